"""Find the least roller of a shelf that is enough for a required life, reliability and safety
against overload.

The rollers are the levels of a factor of a study, and the required life is its requirement:
`Results.answer` judges them. A second study has all forces times the safety; there each limit has
to hold, whatever the life.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from trackroller.carriage.file import CHANCE, carriage_of, written_out
from trackroller.carriage.files import name_of_study
from trackroller.errors import InputError, raise_all, unknown_name
from trackroller.files import files_beside
from trackroller.numerics.numbers import finite_number
from trackroller.numerics.plain import mapping_of
from trackroller.parameters import PARAMETERS
from trackroller.parameters.example import EXAMPLE, used_of
from trackroller.results.life_columns import FIRST_LIMIT
from trackroller.results.load_ratio import EXACT, FORCES, LoadRatios, load_ratios
from trackroller.results.mounting import Mounting, rollers_by_place
from trackroller.results.results import Results
from trackroller.results.run import run
from trackroller.results.size_spectrum import spectrum_table, spectrum_with
from trackroller.results.size_verdicts import PERMITTED, RATIO, VERDICTS, RollerVerdicts
from trackroller.roller.aliases import OTHER_OPTIONS, with_options
from trackroller.roller.duty import OVERROLLINGS
from trackroller.roller.output_names import is_life
from trackroller.roller.requirement import DEFAULT
from trackroller.study.design.carriage_cases import common_values
from trackroller.study.file.config import IN_STUDY
from trackroller.study.file.load import load_study
from trackroller.study.file.shelf import (
    ROLLER,
    base_beside_shelf,
    with_rows,
    without_overridden,
)
from trackroller.study.file.study import Study
from trackroller.study.outputs import of_fatigue
from trackroller.study.spectrum.file import LOAD_FIELDS
from trackroller.yaml_file import read_mapping

# keys that a study file has and a case file has not
OF_STUDY = ("factors", "base", "name", "design", "method")
OF_CARRIAGE = ("mass", "rollers", "cases")  # keys that every carriage file has
# columns of the table of a sizing, which a shelf has no columns of its own for
OF_SIZING = (
    *("verdict", "life_hours", "life_ratio", "ends", *RATIO.values()),
    *("second_model", "overload", "load_ratio", "load_ends", "excluded_by"),
)
# what a sizing may require, and by what rollers rank; arguments of `size`
REQUIRED = ("life", "failures", "safety", *PERMITTED, "least")
AT_LOADS = "loads"  # kind of the study at the forces of the case
OVERLOAD = "overload"  # kind of the study with all forces times the safety, and end of its name
# groups of outputs on which verdicts rest
JUDGED = ("forces", "contact", "peak_stress", "life", "limits")


@dataclass(frozen=True, eq=False)
class Sizing:
    """Which rollers of a shelf are enough.

    Parameters
    ----------
    table : pandas.DataFrame
        One row a roller, the least one that is enough first: `roller`, `verdict` (one of
        `trackroller.results.size_verdicts.VERDICTS`), the columns of the shelf, `life_hours` (low
        end of the life to the first limit, worst condition), `life_ratio` (over the required life),
        `ends` (what ends it), `temperature_ratio` (permitted temperature rise over the rise),
        `wear_ratio` (life to the permitted wear depth over the required life), each further output
        that the file requires with `NAME_ratio`, `second_model` (a second model that turns the
        verdict, with its life), `load_ratio` (all forces times it reach the first
        limit), `load_ends` (that limit), `overload` (held, exceeded or not judged) and
        `excluded_by`. A requirement is met where its ratio is 1 or more.
    least : str
        Name of the roller to take; '' if none is surely enough.
    least_of : str
        Column or output by which the rollers rank; '' for the longest life.
    unranked : tuple of str
        Rollers of which this value is not known, so that they do not rank by it.
    results : Results, optional
        The study at the loads of the case; None if nothing but a safety is required.
    overload : Results, optional
        The study with all forces times the safety; None without a safety.
    ratios : LoadRatios, optional
        What all forces may be multiplied by until each limit is reached.
    units : mapping of str to str
        Units of the user's own columns of the shelf, as far as they are given.
    mounting : Mounting, optional
        The roller of each place of a carriage, if each takes its own.
    not_given : mapping of str to object
        Parameters that nobody gave, with the values of the paper's example that were used.
    spectrum : mapping
        Keys of the spectrum file with the least roller, of which no study is kept; {} for another
        file, and if no roller is surely enough.
    """

    table: pd.DataFrame
    least: str
    least_of: str = ""
    unranked: tuple[str, ...] = ()
    results: Results | None = field(default=None, repr=False)
    overload: Results | None = field(default=None, repr=False)
    ratios: LoadRatios | None = field(default=None, repr=False)
    units: Mapping[str, str] = field(default_factory=dict, repr=False)
    mounting: Mounting | None = field(default=None, repr=False)
    not_given: Mapping[str, Any] = field(default_factory=dict, repr=False)
    spectrum: Mapping[str, Any] = field(default_factory=dict, repr=False)

    @property
    def open_and_less(self) -> tuple[str, ...]:
        """Return the rollers whose verdict is open, and that rank before the least one that is
        enough.
        """
        table = self.table.set_index(ROLLER)
        is_open = table["verdict"] == VERDICTS[1]
        if self.least and self.least_of:
            is_open &= table[self.least_of] < table[self.least_of][self.least]
        elif self.least:
            is_open &= False
        return tuple(map(str, table.index[is_open]))

    def to_dict(self) -> dict[str, Any]:
        """Return the sizing as values of JSON; None stands for a number that is not known."""
        rows = _as_json(self.table)
        head: dict[str, Any] = {
            "least": self.least,
            "least_of": self.least_of,
            "unranked": list(self.unranked),
        }
        head["open_and_less"] = list(self.open_and_less)
        head["not_given"] = dict(self.not_given)
        if self.ratios is not None:
            head["load_ratios"] = _as_json(self.ratios.table.reset_index())
        if self.mounting is not None:
            head["places"] = _as_json(self.mounting.table)
            head["places_enough"] = self.mounting.enough
        return head | {"rollers": rows}


def _as_json(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Return the rows of a table as values of JSON; None stands for a number that is not known,
    and for an infinite one.
    """
    known = table.replace([np.inf, -np.inf], np.nan).astype(object)
    rows = known.where(known.notna(), None).to_dict("records")
    return [{str(key): value for key, value in row.items()} for row in rows]


