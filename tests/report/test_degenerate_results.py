"""Degenerate results pass through every table, figure, page and workbook: no question ends in an error.

Each study is solved once, and its results are then impoverished: constant columns, one level or one row left, and an
output that is missing in all rows.
"""

from __future__ import annotations

import contextlib
import io
import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from golden_pages import visible

import trackroller as tr
from trackroller.report.explorer.page import write_explorer
from trackroller.report.figures.study import draw_all
from trackroller.report.pages.sheet import as_json, print_facts, write_sheet
from trackroller.report.pages.study import write_report
from trackroller.report.printed import print_answer
from trackroller.report.workbook import write_results, write_roller

QUICK = {"contact_model": "sliding", "accuracy": "preview"}
OUTPUTS = ["forces", "contact", "friction_work", "peak_stress", "life", "limits"]
BASE = {"motor_force": 0, "friction_coefficient": 0.1, "guide_overrollings_per_hour": 60}
COMMON = {"name": "poor", "base": BASE, "outputs": OUTPUTS, **QUICK}
RADII = {"roller_profile_radius": {"values": [-8, -7, -6.5]}}
FORCES = {"axial_force": {"uniform": [0, 20]}, "radial_force": {"uniform": [-300, -200]}}
PAIRS = {"roller_material": {"values": ["1.7225-normalised", "1.7225-quenched-tempered"]}}
LIFE = {"pair_life_to_first_limit_hours": {"min": 100}}
CASES = """load case,axial_force,radial_force,roller_profile_radius
start,0,-200,-7
"curve, left",20,-200,-7
stop,10,-150,-7
start,0,-200,-6.5
"curve, left",20,-200,-6.5
stop,10,-150,-6.5
"""
STUDIES = {
    "decide": {"factors": RADII | PAIRS | {"axial_force": {"values": [0, 20]}}, "requirement": LIFE},
    "decide by table": {"table": "cases.csv", "method": "table", "requirement": LIFE, "question": "decide"},
    "how sure": {"factors": FORCES, "method": "lhs", "samples": 16, "requirement": LIFE, "question": "how sure"},
    "what matters by morris": {"factors": RADII | FORCES, "method": "morris", "samples": 2},
    "what matters by saltelli": {"factors": FORCES, "method": "saltelli", "samples": 8},
    "what matters by box_behnken": {
        "factors": FORCES | {"contact_angle": {"uniform": [25, 35]}},
        "method": "box_behnken",
    },
    "best": {
        "factors": {"roller_profile_radius": {"uniform": [-9, -6.3]}} | PAIRS,
        "method": "optimise",
        "goals": {"pair_life_hours": "max", "max_pressure_1": "min"},
        "budget": {"designs": 8, "population": 4},
    },
    "best of one goal": {
        "factors": {"roller_profile_radius": {"uniform": [-9, -6.3]}} | PAIRS,
        "method": "optimise",
        "goals": {"pair_life_hours": "max"},
        "budget": {"designs": 8, "population": 4},
    },
    "which model": {"factors": RADII, "contact_model": ["sliding", "kalker_table"]},
    "how it behaves": {"factors": {"axial_force": {"values": [0, 10, 20, 30]}}},
    "how it behaves by table": {"table": "cases.csv", "method": "table", "question": "how it behaves"},
    "robust": {
        "factors": RADII | {"axial_force": {"normal": [10, 2]}},
        "method": "inner_outer",
        "inner": "lhs",
        "samples": 8,
    },
    "pareto": {
        "factors": RADII | {"axial_force": {"values": [0, 20]}},
        "pareto": {"pair_life_hours": "max", "friction_power": "min"},
    },
}


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """Return a function that solves a study once and returns its gathered results."""
    known = {}

    def solve(name: str) -> xr.Dataset:
        if name not in known:
            folder = tmp_path_factory.mktemp("poor")
            (folder / "cases.csv").write_text(CASES)
            file = folder / "study.yaml"
            file.write_text(json.dumps(COMMON | STUDIES[name]))  # JSON is YAML
            tr.run(file, results=folder / "results", progress=False)
            known[name] = xr.load_dataset(folder / "results" / "poor" / "study.nc")
        return known[name]

    return solve


def floats(ds: xr.Dataset) -> list[str]:
    """Return the names of the results that are numbers."""
    return [str(name) for name, v in ds.data_vars.items() if v.dtype.kind == "f"]


def lost(ds: xr.Dataset, keep: xr.DataArray) -> xr.Dataset:
    """Return results in which only the cases `keep` are solved; the others failed."""
    out = ds.copy(deep=True)
    for name in floats(ds):
        out[name] = ds[name].where(keep)
        out[name].attrs = ds[name].attrs
    for name, failed in (("regime", 3), ("converged", 0)):
        out[name] = ds[name].where(keep, failed).astype(ds[name].dtype)
        out[name].attrs = ds[name].attrs
    return out


