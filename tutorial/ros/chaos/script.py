"""A script of faults: which, from when, and for how long."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import msgspec

from tutorial.errors import TutorialError
from tutorial.ros.chaos.faults import parse_fault
from tutorial.yamlfile import YamlFile

__all__ = ["ChaosScript"]

_Seconds = Annotated[float, msgspec.Meta(ge=0, le=1_000_000)]  # eleven days, as for --duration


class _Scene(msgspec.Struct, forbid_unknown_fields=True, rename={"duration": "for"}):
    at: _Seconds
    duration: _Seconds
    faults: list[str]


class _ChaosFile(msgspec.Struct, forbid_unknown_fields=True):
    """What a script looks like."""

    chaos: Annotated[list[_Scene], msgspec.Meta(min_length=1)]


class ChaosScript:
    """Faults by time, as a YAML file says; where two scenes overlap, both hold.

    Args:
        path: the file.

    Attributes:
        duration: when the last scene ends [s].

    Raises:
        TutorialError: the file is missing or malformed; the text names the line and the mend.
    """

    def __init__(self, path: Path) -> None:
        file = YamlFile(path, _ChaosFile, "script")
        self._scenes: list[tuple[float, float, dict[str, float]]] = []
        for i, scene in enumerate(file.data.chaos):
            faults = {}
            for j, text in enumerate(scene.faults):
                try:
                    name, share = parse_fault(text)
                except TutorialError as error:
                    raise file.error(("chaos", i, "faults", j), str(error)) from error
                faults[name] = share
            self._scenes.append((scene.at, scene.at + scene.duration, faults))
        self.duration = max(end for _, end, _ in self._scenes)

    def at(self, seconds: float) -> dict[str, float]:
        """Return the faults of a time, by name, with their shares.

        Args:
            seconds: since the beginning [s].
        """
        now: dict[str, float] = {}
        for begin, end, faults in self._scenes:
            if begin <= seconds < end:
                now |= faults
        return now
