"""Rolling-contact fatigue by a line of tests in rolling contact: pressure against overrollings.

The line runs through (N_R, p_R) with the exponent k_R on the largest Hertzian pressure::

    N = N_R (p_0 / p_R)**-k_R

It knows the end that the S-N curve has by tests of rollers and gears in place of bending. The life
to the first limit is then a range: each line gives one end. For steel that is hardened through or
not at all, p_R follows from the hardness (`pressure_of_hardness`).

ASSUME: a line of p_0 holds for elliptical contacts as for the line contacts of its tests. ASSUME:
those tests were lubricated, so that the line knows little traction. The traction of a dry contact
adds to the stress at the same pressure: the line is too long there, and the S-N curve with the peak
stress counts it.
"""

from __future__ import annotations

from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from trackroller.damage.limit import (
    Limit,
    LimitUse,
    SolvedRollers,
    Values,
    optional,
    variables,
    worst,
)
from trackroller.damage.sn_curve import (
    DEVIATES_10_TO_90,
    TYPICAL_SCATTER,
    log_deviates,
    typical_scatter,
)
from trackroller.numerics.variable import LARGEST, LIFE, SMALLEST

CYCLES = 1e7  # overrollings at which a pressure by hardness holds
EXPONENT = 18.0  # of tests of steel: N^-0.055 of rollers, N^-0.056 of gear flanks
HARDNESS = (150.0, 400.0)  # HB between which the pressure follows from the hardness
FAILURES = 0.01  # share of failures of the line of gear flanks


def pressure_of_hardness(hardness: ArrayLike) -> np.ndarray:
    """Return two median pressures that steel of a hardness bears for 1e7 overrollings.

    Parameters
    ----------
    hardness : array_like
        Brinell hardness of `HARDNESS` [HB].

    Returns
    -------
    numpy.ndarray
        p_R of rollers and of gear flanks, (..., 2) [MPa].

    Notes
    -----
    Rollers: 2.76 HB - 70 MPa at 1e8, moved to 1e7 by the exponent 18. Gear flanks: 0.327 HB + 26
    kpsi at 1e7 and 1 % failures, moved to the median by the typical scatter of the life.

    References
    ----------
    Budynas, Nisbett: Shigley's Mechanical Engineering Design, 9th ed., section 6-16, equations
    (6-68) and (6-69).
    """
    hb = np.asarray(hardness, dtype=float)
    rollers = (2.76 * hb - 70.0) * 10.0 ** (1.0 / EXPONENT)
    deviate = NormalDist().inv_cdf(FAILURES) / DEVIATES_10_TO_90
    median = TYPICAL_SCATTER[1] ** (-deviate / EXPONENT)
    return np.stack([rollers, (2.255 * hb + 179.0) * median], axis=-1)


def evaluate(solved: SolvedRollers) -> Values:
    """Return the pressure over that of the line [1] and the median hours, (n, contact, body)."""
    m = {name: solved.materials[name][:, None, :] for name in VALUES}
    pressure = solved.values["max_pressure"][:, :, None]
    ratio = pressure / m["rolling_pressure"]
    with np.errstate(divide="ignore", over="ignore"):
        cycles = m["rolling_cycles"] * ratio ** -m["rolling_exponent"]
        hours = cycles / solved.overrollings_per_hour[:, None, :]
    return {
        "pressure_line_utilisation": ratio,
        "pressure_line_life_hours": np.where(solved.skids[:, :, None], np.nan, hours),
    }


def limit_use(solved: SolvedRollers, results: Values) -> LimitUse:
    """Return utilisation and hours of the worse contact at the failure probability, (n, body).

    The scatter is that of the material, or the typical one with its range.
    """
    median = -worst(-results["pressure_line_life_hours"])
    used = worst(results["pressure_line_utilisation"])
    p = solved.options["failure_probability"]
    if p == 0.5:
        return LimitUse(used, median)
    materials = solved.materials
    by_stress = materials["scatter_in_stress"] ** materials["rolling_exponent"]
    own = np.where(
        np.isnan(materials["scatter_in_cycles"]), by_stress, materials["scatter_in_cycles"]
    )
    given = solved.cases["placeholder_position"][:, None]
    lives = []
    for end in (0.0, -1.0, 1.0):
        typical = typical_scatter(np.where(np.isnan(given), end, given), p)
        scatter = np.where(np.isnan(own), typical, own)
        lives.append(median * scatter ** log_deviates(p))
    return LimitUse(used, lives[0], life_low=lives[1], life_high=lives[2])


VALUES = ("rolling_pressure", "rolling_cycles", "rolling_exponent")
LIMIT = Limit(
    name="pressure_line",
    title="rolling-contact fatigue by pressure (line of tests in rolling contact)",
    short="pressure line",
    group="pressure_line",
    meaning="utilisation and hours by a line of tests in rolling contact, from the Hertzian "
    "pressure",
    evaluate=evaluate,
    use=limit_use,
    results=variables(
        "pressure_line",
        (
            "pressure_line_utilisation",
            ("contact", "body"),
            "1",
            "p_0/p_R",
            "pressure over that of the line of tests in rolling contact",
            LARGEST,
        ),
        (
            "pressure_line_life_hours",
            ("contact", "body"),
            "h",
            "L_h,p",
            "median hours by the line of tests in rolling contact",
            SMALLEST | LIFE,
        ),
    ),
    materials=(
        optional("rolling_pressure", "p_R", "MPa", "pressure borne in rolling contact", 0.0, 2e5),
        optional("rolling_cycles", "N_R", "-", "overrollings at the pressure p_R", 0.0),
        optional("rolling_exponent", "k_R", "-", "exponent of the line of pressure", 0.0, 1e3),
    ),
    requires=("rolling_pressure", "guide_overrollings_per_hour"),
    bounded=False,
    beside=True,
    evidence_of="fatigue",
    line="rolling-contact line",
    distribution="log-normal with the scatter of the material, or a typical one",
    compares=("max_pressure", "pressure p_R at N_R overrollings; above it the life is shorter"),
    assumes=(
        "Pressure line: a line of lubricated line contacts holds for elliptical contacts; it does "
        "not know traction, which shortens the life of a dry contact.",
    ),
)
