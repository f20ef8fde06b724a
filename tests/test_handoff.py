"""The laws of the hand-off: every call runs once, in order, on the main thread, or is refused."""

import asyncio
import random
import re
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import TIMEOUT, until

from tutorial import handoff
from tutorial.errors import RefusedError, WrongThreadError
from tutorial.handoff import CallQueue, Latest, RequestQueue


async def until_idle(queue: CallQueue) -> None:
    """Let the loop run until no call is waiting."""
    while len(queue):
        await asyncio.sleep(0)
    await asyncio.sleep(0)


def run(*steps):
    """Give each step a queue and the list of calls that ran, and wait for the queue; return the list."""

    async def main():
        queue, ran = CallQueue(asyncio.get_running_loop()), []
        for step in steps:
            step(queue, ran)
            await until_idle(queue)
        return ran

    return asyncio.run(main())


def on_threads(jobs):
    """Run each job on a separate thread, and wait for all."""
    with ThreadPoolExecutor() as pool:
        list(pool.map(lambda job: job(), jobs))


def test_latest_is_the_initial_and_then_the_newest_value():
    latest = Latest(0)
    assert latest.get() == 0
    latest.put(1)
    latest.put(2)
    assert latest.get() == 2


class TestCallLater:
    @given(st.lists(st.lists(st.integers(), max_size=30), min_size=1, max_size=4))
    def test_every_call_runs_once_on_the_loops_thread_in_order(self, posted):
        def post(queue, ran):
            def poster(number, values):
                scope = queue.scope(f"poster {number}")
                note = lambda value: ran.append((threading.current_thread(), number, value))  # noqa: E731
                return lambda: [scope.call_later(note, value) for value in values]

            on_threads([poster(i, values) for i, values in enumerate(posted)])

        ran = run(post)
        assert {thread for thread, _, _ in ran} <= {threading.main_thread()}
        for i, values in enumerate(posted):
            assert [value for _, number, value in ran if number == i] == values

    def test_an_iteration_runs_the_calls_queued_before_it(self):
        def post(queue, ran):
            def again():
                ran.append("call")
                if len(ran) < 10:
                    scope.call_later(again)

            scope = queue.scope("test")
            scope.call_later(again)
            asyncio.get_running_loop().call_soon(ran.append, "loop")

        assert run(post)[:3] == ["call", "loop", "call"], "a call that posts itself again must not hold the loop"

    @pytest.mark.parametrize("kind", [SystemExit, ZeroDivisionError])
    def test_a_failure_shows_where_it_was_posted_and_later_calls_run(self, kind, caplog):
        def fail():
            raise kind

        def post(queue, ran):
            scope = queue.scope("Broken of Tank")
            on_threads([lambda: scope.call_later(fail)])
            scope.call_later(ran.append, scope)

        (scope,) = run(post)
        assert isinstance(scope.queue.error, kind)
        said = r"Broken of Tank: a call posted at .*test_handoff\.py:\d+ on the thread 'ThreadPool.*' failed"
        assert re.fullmatch(said, caplog.messages[0])
        assert kind.__name__ in caplog.text

    def test_an_interrupted_call_does_not_cancel_later_ones(self):
        def interrupt():
            raise KeyboardInterrupt

        loop = asyncio.new_event_loop()
        queue = CallQueue(loop)
        scope, ran = queue.scope("test"), []
        scope.call_later(interrupt)
        scope.call_later(ran.append, "waited")
        with pytest.raises(KeyboardInterrupt):
            loop.run_until_complete(until_idle(queue))
        scope.call_later(ran.append, "came later")
        loop.run_until_complete(asyncio.wait_for(until_idle(queue), 20))
        assert ran == ["waited", "came later"]
        loop.close()
        scope.call_later(print)
        assert not len(queue), "posted after the loop has closed"

    @given(before=st.integers(0, 20), after=st.integers(0, 20))
    def test_after_close_posting_does_nothing(self, before, after):
        def post(queue, ran):
            kept, left = queue.scope("kept"), queue.scope("left")
            for _ in range(before):
                left.call_later(ran.append, "left")
                kept.call_later(ran.append, "kept")
            left.close()
            left.close()
            for _ in range(after):
                left.call_later(ran.append, "left")
            assert len(queue) == 2 * before

        assert run(post) == ["kept"] * before

    def test_a_closed_queue_refuses_and_runs_nothing(self):
        def post(queue, ran):
            scope = queue.scope("test")
            scope.call_later(ran.append, 1)
            queue.close()
            queue.close()
            scope.call_latest("key", ran.append, 2)
            assert not len(queue)

        assert run(post) == []

    def test_during_close_each_call_runs_once_or_is_refused(self):
        def post(queue, ran):
            def flood():
                for i in range(3000):
                    scope.call_later(ran.append, i)
                    posted.set()

            def close():
                scope.close()
                flooding.join()

            scope, posted, flooding = queue.scope("test"), threading.Event(), threading.Thread(target=flood)
            flooding.start()
            posted.wait()
            asyncio.get_running_loop().call_soon(close)

        ran = run(post)
        assert ran == list(range(len(ran))), "in order, each once, and all before the close"


