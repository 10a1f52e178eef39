"""Ask about values that are allowed but unusual: a wrong unit, a reciprocal, measured points that are not smoothed."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.contact.cross_sections import noise_of
from trackroller.materials.properties import PROPERTIES
from trackroller.numerics.units import in_unit
from trackroller.parameters import PARAMETERS
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
    "permissible_wear_depth": (1e-4, 10.0),
}
FROM_ZERO = ("axial_force", "motor_force")  # small values are usual beside larger ones: only the largest counts
# ASSUME: magnesium to tungsten, and unfilled polyethylene to polymers with carbon fibres.
METAL = {"youngs_modulus": (4e4, 4.5e5), "tensile_strength": (50.0, 4000.0), "density": (1500.0, 20000.0)}
EXPONENT = (1.0, 100.0)  # of an S-N curve; welds have 3
POLYMER = {"youngs_modulus": (200.0, 4e4), "tensile_strength": (10.0, 500.0), "density": (850.0, 2300.0)}
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
}
# entries of mappings that the radial force of a roller usually does not exceed, in N; the others in N mm times 1 mm
RATINGS = {
    "bearing": {"dynamic_rating": "N", "static_rating": "N", "permissible_moment": "N mm"},
    "catalogue": {"radial": "N", "axial": "N", "moment": "N mm"},
}
LARGER_UNITS = {"N": "kN", "N mm": "Nm"}
SMALL = {"axial": 0.02}  # share of the radial force below which a rating is asked about; 1 for the others
ROUGH = 0.05  # scatter of the curvature of measured points over that of an arc as wide as the points


def doubts(values: Mapping[str, Any], materials: Iterable[Material] = ()) -> list[str]:
    """Return a sentence for each value that is unusual, with the unit that may have been meant.

    Parameters
    ----------
    values : mapping
        Numbers of cases by parameter, each a number or an array, in the units of `PARAMETERS`; `guide_profile` and
        `roller_profile` as mappings, JSON texts or arrays of such texts.
    materials : iterable of Material
        Materials of the cases; a family of `OF_FAMILY` has usual values.

    Returns
    -------
    list of str
        Sentences; empty if nothing is unusual.
    """
    sentences = []
    for name, usual in USUAL.items():
        given = np.ravel(values.get(name, math.nan)).tolist()  # a friction coefficient may be a word
        numbers = [float(v) for v in given if isinstance(v, (int, float)) and math.isfinite(v) and v != 0.0]
        places = (max, *(() if name in FROM_ZERO else (min,)))
        ends = {place(numbers, key=abs) for place in places} if numbers else ()
        sentences += [text for number in ends if (text := _unusual(name, number, PARAMETERS[name].unit, usual, ""))]
    for material in {m.name: m for m in materials}.values():
        for name, usual in OF_FAMILY.get(material.family, {}).items():
            number = getattr(material, name)
            kind = f" for the family {material.family} (material '{material.name}')"
            sentences += [_unusual(name, number, PROPERTIES[name].unit, usual, kind)] if number is not None else []
        sentences.append(_exponent(material))
    sentences += _ratings(values)
    for name in ("guide_profile", "roller_profile"):
        sentences += [_rough(name, profile) for profile in _mappings(values.get(name))]
    return [text for text in sentences if text]


def doubts_of_case(case: Case, database: MaterialDatabase) -> list[str]:
    """Return the doubts about a case, see `doubts`."""
    return doubts(case.as_dict(), map(database.material, (case.roller_material, case.guide_material)))


def _unusual(name: str, number: float, unit: str, usual: tuple[float, float], kind: str) -> str:
    """Return the sentence about an unusual number, '' for a usual one."""
    low, high = usual
    size, shown = abs(number), "" if unit == "-" else f" {unit}"
    if low <= size <= high:
        return ""
    off = f"{low / size:.3g} times below" if size < low else f"{size / high:.3g} times above"
    meant = [(in_unit(number, other, unit, name), other) for other in OTHER_UNITS.get(unit, ())]
    likely = [f"write '{number:g} {other}' or {value:g}" for value, other in meant if low <= abs(value) <= high]
    ask = f"; if {likely[0].split(chr(39))[1]} is meant, {likely[0]}" if likely else ""
    return f"{name} = {number:g}{shown} is {off} the usual {low:g} to {high:g}{shown}{kind}{ask}."


def _exponent(material: Material) -> str:
    """Return the sentence about an exponent of the S-N curve that may be Basquin's b = 1/k, '' for a usual one."""
    k = material.woehler_exponent
    if EXPONENT[0] <= k <= EXPONENT[1]:
        return ""
    off = f"below the usual {EXPONENT[0]:g}" if k < EXPONENT[0] else f"above the usual {EXPONENT[1]:g}"
    ask = f"; if b is meant, k = 1/b: write {1.0 / k:.3g}" if k < EXPONENT[0] else ""
    return f"woehler_exponent = {k:.4g} of the material '{material.name}' is {off}{ask}."


def _ratings(values: Mapping[str, Any]) -> list[str]:
    """Return a sentence for each rating of a bearing or catalogue that is smaller than the smallest radial force."""
    loads = [abs(v) for v in np.ravel(values.get("radial_force", math.nan)).tolist() if isinstance(v, (int, float))]
    load = min((v for v in loads if v > 0.0 and math.isfinite(v)), default=0.0)
    given = [("permissible_radial_force", v, "N", 1.0) for v in np.ravel(values.get("permissible_radial_force", 0.0))]
    for field, units in RATINGS.items():
        for mapping in _mappings(values.get(field)):
            given += [(f"{field}.{n}", mapping.get(n), unit, SMALL.get(n, 1.0)) for n, unit in units.items()]
    out = []
    for name, number, unit, share in given:
        if isinstance(number, (int, float)) and 0.0 < number < share * load:
            larger = LARGER_UNITS[unit]
            out.append(
                f"{name} = {number:g} {unit} is small beside the radial force of {load:g} N; if {number:g} {larger} is "
                f"meant, write '{number:g} {larger}' or {1e3 * number:g}."
            )
    return list(dict.fromkeys(out))


def _mappings(value: Any) -> list[dict[str, Any]]:
    """Return the distinct mappings of a value of `doubts`, such as cross-sections."""
    if isinstance(value, Mapping):
        return [dict(value)]
    return [json.loads(text) for text in dict.fromkeys(np.ravel(value).tolist()) if isinstance(text, str) and text]


def _rough(name: str, profile: Mapping[str, Any]) -> str:
    """Return the sentence about measured points whose scatter counts as shape, '' if there is none."""
    if "points" not in profile or profile.get("smooth"):
        return ""
    x, z = np.asarray(profile["points"], dtype=float).T
    noise = noise_of(x, z)
    scatter = math.sqrt(6.0) * noise / float(np.median(np.diff(x))) ** 2  # of the second difference
    signs = np.sign(np.diff(z, 4))
    random = np.mean(signs[1:] != signs[:-1]) > 0.5 if signs.size > 1 else False  # 0.8 of noise, 0 of a coarse arc
    if scatter < ROUGH / (0.5 * float(x[-1] - x[0])) or not random:
        return ""
    return (
        f"{name}: its points scatter by {1e3 * noise:.2g} µm and are not smoothed, so that the scatter counts as shape "
        f"and pressures are far too high; add smooth: auto, or the measured noise, smooth: {1e3 * noise:.1g} um."
    )
