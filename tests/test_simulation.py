"""The simulated copy: stepped at once or in real time, and used by controllers through their io."""

import _thread
import re
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from programs import TIMEOUT, until

from tutorial import simulation as simulation_module
from tutorial.body import Body
from tutorial.controller import SimpleController
from tutorial.errors import RefusedError, TutorialError
from tutorial.model.mujoco_warnings import mujoco_warns
from tutorial.simulation import ControllerError, Simulation, State
from tutorial.world import Placement

TANK = Placement("Tank", Path(__file__).parent.parent / "project" / "models" / "tank.xml", (0.0, 0.0, 1.0))


class Recorder(SimpleController):
    """Records its calls and threads. A subclass can act in one of its methods."""

    def __init__(self, method=None):
        self.method = method
        self.calls, self.times, self.threads = [], [], set()

    def initialize(self, io):
        self.io = io
        self.calls.append("initialize")
        self.perhaps("initialize")

    def control(self):
        self.times.append(self.io.time)
        self.threads.add(threading.current_thread().name)
        self.perhaps("control")

    def stop(self):
        self.calls.append("stop")
        self.perhaps("stop")

    def perhaps(self, method):
        if method == self.method:
            self.act()


def simulate(*controllers):
    return Simulation([TANK], [("Tank", each) for each in controllers])


@pytest.fixture
def recorder():
    recorder = Recorder()
    recorder.simulation = simulate(recorder)
    yield recorder
    recorder.simulation.stop()


class TestAdvance:
    def test_control_runs_before_every_step_and_advance_continues(self, recorder):
        recorder.simulation.advance(0.003)
        recorder.simulation.advance(0.002)
        assert recorder.times == [0.0, 0.001, 0.002, 0.003, 0.004]
        assert recorder.calls == ["initialize"]
        assert recorder.threads == {"MainThread"}
        assert (recorder.simulation.step, recorder.simulation.time) == (5, 0.005)
        recorder.simulation.advance(0.995)
        assert recorder.io.time_ns == 999_000_000, "an exact multiple of the step"

    def test_a_controller_that_cannot_start_is_tried_again(self, recorder):
        class Unready(Recorder):
            def act(self):
                if len(self.calls) == 1:
                    raise ValueError("mine")

        unready = Unready("initialize")
        simulation = simulate(recorder, unready)
        with pytest.raises(ControllerError, match="Unready failed at"):
            simulation.advance(0.001)
        assert recorder.calls == ["initialize", "stop"], "a started controller is stopped"
        assert unready.calls == ["initialize"], "a controller that did not start is not stopped"
        simulation.advance(0.001)
        assert (simulation.state, simulation.error) == (State.IDLE, None)
        simulation.stop()
        assert recorder.times == unready.times == [0.0]
        assert recorder.calls == ["initialize", "stop"] * 2

    def test_displayed_bodies_move_to_the_copy_which_is_reproducible(self):
        simulation = Simulation([TANK])
        shown = Body.displayed(TANK)
        assert np.array_equal(shown.qpos, simulation.bodies["Tank"].qpos)
        simulation.advance(0.2)
        assert not np.array_equal(shown.qpos, simulation.bodies["Tank"].qpos), "it is a copy"
        assert simulation.copy_to([shown]) == 0.2
        assert np.array_equal(shown.qpos, simulation.bodies["Tank"].qpos)
        again = Simulation([TANK])
        again.advance(0.2)
        assert np.array_equal(shown.qpos, again.snapshot.get().qpos)


