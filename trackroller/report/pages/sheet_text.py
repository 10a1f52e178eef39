"""Results of one roller and of a load spectrum for the terminal, and as JSON."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.damage.verdict import STATES
from trackroller.parameters import BODIES, FIRST_TO_FAIL, REGIME_LABELS, REGIMES
from trackroller.report.numbers import lives_in_years
from trackroller.report.pages.carriage import tables as carriage_tables
from trackroller.report.pages.sheet import collect
from trackroller.report.pages.spectrum import assumed, block_table, life_rows, limit_table, warnings
from trackroller.report.tables.limits import BOTH
from trackroller.report.terminal import print_table, print_text
from trackroller.report.words.accuracy import flags_of
from trackroller.report.words.carriage import sentences as carriage_sentences
from trackroller.report.words.spectrum import sentences
from trackroller.roller.dataset import solved_by
from trackroller.roller.duty import duty_of, years
from trackroller.roller.record import doubts_of, friction_records, inputs_of, is_default, materials_of
from trackroller.study.store.provenance import versions


@lives_in_years
def print_facts(ds: xr.Dataset) -> None:
    """Print the facts of a solved roller: verdict, inputs, contacts, life and warnings, and its margins at the end."""
    facts = collect(ds)
    print_text(facts.verdict)
    regime = REGIME_LABELS[int(ds["regime"])]
    print_text(f"regime: {regime}, {'converged' if int(ds['converged']) else 'NOT converged'}")
    if facts.reason:
        print_text(f"reason: {facts.reason}")
    rows = [[row.words, row.value, row.unit, "example" if row.default else "given"] for row in facts.inputs]
    print_table(["input", "value", "unit", "from"], rows, (1,))
    example = "Values from 'example' were not given: the paper's example has them. Give yours."
    for text in filter(None, (example if facts.not_given else "", facts.drive)):
        print_text(text)
    print_text(facts.options, "options")
    if regime == "failed":  # nothing else is known
        return
    if facts.lines:
        print_table(["quantity", "contact 1", "contact 2", "unit"], facts.lines, (1, 2))
    own = [[row.words, row.value, row.unit] for row in facts.whole]
    if own:
        print_table(["whole roller", "value", "unit"], own, (1,))
    for row in facts.lives:
        print_text(f"{row.words}: {row.value} {row.unit}".rstrip(), "life")
    for sentence in facts.data:
        print_text(sentence, "data")
    for flag in facts.flags:
        print_text(f"{flag.sentence} {flag.remedy}", "warning")
    fields = [str(name) for name, variable in ds.data_vars.items() if variable.ndim > 2]
    if fields:
        print_text(f"{', '.join(fields)} (write them with -o)", "fields")
    print_margins(facts, float(ds.attrs["failure_probability"]))


def print_margins(facts: SimpleNamespace, probability: float) -> None:
    """Print the table of margins, what comes first for roller, guide and pair, and what was not checked."""
    rows = [[m.title, "both" if m.body == BOTH else m.body, m.now, m.required, m.share, m.life] for m in facts.margins]
    if rows:
        title = f"Margins, the first limit first, at {100 * probability:g} % failure probability"
        print_table(["limit", "of", "now", "at most", "used", "reached after"], rows, (2, 4, 5), title)
    for sentence in (*facts.first, *facts.guesses, *facts.not_checked):
        print_text(sentence)


@lives_in_years
def print_spectrum(ds: xr.Dataset) -> None:
    """Print the damage of each block, the lives, sentences on their causes and warnings."""
    for part, words in ((block_table(ds), "damage per shift"), (limit_table(ds), "limits")):
        if part is not None:
            print_table(part.heads, part.rows, range(1, len(part.heads)), f"{ds.attrs['title']}: {words}")
            print_text(part.note)
    for body in BODIES:
        lives = "; ".join(f"{row.words}: {row.value} {row.unit}".rstrip() for row in life_rows(ds, body))
        print_text(lives, body)
    for sentence in sentences(ds):
        print_text(sentence.text)
    for text in warnings(ds):
        print_text(text, "warning")
    for text in assumed(ds):
        print_text(text)


@lives_in_years
def print_carriage(ds: xr.Dataset) -> None:
    """Print loads and lives of the rollers of a carriage, its margins, and sentences on them."""
    for part in carriage_tables(ds):
        print_table(part.heads, part.rows, range(2, len(part.heads)), f"{ds.attrs['title']}: {part.title.lower()}")
        print_text(part.note)
    for sentence in carriage_sentences(ds):
        print_text(sentence.text)


_RECORDS = ("case", "materials", "friction", "doubts")  # attributes with keys of their own in JSON


def as_json(ds: xr.Dataset) -> str:
    """Return a result as JSON: every variable with dims, units and values; NaN is null, infinity a text.

    Lives in hours also have years where the duty is known, and `doubts` holds a sentence for each unusual value. The
    result of one case also has its inputs and which of them are defaults, its materials with sources, its flags in
    words, the options and the versions.
    """
    content: dict[str, Any] = {
        str(name): {
            "dims": list(variable.dims),
            "units": variable.attrs.get("units", "1"),
            "value": _plain(variable.values.tolist()),
        }
        for name, variable in ds.variables.items()
    }
    for name, words in (
        ("regime", REGIMES),
        ("first_to_fail", FIRST_TO_FAIL),
        ("limiting_mechanism", (*LIMITS, "unknown")),
        ("limit_state", STATES),
    ):
        if name in content:
            content[name]["meaning"] = np.array(words)[ds[name].values].tolist()
    if "contact_model_used" in content:
        content["contact_model_used"]["meaning"] = solved_by(ds).tolist()
    duty = duty_of(ds)
    if duty is not None:
        for name in (n for n, of in content.items() if of["units"] == "h" and "life" in n):
            content[name]["years"] = _plain(years(ds[name].values, duty).tolist())
    content["doubts"] = doubts_of(ds)
    if "case" in ds.attrs:
        inputs = inputs_of(ds)
        content["inputs"] = {name: {"value": _plain(v), "default": is_default(name, v)} for name, v in inputs.items()}
        content["materials"], content["friction"] = materials_of(ds), friction_records(ds.attrs)
        content["flags"] = [vars(flag) for flag in flags_of(ds)]
        content["options"] = {k: _plain(v) for k, v in ds.attrs.items() if k not in _RECORDS}
        content["versions"] = versions()
    return json.dumps(content)


def _plain(value: Any) -> Any:
    if isinstance(value, list):
        return [_plain(v) for v in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float) and not np.isfinite(value):
        return None if np.isnan(value) else str(value)
    return value
