"""Read a carriage file: masses, drive, rollers, preload and load cases.

mass: {value: 40 kg, at: [0, 0, 60]}          # mm: x forward, y left, z up
payloads: [{value: 60 kg, at: [80, 0, 150]}]
drive: {at: [0, 0, -20]}
rollers:
  FL: {at: [150, 40, 0], pushes: [0, -1, 0], x_R: [0, 0, 1], kind: locating, roller: roller.yaml}
preload: [{pair: [FL, FR], force: 100 N}]
cases:
  - {name: curve, share: 1, speed: 1 m/s, curve_radius: 1.5 m}     # positive: to the left
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.damage.catalogue import FIELD as CATALOGUE
from trackroller.damage.catalogue import LAWS, apply_stroke_factor, catalogue_km
from trackroller.errors import (
    Collector,
    InputError,
    check_names,
    text_of,
    unknown_name,
)
from trackroller.files import files_beside, find_beside, read_text
from trackroller.numerics.numbers import number_in, number_or_nan
from trackroller.numerics.plain import mapping_of
from trackroller.numerics.units import split_quantity
from trackroller.parameters import MATERIAL_FIELDS
from trackroller.roller.aliases import OTHER_OPTIONS, WRITTEN, with_options
from trackroller.roller.case import Case
from trackroller.roller.duty import (
    STROKES,
    checked_duty,
    in_hours,
    is_of_strokes,
    refuse_overrollings,
    strokes_in,
)
from trackroller.roller.requirement import Requirement, checked_requirement
from trackroller.roller.settings import LOADS, checked_case
from trackroller.yaml_file import errors_by_line, parse_mapping

FILE_FIELDS = (
    *("name", "description", "mass", "payloads", "drive", "rollers", "preload", "cases"),
    *("distance", "duty", "failure_probability"),
)
ROLLER_FIELDS = (
    "at",
    "pushes",
    "x_R",
    "kind",
    "roller",
    "stiffness",
    "bearing",
    "structure",
    "catalogue",
)
CASE_FIELDS = (
    *(
        "name",
        "share",
        "acceleration",
        "speed",
        "curve_radius",
        "gradient",
        "cant",
        "payload",
        "forces",
    ),
)
KINDS = ("locating", "floating")
CHANCE = "failure_probability"  # option that a carriage states for all of its rollers
OF_LOADS = (*LOADS, "velocity")  # parameters of a roller that its carriage gives
SQUARE = 1e-6  # largest cosine between directions that count as perpendicular
# of the distance: rollers of a pair press against each other if they are off their line by less
IN_LINE = 1e-3
LARGEST_RADIUS = 1e12  # of a curve of the track [mm]; beyond it, the track is straight
_POINT = "three numbers [x, y, z] in mm: x forward, y left, z up"
_AT = "Write at: [0, 0, 60]."


@dataclass(frozen=True)
class PointMass:
    """A mass [kg] at a point (3,) [mm]."""

    value: float
    at: np.ndarray


@dataclass(frozen=True)
class CatalogueRoller:
    """What a maker's catalogue states of a roller, with the keys of the field `catalogue` of a
    case.

    Parameters
    ----------
    radial_force, axial_force : float
        Permissible radial and axial force [N].
    basic_life : float
        Basic life BL [km].
    law : str
        Law of the life by the load factor, see `trackroller.damage.catalogue.catalogue_km`.
    offset : float
        Load factor that counts without any load [1]; NaN for that of the law.
    moment : float
        Permissible moment [N mm], which does not count here: the statics of a carriage knows no
        moment of a roller.
    exponent, speed_factor, stroke_factor : float
        Exponent of the life in place of that of the law, factor of the life for speed, and factor
        of both permissible forces for short strokes [1]; NaN if not given.
    """

    radial_force: float
    axial_force: float
    basic_life: float
    law: str = LAWS[0]
    offset: float = math.nan
    moment: float = math.nan
    exponent: float = math.nan
    speed_factor: float = math.nan
    stroke_factor: float = math.nan

    def load_factor(self, radial: np.ndarray, axial: np.ndarray) -> np.ndarray:
        """Return the sum of the ratios of both forces [N] to their permissible values [1]."""
        ratios = np.abs(radial) / self.radial_force + np.abs(axial) / self.axial_force
        return apply_stroke_factor(ratios, self.stroke_factor)

    def life(self, load_factor: np.ndarray) -> np.ndarray:
        """Return the life at load factors [1], in km."""
        return catalogue_km(
            load_factor,
            np.asarray(self.basic_life),
            np.asarray(self.law),
            self.offset,
            self.exponent,
            self.speed_factor,
        )


@dataclass(frozen=True)
class MountedRoller:
    """A roller on a carriage.

    Parameters
    ----------
    name : str
        Its name.
    at : numpy.ndarray, shape (3,)
        Place of its centre [mm].
    pushes, axis : numpy.ndarray, shape (3,)
        Unit vectors: in which direction it presses on its rail, and its own axis x_R.
    locating : bool
        Whether it carries axial load.
    case : Case, optional
        The roller, whose loads are replaced.
    options : mapping
        Options of the solver in the roller's file.
    given : mapping
        The roller's file.
    required : mapping of str to Requirement
        What the roller's file requires of outputs.
    stiffness : tuple of float, optional
        Radial and axial stiffness of the whole roller, in place of that of its contacts [N/mm].
    compliance : tuple of float
        Radial and axial compliance of bearing and structure [mm/N].
    catalogue : CatalogueRoller, optional
        What a maker's catalogue states.
    """

    name: str
    at: np.ndarray
    pushes: np.ndarray
    axis: np.ndarray
    locating: bool
    case: Case | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    given: Mapping[str, Any] = field(default_factory=dict)
    required: Mapping[str, Requirement] = field(default_factory=dict)
    stiffness: tuple[float, float] | None = None
    compliance: tuple[float, float] = (0.0, 0.0)
    catalogue: CatalogueRoller | None = None


@dataclass(frozen=True)
class Preload:
    """Preload of two rollers that press against each other: the force between them [N], or their
    play [mm].
    """

    pair: tuple[str, str]
    force: float = 0.0
    play: float = 0.0


@dataclass(frozen=True)
class LoadCase:
    """How a carriage moves, and what acts on it.

    Parameters
    ----------
    name : str
        Its name.
    share : float
        Share of the travel [1].
    acceleration : float
        Acceleration along x [m/s2].
    speed : float, optional
        Speed [m/s].
    curve_radius : float
        Radius of the curve of the origin [mm]: > 0 to the left, inf on a straight.
    gradient, cant : float
        Slope of the track, > 0 uphill, and its lateral tilt, > 0 towards the left [rad].
    payload : float
        Share of the payloads that is on board [1].
    forces : tuple
        Process forces (3,) [N], each with its point (3,) [mm].
    """

    name: str
    share: float = 1.0
    acceleration: float = 0.0
    speed: float | None = None
    curve_radius: float = math.inf
    gradient: float = 0.0
    cant: float = 0.0
    payload: float = 1.0
    forces: tuple[tuple[np.ndarray, np.ndarray], ...] = ()


@dataclass(frozen=True)
class Carriage:
    """A carriage on track rollers; `load_carriage` makes it.

    Parameters
    ----------
    name, description : str
        Name and description.
    mass : PointMass
        The carriage without payload.
    payloads : tuple of PointMass
        Its payloads.
    drive : numpy.ndarray, optional
        Point (3,) at which the force along the track acts [mm].
    rollers : tuple of MountedRoller
        Its rollers.
    preloads : tuple of Preload
        Preload and play of pairs.
    cases : tuple of LoadCase
        Its load cases, whose shares add up to 1.
    distance : float
        Travel per shift [m].
    duty : mapping, optional
        Hours a day and days a year of travel.
    strokes : mapping, optional
        The strokes that the duty was given in, from which its hours follow.
    """

    name: str
    mass: PointMass
    rollers: tuple[MountedRoller, ...]
    cases: tuple[LoadCase, ...]
    description: str = ""
    payloads: tuple[PointMass, ...] = ()
    drive: np.ndarray | None = None
    preloads: tuple[Preload, ...] = ()
    distance: float = 1000.0
    duty: Mapping[str, float] | None = None
    strokes: Mapping[str, float] | None = None

    @property
    def stroke(self) -> float:
        """Return the length of a stroke, one way [m]; NaN for a duty in hours."""
        return math.nan if self.strokes is None else self.strokes["stroke"]


def load_carriage(source: Path | str | Mapping[str, Any]) -> Carriage:
    """Read and check a carriage.

    Parameters
    ----------
    source : pathlib.Path, str or mapping
        The YAML file, or a mapping with its keys, in which `roller` may be a mapping or a `Case`,
        too.

    Raises
    ------
    InputError
        If an entry is wrong; the error names the entry, its value, what is allowed and what to do.
    """
    values = mapping_of(source)
    if isinstance(values, Mapping):
        return carriage_of(values)
    if not isinstance(source, str | Path):
        allowed = "the name of a carriage file, or a mapping with its keys"
        raise InputError(
            "carriage", type(source).__name__, allowed, "Write tr.carriage('shuttle.yaml')."
        )
    path = Path(source)
    text = read_text(path, "carriage file")
    values = parse_mapping(text, str(path))
    with errors_by_line(text, aliases=WRITTEN), files_beside(path):
        return carriage_of({"name": path.stem} | values)


def written_out(source: Path | str | Mapping[str, Any], field: str = "carriage") -> dict[str, Any]:
    """Return the keys of a carriage file with the values of its rollers in place of their files.

    A study keeps them, so that it can be solved without these files. Values of a roller that its
    file does not name are left out.

    Parameters
    ----------
    source : pathlib.Path, str or mapping
        The file, or a mapping with its keys.
    field : str
        Name of the entry that holds the path, for messages.

    Raises
    ------
    InputError
        As `load_carriage`; or if a roller states its material in its own file, because a study
        names materials.
    """
    values = mapping_of(source)
    if not isinstance(values, Mapping):
        path = find_beside(str(source), field)
        text = read_text(path, "carriage file")
        with errors_by_line(text, file=str(path), aliases=WRITTEN), files_beside(path):
            values = {"name": path.stem} | parse_mapping(text, str(path))
            return written_out(values, field)
    whole = carriage_of(values)
    rollers = {}
    for roller, entry in zip(whole.rollers, values["rollers"].values(), strict=True):
        rollers[roller.name] = dict(entry)
        if roller.case is not None:
            rollers[roller.name]["roller"] = _stated(roller)
    out = {**values, "rollers": rollers}
    return {key: value for key, value in out.items() if value is not None}


def _stated(roller: MountedRoller) -> dict[str, Any]:
    """Return what the file of a roller states, as values of YAML."""
    assert roller.case is not None
    given = {
        name: v for name, v in roller.case.as_dict().items() if name not in roller.case.not_given
    }
    for name in MATERIAL_FIELDS:
        if not isinstance(given.get(name, ""), str):
            remedy = "Add it to the database by `trackroller materials add`, and write its name."
            where = f"rollers.{roller.name}.roller.{name}"
            raise InputError(where, "a mapping", "the name of a material", remedy, "is no name")
    plain = {name: value for name, value in given.items() if value is not None and value != ""}
    options = {
        key: list(value) for key, value in roller.options.items() if isinstance(value, tuple)
    }
    return {**plain, **roller.options, **options}


def carriage_of(values: Mapping[str, Any]) -> Carriage:
    """Return the carriage of a mapping with the keys of a file; see `load_carriage`."""
    wrong = Collector()
    fields: dict[str, Any] = {}
    with wrong.part():
        values = with_options(values)
    with wrong.part():
        check_names("carriage: key", values, (*FILE_FIELDS, *OTHER_OPTIONS))
    for key, read in _READERS.items():
        with wrong.part():
            if values.get(key) is not None:
                fields[key] = read(values[key])
            elif key in ("mass", "rollers", "cases"):
                raise InputError(key, None, _NEEDED[key], f"Add {_EXAMPLES[key]}.")
    wrong.check()
    with wrong.part():
        if values.get("preload") is not None:
            fields["preloads"] = _preloads(values["preload"], fields["rollers"])
    with wrong.part():
        if values.get(CHANCE) is not None:
            fields["rollers"] = _with_chance(fields["rollers"], values[CHANCE])
    with wrong.part():
        check_curves(fields["cases"], fields["rollers"])
    with wrong.part():
        if is_of_strokes(fields.get("duty")):
            fields |= _by_strokes(fields["duty"], fields["cases"], fields["rollers"])
    with wrong.part():
        _check_payloads(values["cases"], fields)
    with wrong.part():
        fields["name"] = text_of(values.get("name"), "name", "carriage")
    with wrong.part():
        fields["description"] = text_of(values.get("description"), "description", lines=True)
    wrong.check()
    return Carriage(**fields)


def _payloads(value: Any) -> tuple[PointMass, ...]:
    masses = _list(value, "payloads")
    return tuple(_mass(mass, f"payloads[{i}]") for i, mass in enumerate(masses, 1))


def _distance(value: Any) -> float:
    return _number(value, "distance", "m", "a distance > 0 per shift", lower=1e-9)


def _with_chance(rollers: Sequence[MountedRoller], value: Any) -> tuple[MountedRoller, ...]:
    """Return the rollers with the failure probability of their carriage; refuse a file of a roller
    that states another one.
    """
    chance = number_in(value, CHANCE, "a share between 0 and 1, such as 5%", 1e-9, 1.0 - 1e-9, "-")
    wrong = Collector()
    out = []
    for roller in rollers:
        own = roller.options.get(CHANCE)
        if own is not None and number_or_nan(own) != chance:
            where = f"rollers.{roller.name}.roller.{CHANCE}"
            remedy = f"Remove it there: the carriage states {chance:g} for all rollers."
            wrong.errors.append(
                InputError(where, own, "one failure probability", remedy, "is another one")
            )
        stated = {CHANCE: chance}
        out.append(
            replace(roller, options={**roller.options, **stated}, given={**roller.given, **stated})
        )
    wrong.check()
    return tuple(out)


def _by_strokes(
    duty: Mapping[str, float], cases: Sequence[LoadCase], rollers: Sequence[MountedRoller]
) -> dict[str, Any]:
    """Return the duty of a carriage in hours, and its strokes."""
    if STROKES[2] in duty:
        wrong = "is not known of a carriage: it follows from the places of its rollers"
        raise InputError(
            f"duty.{STROKES[2]}",
            duty[STROKES[2]],
            "strokes_per_day and stroke",
            "Remove it.",
            wrong,
        )
    for roller in rollers:
        if roller.case is None:
            given = None
        else:
            given = roller.case.guide_overrollings_per_hour
        refuse_overrollings(given, f"rollers.{roller.name}.roller.guide_overrollings_per_hour")
    for case in cases:
        if case.speed is None:
            allowed = "the speed of each load case, which turns strokes into hours"
            raise InputError(f"case '{case.name}'.speed", None, allowed, "Add speed: 1 m/s.")
    hours_per_km = sum(case.share / (3.6 * case.speed) for case in cases if case.speed is not None)
    return {"duty": in_hours(duty, hours_per_km), "strokes": strokes_in(duty)}


def _check_payloads(entries: Sequence[Mapping[str, Any]], fields: Mapping[str, Any]) -> None:
    """Refuse a load case that states a share of payloads where the carriage has no payload."""
    for case, entry in zip(fields["cases"], entries, strict=True):
        if case.payload > 0 and entry.get("payload") is not None and not fields.get("payloads"):
            allowed = "a share of the payloads of the carriage"
            remedy = "Add payloads: [{value: 60 kg, at: [80, 0, 150]}], or remove payload here."
            raise InputError(
                f"case '{case.name}'.payload",
                entry["payload"],
                allowed,
                remedy,
                "has no payload to count",
            )


_NEEDED = {
    "mass": "the carriage's own mass",
    "rollers": "the rollers by name",
    "cases": "a list of load cases",
}
_EXAMPLES = {
    "mass": "mass: {value: 40 kg, at: [0, 0, 60]}",
    "rollers": "rollers: {FL: {at: [150, 40, 0], pushes: [0, -1, 0], x_R: [0, 0, 1], kind: "
    "locating, roller: r.yaml}}",
    "cases": "cases: [{name: run, share: 1, speed: 1 m/s}]",
}


def _entries(value: Any, where: str, names: Sequence[str], example: str) -> Mapping[str, Any]:
    """Return a mapping whose keys are known."""
    if not isinstance(value, Mapping):
        raise InputError(where, value, f"a mapping with {', '.join(names)}", f"Write {example}.")
    check_names(f"{where}: key", value, names)
    return value


def _list(value: Any, where: str) -> list[Any]:
    if not isinstance(value, (list, tuple)):
        raise InputError(
            where, value, "a list", "Begin each entry with '- ', or write [ ] around them."
        )
    return list(value)


def _number(
    value: Any, where: str, unit: str, allowed: str, lower: float = -1e12, upper: float = 1e12
) -> float:
    if unit != "-":
        allowed = f"{allowed} [{unit}]"
    return number_in(value, where, allowed, lower, upper, unit)


def _vector(value: Any, where: str, unit: str, allowed: str, remedy: str) -> np.ndarray:
    values = value
    if isinstance(value, np.ndarray):
        values = value.tolist()
    if not isinstance(values, (list, tuple)) or len(values) != 3:
        raise InputError(where, value, allowed, remedy)
    return np.array([_number(one, where, unit, allowed) for one in values])


def _direction(value: Any, where: str) -> np.ndarray:
    allowed = "a direction [x, y, z]; its length does not count"
    vector = _vector(value, where, "-", allowed, "Write [0, -1, 0].")
    length = float(np.linalg.norm(vector))
    if length == 0:
        raise InputError(where, value, allowed, "Write [0, -1, 0].", "has no direction")
    return vector / length


def _mass(value: Any, where: str) -> PointMass:
    entry = _entries(value, where, ("value", "at"), "{value: 40 kg, at: [0, 0, 60]}")
    for key in ("value", "at"):
        if entry.get(key) is None:
            needs = {"value": "a mass in kg", "at": _POINT}[key]
            raise InputError(f"{where}.{key}", None, needs, "Write {value: 40 kg, at: [0, 0, 60]}.")
    parts = split_quantity(entry["value"])
    if parts and parts[1] in ("N", "kN"):
        newton = float(parts[0]) * (1000 if parts[1] == "kN" else 1)
        remedy = f"Write {newton / 9.80665:.6g} kg if {entry['value']} is its weight."
        raise InputError(f"{where}.value", entry["value"], "a mass in kg", remedy, "is a force")
    mass = _number(entry["value"], f"{where}.value", "kg", "a mass >= 0", lower=0.0)
    return PointMass(mass, _vector(entry["at"], f"{where}.at", "mm", _POINT, _AT))


def _drive(value: Any) -> np.ndarray:
    entry = _entries(value, "drive", ("at",), "drive: {at: [0, 0, -20]}")
    return _vector(entry.get("at"), "drive.at", "mm", _POINT, "Write drive: {at: [0, 0, -20]}.")


def _rollers(value: Any) -> tuple[MountedRoller, ...]:
    if not isinstance(value, Mapping) or not value:
        raise InputError("rollers", value, "rollers by name", f"Write {_EXAMPLES['rollers']}.")
    wrong = Collector()
    rollers = []
    files: dict[object, Any] = {}
    for name, entry in value.items():
        with wrong.part("rollers", str(name)):
            rollers.append(_roller(_roller_name(name), entry, files))
    wrong.check()
    if not any(roller.locating for roller in rollers):
        remedy = "Write kind: locating for the rollers that guide the carriage along their axes."
        raise InputError(
            "rollers",
            ", ".join(r.name for r in rollers),
            "at least one locating roller",
            remedy,
            "float all",
        )
    return tuple(rollers)


def _roller(name: str, value: Any, files: dict[object, Any]) -> MountedRoller:
    """Return a roller of the entry under its name; raise all errors of the entry together."""
    where = f"rollers.{name}"
    example = "{at: [150, 40, 0], pushes: [0, -1, 0], x_R: [0, 0, 1], roller: r.yaml}"
    entry = _entries(value, where, ROLLER_FIELDS, example)
    wrong = Collector()
    vectors: dict[str, np.ndarray] = {}
    for key in ("at", "pushes", "x_R"):
        with wrong.part():
            vectors[key] = _vector_of_roller(key, entry.get(key), f"{where}.{key}")
    with wrong.part():
        kind = entry.get("kind", KINDS[0])
        if kind not in KINDS:
            raise unknown_name(f"{where}.kind", str(kind), KINDS)
    of_file: dict[str, Any] = {}
    with wrong.part():
        if entry.get("roller") is not None:
            of_file = _case(entry["roller"], f"{where}.roller", files)
    optional: dict[str, Any] = {}
    with wrong.part():
        optional |= _stiffness_of_roller(entry, where)
    with wrong.part():
        if "catalogue" in entry:
            optional["catalogue"] = _catalogue(entry["catalogue"], f"{where}.catalogue")
    wrong.check()
    _check_directions(where, vectors["pushes"], vectors["x_R"])
    case = of_file.get("case")
    if "catalogue" in optional and case is not None and case.catalogue is not None:
        allowed = "the catalogue once"
        remedy = "Remove it here: the one in the file of the roller counts its moment, too."
        raise InputError(
            f"{where}.catalogue", entry["catalogue"], allowed, remedy, "stands in both places"
        )
    return MountedRoller(
        name,
        vectors["at"],
        vectors["pushes"],
        vectors["x_R"],
        kind == KINDS[0],
        **(optional | of_file),
    )


def _vector_of_roller(key: str, value: Any, where: str) -> np.ndarray:
    """Return the place of a roller [mm], or one of its directions."""
    allowed = "a direction [x, y, z]"
    if key == "at":
        allowed = _POINT
    if value is None:
        raise InputError(where, None, allowed, "Add it.")
    if key == "at":
        return _vector(value, where, "mm", _POINT, _AT)
    return _direction(value, where)


def _stiffness_of_roller(entry: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return the stiffness that an entry states, and the compliance [mm/N] of bearing and
    structure in series.
    """
    stated = {}
    if "stiffness" in entry:
        stated["stiffness"] = _stiffness(entry["stiffness"], f"{where}.stiffness")
    series = [
        _stiffness(entry[key], f"{where}.{key}") for key in ("bearing", "structure") if key in entry
    ]
    return stated | {"compliance": tuple(sum(1 / one[i] for one in series) for i in (0, 1))}


