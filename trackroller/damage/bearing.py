"""The bearing inside the roller: rating life and static safety (ISO 281, ISO 76), and the force of
ring or stud.

Two rows share the loads by statics: the radial force F_rad and the drive force F_Motor act in the
middle between the rows, the moments M_yR and M_zR turn into a couple of row forces.

ASSUME: the row with the larger radial force carries the axial force alone, which is the worst case.
ASSUME: a moment loads a single row as far as its permissible moment, and leaves the rating life as
it is.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from trackroller.damage.limit import Limit, LimitUse, SolvedRollers, Values, optional, variables
from trackroller.damage.mapping import MappingField
from trackroller.errors import InputError
from trackroller.numerics.variable import LIFE

LIFE_EXPONENT = {"ball": 3.0, "roller": 10.0 / 3.0}
# slope of the lives, also of rows that run together
WEIBULL = {"ball": 10.0 / 9.0, "roller": 9.0 / 8.0}


class BearingLoads(NamedTuple):
    """Loads on the bearing: radial force along and across the track normal [N], axial force [N],
    moments [N mm], (n,).

    `pressing` is F_rad and `driving` F_Motor; `tilting` is M_yR and `yawing` M_zR.
    """

    pressing: np.ndarray
    driving: np.ndarray
    axial: np.ndarray
    tilting: np.ndarray
    yawing: np.ndarray

    @classmethod
    def of(cls, solved: SolvedRollers) -> BearingLoads:
        """Return the loads of solved rollers."""
        c = solved.cases
        v = solved.values
        forces = c["radial_force"], c["motor_force"], np.abs(c["axial_force"])
        return cls(*forces, v["tilting_moment"], v["yaw_moment"])

    @property
    def radial(self) -> np.ndarray:
        """Return the radial force [N]."""
        return np.asarray(np.hypot(self.pressing, self.driving))

    @property
    def moment(self) -> np.ndarray:
        """Return the moment across the axis [N mm]."""
        return np.asarray(np.hypot(self.tilting, self.yawing))


def row_forces(
    loads: BearingLoads, rows: np.ndarray, distance: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the radial and axial force of each row.

    Parameters
    ----------
    loads : BearingLoads
        Loads of n bearings.
    rows : numpy.ndarray
        1 or 2, (n,).
    distance : numpy.ndarray
        Distance of two rows, (n,) [mm].

    Returns
    -------
    tuple of numpy.ndarray
        F_r and F_a of each row, (n, 2) [N]; NaN for the second row of a bearing with one.
    """
    side = np.array([1.0, -1.0])
    with np.errstate(divide="ignore", invalid="ignore"):
        pressing = loads.pressing[:, None] / 2 + side * (loads.tilting / distance)[:, None]
        driving = loads.driving[:, None] / 2 - side * (loads.yawing / distance)[:, None]
    radial = np.hypot(pressing, driving)
    axial = np.where(np.argmax(radial, axis=1)[:, None] == np.arange(2), loads.axial[:, None], 0.0)
    single = (rows == 1)[:, None]
    alone = np.array([1.0, np.nan])
    return np.where(single, alone * loads.radial[:, None], radial), np.where(
        single, alone * loads.axial[:, None], axial
    )


