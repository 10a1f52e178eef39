"""Make a load spectrum of a log: a history of loads over time or distance becomes blocks of travel at a load.

Each revolution of a roller at a load is one overrolling of its track, whatever the load was before. Counting therefore
sums the travel at each level. Rainflow counting pairs the turning points of a stress that a material feels between
overrollings; a rolling contact unloads completely in each revolution, so that no such pairs exist.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.errors import Collector, InputError, listing
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.units import split_quantity
from trackroller.parameters.example import EXAMPLE
from trackroller.roller.aliases import renamed
from trackroller.roller.settings import LOADS, parts_for_spectrum
from trackroller.study.file.user_table import UserTable, read_table

COLUMNS = {"time": "s", "distance": "m", "radial_force": "N", "axial_force": "N", "velocity": "m/min", "speed": "m/s"}
NO_RAINFLOW = (
    "Blocks hold the travel at each level of load: each revolution is one overrolling. Rainflow counting pairs turning "
    "points between overrollings and does not apply."
)
POWERS = (1.0, 3.0, 7.0)  # of the contact force to which damage may grow; an S-N curve of exponent 9 gives 3
TOLERANCE = 0.007  # of the damage of each contact for each power; solved with `sliding` it stays below 1 %
MOST_BLOCKS = 2000
GAP = 5.0  # times the usual step of time, or of distance
SPIKE = 12.0  # times the usual change from line to line, there and back
DRIFT = 0.25  # of the spread of a force: a change of its median from the first to the last fifth
MOSTLY = 0.5  # of the lines: radial forces above 0 in more of them have another sign convention
SMALL = 1.0  # N: a force that stays below is more likely in kN


@dataclass
class Log:
    """A history of loads: travel [m], hours [h] and both forces [N] of each line, and what is told of it.

    `travel` and `hours` are those of the time during which a line holds, half of the step before and of the step after.
    """

    travel: np.ndarray
    hours: np.ndarray
    radial: np.ndarray
    axial: np.ndarray
    notes: list[str] = field(default_factory=list)


def spectrum_of_log(path: Path | str, roller: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return the load spectrum of a log, as the keys of a spectrum file, and what a user must know of the log.

    Parameters
    ----------
    path : pathlib.Path or str
        CSV file or workbook with a column `time` or `distance`, `radial_force`, and where they vary `axial_force` and
        `velocity` or `speed`; heads may have units.
    roller : mapping
        Fields and options of the roller's case file. Its `velocity` holds where the log has none.

    Raises
    ------
    InputError
        If a column is missing, a cell is no number, or time does not increase; the error names file and line.
    """
    path = Path(path)
    given = renamed(roller)
    log = read_log(path, float(number_or_nan(given.get("velocity", EXAMPLE.get("velocity")), "m/min")))
    angle = math.radians(float(number_or_nan(given.get("contact_angle", EXAMPLE["contact_angle"]), "deg")))
    pressed = (log.radial < 0) & (log.travel > 0)
    if not pressed.any():
        raise InputError("radial_force", None, "a line below 0, in which the roller is pressed on the guide and moves")
    share = float(log.travel[~pressed].sum() / log.travel.sum())
    if share > 0:
        log.notes.append(f"Over {100 * share:.3g} % of the travel no radial force presses; it has no block.")
    loads = np.column_stack([log.radial, log.axial])[pressed]
    weights = log.travel[pressed]
    _tell_lift_off(loads, weights, math.tan(angle), log.notes)
    blocks = []
    for own in levels(loads, weights, math.tan(angle)):
        radial, axial = np.average(loads[own], axis=0, weights=weights[own])
        block: dict[str, Any] = {"distance": float(weights[own].sum()), "radial_force": radial, "axial_force": axial}
        hours = float(log.hours[pressed][own].sum())
        blocks.append(block | ({"velocity": block["distance"] / hours / 60} if hours > 0 else {}))
    blocks.sort(key=lambda block: block["radial_force"])
    named = [{"name": f"level {i + 1}"} | {k: float(f"{v:.8g}") for k, v in b.items()} for i, b in enumerate(blocks)]
    fields, options = parts_for_spectrum(roller)
    if any("velocity" in block for block in named):
        fields.pop("velocity", None)
    duty = {"duty": given["duty"]} if "duty" in given else {}
    lines = f"{len(log.travel):,} lines of {path.name} in {len(named)} level{'s' * (len(named) > 1)} of load"
    log.notes.insert(0, f"{lines}: {log.travel.sum() / 1e3:.4g} km in {log.hours.sum():.4g} h.")
    head = {"name": path.stem, "description": " ".join([*log.notes, NO_RAINFLOW])}
    return head | {"base": fields, "blocks": named} | duty | options, log.notes


