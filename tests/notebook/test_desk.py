"""What is open in a kernel: under each name one thing, and in the end nothing."""

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


def test_what_was_open_under_a_name_is_closed_first_and_in_the_end_all_is_the_newest_first():
    diary = []
    for name in "abac":
        keep(name, lambda name=name: diary.append(f"+{name}"), lambda _, name=name: diary.append(f"-{name}"))
    close_all()
    close_all()
    assert diary == ["+a", "+b", "-a", "+a", "+c", "-c", "-a", "-b"]


def test_when_making_fails_the_old_is_closed_all_the_same_and_nothing_is_kept():
    closed = []
    keep("node a", object, closed.append)
    with pytest.raises(ZeroDivisionError):
        keep("node a", lambda: 1 / 0, print)
    close_all()
    assert len(closed) == 1


def test_what_is_kept_once_stays():
    assert keep_once("tools", object, print) is keep_once("tools", object, print)


def test_one_that_cannot_be_closed_does_not_keep_the_others_open(capsys):
    closed = []
    first = keep("a", object, closed.append)
    keep("b", object, lambda thing: 1 / 0)
    close_all()
    assert closed == [first]
    log()
    assert capsys.readouterr().out == "[ERROR] b could not be closed: ZeroDivisionError: division by zero\n"


async def test_until_leaves_the_loop_free_and_says_what_it_waited_for():
    done = []
    asyncio.get_running_loop().call_later(0.05, done.append, True)
    await until(lambda: done)
    with pytest.raises(TutorialError, match=r"waited 0\.02 s in vain for the match\. Run the cells above"):
        await until(lambda: False, "the match", 0.02)
    with pytest.raises(TutorialError, match=r"in vain\. Meanwhile: \[ERROR\] no match"):
        await until(lambda: logger.error("no match"), patience=0.02)


def test_errors_may_pour_in_while_they_are_looked_at(capsys):
    """The one who waits in vain, and the one who prints, see whole lines, however often the threads change."""
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
            with pytest.raises(TutorialError, match="in vain"):
                until(lambda: False, patience=-1.0).send(None)
            log()
    finally:
        enough.set()
        thread.join()
        sys.setswitchinterval(interval)
    assert set(capsys.readouterr().out.splitlines()) <= {"[ERROR] again"}


def test_what_is_logged_on_any_thread_is_printed_when_asked_for(capsys):
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
