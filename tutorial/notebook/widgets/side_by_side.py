"""A row of widgets."""

from ipywidgets import HBox, Layout, Widget

from tutorial.notebook.widgets.scene_view import SceneView


class SideBySide(HBox):  # type: ignore[misc]
    """Shows widgets in a row, or in a column on a narrow page.

    3D views share the width that the other widgets leave free.

    Args:
        widgets: the widgets to show.
    """

    def __init__(self, *widgets: Widget) -> None:
        views = [widget for widget in widgets if isinstance(widget, SceneView)]
        align = "flex-start" if len(views) == len(widgets) else "center"
        super().__init__(widgets, layout=Layout(flex_flow="row wrap", align_items=align, grid_gap="0.6em"))
        for view in views:
            view.layout.flex = "1 1 24em"
            view.layout.min_width = "0"

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(map(repr, self.children))})"