def size(  # noqa: PLR0913 - a requirement has many parts
    case: Path | str | Mapping[str, Any],
    shelf: Path | str,
    *,
    life: str | float | None = None,
    failures: str | float | None = None,
    safety: str | float | None = None,
    temperature: str | float | None = None,
    wear_depth: str | float | None = None,
    least: str | None = None,
    each: bool = False,
    results: Path | str | None = None,
    progress: bool = False,
) -> Sizing:
    """Find the least roller of a shelf that is enough.

    Parameters
    ----------
    case : pathlib.Path, str or mapping
        Case, carriage, spectrum or study file with loads, rail and duty, or a mapping with its
        keys. The rollers of the shelf take the place of its roller, in a carriage that of all
        rollers.
    shelf : pathlib.Path or str
        Table of rollers, see `trackroller.study.file.shelf`.
    life : str or float, optional
        Required life to the first limit: hours, or years such as "3 years" where the case has a
        duty.
    failures : str or float, optional
        Failure probability of each limit [1], such as "5%". Default: that of the case, otherwise
        0.5.
    safety : str or float, optional
        Factor >= 1 on all forces at which no limit may be exceeded [1].
    temperature : str or float, optional
        Permissible temperature of roller and guide [degC], such as "60 degC"; takes the place of
        `permissible_temperature` of the case.
    wear_depth : str or float, optional
        Permissible wear depth of roller and guide [mm], such as "0.05 mm", that the required life,
        or the `required_travel` of the case, must not exceed; takes the place of
        `permissible_wear_depth` of the case.
    least : str, optional
        Column of the shelf or result of which the least roller is sought, such as "price". Rollers
        that are equal in it rank by their life, then by their load ratio. Default: the longest
        life.
    each : bool
        Whether each place of a carriage takes its own roller, see `Sizing.mounting`.
    results : path, optional
        Parent of the folders of the studies, as for `trackroller.run`. By default nothing is
        written. A spectrum has no study: `Sizing.spectrum` is the spectrum with the least roller.
    progress : bool
        Whether to show a progress bar.

    Returns
    -------
    Sizing
        The rollers with their verdicts.

    Raises
    ------
    InputError
        If nothing is required, or case, shelf or a value is not allowed.

    Notes
    -----
    Any requirement may stand alone. What the file requires under `requirement` counts too.

    Examples
    --------
    >>> import trackroller as tr
    >>> head = "name;roller_profile_radius;price"
    >>> characters = Path("rollers.csv").write_text(f"{head}\\nclose;-6.4;9\\nwide;-8;5\\n")
    >>> case = {"radial_force": -100, "motor_force": 0}
    >>> case |= {"contact_model": "sliding", "accuracy": "preview"}
    >>> tr.size(case, "rollers.csv", life=50, least="price").least
    'close'
    """
    required: dict[str, Any] = {
        "life": life,
        "failures": failures,
        "safety": safety,
        "temperature": temperature,
        "wear_depth": wear_depth,
        "least": least,
    }
    if is_spectrum(case):
        if each:
            remedy = "Leave it out, or give a carriage file."
            raise InputError("each", True, "a carriage, which has places", remedy)
        return _sized_spectrum(case, shelf, required)
    studies = sizing_studies(case, shelf, required)
    solved = {
        kind: run(study, progress=progress, results=results) for kind, study in studies.items()
    }
    ratios = ratios_of(studies, safety)
    sizing = sizing_of(solved.get(AT_LOADS), solved.get(OVERLOAD), required, ratios)
    if not each:
        return sizing
    factor = 1.0
    if safety is not None:
        factor = finite_number(safety, "-", "safety")
    by_life = studies.get(AT_LOADS, studies.get(OVERLOAD))
    assert by_life is not None
    permitted = tuple(name for name in PERMITTED if required[name] is not None)
    mounting = rollers_by_place(by_life, factor, least or "", permitted)
    return replace(sizing, mounting=mounting)