class TestRealTime:
    def test_it_keeps_pace_stops_at_its_duration_and_continues(self, recorder):
        began = time.monotonic()
        recorder.simulation.start(0.5)
        until(lambda: not recorder.simulation.running)
        assert time.monotonic() - began >= 0.48
        assert recorder.simulation.step == 500
        recorder.simulation.start(0.01)
        until(lambda: not recorder.simulation.running)
        recorder.simulation.stop()
        assert recorder.simulation.step == 510
        assert recorder.threads == {"simulation"}
        assert recorder.calls[-2:] == ["initialize", "stop"]

    def test_impossible_calls_are_refused_and_stop_leaves_nothing(self, recorder):
        simulation, before = recorder.simulation, sys.getswitchinterval()
        simulation.start()
        for call, said in (
            (simulation.start, "already running"),
            (lambda: simulation.advance(1.0), r"Call stop\(\) before advance"),
            (lambda: simulation.advance(-1.0), "time cannot run backwards"),
        ):
            with pytest.raises(TutorialError, match=said):
                call()
        until(lambda: simulation.step > 0)
        assert sys.getswitchinterval() < before
        simulation.stop()
        simulation.stop()
        assert "simulation" not in [thread.name for thread in threading.enumerate()]
        assert not simulation.running
        assert sys.getswitchinterval() == before

    @pytest.mark.parametrize(("steps", "said"), [(40, []), (36, ["0.94", "0.90"]), (10, ["0.30", "0.25"])])
    def test_a_slow_machine_is_reported(self, steps, said, caplog, monkeypatch):
        now = 100.0
        monkeypatch.setattr(simulation_module.time, "perf_counter", lambda: now)
        pace, step = simulation_module._Pace(7000, 0.001), 7000
        assert pace.steps_due(step) == 0
        for turn in range(1, 256):
            now = 100.0 + 0.04 * turn
            assert 39 <= pace.steps_due(step) <= 100
            step += steps
        assert [text.split("the simulation runs at ")[1] for text in caplog.messages] == [
            f"{ratio} times real time" for ratio in said
        ]


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e300])
def test_a_state_with_nan_is_reported_once_and_leaves_no_file(value, tmp_path, monkeypatch, caplog, capfd):
    class Wild(Recorder):
        def act(self):
            self.io.body.actuator("TRACK_L").ctrl = value
            self.io.body.joint("TURRET_Y").effort = value
            self.io.body.data.qfrc_applied[:] = value

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(mujoco_warns, "_due", 0.0)
    simulation = simulate(Wild("control"))
    simulation.advance(0.1)
    assert np.isfinite(simulation.snapshot.get().qpos).all()
    (said,) = caplog.messages
    assert said.startswith("MuJoCo: Nan, Inf or huge value in ")
    assert list(tmp_path.iterdir()) == []
    assert "unstable" not in capfd.readouterr().err


class Raising(Recorder):
    """Raises the given exception in the given method; in control at the fourth step."""

    def __init__(self, kind, method):
        super().__init__(method)
        self.kind = kind

    def act(self):
        if self.method != "control" or self.io.step == 3:
            raise self.kind("mine")


@pytest.mark.parametrize("kind", [ValueError, SystemExit, KeyboardInterrupt, GeneratorExit])
class TestFailingController:
    @pytest.mark.parametrize(("method", "when"), [("initialize", "0.000"), ("control", "0.003")])
    def test_advance_raises_it_and_the_thread_logs_it(self, kind, method, when, caplog):
        simulation = simulate(Raising(kind, method))
        said = rf"^Raising failed at {when} s of simulated time: test_simulation\.py, line \d+, in act: {kind.__name__}"
        with pytest.raises(ControllerError, match=said) as info:
            simulation.advance(0.05)
        assert simulation.error is info.value
        assert isinstance(info.value.__cause__, kind)
        assert (simulation.state, caplog.messages) == (State.FAILED, [])
        simulation.start(0.05)
        until(lambda: not simulation.running)
        assert simulation.state is State.FAILED
        assert isinstance(simulation.error.__cause__, kind)
        assert caplog.messages == [str(simulation.error)] == [str(info.value)]
        simulation.stop()

    def test_an_error_in_stop_is_kept_and_the_rest_are_stopped(self, kind, caplog):
        after = Recorder()
        simulation = simulate(Raising(kind, "stop"), after)
        simulation.advance(0.001)
        simulation.stop()
        assert str(simulation.error).endswith(f", in act: {kind.__name__}: mine")
        assert simulation.state is State.FAILED
        assert str(simulation.error) in caplog.text
        assert after.calls == ["initialize", "stop"]

    def test_an_error_on_release_is_kept_and_the_simulation_goes_on(self, kind):
        simulation = simulate(Raising(kind, "stop"))
        simulation.start()
        until(lambda: simulation.step)
        simulation.release("Tank")
        assert simulation.running
        simulation.stop()
        assert simulation.state is State.FAILED
        assert str(simulation.error).endswith(f", in act: {kind.__name__}: mine")


