"""The report: complete, one file without network, safe against markup in names, whole in a browser."""

from __future__ import annotations

import json
import re
from contextlib import closing
from html.parser import HTMLParser

import numpy as np
import pytest
import xarray as xr
from browser import CHROMIUM, Browser
from synthetic_results import PAIRS, grid_study, results_of, sampled_study
from told import occurrence

from trackroller.parameters.validity import VALIDITY
from trackroller.report.build import build_report
from trackroller.report.figures.study import draw_all
from trackroller.report.pages.study import SECTIONS, Section, contents, models_used, page_text, write_report
from trackroller.report.tables.inputs import Row
from trackroller.report.tables.table import Table
from trackroller.report.words.cases import regime_table, validity_table
from trackroller.study.store.folder import StudyFolder
from trackroller.study.store.replace import put, put_text

FACTORS = {
    "friction_coefficient": [0.05, 0.3, 0.4],
    "roller_profile_radius": [-8.0, -7.0, -6.4],
    "material_pair": list(PAIRS),
    "motor_force": [-30.0, 0.0],
    "axial_force": [0.0, 30.0, 130.0],
    "guide_curve_radius": [220.0, float("inf")],
}


class _Balanced(HTMLParser):
    """Collects open tags; a report must close what it opens."""

    void = frozenset(("meta", "link", "br", "img"))

    def __init__(self):
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag, attrs):
        if tag not in self.void:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    grid_study(FACTORS).to_netcdf(folder / "study.nc")
    draw_all(results_of(folder / "study.nc"), folder / "figures")
    return write_report(results_of(folder / "study.nc"), folder / "figures", folder / "report.html")


def test_a_long_cell_that_equals_the_one_above_says_so(tmp_path):
    ds = grid_study({"axial_force": [0.0, 130.0], "friction_coefficient": [0.1, 0.2]})
    long = ["no convergence, " * 6 + str(i) for i in (0, 1)]
    ds["reason"] = xr.full_like(ds["regime"], long[0], dtype=object)
    table = Table("reasons", "Reasons", ["Case", "Reason"], [[1, long[0]], [2, long[0]], [3, long[1]]])
    content = contents(results_of(ds))
    content["tables"]["ends"] = [table]
    page = page_text(results_of(ds), content, tmp_path)
    cells = re.findall(r'<td class="w">(.*?)</td>', page.split("<h3>Reasons")[1].split("</table>")[0])
    assert cells == [long[0], "as above", long[1]]


@pytest.mark.slow
def test_a_further_section_stands_on_the_page_and_in_its_contents(tmp_path, monkeypatch):
    """The recipe of CONTRIBUTING: one row with a title, and tables under its key."""
    monkeypatch.setitem(SECTIONS, "cost", Section("What it costs", link="Cost"))
    results = results_of(grid_study({"axial_force": [0.0, 130.0], "friction_coefficient": [0.1, 0.2]}))
    content = contents(results)
    content["tables"]["cost"] = [Table("cost", "Cases", ["Cases"], [[4]])]
    text = page_text(results, content, tmp_path)
    assert '<a href="#cost">Cost</a>' in text and '<section id="cost">\n<h2>What it costs</h2>' in text
    del content["tables"]["cost"]
    assert "#cost" not in page_text(results, content, tmp_path)


def test_it_says_what_was_studied_found_and_how_to_repeat_it(report):
    text = report.read_text(encoding="utf-8")
    wanted = (
        "friction-and-fit",
        "540 cases",
        "Roller profile radius",
        "full slip",
        "lift-off",
        "Candidate 1",
        "Candidate 5",
        "of 540 cases roll",
        '<p class="lead"><strong>',
        "Papers behind the methods",
        "applmech3020041",
        "abcdef0",
        "Conventions",
        "static",
    )
    assert [w for w in wanted if w not in text] == []
    assert text.count("<figure") == 3 and text.index('id="designs"') < text.index('id="decide"')
    parts = ("Verdict", "Decide", "Why", "Where it ends", "Explore", "Proof")
    heads = [text.index(f">{head}</h2>") for head in parts]
    assert heads == sorted(heads) and 0 < text[heads[2] : heads[3]].count("<li>") <= 5
    assert text.index("<details") < heads[-1] and "<h3>What decides each output" not in text
    assert (report.parent / "tables" / "candidates.csv").is_file()


def test_it_is_one_file_without_network(report):
    text = report.read_text(encoding="utf-8")
    sources = re.findall(r'(?:src|href)="([^"]*)"', text)
    assert sources and all(s.startswith(("data:", "#")) for s in sources)
    assert "<script src" not in text and "@import" not in text and "url(" not in text
    assert not list(report.parent.glob(".*.tmp"))


