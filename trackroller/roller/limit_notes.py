"""Notes on the limits of a result: values that a limit lacks, and placeholders of materials that it
rests on.

A data set keeps the notes as sentences, a line each, which a user reads and which results of
several cases unite. Each note writes its sentence and reads it back, so that no other file depends
on the words.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.damage import checked_limits, fields_of, limits_of
from trackroller.damage.limit import SN_SCATTER, Limit, SolvedRollers, missing
from trackroller.damage.sn_curve import TYPICAL_SCATTER
from trackroller.damage.stud import FIELD as STUD_FIELD
from trackroller.damage.stud import LIMIT as STUD
from trackroller.damage.stud import MATERIAL, without_scatter
from trackroller.damage.wear import TABLE as WEAR_TABLE
from trackroller.materials.energy_wear import FIELD as ENERGY_WEAR
from trackroller.materials.material import UNNAMED
from trackroller.materials.properties import Value
from trackroller.parameters import BODIES, MAPPING_FIELDS, PARAMETERS
from trackroller.roller.case import CaseTable
from trackroller.roller.case_limits import solved_of, to_compute
from trackroller.roller.dataset import NOTES
from trackroller.roller.stored_inputs import is_default

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.roller.options import Options

_LACK = re.compile(
    r"(?P<limit>\w+): (?:the case gives|material '(?P<material>.+?)' has) no (?P<name>\w+)\. "
    r"(?P<remedy>.*)"
)
_PLACEHOLDERS = re.compile(
    r"(?P<limit>\w+): placeholders of material '(?P<material>.+?)': (?P<values>.*)\."
)
_VALUE = re.compile(
    r"(?P<name>\w+) \((?:(?P<note>.+?), )??"
    r"(?:expected from (?P<low>\S+) to (?P<high>[^\s)]+)(?: (?P<units>.+?))?|no range is "
    r"given)\)(?=, \w+ \(|$)"
)


# name, note and range of the scatter of a material that gives none
TYPICAL = (
    "scatter_in_cycles",
    "typical of S-N tests and of bearings",
    TYPICAL_SCATTER[0],
    TYPICAL_SCATTER[2],
)


@dataclass(frozen=True)
class Lack:
    """A value that a limit requires and that a case or a material does not have.

    Attributes
    ----------
    limit, name : str
        Name of the limit and of the value.
    material : str
        Name of the material; an empty text for a value of the case.
    remedy : str
        How to give the value.
    """

    limit: str
    name: str
    material: str = ""
    remedy: str = ""

    @property
    def words(self) -> str:
        """Return what is missing."""
        if self.material:
            return f"material '{self.material}' has no {self.name}"
        return f"the case gives no {self.name}"

    @property
    def line(self) -> str:
        """Return the sentence in a data set."""
        return f"{self.limit}: {self.words}. {self.remedy}"


@dataclass(frozen=True)
class Placeholder:
    """A value of a material without a source, on which a limit rests.

    Attributes
    ----------
    limit, material, name : str
        Name of the limit, of the material, and of its value.
    note : str
        Note on the value; that of a value of a pair begins with 'on' and the other material.
    low, high : float
        Range in which the value is expected; NaN if no range is given.
    units : str
        Unit of the range.
    """

    limit: str
    material: str
    name: str
    note: str = ""
    low: float = np.nan
    high: float = np.nan
    units: str = ""

    @classmethod
    def of(cls, limit: str, material: str, name: str, guess: Value) -> Placeholder:
        """Return the placeholder of a limit for a guess of a material."""
        return cls(
            limit, material, name, guess.note, *(guess.range or (np.nan, np.nan)), units=guess.unit
        )

    @property
    def on(self) -> str:
        """Return the material that it runs on if the value is that of a pair, otherwise an empty
        text.
        """
        first = self.note.partition(", ")[0]
        if first.startswith("on "):
            return first.removeprefix("on ")
        return ""

    @property
    def words(self) -> str:
        """Return the name with the note and the range."""
        span = "no range is given"
        if not np.isnan(self.low):
            span = f"expected from {self.low:g} to {self.high:g} {self.units}".rstrip(" -")
        return f"{self.name} ({', '.join(filter(None, (self.note, span)))})"


def placeholder_line(placeholders: list[Placeholder]) -> str:
    """Return the sentence in a data set on the placeholders of one material on which one limit
    rests.
    """
    first = placeholders[0]
    values = ", ".join(one.words for one in placeholders)
    return f"{first.limit}: placeholders of material '{first.material}': {values}."


def notes_of(ds: xr.Dataset) -> list[str]:
    """Return the notes of a data set, a sentence each; those on temperature included."""
    return [note for note in str(ds.attrs.get(NOTES, "")).split("\n") if note]


def lacks_of(ds: xr.Dataset) -> list[Lack]:
    """Return the values that the limits of a result lack."""
    matches = map(_LACK.fullmatch, notes_of(ds))
    return [Lack(**match.groupdict(default="")) for match in matches if match is not None]


def placeholders_of(ds: xr.Dataset) -> list[Placeholder]:
    """Return the placeholders of materials on which the limits of a result rest."""
    out = []
    for note in notes_of(ds):
        placeholders = _PLACEHOLDERS.fullmatch(note)
        if placeholders is None:
            continue
        for value in _VALUE.finditer(placeholders["values"]):
            low = float(value["low"] or np.nan)
            high = float(value["high"] or np.nan)
            texts = (
                placeholders["limit"],
                placeholders["material"],
                value["name"],
                value["note"] or "",
            )
            out.append(Placeholder(*texts, low, high, value["units"] or ""))
    return out


def notes_on_limits(table: CaseTable, options: Options) -> list[str]:
    """Return one sentence for each value that a limit asked for lacks, and for each that is a
    placeholder.
    """
    solved = solved_of(table, {}, options)
    bodies = {"roller": table.roller, "guide": table.guide}
    names = {body: own.name for body, own in bodies.items()}
    guesses = dict.fromkeys(
        (str(name), tuple(own.items()))
        for body in bodies.values()
        for name, own in zip(body.name, body.guesses, strict=True)
    )
    out = []
    served = to_compute(solved, options)
    for limit in limits_of(options.outputs, options.not_checked):
        out += [lack.line for lack in _lacks(limit, solved, names)]
        required = {}
        if limit in served:
            required = dict(limit.required_of(solved))
            if WEAR_TABLE.name in limit.required(solved.options):
                required[ENERGY_WEAR] = np.stack([table.wear_table == ""] * len(BODIES), axis=1)
        for material, guessed in guesses:
            of = np.stack([own.name == material for own in bodies.values()], axis=1)
            used = [
                (name, guess)
                for name, guess in guessed
                if name in required and np.any(required[name] & of)
            ]
            placeholders = [
                Placeholder.of(limit.name, material, name, guess) for name, guess in used
            ]
            if np.any(_typical_scatter(limit, solved) & of):
                placeholders.append(Placeholder(limit.name, material, *TYPICAL))
            if placeholders:
                out.append(placeholder_line(placeholders))
        if limit.name == STUD.name and limit in served and _is_off_median(solved):
            typical = without_scatter(solved.cases)
            texts = dict.fromkeys(solved.cases[STUD_FIELD.name][typical].tolist())
            own = dict.fromkeys(_material_of_stud(text) for text in texts)
            out += [placeholder_line([Placeholder(STUD.name, name, *TYPICAL)]) for name in own]
    return list(dict.fromkeys(out))


def _typical_scatter(limit: Limit, solved: SolvedRollers) -> np.ndarray:
    """Return where a limit takes the typical scatter, because its material gives none, (n, 2)."""
    materials = solved.materials
    unknown = np.isnan(materials["scatter_in_cycles"]) & np.isnan(materials["scatter_in_stress"])
    counts = _is_off_median(solved) and limit.distribution == SN_SCATTER
    return np.asarray(unknown & counts)


def _is_off_median(solved: SolvedRollers) -> bool:
    """Return whether lives are those at another failure probability than 50 %."""
    return bool(solved.options["failure_probability"] != 0.5)


def _material_of_stud(text: str) -> str:
    """Return the name of the material of a stud that is given as JSON; 'stud' without one."""
    return str(json.loads(text).get(MATERIAL, STUD.name))


def _lacks(limit: Limit, solved: SolvedRollers, names: Mapping[str, np.ndarray]) -> Iterator[Lack]:
    """Yield each value that a limit requires and that a case or a material does not have.

    Parameters
    ----------
    limit : Limit
        The limit.
    solved : SolvedRollers
        The cases.
    names : mapping of str to numpy.ndarray
        Names of the materials by body, (n,) each.
    """
    for name in limit.required(solved.options):
        column = solved.cases.get(name)
        if column is not None and missing(column).any():
            yield Lack(limit.name, name, remedy=_remedy_of_field(name))
    for name, here in limit.required_of(solved):
        unknown = np.isnan(solved.materials[name]) & here
        materials = np.concatenate([names[body][unknown[:, i]] for i, body in enumerate(BODIES)])
        for material in dict.fromkeys(materials):
            yield Lack(limit.name, name, material, _remedy_of_value(name, material))


def _remedy_of_field(name: str) -> str:
    """Say how a field of a case is entered: its meaning with its unit, or with an example of a
    mapping.
    """
    if name in MAPPING_FIELDS:
        return f"Add it to the case, or with --set: {MAPPING_FIELDS[name]}."
    parameter = PARAMETERS[name]
    return (
        f"Add it to the case, or with --set {name}=NUMBER: {parameter.long_name} "
        f"[{parameter.unit}]."
    )


def _remedy_of_value(name: str, material: str) -> str:
    """Say how a value of a material is entered."""
    if material == UNNAMED:
        return f"Add {name}: NUMBER to the material of the case."
    return (
        f"Enter it in config/materials.yaml under materials.{material}, or in the case: "
        f"{{like: {material}, {name}: NUMBER}}."
    )


def given_in_vain(values: Mapping[str, Any], idle: Iterable[str]) -> dict[str, list[str]]:
    """Return the values that were given for limits which were not checked, and for nothing else.

    Parameters
    ----------
    values : mapping
        Values of a case by name.
    idle : iterable of str
        Names of the limits that were not checked.

    Returns
    -------
    dict of str to list of str
        The limits that would use a value, by its name. Defaults are left out, and `travel`, which
        any study may have.
    """
    users = {
        name: [limit.name for limit in checked_limits() if name in fields_of(limit)]
        for name in values
    }
    unused = {
        name: own for name, own in users.items() if own and {*own} <= {*idle} and name != "travel"
    }
    return {name: own for name, own in unused.items() if not is_default(name, values[name])}
