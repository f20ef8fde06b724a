"""A robot or any other body: a MuJoCo model with its state, and joints that can be found by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

import mujoco
import numpy as np

from tutorial.errors import TutorialError, did_you_mean
from tutorial.handoff import ThreadGuard
from tutorial.model.actuators import Command, effort_command, target_command
from tutorial.model.couplings import Followers
from tutorial.world import Placement, compose

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from tutorial.joints import JointReport

    Observer = Callable[[JointReport | None], object]

FindCamera = Callable[["Body", str], Any]

SHOWN_GROUPS = 3  # MuJoCo's convention: viewers hide groups 3 to 5
ONE_DOF = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))


class Joint:
    """A hinge or slide joint of a body, with the quantities that a `sensor_msgs/JointState` contains.

    Attributes:
        name: its name, without the body's prefix.
        range: the limits ``(lower, upper)`` [rad or m]; infinite if the joint has no limits.
        qpos_adr: the index of its position in MuJoCo's ``qpos``.
    """

    __slots__ = (
        *("_ctrl", "_dof_adr", "_effort", "_effort_command", "_guard", "_id", "_model", "_qpos", "_qvel"),
        *("_target_command", "name", "qpos_adr", "range"),
    )

    def __init__(
        self, name: str, model: mujoco.MjModel, data: mujoco.MjData, joint_id: int, guard: ThreadGuard | None
    ) -> None:
        self.name = name
        limited = model.jnt_limited[joint_id]
        self.range: tuple[float, float] = tuple(model.jnt_range[joint_id].tolist()) if limited else (-inf, inf)
        self.qpos_adr = int(model.jnt_qposadr[joint_id])
        self._dof_adr = int(model.jnt_dofadr[joint_id])
        self._guard = guard
        self._qpos: NDArray[np.float64] = data.qpos
        self._qvel: NDArray[np.float64] = data.qvel
        self._effort: NDArray[np.float64] = data.qfrc_actuator
        self._ctrl: NDArray[np.float64] = data.ctrl
        self._model = model
        self._id = joint_id
        self._effort_command: Command | None = None  # looked up on first use
        self._target_command: Command | None = None

    @property
    def position(self) -> float:
        """Position [rad or m]. Setting it moves the joint of a displayed body; only the body's thread may set it."""
        return self._qpos.item(self.qpos_adr)

    @position.setter
    def position(self, value: float) -> None:
        if self._guard:
            self._guard.check("Joint.position")
        self._qpos[self.qpos_adr] = value

    @property
    def velocity(self) -> float:
        """Velocity [rad/s or m/s]."""
        return self._qvel.item(self._dof_adr)

    @property
    def effort(self) -> float:
        """Torque or force [N.m or N] of the joint's actuators in the last step. Setting it commands the motor.

        Raises:
            TutorialError: on assignment, if the joint has no motor or has a servo; the error names the actuator and
                its kind.
        """
        return self._effort.item(self._dof_adr)

    @effort.setter
    def effort(self, value: float) -> None:
        command = self._effort_command = self._effort_command or effort_command(self._model, self._id)
        self._ctrl[command.adr] = command.scale * value

    @property
    def target(self) -> float:
        """Position [rad or m] that the joint's position servo holds. Setting it commands the servo.

        Raises:
            TutorialError: the joint has no position servo, or more than one; the error names the actuator and its kind.
        """
        command = self._find_target_command()
        return (self._ctrl.item(command.adr) - command.offset) / command.scale

    @target.setter
    def target(self, value: float) -> None:
        command = self._find_target_command()
        self._ctrl[command.adr] = command.offset + command.scale * value

    def _find_target_command(self) -> Command:
        self._target_command = self._target_command or target_command(self._model, self._id)
        return self._target_command


class Actuator:
    """An actuator of a body, such as a track. To command a joint's motor, set `Joint.effort` instead.

    Attributes:
        name: its name, without the body's prefix.
    """

    __slots__ = ("_adr", "_ctrl", "name")

    def __init__(self, name: str, data: mujoco.MjData, adr: int) -> None:
        self.name = name
        self._ctrl: NDArray[np.float64] = data.ctrl
        self._adr = adr

    @property
    def ctrl(self) -> float:
        """The control signal, in the model's unit; for a track, the surface speed [m/s]."""
        return self._ctrl.item(self._adr)

    @ctrl.setter
    def ctrl(self, value: float) -> None:
        self._ctrl[self._adr] = value


class Sensor:
    """A sensor on a body, such as an accelerometer.

    Attributes:
        name: its name, without the body's prefix.
    """

    __slots__ = ("_guard", "_measured", "name")

    def __init__(self, name: str, measured: NDArray[np.float64], guard: ThreadGuard | None) -> None:
        self.name = name
        self._measured = measured
        self._guard = guard

    @property
    def value(self) -> NDArray[np.float64]:
        """A copy of the last step's measurement, shape (dim,), in the sensor's unit, such as [m/s^2] along x, y, z.

        Setting it stores a received measurement in a displayed body; only the body's thread may set it.
        """
        return self._measured.copy()

    @value.setter
    def value(self, value: ArrayLike) -> None:
        if self._guard:
            self._guard.check("Sensor.value")
        self._measured[:] = value


