"""The comparison of contact models that any study with them as a factor gets: pairs, errors, words, figures, report."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
import yaml
from synthetic_results import grid_study, results_of

import trackroller as tr
from trackroller.parameters import PARAMETERS
from trackroller.report.figures import style
from trackroller.report.figures.comparison import model_errors
from trackroller.report.figures.study import draw_all
from trackroller.report.pages.study import contents, write_report
from trackroller.report.words import comparison
from trackroller.report.words.comparison import levels_kept
from trackroller.report.words.levels import group_texts
from trackroller.results import contact_models as ladder
from trackroller.results.groups import drives, groups
from trackroller.results.pareto import study_pareto
from trackroller.study.file.load import load_study
from trackroller.study.run import run_study
from validation.benchmarks.contact_spin import spin
from validation.contact_models.product import compare

MODELS = ["sliding", "kalker_table", "kalker"]
FIGURES = {"models-error"}
OUTPUTS = ["forces", "contact", "friction_work", "peak_stress", "life"]


def study(place, factors, base=None, models=MODELS, outputs=OUTPUTS, **more):
    """Solve a study at `preview` and return the path of the gathered file."""
    name = f"s{len(list(place.glob('*.yaml')))}"
    path = place / f"{name}.yaml"
    path.write_text(
        yaml.safe_dump(
            {
                "name": name,
                "base": base or {},
                "factors": factors,
                "contact_model": models,
                "outputs": outputs,
                "accuracy": "preview",
                **more,
            }
        )
    )
    return run_study(load_study(path), place / "results").folder.gathered


def shown(gathered, place):
    """Return the captions of all figures by name, each rendered and saved as an empty file, and the report's text."""

    def save(figure, out_dir, name):
        figure.draw_without_rendering()
        out_dir.mkdir(exist_ok=True)
        (out_dir / f"{name}.svg").touch()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "save", save)
        infos = draw_all(results_of(gathered), place / "figures")
    text = write_report(results_of(gathered), place / "figures", place / "report.html").read_text(encoding="utf-8")
    return {i.name: i for i in infos}, re.sub(r'src="data[^"]*"', "", text)


def compared(gathered, place):
    """Return the captions of the figures that compare models, and the text of the report."""
    with xr.open_dataset(gathered) as ds, style.look():
        infos = [drawn[1]] if (drawn := model_errors(results_of(ds))) else []
    page = write_report(results_of(gathered), place / "figures", place / "report.html")
    return {i.name: i for i in infos}, page.read_text(encoding="utf-8")


def designs_of(gathered):
    """Return the number of cases that differ in nothing but the model."""
    with xr.open_dataset(gathered) as ds:
        return ladder.pairs(results_of(ds)).sizes["design"]


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """Return a user's study of two frictions and two drives."""
    place = tmp_path_factory.mktemp("own")
    factors = {"friction_coefficient": {"values": [0.04, 0.3]}, "motor_force": {"values": [0, -10]}}
    return study(place, factors), place


@pytest.mark.long
def test_a_study_with_the_models_as_a_factor_is_compared_in_figures_and_report(own):
    drawn, text = shown(*own)
    assert set(drawn) >= FIGURES
    assert "Contact models compared" in text
    with xr.open_dataset(own[0]) as ds:
        paired = ladder.pairs(results_of(ds))
    assert paired.sizes["design"] == 4 and paired.attrs["reference"] == "kalker"
    found = ladder.errors(paired)
    driven = found.isel(design=np.flatnonzero(paired["motor_force"] == -10))
    # driven by 10 N at mu = 0.04 slips altogether and is not compared
    assert np.isnan(driven.normal_force.sel(contact_model="sliding")[0])
    exact, sliding = (
        tr.solve(
            tr.Case(friction_coefficient=0.3, motor_force=0), contact_model=m, accuracy="preview", outputs="forces"
        )
        for m in ("kalker", "sliding")
    )
    expected = np.abs(sliding.normal_force / exact.normal_force - 1).max()
    free = found.normal_force.sel(contact_model="sliding").values[
        (paired["motor_force"].values == 0) & (paired["friction_coefficient"].values == 0.3)
    ]
    assert free[0] == pytest.approx(float(expected), rel=1e-3)


@pytest.mark.slow
def test_best_designs_and_pareto_set_are_those_of_one_model(own):
    with xr.open_dataset(own[0]) as ds:
        page, front = contents(results_of(ds)), study_pareto(results_of(ds))
        exact = ds["roller_life_hours"].where(ds["regime"] == 0).sel(contact_model="kalker")
        valid = (ds["regime"] == 0) & ((ds["validity"] & 0b100001111) == 0)
        best = {row[0]: row[1:] for row in page["tables"]["decide"][0].rows}
        expected = exact.where(valid.sel(contact_model="kalker")).values
    lives = expected[np.isfinite(expected)]
    told = [best[f"Life of the roller, {row} [h]"][0] for row in ("worst condition", "median where it holds")]
    assert told == pytest.approx([lives.min(), np.median(lives)])
    assert best["Holds in"] == [f"{lives.size} of 4"]
    assert front.attrs["model"] == "kalker" and front.sizes["row"] == 1 and "contact_model" not in front
    assert front["roller_life_hours"].item() == pytest.approx(lives.min())


