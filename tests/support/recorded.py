"""What a real ``ros2`` printed, from tests/support/data."""

from __future__ import annotations

import re
from pathlib import Path

RECORDED = (Path(__file__).parent / "data" / "ros2_cli.txt").read_text(encoding="utf-8")


def recorded(command: str) -> str:
    """What a command printed, standard error included."""
    return _row(command)[1]


def recorded_status(command: str) -> int:
    """A command's exit status."""
    return int(_row(command)[2])


def masked(text: str) -> str:
    """Hide what differs from run to run: identifiers, and how far the simulation's clock has come."""
    text = re.sub(r"GID: [0-9a-f.]{47}\n", "GID: *\n", text)
    return re.sub(r"^\d+,\d+,", "*,*,", text)


def _row(command: str) -> re.Match[str]:
    found = re.search(rf"^\$ {re.escape(command)}\n(.*?)^\[exit (\d+)\]$", RECORDED, re.DOTALL | re.MULTILINE)
    assert found is not None, command
    return found
