"""The parts of the course that belong to no step."""

BESIDE = {"referee", "robot_description_publisher", "tank_server"}
"""Controllers that no notebook builds: files of ``tutorial/controllers/`` without the suffix."""
