"""Run coroutine tests like a cell: on a loop, and close everything that they opened."""

import asyncio
import inspect

import pytest

from tutorial.notebook import close_all


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    if not inspect.iscoroutinefunction(pyfuncitem.obj):
        return None

    async def cell() -> None:
        try:
            await pyfuncitem.obj(**{name: pyfuncitem.funcargs[name] for name in pyfuncitem._fixtureinfo.argnames})
        finally:
            close_all()

    asyncio.run(cell())
    return True
