"""The simulated copy: stepped at once or in real time, and seen by controllers through their io."""

from __future__ import annotations

import _thread
import random
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from unruly import Unruly

from tutorial.body import Body
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError, mujoco_warns
from tutorial.simulation import ControllerError, Simulation, State
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


class TestUnstable:
    """A state that is no number: MuJoCo goes back to the beginning, and says so in our log instead of a file."""

    @pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e300])
    def test_is_said_once_and_leaves_no_file(self, value, tmp_path, monkeypatch, caplog, capfd):
        class Wild(Recorder):
            def control(self):
                self.io.body.actuator("TRACK_L").ctrl = value
                self.io.body.joint("TURRET_Y").effort = value
                self.io.body.data.qfrc_applied[:] = value

        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(mujoco_warns, "_due", 0.0)
        simulation = Simulation([TANK], [("Tank", Wild())])
        simulation.advance(0.1)
        assert np.isfinite(simulation.snapshot.get().qpos).all()
        (said,) = caplog.messages
        assert said.startswith("MuJoCo: Nan, Inf or huge value in ")
        assert list(tmp_path.iterdir()) == []
        assert "unstable" not in capfd.readouterr().err

    def test_a_log_that_fails_does_not_end_the_process(self, monkeypatch):
        monkeypatch.setattr(mujoco_warns, "_due", 0.0)
        monkeypatch.setattr("tutorial.errors._log", None)
        mujoco_warns("nobody hears it")


class Acting(Recorder):
    """Acts in one of its methods."""

    def __init__(self, method):
        super().__init__()
        self.method = method

    def initialize(self, io):
        super().initialize(io)
        self.perhaps("initialize")

    def control(self):
        super().control()
        self.perhaps("control")

    def stop(self):
        super().stop()
        self.perhaps("stop")

    def perhaps(self, method):
        if method == self.method:
            self.act()


class Raising(Acting):
    """Raises what it is given, in the method it is given."""

    def __init__(self, kind, method):
        super().__init__(method)
        self.kind = kind

    def act(self):
        raise self.kind


@pytest.mark.parametrize("kind", [ValueError, SystemExit, KeyboardInterrupt, GeneratorExit])
class TestWhateverAControllerRaises:
    @pytest.mark.parametrize("method", ["initialize", "control"])
    def test_is_told_with_its_place_and_logged_by_the_thread(self, kind, method, caplog):
        simulation = Simulation([TANK], [("Tank", Raising(kind, method))])
        simulation.start(0.05)
        assert simulation.wait(20)
        assert simulation.state is State.FAILED
        assert "Raising failed at 0.000 s of simulated time: test_simulation.py, line " in str(simulation.error)
        assert str(simulation.error).endswith(f", in act: {kind.__name__}")
        assert isinstance(simulation.error.__cause__, kind)
        assert [record.getMessage() for record in caplog.records] == [str(simulation.error)]
        simulation.stop()

    @pytest.mark.parametrize("method", ["initialize", "control"])
    def test_is_raised_by_advance_and_kept(self, kind, method):
        simulation = Simulation([TANK], [("Tank", Raising(kind, method))])
        with pytest.raises(ControllerError, match=f"in act: {kind.__name__}$") as info:
            simulation.advance(0.05)
        assert simulation.error is info.value
        assert simulation.state is State.FAILED

    def test_when_it_is_stopped_is_kept_and_logged_and_the_others_are_stopped(self, kind, caplog):
        after = Recorder()
        simulation = Simulation([TANK], [("Tank", Raising(kind, "stop")), ("Tank", after)])
        simulation.advance(0.001)
        simulation.stop()
        assert str(simulation.error).endswith(f", in act: {kind.__name__}")
        assert str(simulation.error) in caplog.text
        assert after.calls == ["initialize", "stop"]


def test_after_a_failure_it_may_be_run_again():
    controller = Raising(ValueError, "control")
    simulation = Simulation([TANK], [("Tank", controller)])
    with pytest.raises(ControllerError):
        simulation.advance(0.001)
    controller.method = None
    simulation.advance(0.001)
    assert (simulation.state, simulation.error, simulation.step) == (State.IDLE, None, 1)


def test_the_readers_own_interrupt_of_advance_passes_and_it_can_go_on():
    def interrupt():
        until(lambda: simulation.step)
        _thread.interrupt_main()

    simulation = Simulation([TANK])
    other = threading.Thread(target=interrupt)
    other.start()
    with pytest.raises(KeyboardInterrupt):
        simulation.advance(1_000_000)
    other.join(20)
    assert simulation.state is State.IDLE
    step = simulation.step
    simulation.advance(0.001)
    assert simulation.step == step + 1


