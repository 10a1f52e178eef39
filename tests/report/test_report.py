"""The report: complete, one file without network, safe against markup in names, whole in a browser."""

from __future__ import annotations

import json
from html.parser import HTMLParser

import pytest
import yaml
from synthetic_results import PAIRS, grid_study

from trackroller.report.build import build_report
from trackroller.study.file.load import parse_study
from trackroller.study.store.folder import StudyFolder
from trackroller.study.store.put import put, put_text

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


@pytest.mark.slow
@pytest.mark.parametrize(
    "part",
    [
        "pages.study.screen_of",
        "pages.study.proof_of",
        "pages.study.explorer",
        "pages.study.tables_of",
        "pages.study.write_answer",
        "figures.study.given_pareto",
        "figures.maps.held_words",
    ],
)
def test_a_part_that_cannot_be_made_fails_the_command(part, tmp_path, monkeypatch):
    """A missing section beside exit code 0 would say that all is well; the report of before stays as it was."""

    def broken(*_, **__):
        raise RuntimeError("this part cannot be made")

    place = StudyFolder(tmp_path / "friction-and-fit").create()
    levels = {"friction_coefficient": [0.2, 0.3], "roller_profile_radius": [-8.0, -7.0], "axial_force": [0.0, 30.0]}
    ds = grid_study(levels)
    told = yaml.safe_load(ds.attrs["study"])
    told["base"] = {name: value for name, value in told["base"].items() if name not in told["factors"]}
    ds.attrs["study"] = json.dumps(parse_study(told).as_dict())
    put(place.gathered, ds.to_netcdf)
    put_text(place.root / "report.html", "the report of before")
    if part.startswith("pages."):  # the figures come first, and take a second
        monkeypatch.setattr("trackroller.report.figures.study.draw_all", lambda results, folder: [])
    monkeypatch.setattr(f"trackroller.report.{part}", broken)
    with pytest.raises(RuntimeError, match="cannot be made"):
        build_report(place)
    assert (place.root / "report.html").read_text() == "the report of before"
