"""The 3D view in a cell: a scene, shown by meshcat's viewer over the notebook's own connection."""

from tutorial.notebook.widgets.frame_widget import Frame, FrameWidget
from tutorial.view.assets import read_static, zipped_viewer
from tutorial.view.scene import Scene


class SceneView(FrameWidget):
    """Shows a scene in a notebook's cell, as often as it is displayed, on every page that has the notebook open.

    Make it in a cell, on the main thread: it belongs to the thread of the scene. A page that opens the view is answered
    when that thread is free; pages that show it already see at once what a busy cell flushes.

    Args:
        scene: what to show.
        title: what a screen reader says it is.

    Attributes:
        scene: as given.

    Raises:
        TutorialError: no event loop runs.
        WrongThreadError: made on another thread than the scene's.
    """

    AHEAD = 60  # two seconds of a program's frames
    _esm = read_static("make.js", "cell.js", "scene.js", "viewer.js", "scene_view.js")
    _css = read_static("scene_view.css", "readings.css")

    def __init__(self, scene: Scene, title: str = "Tank") -> None:
        self.scene = scene
        super().__init__(title)
        self.on_msg(self._on_request)

    def whole(self) -> Frame:
        """The scene, which is watched from now on."""
        content = self.scene.snapshot()
        if not self.ended:
            self.scene.attach(self._show)
        return content, {}

    def _show(self, content: bytes) -> None:
        """Send a frame; if there is nobody left to send it to, leave the scene alone."""
        if not self.send_frame(content):
            self.scene.detach(self._show)

    def end(self) -> None:
        """Show no more of what the scene becomes; the last picture stays on the page, also on one that comes later.

        Idempotent.

        Raises:
            WrongThreadError: called on another thread than the scene's.
        """
        self.scene.detach(self._show)
        super().end()

    def _on_request(self, _widget: object, content: object, _buffers: object) -> None:
        """Send meshcat's viewer, a script, to a page that lacks it. Any thread."""
        if content == {"type": "library"}:
            self.calls.call_latest("library", lambda: self.say("library", [zipped_viewer()]))