def read_log(path: Path, velocity: float) -> Log:
    """Read a log; see `spectrum_of_log`. `velocity` [m/min] is that of a log without a column of speeds."""
    wrong = Collector()
    table = read_table(path, "--from", "line", wrong, further=COLUMNS)
    wrong.check()
    notes: list[str] = []
    columns = _columns(table, path, notes)
    axis = next((name for name in ("time", "distance") if name in columns), None)
    if axis is None or "radial_force" not in columns:
        lacking = "radial_force" if axis is not None else "time or distance"
        allowed = "columns time or distance, radial_force, and where they vary axial_force and velocity"
        raise InputError("--from", ", ".join(table.names), allowed, f"Name a column {lacking}.").at(path, table.head)
    if len(table.lines) < 2:
        raise InputError("--from", str(path), "a log of at least two lines", "Add lines.")
    if "axial_force" not in columns:
        notes.append("No column axial_force: the axial force counts as 0 N.")
        columns["axial_force"] = np.zeros(len(table.lines))
    if {"speed", "velocity"} <= set(columns):
        allowed = "one of them, because both say how fast the roller moves"
        raise InputError("columns", "speed, velocity", allowed, "Remove one of the columns.").at(path, table.head)
    pace = columns["velocity"] if "velocity" in columns else 60 * columns["speed"] if "speed" in columns else None
    steps = np.diff(columns[axis])
    if axis == "time" and (steps <= 0).any():
        k = int(np.argmax(steps <= 0)) + 1
        line = list(table.lines)[k]
        raise InputError("time", float(columns["time"][k]), "times that increase", "Sort the lines.").at(path, line)
    steps = _without_gaps(np.abs(steps), axis, table, notes)
    held = _halves(steps)
    if pace is None:
        notes.append(f"No column velocity: {velocity:g} m/min holds, that of the roller's file or of the example.")
        pace = np.full(held.size, velocity)
    else:
        _tell_speed(pace, table, notes)
    pace = np.abs(pace) / 60  # m/s
    if axis == "time":
        hours, travel = held / 3600, held * pace
        if "distance" in columns:
            travel = _halves(np.abs(np.diff(columns["distance"])))
    else:
        travel = held
        with np.errstate(divide="ignore", invalid="ignore"):
            hours = np.where(pace > 0, travel / pace / 3600, 0.0)
    if not travel.sum() > 0:
        raise InputError("--from", str(path), "a log in which the roller moves", "Check the column velocity.")
    _tell_forces(columns, table, notes)
    return Log(travel, hours, columns["radial_force"], columns["axial_force"], notes)


def _halves(steps: np.ndarray) -> np.ndarray:
    """Return half of the step before and half of the step after each line."""
    return np.asarray((np.append(steps, 0.0) + np.insert(steps, 0, 0.0)) / 2)


def _columns(table: UserTable, path: Path, notes: list[str]) -> dict[str, np.ndarray]:
    """Return the known columns of a log in their units; a unit that is not stated is told."""
    found, bare = {}, []
    for j, name in enumerate(table.names):
        if name not in COLUMNS:
            continue
        wanted, cells = COLUMNS[name], table.column(j)
        values = np.array([number_or_nan(cell, wanted, name) for cell in cells])  # the reader has put the units there
        if np.isnan(values).any():
            k = int(np.argmax(np.isnan(values)))
            error = InputError(name, str(cells[k]), f"a number [{wanted}]", "Mend the cell, or remove its line.")
            raise error.at(path, list(table.lines)[k])
        if split_quantity(cells[0]) is None:
            bare.append(f"{name} in {wanted}")
        found[name] = values
    if bare:
        notes.append(f"Columns without a unit: {listing(bare)}.")
    return found


