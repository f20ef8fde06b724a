"""What takes long for a good reason is not blamed, and what never ends is, on whatever thread it runs."""

from __future__ import annotations

import asyncio
import contextlib
import io
import threading

import pytest

from tutorial.checks.drive import GentleTank, drive
from tutorial.checks.publish import SlowPublisher, publish

pytestmark = pytest.mark.process


class LocksAllOfControl(GentleTank):
    def configure(self, config):
        super().configure(config)
        self.lock = threading.Lock()

    def on_joy(self, message):
        with self.lock:
            self.joy.put(message)

    def control(self):
        with self.lock:
            super().control()


class LoopsInATimer(SlowPublisher):
    def configure(self, config):
        self.node = config.node
        super().configure(config)
        config.node.create_timer(0.001, self.tick)

    def tick(self):
        while True:
            pass


class RaisesInATimer(SlowPublisher):
    def configure(self, config):
        self.node = config.node
        super().configure(config)
        config.node.create_timer(0.001, self.tick)

    def tick(self):
        raise ValueError("no tick today")


def said_about(exercise, answer):
    with contextlib.redirect_stdout(io.StringIO()) as text:
        asyncio.run(exercise.check(answer))
    return text.getvalue()


def test_a_lock_around_all_of_control_is_a_right_answer():
    assert "All right." in said_about(drive, LocksAllOfControl)


def test_a_loop_in_a_timers_callback_is_named():
    said = said_about(publish, LoopsInATimer)
    assert "✗ tick does not return" in said
    assert "in tick, line " in said


def test_a_timers_callback_that_raises_is_named():
    assert "✗ tick raised ValueError: no tick today" in said_about(publish, RaisesInATimer)
