"""The page of a record that is no study: of one roller, a spectrum, a carriage, or a roller that
wears.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from trackroller.parameters import BODIES, OPTIONS
from trackroller.report import html
from trackroller.report.numbers import plain
from trackroller.report.pages.blocks import screen_of
from trackroller.report.printed import print_answer, print_part
from trackroller.report.tables.inputs import Row, material_rows, material_source
from trackroller.results.answer import Answer
from trackroller.roller import stored_inputs as record
from trackroller.roller.dataset import solved_by
from trackroller.roller.duty import duty_of
from trackroller.roller.requirement import KEY
from trackroller.study.store.provenance import versions

# a command always states them
DECISIVE = ("contact_model", "spin_model", "accuracy", "normal", "life_rule")
FIELDS: dict[str, Any] = {  # of the template; a page states those that it has
    "signed": (),
    "drawing": "",
    "first_figures": (),
    "figures": (),
    "figures_title": "",
    "aside": "",
    "small": (),
    "numbers": "Numbers",
    "given": (),
    "not_given": (),
    "materials": (),
    "options": "",
    "notes": {},
}


def record_text(answer: Answer, kind: str, command: str, **fields: Any) -> str:
    """Return the page of a record as HTML.

    Parameters
    ----------
    answer : Answer
        The record.
    kind : str
        What the page is, for its title.
    command : str
        The line that repeats it.
    **fields : Any
        Fields of `FIELDS` that the page has.
    """
    screen = screen_of(answer)
    content = {"screen": screen, "kind": kind, "command": command, "versions": versions_text()}
    return html.render("record.html.j2", FIELDS | content | fields)


def print_record(answer: Answer) -> None:
    """Print the further tables of a record, and at the end its table, what was not checked, and its
    warnings.
    """
    for part in answer.parts:
        print_part(answer, part)
    print_answer(answer)


def inputs_apart(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Return the inputs that were given, and those that were not."""
    return {
        "given": [row for row in rows if not row.default],
        "not_given": [row for row in rows if row.default],
    }


def pictures(*jobs: Callable[[], Any]) -> dict[str, dict[str, str]]:
    """Draw figures, and return the data URI, caption and sentence of each by its name."""
    from trackroller.report.figures import style  # heavy: matplotlib

    with tempfile.TemporaryDirectory() as place:
        infos = style.draw_all(jobs, Path(place))
        return {
            i.name: vars(i) | {"source": html.data_uri(Path(place, f"{i.name}.svg"))} for i in infos
        }


def versions_text() -> str:
    """Return the versions of the programs that a result depends on."""
    return ", ".join(f"{name} {version}" for name, version in versions().items())


def options_text(ds: xr.Dataset) -> str:
    """Return the options of a solved case, and the contact model that solved it if it is not the
    chosen one.
    """
    return ", ".join(
        f"{plain(name)} {ds.attrs[name]}{_used(ds, name)}" for name in OPTIONS if ds.attrs.get(name)
    )


def _used(ds: xr.Dataset, option: str) -> str:
    """Name the contact model that solved the case if it is not the chosen one; an empty text for
    other options.
    """
    if option != "contact_model" or "contact_model_used" not in ds or ds["contact_model_used"].ndim:
        return ""
    used = solved_by(ds).item()
    if used != ds.attrs[option]:
        return f" (solved by {used})"
    return ""


def body_materials(materials: Mapping[str, Mapping[str, Any]]) -> list[tuple[str, list[Row], str]]:
    """Return head, values and source of each material, once if both bodies are of the same."""
    roller, guide = (materials[f"{body}_material"] for body in BODIES)
    if roller == guide:
        by_body = [("roller and guide", roller)]
    else:
        by_body = [("roller", roller), ("guide", guide)]
    return [
        (head, material_rows(record.as_material(values)), material_source(values))
        for head, values in by_body
    ]


def command_of(ds: xr.Dataset, words: tuple[str, ...] = ("solve",)) -> str:
    """Return the command that solves the case of a result again, or that `words` name."""
    left_out = record.names_not_given(ds.attrs)
    given = {name: value for name, value in record.inputs_of(ds).items() if name not in left_out}
    plain_values = {
        n: v if v is None or isinstance(v, Mapping) else str(v).removesuffix(".0")
        for n, v in given.items()
    }
    beside = {"duty": duty_of(ds), KEY: json.loads(ds.attrs.get(KEY, "{}")) or None}
    return record.solve_command(plain_values | _options_of(ds) | beside, words)


def _options_of(ds: xr.Dataset) -> dict[str, str]:
    """Return the options of a result: those that decide most, and all that are not the default."""
    model = str(ds.attrs["contact_model"])
    options = {}
    for name, option in OPTIONS.items():
        text = ds.attrs.get(name)
        if text and (name in DECISIVE or text != option.attribute(option.default, model)):
            options[name] = str(text)
    return options