def _check_directions(where: str, pushes: np.ndarray, axis: np.ndarray) -> None:
    """Refuse directions between which a roller cannot roll along the track."""
    angle = math.degrees(math.acos(min(1.0, abs(float(pushes @ axis)))))
    if abs(pushes @ axis) > SQUARE:
        allowed = "a direction perpendicular to x_R"
        remedy = "A roller presses at right angles to its axis: change pushes or x_R."
        raise InputError(
            f"{where}.pushes", pushes.tolist(), allowed, remedy, f"stands at {angle:.6g} deg to x_R"
        )
    for key, way in (("pushes", pushes), ("x_R", axis)):
        if abs(way[0]) > SQUARE:
            allowed = "a direction across the track, whose x is 0"
            raise InputError(
                f"{where}.{key}",
                way.tolist(),
                allowed,
                "The carriage travels along x: write x as 0.",
            )


def _case(value: Any, where: str, files: dict[object, Any]) -> dict[str, Any]:
    """Return case, options and given values of a roller: a file, a mapping or a `Case`.

    Rollers may share a file or a mapping, which is read once and kept in `files`; its errors are
    stated once.
    """
    if isinstance(value, Case):
        return {
            "case": value,
            "given": {n: v for n, v in value.as_dict().items() if n not in value.not_given},
        }
    shared: object = id(value) if isinstance(value, Mapping) else str(value)
    if shared not in files:
        files[shared] = {}  # stays where the roller is wrong
        files[shared] = _read_roller(value, where)
    return dict(files[shared])


