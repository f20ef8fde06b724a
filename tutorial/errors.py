"""What goes wrong, said so that the reader knows the mend."""

import re
import sys
import threading
import traceback
from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path

WIDE_SPACES = "\u00a0\u3000"  # not breaking, and as wide as a Japanese character: Python takes them for unprintable


class TutorialError(Exception):
    """Base of every error that the library raises on purpose.

    Its text is made for the learner: what was given, what was expected, and the mend.
    """

    def _render_traceback_(self) -> list[str]:
        """What a notebook shows in place of a traceback: the text is about the learner's code, the frames are not."""
        return [f"{type(self).__name__}: {self}"]


class WrongThreadError(TutorialError):
    """Something that belongs to one thread was touched from another."""


def did_you_mean(given: str, valid: Iterable[str]) -> str:
    """End a message about an unknown name: the nearest valid name, and all of them, or the first thirty.

    Args:
        given: the name that is not known.
        valid: the names that are.

    Returns:
        ``" Did you mean 'x'? Known are 'x', 'y'."``, with a leading space so that it can be appended to a sentence.
    """
    names = sorted(valid)
    if not names:
        return " There are none."
    near = get_close_matches(given, names, n=1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    more = f" and {len(names) - 30:,} more" if len(names) > 30 else ""
    return f"{hint} Known are {', '.join(map(repr, names[:30]))}{more}."


def printable(text: str) -> str:
    """Make a text from outside fit for a terminal: what is no visible character becomes its escape.

    That are control characters, which a terminal obeys, those that turn the direction of writing around, line ends and
    half characters.

    Returns:
        For instance ``'a\\x1b[2Jb'`` or ``'\\u202egpj'``; a text of visible characters as it is.
    """
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() or c in WIDE_SPACES else c.encode("unicode_escape").decode("ascii") for c in text
    )


def printable_lines(text: str) -> str:
    """As `printable`, for a text that has line ends and tabs of its own: they stay.

    What comes from outside is made `printable` before it is put into such a text, or it could add lines to it.
    """
    return re.sub(r"[^\n\t]+", lambda part: printable(part[0]), text)


def file_of(written: type) -> str:
    """Return the file, or the notebook's cell, that a class is written in; empty for one without methods."""
    codes = (getattr(attribute, "__code__", None) for attribute in vars(written).values())
    return next((code.co_filename for code in codes if code is not None), "")


def tell(error: BaseException, file: str) -> str:
    """Say in one line what went wrong in somebody's file, and where: the innermost place that is in it.

    Args:
        error: what was raised.
        file: the path of the file that the reader can mend, or what a kernel calls a cell.

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
    """Say which line a thread is at that does not come to its end.

    Args:
        thread: the thread.
        file: whose innermost line is meant, if the thread is in it; else the innermost of all is.

    Returns:
        For instance ``": it is at mine.py, line 8, in control"``; empty when it has ended.
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
    """Name a file; the files that a kernel says its cells come from do not exist, and their names say nothing."""
    path = Path(file)
    return "your cell" if path.parent.name.startswith("ipykernel_") else path.name
