"""What shows a result stands above it: functions of the package, methods of the same names, the notebook view."""

from __future__ import annotations

import html
import re
import subprocess
import sys

import pandas as pd
import pytest
import xarray as xr

import trackroller as tr
from trackroller.study.file.load import parse_study

STUDY = {
    "name": "grooves",
    "factors": {"roller_profile_radius": {"values": [-7, -8]}, "friction_coefficient": {"values": [0.1, 0.2]}},
    "contact_model": "sliding",
    "accuracy": "preview",
}


@pytest.fixture(scope="module")
def results():
    return tr.run(parse_study(STUDY), progress=False)


def frame_text(shown: str) -> str:
    """Return the page inside the frame of a notebook."""
    return html.unescape(re.fullmatch(r'<iframe srcdoc="([^"]*)"[^>]*></iframe>', shown)[1])


@pytest.mark.slow
def test_the_functions_write_what_the_methods_write(results, tmp_path):
    pairs = {
        "report.html": (tr.report, results.report),
        "explorer.html": (tr.explore, results.explore),
        "cases.csv": (tr.workbook, results.export),
    }
    for name, (function, method) in pairs.items():
        first = function(results, tmp_path / name)
        assert first == tmp_path / name
        text = first.read_bytes()
        assert method(tmp_path / name).read_bytes() == text
    table = pd.read_csv(tmp_path / "cases.csv")
    assert table["roller_life_hours"].tolist() == pytest.approx(
        results.to_table()["roller_life_hours"].tolist(), nan_ok=True
    )


@pytest.mark.slow
def test_a_notebook_shows_the_answer_and_the_explorer(results, tmp_path):
    """The explorer in the frame is the page that is written to a file; the answer needs no explorer."""
    assert frame_text(tr.explore(results)._repr_html_()) == tr.explore(results, tmp_path / "e.html").read_text("utf-8")
    shown = frame_text(results._repr_html_())
    assert "grooves" in shown and "data-count" not in shown


def test_only_a_result_is_shown(tmp_path):
    for function, words in ((tr.report, "report"), (tr.explore, "explore"), (tr.workbook, "workbook")):
        with pytest.raises(tr.InputError, match=f"{words} = 'list'.*open_study returns"):
            function([1], tmp_path / "page.html")
    with pytest.raises(tr.InputError, match="results with their study file"):
        tr.explore(xr.Dataset({"life_cycles": 1.0}), tmp_path / "page.html")
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("module", ["trackroller.results.stored_study", "trackroller.fit.bench"])
def test_results_and_fits_are_there_without_pages(module):
    """No module of a page is imported with them, yet the methods that show them are there."""
    code = (
        f"import sys, {module}, trackroller.results.results as r, trackroller.fit.material_fit as f\n"
        "print([m for m in sys.modules if m.startswith('trackroller.report') or m == 'matplotlib'])\n"
        "print(callable(r.Results.report), callable(r.Results.explore), callable(f.MaterialFit.report))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["[]", "True True True"]
