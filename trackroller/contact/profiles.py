"""Check drawn and measured cross-sections of guide and roller as a case gives them.

Both bodies are drawn in the same picture::

         z (towards the roller's axis)
         |        roller: material above its curve
         |     ___________
         |   /   groove    \\
         | /  .---------.   \\        guide: material below its curve
         |  /   guide    \\
    -----+--------------------> x (along the roller's axis)
       x = 0: middle of the guide

`frame: section` is this picture. Contact 1 takes the part with x >= 0. Contact 2 takes the mirrored
part with x <= 0, or the same part as contact 1 if nothing is drawn there. The curve touches where
its inclination is the contact angle. `frame: contact` is the picture turned by the contact angle: x
= 0 is the nominal point of contact, x > 0 is outward in both contacts, z is the common normal
towards the roller. Only the shape of a curve counts, not its place.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from trackroller.contact.measured_points import (
    FARTHEST,
    MISLEADING,
    TOLD,
    PointFaults,
    examined,
    in_order,
)
from trackroller.errors import Collector, InputError, check_names, unknown_name
from trackroller.numerics.numbers import number_in, number_or_nan

FORMS = ("arc", "parabola", "arcs", "points", "file")
KEYS = (*FORMS, "name", "frame", "smooth", "edge", "width", "worn")
LONGEST_NAME = 80  # characters
WORN_KEYS = ("start", "step", "depth", "moved", "inclined")
EDGE_KEYS = ("inner", "outer", "chamfer")
FRAMES = ("section", "contact")
LARGEST = 1e300  # mm; largest finite length
FEWEST, MOST = 5, 20_000  # smallest and largest number of points of a drawn cross-section
# scatter of sorted points over their height from which on they are two parts of an outline
FOLDED = 0.05


class PointRows(NamedTuple):
    """Points of a cross-section as they were given: rows [x, z], and the file and the line of each,
    if there is one.
    """

    rows: Any
    path: Path | None = None
    lines: tuple[int, ...] = ()

    def at(self, row: int, error: InputError) -> InputError:
        """Return an error after noting where this row stands."""
        return error if self.path is None else error.at(self.path, self.lines[row])


PointReader = Callable[[Any, str], PointRows]  # (name of a file, field) -> points


def canonical(
    value: Mapping[str, Any], field: str = "profile", read: PointReader | None = None
) -> dict[str, Any]:
    """Return the checked mapping of a cross-section, with plain numbers.

    Parameters
    ----------
    value : mapping
        Exactly one of the forms `arc`, `parabola`, `arcs`, `points` and `file`; see Notes.
    field : str
        Name of the study key for error messages, such as `guide_profile` or `roller_profile`.
    read : callable, optional
        Function that reads the points of a file, see `roller.point_files.read_points`.

    Returns
    -------
    dict
        The same description with `points` in place of `file`, and the name of the file; {} for an
        empty mapping.

    Raises
    ------
    InputError
        If a part is wrong; the error names the part, its value, what is allowed and what to do.

    Notes
    -----
    `arc: r` is a circle (> 0 convex, < 0 a groove, inf straight) [mm], and `parabola: r` its
    approximation in Hertz's theory. `arcs: [{radius: r, to: x}, ..., {radius: r}]` are tangent arcs
    from inside to outside, with x from the nominal contact. `points: [[x, z], ...]` are drawn or
    measured points [mm], and `file: name.csv` gives them as two columns of a file. They are sorted
    by x, and points that stand twice count once. `name` is what reports call the shape, by default
    the name of the file.

    Points and files may also have `frame: section | contact` (default section) and `smooth`: the
    standard deviation of the measuring noise [mm], 'auto', or 0. Without it, the spline passes
    through every point, and points that scatter or lie off their neighbours are refused. `smooth:
    0` says that every point is meant.

    Every form may have `edge: {inner: mm, outer: mm, chamfer: mm}` or `width: mm`. `edge` gives the
    distances from the nominal contact along the tangent plane at which the material ends, and the
    radius of the rounded edge. `width` is the width of the whole groove or guide along the axis of
    the roller.

    Every form may also have `worn: {start: mm, step: mm, depth: [[mm, ...]]}`, the depth that wear
    took off, as `trackroller wear` writes it. `depth` has one list for both contacts or one for
    each, with the mean depth of equal cells outward of the nominal contact; `start` is the middle
    of the first cell. `moved: [mm]` gives the distances by which the body has moved outward,
    `inclined: [rad]` at the guide the angles by which the contact normals have turned outward.
    """
    if not value:
        return {}
    check_names(f"{field} entry", value, KEYS)
    forms = [key for key in FORMS if key in value]
    if len(forms) != 1:
        remedy = "Keep the entry that describes the cross-section."
        raise InputError(
            field, sorted(map(str, value)), "exactly one of " + ", ".join(FORMS), remedy
        )
    out = _shape(forms[0], value, field, read)
    if "points" not in out:
        for key in ("name", "frame", "smooth"):
            if key in value:
                raise InputError(
                    f"{field}.{key}", value[key], "only with points or a file", "Leave it out."
                )
    if "edge" in value and "width" in value:
        raise InputError(field, "edge and width", "one of the two", "Keep the entry that you know.")
    if "edge" in value:
        out["edge"] = _edge(value["edge"], f"{field}.edge")
    if "width" in value:
        out["width"] = _number(value["width"], f"{field}.width", positive=True)
    if "worn" in value:
        out["worn"] = _worn(value["worn"], f"{field}.worn")
    return out


def _name(value: Any, field: str) -> str:
    if (
        not isinstance(value, str)
        or not 0 < len(value.strip()) <= LONGEST_NAME
        or not value.isprintable()
    ):
        allowed = f"a text of at most {LONGEST_NAME} printed characters"
        raise InputError(field, value, allowed, "Write a short name, or leave it out.")
    return value.strip()


def _number(value: Any, field: str, positive: bool = False, finite: bool = True) -> float:
    words = ("a number > 0" if positive else "a number other than 0") + (
        " [mm]" if finite else " or inf [mm]"
    )
    number = number_in(value, field, words, 0.0 if positive else -math.inf, unit="mm")
    if number == 0.0 or (finite and math.isinf(number)):
        raise InputError(field, value, words)
    return number


def _shape(
    form: str, value: Mapping[str, Any], field: str, read: PointReader | None
) -> dict[str, Any]:
    """Return the entries that describe the curve itself."""
    if form in ("arc", "parabola"):
        return {form: _number(value[form], f"{field}.{form}", finite=False)}
    if form == "arcs":
        return {"arcs": _arcs(value["arcs"], f"{field}.arcs")}
    if form == "file" and read is None:
        raise InputError(
            f"{field}.file", value["file"], "points", "Read the file and give its rows as points."
        )
    given = (
        read(value["file"], f"{field}.file")
        if form == "file" and read
        else PointRows(value["points"])
    )
    frame = value.get("frame", "section")
    if frame not in FRAMES:
        raise unknown_name(f"{field}.frame", str(frame), FRAMES)
    points = _points(given, f"{field}.{form}")
    low, high = float(points[:, 0].min()), float(points[:, 0].max())
    if frame == "contact" and not low < 0 < high:
        remedy = (
            "In frame: contact x counts from the nominal contact; in frame: section from the "
            "middle of the guide."
        )
        allowed = "points on both sides of the nominal contact x = 0"
        raise InputError(f"{field}.{form}", [low, high], allowed, remedy)
    out: dict[str, Any] = {"points": points.tolist(), "frame": frame}
    if form == "file" or "name" in value:  # where a file lies on this machine is not stored
        file = Path(str(value.get("file", "")))
        out["name"] = _name(
            value.get("name", file.name if file.is_absolute() else str(file)), f"{field}.name"
        )
    smooth = value.get("smooth", 0.0)
    if smooth != "auto":
        allowed = "the standard deviation of the noise >= 0 [mm], or 'auto'"
        smooth = number_in(smooth, f"{field}.smooth", allowed, 0.0, LARGEST, unit="mm")
    order = _checked_order(points, given, f"{field}.{form}")
    faults = examined(*points[order].T)
    meant = "smooth" in value and not smooth
    if not meant:
        _check_curve(faults, points, order, given, f"{field}.{form}")
    if "smooth" not in value and faults.roughness >= MISLEADING:
        error = _unsmoothed(faults, field)
        error.file = None if given.path is None else str(given.path)
        raise error
    if smooth or (meant and (faults.runs or faults.jumps or faults.roughness >= TOLD)):
        out["smooth"] = smooth
    return out


def _arcs(rows: Any, field: str) -> list[dict[str, float]]:
    """Return the checked arcs of a profile: radius [mm], and where each but the last ends [mm]."""
    if (
        not isinstance(rows, (list, tuple))
        or not rows
        or not all(isinstance(row, Mapping) for row in rows)
    ):
        raise InputError(
            field,
            rows,
            "a list of {radius: mm, to: mm} from inside to outside, the last without `to`",
        )
    out: list[dict[str, float]] = []
    for i, row in enumerate(rows):
        here = f"{field}[{i}]"
        check_names(f"{here} entry", row, ("radius", "to"))
        last = i == len(rows) - 1
        if "radius" not in row or ("to" in row) == last:
            raise InputError(
                here, dict(row), "a radius, and where the arc ends (`to`) for all but the last"
            )
        arc = {"radius": _number(row["radius"], f"{here}.radius", finite=False)}
        if not last:
            allowed = "a finite place [mm] beyond the end of the arc before"
            start = math.nextafter(out[-1]["to"], math.inf) if out else -LARGEST
            arc["to"] = number_in(row["to"], f"{here}.to", allowed, start, LARGEST, unit="mm")
        out.append(arc)
    return out


def _points(given: PointRows, field: str) -> np.ndarray:
    """Return the numbers of points (n, 2) [mm] as they were given."""
    rows = given.rows
    try:
        points = np.asarray(
            [[number_or_nan(v, "mm", field) for v in row] for row in rows], dtype=float
        )
    except (TypeError, ValueError):
        raise InputError(
            field, rows if len(str(rows)) < 200 else "...", "rows of two numbers x, z [mm]"
        ) from None
    if points.ndim != 2 or points.shape[1] != 2 or not FEWEST <= len(points) <= MOST:
        allowed = f"{FEWEST} to {MOST} rows of two numbers x, z [mm]"
        raise InputError(field, f"an array of shape {points.shape}", allowed)
    lost = ~(np.abs(points) < FARTHEST).all(axis=1)
    for row in np.flatnonzero(lost)[:1].tolist():
        allowed, remedy = (
            f"finite numbers below {FARTHEST:g} mm",
            "Leave out the points that were not measured.",
        )
        error = InputError(
            f"{field}[{row}]", points[row].tolist(), allowed, remedy, "is no place of a point"
        )
        raise given.at(row, error)
    return points


def _checked_order(points: np.ndarray, given: PointRows, field: str) -> np.ndarray:
    """Return the order of points by x, each once; refuse two heights for one x, and outlines that
    turn back.
    """
    order = in_order(points)
    x, z = points[order].T
    for k in np.flatnonzero(np.diff(x) <= 0)[:1].tolist():
        first, second = sorted((int(order[k]), int(order[k + 1])))
        wrong = f"has the x of point {first + 1}, whose z is {points[first, 1]:g} mm"
        remedy = (
            "Keep one of these points, or their mean; x is the position across the profile, "
            "z the height."
        )
        error = InputError(field, _named(points, [second]), "one height for each x", remedy, wrong)
        raise given.at(second, error)
    if len(order) < FEWEST:
        raise InputError(
            field, f"{len(order)} different points", f"at least {FEWEST}", wrong="are too few"
        )
    steps = np.diff(points[:, 0])
    turns = np.flatnonzero(steps[1:] * steps[:-1] < 0)
    if turns.size and examined(x, z).scatter > FOLDED * np.ptp(z):
        row = int(turns[0]) + 1
        allowed = "points of a curve with one height for each x"
        remedy = (
            "Keep the part of the outline that faces the other body, with the position in "
            "column x, z in column z."
        )
        raise given.at(
            row, InputError(field, _named(points, [row]), allowed, remedy, "is where x turns back")
        )
    return order


def _check_curve(
    faults: PointFaults, points: np.ndarray, order: np.ndarray, given: PointRows, field: str
) -> None:
    """Refuse points off the curve through their neighbours, and jumps; `faults` counts in
    `order`.
    """
    wrong = Collector()

    def refuse(rows: list[int], row: int, lies: str, remedy: str) -> None:
        error = InputError(field, _named(points, rows), "points of one curve", remedy, lies)
        wrong.errors.append(given.at(row, error))

    near: set[int] = set()
    for run in faults.runs:
        rows = sorted(order[run.first : run.last + 1].tolist())
        near |= set(range(run.first - 1, run.last + 1))
        lies = (
            f"{_length(run.off)} off {'its neighbours' if len(rows) == 1 else 'their neighbours'}"
        )
        remedy = (
            "Leave out lost points and specks. If the shape is meant, draw it with more "
            "points, or give smooth: 0."
        )
        refuse(rows, rows[0], f"{'lies' if len(rows) == 1 else 'lie'} {lies}", remedy)
    for k in (k for k in faults.jumps if k not in near):
        (x, z), (to_x, to_z) = points[order[k]], points[order[k + 1]]
        rows = sorted((int(order[k]), int(order[k + 1])))
        lies = (
            f"have a step between them that is {_length(to_x - x)} wide and "
            f"{_length(abs(to_z - z))} high"
        )
        remedy = (
            "Leave out lost points. If a step is meant, end the points there and give "
            "`edge`, or give smooth: 0."
        )
        refuse(rows, rows[1], lies, remedy)
    wrong.check()


def _named(points: np.ndarray, rows: list[int]) -> str:
    """Return points in words, such as 'point 41 (-2.5, 0)'."""
    ends = [f"({x:.6g}, {z:.6g})" for x, z in points[rows][[0, -1]]]
    if len(rows) == 1:
        return f"point {rows[0] + 1} {ends[0]}"
    return f"points {rows[0] + 1} to {rows[-1] + 1}, {ends[0]} to {ends[1]}"


def _length(size: float) -> str:
    return f"{size:.3g} mm" if size >= 0.1 else f"{1e3 * size:.2g} µm"


def _unsmoothed(faults: PointFaults, field: str) -> InputError:
    """Return the error for points whose scatter would count as shape."""
    noise = f"{1e3 * faults.scatter:.2g} um"
    wrong = (
        f"is missing, and the points scatter by {noise} (noise or rounding), which can raise "
        "the pressure by "
    )
    allowed = "auto, the standard deviation of the noise, or 0"
    # the scatter found here is no advice: a curve smoothed by slightly less than the noise follows
    # it
    remedy = "Give smooth: auto. Give smooth: 0 if the scatter is the shape."
    return InputError(f"{field}.smooth", None, allowed, remedy, wrong + faults.pressure_rise)


def _edge(value: Any, field: str) -> dict[str, float]:
    if not isinstance(value, Mapping) or not value:
        raise InputError(field, value, "a mapping with one or more of " + ", ".join(EDGE_KEYS))
    check_names(f"{field} entry", value, EDGE_KEYS)
    return {
        key: _number(value[key], f"{field}.{key}", positive=True)
        for key in EDGE_KEYS
        if key in value
    }


def _worn(value: Any, field: str) -> dict[str, Any]:
    """Return the checked wear of a profile: depths [mm] at places from `start` on, `step` apart
    [mm].
    """
    allowed = (
        "a mapping with start, step > 0 and depth, lists of numbers >= 0 [mm] for one or "
        "both contacts"
    )
    try:
        start, step = float(value["start"]), float(value["step"])
        depth = np.atleast_2d(np.asarray(value["depth"], float))
        turned = {
            key: np.broadcast_to(np.asarray(value.get(key, 0.0), float), len(depth))
            for key in WORN_KEYS[3:]
        }
    except (TypeError, ValueError, KeyError):
        raise InputError(field, value if len(str(value)) < 200 else "...", allowed) from None
    check_names(f"{field} entry", value, WORN_KEYS)
    fits = (
        step > 0
        and depth.ndim == 2
        and 1 <= len(depth) <= 2
        and 1 <= depth.shape[1] <= MOST
        and np.all(depth >= 0)
    )
    if not (
        fits
        and np.isfinite([start, step, *np.concatenate([*turned.values()])]).all()
        and np.isfinite(depth).all()
    ):
        raise InputError(field, "...", allowed)
    return {"start": start, "step": step, "depth": depth.tolist()} | {
        k: v.tolist() for k, v in turned.items()
    }
