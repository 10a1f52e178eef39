"""The load spectrum of the roller on the page: its blocks in, sentences, tables and the spectrum
file out.
"""

from __future__ import annotations

from typing import Any

import xarray as xr

from trackroller.app.materials import typed
from trackroller.app.picture import Values, read
from trackroller.app.tables import limits_on_page, part_on_page
from trackroller.errors import InputError
from trackroller.report.headlines import headline_of, warning_line
from trackroller.report.numbers import lives_in_years
from trackroller.results.spectrum_answer import answer_of_spectrum
from trackroller.roller.settings import LOADS, parts_for_spectrum
from trackroller.roller.stored_inputs import given_inputs
from trackroller.study.spectrum.file import TRAVEL, Spectrum
from trackroller.study.spectrum.solve import solve_spectrum
from trackroller.yaml_file import write_yaml


def spectrum(values: Values, by: str, blocks: list[dict[str, str]]) -> dict[str, Any]:
    """Sum the loads of a roller over the blocks of a spectrum.

    Parameters
    ----------
    values : mapping
        Fields of the case and options by name; the blocks replace its forces.
    by : str
        What the amount of each block is: `share` of the time of travel, or `hours` or `distance`
        [m] of a shift.
    blocks : list of dict
        `name`, `amount`, `radial_force` and `axial_force` of each block, as texts; a decimal comma
        is a point.

    Returns
    -------
    dict
        The record, its headline, warnings and tables as texts, and the text of the spectrum file.
    """
    if by not in TRAVEL:
        raise InputError("by", by, ", ".join(TRAVEL), "Choose what the blocks are given by.")
    case, options, beside = read(values)
    base, settings = parts_for_spectrum(given_inputs(case) | options)
    loads = [
        {"name": block.get("name") or f"load {i}", by: typed(block.get("amount", ""))}
        | {name: typed(block.get(name, "")) for name in LOADS}
        for i, block in enumerate(blocks, 1)
    ]
    duty = {}
    if "duty" in beside:
        duty = {"duty": beside["duty"]}
    file = {"name": "loads-of-the-roller", "base": base, **duty, "blocks": loads, **settings}
    return _answer(solve_spectrum(Spectrum.from_dict(file))) | {"text": write_yaml(file)}


@lives_in_years
def _answer(ds: xr.Dataset) -> dict[str, Any]:
    answer = answer_of_spectrum(ds)
    headline = headline_of(answer)
    return {
        "answer": answer.to_dict(),
        "headline": {"lead": headline.lead, "rest": headline.ending},
        "warnings": [warning_line(caution) for caution in answer.warnings],
        "not_checked": {
            body: list(limits) for body, limits in answer.not_checked.items() if limits
        },
        "tables": [limits_on_page(answer), *(part_on_page(answer, part) for part in answer.parts)],
    }
