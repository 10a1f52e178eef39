"""The sheet of one roller as a page, on a terminal, and as JSON."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.damage.first_limit import STATES
from trackroller.parameters import FIRST_TO_FAIL, REGIME_LABELS, REGIMES
from trackroller.report import html
from trackroller.report.figures.roller_section import drawing
from trackroller.report.headlines import headline_of, warning_line
from trackroller.report.numbers import lives_in_years, number, plain
from trackroller.report.pages.record import (
    body_materials,
    command_of,
    inputs_apart,
    options_text,
    pictures,
    record_text,
)
from trackroller.report.printed import print_answer, print_below_headline, print_part
from trackroller.report.tables.inputs import Row, input_rows
from trackroller.report.terminal import print_table, print_text
from trackroller.report.words.assumptions import (
    assumptions,
    friction_sentence,
    standards,
    strength_sentences,
)
from trackroller.results.answer import Answer, plain_value
from trackroller.results.answer_of_data import answer_of_data
from trackroller.results.roller_answer import answer_of_roller, materials_of_case
from trackroller.results.validity_flags import flags_of
from trackroller.roller import stored_inputs as record
from trackroller.roller.dataset import solved_by
from trackroller.roller.duty import OVERROLLINGS, duty_of, duty_words, strokes_of, years
from trackroller.roller.output_names import is_life
from trackroller.roller.settings import SHEET_FIELDS, sheet_of
from trackroller.roller.stored_inputs import (
    doubts_of,
    friction_records,
    inputs_of,
    is_default,
    materials_of,
)
from trackroller.study.store.provenance import versions

# figures of the sheet, if drawn
SHOWN = ("contact_shear", "contact_1_stress", "contact_2_stress", "wear_depth")
KIND = "sheet of a track roller"


def write_sheet(ds: xr.Dataset, path: Path | str, name: str = "") -> Path:
    """Write the sheet of a solved roller as one HTML file that stands alone, or as PDF by the name
    of the file.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case. Figures need the outputs `tractions` and
        `subsurface`.
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
    answer = named_answer(ds, name or "Track roller")
    picture = ""
    if "normal_force" in ds:
        picture = drawing(ds)
    return record_text(
        answer,
        KIND,
        command_of(ds),
        signed=[
            (head.capitalize(), sheet_of(ds).get(head, "")) for head in (*SHEET_FIELDS, "signature")
        ],
        drawing=picture,
        figures=[drawn[one] for one in SHOWN if one in drawn],
        figures_title="Shear and stress",
        aside=_less_stressed(ds),
        small=("wear_depth",),
        materials=body_materials(materials_of(ds)),
        options=options_text(ds),
        notes=notes_of_sheet(ds),
        **inputs_apart(sheet_inputs(ds)),
    )


def named_answer(ds: xr.Dataset, name: str) -> Answer:
    """Return the record of one roller with the name of its sheet."""
    answer = answer_of_roller(ds)
    sheet = sheet_of(ds)
    return replace(answer, facts={**answer.facts, "name": name, "date": sheet.get("date", "")})


def notes_of_sheet(ds: xr.Dataset) -> dict[str, list[str]]:
    """Return what the proof of a sheet states, by its head."""
    materials = materials_of_case(ds, inputs_of(ds))
    data = [text for text in (friction_sentence(ds), *strength_sentences(materials)) if text]
    return {
        "Values of the materials": data,
        "Assumptions": assumptions(ds),
        "Standards": [standards(ds)],
    }


def sheet_inputs(ds: xr.Dataset) -> list[Row]:
    """Return the inputs of a roller as they were given: outer radius, groove depth and duty
    first.
    """
    rows = [
        Row(f"{plain(name)} of the roller", number(value), "mm")
        for name, value in record.radii_of(ds).items()
    ]
    duty = duty_of(ds)
    if duty:
        rows.append(Row("duty", duty_words(duty, strokes_of(ds))))
    inputs = inputs_of(ds)
    if strokes_of(ds):
        inputs.pop(OVERROLLINGS)  # the strokes give it; the table of lives shows it
    from_database = []
    if friction_records(ds.attrs):
        from_database = ["friction_coefficient"]
    return [*rows, *input_rows(inputs, record.not_given_of(ds), from_database)]


