"""Draws what stale joints move in grey, and later in its own colours again."""

from collections.abc import Collection, Iterator

import mujoco

from tutorial.description.colour import colour_of

STALE = [0.72, 0.73, 0.75]
"""Red, green and blue, each 0 to 1: a grey that none of the tutorial's models has."""


class Paint:
    """The colours of one model's geoms, by the joints that move them.

    A joint moves the geoms of its own MuJoCo body, and of the bodies that are fixed to that. What further
    joints move belongs to these.

    Args:
        name: of the body that is drawn: its joints are called ``name/joint`` in the model.
        model: what is drawn.
        geoms: by a geom's number, where it is drawn.
    """

    def __init__(self, name: str, model: mujoco.MjModel, geoms: dict[int, str]) -> None:
        self._geoms: list[tuple[frozenset[str], str, list[float]]] = []  # the joints, the path, the own colour
        self._stale: frozenset[str] = frozenset()
        for geom, path in geoms.items():
            joints = frozenset(joint.removeprefix(f"{name}/") for joint in _moved_by(model, geom))
            self._geoms.append((joints, f"{path}/<object>", colour_of(model, geom).tolist()))

    def stale(self, joints: Collection[str]) -> Iterator[tuple[str, list[float]]]:
        """Yield what changes when these joints are stale, and no others: (path, [red, green, blue, opacity])."""
        before, self._stale = self._stale, frozenset(joints)
        if before == self._stale:
            return
        for movers, path, colour in self._geoms:
            is_grey = not movers.isdisjoint(self._stale)
            if is_grey == movers.isdisjoint(before):
                yield path, [*STALE, colour[3]] if is_grey else colour


def _moved_by(model: mujoco.MjModel, geom: int) -> list[str]:
    """The joints of the nearest body above a geom that has any."""
    body = int(model.geom_bodyid[geom])
    while body and not model.body_jntnum[body]:
        body = int(model.body_parentid[body])
    first = int(model.body_jntadr[body])
    numbers = range(first, first + int(model.body_jntnum[body]))
    return [model.joint(number).name for number in numbers]
