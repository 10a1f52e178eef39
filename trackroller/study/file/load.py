"""Read and check a study file, so that errors are found before any case is solved."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from trackroller.carriage.fields import check_fields
from trackroller.contact.friction_laws import at_rest
from trackroller.damage.own import digests
from trackroller.errors import Collector, InputError, nearest, raise_all, unknown_name
from trackroller.files import Reads, files_beside, find_beside, noted_reads, read_text
from trackroller.materials import load_database
from trackroller.methods.factor import ROWS
from trackroller.numerics.numbers import number_in
from trackroller.numerics.plain import mapping_of
from trackroller.parameters import MATERIAL_FIELDS
from trackroller.parameters.carriage_fields import field_of
from trackroller.parameters.example import not_given
from trackroller.roller.aliases import OTHER_OPTIONS, WRITTEN, study_with_radii, with_options
from trackroller.roller.duty import OVERROLLINGS, checked_duty, is_of_strokes, of_roller
from trackroller.study.design.carriage_cases import common_values, given_by
from trackroller.study.design.factor_names import SHELVES
from trackroller.study.file.checks import check_cells, check_geometry, cross_check, named_materials
from trackroller.study.file.config import StudyFile
from trackroller.study.file.goals import Analysis, check_analysed, to_first_limit
from trackroller.study.file.search import Budget
from trackroller.study.file.shelf import names_of_columns, rows_named, with_rows
from trackroller.study.file.study import Study
from trackroller.study.file.until import Until
from trackroller.study.file.user_columns import column_names
from trackroller.yaml_file import errors_by_line, parse_mapping

if TYPE_CHECKING:
    from trackroller.carriage.file import Carriage

EXAMPLES = {  # of keys that are mappings or lists
    "base": "{radial_force: -200}",
    "factors": "{friction_coefficient: {values: [0.1, 0.2]}}",
    "roles": "{friction_coefficient: condition, roller_profile_radius: choice}",
    "goals": "{pair_life_hours: max}",
    "pareto": "{pair_life_hours: max, friction_power: min}",
    "constraints": "[max_pressure < 1500]",
    "budget": "{designs: 640, hours: 2}",
    "until": "{half_width: 0.03, of: [roller_life_hours], at_most: 20000}",
    "requirement": "{roller_life_hours: {min: 500}}",
    "own": "{heat_per_force: friction_power_2 / normal_force_2}",
}
ROOMS = {
    "analysis": Analysis.model_fields,
    "until": Until.model_fields,
    "budget": Budget.model_fields,
}
# keys that have two names, and today's name
OTHER_NAMES = {"design": "method", "analysis.target": "requirement"}
# keys of a study file, another name of a key included
KEYS = ("design", *(key.alias or name for name, key in StudyFile.model_fields.items()))


def _translated(detail: Mapping[str, Any]) -> InputError:
    """Return an error of pydantic as an `InputError` with a remedy."""
    context = detail.get("ctx", {}).get("error")
    if isinstance(context, InputError):
        return context
    where = ".".join(str(part) for part in detail["loc"]) or "study"
    if detail["type"] == "extra_forbidden":
        room_name = str(detail["loc"][0])
        name = str(detail["loc"][-1])
        if len(detail["loc"]) > 1 and room_name in ROOMS:
            return unknown_name(room_name, name, ROOMS[room_name])
        return unknown_name("study key", where, KEYS)
    if detail["type"] == "missing":
        *room, key = (str(part) for part in detail["loc"])
        if room:
            return InputError(
                where, None, f"this key, in {room[-1]}", f"Add {key}: ... to {room[-1]}."
            )
        return InputError(where, None, "this key, in every study", f"Add a line '{key}: ...'.")
    allowed = detail["msg"].replace("Input should be ", "")
    if detail["type"] == "model_type":
        allowed = f"a mapping with {', '.join(ROOMS[where])}"
    for word, plain in (
        ("dictionary", "mapping of names to values"),
        ("tuple", "list"),
        ("string", "text"),
    ):
        allowed = allowed.replace(f"valid {word}", plain)
    remedy = ""
    if where in EXAMPLES:
        remedy = f"For example {where}: {EXAMPLES[where]}."
    if where == "table" and isinstance(detail.get("input"), (list, dict)):
        remedy = (
            "Write the table to a file, as frame.to_csv('cases.csv', index=False), and give "
            "the path: cases.csv."
        )
    return InputError(where, detail.get("input"), allowed, remedy)


def with_present_keys(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return a study file with today's name of each key in `OTHER_NAMES` and `OTHER_OPTIONS`;
    refuse a doubled key.
    """
    out = dict(data)
    if "design" in out:
        _refuse_both("design", "method", out)
        out = {{"design": "method"}.get(key, key): value for key, value in out.items()}
    out = with_options(out)
    given = _mapping(out.get("analysis"))
    if "target" in given:
        _refuse_both("analysis.target", "requirement", out)
        out["requirement"] = given["target"]
        out["analysis"] = {key: value for key, value in given.items() if key != "target"}
    return out


