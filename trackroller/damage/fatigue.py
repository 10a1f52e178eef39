"""Rolling-contact fatigue by the S-N curve: overrollings and hours to failure of both bodies.

ASSUME: the stress of the life criterion is the fully reversed amplitude, without a correction for
size, and one overrolling is one cycle. The published criterion takes the peak von Mises stress,
without a correction for mean stress; `goodman` corrects for it.
"""

from __future__ import annotations

import numpy as np

from trackroller.damage.limit import (
    SN_SCATTER,
    Limit,
    LimitUse,
    SolvedRollers,
    Values,
    variables,
    worst,
)
from trackroller.damage.pair import first_failure
from trackroller.damage.sn_curve import SNCurve, typical_scatter
from trackroller.numerics.variable import ESTIMATE, LARGEST, LIFE, SMALLEST

# results of `multiaxial` that enter the S-N curve by a life criterion; of the ratios to a limit, 1
# stands for sigma_D
STRESS_OF = {
    "von_mises_amplitude": "von_mises_amplitude",
    "goodman": "goodman_stress",
    "findley": "findley_utilisation",
    "dang_van": "dang_van_utilisation",
}
AMPLITUDE = (
    "peak von Mises stress taken as amplitude, one cycle an overrolling, 50 % failure probability"
)


def curve_of(solved: SolvedRollers) -> SNCurve:
    """Return the S-N curves of roller and guide at a failure probability of 50 %, values (n,
    1, 2).
    """
    materials = {name: value[:, None] for name, value in solved.materials.items()}
    return SNCurve.of(materials, solved.options["life_rule"])


def amplitude(solved: SolvedRollers) -> np.ndarray:
    """Return the stress that enters the S-N curve by the option `life_criterion`, (n, contact,
    body) [MPa].
    """
    criterion = solved.options["life_criterion"]
    values = solved.values
    if criterion not in STRESS_OF:
        return values["peak_stress"]
    name = STRESS_OF[criterion]
    if criterion == "dang_van" and not solved.options["credit_pressure"]:
        name = "dang_van_utilisation_without_pressure"
    if criterion in ("von_mises_amplitude", "goodman"):  # these are stresses already
        return np.asarray(values[name])
    return np.asarray(values[name] * solved.materials["fatigue_limit"][:, None, :])


def overloaded(peak_stress: np.ndarray, tensile_strength: np.ndarray) -> np.ndarray:
    """Return where a body breaks at once, (n, body) bool: its peak stress exceeds its tensile
    strength in a contact.

    Parameters
    ----------
    peak_stress : numpy.ndarray
        Largest von Mises stress, (n, contact, body) [MPa].
    tensile_strength : numpy.ndarray
        R_m, (n, body) [MPa].
    """
    return np.asarray(np.any(peak_stress > tensile_strength[:, None, :], axis=1))


def _overloaded(solved: SolvedRollers) -> np.ndarray:
    return overloaded(solved.values["peak_stress"], solved.materials["tensile_strength"])


def _without_life(solved: SolvedRollers) -> np.ndarray:
    """Return where a body has no fatigue life, (n, body) bool: it breaks at once, or the roller
    skids.
    """
    return np.asarray(_overloaded(solved) | solved.skids)


