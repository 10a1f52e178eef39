"""Draw roller and guide to scale with the forces of a solved case, as SVG text."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.report.numbers import rounded
from trackroller.roller.record import inputs_of

if TYPE_CHECKING:
    import xarray as xr

WIDTH, HEIGHT = 300.0, 330.0  # of the drawing [px]
LONGEST = 62.0  # the largest force [px]
SHORT = 30.0  # arrows of friction below this length [px] have no label
ARC = 40  # points of an arc


def drawing(ds: xr.Dataset) -> str:
    """Return the section through the roller's axis as an SVG element.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of one case with the output `forces`.

    Notes
    -----
    Lengths are to scale; so are the forces among each other. The width of the roller is not a parameter: twice the
    guide's radius is drawn.
    """
    values = inputs_of(ds)
    alpha, r_guide = math.radians(values["contact_angle"]), values["guide_profile_radius"]
    height = values["axis_distance"]
    scale = min(0.86 * HEIGHT / (height + r_guide), 0.3 * WIDTH / r_guide)
    picture = _Picture(scale, 0.5 * WIDTH, 0.06 * HEIGHT + height * scale)
    picture.polygon(_circle(r_guide), "guide")
    picture.polygon(_roller(alpha, r_guide, values["roller_profile_radius"], height), "roller")
    picture.line((-2.2 * r_guide, height), (2.2 * r_guide, height), "axis")
    forces = _forces(ds, values, alpha, r_guide, height)
    largest = max((math.hypot(*vector) for _, vector, _ in forces), default=1.0)
    for start, vector, label in forces:
        picture.arrow(start, tuple(LONGEST / largest / scale * v for v in vector), label)
    for number, sign in ((1, 1), (2, -1)):
        at = (sign * r_guide * math.sin(alpha), r_guide * math.cos(alpha))
        picture.dot(at)
        picture.text((0.72 * at[0], 0.72 * at[1]), str(number), "label")
    title = "Section through the roller's axis, to scale, with the forces on the roller"
    return (
        f'<svg class="drawing" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="{title}">'
        f"<title>{title}</title>"
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6" orient="auto">'
        f'<path d="M0 0L8 4L0 8z" class="tip"/></marker></defs>{"".join(picture.parts)}</svg>'
    )


def _circle(radius: float) -> np.ndarray:
    turn = np.linspace(0.0, 2.0 * np.pi, 2 * ARC)
    return radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)


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


def _forces(ds: xr.Dataset, values: dict[str, Any], alpha: float, r_guide: float, height: float) -> list:
    """Return the forces on the roller in the section: (start, vector, label) in mm and N."""
    found = []
    for number, sign in ((1, 1.0), (2, -1.0)):
        own = ds.sel(contact=number)
        at = (sign * r_guide * math.sin(alpha), r_guide * math.cos(alpha))
        load, lateral = float(own["normal_force"]), float(own["lateral_force"])
        if math.isfinite(load):
            found.append((at, (sign * math.sin(alpha) * load, math.cos(alpha) * load), f"F_N {rounded(load)} N"))
        if math.isfinite(lateral) and abs(lateral) > 0.02 * abs(values["radial_force"]):
            along = (math.cos(alpha) * lateral, -sign * math.sin(alpha) * lateral)
            found.append((at, along, f"F_T {rounded(lateral)} N"))
    radial, axial = values["radial_force"], values["axial_force"]
    found.append(((0.0, height), (0.0, radial), f"F_rad {rounded(radial)} N"))
    if axial:
        found.append(((0.0, height), (axial, 0.0), f"F_ax {rounded(axial)} N"))
    return found


class _Picture:
    """SVG elements in a frame of mm with its origin at the centre of the guide's contour."""

    def __init__(self, scale: float, left: float, top: float) -> None:
        self.scale, self.left, self.top = scale, left, top
        self.parts: list[str] = []

    def _at(self, point) -> tuple[float, float]:
        return self.left + point[0] * self.scale, self.top - point[1] * self.scale

    def polygon(self, points: np.ndarray, name: str) -> None:
        """Add a filled outline."""
        told = " ".join("{:.1f},{:.1f}".format(*self._at(p)) for p in points)
        self.parts.append(f'<polygon class="{name}" points="{told}"/>')

    def line(self, start, end, name: str, tip: bool = False) -> None:
        """Add a line, with an arrow's tip if asked for."""
        (x1, y1), (x2, y2) = self._at(start), self._at(end)
        marker = ' marker-end="url(#tip)"' if tip else ""
        self.parts.append(f'<line class="{name}" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"{marker}/>')

    def arrow(self, start, vector, label: str) -> None:
        """Add a force with its label beside the tip."""
        end = (start[0] + vector[0], start[1] + vector[1])
        self.line(start, end, "force", tip=True)
        length = math.hypot(*vector) or 1.0
        away = 9.0 / self.scale
        beside = (end[0] + away * vector[0] / length, end[1] + away * vector[1] / length)
        if label.startswith("F_T") and length * self.scale < SHORT:
            return  # its label would cover those of the other forces; the table has the value
        anchor = "middle" if abs(vector[0]) < 0.35 * length else "start" if vector[0] > 0 else "end"
        self.text(beside, label, "force-label", anchor)

    def dot(self, point) -> None:
        """Add a point of contact."""
        x, y = self._at(point)
        self.parts.append(f'<circle class="dot" cx="{x:.1f}" cy="{y:.1f}" r="2.6"/>')

    def text(self, point, text: str, name: str, anchor: str = "middle") -> None:
        """Add a label; an underscore starts a subscript."""
        x, y = self._at(point)
        head, _, rest = text.partition("_")
        sub, _, tail = rest.partition(" ")
        told = f'{head}<tspan dy="3" font-size="8">{sub}</tspan><tspan dy="-3"> {tail}</tspan>' if rest else head
        self.parts.append(f'<text class="{name}" x="{x:.1f}" y="{y + 4:.1f}" text-anchor="{anchor}">{told}</text>')
