"""Widgets in a row."""

from __future__ import annotations

from ipywidgets import HBox, Layout, Widget

__all__ = ["SideBySide"]


class SideBySide(HBox):  # type: ignore[misc]
    """Shows widgets in a row, the first one as wide as there is room; on a narrow page, one below the other.

    Args:
        widgets: what to show.
    """

    def __init__(self, *widgets: Widget) -> None:
        super().__init__(widgets, layout=Layout(flex_flow="row wrap", align_items="center", grid_gap="0.6em"))
        widgets[0].layout.flex = "1 1 24em"
        widgets[0].layout.min_width = "0"

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(map(repr, self.children))})"
