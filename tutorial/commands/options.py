"""Options that several commands of ``tank`` share."""

import math
from functools import partial
from pathlib import Path
from typing import Any

import click


class Finite(click.FloatRange):
    """A finite number: neither "nan" nor "inf"."""

    name = "number"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Parse the number, or fail with a usage error."""
        number: float = super().convert(value, param, ctx)
        return number if math.isfinite(number) else self.fail(f"{value!r} is not a number.", param, ctx)


Seconds = partial(Finite, max=1_000_000)
"""A number of seconds, up to a million (about eleven and a half days)."""

duration_option = click.option(
    "--duration",
    type=Seconds(min=0, min_open=True),
    metavar="SECONDS",
    envvar="TANK_DURATION",
    help="Stop after this many seconds; by default, run until Ctrl-C.",
)
linger_option = click.option(
    "--linger",
    type=Seconds(min=0),
    default=0.0,
    metavar="SECONDS",
    envvar="TANK_LINGER",
    help="After the duration, wait up to SECONDS for the other programs to exit.",
)
report_option = click.option(
    "--report",
    type=click.Path(file_okay=False, path_type=Path),
    metavar="DIR",
    envvar="TANK_REPORT",
    help="Write measurements to DIR/NODE.json.",
)
LAYOUT = (
    "Race along this line: its name, or a YAML file that contains, for example, "
    "'points: [[-2, -0.5], [0, -1], [2, -1.3], [2.6, -0.5]]'."
)
headless_option = click.option("--headless", is_flag=True, envvar="TANK_HEADLESS", help="Don't show the 3D view.")


def part_class(given: str) -> tuple[Path, str | None]:
    """Split ``FILE:CLASS``, which names a controller in a Python file. The class is None for ``FILE`` alone."""
    file, _, name = given.rpartition(":")
    return (Path(file), name) if file and name.isidentifier() else (Path(given), None)
