"""Find the steps of time and travel from line to line of a measured log, whatever its clock and its
counter did.
"""

from __future__ import annotations

import numpy as np

from trackroller.errors import Collector, InputError
from trackroller.study.spectrum.log_columns import COLUMNS, LogColumns
from trackroller.study.spectrum.log_doubts import Doubt, first_lines, hold_question

GAP = 5.0  # times the usual step of time, or of distance
FEW_GAPS = 3
SHARE_OF_GAPS = 0.03  # of the steps, from which on gaps are asked about
LOST = 0.05  # of the time: more gaps than `FEW_GAPS` that hold more are asked about
UNEVEN = 0.2  # of the steps that differ from the usual one by more than `DIFFERENT`
DIFFERENT = 0.5  # of the usual step
REGULAR = 3.0  # between the 90th and the 10th percentile of steps of one rate
MANY_BACK = 0.1  # of the steps of time below 0
BACK = 1.5  # times the usual step: a single step of a counter backward
HOUR = 3600.0


class Steps:
    """The steps from line to line of a log, shape (n - 1).

    Parameters
    ----------
    name : str
        The column over which the log was taken, `time` or `distance`.
    along : numpy.ndarray
        Its steps [s or m].
    travel : numpy.ndarray, optional
        Travel that a column `distance` beside `time` states [m].

    Attributes
    ----------
    usual : numpy.ndarray of bool
        Steps that are no gaps.
    """

    def __init__(self, name: str, along: np.ndarray, travel: np.ndarray | None = None) -> None:
        self.name = name
        self.along = along
        self.travel = travel
        self.usual = np.full(along.size, True)

    def cut_gaps(
        self, log: LogColumns, hold: str | None, doubts: list[Doubt], questions: Collector
    ) -> None:
        """Let gaps count as usual steps; ask where many steps are long and `hold` does not say what
        they are.
        """
        steps = self.along
        moving = steps[steps > 0]
        if not moving.size:
            return
        unit = COLUMNS[self.name]
        usual = float(np.median(moving))
        gaps = np.asarray(steps > GAP * usual)
        count = int(gaps.sum())
        lost = float(steps[gaps].sum())
        lines = log.lines[np.flatnonzero(gaps) + 1]
        other = float(np.mean(np.abs(moving / usual - 1) > DIFFERENT - 1e-9))
        many = count > SHARE_OF_GAPS * steps.size or (
            count > FEW_GAPS and lost > LOST * steps.sum()
        )
        if hold is None and count and (many or other > UNEVEN):
            question = hold_question(self.name, count, lost, float(steps.sum()), unit)
            questions.errors.append(question.at(log.path, int(lines[0])))
        elif hold is None and other > UNEVEN:
            doubts.append(
                Doubt("uneven", values={"share": 100 * other, "usual": usual, "unit": unit})
            )
        if not count or hold in ("last", "middle"):
            return
        self.usual = ~gaps
        values = {"lost": lost, "unit": unit, "lines": first_lines(lines)}
        if self.travel is not None:
            travel = float(self.travel[gaps].sum())
            doubts.append(
                Doubt("gap_with_travel", count, int(lines[0]), values | {"travel": travel})
            )
            self.along = np.where(gaps, self._needed(self.travel, usual), steps)
        else:
            cause = ""
            if self.name == "time" and count == 1:
                cause = _forward_cause(lost, usual)
            doubts.append(Doubt("gap", count, int(lines[0]), values | {"cause": cause}))
            self.along = np.where(gaps, usual, steps)

    def _needed(self, travel: np.ndarray, usual: float) -> np.ndarray:
        """Return the seconds of each step at the usual speed of the log: a usual step at least, its
        own at most.
        """
        moving = self.usual & (travel > 0) & (self.along > 0)
        if moving.any():
            speed = float(np.median(travel[moving] / self.along[moving]))
        else:
            speed = np.inf
        return np.asarray(np.minimum(self.along, np.maximum(travel / speed, usual)))


def _forward_cause(lost: float, usual: float) -> str:
    """Return in words why time may jump forward by an hour."""
    if abs(lost - usual - HOUR) <= max(2 * usual, 30.0):
        return "; it is about an hour, as a clock is set forward in spring"
    return ""