@pytest.mark.slow
def test_three_drives_get_room_and_many_are_told_by_their_sign(tmp_path):
    factors = {"friction_coefficient": {"values": [0.1, 0.3]}, "motor_force": {"values": [0, -10, 10]}}
    with xr.open_dataset(study(tmp_path, factors, outputs=["forces", "contact"])) as ds:
        figure = model_errors(results_of(ds))[0]
    figure.draw_without_rendering()
    bottom = [axes for axes in figure.axes if axes.get_xlabel()]
    boxes = [axes.xaxis.label.get_window_extent() for axes in bottom]
    assert len(boxes) == 3 and boxes[-1].x1 <= figure.bbox.x1
    assert all(left.x1 < right.x0 for left, right in pairwise(boxes))
    texts = group_texts(drives(pd.DataFrame({"motor_force": [-20.0, -5.0, 0.0, 5.0, 9.0]})))
    assert texts == ["driven, 5 to 20 N", "free rolling", "braked, 5 to 9 N"]


@pytest.mark.slow
def test_motor_force_in_the_base_and_another_factor(tmp_path):
    factors = {"friction_coefficient": {"values": [0.05, 0.3]}, "contact_angle": {"values": [20, 30, 60]}}
    gathered = study(tmp_path, factors, {"motor_force": -5, "radial_force": -400, "axial_force": 0})
    drawn, _ = compared(gathered, tmp_path)
    assert set(drawn) >= FIGURES
    assert not any("Paper" in i.caption + i.sentence for i in drawn.values())
    with xr.open_dataset(gathered) as ds:
        paired = ladder.pairs(results_of(ds))
    alpha = np.deg2rad(30)  # spin of the paper's roller: sin(alpha)/r_A times 4 over the sum of curvatures
    r_a = 21.75 - 6 * np.cos(alpha)
    k = 1 / 6 - 1 / 7 + np.cos(alpha) * (1 / r_a + 1 / 220)
    own = {name: np.array([float(p.default or 0)]) for name, p in PARAMETERS.items()} | {
        "contact_angle": np.array([30.0])
    }
    assert spin(own)[0] == pytest.approx(np.sin(alpha) / r_a * 4 / k, rel=1e-6)
    assert set(paired["contact_angle"].values) == {20, 30, 60}


@pytest.mark.slow
def test_an_inner_outer_design_has_pairs_and_a_sample_that_draws_the_model_says_why_not(tmp_path):
    factors = {
        "friction_coefficient": {"uniform": [0.05, 0.4]},
        "axial_force": {"uniform": [0, 30]},
        "motor_force": {"values": [0, -10]},
    }
    gathered = study(tmp_path, factors, design="inner_outer", samples=24, models=["sliding", "kalker"])
    drawn, text = compared(gathered, tmp_path)
    assert set(drawn) >= FIGURES and designs_of(gathered) == 48
    gathered = study(tmp_path, factors, design="lhs", samples=24, models=["sliding", "kalker"])
    drawn, text = compared(gathered, tmp_path)
    assert not set(drawn) & FIGURES and designs_of(gathered) == 0 and "cannot be compared" in text


@pytest.mark.slow
def test_without_kalker_its_table_is_the_reference(tmp_path):
    factors = {"axial_force": {"values": [0, 20]}}
    with xr.open_dataset(study(tmp_path, factors, models=["sliding", "kalker_table"], outputs=["forces"])) as ds:
        paired = ladder.pairs(results_of(ds))
        assert model_errors(results_of(ds))[1].name == "models-error"
    assert paired.attrs["reference"] == "kalker_table" and list(paired.contact_model.values) == [
        "sliding",
        "kalker_table",
    ]
    assert ladder.compared(ladder.errors(paired).sel(contact_model="sliding")) == 2 < comparison.FEWEST


def test_one_model_or_none_is_not_compared():
    results = results_of(grid_study())
    assert ladder.pairs(results) is None and comparison.report_section(results) == {} and model_errors(results) is None


def test_models_that_change_nothing_else_are_matched_whatever_the_order_of_the_cases():
    rng = np.random.default_rng(5)
    n = 3000
    mu, model = rng.uniform(0.02, 0.5, n), np.repeat(MODELS, n)
    order = rng.permutation(3 * n)
    force = np.stack([np.tile(100 * mu, 3) * np.repeat([1.1, 1.02, 1.0], n)] * 2, -1)
    ds = xr.Dataset(
        {"regime": ("case", np.zeros(3 * n, "i1")), "normal_force": (("case", "contact"), force)},
        coords={"contact_model": ("case", model), "friction_coefficient": ("case", np.tile(mu, 3)), "contact": [1, 2]},
    ).isel(case=order)
    paired = ladder.pairs(results_of(ds.isel(case=slice(1, None))))
    lost = str(ds["contact_model"][0].item())
    assert paired.sizes["design"] == (n if lost != "kalker" else n - 1)
    found = ladder.errors(paired).normal_force
    np.testing.assert_allclose(found.sel(contact_model="sliding").dropna("design"), 0.1, rtol=1e-9)
    np.testing.assert_allclose(found.sel(contact_model="kalker_table").dropna("design"), 0.02, rtol=1e-9)
    assert [re.findall(r"forces in (\d+) %", said) for said in comparison.short(paired)] == [["0"], ["100"]]


