"""Find the least roller of a shelf that is enough for a required life, reliability and safety
against overload.

The rollers are the levels of a factor of a study, and the required life is its requirement:
`Results.answer` judges them. A second study has all forces times the safety; there each limit has
to hold, whatever the life.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from trackroller.errors import InputError, unknown_name
from trackroller.files import files_beside
from trackroller.numerics.numbers import finite_number
from trackroller.numerics.plain import mapping_of
from trackroller.parameters.example import EXAMPLE
from trackroller.results.results import Results
from trackroller.results.solving import run
from trackroller.roller.aliases import with_options
from trackroller.roller.duty import OVERROLLINGS
from trackroller.roller.requirement import DEFAULT
from trackroller.roller.settings import LOADS, checked_case
from trackroller.study.file.config import IN_STUDY, NAME
from trackroller.study.file.load import load_study
from trackroller.study.file.shelf import ROLLER, base_of_case, with_rows, without_overridden
from trackroller.study.file.study import Study
from trackroller.study.outputs import of_fatigue
from trackroller.yaml_file import read_mapping

# keys that a study file has and a case file has not
OF_STUDY = ("factors", "base", "name", "design", "method")
VERDICTS = ("enough", "open", "not enough")
OVERLOAD = "overload"  # end of the name of the study with all forces times the safety


@dataclass(frozen=True, eq=False)
class Sizing:
    """Which rollers of a shelf are enough.

    Parameters
    ----------
    table : pandas.DataFrame
        One row a roller, the least one that is enough first: `roller`, `verdict` (one of
        `VERDICTS`), the columns of the shelf, `life_hours` (low end of the life to the first limit,
        worst condition), `life_ratio` (over the required life), `ends` (what ends it), `overload`
        (held, exceeded or not judged) and `excluded_by`.
    least : str
        Name of the roller to take; '' if none is surely enough.
    least_of : str
        Column or output by which the rollers rank; '' for the longest life.
    unranked : tuple of str
        Rollers of which this value is not known, so that they do not rank by it.
    results : Results, optional
        The study at the loads of the case; None if no life is required.
    overload : Results, optional
        The study with all forces times the safety; None without a safety.
    """

    table: pd.DataFrame
    least: str
    least_of: str = ""
    unranked: tuple[str, ...] = ()
    results: Results | None = field(default=None, repr=False)
    overload: Results | None = field(default=None, repr=False)

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
        rows = self.table.astype(object).where(self.table.notna(), None).to_dict("records")
        head: dict[str, Any] = {
            "least": self.least,
            "least_of": self.least_of,
            "unranked": list(self.unranked),
        }
        head["open_and_less"] = list(self.open_and_less)
        return head | {"rollers": [{str(key): value for key, value in row.items()} for row in rows]}


def size(
    case: Path | str | Mapping[str, Any],
    shelf: Path | str,
    *,
    life: str | float | None = None,
    failures: str | float | None = None,
    safety: str | float | None = None,
    least: str | None = None,
    results: Path | str | None = None,
    progress: bool = False,
) -> Sizing:
    """Find the least roller of a shelf that is enough.

    Parameters
    ----------
    case : pathlib.Path, str or mapping
        Case file or study file with loads, rail and duty, or a mapping with its keys. The rollers
        of the shelf take the place of its roller.
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
    least : str, optional
        Column of the shelf or result of which the least roller is sought, such as "price". Rollers
        that are equal in it rank by their life. Default: the longest life.
    results : path, optional
        Parent of the folders of the studies, as for `trackroller.run`. By default nothing is
        written.
    progress : bool
        Whether to show a progress bar.

    Returns
    -------
    Sizing
        The rollers with their verdicts.

    Raises
    ------
    InputError
        If neither life nor safety is required, or case, shelf or a value is not allowed.

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
    studies = sizing_studies(case, shelf, life=life, failures=failures, safety=safety, least=least)
    solved = {
        kind: run(study, progress=progress, results=results) for kind, study in studies.items()
    }
    return sizing_of(solved.get("life"), solved.get(OVERLOAD), least or "")


