"""A contact model from outside: the example of CONTRIBUTING is registered, solved with and removed."""

from __future__ import annotations

import importlib.util
import linecache
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact.models import CLASSES, _digest, register
from trackroller.parameters import CONTACT_MODELS, EXACTNESS, OPTIONS, contact_models, options_text
from trackroller.parameters.contact_models import DECLARED
from trackroller.roller.case import to_table
from trackroller.roller.expected_errors import error_attributes, expected_errors
from trackroller.roller.options import Options
from trackroller.study.cost import rate
from trackroller.study.file.load import parse_study
from trackroller.study.store.fingerprint import fingerprints

RECIPE = Path(__file__).parents[2] / "CONTRIBUTING.md"


def recipe(steepness: float = 0.01) -> str:
    """Return the code of the example, with this creepage in place of 1e-2."""
    code = re.search(r"## Add a contact model.*?```python\n(.*?)```", RECIPE.read_text(encoding="utf-8"), re.DOTALL)[1]
    return code.replace("1e-2", str(steepness))


def unregister(name: str) -> None:
    """Remove a contact model that a test has registered."""
    del CLASSES[name], DECLARED[name]
    contact_models._derive()


@pytest.fixture
def film():
    code = recipe()
    assert len(code.splitlines()) < 40
    exec(compile(code, str(RECIPE), "exec"), {})
    yield "film"
    unregister("film")
    assert "film" not in CONTACT_MODELS and "film" not in EXACTNESS and "film" not in OPTIONS["contact_model"].values
    with pytest.raises(tr.InputError, match="film"):
        tr.solve(tr.Case(), contact_model="film")


def test_the_example_of_the_recipe_solves(film):
    """Without spin moment the drive torque balance gives F_A1 + F_A2 = -F_Motor; peaks carry the shear."""
    outputs = ("forces", "contact", "friction_work", "peak_stress", "life", "tractions")
    cases = [tr.Case(motor_force=force) for force in (0.0, -20.0, -80.0)]
    ds = tr.solve(cases, outputs, contact_model=film)
    assert [ds.contact_model_used.attrs["flag_meanings"].split()[i] for i in ds.contact_model_used.values] == [film] * 3
    np.testing.assert_allclose(ds.transmitted_force[:2], [0.0, 20.0], atol=1e-6)
    assert ds.regime.attrs["flag_meanings"].split()[int(ds.regime[2])] == "full_slip"
    slip = ds.slip.values[1]
    np.testing.assert_allclose(ds.driving_force[1], -0.3 * ds.normal_force[1] * np.tanh(slip / 1e-2), rtol=1e-9)
    np.testing.assert_allclose(ds.friction_energy_per_distance[1], -slip * ds.driving_force[1], rtol=1e-9)
    # rolling freely there is no shear, and the peak is that of the pressure alone
    bare = tr.solve(tr.Case(friction_coefficient=0.0), ("contact", "peak_stress"), contact_model="sliding")
    ratios = [found.peak_stress / found.max_pressure for found in (ds.isel(case=0), bare)]
    np.testing.assert_allclose(*ratios, rtol=1e-3)


@pytest.mark.parametrize("steepness", [1e-3, 1e-5, 1e-8])
def test_a_law_that_is_steep_at_zero_creepage_rolls_freely(steepness):
    exec(compile(recipe(steepness), str(RECIPE), "exec"), {})
    try:
        cases = [tr.Case(motor_force=force, axial_force=axial) for force in (0.0, -20.0) for axial in (0.0, 30.0)]
        ds = tr.solve(cases, "forces", contact_model="film")
    finally:
        unregister("film")
    assert ds.converged.all()
    np.testing.assert_allclose(ds.transmitted_force, [0.0, 0.0, 20.0, 20.0], atol=1e-6)
    capacity = 0.3 * ds.normal_force.sum("contact").values
    np.testing.assert_allclose(
        ds.slip, -steepness * np.arctanh([0.0, 0.0, 20.0, 20.0] / capacity), atol=1e-9 * steepness
    )


def test_everything_else_follows_from_the_declaration(film):
    assert f" {film}" in options_text() and OPTIONS["contact_model"].values[film].startswith("shear grows")
    study = {"name": "films", "factors": {"contact_model": {"values": [film, "sliding"]}}}
    assert parse_study(study).factors["contact_model"]["values"] == [film, "sliding"]
    assert rate({"contact_model": film, "outputs": ("forces",)}) == pytest.approx(1e3)
    assert error_attributes(expected_errors(Options(contact_model=film), film, True)) == {}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"accuracy": 0.01}, "the errors of film were not measured"),
        ({"normal": "halfspace"}, "hertz only, with contact_model: film"),
        ({"slip_terms": "curve"}, "no word only, with contact_model: film"),
        ({"spin_model": "edge"}, "only skewed with contact_model: film"),
    ],
)
def test_what_the_declaration_does_not_state_is_refused(film, given, words):
    with pytest.raises(tr.InputError, match=words):
        Options(contact_model=film, **given)


def test_friction_laws_are_refused(film):
    with pytest.raises(tr.InputError, match="constant friction with contact_model: film"):
        tr.solve(tr.Case(friction_law={"kind": "exponential", "speed": 20}), contact_model=film)


def test_names_are_unique():
    with pytest.raises(tr.InputError, match="no other contact model"):
        register(CLASSES["sliding"])


def fingerprint_of_film(place: Path, steepness: float) -> bytes:
    """Return the fingerprint of a case by a model whose module lies in `place`."""
    (place / "film_model.py").write_text(recipe(steepness), encoding="utf-8")
    linecache.clearcache()
    spec = importlib.util.spec_from_file_location("film_model", place / "film_model.py")
    sys.modules["film_model"] = module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
        return fingerprints(to_table(tr.Case(), tr.load_database()), {"contact_model": "film"})[0]
    finally:
        unregister("film")
        del sys.modules["film_model"]


def test_a_changed_model_has_other_fingerprints(tmp_path):
    places = [tmp_path / name for name in "abc"]
    for place in places:
        place.mkdir()
    first, same, changed = map(fingerprint_of_film, places, (0.01, 0.01, 0.02))
    assert first == same != changed


def test_a_model_without_a_file_is_identified_by_its_code(film):
    class Other(CLASSES[film]):
        def law(self, patch, slip, friction, rows, fine):
            return super().law(patch, slip, 2.0 * friction, rows, fine)

    assert _digest(CLASSES[film]) == _digest(CLASSES[film]) == DECLARED[film].source
    Other.__module__ = "builtins"
    assert _digest(Other) != DECLARED[film].source
