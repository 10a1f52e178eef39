"""Wear of roller and guide from their new profiles: depth, volume, run-in distance and life.

The depth of an overrolling is the integral of a local rate along the rolling direction: k p |s| by
Archard's law, or a loss of mass by a table over the frictional work |tau| |s| of the place. The
integral of all depths is the volume. It is tied to the friction energy of the contact model, which
is more exact than the sum over the elements.

The life to a permissible depth lies between two closed forms. At the rate of the new profiles it is
too short, because the patch grows. The other form divides the area that must go, that between the
profiles with one of them sunk by the depth, by the area that an overrolling wears off; it assumes
that this area stays as it is and that no material goes elsewhere. The mean of both is stated as the
value. On six rollers that were followed to 0.05 mm (594, 165, 274, 82, 163 km, and one that ended
before), the first form gives 122, 60, 110, 35 and 69 km, the second 569, 243, 528, 120 and 287 km.

ASSUME: wear coefficients do not depend on pressure, speed or temperature; the debris leaves the
contact. ASSUME: a braked roller in full slip stands still, so that the guide slides below it over
the whole distance. ASSUME: beyond its last work rate, a table of the energy law continues with its
last slope, and below its first one with its first loss. The flag `wear_extrapolated` says where.
"""

from __future__ import annotations

import functools
import json
import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trackroller.damage.histories import RollerTractions
from trackroller.damage.limit import (
    TRACTIONS,
    Limit,
    LimitUse,
    SolvedRollers,
    Values,
    optional,
    variables,
    worst,
)
from trackroller.damage.mapping import MappingField
from trackroller.errors import InputError
from trackroller.numerics.parameter import Parameter
from trackroller.numerics.variable import ESTIMATE, LARGEST, LIFE, SMALLEST, SUM

KM_PER_HOUR = 0.06  # for 1 m/min
# Relative error of the depth times the elements across a patch that 95 % of the patches of random
# rollers keep, against finer elements. Measures of single patches, such as the roughness of the
# depth, did not tell the error any better.
ERROR = {"kalker": 0.5, "kalker_table": 0.5, "sliding": 0.8}
PLACES = 801  # across drawn profiles
WIDEST = 20.0  # half their width over the root of the depth [mm^0.5]
TIE = 1e-9  # relative difference below which the outer one of two depths counts as the deeper one


def wear_depth(
    pressure: np.ndarray, slip_speed: np.ndarray, spacing: np.ndarray, coefficient: ArrayLike
) -> np.ndarray:
    """Return the depth that one overrolling wears off at each lateral place, by Archard's law.

    Parameters
    ----------
    pressure : numpy.ndarray
        p at the centres of elements, (n, contact, y, x) [MPa].
    slip_speed : numpy.ndarray
        Local slip |s| per distance travelled, (n, contact, y, x) [1].
    spacing : numpy.ndarray
        Length of an element along the rolling direction, (n, contact) [mm].
    coefficient : array_like
        Wear coefficient k of the body, (n, contact) or (n,) [mm3/(N m)].

    Returns
    -------
    numpy.ndarray
        delta(x) = 1e-3 k int p |s| dy, (n, contact, x) [mm].

    Notes
    -----
    The sum over the elements is exact for tractions that are constant in each element.

    References
    ----------
    Archard, J. F. (1953). Contact and rubbing of flat surfaces. Journal of Applied Physics 24,
    981-988, doi:10.1063/1.1721448.

    Examples
    --------
    >>> pressure = np.full((1, 1, 4, 2), 100.0)
    >>> wear_depth(pressure, 0.01 + 0.0 * pressure, np.array([[0.25]]), 1e-5)
    array([[[1.e-08, 1.e-08]]])
    """
    worn = np.einsum("...yx,...yx->...x", pressure, slip_speed) * np.asarray(spacing)[..., None]
    k = np.asarray(coefficient, float)
    return np.asarray(1e-3 * k.reshape(k.shape + (1,) * (worn.ndim - k.ndim)) * worn)


