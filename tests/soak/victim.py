"""Run the command ``tank`` unchanged as the victim, and measure how long its main loop is blocked.

Every tenth of a second, write the longest time that it was blocked since the last line [s] to the file ``HOLDS``.
"""

import asyncio
import os
import time
from typing import Any

from tutorial.__main__ import main
from tutorial.program.host import Host

EVERY = 0.1  # [s] between two lines
NAP = 0.005  # [s] how long the main loop sleeps before it should run again

run = Host.run


async def measure() -> None:
    """Write these times to the file."""
    with open(os.environ["HOLDS"], "w", buffering=1) as file:  # noqa: PTH123
        while True:
            longest, due = 0.0, time.monotonic() + EVERY
            while (before := time.monotonic()) < due:
                await asyncio.sleep(NAP)
                longest = max(longest, time.monotonic() - before - NAP)
            file.write(f"{longest}\n")


async def measured_run(self: Host, *args: Any, **options: Any) -> None:
    """Run the command, and measure at the same time."""
    measuring = asyncio.ensure_future(measure())
    try:
        await run(self, *args, **options)
    finally:
        measuring.cancel()


if __name__ == "__main__":
    Host.run = measured_run  # type: ignore[method-assign]
    main()
