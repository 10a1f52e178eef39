"""Make the cross-sections and the gap of one contact from the profiles of a case (see
`profiles.canonical`).
"""

from __future__ import annotations

import json
import math
from functools import lru_cache
from typing import Any

import numpy as np

from trackroller.contact.cross_sections import (
    CrossSection,
    Gap,
    arcs,
    drawn,
    parabola,
    smoothed,
    with_edges,
    worn,
)
from trackroller.contact.measured_points import in_order, noise_of
from trackroller.contact.profiles import FEWEST
from trackroller.errors import ShapeError

# These limits are ratios to the profile radius of the guide, except ASTRAY.
INTERLOCK = 0.01  # largest overlap of the shapes beside the nominal contact
# Bodies that overlap by more than FIRST at a distance of more than ASIDE from the nominal contact
# touch elsewhere.
ASIDE, FIRST = 0.2, 5e-4
NARROWEST, WIDEST = 5e-3, 50.0  # smallest and largest extent of points about the contact
ASTRAY = 2.5  # largest ratio between the distances of drawn and nominal contact from the middle


@lru_cache(maxsize=256)
def _parsed(text: str) -> dict[str, Any]:
    return json.loads(text)


def cross_section(
    text: str, body: str, radius: float, alpha: float, guide_radius: float, side: int
) -> CrossSection:
    """Return the cross-section of one body beside one contact.

    Parameters
    ----------
    text : str
        Canonical JSON of the profile; "" for the circle of `radius`.
    body : str
        "guide_profile" or "roller_profile".
    radius : float
        Profile radius of the body [mm].
    alpha : float
        Contact angle [rad].
    guide_radius : float
        Nominal r_C,G [mm], from which the distance of the contact from the middle follows.
    side : int
        Number of the contact, 1 or 2.

    Returns
    -------
    CrossSection
        The cross-section. A circle without given edges ends at the middle of the guide, where the
        other flank begins, and at the guide's equator.

    Raises
    ------
    ShapeError
        If a drawn curve does not have the inclination of the contact anywhere, or is too narrow or
        too wide.
    """
    profile: dict[str, Any] = _parsed(text) if text else {"arc": radius}
    middle, equator = -guide_radius * math.sin(alpha), guide_radius * math.cos(alpha)
    if "arc" in profile:
        shape = with_edges(arcs([profile["arc"]], []), middle, equator)
    elif "parabola" in profile:
        shape = with_edges(parabola(profile["parabola"]), middle, equator)
    elif "arcs" in profile:
        rows = profile["arcs"]
        shape = with_edges(
            arcs([r["radius"] for r in rows], [r["to"] for r in rows[:-1]]), middle, equator
        )
    else:
        shape = _from_points(profile, body, alpha, guide_radius, side)
    edge: dict[str, float] = profile.get("edge", {})
    if "width" in profile:
        reach = (0.5 * profile["width"] - guide_radius * math.sin(alpha)) / math.cos(alpha)
        if reach <= 0.0:
            apart = 2 * guide_radius * math.sin(alpha)
            raise ShapeError(
                f"{body}.width",
                profile["width"],
                f"more than {apart:.6g} mm, the distance of the contacts",
            )
        edge = {"outer": reach}
    shape = with_edges(
        shape, -edge.get("inner", math.inf), edge.get("outer", math.inf), edge.get("chamfer", 0.0)
    )
    if "worn" in profile:
        loss = profile["worn"]
        row = min(side, len(loss["depth"])) - 1
        moved = loss.get("moved", [0.0, 0.0])[row]
        shape = worn(shape, loss["start"], loss["step"], np.array(loss["depth"][row]), moved)
    return shape