def _error_of_life(exponent: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Return the error of a life as a factor less 1, for relative errors of the stress and
    exponents.
    """
    return np.asarray(np.expm1(exponent * np.log1p(error)))


def life(solved: SolvedRollers) -> Values:
    """Return overrollings and hours to failure at 50 % failure probability, and the relative error
    of the life.

    A stress that is larger by the factor 1 + e shortens the life by the factor (1 + e)^k with the
    exponent k of the S-N curve, so that the relative error of the life is (1 + e)^k - 1. A body
    that breaks at once or skids has no fatigue life: NaN, and so has its pair.

    Parameters
    ----------
    solved : SolvedRollers
        With `peak_stress` [MPa] and `error_estimate` [1], (n, contact, body), and by the option
        `life_criterion` with the results of `multiaxial`.

    Returns
    -------
    dict of str to numpy.ndarray
        `life_cycles` [1], `life_error_estimate` [1], `life_hours` [h], each (n, contact, body);
        `roller_life_hours`, `guide_life_hours`, `pair_life_hours` [h] and the flag `first_to_fail`,
        each (n,). With a criterion other than the published one also `fatigue_stress` [MPa], (n,
        contact, body).

    Notes
    -----
    The error of a stress other than the peak is not estimated, so its life has no error either.
    """
    stress = amplitude(solved)
    curve = curve_of(solved)
    published = solved.options["life_criterion"] not in STRESS_OF
    if published:
        error = solved.values["error_estimate"]
    else:
        error = np.full_like(stress, np.nan)
    lifeless = _without_life(solved)
    cycles = np.where(lifeless[:, None, :], np.nan, curve.life_cycles(stress))
    with np.errstate(over="ignore"):  # lives longer than the range of numbers are infinite
        hours = cycles / solved.overrollings_per_hour[:, None, :]
    roller, guide = np.moveaxis(hours.min(axis=1), 1, 0)
    pair, first = first_failure(roller, guide)
    pair = np.where(lifeless.any(axis=1), np.nan, pair)
    results = {
        "life_cycles": cycles,
        "life_error_estimate": np.where(
            np.isnan(cycles), np.nan, _error_of_life(curve.slope(stress), error)
        ),
        "life_hours": hours,
        "roller_life_hours": roller,
        "guide_life_hours": guide,
        "pair_life_hours": pair,
        "first_to_fail": first,
    }
    if not published:
        results["fatigue_stress"] = stress
    return results


def limit_use(solved: SolvedRollers, results: Values) -> LimitUse:
    """Return the utilisation of the fatigue limit and the life at the failure probability, (n,
    body).

    Where a material gives no scatter, the life is a range: its ends are those of the typical
    scatter. A given place of the placeholders holds for this scatter, too.
    """
    p = solved.options["failure_probability"]
    stress = amplitude(solved)
    overloaded = _overloaded(solved)
    if p == 0.5:
        curve = curve_of(solved)
        return LimitUse(
            worst(stress / curve.knee[0]), _hours_to_failure(solved, curve, stress), overloaded
        )
    given = solved.cases["placeholder_position"][:, None, None]
    used = []
    hours = []
    for end in (0.0, -1.0, 1.0):
        place = np.where(np.isnan(given), end, given)
        curve = curve_of(solved).assuming(typical_scatter(place, p)).changed(failure_probability=p)
        used.append(worst(stress / curve.knee[0]))
        hours.append(_hours_to_failure(solved, curve, stress))
    return LimitUse(used[0], hours[0], overloaded, life_low=hours[1], life_high=hours[2])


def _hours_to_failure(solved: SolvedRollers, curve: SNCurve, stress: np.ndarray) -> np.ndarray:
    """Return the hours to the first failure of each body by an S-N curve, (n, body); NaN without a
    fatigue life.
    """
    hours = curve.life_cycles(stress) / solved.overrollings_per_hour[:, None, :]
    living = ~_without_life(solved)[:, None, :]
    return -worst(-np.where(living, hours, np.nan))


LIMIT = Limit(
    name="fatigue",
    title="rolling-contact fatigue (S-N curve)",
    short="fatigue",
    group="life",
    meaning="overrollings and hours to failure",
    evaluate=life,
    use=limit_use,
    needs=("peak_stress",),
    results=variables(
        "life",
        ("life_cycles", ("contact", "body"), "1", "N", "overrollings to failure", SMALLEST | LIFE),
        (
            "life_error_estimate",
            ("contact", "body"),
            "1",
            "(1 + delta(sigma)/sigma)^k - 1",
            "estimated relative error of the life",
            ESTIMATE,
        ),
        (
            "fatigue_stress",
            ("contact", "body"),
            "MPa",
            "sigma_a,eq",
            "amplitude that enters the S-N curve",
            LARGEST,
        ),
        ("life_hours", ("contact", "body"), "h", "L_h", "life in hours of travel", SMALLEST | LIFE),
        (
            "roller_life_hours",
            (),
            "h",
            "L_h,TR",
            "hours of travel to the first failure of the roller",
            LIFE | {"of": "roller", "label": "life of the roller"},
        ),
        (
            "guide_life_hours",
            (),
            "h",
            "L_h,G",
            "hours to the first failure of the guide",
            LIFE | {"of": "guide", "label": "life of the guide"},
        ),
        (
            "pair_life_hours",
            (),
            "h",
            "L_h",
            "hours to the first failure of roller or guide",
            LIFE | {"of": "pair", "label": "life of the pair"},
        ),
    ),
    requires=("guide_overrollings_per_hour",),
    requires_by={
        "life_criterion": dict.fromkeys(("findley", "dang_van"), ("fatigue_limit_torsion",))
    },
    bounded=False,
    line="bending line",
    distribution=SN_SCATTER,
    compares=("fatigue_stress peak_stress", "fatigue limit sigma_D; above it the life is finite"),
    standard="DIN 50100:2016 for the form of the S-N curve",
    assumes=(
        "Fatigue: no size effect; one overrolling is one cycle. The published life_criterion "
        "takes the peak von Mises "
        "stress as amplitude, with no mean stress. A roller that skids and a body above its "
        "tensile strength have no "
        "fatigue life.",
    ),
)
