"""Widgets in a column."""

from collections.abc import Sequence

from ipywidgets import Layout, VBox, Widget


class Column(VBox):  # type: ignore[misc]
    """Stacks widgets in a column that is narrow enough to fit beside a view.

    Args:
        widgets: the widgets to show.
    """

    def __init__(self, widgets: Sequence[Widget]) -> None:
        super().__init__(widgets, layout=Layout(width="33em", max_width="100%", grid_gap="0.6em"))

    def __repr__(self) -> str:
        return f"[{', '.join(map(repr, self.children))}]"