def _from_points(
    profile: dict[str, Any], body: str, alpha: float, guide_radius: float, side: int
) -> CrossSection:
    """Return the cross-section of a body in the frame of contact 1 or 2 (`side`) from its
    points.
    """
    points = np.asarray(profile["points"])
    x, z = points[in_order(points)].T
    out = -1.0 if body == "roller_profile" else 1.0
    noise = profile.get("smooth", 0.0)
    if profile["frame"] == "contact":
        wide = x[-1] - x[0]
        if not NARROWEST < wide / guide_radius < WIDEST:
            allowed = (
                f"{NARROWEST * guide_radius:.4g} to {WIDEST * guide_radius:.4g} "
                f"mm{_beside(guide_radius)}"
            )
            raise ShapeError(body, f"points over {wide:.4g} mm", allowed, "Give x and z in mm.")
        return _flat_enough(drawn(x, out * z, noise), body, guide_radius)
    if side == 2 and np.count_nonzero(x <= 0) >= FEWEST:
        x, z = -x[::-1], z[::-1]
    x, z = x[x >= 0], z[x >= 0]
    if x.size < FEWEST:
        remedy = "In frame: section x = 0 is the middle of the guide; see also frame: contact."
        raise ShapeError(
            body,
            f"{x.size} points with x >= 0",
            f"at least {FEWEST} on the side of a contact",
            remedy,
        )
    nominal = guide_radius * math.sin(alpha)
    u, w = _single_valued(*_turned(x, smoothed(x, z, noise)(x) if noise else z, alpha), body)
    apex = _touching_point(u, w, _turned(x, z, alpha), noise, body, alpha)
    # `place` is the distance from the middle of the guide, which compares with that of the nominal
    # contact.
    place = apex * math.cos(alpha) + float(np.interp(apex, u, w)) * math.sin(alpha)
    if not nominal / ASTRAY < place < nominal * ASTRAY:
        given = f"a curve that is inclined by the contact angle {place:.4g} mm from the middle"
        allowed = (
            f"{nominal / ASTRAY:.4g} to {nominal * ASTRAY:.4g} mm: the nominal contact lies "
            f"guide_profile_radius sin(contact_angle) = {nominal:.4g} mm from the middle"
        )
        remedy = (
            "Give x and z in mm, x = 0 in the middle, and a nominal radius near the drawn "
            "one; or frame: contact."
        )
        raise ShapeError(body, given, allowed, remedy)
    return _flat_enough(drawn(u - apex, out * w), body, guide_radius)


def smoothed_otherwise(text: str) -> list[str]:
    """Return a profile of smoothed points with half and with twice its smoothing, in canonical
    JSON.

    The curve follows the noise of its points where it is smoothed by less than this noise. So the
    smaller smoothing is no smaller than the noise that `noise_of` finds; it is left out where
    nothing lies between them.

    Parameters
    ----------
    text : str
        Profile in canonical JSON; "" for the circle.

    Returns
    -------
    list of str
        The profile with more smoothing, and with less where there is a smaller one; [] for a
        profile without smoothing.
    """
    profile = _parsed(text) if text else {}
    if not profile.get("smooth"):
        return []
    points = np.asarray(profile["points"])
    noise = noise_of(*points[in_order(points)].T)
    given = noise if profile["smooth"] == "auto" else profile["smooth"]
    less = max(0.5 * given, min(noise, given))
    others = [2.0 * given, *([less] if less < given else [])]
    return [json.dumps(profile | {"smooth": other}, sort_keys=True) for other in others]


def _turned(x: np.ndarray, z: np.ndarray, alpha: float) -> tuple[np.ndarray, np.ndarray]:
    """Return points of the section along and across the tangent plane at the contact [mm]."""
    return x * math.cos(alpha) - z * math.sin(alpha), x * math.sin(alpha) + z * math.cos(alpha)


def _beside(guide_radius: float) -> str:
    return f", beside a guide_profile_radius of {guide_radius:g} mm"


def _flat_enough(shape: CrossSection, body: str, guide_radius: float) -> CrossSection:
    """Return the shape; refuse it if nearly all of it is too steep for contact, as heights in other
    units are.
    """
    low, high = shape.limits
    if high - low > NARROWEST * guide_radius:
        return shape
    given = f"a curve inclined by more than 25 deg {min(-low, high):.3g} mm beside the contact"
    allowed = (
        f"one that is flatter over {NARROWEST * guide_radius:.3g} mm at "
        f"least{_beside(guide_radius)}"
    )
    raise ShapeError(
        body, given, allowed, "Give x and z in mm. If the points are noisy, give smooth: auto."
    )


