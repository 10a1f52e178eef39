"""Standard rating of wheels and rails after EN 13001-3-3, as limits of the Hertzian pressure.

The standard gives forces of line contacts; through Hertz's line contact they are limits of p_0. The
text of the standard was not at hand; the numbers are those of a public implementation, without
factors for edges and use.

ASSUME: the limits of p_0 hold for elliptical contacts too.
"""

from __future__ import annotations

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
from trackroller.numerics.variable import LARGEST, LIFE, SMALLEST

RESISTANCE = 1.1  # partial factor of the material, on the force
CONTACTS = 6.4e6  # contacts that the fatigue limit stands for
EXPONENT = 20.0 / 3.0  # of the pressure; 10/3 of the force


def static_pressure(
    hardness: ArrayLike, yield_strength: ArrayLike, hardened: ArrayLike
) -> np.ndarray:
    """Return the largest p_0 of a single load.

    Parameters
    ----------
    hardness, yield_strength : array_like
        Brinell hardness [HB], and f_y [MPa] of a surface-hardened material.
    hardened : array_like of bool
        Whether the surface is hardened.

    Returns
    -------
    numpy.ndarray
        7 HB / sqrt(1.1), or 4.2 f_y / sqrt(1.1) [MPa]; the factor 1.1 belongs to the force.
    """
    pressure = np.where(hardened, 4.2 * np.asarray(yield_strength), 7.0 * np.asarray(hardness))
    return np.asarray(pressure / np.sqrt(RESISTANCE))


def contacts_to_limit(
    pressure: ArrayLike, hardness: ArrayLike, yield_strength: ArrayLike, hardened: ArrayLike
) -> np.ndarray:
    """Return the contacts that a pressure p_0 [MPa] allows, 6.4e6 (p_u/p_0)^(20/3) [1].

    p_u is 3 HB, or 1.8 f_y of a surface-hardened material; see `static_pressure`.
    """
    limit = np.where(hardened, 1.8 * np.asarray(yield_strength), 3.0 * np.asarray(hardness))
    with np.errstate(divide="ignore", over="ignore"):
        return np.asarray(CONTACTS * (limit / np.asarray(pressure, dtype=float)) ** EXPONENT)


def evaluate(solved: SolvedRollers) -> Values:
    """Return `rating_utilisation_static` [1] and `rating_life_hours` [h], (n, contact, body); NaN
    if it skids.
    """
    m = {
        name: solved.materials[name][:, None, :]
        for name in ("hardness", "yield_strength", "surface_hardened")
    }
    strength = m["hardness"], m["yield_strength"], m["surface_hardened"] == 1
    pressure = solved.values["max_pressure"][:, :, None]
    hours = contacts_to_limit(pressure, *strength) / solved.overrollings_per_hour[:, None, :]
    return {
        "rating_utilisation_static": pressure / static_pressure(*strength),
        "rating_life_hours": np.where(solved.skids[:, :, None], np.nan, hours),
    }


def limit_use(solved: SolvedRollers, results: Values) -> LimitUse:
    """Return utilisation and hours of the worse contact, (n, body)."""
    return LimitUse(
        worst(results["rating_utilisation_static"]), -worst(-results["rating_life_hours"])
    )


LIMIT = Limit(
    name="rating",
    title="standard rating of wheel and rail (EN 13001-3-3)",
    short="rating",
    group="rating",
    meaning="utilisation and hours after EN 13001-3-3, from Hertzian pressure and hardness",
    evaluate=evaluate,
    use=limit_use,
    results=variables(
        "rating",
        (
            "rating_utilisation_static",
            ("contact", "body"),
            "1",
            "p_0/p_Rd",
            "pressure over its static limit",
            LARGEST,
        ),
        (
            "rating_life_hours",
            ("contact", "body"),
            "h",
            "L_h,R",
            "hours to the contacts that the standard allows",
            SMALLEST | LIFE,
        ),
    ),
    materials=(
        optional("hardness", "HB", "HB", "Brinell hardness", 0.0, 2000.0),
        optional(
            "surface_hardened",
            "",
            "-",
            "1 where the surface is hardened, 0 where it is not",
            0.0,
            1.0,
            closed=True,
        ),
        optional("yield_strength", "R_e", "MPa", "yield strength", 0.0, 2e5),
    ),
    requires=("hardness", "guide_overrollings_per_hour"),
    beside=True,
    instead={"hardness": ("surface_hardened", "yield_strength")},
    compares=("max_pressure", "static pressure of the standard"),
    standard="EN 13001-3-3 after a public implementation; its text was not at hand",
    assumes=("Standard rating: the limits of line contacts hold for elliptical contacts.",),
)
