"""The command ``tank urdf``: a robot's description, for programs that read it from a file."""

# ruff: noqa: PLC0415 - MuJoCo is slow to import, and help must be fast

from __future__ import annotations

import click

from tutorial.printing import say


@click.command(short_help="Print a robot's description, a URDF.")
@click.argument("model")
def urdf(model: str) -> None:
    """Print MODEL as URDF: an MJCF file, or the name of one of the tutorial's, such as tank.

    It is what RobotDescriptionPublisher publishes: tank urdf tank > tank.urdf.
    """
    from tutorial.body import Body
    from tutorial.description.urdf import robot_description
    from tutorial.paths import find_model
    from tutorial.world import Placement

    path = find_model(model)
    say(robot_description(Body.displayed(Placement(path.stem.capitalize(), path))))