def equivalent(
    radial: np.ndarray, axial: np.ndarray, given: dict[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the equivalent loads P = X F_r + Y F_a (F_r up to F_a/F_r = e) and P_0 = max(X_0 F_r +
    Y_0 F_a, F_r) [N].

    `given` holds e, X, Y, X0 and Y0 of the bearings, of shapes that broadcast with the forces [1].
    """
    p = np.where(axial <= given["e"] * radial, radial, given["X"] * radial + given["Y"] * axial)
    return p, np.maximum(given["X0"] * radial + given["Y0"] * axial, radial)


def rating_life(load: np.ndarray, rating: np.ndarray, kind: np.ndarray) -> np.ndarray:
    """Return the basic rating life L10 of bearings whose rows run together [million turns].

    Parameters
    ----------
    load : numpy.ndarray
        Equivalent load P of each row, (n, rows) [N]; NaN for a row that is not there.
    rating : numpy.ndarray
        Dynamic rating C of a row, (n,) [N].
    kind : numpy.ndarray of str
        "ball" or "roller", (n,).

    Returns
    -------
    numpy.ndarray
        (sum over rows of (C/P)^(-p e))^(-1/e), (n,), with p = 3 and e = 10/9 of ball bearings, 10/3
        and 9/8 of others.
    """
    p, e = (
        np.array([table.get(str(word), np.nan) for word in kind])[:, None]
        for table in (LIFE_EXPONENT, WEIBULL)
    )
    with np.errstate(divide="ignore"):
        total = np.nansum((load / rating[:, None]) ** (p * e), axis=1)
        return np.where(np.isnan(load).all(axis=1), np.nan, total ** (-1.0 / e[:, 0]))


def life_at(life: np.ndarray, probability: float, slope: np.ndarray) -> np.ndarray:
    """Return the life at a failure probability from L10, by Weibull: L10 (ln(1 - F)/ln
    0.9)^(1/slope).
    """
    return np.asarray(life * (np.log1p(-probability) / np.log(0.9)) ** (1.0 / slope))


def evaluate(solved: SolvedRollers) -> Values:
    """Return `bearing_life_hours` (L10) [h], `bearing_static_safety` and `bearing_utilisation` [1],
    (n,).
    """
    loads = BearingLoads.of(solved)
    b = FIELD.columns(solved.cases["bearing"])
    each = {name: b[name][:, None] for name in ("e", "X", "Y", "X0", "Y0")}
    dynamic, static = equivalent(*row_forces(loads, b["rows"], b["row_distance"]), each)
    hours = (
        1e6
        * rating_life(dynamic, b["dynamic_rating"], b["kind"])
        / solved.overrollings_per_hour[:, 0]
    )
    with np.errstate(divide="ignore"):
        safety = b["static_rating"] / np.fmax.reduce(static, axis=1)
        shares = 1.0 / safety, loads.moment / b["permissible_moment"]
    of_ring = loads.radial / solved.cases["permissible_radial_force"]
    return {
        "bearing_life_hours": hours,
        "bearing_static_safety": safety,
        "bearing_utilisation": np.fmax.reduce([*shares, of_ring]),
    }


def limit_use(solved: SolvedRollers, results: Values) -> LimitUse:
    """Return the utilisation, and the hours at the failure probability, (n, body); the guide has
    neither.
    """
    slope = np.array(
        [WEIBULL.get(str(kind), np.nan) for kind in FIELD.columns(solved.cases["bearing"])["kind"]]
    )
    hours = life_at(results["bearing_life_hours"], solved.options["failure_probability"], slope)
    return LimitUse(
        *(
            np.stack([v, np.full_like(v, np.nan)], axis=1)
            for v in (results["bearing_utilisation"], hours)
        )
    )


def check(given: dict[str, Any]) -> None:
    """Refuse a number of rows other than 1 or 2, and rows without the value that carries a
    moment.
    """
    if given["rows"] not in (1, 2):
        raise InputError("bearing.rows", given["rows"], "1 or 2")
    carries = "row_distance"
    if given["rows"] == 1:
        carries = "permissible_moment"
    if carries not in given:
        wrong = f"lacks {carries}, because the roller loads it with moments"
        raise InputError(
            "bearing", given, "", f"Add {carries}, or take another number of rows.", wrong
        )


FIELD = MappingField(
    "bearing",
    "bearing inside the roller, with the ratings of one row: {rows: 2, row_distance: 8, "
    "kind: ball, dynamic_rating: "
    "3000, static_rating: 1500, e: 0.3, X: 0.56, Y: 1.5, X0: 0.6, Y0: 0.5}; one row needs "
    "permissible_moment [N mm]",
    words={"kind": ("ball", "roller")},
    numbers=(
        optional("rows", "", "-", "number of rows, 1 or 2", 1.0, 2.0, closed=True),
        optional("row_distance", "", "mm", "distance of the rows", 0.0),
        optional("dynamic_rating", "C", "N", "dynamic load rating of a row", 0.0),
        optional("static_rating", "C_0", "N", "static load rating of a row", 0.0),
        optional("e", "e", "-", "F_a/F_r up to which P = F_r", 0.0, closed=True),
        optional("X", "X", "-", "radial factor of P", 0.0, closed=True),
        optional("Y", "Y", "-", "axial factor of P", 0.0, closed=True),
        optional("X0", "X_0", "-", "radial factor of P_0", 0.0, closed=True),
        optional("Y0", "Y_0", "-", "axial factor of P_0", 0.0, closed=True),
        optional("permissible_moment", "M_zul", "N mm", "permissible moment", 0.0),
    ),
    may_miss=("row_distance", "permissible_moment"),
    check=check,
)

LIMIT = Limit(
    name="bearing",
    title="bearing inside the roller, ring or stud",
    short="bearing",
    group="bearing",
    meaning="rating life and static safety of the bearing inside, and utilisation by a maker's "
    "catalogue",
    evaluate=evaluate,
    use=limit_use,
    results=variables(
        "bearing",
        (
            "bearing_life_hours",
            (),
            "h",
            "L_10h",
            "basic rating life of the bearing inside (10 % failed)",
            LIFE,
        ),
        ("bearing_static_safety", (), "1", "C_0/P_0", "static safety of the bearing inside"),
        (
            "bearing_utilisation",
            (),
            "1",
            "",
            "largest of P_0/C_0, moment and radial force over what is permissible",
        ),
    ),
    parameters=(
        optional(
            "permissible_radial_force",
            "F_r,zul",
            "N",
            "permissible radial force of ring or stud",
            0.0,
        ),
    ),
    mappings=(FIELD,),
    requires=("bearing",),
    bodies=("roller",),
    distribution="Weibull 10/9 (ball) or 9/8 (roller)",
    compares=("bearing_utilisation", "permissible load"),
    standard="ISO 281 and ISO 76",
    assumes=(
        "Bearing inside: the row with the larger radial force carries the axial force alone.",
    ),
)
