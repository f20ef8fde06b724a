"""The laws of the hand-off: every call once, in order, on the main thread, or refused and counted."""

from __future__ import annotations

import asyncio
import logging
import sys
import threading
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tutorial import handoff
from tutorial.errors import WrongThreadError
from tutorial.handoff import CallQueue, CallScope, Latest, ThreadGuard


async def until_idle(queue: CallQueue) -> None:
    """Let the loop turn until nothing waits."""
    while len(queue):
        await asyncio.sleep(0)
    await asyncio.sleep(0)


def on_threads(jobs):
    """Run each job on a thread of its own, and wait for all."""
    threads = [threading.Thread(target=job) for job in jobs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


class TestLatest:
    def test_returns_the_initial_value_then_the_newest(self):
        latest = Latest(0)
        assert latest.get() == 0
        latest.put(1)
        latest.put(2)
        assert latest.get() == 2

    def test_threads_never_see_anything_but_what_was_put(self):
        latest = Latest((0, 0))
        seen = []

        def put():
            for i in range(2000):
                latest.put((i, i))

        def get():
            seen.extend(latest.get() for _ in range(2000))

        on_threads([put, put, get, get])
        assert all(a == b for a, b in seen)


class TestCallLater:
    @settings(deadline=None)
    @given(st.lists(st.lists(st.integers(), max_size=30), min_size=1, max_size=4))
    def test_every_call_runs_once_in_the_order_of_its_thread(self, posted):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            ran = []

            def poster(number, values):
                scope = queue.scope(f"poster {number}")
                return lambda: [scope.call_later(ran.append, (number, value)) for value in values]

            on_threads([poster(i, values) for i, values in enumerate(posted)])
            await until_idle(queue)
            return ran

        ran = asyncio.run(scenario())
        for i, values in enumerate(posted):
            assert [value for number, value in ran if number == i] == values

    def test_runs_on_the_loops_thread(self):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            threads = []
            on_threads([lambda: queue.scope("test").call_later(lambda: threads.append(threading.current_thread()))])
            await until_idle(queue)
            return threads

        assert asyncio.run(scenario()) == [threading.main_thread()]

    def test_one_turn_runs_what_was_queued_when_it_began(self):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            scope = queue.scope("test")
            ran = []

            def again():
                ran.append("call")
                if len(ran) < 10:
                    scope.call_later(again)

            def other():
                ran.append("loop")

            scope.call_later(again)
            asyncio.get_running_loop().call_soon(other)
            await until_idle(queue)
            return ran

        ran = asyncio.run(scenario())
        assert ran.index("loop") <= 1, "a call that posts itself again must not hold the loop"

    def test_one_that_wants_to_end_the_program_is_kept_as_an_error_and_the_next_call_runs(self, caplog):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            scope, ran = queue.scope("Ending of Tank"), []
            scope.call_later(sys.exit)
            scope.call_later(ran.append, "next")
            await until_idle(queue)
            assert ran == ["next"]
            assert isinstance(scope.error, SystemExit)

        asyncio.run(scenario())
        assert "Ending of Tank" in caplog.text

    def test_an_exception_is_logged_with_where_it_was_posted_and_the_next_call_runs(self, caplog):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            ran = []
            scope = queue.scope("Broken of Tank")
            on_threads([lambda: scope.call_later(lambda: 1 / 0)])
            scope.call_later(ran.append, 1)
            await until_idle(queue)
            return ran

        with caplog.at_level(logging.ERROR):
            assert asyncio.run(scenario()) == [1]
        assert "Broken of Tank" in caplog.text
        assert "test_handoff.py:" in caplog.text
        assert "Thread-" in caplog.text
        assert "ZeroDivisionError" in caplog.text

    def test_an_interrupted_call_does_not_cost_the_later_ones(self):
        def interrupt():
            raise KeyboardInterrupt

        loop = asyncio.new_event_loop()
        queue = CallQueue(loop)
        scope = queue.scope("test")
        ran = []
        scope.call_later(interrupt)
        scope.call_later(ran.append, "waited")
        with pytest.raises(KeyboardInterrupt):
            loop.run_until_complete(until_idle(queue))
        scope.call_later(ran.append, "came later")
        loop.run_until_complete(asyncio.wait_for(until_idle(queue), 20))
        loop.close()
        assert ran == ["waited", "came later"]

    @settings(deadline=None)
    @given(before=st.integers(0, 20), after=st.integers(0, 20))
    def test_after_close_posting_is_a_counted_no_op(self, before, after):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            kept, left = queue.scope("kept"), queue.scope("left")
            ran = []
            for _ in range(before):
                left.call_later(ran.append, "left")
                kept.call_later(ran.append, "kept")
            left.close()
            left.close()
            for _ in range(after):
                left.call_later(ran.append, "left")
            await until_idle(queue)
            return ran, left.refused

        assert asyncio.run(scenario()) == (["kept"] * before, after)

    def test_a_closed_queue_refuses_everything_and_runs_nothing(self):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            scope = queue.scope("test")
            ran = []
            scope.call_later(ran.append, 1)
            queue.close()
            queue.close()
            scope.call_latest("key", ran.append, 2)
            await asyncio.sleep(0)
            return ran, scope.refused, len(queue)

        assert asyncio.run(scenario()) == ([], 1, 0)

    def test_posting_after_the_loop_is_gone_is_refused(self):
        loop = asyncio.new_event_loop()
        scope = CallQueue(loop).scope("test")
        loop.close()
        scope.call_later(print)
        assert scope.refused == 1

    def test_while_it_is_being_closed_each_call_runs_once_or_is_refused(self):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            scope = queue.scope("test")
            ran = []
            posted = threading.Event()

            def post():
                for i in range(3000):
                    scope.call_later(ran.append, i)
                    posted.set()

            thread = threading.Thread(target=post)
            thread.start()
            posted.wait()
            await asyncio.sleep(0)
            scope.close()
            thread.join()
            await until_idle(queue)
            return ran, scope.refused

        ran, refused = asyncio.run(scenario())
        assert ran == list(range(len(ran))), "in order, none twice, and none lost before the close"
        assert len(ran) + refused <= 3000


class TestCallLatest:
    @settings(deadline=None)
    @given(st.lists(st.tuples(st.sampled_from("abc"), st.integers()), max_size=40))
    def test_of_each_key_the_newest_runs_once_in_the_order_of_the_first(self, posted):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            scope = queue.scope("test")
            ran = []
            for key, value in posted:
                scope.call_latest(key, lambda *pair: ran.append(pair), key, value)
            assert len(queue) <= 3, "the queue cannot grow"
            await until_idle(queue)
            return ran

        assert asyncio.run(scenario()) == list(dict(posted).items())

    def test_keys_of_two_scopes_are_two_keys(self):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            ran = []
            one, other = queue.scope("one"), queue.scope("other")
            one.call_latest("key", ran.append, "one")
            other.call_latest("key", ran.append, "other")
            await until_idle(queue)
            return ran

        assert asyncio.run(scenario()) == ["one", "other"]

    def test_keeps_its_place_among_calls_that_are_all_kept(self):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            scope: CallScope = queue.scope("test")
            ran = []
            scope.call_latest("key", ran.append, "old")
            scope.call_later(ran.append, "event")
            scope.call_latest("key", ran.append, "new")
            await until_idle(queue)
            scope.call_latest("key", ran.append, "next")
            await until_idle(queue)
            return ran

        assert asyncio.run(scenario()) == ["new", "event", "next"]


class TestTooBusy:
    @staticmethod
    def told(caplog):
        return [record.getMessage() for record in caplog.records]

    def test_that_a_crowd_waits_is_said_once_with_the_mend(self, caplog):
        async def scenario():
            queue = CallQueue(asyncio.get_running_loop())
            scope = queue.scope("Viewer of Tank")
            for _ in range(handoff.CROWD):
                scope.call_later(list)
            assert self.told(caplog) == []
            for _ in range(handoff.CROWD):
                scope.call_later(list)
            await until_idle(queue)

        asyncio.run(scenario())
        (line,) = self.told(caplog)
        assert line.startswith(f"the main thread is too busy for what is posted to it: {handoff.CROWD + 1} waiting")
        assert line.endswith("Viewer of Tank may post with call_latest(key, f, message)")

    def test_that_one_waits_long_is_said_once(self, caplog, monkeypatch):
        loop = asyncio.SelectorEventLoop()
        scope = CallQueue(loop).scope("Viewer of Tank")
        scope.call_latest("key", list)
        first = time.monotonic()
        for later in (handoff.LONG_WAIT - 1, handoff.LONG_WAIT + 1, handoff.LONG_WAIT + 2):
            monkeypatch.setattr(handoff.time, "monotonic", lambda later=later: first + later)
            scope.call_latest("key", list)
        loop.close()
        (line,) = self.told(caplog)
        assert "1 waiting, the first for 11.0 s. Let it do less at a time;" in line

    def test_that_one_has_waited_long_is_said_when_nobody_posts_any_more(self, caplog, monkeypatch):
        loop = asyncio.SelectorEventLoop()
        queue = CallQueue(loop)
        queue.scope("Viewer of Tank").call_later(list)
        monkeypatch.setattr(handoff, "LONG_WAIT", -1.0)
        loop.run_until_complete(until_idle(queue))
        loop.close()
        assert len(self.told(caplog)) == 1


class TestThreadGuard:
    def test_lets_its_own_thread_pass(self):
        ThreadGuard("the body 'Tank'").check("notify_change")

    def test_names_both_threads_and_the_mend(self):
        guard = ThreadGuard("the body 'Tank'")
        errors = []

        def intrude():
            with pytest.raises(WrongThreadError) as info:
                guard.check("set_joint_positions")
            errors.append(str(info.value))

        thread = threading.Thread(target=intrude, name="executor")
        thread.start()
        thread.join()
        assert errors == [
            "set_joint_positions was called on the thread 'executor', but the body 'Tank' belongs to the thread "
            "'MainThread'. Post the call instead: call_later(f, message)."
        ]
