"""The comparison with other viewers: its table is what the models show, and the models do what their sources say."""

import math

import pytest
from comparison import COMPARED, PAGE, RANGES, TABLE, judge, table
from sensor_msgs.msg import JointState
from viewers import (
    ChoreonoidTutorial,
    Foxglove,
    JointStatePublisher,
    PlotJuggler,
    RobotStatePublisher,
    TankTutorial,
)

NOTHING_TO_SAY = {"subset", "drop"}  # the one is allowed, the other cannot be known


def message(seconds, names, positions):
    made = JointState(name=names, position=positions)
    made.header.stamp.sec = seconds
    return made


def shown(kind, *messages):
    """The pose after some messages, and what was said about each."""
    viewer = kind(RANGES)
    said = [viewer.take(each) for each in messages]
    return viewer.pose, said


def test_the_table_in_the_book_is_what_the_models_show():
    """If it is not: ``PYTHONPATH=tests/support python tests/support/comparison.py`` writes it anew."""
    assert TABLE.search(PAGE.read_text(encoding="utf-8"))[0] == table()


def test_this_viewer_is_silent_only_where_there_is_nothing_to_say():
    silent = {fault for fault in COMPARED if judge(TankTutorial, fault).endswith("silent")}
    assert silent == NOTHING_TO_SAY


def test_the_original_goes_by_index():
    swapped = message(1, ["TURRET_P", "TURRET_Y"], [0.1, 0.5])
    assert shown(ChoreonoidTutorial, swapped) == ({"TURRET_Y": 0.0, "TURRET_P": 0.0}, [False])


def test_robot_state_publisher_goes_by_the_stamp_of_each_joint():
    both, one = ["TURRET_Y", "TURRET_P"], ["TURRET_P"]
    pose, said = shown(RobotStatePublisher, message(9, both, [0.5, 0.1]), message(8, both, [0.6, 0.2]))
    assert (pose, said) == ({"TURRET_Y": 0.5, "TURRET_P": 0.1}, [False, False])
    pose, said = shown(RobotStatePublisher, message(9, one, [0.1]), message(8, both, [0.6, 0.2]))
    assert pose == {"TURRET_Y": 0.6, "TURRET_P": 0.1}  # of the other, tf2 has something newer
    pose, said = shown(RobotStatePublisher, message(9, both, [0.5]), message(10, [*both, "TURRET_Y"], [0.6, 0.2, 0.7]))
    assert (pose, said) == ({"TURRET_Y": 0.6, "TURRET_P": 0.2}, [True, False])
    pose, said = shown(RobotStatePublisher, message(9, both, [math.nan, 0.1]))
    assert (pose, said) == ({"TURRET_Y": 0.0, "TURRET_P": 0.1}, [True])


@pytest.mark.parametrize(
    ("kind", "position", "ended"),
    [(JointStatePublisher, 0.1, True), (Foxglove, 0.0, False), (PlotJuggler, 0.1, False), (TankTutorial, 0.1, False)],
)
def test_what_a_missing_position_becomes(kind, position, ended):
    viewer = kind(RANGES)
    viewer.take(message(1, ["TURRET_Y", "TURRET_P"], [0.5, 0.1]))
    viewer.take(message(2, ["TURRET_Y", "TURRET_P"], [0.6]))
    assert viewer.pose == {"TURRET_Y": 0.6, "TURRET_P": position}
    assert viewer.ended == ended