class Body:
    """A named part of a MuJoCo model, with its state.

    A displayed body has its own model and state and belongs to the thread that made it, the main thread. A simulated
    body is part of the simulation's world and belongs to the thread that steps it. Moving a displayed body on a thread
    other than its own raises WrongThreadError.

    Args:
        name: the body's name. Its elements are called ``name/element`` in the model.
        model: the model.
        data: its state.
        guard: the guard that restricts a displayed body to its thread; None for a simulated body.
        find_camera: a function that finds a simulated body's camera by name; None for a displayed body.

    Attributes:
        name, model, data, find_camera: as given.
        joints: the hinge and slide joints of groups 0 to 2, in the model's order. Higher groups, which MuJoCo hides,
            contain the joints of internal parts, such as the wheels in a track.
        qpos_slice: the body's part of MuJoCo's ``qpos``.
        note: text that a controller of a displayed body shows in the line below the view.
    """

    def __init__(
        self,
        name: str,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        guard: ThreadGuard | None = None,
        find_camera: FindCamera | None = None,
    ) -> None:
        self.name = name
        self.model = model
        self.data = data
        self.find_camera = find_camera
        self.note = ""
        ids = [i for i in range(model.njnt) if model.joint(i).name.startswith(f"{name}/")]
        shown = [i for i in ids if int(model.jnt_type[i]) in ONE_DOF and model.jnt_group[i] < SHOWN_GROUPS]
        names = {i: model.joint(i).name.removeprefix(f"{name}/") for i in shown}
        self.joints = tuple(Joint(names[i], model, data, i, guard) for i in shown)
        self.qpos_slice = _slice(ids, model.jnt_qposadr, model.nq)
        self._dof_slice = _slice(ids, model.jnt_dofadr, model.nv)
        self._root = _Root.of(name, model, data, ids)
        self._followers = Followers(model, f"{name}/") if guard else None  # a simulation computes the couplings itself
        self._by_name = {joint.name: joint for joint in self.joints}
        self._guard = guard
        self._observers: list[Observer] = []

    @classmethod
    def displayed(cls, placement: Placement) -> Body:
        """Make a displayed body from its model file. It belongs to the calling thread.

        Args:
            placement: the body's name and model.

        Raises:
            TutorialError: the model cannot be loaded.
        """
        model = compose([placement])
        body = cls(placement.name, model, mujoco.MjData(model), ThreadGuard(f"the body {placement.name!r}"))
        if body._followers:
            body._followers.begin(body.data.qpos)
        body.calc_forward_kinematics()
        return body

    def __repr__(self) -> str:
        return f"Body({self.name!r}, joints={list(self.joint_names)})"

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The body's joint names."""
        return tuple(self._by_name)

    @property
    def joint_ranges(self) -> dict[str, tuple[float, float]]:
        """The joints' ranges by name, ``(lower, upper)`` [rad or m]."""
        return {joint.name: joint.range for joint in self.joints}

    @property
    def qpos(self) -> NDArray[np.float64]:
        """A view of the body's part of MuJoCo's ``qpos``, shape (nq,)."""
        qpos: NDArray[np.float64] = self.data.qpos[self.qpos_slice]
        return qpos

    @property
    def followers(self) -> frozenset[str]:
        """The coupled joints that still follow other joints because they have never been passed to
        `set_joint_positions`.
        """
        return self._followers.names if self._followers else frozenset()

    def joint(self, name: str) -> Joint:
        """Find a joint by name.

        Raises:
            TutorialError: the body has no such joint; the error suggests the nearest name.
        """
        if name not in self._by_name:
            raise TutorialError(f"the body {self.name!r} has no joint {name!r}.{did_you_mean(name, self.joint_names)}")
        return self._by_name[name]

    def actuator(self, name: str) -> Actuator:
        """Find an actuator by name, or raise the same error as `joint`."""
        number = self.find_id("actuator", self.model.actuator, self.model.nactuator, name)
        return Actuator(name, self.data, int(self.model.actuator_ctrladr[number]))

    def sensor(self, name: str) -> Sensor:
        """Find a sensor by name, or raise the same error as `joint`."""
        number = self.find_id("sensor", self.model.sensor, self.model.nsensor, name)
        return Sensor(name, self.data.sensor(number).data, self._guard)

    def camera(self, name: str) -> Any:
        """Find a simulated body's `tutorial.view.camera.Camera` by name, or raise the same error as `joint`."""
        if self.find_camera is None:
            raise TutorialError(
                f"the displayed body {self.name!r} cannot capture images. Use the simulated body, io.body."
            )
        return self.find_camera(self, name)

    def find_id(self, kind: str, element: Callable[[int], Any], count: int, name: str) -> int:
        """Return the MuJoCo ID of an element of the body, such as a camera.

        Args:
            kind: the kind of element, as it should appear in the error message.
            element: the MuJoCo method that returns an element of this kind by ID, such as ``model.camera``.
            count: the number of such elements in the whole model.
            name: the element's name, without the body's prefix.

        Raises:
            TutorialError: the body has no such element; the error suggests the nearest name.
        """
        prefix = f"{self.name}/"
        every = {element(i).name: i for i in range(count)}
        mine = {each.removeprefix(prefix): i for each, i in every.items() if each.startswith(prefix)}
        if name not in mine:
            raise TutorialError(f"the body {self.name!r} has no {kind} {name!r}.{did_you_mean(name, mine)}")
        return mine[name]

    @property
    def position(self) -> NDArray[np.float64]:
        """A copy of the position [m] of the root (the first link), shape (3,). Setting it moves a displayed body."""
        return self._root.position.copy()

    @position.setter
    def position(self, value: ArrayLike) -> None:
        self._check("Body.position")
        self._root.position[:] = value

    @property
    def orientation_wxyz(self) -> NDArray[np.float64]:
        """A copy of the root's orientation as a unit quaternion, shape (4,). Setting it turns a displayed body."""
        return self._root.wxyz.copy()

    @orientation_wxyz.setter
    def orientation_wxyz(self, value: ArrayLike) -> None:
        self._check("Body.orientation_wxyz")
        self._root.wxyz[:] = value

    @property
    def twist(self) -> NDArray[np.float64]:
        """A copy of the root's velocity along its own axes: linear [m/s], then angular [rad/s], shape (6,)."""
        linear, inverse = np.empty(3), self._root.wxyz * (1.0, -1.0, -1.0, -1.0)
        mujoco.mju_rotVecQuat(linear, self._root.velocity[:3], inverse)  # the linear velocity is in the world frame
        return np.concatenate([linear, self._root.velocity[3:]])

    def reset(self) -> None:
        """Move the body back to its initial pose and joint positions, and set its velocities to zero."""
        self._check("reset")
        self.data.qpos[self.qpos_slice] = self.model.qpos0[self.qpos_slice]
        self.data.qvel[self._dof_slice] = self.data.qacc_warmstart[self._dof_slice] = 0.0
        mujoco.mj_forward(self.model, self.data)  # for code that reads poses and sensors before the next step

    def set_joint_positions(self, positions: Mapping[str, float]) -> None:
        """Move joints of a displayed body, and the joints that its model couples to them.

        A coupled joint follows its leader until a call passes a position for it. Joints that get no position and are
        not coupled do not move.

        Args:
            positions: the positions [rad or m] by joint name.

        Raises:
            TutorialError: the body has no joint of that name.
        """
        self._check("set_joint_positions")
        qpos = self.data.qpos
        for name, position in positions.items():
            qpos[self.joint(name).qpos_adr] = position
        if self._followers:
            self._followers.update(positions, qpos)

    def calc_forward_kinematics(self) -> None:
        """Compute the poses of the links from the root's pose and the joint positions."""
        self._check("calc_forward_kinematics")
        mujoco.mj_kinematics(self.model, self.data)

    def notify_change(self, report: JointReport | None = None) -> None:
        """Call the observers, so that the view shows the change.

        Args:
            report: which joints the message moved, and the message's faults; None if no message caused the
                change. The body only passes the report on to the observers, to which a controller has no access.
        """
        self._check("notify_change")
        for observer in tuple(self._observers):
            observer(report)

    def on_change(self, observer: Observer) -> None:
        """Register ``observer(report)``, to be called on the main thread after every change."""
        self._observers.append(observer)

    def _check(self, action: str) -> None:
        if self._guard:
            self._guard.check(action)