def mass_loss(work: np.ndarray, rates: ArrayLike, losses: ArrayLike) -> np.ndarray:
    """Return the loss of mass of the energy law, linear between the points of its table.

    Parameters
    ----------
    work : numpy.ndarray
        Frictional work per area and distance travelled, |tau| |s| [N/mm2].
    rates, losses : array_like
        Work rates, rising [N/mm2], and losses of mass there [ug/(m mm2)].

    Returns
    -------
    numpy.ndarray
        Loss per area and distance, of the shape of `work` [ug/(m mm2)]; beyond the table with its
        last slope.
    """
    x, y = np.asarray(rates, float), np.asarray(losses, float)
    slope = (y[-1] - y[-2]) / (x[-1] - x[-2])
    return np.asarray(np.interp(work, x, y) + slope * np.maximum(work - x[-1], 0.0))


@functools.lru_cache(maxsize=256)
def table_of_laws(roller: str, guide: str) -> str:
    """Return the table of the energy law of a pair as canonical JSON.

    Parameters
    ----------
    roller, guide : str
        `work_rate` and `loss` of each body as JSON.

    Returns
    -------
    str
        Both losses at the work rates of either body, up to the smaller of the last ones: beyond it
        the loss of one body is not known.
    """
    laws = [json.loads(text) for text in (roller, guide)]
    rates = np.union1d(*(law["work_rate"] for law in laws))
    first = max(law["work_rate"][0] for law in laws)
    last = min(law["work_rate"][-1] for law in laws)
    rates = rates[(rates >= first) & (rates <= last)]
    table = {"work_rate": rates.tolist()}
    for body, law in zip(BODIES, laws, strict=True):
        table[body] = mass_loss(rates, law["work_rate"], law["loss"]).tolist()
    return json.dumps(TABLE.canonical(table), sort_keys=True)


