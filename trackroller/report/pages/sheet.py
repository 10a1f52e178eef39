"""The sheet of one roller: its facts (verdict, inputs, results, limits, flags), printed, as a page and as JSON."""

from __future__ import annotations

import json
import math
import tempfile
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.damage.verdict import STATES
from trackroller.materials import Material
from trackroller.parameters import BODIES, FIRST_TO_FAIL, OPTIONS, PARAMETERS, REGIME_LABELS, REGIMES
from trackroller.parameters.example import drive_question, not_given_text
from trackroller.report import html
from trackroller.report.figures.roller_section import drawing
from trackroller.report.numbers import BEYOND, listing, lives_in_years, number, plain, rounded, row_unit
from trackroller.report.tables.inputs import Row, as_material, input_rows, material_rows, material_source
from trackroller.report.tables.limits import (
    BOTH,
    OVERLOADED,
    Margin,
    at_temperature,
    first_limits,
    margins,
    not_checked,
    placeholders,
    unchecked,
    what_ends,
)
from trackroller.report.tables.lives import life_rows
from trackroller.report.terminal import print_table, print_text
from trackroller.report.words.accuracy import flags_of, not_judged
from trackroller.report.words.assumptions import (
    assumptions,
    friction_sentence,
    material_warnings,
    standards,
    strength_sentences,
)
from trackroller.report.words.by_tests import by_tests
from trackroller.report.words.sentence import phrase
from trackroller.report.words.wear import run_in
from trackroller.results.columns import at_surface
from trackroller.roller import stored_inputs as record
from trackroller.roller.dataset import VARIABLES, shown, solved_by, validity_bit
from trackroller.roller.duty import FIELD as DUTY
from trackroller.roller.duty import duty_of, years
from trackroller.roller.output_names import is_life
from trackroller.roller.regime_limits import Limits, limits
from trackroller.roller.settings import SHEET_FIELDS, sheet_of
from trackroller.roller.stored_inputs import doubts_of, friction_records, inputs_of, is_default, materials_of
from trackroller.roller.temperature import temperatures_of
from trackroller.study.store.provenance import versions

SHOWN = ("contact_shear", "contact_1_stress", "contact_2_stress")  # figures of the sheet, as far as drawn
FULL = 150.0  # percent of a limit at the right end of a bar


def write_sheet(ds: xr.Dataset, path: Path | str, name: str = "") -> Path:
    """Write the sheet of a solved roller as one HTML file that stands alone, or as PDF by the name of the file.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case. Figures need the outputs `tractions` and `subsurface`.
    path : Path or str
        The file to write.
    name : str
        Head of the sheet.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If `ds` is not the result of one case, or for another name than .html or .pdf.
    WorkError
        If no browser is there that prints a PDF.
    """
    return html.write_page(Path(path), render(ds, name))


@lives_in_years
def render(ds: xr.Dataset, name: str = "") -> str:
    """Return the sheet as HTML text; see `write_sheet`."""
    drawn = {}
    if any(v.ndim > 2 for v in ds.values()):
        from trackroller.report.figures import contact, wear  # heavy: matplotlib

        drawn = pictures(*contact.figures_of(ds), partial(wear.over_patch, ds))
    facts = collect(ds)
    content = {
        "facts": facts,
        "aside": _less_stressed(ds),
        "name": name or "Track roller",
        "signed": [(head.capitalize(), sheet_of(ds).get(head, "")) for head in (*SHEET_FIELDS, "signature")],
        "drawing": drawing(ds) if "normal_force" in ds else "",
        "figures": [drawn[name] for name in SHOWN if name in drawn],
        "worn": run_in(ds),
        "depth": drawn.get("wear_depth"),
        "full": FULL,
        "probability": f"{100 * float(ds.attrs['failure_probability']):g} %",
    }
    return html.render("sheet.html.j2", content)


def _less_stressed(ds: xr.Dataset) -> str:
    """Name the stress figure that the print leaves out: that of the contact with the lower peak stress."""
    peaks = np.nan_to_num(ds["peak_stress"].max("body").values) if "peak_stress" in ds else np.zeros(2)
    return f"contact_{np.argmin(peaks) + 1}_stress"


def pictures(*jobs: Callable[[], Any]) -> dict[str, dict[str, str]]:
    """Draw figures, and return the data URI, caption and sentence of each by its name."""
    from trackroller.report.figures import style  # heavy: matplotlib

    with tempfile.TemporaryDirectory() as place:
        infos = style.draw_all(jobs, Path(place))
        return {i.name: vars(i) | {"source": html.data_uri(Path(place, f"{i.name}.svg"))} for i in infos}


ROUNDING = 1e-9  # N, mm, MPa, 1: results below are rounding errors of a zero, as the drive torque of a free roller


