"""A body's MuJoCo model as URDF, the robot description that rviz2, robot_state_publisher and other programs read.

The links are the model's bodies, in the same places. The movable joints are those that appear in joint states. Names
are the same as in the model, without the body's prefix, which robot_state_publisher can add (``frame_prefix``). A link
is renamed if a joint has the same name. Each sensor and camera has its own link, which is the frame of its messages.
"""

import logging
from collections import Counter
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Comment, Element, SubElement

import mujoco
import numpy as np

from tutorial.body import Body
from tutorial.description.limits import add_dynamics, add_limit
from tutorial.description.poses import OPTICAL, Matrix, add_origin, numbers, pose, shift, turn
from tutorial.description.shapes import add_shapes
from tutorial.model.couplings import NOT_COMPUTED, Coupling, active_equalities, couplings_of, follow, roots
from tutorial.model.urdf_file import NO_MASS

ROOT = "base_link"
"""The name of the link that represents the body's root. The free joint that moves it is not in the description."""

WORLD, FIRST = 0, 1
"""The MuJoCo IDs of the world and the root."""

FREE, BALL, SLIDE = (int(getattr(mujoco.mjtJoint, f"mjJNT_{kind}")) for kind in ("FREE", "BALL", "SLIDE"))

_log = logging.getLogger(__name__)


def robot_description(body: Body) -> str:
    """Return the URDF of a body.

    Elements that URDF lacks, such as tendons and ellipsoids, are omitted. Joints that do not appear in joint
    states (joints in hidden groups, ball joints, unnamed joints) are fixed at their initial positions in the model. A
    joint with a linear coupling to another joint mimics that joint; other equalities are omitted. A comment at the top
    lists these differences, with a count for each. If the description moves differently from the robot, a warning is
    also logged.

    Args:
        body: a displayed body, whose model contains only this body.

    Returns:
        The XML. Lengths are in m, angles in rad, inertias in kg.m^2.
    """
    return _Writer(body).write()