def test_names_from_the_study_are_escaped_and_tags_balance(report):
    text = report.read_text(encoding="utf-8")
    assert "&lt;five pairs&gt;" in text and "<five pairs>" not in text
    parser = _Balanced()
    parser.feed(text)
    assert parser.open == []


def test_regimes_name_the_levels_at_which_they_occur():
    results = results_of(grid_study(FACTORS))
    rows = {row[0]: row for row in regime_table(results).rows}
    assert sum(row[1] for row in rows.values()) == len(results.table)
    slip, lift = dict(contents(results)["summary"])["Where it ends"][1:3]
    table = results.table
    assert lift.kind == "only" and lift.values["conditions"] == [("axial_force", [130.0])]
    assert lift.values["inside"] == lift.values["count"] == (table["axial_force"] == 130).sum()
    drive = table["motor_force"].abs() * np.cos(np.deg2rad(30)) > 200 * table["friction_coefficient"]
    assert slip.kind == "slip_law" and slip.values["count"] == (drive & (table["axial_force"] < 130)).sum()
    assert "failed" not in rows


def test_events_of_all_designs_and_of_none():
    results = results_of(grid_study(FACTORS))
    everywhere = occurrence(results, np.ones(len(results.table), bool), "Slip")
    assert everywhere.kind == "everywhere" and everywhere.values["count"] == 540
    assert occurrence(results, np.zeros(len(results.table), bool), "Slip") is None


def test_validity_bits_are_counted_by_mask():
    ds = grid_study(FACTORS)
    results = results_of(ds)
    rows = {row[0]: row for row in validity_table(results).rows}
    assert rows["conformal"][3] == int((((ds["validity"] & 8) > 0) & (ds["regime"] == 0)).sum()) > 0
    assert rows["static"][2] == VALIDITY["static"].criterion
    assert "half space" not in rows  # no case carries it


def test_best_designs_are_sorted_by_the_conditions_they_hold_and_their_worst_life():
    ds = grid_study(FACTORS)
    best = {row[0]: row[1:] for row in contents(results_of(ds))["tables"]["decide"][0].rows}
    valid = (ds["regime"] == 0) & ((ds["validity"] & 15) == 0)
    frame = ds["roller_life_hours"].where(valid).to_dataframe(name="life").reset_index()
    groups = frame.groupby(["roller_profile_radius", "material_pair"]).life
    expected = groups.agg(["count", "min", "median", "max", "size"]).sort_values(["count", "min"], ascending=False)[:5]
    for row, column in (("worst condition", "min"), ("median where it holds", "median")):
        assert best[f"Life of the roller, {row} [h]"] == pytest.approx(expected[column].tolist())
    told = [f"{n} of {size}" for n, size in zip(expected["count"], expected["size"], strict=True)]
    assert best["Holds in"] == told
    assert best["Roller profile radius [mm]"] == expected.index.get_level_values(0).tolist()


def test_a_loads_only_study_and_a_missing_figure_folder_still_give_a_report(tmp_path):
    ds = grid_study({"axial_force": [0.0, 130.0], "radial_force": [-200.0, -100.0]}, only=("normal_force",))
    text = write_report(results_of(ds), tmp_path / "none", tmp_path / "deep" / "report.html").read_text()
    assert "<figure" not in text and "Candidate 1" not in text and "lift-off" in text


def test_a_study_in_which_everything_failed_shows_the_reasons(tmp_path):
    ds = grid_study({"axial_force": [0.0, 130.0], "radial_force": [-200.0, -100.0]})
    ds["regime"][:] = 3
    for name, variable in ds.data_vars.items():
        if variable.dtype.kind == "f":
            ds[name] = variable * np.nan
    ds["reason"] = xr.full_like(ds["regime"], "no convergence <x>", dtype=object)
    ds.to_netcdf(tmp_path / "study.nc")
    text = write_report(results_of(tmp_path / "study.nc"), tmp_path, tmp_path / "report.html").read_text()
    assert "no convergence &lt;x&gt;" in text and "Candidate 1" not in text


def test_a_sample_says_how_its_factors_were_drawn(tmp_path):
    found = contents(results_of(sampled_study(60)))
    values, spec = next(row[2:4] for row in found["factors"].rows if row[0].startswith("Friction coefficient"))
    assert spec == "uniform 0.02, 0.4" and "…" in values
    assert "60 cases" in found["facts"] and "lhs" in found["facts"]