def collect(ds: xr.Dataset, ranges: Limits | None = None) -> SimpleNamespace:
    """Return the statements of the sheet of a solved case: texts, rows and margins by name.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case.
    ranges : Limits, optional
        Ranges of forces and friction in which the roller rolls; searched if not given.

    Raises
    ------
    InputError
        If `ds` is not the result of one case.
    """
    inputs, stored, given = record.inputs_of(ds), record.materials_of(ds), record.not_given_of(ds)
    from_database = ["friction_coefficient"] if friction_records(ds.attrs) else []
    warm = temperatures_of(ds, inputs["ambient_temperature"])
    materials = {body: as_material(stored[f"{body}_material"]).at(at) for body, at in zip(BODIES, warm, strict=True)}
    regime = REGIMES[int(ds["regime"])]
    ranges = ranges or limits(record.case_of_result(ds), str(ds.attrs["contact_model"]))
    drive = drive_question(given, set(PARAMETERS) - set(given))
    lifeless = {body: _no_life(regime, ds, body, material) for body, material in materials.items()}
    lives, own = life_rows(ds, inputs, materials, lifeless), margins(ds, ranges, inputs, materials, lifeless)
    below, above = inputs["axial_force"] - ranges.axial_force[0], ranges.axial_force[1] - inputs["axial_force"]
    reason = str(ds["reason"].item()) if "reason" in ds else ""
    summed = {"reserve": min(above, below), "toward": "more" if above <= below else "less", "axial": ranges.axial_force}
    tested = by_tests(ds)
    said = filter(
        None,
        [*tested, friction_sentence(ds), *strength_sentences(materials), *material_warnings(stored, materials)],
    )
    return SimpleNamespace(
        verdict=_verdict(regime, ds, lives, lifeless, own, reason=reason, **summed),
        reason=reason,
        inputs=[*_size_rows(ds), *input_rows(inputs, [*given, *from_database])],
        not_given=not_given_text(given),
        doubts=[*record.doubts_of(ds), *filter(None, [drive])],
        drive=drive,
        materials=body_materials(stored),
        lines=_contact_lines(ds),
        whole=quantity_rows(ds, shown()),
        lives=lives,
        margins=own,
        first=first_limits(own, not not_judged(ds)),
        not_checked=not_checked(ds),
        flags=flags_of(ds),
        assumptions=assumptions(ds),
        standards=standards(ds),
        data=list(said),
        guesses=[*placeholders(ds), *at_temperature(ds)],
        options=", ".join(f"{plain(name)} {ds.attrs[name]}{_used(ds, name)}" for name in OPTIONS if ds.attrs.get(name)),
        command=command_of(ds),
        versions=versions_text(),
    )


def _size_rows(ds: xr.Dataset) -> list[Row]:
    """Return the outer radius and groove depth of a roller, and its duty, as far as they were given."""
    rows = [Row(f"{plain(name)} of the roller", number(value), "mm") for name, value in record.radii_of(ds).items()]
    if duty := duty_of(ds):
        hours, days = (number(duty[n.name]) for n in DUTY.numbers)
        rows.append(Row("duty", f"{hours} h a day, {days} days a year"))
    return rows


def _used(ds: xr.Dataset, option: str) -> str:
    """Name the contact model that solved the case if it is not the chosen one; an empty text for other options."""
    used = solved_by(ds).item()
    return f" (solved by {used})" if option == "contact_model" and used != ds.attrs[option] else ""


def versions_text() -> str:
    """Return the versions of the programs that a result depends on."""
    return ", ".join(f"{name} {version}" for name, version in versions().items())


def body_materials(materials: Mapping[str, Mapping[str, Any]]) -> list[tuple[str, list[Row], str]]:
    """Return head, values and source of each material, once if both bodies are of the same."""
    roller, guide = (materials[f"{body}_material"] for body in BODIES)
    by_body = [("roller and guide", roller)] if roller == guide else [("roller", roller), ("guide", guide)]
    return [(head, material_rows(as_material(values)), material_source(values)) for head, values in by_body]


def command_of(ds: xr.Dataset, words: tuple[str, ...] = ("solve",)) -> str:
    """Return the command that solves the case of a result again, or that `words` name."""
    given = {name: value for name, value in record.inputs_of(ds).items() if not record.is_default(name, value)}
    plain = {n: v if v is None or isinstance(v, Mapping) else str(v).removesuffix(".0") for n, v in given.items()}
    named = ("contact_model", "spin_model", "accuracy", "normal", "life_rule")
    plain |= {name: ds.attrs.get(name) for name in named}
    plain |= {n: ds.attrs.get(n) for n in ("wear_law", "life_criterion") if ds.attrs.get(n) != OPTIONS[n].default}
    return record.solve_command(plain | {"duty": duty_of(ds)}, words)