def _refuse_both(other: str, name: str, data: Mapping[str, Any]) -> None:
    """Refuse a key that stands beside its other name."""
    if name in data:
        wrong = f"stands beside {other}, which is another name of it"
        raise InputError(name, data[name], "one of the two", f"Remove {other}.", wrong)


@contextmanager
def _as_written(data: Mapping[str, Any]) -> Iterator[None]:
    """Name in errors the keys of `OTHER_NAMES` and `OTHER_OPTIONS` as the study file does."""
    written = {}
    if "design" in data and "method" not in data:
        written["method"] = "design"
    for other, name in OTHER_OPTIONS.items():
        if other in data:
            written[name] = other
    if "target" in _mapping(data.get("analysis")) and "requirement" not in data:
        written["requirement"] = "analysis.target"
    try:
        yield
    except InputError as error:
        raise_all(_renamed(one, written) for one in error.errors)


def _renamed(error: InputError, names: Mapping[str, str]) -> InputError:
    """Return an error whose key has the name that the study file uses."""
    head, dot, tail = error.field.partition(".")
    if head in names:
        return error.named(f"{names[head]}{dot}{tail}")
    return error


def checked_keys(data: Mapping[str, Any]) -> StudyFile:
    """Return the keys of a study file, each checked by itself; raise `InputError` if one is
    wrong.
    """
    wrong = Collector()
    data = study_with_radii(with_present_keys(data), wrong)
    with wrong.part():
        data = _by_strokes(data)
    try:
        config: StudyFile = StudyFile.model_validate(dict(data))
        wrong.check()
    except ValidationError as error:
        errors = error.errors()
        unknown = [str(one["loc"][-1]) for one in errors if one["type"] == "extra_forbidden"]
        for one in errors:
            if one["type"] != "missing" or not any(
                nearest(name, map(str, one["loc"][-1:])) for name in unknown
            ):
                wrong.errors += _translated(one).errors
        naming = ("outputs", "analysis", "requirement", "duty", "carriage", "own")
        if not {one["loc"][0] for one in errors} & {*naming}:
            with wrong.part():
                analysed = {key: data[key] for key in naming if key in data}
                goods = names_of_columns(_mapping(data.get("factors")))
                check_analysed(
                    StudyFile.model_validate({"name": "without-the-other-keys"} | analysed), goods
                )
        wrong.check()
        raise
    return config


