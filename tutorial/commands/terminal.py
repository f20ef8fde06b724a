"""The commands' behaviour in a terminal: signals, logging and progress bars."""

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
    """Escapes log lines as `print_text` escapes printed text."""

    def format(self, record: logging.LogRecord) -> str:
        return printable_lines(super().format(record))


def prepare_output() -> None:
    """Log on stderr. On stdout, escape the characters that the terminal's encoding lacks."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # as Python does on stderr
    handler = logging.StreamHandler()
    handler.setFormatter(_LogFormatter("[%(levelname)s] %(message)s"))
    logging.basicConfig(handlers=[handler], level=logging.INFO)
    logging.getLogger("OpenGL").setLevel(logging.WARNING)  # PyOpenGL logs every missing accelerator when it is imported


def handle_signals(ask: Callable[[], object], at_once: Callable[[], object] = lambda: None) -> None:
    """Make the first Ctrl-C or SIGTERM ask this process to end, and the second one end it at once. Main thread only.

    SIGHUP, which a closing terminal sends, is handled the same way unless ``nohup`` makes this process ignore it.

    A separate thread waits for the signals, because the main thread can be stuck in a loop or a blocking call. The
    thread keeps waiting until the process ends, because the cleanup can also get stuck.

    Args:
        ask: called on the waiting thread at the first signal. Exceptions are ignored, because the program may already
            have ended.
        at_once: called on the waiting thread at the second signal, before the process ends with the signal's exit
            status.
    """
    read_end, write_end = os.pipe()
    os.set_blocking(write_end, False)
    signal.set_wakeup_fd(write_end, warn_on_full_buffer=False)  # Python writes each signal's number to it
    for number in _heeded():
        signal.signal(number, lambda *_: None)
    heard = (lambda: os.read(read_end, 1)[0], ask, at_once)
    threading.Thread(target=_end, args=heard, name="endings", daemon=True).start()


def _heeded() -> list[signal.Signals]:
    """Return the signals that end this process."""
    return [each for each in ENDINGS if each != signal.SIGHUP or signal.getsignal(each) != signal.SIG_IGN]


def _end(hear: Callable[[], int], ask: Callable[[], object], at_once: Callable[[], object]) -> None:
    """Call `ask` at the first signal; at the second one, call `at_once` and end the process."""
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
    """Run a program on a new event loop until it ends or until Ctrl-C or SIGTERM; return whether a signal ended it."""
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
    """Show a progress bar for work of known duration, if stderr is a terminal. Log lines appear above the bar.

    Args:
        duration: the duration [s]; None to show no bar.
    """
    total = duration or 0.0
    form = "{percentage:3.0f}% |{bar:40}| {n:.0f} of {total:.0f} s"
    bar = tqdm(total=total, bar_format=form, disable=True if duration is None else None, ascii=" =")
    with bar, logging_redirect_tqdm():
        yield lambda seconds: bar.update(min(seconds, total) - bar.n)


@contextmanager
def status_line() -> Iterator[Callable[[str], object]]:
    """Show a status line for work of unknown duration, if stderr is a terminal."""
    line = tqdm(bar_format="{desc}", disable=None, leave=False, dynamic_ncols=True)
    with line, logging_redirect_tqdm():
        yield line.set_description_str
