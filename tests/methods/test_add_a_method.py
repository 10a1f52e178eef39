"""A design of experiments from outside: the example of CONTRIBUTING is registered, run, analysed and removed."""

from __future__ import annotations

import re
from pathlib import Path
from typing import ClassVar

import fake_solver
import numpy as np
import pytest

import trackroller as tr
from trackroller.app.fields import all_fields
from trackroller.methods import METHODS, Method, register
from trackroller.methods.method import Estimated, Index
from trackroller.methods.sample import RandomSample
from trackroller.results.interim_looks import looks_of
from trackroller.results.sample_growth import grow_study

RECIPE = Path(__file__).parents[2] / "CONTRIBUTING.md"
STUDY = {
    "name": "numbers",
    "method": "halton",
    "samples": 64,
    "factors": {
        "axial_force": {"uniform": [20, 50]},
        "friction_coefficient": {"uniform": [0.1, 0.3]},
        "motor_force": {"values": [0, -10], "weights": [3, 1]},
    },
    "outputs": ["forces"],
    "contact_model": "sliding",
    "accuracy": "preview",
}


@pytest.fixture
def halton():
    text = RECIPE.read_text(encoding="utf-8")
    code = re.search(r"## Add a method.*?```python\n(.*?)```", text, re.DOTALL)[1]
    assert len(code.splitlines()) < 34
    exec(compile(code, str(RECIPE), "exec"), {})
    yield "halton"
    del METHODS["halton"]
    with pytest.raises(tr.InputError, match="halton"):
        tr.load_study(STUDY)


@pytest.mark.slow
def test_a_study_with_the_method_of_the_recipe_is_drawn_analysed_and_reported(halton, tmp_path):
    study = tr.load_study(STUDY)
    half = tr.load_study(STUDY | {"samples": 32}).drawn
    assert np.array_equal(study.drawn.unit[:32], half.unit) and study.drawn.size == 64
    assert (study.drawn.columns["motor_force"] == -10).mean() == pytest.approx(0.25, abs=0.05)
    solved = tr.run(STUDY, progress=False)
    share = solved.indices().sel(output="normal_force_1")["first"]
    assert float(share.sel(factor="axial_force")) > 0.8 and solved.indices().attrs["method"] == halton
    page = solved.report(tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Halton (1960)" in page
    assert np.array_equal(tr.open_study(solved.data).design.unit, study.drawn.unit)


@pytest.mark.slow
def test_the_method_of_the_recipe_grows(halton, tmp_path):
    until = {"half_width": 0.05, "of": ["normal_force_1"], "at_most": 4096}
    study = tr.load_study({key: value for key, value in STUDY.items() if key != "samples"} | {"until": until})
    assert study.drawn.size == 128
    solved = tr.open_study(grow_study(study, tmp_path, solver=fake_solver.solve).folder.root)
    assert "narrower than ± 0.05" in looks_of(solved)["stopped"] and solved.design.samples > 128


def test_everything_else_follows_from_the_class(halton):
    assert halton in all_fields()["designs"]
    with pytest.raises(tr.InputError, match=r"groups.*not halton"):
        tr.load_study(STUDY | {"analysis": {"groups": {"load": ["axial_force"]}}})
    with pytest.raises(tr.InputError, match=r"rank_correlations.*not halton"):
        tr.load_study(STUDY | {"rank_correlations": [["axial_force", "friction_coefficient", 0.5]]})
    with pytest.raises(tr.InputError, match=r"levels = 6.*an option of design morris"):
        tr.load_study(STUDY | {"levels": 6}).design()


def test_names_are_unique():
    with pytest.raises(tr.InputError, match="no other design of experiments"):
        register(type("Grid", (Method,), {"name": "grid"}))


class Ratio(RandomSample):
    """A random sample whose index is the range of the output over the range of a factor, in the unit of the output."""

    name = "ratio"
    headline, judged = "pull", ()
    indices: ClassVar = {"pull": Index("pull of the factor", sized=True, signed=True, of_factor=True)}

    def draw(self, free, n, seed, settings):
        return np.random.default_rng(seed).random((n, len(free))), {}

    def estimate(self, y, design):
        good = np.isfinite(y)
        pull = [np.polyfit(design.unit[good, j], y[good], 1)[0] for j in range(design.unit.shape[1])]
        return Estimated({"pull": np.array(pull)}, len(y), len(y))


class Undeclared(Ratio):
    name = "undeclared"
    indices: ClassVar = {"drag": Index("drag of the factor")}


@pytest.fixture
def own_index():
    for method in (Ratio, Undeclared):
        register(method)
    yield
    for method in (Ratio, Undeclared):
        del METHODS[method.name]


def test_a_method_declares_an_index_of_its_own(own_index, tmp_path):
    asked = {"method": "ratio", "samples": 32, "question": "what matters", "analysis": {"outputs": ["normal_force_1"]}}
    solved = tr.run(STUDY | asked, progress=False)
    pull = solved.indices()["pull"]
    assert pull.attrs["long_name"] == "pull of the factor" and pull.attrs["units"] == ""
    answer = solved.answer
    shown = {column.name: column for column in answer.columns}
    assert shown["index"].kind == "number" and shown["index"].meaning.startswith("pull of the factor")
    rolling = solved.data["regime"].values == 0
    force = solved.data["normal_force"].sel(contact=1).values
    raw = np.polyfit(solved.design.unit[rolling, 0], force[rolling], 1)[0]
    assert float(pull.sel(output="normal_force_1", factor="axial_force")) == pytest.approx(raw)
    ranked = answer.table.set_index("name")["index"]
    assert ranked["axial_force"] == pytest.approx(raw)
    page = solved.report(tmp_path / "report.html").read_text(encoding="utf-8")
    assert "ull of the factor" in page


def test_an_index_that_a_method_does_not_declare_is_refused(own_index):
    with pytest.raises(tr.InputError, match=r"index of design undeclared = 'pull' is not declared.*drag"):
        tr.run(STUDY | {"method": "undeclared", "samples": 32}, progress=False).indices()
