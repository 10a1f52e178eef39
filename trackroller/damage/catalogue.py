"""Load factor and kilometres of a maker's catalogue for track rollers."""

from __future__ import annotations

import numpy as np

from trackroller.damage.bearing import BearingLoads
from trackroller.damage.limit import Limit, SolvedRollers, Values, Verdict, optional, variables
from trackroller.damage.mapping import MappingField
from trackroller.numerics.variable import LIFE

LAWS = ("dry", "lubricated", "cubic")
POWERS = {"dry": 2.0, "lubricated": 3.0, "cubic": 3.0}
OFFSETS = {"dry": 0.03, "lubricated": 0.03, "cubic": 0.0}  # unless one is given


def travel_km(
    load_factor: np.ndarray | float,
    basic_life: np.ndarray | float,
    power: float,
    offset: np.ndarray | float = 0.03,
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


def catalogue_km(
    load_factor: np.ndarray, basic_life: np.ndarray, law: np.ndarray, offset: np.ndarray | float = np.nan
) -> np.ndarray:
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
    offset : numpy.ndarray or float
        Load factor that counts without any load [1]; NaN stands for that of the law.

    Returns
    -------
    numpy.ndarray
        Kilometres, (n,); NaN without a law.
    """
    offsets = [np.where(np.isnan(offset), OFFSETS[word], offset) for word in LAWS]
    lives = [travel_km(load_factor, basic_life, POWERS[word], own) for word, own in zip(LAWS, offsets, strict=True)]
    return np.asarray(np.select([law == word for word in LAWS], lives, np.nan))


def evaluate(solved: SolvedRollers) -> Values:
    """Return `catalogue_load_factor` [1] and `catalogue_life_km` [km], (n,)."""
    loads = BearingLoads.of(solved)
    c = FIELD.columns(solved.cases["catalogue"])
    by_moment = np.where(np.isnan(c["moment"]), 0.0, loads.moment / c["moment"])
    factor = loads.radial / c["radial_force"] + loads.axial / c["axial_force"] + by_moment
    law = np.where(c["law"] == "", LAWS[0], c["law"])
    return {
        "catalogue_load_factor": factor,
        "catalogue_life_km": catalogue_km(factor, c["basic_life"], law, c["offset"]),
    }


def verdict(solved: SolvedRollers, results: Values) -> Verdict:
    """Return load factor and hours of travel, (n, body); the guide has neither."""
    hours = results["catalogue_life_km"] * 1e3 / (solved.cases["velocity"] * 60.0)
    factor = results["catalogue_load_factor"]
    return Verdict(*(np.stack([value, np.full_like(value, np.nan)], axis=1) for value in (factor, hours)))


FIELD = MappingField(
    "catalogue",
    "limits of a maker's catalogue: {radial_force: 800, axial_force: 300, basic_life: 100, law: dry} [N, N, km]; "
    "moment [N mm] counts if it is given; law: dry (the default), lubricated or cubic; offset: the load factor that "
    "counts without any load, 0.03 or, if cubic, 0",
    numbers=(
        optional("radial_force", "", "N", "permissible radial force", 0.0),
        optional("axial_force", "", "N", "permissible axial force", 0.0),
        optional("basic_life", "BL", "km", "life at a load factor of 1", 0.0),
        optional("moment", "", "N mm", "permissible moment across the axis", 0.0),
        optional("offset", "", "-", "load factor that counts without any load", 0.0, 1.0, closed=True),
    ),
    words={"law": LAWS},
    may_miss=("moment", "law", "offset"),
    renamed={
        "radial": "radial_force",
        "axial": "axial_force",
        "basic_life_km": "basic_life",
        "lubricated": "law: lubricated, or law: dry",
    },
)

LIMIT = Limit(
    name="catalogue",
    title="maker's catalogue (load factor)",
    short="catalogue",
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
