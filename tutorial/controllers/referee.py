"""The referee of a race: it sees the true state of the world and publishes the score."""

import json
import math
from collections import Counter

import mujoco
import numpy as np
from std_msgs.msg import String

from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.errors import TutorialError
from tutorial.model.line_file import line_points
from tutorial.race.rules import LIMIT, REACH, Race, Result

CHECKS = 200  # [Hz] how often to check the tank's position and contacts, in simulated time
MESSAGES = 2  # [Hz] how often to publish the score and count the publishers
SHARED = ("/rosout", "/parameter_events")  # topics that every node in the real ROS 2 publishes on


class Referee(SimpleController):
    """Judge a body's race along the line in the world, and publish the score as JSON.

    A race is fair if exactly one node publishes on ``joy``, no other node publishes on the simulation's topics, and
    only the motors move the tank.
    """

    limit = LIMIT  # [s] maximum duration of a race
    begun = False

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Create the publisher. Its topic is named after the body."""
        self.node, self.body, self.call_latest = config.node, config.body, config.call_latest
        self.publisher = self.node.create_publisher(String, f"{self.body.name}/race", 10)

    def initialize(self, io: ControllerIO) -> None:  # simulation thread, before the first step
        """Find the line and the things that the tank can touch. If the simulation restarts, the race continues."""
        if self.begun:
            return
        self.io, self.start = io, io.time
        line = line_points(io.body.model, io.body.data).tolist()
        if not line:
            raise TutorialError("there is no line in this world. Add a line to the project: 'model: race/bend.yaml'.")
        x, y, _ = io.body.position
        if math.dist(line[0], (x, y)) > REACH:
            where = f"at {line[0]}, more than {REACH:g} m from the tank"
            raise TutorialError(f"the line begins {where}. Make it begin at the tank, at [{x:.2f}, {y:.2f}].")
        self.race = Race(line, self.limit)
        self.names = _geom_names(io.body.model)
        self.floor = set(np.flatnonzero(io.body.model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE).tolist())
        self.expected = Counter(each.topic_name for each in self.node.publishers if each.topic_name not in SHARED)
        self.expected[self.node.resolve_topic_name("joy")] += 1
        self.steps_per_check = round(1 / (CHECKS * io.time_step))
        self.checks_per_message = CHECKS // MESSAGES
        self.checks = 0
        self.begun = True

    def control(self) -> None:  # simulation thread, every step
        """Check the tank when a check is due, and publish the score when a message is due."""
        if self.race.over or self.io.step % self.steps_per_check:
            return
        touched, on_rail = self.contacts()
        self.race.update(self.io.time - self.start, tuple(self.io.body.position.tolist()), touched, on_rail)
        data = self.io.body.data
        if data.xfrc_applied.any() or data.qfrc_applied.any():
            self.race.disqualify("the tank is moved by something other than its motors")
        self.checks += 1
        if self.race.over or self.checks % self.checks_per_message == 0:
            self.count_publishers()
            self.publisher.publish(String(data=json.dumps(self.race.result.as_dict())))
            self.call_latest("race", self.show, self.race.result)

    def contacts(self) -> tuple[set[str], bool]:
        """Return the names of the things that the tank touches, and whether its barrel touches the rail."""
        touched, on_rail = set(), False
        for one, other in self.io.body.data.contact.geom.tolist():
            if self.is_mine(one) == self.is_mine(other):
                continue
            part, thing = (one, other) if self.is_mine(one) else (other, one)
            if thing in self.floor:
                continue
            if self.names[part].endswith("/BARREL") and self.names[thing].endswith("/RAIL"):
                on_rail = True
            else:
                touched.add(self.names[thing])
        return touched, on_rail

    def is_mine(self, geom: int) -> bool:
        """Return whether a geom is part of the tank."""
        return self.names[geom].startswith(f"{self.io.body.name}/")

    def count_publishers(self) -> None:
        """End the race if a topic has more publishers than it should have."""
        for topic, expected in self.expected.items():
            count = self.node.count_publishers(topic)
            if count > expected:
                self.race.disqualify(f"{count} publishers on {topic}, not {expected}")

    def show(self, result: Result) -> None:  # main thread
        """Show the state of the race in the line below the view."""
        self.body.note = str(result)

    def unconfigure(self) -> None:  # main thread
        """Destroy the publisher."""
        self.node.destroy_publisher(self.publisher)


def _geom_names(model: mujoco.MjModel) -> list[str]:
    """Return a name for each geom, with its body's name as a prefix.

    A geom without its own name gets the name of its MuJoCo body.
    """
    return [model.geom(i).name or model.body(model.geom_bodyid[i]).name for i in range(model.ngeom)]
