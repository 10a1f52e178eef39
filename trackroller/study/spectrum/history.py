"""Make a load spectrum of a log: a history of loads over time or distance becomes blocks of travel
at a load.

Each revolution of a roller at a load is one overrolling of its track, whatever the load was before.
Counting therefore sums the travel at each level. Rainflow counting pairs the turning points of a
stress that a material feels between overrollings; a rolling contact unloads completely in each
revolution, so that no such pairs exist.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.errors import InputError
from trackroller.numerics.numbers import number_or_nan
from trackroller.parameters.example import EXAMPLE
from trackroller.roller.aliases import renamed
from trackroller.roller.log_answers import answers_of
from trackroller.roller.settings import parts_for_spectrum
from trackroller.study.spectrum.log import read_log
from trackroller.study.spectrum.log_doubts import Doubt, few_lines

NO_RAINFLOW = (
    "Blocks hold the travel at each level of load: each revolution is one overrolling. "
    "Rainflow counting pairs turning "
    "points between overrollings and does not apply."
)
# of the contact force to which damage may grow; an S-N curve of exponent 9 gives 3
POWERS = (1.0, 3.0, 7.0)
# of the damage of each contact for each power; solved with `sliding` it stays below 1 %
TOLERANCE = 0.007
MOST_BLOCKS = 2000
MOST_POINTS = 200_000  # lines of a log whose levels are found one by one
FINE = 1_000  # parts of the range of a force, within which the lines of a longer log count as one


def spectrum_of_log(
    path: Path | str, roller: Mapping[str, Any]
) -> tuple[dict[str, Any], list[str]]:
    """Return the load spectrum of a log, as the keys of a spectrum file, and what a user must know
    of the log.

    Parameters
    ----------
    path : pathlib.Path or str
        CSV file or workbook with a column `time` or `distance`, `radial_force`, and where they vary
        `axial_force` and `velocity` or `speed`; heads may have units.
    roller : mapping
        Fields and options of the roller's case file. Its `velocity` holds where the log has none.

    Raises
    ------
    InputError
        If a column is missing, a cell is no number, or time does not increase; the error names file
        and line.
    """
    path = Path(path)
    given = renamed(roller)
    answers = answers_of(given)
    log = read_log(
        path, float(number_or_nan(given.get("velocity", EXAMPLE.get("velocity")), "m/min")), answers
    )
    angle = math.radians(
        float(number_or_nan(given.get("contact_angle", EXAMPLE["contact_angle"]), "deg"))
    )
    pressed = (log.radial < 0) & (log.travel > 0)
    if not pressed.any():
        raise InputError(
            "radial_force",
            None,
            "a line below 0, in which the roller is pressed on the guide and moves",
        )
    share = float(log.travel[~pressed].sum() / log.travel.sum())
    if share > 0:
        log.doubts.append(Doubt("unpressed", values={"share": 100 * share}))
    loads = np.column_stack([log.radial, log.axial])[pressed]
    weights = log.travel[pressed]
    tangent = math.tan(angle)
    _doubt_loads(loads, weights, log.lines[pressed], tangent, log.doubts)
    blocks = _blocks(*_merged(loads, weights, log.hours[pressed], tangent), tangent)
    fields, options = parts_for_spectrum(roller)
    if any("velocity" in block for block in blocks):
        fields.pop("velocity", None)
    duty = {}
    if "duty" in given:
        duty = {"duty": given["duty"]}
    if len(blocks) == 1:
        levels_ = "1 level of load"
    else:
        levels_ = f"{len(blocks)} levels of load"
    whole = {"lines": len(log.travel), "file": path.name, "levels": levels_}
    whole |= {"km": float(log.travel.sum() / 1e3), "hours": float(log.hours.sum())}
    log.doubts.insert(0, Doubt("lines", values=whole))
    head = {"name": path.stem, "description": " ".join([*log.notes, NO_RAINFLOW])}
    record = {"log": {"file": path.name, "doubts": [doubt.record for doubt in log.doubts[1:]]}}
    return head | {"base": fields, "blocks": blocks} | duty | options | record, log.notes


def _blocks(
    loads: np.ndarray, weights: np.ndarray, hours: np.ndarray, tangent: float
) -> list[dict[str, Any]]:
    """Return the blocks of a spectrum, one for each level of load."""
    blocks = []
    for own in levels(loads, weights, tangent):
        radial, axial = np.average(loads[own], axis=0, weights=weights[own])
        block: dict[str, Any] = {
            "distance": float(weights[own].sum()),
            "radial_force": radial,
            "axial_force": axial,
        }
        time = float(hours[own].sum())
        if time > 0:
            block["velocity"] = block["distance"] / time / 60
        blocks.append(block)
    blocks.sort(key=lambda block: block["radial_force"])
    rounded = [{key: float(f"{value:.8g}") for key, value in block.items()} for block in blocks]
    return [{"name": f"level {i}"} | block for i, block in enumerate(rounded, start=1)]


def _merged(
    loads: np.ndarray, weights: np.ndarray, hours: np.ndarray, tangent: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return loads, travel and hours in which lines of nearly the same loads count as one, with
    their mean load.

    A short log is returned as it is. Lines with and without lift-off stay apart.
    """
    if len(weights) <= MOST_POINTS:
        return loads, weights, hours
    spread = np.maximum(np.ptp(loads, axis=0), 1e-300)
    parts = np.minimum((loads - loads.min(axis=0)) / spread * FINE, FINE - 1).astype(np.int64)
    lifted = _lifted(loads, tangent)
    keys = (parts[:, 0] * FINE + parts[:, 1]) * 2 + lifted
    different, own = np.unique(keys, return_inverse=True)

    def summed(values: np.ndarray) -> np.ndarray:
        return np.bincount(own, weights=values, minlength=different.size)

    whole = summed(weights)
    means = np.column_stack([summed(weights * loads[:, i]) / whole for i in range(2)])
    return means, whole, summed(hours)