def _read_roller(value: Any, where: str) -> dict[str, Any]:
    """Return case, options and given values of the roller of a mapping or a file."""
    if isinstance(value, Mapping):
        case, options, beside = checked_case(value)
        return {
            "case": case,
            "options": options,
            "given": dict(value),
            "required": _required(beside),
        }
    path = find_beside(value, where)
    text = read_text(path, "roller file")
    given = parse_mapping(text, str(path))
    with errors_by_line(text, file=str(path), aliases=WRITTEN):
        case, options, beside = checked_case(given)
    return {"case": case, "options": options, "given": given, "required": _required(beside)}


def _required(beside: Mapping[str, Any]) -> dict[str, Requirement]:
    """Return what the file of a roller requires, from its entries beside the case."""
    requirements: dict[str, Requirement] = checked_requirement(
        beside.get("requirement", {}), beside.get("duty")
    )
    return requirements


def _stiffness(value: Any, where: str) -> tuple[float, float]:
    """Return radial and axial stiffness; a single number is both."""
    if isinstance(value, Mapping):
        entry = value
    else:
        entry = {"radial": value, "axial": value}
    check_names(f"{where}: key", entry, ("radial", "axial"))
    radial = entry.get("radial", entry.get("axial"))
    both = (radial, entry.get("axial", radial))
    return tuple(
        _number(one, where, "N/mm", "a stiffness > 0", lower=1e-9, upper=1e15) for one in both
    )  # type: ignore[return-value]


