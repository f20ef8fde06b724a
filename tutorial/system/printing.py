"""Prints what comes in part from outside, at a terminal and in a cell."""

from collections.abc import AsyncGenerator
from contextlib import aclosing

import click

from tutorial.errors import printable_lines


def say(text: str, err: bool = False) -> None:
    """Print a text that has its line breaks, at once, also into a pipe. All that the commands print goes through here.

    Some of it comes from outside, and a terminal obeys what it is sent: control characters are shown as escapes.

    Args:
        text: what to print.
        err: on stderr.
    """
    click.echo(printable_lines(text), nl=False, err=err)


async def say_all(texts: AsyncGenerator[str, None], count: int | None = None) -> None:
    """Print texts as they come: so many of them, or to the end."""
    async with aclosing(texts):
        async for text in texts:
            say(text)
            count = None if count is None else count - 1
            if count == 0:
                return
