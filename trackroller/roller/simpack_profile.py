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
_NOTES = (
    "file",
    "file.mtime",
    "comment",
    "type",
    "inversion",
    "units.len",
    "units.ang",
    "units.ang.f",
)
_SETTINGS = {
    **dict.fromkeys(
        ("approx.smooth", "point.dist.min", "rotate", "shift.y", "shift.z", "mirror.y", "mirror.z"),
        0.0,
    ),
    # a lower bound above the upper one bounds nothing
    **dict.fromkeys(("bound.y.min", "bound.z.min"), 1.0),
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
    """The settings and points of a profile, with the lines in which they stand."""

    def __init__(self, lines: Sequence[tuple[int, str]], path: Path, field: str) -> None:
        self.path = path
        self.field = field
        self.last = lines[-1]
        self.settings = dict(_SETTINGS)
        self.stated: dict[str, tuple[int, str]] = {}
        self.rows: dict[int, list[float]] = {}
        self.opened: list[str] = []
        for line in lines:
            self._read(line)
        if self.opened or not self.rows:
            wrong = "ends without points or within a section"
            raise self._refused(self.last, wrong, "sections that begin and end")
        weights = {tuple(row[2:]) for row in self.rows.values()}
        if len(weights) > 1:
            allowed = "the same weight for all points"
            raise self._refused(
                self.last, "ends points of different weights", allowed, "Leave the weights out."
            )

    def _refused(
        self, line: tuple[int, str], wrong: str, allowed: str, remedy: str = _EXPORT
    ) -> InputError:
        number, text = line
        return InputError(self.field, text.strip(), allowed, remedy, wrong).at(self.path, number)

    def _read(self, line: tuple[int, str]) -> None:
        """Read a line without its comment: the begin or end of a section, a point, or a setting."""
        text = line[1].split("!")[0].strip()
        part = _SECTION.fullmatch(text)
        inside = self.opened[-1] if self.opened else ""
        if part:
            self._read_section(line, part[1].lower(), part[2].lower() == "begin")
        elif text and inside == "point":
            self._read_point(line, text)
        elif text and inside == "spline":
            self._read_setting(line, text)

    def _read_section(self, line: tuple[int, str], part: str, begins: bool) -> None:
        if begins and part == "point" and self.rows:
            raise self._refused(line, "begins a second profile", "one profile in the file")
        if begins:
            self.opened.append(part)
        elif not self.opened or self.opened.pop() != part:
            allowed = "sections that begin and end one within the other"
            raise self._refused(line, "ends a section that is not open", allowed)

    def _read_point(self, line: tuple[int, str], text: str) -> None:
        numbers = [number_or_nan(plain_cell(cell, ".")) for cell in text.split()]
        if len(numbers) not in (2, 3) or not np.isfinite(numbers).all():
            allowed = "two numbers y, z, or three with a weight"
            raise self._refused(line, "is no point", allowed, "Leave out the lines of lost points.")
        self.rows[line[0]] = numbers

    def _read_setting(self, line: tuple[int, str], text: str) -> None:
        key, _, value = (half.strip() for half in text.lower().partition("="))
        if key in _NOTES:
            return
        number = number_or_nan(plain_cell(value, "."))
        if key not in _SETTINGS or not np.isfinite(number):
            raise self._refused(line, "is no known setting with a number", ", ".join(_SETTINGS))
        self.settings[key] = number
        self.stated[key] = line

    def points(self) -> PointRows:
        """Return the points [mm] as the settings say."""
        points = np.array([row[:2] for row in self.rows.values()])
        unit = self._unit()
        self._check_whole_shape(points)
        shifts = np.array([self.settings["shift.y"], self.settings["shift.z"]])
        moved = points + shifts
        for axis, column in zip("yz", moved.T, strict=True):
            self._check_axis(axis, column)
        mirrors = np.array([self.settings["mirror.y"], self.settings["mirror.z"]])
        mirrored = moved * (1.0 - 2.0 * mirrors)
        return PointRows((mirrored * unit).tolist(), self.path, tuple(self.rows))

    def _unit(self) -> float:
        """Return the unit of the points [mm]."""
        per_metre = self.settings["units.len.f"]
        if per_metre > 0.0:
            return 1000.0 / per_metre
        line = self.stated.get("units.len.f")
        wrong = "is no positive number"
        if line is None:
            wrong = "ends a profile without unit"
        allowed = "a setting units.len.f, the units in a metre"
        raise self._refused(line or self.last, wrong, allowed, "Write units.len.f = 1000 for mm.")

    def _check_whole_shape(self, points: np.ndarray) -> None:
        """Refuse settings that smooth, turn or leave out points."""
        if self.settings["approx.smooth"] != 0.0:
            raise self._changing("approx.smooth", "0", "Give `smooth` beside the file.")
        if self.settings["rotate"] != 0.0:
            raise self._changing("rotate", "0", "Turn the points before.")
        apart = float(np.hypot(*np.diff(points, axis=0).T).min(initial=np.inf))
        if self.settings["point.dist.min"] > apart:
            raise self._changing("point.dist.min", "a distance that leaves out no point", _EXPORT)

    def _check_axis(self, axis: str, column: np.ndarray) -> None:
        """Refuse mirrors that are not clear, and bounds that leave out points."""
        mirror = self.settings[f"mirror.{axis}"]
        shift = self.settings[f"shift.{axis}"]
        if mirror not in (0.0, 1.0) or (mirror and shift):
            allowed = "0 or 1, and 0 beside a shift, because the order of both is not known"
            raise self._changing(f"mirror.{axis}", allowed, _EXPORT)
        low = self.settings[f"bound.{axis}.min"]
        high = self.settings[f"bound.{axis}.max"]
        allowed = "bounds that leave out no point"
        remedy = "Leave out the points beyond the bounds."
        if low < high and column.min() < low:
            raise self._changing(f"bound.{axis}.min", allowed, remedy)
        if low < high and column.max() > high:
            raise self._changing(f"bound.{axis}.max", allowed, remedy)

    def _changing(self, name: str, allowed: str, remedy: str) -> InputError:
        return self._refused(self.stated.get(name, self.last), "changes the shape", allowed, remedy)