def _without_gaps(steps: np.ndarray, axis: str, table: UserTable, notes: list[str]) -> np.ndarray:
    """Return steps in which a gap counts as a usual step; gaps are told with their lines."""
    moving = steps[steps > 0]
    usual = float(np.median(moving)) if moving.size else 0.0
    gaps = np.flatnonzero(steps > GAP * usual)
    if gaps.size and usual > 0:
        lines = list(table.lines)
        named = listing([str(lines[k + 1]) for k in gaps[:3]] + (["others"] if gaps.size > 3 else []))
        lost = float(steps[gaps].sum())
        unit = COLUMNS[axis]
        count = f"{gaps.size} gaps" if gaps.size > 1 else "1 gap"
        notes.append(f"{count} of {lost:.4g} {unit} in all, before line {named}: each counts as a usual step.")
        steps = np.where(steps > GAP * usual, usual, steps)
    return steps


def _spikes(values: np.ndarray) -> np.ndarray:
    """Return the lines that jump away from both neighbours by many times the usual change."""
    change = np.diff(values)
    usual = float(np.median(np.abs(change[change != 0]))) if np.any(change) else math.inf
    far = np.minimum(np.abs(change[:-1]), np.abs(change[1:])) > SPIKE * usual
    return np.flatnonzero(far & (change[:-1] * change[1:] < 0)) + 1


def _tell_spikes(name: str, values: np.ndarray, unit: str, effect: str, table: UserTable, notes: list[str]) -> None:
    spikes = _spikes(values)
    if spikes.size:
        worst = int(spikes[np.argmax(np.abs(values[spikes]))])
        count = f"{spikes.size} spikes" if spikes.size > 1 else "1 spike"
        largest = f"the largest {values[worst]:.4g} {unit} in line {list(table.lines)[worst]}"
        notes.append(f"{name} has {count} of one line, {effect}: {largest}.")


def _tell_speed(pace: np.ndarray, table: UserTable, notes: list[str]) -> None:
    """Tell travel backward, and spikes of the speed [m/min]."""
    _tell_spikes("The speed", pace, "m/min", "and the travel holds them", table, notes)
    if (back := float(np.mean(pace < 0))) > 0:
        notes.append(f"The speed is below 0 in {100 * back:.3g} % of the lines: travel backward counts as forward.")


def _tell_forces(columns: dict[str, np.ndarray], table: UserTable, notes: list[str]) -> None:
    """Tell sign, unit, spikes and drift of the forces; radial forces of the other sign are turned."""
    radial = columns["radial_force"]
    if (radial >= 0).all() and (radial > 0).any():
        notes.append("All radial forces are positive; they count as pressing the roller on the guide.")
        columns["radial_force"] = radial = -radial
    elif (share := float(np.mean(radial > 0))) > MOSTLY:
        notes.append(f"radial_force is above 0 in {100 * share:.3g} % of the lines: change its sign if they press.")
    for name in LOADS:
        force = columns[name]
        if name == "radial_force" and 0 < float(np.abs(force).max()) < SMALL:
            largest = f"The largest {name} is {float(np.abs(force).max()):.3g} N."
            notes.append(f"{largest} Name the column {name} [kN] if it is in kN.")
        _tell_spikes(name, force, "N", "which count as loads", table, notes)
        fifth = max(1, force.size // 5)
        spread = float(np.ptp(np.percentile(force, [5, 95])))
        moved = float(np.median(force[-fifth:]) - np.median(force[:fifth]))
        if force.size >= 50 and spread > 0 and abs(moved) > DRIFT * spread:
            notes.append(f"{name} drifts: its median moves by {moved:.4g} N from the first to the last fifth.")


def _tell_lift_off(loads: np.ndarray, weights: np.ndarray, tangent: float, notes: list[str]) -> None:
    """Tell the travel in which the axial force lifts a contact off, without friction."""
    share = float(weights[np.abs(loads[:, 1]) >= -loads[:, 0] * tangent].sum() / weights.sum())
    if share > 0:
        notes.append(
            f"Over {100 * share:.3g} % of the travel the axial force lifts one contact off; a spectrum with such "
            "blocks has no life."
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
    The contacts of a wedge without friction carry forces in the ratio of -F_rad +- F_ax/tan(alpha). Lines in which one
    of them lifts off have levels of their own. The level that changes the sum of their powers most is halved, until no
    power in `POWERS` changes by more than `TOLERANCE`.
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

    lifted = contacts.min(axis=1) <= 0  # a mean of lines with and without lift-off stands for neither
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
