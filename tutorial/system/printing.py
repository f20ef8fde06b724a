"""Prints text that may contain untrusted parts, in a terminal or in a notebook cell."""

from collections.abc import AsyncGenerator
from contextlib import aclosing

import click

from tutorial.errors import printable_lines


def print_text(text: str, err: bool = False) -> None:
    """Print text without adding a line break, and flush. All commands use this function to print.

    Control characters are printed as escapes: parts of the text may be untrusted, and a terminal would interpret them.

    Args:
        text: the text.
        err: print on stderr.
    """
    click.echo(printable_lines(text), nl=False, err=err)


async def print_texts(texts: AsyncGenerator[str, None], count: int | None = None) -> None:
    """Print strings as they arrive: the first ``count`` strings, or all strings if ``count`` is None."""
    async with aclosing(texts):
        async for text in texts:
            print_text(text)
            count = None if count is None else count - 1
            if count == 0:
                return
