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

`frame: section` is this picture. Contact 1 takes the part with x >= 0. Contact 2 takes the mirrored part with x <= 0,
or the same part as contact 1 if nothing is drawn there. The curve touches where its inclination is the contact angle.
`frame: contact` is the picture turned by the contact angle: x = 0 is the nominal point of contact, x > 0 is outward in
both contacts, z is the common normal towards the roller. Only the shape of a curve counts, not its place.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from trackroller.errors import InputError, check_names, unknown_name
from trackroller.numerics.numbers import number_in, number_or_nan

FORMS = ("arc", "parabola", "arcs", "points", "file")
KEYS = (*FORMS, "frame", "smooth", "edge", "width", "worn")
WORN_KEYS = ("start", "step", "depth", "moved", "inclined")
EDGE_KEYS = ("inner", "outer", "chamfer")
FRAMES = ("section", "contact")
FARTHEST = 1e300  # mm; largest finite length
FEWEST, MOST = 5, 20_000  # smallest and largest number of points of a drawn cross-section

PointReader = Callable[[Any, str], list[list[float]]]  # (name of a file, field) -> rows [x, z]


def canonical(value: Mapping[str, Any], field: str = "profile", read: PointReader | None = None) -> dict[str, Any]:
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
        The same description with `points` in place of `file`; {} for an empty mapping.

    Raises
    ------
    InputError
        If a part is wrong; the error names the part, its value, what is allowed and what to do.

    Notes
    -----
    `arc: r` is a circle (> 0 convex, < 0 a groove, inf straight) [mm], and `parabola: r` its approximation in Hertz's
    theory. `arcs: [{radius: r, to: x}, ..., {radius: r}]` are tangent arcs from inside to outside, with x from the
    nominal contact. `points: [[x, z], ...]` are drawn or measured points with increasing x [mm], and `file: name.csv`
    gives them as two columns of a file.

    Points and files may also have `frame: section | contact` (default section) and `smooth`: the standard deviation of
    the measuring noise [mm], 'auto', or 0. With the default 0 the spline passes through every point.

    Every form may have `edge: {inner: mm, outer: mm, chamfer: mm}` or `width: mm`. `edge` gives the distances from the
    nominal contact along the tangent plane at which the material ends, and the radius of the rounded edge. `width` is
    the width of the whole groove or guide along the axis of the roller.

    Every form may also have `worn: {start: mm, step: mm, depth: [[mm, ...]]}`, the depth that wear took off, as
    `trackroller wear` writes it. `depth` has one list for both contacts or one for each, with the mean depth of equal
    cells outward of the nominal contact; `start` is the middle of the first cell. `moved: [mm]` gives the distances by
    which the body has moved outward, `inclined: [rad]` at the guide the angles by which the contact
    normals have turned outward.
    """
    if not value:
        return {}
    check_names(f"{field} entry", value, KEYS)
    forms = [key for key in FORMS if key in value]
    if len(forms) != 1:
        remedy = "Keep the entry that describes the cross-section."
        raise InputError(field, sorted(map(str, value)), "exactly one of " + ", ".join(FORMS), remedy)
    out = _shape(forms[0], value, field, read)
    if "points" not in out:
        for key in ("frame", "smooth"):
            if key in value:
                raise InputError(f"{field}.{key}", value[key], "only with points or a file", "Leave it out.")
    if "edge" in value and "width" in value:
        raise InputError(field, "edge and width", "one of the two", "Keep the entry that you know.")
    if "edge" in value:
        out["edge"] = _edge(value["edge"], f"{field}.edge")
    if "width" in value:
        out["width"] = _number(value["width"], f"{field}.width", positive=True)
    if "worn" in value:
        out["worn"] = _worn(value["worn"], f"{field}.worn")
    return out


def _number(value: Any, field: str, positive: bool = False, finite: bool = True) -> float:
    words = ("a number > 0" if positive else "a number other than 0") + (" [mm]" if finite else " or inf [mm]")
    number = number_in(value, field, words, 0.0 if positive else -math.inf, unit="mm")
    if number == 0.0 or (finite and math.isinf(number)):
        raise InputError(field, value, words)
    return number


def _shape(form: str, value: Mapping[str, Any], field: str, read: PointReader | None) -> dict[str, Any]:
    """Return the entries that describe the curve itself."""
    if form in ("arc", "parabola"):
        return {form: _number(value[form], f"{field}.{form}", finite=False)}
    if form == "arcs":
        return {"arcs": _arcs(value["arcs"], f"{field}.arcs")}
    if form == "file" and read is None:
        raise InputError(f"{field}.file", value["file"], "points", "Read the file and give its rows as points.")
    rows = read(value["file"], f"{field}.file") if form == "file" and read else value["points"]
    frame = value.get("frame", "section")
    if frame not in FRAMES:
        raise unknown_name(f"{field}.frame", str(frame), FRAMES)
    out: dict[str, Any] = {"points": _points(rows, f"{field}.{form}"), "frame": frame}
    x = [p[0] for p in out["points"]]
    if frame == "contact" and not x[0] < 0 < x[-1]:
        remedy = "In frame: contact x counts from the nominal contact; in frame: section from the middle of the guide."
        allowed = "points on both sides of the nominal contact x = 0"
        raise InputError(f"{field}.{form}", [x[0], x[-1]], allowed, remedy)
    smooth = value.get("smooth", 0.0)
    if smooth != "auto":
        allowed = "the standard deviation of the noise >= 0 [mm], or 'auto'"
        smooth = number_in(smooth, f"{field}.smooth", allowed, 0.0, FARTHEST, unit="mm")
    if smooth:
        out["smooth"] = smooth
    return out


def _arcs(rows: Any, field: str) -> list[dict[str, float]]:
    if not isinstance(rows, (list, tuple)) or not rows or not all(isinstance(row, Mapping) for row in rows):
        raise InputError(field, rows, "a list of {radius: mm, to: mm} from inside to outside, the last without `to`")
    out: list[dict[str, float]] = []
    for i, row in enumerate(rows):
        here = f"{field}[{i}]"
        check_names(f"{here} entry", row, ("radius", "to"))
        last = i == len(rows) - 1
        if "radius" not in row or ("to" in row) == last:
            raise InputError(here, dict(row), "a radius, and where the arc ends (`to`) for all but the last")
        arc = {"radius": _number(row["radius"], f"{here}.radius", finite=False)}
        if not last:
            allowed = "a finite place [mm] beyond the end of the arc before"
            start = math.nextafter(out[-1]["to"], math.inf) if out else -FARTHEST
            arc["to"] = number_in(row["to"], f"{here}.to", allowed, start, FARTHEST, unit="mm")
        out.append(arc)
    return out


def _points(rows: Any, field: str) -> list[list[float]]:
    try:
        points = np.asarray([[number_or_nan(v, "mm", field) for v in row] for row in rows], dtype=float)
    except (TypeError, ValueError):
        raise InputError(field, rows if len(str(rows)) < 200 else "...", "rows of two numbers x, z [mm]") from None
    if points.ndim != 2 or points.shape[1] != 2 or not FEWEST <= len(points) <= MOST:
        allowed = f"{FEWEST} to {MOST} rows of two numbers x, z [mm]"
        raise InputError(field, f"an array of shape {points.shape}", allowed)
    for wrong, allowed, remedy in (
        (~np.isfinite(points).all(axis=1), "finite numbers", "Leave out the rows that were not measured."),
        (
            np.diff(points.T[0], prepend=-np.inf) <= 0,
            "x increases from row to row",
            "Sort by x; keep one point for each x.",
        ),
    ):
        for row in np.flatnonzero(wrong)[:1].tolist():
            raise InputError(f"{field}[{row}]", points[row].tolist(), allowed, remedy)
    return points.tolist()


def _edge(value: Any, field: str) -> dict[str, float]:
    if not isinstance(value, Mapping) or not value:
        raise InputError(field, value, "a mapping with one or more of " + ", ".join(EDGE_KEYS))
    check_names(f"{field} entry", value, EDGE_KEYS)
    return {key: _number(value[key], f"{field}.{key}", positive=True) for key in EDGE_KEYS if key in value}


def _worn(value: Any, field: str) -> dict[str, Any]:
    allowed = "a mapping with start, step > 0 and depth, lists of numbers >= 0 [mm] for one or both contacts"
    try:
        start, step = float(value["start"]), float(value["step"])
        depth = np.atleast_2d(np.asarray(value["depth"], float))
        turned = {key: np.broadcast_to(np.asarray(value.get(key, 0.0), float), len(depth)) for key in WORN_KEYS[3:]}
    except (TypeError, ValueError, KeyError):
        raise InputError(field, value if len(str(value)) < 200 else "...", allowed) from None
    check_names(f"{field} entry", value, WORN_KEYS)
    fits = step > 0 and depth.ndim == 2 and 1 <= len(depth) <= 2 and 1 <= depth.shape[1] <= MOST and np.all(depth >= 0)
    if not (
        fits and np.isfinite([start, step, *np.concatenate([*turned.values()])]).all() and np.isfinite(depth).all()
    ):
        raise InputError(field, "...", allowed)
    return {"start": start, "step": step, "depth": depth.tolist()} | {k: v.tolist() for k, v in turned.items()}