def _catalogue(value: Any, where: str) -> CatalogueRoller:
    """Return the entries of a maker's catalogue, which are those of the field `catalogue` of a
    case.
    """
    if not isinstance(value, Mapping):
        example = "{radial_force: 9700 N, axial_force: 4000 N, basic_life: 174 km, law: dry}"
        raise InputError(
            where, value, "a mapping of the values of a catalogue", f"Write {example}."
        )
    return CatalogueRoller(**replace(CATALOGUE, name=where).canonical(value))


def _preloads(value: Any, rollers: Sequence[MountedRoller]) -> tuple[Preload, ...]:
    known = {roller.name: roller for roller in rollers}
    wrong = Collector()
    preloads = []
    paired: set[str] = set()
    for i, entry in enumerate(_list(value, "preload")):
        where = f"preload[{i + 1}]"
        with wrong.part("preload", str(i)):
            preload = _preload(entry, where, known)
            preloads.append(preload)
            twice = paired & {*preload.pair}
            if twice:
                raise InputError(
                    f"{where}.pair",
                    sorted(twice)[0],
                    "each roller in one pair",
                    "Remove one of the pairs.",
                )
            paired |= {*preload.pair}
    wrong.check()
    return tuple(preloads)


def _preload(value: Any, where: str, known: Mapping[str, MountedRoller]) -> Preload:
    entry = _entries(value, where, ("pair", "force", "play"), "{pair: [FL, FR], force: 100 N}")
    pair = entry.get("pair")
    if not isinstance(pair, (list, tuple)) or len(pair) != 2 or pair[0] == pair[1]:
        raise InputError(f"{where}.pair", pair, "two rollers", "Write pair: [FL, FR].")
    check_names(f"{where}.pair", map(str, pair), known)
    if ("force" in entry) == ("play" in entry):
        raise InputError(
            where, dict(entry), "either force or play", "Write force: 100 N, or play: 0.05 mm."
        )
    one, other = (known[str(name)] for name in pair)
    way = other.at - one.at
    off = np.linalg.norm(way - (way @ one.pushes) * one.pushes)
    if one.pushes @ other.pushes > -1 + SQUARE or off > IN_LINE * max(
        float(np.linalg.norm(way)), 1e-9
    ):
        allowed = "two rollers that press against each other on one line"
        raise InputError(
            f"{where}.pair", list(pair), allowed, "Name the roller on the other side of the rails."
        )
    if "force" in entry:
        return Preload(
            (one.name, other.name),
            _number(entry["force"], f"{where}.force", "N", "a force >= 0", lower=0.0),
        )
    play = _number(entry["play"], f"{where}.play", "mm", "a play >= 0", lower=0.0)
    return Preload((one.name, other.name), play=play)