OVERFLOW = """(() => {
  const width = document.documentElement.clientWidth, out = [];
  for (const e of document.querySelectorAll('body *')) {
    if (e.closest('.wide, .cases, figure a, svg, script')) continue;  // they scroll inside themselves
    const box = e.getBoundingClientRect();
    if (box.width && (box.right > width + 1 || box.left < -1)) out.push(e.tagName + ' ' + e.textContent.slice(0, 30));
    if (e.querySelector('.lines')) continue;  // the lines of the explorer use the margins of the page
    if (e.scrollWidth > e.clientWidth + 1 && e.clientWidth && !['SUB', 'I', 'A', 'SELECT', 'INPUT'].includes(e.tagName))
      out.push('inner ' + e.tagName + ' ' + e.textContent.slice(0, 30));
  }
  for (const e of document.querySelectorAll('.wide, .cases, figure a'))
    if (e.getBoundingClientRect().right > width + 1) out.push('wide ' + e.textContent.slice(0, 30));
  const images = [...document.images].filter(i => !i.complete || !i.naturalWidth).length;
  return {width, page: document.documentElement.scrollWidth, out: out.slice(0, 5), images};
})()"""


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_a_browser_shows_it_whole_and_without_console_errors(report):
    """Nothing is wider than the window, every figure loads, the console stays empty."""
    with closing(Browser()) as browser:
        page = browser.open(report, width=1280)
        for width in (1280, 800, 400):
            page.resize(width)
            page.until(f"{OVERFLOW}.out.length === 0")  # the explorer draws itself anew a moment later
            found = page.run(OVERFLOW)
            assert found["images"] == 0 and found["out"] == [] and found["page"] <= found["width"] == width
        page.run("document.querySelector('figure a').click()")
        assert page.run("getComputedStyle(document.querySelector('figure:target img')).position") == "fixed"
        page.key("Escape")
        assert page.run("document.querySelector('figure:target')") is None
        assert page.complaints == [] and page.requests == [report.as_uri()]


def test_chosen_models_and_stopped_cases_are_counted_and_laws_told_in_words():
    ds = sampled_study(40)
    law = np.where(np.arange(40) < 20, "", json.dumps({"kind": "linear", "speed": 50, "lowest": 0.3}))
    ds = ds.assign_coords(friction_law=("case", law.astype(object)))
    ds["contact_model_used"] = ("case", np.arange(40) % 2 + 2, {"flag_meanings": "sliding fastsim kalker kalker_table"})
    ds["stopped"] = ("case", (np.arange(40) < 7).astype("i1"))
    (row,) = models_used(ds)
    counts = [("kalker", "20"), ("kalker_table", "20")]
    assert row.words == "Contact model used" and re.findall(r"(\w+) in (\d+)", row.value) == counts
    asked = ds.assign_attrs(contact_model="kalker")
    asked["contact_model_used"][:] = 3
    assert models_used(asked) == [Row("Contact model used", "kalker_table in 40 of 40 cases")]
    assert models_used(asked.assign_attrs(contact_model="kalker_table")) == []
    told = contents(results_of(ds))
    valid = dict(told["summary"])["Where it ends"]
    assert [(s.values["count"], s.values["of"]) for s in valid if s.kind == "stopped"] == [(7, 40)]
    assert models_used(sampled_study(40)) == []


def test_a_handful_of_cases_is_counted_and_attributed_to_nothing():
    results = results_of(sampled_study(400))
    hit = np.zeros(400, dtype=bool)
    hit[:3] = True
    said = occurrence(results, hit, "Jamming")
    assert said.kind == "cases"
    assert (said.values["count"], said.values["of"]) == (3, 400)


@pytest.mark.slow
@pytest.mark.parametrize(
    "part",
    [
        "pages.study.report_section",
        "pages.study.given_pareto",
        "pages.study.target_tables",
        "pages.study.explorer",
        "pages.study.figures",
        "figures.comparison.pairs",
        "figures.study.given_pareto",
        "figures.factors.coloured",
        "figures.sensitivity._axis",
    ],
)
def test_a_part_that_cannot_be_made_fails_the_command(part, tmp_path, monkeypatch):
    """A missing section beside exit code 0 would say that all is well; the report of before stays as it was."""

    def broken(*_, **__):
        raise RuntimeError("this part cannot be made")

    place = StudyFolder(tmp_path / "friction-and-fit")
    place.create()
    levels = {"friction_coefficient": [0.2, 0.3], "roller_profile_radius": [-8.0, -7.0], "axial_force": [0.0, 30.0]}
    put(place.gathered, grid_study(levels).to_netcdf)
    put_text(place.root / "report.html", "the report of before")
    if part.startswith("pages."):  # the figures come first, and take a second
        monkeypatch.setattr("trackroller.report.figures.study.draw_all", lambda results, folder: [])
    monkeypatch.setattr(f"trackroller.report.{part}", broken)
    with pytest.raises(RuntimeError, match="cannot be made"):
        build_report(place)
    assert (place.root / "report.html").read_text() == "the report of before"
