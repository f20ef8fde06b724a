"""What is open in a kernel: under each name one thing, and in the end nothing."""

from __future__ import annotations

import asyncio
import logging
import sys
import threading

import pytest

from tutorial.errors import TutorialError
from tutorial.notebook import desk
from tutorial.notebook.desk import close_all, keep, keep_once, log, until


@pytest.fixture(autouse=True)
def empty_desk(monkeypatch):
    monkeypatch.setattr(desk, "_open", {})


class Thing:
    closed = 0

    def __init__(self, diary=None, name=""):
        self.diary, self.name = diary, name

    def close(self):
        self.closed += 1
        if self.diary is not None:
            self.diary.append(self.name)


def test_what_was_open_under_a_name_is_closed_before_the_new_is_made():
    first = keep("node a", Thing, Thing.close)

    def make():
        assert first.closed == 1
        return Thing()

    second = keep("node a", make, Thing.close)
    assert second is not first
    assert second.closed == 0


def test_when_making_fails_the_old_is_closed_all_the_same_and_nothing_is_kept():
    first = keep("node a", Thing, Thing.close)
    with pytest.raises(ZeroDivisionError):
        keep("node a", lambda: 1 / 0, print)
    close_all()
    assert first.closed == 1


def test_what_is_kept_once_stays():
    assert keep_once("tools", Thing, Thing.close) is keep_once("tools", Thing, Thing.close)


def test_all_is_closed_the_newest_first_and_twice_is_once():
    diary = []
    for name in "abc":
        keep(name, lambda name=name: Thing(diary, name), Thing.close)
    close_all()
    close_all()
    assert diary == ["c", "b", "a"]


def test_one_that_cannot_be_closed_does_not_keep_the_others_open(capsys):
    first = keep("a", Thing, Thing.close)
    keep("b", Thing, lambda thing: 1 / 0)
    log()
    capsys.readouterr()
    close_all()
    assert first.closed == 1
    log()
    assert capsys.readouterr().out == "[ERROR] b could not be closed: ZeroDivisionError: division by zero\n"


def test_until_leaves_the_loop_free():
    async def scenario():
        done = []
        asyncio.get_running_loop().call_later(0.05, done.append, True)
        await until(lambda: done)

    asyncio.run(scenario())


def test_until_says_what_it_waited_for():
    with pytest.raises(TutorialError, match=r"waited 0\.02 s in vain for the match\. Run the cells above"):
        asyncio.run(until(lambda: False, "the match", 0.02))


def test_errors_may_pour_in_while_they_are_looked_at(capsys):
    """The one who waits in vain, and the one who prints, see whole lines, however often the threads change."""
    enough = threading.Event()

    def pour():
        while not enough.is_set():
            logging.getLogger("tutorial.somewhere").error("again")

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
    log()
    capsys.readouterr()
    logger = logging.getLogger("tutorial.somewhere")

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
    assert capsys.readouterr().out == "[WARNING] the rate is 50\n[ERROR] it failed: ValueError: mine\n"
    log()
    assert capsys.readouterr().out == ""