def _cases(value: Any) -> tuple[LoadCase, ...]:
    wrong = Collector()
    cases = []
    entries = _list(value, "cases")
    for i, entry in enumerate(entries):
        with wrong.part("cases", str(i)):
            cases.append(_load_case(entry, i + 1))
    wrong.check()
    if not cases:
        raise InputError(
            "cases", value, "a list of load cases that is not empty", f"Write {_EXAMPLES['cases']}."
        )
    names = [case.name for case in cases]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                "cases", name, "a name of its own for each load case", "Rename one of the cases."
            )
    shares = [case.share for case in cases]
    if not any("share" in entry for entry in entries):
        return tuple(_with_share(case, 1 / len(cases)) for case in cases)
    for case, entry in zip(cases, entries, strict=True):
        if len(cases) > 1 and "share" not in entry:
            allowed = "the share of the travel, as other cases have one"
            raise InputError(
                f"case '{case.name}'.share", None, allowed, "Add share: 0.5, or remove all shares."
            )
    if abs(sum(shares) - 1) > 1e-6:
        raise InputError(
            "cases",
            f"{sum(shares):.6g}",
            "shares that add up to 1",
            "Change the shares.",
            "is the sum of the shares",
        )
    return tuple(cases)


def _with_share(case: LoadCase, share: float) -> LoadCase:
    new = copy.copy(case)
    object.__setattr__(new, "share", share)
    return new


