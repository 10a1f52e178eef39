"""Size the roller of a load spectrum: the life of each roller of a shelf under all blocks.

Damage adds up over the blocks, limit by limit, as in the page of a spectrum. A row of a study is
one case with a life of its own, and a spectrum has one life of many cases. So each roller has its
own spectrum and there is no study; the spectrum with the least roller is returned as a file.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.errors import unknown_name
from trackroller.files import files_beside
from trackroller.numerics.plain import plain
from trackroller.parameters import BODIES, MAPPING_FIELDS
from trackroller.results.load_ratio import EXACT, LoadRatios, load_ratios_of_cases
from trackroller.results.roller_answer import material_name
from trackroller.results.size_verdicts import (
    RATIO,
    VERDICTS,
    is_permitted_known,
    lacks_in_words,
    permitted_ratios,
)
from trackroller.results.spectrum_answer import answer_of_spectrum
from trackroller.roller.requirement import DEFAULT, checked_requirement
from trackroller.study.design.factor_names import CASE_FIELDS
from trackroller.study.file.shelf import ROLLER
from trackroller.study.file.study import Study
from trackroller.study.spectrum.file import Spectrum
from trackroller.study.spectrum.solve import solve_spectrum


def spectrum_table(
    values: Mapping[str, Any],
    path: Path | None,
    shelf: Study,
    *,
    life: str | float | None,
    safety: float | None,
    least: str | None,
    permitted: tuple[str, ...] = (),
) -> tuple[pd.DataFrame, LoadRatios]:
    """Return the rollers of a shelf with their verdicts under a load spectrum, and load ratios.

    Parameters
    ----------
    values : mapping
        Keys of a spectrum file.
    path : pathlib.Path, optional
        The file, beside which a table of blocks is found.
    shelf : Study
        A study of the rollers of the shelf with the `base` of the spectrum.
    life : str or float, optional
        Required life: hours of travel, or years such as "3 years" beside a duty.
    safety : float, optional
        Factor on all forces at which no limit may be exceeded [1].
    least : str, optional
        Column of the shelf by which rollers rank.
    permitted : tuple of str
        The permitted values that are required, of `trackroller.results.size_verdicts.PERMITTED`.

    Returns
    -------
    tuple of pandas.DataFrame and LoadRatios
        The table by roller, as `trackroller.results.size.Sizing` has it without ranks, and the
        load ratios in the worst block.
    """
    known = [name for name, factor in shelf.columns_of_shelves.items() if factor.numeric]
    if least and least not in known:
        raise unknown_name("least", least, known)
    levels = _levels(shelf)
    columns = shelf.drawn.columns
    spectra = []
    for name in levels:
        with files_beside(path):
            spectra.append(Spectrum.from_dict(spectrum_with(values, shelf, name)))
    required = math.nan
    if life is not None:
        entry = checked_requirement({DEFAULT: {"min": life}}, spectra[0].duty)
        required = float(entry[DEFAULT].least)
    ratios = _ratios(spectra, levels, shelf)
    rows = []
    for own in spectra:
        ds = solve_spectrum(own, shelf.materials)
        rows.append(_judged(ds, own, required, permitted))
    table = pd.DataFrame(rows, pd.Index(levels, name=ROLLER))
    if life is None:
        table = table.drop(columns="life_ratio")
    goods = [name for name in shelf.columns_of_shelves if name not in CASE_FIELDS]
    for name in reversed(goods):
        table.insert(0, name, list(columns[name]))
    table["load_ratio"] = ratios.least.reindex(table.index)
    table["load_ends"] = ratios.first.reindex(table.index)
    if safety is not None:
        table = _with_safety(table, safety)
    return table, ratios


def _levels(shelf: Study) -> list[str]:
    """Return the names of the rollers of a shelf."""
    return [str(level) for level in shelf.parsed[ROLLER].levels]


def spectrum_with(values: Mapping[str, Any], shelf: Study, name: str) -> dict[str, Any]:
    """Return the keys of a spectrum file with a roller of a shelf.

    Parameters
    ----------
    values : mapping
        Keys of a spectrum file.
    shelf : Study
        As for `spectrum_table`.
    name : str
        Name of the roller.
    """
    place = _levels(shelf).index(name)
    columns = shelf.drawn.columns
    row = {key: column[place] for key, column in columns.items() if key in CASE_FIELDS}
    return {**values, "base": _base(shelf, row)}


def _base(shelf: Study, row: Mapping[str, Any]) -> dict[str, Any]:
    """Return the `base` of the spectrum of a roller: what the user gave, and the row of the
    shelf.
    """
    given = {name: v for name, v in shelf.config.base.items() if name not in shelf.not_given}
    own = {name: plain(value) for name, value in row.items() if not _is_missing(value)}
    for name in MAPPING_FIELDS:
        if isinstance(own.get(name), str):
            own[name] = json.loads(own[name])
    return given | own


def _is_missing(value: Any) -> bool:
    return value is None or value == "" or (isinstance(value, float) and math.isnan(value))


def _ratios(spectra: list[Spectrum], levels: list[str], shelf: Study) -> LoadRatios:
    """Return the load ratios of the spectra, of which a block without travel does not count."""
    cases = []
    labels = []
    for name, own in zip(levels, spectra, strict=True):
        travelled = [block.case for block in own.blocks if block.distance > 0]
        cases += travelled
        labels += [name] * len(travelled)
    outputs = dict.fromkeys(("forces", "contact", "peak_stress", "limits", *spectra[0].groups))
    options = {**spectra[0].options, "outputs": list(outputs)}
    return load_ratios_of_cases(cases, labels, options, shelf.materials)


def _judged(
    ds: xr.Dataset, own: Spectrum, required: float, permitted: tuple[str, ...]
) -> dict[str, Any]:
    """Return verdict, life and what excludes a roller by its solved spectrum."""
    head = answer_of_spectrum(ds).headline
    unknown = [one for one in permitted if not is_permitted_known(ds, one).all()]
    ratios = {RATIO[one]: permitted_ratios(ds, one, required) for one in permitted}
    ends = " or ".join(head["ends"])
    over = [_exceeded(one) for one in (*head["broken"], *head["exceeded"])]
    lacking = [body for body in head["unknown"] if body == "roller" or _rolls_over(own)]
    verdict = VERDICTS[0]
    why = ""
    if over:
        verdict = VERDICTS[2]
        why = ", ".join(over)
    elif head["high"] < required:
        verdict = VERDICTS[2]
        why = f"life: {ends} after {head['low']:.4g} h"
    elif lacking and not math.isnan(required):
        verdict = VERDICTS[1]
        why = f"open: the life of the {' and '.join(lacking)} is not known"
    elif unknown:
        verdict = VERDICTS[1]
        names = {material_name(ds, body) for body in BODIES}
        why = f"open: {'; '.join(lacks_in_words(ds, one, names) for one in unknown)}"
    elif head["not_judged"]:
        verdict = VERDICTS[1]
        why = f"open: {'; '.join(head['not_judged'])}"
    elif head["low"] < required:
        verdict = VERDICTS[1]
        why = f"open: {ends} between {head['low']:.4g} and {head['high']:.4g} h"
    return {
        "verdict": verdict,
        "life_hours": head["low"],
        "life_ratio": head["low"] / required,
        "ends": ends,
        **{name: float(np.nanmin(values)) for name, values in ratios.items()},
        "excluded_by": why,
    }


def _exceeded(one: Mapping[str, Any]) -> str:
    """Return an exceeded limit of the headline in words, with its use where it is known."""
    words = f"{one['limit']} of the {one['body']}"
    if math.isnan(one["use"]):
        return words
    return f"{words} at {100 * one['use']:.0f} %"


def _rolls_over(own: Spectrum) -> bool:
    """Return whether the overrollings of the guide are known in a block."""
    return any(
        block.guide_overrollings is not None or block.case.guide_overrollings_per_hour is not None
        for block in own.blocks
    )


def _with_safety(table: pd.DataFrame, safety: float) -> pd.DataFrame:
    """Return the table with what becomes of each roller at the forces times the safety."""
    texts = []
    for place in range(len(table)):
        row = table.iloc[place]
        if np.isnan(row["load_ratio"]):
            texts.append("not judged")
        elif row["load_ratio"] < safety * (1.0 - EXACT):
            texts.append(f"{row['load_ends']} at {row['load_ratio']:.3g} times the forces")
        else:
            texts.append("held")
    out = table.assign(overload=texts)
    for place, text in enumerate(texts):
        name = out.index[place]
        if text == "not judged" and out.loc[name, "verdict"] == VERDICTS[0]:
            out.loc[name, "verdict"] = VERDICTS[1]
        elif text not in ("held", "not judged"):
            parts = filter(None, [str(out.loc[name, "excluded_by"]), f"overload: {text}"])
            out.loc[name, "excluded_by"] = "; ".join(parts)
            out.loc[name, "verdict"] = VERDICTS[2]
    return out
