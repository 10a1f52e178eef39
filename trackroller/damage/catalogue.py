"""Load factor and kilometres of a maker's catalogue for track rollers."""

from __future__ import annotations

import numpy as np

from trackroller.damage.bearing import BearingLoads
from trackroller.damage.limit import Limit, SolvedRollers, Values, Verdict, optional, variables
from trackroller.damage.mapping import MappingField
from trackroller.numerics.variable import LIFE

LAWS = ("dry", "lubricated", "cubic")


def travel_km(
    load_factor: np.ndarray | float, basic_life: np.ndarray | float, power: float, offset: float = 0.03
) -> np.ndarray:
    """Return the kilometres that a load factor LF allows, BL/(c + (1 - c) LF)^power.

    Parameters
    ----------
    load_factor : numpy.ndarray or float
        Sum of the loads over their limits [1].
    basic_life : numpy.ndarray or float
        Kilometres BL at a load factor of 1 [km].
    power : float
        Exponent [1]: 2 for dry and 3 for lubricated rollers.
    offset : float
        Load factor c that counts without any load [1]; 0 gives BL/LF^power.

    Returns
    -------
    numpy.ndarray
        Kilometres, inf without any load.
    """
    with np.errstate(divide="ignore"):
        return np.asarray(basic_life * (offset + (1.0 - offset) * np.asarray(load_factor)) ** -power)


def catalogue_km(load_factor: np.ndarray, basic_life: np.ndarray, law: np.ndarray) -> np.ndarray:
    """Return the kilometres that a load factor allows.

    Parameters
    ----------
    load_factor : numpy.ndarray
        Sum of the loads over their limits, (n,) [1].
    basic_life : numpy.ndarray
        Kilometres at a load factor of 1, (n,) [km].
    law : numpy.ndarray of str
        "dry": BL/(0.03 + 0.97 LF)^2, "lubricated": the same with exponent 3 (a maker's laws from tests), or "cubic":
        BL/LF^3, (n,).

    Returns
    -------
    numpy.ndarray
        Kilometres, (n,); NaN without a law.
    """
    lives = [travel_km(load_factor, basic_life, *one) for one in ((2.0,), (3.0,), (3.0, 0.0))]
    return np.asarray(np.select([law == word for word in LAWS], lives, np.nan))


def evaluate(solved: SolvedRollers) -> Values:
    """Return `catalogue_load_factor` [1] and `catalogue_life_km` [km], (n,)."""
    loads, c = BearingLoads.of(solved), FIELD.columns(solved.cases["catalogue"])
    factor = loads.radial / c["radial"] + loads.axial / c["axial"] + loads.moment / c["moment"]
    return {
        "catalogue_load_factor": factor,
        "catalogue_life_km": catalogue_km(factor, c["basic_life_km"], c["law"]),
    }


def verdict(solved: SolvedRollers, results: Values) -> Verdict:
    """Return load factor and hours of travel, (n, body); the guide has neither."""
    hours = results["catalogue_life_km"] * 1e3 / (solved.cases["velocity"] * 60.0)
    factor = results["catalogue_load_factor"]
    return Verdict(*(np.stack([value, np.full_like(value, np.nan)], axis=1) for value in (factor, hours)))


FIELD = MappingField(
    "catalogue",
    "limits of a maker's catalogue: {radial: 800, axial: 300, moment: 2000, basic_life_km: 100, law: dry} [N, N, N mm, "
    "km]; law: dry, lubricated or cubic",
    numbers=(
        optional("radial", "", "N", "permissible radial force", 0.0),
        optional("axial", "", "N", "permissible axial force", 0.0),
        optional("moment", "", "N mm", "permissible moment across the axis", 0.0),
        optional("basic_life_km", "BL", "km", "life at a load factor of 1", 0.0),
    ),
    words={"law": LAWS},
)

LIMIT = Limit(
    name="catalogue",
    title="maker's catalogue (load factor)",
    group="bearing",
    evaluate=evaluate,
    verdict=verdict,
    results=variables(
        "bearing",
        ("catalogue_load_factor", (), "1", "LF", "sum of the loads over the limits of the catalogue"),
        ("catalogue_life_km", (), "km", "L_km", "travel that the catalogue allows", LIFE),
    ),
    mappings=(FIELD,),
    requires=("catalogue",),
    beside=True,
    bodies=("roller",),
    compares=("catalogue_load_factor", "load factor of the catalogue"),
)