def sizing_studies(
    case: Path | str | Mapping[str, Any],
    shelf: Path | str,
    *,
    life: str | float | None,
    failures: str | float | None,
    safety: str | float | None,
    least: str | None,
) -> dict[str, Study]:
    """Return the studies of a sizing: `life` with the requirement, and `overload`; see `size`."""
    if life is None and safety is None:
        raise InputError(
            "size", None, "a required life, or a safety", 'Give life="3 years", for example.'
        )
    keys = _keys_of(case, shelf)
    if failures is not None:
        keys["failure_probability"] = finite_number(failures, "-", "failures")
    studies = {}
    if life is not None:
        name = DEFAULT
        if OVERROLLINGS not in keys["base"] and OVERROLLINGS not in keys["factors"]:
            name = "roller_life_hours"  # nobody knows the hours of the guide
        required = {**(keys.get("requirement") or {}), name: {"min": life}}
        more: dict[str, Any] = {"requirement": required}
        if least:
            more["pareto"] = {least: "min"}
        studies["life"] = keys | more
    if safety is not None:
        studies[OVERLOAD] = _overloaded(keys, safety)
    checked = {kind: _checked(own, shelf) for kind, own in studies.items()}
    for study in checked.values():
        known = [name for name, factor in study.columns_of_shelves.items() if factor.numeric]
        if least and "life" not in studies and least not in known:
            raise unknown_name("least", least, known)
    return checked


def _keys_of(case: Path | str | Mapping[str, Any], shelf: Path | str) -> dict[str, Any]:
    """Return the keys of a study of the rollers of a shelf in a case or study."""
    path = _path_of(case)
    if path is None:
        stem = "case"
        values = mapping_of(case)
    else:
        stem = path.stem
        values = read_mapping(path, "study or case file")
    if not isinstance(values, Mapping):
        raise InputError(
            "case", type(case).__name__, "a path or a mapping", "Give a case file, or its keys."
        )
    with files_beside(path):
        if set(OF_STUDY) & set(values):
            keys = with_options(values)
        else:
            keys = _of_case(values)
    for name in ("carriage", "table", "blocks"):
        if keys.get(name) is not None:
            remedy = "Give a case file, or a study with factors."
            raise InputError(
                f"size: {name}",
                None,
                "the loads of one roller",
                remedy,
                "has several rollers or rows",
            )
    if ROLLER in (keys.get("factors") or {}):
        raise InputError(
            f"factors.{ROLLER}",
            None,
            "one shelf",
            "Remove it: --shelf gives it.",
            "stands there already",
        )
    keys["name"] = _name(str(keys.get("name", stem)), Path(shelf).stem)
    keys["factors"] = {ROLLER: {"file": Path(shelf).name}, **(keys.get("factors") or {})}
    base = dict(keys.get("base") or {})
    with files_beside(Path(shelf)):
        rows, _ = with_rows({"base": base, "factors": {ROLLER: keys["factors"][ROLLER]}})
    fills_cells = {name: value for name, value in base.items() if name not in rows["base"]}
    keys["base"] = fills_cells | without_overridden(rows, ROLLER)["base"]
    keys["question"] = "decide"
    return keys


def _path_of(case: Any) -> Path | None:
    """Return the path of a case file; None for a mapping."""
    if isinstance(case, (str, Path)):
        return Path(case)
    return None


