"""Vector pictures made of elements, so that every name in them is escaped, in the colours of JupyterLab's theme."""

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement, tostring

from tutorial.errors import printable

INK = "var(--jp-ui-font-color1, #212121)"
MUTED = "var(--jp-ui-font-color2, #5f6368)"
RULE = "var(--jp-border-color2, #dadce0)"
PAPER = "var(--jp-layout-color0, #ffffff)"
LINE = "#80868b"  # on white and on black
ACCENT = "#1e88e5"
WARN = "#e8710a"
SERIES = ("#1e88e5", "#e8710a", "#2e9e5b", "#a05fd0", "#d9466f", "#1a9aa8", "#a9744f", "#8a8f2a")
"""Colours of curves: readable on white and on black."""

UI_FONT = "var(--jp-ui-font-family, system-ui, sans-serif)"
CODE_FONT = "var(--jp-code-font-family, ui-monospace, monospace)"


def new_picture(width: float, height: float) -> Element:
    """Begin a picture, as wide as its cell at most.

    Args:
        width: [px].
        height: [px].
    """
    root = Element("svg", xmlns="http://www.w3.org/2000/svg", viewBox=f"0 0 {_number(width)} {_number(height)}")
    root.set("width", _number(width))
    root.set("style", f"max-width:100%;height:auto;background:{PAPER};font-family:{UI_FONT};font-size:12px")
    return root


def notice(width: float, height: float, text: str) -> str:
    """Write down a picture that has nothing to show but a line of text, in its middle.

    Args:
        width: [px].
        height: [px].
        text: of any characters.
    """
    root = new_picture(width, height)
    write(root, width / 2, height / 2 + 4, text, f"fill:{MUTED};font-size:14px", "middle")
    return to_text(root)


def draw(parent: Element, tag: str, style: str = "", **attributes: float | str) -> Element:
    """Add a shape.

    Args:
        parent: where to.
        tag: such as ``"line"``.
        style: CSS, which is where colours stand: attributes cannot hold variables.
        attributes: of the element; numbers are [px], and ``_`` stands for ``-``.
    """
    texts = {name.replace("_", "-"): _number(a) if not isinstance(a, str) else a for name, a in attributes.items()}
    element = SubElement(parent, tag, texts)
    if style:
        element.set("style", style)
    return element


def write(parent: Element, x: float, y: float, text: str, style: str = f"fill:{INK}", anchor: str = "start") -> Element:
    """Add a line of text.

    Args:
        parent: where to.
        x: of the text's start, middle or end [px].
        y: of its base line [px].
        text: of any characters.
        style: CSS.
        anchor: ``"start"``, ``"middle"`` or ``"end"``: what x is of.
    """
    element = draw(parent, "text", style, x=x, y=y, text_anchor=anchor)
    element.text = text
    return element


def points_text(points: Iterable[tuple[float, float]]) -> str:
    """Write points as a polyline wants them."""
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def shorten(text: str, length: int) -> str:
    """Take out the middle of what is longer than this many characters."""
    if len(text) <= length:
        return text
    end = (length - 1) // 2
    return f"{text[: length - 1 - end]}…{text[-end:]}"


def to_text(root: Element) -> str:
    """Write a picture down. What is no visible character becomes its escape, as XML cannot hold all of them."""
    for element in root.iter():
        if element.text:
            element.text = printable(element.text)
    return tostring(root, encoding="unicode")


def _number(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")