def test_an_interrupted_advance_can_be_continued():
    def interrupt():
        until(lambda: simulation.step)
        _thread.interrupt_main()

    simulation = Simulation([TANK])
    other = threading.Thread(target=interrupt)
    other.start()
    with pytest.raises(KeyboardInterrupt):
        simulation.advance(1_000_000)
    other.join()
    assert simulation.state is State.IDLE
    step = simulation.step
    simulation.advance(0.001)
    assert simulation.step == step + 1


def test_the_last_simulation_restores_the_switch_interval():
    before = sys.getswitchinterval()
    first, second = Simulation([TANK]), Simulation([TANK])
    first.start()
    second.start()
    until(lambda: first.step and second.step)
    first.stop()
    until(lambda: sys.getswitchinterval() < before, "the second one, which is still running")
    second.stop()
    assert sys.getswitchinterval() == before


class Stuck(Recorder):
    """Hangs in one of its methods until the test releases it."""

    def __init__(self, method="control"):
        super().__init__(method)
        self.there, self.let = threading.Event(), threading.Event()
        self.simulation = simulate(self)

    def act(self):
        self.there.set()
        self.let.wait(60)

    def start(self):
        self.simulation.start()
        assert self.there.wait(TIMEOUT)


@pytest.fixture
def stuck(monkeypatch):
    """A hanging controller, in a simulation that waits for it only a moment."""
    monkeypatch.setattr("tutorial.simulation.STUCK", 0.05)
    controller = Stuck()
    yield controller
    controller.let.set()
    until(lambda: "simulation" not in [thread.name for thread in threading.enumerate()])


SAID = r"Stuck does not return: it is at test_simulation\.py, line \d+, in act\. Fix the code, then open the program"


CALLS = {"advance": (0.01,), "start": (), "release": ("Tank",)}


class TestHangingController:
    @pytest.mark.parametrize("method", ["initialize", "control", "stop"])
    @pytest.mark.parametrize("call", ["release", "stop"])
    def test_stopping_does_not_wait_forever(self, stuck, call, method, monkeypatch):
        stuck.method = method
        if method == "stop":
            stuck.simulation.advance(0.001)
            monkeypatch.setattr("tutorial.simulation.STUCK", 1.0)  # reaching the method may take this long
        else:
            stuck.start()
        with nullcontext() if call == "stop" else pytest.raises(ControllerError, match=SAID):
            getattr(stuck.simulation, call)(*CALLS.get(call, ()))
        assert stuck.simulation.state is State.ABANDONED

    def test_it_and_its_simulation_are_abandoned_with_an_error(self, stuck, caplog):
        simulation = stuck.simulation
        stuck.start()
        simulation.stop()
        simulation.stop()
        assert caplog.text.count("Stuck does not return") == 1
        error, snapshot = simulation.error, simulation.snapshot.get()
        for call, given in CALLS.items():
            with pytest.raises(ControllerError, match=SAID):
                getattr(simulation, call)(*given)
        assert not simulation.running
        stuck.let.set()
        until(lambda: "simulation" not in [thread.name for thread in threading.enumerate()])
        assert (simulation.error, simulation.state) == (error, State.ABANDONED)
        assert "Stuck does not return" in str(error)
        assert simulation.snapshot.get() is snapshot
        assert simulation.step == simulation.world.data.time == 0.0
        assert stuck.calls == ["initialize"]

    def test_only_the_advancing_thread_waits(self, stuck):
        with ThreadPoolExecutor(1) as pool:
            advancing = pool.submit(stuck.simulation.advance, 1.0)
            assert stuck.there.wait(TIMEOUT)
            stuck.simulation.stop()
            assert stuck.simulation.state is State.ABANDONED
            stuck.let.set()
            with pytest.raises(ControllerError, match=SAID):
                advancing.result(TIMEOUT)


