"""Act as a widget's page: deliver messages as ipykernel does."""

import asyncio
import threading
from collections.abc import Callable
from xml.etree import ElementTree


def on_a_subshell(call: Callable[..., object], *arguments: object) -> None:
    """Call a function on a thread without an event loop, and wait until it is done."""
    thread = threading.Thread(target=call, args=arguments, name="subshell-1")
    thread.start()
    thread.join()


async def settle() -> None:
    """Let the posted calls run."""
    for _ in range(3):
        await asyncio.sleep(0)


async def say(widget, kind, view="page", **fields) -> None:
    """Send a message to a widget, as a page does."""
    on_a_subshell(widget._handle_custom_msg, {"type": kind, "view": view, **fields}, [])
    await settle()


def parsed(svg: str) -> ElementTree.Element:
    """Parse a picture, with element names without namespaces."""
    return ElementTree.fromstring(svg.replace(' xmlns="http://www.w3.org/2000/svg"', "", 1))