class TestSwitchInterval:
    def test_the_last_of_several_puts_it_back(self):
        before = sys.getswitchinterval()
        first, second = Simulation([TANK]), Simulation([TANK])
        first.start()
        second.start()
        short = sys.getswitchinterval()
        first.stop()
        assert sys.getswitchinterval() == short < before, "the second still runs"
        second.stop()
        assert sys.getswitchinterval() == before

    def test_an_abandoned_simulation_does_without(self, stuck):
        before = sys.getswitchinterval()
        stuck.simulation.start()
        stuck.reached()
        stuck.simulation.stop()
        assert sys.getswitchinterval() == before


class Stuck(Acting):
    """Does not return from one of its methods, until it is let."""

    def __init__(self, method="control"):
        super().__init__(method)
        self.there, self.let = threading.Event(), threading.Event()

    def act(self):
        self.there.set()
        self.let.wait(60)

    def reached(self):
        assert self.there.wait(20)


@pytest.fixture
def stuck(monkeypatch):
    """A controller that does not return, in a simulation that waits for it only a moment."""
    monkeypatch.setattr("tutorial.simulation.STUCK", 0.2)
    controller = Stuck()
    controller.simulation = Simulation([TANK], [("Tank", controller)])
    yield controller
    controller.let.set()
    until(lambda: not any(thread.name in ("simulation", "stepper") for thread in threading.enumerate()))


SAID = r"Stuck does not return: it is at test_simulation\.py, line \d+, in act\. Mend it, and make the simulation"


CALLS = {
    "advance": lambda simulation: simulation.advance(0.01),
    "start": lambda simulation: simulation.start(),
    "restart": lambda simulation: simulation.restart(),
    "release": lambda simulation: simulation.release("Tank"),
}


class TestAControllerThatDoesNotReturn:
    @pytest.mark.parametrize("method", ["initialize", "control"])
    @pytest.mark.parametrize("call", ["restart", "release"])
    def test_is_not_waited_for_without_end(self, stuck, call, method):
        stuck.method = method
        stuck.simulation.start()
        stuck.reached()
        with pytest.raises(ControllerError, match=SAID):
            CALLS[call](stuck.simulation)
        assert stuck.simulation.state is State.ABANDONED

    @pytest.mark.parametrize("call", CALLS)
    def test_once_it_was_given_up_everything_says_so(self, stuck, call, caplog):
        stuck.simulation.start()
        stuck.reached()
        stuck.simulation.stop()
        stuck.simulation.stop()
        assert caplog.text.count("Stuck does not return") == 1
        with pytest.raises(ControllerError, match=SAID):
            CALLS[call](stuck.simulation)
        assert stuck.simulation.wait()
        assert not stuck.simulation.running
        assert "Stuck does not return" in str(stuck.simulation.error)

    def test_and_its_simulation_are_never_touched_again(self, stuck):
        stuck.simulation.start()
        stuck.reached()
        stuck.simulation.stop()
        error, snapshot = stuck.simulation.error, stuck.simulation.snapshot.get()
        with pytest.raises(ControllerError):
            stuck.simulation.restart()
        stuck.let.set()
        until(lambda: "simulation" not in [thread.name for thread in threading.enumerate()])
        assert (stuck.simulation.error, stuck.simulation.state) == (error, State.ABANDONED)
        assert stuck.simulation.snapshot.get() is snapshot
        assert stuck.simulation.step == stuck.simulation.data.time == 0.0
        assert stuck.calls == ["initialize"]

    @pytest.mark.parametrize("call", ["stop", "restart", "release"])
    def test_in_its_stop_is_not_waited_for_either(self, stuck, call):
        stuck.method = "stop"
        stuck.simulation.advance(0.001)
        if call == "stop":
            stuck.simulation.stop()
        else:
            with pytest.raises(ControllerError, match=SAID):
                CALLS[call](stuck.simulation)
        assert stuck.simulation.state is State.ABANDONED

    def test_keeps_only_the_thread_that_advances(self, stuck):
        raised = []

        def advance():
            with pytest.raises(ControllerError, match=SAID) as info:
                stuck.simulation.advance(1.0)
            raised.append(info.value)

        stepper = threading.Thread(target=advance, name="stepper")
        stepper.start()
        stuck.reached()
        for call in ("advance", "start"):
            with pytest.raises(TutorialError, match=r"Call stop\(\)"):
                CALLS[call](stuck.simulation)
        stuck.simulation.stop()
        assert stuck.simulation.state is State.ABANDONED
        stuck.let.set()
        stepper.join(20)
        assert raised


