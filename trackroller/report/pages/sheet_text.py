"""Results of one roller and of a load spectrum for the terminal, and as JSON."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.analysis.table import BODIES
from trackroller.parameters import CONTACT_MODELS, FIRST_TO_FAIL, REGIME_LABELS, REGIMES
from trackroller.report.pages.sheet_facts import Facts, collect
from trackroller.report.pages.spectrum import block_table, life_rows, warnings
from trackroller.report.terminal import print_table
from trackroller.report.words.flags import flags_of
from trackroller.report.words.spectrum import sentences
from trackroller.roller.record import friction_records, inputs_of, is_default, materials_of
from trackroller.study.store.provenance import versions

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.report.tables.inputs import Row


def print_facts(ds: xr.Dataset) -> None:
    """Print the facts of a solved roller: verdict, inputs with defaults, contacts, life, limits and warnings."""
    facts = collect(ds)
    print(facts.verdict)
    regime = REGIME_LABELS[int(ds["regime"])]
    print(f"regime: {regime}, {'converged' if int(ds['converged']) else 'NOT converged'}")
    if facts.reason:
        print(f"reason: {facts.reason}")
    _print_inputs(facts)
    if any(contact.carries for contact in facts.contacts):
        _print_contacts(facts)
    for head, rows in (("roller", facts.whole), ("life", facts.lives), ("limits", facts.limits)):
        for row in rows:
            print(f"{head:<8} {row.words}: {row.value} {row.unit}".rstrip())
    for flag in facts.flags:
        print(f"warning  {flag.sentence} {flag.remedy}")
    undefined = [str(name) for name, variable in ds.data_vars.items() if variable.ndim <= 2 and _is_undefined(variable)]
    if undefined and not any(contact.carries for contact in facts.contacts):
        print(f"undefined here: all {len(undefined)} forces, stresses, lives and other results")
    elif undefined:
        print(f"undefined here: {', '.join(undefined)}")
    fields = [str(name) for name, variable in ds.data_vars.items() if variable.ndim > 2]
    if fields:
        print(f"fields (write them with -o): {', '.join(fields)}")


def _is_undefined(variable: xr.DataArray) -> bool:
    """Return whether the regime leaves every value of a quantity undefined."""
    return variable.dtype.kind == "f" and bool(variable.isnull().all())


def _print_inputs(facts: Facts) -> None:
    for default, head in ((False, "given"), (True, "default")):
        told = [_told(row) for row in facts.inputs if row.default is default]
        if told:
            print(f"{head:<8} {', '.join(told)}")
    print(f"options  {facts.options}")


def _told(row: Row) -> str:
    return f"{row.words} {row.value} {row.unit}".rstrip()


def _print_contacts(facts: Facts) -> None:
    rows: list[list[str]] = []
    for own in zip(*(contact.rows for contact in facts.contacts), strict=True):
        rows.append([own[0].words, *(row.value for row in own), own[0].unit])
    for bodies in zip(*(contact.bodies for contact in facts.contacts), strict=True):
        rows.append([f"peak stress of the {bodies[0].body}", *(f"{b.peak:.5g}" for b in bodies), "MPa"])
        rows.append(["  share of its fatigue limit", *(f"{100 * b.of_fatigue_limit:.3g}" for b in bodies), "%"])
        rows.append(["  share of its tensile strength", *(f"{100 * b.of_strength:.3g}" for b in bodies), "%"])
    print_table(["quantity", *(f"contact {contact.number}" for contact in facts.contacts), "unit"], rows, 120)


def print_spectrum(ds: xr.Dataset) -> None:
    """Print the damage of each block, the lives, sentences on their causes and warnings."""
    told = block_table(ds)
    title = f"{ds.attrs['title']}: damage per shift"
    print_table(told.heads, told.rows, 180, range(1, len(told.heads)), title)
    print(told.note)
    for body in BODIES:
        print(f"{body:<7} {'; '.join(f'{row.words}: {row.value} {row.unit}'.rstrip() for row in life_rows(ds, body))}")
    for sentence in sentences(ds):
        print(sentence.text)
    for text in warnings(ds):
        print(f"warning {text}")


def as_json(ds: xr.Dataset) -> str:
    """Return a result as JSON: every variable with dims, units and values; NaN is null, infinity a text.

    The result of one case also has its inputs and which of them are defaults, its materials with sources, its flags in
    words, the options and the versions.
    """
    told: dict[str, Any] = {
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
        ("contact_model_used", CONTACT_MODELS),
    ):
        if name in told:
            told[name]["meaning"] = np.array(words)[ds[name].values].tolist()
    if "case" in ds.attrs:
        inputs = inputs_of(ds)
        told["inputs"] = {name: {"value": _plain(v), "default": is_default(name, v)} for name, v in inputs.items()}
        told["materials"], told["friction"] = materials_of(ds), friction_records(ds.attrs)
        told["flags"] = [vars(flag) for flag in flags_of(ds)]
        told["options"] = {k: _plain(v) for k, v in ds.attrs.items() if k not in ("case", "materials", "friction")}
        told["versions"] = versions()
    return json.dumps(told)


def _plain(value: Any) -> Any:
    if isinstance(value, list):
        return [_plain(v) for v in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float) and not np.isfinite(value):
        return None if np.isnan(value) else str(value)
    return value
