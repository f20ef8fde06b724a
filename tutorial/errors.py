"""Errors whose messages say what is wrong and how to fix it."""

import re
import sys
import threading
import traceback
from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path

WIDE_SPACES = "\u00a0\u3000"  # no-break and ideographic spaces: visible, though Python calls them unprintable


class TutorialError(Exception):
    """Base class of every error that the library raises on purpose.

    The message is for the learner: it quotes the input, and explains what is wrong with it and how to fix it.
    """

    def _render_traceback_(self) -> list[str]:
        """Return the error's own line, which a notebook shows instead of a traceback through the library."""
        return [f"{type(self).__name__}: {self}"]


class WrongThreadError(TutorialError):
    """A thread used an object that belongs to a different thread."""


class RefusedError(TutorialError):
    """A request was not carried out; the text gives the reason. See `tutorial.handoff.RequestQueue`."""


def did_you_mean(given: str, valid: Iterable[str]) -> str:
    """Return the end of a message about an unknown name: the nearest valid name, and up to thirty valid names.

    Args:
        given: the unknown name.
        valid: the valid names.

    Returns:
        ``" Did you mean 'x'? Known: 'x', 'y'."``, with a leading space so that it can be appended to a sentence.
    """
    names = sorted(valid)
    if not names:
        return " There are none."
    near = get_close_matches(given, names, n=1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    more = f" and {len(names) - 30:,} more" if len(names) > 30 else ""
    return f"{hint} Known: {', '.join(map(repr, names[:30]))}{more}."


def printable(text: str) -> str:
    """Escape every invisible character in untrusted text, so that a terminal can print it safely.

    These are line breaks, lone surrogates, characters that reverse the text direction, and control characters,
    which a terminal would interpret.

    Returns:
        For instance ``'a\\x1b[2Jb'`` or ``'\\u202egpj'``; text with only visible characters is returned unchanged.
    """
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() or c in WIDE_SPACES else c.encode("unicode_escape").decode("ascii") for c in text
    )


def printable_lines(text: str) -> str:
    """Escape invisible characters as `printable` does, but keep line breaks and tabs.

    Pass each untrusted part through `printable` before you insert it into the text, so that it cannot add lines.
    """
    return re.sub(r"[^\n\t]+", lambda part: printable(part[0]), text)


def file_of(written: type) -> str:
    """Return the file, or the notebook cell, that defines a class; empty if the class has no methods."""
    codes = (getattr(attribute, "__code__", None) for attribute in vars(written).values())
    return next((code.co_filename for code in codes if code is not None), "")


def describe_error(error: BaseException, file: str) -> str:
    """Describe an error in one line, including the last traceback line that belongs to a given file.

    Args:
        error: the exception.
        file: the path of the file that the reader can fix, or the kernel's file name for a cell.

    Returns:
        For instance ``"hello_world.py, line 8, in control: ZeroDivisionError: division by zero"``.
    """
    text = f"{type(error).__name__}: {error}".removesuffix(": ")
    if isinstance(error, SyntaxError) and error.filename == file:
        return f"{_title(file)}, line {error.lineno}: {type(error).__name__}: {error.msg}"
    places = [place for place in traceback.extract_tb(error.__traceback__) if place.filename == file]
    if not places:
        return f"{_title(file)}: {text}" if file else text
    within = "" if places[-1].name == "<module>" else f", in {places[-1].name}"
    return f"{_title(file)}, line {places[-1].lineno}{within}: {text}"


def where(thread: threading.Thread, file: str = "") -> str:
    """Return the end of a message about a thread that does not return: the line that the thread is executing.

    Args:
        thread: the thread.
        file: report the innermost line in this file or, if the thread is not executing it, in any file.

    Returns:
        For instance ``": it is at mine.py, line 8, in control"``; empty if the thread has ended.
    """
    inner = frame = sys._current_frames().get(thread.ident or 0)
    while frame is not None and frame.f_code.co_filename != file:
        frame = frame.f_back
    frame = frame or inner
    if frame is None:
        return ""
    code = frame.f_code
    return f": it is at {_title(code.co_filename)}, line {frame.f_lineno}, in {code.co_name}"


def _title(file: str) -> str:
    """Return a file's name; "your cell" for a cell, because users do not know the file name that the kernel gave it."""
    path = Path(file)
    return "your cell" if path.parent.name.startswith("ipykernel_") else path.name
