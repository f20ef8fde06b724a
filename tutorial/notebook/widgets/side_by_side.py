"""A row of widgets."""

from ipywidgets import HBox, Layout, Widget

from tutorial.notebook.widgets.picture import Picture
from tutorial.notebook.widgets.scene_view import SceneView


class SideBySide(HBox):  # type: ignore[misc]
    """Shows widgets in a row. On a narrow page, views are stacked.

    A widget beside a view, such as a joystick, shrinks but stays beside it, because you watch the view while you use
    the widget. The view occupies at least half of the row.

    Args:
        widgets: the widgets to show.
    """

    def __init__(self, *widgets: Widget) -> None:
        views = [widget for widget in widgets if isinstance(widget, SceneView)]
        others = [widget for widget in widgets if widget not in views]
        wrap, align = ("nowrap", "center") if others else ("wrap", "flex-start")
        super().__init__(widgets, layout=Layout(flex_flow=f"row {wrap}", align_items=align, grid_gap="0.6em"))
        for view in views:
            view.layout.flex = "1 1 24em"
            view.layout.min_width = "55%" if others else "0"
        for other in others:
            other.layout.flex = "1 1 24em" if isinstance(other, Picture) else "0 1 auto"
            other.layout.min_width = "0"

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(map(repr, self.children))})"
