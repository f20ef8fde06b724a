"""What the course has beside its steps."""

BESIDE = {"robot_description_publisher"}
"""Controllers that no notebook builds: files of ``tutorial/controllers/`` without the suffix."""