def in_order(log: LogColumns, doubts: list[Doubt]) -> LogColumns:
    """Return the lines of a log in the order of their times; a clock that was set back does not
    change the order.

    Raises
    ------
    InputError
        If no order of the lines follows from their times.
    """
    time = log.values["time"]
    steps = np.diff(time)
    back = steps < 0
    if not back.any() or not np.any(steps):
        return log
    if (steps <= 0).all():
        doubts.append(Doubt("reversed"))
        return log.take(np.arange(len(log))[::-1])
    forward = steps[steps > 0]
    order = np.argsort(time, kind="stable")
    in_time = np.diff(time[order])
    first = int(log.lines[np.argmax(back) + 1])
    near = bool((-steps[back] <= GAP * np.median(forward)).all())
    shuffled = not _is_regular(forward) and _is_regular(in_time)
    if (in_time > 0).all() and (near or (shuffled and back.mean() > MANY_BACK)):
        doubts.append(Doubt("sorted", int(back.sum()), first))
        return log.take(order)
    if back.mean() > MANY_BACK and not _is_regular(forward):
        remedy = (
            "Write the time since the first line, or a column distance; sort the lines if each "
            "time stands once in "
            "the log."
        )
        wrong = f"is below the time of the line before, as {back.sum()} times are"
        error = InputError(
            "time", float(time[np.argmax(back) + 1]), "times that increase", remedy, wrong
        )
        raise error.at(log.path, first)
    return log


def _is_regular(steps: np.ndarray) -> bool:
    low, high = np.percentile(steps, [10, 90])
    return bool(0 < low and high <= REGULAR * low)


def time_steps(log: LogColumns, doubts: list[Doubt]) -> np.ndarray:
    """Return the seconds of each step; steps of a clock that was set back count as usual ones.

    Raises
    ------
    InputError
        If no time passes.
    """
    time = log.values["time"]
    steps = np.diff(time)
    back = steps < 0
    forward = steps[steps > 0]
    if not forward.size:
        remedy = "Record times with more decimals, or a column distance."
        raise InputError("time", float(time[1]), "times that increase", remedy).at(
            log.path, int(log.lines[1])
        )
    usual = float(np.median(forward))
    if back.any():
        row = int(np.argmax(back)) + 1
        cause = _back_cause(time, row, usual)
        values = {"back": float(-steps[row - 1]), "cause": cause}
        doubts.append(Doubt("clock_back", int(back.sum()), int(log.lines[row]), values))
        steps = np.where(back, usual, steps)
    equal = steps == 0
    if equal.any():
        row = int(np.argmax(equal)) + 1
        doubts.append(Doubt("equal_times", int(equal.sum()), int(log.lines[row])))
        steps = _shared(steps)
    return steps


def _back_cause(time: np.ndarray, row: int, usual: float) -> str:
    """Return in words why a clock may step back."""
    back = float(time[row - 1] - time[row]) + usual
    if abs(back - HOUR) <= max(2 * usual, 30.0):
        return ", about an hour, as a clock is set back in autumn"
    if abs(back - 24 * HOUR) <= max(2 * usual, 30.0):
        return ", a day, as a time without a date does at midnight"
    if abs(time[row] - time[0]) <= GAP * usual or time[row] == 0:
        return ", where it begins again"
    return ""


def _shared(steps: np.ndarray) -> np.ndarray:
    """Return steps in which the lines of one time share the step to the next time, a usual one at
    most.
    """
    ends = np.flatnonzero(np.append(steps > 0, True))  # the last line of each time
    sizes = np.diff(ends, prepend=-1)  # lines of each time
    usual = float(np.median(steps[steps > 0]))
    following = np.append(steps[ends[:-1]], usual)
    share = np.minimum(following, usual) / sizes
    share[-1] = usual / max(float(np.median(sizes)), float(sizes[-1]))
    shared = np.repeat(share, sizes)
    last_share = following - share * (sizes - 1)
    shared[ends[:-1]] = last_share[:-1]
    return np.asarray(shared[: steps.size])


def distance_steps(log: LogColumns, seconds: np.ndarray | None, doubts: list[Doubt]) -> np.ndarray:
    """Return the travel of each step [m]; a jump of the counter is none.

    A counter that is reset steps back once, between steps forward. Where the time is known, a step
    that is far too fast is a jump, too.
    """
    steps = np.diff(log.values["distance"])
    if np.sum(steps < 0) > np.sum(steps > 0):  # a counter that counts down
        steps = -steps
    moving = np.abs(steps[steps != 0])
    if not moving.size:
        return np.abs(steps)
    before = np.append(0.0, steps[:-1])
    after = np.append(steps[1:], 0.0)
    alone = (steps < 0) & (before >= 0) & (after >= 0)
    jumps = alone & (-steps > BACK * np.median(moving))
    if seconds is None:
        rates = np.abs(steps)
    else:
        rates = np.abs(steps) / np.maximum(seconds, 1e-300)
    fast = rates > max(GAP * np.median(rates[rates > 0]), 2 * np.percentile(rates, 95))
    jumps |= fast & ((steps < 0) | (seconds is not None))
    if jumps.any():
        row = int(np.argmax(jumps)) + 1
        doubts.append(
            Doubt("jump", int(jumps.sum()), int(log.lines[row]), {"jump": float(steps[row - 1])})
        )
    back = (steps < 0) & ~jumps
    if back.any():
        doubts.append(Doubt("distance_back", values={"share": 100 * float(np.mean(back))}))
    return np.where(jumps, 0.0, np.abs(steps))
