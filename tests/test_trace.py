"""The trace of messages and calls on their way from thread to thread."""

import asyncio
from concurrent.futures import ThreadPoolExecutor

import pytest
from loops import in_a_loop, until
from std_msgs.msg import String

from tutorial.handoff import CallQueue
from tutorial.ros.node_thread import NodeThread
from tutorial.trace import HandoffTrace


def run(scenario):
    """Run a scenario with a trace and a scope of a traced queue; return the trace's records."""

    async def main():
        trace = HandoffTrace()
        queue = CallQueue(asyncio.get_running_loop(), trace)
        scenario(trace, queue.scope("test"))
        while len(queue):
            await asyncio.sleep(0)
        return trace.handoffs()

    return asyncio.run(main())


def test_a_replaced_call_is_superseded_when_the_newer_one_is_posted():
    def scenario(trace, scope):
        for _ in range(3):
            with trace.receiving("/joy"):
                scope.call_latest("joy", list)

    first, second, third = handoffs = run(scenario)
    assert [handoff.outcome for handoff in handoffs] == ["superseded", "superseded", "applied"]
    assert (first.superseded, second.superseded) == (second.posted, third.posted)


def test_every_call_that_a_callback_posts_is_followed():
    def scenario(trace, scope):
        with trace.receiving("/quiet"):
            pass
        with trace.receiving("/joy"):
            scope.call_later(list)
            scope.call_later(list)
        scope.call_later(list)

    handled, first, second, third = run(scenario)
    assert handled.outcome == "handled"
    assert [handoff.outcome for handoff in (first, second, third)] == ["applied"] * 3
    assert first.received == second.received
    assert (second.topic, third.topic, third.received) == ("/joy", None, None)


def test_a_dropped_call_keeps_waiting():
    def scenario(trace, scope):
        scope.call_later(list)
        scope.close()

    (handoff,) = run(scenario)
    assert handoff.outcome == "waiting"


def test_a_failed_callback_is_finished():
    trace = HandoffTrace()
    with pytest.raises(ZeroDivisionError), trace.receiving("/joy"):
        raise ZeroDivisionError
    assert trace.handoffs()[0].handled is not None
    trace.post()
    assert trace.handoffs()[1].topic is None


def test_memory_is_bounded():
    trace = HandoffTrace(capacity=10)
    for i in range(100):
        with trace.receiving(f"/topic{i}"):
            pass
    assert [handoff.topic for handoff in trace.handoffs()] == [f"/topic{i}" for i in range(90, 100)]


def test_returned_records_do_not_change():
    trace = HandoffTrace()
    handoff = trace.post()
    (before,) = trace.handoffs()
    handoff.apply()
    assert (before.outcome, trace.handoffs()[0].outcome) == ("waiting", "applied")


def test_threads_do_not_mix_up_their_messages():
    trace = HandoffTrace()
    with ThreadPoolExecutor(1) as pool, trace.receiving("/joy"):
        pool.submit(trace.post).result()
    received, posted = trace.handoffs()
    assert (received.posted, posted.topic) == (None, None)


@in_a_loop
async def test_a_nodes_messages_are_traced_from_thread_to_thread(domain):
    trace, arrived = HandoffTrace(), asyncio.Event()
    scope = CallQueue(asyncio.get_running_loop(), trace).scope("test")
    with NodeThread("tester", trace=trace) as ros:
        ros.node.create_subscription(String, "x", lambda _: scope.call_later(arrived.set), 1)
        publisher = ros.node.create_publisher(String, "x", 1)
        await until(publisher.get_subscription_count)
        publisher.publish(String())
        await until(arrived.is_set)
    (handoff,) = trace.handoffs()
    assert (handoff.topic, handoff.outcome) == ("/x", "applied")
    moments = (handoff.received, handoff.posted, handoff.handled)
    assert [moment.thread for moment in (*moments, handoff.applied)] == ["executor"] * 3 + ["MainThread"]
    assert sorted(moments, key=lambda moment: moment.time) == list(moments)
    assert handoff.applied.time >= handoff.posted.time
