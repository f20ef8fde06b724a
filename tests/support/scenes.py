"""Helpers for tests of scenes: the contents of messages, and calls from other threads."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from tutorial.view.scene import Record, unpack_command, unpack_records


def commands(message: bytes) -> list[dict[str, Any]]:
    """Return the commands in a message."""
    return [unpack_command(payload) for kind, payload in unpack_records(message) if kind is Record.COMMAND]


def lines(message: bytes) -> list[str]:
    """Return the lines that a message shows below the view."""
    return [payload.decode() for kind, payload in unpack_records(message) if kind is Record.LINE]


def raised_elsewhere(call: Callable[..., object], *args: object) -> BaseException | None:
    """Call a function on a different thread, ``other_0``, and return the exception that it raises."""
    with ThreadPoolExecutor(1, thread_name_prefix="other") as pool:
        return pool.submit(call, *args).exception()


def sends_away(owner: object, method: str, *args: object) -> bool:
    """Return whether a scene or a view tells other threads that it belongs to the main thread."""
    return repr(raised_elsewhere(getattr(owner, method), *args)) == (
        f"WrongThreadError(\"{type(owner).__name__}.{method} was called on the thread 'other_0', but the 3D view "
        "belongs to the thread 'MainThread'. Post the call instead: call_later(f, message).\")"
    )
