"""Rolling-contact fatigue by the S-N curve: overrollings and hours to failure of both bodies.

ASSUME: the peak von Mises stress is the amplitude, without a correction for mean stress or size, and one overrolling is
one cycle, as published.
"""

from __future__ import annotations

import numpy as np

from trackroller.damage.limit import SN_SCATTER, Limit, Results, Solved, Verdict, variables, worst
from trackroller.damage.pair import first_failure
from trackroller.damage.sn_curve import SNCurve

AMPLITUDE = "peak von Mises stress taken as amplitude, one cycle an overrolling, 50 % failure probability"


def curve_of(solved: Solved) -> SNCurve:
    """Return the S-N curves of roller and guide at a failure probability of 50 %, values (n, 1, 2)."""
    materials = {name: value[:, None] for name, value in solved.materials.items()}
    return SNCurve.of(materials, solved.options["life_rule"])


def life(solved: Solved) -> Results:
    """Return overrollings and hours to failure at 50 % failure probability, and the relative error of the life.

    The relative error of the life is the exponent of the S-N curve times the relative error of the stress.

    Parameters
    ----------
    solved : Solved
        With `peak_stress` [MPa] and `error_estimate` [1], (n, contact, body).

    Returns
    -------
    dict of str to numpy.ndarray
        `life_cycles` [1], `life_error_estimate` [1], `life_hours` [h], each (n, contact, body);
        `roller_life_hours`, `guide_life_hours`, `pair_life_hours` [h] and the flag `first_to_fail`, each (n,).
    """
    stress, curve = solved.values["peak_stress"], curve_of(solved)
    cycles = curve.life_cycles(stress)
    hours = cycles / solved.overrollings_per_hour[:, None, :]
    roller, guide = np.moveaxis(hours.min(axis=1), 1, 0)
    pair, first = first_failure(roller, guide)
    return {
        "life_cycles": cycles,
        "life_error_estimate": curve.slope(stress) * solved.values["error_estimate"],
        "life_hours": hours,
        "roller_life_hours": roller,
        "guide_life_hours": guide,
        "pair_life_hours": pair,
        "first_to_fail": first,
    }


def verdict(solved: Solved, results: Results) -> Verdict:
    """Return the utilisation of the fatigue limit and the life at the failure probability, (n, body)."""
    p = solved.options["failure_probability"]
    curve, stress = curve_of(solved).changed(failure_probability=p), solved.values["peak_stress"]
    known = curve.scatters | (p == 0.5)
    hours = curve.life_cycles(stress) / solved.overrollings_per_hour[:, None, :]
    utilisation = worst(np.where(known, stress / curve.knee[0], np.nan))
    return Verdict(utilisation, -worst(-np.where(known, hours, np.nan)))


LIMIT = Limit(
    name="fatigue",
    title="rolling-contact fatigue (S-N curve)",
    group="life",
    meaning="overrollings and hours to failure",
    evaluate=life,
    verdict=verdict,
    needs=("peak_stress",),
    results=variables(
        "life",
        ("life_cycles", ("contact", "body"), "1", "N", "overrollings to failure"),
        (
            "life_error_estimate",
            ("contact", "body"),
            "1",
            "k delta(sigma)/sigma",
            "estimated relative error of the life",
        ),
        ("life_hours", ("contact", "body"), "h", "L_h", "life in hours of travel"),
        ("roller_life_hours", (), "h", "L_h,TR", "hours of travel to the first failure of the roller"),
        ("guide_life_hours", (), "h", "L_h,G", "hours to the first failure of the guide"),
        ("pair_life_hours", (), "h", "L_h", "hours to the first failure of roller or guide"),
    ),
    requires=("guide_overrollings_per_hour",),
    ends_at_once=False,
    distribution=SN_SCATTER,
)
