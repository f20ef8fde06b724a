"""Step 10: answer requests, and let other programs tune the controller."""

from collections.abc import Callable, Sequence
from math import sqrt
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool, Trigger

from tutorial.body import Joint
from tutorial.controller import ControllerConfig, ControllerIO
from tutorial.controllers.tank_controller import D_GAIN, P_GAIN, STEP_AT_FULL_STICK, AimedJoint, TankController
from tutorial.errors import RefusedError
from tutorial.handoff import Latest

INERTIA = 0.34  # [kg.m^2] of the turret with its barrel, about the turret's axis


class TankServer(TankController):
    """Drive as in step 1, offer two services, and read the gains from parameters."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Declare the gains as parameters, and create the services. All names begin with the body's name."""
        super().configure(config)
        name, self.ask = config.body.name, config.ask
        p_gain = ("p_gain", P_GAIN, gain("stiffness of turret and barrel [N.m/rad]", 1000.0))
        d_gain = ("d_gain", D_GAIN, gain("damping of turret and barrel [N.m.s/rad]", 100.0))
        declared = self.node.declare_parameters(name, [p_gain, d_gain])
        self.gains = Latest({parameter.name: parameter.value for parameter in declared})
        self.node.add_on_set_parameters_callback(self.check_gains)
        self.node.add_post_set_parameters_callback(self.use_gains)
        self.motors_on = True
        self.reset_service = self.node.create_service(Trigger, f"{name}/reset", self.on_reset)
        self.motors_service = self.node.create_service(SetBool, f"{name}/set_motors", self.on_set_motors)

    def on_reset(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:  # executor's thread
        """Have the tank moved back to its starting position, and respond when it is there."""
        return self.answer(response, self.reset)

    def on_set_motors(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Have the motors switched on or off, and respond afterwards."""
        return self.answer(response, self.set_motors, request.data)

    def answer(self, response: Any, function: Callable[..., str], *args: object) -> Any:  # executor's thread
        """Have the simulation thread call a function, and report its result or the refusal in the response."""
        try:
            response.message = self.ask(function, *args)
            response.success = True
        except RefusedError as refusal:
            response.message = str(refusal)
        return response

    def check_gains(self, parameters: Sequence[Parameter]) -> SetParametersResult:  # executor's thread
        """Reject gains that would make the turret or barrel oscillate. ROS 2 itself checks the range of each gain."""
        p_gain, d_gain = self.tuned(parameters).values()
        least = sqrt(2.0 * INERTIA * p_gain)  # the damping ratio is then 0.7
        if d_gain < least:
            reason = f"with a p_gain of {p_gain:g}, a d_gain of {d_gain:g} lets the turret swing: {least:.1f} is enough"
            return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def use_gains(self, parameters: Sequence[Parameter]) -> None:  # executor's thread: put and return
        """Use the new gains from the next step on."""
        self.gains.put(self.tuned(parameters))

    def tuned(self, parameters: Sequence[Parameter]) -> dict[str, float]:
        """Return all gains, updated with those that are being set. The argument can also contain other parameters."""
        new = {parameter.name: parameter.value for parameter in parameters}
        return {name: new.get(name, value) for name, value in self.gains.get().items()}

    def initialize(self, io: ControllerIO) -> None:  # simulation thread, before the first step
        """Look up the tracks and the joints, as in step 1, but make the joints use the newest gains."""
        super().initialize(io)
        self.io = io
        self.turret = TunedJoint(io.body.joint("TURRET_Y"), io.time_step, self.gains)
        self.barrel = TunedJoint(io.body.joint("TURRET_P"), io.time_step, self.gains)

    def control(self) -> None:  # simulation thread, every step
        """Drive as in step 1, unless the motors are off."""
        super().control()
        if not self.motors_on:
            self.track_l.ctrl = self.track_r.ctrl = self.turret.joint.effort = self.barrel.joint.effort = 0.0

    def reset(self) -> str:  # simulation thread, between two steps
        """Move the tank back to its starting position, and hold its joints at their initial positions."""
        self.io.body.reset()
        self.initialize(self.io)
        return f"{self.io.body.name} is back at its starting position"

    def set_motors(self, on: bool) -> str:  # simulation thread, between two steps
        """Switch the motors on or off."""
        self.motors_on = on
        return f"the motors are {'on' if on else 'off'}"

    def unconfigure(self) -> None:  # main thread
        """Stop answering and listening."""
        self.node.destroy_service(self.reset_service)
        self.node.destroy_service(self.motors_service)
        self.node.remove_on_set_parameters_callback(self.check_gains)
        self.node.remove_post_set_parameters_callback(self.use_gains)
        for name in self.gains.get():
            self.node.undeclare_parameter(name)
        super().unconfigure()


class TunedJoint(AimedJoint):
    """An aimed joint whose gains can change at every step."""

    def __init__(self, joint: Joint, time_step: float, gains: Latest[dict[str, float]]) -> None:
        super().__init__(joint, time_step)
        self.gains = gains

    def aim(self, stick: float) -> None:
        """Move the reference angle as in step 1, and compute the torque from the newest gains."""
        lower, upper = self.joint.range
        q_ref = min(max(self.q_ref + STEP_AT_FULL_STICK * stick, lower), upper)
        dq_ref = (q_ref - self.q_ref) / self.time_step

        q = self.joint.position
        dq = (q - self.q_prev) / self.time_step
        p_gain, d_gain = self.gains.get().values()
        self.joint.effort = p_gain * (q_ref - q) + d_gain * (dq_ref - dq)

        self.q_ref, self.q_prev = q_ref, q


def gain(description: str, largest: float) -> ParameterDescriptor:
    """Return the descriptor for a gain that ranges from 0 to a maximum."""
    limits = FloatingPointRange(from_value=0.0, to_value=largest)
    return ParameterDescriptor(description=description, floating_point_range=[limits])
