"""Files that follow from a solved carriage: the load spectrum of a roller, and a study of the loads
of all rollers.
"""

from __future__ import annotations

import csv
import io
import math
import re
import unicodedata
from collections.abc import Mapping, Sequence
from typing import Any

import xarray as xr

from trackroller.carriage.file import OF_LOADS, Carriage, MountedRoller
from trackroller.carriage.solve import cases_of
from trackroller.carriage.strokes import passes_per_km
from trackroller.errors import InputError, check_names
from trackroller.files import inert_cell
from trackroller.parameters import MAPPING_FIELDS, OPTIONS, PARAMETERS
from trackroller.roller.case import Case
from trackroller.roller.duty import OVERROLLINGS
from trackroller.roller.settings import LOADS, parts_for_spectrum

MOST_LETTERS = 64  # of the name of a study
HEADS = "load_case,roller,share"  # the columns before them, which say where a load comes from


def spectrum_of(whole: Carriage, ds: xr.Dataset, name: str) -> dict[str, Any]:
    """Return the load spectrum of a roller, as the keys of a spectrum file.

    Parameters
    ----------
    whole : Carriage
        The carriage.
    ds : xarray.Dataset
        Its solution by `trackroller.carriage`.
    name : str
        The roller.

    Returns
    -------
    dict
        One block for each load case in which the roller carries load. The description states the
        share of the travel without load, because a roller without radial force is no case.

    Raises
    ------
    InputError
        If there is no such roller, if its file is not given, or if it carries no load in any case.
    """
    check_names("--spectrum", [name], [roller.name for roller in whole.rollers])
    j = [roller.name for roller in whole.rollers].index(name)
    roller = whole.rollers[j]
    _check_has_file(roller)
    _check_settled(ds)
    cases = {i: case for (i, own), case in cases_of(whole, ds).items() if own == j}
    if not cases:
        raise InputError(
            "--spectrum", name, "a roller that carries load in a load case", "Name another roller."
        )
    base, options = parts_for_spectrum(roller.given)
    head = {
        "name": name_of_study(f"{whole.name}-{name}"),
        "description": _description_of_roller(whole, name, cases),
        "base": base,
        "blocks": _blocks(whole, cases, float(passes_per_km(whole)[j])),
    }
    duty = whole.duty
    if duty is None:
        duty = roller.given.get("duty")
    if isinstance(duty, Mapping):
        head["duty"] = dict(duty)
    return head | options


def _blocks(whole: Carriage, cases: Mapping[int, Case], passes: float) -> list[dict[str, Any]]:
    """Return a block for each load case of a roller, by its number; `passes` are those of the guide
    per km of travel, infinite without strokes.
    """
    blocks: list[dict[str, Any]] = []
    for i, case in cases.items():
        block: dict[str, Any] = {
            "name": whole.cases[i].name,
            "distance": _short(whole.cases[i].share * whole.distance),
            "velocity": _short(case.velocity),
            **{load: _short(getattr(case, load)) for load in LOADS},
        }
        if math.isfinite(passes):
            block["guide_overrollings"] = _short(passes * block["distance"] / 1000)
        blocks.append(block)
    return blocks


def _description_of_roller(whole: Carriage, name: str, cases: Mapping[int, Case]) -> str:
    """Say of which roller a spectrum is, and which share of the travel it leaves out."""
    text = f"Roller {name} of {whole.name}, {whole.distance:g} m of travel per shift."
    lifted = [case for i, case in enumerate(whole.cases) if i not in cases]
    if not lifted:
        return text
    share = sum(case.share for case in lifted)
    named = ", ".join(case.name for case in lifted)
    return (
        f"{text} No block holds {100 * share:.4g} % of the travel, in which the roller is "
        f"lifted: {named}."
    )


def study_of(whole: Carriage, ds: xr.Dataset, table: str) -> tuple[dict[str, Any], str]:
    """Return a study of all loads of all rollers: the keys of a study file, and the text of its
    table of cases.

    Parameters
    ----------
    whole : Carriage
        The carriage.
    ds : xarray.Dataset
        Its forces by `trackroller.carriage`.
    table : str
        Name of the table, from the folder of the study.

    Returns
    -------
    tuple of dict and str
        The table has a row for each load case and roller that carries load. Fields in which the
        rollers differ are columns; all others stand in the study, which asks about one design under
        all these conditions.

    Raises
    ------
    InputError
        If the file of a roller is not given, or if the rollers differ in more than numbers and
        names.
    """
    for roller in whole.rollers:
        _check_has_file(roller)
    _check_settled(ds)
    _check_same_options(whole)
    base, varying = _shared(whole)
    of_travel: tuple[str, ...] = OF_LOADS
    if math.isfinite(whole.stroke):
        of_travel = (*OF_LOADS, OVERROLLINGS)
    heads = [*HEADS.split(","), *of_travel, *varying]
    rows = _rows(whole, ds, [*of_travel, *varying])
    text = f"Loads of the rollers of {whole.name} by load case."
    lifted = ds["radial_force"].size - len(rows)
    if lifted:
        text += f" Rollers that are lifted carry no load and have no row, {lifted} in all."
    columns = zip(heads, zip(*rows, strict=True), strict=True)
    varies = [name for name, column in columns if name not in OF_LOADS and len({*column}) > 1]
    study = {
        "name": name_of_study(f"{whole.name}-loads"),
        "description": text,
        "base": base,
        "method": "table",
        "table": table,
        "roles": dict.fromkeys(varies, "condition"),  # all cases are conditions of one design
    }
    if whole.duty is not None:
        study["duty"] = dict(whole.duty)
    options = {
        key: value
        for key, value in whole.rollers[0].options.items()
        if "study" in OPTIONS[key].files and key != "outputs"
    }
    return study | options, _csv([_heads_with_units(heads), *rows])