def _roller_name(value: Any) -> str:
    name = text_of(value, "name of a roller")
    if not name:
        raise InputError("name of a roller", None, "a name such as FL", "Write the name.")
    return name


def _load_case(value: Any, number: int) -> LoadCase:
    entry = _entries(value, f"cases[{number}]", CASE_FIELDS, "{name: run, share: 1, speed: 1 m/s}")
    name = text_of(entry.get("name"), "name of a load case", f"case {number}")
    where = f"case '{name}'"
    wrong = Collector()
    fields = {}
    for key, read in _OF_CASE.items():
        with wrong.part():
            if entry.get(key) is not None:
                fields[key] = read(entry[key], f"{where}.{key}")
    wrong.check()
    if math.isfinite(fields.get("curve_radius", math.inf)) and "speed" not in fields:
        raise InputError(f"{where}.speed", None, "the speed in the curve", "Add speed: 1 m/s.")
    return LoadCase(name, **fields)


def _angle(value: Any, where: str) -> float:
    """Return an angle that is given in per cent or degrees, in rad."""
    parts = split_quantity(value)
    if parts is None:
        allowed = "a slope with its unit, in per cent or degrees"
        if number_or_nan(value) == 0:
            return 0.0
        raise InputError(where, value, allowed, f"Write {value} % or {value} deg.", "has no unit")
    if parts[1] == "%":
        share = _number(parts[0], where, "-", "a slope in % or degrees")
        return math.atan(share / 100.0)
    return math.radians(
        _number(value, where, "deg", "a slope in % or degrees, from -90 to 90", -90.0, 90.0)
    )


