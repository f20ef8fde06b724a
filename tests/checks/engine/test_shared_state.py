"""State that an answer keeps outside its objects."""

import pickle

from rclpy.qos import qos_profile_sensor_data

from tutorial.checks.engine.shared_state import SharedState, cause_of_sharing, outside, pickled

KEPT = []
append = []  # has the name of a method that `Keeps` calls


class Keeps:
    seen = []

    def keep(self, where=KEPT):
        self.seen.append(where)


def test_changed_state_is_named():
    state = SharedState(Keeps)
    assert state.changed() == ""
    Keeps().keep()
    assert state.changed() == "Keeps.seen"
    assert "self.seen = ..., in __init__" in cause_of_sharing(Keeps, "Keeps.seen")
    assert "In each call" in cause_of_sharing(Keeps.keep, "KEPT")


def test_state_outside_the_objects():
    assert {name for name, _ in outside(Keeps)} == {"Keeps.seen", "the default value of the argument where"}
    assert pickled(KEPT)


def test_a_qos_profile_reaches_the_process():
    assert pickle.loads(pickled(qos_profile_sensor_data)) == qos_profile_sensor_data
