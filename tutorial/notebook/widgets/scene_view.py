"""The 3D view in a cell: meshcat's viewer, which receives a scene through the notebook's connection to its kernel."""

from tutorial.notebook.widgets.frame_widget import Frame, FrameWidget
from tutorial.view.assets import VIEW, read_static, zipped_viewer
from tutorial.view.scene import Scene


class SceneView(FrameWidget):
    """Shows a scene in any number of cells, on every page that has the notebook open.

    Create the view in a cell, on the scene's thread, which is the main thread. A newly opened page receives the scene
    when that thread is free; a page that already shows the scene receives changes as soon as a busy cell flushes them.

    Args:
        scene: the scene to show.
        title: the view's name for screen readers.

    Attributes:
        scene: the scene.

    Raises:
        TutorialError: no event loop is running.
        WrongThreadError: this is not the scene's thread.
    """

    AHEAD = 60  # as many frames as a program draws in two seconds
    _esm = read_static(*VIEW, "cell.js", "scene_view.js")
    _css = read_static("scene_view.css", "readings.css")

    def __init__(self, scene: Scene, title: str = "Tank") -> None:
        self.scene = scene
        super().__init__(title)
        self.on_msg(self._on_request)

    def whole(self) -> Frame:
        """Return the scene, and follow its changes from now on."""
        content = self.scene.snapshot()
        if not self.ended:
            self.scene.attach(self._show)
        return content, {}

    def _show(self, content: bytes) -> None:
        """Send a frame. If no view keeps up any longer, stop following the scene."""
        if not self.send_frame(content):
            self.scene.detach(self._show)

    def end(self) -> None:
        """Stop following the scene. All pages, even those opened later, show its last frame. Idempotent.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        self.scene.detach(self._show)
        super().end()

    def _on_request(self, _widget: object, content: object, _buffers: object) -> None:
        """Send the script of meshcat's viewer to a page that lacks it. Thread-safe."""
        if content == {"type": "library"}:
            self.calls.call_latest("library", lambda: self.say("library", [zipped_viewer()]))
