"""Read and check what describes one contact by itself: load, shape, materials, friction and
creepages.

normal_force: 106.7 kN
curvature_rolling: 0.0016 1/mm            # or semi_axes: [12 mm, 6 mm], lateral first
curvature_lateral: 0.00056 1/mm           # 0 for two discs, which need a width
materials: {youngs_modulus: 210 GPa, poisson_ratio: 0.28}      # or [name, name]
friction_coefficient: 0.33
longitudinal_creepage: [0, 0.1 %, 0.2 %]
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.contact.friction_laws import FrictionLaw, at_rest, law_of
from trackroller.errors import Collector, InputError, check_names, text_of, unknown_name
from trackroller.files import files_beside, read_text
from trackroller.materials import load_database
from trackroller.materials.properties import PROPERTIES, check_number
from trackroller.numerics.numbers import number_or_nan, written
from trackroller.numerics.plain import mapping_of, plain
from trackroller.parameters.accuracy import PRESETS
from trackroller.parameters.patch_fields import CREEPAGES, PATCH_FIELDS
from trackroller.yaml_file import errors_by_line, parse_mapping

SEMI_AXES = ("semi_axis_lateral", "semi_axis_rolling")
CURVATURES = ("curvature_rolling", "curvature_lateral")
ELASTIC = ("youngs_modulus", "poisson_ratio")
# keys of a file that hold numbers
NUMBERS = tuple(name for name in PATCH_FIELDS if name not in SEMI_AXES)
FILE_FIELDS = (
    "name",
    "description",
    *NUMBERS,
    "semi_axes",
    "materials",
    "friction_law",
    "accuracy",
)


@dataclass(frozen=True)
class Body:
    """A body of the contact: name of its material, Young's modulus [MPa] and Poisson's ratio
    [1].
    """

    name: str
    youngs_modulus: float
    poisson_ratio: float


@dataclass(frozen=True)
class PatchInputs:
    """What describes one contact in n cases, checked.

    Parameters
    ----------
    columns : mapping of str to numpy.ndarray
        Numbers by their names in `PATCH_FIELDS`, each (n,): either both curvatures or both
        semi-axes.
    bodies : tuple of Body
        Body 1, on which the forces act, and body 2.
    law : FrictionLaw
        Friction as a function of the slip speed.
    accuracy : str
        Rung of `PRESETS`.
    single : bool
        Whether no value was a list, so that the result has no dimension `case`.
    name, description : str
        Name and description.
    """

    columns: Mapping[str, np.ndarray]
    bodies: tuple[Body, Body]
    law: FrictionLaw
    accuracy: str
    single: bool
    name: str = "patch"
    description: str = ""

    @property
    def size(self) -> int:
        """Return the number of cases n."""
        return len(self.columns["normal_force"])

    @property
    def elastic_constants(self) -> tuple[float, float, float, float]:
        """Return Young's modulus [MPa] and Poisson's ratio [1] of body 1, and those of body 2."""
        first, second = self.bodies
        of_second = second.youngs_modulus, second.poisson_ratio
        return first.youngs_modulus, first.poisson_ratio, *of_second

    @property
    def is_discs(self) -> bool:
        """Return whether the bodies are two discs, which touch along a line."""
        return "width" in self.columns


def load_patch(path: Path | str, changes: Mapping[str, Any] | None = None) -> PatchInputs:
    """Read and check the file of a contact.

    Parameters
    ----------
    path : pathlib.Path or str
        The YAML file; its keys are `FILE_FIELDS`.
    changes : mapping, optional
        Values that replace those of the file.

    Raises
    ------
    InputError
        If an entry is wrong; the error names file, line, entry, value, what is allowed and what to
        do.
    """
    text = read_text(Path(path), "patch file")
    given = {"name": Path(path).stem} | parse_mapping(text, str(path))
    own = dict(changes or {})
    with errors_by_line(text, own), files_beside(path):
        return checked_patch(given | own)


def checked_patch(values: Mapping[str, Any]) -> PatchInputs:
    """Return the checked inputs of a mapping with the keys of a file; raise the errors of all
    entries together.
    """
    given = {key: value for key, value in values.items() if value is not None}
    wrong = Collector()
    fields: dict[str, Any] = {}
    columns: dict[str, np.ndarray] = {}
    with wrong.part():
        check_names("patch: key", given, FILE_FIELDS)
    for name in (name for name in NUMBERS if name in given):
        with wrong.part():
            columns[name] = _column(name, given[name])
    with wrong.part():
        columns |= _semi_axes(given.get("semi_axes"))
    with wrong.part():
        fields["bodies"] = _bodies(given.get("materials"))
    with wrong.part():
        fields["law"] = law_of(plain(given.get("friction_law"), "friction_law"))
    with wrong.part():
        fields["accuracy"] = _rung(given.get("accuracy", "standard"))
    with wrong.part():
        fields["name"] = text_of(given.get("name"), "name", "patch")
    with wrong.part():
        fields["description"] = text_of(given.get("description"), "description", lines=True)
    wrong.check()
    own_friction = at_rest(fields["law"])
    if own_friction is not None:
        columns.setdefault("friction_coefficient", np.array(own_friction))
    _check_needed(columns)
    _check_discs(columns)
    single = all(column.ndim == 0 for column in columns.values())
    usual = {
        name: np.array(own.default)
        for name, own in PATCH_FIELDS.items()
        if np.isfinite(own.default)
    }
    return PatchInputs(_along_case(usual | columns), single=single, **fields)


def _column(name: str, value: Any) -> np.ndarray:
    """Return the number of a field, shape (), or its list of numbers, shape (n,), in the unit of
    the field.
    """
    own = plain(value, name)
    if not isinstance(own, list):
        return np.array(_number(name, own))
    if not own:
        raise InputError(
            name,
            own,
            "a number, or a list of numbers",
            f"Write {name}: [..] with at least one number.",
        )
    return np.array([_number(name, one) for one in own])


def _number(name: str, value: Any) -> float:
    """Return a number in the unit of its field, within its bounds."""
    parameter = PATCH_FIELDS[name]
    number = number_or_nan(value, parameter.unit, name)
    if parameter.accepts(number):
        return number
    remedy = parameter.remedy(number, value)
    if name in CREEPAGES[:2] and np.isfinite(number):
        remedy = f"Write '{number:g} %' if per cent are meant."
    raise InputError(name, value, parameter.allowed(), remedy)


def _semi_axes(value: Any) -> dict[str, np.ndarray]:
    """Return the two semi-axes as columns; nothing if they are not given."""
    if value is None:
        return {}
    own = plain(value, "semi_axes")
    if not isinstance(own, list) or len(own) != len(SEMI_AXES):
        allowed = "two semi-axes [a, b] in mm: a across the rolling direction, b along it"
        raise InputError("semi_axes", value, allowed, "For example semi_axes: [0.3, 0.2].")
    return {name: _column(name, one) for name, one in zip(SEMI_AXES, own, strict=True)}


def _bodies(value: Any) -> tuple[Body, Body]:
    """Return the two bodies of a material that both are of, or of a list of two materials."""
    own = plain(value, "materials")
    pair = own if isinstance(own, list) else [own, own]
    if value is None or len(pair) != 2:
        allowed = (
            "a material of both bodies, or a list of two: that of body 1, on which the "
            "forces act, and of body 2"
        )
        remedy = (
            "Write names of the database, or materials: {youngs_modulus: 210 GPa, "
            "poisson_ratio: 0.3}."
        )
        raise InputError("materials", value, allowed, remedy)
    first, second = (_body(one, f"materials[{i + 1}]") for i, one in enumerate(pair))
    return first, second


def _body(value: Any, field: str) -> Body:
    """Return the body of a material of the database, or of a mapping, of which the elastic
    constants are enough.
    """
    own = mapping_of(value)
    if isinstance(own, Mapping) and set(own) - {"name"} == set(ELASTIC):
        name = text_of(own.get("name"), f"{field}.name", "given")
        return Body(name, *(check_number(PROPERTIES[key], own[key], field) for key in ELASTIC))
    material = load_database().material(own, field)
    return Body(material.name, material.youngs_modulus, material.poisson_ratio)


def _rung(value: Any) -> str:
    if not isinstance(value, str) or value not in PRESETS:
        raise unknown_name("accuracy", value, PRESETS)
    return value


def _check_needed(columns: Mapping[str, np.ndarray]) -> None:
    """Refuse a contact without load, friction or shape, and one with two shapes."""
    for name in ("normal_force", "friction_coefficient"):
        if name not in columns:
            raise InputError(name, None, PATCH_FIELDS[name].allowed())
    axes = [name for name in SEMI_AXES if name in columns]
    curved = [name for name in CURVATURES if name in columns]
    if axes and curved:
        shown = [columns[name].tolist() for name in SEMI_AXES]
        remedy = f"Remove semi_axes, or remove {' and '.join(curved)}."
        raise InputError(
            "semi_axes",
            shown,
            "either curvatures or semi-axes",
            remedy,
            f"stand beside {curved[0]}",
        )
    if not axes and len(curved) < len(CURVATURES):
        missing = next(name for name in CURVATURES if name not in curved)
        remedy = "Give curvature_rolling and curvature_lateral, or semi_axes: [a, b]."
        raise InputError(missing, None, PATCH_FIELDS[missing].allowed(), remedy)


def _check_discs(columns: Mapping[str, np.ndarray]) -> None:
    """Refuse discs without a width or with spin, a width of other bodies, and discs beside other
    bodies.
    """
    lateral = columns.get("curvature_lateral", np.ones(()))
    least = PATCH_FIELDS["curvature_rolling"].lower
    flat = lateral == 0.0
    if np.any(~flat & (lateral < least)):
        allowed = f"0, which stands for two discs, or a curvature >= {least:g} 1/mm"
        remedy = "Write curvature_lateral: 0, and width: 10 mm."
        raise InputError("curvature_lateral", float(lateral[lateral > 0].min()), allowed, remedy)
    if flat.any() and not flat.all():
        allowed = "0 in all cases, which stands for two discs, or > 0 in all cases"
        remedy = "Solve discs and ellipses one after the other."
        raise InputError(
            "curvature_lateral", columns["curvature_lateral"].tolist(), allowed, remedy
        )
    if flat.all() and "width" not in columns:
        remedy = "Write width: 10 mm, or curvature_lateral > 0 for an ellipse."
        raise InputError(
            "width", None, "the width of the two discs, because curvature_lateral is 0", remedy
        )
    if not flat.all() and "width" in columns:
        remedy = "Remove width, or write curvature_lateral: 0."
        allowed = "no width: only discs, with curvature_lateral 0, have one"
        raise InputError("width", columns["width"].tolist(), allowed, remedy)
    spin = columns.get("spin", np.zeros(()))
    if flat.all() and np.any(spin != 0.0):
        allowed = "0 for two discs: with spin the slip would change across their width"
        raise InputError(
            "spin", spin.tolist(), allowed, "Remove spin, or give curvature_lateral > 0."
        )


def _along_case(columns: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return all columns with the length of the longest list, (n,); single values hold in every
    case.
    """
    lengths = {name: column.size for name, column in columns.items() if column.ndim}
    n = max(lengths.values(), default=1)
    longest = next((name for name, length in lengths.items() if length == n), "")
    for name, length in lengths.items():
        if length not in (1, n):
            allowed = f"one value, or {n} values as {longest} has"
            raise InputError(name, f"{length} values", allowed, "Give lists of one length.")
    return {name: np.array(np.broadcast_to(column, n)) for name, column in columns.items()}