posts = st.lists(st.tuples(st.sampled_from([0, 1]), st.sampled_from(["a", "b", None]), st.integers()), max_size=20)


@given(posts, posts)
def test_the_newest_call_of_a_key_takes_the_firsts_place(first, second):
    scopes, expected = [], []

    def posting(posted):
        def post(queue, ran):
            scopes.extend(queue.scope(f"scope {len(scopes)}") for _ in range(2 - len(scopes)))
            waiting = {}
            for i, (number, key, value) in enumerate(posted):
                if key is None:
                    scopes[number].call_later(ran.append, value)
                else:
                    scopes[number].call_latest(key, ran.append, value)
                waiting[i if key is None else (number, key)] = value
            assert len(queue) == len(waiting), "replaced calls do not make the queue grow"
            expected.extend(waiting.values())

        return post

    assert run(posting(first), posting(second)) == expected


class TestTooBusy:
    def test_many_waiting_calls_are_reported_once_with_advice(self, caplog):
        def post(queue, ran):
            scope = queue.scope("Viewer of Tank")
            for waiting in range(2 * handoff.CROWD):
                assert bool(caplog.messages) == (waiting > handoff.CROWD)
                scope.call_later(list)

        run(post)
        (line,) = caplog.messages
        assert line.startswith(f"the main thread is too busy for the calls posted to it: {handoff.CROWD + 1} waiting")
        assert line.endswith("Viewer of Tank can post with call_latest(key, f, message)")

    def test_a_long_wait_is_reported_once(self, caplog, monkeypatch):
        loop = asyncio.SelectorEventLoop()
        scope = CallQueue(loop).scope("Viewer of Tank")
        scope.call_latest("key", list)
        first = time.monotonic()
        for later in (handoff.LONG_WAIT - 1, handoff.LONG_WAIT + 1, handoff.LONG_WAIT + 2):
            monkeypatch.setattr(handoff.time, "monotonic", lambda later=later: first + later)
            scope.call_latest("key", list)
        loop.close()
        (line,) = caplog.messages
        assert "1 waiting, the first for 11.0 s. Do less in each call;" in line

    def test_a_long_wait_is_reported_without_new_posts(self, caplog, monkeypatch):
        def post(queue, ran):
            queue.scope("Viewer of Tank").call_later(list)
            assert caplog.messages == []
            monkeypatch.setattr(handoff, "LONG_WAIT", -1.0)

        run(post)
        assert len(caplog.messages) == 1


@contextmanager
def stepping(requests, step=lambda: None):
    """Step as a simulation does, on a separate thread: carry out the requests, and refuse them at the end."""
    stopping = threading.Event()

    def main():
        while not stopping.wait(0.0001):  # a step takes time, and leaves Python to other threads
            requests.run_waiting()
            step()
        requests.close()

    thread = threading.Thread(target=main, name="stepping", daemon=True)
    requests.open(thread)
    thread.start()
    try:
        yield thread
    finally:
        stopping.set()
        thread.join(TIMEOUT)
        assert not thread.is_alive()


@pytest.fixture
def requests():
    return RequestQueue()


def refusal(ask, *args, **options):
    """Return the text of a refusal."""
    with pytest.raises(RefusedError) as info:
        ask(*args, **options)
    return str(info.value)


