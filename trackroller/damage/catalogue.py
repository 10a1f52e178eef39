"""Load factor and kilometres of a maker's catalogue for track rollers.

Makers state one family of rules: a basic life over a power of the load factor, with factors for
speed and stroke. HepcoMotion PRT2 has BL/(0.03 + 0.97 LF)^2 for dry and ^3 for lubricated rollers,
Bishop-Wisecarver DualVee LC/LF^3 times a factor for speed and surroundings, and Rollon Compact Rail
100 km (C/P f_h)^3 with a factor f_h for short strokes, of the load.
"""

from __future__ import annotations

import numpy as np

from trackroller.damage.bearing import BearingLoads
from trackroller.damage.limit import Limit, LimitUse, SolvedRollers, Values, optional, variables
from trackroller.damage.mapping import MappingField
from trackroller.numerics.variable import LIFE

LAWS = ("dry", "lubricated", "cubic", "square")
# unless one is given
POWERS = {"dry": 2.0, "lubricated": 3.0, "cubic": 3.0, "square": 2.0}
OFFSETS = {"dry": 0.03, "lubricated": 0.03, "cubic": 0.0, "square": 0.0}


def travel_km(
    load_factor: np.ndarray | float,
    basic_life: np.ndarray | float,
    power: np.ndarray | float,
    offset: np.ndarray | float = 0.03,
) -> np.ndarray:
    """Return the kilometres that a load factor LF allows, BL/(c + (1 - c) LF)^power.

    Parameters
    ----------
    load_factor : numpy.ndarray or float
        Sum of the loads over their limits [1].
    basic_life : numpy.ndarray or float
        Kilometres BL at a load factor of 1 [km].
    power : numpy.ndarray or float
        Exponent [1]: 2 for dry and 3 for lubricated rollers.
    offset : float
        Load factor c that counts without any load [1]; 0 gives BL/LF^power.

    Returns
    -------
    numpy.ndarray
        Kilometres, inf without any load.
    """
    with np.errstate(divide="ignore"):
        return np.asarray(
            basic_life * (offset + (1.0 - offset) * np.asarray(load_factor)) ** -power
        )


def catalogue_km(
    load_factor: np.ndarray,
    basic_life: np.ndarray,
    law: np.ndarray,
    offset: np.ndarray | float = np.nan,
    exponent: np.ndarray | float = np.nan,
    speed_factor: np.ndarray | float = np.nan,
) -> np.ndarray:
    """Return the kilometres that a load factor allows.

    Parameters
    ----------
    load_factor : numpy.ndarray
        Sum of the loads over their limits, (n,) [1].
    basic_life : numpy.ndarray
        Kilometres at a load factor of 1, (n,) [km].
    law : numpy.ndarray of str
        "dry": BL/(0.03 + 0.97 LF)^2, "lubricated": the same with exponent 3 (a maker's laws from
        tests), "cubic": BL/LF^3, or "square": BL/LF^2, (n,).
    offset : numpy.ndarray or float
        Load factor that counts without any load [1]; NaN stands for that of the law.
    exponent : numpy.ndarray or float
        Exponent of the life [1]; NaN stands for that of the law.
    speed_factor : numpy.ndarray or float
        Factor of the life [1]; NaN stands for 1.

    Returns
    -------
    numpy.ndarray
        Kilometres, (n,); NaN without a law.
    """
    known = [law == word for word in LAWS]
    powers = np.select(known, list(POWERS.values()), np.nan)
    offsets = np.select(known, list(OFFSETS.values()), np.nan)
    own_power = np.where(np.isnan(exponent), powers, exponent)
    own_offset = np.where(np.isnan(offset), offsets, offset)
    life = travel_km(load_factor, basic_life, own_power, own_offset)
    life = np.where(np.any(known, axis=0), life, np.nan)
    return np.asarray(life * np.where(np.isnan(speed_factor), 1.0, speed_factor))


def apply_stroke_factor(
    ratios: np.ndarray, stroke_factor: np.ndarray | float = np.nan
) -> np.ndarray:
    """Return the load factor LF of limits with a factor for the stroke.

    Parameters
    ----------
    ratios : numpy.ndarray
        Sum of the loads over their limits [1].
    stroke_factor : numpy.ndarray or float
        Factor of the limits, such as that for short strokes [1]; NaN stands for 1.
    """
    return np.asarray(ratios / np.where(np.isnan(stroke_factor), 1.0, stroke_factor))


def evaluate(solved: SolvedRollers) -> Values:
    """Return `catalogue_load_factor` [1] and `catalogue_life_km` [km], (n,)."""
    loads = BearingLoads.of(solved)
    c = FIELD.columns(solved.cases["catalogue"])
    by_moment = np.where(np.isnan(c["moment"]), 0.0, loads.moment / c["moment"])
    ratios = loads.radial / c["radial_force"] + loads.axial / c["axial_force"] + by_moment
    factor = apply_stroke_factor(ratios, c["stroke_factor"])
    law = np.where(c["law"] == "", LAWS[0], c["law"])
    life = catalogue_km(factor, c["basic_life"], law, c["offset"], c["exponent"], c["speed_factor"])
    return {"catalogue_load_factor": factor, "catalogue_life_km": life}


def limit_use(solved: SolvedRollers, results: Values) -> LimitUse:
    """Return load factor and hours of travel, (n, body); the guide has neither."""
    hours = results["catalogue_life_km"] * 1e3 / (solved.cases["velocity"] * 60.0)
    factor = results["catalogue_load_factor"]
    return LimitUse(
        *(np.stack([value, np.full_like(value, np.nan)], axis=1) for value in (factor, hours))
    )


FIELD = MappingField(
    "catalogue",
    "limits of a maker's catalogue: {radial_force: 800, axial_force: 300, basic_life: 100, "
    "law: dry} [N, N, km]; "
    "moment [N mm] counts if it is given; law: dry (the default), lubricated, cubic or square; "
    "offset: the load factor that "
    "counts without any load, 0.03 or, if cubic or square, 0; exponent: that of the life, in place "
    "of that of the law; speed_factor: factor of the life for speed and surroundings; "
    "stroke_factor: factor of the permissible loads for short strokes",
    numbers=(
        optional("radial_force", "", "N", "permissible radial force", 0.0),
        optional("axial_force", "", "N", "permissible axial force", 0.0),
        optional("basic_life", "BL", "km", "life at a load factor of 1", 0.0),
        optional("moment", "", "N mm", "permissible moment across the axis", 0.0),
        optional(
            "offset", "", "-", "load factor that counts without any load", 0.0, 1.0, closed=True
        ),
        optional("exponent", "", "-", "exponent of the life on the load factor", 0.5, 20.0, True),
        optional("speed_factor", "", "-", "factor of the life for speed", 0.0, 100.0),
        optional("stroke_factor", "", "-", "factor of the limits for short strokes", 0.0, 100.0),
    ),
    words={"law": LAWS},
    may_miss=("moment", "law", "offset", "exponent", "speed_factor", "stroke_factor"),
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
    use=limit_use,
    results=variables(
        "bearing",
        (
            "catalogue_load_factor",
            (),
            "1",
            "LF",
            "sum of the loads over the limits of the catalogue",
        ),
        ("catalogue_life_km", (), "km", "L_km", "travel that the catalogue allows", LIFE),
    ),
    mappings=(FIELD,),
    requires=("catalogue",),
    beside=True,
    bodies=("roller",),
    compares=("catalogue_load_factor", "load factor of the catalogue"),
)
