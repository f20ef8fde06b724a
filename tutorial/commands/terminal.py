"""What the commands do at a terminal: they end when they are asked to, and show how far they have come."""

import asyncio
import logging
import os
import signal
import sys
import threading
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager, suppress
from io import TextIOWrapper

from tqdm import tqdm
from tqdm.contrib.logging import logging_redirect_tqdm

from tutorial.errors import printable_lines

ENDINGS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
INTERRUPTED = 130  # the exit status that shells expect after Ctrl-C


class _LogFormatter(logging.Formatter):
    """Writes log lines as `say` does what is printed."""

    def format(self, record: logging.LogRecord) -> str:
        return printable_lines(super().format(record))


def prepare_output() -> None:
    """Have this process log on stderr, and write on stdout as escapes what the terminal has no characters for."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # as Python's stderr
    handler = logging.StreamHandler()
    handler.setFormatter(_LogFormatter("[%(levelname)s] %(message)s"))
    logging.basicConfig(handlers=[handler], level=logging.INFO)
    logging.getLogger("OpenGL").setLevel(logging.WARNING)  # at its import it says what it does without


def handle_signals(ask: Callable[[], object], at_once: Callable[[], object] = lambda: None) -> None:
    """From now on the first Ctrl-C or SIGTERM asks this process to end, and the second ends it at once. Main thread.

    So does SIGHUP, which comes when the terminal is closed, unless ``nohup`` has this process ignore it.

    A thread of its own waits for them, for the main thread may be in a loop, or in a call that does not return. It
    waits until the process has ended, for the code that closes everything may be in a loop, too.

    Args:
        ask: called on that thread at the first signal; it may fail when there is nothing left to ask.
        at_once: called there at the second one, before the process ends with the status that shells give to it.
    """
    read_end, write_end = os.pipe()
    os.set_blocking(write_end, False)
    signal.set_wakeup_fd(write_end, warn_on_full_buffer=False)  # Python writes the number of each signal there
    for number in _heeded():
        signal.signal(number, lambda *_: None)
    heard = (lambda: os.read(read_end, 1)[0], ask, at_once)
    threading.Thread(target=_end, args=heard, name="endings", daemon=True).start()


def _heeded() -> list[signal.Signals]:
    """Return the signals that end this process."""
    return [each for each in ENDINGS if each != signal.SIGHUP or signal.getsignal(each) != signal.SIG_IGN]


def _end(hear: Callable[[], int], ask: Callable[[], object], at_once: Callable[[], object]) -> None:
    """Wait for a signal that asks, and then for one that ends."""
    while hear() not in ENDINGS:
        pass
    with suppress(Exception):
        ask()
    while (number := hear()) not in ENDINGS:
        pass
    try:
        at_once()
    finally:
        os._exit(128 + number)


def until_asked(program: Awaitable[None]) -> bool:
    """Run a program on a fresh event loop until it ends or is asked to, by Ctrl-C or SIGTERM; return whether it was."""
    asked = threading.Event()

    async def body() -> None:
        task = asyncio.ensure_future(program)
        loop = asyncio.get_running_loop()

        def ask() -> None:
            asked.set()
            loop.call_soon_threadsafe(task.cancel)

        handle_signals(ask)
        try:
            await task
        except asyncio.CancelledError:
            if not asked.is_set():
                raise

    asyncio.run(body())
    return asked.is_set()


@contextmanager
def progress_bar(duration: float | None) -> Iterator[Callable[[float], object]]:
    """Make a progress bar over some seconds, on stderr if it is a terminal; what is logged meanwhile stands above it.

    Args:
        duration: its length [s]; None for no bar.
    """
    total = duration or 0.0
    form = "{percentage:3.0f}% |{bar:40}| {n:.0f} of {total:.0f} s"
    bar = tqdm(total=total, bar_format=form, disable=True if duration is None else None, ascii=" =")
    with bar, logging_redirect_tqdm():
        yield lambda seconds: bar.update(min(seconds, total) - bar.n)


@contextmanager
def status_line() -> Iterator[Callable[[str], object]]:
    """Show a line on stderr, as wide as the terminal, for work of unknown length; nothing if stderr is no terminal."""
    line = tqdm(bar_format="{desc}", disable=None, leave=False, dynamic_ncols=True)
    with line, logging_redirect_tqdm():
        yield line.set_description_str
