"""Cross-sections as people, spreadsheets and instruments write them, with the true curve beside them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

Curve = Callable[[np.ndarray], np.ndarray]
UNITS = {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "cm": 10.0, "in": 25.4, "inch": 25.4, "thou": 0.0254, "m": 1e3, "nm": 1e-6}
LOST = ("0", "-9999", "9999", "1e30", "NaN", "", "*****", "---", "#N/A")


class Written(NamedTuple):
    """A file, the true curve, and what may be expected.

    Attributes
    ----------
    content : bytes
        The file.
    curve : callable
        True height over x [mm].
    ends : tuple of float
        First and last true x [mm].
    spacing : float
        Distance of the points [mm].
    fault : str
        What is wrong with the numbers, "" for nothing.
    clear : bool
        Whether a person reads the file without a question.
    unseen : float
        Error of rounded heights that straight parts of the curve hide [mm]; 0 for other curves.
    """

    content: bytes
    curve: Curve
    ends: tuple[float, float]
    spacing: float
    fault: str
    clear: bool
    unseen: float


def curve_of(r: np.random.Generator) -> tuple[Curve, float, list[float], bool]:
    """Return a curve that is drawn or measured, half its width and its kinks [mm], and whether parts are straight."""
    radius = float(r.uniform(2.0, 20.0))
    half = float(r.uniform(0.3, 0.75)) * min(radius, 8.0)
    end = float(r.uniform(0.4, 0.8)) * half
    sign = float(r.choice([-1.0, 1.0]))
    kind = r.choice(["circle", "parabola", "chamfer", "rounded edge", "worn", "gothic", "logarithmic", "waves"])
    kinks: list[float] = []

    def chord(x: np.ndarray) -> np.ndarray:
        return np.sqrt(radius**2 - x * x) - radius

    curve: Curve = chord
    if kind == "parabola":
        curve = lambda x: -x * x / (2 * radius)  # noqa: E731
    elif kind == "chamfer":
        slope, kinks = float(r.uniform(0.1, 1.2)), [-end, end]
        curve = lambda x: chord(np.clip(x, -end, end)) - slope * np.maximum(np.abs(x) - end, 0.0)  # noqa: E731
    elif kind == "rounded edge":  # flat, arc, chamfer of 45 degrees, tangent to each other
        arc, kinks = float(r.uniform(0.2, 1.0)), [-end, end]
        run = arc * math.sqrt(0.5)

        def curve(x: np.ndarray) -> np.ndarray:
            beyond = np.maximum(np.abs(x) - end, 0.0)
            on_arc = np.minimum(beyond, run)
            return np.sqrt(arc**2 - on_arc**2) - arc - (beyond - on_arc)

    elif kind == "worn":
        wear, kinks = float(10 ** r.uniform(-3, -1.5)), [-end, end]
        curve = lambda x: chord(x) - wear * np.maximum(np.abs(x) - end, 0.0)  # noqa: E731
    elif kind == "gothic":
        apart, kinks = float(r.uniform(0.02, 0.15)) * radius, [0.0]
        curve = lambda x: chord(np.abs(x) + apart)  # noqa: E731
    elif kind == "logarithmic":
        drop = float(10 ** r.uniform(-3, -1))
        curve = lambda x: drop * np.log(1.0 - np.minimum(np.abs(x) / half, 0.9) ** 2)  # noqa: E731
        kinks = [-0.9 * half, 0.9 * half]
    elif kind == "waves":
        height, length = float(10 ** r.uniform(-4, -2.5)), float(r.uniform(0.3, 0.6)) * half
        curve = lambda x: chord(x) + height * np.cos(2 * np.pi * x / length)  # noqa: E731
    offset = float(r.choice([0.0, radius, r.uniform(-3.0, 3.0)]))
    straight = kind in ("chamfer", "rounded edge", "logarithmic")
    return (lambda x: sign * curve(x) + offset), half, kinks, straight


def written(seed: int) -> Written:
    """Return the file with this number."""
    r = np.random.default_rng(seed)
    curve, half, kinks, straight = curve_of(r)
    x = np.linspace(-half, half, int(10 ** r.uniform(1.65, 2.35)))
    if r.random() < 0.3:
        x[1:-1] += r.uniform(-0.3, 0.3, x.size - 2) * (x[1] - x[0])
    x = np.round(x, 5)
    spacing = float(np.median(np.diff(x)))
    z = curve(x)
    fault = str(r.choice(["", "", "", "noise", "rounding", "speck", "lost", "step"]))
    cells: dict[int, str] = {}
    if fault == "noise":
        z = z + r.normal(0.0, r.choice([spacing * 10 ** r.uniform(-3.5, -1.5), r.uniform(1e-3, 5e-3)]), x.size)
    elif fault in ("speck", "step"):
        place, length = _smooth_place(r, x, kinks)
        fault = fault if length else ""
        off = r.choice([-1, 1]) * spacing * 10 ** r.uniform(-1, 1)
        if fault == "step":
            z[place:] += off
        else:
            z[place : place + length] += off * r.uniform(0.8, 1.2, length)
    elif fault == "lost":
        length = int(r.choice([1, 1, 2, 3, 5, 12]))
        place = int(r.choice([0, x.size - length, r.integers(0, x.size - length)]))
        mark = str(r.choice(LOST))
        if np.abs(z[place : place + length]).min() < 4.0 * spacing:  # 0 would look like a chamfer there
            mark = mark.replace("0", "-9999") if mark == "0" else mark
        cells = dict.fromkeys(range(place, place + length), mark)
    if not kinks and r.random() < 0.1:  # points that are missing, as spreadsheets without the lost ones have them
        kept = np.delete(np.arange(x.size), slice(x.size // 3, x.size // 3 + int(r.integers(1, 4))))
        cells = {int(np.searchsorted(kept, k)): mark for k, mark in cells.items() if k in kept}
        x, z = x[kept], z[kept]
    digits = int(r.integers(2, 5)) if fault == "rounding" else 8
    content, scale, clear = _in_style(r, x, z, cells, digits)
    unseen = 1.5 * 10.0**-digits if fault == "rounding" and straight else 0.0
    true = (lambda at: scale * curve(at)) if scale != 1.0 else curve
    return Written(content, true, (float(x[0]), float(x[-1])), spacing, fault, clear, unseen)


def _smooth_place(r: np.random.Generator, x: np.ndarray, kinks: list[float]) -> tuple[int, int]:
    """Return where a speck begins and how long it is: on a smooth part of the curve; 0 if there is none."""
    length = int(r.integers(1, 6))
    places = np.arange(12, x.size - 12 - length)
    for kink in kinks:
        places = places[np.abs(places + length / 2 - np.searchsorted(x, kink)) > 12 + length]
    return (int(r.choice(places)), length) if places.size else (0, 0)


def _in_style(
    r: np.random.Generator, x: np.ndarray, z: np.ndarray, lost: dict[int, str], digits: int
) -> tuple[bytes, float, bool]:
    """Return points in a style of writing, the scale that the file states for z, and whether the style is clear."""
    unit_x, unit_z = (str(r.choice(list(UNITS))) for _ in range(2)) if r.random() < 0.5 else ("mm", "mm")
    separator = str(r.choice([";", "; ", "\t", ",", ", ", "  ", " ", "|"]))
    comma = bool(r.random() < 0.4)
    quote = str(r.choice(["", "", "", '"']))
    clear = not (comma and separator.strip() == "," and not quote)
    stated = (unit_x, unit_z) != ("mm", "mm") or r.random() < 0.3
    thousands = str(r.choice(["", "", "", ".", "'", "\u202f"])) if comma else str(r.choice(["", "", "", ",", "'"]))
    thousands = "" if separator.strip() in ("", thousands) else thousands
    behind = bool(stated and separator.strip() and r.random() < 0.1)  # units behind each number
    head, head_clear = _head(r, separator, (unit_x, unit_z) if stated and not behind else None)
    extra = str(r.choice(["", "", "", "index", "y", "quality"]))
    swapped = bool(head and r.random() < 0.15)
    order = np.arange(x.size)
    if r.random() < 0.3:
        order = order[::-1] if r.random() < 0.6 else r.permutation(order)
    if r.random() < 0.2:
        order = np.insert(order, 5, order[4])
    places = {unit: digits + max(0, math.ceil(math.log10(UNITS[unit]))) for unit in UNITS}
    places |= {unit: max(places[unit], 0) for unit in UNITS}

    def shown(value: float, unit: str) -> str:
        text = f"{value / UNITS[unit]:,.{places[unit]}f}"
        text = text.translate({ord(","): thousands or None, ord("."): "," if comma else "."})
        return f"{text} {unit}" if behind else text

    lines = []
    for count, k in enumerate(order.tolist()):
        row = [shown(x[k], unit_x), lost.get(k, shown(z[k], unit_z))]
        row = row[::-1] if swapped else row
        row = {
            "index": [str(count), *row],
            "y": [row[0], "12,5" if comma else "12.5", row[1]],
            "quality": [*row, "1"],
        }.get(extra, row)
        lines.append(separator.join(f"{quote}{cell}{quote}" for cell in row))
    head = head[::-1] if swapped else head
    if extra:
        names = {"index": ["no", *head], "y": [head[0], "y", head[1]], "quality": [*head, "q"]}[extra] if head else []
        clear &= bool(names)
        head = names
    remarks = ["# Profile 7, probe 2 um", "# 2024-05-01", "# measured on Monday", "# by hand"]
    remarks = [str(remark) for remark in r.permutation(remarks)[: r.integers(0, 3)]]
    block, scale = _block(r, separator)
    clear &= not block
    top = [separator.join(f"{quote}{name}{quote}" for name in head)] if head else []
    text = str(r.choice(["\n", "\r\n", "\r"])).join([*remarks, *block, *top, *_loosened(r, lines, separator), ""])
    if r.random() < 0.2:
        text = text.replace("-", str(r.choice(["\u2212", "-"])))
    encoding = str(r.choice(["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "cp1252"]))
    if encoding == "cp1252" and ("\u2212" in text or "\u202f" in text):
        encoding = "utf-8"
    return text.encode(encoding), scale, clear and head_clear


def _loosened(r: np.random.Generator, lines: list[str], separator: str) -> list[str]:
    """Return lines with empty lines, empty rows of a spreadsheet, an empty cell in each row, or a remark."""
    if r.random() < 0.1:
        lines = [*lines[:7], str(r.choice(["", separator])), *lines[7:], "", ""]
    if separator.strip() and r.random() < 0.1:
        lines = [line + separator.strip(" ") for line in lines]
    if r.random() < 0.1:
        lines.insert(int(r.integers(0, len(lines))), "# cleaned")
    return lines


def _block(r: np.random.Generator, separator: str) -> tuple[list[str], float]:
    """Return the lines with which an instrument begins its files, and the scale of z that they state."""
    if r.random() > 0.15:
        return [], 1.0
    between = str(r.choice([": ", "=", separator]))
    words = {"Operator": "N. N.", "Device": "contour 12", "Points": "181", "Speed": "0.5 mm/s", "Filter": "none"}
    words |= {"Probe": "R 2 um", "Date": "2024-05-01", "Time": "10:11:12", "Part": "00123", "Force": "0.75 mN"}
    scale = float(r.choice([1.0, 1.0, 2.0, 0.001]))
    words |= {} if scale == 1.0 else {"Scale": f"{scale:g}"}
    keys = [str(key) for key in r.permutation(list(words))][: r.integers(1, 10)]
    return [f"{key}{between}{words[key]}" for key in keys], scale if "Scale" in keys else 1.0


def _head(r: np.random.Generator, separator: str, units: tuple[str, str] | None) -> tuple[list[str], bool]:
    """Return the names of the columns with their units in one of many ways, and whether this is clear."""
    if units is None:
        return [["x", "z"], ["X", "Z"], []][int(r.integers(0, 3))], True
    clear_ways = ["{} [{}]", "{} ({})", "{}({})", "{}/{}"]
    ways = [*clear_ways, *clear_ways, "{} / {}", "{}_{}", "{} in {}", "{}, {}", "{} {}"]
    way = ways[int(r.integers(0, len(ways)))]
    names = r.choice([["x", "z"], ["X", "Z"], ["x-axis", "z-axis"]])
    clear = way in clear_ways and names[0] in "xX"
    return [way.format(name, unit) for name, unit in zip(names, units, strict=True)], clear
