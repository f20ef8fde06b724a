"""Keeps what a scene shows over a run, as a page that plays it again: in any browser, with nothing from outside.

While the run goes on, the messages of the scene become an animation (`tutorial.view.animation`), and afterwards that a
page.
"""

import base64
import gzip
import html
import logging
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from string import Template

import msgspec

from tutorial.errors import TutorialError
from tutorial.view.animation import Animation
from tutorial.view.assets import STATIC, read_static, zipped_viewer
from tutorial.view.scene import Scene

_log = logging.getLogger(__name__)

FRAME = 1 / 30  # [s] between two frames of what moves

SCRIPTS = ("make.js", "scene.js", "viewer.js", "replay.js")
STYLES = ("scene_view.css", "readings.css", "replay.css")


@dataclass(frozen=True)
class Replay:
    """A run, to be looked at again.

    Attributes:
        scene: a message of `tutorial.view.scene`: what there is to see, and the animation.
        times: of the frames [s], from 0.
        joints: by "body joint", its position in each frame [rad], or [m] of one that slides; NaN where there is none.
        lines: what stood below the view: (since when [s], text).
    """

    scene: bytes
    times: tuple[float, ...]
    joints: dict[str, tuple[float, ...]]
    lines: tuple[tuple[float, str], ...]

    def figure(self, title: str) -> str:
        """Return it as a piece of HTML; a page needs `script` and `style` once, and meshcat's viewer.

        Args:
            title: what a screen reader says it is.
        """
        timeline = {
            "title": title,
            "times": [round(time, 4) for time in self.times],
            "joints": {name: [round(float(value), 5) for value in values] for name, values in self.joints.items()},
            "lines": self.lines,
        }
        packed = _packed(msgspec.json.encode(timeline))  # NaN becomes null
        return (
            f'<figure class="tank-replay" aria-label="{html.escape(title)}">'
            f'<script type="text/plain" class="timeline">{packed}</script>'
            f'<script type="text/plain" class="scene">{_packed(self.scene)}</script></figure>'
        )

    def page(self, title: str) -> str:
        """Return it as a page of its own, which needs nothing else.

        Args:
            title: of the page.
        """
        template = Template((STATIC / "replay.html").read_text(encoding="utf-8"))
        viewer = base64.b64encode(zipped_viewer()).decode()
        return template.substitute(
            title=html.escape(title), style=style(), script=script(), viewer=viewer, figure=self.figure(title)
        )


def script() -> str:
    """Return what plays the figures of a page, as a plain script."""
    text = read_static(*SCRIPTS).replace("\nexport ", "\n")
    return f"(() => {{\n{text}\n}})();\n"


def style() -> str:
    """Return how the figures of a page look."""
    return read_static(*STYLES)


class ReplayRecorder:
    """Takes down what a scene shows, and when. It belongs to the scene's thread.

    Args:
        scene: what to watch, from now on.
        seconds: says how long the run has taken so far [s].
        joints: says where the joints are: positions [rad], or [m], by "body joint".
        longest_pause: a longer time in which nothing moves is shortened to this [s].
    """

    def __init__(
        self,
        scene: Scene,
        seconds: Callable[[], float],
        joints: Callable[[], Mapping[str, float]] = dict,
        longest_pause: float = math.inf,
    ) -> None:
        self._scene = scene
        self._seconds = seconds
        self._joints = joints
        self._longest_pause = longest_pause
        self._last_at = seconds()
        self._time = 0.0
        self._animation = Animation()
        self._times: list[float] = []
        self._positions: list[dict[str, float]] = []
        self._add(0.0, scene.snapshot(), dict(joints()))
        scene.attach(self._take)

    def stop(self) -> Replay:
        """Watch no more, and return what was seen."""
        self._scene.detach(self._take)
        self._take(b"")
        names = self._positions[-1]
        joints = {name: tuple(each.get(name, math.nan) for each in self._positions) for name in names}
        return Replay(self._animation.finish(), tuple(self._times), joints, tuple(self._animation.lines))

    def _take(self, message: bytes) -> None:
        now = self._seconds()
        self._time += min(max(now - self._last_at, 0.0), self._longest_pause)
        self._last_at = now
        if self._time - self._times[-1] > 2 * FRAME:  # until just now, nothing has moved
            self._add(self._time - FRAME, b"", self._positions[-1])
        self._add(self._time, message, dict(self._joints()))

    def _add(self, time: float, message: bytes, positions: dict[str, float]) -> None:
        self._animation.add(time, message)
        self._times.append(time)
        self._positions.append(positions)


@contextmanager
def recorded(
    scene: Scene,
    path: Path | str,
    title: str,
    seconds: Callable[[], float],
    joints: Callable[[], Mapping[str, float]] = dict,
    longest_pause: float = math.inf,
) -> Iterator[None]:
    """Keep what a scene shows, while something runs within, as a page.

    Args:
        scene: what to watch.
        path: of the page.
        title: of the page.
        seconds: says what time the scene shows [s].
        joints: says where the joints are: positions [rad], or [m], by "body joint".
        longest_pause: a longer time in which nothing moves is shortened to this [s].

    Raises:
        TutorialError: the file cannot be written; this is found out before the run.
    """
    path = Path(path)
    with _told(path), path.open("a"):  # what is there already stays until the run is over
        pass
    recorder = ReplayRecorder(scene, seconds, joints, longest_pause)
    try:
        yield
    finally:
        with _told(path):
            path.write_text(recorder.stop().page(title), encoding="utf-8")
        _log.info("the run is kept in %s: open it in a browser", path)


@contextmanager
def _told(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise TutorialError(f"the replay cannot be written to {path}: {error.strerror}") from error


def _packed(data: bytes) -> str:
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()
