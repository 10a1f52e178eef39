"""What the page shows of one case: the drawing, both patches, tables, margins, lives, warnings,
curves and texts.
"""

from __future__ import annotations

import base64
import functools
import itertools
import json
import math
import re
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from trackroller.app.tables import limits_on_page, part_on_page
from trackroller.damage import LIMITS
from trackroller.errors import InputError
from trackroller.report.figures.contact_outline import DrawnPatch, patches_of
from trackroller.report.figures.roller_section import drawing
from trackroller.report.headlines import headline_of
from trackroller.report.numbers import head_unit, lives_in_years, on_duty, rounded
from trackroller.report.pages.blocks import warnings_of
from trackroller.report.pages.sheet import render, sheet_inputs, write_sheet
from trackroller.report.workbook import write_roller
from trackroller.results.roller_answer import answer_of_roller
from trackroller.roller.case import Case
from trackroller.roller.duty import EXAMPLE, years
from trackroller.roller.find import find
from trackroller.roller.regime_limits import Limits
from trackroller.roller.requirement import YEARS
from trackroller.roller.settings import BESIDE, checked_case, with_beside
from trackroller.roller.solver import solve
from trackroller.roller.stored_inputs import given_inputs, solve_command
from trackroller.study.outputs import every_name, outputs
from trackroller.yaml_file import parse_yaml, write_yaml

Values = dict[str, Any]
POINTS = 21  # cases of a curve
LIVE = ("forces", "contact", "friction_work", "peak_stress", "life", "tractions")
_JUDGED = tuple(dict.fromkeys(limit.group for limit in LIMITS.values() if limit.use is not None))
# not searched, which takes up to 1 s
_UNKNOWN = Limits((math.nan, math.nan), (math.nan, math.nan), math.nan)
STILL = 0.01  # of the largest local creepage: elements that creep less count as adhering


def read(values: Values) -> tuple[Case, dict[str, Any], dict[str, Any]]:
    """Return what `checked_case` does for the fields of the page; texts are read as those of
    `--set`.
    """
    fields = {name: value for name, value in values.items() if value not in ("", None)}
    for name, value in fields.items():
        if isinstance(value, str):
            fields[name] = parse_yaml(value, name)
    return checked_case(fields)


@functools.lru_cache(maxsize=8)
def _solved(text: str, accuracy: str, groups: tuple[str, ...]) -> xr.Dataset:
    """Return the solution of a case given as JSON; the steps of one picture ask for it several
    times.
    """
    case, options, beside = read(json.loads(text))
    return with_beside(_solve(case, groups, accuracy, options), beside)


def _solve(
    case: Case | Sequence[Case], groups: Sequence[str], accuracy: str, options: dict[str, Any]
) -> xr.Dataset:
    """Solve a case or several with the outputs of the page and those of the case file."""
    own = {"accuracy": accuracy, **options}
    outputs = dict.fromkeys((*groups, *own.pop("outputs", ())))
    return solve(case, tuple(outputs), **own)


def picture(
    values: Values, accuracy: str = "preview", complete: bool = False, inside: bool = False
) -> dict[str, Any]:
    """Solve one case and return everything that the page shows of it, as values of JSON.

    Parameters
    ----------
    values : mapping
        Fields of the case and options by name.
    accuracy : str
        "preview" while a slider moves, "standard" when it rests.
    complete : bool
        Whether to search the distance to lift-off, full slip and self-locking as well.
    inside : bool
        Whether to compute the von Mises stress below the surface as well.

    Raises
    ------
    InputError
        If a value is wrong.
    """
    groups = (*LIVE, *_JUDGED, "limits")
    if inside:
        groups = (*groups, "subsurface")
    ds = _solved(json.dumps(values, sort_keys=True), accuracy, groups)
    unknown: Limits | None = _UNKNOWN
    if complete:
        unknown = None
    sections = []
    if inside:
        sections = _sections(ds)
    return {
        **_facts(ds, unknown),
        "accuracy": accuracy,
        "complete": complete,
        "drawing": drawing(ds),
        "patches": [
            _patch(patch) for patch in patches_of(ds, "pressure", "shear_lateral", "shear_rolling")
        ],
        "sections": sections,
    }


