"""Doubts about a measured log: each is a record, which says what was seen where; its words are made
here alone.

A doubt is told where the log may be right. A question stops the work, because one of its answers
gives a wrong number; the key `log` of the case file answers it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from trackroller.errors import InputError, listing

SPIKE = 12.0  # times the usual change from line to line, there and back
RELEVANT = 0.2  # of the usual size of a column: a smaller spike changes no life
DRIFT = 0.25  # of the spread of a force: a change of its median from the first to the last fifth
MOSTLY = 0.5  # of the lines: radial forces above 0 in more of them have another sign convention
SMALL = 1.0  # N: a force that stays below is more likely in kN
# times the range of all other values: a value that repeats there is more likely a mark than a load
FAR = 3.0
CLIPPED = 0.03  # of the lines at exactly the largest load
FROZEN = 20  # lines on end with the same load
# of the other lines that repeat the load before: a load that is often constant is not frozen
STEADY = 0.5
FEW = 0.03  # of the lines
MOST_OF_IT = 0.8  # of a sum that these lines hold
# of loggers, beside 9999, 8888, limits of whole numbers and numbers from 1e20 on
MARKS = (6999.0, 7999.0)

TOLD = {
    "lines": "{lines:,} lines of {file} in {levels}: {km:.4g} km in {hours:.4g} h.",
    "unpressed": "Over {share:.3g} % of the travel no radial force presses; it has no block.",
    "lift_off": "Over {share:.3g} % of the travel the axial force lifts one contact off; a "
    "spectrum with such blocks "
    "has no life.",
    "no_units": "Columns without a unit: {columns}.",
    "no_axial_force": "No column axial_force: the axial force counts as 0 N.",
    "no_velocity": "No column velocity: {velocity:g} m/min holds, that of the roller's file or of "
    "the example.",
    "hold": "Each line holds {words}, as the case file says.",
    "left_out": "{counted} without a value left out ({values}), the first in line {line}.",
    "spikes_left_out": "{counted} with a spike left out, the first in line {line}.",
    "mark": "{column} is {value:g} {unit} in {counted}, the first line {line}, far from all other "
    "values.",
    "reversed": "Times decrease from line to line: the log is read from its last line upward.",
    "sorted": "{counted} before a line of an earlier time, the first line {line}: all lines are "
    "put in order of time.",
    "clock_back": "The time steps back {counted}, first by {back:.4g} s in line {line}{cause}: "
    "the step counts as a "
    "usual one.",
    "equal_times": "{counted} the time of the line before, the first line {line}, as rounded "
    "times do: lines of one "
    "time share the step to the next.",
    "gap": "{counted} of {lost:.4g} {unit} in all, before line {lines}: each counts as a usual "
    "step{cause}.",
    "gap_with_travel": "{counted} of {lost:.4g} {unit} in all, before line {lines}: the "
    "{travel:.4g} m that the column "
    "distance states for them count at the loads beside them.",
    "uneven": "{share:.3g} % of the steps differ from the usual {usual:.4g} {unit} by more than "
    "half: each line holds "
    "for half of the step before and half of the step after. If a value holds until the next "
    "line, write "
    "log: {{hold: last}} in the case file.",
    "jump": "distance jumps {counted}, first by {jump:.4g} m in line {line}, as a counter does "
    "that is reset: a jump "
    "is no travel.",
    "distance_back": "distance decreases in {share:.3g} % of the steps: travel backward counts as "
    "forward.",
    "travel_differs": "distance says {distance:.4g} m and the speed {speed:.4g} m for the same "
    "lines: {used} counts.",
    "spike": "{column} has {counted} of one line, which count as loads: the largest {value:.4g} "
    "{unit} in line {line}.",
    "speed_spike": "The speed has {counted} of one line, and the travel holds them: the largest "
    "{value:.4g} m/min in "
    "line {line}. They hold {share:.3g} % of the travel; log: {{spikes: leave out}} in the "
    "case file leaves them out.",
    "speed_back": "The speed is below 0 in {share:.3g} % of the lines: travel backward counts as "
    "forward.",
    "unusual_speed": "The roller moves at {value:.4g} m/min in the middle, and usual are {low:g} "
    "to {high:g} m/min: check the units of {columns}.",
    "turned": "All radial forces are positive; they count as pressing the roller on the guide.",
    "other_sign": "radial_force is above 0 in {share:.3g} % of the lines: change its sign if they "
    "press.",
    "small": "The largest {column} is {value:.3g} N. Name the column {column} [kN] if it is in kN.",
    "drift": "{column} drifts: its median moves by {value:.4g} N from the first to the last fifth.",
    "clipped": "{column} stands at exactly its largest load, {value:.4g} N, in {share:.3g} % of "
    "the lines, the first "
    "line {line}: a sensor at the end of its range hides larger loads.",
    "frozen": "{column} stands at exactly {value:.4g} N in {counted} on end, the first line "
    "{line}, while it changes "
    "from line to line otherwise: a sensor that has stopped hides the loads.",
    "few_lines": "{counted}, the first line {line}, hold {share:.3g} % of {sum}: the life rests "
    "on them.",
}
COUNTED = {  # one, and several
    "left_out": ("1 line", "{} lines"),
    "spikes_left_out": ("1 line", "{} lines"),
    "mark": ("1 line", "{} lines"),
    "sorted": ("1 line stands", "{} lines stand"),
    "clock_back": ("once", "{} times"),
    "equal_times": ("1 line has", "{} lines have"),
    "gap": ("1 gap", "{} gaps"),
    "gap_with_travel": ("1 gap", "{} gaps"),
    "jump": ("once", "{} times"),
    "spike": ("1 spike", "{} spikes"),
    "speed_spike": ("1 spike", "{} spikes"),
    "frozen": ("1 line", "{} lines"),
    "few_lines": ("1 line", "{} lines"),
}
UNITS = {"m/s": 60.0, "km/h": 1e3 / 60, "m/min": 1.0, "mm/s": 0.06, "mm/min": 1e-3}  # in m/min
COLUMN_UNIT = {"velocity": "m/min", "speed": "m/s"}
HOLD = {  # the answers of log.hold in words
    "last": "until the next line",
    "middle": "for half of the step before and half of the step after",
    "step": "for a usual step at most; a longer step is a gap and counts as a usual one",
}


@dataclass(frozen=True)
class Doubt:
    """What was seen in a log: a code, how often, the first line, and numbers for the words."""

    code: str
    count: int = 0
    line: int | None = None
    values: Mapping[str, Any] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """Return the doubt in words."""
        one, several = COUNTED.get(self.code, ("", ""))
        if self.count == 1:
            counted = one
        else:
            counted = several.format(self.count)
        return TOLD[self.code].format(counted=counted, line=self.line, **self.values)

    @property
    def record(self) -> dict[str, Any]:
        """Return the doubt as the entries of a file."""
        if self.line is None:
            place = {}
        else:
            place = {"count": self.count, "line": self.line}
        return {"code": self.code} | place | dict(self.values)


def mark_question(column: str, values: list[float], count: int, unit: str) -> InputError:
    """Ask whether values far from all others stand for no value."""
    shown = ", ".join(f"{value:g}" for value in values)
    lines = f"{count} lines"
    if count == 1:
        lines = "1 line"
    wrong = f"stands in {lines}, far from all other values, as a mark for no value does"
    remedy = (
        f"Write log: {{missing: [{shown}]}} in the case file to leave such lines out, and "
        f"log: {{missing: []}} "
    )
    return InputError(
        column, f"{shown} {unit}", "values that were measured", f"{remedy}to keep them.", wrong
    )


def hold_question(column: str, count: int, lost: float, whole: float, unit: str) -> InputError:
    """Ask how long the lines hold where many steps are long."""
    remedy = (
        "Write in the case file log: {hold: last} if a value holds until the next line, log: "
        "{hold: middle} if it "
        "holds for half of the step before and after, and log: {hold: step} if nothing is known "
        "of the long steps."
    )
    wrong = (
        f"has {count} long steps, which hold {lost:.4g} of {whole:.4g} {unit}, as a log of "
        "changes or of two rates"
    )
    return InputError(
        column, f"{count} long steps", "steps of which few are long", remedy, f"{wrong} has"
    )


def travel_question(distance: float, speed: float, column: str) -> InputError:
    """Ask which of two columns says how far the roller moves."""
    ratio = speed / distance if distance else 0.0
    size = UNITS[COLUMN_UNIT[column]]
    meant = [unit for unit, own in UNITS.items() if abs(ratio * own / size - 1) < 0.03]
    hint = ""
    if meant:
        hint = f"Write {column} [{meant[0]}] if this is its unit. "
    remedy = f"{hint}Write log: {{travel: distance}} or log: {{travel: velocity}} in the case file."
    wrong = f"adds up to {distance:.4g} m, and {column} to {speed:.4g} m in the same lines"
    return InputError(
        "distance", f"{distance:.4g} m", f"the travel that {column} gives", remedy, wrong
    )


def is_mark(value: float) -> bool:
    """Return whether a number is one that loggers write where there is no value.

    Examples
    --------
    >>> [is_mark(value) for value in (-9999, -999.9, 32767, 9.9e37, 6999, 120, 1000)]
    [True, True, True, True, True, False, False]
    """
    size = abs(value)
    if size >= 1e20 or size in MARKS:
        return True
    digits = f"{size:.6g}".replace(".", "").lstrip("0")
    if (
        "e" not in digits
        and len(set(digits)) == 1
        and len(digits) >= (3 if digits[0] == "9" else 4)
    ):
        return True
    whole = int(size) if size == int(size) else 0
    return whole >= 4095 and (whole & (whole + 1) == 0 or whole & (whole - 1) == 0)


def marks_of(values: np.ndarray, scale: float) -> list[float]:
    """Return the values (n,) of a column far outside all others that stand for no value.

    Parameters
    ----------
    values : numpy.ndarray, shape (n,)
        Numbers of the column.
    scale : float
        Unit of the column in its file, over that of `values`.

    Notes
    -----
    A number that loggers write for no value, such as -9999, need not repeat; any other value must
    repeat, and stand farther from the others. A single other value far away is a spike and is
    passed over.
    """
    different, counts = np.unique(values, return_counts=True)
    marks: list[float] = []
    low, high = 0, len(different)
    for _ in range(8):
        if high - low < 2:
            break
        ends = {low: (low + 1, high), high - 1: (low, high - 1)}
        far = None
        for end, (start, stop) in ends.items():
            others = different[start:stop]
            neighbour = others[-1]
            if end == low:
                neighbour = others[0]
            distance = abs(different[end] - neighbour)
            spread = float(np.ptp(others))
            largest = float(np.abs(others).max())
            known = is_mark(float(f"{different[end] / scale:.9g}"))
            beyond = distance > FAR * spread and abs(different[end]) > 2 * largest
            if known and distance > max(spread, 0.5 * largest):
                far = end, True
            elif beyond and len(others) >= 10:
                far = end, bool(counts[end] > 1)
            if far is not None:
                break
        if far is None:
            break
        if far[1]:
            marks.append(float(different[far[0]]))
        low, high = ends[far[0]]
    return marks


def spikes_of(values: np.ndarray, size: float) -> np.ndarray:
    """Return the lines that jump away from both neighbours by many times the usual change.

    Parameters
    ----------
    values : numpy.ndarray, shape (n,)
        Numbers of the column.
    size : float
        Usual size of the column: a change far below is no spike, also where the column is constant
        otherwise.
    """
    change = np.diff(values)
    usual = 0.0
    if change.size:
        usual = float(np.median(np.abs(change)))
    least = max(SPIKE * usual, RELEVANT * size)
    far = np.minimum(np.abs(change[:-1]), np.abs(change[1:])) > least
    return np.flatnonzero(far & (change[:-1] * change[1:] < 0)) + 1


def usual_size(values: np.ndarray) -> float:
    """Return the size of a column (n,) without its few largest values."""
    if values.size:
        return float(np.percentile(np.abs(values), 90))
    return 0.0


def force_doubts(column: str, force: np.ndarray, size: float, lines: np.ndarray) -> list[Doubt]:
    """Return what is doubtful about a force [N] of a log; `size` is the usual size of the loads."""
    doubts = []
    largest = float(np.abs(force).max())
    if column == "radial_force" and 0 < largest < SMALL:
        doubts.append(Doubt("small", values={"column": column, "value": largest}))
    spikes = spikes_of(force, size)
    if spikes.size:
        worst = spikes[np.argmax(np.abs(force[spikes]))]
        values = {"column": column, "value": float(force[worst]), "unit": "N"}
        doubts.append(Doubt("spike", int(spikes.size), int(lines[worst]), values))
    clipped = _clipped(column, force, lines)
    doubts += clipped or _frozen(column, force, lines)
    fifth = max(1, force.size // 5)
    spread = float(np.ptp(np.percentile(force, [5, 95])))
    moved = float(np.median(force[-fifth:]) - np.median(force[:fifth]))
    if force.size >= 50 and spread > 0 and abs(moved) > DRIFT * spread:
        doubts.append(Doubt("drift", values={"column": column, "value": moved}))
    return doubts


def _clipped(column: str, force: np.ndarray, lines: np.ndarray) -> list[Doubt]:
    """Return a doubt for each sign of a force at whose largest value many lines stand, while the
    others vary.
    """
    different, counts = np.unique(force, return_counts=True)
    doubts = []
    for end, next_one, sign in ((0, 1, -1), (-1, -2, 1)):
        outward = sign * different[end]
        if different.size < 10 or outward < 0.5 * np.abs(different).max():
            continue
        if (
            counts[end] < 5
            or counts[end] < CLIPPED * force.size
            or counts[end] < 4 * counts[next_one]
        ):
            continue
        here = force == different[end]
        values = {
            "column": column,
            "value": float(different[end]),
            "share": 100 * float(np.mean(here)),
        }
        doubts.append(Doubt("clipped", int(counts[end]), int(lines[np.argmax(here)]), values))
    return doubts


def _frozen(column: str, force: np.ndarray, lines: np.ndarray) -> list[Doubt]:
    """Return a doubt if a force other than 0 stands still for many lines, but changes in most of
    the others.
    """
    starts = np.flatnonzero(np.append(True, np.diff(force) != 0))
    sizes = np.diff(np.append(starts, force.size))
    sizes = np.where(force[starts] == 0, 0, sizes)
    longest = int(np.argmax(sizes))
    size = int(sizes[longest])
    others = np.delete(sizes, longest)
    repeated = float((others[others > 1] - 1).sum()) / max(force.size - size, 1)
    if size < FROZEN or not others.size or repeated > STEADY:
        return []
    first = int(starts[longest])
    return [
        Doubt("frozen", size, int(lines[first]), {"column": column, "value": float(force[first])})
    ]


def few_lines(effects: np.ndarray, lines: np.ndarray, name: str) -> list[Doubt]:
    """Return a doubt if a few of the lines hold most of a sum of effects (n,) >= 0."""
    count = max(1, int(FEW * effects.size))
    if effects.size < 30 or not effects.sum() > 0:
        return []
    largest = np.argpartition(effects, -count)[-count:]
    share = float(effects[largest].sum() / effects.sum())
    if share < MOST_OF_IT:
        return []
    largest = largest[np.argsort(effects[largest])[::-1]]
    needed = int(np.argmax(np.cumsum(effects[largest]) >= MOST_OF_IT * effects.sum())) + 1
    share_of_few = float(effects[largest[:needed]].sum() / effects.sum())
    first = int(lines[largest[:needed]].min())
    return [Doubt("few_lines", needed, first, {"share": 100 * share_of_few, "sum": name})]


def first_lines(lines: np.ndarray) -> str:
    """Return the first numbers of lines in words."""
    words = [str(line) for line in lines[:3].tolist()]
    if lines.size > 3:
        words.append("others")
    return listing(words)
