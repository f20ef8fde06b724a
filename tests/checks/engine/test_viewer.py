"""A controller on a displayed body."""

from contextlib import closing

import pytest
from sensor_msgs.msg import JointState

from tutorial.checks.engine.failure import Failure
from tutorial.checks.engine.trial import Trial
from tutorial.checks.engine.viewer import Viewer
from tutorial.checks.show import MyViewer

MESSAGE = JointState(name=["TURRET_P"], position=[0.2])


class Hurries(MyViewer):
    def on_joint_state(self, message):
        self.update(message)


def test_posted_calls_run_later():
    with closing(Viewer(Trial(MyViewer))) as viewer:
        viewer.receive(MESSAGE)
        assert (viewer.where(), len(viewer.calls)) == ("TURRET_Y at 0, TURRET_P at 0", 1)
        viewer.drain()
        assert viewer.where() == "TURRET_Y at 0, TURRET_P at 0.2"
        assert viewer.news() == "its links follow, observers are notified"
        assert viewer.leaves(MESSAGE) == viewer.where()
        assert viewer.left() == "nothing is left"


def test_a_callback_that_touches_the_body():
    with closing(Viewer(Trial(Hurries))) as viewer, pytest.raises(Failure) as info:
        viewer.receive(MESSAGE)
    assert str(info.value.error) == "it uses the body outside the main thread"