@lives_in_years
def _facts(ds: xr.Dataset, ranges: Limits | None) -> dict[str, Any]:
    """Return the record of a roller, and what the page shows of it: headline, table of limits,
    warnings, inputs.
    """
    answer = answer_of_roller(ds, ranges)
    headline = headline_of(answer)
    return {
        "answer": answer.to_dict(),
        "headline": {"lead": headline.lead, "rest": headline.ending},
        "limits": limits_on_page(answer),
        "parts": {part.name: part_on_page(answer, part) for part in answer.parts},
        "not_checked": {
            body: list(limits) for body, limits in answer.not_checked.items() if limits
        },
        "not_used": dict(answer.not_used),
        "warnings": [[head, where] for head, _, where in warnings_of(answer)],
        "inputs": [asdict(row) for row in sheet_inputs(ds)],
    }


def _bytes(values: np.ndarray, top: float) -> str:
    """Return numbers from 0 to `top` as base64 of one byte each."""
    scaled = 0.0 * values
    if top > 0:
        scaled = values / top
    scaled = np.nan_to_num(scaled)
    return base64.b64encode(
        np.round(255 * np.clip(scaled, 0, 1)).astype(np.uint8).tobytes()
    ).decode()


def _field(values: np.ndarray, words: str, unit: str) -> dict[str, Any]:
    top = float(np.max(np.nan_to_num(values), initial=0.0))
    return {"words": words, "unit": unit, "top": top, "data": _bytes(values, top)}


def _patch(patch: DrawnPatch) -> dict[str, Any]:
    """Return the fields of one patch as bytes, its ends [mm], its edge, the adhesion area and the
    spin pole.
    """
    fields = {
        "pressure": _field(patch.field("pressure"), "pressure", "MPa"),
        "shear": _field(
            np.hypot(patch.field("shear_lateral"), patch.field("shear_rolling")),
            "shear traction",
            "MPa",
        ),
    }
    creepage = np.hypot(patch.field("slip_lateral"), patch.field("slip_rolling"))
    still = patch.inside & (creepage < STILL * np.max(creepage, where=patch.inside, initial=0.0))
    pole = [float(patch.ds.get(f"spin_pole_{way}", math.nan)) for way in ("lateral", "rolling")]
    return {
        "contact": patch.contact,
        "size": [len(patch.x), len(patch.y)],
        "x": [float(patch.x[0]), float(patch.x[-1])],
        "y": [float(patch.y[0]), float(patch.y[-1])],
        "ellipse": None if patch.solved else [patch.a, patch.b],
        "fields": fields,
        "inside": _bytes(patch.inside.astype(float), 1.0),
        "adhesion": _bytes(still.astype(float), 1.0),
        "pole": pole if all(map(math.isfinite, pole)) else None,
    }


def _sections(ds: xr.Dataset) -> list[dict[str, Any]]:
    """Return the von Mises stress below each contact of each body, in the plane across the track
    through the peak.
    """
    maps = []
    for contact, body in itertools.product(
        ds["contact"].values.tolist(), ds["body"].values.tolist()
    ):
        own = ds.sel(contact=contact, body=body)
        x, z, stress = (own[name].values for name in ("xz_x", "xz_z", "von_mises_xz"))
        if np.isfinite(stress).any():
            ends = {
                "x": [float(x[0]), float(x[-1])],
                "z": [float(z[0]), float(z[-1])],
                "size": [len(x), len(z)],
            }
            maps.append(
                {
                    "contact": contact,
                    "body": body,
                    **ends,
                    "field": _field(stress, "von Mises stress", "MPa"),
                }
            )
    return maps


def sheet(values: Values) -> str:
    """Return the sheet of a case as a page to print."""
    return render(_of_sheet(values))


def _of_sheet(values: Values) -> xr.Dataset:
    return _solved(
        json.dumps(values, sort_keys=True), "standard", (*LIVE, *_JUDGED, "limits", "subsurface")
    )


