"""Draw roller and guide to scale with the forces of a solved case, as SVG text."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.report import html
from trackroller.report.numbers import rounded
from trackroller.roller.record import inputs_of

if TYPE_CHECKING:
    import xarray as xr

SIZE = np.array([300.0, 330.0])  # width and height of the drawing [px]
LONGEST = 62.0  # the largest force [px]
SHORT = 30.0  # arrows of friction below this length [px] have no label
AWAY = 9.0  # from the tip of an arrow to its label [px]
DOWN = np.array([0.0, 4.0])  # from the middle of a label to the line on which it stands [px]
ARC = 40  # points of an arc


def drawing(ds: xr.Dataset) -> str:
    """Return the section through the roller's axis as an SVG element.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of one case with the output `forces`.

    Notes
    -----
    Lengths are to scale, and so are the forces relative to each other. The width of the roller is no parameter; it is
    drawn as twice the guide's radius.
    """
    values = inputs_of(ds)
    alpha, r_guide = math.radians(values["contact_angle"]), values["guide_profile_radius"]
    height = values["axis_distance"]
    scale = min(0.86 * SIZE[1] / (height + r_guide), 0.3 * SIZE[0] / r_guide)
    origin = np.array([0.5 * SIZE[0], 0.06 * SIZE[1] + height * scale])

    def place(points: Any) -> np.ndarray:
        return origin + scale * np.asarray(points, dtype=float) * (1, -1)

    turn = np.linspace(0.0, 2.0 * np.pi, 2 * ARC)
    outline = _roller(alpha, r_guide, values["roller_profile_radius"], height)
    forces = _forces(ds, values, alpha)
    largest = max((float(np.hypot(*force)) for *_, force in forces), default=1.0)
    contacts = r_guide * np.array([[math.sin(alpha), math.cos(alpha)], [-math.sin(alpha), math.cos(alpha)]])
    content = {
        "size": [f"{length:g}" for length in SIZE],
        "outlines": [("guide", place(r_guide * np.stack([np.cos(turn), np.sin(turn)], 1))), ("roller", place(outline))],
        "axis": place([(-2.2 * r_guide, height), (2.2 * r_guide, height)]),
        "forces": [
            _arrow(place(at), LONGEST / largest * force * (1, -1), index, load) for at, index, load, force in forces
        ],
        "contacts": [(place(at), place(0.72 * at) + DOWN) for at in contacts],
    }
    return html.render("drawing.svg.j2", content)


def _roller(alpha: float, r_guide: float, r_roller: float, height: float) -> np.ndarray:
    """Outline of the roller's section: an arc about each contact, the outer ends, and the axis."""
    half = 1.25 * r_guide
    contact = r_guide * np.array([math.sin(alpha), math.cos(alpha)])
    normal = contact / r_guide
    if math.isinf(r_roller):
        reach = np.linspace(-0.35 * r_guide, 0.35 * r_guide, ARC)
        flank = contact + reach[:, None] * np.array([math.cos(alpha), -math.sin(alpha)])
    else:
        centre = contact + normal * r_roller  # behind the guide for a groove, in the roller for a convex profile
        sign = -math.copysign(1.0, r_roller)
        spread = min(0.45, 0.5 * r_guide / abs(r_roller))
        turn = alpha + np.linspace(-spread, spread, ARC)
        flank = centre + abs(r_roller) * sign * np.stack([np.sin(turn), np.cos(turn)], axis=1)
    flank = flank[(flank[:, 0] > 0) & (flank[:, 0] < half)]
    flank = flank[np.argsort(flank[:, 0])]
    ends = np.array([[half, flank[-1, 1]], [half, height], [-half, height], [-half, flank[-1, 1]]])
    return np.concatenate([(flank * (-1, 1))[::-1], flank, ends])


def _forces(ds: xr.Dataset, values: dict[str, Any], alpha: float) -> list[tuple[np.ndarray, str, float, np.ndarray]]:
    """Return the forces on the roller in the section: place [mm], index, size and vector [N]."""
    found, axle = [], np.array([0.0, values["axis_distance"]])
    radial, axial = values["radial_force"], values["axial_force"]
    for number, sign in ((1, 1.0), (2, -1.0)):
        own = ds.sel(contact=number)
        normal = np.array([sign * math.sin(alpha), math.cos(alpha)])
        along = np.array([math.cos(alpha), -sign * math.sin(alpha)])
        load, lateral = float(own["normal_force"]), float(own["lateral_force"])
        if math.isfinite(load):
            found.append((values["guide_profile_radius"] * normal, "N", load, load * normal))
        if math.isfinite(lateral) and abs(lateral) > 0.02 * abs(radial):
            found.append((values["guide_profile_radius"] * normal, "T", lateral, lateral * along))
    found.append((axle, "rad", radial, np.array([0.0, radial])))
    return found + ([(axle, "ax", axial, np.array([axial, 0.0]))] if axial else [])


def _arrow(start: np.ndarray, step: np.ndarray, index: str, size: float) -> dict[str, Any]:
    """Return a force with its label beside the tip.

    A short arrow of friction has no label, which would cover those of the other forces: the table has its value.
    """
    length = float(np.hypot(*step)) or 1.0
    anchor = "middle" if abs(step[0]) < 0.35 * length else "start" if step[0] > 0 else "end"
    end = start + step
    beside = end + AWAY / length * step + DOWN
    told = {"index": index, "size": rounded(size), "labelled": index != "T" or length >= SHORT}
    return {"start": start, "end": end, "beside": beside, "anchor": anchor, **told}
