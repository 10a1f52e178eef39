"""The explorer as a section of the report, and as a page of its own; both forbid every request."""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import json
import re
from importlib import resources
from pathlib import Path
from typing import Any

import markupsafe
import numpy as np

from trackroller.report.explorer.candidate_columns import candidate_columns
from trackroller.report.explorer.pack import affordable_rows, extreme_rows, pack, sample_rows
from trackroller.report.explorer.rows import (
    STATES,
    ExplorerColumn,
    collect,
    solve_inputs,
    strengths,
)
from trackroller.report.html import render
from trackroller.report.numbers import count, lives_in_years
from trackroller.results.pareto import pareto
from trackroller.results.results import Results
from trackroller.study.outputs import flat
from trackroller.study.store.put import put_text

MODEL = "contact_model"  # a Pareto set compares candidates solved with one model
POLICY = "@content-security-policy@"  # stands in the templates where the policy is filled in


@lives_in_years
def explorer(results: Results) -> dict[str, Any]:
    """Return what the template of the explorer needs.

    Parameters
    ----------
    results : the solved study

    Returns
    -------
    `header` (JSON), `rows` (base64), `script` and `style` (text), `sampled` (a sentence, '' if all
    cases are shown)
    """
    ds = results.data
    columns = collect(results)
    settings, setting_columns = solve_inputs(results, {c.name: c for c in columns})
    columns += setting_columns
    of_candidates, lists = candidate_columns(results)
    columns += of_candidates
    state = next(c for c in columns if c.name == "state").values
    cases = len(state)
    chosen = pareto_rows(results, cases) | extreme_rows(
        state, (c.values for c in columns if c.levels is None)
    )
    rows = sample_rows(state, chosen, affordable_rows(columns))
    if len(rows) < cases:
        columns = [dataclasses.replace(c, values=c.values[rows]) for c in columns]
        columns.append(ExplorerColumn("row", "Row", "", "row", rows.astype(float)))
    numbers = _numbers(results)
    if numbers is not None:
        columns.append(ExplorerColumn("case", "Case", "", "row", numbers[rows].astype(float)))
    packed, block = pack(columns)
    compared = ""
    if MODEL in results.factors:
        compared = results.held_level(MODEL)
    header = {
        "name": results.config.name,
        "rows": len(rows),
        "cases": cases,
        "grid": results.grid and len(rows) == cases,
        "settings": settings,
        "strengths": strengths(ds),
        "states": list(STATES),
        "goals": results.goals,
        "constraints": results.config.constraints,
        "compared": compared,
        "lists": lists,
        "columns": packed,
    }
    sampled = ""
    if len(rows) < cases:
        sampled = (
            f"{count(len(rows))} of {count(cases)} cases are shown: a sample by regime and "
            "validity, with all cases of rare states, the smallest and the largest value of every "
            "quantity in every state, and the Pareto set of the study's goals. Counts and shares "
            "are those of the sample."
        )
    return {
        "header": _json(header),
        "rows": markupsafe.Markup(block),
        "script": markupsafe.Markup(asset("explorer.js")),
        "style": markupsafe.Markup(asset("explorer.css")),
        "sampled": sampled,
    }


def _numbers(results: Results) -> np.ndarray | None:
    """Return the case numbers of `trackroller repeat` if they are not the row numbers."""
    ds = results.data
    if (
        "case" not in ds.variables
        or ds["case"].size != len(results.table)
        or ds["case"].dtype.kind not in "fiu"
    ):
        return None
    numbers = flat(ds, "case", results.dims)
    if (numbers == np.arange(len(numbers))).all():
        return None
    return numbers


def pareto_rows(results: Results, cases: int) -> np.ndarray:
    """Mark the cases that no other case beats in the study's goals, shape (n,) bool; all False
    without goals.
    """
    marked = np.zeros(cases, dtype=bool)
    goals = results.goals
    if not goals or results.design.method.points:
        return marked
    front = pareto(results, goals, results.config.constraints)
    marked[front["row"].values[front["optimal"].values == 1]] = True
    return marked


def asset(name: str) -> str:
    """Return the text of a built file of the page."""
    return (resources.files("trackroller.report") / "explorer" / "assets" / name).read_text(
        encoding="utf-8"
    )


def _json(value: Any) -> markupsafe.Markup:
    """Write JSON without NaN. Every `<` is escaped, so that no name of a user can end the script
    element.
    """
    text = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return markupsafe.Markup(
        text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
    )


def secured(page: str) -> str:
    """Fill in the Content-Security-Policy of a page: its own scripts and styles by their digests,
    nothing else.
    """
    policy = ["default-src 'none'", "img-src data:", "base-uri 'none'", "form-action 'none'"]
    for kind in ("script", "style"):
        texts = re.findall(rf"<{kind}>(.*?)</{kind}>", page, re.S)
        digests = [
            base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in texts
        ]
        policy.append(
            " ".join([f"{kind}-src", *([f"'sha256-{digest}'" for digest in digests] or ["'none'"])])
        )
    return page.replace(POLICY, "; ".join(policy), 1)


def explorer_text(results: Results) -> str:
    """Return the explorer of a solved study as one page of HTML."""
    content = {
        "name": results.config.name,
        "description": results.config.description,
        "notice": results.data.attrs.get("notice", ""),
        "explorer": explorer(results),
    }
    return secured(render("explorer.html.j2", content))


def write_explorer(results: Results, out: Path) -> Path:
    """Write the explorer of a solved study as one HTML file.

    Parameters
    ----------
    results : Results
        The solved study.
    out : pathlib.Path
        File to write.

    Returns
    -------
    pathlib.Path
        The path of the page.
    """
    return put_text(out, explorer_text(results))
