"""The report of a study: one HTML file that works by mail, on a screen and on paper."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from trackroller import parameters
from trackroller.methods import METHODS
from trackroller.report.explorer.page import explorer, secured
from trackroller.report.html import render
from trackroller.report.numbers import (
    capital,
    lives_in_years,
    long_name,
    part_of,
    percent_up,
    rounded,
)
from trackroller.report.pages.blocks import screen_of
from trackroller.report.tables import inputs
from trackroller.report.tables.failures import reason_table, validity_table
from trackroller.report.tables.indices import index_tables
from trackroller.report.tables.table import Table, cell
from trackroller.report.workbook import export, write_answer
from trackroller.results.answer import Answer
from trackroller.results.interim_looks import UNTIL
from trackroller.results.results import Results, shown_answer
from trackroller.results.search_fitness import OPTIMUM
from trackroller.roller.dataset import solved_by
from trackroller.roller.doubts import doubts
from trackroller.roller.stored_inputs import NOT_GIVEN, as_material
from trackroller.study.outputs import OF_UNITS, is_constant_field
from trackroller.study.store.put import put_text, replacing

OPTIONS = tuple(option.name for option in parameters.OPTIONS.values() if option.recorded)
_ELSEWHERE = (
    "notice study materials friction comment title coordinates Conventions life_conventions "
    "sign_conventions design"
)
# attributes that do not stand in the record
_NO_RECORD = {*_ELSEWHERE.split(), *OPTIONS, OPTIMUM, UNTIL, NOT_GIVEN}


def write_report(results: Results, out_html: Path) -> Path:
    """Write the report of a gathered study as one self-contained HTML file, and its tables beside
    it.

    Parameters
    ----------
    results : Results
        The solved study.
    out_html : pathlib.Path
        File to write, completely or not at all. The tables are written to the folder `tables`
        beside it.

    Returns
    -------
    pathlib.Path
        The path of the report.
    """
    text = report_text(results)
    with replacing(Path(out_html).with_name("tables")) as beside:
        export(tables_of(results), beside)
        write_answer(shown_answer(results), beside)
    put_text(Path(out_html), text)
    return Path(out_html)


def report_text(results: Results) -> str:
    """Return the report of a study as HTML; no file is read or written."""
    return page_text(shown_answer(results), proof_of(results), explorer(results))


def page_text(answer: Answer, proof: dict[str, Any], shown: dict[str, Any] | None) -> str:
    """Return the page of an answer as HTML, from its record, its proof and its explorer (None for
    none).
    """
    content = {"screen": screen_of(answer), "proof": proof, "explorer": shown}
    return secured(render("report.html.j2", content, cell=cell))


@lives_in_years
def proof_of(results: Results) -> dict[str, Any]:
    """Return what the folded part of the page needs: inputs, materials, errors, failed cases,
    versions and papers.
    """
    settings = results.study.as_dict()
    attrs = dict(results.data.attrs)
    merged = {name: settings[name] for name in OPTIONS if name in settings} | attrs
    texts = {name: _option_text(_levels(results, name, merged.get(name, ""))) for name in OPTIONS}
    options = [inputs.Row(capital(long_name(name)), text) for name, text in texts.items() if text]
    solution = [
        *options,
        *models_used(results.data),
        *inputs.correlation_row(results),
        *solution_facts(results),
    ]
    return {
        "notice": attrs.get("notice", ""),
        "factors": inputs.factor_table(results),
        "base": inputs.base_rows(results),
        "doubts": _doubts(results),
        "materials": [
            t for t in (inputs.materials_table(attrs), inputs.friction_table(attrs)) if t
        ],
        "solution": solution,
        "tables": [t for t in (validity_table(results), reason_table(results.data)) if t],
        "used": defaultdict(str, merged),
        "design_reference": METHODS[results.config.method_name].reference,
        "results": set(map(str, results.data.data_vars)),
        "record": inputs.record_rows(attrs, _NO_RECORD | _constants_of(attrs)),
        "study_text": str(attrs.get("study", "")),
    }


def tables_of(results: Results) -> list[Table]:
    """Return the tables that stand beside the page as files: failed cases and all indices."""
    tables = [validity_table(results), reason_table(results.data)]
    if results.analysis is not None:
        tables += index_tables(results.analysis)
    return [table for table in tables if table]


def _constants_of(attrs: Mapping[str, Any]) -> set[str]:
    """Return the attributes that hold the inputs that all cases share, and their units: the page
    has a table of them.
    """
    return {name for name in attrs if is_constant_field(name.removesuffix(OF_UNITS))}


def _doubts(results: Results) -> list[str]:
    """Return a sentence for each unusual value of the cases."""
    varied = {
        name: results.table[name].to_numpy()
        for name in results.table
        if name in parameters.PARAMETERS
    }
    materials = map(as_material, inputs.stored_materials(results.data.attrs).values())
    return doubts({**results.base, **varied}, materials)


def _levels(results: Results, name: str, value: Any) -> Any:
    """Return the levels of an option that is a factor, otherwise its value."""
    if name in results.factors:
        return results.levels(name)
    return value


def _option_text(value: Any) -> str:
    """Write an option: a list, as of a factor or of terms, as its entries."""
    if isinstance(value, (list, tuple)):
        return ", ".join(map(str, value))
    return str(value)


def models_used(ds: xr.Dataset) -> list[inputs.Row]:
    """Say how many cases each contact model solved, where another model than the chosen one solved
    some of them.
    """
    if "contact_model_used" not in ds or "contact_model" in ds.coords:
        return []
    used = solved_by(ds)
    counts = {name: int((used == name).sum()) for name in sorted(set(used.ravel().tolist()))}
    if not counts or list(counts) == [ds.attrs.get("contact_model")]:
        return []
    text = ", ".join(f"{name} in {cases}" for name, cases in counts.items())
    return [inputs.Row("Contact model used", f"{text} of {used.size} cases")]


def solution_facts(results: Results) -> list[inputs.Row]:
    """Say how well the cases are solved."""
    ds = results.data
    rows = []
    if "converged" in results.table:
        done = int((results.table["converged"] == 1).sum())
        rows.append(inputs.Row("Converged cases", part_of(done, len(results.table))))
    residual = _finite(ds, "residual")
    if residual.size:
        rows.append(
            inputs.Row(
                "Largest relative residual of the equilibrium", rounded(float(residual.max()), 2)
            )
        )
    error = _finite(ds, "error_estimate")
    if error.size:
        rows.append(
            inputs.Row(
                "Largest estimated relative error of the peak stress",
                percent_up(float(error.max())),
            )
        )
    return rows


def _finite(ds: xr.Dataset, name: str) -> np.ndarray:
    if name in ds:
        values = ds[name].values.astype(float)
    else:
        values = np.empty(0)
    return values[np.isfinite(values)]
