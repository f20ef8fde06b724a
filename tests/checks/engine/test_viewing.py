"""The steps of a viewer's cases."""

from sensor_msgs.msg import JointState

from tutorial.checks.engine.trial import Trial
from tutorial.checks.engine.viewer import Viewer
from tutorial.checks.engine.viewing import hands_over, heard, side_by_side, steps
from tutorial.checks.keep_up import CalmViewer

MESSAGE = JointState(name=["TURRET_P", "LUFF"], position=[0.2, 0.3])
MOVED = "TURRET_Y at 0, TURRET_P at 0.2"


def observed(*done):
    return steps(*done)(Trial(CalmViewer))


def test_steps():
    assert observed(heard(MESSAGE), Viewer.where, Viewer.where) == MOVED
    assert observed(hands_over(MESSAGE, MESSAGE)) == "a call is posted for 2 of 2 messages"
    assert observed(side_by_side(lambda viewer: viewer.body.name)) == "Rover and Lift"