def _less_stressed(ds: xr.Dataset) -> str:
    """Name the stress figure that the print leaves out: that of the contact with the lower peak
    stress.
    """
    if "peak_stress" in ds:
        peaks = np.nan_to_num(ds["peak_stress"].max("body").values)
    else:
        peaks = np.zeros(2)
    return f"contact_{np.argmin(peaks) + 1}_stress"


@lives_in_years
def print_facts(ds: xr.Dataset) -> None:
    """Print the record of a solved roller: its headline first, then inputs and numbers, and its
    limits at the end.
    """
    answer = answer_of_roller(ds)
    print_text(headline_of(answer).text)
    converged = "NOT converged"
    if answer.facts["converged"]:
        converged = "converged"
    print_text(f"regime: {REGIME_LABELS[int(ds['regime'])]}, {converged}")
    _print_inputs(ds)
    if answer.facts["regime"] == "failed":  # nothing else is known
        for caution in answer.warnings:
            if caution.code == "not_given":
                print_text(warning_line(caution))
        return
    for heading, texts in notes_of_sheet(ds).items():
        if heading == "Values of the materials":
            for text in texts:
                print_text(text, "data")
    fields = [str(name) for name, variable in ds.data_vars.items() if variable.ndim > 2]
    if fields:
        print_text(f"{', '.join(fields)} (write them with -o)", "fields")
    for part in answer.parts:
        print_part(answer, part)
    print_below_headline(answer)


def _print_inputs(ds: xr.Dataset) -> None:
    """Print the inputs of a roller, and the options of the calculation."""
    rows = [[row.words, row.value, row.unit, row.origin] for row in sheet_inputs(ds)]
    print_table(["input", "value", "unit", "from"], rows, (1,))
    if any(row[3] == "example" for row in rows):
        print_text(
            "Values from 'example' were not given: the paper's example has them. Give yours."
        )
    print_text(options_text(ds), "options")


@lives_in_years
def print_limits(ds: xr.Dataset) -> None:
    """Print the table of limits alone, with its headline, what was not checked, and warnings."""
    print_answer(answer_of_roller(ds))


_RECORDS = ("case", "materials", "friction", "doubts")  # attributes with keys of their own in JSON


def as_json(ds: xr.Dataset) -> str:
    """Return a result as JSON: every variable with dims, units and values; NaN is null, infinity a
    text.

    Lives in hours also have years where the duty is known, and `doubts` holds a sentence for each
    unusual value. The result of one case also has its inputs and which of them are defaults, its
    materials with sources, its flags in words, the options and the versions.
    """
    content: dict[str, Any] = {
        str(name): {
            "dims": list(variable.dims),
            "units": variable.attrs.get("units", "1"),
            "value": plain_value(variable.values.tolist()),
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
            content[name]["years"] = plain_value(years(ds[name].values, duty).tolist())
    content["doubts"] = doubts_of(ds)
    answer = answer_of_data(ds)
    if answer is not None:
        content["answer"] = answer.to_dict()
    if "case" in ds.attrs:
        inputs = inputs_of(ds)
        content["inputs"] = {
            name: {"value": plain_value(v), "default": is_default(name, v)}
            for name, v in inputs.items()
        }
        content["materials"] = materials_of(ds)
        content["friction"] = friction_records(ds.attrs)
        content["flags"] = [vars(flag) for flag in flags_of(ds)]
        content["options"] = {k: plain_value(v) for k, v in ds.attrs.items() if k not in _RECORDS}
        content["versions"] = versions()
    return json.dumps(content)