MOST_POINTS, USUAL_POINTS = 1000, 41  # of a range of creepages
_RANGE = re.compile(r"\s*([^:]+):([^:]+?)\s*%\s*(?::\s*(\d{1,6})\s*)?", re.ASCII)


def creepage_range(text: str, field: str = "--creepage") -> list[float]:
    """Return the evenly spaced creepages of a text such as '0:2%', or '0:2%:21' with their number.

    Parameters
    ----------
    text : str
        First and last creepage in per cent, and how many; 41 if not given.
    field : str
        Name for messages.

    Raises
    ------
    InputError
        If the text is no such range.

    Examples
    --------
    >>> creepage_range("0:2%:3")
    [0.0, 0.01, 0.02]
    """
    allowed = "a range of creepages in per cent, such as 0:2% or 0:2%:21 with the number of points"
    parts = _RANGE.fullmatch(text)
    if parts is None:
        raise InputError(field, text, allowed, f"Write {field} 0:2%.", "is no range in per cent")
    ends = [number_or_nan(end.strip().removesuffix("%")) for end in parts.groups()[:2]]
    count = int(parts[3] or USUAL_POINTS)
    if not (all(abs(end) <= 100.0 for end in ends) and 2 <= count <= MOST_POINTS):
        limits = f"; both ends between -100 and 100, and 2 to {MOST_POINTS} points"
        raise InputError(field, text, allowed + limits, f"Write {field} 0:2%.")
    return written(np.linspace(ends[0] / 100.0, ends[1] / 100.0, count).tolist())
