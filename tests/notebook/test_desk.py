"""The things that are open in a kernel: one under each name, and none after closing."""

import asyncio
import logging
import sys
import threading

import pytest

from tutorial.errors import TutorialError
from tutorial.notebook import desk
from tutorial.notebook.desk import close_all, keep, keep_once, log, until

logger = logging.getLogger("tutorial.somewhere")


@pytest.fixture(autouse=True)
def empty_desk(monkeypatch):
    monkeypatch.setattr(desk, "_open", {})
    desk.logged.lines.clear()


def test_reopening_a_name_closes_the_old_one_and_close_all_goes_backwards():
    diary = []
    for name in "abac":
        keep(name, lambda name=name: diary.append(f"+{name}"), lambda _, name=name: diary.append(f"-{name}"))
    close_all()
    close_all()
    assert diary == ["+a", "+b", "-a", "+a", "+c", "-c", "-a", "-b"]


def test_a_failed_opening_closes_the_old_one_and_keeps_nothing():
    closed = []
    keep("node a", object, closed.append)
    with pytest.raises(ZeroDivisionError):
        keep("node a", lambda: 1 / 0, print)
    close_all()
    assert len(closed) == 1


def test_keep_once_keeps_the_first():
    assert keep_once("tools", object, print) is keep_once("tools", object, print)


def test_a_failure_to_close_does_not_keep_the_rest_open(capsys):
    closed = []
    first = keep("a", object, closed.append)
    keep("b", object, lambda thing: 1 / 0)
    close_all()
    assert closed == [first]
    log()
    assert capsys.readouterr().out == "[ERROR] b could not be closed: ZeroDivisionError: division by zero\n"


async def test_until_lets_the_loop_run_and_names_its_condition():
    done = []
    asyncio.get_running_loop().call_later(0.05, done.append, True)
    await until(lambda: done)
    with pytest.raises(TutorialError, match=r"timed out after 0\.02 s waiting for the match\. Run the cells above"):
        await until(lambda: False, "the match", 0.02)
    with pytest.raises(TutorialError, match=r"timed out .*\. Meanwhile: \[ERROR\] no match"):
        await until(lambda: logger.error("no match"), timeout=0.02)


def test_errors_may_be_logged_while_they_are_read(capsys):
    """A failing `until`, and `log`, see whole lines, even if threads switch constantly."""
    enough = threading.Event()

    def pour():
        while not enough.is_set():
            logger.error("again")

    thread = threading.Thread(target=pour)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    thread.start()
    try:
        for _ in range(3000):
            with pytest.raises(TutorialError, match="timed out"):
                until(lambda: False, timeout=-1.0).send(None)
            log()
    finally:
        enough.set()
        thread.join()
        sys.setswitchinterval(interval)
    assert set(capsys.readouterr().out.splitlines()) <= {"[ERROR] again"}


def test_log_prints_lines_of_any_thread(capsys):
    def work():
        logger.warning("the rate is %d", 50)
        try:
            raise ValueError("mine")
        except ValueError:
            logger.exception("it failed")

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert capsys.readouterr() == ("", "")
    log()
    log()
    assert capsys.readouterr().out == "[WARNING] the rate is 50\n[ERROR] it failed: ValueError: mine\n"
