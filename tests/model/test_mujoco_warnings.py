"""MuJoCo's warnings are counted and logged, and never end the process."""

from tutorial.model import mujoco_warnings
from tutorial.model.mujoco_warnings import _MujocoWarns


def test_warnings_are_counted_and_logged_now_and_then(caplog, monkeypatch):
    monkeypatch.setattr(mujoco_warnings, "WARN_EVERY", 1000.0)
    mujoco_warns = _MujocoWarns()
    mujoco_warns("Nan, Inf or huge value in CTRL at ACTUATOR 0.")
    for _ in range(7):
        mujoco_warns("Nan, Inf or huge value in QACC at DOF 0.")
    monkeypatch.setattr(mujoco_warns, "_due", 0.0)
    mujoco_warns("Nan, Inf or huge value in QPOS at DOF 0.")
    assert caplog.messages == [
        "MuJoCo: Nan, Inf or huge value in CTRL at ACTUATOR 0. "
        "All controls are treated as 0 until all of them are valid again.",
        "MuJoCo: Nan, Inf or huge value in QPOS at DOF 0. The simulated world is reset to its initial state. "
        "(7 more since the last warning)",
    ]


def test_a_failing_log_does_not_end_the_process(monkeypatch):
    monkeypatch.setattr(mujoco_warnings, "_log", None)
    _MujocoWarns()("nobody hears it")
