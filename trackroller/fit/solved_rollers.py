"""Rollers as the model solves them for a fit, and the options under which the values of a fit
hold.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from trackroller.damage.limit import roller_overrollings
from trackroller.damage.wear import KM_PER_HOUR
from trackroller.errors import InputError
from trackroller.parameters import BODIES, REGIMES
from trackroller.roller.case import FIELDS, Case
from trackroller.roller.geometry import rolling_radius
from trackroller.roller.settings import checked_case
from trackroller.roller.solver import solve

DEFAULTS = {"contact_model": "kalker", "life_criterion": "von_mises_peak", "accuracy": "standard"}


@dataclass(frozen=True)
class Solved:
    """What the model says of rollers, arrays of shape (n, contact, body).

    Attributes
    ----------
    stress : numpy.ndarray
        Stress that enters the S-N line [MPa].
    pressure : numpy.ndarray
        Largest contact pressure, which enters the line of pressure [MPa].
    per_km : numpy.ndarray
        Overrollings of a travel of 1 km [1/km].
    per_hour : numpy.ndarray
        Overrollings of an hour [1/h].
    regime : list of str
        Regime of each roller, (n,).
    flags : numpy.ndarray
        Validity flags of each body, (n, body).
    """

    stress: np.ndarray
    pressure: np.ndarray
    per_km: np.ndarray
    per_hour: np.ndarray
    regime: list[str]
    flags: np.ndarray


def check_same(given: Mapping[str, str], options: Mapping[str, Any], name: str) -> None:
    """Refuse options under which values of a fit do not hold.

    Parameters
    ----------
    given : mapping of str to str
        Contact model, life criterion and accuracy of the fit; others do not count.
    options : mapping
        Options of the solution that would use the values.
    name : str
        Name of the fit, for the message.

    Raises
    ------
    InputError
        If one of them differs.
    """
    for key, default in DEFAULTS.items():
        used = str(options.get(key, default))
        if key in given and used != given[key]:
            remedy = f"Set {key}: {given[key]}, or fit the tests anew with {used}."
            wrong = f"differs from the {given[key]} of '{name}', whose values hold for it alone"
            raise InputError(key, used, "", remedy, wrong)


def solved_rollers(cases: Sequence[Case], options: Mapping[str, Any]) -> Solved:
    """Solve rollers, and return what a life by any S-N line needs.

    Parameters
    ----------
    cases : sequence of Case
        The rollers.
    options : mapping
        Options of `trackroller.solve` beside the outputs.
    """
    groups = ["forces", "contact", "peak_stress", "life"]
    if options.get("life_criterion", "von_mises_peak") != "von_mises_peak":
        groups.append("multiaxial")
    ds = solve(list(cases), **{**options, "outputs": groups})
    regime = [REGIMES[int(i)] for i in np.atleast_1d(ds["regime"].values)]
    if "fatigue_stress" in ds:
        stress = ds["fatigue_stress"]
    else:
        stress = ds["peak_stress"]
    radius = np.array([_rolling_radius(case) for case in cases])
    velocity = np.array([case.velocity for case in cases])
    guide = np.array([case.guide_overrollings_per_hour or math.nan for case in cases])
    per_hour = np.stack([roller_overrollings(velocity, radius), guide], axis=1)[:, None, :]
    per_km = per_hour / (KM_PER_HOUR * velocity)[:, None, None]
    shape = (len(cases), 2, 2)
    stresses = stress.transpose("case", "contact", "body").values
    flags = ds["validity_body"].transpose("case", "body").values.astype(int)
    pressure = ds["max_pressure"].transpose("case", "contact").values[:, :, None]
    return Solved(
        stresses,
        np.broadcast_to(pressure, shape),
        np.broadcast_to(per_km, shape),
        np.broadcast_to(per_hour, shape),
        regime,
        flags,
    )


def fields_of(design: Any, field: str = "design") -> dict[str, Any]:
    """Return the fields of a case, or of a mapping of fields and options; refuse other values."""
    if isinstance(design, Case):
        return {name: getattr(design, name) for name in FIELDS}
    if not isinstance(design, Mapping):
        remedy = "Write tr.Case(...), or a mapping such as {'radial_force': -150}."
        raise InputError(
            field, design, "a case, or a mapping with fields of a case and options", remedy
        )
    return dict(design)


def worst_load(
    design: Any, given: Mapping[str, str], name: str, by_pressure: bool = False
) -> tuple[float, float]:
    """Return the stress or the pressure of a design that decides its life [MPa], and its
    overrollings per hour [1/h].

    Parameters
    ----------
    design : Case or mapping
        Fields of the case and options.
    given : mapping of str to str
        Under what a fit holds, see `check_same`.
    name : str
        Name of the fit, for messages.
    by_pressure : bool
        Whether the life follows from the largest pressure; otherwise from the stress.
    """
    case, options, _ = checked_case(fields_of(design))
    check_same(given, options, name)
    solved = solved_rollers(
        [case], {key: value for key, value in options.items() if key != "outputs"}
    )
    body = BODIES.index(given.get("body", "roller"))
    if solved.regime[0] != "rolling":
        raise InputError("design", solved.regime[0], "a roller that rolls", "Change its loads.")
    if np.isnan(solved.per_hour[0, 0, body]):
        raise InputError(
            "guide_overrollings_per_hour", None, "a number, for the life of the guide in hours"
        )
    if by_pressure:
        load = solved.pressure
    else:
        load = solved.stress
    return float(load[0, :, body].max()), float(solved.per_hour[0, 0, body])


def _rolling_radius(case: Case) -> float:
    return float(
        rolling_radius(
            case.axis_distance, case.guide_profile_radius, np.radians(case.contact_angle)
        )
    )
