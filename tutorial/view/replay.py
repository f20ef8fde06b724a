"""Records a scene during a run, and makes a self-contained page that replays the run in any browser.

During the run, an animation (`tutorial.view.animation`) collects the scene's messages. The page then replays this
animation.
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
from tutorial.view.assets import STATIC, VIEW, read_static, zipped_viewer
from tutorial.view.scene import Scene

_log = logging.getLogger(__name__)

FRAME = 1 / 30  # [s] between frames while something moves

SCRIPTS = (*VIEW, "replay.js")
STYLES = ("scene_view.css", "readings.css", "replay.css")


@dataclass(frozen=True)
class Replay:
    """A recorded run.

    Attributes:
        scene: a message of `tutorial.view.scene` with all objects and the animation.
        times: the frames' times [s], starting at 0.
        joints: each joint's position in each frame [rad, or m for slide joints], keyed by "body joint"; NaN if missing.
        lines: the lines below the view: (start time [s], text).
    """

    scene: bytes
    times: tuple[float, ...]
    joints: dict[str, tuple[float, ...]]
    lines: tuple[tuple[float, str], ...]

    def figure(self, title: str) -> str:
        """Return the run as an HTML element.

        A page with such elements needs `script`, `style` and meshcat's viewer, once each.

        Args:
            title: the run's name for screen readers.
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
        """Return the run as a self-contained page.

        Args:
            title: the title of the page.
        """
        template = Template((STATIC / "replay.html").read_text(encoding="utf-8"))
        viewer = base64.b64encode(zipped_viewer()).decode()
        return template.substitute(
            title=html.escape(title), style=style(), script=script(), viewer=viewer, figure=self.figure(title)
        )


def script() -> str:
    """Return the script that plays the figures of a page."""
    text = read_static(*SCRIPTS).replace("\nexport ", "\n")
    return f"(() => {{\n{text}\n}})();\n"


def style() -> str:
    """Return the style sheet for the figures of a page."""
    return read_static(*STYLES)


class ReplayRecorder:
    """Records how a scene changes over time. Use it on the scene's thread.

    Args:
        scene: the scene to record. Recording begins immediately.
        seconds: a function that returns the elapsed time of the run [s].
        joints: a function that returns the joints' positions [rad, or m for slide joints], keyed by "body joint".
        longest_pause: longer pauses without movement are shortened to this length [s].
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
        """Stop recording, and return the recorded run."""
        self._scene.detach(self._take)
        self._take(b"")
        names = self._positions[-1]
        joints = {name: tuple(each.get(name, math.nan) for each in self._positions) for name in names}
        return Replay(self._animation.finish(), tuple(self._times), joints, tuple(self._animation.lines))

    def _take(self, message: bytes) -> None:
        now = self._seconds()
        self._time += min(max(now - self._last_at, 0.0), self._longest_pause)
        self._last_at = now
        if self._time - self._times[-1] > 2 * FRAME:  # nothing has moved since the last frame
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
    """Record a scene during a ``with`` block, and write the recording as a page.

    Args:
        scene: the scene to record.
        path: where to write the page.
        title: the title of the page.
        seconds: a function that returns the time that the scene shows [s].
        joints: a function that returns the joints' positions [rad, or m for slide joints], keyed by "body joint".
        longest_pause: longer pauses without movement are shortened to this length [s].

    Raises:
        TutorialError: the file cannot be written; this is checked before the run.
    """
    path = Path(path)
    with _writing(path), path.open("a"):  # an existing file is not changed before the run is over
        pass
    recorder = ReplayRecorder(scene, seconds, joints, longest_pause)
    try:
        yield
    finally:
        with _writing(path):
            path.write_text(recorder.stop().page(title), encoding="utf-8")
        _log.info("the replay is in %s: open it in a browser", path)


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise TutorialError(f"the replay cannot be written to {path}: {error.strerror}") from error


def _packed(data: bytes) -> str:
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()