def file_of_roller(values: Values, name: str) -> bytes:
    """Return the sheet of a case as PDF, `sheet.pdf`, or its workbook, `roller.xlsx`."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, name)
        if path.suffix == ".pdf":
            return write_sheet(_of_sheet(values), path).read_bytes()
        return write_roller(_of_sheet(values), path).read_bytes()


def curve(values: Values, over: str, ends: list[float]) -> dict[str, Any]:
    """Solve 21 cases over a parameter in one batch.

    Parameters
    ----------
    values : mapping
        Fields of the case and options by name.
    over : str
        The parameter.
    ends : list of float
        Its first and last value.

    Returns
    -------
    dict
        The values, every result with one number a case by name, and what is wrong with values that
        are refused.
    """
    if len(ends) != 2 or not all(map(math.isfinite, ends)) or ends[0] == ends[1]:
        raise InputError(over, ends, "a first and a last value that differ", "Write two numbers.")
    low, high = ends
    if low * high > 0:
        along = np.geomspace(low, high, POINTS)
    else:
        along = np.linspace(low, high, POINTS)
    cases = []
    solved = []
    refused = ""
    for i, value in enumerate(along):
        try:
            cases.append(read({**values, over: float(value)})[0])
            solved.append(i)
        except InputError as exc:
            refused = str(exc.errors[0])
    if not cases:
        raise InputError(
            over, f"{low:g} to {high:g}", "values of which one at least can be solved", refused
        )
    ds = _solve(cases, (*LIVE[:-1], *_JUDGED, "limits"), "preview", read(values)[1])
    columns = {}
    duty = read(values)[2].get("duty")
    names = every_name(ds, (), ("case",))
    regimes = ("rolling", "full_slip", "lift_off")
    for output in outputs(ds, (), names, regimes, unlimited=True, scale="natural"):
        column = np.full(POINTS, np.nan)
        column[solved] = output.values
        if not np.isnan(column).all():
            # the number of an equation of the paper
            label = re.sub(r", eqs?\. \(\d+\)", "", output.long_name)
            with on_duty(duty):
                columns[output.name] = {
                    "label": label,
                    "unit": head_unit(output.units),
                    "values": column.tolist(),
                }
    return {"over": over, "along": along.tolist(), "columns": columns, "refused": refused}


def find_range(values: Values, over: str, condition: str) -> dict[str, Any]:
    """Find how far a parameter may go so that a condition holds; see `trackroller.find`.

    Parameters
    ----------
    values : mapping
        Fields of the case and options by name.
    over : str
        The parameter.
    condition : str
        A comparison of a result with a number, such as "pair_life_to_first_limit_hours >= 10500",
        or, beside a duty, "pair_life_to_first_limit_hours >= 3 years".

    Returns
    -------
    dict
        The answer in words, and the ends of the range; they are NaN if no value meets the
        condition.
    """
    case, options, beside = read(values)
    in_hours, sentence = _in_hours(condition, beside.get("duty"))
    settings = {name: value for name, value in options.items() if name != "outputs"}
    range_ = find(case, over, in_hours, **settings)
    return {"text": f"{sentence}{range_.text}", "ends": [range_.low, range_.high]}


def _in_hours(condition: str, duty: Any) -> tuple[str, str]:
    """Return a condition whose last number is in years with hours in their place, and a sentence on
    them.
    """
    head, relation, number = condition.rpartition("=")
    years_text = YEARS.fullmatch(number)
    if years_text is None:
        return condition, ""
    if duty is None:
        raise InputError(
            "find", number.strip(), "hours, or years beside a duty", EXAMPLE, "needs a duty"
        )
    hours = float(years_text[1]) / float(years(1.0, duty))
    return f"{head}{relation} {hours!r}", f"{number.strip()} are {rounded(hours, 4)} h. "


def texts(values: Values) -> dict[str, str]:
    """Return the case as a case file (YAML), as a command and as lines of Python."""
    case, options, beside = read(values)
    given = given_inputs(case)
    fields = ", ".join(f"{name}={_python(value)}" for name, value in given.items())
    further = "".join(f", {name}={value!r}" for name, value in options.items())
    # a sheet of `ds` takes both from its attributes
    attributes = "".join(
        f"ds.attrs[{name!r}] = {json.dumps(value)!r}\n" for name, value in beside.items()
    )
    # the duty is in hours
    entries = {name: value for name, value in beside.items() if name in BESIDE}
    return {
        "YAML": write_yaml(given | options | entries),
        "command": solve_command(given | options | entries),
        "Python": "import trackroller as tr\n\nds = "
        f"tr.solve(tr.Case({fields}){further})\n{attributes}",
    }


def _python(value: Any) -> str:
    """Write a value as Python; an infinite number stands as a text in the values of JSON."""
    infinite = isinstance(value, str) and value.lstrip("-") == "inf"
    return f'float("{value}")' if infinite else repr(value)
