"""A reading of URDF that shares nothing with what writes it: links and joints, and where the links are."""

from __future__ import annotations

from math import asin, atan2, cos, hypot, pi, sin
from xml.etree import ElementTree

import numpy as np


def rotation_about(axis, angle):
    """Turn about an axis, after Rodrigues."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sin(angle) * cross + (1 - cos(angle)) * cross @ cross


def rotation_of(w, x, y, z):
    """The matrix of a unit quaternion."""
    half = np.array([x, y, z])
    sine = np.linalg.norm(half)
    return rotation_about(half / sine, 2 * atan2(sine, w)) if sine else np.eye(3)


def angle(rotation):
    """How far a rotation turns [rad], exactly also where that is little."""
    sine = hypot(*(rotation - rotation.T)[[2, 0, 1], [1, 2, 0]]) / 2
    return asin(min(sine, 1.0)) if np.trace(rotation) > 1 else pi - asin(min(sine, 1.0))


def matrix_of(rotation=None, position=(0, 0, 0)):
    matrix = np.eye(4)
    if rotation is not None:
        matrix[:3, :3] = rotation
    matrix[:3, 3] = position
    return matrix


def is_at(matrix, data, number):
    """Whether a pose is that of one of MuJoCo's bodies, to a micrometre and a microradian."""
    off, turned = matrix[:3, 3] - data.xpos[number], matrix[:3, :3].T @ data.xmat[number].reshape(3, 3)
    return np.abs(off).max() < 1e-6 and angle(turned) < 1e-6


def numbers(text):
    return [float(part) for part in text.split()]


class Robot:
    """A URDF document.

    Attributes:
        links: the elements by name.
        joints: likewise.
        comment: the first one, or None.
    """

    def __init__(self, text):
        builder = ElementTree.TreeBuilder(insert_comments=True)
        robot = ElementTree.fromstring(text, ElementTree.XMLParser(target=builder))
        self.links = {link.get("name"): link for link in robot.findall("link")}
        self.joints = {joint.get("name"): joint for joint in robot.findall("joint")}
        comments = [each.text for each in robot if each.tag is ElementTree.Comment]
        self.comment = comments[0] if comments else None
        assert len(self.links) == len(robot.findall("link"))
        assert len(self.joints) == len(robot.findall("joint"))

    def origin(self, element):
        """The pose in its ``<origin>``, 4 x 4: roll, pitch and yaw are about the fixed axes x, y and z."""
        origin = element.find("origin")
        if origin is None:
            return np.eye(4)
        roll, pitch, yaw = numbers(origin.get("rpy", "0 0 0"))
        turned = rotation_about((0, 0, 1), yaw) @ rotation_about((0, 1, 0), pitch) @ rotation_about((1, 0, 0), roll)
        return matrix_of(turned, numbers(origin.get("xyz", "0 0 0")))

    def link_poses(self, positions):
        """Where each link is in the root, by name, 4 x 4; joints that are not named are at 0."""
        children = {joint.find("child").get("link"): joint for joint in self.joints.values()}
        (root,) = self.links.keys() - children.keys()

        def pose(name):
            if name == root:
                return np.eye(4)
            joint = children[name]
            moved = self._motion(joint, positions.get(joint.get("name"), 0.0))
            return pose(joint.find("parent").get("link")) @ self.origin(joint) @ moved

        return {name: pose(name) for name in self.links}

    def center_of_mass(self, link):
        return self.origin(self.links[link].find("inertial"))[:3, 3]

    def inertia(self, link):
        """About the centre of mass, along the link's axes, 3 x 3 [kg.m^2]."""
        inertial = self.links[link].find("inertial")
        part = {name: float(value) for name, value in inertial.find("inertia").attrib.items()}
        tensor = np.array([[part[f"i{min(a, b)}{max(a, b)}"] for b in "xyz"] for a in "xyz"])
        turned = self.origin(inertial)[:3, :3]
        return turned @ tensor @ turned.T

    def _motion(self, joint, position):
        if joint.get("type") == "fixed":
            return np.eye(4)
        axis = numbers(joint.find("axis").get("xyz"))
        if joint.get("type") == "prismatic":
            return matrix_of(position=np.asarray(axis) * position)
        return matrix_of(rotation_about(axis, position))