def _by_strokes(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return a study file whose duty is in hours, and whose guide has the overrollings of the
    strokes.

    Raises
    ------
    InputError
        If the cases of the study differ in velocity, so that they have no hours in common.
    """
    if not is_of_strokes(_mapping(data.get("duty"))):
        return data
    duty = checked_duty(data["duty"])
    base = dict(_mapping(data.get("base")))
    remedies = {
        "carriage": "Write the strokes into the file of the carriage.",
        "table": "Write hours_per_day here, and guide_overrollings_per_hour in the table.",
    }
    for key, remedy in remedies.items():
        if data.get(key) is not None:
            raise InputError(
                "duty.stroke", duty["stroke"], "hours_per_day", remedy, f"stands beside a {key}"
            )
    for name in ("velocity", OVERROLLINGS):
        if name in _mapping(data.get("factors")):
            wrong = "varies beside the strokes of the duty"
            remedy = "Write hours_per_day in place of the strokes."
            raise InputError(f"factors.{name}", None, "one velocity", remedy, wrong)
    velocity = None
    if base.get("velocity") is not None:
        velocity = number_in(
            base["velocity"], "base.velocity", "a velocity > 0 [m/min]", 1e-9, 1e9, "m/min"
        )
    in_time, given = of_roller(duty, velocity, base.get(OVERROLLINGS))
    return {**data, "duty": in_time, "base": base | given}


def _mapping(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def complete(study: Study) -> Study:
    """Return a study whose key `base` holds a value of every parameter that varies in no factor.

    Parameters
    ----------
    study : the study as its file states it
    """
    config = study.config
    names = {*config.base, *study.factors, *study.columns_of_shelves}
    if config.method.observed and config.table is not None:
        names.update(column_names(study.table_path, "table"))
    if any(at_rest(law) is not None for law in study.friction_laws if law):
        names.add("friction_coefficient")  # the first value of the table
    values = not_given(names)
    update: dict[str, Any] = {"base": config.base | values}
    if study.carriage is not None:
        update, values = _on_carriage(study, study.carriage, names)
    if config.until is not None and "samples" not in config.model_fields_set:
        update["samples"] = config.until.replicates * config.method.first_look
    update |= to_first_limit(config)
    return replace(study, config=config.model_copy(update=update), not_given=tuple(values))


def _on_carriage(
    study: Study, whole: Carriage, names: set[str]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the keys that a study takes from its carriage, and the values of parameters that no
    file gives.

    The key `base` takes what all rollers share, `roles` the roles of the fields, and `duty` that of
    the carriage.
    """
    config = study.config
    _check_beside_carriage(study, whole, names)
    of_study = set(names)
    if "material_pair" in names:
        of_study |= {*MATERIAL_FIELDS}
    common = {name: value for name, value in common_values(whole).items() if name not in of_study}
    cases = [roller.case for roller in whole.rollers if roller.case is not None]
    lacking = {name for name in common if all(name in case.not_given for case in cases)}
    roles = {}
    if not config.method.points:
        roles = {name: field.role for name in study.factors if (field := field_of(name))}
    duty: Mapping[str, float] | None = config.duty
    if duty is None:
        duty = whole.duty
    return (
        {"base": config.base | common, "roles": roles | config.roles, "duty": duty},
        {name: value for name, value in not_given(of_study).items() if name in lacking},
    )


def _check_beside_carriage(study: Study, whole: Carriage, names: set[str]) -> None:
    """Refuse keys of a study that contradict its carriage; raise all errors together."""
    config = study.config
    wrong = Collector()
    for name in sorted(names & {*given_by(whole)}):
        allowed = "parameters that the carriage does not give"
        remedy = "Remove it: statics gives it."
        wrong.errors.append(InputError(name, None, allowed, remedy, "stands beside a carriage"))
    if config.method.observed:
        allowed = "a design of factors, because a table lists loads of rollers"
        remedy = "Write factors in place of the table."
        wrong.errors.append(InputError("method", config.method_name, allowed, remedy))
    # in their order: a file is written the same again
    fields = [name for name in study.factors if field_of(name)]
    with wrong.part():
        check_fields(whole, fields)
    _check_rollers(config, whole, wrong)
    if "life" not in config.outputs:
        allowed = "outputs with life, by which the worst roller is found"
        wrong.errors.append(InputError("outputs", list(config.outputs), allowed, "Add life."))
    if whole.duty is not None and config.duty not in (None, whole.duty):
        allowed = "the duty of the carriage"
        wrong.errors.append(InputError("duty", config.duty, allowed, "Remove one of them."))
    speeds = [name for name in fields if "carriage_speed" in name]
    if math.isfinite(whole.stroke) and speeds:
        remedy = "Write hours_per_day in place of the strokes."
        wrong.errors.append(
            InputError(f"factors.{speeds[0]}", None, "one speed", remedy, "varies beside strokes")
        )
    wrong.check()


def _check_rollers(config: StudyFile, whole: Carriage, wrong: Collector) -> None:
    """Add the errors of rollers without a file, and of files with other options than the
    study has.
    """
    checked: set[tuple[str, str]] = set()
    for roller in whole.rollers:
        field = f"carriage.rollers.{roller.name}.roller"
        if roller.case is None:
            wrong.errors.append(InputError(field, None, "its file", "Add roller: FILE."))
        for key, value in roller.options.items():
            if (key, str(value)) in checked:  # rollers may share a file, whose error is stated once
                continue
            checked.add((key, str(value)))
            with wrong.part():
                _check_option(config, key, value, f"{field}.{key}")


def _check_option(config: StudyFile, key: str, value: Any, where: str) -> None:
    """Refuse an option in the file of a roller that the study does not have."""
    stated = getattr(config, key, None)
    listed = value
    if isinstance(value, (list, tuple)):
        listed = tuple(value)
    if key == "outputs" or stated == listed:
        return
    allowed = f"the option of the study, {stated}"
    raise InputError(
        where,
        value,
        allowed,
        f"Write {key}: {value} in the study, or remove it from the roller's file.",
    )


def parse_study(
    data: Mapping[str, Any], path: Path | None = None, database: Any = None, planned: bool = False
) -> Study:
    """Return the study of a mapping with the keys of a study file; raise `InputError` if an entry
    is wrong.
    """
    with _as_written(data), noted_reads() as inputs:
        inputs |= {path: ("limit", digest) for path, digest in digests().items()}
        data, places = with_rows(data)
        with places.in_files():
            study = _checked_rows(data, path, database, planned, inputs)
        return study


def _checked_rows(
    data: Mapping[str, Any], path: Path | None, database: Any, planned: bool, inputs: Reads
) -> Study:
    """Return the checked study, see `_checked_study`; raise the errors of all rows of its shelves,
    also those that a check finds only where an earlier one has passed.
    """
    wrong = Collector()
    remaining = data
    while True:
        try:
            study = _checked_study(remaining, path, database, planned, inputs)
        except InputError as error:
            wrong.errors += error.errors
            remaining = _without_rows(remaining, error)
            if remaining:
                continue
        wrong.check()
        return study


def _without_rows(data: Mapping[str, Any], error: InputError) -> dict[str, Any]:
    """Return a study without the rows of the shelf that all of some errors name; {} if there are
    none, or if no row is left.
    """
    factors = _mapping(data.get("factors"))
    for shelf in (name for name in SHELVES if isinstance(factors.get(name), Mapping)):
        rows = factors[shelf].get(ROWS)
        if not isinstance(rows, list) or not all(isinstance(row, Mapping) for row in rows):
            continue
        named = rows_named(shelf, rows, error)
        others = [row for row in rows if str(row.get("name")) not in named]
        if named and others:
            return {**data, "factors": {**factors, shelf: {**factors[shelf], ROWS: others}}}
    return {}


def _checked_study(
    data: Mapping[str, Any], path: Path | None, database: Any, planned: bool, inputs: Reads
) -> Study:
    """Return the study of a mapping that holds the rows of its shelves; see `parse_study`."""
    wrong = Collector()
    with wrong.part():
        config = checked_keys(data)
    if wrong.errors:
        # unknown materials are told beside wrong keys: otherwise they would be told one run later
        base = _mapping(data.get("base"))
        factors = _mapping(data.get("factors"))
        with wrong.part():
            named_materials(base, factors, database or load_database())
        wrong.check()
    study = complete(Study(config, path, database, inputs))
    with wrong.part():
        cross_check(study)
    with wrong.part():
        if study.config.method.observed and study.config.table and not planned:
            check_cells(study)
    wrong.check()
    if not planned:
        check_geometry(study)
    return study


def load_study(
    path: str | Path | Mapping[str, Any], database: Any = None, planned: bool = False
) -> Study:
    """Read and check a study file.

    Parameters
    ----------
    path : str, pathlib.Path or mapping
        The YAML file, or a mapping with its keys; arrays and columns of data frames count as lists.
    database : MaterialDatabase, optional
        Materials. Default: the built-in database, changed and extended by the user's own file.
    planned : bool
        The geometry of every case is checked already; a job of a cluster need not draw the whole
        design for it.

    Returns
    -------
    Study
        The checked study.

    Raises
    ------
    InputError
        If the file is missing or is not YAML, a key or name is unknown, a value is out of bounds,
        or the geometry contradicts itself. The error names field, value, what is allowed and the
        nearest known name.

    Examples
    --------
    >>> factors = "factors: {roller_profile_radius: {values: [-6.5, -8]}}"
    >>> characters = Path("study.yaml").write_text(f"{{name: fit, {factors}}}")
    >>> load_study("study.yaml").design().sizes["case"]
    2
    """
    path = mapping_of(path)
    if isinstance(path, Mapping):
        return parse_study(path, None, database, planned)
    if not isinstance(path, (str, Path)):
        remedy = "Give the path of a study file, or a mapping with its keys."
        raise InputError("study", type(path).__name__, "a path or a mapping", remedy)
    path = Path(path)
    with files_beside(path), noted_reads():
        text = read_text(path, "study file")
        data = parse_mapping(text, "study file")
        with errors_by_line(text, aliases=WRITTEN):
            if data.get("table") is not None:
                find_beside(data["table"], "table")
            return parse_study(data, path, database, planned)
