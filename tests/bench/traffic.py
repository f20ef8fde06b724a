"""Measure how messages travel between two processes: with our node, plain Cyclone DDS Python, or the real rclpy.

``traffic.py publish|subscribe node|plain beat|flood|cost`` runs one end. Every publisher sends the same message
reliably: 100 times a second, stamped with the time, or as fast as it can, to count the messages that arrive.
"""

import statistics
import sys
import time
from importlib import import_module
from typing import Any

MESSAGES = 300
WARM_UP = 50
PERIOD = 0.01  # [s]
FLOOD = 2.0  # [s] how long messages are counted


def publish(kind: str, pace: str) -> None:
    """Publish until killed. A flood is serialized in advance, so the receiver is the slower side."""
    message, serialized, send, listeners = import_module(kind).publisher()
    message.name, message.position = ["TURRET_Y", "TURRET_P"], [0.1, 0.2]
    message.velocity = message.effort = message.position
    while not listeners():
        time.sleep(0.01)
    while True:
        time.sleep(PERIOD)
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
        if pace != "beat":
            made = serialized(message)
            while True:
                send(made)
        send(message)


def subscribe(kind: str, pace: str) -> None:
    """Print the median age of a message, or the real time or this thread's processor time per message [s]."""
    ages: list[int] = []  # [ns]
    began = began_cpu = 0.0

    def add(message: Any) -> None:
        nonlocal began, began_cpu
        if not ages:
            began, began_cpu = time.monotonic(), time.thread_time()
        stamp = message.header.stamp
        ages.append(time.time_ns() - stamp.sec * 1_000_000_000 - stamp.nanosec)

    wait = import_module(kind).subscriber(add)
    while not ages or (len(ages) < MESSAGES if pace == "beat" else time.monotonic() < began + FLOOD):
        wait()
    took = time.thread_time() - began_cpu if pace == "cost" else time.monotonic() - began
    print(statistics.median(ages[WARM_UP:]) / 1e9 if pace == "beat" else took / len(ages))


if __name__ == "__main__":
    {"publish": publish, "subscribe": subscribe}[sys.argv[1]](*sys.argv[2:])
