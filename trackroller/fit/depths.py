"""Fit a wear coefficient to repeated depths of one groove over the travel, by the followed
profile.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from trackroller.errors import InputError, check_names
from trackroller.fit.bench import DEEPEST, check_base, not_given_notes, wear_group, worn_alone
from trackroller.fit.material_fit import MaterialFit, check_texts
from trackroller.fit.solved_rollers import DEFAULTS
from trackroller.fit.table import LEAST, TestTable, read_tests
from trackroller.parameters import BODIES
from trackroller.roller.settings import checked_case
from trackroller.roller.wear import wear

NEEDED = ("travel", "wear_depth")
COLUMNS = (*NEEDED, "test", "note")
REACHED = 1e-3  # share of a depth by which the last state may fall short of it
FARTHEST = 1e9  # km, how far a groove is followed until its depth is reached


def fit_wear(
    table: Any,
    base: Mapping[str, Any] | None = None,
    *,
    body: str = "roller",
    name: str = "",
    like: str | None = None,
) -> MaterialFit:
    """Fit the wear coefficient of a body to depths of one groove that were measured over its
    travel.

    Parameters
    ----------
    table : path, data frame, list of mappings or mapping of columns
        Columns `travel [km]` and `wear_depth [mm]`, one measurement a row, of the same groove.
    base : mapping, optional
        Fields of the case and options of `trackroller.wear`; the paper's example without it.
    body : str
        The body that wears, "roller" or "guide".
    name : str
        Name of the material that is made.
    like : str, optional
        Material whose other values the fitted one takes; by default that of the body.

    Returns
    -------
    MaterialFit
        With `wear_coefficient` and its interval.

    Raises
    ------
    InputError
        For depths that fall with the travel, or a case that cannot be followed.

    Notes
    -----
    The profile is followed once with a unit coefficient, which takes minutes. The travel to a depth
    is inversely proportional to the coefficient.

    ASSUME: the other body keeps its profile, and errors of the depths are independent of each
    other.
    """
    check_names("body", [body], BODIES)
    check_texts(name=name, like=like)
    check_base(base)
    rows = read_tests(table, NEEDED, COLUMNS, ("test", "note"))
    travel = np.array([rows.number(row, "travel", LEAST, FARTHEST) for row in rows])
    depth = np.array([rows.number(row, "wear_depth", LEAST, DEEPEST) for row in rows])
    _check_depths(rows, travel, depth)
    case, options, _ = checked_case(dict(base or {}))
    unit = followed(worn_alone(case, body), options, body, depth)
    for row in np.flatnonzero(np.isnan(unit)).tolist():
        allowed = (
            "a depth that the followed profile reaches before it has worn through or lifted off"
        )
        raise rows.error(row, "wear_depth", allowed, "Check the unit: it is mm.")
    observed = np.log(travel / unit)
    group = wear_group(observed, observed, tuple(rows))
    given = {
        key: str(options.get(key, default))
        for key, default in DEFAULTS.items()
        if key != "life_criterion"
    }
    notes = [f"The profile of the {body} was followed; the other body kept its profile."]
    material: Any = case.guide_material
    if body == "roller":
        material = case.roller_material
    base_name = getattr(material, "name", "material")
    if isinstance(material, str):
        base_name = material
    given |= {"body": body}
    not_given = not_given_notes([case])
    return MaterialFit(
        "wear",
        name or f"{base_name} worn",
        (group,),
        rows,
        like or base_name,
        given,
        notes,
        not_given,
    )


def _check_depths(rows: TestTable, travel: np.ndarray, depth: np.ndarray) -> None:
    """Refuse empty cells, depths that fall with the travel, and fewer than two measurements.

    `travel` [km] and `depth` [mm] have one value a row.
    """
    for row, (km, mm) in enumerate(zip(travel, depth, strict=True)):
        for column, value in zip(NEEDED, (km, mm), strict=True):
            if math.isnan(value):
                raise rows.error(
                    row, column, "a number; the cell is empty", "Fill the cell, or remove the row."
                )
        deeper = [other for other in range(row) if travel[other] < km and depth[other] > mm]
        if deeper:
            allowed = f"a depth of at least that after less travel, {depth[deeper[0]]:g} mm"
            raise rows.error(
                row, "wear_depth", allowed, "Measure one groove only, and correct the row."
            )
        if any(travel[other] == km for other in range(row)):
            remedy = "Write the mean of the two depths once."
            raise rows.error(
                row, "travel", "each travel once", remedy, "stands in another row as well"
            )
    if len(rows) < 2:
        allowed = "two depths or more, for a coefficient with its scatter"
        raise rows.placed(InputError("tests", len(rows), allowed, "Measure the groove once more."))


def followed(
    values: Mapping[str, Any], options: Mapping[str, Any], body: str, depths: np.ndarray
) -> np.ndarray:
    """Return the travels at which a groove that is followed reaches depths [mm], of the same shape
    [km].

    Parameters
    ----------
    values : mapping
        Fields of the case.
    options : mapping
        Options of `trackroller.wear`.
    body : str
        The body that wears.
    depths : numpy.ndarray
        Depths [mm].

    Returns
    -------
    numpy.ndarray
        NaN for a depth that the profile does not reach.
    """
    settings = {
        name: value
        for name, value in options.items()
        if name not in ("normal", "outputs", "life_criterion")
    }
    case = {**values, "permissible_wear_depth": 1.001 * float(depths.max())}
    ds = wear(case, f"{FARTHEST:g}km", outputs=("forces",), **settings)
    deep = ds["groove_depth"].sel(body=body).max("contact").values
    travel = ds["travel"].values
    grown = deep > 0
    # the depth grows as a power of the travel, so that logarithms are interpolated; the first part
    # is a straight line
    known_depth = np.log(deep[grown])
    known_travel = np.log(travel[grown])
    before = np.minimum(np.log(depths) - known_depth[0], 0.0)
    travels = np.exp(np.interp(np.log(depths), known_depth, known_travel) + before)
    return np.where(depths > (1.0 + REACHED) * deep.max(), np.nan, travels)
