"""Ask about values that are allowed but unusual: another unit, sign or reciprocal, points that are
not smoothed.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.contact.drawn_profiles import touching_place
from trackroller.contact.measured_points import (
    MISLEADING,
    TOLD,
    PointFaults,
    examined,
    gap,
    in_order,
    waves,
)
from trackroller.materials.properties import PROPERTIES
from trackroller.numerics.units import in_unit
from trackroller.parameters import PARAMETERS
from trackroller.parameters.example import EXAMPLE
from trackroller.roller.case import Case

if TYPE_CHECKING:
    from trackroller.materials import Material, MaterialDatabase

# ASSUME: sizes between which the values of rollers lie that are built; the sign does not count.
USUAL: dict[str, tuple[float, float]] = {
    "axis_distance": (3.0, 2000.0),
    "guide_profile_radius": (0.3, 500.0),
    "roller_profile_radius": (0.3, 1000.0),
    "guide_curve_radius": (10.0, 1e6),
    "contact_angle": (5.0, 85.0),
    "radial_force": (1.0, 1e6),
    "axial_force": (0.1, 1e6),
    "motor_force": (0.1, 1e6),
    "velocity": (0.3, 2000.0),
    "friction_coefficient": (0.0, 1.0),
    "ambient_temperature": (0.0, 200.0),
    "cooled_area": (100.0, 1e7),
    "permissible_temperature": (0.0, 250.0),
    "permissible_wear_depth": (1e-4, 10.0),
}
# small values are usual beside larger ones: only the largest counts
FROM_ZERO = ("axial_force", "motor_force")
UNSURE = 0.1  # error of the pressure, as a share, from which on smoothed points are asked about
# ASSUME: magnesium to tungsten, and unfilled polyethylene to polymers with carbon fibres.
METAL = {
    "youngs_modulus": (4e4, 4.5e5),
    "tensile_strength": (50.0, 4000.0),
    "density": (1500.0, 20000.0),
}
EXPONENT = (1.0, 100.0)  # of an S-N curve; welds have 3
POLYMER = {
    "youngs_modulus": (200.0, 4e4),
    "tensile_strength": (10.0, 500.0),
    "density": (850.0, 2300.0),
}
OF_FAMILY = {"metal": METAL, "PA6": POLYMER, "POM": POLYMER}
OTHER_UNITS = {
    "MPa": ("GPa", "Pa", "kPa"),
    "mm": ("m", "cm", "um"),
    "mm2": ("m2", "cm2"),
    "degC": ("K",),
    "N": ("kN", "mN"),
    "deg": ("rad",),
    "m/min": ("m/s", "mm/s", "km/h"),
    "kg/m3": ("g/cm3",),
    "-": ("%",),
    "km": ("m", "mm"),
}
# entries of mappings that the radial force of a roller usually does not exceed, in N; the others in
# N mm times 1 mm
RATINGS = {
    "bearing": {"dynamic_rating": "N", "static_rating": "N", "permissible_moment": "N mm"},
    "catalogue": {"radial_force": "N", "axial_force": "N", "moment": "N mm"},
}
# ASSUME: kilometres at a load factor of 1, which catalogues state as 40 to 1000
BASIC_LIFE = (10.0, 2e4)
LARGER_UNITS = {"N": "kN", "N mm": "Nm"}
# ASSUME: sizes [mm] and strengths [MPa] between which those of studs and axles lie
STUD = {
    "diameter": (2.0, 300.0),
    "length": (1.0, 1000.0),
    "yield_strength": (50.0, 2500.0),
    "tensile_strength": (50.0, 3000.0),
}
SHORT = 0.5  # ASSUME: diameters of free length below which a stud is no beam
# share of the radial force below which a rating is asked about; 1 for the others
SMALL = {"axial_force": 0.02}
# ASSUME: width of measured points over the radius of the guide; inches as mm are below, micrometres
# above.
MEASURED_WIDTH = 0.05, 20.0
TURNED = 5.0  # ASSUME: deg; contact angles of a drawn section that differ by less are drawn alike
LIKE_A_GROOVE = 2.0  # ASSUME: the radius of a groove is at most this times that of the guide


def doubts(values: Mapping[str, Any], materials: Iterable[Material] = ()) -> list[str]:
    """Return a sentence for each value that is unusual, with the unit that may have been meant.

    Parameters
    ----------
    values : mapping
        Numbers of cases by parameter, each a number or an array, in the units of `PARAMETERS`;
        `guide_profile` and `roller_profile` as mappings, JSON texts or arrays of such texts.
    materials : iterable of Material
        Materials of the cases; a family of `OF_FAMILY` has usual values.

    Returns
    -------
    list of str
        Sentences; empty if nothing is unusual.
    """
    sentences = []
    for name, usual in USUAL.items():
        # a friction coefficient may be a word
        given = np.ravel(values.get(name, math.nan)).tolist()
        numbers = [
            float(v) for v in given if isinstance(v, (int, float)) and math.isfinite(v) and v != 0.0
        ]
        ends = set()
        if numbers:
            ends.add(max(numbers, key=abs))
        if numbers and name not in FROM_ZERO:
            ends.add(min(numbers, key=abs))
        sentences += [
            text
            for number in ends
            if (text := sentence_of_unusual(name, number, PARAMETERS[name].unit, usual, ""))
        ]
    for material in {m.name: m for m in materials}.values():
        for name, usual in OF_FAMILY.get(material.family, {}).items():
            number = getattr(material, name)
            kind = f" for the family {material.family} (material '{material.name}')"
            if number is not None:
                sentences += [sentence_of_unusual(name, number, PROPERTIES[name].unit, usual, kind)]
        sentences += [_exponent(material, name) for name in ("woehler_exponent", "second_exponent")]
    sentences += ratings(values)
    sentences += _studs(values)
    guide_radii = _numbers(values.get("guide_profile_radius", EXAMPLE["guide_profile_radius"]))
    for name in ("guide_profile", "roller_profile"):
        radius = next((r for r in guide_radii if r > 0.0), math.nan)
        sentences += [
            text
            for profile in _mappings(values.get(name))
            for text in _of_points(name, profile, radius)
        ]
    sentences += _axles_in_the_rail(values)
    sentences += _convex_rollers(values)
    sentences += _touching_elsewhere(values)
    return [text for text in sentences if text]


def doubts_of_case(case: Case, database: MaterialDatabase) -> list[str]:
    """Return the doubts about a case, see `doubts`."""
    return doubts(
        case.as_dict(), map(database.material, (case.roller_material, case.guide_material))
    )


def sentence_of_unusual(
    name: str, number: float, unit: str, usual: tuple[float, float], kind: str
) -> str:
    """Return the sentence about a number outside its usual sizes, '' for a usual one.

    Parameters
    ----------
    name, unit : str
        Field and unit of the number.
    number : float
        The number; its sign does not count.
    usual : tuple of float
        Smallest and largest usual size.
    kind : str
        For what they are usual, such as ' for the family metal'.
    """
    low, high = usual
    size = abs(number)
    shown = "" if unit == "-" else f" {unit}"
    if low <= size <= high:
        return ""
    if size < low:
        off = f"{low / size:.3g} times below"
    else:
        off = f"{size / high:.3g} times above"
    meant = [(in_unit(number, other, unit, name), other) for other in OTHER_UNITS.get(unit, ())]
    likely = [
        f"write '{number:g} {other}' or {value:g}"
        for value, other in meant
        if low <= abs(value) <= high
    ]
    ask = ""
    if likely:
        ask = f"; if {likely[0].split(chr(39))[1]} is meant, {likely[0]}"
    return f"{name} = {number:g}{shown} is {off} the usual {low:g} to {high:g}{shown}{kind}{ask}."


def _exponent(material: Material, name: str) -> str:
    """Return the sentence about an exponent of the S-N curve that may be Basquin's b = 1/k, '' for
    a usual one.
    """
    k = getattr(material, name)
    if not isinstance(k, (int, float)) or EXPONENT[0] <= k <= EXPONENT[1] or math.isinf(k):
        return ""
    if k < EXPONENT[0]:
        off = f"below the usual {EXPONENT[0]:g}"
    else:
        off = f"above the usual {EXPONENT[1]:g}"
    ask = ""
    if k < EXPONENT[0]:
        ask = f"; if b is meant, k = 1/b: write {1.0 / k:.3g}"
    return f"{name} = {k:.4g} of the material '{material.name}' is {off}{ask}."


def ratings(values: Mapping[str, Any]) -> list[str]:
    """Return a sentence for each rating of a bearing or catalogue that is smaller than the smallest
    radial force, and for an unusual basic life of a catalogue.
    """
    loads = [
        abs(v)
        for v in np.ravel(values.get("radial_force", math.nan)).tolist()
        if isinstance(v, (int, float))
    ]
    load = min((v for v in loads if v > 0.0 and math.isfinite(v)), default=0.0)
    given = [
        ("permissible_radial_force", v, "N", 1.0)
        for v in np.ravel(values.get("permissible_radial_force", 0.0))
    ]
    for field, units in RATINGS.items():
        for mapping in _mappings(values.get(field)):
            given += [
                (f"{field}.{n}", mapping.get(n), unit, SMALL.get(n, 1.0))
                for n, unit in units.items()
            ]
    out = []
    for name, number, unit, share in given:
        if isinstance(number, (int, float)) and 0.0 < number < share * load:
            larger = LARGER_UNITS[unit]
            out.append(
                f"{name} = {number:g} {unit} is small beside the radial force of {load:g} N; if "
                f"{number:g} {larger} is "
                f"meant, write '{number:g} {larger}' or {1e3 * number:g}."
            )
    for mapping in _mappings(values.get("catalogue")):
        life = mapping.get("basic_life")
        if isinstance(life, (int, float)):
            out.append(sentence_of_unusual("catalogue.basic_life", life, "km", BASIC_LIFE, ""))
    return [text for text in dict.fromkeys(out) if text]


def _studs(values: Mapping[str, Any]) -> list[str]:
    """Return sentences about studs of an unusual size or strength, and about short ones."""
    sentences = []
    for stud in _mappings(values.get("stud")):
        for name, usual in STUD.items():
            if name in stud:
                unit = "MPa" if "strength" in name else "mm"
                sentences.append(sentence_of_unusual(f"stud.{name}", stud[name], unit, usual, ""))
        if stud["length"] < SHORT * stud["diameter"]:
            sentences.append(
                f"stud.length = {stud['length']:g} mm is less than half the diameter; the stress "
                "of so short a stud is not that of a beam."
            )
    return sentences


def _mappings(value: Any) -> list[dict[str, Any]]:
    """Return the distinct mappings of a value of `doubts`, such as cross-sections."""
    if isinstance(value, Mapping):
        return [dict(value)]
    return [
        json.loads(text)
        for text in dict.fromkeys(np.ravel(value).tolist())
        if isinstance(text, str) and text
    ]


def _of_points(name: str, profile: Mapping[str, Any], guide_radius: float) -> list[str]:
    """Return sentences about points of an unlikely size, or that were put in order, scatter or
    leave the curve.
    """
    if "points" not in profile:
        return []
    points = np.asarray(profile["points"], dtype=float)
    order = in_order(points)
    faults = examined(*points[order].T)
    steps = np.sign(np.diff(points[:, 0]))
    sentences = []
    width = float(np.ptp(points[:, 0]))
    low, high = (size * guide_radius for size in MEASURED_WIDTH)
    if width < low or width > high:
        sentences.append(
            f"{name}: its points are {width:.3g} mm wide, and the radius of the guide is "
            f"{guide_radius:.3g} mm; if "
            "they are not in mm, give their unit: x [um], z [um] at the head of a file."
        )
    if len(order) < len(points):
        sentences.append(
            f"{name}: {len(points) - len(order)} of its {len(points)} points stand twice; each "
            "counts once."
        )
    if np.all(steps <= 0) and np.any(steps < 0):
        sentences.append(f"{name}: its points run from large to small x; they were sorted by x.")
    elif np.any(steps < 0):
        sentences.append(f"{name}: its points do not run in one direction; they were sorted by x.")
    sentences += [f"{name}: {text}" for text in _gaps_and_waves(points[order], faults)]
    for run in faults.at_ends:
        ends = " to ".join(
            f"({px:.4g}, {pz:.4g})" for px, pz in points[order][[run.first, run.last]]
        )
        sentences.append(
            f"{name}: its outermost points {ends} lie {1e3 * run.off:.2g} µm off the curve of the "
            "points beside them; "
            "if they are a speck, leave them out."
        )
    if profile.get("smooth"):
        return sentences + _error_of_smoothing(name, faults)
    return sentences + _scatter_as_shape(name, faults, "smooth" in profile)


def _error_of_smoothing(name: str, faults: PointFaults) -> list[str]:
    """Return a sentence about points that scatter too much to be smoothed."""
    if faults.error_if_smoothed < UNSURE:
        return []
    return [
        f"{name}: its points scatter by {1e3 * faults.scatter:.2g} µm at distances of "
        f"{faults.spacing:.2g} mm; "
        f"after smoothing, the pressure is wrong by about {100 * faults.error_if_smoothed:.0f} "
        "%. Measure with "
        "less noise, or describe the shape by its radii (arc, arcs)."
    ]


def _scatter_as_shape(name: str, faults: PointFaults, meant: bool) -> list[str]:
    """Return sentences about scatter that counts as shape; `meant` says that the profile has
    `smooth: 0`.
    """
    sentences = []
    if faults.runs or faults.jumps:
        sentences.append(
            f"{name}: points lie off their neighbours, and smooth: 0 takes them as shape."
        )
    least = TOLD
    remedy = "add smooth: auto, or smooth: 0 if it is meant"
    if meant:
        least = MISLEADING
        remedy = "add smooth: auto"
    if faults.roughness >= least:
        noise = f"{1e3 * faults.scatter:.2g}"
        sentences.append(
            f"{name}: its points scatter by {noise} µm (noise or rounding) and are not smoothed, "
            "so that the scatter "
            f"counts as shape and can raise the pressure by {faults.pressure_rise}; {remedy}."
        )
    return sentences


def _gaps_and_waves(points: np.ndarray, faults: PointFaults) -> list[str]:
    """Return sentences about a length without points, and about waves that count as shape."""
    sentences = []
    x, z = points.T
    place = gap(x)
    if place is not None:
        sentences.append(
            f"no points lie between x = {x[place]:.4g} and {x[place + 1]:.4g} mm, and their usual "
            "distance is "
            f"{faults.spacing:.2g} mm; the curve there is only guessed. Measure this part if "
            "the bodies touch there."
        )
    wave = waves(x, z, faults.scatter)
    if wave is not None and not faults.runs:
        height = f"{1e3 * wave.height:.2g}"
        sentences.append(
            f"its curvature goes to and fro {wave.turns} times, as waves of ± {height} µm and "
            f"{wave.length:.2g} mm "
            "length do; they count as shape. If they come from the measurement, describe the "
            "shape by its radii."
        )
    return sentences


def _axles_in_the_rail(values: Mapping[str, Any]) -> list[str]:
    """Return a sentence about the first roller whose axis lies inside the contour of the guide."""
    axes = _numbers(values.get("axis_distance", EXAMPLE["axis_distance"]))
    radii = _numbers(values.get("guide_profile_radius", EXAMPLE["guide_profile_radius"]))
    same = len(axes) == len(radii)  # a study has a row for each case
    if same:
        pairs = list(zip(axes, radii, strict=True))
    else:
        pairs = [(axis, radius) for axis in axes for radius in radii]
    inside = [(axis, radius) for axis, radius in pairs if axis <= radius]
    return [
        f"axis_distance = {axis:.4g} mm does not exceed guide_profile_radius = {radius:.4g} mm: "
        "the axle lies inside "
        "the rail. Take a larger axis_distance."
        for axis, radius in inside[:1]
    ]


def _touching_elsewhere(values: Mapping[str, Any]) -> list[str]:
    """Return sentences about drawn grooves that touch the guide of the first case at another angle
    than its own.
    """
    radii = _numbers(values.get("guide_profile_radius", EXAMPLE["guide_profile_radius"]))
    angles = _numbers(values.get("contact_angle", EXAMPLE["contact_angle"]))
    guides = _mappings(values.get("guide_profile")) or [{}]
    if not (radii and angles) or not (radii[0] > 0.0 and angles[0] > 0.0):
        return []
    sentences = []
    for profile in _mappings(values.get("roller_profile")):
        if "points" not in profile:
            continue
        guide = ""
        if guides[0]:
            guide = json.dumps(guides[0])
        touching = touching_place(guide, json.dumps({"frame": "section", **profile}), radii[0])
        if touching is None or abs(touching[1] - angles[0]) <= TURNED:
            continue
        place, angle = touching
        if place == 0.0:
            where = "in the middle"
        else:
            where = f"{place:.3g} mm from the middle, at {angle:.3g} deg"
        sentences.append(
            f"roller_profile: as drawn, groove and guide touch {where}, and not at the "
            "contact_angle of "
            f"{angles[0]:g} deg, where they are solved. A groove with two contacts has two arcs: "
            "draw it so, correct "
            "contact_angle, or use frame: contact."
        )
    return sentences[:1]


def _convex_rollers(values: Mapping[str, Any]) -> list[str]:
    """Return sentences about convex rollers with the radius of a groove."""
    guides = _numbers(values.get("guide_profile_radius", EXAMPLE["guide_profile_radius"]))
    rollers = _numbers(values.get("roller_profile_radius", math.nan))
    if not guides:
        return []
    same = len(guides) == len(rollers)  # a study has a row for each case
    pairs = [(guides[0], roller) for roller in rollers]
    if same:
        pairs = list(zip(guides, rollers, strict=True))
    like = {other: other / one for one, other in pairs if one < other <= LIKE_A_GROOVE * one}
    radii = [
        ("roller_profile_radius", radius, ratio, f"write -{radius:g}")
        for radius, ratio in like.items()
    ]
    for profile in _mappings(values.get("roller_profile")):
        radius, remedy = _convex_radius(profile)
        if guides[0] < radius <= LIKE_A_GROOVE * guides[0]:
            radii.append(("roller_profile", radius, radius / guides[0], remedy))
    return [
        f"{name}: a radius of {radius:.4g} mm is that of a convex roller, and {ratio:.3g} times "
        "that of the guide, as "
        f"grooves have; if a groove is meant, {remedy}."
        for name, radius, ratio, remedy in radii[:1]
    ]


def _numbers(given: Any) -> list[float]:
    """Return the finite numbers of a value of `doubts`; other values become NaN."""
    numbers = []
    for value in np.ravel(given).tolist():
        if isinstance(value, (int, float)):
            numbers.append(float(value))
        else:
            numbers.append(math.nan)
    return numbers


def _convex_radius(profile: Mapping[str, Any]) -> tuple[float, str]:
    """Return the radius of a roller at its nominal contact, > 0 convex [mm], and how a groove is
    written.
    """
    for form in ("arc", "parabola"):
        if form in profile:
            return profile[form], f"write {form}: -{profile[form]:g}"
    if "arcs" in profile:
        here = next(row for row in profile["arcs"] if row.get("to", math.inf) > 0.0)
        return here["radius"], f"write radius: -{here['radius']:g}"
    # in frame: section a curve that bends the wrong way has no contact
    if profile.get("frame") != "contact":
        return math.nan, ""
    x, z = np.asarray(profile["points"], dtype=float).T
    square = np.polyfit(x, z, 2)[0]
    return (
        0.5 / square if square > 0.0 else math.nan
    ), "change the sign of z, which counts towards the roller's axis"