def _slice(joint_ids: Sequence[int], addresses: NDArray[np.int32], size: int) -> slice:
    """Return a body's slice of an array such as ``qpos``. MuJoCo numbers a body's joints consecutively.

    Args:
        joint_ids: the body's joints.
        addresses: for each joint of the model, the index of its first element.
        size: the array's size.
    """
    bounds = [*addresses.tolist(), size]
    return slice(bounds[joint_ids[0]], bounds[joint_ids[-1] + 1]) if joint_ids else slice(0, 0)


class _Root(NamedTuple):
    """Views of the pose and velocity of a body's root in MuJoCo's data, or in the model if the root is fixed."""

    position: NDArray[np.float64]
    wxyz: NDArray[np.float64]
    velocity: NDArray[np.float64]

    @classmethod
    def of(cls, name: str, model: mujoco.MjModel, data: mujoco.MjData, joint_ids: Sequence[int]) -> _Root:
        """Find a body's root. If the root can move, the body's first joint is a free joint."""
        if joint_ids and model.jnt_type[joint_ids[0]] == mujoco.mjtJoint.mjJNT_FREE:
            adr, dof = int(model.jnt_qposadr[joint_ids[0]]), int(model.jnt_dofadr[joint_ids[0]])
            return cls(data.qpos[adr : adr + 3], data.qpos[adr + 3 : adr + 7], data.qvel[dof : dof + 6])
        root = next((i for i in range(model.nbody) if model.body(i).name.startswith(f"{name}/")), 0)
        return cls(model.body_pos[root], model.body_quat[root], np.zeros(6))
