"""Draw roller and guide to scale with the forces of a solved case, as SVG text."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from trackroller.contact.drawn_profiles import cross_section
from trackroller.errors import ShapeError
from trackroller.report import html
from trackroller.report.numbers import rounded
from trackroller.roller.stored_inputs import inputs_of

SIZE = np.array([340.0, 330.0])  # width and height of the drawing [px]
LONGEST = 62.0  # the largest force [px]
# guide radii; an axis farther from the guide is drawn nearer, so that the groove stays visible
TALLEST = 4.2
LETTER, LINE = 6.4, 13.0  # width of a letter and height of a line of text [px]
CLEAR = 2.5  # free space around a label [px]
DOWN = 4.0  # from the middle of a label to the line on which it stands [px]
ARC = 40  # points of an arc
REACH = 0.5  # guide radii; a profile is drawn so far on both sides of its contact
PROFILES = ("guide_profile", "roller_profile")
# label directions from an arrow's
TURNS = np.deg2rad([0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180])
STEPS = (6.0, 14.0, 24.0, 36.0, 50.0)  # from the tip of an arrow to its label [px]
Line = tuple[np.ndarray, np.ndarray]


class Labels:
    """Texts of a drawing, each placed where it covers no line and no other text.

    Parameters
    ----------
    lines : list of pairs of numpy.ndarray
        Lines that no text may cover, (2,) each [px].
    """

    def __init__(self, lines: list[Line]) -> None:
        starts, ends = np.array(lines, dtype=float).transpose(1, 0, 2)
        steps = np.hypot(*(ends - starts).T).astype(int) + 1
        share = np.concatenate([np.arange(n + 1) / n for n in steps.tolist()])[:, None]
        self.points = (
            np.repeat(starts, steps + 1, axis=0) * (1 - share)
            + np.repeat(ends, steps + 1, axis=0) * share
        )
        self.boxes: list[tuple[np.ndarray, np.ndarray]] = []

    def place(
        self, text: str, index: str, tip: np.ndarray, direction: np.ndarray
    ) -> dict[str, Any]:
        """Return a text with its index and its place near `tip`, at best in a direction, both (2,)
        [px].
        """
        half = 0.5 * np.array([LETTER * (len(text) + 0.8 * len(index)), LINE]) + CLEAR
        angles = math.atan2(direction[1], direction[0]) + TURNS
        toward = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        best = tip
        fewest = math.inf
        for step in STEPS:
            middles = tip + (step + half) * toward
            covered = self._covered(middles, half)
            least = int(np.argmin(covered))
            if covered[least] < fewest:
                best = middles[least]
                fewest = covered[least]
            if not fewest:
                break
        self.boxes.append((best, half))
        return {"at": best + np.array([0.0, DOWN]), "text": text, "index": index}

    def _covered(self, middles: np.ndarray, half: np.ndarray) -> np.ndarray:
        """Count the points of lines and the texts that boxes cover, (n,); a box outside the drawing
        covers a thousand.

        Parameters
        ----------
        middles : middles of the boxes, (n, 2) [px]
        half : half of their width and height, (2,) [px]
        """
        outside = ((middles < half) | (middles + half > SIZE)).any(axis=1)
        texts = sum(
            ((np.abs(middles - at) < half + own).all(axis=1) for at, own in self.boxes),
            np.zeros(len(middles)),
        )
        near = [np.abs(self.points[:, i] - middles[:, i, None]) < half[i] for i in (0, 1)]
        return np.count_nonzero(near[0] & near[1], axis=1) + 100 * texts + 1000 * outside


def drawing(ds: xr.Dataset) -> str:
    """Return the section through the roller's axis as an SVG element.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of one case with the output `forces`.

    Notes
    -----
    Lengths are to scale, and so are the forces relative to each other. Drawn profiles appear as
    given. The width of the roller is no parameter; it is drawn as twice the guide's radius. An axis
    farther than 4.2 guide radii is drawn nearer.
    """
    return html.render("drawing.svg.j2", content_of(ds))


def content_of(ds: xr.Dataset) -> dict[str, Any]:
    """Return outlines, forces, dimensions and labels of the drawing, in pixels; see `drawing`."""
    values = inputs_of(ds)
    alpha = math.radians(values["contact_angle"])
    r_guide = values["guide_profile_radius"]
    height = min(values["axis_distance"], TALLEST * r_guide)
    scale = min(0.84 * SIZE[1] / (height + r_guide), 0.28 * SIZE[0] / r_guide)
    origin = np.array([0.46 * SIZE[0], 0.08 * SIZE[1] + height * scale])

    def place(points: Any) -> np.ndarray:
        return origin + scale * np.asarray(points, dtype=float) * (1, -1)

    outline = _roller(values, height)
    outlines = [place(_guide(values)), place(outline)]
    axes = [
        place([(-1.8 * r_guide, height), (1.8 * r_guide, height)]),
        place([(-0.4, 0), (1.5 * r_guide, 0)]),
    ]
    forces = _forces(ds, values, alpha, height)
    largest = max((float(np.hypot(*force)) for *_, force in forces), default=1.0)
    arrows = [
        (place(at), place(at) + LONGEST / largest * force * (1, -1)) for at, *_, force in forces
    ]
    sizes = [
        (place(line), text, index, toward)
        for line, text, index, toward in _dimensions(values, r_guide, height, outline)
    ]
    contacts = place(
        r_guide
        * np.array([[math.sin(alpha), math.cos(alpha)], [-math.sin(alpha), math.cos(alpha)]])
    )
    lines = [*arrows, *((line[0], line[1]) for line, *_ in sizes)]
    labels = Labels([*lines, *_edges(outlines), *((axis[0], axis[1]) for axis in axes)])
    middle = place([(0.0, 0.0)])[0]
    named = [
        labels.place(str(i), "", at + 0.25 * (middle - at), np.array([0.0, 1.0]))
        for i, at in enumerate(contacts, 1)
    ]
    named += [
        labels.place(text, index, line[0], np.array(toward))
        for line, text, index, toward in sizes
        if text
    ]
    loads = [
        labels.place(f"F {rounded(size)} N", index, end, end - start)
        for (_, index, size, _), (start, end) in zip(forces, arrows, strict=True)
    ]
    return {
        "size": [f"{length:g}" for length in SIZE],
        "outlines": list(zip(("guide", "roller"), outlines, strict=True)),
        "axes": axes,
        "forces": arrows,
        "spans": [line for line, *_ in sizes],
        "contacts": contacts,
        "labels": [
            *((label, "label") for label in named),
            *((label, "force-label") for label in loads),
        ],
        "lines": lines,
        "boxes": labels.boxes,
    }


def _edges(outlines: list[np.ndarray]) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield both ends of each edge of closed outlines."""
    for points in outlines:
        yield from zip(points, np.roll(points, -1, axis=0), strict=True)