def rows_of(ds: xr.Dataset) -> xr.DataArray:
    """Return the number of each case."""
    return (0 * ds["regime"].astype(int)).copy(data=np.arange(ds["regime"].size).reshape(ds["regime"].shape))


def constant(ds: xr.Dataset) -> xr.Dataset:
    """Return results in which every case has the numbers of the first one."""
    out, along = ds.copy(deep=True), ds["regime"].dims
    for name in ds.data_vars:
        if set(along) <= set(ds[name].dims):
            own = ds[name].transpose(*along, ...)
            out[name] = own.copy(data=np.broadcast_to(own.values[(0,) * len(along)], own.shape))
    return out


def one_level(ds: xr.Dataset) -> xr.Dataset:
    """Return results in which only the first level of the first factor is solved."""
    factors = [n for n in (*ds.dims, *ds.coords) if n in ds.coords and set(ds[n].dims) & set(ds["regime"].dims)]
    first = next(n for n in factors if n != "case")
    return lost(ds, (ds[first] == ds[first].values.ravel()[0]) & (rows_of(ds) >= 0))


def one_row(ds: xr.Dataset) -> xr.Dataset:
    """Return results in which only one case is solved."""
    return lost(ds, rows_of(ds) == ds["regime"].size - 1)


def no_row(ds: xr.Dataset) -> xr.Dataset:
    """Return results in which every case failed."""
    return lost(ds, rows_of(ds) < 0)


def without(name: str, ds: xr.Dataset) -> xr.Dataset:
    """Return results in which an output is missing in all rows."""
    out = ds.copy(deep=True)
    out[name] = ds[name] * np.nan
    out[name].attrs = ds[name].attrs
    return out


POOR = {"constant": constant, "one level": one_level, "one row": one_row, "no row": no_row}
QUICKEST = ("decide", "how sure")


def write_all(ds: xr.Dataset, folder: Path) -> str:
    """Write page, tables, figures, workbook and explorer of results, print the answer, and return the page."""
    results = tr.open_study(ds)
    page = write_report(results, folder / "report.html").read_text(encoding="utf-8")
    draw_all(results, folder / "figures")
    write_results(results, folder / "cases.xlsx")
    write_explorer(results, folder / "explorer.html")
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        print_answer(results.answer)
    assert printed.getvalue().strip()
    json.dumps(results.answer.to_dict(), allow_nan=False)
    return page


def told(page: str) -> list[str]:
    """Return the lines of a page that hold a number which is none."""
    return [line for line in visible(page) if re.search(r"\bnan\b", line)]


@pytest.mark.filterwarnings("error::RuntimeWarning")  # it would stand between the lines of the terminal
@pytest.mark.parametrize("how", POOR)
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICKEST else pytest.mark.slow) for name in STUDIES]
)
def test_poor_results_have_a_page_figures_tables_and_an_explorer(solved, tmp_path, name, how):
    assert not told(write_all(POOR[how](solved(name)), tmp_path))


def broken_pages(ds: xr.Dataset, outputs: list[str], folder: Path) -> dict[str, list[str]]:
    """Return what the page says wrongly where one of these outputs is missing in all rows, by output."""
    wrong = {}
    for output in outputs:
        lines = told(write_all(without(output, ds), folder))
        if lines:
            wrong[output] = lines
    return wrong


@pytest.mark.slow
@pytest.mark.parametrize("name", STUDIES)
def test_an_output_that_is_missing_in_all_rows_stops_no_page(solved, tmp_path, monkeypatch, name):
    # each output goes with one question and each question has its share of them; the next test crosses them all
    # and writes the figures, which are only laid out here
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", lambda *_, **__: None)
    ds = solved(name)
    share = floats(ds)[list(STUDIES).index(name) :: len(STUDIES)]
    assert share
    assert not broken_pages(ds, share, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("name", STUDIES)
def test_any_output_that_is_missing_in_all_rows_stops_no_page(solved, tmp_path, name):
    ds = solved(name)
    assert not broken_pages(ds, floats(ds), tmp_path)


@pytest.mark.slow
def test_sheet_workbook_and_json_of_a_roller_bear_an_output_that_is_missing(tmp_path):
    ds = tr.solve(tr.Case(**BASE), OUTPUTS, **QUICK)
    for output in floats(ds):
        poor = without(output, ds)
        page = write_sheet(poor, tmp_path / "sheet.html").read_text(encoding="utf-8")
        assert not told(page), output
        write_roller(poor, tmp_path / "roller.xlsx")
        json.loads(as_json(poor))
        with contextlib.redirect_stdout(io.StringIO()):
            print_facts(poor)
