"""Files that follow from a solved carriage: the load spectrum of a roller, and a study of the loads
of all rollers.
"""

from __future__ import annotations

import csv
import io
import math
import re
import unicodedata
from collections.abc import Mapping
from typing import Any

import xarray as xr

from trackroller.carriage.file import OF_LOADS, Carriage
from trackroller.carriage.solve import cases_of
from trackroller.carriage.strokes import passes_per_km
from trackroller.errors import InputError, check_names
from trackroller.files import inert_cell
from trackroller.parameters import MAPPING_FIELDS, OPTIONS, PARAMETERS
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
    if roller.case is None:
        raise InputError(
            f"rollers.{name}.roller", None, "the file of the roller", "Add roller: FILE."
        )
    _check_settled(ds)
    cases = {i: case for (i, own), case in cases_of(whole, ds).items() if own == j}
    if not cases:
        raise InputError(
            "--spectrum", name, "a roller that carries load in a load case", "Name another roller."
        )
    blocks: list[dict[str, Any]] = [
        {
            "name": whole.cases[i].name,
            "distance": _short(whole.cases[i].share * whole.distance),
            "velocity": _short(case.velocity),
            **{load: _short(getattr(case, load)) for load in LOADS},
        }
        for i, case in cases.items()
    ]
    passes = float(passes_per_km(whole)[j])
    if math.isfinite(passes):
        for block in blocks:
            block["guide_overrollings"] = _short(passes * block["distance"] / 1000)
    lifted = [case for i, case in enumerate(whole.cases) if i not in cases]
    share = sum(case.share for case in lifted)
    text = f"Roller {name} of {whole.name}, {whole.distance:g} m of travel per shift."
    if lifted:
        named = ", ".join(case.name for case in lifted)
        text += (
            f" No block holds {100 * share:.4g} % of the travel, in which the roller is "
            f"lifted: {named}."
        )
    base, options = parts_for_spectrum(roller.given)
    head = {
        "name": name_of_study(f"{whole.name}-{name}"),
        "description": text,
        "base": base,
        "blocks": blocks,
    }
    duty = whole.duty
    if duty is None:
        duty = roller.given.get("duty")
    if isinstance(duty, Mapping):
        head["duty"] = dict(duty)
    return head | options


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
        if roller.case is None:
            raise InputError(
                f"rollers.{roller.name}.roller", None, "the file of the roller", "Add roller: FILE."
            )
    _check_settled(ds)
    _check_same_options(whole)
    base, varying = _shared(whole)
    of_travel: tuple[str, ...] = OF_LOADS
    if math.isfinite(whole.stroke):
        of_travel = (*OF_LOADS, OVERROLLINGS)
    units = {name: PARAMETERS[name].unit for name in (*varying, *of_travel) if name in PARAMETERS}
    heads = [*HEADS.split(","), *of_travel, *varying]
    rows: list[list[Any]] = [[_head(name, units.get(name, "-")) for name in heads]]
    for (i, j), case in sorted(cases_of(whole, ds).items()):
        fields = [getattr(case, name) for name in (*of_travel, *varying)]
        shown = [_cell(value) for value in fields]
        names = (whole.cases[i].name, whole.rollers[j].name)
        rows.append([inert_cell(cell) for cell in (*names, f"{whole.cases[i].share:.10g}", *shown)])
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    lifted = ds["radial_force"].size - (len(rows) - 1)
    text = f"Loads of the rollers of {whole.name} by load case."
    if lifted:
        text += f" Rollers that are lifted carry no load and have no row, {lifted} in all."
    study = {
        "name": name_of_study(f"{whole.name}-loads"),
        "description": text,
        "base": base,
        "method": "table",
        "table": table,
    }
    columns = zip(heads, zip(*rows[1:], strict=True), strict=True)
    varies = [name for name, column in columns if name not in OF_LOADS and len({*column}) > 1]
    study["roles"] = dict.fromkeys(varies, "condition")  # all cases are conditions of one design
    if whole.duty is None:
        duty = {}
    else:
        duty = {"duty": dict(whole.duty)}
    given = whole.rollers[0].options
    options = {
        key: value
        for key, value in given.items()
        if "study" in OPTIONS[key].files and key != "outputs"
    }
    return study | duty | options, out.getvalue()


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