def _rows(whole: Carriage, ds: xr.Dataset, fields: Sequence[str]) -> list[list[Any]]:
    """Return the row of each load case and roller that carries load: names, share, and fields."""
    rows = []
    for (i, j), case in sorted(cases_of(whole, ds).items()):
        names = (whole.cases[i].name, whole.rollers[j].name, f"{whole.cases[i].share:.10g}")
        values = [_cell(getattr(case, name)) for name in fields]
        rows.append([inert_cell(cell) for cell in (*names, *values)])
    return rows


def _heads_with_units(names: Sequence[str]) -> list[str]:
    """Return the heads of columns; those of parameters state their units."""
    units = {name: PARAMETERS[name].unit for name in names if name in PARAMETERS}
    return [_head(name, units.get(name, "-")) for name in names]


def _csv(rows: Sequence[Sequence[Any]]) -> str:
    """Return rows as the text of a CSV file."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()


def _check_has_file(roller: MountedRoller) -> None:
    """Refuse a roller whose file is not given."""
    if roller.case is None:
        where = f"rollers.{roller.name}.roller"
        raise InputError(where, None, "the file of the roller", "Add roller: FILE.")


def name_of_study(text: str) -> str:
    """Return a name that a study or spectrum may have, made of any text: 'my-shuttle-loads' of 'my
    shuttle-loads'.

    Accents are removed, other signs than letters and digits become '-', and long names are cut in
    the middle.
    """
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    name = re.sub(r"[^A-Za-z0-9_]+", "-", plain).strip("-_")
    if not len(name) <= MOST_LETTERS:
        name = f"{name[:40]}-{name[-20:]}"
    return name or "carriage"


def _check_settled(ds: xr.Dataset) -> None:
    """Refuse load cases without an equilibrium: their loads are not known."""
    unsettled = ds["load_case"].values[~ds["converged"].values].tolist()
    if unsettled:
        remedy = "Give the pairs a larger preload, or make more rollers locating ones."
        wrong = "has no forces of the rollers that fulfil all conditions of an equilibrium"
        raise InputError(
            "case", ", ".join(unsettled), "load cases in which the rollers hold", remedy, wrong
        )


def _check_same_options(whole: Carriage) -> None:
    """Refuse rollers with different options: a study has one value of each."""
    first = whole.rollers[0]
    for roller in whole.rollers:
        for key in {*roller.options, *first.options} - {"outputs"}:
            own, other = (one.options.get(key, OPTIONS[key].default) for one in (roller, first))
            if own != other:
                allowed = f"the same {key} for all rollers, which is {other} for {first.name}"
                raise InputError(
                    f"rollers.{roller.name}.roller",
                    f"{key}: {own}",
                    allowed,
                    "Change one of the files.",
                )


def _head(name: str, unit: str) -> str:
    """Return the head of a column."""
    if unit == "-":
        return name
    return f"{name} [{unit}]"


def _cell(value: Any) -> str:
    """Return a value of a case as the cell of a table."""
    if isinstance(value, str):
        return value
    return f"{value:.10g}"


def _shared(whole: Carriage) -> tuple[dict[str, Any], list[str]]:
    """Return what the files of all rollers say alike, and the fields in which the rollers
    differ.
    """
    given = [
        {
            key: value
            for key, value in parts_for_spectrum(roller.given)[0].items()
            if key not in OF_LOADS
        }
        for roller in whole.rollers
    ]
    if all(entry == given[0] for entry in given):
        return given[0], []
    cases = [roller.case for roller in whole.rollers if roller.case is not None]
    fields = [
        {key: value for key, value in case.as_dict().items() if key not in OF_LOADS}
        for case in cases
    ]
    varying = [key for key in fields[0] if any(entry[key] != fields[0][key] for entry in fields)]
    for key in varying:
        if key in MAPPING_FIELDS:
            allowed = "the same for all rollers"
            remedy = "Write the spectrum of each roller with --spectrum instead."
            raise InputError(key, None, allowed, remedy, "differs among the rollers")
    given_fields = {key for key in fields[0] if not all(key in case.not_given for case in cases)}
    return {
        key: value for key, value in fields[0].items() if key in given_fields and key not in varying
    }, varying


def _short(value: Any) -> float:
    """Return a number with 10 digits, as a person can read it."""
    return float(f"{float(value):.10g}")
