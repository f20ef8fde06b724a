"""Computes the positions of coupled joints that no message names, such as the joint of a gripper's second finger."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

NOBODY = -1
"""Stands in for a leader if the follower is held at a constant position."""

NOT_COMPUTED = ("mjEQ_CONNECT", "mjEQ_WELD", "mjEQ_TENDON", "mjEQ_DISTANCE")
"""Equality constraints on links and tendons. They also move joints, but no formula gives a single joint's position."""


class Coupling(NamedTuple):
    """A coupling that makes one joint follow another joint.

    Attributes:
        follower: the MuJoCo ID of the joint that follows.
        leader: the MuJoCo ID of the joint that is followed, or `NOBODY`.
        polynomial: the coefficients of the follower's position [rad or m] as a function of the leader's position,
            with the constant first.
    """

    follower: int
    leader: int
    polynomial: tuple[float, ...]

    def position(self, leader: float) -> float:
        """Compute the follower's position from the leader's position [rad or m]."""
        position = 0.0
        for coefficient in reversed(self.polynomial):
            position = position * leader + coefficient
        return position

    @property
    def is_linear(self) -> bool:
        """Whether the follower moves in proportion to the leader."""
        return len(self.polynomial) == 2

    def swapped(self) -> Coupling:
        """Return this linear coupling with leader and follower exchanged."""
        offset, ratio = self.polynomial
        return Coupling(self.leader, self.follower, (-offset / ratio, 1 / ratio))

    def after(self, other: Coupling) -> Coupling:
        """Combine this coupling with ``other``, which moves this coupling's leader. Both couplings must be linear."""
        (offset, ratio), (other_offset, other_ratio) = self.polynomial, other.polynomial
        return Coupling(self.follower, other.leader, (offset + ratio * other_offset, ratio * other_ratio))


class Followers:
    """Moves the joints of a displayed body that are coupled to other joints.

    A joint follows its leader until the follower's own position is set, for instance from a message.

    Args:
        model: the model.
        prefix: the prefix of the body's joint names in the model, such as ``Tank/``.

    Attributes:
        names: the names, without the prefix, of the joints that follow joints with known positions.
    """

    def __init__(self, model: mujoco.MjModel, prefix: str) -> None:
        self.names: frozenset[str] = frozenset()
        self._model = model
        self._prefix = prefix
        self._couplings = [each for each in couplings_of(model) if self._name(each.follower).startswith(prefix)]
        self._steps: list[Coupling] = []
        self._set: set[str] = set()

    def begin(self, qpos: NDArray[np.float64]) -> None:
        """Satisfy every coupling, before any position is set."""
        self._move(follow(self._couplings, roots(self._couplings)), qpos)

    def update(self, positions: Mapping[str, float], qpos: NDArray[np.float64]) -> None:
        """Move the followers after positions have been set.

        Args:
            positions: the positions that were set, by joint name.
            qpos: MuJoCo's positions, which already include the positions that were set.
        """
        if not self._couplings:
            return
        if not self._set.issuperset(positions):
            self._set.update(positions)
            joints = (self._model.joint(self._prefix + name).id for name in self._set)
            self._steps = follow(self._couplings, joints)
            self.names = frozenset(self._name(each.follower).removeprefix(self._prefix) for each in self._steps)
        self._move(self._steps, qpos)

    def _move(self, steps: Iterable[Coupling], qpos: NDArray[np.float64]) -> None:
        adr = self._model.jnt_qposadr
        for step in steps:
            qpos[adr[step.follower]] = step.position(qpos.item(adr[step.leader]))

    def _name(self, joint: int) -> str:
        return str(self._model.joint(joint).name)


def couplings_of(model: mujoco.MjModel) -> list[Coupling]:
    """Return a model's joint couplings that are active at the start."""
    joint_equalities = (i for i in active_equalities(model) if model.eq_type[i] == mujoco.mjtEq.mjEQ_JOINT)
    return [_coupling(model, equality) for equality in joint_equalities]


def active_equalities(model: mujoco.MjModel) -> list[int]:
    """Return the MuJoCo IDs of the equality constraints that are active at the start."""
    off = model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_EQUALITY)
    return [] if off else [i for i, active in enumerate(model.eq_active0.tolist()) if active]


def not_computed(model: mujoco.MjModel) -> list[str]:
    """Return the MJCF names of the kinds of active equalities that only a simulation can satisfy."""
    kinds = {mujoco.mjtEq(model.eq_type[each]).name for each in active_equalities(model)}
    return [kind.removeprefix("mjEQ_").lower() for kind in NOT_COMPUTED if kind in kinds]


def follow(couplings: Sequence[Coupling], named: Iterable[int]) -> list[Coupling]:
    """Find the couplings that determine the unknown joint positions.

    A linear coupling also works backwards, from its follower to its leader. If several couplings determine a
    joint's position, the first one is used.

    Args:
        couplings: the couplings of a model.
        named: the MuJoCo IDs of the joints whose positions are known.

    Returns:
        The couplings, sorted so that each leader's position is known before its followers need it.
    """
    ways = [*couplings, *(each.swapped() for each in couplings if each.is_linear)]
    known, found = {NOBODY, *named}, list[Coupling]()
    while step := next((way for way in ways if way.leader in known and way.follower not in known), None):
        known.add(step.follower)
        found.append(step)
    return found


def roots(couplings: Sequence[Coupling]) -> set[int]:
    """Return the leaders that follow no joint themselves, and one joint of each cycle."""
    found = {each.leader for each in couplings} - {each.follower for each in couplings}
    for each in couplings:
        if each.leader not in found.union(step.follower for step in follow(couplings, found)):
            found.add(each.leader)
    return found


def _coupling(model: mujoco.MjModel, equality: int) -> Coupling:
    """Read an equality. MuJoCo's polynomial is a function of the leader's distance from its ``qpos0``."""
    follower, leader = int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality])
    start = float(model.qpos0[model.jnt_qposadr[follower]])
    coefficients = model.eq_data[equality, :5].tolist()
    if leader == NOBODY:
        return Coupling(follower, leader, (start + coefficients[0],))
    moved = Polynomial([-float(model.qpos0[model.jnt_qposadr[leader]]), 1.0])
    polynomial = (start + Polynomial(coefficients)(moved)).trim()
    return Coupling(follower, leader, tuple(polynomial.coef.tolist()))
