"""A watched node, on a real ROS 2: it records its callbacks, and finds those that wait for themselves."""

import gc
import time
from contextlib import ExitStack
from functools import partial

import pytest

pytest.importorskip("std_srvs.srv", reason="the pocket ROS 2 has no services: see make test-ros2")

from loops import in_a_loop, until
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from std_srvs.srv import Trigger

from tutorial.ros.node_thread import SpinThread
from tutorial.ros.watched_node import DeadlockError, WatchedNode

TWO = partial(MultiThreadedExecutor, num_threads=2)


class Relay:
    """Answers a request with the response of a second service."""

    def __init__(self, stack, callback, executor=SingleThreadedExecutor, group=None):
        self.other = stack.enter_context(SpinThread(WatchedNode, "other"))
        self.thread = stack.enter_context(SpinThread(WatchedNode, "relay", executor=executor))
        self.node = self.thread.node
        stack.callback(self.node.end_deadlocks)
        self.other.node.create_service(Trigger, "/second", lambda _, response: response)
        self.second = self.node.create_client(Trigger, "/second", callback_group=group)
        self.node.create_service(Trigger, "/first", getattr(self, callback))
        self.node.create_timer(0.02, self.on_tick, callback_group=MutuallyExclusiveCallbackGroup())
        self.first = self.other.node.create_client(Trigger, "/first")

    async def ask(self):
        await until(lambda: self.second.service_is_ready() and self.first.service_is_ready())
        return self.first.call_async(Trigger.Request())

    def on_tick(self):
        pass

    def call(self, request, _response):
        return self.second.call(request)

    async def wait(self, request, _response):
        return await self.second.call_async(request)

    def spans(self, label):
        return [span for span in self.node.spans if span.label == label]


CALL = "call waits in call() for the response of /second"
OCCUPIED = "Nobody can receive the response: {} occupies the client's callback group until it returns."
ALONE = f"{CALL}, on the thread 'executor'. Only this thread can receive the response."


@pytest.mark.parametrize(
    ("callback", "executor", "group", "text"),
    [
        ("call", SingleThreadedExecutor, None, ALONE),
        ("call", SingleThreadedExecutor, ReentrantCallbackGroup, ALONE),
        ("call", TWO, None, f"{CALL}. {OCCUPIED.format('call')}"),
        ("wait", SingleThreadedExecutor, None, f"wait awaits the response of /second. {OCCUPIED.format('wait')}"),
        ("wait", TWO, None, f"wait awaits the response of /second. {OCCUPIED.format('wait')}"),
    ],
)
@in_a_loop
async def test_a_deadlock_is_explained_and_ended(callback, executor, group, text, domain):
    with ExitStack() as stack:
        relay = Relay(stack, callback, executor, group and group())
        response = await relay.ask()
        await until(relay.node.deadlocks)
        assert [*relay.node.deadlocks().values()] == [text]
        relay.node.end_deadlocks()
        await until(lambda: relay.thread.error)
        assert isinstance(relay.thread.error, DeadlockError)
        assert str(relay.thread.error) == text
        assert not relay.node.deadlocks()
        assert not response.done()


@pytest.mark.parametrize(("callback", "executor"), [("call", TWO), ("wait", SingleThreadedExecutor), ("wait", TWO)])
@in_a_loop
async def test_a_repaired_callback_answers(callback, executor, domain):
    with ExitStack() as stack:
        relay = Relay(stack, callback, executor, MutuallyExclusiveCallbackGroup())
        response = await relay.ask()
        await until(response.done)
        assert not relay.node.deadlocks()
        kinds = [span.kind for span in relay.spans(callback)]
        assert kinds == (["runs", "call()"] if callback == "call" else ["runs", "await", "runs"])
        assert all(span.ended for span in relay.spans(callback))


@in_a_loop
async def test_done_callbacks_are_recorded_and_rclpys_own_are_not(domain):
    with ExitStack() as stack:
        relay = Relay(stack, "call")
        await relay.ask()
        await until(relay.node.deadlocks)

        def on_done(future):
            pass

        relay.second.call_async(Trigger.Request()).add_done_callback(on_done)
        relay.node.end_deadlocks()
        await until(lambda: relay.spans("on_done"))
        assert {span.label for span in relay.node.spans} == {"on_tick", "call", "on_done"}


def test_closing_waits_for_all_threads_of_the_executor(domain, capfd):
    def tick():
        time.sleep(0.003)

    for _ in range(5):
        with SpinThread(WatchedNode, "busy", executor=TWO) as thread:
            for _ in range(3):
                thread.node.create_timer(0.001, tick, callback_group=ReentrantCallbackGroup())
            time.sleep(0.03)
        del thread
        gc.collect()
    assert capfd.readouterr().err == ""