def ratios_of(studies: Mapping[str, Study], safety: str | float | None = None) -> LoadRatios:
    """Return the load ratios of the rollers of a sizing at the forces of its case.

    Parameters
    ----------
    studies : mapping of str to Study
        The studies, as `sizing_studies` returns them.
    safety : str or float, optional
        The factor on the forces of the study `overload` [1].
    """
    if AT_LOADS in studies:
        return load_ratios(studies[AT_LOADS], ROLLER)
    return load_ratios(studies[OVERLOAD], ROLLER).times(finite_number(safety, "-", "safety"))


def sizing_studies(
    case: Path | str | Mapping[str, Any], shelf: Path | str, required: Mapping[str, Any]
) -> dict[str, Study]:
    """Return the studies of a sizing: `AT_LOADS` with the requirement, and `OVERLOAD`.

    Parameters
    ----------
    case, shelf
        As for `size`.
    required : mapping of str to object
        The arguments of `size` by the names of `REQUIRED`, None where nothing is required.
    """
    life = required["life"]
    safety = required["safety"]
    least = required["least"]
    keys = _keys_of(case, shelf)
    _check_required(required, keys)
    if required["failures"] is not None:
        keys = _with_failures(keys, required["failures"])
    keys = _with_permitted(keys, required)
    on_carriage = keys.get("carriage") is not None
    at_loads = keys
    if life is not None:
        own = {**(keys.get("requirement") or {}), _life_of(keys): {"min": life}}
        at_loads = at_loads | {"requirement": own}
    judged = any(required[name] is not None for name in ("life", *PERMITTED))
    judged = judged or bool(keys.get("requirement")) or on_carriage
    if least and (life is not None or keys.get("requirement")):
        at_loads = at_loads | {"pareto": {least: "min"}}
    studies = {}
    if judged:
        studies[AT_LOADS] = at_loads
    if safety is not None:
        overloaded = _overloaded(keys, safety)
        if not on_carriage:  # the load ratios judge the forces that statics gives
            studies[OVERLOAD] = overloaded
    with _as_arguments(required, _life_of(keys)):
        checked = {kind: _checked(own, shelf) for kind, own in studies.items()}
    for study in checked.values():
        known = [name for name, factor in study.columns_of_shelves.items() if factor.numeric]
        if least and not study.config.pareto and least not in known:
            raise unknown_name("least", least, known)
    return checked