def _single_valued(u: np.ndarray, w: np.ndarray, body: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the longest part of the turned curve in which u increases.

    Several steps back are an overhang, which takes no part in the contact. A single one is a jump
    or noise.
    """
    back = np.diff(u) <= 0
    single = back[1:-1] & ~back[:-2] & ~back[2:]
    if single.any():
        place = np.flatnonzero(single)[0] + 1
        given = (
            "a curve that turns back between two points, "
            f"{math.hypot(u[place], w[place]):.4g} mm from the origin"
        )
        allowed = "a curve that does not turn back, seen along the contact normal"
        raise ShapeError(
            body,
            given,
            allowed,
            "Leave out lost points. If the points are noisy, give smooth: auto.",
        )
    breaks = np.flatnonzero(back)
    starts, ends = np.concatenate([[0], breaks + 1]), np.concatenate([breaks + 1, [u.size]])
    k = int(np.argmax(ends - starts))
    return u[starts[k] : ends[k]], w[starts[k] : ends[k]]


def _touching_point(u, w, points, noise, body: str, alpha: float) -> float:
    """Return the u where the curve is parallel to the tangent plane, nearest to the apex of a
    fitted parabola.

    `points` are the turned points before they were smoothed with `noise`, for the message where
    there is none.
    """
    from scipy.optimize import brentq  # heavy, and for drawn profiles only

    if u.size < FEWEST:
        raise _nowhere_parallel(points, body, alpha)
    slope = smoothed(u, w, 0.0).derivative()
    places = np.linspace(u[0], u[-1], 40 * u.size + 1)
    values = slope(places)
    turns = np.flatnonzero(values[:-1] * values[1:] <= 0)
    if turns.size == 0:
        raise _nowhere_parallel(points, body, alpha, (noise, values) if noise else None)
    roots = np.array(
        [
            brentq(slope, places[k], places[k + 1])
            if values[k] * values[k + 1] < 0
            else places[k + (values[k] != 0)]
            for k in turns
        ]
    )
    square, linear, _ = np.polyfit(u - u.mean(), w, 2)
    apex = u.mean() - 0.5 * linear / square if square != 0 else u.mean()
    return float(roots[np.argmin(np.abs(roots - apex))])


def _nowhere_parallel(turned, body: str, alpha: float, smooth: tuple | None = None) -> ShapeError:
    """Return the error for points without a contact, or for smoothing `smooth` = (noise, slopes)
    that removed it.
    """
    u, w = turned
    with np.errstate(divide="ignore"):  # a step along the contact normal
        steps = np.diff(w) / np.diff(u) if u.size > 1 else np.full(1, math.tan(alpha))
    angle = math.degrees(alpha)
    points = angle - np.degrees(np.arctan(steps))
    lean = points if smooth is None else angle - np.degrees(np.arctan(smooth[1]))
    low, high = (round(float(v), 3) + 0.0 for v in (lean.min(), lean.max()))
    wanted = f"one that is somewhere inclined by the contact angle of {angle:.4g} deg"
    if smooth is not None and points.min() <= angle <= points.max():
        allowed = (
            f"less: the smoothed curve is inclined by {low:.4g} to {high:.4g} deg, the "
            f"points reach {angle:.4g} deg"
        )
        remedy = "Give the standard deviation of the noise in mm, for example 0.001, or 'auto'."
        return ShapeError(f"{body}.smooth", smooth[0], allowed, remedy)
    remedy = "Draw more of it, or use frame: contact."
    if points.min() <= -angle <= points.max():
        remedy = (
            "The curve is inclined the other way round: z counts from the guide towards the "
            "roller's axis."
        )
    return ShapeError(body, f"a curve inclined by {low:.4g} to {high:.4g} deg", wanted, remedy)


def gap(
    guide: str,
    roller: str,
    guide_radius: float,
    roller_radius: float,
    alpha: float,
    rolling_radius: float,
    guide_curve_radius: float,
    side: int,
) -> Gap:
    """Return the gap of the undeformed bodies at one contact.

    Parameters
    ----------
    guide, roller : str
        Profiles in canonical JSON; "" for the circle. If one body is a parabola, the circle of the
        other one becomes a parabola as well.
    guide_radius, roller_radius : float
        Profile radii r_C,G and r_C,TR [mm].
    alpha : float
        Contact angle [rad].
    rolling_radius, guide_curve_radius : float
        r_A and r_Curve [mm].
    side : int
        Number of the contact, 1 or 2.

    Returns
    -------
    Gap
        The gap.

    Raises
    ------
    ShapeError
        If the shapes overlap or touch far from the nominal contact.
    """
    if '"parabola"' in guide + roller:
        guide = guide or json.dumps({"parabola": guide_radius})
        roller = roller or json.dumps({"parabola": roller_radius})
    between = Gap(
        cross_section(guide, "guide_profile", guide_radius, alpha, guide_radius, side),
        cross_section(roller, "roller_profile", roller_radius, alpha, guide_radius, side),
        alpha,
        rolling_radius,
        guide_curve_radius,
    )
    less = " Or smooth less: `smooth` is the noise in mm." if '"smooth"' in guide + roller else ""
    if '"worn"' not in guide + roller:  # the contact of worn bodies moves
        _check_touch(between, "roller_profile" if roller else "guide_profile", guide_radius, less)
    return between


def _check_touch(between: Gap, body: str, guide_radius: float, more: str = "") -> None:
    """Refuse bodies that overlap or touch far from the nominal contact; `more` extends the
    remedy.
    """
    x = np.linspace(*between.limits, 801)
    lateral = between.lateral(x)
    first, depth = float(x[np.argmin(lateral)]), float(-lateral.min())
    if depth > INTERLOCK * guide_radius:
        given = f"shapes that overlap by {depth:.3g} mm, {first:.3g} mm outward"
        allowed = (
            "shapes that touch at the nominal contact and overlap by no more than load and "
            "wear can close"
        )
        remedy = (
            "Compare both profiles, and the radius of a profile that is not drawn, beside "
            "that point."
        )
        raise ShapeError(body, given, allowed, remedy + more)
    if depth > FIRST * guide_radius and abs(first) > ASIDE * guide_radius:
        given = (
            f"shapes that touch {first:.3g} mm outward of the nominal contact, {depth:.3g} mm "
            "before they touch there"
        )
        allowed = (
            f"shapes that touch within {ASIDE * guide_radius:.3g} mm of it, because all "
            "lever arms refer to it"
        )
        remedy = (
            "Make the groove wider than the guide there, or correct contact_angle and the "
            "nominal radii."
        )
        raise ShapeError(body, given, allowed, remedy + more)


def touching_place(guide: str, roller: str, guide_radius: float) -> tuple[float, float] | None:
    """Return where a roller and a guide touch as they are drawn with x = 0 in the middle of both.

    Parameters
    ----------
    guide, roller : str
        Profiles in canonical JSON; "" for the circle.
    guide_radius : float
        Nominal r_C,G [mm].

    Returns
    -------
    tuple of float or None
        Distance from the middle [mm], and inclination of the roller's curve there [deg]; None
        unless the roller is drawn by points in frame: section, and the guide so too or as the
        circle.
    """
    shapes = [_parsed(text) if text else {} for text in (guide, roller)]
    if shapes[1].get("frame") != "section" or (shapes[0] and shapes[0].get("frame") != "section"):
        return None
    sides = [_drawn_side(shape) for shape in shapes if shape]
    if any(x.size < FEWEST for x, _ in sides):
        return None
    ends = [float(x[-1]) for x, _ in sides]
    end = min(ends if shapes[0] else [guide_radius, *ends])
    x = np.linspace(0.0, end, 2001)
    curves = [
        smoothed(*side, shape.get("smooth", 0.0))
        for side, shape in zip(sides, filter(None, shapes), strict=True)
    ]
    guide_heights = curves[0](x) if shapes[0] else np.sqrt(guide_radius**2 - x**2)
    place = float(x[np.argmin(curves[-1](x) - guide_heights)])
    return place, -math.degrees(math.atan(float(curves[-1](place, 1))))


def _drawn_side(profile: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of a section with x >= 0 in order, or those of its mirror image."""
    points = np.asarray(profile["points"])
    x, z = points[in_order(points)].T
    if np.count_nonzero(x >= 0) < FEWEST:
        x, z = -x[::-1], z[::-1]
    return x[x >= 0], z[x >= 0]


def has_details(text: str) -> bool:
    """Return True if a profile in canonical JSON is more than one arc or parabola without edges."""
    profile = _parsed(text) if text else {}
    return bool(profile.keys() - {"arc", "parabola", "worn"})


def treats_sides_alike(text: str) -> bool:
    """Return True if both contacts have the same profile, mirrored.

    Parameters
    ----------
    text : str
        Profile in canonical JSON; "" for the circle.
    """
    profile = _parsed(text) if text else {}
    if len(profile.get("worn", {}).get("depth", ())) > 1:
        return False
    if profile.get("frame") != "section":
        return True
    points = np.asarray(profile["points"])
    return bool(np.count_nonzero(points[in_order(points), 0] <= 0) < FEWEST)


def with_wear(
    guide: str, roller: str, radii: tuple[float, float], worn: list[dict[str, Any]]
) -> tuple[str, str]:
    """Return the profiles of guide and roller with other entries `worn`, in canonical JSON.

    Parameters
    ----------
    guide, roller : str
        Profiles in canonical JSON; "" for the circle. An entry `worn` in them is replaced.
    radii : tuple of float
        Profile radii r_C,G and r_C,TR [mm].
    worn : list of dict
        Entries `worn` of guide and roller, see `profiles.canonical`.
    """
    form = "parabola" if '"parabola"' in guide + roller else "arc"  # `gap` chooses so, too
    own = [
        dict(_parsed(text)) if text else {form: radius}
        for text, radius in zip((guide, roller), radii, strict=True)
    ]
    one, two = (
        json.dumps(profile | {"worn": loss}, sort_keys=True)
        for profile, loss in zip(own, worn, strict=True)
    )
    return one, two


def inclined(guide: str) -> tuple[float, float]:
    """Return the angles by which wear has turned the contact normals outward, from the guide's
    profile [rad].
    """
    turned = _parsed(guide).get("worn", {}).get("inclined", [0.0]) if guide else [0.0]
    return turned[0], turned[-1]