def test_the_levels_that_keep_the_tolerance_are_named():
    mu = [0.02, 0.05, 0.1, 0.2, 0.3, 0.5]
    along = groups(pd.DataFrame({"friction_coefficient": mu}), "friction_coefficient")
    told = {
        (0, 0, 1, 1, 1, 1): "up to a friction of 0.05",
        (1, 1, 0, 0, 1, 0): "at a friction of 0.1 to 0.2 and from a friction of 0.5 on",
        (1,) * 6: "",
        (0,) * 6: "at every friction",
        (1, 1, 1, 1, 0, np.nan): "from a friction of 0.3 on",
    }
    for wrong, words in told.items():
        assert levels_kept(along, np.array(wrong, float)) == words


def test_unlimited_lives_are_no_error_where_both_are():
    life = np.array([[np.inf, np.inf, 3.0, 2.0], [np.inf, 5.0, np.inf, 1.0]])
    dims = ("contact_model", "design")
    ds = xr.Dataset(
        {"life": (dims, life), "regime": (dims, np.zeros((2, 4)))},
        coords={"contact_model": ["sliding", "kalker"]},
        attrs={"reference": "kalker"},
    )
    assert ladder.errors(ds).life.values[0].tolist() == [0.0, np.inf, 1.0, 1.0]


@pytest.mark.long
def test_the_shipped_study_may_be_edited(tmp_path):
    """Another roller, three drives in one file; a fixed drive and the contact angle as a factor in the other."""
    for factors, base in (
        (
            {"friction_coefficient": {"values": [0.05, 0.3]}, "motor_force": {"values": [0, -5, 5]}},
            {"roller_profile_radius": -8, "radial_force": -90, "axial_force": 0},
        ),
        ({"contact_angle": {"values": [20, 50]}}, {"motor_force": -5, "friction_coefficient": 0.2}),
    ):
        study = {"base": base, "factors": factors, "outputs": OUTPUTS, "contact_model": MODELS, "accuracy": "preview"}
        found = compare(study, tmp_path / "results" / "contact_models")
        assert set(found["models"]) == {"sliding", "kalker_table"} and found["designs"] > 0
        text = (tmp_path / "results" / "contact_models" / "study" / "report.html").read_text(encoding="utf-8")
        assert "Contact models compared" in text and "200 N radial" not in text
        drawn = {p.stem for p in (tmp_path / "results" / "contact_models" / "study" / "figures").glob("*.svg")}
        assert drawn >= FIGURES


def test_the_shipped_study_holds_friction_drive_and_spin():
    shipped = yaml.safe_load((Path(__file__).parents[2] / "validation" / "config" / "contact_models.yaml").read_text())
    assert {"friction_coefficient", "motor_force", "contact_angle", "axis_distance"} <= set(shipped["factors"])
    assert shipped["contact_model"] == MODELS


@pytest.mark.slow
def test_the_table_of_the_exact_theory_is_compared_like_any_other_model(tmp_path):
    """Its section stands in the report; full sliding is not judged by an adhesion area that it does not have."""
    factors = {"friction_coefficient": {"values": [0.1, 0.3]}, "axial_force": {"values": [0, 10, 200]}}
    ds = xr.load_dataset(study(tmp_path, factors, {"motor_force": 0}, ["sliding", "kalker_table", "kalker"]))
    paired = ladder.pairs(results_of(ds))
    assert paired.attrs["same"] == ("kalker_table",)  # at preview
    assert len(comparison.short(paired)) == 1  # on full sliding alone
    ds["contact_model_used"].loc[{"contact_model": "kalker"}] = 1  # as at standard
    paired = ladder.pairs(results_of(ds))
    rolls = int(((ds["regime"] == 0).all("contact_model")).sum())
    one, two = ladder.errors(paired).transpose("contact_model", ...)["contact_model"].values
    both = [ladder.compared(ladder.errors(paired).sel(contact_model=model)) for model in (one, two)]
    assert both == [rolls, rolls] and 0 < rolls < paired.sizes["design"] and len(comparison.short(paired)) == 2
    stick = ladder.errors(paired)["stick"]
    assert stick.sel(contact_model="sliding").isnull().all() and stick.sel(contact_model="kalker_table").notnull().any()
    rows = [row[0] for row in comparison.report_section(results_of(ds))["tables"][0].rows]
    assert any("kalker_table: adhesion" in row for row in rows) and not any("sliding: adhesion" in row for row in rows)
    with style.look():
        assert model_errors(results_of(ds))[1].name == "models-error"
