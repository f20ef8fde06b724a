"""Bodies that do not move by themselves."""

from tutorial.checks.engine.bodies import bodies, displayed_body, scratch
from tutorial.checks.engine.trial import Trial
from tutorial.handoff import ThreadGuard


def test_bodies_are_made_once_and_reset():
    trial = Trial(int)
    displayed, simulated = bodies(trial, "tank", "Rover")
    simulated.data.qvel[:] = 1.0
    assert bodies(trial, "tank", "Rover") == (displayed, simulated)
    assert not simulated.data.qvel.any()
    assert displayed_body(trial, "tank", "Rover", ThreadGuard("it")) is not displayed
    assert scratch(trial, "tank", "Rover") is scratch(trial, "tank", "Rover")
