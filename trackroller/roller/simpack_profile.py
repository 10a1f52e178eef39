"""Read the points of a profile of SIMPACK (`.prr`, `.prw`): sections, settings and points."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from trackroller.contact.profiles import PointRows
from trackroller.errors import InputError
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.table_cells import plain_cell

_SECTION = re.compile(r"\s*(header|spline|point)\.(begin|end)\s*", re.IGNORECASE)
_EXPORT = "Export the points as two columns of text, such as `x [mm]; z [mm]`."

# words that do not change the shape, and the numbers of a profile that is as its points say
_NOTES = ("file", "file.mtime", "comment", "type", "inversion", "units.len", "units.ang", "units.ang.f")
_SETTINGS = {
    **dict.fromkeys(("approx.smooth", "point.dist.min", "rotate", "shift.y", "shift.z", "mirror.y", "mirror.z"), 0.0),
    **dict.fromkeys(("bound.y.min", "bound.z.min"), 1.0),  # a lower bound above the upper one bounds nothing
    **dict.fromkeys(("bound.y.max", "bound.z.max", "units.len.f"), 0.0),
}


def is_simpack(texts: Sequence[str]) -> bool:
    """Return whether lines are those of a profile of SIMPACK."""
    return any(_SECTION.match(text) for text in texts)


def simpack_points(lines: Sequence[tuple[int, str]], path: Path, field: str) -> PointRows:
    """Return the points [y, z] [mm] of a profile of SIMPACK, as its settings say.

    Parameters
    ----------
    lines : sequence of (int, str)
        Numbers and texts of the lines.
    path : Path
        The file.
    field : str
        Name of the field, for messages.

    Returns
    -------
    PointRows
        The points in the order of the file, with their lines.

    Raises
    ------
    InputError
        If a setting is neither neutral nor a plain shift, mirror or unit, or if a line is no point.
    """
    return _Profile(lines, path, field).points()


class _Profile:
    """The settings and points of a profile."""

    def __init__(self, lines: Sequence[tuple[int, str]], path: Path, field: str) -> None:
        self.path, self.field, self.last = path, field, lines[-1]
        self.settings = dict(_SETTINGS)
        self.stated: dict[str, tuple[int, str]] = {}
        self.rows: dict[int, list[float]] = {}
        opened: list[str] = []
        for line in lines:
            text = line[1].split("!")[0].strip()
            if part := _SECTION.fullmatch(text):
                self._section(line, opened, part[1].lower(), part[2].lower() == "begin")
            elif text and opened[-1:] == ["point"]:
                self._point(line, text)
            elif text and opened[-1:] == ["spline"]:
                self._setting(line, text)
        if opened or not self.rows:
            raise self._refused(self.last, "ends without points or within a section", "sections that begin and end")
        if len({tuple(row[2:]) for row in self.rows.values()}) > 1:
            wrong, remedy = "ends points of different weights", "Leave the weights out."
            raise self._refused(self.last, wrong, "the same weight for all points", remedy)

    def _refused(self, line: tuple[int, str], wrong: str, allowed: str, remedy: str = _EXPORT) -> InputError:
        return InputError(self.field, line[1].strip(), allowed, remedy, wrong).at(self.path, line[0])

    def _section(self, line: tuple[int, str], opened: list[str], part: str, begins: bool) -> None:
        if begins and part == "point" and self.rows:
            raise self._refused(line, "begins a second profile", "one profile in the file")
        if begins:
            opened.append(part)
        elif not opened or opened.pop() != part:
            allowed = "sections that begin and end one within the other"
            raise self._refused(line, "ends a section that is not open", allowed)

    def _point(self, line: tuple[int, str], text: str) -> None:
        numbers = [number_or_nan(plain_cell(cell, ".")) for cell in text.split()]
        if len(numbers) not in (2, 3) or not np.isfinite(numbers).all():
            allowed = "two numbers y, z, or three with a weight"
            raise self._refused(line, "is no point", allowed, "Leave out the lines of lost points.")
        self.rows[line[0]] = numbers

    def _setting(self, line: tuple[int, str], text: str) -> None:
        key, _, value = (half.strip() for half in text.lower().partition("="))
        if key in _NOTES:
            return
        number = number_or_nan(plain_cell(value, "."))
        if key not in _SETTINGS or not np.isfinite(number):
            raise self._refused(line, "is no known setting with a number", ", ".join(_SETTINGS))
        self.settings[key], self.stated[key] = number, line

    def points(self) -> PointRows:
        """Return the points [mm] as the settings say."""
        points = np.array([row[:2] for row in self.rows.values()])
        setting = self.settings
        per_metre = setting["units.len.f"]
        if per_metre <= 0.0:
            line = self.stated.get("units.len.f", self.last)
            wrong = "is no positive number" if "units.len.f" in self.stated else "ends a profile without unit"
            allowed = "a setting units.len.f, the units in a metre"
            raise self._refused(line, wrong, allowed, "Write units.len.f = 1000 for mm.")
        apart = float(np.hypot(*np.diff(points, axis=0).T).min(initial=np.inf))
        shifts, mirrors = np.array([[setting[f"{kind}.{axis}"] for axis in "yz"] for kind in ("shift", "mirror")])
        moved = points + shifts
        changes = {
            "approx.smooth": (setting["approx.smooth"] != 0.0, "0", "Give `smooth` beside the file."),
            "rotate": (setting["rotate"] != 0.0, "0", "Turn the points before."),
            "point.dist.min": (setting["point.dist.min"] > apart, "a distance that leaves out no point", _EXPORT),
        }
        for axis, column, shift, mirror in zip("yz", moved.T, shifts, mirrors, strict=True):
            allowed = "0 or 1, and 0 beside a shift, because the order of both is not known"
            changes[f"mirror.{axis}"] = mirror not in (0.0, 1.0) or (mirror and shift), allowed, _EXPORT
            low, high = setting[f"bound.{axis}.min"], setting[f"bound.{axis}.max"]
            words = "bounds that leave out no point", "Leave out the points beyond the bounds."
            changes[f"bound.{axis}.min"] = (low < high and column.min() < low, *words)
            changes[f"bound.{axis}.max"] = (low < high and column.max() > high, *words)
        for name, (changed, allowed, remedy) in changes.items():
            if changed:
                raise self._refused(self.stated.get(name, self.last), "changes the shape", allowed, remedy)
        return PointRows((moved * (1.0 - 2.0 * mirrors) * (1000.0 / per_metre)).tolist(), self.path, tuple(self.rows))
