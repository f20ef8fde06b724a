"""A body on the page: the joints and actuators that the course's controllers use, based on MuJoCo for browsers."""

from array import array
from collections.abc import Callable, Mapping
from math import inf
from operator import setitem as put
from typing import Any

from tutorial.errors import TutorialError, did_you_mean


class State:
    """A copy of MuJoCo's state. Python reads and writes it much faster than the original in the browser.

    Args:
        mujoco: the browser's MuJoCo.
        xml: the world.
    """

    def __init__(self, mujoco: Any, xml: str) -> None:
        self._mujoco, self.model = mujoco, mujoco.MjModel.from_xml_string(xml)
        self.data = mujoco.MjData.new(self.model)
        nq, nv, nu = self.model.nq, self.model.nv, self.model.nu
        self.qpos, self.qvel, self.effort, self.ctrl = (array("d", bytes(8 * size)) for size in (nq, nv, nv, nu))
        self.reset()

    def look_up(self) -> None:
        """Look up MuJoCo's arrays again: they move when it allocates more memory."""
        data = self.data
        self._qpos, self._ctrl = data.qpos, data.ctrl
        theirs = self._qpos, data.qvel, data.qfrc_actuator, self._ctrl
        self._views = tuple(zip(theirs, (self.qpos, self.qvel, self.effort, self.ctrl)))

    def step(self) -> None:
        """Step MuJoCo once."""
        self._ctrl.assign(self.ctrl)
        self._mujoco.mj_step(self.model, self.data)
        self._copy()

    def kinematics(self) -> None:
        """Compute the poses of the links."""
        self._qpos.assign(self.qpos)
        self._mujoco.mj_kinematics(self.model, self.data)

    def reset(self) -> None:
        """Return to the initial pose."""
        self._mujoco.mj_resetData(self.model, self.data)
        self._mujoco.mj_forward(self.model, self.data)
        self.look_up()
        self._copy()

    def _copy(self) -> None:
        for theirs, ours in self._views:
            theirs.assign_to(ours)


class Joint:
    """A hinge joint: its name, its range [rad], position [rad], velocity [rad/s] and effort [N.m].

    The effort is the torque that the motor applied in the last step. Setting it commands the torque of the next step.
    """

    def __init__(self, state: State, name: str, limits: list[float] | None, qpos: int, dof: int, ctrl: int) -> None:
        self.name, self.range = name, tuple(limits) if limits else (-inf, inf)
        self._state, self._qpos, self._dof, self._ctrl = state, qpos, dof, ctrl

    position = property(lambda self: self._state.qpos[self._qpos], lambda self, q: put(self._state.qpos, self._qpos, q))
    velocity = property(lambda self: self._state.qvel[self._dof])
    effort = property(lambda self: self._state.effort[self._dof], lambda self, u: put(self._state.ctrl, self._ctrl, u))


class Actuator:
    """An actuator that is not a joint's motor, such as a track: its control signal (for a track, its speed [m/s])."""

    def __init__(self, state: State, name: str, ctrl: int) -> None:
        self.name, self._state, self._adr = name, state, ctrl

    ctrl = property(lambda self: self._state.ctrl[self._adr], lambda self, u: put(self._state.ctrl, self._adr, u))


class Body:
    """The tank: simulated in one program, displayed in the other. Its attributes are those of the course's `Body`."""

    def __init__(self, state: State, name: str, joints: list[dict[str, Any]], actuators: dict[str, int]) -> None:
        self.name, self.calc_forward_kinematics = name, state.kinematics
        self._joints = {joint["name"]: Joint(state, **joint) for joint in joints}
        self.joints, self.joint_names = tuple(self._joints.values()), tuple(self._joints)
        self.joint_ranges = {joint.name: joint.range for joint in self.joints}
        self._actuators = {each: Actuator(state, each, ctrl) for each, ctrl in actuators.items()}
        self._observers: list[Callable[[Any], object]] = []

    def joint(self, name: str) -> Joint:
        """Find a joint by name."""
        return self._find("joint", self._joints, name)

    def actuator(self, name: str) -> Actuator:
        """Find an actuator by name."""
        return self._find("actuator", self._actuators, name)

    def set_joint_positions(self, positions: Mapping[str, float]) -> None:
        """Move the given joints [rad]; the remaining ones keep their positions."""
        for name, position in positions.items():
            self.joint(name).position = position

    def notify_change(self, report: Any = None) -> None:
        """Notify the observers that the body has changed, with the report of the matched message."""
        for observer in self._observers:
            observer(report)

    def on_change(self, observer: Callable[[Any], object]) -> None:
        """Call ``observer(report)`` whenever the body has changed."""
        self._observers.append(observer)

    def _find(self, kind: str, known: dict[str, Any], name: str) -> Any:
        if name not in known:
            raise TutorialError(f"the body {self.name!r} has no {kind} {name!r}.{did_you_mean(name, known)}")
        return known[name]