def _radius(value: Any, where: str) -> float:
    radius = number_or_nan(value, "mm", where)
    is_straight = math.isinf(radius)
    if not (0 < abs(radius) <= LARGEST_RADIUS or is_straight):
        raise InputError(
            where,
            value,
            "a radius, > 0 to the left and < 0 to the right, at most 1e12 mm or inf",
            "Write curve_radius: 1.5 m.",
        )
    return radius


def _forces(value: Any, where: str) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    forces = []
    for item in _list(value, where):
        entry = _entries(item, where, ("force", "at"), "{force: [0, 50 N, 0], at: [0, 0, 200]}")
        force = _vector(
            entry.get("force"),
            f"{where}.force",
            "N",
            "three forces [x, y, z] in N",
            "Write [0, 50, 0].",
        )
        forces.append((force, _vector(entry.get("at"), f"{where}.at", "mm", _POINT, _AT)))
    return tuple(forces)


def _share_of_payloads(value: Any, where: str) -> float:
    """Return the share of the payloads that is on board; ask back where it may be a mass."""
    parts = split_quantity(value)
    if parts is not None and parts[1] == "%":
        share = math.nan
    else:
        share = number_or_nan(value)
    if share > 1 or (parts is not None and parts[1] in ("kg", "g", "t")):
        allowed = "the share of the payloads that is on board, from 0 to 1"
        remedy = (
            "Write payload: 1 for all of them. A larger payload is a value of its own in payloads."
        )
        raise InputError(where, value, allowed, remedy, "is no share; a mass in kg seems meant")
    return _number(value, where, "-", "a share of the payloads from 0 to 1", 0.0, 1.0)