def _lifted(loads: np.ndarray, tangent: float) -> np.ndarray:
    """Return the lines in which the axial force lifts a contact off, without friction."""
    return np.asarray(np.abs(loads[:, 1]) >= -loads[:, 0] * tangent)


def _doubt_loads(
    loads: np.ndarray, weights: np.ndarray, lines: np.ndarray, tangent: float, doubts: list[Doubt]
) -> None:
    """Add the doubts about lift-off, and about few lines that carry the life alone."""
    share = float(weights[_lifted(loads, tangent)].sum() / weights.sum())
    if share > 0:
        doubts.append(Doubt("lift_off", values={"share": 100 * share}))
    contact = -loads[:, 0] + np.abs(loads[:, 1]) / tangent
    power = POWERS[1]
    damage = f"the sum of travel times load to the power of {power:g}, to which damage may grow"
    doubts += few_lines(weights, lines, "the travel") or few_lines(
        weights * contact**power, lines, damage
    )


def levels(loads: np.ndarray, weights: np.ndarray, tangent: float) -> list[np.ndarray]:
    """Return the levels of a history: the lines of each level, whose mean load stands for them.

    Parameters
    ----------
    loads : numpy.ndarray, shape (n, 2)
        Radial and axial force [N].
    weights : numpy.ndarray, shape (n,)
        Travel at each of them [m].
    tangent : float
        Tangent of the contact angle [1].

    Notes
    -----
    The contacts of a wedge without friction carry forces in the ratio of -F_rad +- F_ax/tan(alpha).
    Lines in which one of them lifts off have levels of their own. The level that changes the sum of
    their powers most is halved, until no power in `POWERS` changes by more than `TOLERANCE`.
    """
    axial = loads[:, 1] / tangent
    contacts = np.maximum(np.column_stack([-loads[:, 0] - axial, -loads[:, 0] + axial]), 0.0)
    contacts = contacts / contacts.max()
    effects = np.concatenate([contacts**power for power in POWERS], axis=1)
    total = np.maximum(weights @ effects, 1e-300)

    def error(own: np.ndarray) -> np.ndarray:
        """Return by how much the mean load of a level changes each sum."""
        mean = np.average(contacts[own], axis=0, weights=weights[own])
        single = np.concatenate([mean**power for power in POWERS])
        return np.asarray(np.abs(weights[own] @ effects[own] - weights[own].sum() * single) / total)

    # a mean of lines with and without lift-off stands for neither
    lifted = contacts.min(axis=1) <= 0
    whole = [own for own in (np.flatnonzero(~lifted), np.flatnonzero(lifted)) if own.size]
    errors = [error(own) for own in whole]
    while np.max(np.sum(errors, axis=0)) > TOLERANCE and len(whole) < MOST_BLOCKS:
        i = int(np.argmax([one.max() for one in errors]))
        own = whole.pop(i)
        errors.pop(i)
        across = int(np.argmax(np.ptp(contacts[own], axis=0)))
        values = contacts[own, across]
        middle = (values.min() + values.max()) / 2
        for part in (own[values <= middle], own[values > middle]):
            whole.append(part)
            errors.append(error(part))
    return whole
