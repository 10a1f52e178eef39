"""Read a measured log: travel, hours and forces of each line, and what is doubtful about it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from trackroller.errors import Collector, InputError, listing
from trackroller.roller.doubts import USUAL
from trackroller.roller.log_answers import LogAnswers
from trackroller.roller.settings import LOADS
from trackroller.study.spectrum.log_columns import COLUMNS, FIELD, LogColumns, read_columns
from trackroller.study.spectrum.log_doubts import (
    HOLD,
    MOSTLY,
    Doubt,
    force_doubts,
    mark_question,
    marks_of,
    spikes_of,
    travel_question,
    usual_size,
)
from trackroller.study.spectrum.log_steps import Steps, distance_steps, in_order, time_steps

TOLD_ABOVE = 0.02  # relative difference between two columns of travel
ASKED_ABOVE = 0.1


@dataclass
class Log:
    """A history of loads: travel [m], hours [h] and both forces [N] of each line, and the doubts
    about it.

    `lines` holds the number of each line in its file.
    """

    travel: np.ndarray
    hours: np.ndarray
    radial: np.ndarray
    axial: np.ndarray
    lines: np.ndarray
    doubts: list[Doubt] = field(default_factory=list)

    @property
    def notes(self) -> list[str]:
        """Return the doubts in words."""
        return [doubt.text for doubt in self.doubts]


def read_log(path: Path, velocity: float, answers: LogAnswers | None = None) -> Log:
    """Read a log.

    Parameters
    ----------
    path : pathlib.Path
        CSV file or workbook, see `spectrum_of_log`.
    velocity : float
        Velocity of a log without a column of speeds [m/min].
    answers : LogAnswers, optional
        What the user says of the log.

    Raises
    ------
    InputError
        If a column is missing, a cell is no finite number, or a question about the log has no
        answer.
    """
    answers = answers or LogAnswers()
    log = read_columns(path, answers)
    _check_names(log)
    doubts: list[Doubt] = []
    questions = Collector()
    log = _without_marks(log, answers, doubts, questions)
    questions.check()
    log = _without_spikes(log, answers, doubts)
    if len(log) < 2:
        raise InputError(FIELD, str(path), "a log of at least two lines with values", "Add lines.")
    if "time" in log.values:
        log = in_order(log, doubts)
    if log.bare:
        doubts.append(Doubt("no_units", values={"columns": listing(log.bare)}))
    if "axial_force" not in log.values:
        doubts.append(Doubt("no_axial_force"))
        log.values["axial_force"] = np.zeros(len(log))
    travel, hours = _travel_and_hours(log, velocity, answers, doubts, questions)
    questions.check()
    if not travel.sum() > 0:
        raise InputError(
            FIELD, str(path), "a log in which the roller moves", "Check the column velocity."
        )
    _doubt_speed(travel, hours, log, doubts)
    _doubt_forces(log, doubts)
    return Log(
        travel, hours, log.values["radial_force"], log.values["axial_force"], log.lines, doubts
    )


def _check_names(log: LogColumns) -> None:
    """Refuse a log without the columns that it needs, and with two that say the same."""
    has_axis = "time" in log.values or "distance" in log.values
    if not has_axis or "radial_force" not in log.values:
        lacking = "time or distance"
        if has_axis:
            lacking = "radial_force"
        allowed = (
            "columns time or distance, radial_force, and where they vary axial_force and velocity"
        )
        raise InputError(FIELD, ", ".join(log.names), allowed, f"Name a column {lacking}.").at(
            log.path, log.head
        )
    if {"speed", "velocity"} <= set(log.values):
        allowed = "one of them, because both say how fast the roller moves"
        raise InputError("columns", "speed, velocity", allowed, "Remove one of the columns.").at(
            log.path, log.head
        )


def _without_marks(
    log: LogColumns, answers: LogAnswers, doubts: list[Doubt], questions: Collector
) -> LogColumns:
    """Tell which lines were left out; ask about values that look like marks for no value."""
    if log.empty.size:
        words = {"values": listing([repr(cell) for cell in answers.missing or ()], "or")}
        doubts.append(Doubt("left_out", int(log.empty.size), int(log.empty[0]), words))
    if answers.missing == ():
        return log
    for name, column in log.values.items():
        marks = marks_of(column, log.scales[name])
        if not marks:
            continue
        is_marked = np.isin(column, marks)
        line = int(log.lines[np.argmax(is_marked)])
        shown = [float(f"{mark / log.scales[name]:.9g}") for mark in marks]
        if answers.missing is None:
            question = mark_question(name, shown, int(is_marked.sum()), COLUMNS[name])
            questions.errors.append(question.at(log.path, line))
        else:
            values: dict[str, float | str] = {
                "column": name,
                "value": marks[0],
                "unit": COLUMNS[name],
            }
            doubts.append(Doubt("mark", int(is_marked.sum()), line, values))
    return log


def _pace(log: LogColumns) -> np.ndarray | None:
    """Return the speed of each line [m/min], None for a log without one."""
    if "velocity" in log.values:
        return log.values["velocity"]
    if "speed" in log.values:
        return 60 * log.values["speed"]
    return None


def _without_spikes(log: LogColumns, answers: LogAnswers, doubts: list[Doubt]) -> LogColumns:
    """Leave out the lines with a spike if the user says so; tell spikes of the speed."""
    load = usual_size(log.values["radial_force"])
    spikes = {name: spikes_of(log.values[name], load) for name in LOADS if name in log.values}
    pace = _pace(log)
    if pace is not None:
        spikes["speed"] = spikes_of(pace, usual_size(pace))
    rows = np.unique(np.concatenate(list(spikes.values())))
    if answers.spikes == "leave out" and rows.size:
        doubts.append(Doubt("spikes_left_out", int(rows.size), int(log.lines[rows[0]])))
        counts = np.full(len(log), True)
        counts[rows] = False
        return log.take(counts)
    if pace is not None and spikes["speed"].size:
        fast = spikes["speed"]
        worst = int(fast[np.argmax(np.abs(pace[fast]))])
        share = 100 * float(np.abs(pace[fast]).sum() / np.abs(pace).sum())
        values = {"value": float(pace[worst]), "share": share}
        doubts.append(Doubt("speed_spike", int(fast.size), int(log.lines[worst]), values))
    return log


def _travel_and_hours(
    log: LogColumns, velocity: float, answers: LogAnswers, doubts: list[Doubt], questions: Collector
) -> tuple[np.ndarray, np.ndarray]:
    """Return travel [m] and hours [h] of the time during which each line holds."""
    pace = _pace(log)
    timed = "time" in log.values
    counted = "distance" in log.values
    if pace is None and not (timed and counted):
        doubts.append(Doubt("no_velocity", values={"velocity": velocity}))
    elif pace is not None and (pace < 0).any():
        doubts.append(Doubt("speed_back", values={"share": 100 * float(np.mean(pace < 0))}))
    speed = np.full(len(log), velocity / 60)  # m/s
    if pace is not None:
        speed = np.abs(pace) / 60
    hold = answers.hold or "middle"
    if answers.hold is not None:
        doubts.append(Doubt("hold", values={"words": HOLD[answers.hold]}))
    if not timed:
        steps = Steps("distance", distance_steps(log, None, doubts))
        steps.cut_gaps(log, answers.hold, doubts, questions)
        travel = _of_lines(steps.along, hold)
        with np.errstate(divide="ignore", invalid="ignore"):
            return travel, np.where(speed > 0, travel / speed / 3600, 0.0)
    seconds = time_steps(log, doubts)
    moved = None
    if counted:
        moved = distance_steps(log, seconds, doubts)
    steps = Steps("time", seconds, moved)
    steps.cut_gaps(log, answers.hold, doubts, questions)
    duration = _of_lines(steps.along, hold)
    if moved is None:
        return duration * speed, duration / 3600
    if pace is not None:
        _compare_travel(steps, moved, speed, log, answers, doubts, questions)
    if answers.travel == "velocity":
        return duration * speed, duration / 3600
    return _of_lines(moved, hold), duration / 3600


def _compare_travel(
    steps: Steps,
    moved: np.ndarray,
    speed: np.ndarray,
    log: LogColumns,
    answers: LogAnswers,
    doubts: list[Doubt],
    questions: Collector,
) -> None:
    """Compare what the columns of distance and speed [m/s] say of the steps that are neither gaps
    nor jumps.
    """
    if answers.hold == "last":
        of_steps = speed[:-1]
    else:
        of_steps = (speed[:-1] + speed[1:]) / 2
    usual = steps.usual
    distance = float(moved[usual].sum())
    by_speed = float((of_steps * steps.along)[usual].sum())
    difference = abs(distance - by_speed) / max(distance, by_speed, 1e-300)
    column = "speed"
    if "velocity" in log.values:
        column = "velocity"
    if difference > ASKED_ABOVE and answers.travel is None:
        questions.errors.append(travel_question(distance, by_speed, column).at(log.path, log.head))
    elif difference > TOLD_ABOVE:
        values = {"distance": distance, "speed": by_speed, "used": answers.travel or "distance"}
        doubts.append(Doubt("travel_differs", values=values))


def _of_lines(steps: np.ndarray, hold: str) -> np.ndarray:
    """Return what each line holds: the step after it, or half of the step before and half of the
    step after.
    """
    if hold == "last":
        return np.append(steps, 0.0)
    return np.asarray((np.append(steps, 0.0) + np.insert(steps, 0, 0.0)) / 2)


def _doubt_speed(
    travel: np.ndarray, hours: np.ndarray, log: LogColumns, doubts: list[Doubt]
) -> None:
    """Add a doubt if the roller moves far slower or faster than rollers do; `travel` [m] and
    `hours` [h] of each line, (n,).
    """
    columns = [name for name in ("time", "distance", "velocity", "speed") if name in log.values]
    moving = (travel > 0) & (hours > 0)
    if len(columns) < 2 or not moving.any():  # the speed is that of the case
        return
    low, high = USUAL["velocity"]
    speed = float(np.median(travel[moving] / hours[moving])) / 60  # m/min
    if not low <= speed <= high:
        values = {"value": speed, "low": low, "high": high, "columns": listing(columns)}
        doubts.append(Doubt("unusual_speed", values=values))


def _doubt_forces(log: LogColumns, doubts: list[Doubt]) -> None:
    """Add the doubts about the forces; radial forces of the other sign are turned."""
    radial = log.values["radial_force"]
    if (radial >= 0).all() and (radial > 0).any():
        doubts.append(Doubt("turned"))
        log.values["radial_force"] = radial = -radial
    elif float(np.mean(radial > 0)) > MOSTLY:
        doubts.append(Doubt("other_sign", values={"share": 100 * float(np.mean(radial > 0))}))
    load = usual_size(radial)
    for name in LOADS:
        doubts += force_doubts(name, log.values[name], load, log.lines)