_OF_CASE: dict[str, Callable[[Any, str], Any]] = {
    "share": lambda v, where: _number(v, where, "-", "a share from 0 to 1", 0.0, 1.0),
    "acceleration": lambda v, where: _number(v, where, "m/s2", "an acceleration along the track"),
    "speed": lambda v, where: _number(v, where, "m/s", "a speed > 0", lower=1e-9),
    "curve_radius": _radius,
    "gradient": _angle,
    "cant": _angle,
    "payload": _share_of_payloads,
    "forces": _forces,
}


def check_curves(cases: Sequence[LoadCase], rollers: Sequence[MountedRoller]) -> None:
    """Refuse a curve whose centre lies inside the carriage."""
    reach = max(float(np.linalg.norm(roller.at[:2])) for roller in rollers)
    for case in cases:
        if abs(case.curve_radius) <= reach:
            allowed = f"a radius larger than the reach of the rollers, {reach:.4g} mm"
            remedy = f"Write curve_radius: {case.curve_radius:g} m if metres are meant."
            raise InputError(
                f"case '{case.name}'.curve_radius", f"{case.curve_radius:g} mm", allowed, remedy
            )


_READERS: Mapping[str, Callable[[Any], Any]] = {  # keys that are read by themselves
    "mass": lambda value: _mass(value, "mass"),
    "payloads": _payloads,
    "drive": _drive,
    "rollers": _rollers,
    "cases": _cases,
    "distance": _distance,
    "duty": checked_duty,
}
