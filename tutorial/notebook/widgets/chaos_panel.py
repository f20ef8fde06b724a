"""A panel whose node publishes joint states, with a slider for each kind of fault that the node can introduce."""

from typing import Any

from ipywidgets import HTML, Button, FloatSlider, HBox, Layout, VBox

from tutorial.notebook.widgets.cell_widget import kernel_loop
from tutorial.ros.chaos import FAULTS, Chaos
from tutorial.ros.chaos.stream import ChaosStream
from tutorial.ros.node_thread import NodeThread

HEIGHT = "23em"  # the list of faults scrolls, so that the panel is only as tall as the view beside it
LOOK = 0.5  # [s] between updates of the counts


class ChaosPanel(VBox):  # type: ignore[misc]
    """Sliders that set the share of messages that each fault affects.

    Create the panel on the main thread while the kernel's event loop is running. Its node, ``chaos``, publishes on a
    separate thread, even while a cell is busy.

    Attributes:
        sliders: the sliders by fault name.
        ended: whether the panel has ended.

    Raises:
        TutorialError: no event loop is running.
    """

    def __init__(self) -> None:
        self._loop = kernel_loop()
        self.ended = False
        self._ros = NodeThread("chaos")
        self._stream = ChaosStream(self._ros.node, Chaos())
        self.sliders = {name: _slider(name, what) for name, what in FAULTS.items()}
        for slider in self.sliders.values():
            slider.observe(self._on_share, "value")
        self._reset = Button(description="No faults", tooltip="Set all sliders to 0")
        self._reset.on_click(self._on_reset)
        self._hits = HTML()  # unlike a Label, an HTML widget wraps long lines
        rows = [_row(*each) for each in self.sliders.items()]
        faults = VBox(rows, layout=Layout(height=HEIGHT, overflow="hidden auto", display="block"))
        super().__init__([HTML("Share of the messages that each fault affects:"), faults, self._reset, self._hits])
        self._next = self._loop.call_soon(self._tell)

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"

    @property
    def made(self) -> dict[str, int]:
        """The number of messages that each fault has affected so far."""
        return dict(self._stream.chaos.made)

    def end(self) -> None:
        """Stop publishing, destroy the node, and disable the sliders. Idempotent; main thread only."""
        if self.ended:
            return
        self.ended = True
        self._next.cancel()
        self._ros.close()
        for control in (*self.sliders.values(), self._reset):
            control.disabled = True
        self._hits.value = f"ended. {_words(self.made)}"

    def _on_share(self, _change: object) -> None:
        """Set the shares for the node's thread, which reads them when it publishes the next message. Thread-safe."""
        self._stream.chaos.faults = {name: slider.value for name, slider in self.sliders.items() if slider.value}

    def _on_reset(self, _button: object) -> None:
        for slider in self.sliders.values():
            slider.value = 0.0

    def _tell(self) -> None:
        """Update the counts, and schedule the next update. Main thread only."""
        self._hits.value = _words(self.made)
        self._next = self._loop.call_later(LOOK, self._tell)


def _slider(name: str, what: str) -> Any:
    layout = Layout(width="min(14em, 100%)")
    return FloatSlider(max=1.0, step=0.05, tooltip=f"{name}: {what}", readout_format=".0%", layout=layout)


def _row(name: str, slider: Any) -> HBox:
    """Put a fault's name and effect beside its slider, or below the slider if there is no room."""
    text = HTML(f"<b>{name}</b>: {FAULTS[name]}", layout=Layout(flex="1 1 14em"))
    return HBox([slider, text], layout=Layout(flex_flow="row wrap"))


def _words(made: dict[str, int]) -> str:
    hit = ", ".join(f"{name} {count}" for name, count in made.items() if count)
    return f"affected messages: {hit or 'none'}"
