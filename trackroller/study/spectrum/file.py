"""Read a load spectrum: the loads of a roller during a shift, in blocks.

A spectrum file describes the roller once (`base`), and then its loads in blocks with the distance
or the hours of travel per shift, or with their shares of the time of travel:

    name: sorter
    base: {axis_distance: 21.75, roller_material: PA6, guide_overrollings_per_hour: 120}
    blocks:
      - {name: loaded, distance: 4000, radial_force: -300, axial_force: 60}      # m per shift
      - {name: empty, hours: 1.5, radial_force: -80, guide_overrollings: 900}
    life_rule: haibach
    limits: all

`blocks` may also be the name of a CSV file or workbook in the same folder, with one column for each
field and one line for each block.
"""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.damage import groups_of, others
from trackroller.damage.sn_curve import PROBABILITIES
from trackroller.errors import Collector, InputError, check_names, nearest, text_of
from trackroller.files import files_beside, find_beside, read_text
from trackroller.numerics.numbers import number_in
from trackroller.numerics.plain import mapping_of
from trackroller.parameters import OF_LIMITS, PARAMETERS
from trackroller.parameters import OPTIONS as SOLVE_OPTIONS
from trackroller.parameters.example import used_of
from trackroller.roller.aliases import OTHER_OPTIONS, WRITTEN, renamed, with_options
from trackroller.roller.case import FIELDS, Case
from trackroller.roller.duty import (
    OVERROLLINGS,
    checked_duty,
    in_hours,
    is_of_strokes,
    passes_per_km,
    refuse_overrollings,
    strokes_in,
)
from trackroller.roller.geometry import rolling_radius
from trackroller.roller.options import Options
from trackroller.roller.requirement import KEY, LIVES_OF_PAIR, checked_requirement
from trackroller.study.file.user_columns import read_table
from trackroller.tables.user_table import UserTable
from trackroller.yaml_file import errors_by_line, parse_mapping

# what the use of the roller sets; placeholders and worn profiles are the same in all blocks
LOAD_FIELDS = tuple(
    n for n, p in PARAMETERS.items() if p.role == "condition" and n not in OF_LIMITS
)
# what says how long a block lasts, and its unit
TRAVEL = {"distance": "m", "hours": "h", "share": "-"}
BLOCK_FIELDS = ("name", *TRAVEL, "guide_overrollings", *LOAD_FIELDS)
# of a block; an empty load would be that of the paper's example
OPTIONAL = ("name", "guide_overrollings")
OPTIONS = tuple(option.name for option in SOLVE_OPTIONS.values() if "spectrum" in option.files)
FILE_FIELDS = (
    "name",
    "description",
    "base",
    "blocks",
    "critical_damage",
    "failure_probabilities",
    "duty",
    "requirement",
    "limits",
    "log",
    *OPTIONS,
)


@dataclass(frozen=True)
class Block:
    """One block of a load spectrum.

    Parameters
    ----------
    name : str
        Name of the block.
    case : Case
        The roller with the loads of the block.
    distance : float
        Distance travelled per shift [m].
    guide_overrollings : float, optional
        Overrollings of a point of the guide per shift [1]. Default: from the overrollings per hour
        of the case.
    """

    name: str
    case: Case
    distance: float
    guide_overrollings: float | None = None

    @property
    def hours(self) -> float:
        """Return the hours of travel per shift at the velocity of the case [m/min]."""
        return self.distance / (60.0 * float(self.case.velocity))


