"""The report of a study: one HTML file that works by mail, on a screen and on paper."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from trackroller import parameters
from trackroller.methods import METHODS
from trackroller.parameters.example import not_given_text, used_of
from trackroller.report.explorer.page import explorer, secured
from trackroller.report.html import data_uri, render
from trackroller.report.numbers import (
    capital,
    count,
    lives_in_years,
    long_name,
    part_of,
    percent,
    percent_up,
    plain,
    rounded,
)
from trackroller.report.tables import inputs
from trackroller.report.tables.table import Table, cell
from trackroller.report.words.accuracy import friction_error
from trackroller.report.words.cases import reason_table, regime_table, validity_table
from trackroller.report.words.comparison import report_section
from trackroller.report.words.designs import best_table, rows_table, size_words
from trackroller.report.words.in_short import in_short
from trackroller.report.words.indices import index_table, measure_table, part_tables
from trackroller.report.words.limits import first_limit_table
from trackroller.report.words.optimum import optima_table, steps_table
from trackroller.report.words.pareto import pareto_table
from trackroller.report.words.samples import looks_table
from trackroller.report.words.targets import robust_tables, target_tables
from trackroller.report.workbook import export
from trackroller.results.judging import OPTIMUM
from trackroller.results.looks import UNTIL
from trackroller.results.pareto import given_pareto
from trackroller.results.ranking import headline, robust_design
from trackroller.results.results import Results
from trackroller.roller.dataset import solved_by
from trackroller.roller.doubts import doubts
from trackroller.roller.record import NOT_GIVEN, names_not_given
from trackroller.study.store.replace import put_text, replacing

MAX_SVG = 1_500_000  # bytes; a larger drawing goes in as PNG
OPTIONS = tuple(option.name for option in parameters.OPTIONS.values() if option.recorded)


class Section(NamedTuple):
    """A section of the page; it is left out where it has no sentence, figure or table.

    Attributes
    ----------
    title : its head on the page
    link : its name in the contents; the title if it is not given
    said : heads of `in_short` whose sentences it shows
    figures : beginnings of the names of its figures, of which the first one that is drawn is shown
    every : whether all figures of these names are shown
    listed : whether its sentences are the entries of a list
    """

    title: str
    said: tuple[str, ...] = ()
    figures: tuple[str, ...] = ()
    every: bool = False
    listed: bool = False
    link: str = ""


SECTIONS = {
    "verdict": Section("Verdict", ("Verdict", "Best"), ("designs",)),
    "decide": Section("Decide", ("Decide",), ("pareto-front",)),
    "why": Section("Why", ("Why",), ("morris-", "bands-", "tornado-"), listed=True),
    "ends": Section("Where it ends", ("Where it ends",), ("regime_map",)),
    "models": Section("Contact models compared", figures=("models-",), every=True, link="Contact models"),
}
_ELSEWHERE = (
    "notice study materials friction comment title coordinates Conventions life_conventions sign_conventions design"
)
_NO_RECORD = {*_ELSEWHERE.split(), *OPTIONS, OPTIMUM, UNTIL, NOT_GIVEN}  # attributes that do not stand in the record


def write_report(results: Results, figures_dir: Path, out_html: Path) -> Path:
    """Write the report of a gathered study as one self-contained HTML file, and its tables beside it.

    Parameters
    ----------
    results : Results
        The solved study.
    figures_dir : pathlib.Path
        Folder with the figures and their `index.json`; it may be empty or missing.
    out_html : pathlib.Path
        File to write, completely or not at all. The tables are written to the folder `tables` beside it.

    Returns
    -------
    pathlib.Path
        The path of the report.
    """
    content = contents(results)
    put_text(Path(out_html), page_text(results, content, figures_dir))
    with replacing(Path(out_html).with_name("tables")) as beside:
        export([t for listed in content["tables"].values() for t in listed], beside)
    return Path(out_html)


def page_text(results: Results, content: dict[str, Any], figures_dir: Path) -> str:
    """Return the report as HTML from its `contents`, its figures and its explorer."""
    without = () if content["said"]["why"] else ("why",)  # a figure without a finding says nothing
    shown = content | {
        "figures": figures(Path(figures_dir), without),
        "explorer": explorer(results),
        "sections": SECTIONS,
    }
    return secured(render("report.html.j2", shown, cell=cell))


@lives_in_years
def contents(results: Results) -> dict[str, Any]:
    """Return everything the template needs from the study and its analysis, except figures and explorer."""
    settings, attrs = results.study.as_dict(), dict(results.data.attrs)
    merged = {name: settings[name] for name in OPTIONS if name in settings} | attrs
    models = report_section(results)
    told = [name for name in OPTIONS if name != "not_checked"]  # the verdict names all limits that were not checked
    own = {k: _option_text(_levels(results, k, merged.get(k, ""))) for k in told}
    options = [inputs.Row(capital(long_name(k)), text) for k, text in own.items() if text]
    return {
        "name": settings["name"],
        "description": settings["description"] or attrs.get("comment", ""),
        "facts": _facts(results, merged),
        **sections(results, models),
        "factors": inputs.factor_table(results),
        "base": inputs.base_rows(results),
        "doubts": _doubts(results),
        "not_given": not_given_text(used_of(settings["base"] | settings["factors"], names_not_given(attrs))),
        "options": options + models_used(results.data) + inputs.correlation_row(results),
        "materials": [t for t in (inputs.materials_table(attrs), inputs.friction_table(attrs)) if t],
        "solution": solution_facts(results),
        "used": defaultdict(str, merged),
        "design_reference": METHODS[results.config.design].reference,
        "results": set(map(str, results.data.data_vars)),
        "record": inputs.record_rows(attrs, _NO_RECORD),
        "study_text": str(attrs.get("study", "")),
    }


def _doubts(results: Results) -> list[str]:
    """Return a sentence for each unusual value of the cases."""
    varied = {name: results.table[name].to_numpy() for name in results.table if name in parameters.PARAMETERS}
    return doubts(
        {**results.base, **varied}, map(inputs.as_material, inputs.stored_materials(results.data.attrs).values())
    )


def sections(results: Results, models: dict[str, Any]) -> dict[str, Any]:
    """Return the sentences and the tables of each section.

    The tables of `more` are no part of the page: all indices, and counts of regimes.
    """
    sens, error = results.analysis, friction_error(results)
    summary = in_short(results, models.get("short", []))
    said = {key: [s for head, own in summary if head in one.said for s in own] for key, one in SECTIONS.items()}
    decide: list[Table | None] = [
        optima_table(results) or best_table(results),
        *(steps_table(results), rows_table(results), first_limit_table(results)),
    ]
    front = given_pareto(results)
    if front is not None:
        decide.append(pareto_table(front, results, error))
    more: list[Table | None] = [regime_table(results)]
    if sens is not None:
        decide += target_tables(sens, results)
    if sens is not None and robust_design(sens):
        asked = float(sens.attrs.get("log_life_scatter", 0.0)) > 0  # the verdict leaves the scatter of materials out
        (decide if asked else more).extend(robust_tables(sens, error))
    elif sens is not None:
        more += [index_table(sens, error), *part_tables(sens)]
        index = headline(sens)
        known = [n for n in map(str, sens["output"].values) if np.isfinite(sens[index].sel(output=n)).any()]
        more += [measure_table(sens, name, error) for name in known]
    ends = [validity_table(results), reason_table(results.data)]
    tables = {"decide": decide, "ends": ends, "models": models.get("tables", []), "more": more}
    tables["proof"] = [looks_table(results)]
    return {
        "summary": summary,
        "tables": {key: [t for t in listed if t] for key, listed in tables.items()},
        "said": said | {"models": models.get("said", [])},
        "sure": [s for head, listed in summary if head == "How sure" for s in listed],
    }


def _facts(results: Results, merged: dict[str, Any]) -> str:
    """Return the line under the title: date, design, size, model, accuracy."""
    design, drawn = results.config.design, results.design
    most = "up to " if "point_samples" in drawn.meta else ""
    samples = results.config.samples if results.config.until is None else drawn.samples
    parts = [
        str(merged.get("date_created", ""))[:10],
        f"design of experiments {plain(design)}" + f" with {most}{count(samples)} samples" * METHODS[design].sampled,
        size_words(results),
        *(
            f"{plain(name)} {_option_text(_levels(results, name, merged[name]))}"
            for name in ("contact_model", "accuracy")
        ),
    ]
    chance = results.config.failure_probability
    return " · ".join(filter(None, [*parts, f"lives at {percent(chance)} failures" * (chance != 0.5)]))


def _levels(results: Results, name: str, value: Any) -> Any:
    """Return the levels of an option that is a factor, otherwise its value."""
    return results.levels(name) if name in results.factors else value


def _option_text(value: Any) -> str:
    """Write an option: a list, as of a factor or of terms, as its entries."""
    return ", ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)


def models_used(ds: xr.Dataset) -> list[inputs.Row]:
    """Say how many cases each contact model solved, where another model than the chosen one solved some of them."""
    if "contact_model_used" not in ds or "contact_model" in ds.coords:
        return []
    used = solved_by(ds)
    counts = {name: int((used == name).sum()) for name in sorted(set(used.ravel().tolist()))}
    if not counts or list(counts) == [ds.attrs.get("contact_model")]:
        return []
    said = ", ".join(f"{name} in {cases}" for name, cases in counts.items())
    return [inputs.Row("Contact model used", f"{said} of {used.size} cases")]


def solution_facts(results: Results) -> list[inputs.Row]:
    """Say how well the cases are solved."""
    ds, rows = results.data, []
    if "converged" in results.table:
        done = int((results.table["converged"] == 1).sum())
        rows.append(inputs.Row("Converged cases", part_of(done, len(results.table))))
    if (known := _finite(ds, "residual")).size:
        rows.append(inputs.Row("Largest relative residual of the equilibrium", rounded(float(known.max()), 2)))
    if (known := _finite(ds, "error_estimate")).size:
        rows.append(inputs.Row("Largest estimated relative error of the peak stress", percent_up(float(known.max()))))
    return rows


def _finite(ds: xr.Dataset, name: str) -> np.ndarray:
    values = ds[name].values.astype(float) if name in ds else np.empty(0)
    return values[np.isfinite(values)]


def figures(folder: Path, without: tuple[str, ...] = ()) -> dict[str, list[dict[str, Any]]]:
    """Return the figures that `index.json` of a folder lists, as data URIs with their texts, by section of the page.

    They are numbered in the order of the page; the sections `without` have none.
    """
    listed: list[dict[str, Any]] = []
    if (folder / "index.json").is_file():
        listed = json.loads((folder / "index.json").read_text(encoding="utf-8"))
    placed: dict[str, list[dict[str, Any]]] = {key: [] for key in SECTIONS}
    for section, one in SECTIONS.items():
        found = [item for start in one.figures for item in listed if item["name"].startswith(start)]
        for item in [] if section in without else found if one.every else found[:1]:
            drawn = folder / f"{item['name']}.svg"
            drawn = drawn if drawn.stat().st_size <= MAX_SVG else drawn.with_suffix(".png")
            placed[section].append(item | {"source": data_uri(drawn)})
    for number, item in enumerate((item for items in placed.values() for item in items), 1):
        item["number"] = number
    return placed
