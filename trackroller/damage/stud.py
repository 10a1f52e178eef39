"""The stud or axle that carries the roller: bending and shear at its clamped end, static and with
endurance, and its deflection.

The stud is a round cantilever of the diameter d. Radial force F_rad and drive force F_Motor act at
the free length L from the clamped end, the axial force along the stud, and the moments M_yR and
M_zR of the contacts bend it along its whole length. With W = pi d^3/32 and A = pi d^2/4,

    M = hypot(|F_rad| L + |M_yR|, |F_Motor| L + |M_zR|) + |F_ax| e
    T = F e,    F = hypot(F_rad, F_Motor)
    at the outer fibre   sigma = M/W + |F_ax|/A,    tau = T/(2 W)
    at the neutral axis  sigma = |F_ax|/A,          tau = 4 F/(3 A) + T/(2 W)

(strength of materials, e.g. Timoshenko, Strength of Materials I, 1940: shear of a circular section
4/3 of its mean). The larger von Mises stress counts. The eccentricity e of a stud with an eccentric
collar is the distance of the roller's axis from that of the clamped shank.

ASSUME: the side of the stud is not known, so that the moments of the contacts add to those of the
forces; an eccentric collar stands in its worst position.
ASSUME: the clamping is rigid, and the preload of the bolt does not count.
ASSUME: all forces of the stud change together between the force and `load_ratio` times it; the
mean stress counts by Goodman, sigma_a/(1 - sigma_m/R_m), and a notch multiplies the amplitude.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from trackroller.damage.bearing import BearingLoads
from trackroller.damage.limit import Limit, LimitUse, SolvedRollers, Values, optional, variables
from trackroller.damage.mapping import MappingField
from trackroller.damage.sn_curve import SNCurve, typical_scatter
from trackroller.errors import InputError
from trackroller.numerics.variable import LIFE

SHEAR_FORM = 10.0 / 9.0  # of the shear energy of a circular section
MATERIAL = "material"  # key that names a material of the database
# keys that a named material gives where the user does not, by their names in the database
OF_MATERIAL = (
    "youngs_modulus",
    "poisson_ratio",
    "tensile_strength",
    "yield_strength",
    "fatigue_limit",
    "scatter_in_cycles",
    "scatter_in_stress",
    "cycles_at_tensile_strength",
    "cycles_at_fatigue_limit",
)
SCATTER = ("scatter_in_cycles", "scatter_in_stress")
LINE = ("cycles_at_tensile_strength", "cycles_at_fatigue_limit")
RISING = (("yield_strength", "tensile_strength"), ("fatigue_limit", "tensile_strength"), LINE)


class RootLoads(NamedTuple):
    """Loads at the clamped end: bending moment [N mm], torque [N mm], shear and axial force [N],
    (n,).
    """

    bending: np.ndarray
    torque: np.ndarray
    shear: np.ndarray
    axial: np.ndarray


def root_loads(loads: BearingLoads, length: np.ndarray, eccentricity: np.ndarray) -> RootLoads:
    """Return the loads at the clamped end of studs.

    Parameters
    ----------
    loads : BearingLoads
        Loads on n bearings.
    length : numpy.ndarray
        Free length L from the clamped end to the middle of the roller, (n,) [mm].
    eccentricity : numpy.ndarray
        Distance e of the roller's axis from that of the clamped shank, (n,) [mm].
    """
    pressing = np.abs(loads.pressing) * length + np.abs(loads.tilting)
    driving = np.abs(loads.driving) * length + np.abs(loads.yawing)
    axial = np.abs(loads.axial)
    bending = np.hypot(pressing, driving) + axial * eccentricity
    return RootLoads(bending, loads.radial * eccentricity, loads.radial, axial)


def root_stress(loads: RootLoads, diameter: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the von Mises stress at the outer fibre and at the neutral axis of a round section.

    Parameters
    ----------
    loads : RootLoads
        Loads of n sections.
    diameter : numpy.ndarray
        Diameter d, (n,) [mm].

    Returns
    -------
    tuple of numpy.ndarray
        Both stresses, (n,) [MPa].
    """
    area = np.pi * diameter**2 / 4.0
    modulus = np.pi * diameter**3 / 32.0
    along = loads.axial / area
    twist = loads.torque / (2.0 * modulus)
    outer = loads.bending / modulus + along
    middle = 4.0 * loads.shear / (3.0 * area) + twist
    return np.sqrt(outer**2 + 3.0 * twist**2), np.sqrt(along**2 + 3.0 * middle**2)


