"""The comparison of contact models that any study with them as a factor gets: pairs, errors, words, figures, report."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml
from synthetic_results import results_of

from trackroller.results import model_errors as ladder
from trackroller.study.file.load import load_study
from trackroller.study.run import run_study
from validation.contact_models.product import compare

MODELS = ["sliding", "kalker_table", "kalker"]
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
        assert "by each contact model" in text or "with the contact model" in text
        assert "200 N radial" not in text


def test_the_shipped_study_holds_friction_drive_and_spin():
    shipped = yaml.safe_load((Path(__file__).parents[2] / "validation" / "config" / "contact_models.yaml").read_text())
    assert {"friction_coefficient", "motor_force", "contact_angle", "axis_distance"} <= set(shipped["factors"])
    assert shipped["contact_model"] == MODELS
