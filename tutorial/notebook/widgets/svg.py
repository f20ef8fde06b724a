"""SVG pictures in the colours of JupyterLab's theme, built from XML elements so that every name in them is escaped."""

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement, tostring

from tutorial.errors import printable

INK = "var(--jp-ui-font-color1, #212121)"
MUTED = "var(--jp-ui-font-color2, #5f6368)"
RULE = "var(--jp-border-color2, #dadce0)"
PAPER = "var(--jp-layout-color0, #ffffff)"
LINE = "#80868b"  # visible on white and on black
ACCENT = "#1e88e5"
WARN = "#e8710a"
SERIES = ("#1e88e5", "#e8710a", "#2e9e5b", "#a05fd0", "#d9466f", "#1a9aa8", "#a9744f", "#8a8f2a")
"""Colours for curves: easy to see on both white and black."""

UI_FONT = "var(--jp-ui-font-family, system-ui, sans-serif)"
CODE_FONT = "var(--jp-code-font-family, ui-monospace, monospace)"


def new_picture(width: float, height: float, widest: float = 0.0) -> Element:
    """Make an empty picture that is at most as wide as its cell.

    Args:
        width, height: the picture's size [px].
        widest: the picture grows with its cell up to this width [px]; 0 for a picture that doesn't grow.
    """
    root = Element("svg", xmlns="http://www.w3.org/2000/svg", viewBox=f"0 0 {_number(width)} {_number(height)}")
    root.set("width", _number(width))
    size = f"width:100%;max-width:{_number(widest)}px" if widest else "max-width:100%"
    root.set("style", f"{size};height:auto;background:{PAPER};font-family:{UI_FONT};font-size:12px")
    return root


def notice(width: float, height: float, text: str, widest: float = 0.0) -> str:
    """Return a picture that contains only a centred line of text.

    Args:
        width, height: the picture's size [px].
        text: the text; it can contain any characters.
        widest: see `new_picture`.
    """
    root = new_picture(width, height, widest)
    write(root, width / 2, height / 2 + 4, text, f"fill:{MUTED};font-size:14px", "middle")
    return to_text(root)


def draw(parent: Element, tag: str, style: str = "", **attributes: float | str) -> Element:
    """Add a shape.

    Args:
        parent: the element to add the shape to.
        tag: the element's tag, such as ``"line"``.
        style: CSS. Specify colours here, because attributes cannot contain CSS variables.
        attributes: the element's attributes. Numbers are in px, and ``_`` in a name becomes ``-``.
    """
    texts = {name.replace("_", "-"): _number(a) if not isinstance(a, str) else a for name, a in attributes.items()}
    element = SubElement(parent, tag, texts)
    if style:
        element.set("style", style)
    return element


def write(parent: Element, x: float, y: float, text: str, style: str = f"fill:{INK}", anchor: str = "start") -> Element:
    """Add a line of text.

    Args:
        parent: the element to add the line to.
        x: position of the text's start, middle or end [px].
        y: position of the baseline [px].
        text: the text; it can contain any characters.
        style: CSS.
        anchor: the part of the text that is at x: ``"start"``, ``"middle"`` or ``"end"``.
    """
    element = draw(parent, "text", style, x=x, y=y, text_anchor=anchor)
    element.text = text
    return element


def points_text(points: Iterable[tuple[float, float]]) -> str:
    """Format points for the ``points`` attribute of a polyline."""
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def shorten(text: str, length: int) -> str:
    """If a string has more than `length` characters, replace its middle with an ellipsis."""
    if len(text) <= length:
        return text
    end = (length - 1) // 2
    return f"{text[: length - 1 - end]}…{text[-end:]}"


def to_text(root: Element) -> str:
    """Serialize a picture. Invisible characters become escapes, because XML does not allow all of them."""
    for element in root.iter():
        if element.text:
            element.text = printable(element.text)
    return tostring(root, encoding="unicode")


def _number(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")