def _of_case(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a study with the values of a case file."""
    case, options, beside = checked_case(values)
    keys: dict[str, Any] = {"base": base_of_case(case)}
    keys |= {option.name: options[option.name] for option in IN_STUDY if option.name in options}
    keys |= {name: beside[name] for name in ("duty", "requirement") if name in beside}
    return keys


def _name(case: str, shelf: str) -> str:
    """Return the name of the study of a case and a shelf, which names its folder."""
    name = "-".join(("size", case, shelf))[:50].rstrip(".")
    if NAME.fullmatch(name) and ".." not in name:
        return name
    return "size"


def _overloaded(keys: Mapping[str, Any], safety: str | float) -> dict[str, Any]:
    """Return the keys of the study whose forces are those of another study times the safety."""
    factor = finite_number(safety, "-", "safety")
    if not factor >= 1.0:
        raise InputError("safety", safety, "a number >= 1", "For example 1.5.")
    varied = [name for name in LOADS if name in keys["factors"]]
    if varied:
        remedy = "Give the forces under base, or leave the safety out."
        raise InputError(
            f"factors.{varied[0]}", None, "forces under base beside a safety", remedy, "varies"
        )
    base = dict(keys["base"])
    for name in LOADS:
        base[name] = factor * finite_number(base.get(name, EXAMPLE[name]), "N", f"base.{name}")
    left = {
        name: value
        for name, value in keys.items()
        if name not in ("requirement", "pareto", "goals")
    }
    return left | {"name": f"{keys['name']}-{OVERLOAD}", "base": base}


def sizing_of(at_loads: Results | None, overload: Results | None, least: str = "") -> Sizing:
    """Return which rollers are enough by the answers to the studies of a sizing.

    Parameters
    ----------
    at_loads : Results, optional
        The study with the required life.
    overload : Results, optional
        The study with all forces times the safety.
    least : str
        Column of the shelf or result by which rollers rank.
    """
    solved = at_loads or overload
    assert solved is not None
    goods = [name for name in solved.goods if name != ROLLER]
    levels = solved.study.parsed[ROLLER].levels
    table = pd.DataFrame({ROLLER: list(levels)}).set_index(ROLLER)
    for name in goods:
        table[name] = _by_roller(solved, solved.table[name].to_numpy())
    table["verdict"] = VERDICTS[0]
    table["excluded_by"] = ""
    if at_loads is not None:
        table = _with_life(table, at_loads)
    if overload is not None:
        table = _with_overload(table, overload)
    if least and least not in table:
        table[least] = _by_roller(solved, solved.quantity(least)[0])
    return _ranked(table, least, at_loads, overload)


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


def _answer_rows(results: Results) -> pd.DataFrame:
    """Return the table of the answer to a study by roller."""
    answer = results.answer
    assert answer is not None
    rows = answer.table
    if ROLLER not in rows:
        rows = rows.assign(**{ROLLER: results.study.parsed[ROLLER].levels[0]})
    return rows.set_index(ROLLER)


def _with_life(table: pd.DataFrame, results: Results) -> pd.DataFrame:
    """Return the table with the life of each roller, its ratio to the required life, and the
    verdict of the answer.
    """
    rows = _answer_rows(results).reindex(table.index)
    name = next(
        name for name in (DEFAULT, "roller_life_hours") if name in results.config.requirement
    )
    required = results.config.requirement[name].least
    table = table.assign(
        life_hours=rows["low"], life_ratio=rows["low"] / required, ends=rows["ends"]
    )
    words = {"met": VERDICTS[0], "open": VERDICTS[1]}
    table["verdict"] = [words.get(str(state), VERDICTS[2]) for state in rows["state"]]
    why = []
    shown = rows[["state", "low", "ends", "exceeded", "error"]]
    for state, low, ends, exceeded, error in shown.itertuples(index=False):
        text = ""
        if state == "missed":
            text = f"life: {ends} after {low:.4g} h"
        elif state == "open":
            text = f"open: {ends} after {low:.4g} h, with a told error of {100 * error:.0f} %"
        elif state != "met":
            text = str(exceeded or ends or "no condition is held")
        why.append(text)
    return _without_unknown_lives(table.assign(excluded_by=why), results)


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


def _with_overload(table: pd.DataFrame, results: Results) -> pd.DataFrame:
    """Return the table with what becomes of each roller at the forces times the safety."""
    rows = _answer_rows(results).reindex(table.index)
    found = []
    for holds, judged, of, exceeded in rows[["holds", "judged", "of", "exceeded"]].itertuples(
        index=False
    ):
        if exceeded:  # by a second model too, such as a catalogue
            found.append(str(exceeded))
        elif holds == of:
            found.append("held")
        elif judged == of:
            found.append("does not roll")
        else:
            found.append("not judged")
    table = table.assign(overload=found)
    held = table["overload"] == "held"
    unknown = table["overload"] == "not judged"
    verdict = np.where(held, table["verdict"], np.where(unknown, VERDICTS[1], VERDICTS[2]))
    table["verdict"] = np.where(table["verdict"] == VERDICTS[2], VERDICTS[2], verdict)
    added = [f"overload: {text}" if text not in ("held", "not judged") else "" for text in found]
    both = zip(table["excluded_by"], added, strict=True)
    return table.assign(excluded_by=["; ".join(filter(None, pair)) for pair in both])


def _ranked(
    table: pd.DataFrame, least: str, at_loads: Results | None, overload: Results | None
) -> Sizing:
    """Return the sizing with its rollers in order: by verdict, by what is to be least, then the
    longer life.
    """
    place = [VERDICTS.index(word) for word in table["verdict"]]
    wanted = np.zeros(len(table))
    unranked: tuple[str, ...] = ()
    if least:
        wanted = table[least].to_numpy(dtype=float)
        unranked = tuple(str(name) for name in table.index[np.isnan(wanted)])
    life = np.zeros(len(table))
    if "life_hours" in table:
        life = np.nan_to_num(table["life_hours"].to_numpy(dtype=float), nan=-1.0)
    keys = (-life, np.where(np.isnan(wanted), np.inf, wanted), np.array(place))
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
        return load_study(keys)
