"""One program of the page: a node, the tank, and its controllers. The visitor edits one of them."""

import asyncio
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import rclpy
from pyodide.ffi import to_js
from rclpy._middleware import wires
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import Joy

from tutorial.body import Body, State
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.errors import describe_error
from tutorial.handoff import CallQueue
from tutorial.program.controller_files import find_controller, load_controllers
from tutorial.ros.joy import joy_message

TIME_STEP = 0.001  # [s]
LONGEST_DEBT = 0.25  # [s] maximum backlog of real time to catch up on, as in the course's simulation
LONGEST_TURN = 0.03  # [s] how long stepping can take before the page's messages get a turn


class Program:
    """A program. Everything in it runs on one thread, because a browser's worker has only one.

    Args:
        mujoco: the browser's MuJoCo.
        setup: the program's setup from ``book/drive_page.py``.
        wire: the functions that send bytes and announcements to the page's other programs.
        say: called with the report of each matched message, a line of text.
    """

    def __init__(self, mujoco: Any, setup: Any, wire: Any, say: Any) -> None:
        setup = setup.to_py()
        self.state = State(mujoco, setup["xml"])
        self._own = setup["controller"]
        self._file = Path(setup["file"]).absolute()
        self._bodies = [Body(self.state, "Tank", setup["joints"], setup["actuators"]) for _ in range(2)]
        self._bodies[0].on_change(lambda report: None if report is None else say(str(report)))
        self.wire = wires[0]
        self.wire.send, self.wire.announce = wire.send, wire.announce
        rclpy.init(args=[], domain_id=0)
        self._executor = SingleThreadedExecutor()
        self._node = self._make_node(setup["node"])
        self._calls = CallQueue(asyncio.get_event_loop())
        if setup["simulates"]:
            self._joystick = self._make_node("joystick").create_publisher(Joy, "joy", 1)
        self._controllers: dict[str, tuple[SimpleController, ControllerIO, Callable[[], None]]] = {}
        self._simulates = setup["simulates"]
        self.step, self._started_at = 0, 0.0
        for name in setup["others"]:
            self._start(name, find_controller(name))

    def run(self, source: str) -> str:
        """Replace the previous controller with the visitor's controller; return the error message or ""."""
        self._file.write_text(source)
        return self._attempt(self._replace)

    def reset(self) -> str:
        """Restart at time 0 in the initial pose, and initialize the controllers again; return the error message."""
        return self._attempt(self._restart)

    def turn(self, now: float) -> Any:
        """Run the callbacks and steps that are due at a time on the page's clock [s].

        Returns:
            The error message, the number of simulated steps, and each joint's name, position [rad] and effort [N.m].
        """
        error = "" if self._has_failed else self._attempt(self._work, now)
        return to_js([error, self.step, [[each.name, each.position, each.effort] for each in self._bodies[0].joints]])

    def sticks(self, axes: Any, buttons: Any) -> None:
        """Publish the joystick's axes and buttons."""
        self._joystick.publish(joy_message(self._node, axes.to_py(), buttons.to_py()))

    def advance(self) -> None:
        """Call every controller's `control`, and step MuJoCo once."""
        for name, (controller, io, _) in self._controllers.items():
            io.step, self._at_work = self.step, name
            controller.control()
        self._at_work = ""
        self.state.step()
        self.step += 1

    def _attempt(self, do: Callable[..., None], *arguments: object) -> str:
        """Call a function that runs controllers. After an error, stop and return the message as in the course."""
        self._has_failed, self._at_work = False, ""
        try:
            do(*arguments)
        except BaseException as error:  # noqa: BLE001 - the page shows every error
            self._has_failed = True
            text = describe_error(error, str(self._file))
            if self._at_work:
                return f"{self._at_work} failed at {self.step * TIME_STEP:.3f} s of simulated time: {text}"
            return str(error) if isinstance(error.__cause__, Exception) else text
        return ""

    def _make_node(self, name: str) -> Node:
        node = Node(name)
        self._executor.add_node(node)
        return node

    def _replace(self) -> None:
        if self._own in self._controllers:
            controller, _, leave = self._controllers.pop(self._own)
            try:
                controller.unconfigure()
            finally:
                leave()
        self._start(self._own, load_controllers(self._file, only=self._own)[self._own])

    def _start(self, name: str, controller_class: type[SimpleController]) -> None:
        displayed, simulated = self._bodies
        scope, others = self._calls.scope(name), self._node._entities

        def leave() -> None:
            scope.close()
            for entity in set(self._node._entities) - set(others):
                self._node._remove(entity)

        controller, io = controller_class(), ControllerIO(simulated, TIME_STEP)
        try:
            controller.configure(ControllerConfig(displayed, self._node, scope.call_later, scope.call_latest))
        except BaseException:
            leave()
            raise
        self._controllers[name] = (controller, io, leave)
        if self._simulates:
            io.step, self._at_work = self.step, name
            controller.initialize(io)

    def _restart(self) -> None:
        self.state.reset()
        self.step, self._started_at = 0, 0.0
        for name, (controller, io, _) in self._controllers.items():
            io.step, self._at_work = 0, name
            controller.stop()
            controller.initialize(io)

    def _work(self, now: float) -> None:
        for _ in range(1 + sum(len(getattr(each, "samples", ())) for each in self.wire.own_endpoints())):
            self._executor.spin_once(timeout_sec=0)
        error, self._calls.error = self._calls.error, None
        if error:
            raise error
        if self._simulates:
            self._step(now)

    def _step(self, now: float) -> None:
        """Step until simulated time has caught up with the page's clock [s], but for no longer than `LONGEST_TURN`."""
        self._started_at = max(self._started_at, now - self.step * TIME_STEP - LONGEST_DEBT)
        due = int((now - self._started_at) / TIME_STEP) - self.step
        self.state.look_up()
        deadline = time.perf_counter() + LONGEST_TURN
        for _ in range(due):
            self.advance()
            if time.perf_counter() > deadline:
                break