def _dimensions(
    values: dict[str, Any], r_guide: float, height: float, outline: np.ndarray
) -> list[tuple[np.ndarray, str, str, tuple[float, float]]]:
    """Return line [mm], text, index and direction of the label of the axis distance and of both
    profile radii.
    """
    side, groove = 1.5 * r_guide, outline[int(1.72 * ARC)]  # a point on the right flank
    radius = values["roller_profile_radius"]
    if math.isinf(radius):
        profile = ("straight profile", "")
    else:
        profile = (f"r {abs(radius):.5g} mm", "C,TR")
    if values.get("roller_profile"):
        profile = ("drawn profile", "")
    rim = r_guide * np.array([-0.8, -0.6])
    return [
        (
            np.array([(side, height / 2), (side, height)]),
            f"A {values['axis_distance']:.5g} mm",
            "T",
            (1.0, 0.0),
        ),
        (np.array([(side, height / 2), (side, 0.0)]), "", "", (1.0, 0.0)),
        (np.stack([1.25 * rim, rim]), f"r {r_guide:.5g} mm", "C,G", (-1.0, 1.0)),
        (np.stack([groove + r_guide * np.array([0.9, -0.55]), groove]), *profile, (1.0, 1.0)),
    ]


def _flank(values: dict[str, Any], body: str, side: int) -> np.ndarray:
    """Return a body's section about a contact, from inside to outside, as seen at contact 1, (n, 2)
    [mm].
    """
    alpha, r_guide, radius = (
        math.radians(values["contact_angle"]),
        *(values[f"{b}_radius"] for b in PROFILES),
    )
    if body == PROFILES[0]:
        radius = r_guide
    try:
        drawn = ""
        if values.get(body):
            drawn = json.dumps(values.get(body))
        shape = cross_section(drawn, body, radius, alpha, r_guide, side)
    except ShapeError:
        # the case has failed, and its verdict names the shape; the nominal circle is drawn
        shape = cross_section("", body, radius, alpha, r_guide, side)
    low, high = shape.limits
    u = np.linspace(max(low, -REACH * r_guide), min(high, REACH * r_guide), ARC)[:, None]
    # over the tangent plane, out of the body
    if body == PROFILES[0]:
        sign = 1.0
    else:
        sign = -1.0
    height = shape.full_height(u) * sign
    normal = np.array([math.sin(alpha), math.cos(alpha)])
    outward = np.array([math.cos(alpha), -math.sin(alpha)])
    flank = (r_guide + height) * normal + u * outward
    return flank[flank[:, 0] > 0]