class _Writer:
    """Writes one robot description in MuJoCo's order, which puts parents before children."""

    def __init__(self, body: Body) -> None:
        self.body = body
        self.model = body.model
        self.robot = Element("robot", name=body.name)
        self.links = {WORLD: self._add_link(ROOT)}  # the links, keyed by MuJoCo body ID
        names = (self._plain(body.model.body(number).name) for number in range(FIRST, body.model.nbody))
        self.published = frozenset(body.joint_names)  # the joints included in joint states
        self.mimics = self._mimics()
        self.moving = self.published.union(self._joint_name(each) for each in self.mimics)
        self.names = {"link": {ROOT, *names}, "joint": set(self.moving)}
        others = self._other_equalities()
        self.left_out = Counter(tendons=self.model.ntendon, equalities=self.model.neq - len(self.mimics) - others)
        self.moves_otherwise = +Counter({"equalities that move joints": others})

    def write(self) -> str:
        """Return the XML."""
        for number in range(FIRST, self.model.nbody):
            if self.model.body_parentid[number] in self.links:
                self._add_body(number)
        for geom in range(self.model.ngeom):
            self._add_geom(geom)
        self._add_sensors()
        self._say_what_is_missing()
        ElementTree.indent(self.robot)
        # in ASCII with character references, so that the encoding of files and terminals does not matter
        text = ElementTree.tostring(self.robot, encoding="us-ascii", xml_declaration=False)
        return f'<?xml version="1.0"?>\n{text.decode("ascii")}\n'

    def _add_body(self, number: int) -> None:
        """Add a body's link, and the joints that connect it to its parent's link."""
        place = self._place(number)
        if place is None:
            self.moves_otherwise["bodies that move freely relative to the root"] += 1
            return
        parent = self.links[int(self.model.body_parentid[number])]
        name, joints = self._plain(self.model.body(number).name), self._joints(number)
        if name == ROOT and number == FIRST and not joints:
            self.links[number] = parent
        else:
            own = name if name and name != ROOT else self._unused("link", name or f"body_{number}")
            own = self._unused("link", f"{own}_link") if own in self.moving else own
            self.links[number] = self._lead(parent, joints, place, own)
        self._add_inertia(self.links[number], number)

    def _mimics(self) -> dict[int, Coupling]:
        """Return the linear couplings, keyed by the follower's MuJoCo ID. None of their leaders follows another joint.

        robot_state_publisher cannot place a joint that mimics a mimicking joint.
        """
        found: dict[int, Coupling] = {}
        couplings = couplings_of(self.model)
        for step in follow(couplings, roots(couplings)):
            if step.is_linear:
                found[step.follower] = step.after(found[step.leader]) if step.leader in found else step
        return {follower: each for follower, each in found.items() if self._joint_name(each.leader) in self.published}

    def _other_equalities(self) -> int:
        """Count the active equalities that move joints in the description but are missing from it."""
        between_joints = (each.follower for each in couplings_of(self.model) if each.follower not in self.mimics)
        kinds = (mujoco.mjtEq(self.model.eq_type[each]).name for each in active_equalities(self.model))
        moved = [joint for joint in between_joints if self._joint_name(joint) in self.published]
        return len(moved) + sum(kind in NOT_COMPUTED for kind in kinds)

    def _joint_name(self, joint: int) -> str:
        return self._plain(self.model.joint(joint).name)

    def _place(self, number: int) -> Matrix | None:
        """Return a body's pose at rest, in its parent's frame.

        Return None if the body moves freely, because joint states don't describe free motion. If the parent is the
        world, the pose is relative to the root instead.
        """
        model = self.model
        place = pose(model.body_pos[number], model.body_quat[number])
        if model.body_parentid[number] != WORLD:
            return place
        if number != FIRST and (self._is_free(number) or self._is_free(FIRST)):
            return None
        return np.linalg.inv(pose(model.body_pos[FIRST], model.body_quat[FIRST])) @ place

    def _lead(self, parent: Element, joints: list[int], place: Matrix, name: str) -> Element:
        """Add a link, and the joints that lead to it.

        URDF allows only one joint between two links, and the joint's axis must pass through the child's origin. This
        function therefore adds massless links between joints, and a link on the axis if the axis does not pass through
        the body's origin.
        """
        for joint in joints:
            anchor, at_zero = self._axis(joint)
            here, place = place @ anchor @ at_zero, np.linalg.inv(anchor)
            ends = joint == joints[-1] and not place[:3, 3].any()
            joint_name = self._joint_name(joint)
            link = self._add_link(name if ends else self._unused("link", f"{joint_name}_axis"))
            self._add_moving_joint(joint, joint_name, parent, link, here)
            if ends:
                return link
            parent = link
        return self._add_fixed(parent, name, place)

    def _joints(self, number: int) -> list[int]:
        """Return the MuJoCo IDs of a body's movable joints; count the joints that become fixed."""
        model, moving = self.model, []
        start = int(model.body_jntadr[number])
        for joint in range(start, start + int(model.body_jntnum[number])):
            kind, name = int(model.jnt_type[joint]), model.joint(joint).name
            if self._plain(name) in self.moving:
                moving.append(joint)
            elif kind == BALL:
                self.moves_otherwise["ball joints, which become fixed"] += 1
            elif kind != FREE and not name:
                self.moves_otherwise["unnamed joints, which become fixed"] += 1
            elif kind != FREE:
                self.left_out["joints in hidden groups, which become fixed"] += 1
        return moving

    def _is_free(self, number: int) -> bool:
        joint = self.model.body_jntadr[number]
        return bool(joint >= 0 and self.model.jnt_type[joint] == FREE)

    def _axis(self, joint: int) -> tuple[Matrix, Matrix]:
        """Return a joint's anchor in its body, and the transform from the model's initial position to the joint's zero.

        A slide joint has no anchor. A joint's initial position in the model need not be 0 (``ref`` in MJCF).
        """
        axis, begins = self.model.jnt_axis[joint], float(self.model.qpos0[self.model.jnt_qposadr[joint]])
        if self.model.jnt_type[joint] == SLIDE:
            return np.eye(4), shift(-begins * axis)
        return shift(self.model.jnt_pos[joint]), turn(axis, -begins)

    def _add_link(self, name: str) -> Element:
        return SubElement(self.robot, "link", name=name)

    def _add_fixed(self, parent: Element, name: str, place: Matrix) -> Element:
        link = self._add_link(name)
        self._add_joint(self._unused("joint", f"{name}_fixed"), "fixed", parent, link, place)
        return link

    def _add_joint(self, name: str, kind: str, parent: Element, child: Element, place: Matrix) -> Element:
        element = SubElement(self.robot, "joint", name=name, type=kind)
        add_origin(element, place)
        SubElement(element, "parent", link=parent.attrib["name"])
        SubElement(element, "child", link=child.attrib["name"])
        return element

    def _add_moving_joint(self, joint: int, name: str, parent: Element, child: Element, place: Matrix) -> None:
        turns = "revolute" if self.model.jnt_limited[joint] else "continuous"
        kind = "prismatic" if self.model.jnt_type[joint] == SLIDE else turns
        element = self._add_joint(name, kind, parent, child, place)
        SubElement(element, "axis", xyz=numbers(self.model.jnt_axis[joint]))
        add_limit(element, self.model, joint)
        add_dynamics(element, self.model, joint)
        if joint in self.mimics:
            _, leader, (offset, multiplier) = self.mimics[joint]
            factors = {"multiplier": numbers([multiplier]), "offset": numbers([offset])}
            SubElement(element, "mimic", {"joint": self._joint_name(leader), **factors})

    def _add_inertia(self, link: Element, number: int) -> None:
        """Add a link's mass and inertia, converted from MuJoCo's principal axes to the link's axes."""
        model = self.model
        if model.body_mass[number] <= NO_MASS:
            return
        element = SubElement(link, "inertial")
        add_origin(element, shift(model.body_ipos[number]))
        SubElement(element, "mass", value=numbers([model.body_mass[number]]))
        axes = pose((0.0, 0.0, 0.0), model.body_iquat[number])[:3, :3]
        tensor = axes @ np.diag(model.body_inertia[number]) @ axes.T
        parts = {f"i{'xyz'[i]}{'xyz'[j]}": numbers([tensor[i, j]]) for i in range(3) for j in range(i, 3)}
        SubElement(element, "inertia", parts)

    def _add_geom(self, geom: int) -> None:
        number = int(self.model.geom_bodyid[geom])
        if number == WORLD:
            self.left_out["shapes outside of bodies"] += 1
        elif number in self.links and (missing := add_shapes(self.links[number], self.model, geom)):
            self.left_out[missing] += 1

    def _add_sensors(self) -> None:
        """Add a link for each sensor on a site, named after the sensor, and one for each camera's optical frame."""
        model = self.model
        sensors = np.flatnonzero(model.sensor_objtype == int(mujoco.mjtObj.mjOBJ_SITE)).tolist()
        cameras = map(model.camera, range(model.ncam))
        frames: list[tuple[str, Any, Matrix]] = [
            *((model.sensor(i).name or f"sensor_{i}", model.site(model.sensor_objid[i]), np.eye(4)) for i in sensors),
            *((f"{camera.name or camera.id}_optical", camera, OPTICAL) for camera in cameras),
        ]
        for name, found, turned in frames:
            body = int(found.bodyid[0])
            if body != WORLD and body in self.links:
                own = self._unused("link", self._plain(name))
                self._add_fixed(self.links[body], own, pose(found.pos, found.quat) @ turned)

    def _say_what_is_missing(self) -> None:
        """List omissions in a comment at the top, and log those that change how the description moves.

        The comment contains no colon, because ``ros2 run ... -p robot_description:="$(tank urdf tank)"`` parses the
        text as YAML.
        """
        missing = +(self.left_out + self.moves_otherwise)
        if missing:
            self.robot.insert(0, Comment(f" Differences from the MuJoCo model are {_counted(missing)} "))
        if self.moves_otherwise:
            others = _counted(self.moves_otherwise)
            _log.warning(
                "the robot description of %s does not reproduce all movements of the robot: %s", self.body.name, others
            )

    def _plain(self, name: str) -> str:
        """Return a name as written in the model's file, without the body's prefix."""
        return name.removeprefix(f"{self.body.name}/")

    def _unused(self, kind: str, name: str) -> str:
        """Return this name, or a name derived from it if another link or joint already has this name."""
        while name in self.names[kind]:
            name += "_"
        self.names[kind].add(name)
        return name


def _counted(what: Counter[str]) -> str:
    return "; ".join(f"{name} ({count})" for name, count in what.items())