NOT_RUNNING = "the simulation is not running. Start it, and ask again."


class TestRequests:
    def test_the_answer_comes_from_the_stepping_thread(self, requests):
        with stepping(requests) as thread:
            assert requests.ask(threading.current_thread) is thread
            assert requests.ask(divmod, 7, 2) == (3, 1)

    @pytest.mark.parametrize("kind", [ZeroDivisionError, SystemExit, TimeoutError, RefusedError])
    def test_an_error_reaches_the_caller_and_nobody_else(self, requests, kind):
        def fail():
            raise kind("mine")

        with stepping(requests):
            with pytest.raises(kind, match="mine"):
                requests.ask(fail)
            assert requests.ask(int) == 0

    def test_without_a_running_simulation_it_is_refused_at_once(self, requests):
        assert refusal(requests.ask, print, timeout=TIMEOUT) == NOT_RUNNING
        with stepping(requests):
            assert requests.ask(int) == 0
        assert refusal(requests.ask, print, timeout=TIMEOUT) == NOT_RUNNING
        requests.close("it has failed.")
        assert refusal(requests.ask, print, timeout=TIMEOUT) == "it has failed."

    def test_a_stop_refuses_those_who_wait(self, requests):
        requests.open(None)
        with ThreadPoolExecutor() as pool:
            asked = [pool.submit(refusal, requests.ask, print, timeout=TIMEOUT) for _ in range(3)]
            until(lambda: len(requests._waiting) == 3)
            requests.close("stopped.")
            assert [each.result() for each in asked] == ["stopped."] * 3
        requests.run_waiting()

    def test_a_late_request_is_never_carried_out(self, requests):
        ran = []
        requests.open(None)
        assert refusal(requests.ask, ran.append, 1, timeout=0.01).endswith("not finish its step within 0.01 s.")
        requests.run_waiting()
        assert ran == []

    def test_a_hanging_request_is_given_up(self, requests):
        let = threading.Event()
        with stepping(requests):
            said = refusal(requests.ask, let.wait, TIMEOUT, timeout=0.05)
            assert said == "the request was started, but did not finish within 0.05 s."
            let.set()
            assert requests.ask(int) == 0

    def test_an_interrupted_request_lets_nobody_wait(self, requests):
        def interrupt():
            raise KeyboardInterrupt

        requests.open(None)
        with ThreadPoolExecutor() as pool:
            asked = pool.submit(refusal, requests.ask, interrupt, timeout=0.1)
            with pytest.raises(KeyboardInterrupt):
                until(requests.run_waiting)
            assert asked.result().startswith("the request was started")

    def test_the_stepping_thread_cannot_ask_itself(self, requests):
        with stepping(requests), pytest.raises(WrongThreadError, match="Call the function directly"):
            requests.ask(requests.ask, print)

    def test_requests_do_not_hold_up_the_steps(self, requests):
        steps = []
        with stepping(requests, lambda: steps.append(1)), ThreadPoolExecutor(2) as pool:
            list(pool.map(lambda _: requests.ask(int), range(200)))
        assert len(steps) >= 100, "at most two in each step"

    def test_each_is_answered_or_refused_however_they_interleave(self, requests):
        for seed in range(200):
            goal, reached = 1 + random.Random(seed).randrange(25), threading.Event()
            ran, answered, refused = [], [], []

            def note(value, goal=goal, reached=reached, ran=ran):
                ran.append(value)
                if len(ran) == goal:
                    reached.set()
                return value

            def ask_some(values, note=note, answered=answered, refused=refused):
                for value in values:
                    try:
                        answered.append(requests.ask(note, value, timeout=TIMEOUT))
                    except RefusedError:
                        refused.append(value)

            with ThreadPoolExecutor(3) as pool:
                with stepping(requests):
                    for i in range(3):
                        pool.submit(ask_some, range(10 * i, 10 * i + 10))
                    assert reached.wait(TIMEOUT)
                with stepping(requests):  # some callers that were not refused meanwhile ask again
                    pass
            assert sorted(answered) == sorted(ran), "nothing that was refused was carried out"
            assert sorted(answered + refused) == list(range(30)), seed
