"""The simulated copy: stepped at once or in real time, and seen by controllers through their io."""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from tutorial.body import Body
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError
from tutorial.simulation import ControllerError, Simulation
from tutorial.world import Placement

TANK = Placement("Tank", Path(__file__).parent.parent / "project" / "models" / "tank.xml", (0.0, 0.0, 1.0))


class Recorder(SimpleController):
    """Writes down what it is asked for, and where."""

    def __init__(self):
        self.calls = []
        self.times = []
        self.threads = set()

    def initialize(self, io):
        self.io = io
        self.calls.append("initialize")

    def control(self):
        self.times.append(self.io.time)
        self.threads.add(threading.current_thread().name)

    def stop(self):
        self.calls.append("stop")


def until(condition, seconds=20.0):
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.005)


class TestAdvance:
    def test_asks_for_control_before_every_step(self):
        recorder = Recorder()
        simulation = Simulation([TANK], [("Tank", recorder)])
        simulation.advance(0.005)
        assert recorder.times == [0.0, 0.001, 0.002, 0.003, 0.004]
        assert recorder.calls == ["initialize"]
        assert recorder.threads == {"MainThread"}
        assert (simulation.step, simulation.time) == (5, 0.005)

    def test_goes_on_where_it_was(self):
        recorder = Recorder()
        simulation = Simulation([TANK], [("Tank", recorder)])
        simulation.advance(0.002)
        simulation.advance(0.001)
        assert recorder.times == [0.0, 0.001, 0.002]

    def test_repeats_itself_to_the_bit(self):
        states = []
        for _ in range(2):
            simulation = Simulation([TANK])
            simulation.advance(0.3)
            states.append(simulation.snapshot.get().qpos)
        assert np.array_equal(*states)

    def test_time_is_an_exact_multiple_of_the_step(self):
        recorder = Recorder()
        simulation = Simulation([TANK], [("Tank", recorder)])
        simulation.advance(1.0)
        assert recorder.io.time_ns == 999_000_000

    def test_time_does_not_go_back(self):
        with pytest.raises(TutorialError, match="time does not go back"):
            Simulation([TANK]).advance(-1.0)

    def test_an_exception_in_a_controller_is_named_with_its_time_and_keeps_its_cause(self):
        class Broken(Recorder):
            def control(self):
                if self.io.step == 3:
                    raise ValueError("mine")

        simulation = Simulation([TANK], [("Tank", Broken())])
        said = (
            r"Broken failed at 0\.003 s of simulated time: test_simulation\.py, line \d+, in control: ValueError: mine"
        )
        with pytest.raises(ControllerError, match=said) as info:
            simulation.advance(1.0)
        assert isinstance(info.value.__cause__, ValueError)

    def test_a_controller_that_cannot_start_is_asked_again_at_the_next_start(self):
        class Unready(Recorder):
            def initialize(self, io):
                super().initialize(io)
                if len(self.calls) == 1:
                    raise ValueError("mine")

        first, unready = Recorder(), Unready()
        simulation = Simulation([TANK], [("Tank", first), ("Tank", unready)])
        with pytest.raises(ControllerError, match="Unready failed at"):
            simulation.advance(0.001)
        assert first.calls == ["initialize", "stop"], "what was ready is let go"
        assert unready.calls == ["initialize"], "what never was ready is not stopped"
        simulation.advance(0.001)
        simulation.stop()
        assert first.times == unready.times == [0.0]
        assert first.calls == ["initialize", "stop"] * 2