class TestSeveralThreads:
    def test_an_advance_is_stopped_by_another_and_says_so(self):
        class Stopped(Recorder):
            def control(self):
                super().control()
                began.set()

        began = threading.Event()
        simulation = Simulation([TANK], [("Tank", Stopped())])
        other = threading.Thread(target=lambda: began.wait(20) and simulation.stop())
        other.start()
        with pytest.raises(TutorialError, match=r"advance\(1000000\) was stopped elsewhere, at \d+\.\d+ s"):
            simulation.advance(1_000_000)
        other.join(20)
        assert simulation.state is State.IDLE

    def test_a_body_is_released_while_another_thread_advances(self):
        recorder = Recorder()
        simulation = Simulation([TANK], [("Tank", recorder)])

        def release():
            until(lambda: recorder.times)
            simulation.release("Tank")
            asked.append(len(recorder.times))
            simulation.stop()

        asked = []
        other = threading.Thread(target=release)
        other.start()
        with pytest.raises(TutorialError, match="was stopped elsewhere"):
            simulation.advance(1_000_000)
        other.join(20)
        assert asked == [len(recorder.times)]
        assert recorder.calls == ["initialize", "stop"]

    @pytest.mark.parametrize("method", ["control", "stop"])
    def test_a_controller_cannot_wait_for_itself(self, method):
        class Waits(Acting):
            def act(self):
                simulation.stop()

        simulation = Simulation([TANK], [("Tank", Waits(method))])
        simulation.start(0.01)
        assert simulation.wait(20)
        simulation.stop()
        assert r"stop() was called by a controller" in str(simulation.error)


BOX = """
<mujoco><worldbody><body name="box"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body></worldbody></mujoco>
"""


ACTS = (
    lambda simulation: simulation.start(),
    lambda simulation: simulation.start(0.005),
    lambda simulation: simulation.advance(0.02),
    lambda simulation: simulation.wait(0.005),
    lambda simulation: simulation.wait(0.01),
    lambda simulation: simulation.stop(),
    lambda simulation: simulation.restart(),
    lambda simulation: simulation.release("A"),
)


class Visitor(threading.Thread):
    """Calls a simulation's methods at random, and writes down what comes of it."""

    def __init__(self, simulation, rng):
        super().__init__(name="visitor", daemon=True)
        self.simulation = simulation
        self.acts = rng.choices(ACTS, k=8)
        self.errors, self.wrong, self.longest = [], [], 0.0

    def run(self):
        for act in self.acts:
            began = time.monotonic()
            try:
                act(self.simulation)
            except TutorialError as error:
                self.errors.append(str(error))
            except BaseException as error:  # noqa: BLE001 - nothing else may come out
                self.wrong.append(error)
            self.longest = max(self.longest, time.monotonic() - began)


def stopped(simulation):
    """Stop, unless a visitor is just at it."""
    try:
        simulation.stop()
    except TutorialError:
        return False
    return not simulation.running


def let_two_visit(seed, model):
    """Let two threads do as they like with an unruly simulation; return the failures that neither was told."""
    rng, let = random.Random(seed), threading.Event()
    unruly = [Unruly(rng, let) for _ in range(3)]
    simulation = Simulation([Placement("A", model), Placement("B", model)], zip("AAB", unruly))
    visitors = [Visitor(simulation, rng) for _ in range(2)]
    for visitor in visitors:
        visitor.start()
    until(lambda: any(each.hangs for each in unruly) or not any(visitor.is_alive() for visitor in visitors), 10)
    for visitor in visitors:
        visitor.join(0.2)  # one that hangs itself, in advance(), stays until it is let
    until(lambda: stopped(simulation), 10)
    assert simulation.state is State.ABANDONED or not any(each.hangs for each in unruly)
    assert (simulation.error is None) == (simulation.state is State.IDLE)
    let.set()
    for visitor in visitors:
        visitor.join(10)
        assert not visitor.is_alive()
        assert not visitor.wrong
        assert visitor.longest < 10
    told = "".join(visitors[0].errors + visitors[1].errors)
    return [text for each in unruly for text in each.raised if text not in told]


@pytest.mark.parametrize("tens", range(20))
def test_whatever_two_threads_do_nothing_hangs_and_no_failure_is_unseen(tens, tmp_path, monkeypatch, caplog):
    monkeypatch.setattr("tutorial.simulation.STUCK", 0.1)
    model = tmp_path / "box.xml"
    model.write_text(BOX)
    interval, threads = sys.getswitchinterval(), set(threading.enumerate())
    for seed in range(10 * tens, 10 * tens + 10):
        untold = let_two_visit(seed, model)
        until(lambda: set(threading.enumerate()) <= threads, 10)
        assert [text for text in untold if text not in caplog.text] == [], f"seed {seed}"
        assert sys.getswitchinterval() == interval, f"seed {seed}"


def test_displayed_bodies_are_moved_to_where_the_copy_is():
    simulation = Simulation([TANK])
    shown = Body.displayed(TANK)
    assert np.array_equal(shown.qpos, simulation.bodies["Tank"].qpos)
    simulation.advance(0.2)
    assert not np.array_equal(shown.qpos, simulation.bodies["Tank"].qpos), "it is a copy"
    assert simulation.copy_to([shown]) == 0.2
    assert np.array_equal(shown.qpos, simulation.bodies["Tank"].qpos)
