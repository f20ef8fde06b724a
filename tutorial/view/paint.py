"""Paints geoms grey while the joints that move them are stale."""

from collections.abc import Collection, Iterator

import mujoco

from tutorial.description.colour import colour_of

STALE = [0.72, 0.73, 0.75]
"""Red, green and blue, each from 0 to 1: a grey that no model in the tutorial uses."""


class Paint:
    """The colours of one model's geoms: a geom is grey while any of the joints that move it is stale.

    A geom is moved by the joints of its MuJoCo body or, if that body has none, of its nearest ancestor with joints.

    Args:
        name: the drawn body's name. Its joints are called ``name/joint`` in the model.
        model: the drawn model.
        geoms: the scene path of each drawn geom, keyed by the geom's id.
    """

    def __init__(self, name: str, model: mujoco.MjModel, geoms: dict[int, str]) -> None:
        self._geoms: list[tuple[frozenset[str], str, list[float]]] = []  # each geom's joints, path and colour
        self._stale: frozenset[str] = frozenset()
        for geom, path in geoms.items():
            joints = frozenset(joint.removeprefix(f"{name}/") for joint in _moved_by(model, geom))
            self._geoms.append((joints, f"{path}/<object>", colour_of(model, geom).tolist()))

    def stale(self, joints: Collection[str]) -> Iterator[tuple[str, list[float]]]:
        """Mark exactly these joints as stale; yield each colour change: (path, [red, green, blue, opacity])."""
        before, self._stale = self._stale, frozenset(joints)
        if before == self._stale:
            return
        for movers, path, colour in self._geoms:
            is_grey = not movers.isdisjoint(self._stale)
            if is_grey == movers.isdisjoint(before):
                yield path, [*STALE, colour[3]] if is_grey else colour


def _moved_by(model: mujoco.MjModel, geom: int) -> list[str]:
    """Return the joints of the geom's body or, if that body has none, of its nearest ancestor with joints."""
    body = int(model.geom_bodyid[geom])
    while body and not model.body_jntnum[body]:
        body = int(model.body_parentid[body])
    first = int(model.body_jntadr[body])
    numbers = range(first, first + int(model.body_jntnum[body]))
    return [model.joint(number).name for number in numbers]