class TestRealTime:
    def test_keeps_pace_and_stops_at_the_duration_to_the_step(self):
        recorder = Recorder()
        simulation = Simulation([TANK], [("Tank", recorder)])
        began = time.monotonic()
        simulation.start(0.3)
        assert simulation.wait(20)
        assert time.monotonic() - began >= 0.28
        simulation.stop()
        assert simulation.step == 300
        assert recorder.threads == {"simulation"}
        assert recorder.calls == ["initialize", "stop"]

    def test_puts_the_switch_interval_back(self):
        before = sys.getswitchinterval()
        simulation = Simulation([TANK])
        simulation.start()
        until(lambda: sys.getswitchinterval() != before)
        simulation.stop()
        assert sys.getswitchinterval() == before

    def test_leaves_no_thread_and_stops_twice(self):
        simulation = Simulation([TANK])
        simulation.start()
        until(lambda: simulation.step > 0)
        simulation.stop()
        simulation.stop()
        assert "simulation" not in [thread.name for thread in threading.enumerate()]
        assert not simulation.running

    def test_starts_again_where_it_stopped(self):
        recorder = Recorder()
        simulation = Simulation([TANK], [("Tank", recorder)])
        simulation.start(0.01)
        simulation.wait()
        simulation.start(0.01)
        simulation.wait()
        simulation.stop()
        assert simulation.step == 20

    def test_restart_goes_back_to_the_beginning_and_goes_on(self):
        recorder = Recorder()
        simulation = Simulation([TANK], [("Tank", recorder)])
        initial = simulation.snapshot.get().qpos
        simulation.start()
        until(lambda: simulation.step > 50)
        simulation.restart()
        assert simulation.running
        simulation.stop()
        assert recorder.calls == ["initialize", "stop", "initialize", "stop"]
        simulation.restart()
        assert simulation.step == 0
        assert np.array_equal(simulation.snapshot.get().qpos, initial)
        assert not simulation.running

    def test_restarted_it_still_ends_after_its_duration(self):
        simulation = Simulation([TANK])
        simulation.start(0.2)
        simulation.restart()
        assert simulation.wait(20)
        simulation.stop()
        assert simulation.step == 200

    def test_running_it_twice_is_an_error_that_says_the_mend(self):
        simulation = Simulation([TANK])
        simulation.start()
        try:
            with pytest.raises(TutorialError, match="running already"):
                simulation.start()
            with pytest.raises(TutorialError, match="Call stop\\(\\) before advance"):
                simulation.advance(1.0)
        finally:
            simulation.stop()

    def test_an_exception_in_a_controller_stops_it_and_is_kept(self):
        class Broken(Recorder):
            def control(self):
                raise ValueError("mine")

        simulation = Simulation([TANK], [("Tank", Broken())])
        simulation.start()
        assert simulation.wait(20)
        assert "Broken failed" in str(simulation.error)
        simulation.stop()

    def test_says_when_the_machine_cannot_keep_up(self, caplog, monkeypatch):
        class Slow(Recorder):
            def control(self):
                time.sleep(0.004)

        monkeypatch.setattr("tutorial.simulation.REPORT_EVERY", 0.5)
        simulation = Simulation([TANK], [("Tank", Slow())])
        simulation.start()
        until(lambda: "can't keep up" in caplog.text)
        simulation.stop()
        ratio = float(caplog.text.split("runs at ")[1].split()[0])
        assert ratio < 0.95

    def test_a_released_bodys_controllers_are_asked_no_more(self):
        recorder = Recorder()
        simulation = Simulation([TANK], [("Tank", recorder)])
        simulation.start()
        until(lambda: recorder.times)
        simulation.release("Tank")
        asked = len(recorder.times)
        step = simulation.step
        until(lambda: simulation.step > step + 50)
        simulation.stop()
        assert len(recorder.times) == asked
        assert recorder.calls == ["initialize", "stop"]


def test_displayed_bodies_are_moved_to_where_the_copy_is():
    simulation = Simulation([TANK])
    shown = Body.displayed(TANK)
    assert np.array_equal(shown.qpos, simulation.bodies["Tank"].qpos)
    simulation.advance(0.2)
    assert not np.array_equal(shown.qpos, simulation.bodies["Tank"].qpos), "it is a copy"
    assert simulation.copy_to([shown]) == 0.2
    assert np.array_equal(shown.qpos, simulation.bodies["Tank"].qpos)