def deflection(
    force: np.ndarray,
    moment: np.ndarray,
    length: np.ndarray,
    diameter: np.ndarray,
    youngs_modulus: np.ndarray,
    poisson_ratio: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return deflection and slope at the end of a round cantilever by a force and a moment there.

    Parameters
    ----------
    force, moment : numpy.ndarray
        Force [N] and moment [N mm] at the free end, in one plane, (n,).
    length, diameter : numpy.ndarray
        L and d, (n,) [mm].
    youngs_modulus, poisson_ratio : numpy.ndarray
        E [MPa] and nu [1], (n,).

    Returns
    -------
    tuple of numpy.ndarray
        w = F L^3/(3 E I) + M L^2/(2 E I) + 10/9 F L/(G A) [mm], and
        w' = F L^2/(2 E I) + M L/(E I) [rad], (n,).
    """
    stiffness = youngs_modulus * np.pi * diameter**4 / 64.0
    area = np.pi * diameter**2 / 4.0
    shear_modulus = youngs_modulus / (2.0 * (1.0 + poisson_ratio))
    by_bending = force * length**3 / (3.0 * stiffness) + moment * length**2 / (2.0 * stiffness)
    by_shear = SHEAR_FORM * force * length / (shear_modulus * area)
    slope = force * length**2 / (2.0 * stiffness) + moment * length / stiffness
    return by_bending + by_shear, slope


def reversed_amplitude(
    largest: np.ndarray, load_ratio: np.ndarray, tensile_strength: np.ndarray
) -> np.ndarray:
    """Return the fully reversed amplitude that harms as much as a stress between `load_ratio` times
    its largest value and this value.

    Parameters
    ----------
    largest : numpy.ndarray
        Largest stress of a cycle, (n,) [MPa].
    load_ratio : numpy.ndarray
        Smallest over largest stress R, from -1 to 1, (n,) [1].
    tensile_strength : numpy.ndarray
        R_m, (n,) [MPa]; it does not count at R = -1.

    Returns
    -------
    numpy.ndarray
        sigma_a/(1 - sigma_m/R_m), (n,) [MPa]; inf where the mean stress reaches R_m.

    References
    ----------
    Goodman, Mechanics Applied to Engineering, Longmans, 1899.
    """
    amplitude = largest * (1.0 - load_ratio) / 2.0
    mean = largest * (1.0 + load_ratio) / 2.0
    share = np.where(mean > 0.0, mean / tensile_strength, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        amplitude = np.where(share < 1.0, amplitude / (1.0 - share), np.inf)
    return np.asarray(np.where(np.isnan(share), np.nan, amplitude))


def evaluate(solved: SolvedRollers) -> Values:
    """Return stress, utilisations, life and deflection of the studs, (n,)."""
    own = FIELD.columns(solved.cases[FIELD.name])
    loads = BearingLoads.of(solved)
    eccentricity = np.nan_to_num(own["eccentricity"], nan=0.0)
    root = root_loads(loads, own["length"], eccentricity)
    outer, middle = root_stress(root, own["diameter"])
    stress = np.maximum(outer, middle)
    amplitude = _amplitude(outer, own)
    size = own["length"], own["diameter"], own["youngs_modulus"], own["poisson_ratio"]
    pressed = deflection(np.abs(loads.pressing), np.abs(loads.tilting), *size)
    driven = deflection(np.abs(loads.driving), np.abs(loads.yawing), *size)
    return {
        "stud_stress": stress,
        "stud_static_utilisation": stress / own["yield_strength"],
        "stud_endurance_utilisation": amplitude / own["fatigue_limit"],
        "stud_life_hours": _life(amplitude, own, str(solved.options["life_rule"]))[0],
        "stud_deflection": np.hypot(pressed[0], driven[0]),
        "stud_slope": np.degrees(np.hypot(pressed[1], driven[1])),
    }


def _amplitude(outer: np.ndarray, own: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the fully reversed amplitude of the stress at the outer fibre, with the notch, (n,)
    [MPa].
    """
    reversed_one = reversed_amplitude(outer, own["load_ratio"], own["tensile_strength"])
    return np.asarray(own["notch_factor"] * reversed_one)


def _life(
    amplitude: np.ndarray,
    own: Mapping[str, np.ndarray],
    rule: str,
    probability: float = 0.5,
    place: np.ndarray | float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the hours to failure by the S-N line of the stud's material, NaN without a line or
    without cycles per hour; and the fatigue limit, which falls with the probability where a line is
    known, (n,) each.

    Parameters
    ----------
    amplitude : numpy.ndarray
        Fully reversed amplitude, (n,) [MPa].
    own : mapping
        Values of the studs by name, (n,) each.
    rule : str
        Rule below the fatigue limit.
    probability : float
        Failure probability [1].
    place : numpy.ndarray or float
        Place in the range of the typical scatter, of studs that state none, (n,) [1].
    """
    names = ("tensile_strength", "fatigue_limit", *LINE)
    hours = np.full(len(amplitude), np.nan)
    limit = np.array(own["fatigue_limit"], dtype=float)
    with_line = np.isfinite(amplitude) & np.all([np.isfinite(own[name]) for name in names], axis=0)
    broken = np.isinf(amplitude) & np.isfinite(own["cycles_per_hour"])
    hours[broken] = 0.0
    if not with_line.any():
        return hours, limit
    curve = SNCurve.of({name: own[name][with_line] for name in (*names, *SCATTER)}, rule)
    if probability != 0.5:
        at = np.broadcast_to(place, amplitude.shape)[with_line]
        typical = typical_scatter(at, probability)
        curve = curve.assuming(typical).changed(failure_probability=probability)
    hours[with_line] = curve.life_cycles(amplitude[with_line]) / own["cycles_per_hour"][with_line]
    limit[with_line] = curve.knee[0]
    return hours, limit


def limit_use(solved: SolvedRollers, results: Values) -> LimitUse:
    """Return the utilisation and the hours of the stud at the failure probability, (n, body); the
    guide has neither.

    An endurance limit that is exceeded ends a life where this is known, and is a utilisation
    otherwise. Where the stud states no scatter, its life is a range by the typical one.
    """
    probability = solved.options["failure_probability"]
    static = results["stud_static_utilisation"]
    if probability == 0.5:
        hours = results["stud_life_hours"]
        without_life = np.where(np.isnan(hours), results["stud_endurance_utilisation"], np.nan)
        return LimitUse(_of_roller(np.fmax(static, without_life)), _of_roller(hours))
    own = FIELD.columns(solved.cases[FIELD.name])
    loads = root_loads(
        BearingLoads.of(solved), own["length"], np.nan_to_num(own["eccentricity"], nan=0.0)
    )
    amplitude = _amplitude(root_stress(loads, own["diameter"])[0], own)
    given = solved.cases["placeholder_position"]
    lives = []
    limits = []
    for end in (0.0, -1.0, 1.0):
        place = np.where(np.isnan(given), end, given)
        rule = str(solved.options["life_rule"])
        hours, limit = _life(amplitude, own, rule, probability, place)
        lives.append(_of_roller(hours))
        limits.append(limit)
    without_life = np.where(np.isnan(lives[0][:, 0]), amplitude / limits[0], np.nan)
    used = _of_roller(np.fmax(static, without_life))
    return LimitUse(used, lives[0], life_low=lives[1], life_high=lives[2])


def _of_roller(values: np.ndarray) -> np.ndarray:
    """Return values of the roller, (n,), by body, (n, 2)."""
    return np.stack([values, np.full_like(values, np.nan)], axis=1)


def without_scatter(cases: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return which studs have an S-N line and state no scatter, so that they take the typical one,
    (n,) bool.
    """
    own = FIELD.columns(cases[FIELD.name])
    has_line = np.all([np.isfinite(own[name]) for name in ("load_ratio", *LINE)], axis=0)
    return np.asarray(has_line & np.all([np.isnan(own[name]) for name in SCATTER], axis=0))


def check(given: dict[str, Any]) -> None:
    """Refuse a stud whose strength is not known, strengths in the wrong order, and an endurance
    without what it needs.
    """
    for lower, upper in RISING:
        if lower in given and upper in given and given[lower] > given[upper]:
            allowed = f"at most {upper}, {given[upper]:g}"
            raise InputError(f"{FIELD.name}.{lower}", given[lower], allowed, "Correct one of them.")
    if "yield_strength" not in given:
        wrong = "is missing: it bounds the stress of the stud"
        if MATERIAL in given:
            wrong += f", and the database has none with a source of '{given[MATERIAL]}'"
        remedy = "Add yield_strength: 640 MPa, for example, from the data of your stud."
        raise InputError(f"{FIELD.name}.yield_strength", None, "", remedy, wrong)
    if "load_ratio" in given:
        _check_endurance(given)
        return
    for name in ("cycles_per_hour", "notch_factor"):
        if name in given:
            remedy = "Add load_ratio: 0 for a load that comes and goes, -1 for one that turns."
            wrong = "stands without load_ratio, which the endurance needs"
            raise InputError(f"{FIELD.name}.{name}", given[name], "", remedy, wrong)


def _check_endurance(given: dict[str, Any]) -> None:
    """Refuse an endurance without what it needs, and a load that does not change."""
    where = f"{FIELD.name}.load_ratio"
    if given["load_ratio"] == 1.0:
        wrong = "is that of a force that never changes"
        raise InputError(where, 1.0, "a number from -1 to below 1", "Leave it out.", wrong)
    remedies = {
        "fatigue_limit": "Add fatigue_limit: 200 MPa, for example, of the stud, or its material.",
        "notch_factor": "Add notch_factor: 2, for example; 1 if fatigue_limit is of the stud.",
    }
    if given["load_ratio"] > -1.0:
        remedies["tensile_strength"] = "Add tensile_strength, by which the mean stress counts."
    if "cycles_per_hour" in given:
        remedy = "Add it, so that the S-N line is known, or leave cycles_per_hour out."
        remedies |= dict.fromkeys(("tensile_strength", *LINE), remedy)
    for name, remedy in remedies.items():
        if name not in given:
            wrong = "is missing: the endurance needs it"
            raise InputError(f"{FIELD.name}.{name}", None, "", remedy, wrong)


FIELD = MappingField(
    "stud",
    "stud or axle of the roller, clamped at one end: {diameter: 10, length: 18, material: NAME, "
    "yield_strength: 640} [mm, mm, MPa]; with endurance load_ratio, notch_factor and "
    "fatigue_limit, and for hours cycles_per_hour; eccentricity [mm] of an eccentric collar",
    numbers=(
        optional("diameter", "d", "mm", "diameter at the clamped end", 0.0),
        optional("length", "L", "mm", "free length to the middle of the roller", 0.0),
        optional("eccentricity", "e", "mm", "eccentricity of the collar", 0.0, closed=True),
        optional("youngs_modulus", "E", "MPa", "modulus of elasticity", 0.0),
        optional("poisson_ratio", "nu", "-", "Poisson's ratio", 0.0, 0.5, closed=True),
        optional("yield_strength", "R_e", "MPa", "yield strength", 0.0),
        optional("tensile_strength", "R_m", "MPa", "tensile strength", 0.0),
        optional("fatigue_limit", "sigma_D", "MPa", "fully reversed fatigue limit", 0.0),
        optional("scatter_in_cycles", "T_N", "-", "scatter N_90/N_10", 1.0, closed=True),
        optional("scatter_in_stress", "T_S", "-", "scatter S_90/S_10", 1.0, closed=True),
        optional("cycles_at_tensile_strength", "N_Rm", "-", "cycles at R_m", 0.0),
        optional("cycles_at_fatigue_limit", "N_k", "-", "cycles at sigma_D", 0.0),
        optional("notch_factor", "K_f", "-", "notch factor of fatigue", 1.0, closed=True),
        optional("load_ratio", "R", "-", "smallest over largest force", -1.0, 1.0, closed=True),
        optional("cycles_per_hour", "n_S", "1/h", "changes of the force", 0.0),
    ),
    texts=(MATERIAL,),
    may_miss=(
        "eccentricity",
        "notch_factor",
        "load_ratio",
        "cycles_per_hour",
        MATERIAL,
        *OF_MATERIAL,
    ),
    check=check,
)

LIMIT = Limit(
    name="stud",
    title="stud or axle (bending and shear at its clamped end)",
    short="stud",
    group="stud",
    meaning="stress, endurance and deflection of the stud or axle",
    evaluate=evaluate,
    use=limit_use,
    results=variables(
        "stud",
        ("stud_stress", (), "MPa", "sigma_S", "von Mises stress at the clamped end of the stud"),
        ("stud_static_utilisation", (), "1", "", "stress of the stud over its yield strength"),
        ("stud_endurance_utilisation", (), "1", "", "amplitude over the fatigue limit of the stud"),
        ("stud_life_hours", (), "h", "L_S", "hours until the stud fails by fatigue", LIFE),
        ("stud_deflection", (), "mm", "w_S", "deflection of the stud at the middle of the roller"),
        ("stud_slope", (), "degree", "", "slope of the stud at the middle of the roller"),
    ),
    mappings=(FIELD,),
    requires=("stud",),
    bodies=("roller",),
    compares=("stud_stress", "permissible stress of the stud"),
    distribution="S-N scatter of the stud",
    assumes=(
        "Stud: a rigidly clamped round cantilever, without the preload of its bolt. The moments of "
        "the contacts add to those of the forces, and an eccentric collar stands in its worst "
        "position. With endurance, all forces change together, and the mean stress counts by "
        "Goodman. At a failure probability the fatigue limit of a stud without an S-N line stays "
        "the median one.",
    ),
)
