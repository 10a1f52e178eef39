"""Elements of a picture as markup: lines, circles, texts with a place in percent."""

from __future__ import annotations

from collections.abc import Iterable

from markupsafe import Markup, escape

from trackroller.report.pictures.axis import LETTER


def percent_place(value: float) -> str:
    """Write a place in percent with a tenth."""
    return f"{value:.1f}%"


def element(name: str, content: str | Markup = "", **attributes: object) -> Markup:
    """Return an element; `_` in a name of an attribute is a hyphen, and `class_` is `class`."""
    parts = [name]
    for key, value in attributes.items():
        if value not in (None, ""):
            parts.append(f'{key.rstrip("_").replace("_", "-")}="{escape(value)}"')
    return Markup("<{}>{}</{}>").format(Markup(" ".join(parts)), content, Markup(name))


def line(kind: str, x1: float, y1: str, x2: float, y2: str) -> Markup:
    """Return a line of a class between places in percent (x) and any unit (y)."""
    return element("line", class_=kind, x1=percent_place(x1), x2=percent_place(x2), y1=y1, y2=y2)


def upright(kind: str, x: float, top: str = "0", bottom: str = "100%") -> Markup:
    """Return an upright line at a place in percent."""
    return line(kind, x, top, x, bottom)


def level(kind: str, y: float) -> Markup:
    """Return a line across the whole picture at a height in percent."""
    return line(kind, 0, percent_place(y), 100, percent_place(y))


def dot(kind: str, x: float, y: float | str, radius: float) -> Markup:
    """Return a filled circle; `y` is a place in percent or a length."""
    if isinstance(y, str):
        height = y
    else:
        height = percent_place(y)
    return element("circle", class_=kind, cx=percent_place(x), cy=height, r=radius)


def label(
    text: str, x: float, y: str, anchor: str = "middle", kind: str = "", **shift: float
) -> Markup:
    """Return a text at a place in percent, moved by `dx` and `dy` [px]."""
    if anchor == "start":
        anchor = ""
    return element("text", text, class_=kind, x=percent_place(x), y=y, text_anchor=anchor, **shift)


def anchor_at(place: float) -> str:
    """Return the anchor of a text so that it stays inside a picture."""
    if place < 15:
        return "start"
    if place > 85:
        return "end"
    return "middle"


def joined(parts: Iterable[Markup]) -> Markup:
    """Return elements one after the other."""
    return Markup("").join(parts)


def picture(content: Markup, height: float, words: str, kind: str = "") -> Markup:
    """Return an SVG as wide as its place, of this height [px], with words for those who cannot see
    it.
    """
    return element("svg", content, class_=kind, height=f"{height:g}", role="img", aria_label=words)


def stretched(content: Markup, height: float) -> Markup:
    """Return a layer of paths in percent, which is stretched with the width of the picture."""
    return element(
        "svg",
        content,
        viewBox="0 0 100 100",
        preserveAspectRatio="none",
        width="100%",
        height=f"{height:g}",
    )


def width_of(text: str) -> float:
    """Return the estimated width of a text in a picture [px]."""
    return LETTER * len(text)


def spread_labels(heights: list[float], least: float, top: float, bottom: float) -> list[float]:
    """Move heights of labels apart so that neighbours differ by `least`, between `top` and `bottom`
    [px].

    The order stays; labels that stand apart already stay where they are.
    """
    order = sorted(range(len(heights)), key=heights.__getitem__)
    placed = [0.0] * len(heights)
    last = top - least
    for i in order:
        placed[i] = max(heights[i], last + least)
        last = placed[i]
    limit = bottom
    for i in reversed(order):
        placed[i] = min(placed[i], limit)
        limit = placed[i] - least
    return placed