def test_releasing_a_body_and_stopping_an_advance_from_another_thread(recorder):
    def release():
        until(lambda: recorder.times)
        recorder.simulation.release("Tank")
        asked = len(recorder.times)
        step = recorder.simulation.step
        until(lambda: recorder.simulation.step > step + 50)
        recorder.simulation.stop()
        return asked

    with ThreadPoolExecutor(1) as pool:
        released = pool.submit(release)
        with pytest.raises(TutorialError, match=r"another thread stopped advance\(1000000\) at \d+\.\d+ s"):
            recorder.simulation.advance(1_000_000)
    assert recorder.simulation.state is State.IDLE
    assert released.result() == len(recorder.times)
    assert recorder.calls == ["initialize", "stop"]


@pytest.mark.parametrize("method", ["control", "stop"])
def test_a_controller_cannot_wait_for_itself(method):
    class Waits(Recorder):
        def act(self):
            simulation.stop()

    simulation = simulate(Waits(method))
    simulation.start(0.01)
    until(lambda: not simulation.running)
    simulation.stop()
    assert r"stop() was called by a controller" in str(simulation.error)


class TestRequests:
    def test_a_running_simulation_answers_between_two_steps(self, recorder):
        ask = recorder.simulation.world.requests.ask
        with pytest.raises(RefusedError, match="is not running"):
            ask(print)
        recorder.simulation.start()
        step, steps, thread = ask(lambda: (recorder.simulation.step, len(recorder.times), threading.current_thread()))
        assert (step, thread.name) == (steps, "simulation")
        recorder.simulation.stop()
        with pytest.raises(RefusedError, match="is not running"):
            ask(print)

    def test_an_advancing_thread_answers_too(self, recorder):
        def ask():
            until(lambda: recorder.simulation.step)
            try:
                return recorder.simulation.world.requests.ask(threading.current_thread)
            finally:
                recorder.simulation.stop()

        with ThreadPoolExecutor(1) as pool:
            asked = pool.submit(ask)
            with pytest.raises(TutorialError, match="stopped advance"):
                recorder.simulation.advance(1_000_000)
        assert asked.result() is threading.main_thread()

    def test_a_failure_is_the_reason_of_the_refusal(self):
        simulation = simulate(Raising(ValueError, "control"))
        with pytest.raises(ControllerError):
            simulation.advance(0.05)
        with pytest.raises(RefusedError, match=r"the simulation has stopped: Raising failed at 0\.003 s .*: mine"):
            simulation.world.requests.ask(print)

    def test_a_hanging_controller_is_the_reason_of_the_refusal(self, stuck):
        requests = stuck.simulation.world.requests
        stuck.start()
        with ThreadPoolExecutor(1) as pool:
            asked = pool.submit(requests.ask, print, timeout=TIMEOUT)
            until(lambda: requests._waiting)
            stuck.simulation.stop()
            assert re.match(SAID, str(asked.exception()))
        with pytest.raises(RefusedError, match=SAID):
            requests.ask(print)

    def test_a_hanging_request_is_blamed(self, stuck):
        simulation = simulate(Recorder())
        simulation.start()
        with pytest.raises(RefusedError, match="was started"):
            simulation.world.requests.ask(stuck.let.wait, timeout=0.05)
        simulation.stop()
        assert re.match(r"MuJoCo or a request does not return: it is at threading.py", str(simulation.error))