@dataclass(frozen=True)
class Spectrum:
    """A load spectrum; `load_spectrum` and `from_dict` make it.

    Parameters
    ----------
    name, description : str
        Name and description of the spectrum.
    blocks : tuple of Block
        Blocks of one shift.
    critical_damage : float
        Damage sum at failure [1].
    failure_probabilities : tuple of float
        Failure probabilities at which the life is computed [1].
    options : mapping
        Options of the solver.
    duty : mapping, optional
        `hours_per_day` and `days_per_year` of travel, for lives in years.
    strokes : mapping, optional
        The strokes that the duty was given in, from which its hours follow.
    groups : tuple of str
        Groups of outputs of the limits that the key `limits` names; without it, all whose inputs
        are given are checked.
    required : mapping of str to float
        Shortest life [h] by the name of each required life of the pair.
    by_share : bool
        Whether the blocks state shares of the time of travel. Their distances and overrollings are
        then those of an hour of travel, which takes the place of the shift.
    """

    name: str
    blocks: tuple[Block, ...]
    description: str = ""
    critical_damage: float = 1.0
    failure_probabilities: tuple[float, ...] = PROBABILITIES
    options: Mapping[str, Any] = field(default_factory=dict)
    duty: Mapping[str, float] | None = None
    strokes: Mapping[str, float] | None = None
    groups: tuple[str, ...] = ()
    required: Mapping[str, float] = field(default_factory=dict)
    by_share: bool = False

    @property
    def period(self) -> str:
        """Return what the blocks make up together: a shift, or an hour of travel if they state
        shares of the time.
        """
        return "hour" if self.by_share else "shift"

    @property
    def not_given(self) -> dict[str, Any]:
        """Return the parameters that neither `base` nor every block names, with the values of the
        paper's example.
        """
        cases = [block.case for block in self.blocks]
        return {
            name: value
            for case in cases
            for name, value in used_of(case.as_dict(), case.not_given).items()
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Spectrum:
        """Return the spectrum of a mapping with the keys of a file.

        Parameters
        ----------
        values : mapping
            Keys and values of a spectrum file; arrays count as lists, and `blocks` may be a data
            frame.

        Returns
        -------
        Spectrum
            The checked spectrum.

        Raises
        ------
        InputError
            If an entry is wrong; the error names block, field and value.
        """
        values = mapping_of(values)
        if not isinstance(values, Mapping):
            raise InputError(
                "spectrum", type(values).__name__, "a mapping with the keys of a spectrum file"
            )
        wrong = Collector()
        fields: dict[str, Any] = {}
        with wrong.part():
            values = with_options(values)
        with wrong.part():
            check_names("spectrum: key", values, (*FILE_FIELDS, *OTHER_OPTIONS))
        with wrong.part():
            fields["blocks"], fields["by_share"] = _blocks(
                values.get("blocks"), values.get("base") or {}
            )
        with wrong.part():
            fields["critical_damage"] = _number(
                "critical_damage", values.get("critical_damage", 1.0), open_lower=True
            )
        with wrong.part():
            fields["failure_probabilities"] = _probabilities(
                values.get("failure_probabilities", PROBABILITIES)
            )
        with wrong.part():
            fields["duty"] = None
            if values.get("duty") is not None:
                fields["duty"] = checked_duty(values["duty"])
        left_out = {}
        with wrong.part():
            if "limits" in values:
                fields["groups"] = _groups(values["limits"])
                left_out = {"not_checked": others([*np.atleast_1d(values["limits"])])}
        with wrong.part():
            given = {key: values[key] for key in OPTIONS if key in values}
            fields["options"] = _checked_options(left_out | given)
        with wrong.part():
            fields["name"] = text_of(values.get("name"), "name", "spectrum")
        with wrong.part():
            fields["description"] = text_of(values.get("description"), "description", lines=True)
        wrong.check()
        if is_of_strokes(fields["duty"]):
            fields |= _by_strokes(fields["duty"], fields["blocks"])
        fields["required"] = _required(values.get("requirement"), fields["duty"])
        return cls(**fields)


def _required(given: Any, duty: Mapping[str, float] | None) -> dict[str, float]:
    """Return the shortest life [h] of each requirement; a spectrum judges the life of the pair
    alone.
    """
    requirement = checked_requirement(given, duty)
    wrong = Collector()
    for name, own in requirement.items():
        with wrong.part():
            if name not in LIVES_OF_PAIR or own.ends.keys() != {"min"} or own.in_shares:
                raise InputError(
                    f"{KEY}.{name}",
                    dict(own.written),
                    f"min alone, of {' or '.join(LIVES_OF_PAIR)}",
                    f"Write {KEY}: {{{LIVES_OF_PAIR[0]}: {{min: 5000}}}}.",
                    "is not judged for a spectrum",
                )
    wrong.check()
    return {name: own.least for name, own in requirement.items()}


def _checked_options(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return options of the solver, checked before a case is solved, with numbers as floats."""
    checked = Options(**given)
    numbers = [key for key in given if SOLVE_OPTIONS[key].kind == "number"]
    return {**given, **{key: getattr(checked, key) for key in numbers}}


def _by_strokes(duty: Mapping[str, float], blocks: Sequence[Block]) -> dict[str, Any]:
    """Return the duty of a spectrum in hours, and its blocks with the overrollings of the guide by
    the strokes.
    """
    wrong = Collector()
    for block in blocks:
        with wrong.part():
            refuse_overrollings(
                block.guide_overrollings, f"block '{block.name}'.guide_overrollings"
            )
        with wrong.part():
            refuse_overrollings(block.case.guide_overrollings_per_hour, OVERROLLINGS)
        with wrong.part():
            if "velocity" in block.case.not_given:
                allowed = "the velocity, which turns strokes into hours"
                raise InputError("velocity", None, allowed, "Add velocity: 60 m/min to base.")
    wrong.check()
    travel = sum(block.distance for block in blocks) / 1000.0
    if not travel > 0:
        raise InputError(
            "blocks", None, "a block with travel", "Give one of them a distance.", "have no travel"
        )
    in_time = in_hours(duty, sum(block.hours for block in blocks) / travel)
    passes = passes_per_km(duty) / 1000.0
    given = {"duty": in_time, "strokes": strokes_in(duty)}
    return given | {
        "blocks": tuple(replace(b, guide_overrollings=passes * b.distance) for b in blocks)
    }


def load_spectrum(path: Path | str) -> Spectrum:
    """Read a load spectrum from a file.

    Parameters
    ----------
    path : pathlib.Path or str
        The YAML file.

    Returns
    -------
    Spectrum
        The checked spectrum.

    Raises
    ------
    InputError
        If an entry is wrong; the error names file, block, field and value.
    """
    path = Path(path)
    text = read_text(path, "load spectrum")
    values = parse_mapping(text, str(path))
    with errors_by_line(text, aliases=WRITTEN), files_beside(path):
        return Spectrum.from_dict({"name": path.stem} | values)


def _blocks(given: Any, base: Any) -> tuple[tuple[Block, ...], bool]:
    """Return the checked blocks, and whether these state shares of the time.

    Raises the errors of all blocks and of `base` together.
    """
    wrong = Collector()
    table = None
    path = None
    blocks = given
    if isinstance(given, str):
        path = find_beside(given, "blocks")
        table = read_table(path, "blocks", "block", wrong, optional=OPTIONAL)
        blocks = _entries(table, path, wrong)
    if not isinstance(blocks, list) or not blocks:
        example = "Write - {name: loaded, distance: 4000, radial_force: -300}."
        raise InputError(
            "blocks", blocks, "a list of blocks that is not empty, or the name of a table", example
        )
    if not isinstance(base, Mapping):
        raise InputError("base", base, "a mapping of case fields to values")
    base = renamed(base)
    try:
        Case.from_dict(base)
    except InputError as error:
        wrong.errors += _named(error, "base")
        base = {}  # the loads of the blocks are checked on their own
    checked = []
    for i, entry in enumerate(blocks):
        try:
            checked.append(_block(entry, base, i + 1))
        except InputError as error:
            wrong.errors += [_placed(one, i, table, path) for one in error.errors]
    wrong.check()
    _check_blocks(checked)
    by_share = ["share" in entry for entry in blocks]
    if any(by_share):
        _check_shares(checked, by_share)
    return tuple(checked), any(by_share)


def _check_blocks(blocks: list[Block]) -> None:
    """Refuse two blocks of one name, and blocks in which nothing moves."""
    name, count = Counter(block.name for block in blocks).most_common(1)[0]
    if count > 1:
        raise InputError(
            "blocks", name, "a name of its own for each block", "Rename one of the blocks."
        )
    if not sum(block.distance for block in blocks) > 0:
        allowed = "distances of a shift that add up to more than 0 m"
        raise InputError("distance", 0.0, allowed, "Give distances in m.")


def _placed(error: InputError, i: int, table: UserTable | None, path: Path | None) -> InputError:
    """Return an error of a block with its place: its line in a table, or its number in `blocks`."""
    error.path = ("blocks", str(i))
    if table is None:
        return error
    return error.at(path, list(table.lines)[i])


def _check_shares(blocks: list[Block], by_share: list[bool]) -> None:
    """Refuse shares beside distances or hours, and shares that do not add up to 1."""
    if not all(by_share):
        other = blocks[by_share.index(False)].name
        allowed = "a share in each block, because a share of the time is no part of a shift"
        raise InputError(
            f"block '{other}'.share",
            None,
            allowed,
            "Give share in all blocks, or hours in all of them.",
        )
    whole = sum(block.hours for block in blocks)
    if abs(whole - 1.0) > 1e-6:
        remedy = "Write 0.2 or 20 % for a fifth of the time of travel."
        raise InputError("share", whole, "shares of the blocks that add up to 1", remedy)


def _entries(table: UserTable, path: Path | None, wrong: Collector) -> list[dict[str, str]]:
    """Return the lines of a table as entries of `blocks`; columns that no block can have are left
    out as errors.
    """
    heads = Collector()
    for name in table.names:
        with heads.part():
            _check_fields([name], "blocks", {name: "a column"})
    wrong.errors += [error.at(path, table.head) for error in heads.errors]
    wrong_lines = {error.line for error in wrong.errors}  # cells that are empty or not clear
    if table.head in wrong_lines or wrong_lines >= {*table.lines}:
        wrong.check()
    table.lines = {
        number: line for number, line in table.lines.items() if number not in wrong_lines
    }
    return [
        {n: c for n, c in zip(table.names, line, strict=True) if c} for line in table.lines.values()
    ]


def _check_fields(names: Iterable[Any], where: str, values: Mapping[str, Any]) -> None:
    """Refuse fields that a block cannot have."""
    wrong = Collector()
    of_roller = [key for key in names if key in FIELDS and key not in BLOCK_FIELDS]
    for key in of_roller:
        allowed = "a load, because the roller is the same in all blocks of a spectrum"
        wrong.errors.append(
            InputError(f"{where}.{key}", values.get(key), allowed, "Give this field under `base`.")
        )
    with wrong.part():
        check_names(f"{where}: field", (key for key in names if key not in of_roller), BLOCK_FIELDS)
    wrong.check()


def _block(entry: Any, base: Mapping[str, Any], number: int) -> Block:
    """Return the block of an entry; raise all errors of the entry together."""
    if not isinstance(entry, Mapping):
        allowed = "a mapping such as {distance: 4000, radial_force: -300}"
        raise InputError(f"blocks[{number}]", entry, allowed)
    entry = renamed(entry)
    name = text_of(entry.get("name"), "name of a block", f"block {number}")
    where = f"block '{name}'"
    wrong = Collector()
    with wrong.part():
        _check_fields(list(entry), where, entry)
    fields: dict[str, Any] = {"name": name}
    lasts = [key for key in TRAVEL if key in entry]
    with wrong.part():
        _check_travel(lasts, entry, where)
    for key in lasts[:1]:
        with wrong.part():
            fields["distance"] = _number(f"{where}.{key}", entry[key], unit=TRAVEL[key])
    with wrong.part():
        if entry.get("guide_overrollings") is not None:
            fields["guide_overrollings"] = _overrollings(
                entry["guide_overrollings"], lasts, f"{where}.guide_overrollings"
            )
    loads = {key: entry[key] for key in LOAD_FIELDS if key in entry}
    try:
        fields["case"] = Case.from_dict({**base, **loads})
    except InputError as error:
        wrong.errors += _named(error, where)
    wrong.check()
    if lasts[0] != "distance":
        # the velocity of the block [m/min]
        fields["distance"] *= 60.0 * float(fields["case"].velocity)
    return Block(**fields)


def _check_travel(lasts: list[str], entry: Mapping[str, Any], where: str) -> None:
    """Refuse a block that does not say how long it lasts, or says it twice.

    A block with a mistyped key is left to the check of its names.
    """
    if not lasts and not any(nearest(key, BLOCK_FIELDS) in TRAVEL for key in entry):
        allowed = (
            "the distance in m or the hours travelled per shift, or the share of the time of travel"
        )
        remedy = "Add one of distance, hours and share to the block."
        raise InputError(f"{where}.distance", None, allowed, remedy)
    if len(lasts) > 1:
        allowed = "one of distance, hours and share; the velocity gives the others"
        remedy = f"Remove {lasts[0]} or {lasts[1]}."
        raise InputError(f"{where}.{lasts[1]}", entry[lasts[1]], allowed, remedy)


def _overrollings(value: Any, lasts: list[str], where: str) -> float:
    """Return the overrollings of the guide per shift; refuse them in a block by its share."""
    if lasts[:1] == ["share"]:
        allowed = "overrollings per hour, because blocks by share of the time have no shift"
        raise InputError(where, value, allowed, "Give guide_overrollings_per_hour instead.")
    return _number(where, value)


def _named(error: InputError, where: str) -> list[InputError]:
    """Return the errors of a case with the place of the case before their fields."""
    named = []
    for entry in error.errors:
        if entry.field in FIELDS:
            named.append(entry.named(f"{where}.{entry.field}"))
        else:
            named.append(entry.named(f"{where}: {entry.field}"))
    return named


def _number(name: str, value: Any, open_lower: bool = False, unit: str = "-") -> float:
    lower = 0.0
    allowed = "a finite number >= 0"
    if open_lower:
        lower = math.nextafter(0.0, 1.0)
        allowed = "a finite number > 0"
    return number_in(value, name, allowed, lower, sys.float_info.max, unit)


def _groups(names: Any) -> tuple[str, ...]:
    """Return the groups of outputs of `all` limits, or of a list of limits."""
    limits = names
    if isinstance(names, str):
        limits = [names]
    if not isinstance(limits, list) or not limits:
        raise InputError(
            "limits", names, "all, or a list of names of limits", "Write limits: [fatigue, wear]."
        )
    return groups_of("limits", [str(name) for name in limits])


def _probabilities(values: Any) -> tuple[float, ...]:
    if not isinstance(values, (list, tuple)) or not values:
        raise InputError("failure_probabilities", values, "a list of numbers between 0 and 1")
    numbers = tuple(_number("failure_probabilities", value, open_lower=True) for value in values)
    for number in numbers:
        if number >= 1:
            raise InputError(
                "failure_probabilities", number, "numbers between 0 and 1", "Give 0.1 for 10 %."
            )
    return tuple(sorted(set(numbers)))


def overrollings_per_shift(spectrum: Spectrum) -> np.ndarray:
    """Return the overrollings of roller and guide per shift.

    Parameters
    ----------
    spectrum : Spectrum
        The load spectrum.

    Returns
    -------
    numpy.ndarray, shape (block, body)
        Overrollings [1]. A roller has distance / (2 pi r_A) of them. For the guide, the given
        number is used, otherwise its overrollings per hour times the hours of the block; NaN if
        neither is known.
    """
    rows = []
    for block in spectrum.blocks:
        case = block.case
        radius = rolling_radius(
            case.axis_distance, case.guide_profile_radius, np.deg2rad(case.contact_angle)
        )
        guide = block.guide_overrollings
        if guide is None:
            per_hour = case.guide_overrollings_per_hour
            if per_hour is None:
                guide = math.nan
            else:
                guide = per_hour * block.hours
        if block.distance == 0 and block.guide_overrollings is None:
            guide = 0.0
        rows.append((block.distance * 1e3 / (2 * math.pi * float(radius)), guide))
    return np.array(rows, dtype=float)