def deepest(x: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest depth over x and its place, by a parabola through the three highest
    neighbours.

    Parameters
    ----------
    x : numpy.ndarray
        Equidistant places, (n, contact, x) [mm].
    depth : numpy.ndarray
        Depths, (n, contact, body, x) [mm]. Of two equal depths the outer one counts, in mirrored
        contacts too.

    Returns
    -------
    tuple of numpy.ndarray
        Depth and place, (n, contact, body) [mm]; the place is NaN where nothing wears.
    """
    outward = np.array([1.0, -1.0])[:, None] * np.arange(x.shape[-1])
    at = np.argmax(np.nan_to_num(depth) * (1.0 + TIE * outward[:, None, :]), axis=-1)[..., None]
    inner = np.clip(at, 1, x.shape[-1] - 2)
    before, top, after = (np.take_along_axis(depth, inner + i, axis=-1)[..., 0] for i in (-1, 0, 1))
    curved = (at == inner)[..., 0] & (2.0 * top > before + after)
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = np.where(curved, 0.5 * (after - before) / (2.0 * top - before - after), 0.0)
    largest = np.where(
        curved,
        top + 0.25 * shift * (after - before),
        np.take_along_axis(depth, at, axis=-1)[..., 0],
    )
    step = (x[..., 1] - x[..., 0])[..., None]
    place = (
        np.take_along_axis(np.broadcast_to(x[:, :, None, :], depth.shape), at, axis=-1)[..., 0]
        + shift * step
    )
    return largest, np.where(largest > 0.0, place, np.nan)


def _gaps_at_edges(solved: SolvedRollers, t: RollerTractions) -> np.ndarray:
    """Return the smaller gap of the unworn profiles at the two lateral edges of each patch, (n,
    contact) [mm].
    """
    c = solved.cases
    if solved.options["normal"] == "hertz":
        curvature = 1.0 / c["roller_profile_radius"] + 1.0 / c["guide_profile_radius"]
        return np.asarray(0.5 * curvature[:, None] * solved.values["semi_axis_lateral"] ** 2)

    def of_patch(case: int, contact: int) -> float:
        side = 1 - 2 * contact  # a gap counts x outward
        x = side * t.x[case, contact]
        loaded = (t.pressure[case, contact] > 0.0).any(axis=0)
        half = 0.5 * abs(x[1] - x[0])
        own = x[loaded]
        height = solved.unworn_gap(
            case, contact, np.array([own.min() - half, *own, own.max() + half])
        )
        return float(max(min(height[0], height[-1]) - height.min(), 0.0))

    return t.by_patch(of_patch)


def local_rates(
    pressure: np.ndarray, shear: np.ndarray, sliding: np.ndarray, table: str
) -> list[np.ndarray]:
    """Return p |s| [MPa], or by the `table` of the energy law the loss of mass [ug/(m mm2)], of
    roller and guide.

    Elements have the pressure p and the shear |tau| [MPa], and slide by |s| per distance travelled
    [1]; `table` is the canonical JSON of the case, "" for Archard's law.
    """
    if not table:
        rate = pressure * sliding
        return [rate, rate]
    own = TABLE.parsed(table)
    return [mass_loss(shear * sliding, own["work_rate"], own[body]) for body in BODIES]


def energy_ratio(energy: np.ndarray, elements: np.ndarray) -> np.ndarray:
    """Return the friction energy of the contact model over the sum of its elements; 1 where one of
    them is not known.

    The friction energy of a patch that hardly slips can round to a negative number, which does not
    count.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = energy / elements
    return np.where(np.isfinite(ratio) & (ratio > 0.0), ratio, 1.0)


BEYOND_TABLE = "_beyond_wear_table"  # for the flag `wear_extrapolated`; no result


def leaves_table(work: np.ndarray, table: str) -> np.ndarray:
    """Return whether an element does more frictional work than the last entry of a table, or less
    than the first.

    Elements that do no work have no wear to extrapolate. `work` is |tau| |s| [N/mm2] with the shape
    (..., y, x), the result has the shape (...). `table` is the canonical JSON of the case.
    """
    rates = TABLE.parsed(table)["work_rate"]
    return np.asarray(
        np.any((work > rates[-1]) | ((work > 0.0) & (work < rates[0])), axis=(-2, -1))
    )


def _beyond_table(solved: SolvedRollers, shear: np.ndarray, sliding: np.ndarray) -> np.ndarray:
    """Return whether a contact of a case leaves the table of the case, (n,); see `leaves_table`."""
    out = np.zeros(len(shear), dtype=bool)
    if solved.options["wear_law"] != "energy":
        return out
    texts = solved.cases["wear_table"]
    for text in set(texts.tolist()) - {""}:
        rows = texts == text
        out[rows] = leaves_table(shear[rows] * sliding[rows], text).any(axis=1)
    return out


def _rates(
    solved: SolvedRollers, pressure: np.ndarray, shear: np.ndarray, sliding: np.ndarray
) -> list[np.ndarray]:
    """Return `local_rates` of each case, (n, contact, y, x) of roller and guide; NaN without a
    table.
    """
    if solved.options["wear_law"] == "archard":
        return local_rates(pressure, shear, sliding, "")
    texts = solved.cases["wear_table"]
    out = [np.full_like(shear, np.nan) for _ in BODIES]
    for text in set(texts.tolist()) - {""}:
        rows = texts == text
        own = local_rates(pressure[rows], shear[rows], sliding[rows], text)
        for body in range(len(BODIES)):
            out[body][rows] = own[body]
    return out


def _lines(rates: list[np.ndarray], spacing: np.ndarray) -> np.ndarray:
    """Return the integrals of the rates of both bodies along the rolling direction, (n, contact,
    body, x); equal rates are integrated once.
    """
    unit = np.ones(len(spacing))

    def along_rolling(rate: np.ndarray) -> np.ndarray:
        return wear_depth(rate, np.ones_like(rate), spacing, unit)

    roller, guide = rates
    first = along_rolling(roller)
    second = first
    if guide is not roller:
        second = along_rolling(guide)
    return np.stack([first, second], axis=2)


def of_mechanics(solved: SolvedRollers) -> Values:
    """Return what does not depend on coefficients and speed: depths and volumes for a coefficient
    of 1.

    The coefficient is k by Archard's law, and 1/density by the energy law. Results are
    `_worn_depth` [mm], `wear_place` [mm] and `_worn_volume` [mm3/km], (n, contact, body),
    `_gap_at_edge` [mm] and `wear_error_estimate` [1], (n, contact), and whether the table of the
    energy law is left, (n,).
    """
    t = solved.tractions()
    locked = (
        (solved.cases["motor_force"] > 0.0)[:, None, None, None]
        & np.isnan(t.slip_rolling)
        & (t.pressure >= 0.0)
    )
    sliding = np.where(locked, 1.0, t.slip)
    wide, long = (axis[..., 1] - axis[..., 0] for axis in (t.x, t.y))
    cell = wide * long
    braked = locked.any(axis=(2, 3))
    shear = t.shear
    rubbed = np.sum(shear * sliding, axis=(2, 3))
    rates = _rates(solved, t.pressure, shear, sliding)
    # constant friction: |tau| = mu p wherever surfaces slide, to more digits than an iteration has
    constant = (solved.cases["friction_law"] == "")[:, None]
    mu = solved.cases["friction_coefficient"][:, None]
    rubbed = np.where(constant, mu * np.sum(t.pressure * sliding, axis=(2, 3)), rubbed) * cell
    pressed = np.sum(t.pressure, axis=(2, 3)) * cell
    v = solved.values
    known = np.where(braked, v["normal_force"], v["friction_energy_per_distance"])
    long = long * energy_ratio(known, np.where(braked, pressed, rubbed))
    depth = _lines(rates, long)
    largest, place = deepest(t.x, depth)
    # a roller that stands still is not overrolled
    largest[:, :, 0] = np.where(braked, np.nan, largest[:, :, 0])
    return {
        "_worn_depth": largest,
        "wear_place": place,
        "_worn_volume": 1e6 * depth.sum(axis=-1) * wide[..., None],
        "_gap_at_edge": _gaps_at_edges(solved, t),
        BEYOND_TABLE: _beyond_table(solved, shear, sliding),
        "wear_error_estimate": ERROR.get(solved.options["contact_model"], np.nan) / t.x.shape[-1]
        + 0.0 * wide,
    }


def sunk_area(depth: ArrayLike, guide_radius: ArrayLike, roller_radius: ArrayLike) -> np.ndarray:
    """Return the area that lies between two profiles of circles when one is sunk into the other by
    a depth.

    Parameters
    ----------
    depth : array_like
        h > 0 [mm].
    guide_radius : array_like
        Radius of the convex guide, > 0 [mm].
    roller_radius : array_like
        Radius of the roller [mm]: < 0 for a groove that is wider than the guide, > 0 convex, inf
        straight.

    Returns
    -------
    numpy.ndarray
        Segment of the guide's circle, with that of the roller's circle added (convex) or taken away
        (groove) [mm2].

    Examples
    --------
    >>> # half of a circle in a straight roller
    >>> float(sunk_area(1.0, 1.0, np.inf).round(6)) == round(np.pi / 2, 6)
    True
    """
    h, r, given = (np.asarray(value, dtype=float) for value in (depth, guide_radius, roller_radius))
    straight = np.isinf(given)
    groove = given < 0.0
    other = np.where(straight, 1.0, np.abs(given))
    apart = np.where(groove, other - r + h, other + r - h)  # distance of the centres
    with np.errstate(divide="ignore", invalid="ignore"):
        # distance of the common chord from the centre of the roller's profile, and from that of the
        # guide's
        far = 0.5 * (apart + (other - r) * ((other + r) / apart))
        near = np.where(straight, r - h, np.where(groove, far - apart, apart - far))
    own = _segment(r, near)
    others = np.where(straight, 0.0, _segment(other, far))
    return np.asarray(np.where(groove, own - others, own + others))


def _segment(radius: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Return the area of a circle beyond a chord at a distance from its centre; none or all of it
    without a chord.
    """
    q = np.clip(distance / radius, -1.0, 1.0)
    return np.asarray(radius**2 * (np.arccos(q) - q * np.sqrt(1.0 - q**2)))


def _worn_areas(solved: SolvedRollers) -> np.ndarray:
    """Return the area that goes until the permissible depth is reached, (n, contact) [mm2]; of
    drawn profiles too.
    """
    c = solved.cases
    depth = c["permissible_wear_depth"]
    radii = (c["guide_profile_radius"], c["roller_profile_radius"])
    out = np.repeat(sunk_area(depth, *radii)[:, None], 2, axis=1)
    has_profile = (c["guide_profile"] != "") | (c["roller_profile"] != "")
    for case in np.flatnonzero(has_profile & ~np.isnan(depth)):
        x = np.linspace(-1.0, 1.0, PLACES) * min(
            c["guide_profile_radius"][case], WIDEST * np.sqrt(depth[case])
        )
        for contact in range(2):
            gap = solved.unworn_gap(int(case), contact, x)
            out[case, contact] = np.trapezoid(
                np.nan_to_num(np.maximum(depth[case] - (gap - np.nanmin(gap)), 0.0)), x
            )
    return out


def evaluate(solved: SolvedRollers) -> Values:
    """Return depths, volume and life with its range, (n, contact, body), and the run-in distance
    [km], (n,).
    """
    c = solved.cases
    v = solved.values
    hourly = solved.overrollings_per_hour
    archard = solved.options["wear_law"] == "archard"
    if archard:
        k = solved.materials["wear_coefficient"]
    else:
        k = 1.0 / solved.materials["density"]
    k = (k * np.nan_to_num(c["wear_coefficient_factor"], nan=1.0)[:, None])[:, None, :]
    depth = k * v["_worn_depth"]
    volume = k * v["_worn_volume"]
    travel = c["velocity"] * KM_PER_HOUR
    per_km = depth * (hourly / travel[:, None])[:, None, :]
    # a guide without overrollings does not count
    counted = np.where(np.isnan(hourly)[:, None, :], 0.0, per_km)
    with np.errstate(divide="ignore", invalid="ignore"):
        run_in = np.min(v["_gap_at_edge"] / np.max(counted, axis=2), axis=1)
        by_depth = c["permissible_wear_depth"][:, None, None] / (depth * hourly[:, None, :])
        by_area = 1e6 * _worn_areas(solved)[:, :, None] / (volume * hourly[:, None, :])
    by_area = np.where(np.isnan(by_depth), np.nan, by_area)
    return {
        "wear_depth_per_overrolling": depth,
        "wear_depth_per_km": per_km,
        "wear_place": v["wear_place"],
        "wear_error_estimate": v["wear_error_estimate"],
        "wear_volume_per_km": volume,
        "run_in_distance": run_in,
        "wear_life_hours": 0.5 * (by_depth + by_area),
        "wear_life_hours_low": np.minimum(by_depth, by_area),
        "wear_life_hours_high": np.maximum(by_depth, by_area),
    }


def limit_use(solved: SolvedRollers, results: Values) -> LimitUse:
    """Return the required travel over the travel to the permissible depth, and the hours, (n,
    body).
    """
    hours, low, high = (-worst(-results[f"wear_life_hours{end}"]) for end in ("", "_low", "_high"))
    with np.errstate(divide="ignore"):
        used = solved.cases["required_travel"][:, None] / (
            hours * (solved.cases["velocity"] * KM_PER_HOUR)[:, None]
        )
    return LimitUse(used, hours, life_low=low, life_high=high)


def check(given: dict[str, Any]) -> None:
    """Refuse a table whose lists differ in length, or whose work rates do not rise."""
    lengths = {key: len(values) for key, values in given.items()}
    if len(set(lengths.values())) > 1 or min(lengths.values()) < 2:
        listed = ", ".join(f"{key} {length}" for key, length in lengths.items())
        raise InputError(
            "wear_table", f"numbers of entries: {listed}", "lists of equal length, at least 2"
        )
    if np.any(np.diff(given["work_rate"]) <= 0.0):
        raise InputError("wear_table.work_rate", given["work_rate"], "work rates that rise")


BODIES = ("roller", "guide")
_CB = ("contact", "body")
TABLE = MappingField(
    "wear_table",
    "for wear_law: energy, loss of mass of each body [ug/(m mm2)] over the frictional work "
    "[N/mm2]; without it that of the materials holds (energy_wear) if both have one; such as the "
    "railway values for wheel R8T on rail 900A, to be checked before use: {work_rate: [0, "
    "10.4, 77.2, 100], roller: "
    "[0, 55, 55, 1466], guide: [0, 55, 55, 1466]}",
    lists=(
        optional(
            "work_rate",
            "T gamma/A",
            "N/mm2",
            "frictional work per area and distance",
            0.0,
            closed=True,
        ),
        optional("roller", "", "ug/(m mm2)", "loss of mass of the roller", 0.0, closed=True),
        optional("guide", "", "ug/(m mm2)", "loss of mass of the guide", 0.0, closed=True),
    ),
    check=check,
)

LIMIT = Limit(
    name="wear",
    title="wear (permissible depth)",
    short="wear",
    group="wear",
    meaning="depth and volume of wear, travel until the groove has changed, life to the "
    "permissible depth",
    shared=of_mechanics,
    evaluate=evaluate,
    use=limit_use,
    needs=("friction_work", TRACTIONS),
    results=variables(
        "wear",
        (
            "wear_depth_per_overrolling",
            _CB,
            "mm",
            "delta",
            "largest depth that an overrolling wears off",
            LARGEST,
        ),
        (
            "wear_depth_per_km",
            _CB,
            "mm km-1",
            "",
            "largest depth that is worn off per km of travel",
            LARGEST,
        ),
        ("wear_place", _CB, "mm", "x_C", "lateral place of the largest wear depth", {"odd": True}),
        (
            "wear_volume_per_km",
            _CB,
            "mm3 km-1",
            "V",
            "volume that is worn off per km of travel",
            SUM,
        ),
        (
            "wear_error_estimate",
            ("contact",),
            "1",
            "",
            "estimated relative error of the wear depth",
            ESTIMATE,
        ),
        (
            "run_in_distance",
            (),
            "km",
            "",
            "run-in distance, until wear equals the gap at the edge",
            {"scale": "log10", "shown": True, "label": "run-in distance"},
        ),
        (
            "wear_life_hours",
            _CB,
            "h",
            "L_h,W",
            "hours to the permissible wear depth, the mean of two closed forms",
            SMALLEST | LIFE | {"label": "wear life"},
        ),
        (
            "wear_life_hours_low",
            _CB,
            "h",
            "",
            "low end of the hours to the permissible wear depth, over closed forms and "
            "placeholders",
            SMALLEST | LIFE | {"end": "low", "label": "wear life, low end"},
        ),
        (
            "wear_life_hours_high",
            _CB,
            "h",
            "",
            "high end of the hours to the permissible wear depth, over closed forms and "
            "placeholders",
            SMALLEST | LIFE | {"end": "high", "label": "wear life, high end"},
        ),
    ),
    parameters=(
        optional(
            "permissible_wear_depth",
            "h_zul",
            "mm",
            "permissible wear depth of roller and guide",
            0.0,
            1e3,
        ),
        Parameter(
            "travel",
            "s",
            "km",
            0.0,
            "travel after which the worn profiles are solved, with normal: halfspace; 0 for new "
            "ones",
            0.0,
            1e9,
            role="condition",
        ),
        optional("required_travel", "", "km", "travel that the wear depth has to allow", 0.0, 1e9),
        Parameter(
            "wear_coefficient_factor",
            "f_k",
            "-",
            math.nan,
            "factor on the wear coefficients of both bodies, which replaces the ranges of their "
            "placeholders",
            0.0,
            1e6,
            allow_missing=True,
            role="condition",
        ),
    ),
    materials=(
        optional("wear_coefficient", "k_W", "mm3/(N m)", "wear coefficient", 0.0, 1.0, closed=True),
    ),
    mappings=(TABLE,),
    requires=("permissible_wear_depth", "guide_overrollings_per_hour"),
    requires_by={
        "wear_law": {"archard": ("wear_coefficient",), "energy": ("wear_table", "density")}
    },
    compares=("wear_depth_per_km", "wear that allows the required travel"),
    assumes=(
        "Wear: the life lies between the rate of the new profiles and the worn area over the "
        "worn volume; no wear "
        "coefficient depends on pressure, speed or temperature.",
    ),
)
