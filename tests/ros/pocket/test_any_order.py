"""Starting, spinning, destroying and shutting down in any order, from several threads at once.

Whatever the order, each call succeeds or raises rclpy's exception. There must be no other exception, no hang, no crash
when the interpreter exits, and no thread that is left running.
"""

import pytest

pytestmark = [pytest.mark.process, pytest.mark.pocket]
# rclpy 7.1.3 also raises unintended errors, such as "generator already executing"

PROGRAM = """
import faulthandler, random, sys, threading, traceback
faulthandler.dump_traceback_later(80, exit=True)

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future
from std_msgs.msg import Int32, String

SEED, STEPS, THREADS = int(sys.argv[1]), 300, 3
SAYINGS = ("Executor is already spinning", "Context.init() must only be called once", "Context must be initialized")
contexts, nodes, publishers, subscriptions, timers, executors = [None], [], [], [], [], []
unexpected, spinners = [], []


def keep(things, thing):
    things.append(thing)
    del things[:-6]


def is_expected(error):
    return type(error).__module__.startswith("rclpy.") or (
        isinstance(error, IndexError) and "empty sequence" in str(error)  # nothing of this kind has been made yet
        or type(error) is RuntimeError and str(error).startswith(SAYINGS)
    )


def start(r):
    context = Context()
    rclpy.init(args=[], context=context)
    contexts.append(context)


def spin_forever(node):
    try:
        rclpy.spin(node) if node is not None else None
    except BaseException as error:
        if not is_expected(error):
            unexpected.append(repr(error))


def spin_on_a_thread(r):
    spinners.append(threading.Thread(target=spin_forever, args=(r.choice(nodes),)))
    spinners[-1].start()


def call_back(r):
    # what a callback may do: anything but wait for itself
    step = r.choice([publish, destroy_publisher, destroy_subscription, destroy_timer, destroy_node, shutdown, ask])
    return lambda *_: attempt(step, r)


def init(r): rclpy.init(args=[])
def shutdown(r): rclpy.shutdown(context=r.choice(contexts))
def try_shutdown(r): rclpy.try_shutdown(context=r.choice(contexts))
def create_node(r): keep(nodes, rclpy.create_node(f"n{r.randrange(3)}", context=r.choice(contexts)))
def destroy_node(r): r.choice(nodes).destroy_node()
def create_publisher(r): keep(publishers, r.choice(nodes).create_publisher(r.choice([String, Int32]), "x", 10))
def create_subscription(r):
    keep(subscriptions, r.choice(nodes).create_subscription(String, "x", call_back(r), r.choice([1, 10])))
def create_timer(r): keep(timers, r.choice(nodes).create_timer(r.choice([0.0, 0.001]), call_back(r)))
def publish(r): (lambda publisher: publisher.publish(publisher.msg_type()))(r.choice(publishers))
def destroy_publisher(r): r.choice(nodes).destroy_publisher(r.choice(publishers))
def destroy_subscription(r): r.choice(subscriptions).destroy()
def destroy_timer(r): r.choice(timers).destroy()
def use_timer(r): (r.choice(timers).cancel if r.random() < 0.5 else r.choice(timers).reset)()
def ask(r):
    node = r.choice(nodes)
    node.get_topic_names_and_types(), node.get_node_names(), node.get_publishers_info_by_topic("x")
    r.choice(publishers).get_subscription_count(), node.get_logger().debug("x")
def create_executor(r): keep(executors, SingleThreadedExecutor(context=r.choice(contexts)))
def add_node(r): r.choice(executors).add_node(r.choice(nodes))
def remove_node(r): r.choice(executors).remove_node(r.choice(nodes))
def stop_executor(r): r.choice(executors).shutdown(timeout_sec=0.01)
def spin_once(r): rclpy.spin_once(r.choice(nodes), timeout_sec=0.005)
def spin_executor(r): r.choice(executors).spin_once(timeout_sec=0.005)
def spin_until(r):
    future = Future()
    r.choice(nodes).create_timer(0.001, lambda: future.set_result(None))
    rclpy.spin_until_future_complete(r.choice(nodes), future, timeout_sec=0.02)


ALL_STEPS = [
    init, init, start, shutdown, try_shutdown, create_node, create_node, create_node, destroy_node, create_publisher,
    create_publisher, create_subscription, create_subscription, create_timer, publish, publish, destroy_publisher,
    destroy_subscription, destroy_timer, use_timer, ask, create_executor, add_node, remove_node, stop_executor,
    spin_once, spin_once, spin_executor, spin_until, spin_on_a_thread,
]


def attempt(step, r):
    try:
        step(r)
    except BaseException as error:
        if not is_expected(error):
            unexpected.append(f"{step.__name__}: {traceback.format_exc()}")


def work(seed):
    r = random.Random(seed)
    for _ in range(STEPS):
        attempt(r.choice(ALL_STEPS), r)


threads = [threading.Thread(target=work, args=(SEED * 100 + number,)) for number in range(THREADS)]
for thread in threads:
    thread.start()
work(SEED * 100 + 99)
for thread in threads:
    thread.join()
while any(thread.is_alive() for thread in spinners):
    for context in [*contexts, *(node.context for node in nodes)]:
        rclpy.try_shutdown(context=context)
    for thread in spinners:
        thread.join(0.05)
print("unexpected:", *unexpected, sep="\\n")
print("threads:", [thread.name for thread in threading.enumerate()])
for context in contexts if SEED % 2 else ():  # else the end of the interpreter shuts down
    rclpy.try_shutdown(context=context)
"""


@pytest.mark.parametrize("seed", range(6))
def test_any_order(seed, start):
    process = start(PROGRAM, str(seed))
    output, errors = process.communicate(timeout=100)
    assert (output, process.returncode) == ("unexpected:\nthreads: ['MainThread']\n", 0), errors
    assert "Traceback" not in errors
    assert "Fatal" not in errors