def _contact_lines(ds: xr.Dataset) -> list[list[str]]:
    """Return words, both values and unit of each quantity of the contacts; nothing if a contact has lifted off."""
    if "normal_force" in ds and np.isnan(ds.variables["normal_force"].values).any():
        return []
    lines = [(_words(n), ds.variables[n].values, VARIABLES[n].units) for n in shown("contact") if n in ds]
    if {"peak_stress", "peak_z"} <= set(ds):
        stated = ds[["peak_stress", "peak_z", *(n for n in ("semi_axis_lateral", "semi_axis_rolling") if n in ds)]]
        depth = stated["peak_z"].where(at_surface(stated) != 1, 0.0)  # the place of a peak at the surface is rounding
        for body in BODIES:
            peak = stated["peak_stress"].sel(body=body).values
            lines.append((f"peak stress of the {body} (von Mises)", peak, "MPa"))
            lines.append((f"depth of the peak in the {body}", depth.sel(body=body).values, "mm"))
    known = [line for line in lines if np.isfinite(line[1]).all()]
    return [[words, *map(_number, values), row_unit(units)] for words, values, units in known]


def _no_life(regime: str, ds: xr.Dataset, body: str, material: Material) -> str:
    """Say why a body has no fatigue life: overload or a skidding roller; an empty text if it has one."""
    peaks = ds["peak_stress"].sel(body=body).values if "peak_stress" in ds else np.zeros(1)
    if (over := float(np.nan_to_num(peaks).max()) / material.tensile_strength) > 1:
        return f"the peak stress is {rounded(over, 2)} times its {OVERLOADED}"
    if "validity_body" in ds and int(ds["validity_body"].sel(body=body)) & validity_bit("static"):
        return f"the peak stress exceeds its {OVERLOADED}"
    return "the roller skids: friction heat and wear decide" if regime == "full_slip" else ""


def _verdict(
    regime: str, ds: xr.Dataset, lives: list[Row], lifeless: Mapping[str, str], own: list[Margin], **values: Any
) -> str:
    """Return the summary of the sheet: what rules (lift-off, overload, skidding, life) and the distance to lift-off."""
    states: dict[str, dict[str, list[str]]] = {"exceeded": {}, "open": {}}
    for margin in (m for m in own if m.state in states and not m.breaks and not m.beside):
        states[margin.state].setdefault(margin.short, []).append(margin.body)
    texts = {state: [f"{title} ({listing(bodies)})" for title, bodies in s.items()] for state, s in states.items()}
    ends = what_ends(own)
    of_roller = [row for row in lives if row.words.startswith(("roller, until", "roller, median"))]
    known = of_roller and not any(lifeless.values()) and math.isfinite(float(ds["roller_life_hours"]))
    first = FIRST_TO_FAIL[int(ds["first_to_fail"])] if known else ""
    return phrase(
        "sheet",
        "verdict",
        regime=regime,
        overloaded=[f"at the {body} {why}" for body, why in lifeless.items() if OVERLOADED in why],
        **texts,
        ends=ends,
        outside=not_judged(ds),
        unchecked=unchecked(ds),
        lives=list(map(_hours, of_roller[:2])) if known and not ends else [],
        contact=int(ds["life_hours"].sel(body="roller").idxmin("contact")) if known and first != "guide" else None,
        guide=_hours(lives[-1]) if first == "guide" and not ends else "",
        **values,
    )


def _hours(row: Row) -> str:
    """Return the hours of a life with its failure probability, and whether it lies beyond the S-N data."""
    remarks = [row.words.partition("until ")[2].partition(" have")[0] or "median"]
    return f"{row.value.partition(';')[0]} ({', '.join(remarks + [BEYOND] * (BEYOND in row.value))})"


def quantity_rows(ds: xr.Dataset, names: Iterable[str]) -> list[Row]:
    """Return the finite ones of some results, each with its symbol and unit."""
    stated = [(n, float(ds.variables[n].values), VARIABLES[n].units) for n in names if n in ds]
    return [Row(_words(name), _number(value), row_unit(units)) for name, value, units in stated if np.isfinite(value)]


def _number(value: float) -> str:
    return number(value if abs(value) > ROUNDING else 0.0)


def _words(name: str) -> str:
    """Return the name of a result without remarks, and its symbol if that is no formula."""
    words, _, _ = VARIABLES[name].long_name.partition(",")
    symbol = VARIABLES[name].symbol
    return f"{words} {symbol}" if symbol.replace("_", "").isalnum() else words


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
        for name in (n for n, of in content.items() if of["units"] == "h" and is_life(n)):
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