def _check_required(required: Mapping[str, Any], keys: Mapping[str, Any]) -> None:
    """Refuse a sizing that requires nothing, a safety below 1, and a wear depth after no travel;
    `keys` are those of a file.
    """
    safety = required["safety"]
    alone = [name for name in ("life", "safety", *PERMITTED) if required[name] is not None]
    if not alone and not keys.get("requirement"):
        remedy = 'Give life="3 years", for example.'
        allowed = "a required life, a safety, a temperature or a wear depth"
        raise InputError("size", None, allowed, remedy)
    if safety is not None and not finite_number(safety, "-", "safety") >= 1.0:
        raise InputError("safety", safety, "a number >= 1", "For example 1.5.")
    travels = required["life"] is not None or (keys.get("base") or {}).get("required_travel")
    travels = travels or any(is_life(name) for name in keys.get("requirement") or {})
    if required["wear_depth"] is not None and not travels:
        allowed = "a wear depth beside the life or travel after which it counts"
        remedy = "Give a life too, or required_travel: 500 km in the file."
        raise InputError("wear_depth", required["wear_depth"], allowed, remedy)


def _with_permitted(keys: Mapping[str, Any], required: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a study with the permitted temperature and wear depth, of the rollers of
    its carriage too.
    """
    given = {PERMITTED[name]: required[name] for name in PERMITTED if required[name] is not None}
    out = {**keys, "base": {**(keys.get("base") or {}), **given}}
    if given and keys.get("carriage") is not None:
        places = {}
        for place, entry in keys["carriage"]["rollers"].items():
            places[place] = {**entry, "roller": {**entry["roller"], **given}}
        out["carriage"] = {**keys["carriage"], "rollers": places}
    return out


@contextmanager
def _as_arguments(arguments: Mapping[str, Any], life: str) -> Iterator[None]:
    """Name in errors the arguments of `size`, with their values, in place of the keys of a study
    that receive them; `life` is the output whose least value is required.
    """
    keys = {f"requirement.{life}": "life", CHANCE: "failures", "pareto": "least"}
    keys |= {f"base.{field}": name for name, field in PERMITTED.items()}
    given = {key: name for key, name in keys.items() if arguments[name] is not None}
    try:
        yield
    except InputError as error:
        raise_all(_of_argument(one, given, arguments) for one in error.errors)


def _of_argument(
    error: InputError, names: Mapping[str, str], arguments: Mapping[str, Any]
) -> InputError:
    """Return an error on a key of a study as one on the argument that the key receives."""
    for name, parameter in PERMITTED.items():
        if arguments[name] is not None and error.field == f"factors.{ROLLER}.{parameter}":
            remedy = f"Leave it out, or remove the column {parameter} of the shelf."
            wrong = "stands in the shelf too"
            return InputError(name, arguments[name], "one permitted value", remedy, wrong)
    for key, name in names.items():
        if f"{error.field}.".startswith(f"{key}."):
            return InputError(name, arguments[name], error.allowed, error.remedy, error.wrong)
    return error


def is_spectrum(case: Path | str | Mapping[str, Any]) -> bool:
    """Return whether a file, or a mapping with the keys of one, is a load spectrum."""
    return "blocks" in _values_of(case)


def _values_of(case: Path | str | Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the keys of a file, or of a mapping."""
    path = _path_of(case)
    if path is not None:
        return read_mapping(path, "study or case file")
    values = mapping_of(case)
    if not isinstance(values, Mapping):
        raise InputError(
            "case", type(case).__name__, "a path or a mapping", "Give a case file, or its keys."
        )
    return values


def _sized_spectrum(
    case: Path | str | Mapping[str, Any], shelf: Path | str, required: Mapping[str, Any]
) -> Sizing:
    """Return which rollers of a shelf are enough for a load spectrum."""
    values = with_options(_values_of(case))
    _check_required(required, values)
    if required["failures"] is not None:
        values[CHANCE] = finite_number(required["failures"], "-", "failures")
    path = _path_of(case)
    keys = _with_permitted({"name": "shelf", "base": values.get("base")}, required)
    study = _checked(_with_shelf(keys, shelf), shelf)
    safety = required["safety"]
    if safety is not None:
        safety = finite_number(safety, "-", "safety")
    with _as_arguments(required, DEFAULT):
        table, ratios = spectrum_table(
            values,
            path,
            study,
            life=required["life"],
            safety=safety,
            least=required["least"],
            permitted=tuple(name for name in PERMITTED if required[name] is not None),
        )
    table = table[[*(name for name in table if name != "excluded_by"), "excluded_by"]]
    units = study.parsed[ROLLER].units
    example = _example_values(study)
    not_given = {name: value for name, value in example.items() if name not in LOAD_FIELDS}
    ranked = _ranked(table, required["least"] or "", None, None)
    chosen: dict[str, Any] = {}
    if ranked.least:
        chosen = spectrum_with(values, study, ranked.least)
    return replace(ranked, ratios=ratios, units=units, not_given=not_given, spectrum=chosen)


def _keys_of(case: Path | str | Mapping[str, Any], shelf: Path | str) -> dict[str, Any]:
    """Return the keys of a study of the rollers of a shelf in a case or study."""
    path = _path_of(case)
    values = _values_of(case)
    stem = "case"
    if path is not None:
        stem = path.stem
    with files_beside(path):
        if set(OF_CARRIAGE) <= set(values):
            keys = _of_carriage(values)
        elif set(OF_STUDY) & set(values):
            keys = with_options(values)
        else:
            keys = _of_case(values)
    if keys.get("table") is not None:
        remedy = "Give a case, carriage or spectrum file, or a study with factors."
        raise InputError(
            "size: table", None, "the loads of one roller", remedy, "has rows of its own"
        )
    if ROLLER in (keys.get("factors") or {}):
        raise InputError(
            f"factors.{ROLLER}",
            None,
            "one shelf",
            "Remove it: --shelf gives it.",
            "stands there already",
        )
    keys["name"] = name_of_study(f"size-{keys.get('name', stem)}-{Path(shelf).stem}")
    keys["question"] = "decide"
    if keys.get("outputs") is not None:
        keys["outputs"] = list(dict.fromkeys((*keys["outputs"], *JUDGED)))
    return _with_shelf(keys, shelf)


def _with_shelf(keys: Mapping[str, Any], shelf: Path | str) -> dict[str, Any]:
    """Return the keys of a study with the rollers of a shelf as a factor, which take the place of
    its own roller.
    """
    if not os.path.isfile(shelf):  # a file of its name in the working directory is another one
        raise InputError(
            "shelf", str(shelf), "the path of a table of rollers", "Check the path.", "is no file"
        )
    out = dict(keys)
    out["factors"] = {ROLLER: {"file": Path(shelf).name}, **(keys.get("factors") or {})}
    base = dict(keys.get("base") or {})
    with files_beside(Path(shelf)):
        rows, _ = with_rows({"base": base, "factors": {ROLLER: out["factors"][ROLLER]}})
    fills_cells = {name: value for name, value in base.items() if name not in rows["base"]}
    if keys.get("carriage") is None:
        out["base"] = fills_cells | without_overridden(rows, ROLLER)["base"]
    else:  # the files of its rollers give what neither shelf nor study does
        out["base"] = fills_cells
    return out


def _life_of(keys: Mapping[str, Any]) -> str:
    """Return the name of the life of a study; nobody may know the hours of the guide."""
    if keys.get("carriage") is not None:
        whole = carriage_of(keys["carriage"])
        cases = [roller.case for roller in whole.rollers if roller.case is not None]
        is_known = all(case.guide_overrollings_per_hour is not None for case in cases)
        if is_known or math.isfinite(whole.stroke):
            return DEFAULT
    if OVERROLLINGS in keys["base"] or OVERROLLINGS in keys["factors"]:
        return DEFAULT
    return FIRST_LIMIT[0]


def _path_of(case: Any) -> Path | None:
    """Return the path of a case file; None for a mapping."""
    if isinstance(case, (str, Path)):
        return Path(case)
    return None


def _of_case(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a study with the values of a case file."""
    base, options, beside = base_beside_shelf(values)
    keys: dict[str, Any] = {"base": base}
    keys |= {option.name: options[option.name] for option in IN_STUDY if option.name in options}
    keys |= {name: beside[name] for name in ("duty", "requirement") if name in beside}
    return keys


def _of_carriage(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a study with the values of a carriage file, whose rollers share their
    options.
    """
    written = written_out(values)
    whole = carriage_of(written)
    for roller in whole.rollers:
        if roller.catalogue is not None:
            remedy = (
                "Write it into the file of the roller, or as columns catalogue_... of the shelf."
            )
            where = f"rollers.{roller.name}.catalogue"
            raise InputError(where, None, "no catalogue of a place", remedy, "stands in the place")
    options = whole.rollers[0].options
    keys: dict[str, Any] = {"carriage": written, "base": common_values(whole)}
    keys |= {option.name: options[option.name] for option in IN_STUDY if option.name in options}
    keys.pop("outputs", None)
    if whole.duty is not None:
        keys["duty"] = dict(whole.duty)
    return keys


def _with_failures(keys: Mapping[str, Any], failures: str | float) -> dict[str, Any]:
    """Return the keys of a study with another failure probability, of the rollers of its carriage
    too.
    """
    out = {**keys, CHANCE: finite_number(failures, "-", "failures")}
    if keys.get("carriage") is not None:
        names = (CHANCE, *OTHER_OPTIONS)
        whole = {name: value for name, value in keys["carriage"].items() if name not in names}
        places = {}
        for place, entry in whole["rollers"].items():
            roller = {name: v for name, v in entry["roller"].items() if name not in names}
            places[place] = {**entry, "roller": roller}
        out["carriage"] = whole | {"rollers": places}
    return out


def _overloaded(keys: Mapping[str, Any], safety: str | float) -> dict[str, Any]:
    """Return the keys of the study whose forces are those of another study times the safety."""
    factor = finite_number(safety, "-", "safety")
    varied = [name for name in FORCES if name in keys["factors"]]
    if varied:
        remedy = "Give the forces under base, or leave the safety out."
        raise InputError(
            f"factors.{varied[0]}", None, "forces under base beside a safety", remedy, "varies"
        )
    base = dict(keys["base"])
    for name in FORCES:
        force = finite_number(base.get(name, EXAMPLE[name]), "N", f"base.{name}")
        base[name] = factor * force
        parameter = PARAMETERS[name]
        if parameter.accepts(np.array(force)) and not parameter.accepts(np.array(base[name])):
            wrong = f"takes {name} to {base[name]:.3g} N"
            allowed = f"a factor at which it is {parameter.allowed()}"
            raise InputError("safety", safety, allowed, "Give a smaller one, such as 1.5.", wrong)
    left = {
        name: value
        for name, value in keys.items()
        if name not in ("requirement", "pareto", "goals")
    }
    return left | {"name": name_of_study(f"{keys['name']}-{OVERLOAD}"), "base": base}


def sizing_of(
    at_loads: Results | None,
    overload: Results | None,
    required: Mapping[str, Any],
    ratios: LoadRatios | None = None,
) -> Sizing:
    """Return which rollers are enough by the answers to the studies of a sizing.

    Parameters
    ----------
    at_loads : Results, optional
        The study at the loads of the case.
    overload : Results, optional
        The study with all forces times the safety.
    required : mapping of str to object
        The arguments of `size` by the names of `REQUIRED`.
    ratios : LoadRatios, optional
        Load ratios of the rollers at the forces of the case.
    """
    solved = at_loads or overload
    assert solved is not None
    least = required["least"] or ""
    safety = required["safety"]
    levels = solved.study.parsed[ROLLER].levels
    table = pd.DataFrame({ROLLER: list(levels)}).set_index(ROLLER)
    for name in [name for name in solved.goods if name != ROLLER]:
        table[name] = _by_roller(solved, solved.table[name].to_numpy())
    table = table.assign(verdict=VERDICTS[0], excluded_by="")
    if at_loads is not None:
        permitted = tuple(name for name in PERMITTED if required[name] is not None)
        judged = RollerVerdicts(at_loads, permitted).table()
        table = table.assign(**{str(name): judged[name] for name in judged})
        if "life_hours" in table:
            table = _without_unknown_lives(table, at_loads)
    if ratios is not None:
        table["load_ratio"] = ratios.least.reindex(table.index)
        table["load_ends"] = ratios.first.reindex(table.index)
    if safety is not None:
        table = _with_overload(table, overload or solved, finite_number(safety, "-", "safety"))
    table = table[[*(name for name in table if name != "excluded_by"), "excluded_by"]]
    if least and least not in table:
        table[least] = _by_roller(solved, solved.quantity(least)[0])
    units = {**solved.study.parsed[ROLLER].units, **_units_of(solved)}
    ranked = _ranked(table, least, at_loads, overload)
    return replace(ranked, ratios=ratios, units=units, not_given=_example_values(solved.study))


def _units_of(results: Results) -> dict[str, str]:
    """Return the units of the outputs that a study requires."""
    return {name: results.quantity(name)[1] for name in results.config.requirement}


def _example_values(study: Study) -> dict[str, Any]:
    """Return the parameters of a study that nobody gave, with their values."""
    base = study.config.base
    return used_of(base, [name for name in study.not_given if name in base])


def _by_roller(results: Results, values: np.ndarray) -> list[Any]:
    """Return a column of cases by roller: the largest number of its conditions, or the first
    text.
    """
    own = results.study.parsed[ROLLER].levels
    if ROLLER not in results.table:  # a shelf of one roller
        return [pd.Series(values).max() if values.dtype.kind == "f" else values[0]]
    grouped = pd.Series(values).groupby(results.table[ROLLER].to_numpy())
    if values.dtype.kind == "f":
        return list(grouped.max().reindex(own))
    return list(grouped.first().reindex(own))


def _without_unknown_lives(table: pd.DataFrame, results: Results) -> pd.DataFrame:
    """Return the table with open verdicts where no life is known at the failure probability that is
    asked for; the median life answers another question.
    """
    chance = float(results.data.attrs.get("failure_probability", 0.5))
    answer = results.answer
    assert answer is not None
    if chance == 0.5:
        return table
    by_median = of_fatigue(answer.output[0])
    lacking = np.array(_by_roller(results, results.without_fatigue.astype(float))) > 0
    lacking |= table["ends"].str.endswith("not known").to_numpy()
    unknown = (lacking & (table["verdict"] != VERDICTS[2]).to_numpy()) | by_median
    text = f"open: the life at {100 * chance:g} % failures is not known"
    table = table.copy()
    table.loc[unknown, "verdict"] = VERDICTS[1]
    table.loc[unknown, "excluded_by"] = text
    table.loc[unknown, ["life_hours", "life_ratio"]] = np.nan
    table.loc[unknown, "ends"] = ""
    return table


def _with_overload(table: pd.DataFrame, results: Results, safety: float) -> pd.DataFrame:
    """Return the table with what becomes of each roller at the forces times the safety."""
    judged = RollerVerdicts(results)
    table = table.copy()
    rows = zip(table.index, judged.holding(), judged.rows["exceeded"], strict=True)
    for name, (verdict, text), exceeded in rows:
        ratio = table.loc[name].get("load_ratio", math.nan)
        if ratio < safety * (1.0 - EXACT) and not exceeded:
            verdict = VERDICTS[2]
            text = f"{table.loc[name, 'load_ends']} at {ratio:.3g} times the forces"
        table.loc[name, "overload"] = text
        if verdict == VERDICTS[0]:
            continue
        if verdict == VERDICTS[1]:
            text = f"open: {text}"
        parts = filter(None, [str(table.loc[name, "excluded_by"]), f"overload: {text}"])
        table.loc[name, "excluded_by"] = "; ".join(parts)
        worse = max(verdict, str(table.loc[name, "verdict"]), key=VERDICTS.index)
        table.loc[name, "verdict"] = worse
    return table


def _ranked(
    table: pd.DataFrame, least: str, at_loads: Results | None, overload: Results | None
) -> Sizing:
    """Return the sizing with its rollers in order: by verdict, by what is to be least, the longer
    life, the larger load ratio, then their names.
    """
    place = [VERDICTS.index(word) for word in table["verdict"]]
    priority = np.zeros(len(table))
    unranked: tuple[str, ...] = ()
    if least:
        priority = table[least].to_numpy(dtype=float)
        unranked = tuple(str(name) for name in table.index[np.isnan(priority)])
    life = np.zeros(len(table))
    if "life_hours" in table:
        life = np.nan_to_num(table["life_hours"].to_numpy(dtype=float), nan=-1.0)
    ratio = np.zeros(len(table))
    if "load_ratio" in table:
        ratio = np.nan_to_num(table["load_ratio"].to_numpy(dtype=float), nan=-1.0)
    names = np.array([str(name) for name in table.index])
    keys = (names, -ratio, -life, np.where(np.isnan(priority), np.inf, priority), np.array(place))
    order = np.lexsort(keys)
    table = table.iloc[order].reset_index()
    enough = table[(table["verdict"] == VERDICTS[0]) & ~table[ROLLER].isin(unranked)]
    first = ""
    if len(enough):
        first = str(enough[ROLLER].iloc[0])
    return Sizing(table, first, least, unranked, at_loads, overload)


def _checked(keys: Mapping[str, Any], shelf: Path | str) -> Study:
    """Return a study of a sizing, whose file of rollers is found."""
    with files_beside(Path(shelf)):
        study = load_study(keys)
    raise_all(
        InputError(
            f"{shelf}: column",
            name,
            "a name that the table of the answer does not use for something else",
            f"Rename it, for example own_{name}.",
        )
        for name in study.columns_of_shelves
        if name in OF_SIZING
    )
    return study
