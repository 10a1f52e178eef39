"""Read a load spectrum: the loads of a roller during a shift, in blocks.

A spectrum file describes the roller once (`base`), and then its loads in blocks with the distance travelled per shift:

    name: sorter
    base: {axis_distance: 21.75, roller_material: PA6, guide_overrollings_per_hour: 120}
    blocks:
      - {name: loaded, distance: 4000, radial_force: -300, axial_force: 60}      # m per shift
      - {name: empty, distance: 4000, radial_force: -80, guide_overrollings: 900}
    life_rule: haibach

`blocks` may also be the name of a CSV file in the same folder, with one column for each field and one line for each
block.
"""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.damage.sn_curve import PROBABILITIES
from trackroller.errors import InputError, check_names
from trackroller.files import files_beside, find_beside, read_text
from trackroller.numerics.numbers import number_in
from trackroller.parameters import OPTIONS as SOLVE_OPTIONS
from trackroller.roller.aliases import renamed
from trackroller.roller.case import FIELDS, Case
from trackroller.roller.geometry import rolling_radius
from trackroller.roller.options import Options
from trackroller.study.file.csv import csv_lines
from trackroller.yaml_file import parse_mapping

LOAD_FIELDS = (
    "radial_force",
    "axial_force",
    "motor_force",
    "friction_coefficient",
    "velocity",
    "guide_curve_radius",
    "guide_overrollings_per_hour",
)
BLOCK_FIELDS = ("name", "distance", "guide_overrollings", *LOAD_FIELDS)
OPTIONS = tuple(option.name for option in SOLVE_OPTIONS.values() if "spectrum" in option.files)
FILE_FIELDS = ("name", "description", "base", "blocks", "critical_damage", "failure_probabilities", *OPTIONS)


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
        Overrollings of a point of the guide per shift [1]. Default: from the overrollings per hour of the case.
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
    """

    name: str
    blocks: tuple[Block, ...]
    description: str = ""
    critical_damage: float = 1.0
    failure_probabilities: tuple[float, ...] = PROBABILITIES
    options: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Spectrum:
        """Return the spectrum of a mapping with the keys of a file.

        Parameters
        ----------
        values : mapping
            Keys and values of a spectrum file.

        Returns
        -------
        Spectrum
            The checked spectrum.

        Raises
        ------
        InputError
            If an entry is wrong; the error names block, field and value.
        """
        check_names("spectrum: key", values, FILE_FIELDS)
        blocks = values.get("blocks")
        if isinstance(blocks, str):
            blocks = _table(find_beside(blocks, "blocks"))
        if not isinstance(blocks, list) or not blocks:
            raise InputError(
                "blocks",
                blocks,
                "a list of blocks that is not empty, or the name of a CSV",
                "Write - {name: loaded, distance: 4000, radial_force: -300}.",
            )
        base = values.get("base") or {}
        if not isinstance(base, Mapping):
            raise InputError("base", base, "a mapping of case fields to values")
        base = renamed(base)
        made = tuple(_block(block, base, i) for i, block in enumerate(blocks, start=1))
        if len({block.name for block in made}) < len(made):
            twice = Counter(block.name for block in made).most_common(1)[0][0]
            raise InputError("blocks", twice, "a name of its own for each block", "Rename one of the blocks.")
        if not sum(block.distance for block in made) > 0:
            raise InputError(
                "distance", 0.0, "distances of a shift that add up to more than 0 m", "Give distances in m."
            )
        options = {key: values[key] for key in OPTIONS if key in values}
        Options(**options)  # checked before any case is solved
        return cls(
            name=str(values.get("name", "spectrum")),
            blocks=made,
            description=str(values.get("description", "")),
            critical_damage=_number("critical_damage", values.get("critical_damage", 1.0), open_lower=True),
            failure_probabilities=_probabilities(values.get("failure_probabilities", PROBABILITIES)),
            options=options,
        )


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
    values = parse_mapping(read_text(path, "load spectrum"), str(path))
    with files_beside(path):
        return Spectrum.from_dict({"name": path.stem} | values)


def _block(entry: Any, base: Mapping[str, Any], number: int) -> Block:
    if not isinstance(entry, Mapping):
        raise InputError(f"blocks[{number}]", entry, "a mapping such as {distance: 4000, radial_force: -300}")
    entry = renamed(entry)
    name = str(entry.get("name") or f"block {number}")
    where = f"block '{name}'"
    for key in (key for key in entry if key in FIELDS and key not in BLOCK_FIELDS):
        allowed = "a load, because the roller is the same in all blocks of a spectrum"
        raise InputError(f"{where}.{key}", entry[key], allowed, "Give this field under `base`.")
    check_names(f"{where}: field", entry, BLOCK_FIELDS)
    if "distance" not in entry:
        raise InputError(f"{where}.distance", None, "the distance travelled per shift in m", "Add it to the block.")
    overrollings = entry.get("guide_overrollings")
    loads = {key: entry[key] for key in LOAD_FIELDS if key in entry}
    try:
        case = Case.from_dict({**base, **loads})
    except InputError as error:
        at = where if error.field in loads else "base"
        raise InputError(f"{at}.{error.field}", error.value, error.allowed, error.remedy) from None
    return Block(
        name,
        case,
        _number(f"{where}.distance", entry["distance"], unit="m"),
        None if overrollings is None else _number(f"{where}.guide_overrollings", overrollings),
    )


def _number(name: str, value: Any, open_lower: bool = False, unit: str = "-") -> float:
    lower = math.nextafter(0.0, 1.0) if open_lower else 0.0
    return number_in(value, name, f"a finite number {'>' if open_lower else '>='} 0", lower, sys.float_info.max, unit)


def _probabilities(values: Any) -> tuple[float, ...]:
    if not isinstance(values, (list, tuple)) or not values:
        raise InputError("failure_probabilities", values, "a list of numbers between 0 and 1")
    numbers = tuple(_number("failure_probabilities", value, open_lower=True) for value in values)
    for number in numbers:
        if number >= 1:
            raise InputError("failure_probabilities", number, "numbers between 0 and 1", "Give 0.1 for 10 %.")
    return tuple(sorted(set(numbers)))


def _table(path: Path) -> list[dict[str, Any]]:
    """Return the blocks of a CSV file, one from each line; empty cells are left out."""
    names, lines = csv_lines(read_text(path, "blocks"), path, "blocks", "block")
    return [{n: cell for n, cell in zip(names, line, strict=True) if cell} for line in lines.values()]


def overrollings_per_shift(spectrum: Spectrum) -> np.ndarray:
    """Return the overrollings of roller and guide per shift.

    Parameters
    ----------
    spectrum : Spectrum
        The load spectrum.

    Returns
    -------
    numpy.ndarray, shape (block, body)
        Overrollings [1]. A roller has distance / (2 pi r_A) of them. For the guide, the given number is used, otherwise
        its overrollings per hour times the hours of the block; NaN if neither is known.
    """
    rows = []
    for block in spectrum.blocks:
        case = block.case
        radius = rolling_radius(case.axis_distance, case.guide_profile_radius, np.deg2rad(case.contact_angle))
        guide = block.guide_overrollings
        if guide is None:
            per_hour = case.guide_overrollings_per_hour
            guide = math.nan if per_hour is None else per_hour * block.hours
        guide = 0.0 if block.distance == 0 and block.guide_overrollings is None else guide
        rows.append((block.distance * 1e3 / (2 * math.pi * float(radius)), guide))
    return np.array(rows, dtype=float)