def _guide(values: dict[str, Any]) -> np.ndarray:
    """Outline of the guide's section: a circle, or its drawn profile about both contacts."""
    radius = values["guide_profile_radius"]
    if not values.get("guide_profile"):
        return _arc(radius, 0.0, 2.0 * np.pi)
    right, left = (
        _flank(values, "guide_profile", side) * (sign, 1) for side, sign in ((1, 1), (2, -1))
    )
    (inner, outer), (far, near) = (
        np.arctan2(flank[[0, -1], 1], flank[[0, -1], 0]) for flank in (right, left)
    )
    below, above = _arc(radius, outer, near - 2.0 * np.pi), _arc(radius, far, inner)
    return np.concatenate([right, below[1:-1], left[::-1], above[1:-1]])


def _arc(radius: float, start: float, end: float) -> np.ndarray:
    turn = np.linspace(start, end, 2 * ARC)
    return radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)


def _roller(values: dict[str, Any], height: float) -> np.ndarray:
    """Outline of the roller's section: its profile about each contact, the outer ends, and the
    axis.
    """
    half = 1.25 * values["guide_profile_radius"]
    right, left = (_flank(values, "roller_profile", side) for side in (1, 2))
    ends = np.array([[half, right[-1, 1]], [half, height], [-half, height], [-half, left[-1, 1]]])
    return np.concatenate([(left * (-1, 1))[::-1], right, ends])


def _forces(
    ds: xr.Dataset, values: dict[str, Any], alpha: float, height: float
) -> list[tuple[np.ndarray, str, float, np.ndarray]]:
    """Return the forces on the roller in the section: place [mm], index, size and vector [N]."""
    forces = []
    axle = np.array([0.0, height])
    radial, axial = values["radial_force"], values["axial_force"]
    ds = ds[["normal_force", "lateral_force"]]
    for number, sign in ((1, 1.0), (2, -1.0)):
        own = ds.sel(contact=number)
        normal = np.array([sign * math.sin(alpha), math.cos(alpha)])
        along = np.array([math.cos(alpha), -sign * math.sin(alpha)])
        load = float(own["normal_force"])
        lateral = float(own["lateral_force"])
        if math.isfinite(load):
            forces.append(
                (values["guide_profile_radius"] * normal, f"N{number}", load, load * normal)
            )
        if math.isfinite(lateral) and abs(lateral) > 0.02 * abs(radial):
            forces.append(
                (values["guide_profile_radius"] * normal, f"T{number}", lateral, lateral * along)
            )
    forces.append((axle, "rad", radial, np.array([0.0, radial])))
    axial_force = []
    if axial:
        axial_force = [(axle, "ax", axial, np.array([axial, 0.0]))]
    return forces + axial_force
