"""Only the patches that the scene requires are computed, and this changes no number."""

import numpy as np
import pytest
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.roller import distinct_contacts
from trackroller.roller.case import to_table
from trackroller.roller.explain import explain
from trackroller.roller.options import Options
from trackroller.roller.stages import ellipse_stresses
from trackroller.roller.stages import mechanics as stages
from trackroller.roller.stages import stress as stages_stress
from trackroller.roller.stages.scene import StageResults

EVERYTHING = ("forces", "contact", "friction_work", "peak_stress", "life", "tractions", "subsurface")


def searched_patches(monkeypatch):
    """Return a list that grows by the number of patches with every search for peaks."""
    seen, search = [], ellipse_stresses.find_peaks
    watched = lambda patches, *more: seen.append(len(patches)) or search(patches, *more)  # noqa: E731
    monkeypatch.setattr(ellipse_stresses, "find_peaks", watched)
    return seen


def scenes(n=10, seed=3):
    """Return symmetric, frictionless, repeated and plain scenes, of which some slip fully and some lift off."""
    rng = np.random.default_rng(seed)
    found = [
        {
            "axial_force": float(rng.choice([0.0, 0.0, 20.0, -35.0])),
            "motor_force": float(rng.choice([0, -25, 300])),
            "friction_coefficient": float(rng.choice([0.0, 0.1, 0.35])),
            "contact_angle": float(rng.uniform(20, 60)),
            "velocity": float(rng.uniform(5, 90)),
        }
        for _ in range(n)
    ]
    return [*found, {"velocity": 10.0}, {"velocity": 80.0}, {"axial_force": 800.0}, {"axial_force": -0.0}]


def assert_same(one, other, tolerance):
    for name in one:
        a, b = one[name].values.astype(float), other[name].values.astype(float)
        assert np.array_equal(np.isnan(a), np.isnan(b)), name
        scale = np.nanmax(np.abs(b)) if np.isfinite(b).any() else 1.0
        if name in ("residual", "energy_residual"):  # they are rounding themselves
            scale = 1.0
        assert np.nanmax(np.abs(a - b), initial=0.0) <= tolerance * max(scale, 1e-3), name


def test_shortcuts_change_no_number_of_the_sliding_model():
    outputs = EVERYTHING[:-1]
    assert_same(
        solve_sliding(scenes(), outputs=outputs), solve_sliding(scenes(), outputs=outputs, shortcuts=False), 1e-9
    )


@pytest.mark.slow
def test_shortcuts_change_the_sections_within_their_quadrature():
    few = scenes(3)
    assert_same(
        solve_sliding(few, outputs="subsurface"), solve_sliding(few, outputs="subsurface", shortcuts=False), 2e-3
    )


@pytest.mark.parametrize("model", ["kalker_table", "kalker"])
def test_shortcuts_change_no_number_of_the_iterating_models_beyond_their_residual(model):
    few, outputs = scenes(2), ("forces", "contact", "friction_work")
    told = {"outputs": outputs, "contact_model": model, "accuracy": "preview"}
    assert_same(tr.solve(few, **told), tr.solve(few, **told, shortcuts=False), 1e-6)


def test_symmetric_and_repeated_scenes_are_solved_once(monkeypatch):
    """Six cases of one mechanics without axial force ask for one patch instead of twelve."""
    seen = searched_patches(monkeypatch)
    cases = [{"axial_force": 0.0, "velocity": float(v)} for v in (10, 20, 30, 40, 50, 60)]
    spared = solve_sliding(cases)
    whole = solve_sliding(cases, shortcuts=False)
    assert seen == [1, 12]
    assert_same(spared, whole, 1e-9)
    assert len(np.unique(spared.life_hours.sel(contact=1, body="roller"))) == 6, "hours follow each case's speed"


def test_frictionless_loads_share_one_search(monkeypatch):
    """Without friction the stress over p_max depends on ellipticity and material alone, whatever the load."""
    seen = searched_patches(monkeypatch)
    cases = [
        {"friction_coefficient": 0.0, "motor_force": 0.0, "axial_force": 0.01 * f, "radial_force": -float(f)}
        for f in (50, 200, 900)
    ]
    found = solve_sliding(cases, outputs=("contact", "peak_stress"))
    assert seen == [1]
    ratio = found.peak_stress / found.max_pressure
    assert np.allclose(ratio, ratio.isel(case=0, contact=0), rtol=1e-12)


def test_velocity_counts_where_friction_depends_on_it():
    law = {"kind": "exponential", "speed": 5.0, "lowest": 0.3}
    table = to_table([*({"velocity": v, "friction_law": law} for v in (10.0, 80.0)), {"velocity": 1.0}])
    assert len(distinct_contacts.distinct_mechanics(table)[0]) == 3


@pytest.mark.slow
def test_stopped_cases_would_have_failed_and_the_others_are_untouched():
    loads, frictions = (200.0, 1500.0, 4000.0, 9000.0), (0.05, 0.4)
    cases = [{"radial_force": -f, "friction_coefficient": m} for f in loads for m in frictions]
    whole, cut = solve_sliding(cases), solve_sliding(cases, stop_if="peak_stress > R_m")
    stopped = cut.stopped.values == 1
    assert stopped.any() and not stopped.all()
    limit = to_table(cases).roller.tensile_strength[0]
    assert (whole.peak_stress.max(("contact", "body")).values[stopped] > limit).all(), "no case is stopped wrongly"
    assert cut.peak_stress.values[stopped].size and np.isnan(cut.peak_stress.values[stopped]).all()
    assert np.array_equal(cut.peak_stress.values[~stopped], whole.peak_stress.values[~stopped])
    assert np.array_equal(cut.normal_force, whole.normal_force), "what is known already stays"


@pytest.mark.parametrize("model", ["sliding", "kalker_table"])
def test_the_bound_that_stops_is_below_the_peak(model):
    rng = np.random.default_rng(8)
    cases = [
        {
            "friction_coefficient": float(rng.uniform(0, 0.9)),
            "contact_angle": float(rng.uniform(15, 70)),
            "roller_profile_radius": float(rng.choice([-6.3, -8.0, 40.0])),
        }
        for _ in range(12)
    ]
    options = Options(contact_model=model)
    scene = stages.prepare(to_table(cases), options)
    results = StageResults.start(scene, stages.eq.solve_equilibrium(scene.loads, scene.model.law))
    stages.contact(results, options)
    bound = stages_stress.peak_bound(results, options)
    stages_stress.peak_stress(results, options)
    share = bound / results.values["peak_stress"]
    assert np.nanmax(share) <= 1.002, "within the accuracy of the search"
    assert np.nanmedian(share) > 0.8, "and of use"


def test_stop_before_stresses_by_pressure_or_regime():
    found = solve_sliding(
        [{}, {"motor_force": 500.0}, {"radial_force": -5000.0}], stop_if="regime == full_slip or max_pressure > 1500"
    )
    assert found.stopped.values.tolist() == [0, 1, 1]


def test_a_condition_may_name_a_contact_or_a_body():
    """Contact 2 is pressed harder than contact 1, and a roller of PA6 is weaker than its guide."""
    pressure = float(solve_sliding(tr.Case()).max_pressure.mean())
    for contact, stopped in ((1, 0), (2, 1)):
        assert solve_sliding(tr.Case(), stop_if=f"max_pressure_{contact} > {pressure}").stopped == stopped
    weak = {"roller_material": "PA6", "radial_force": -800.0}
    for name, stopped in (("peak_stress", 1), ("peak_stress_roller", 1), ("peak_stress_guide", 0)):
        assert solve_sliding(weak, stop_if=f"{name} > R_m").stopped == stopped


@pytest.mark.parametrize(
    "text, told",
    [
        ("peak_stress < R_m", "lower bound"),
        ("peak_stress_guide_2 < R_m", "lower bound"),
        ("peak > R_m", "peak_stress"),
        ("peak_stress > R_n", "R_m"),
        ("1 > 2", "1"),
        ("import os", "or"),
        ("regime == slipping", "full_slip"),
        ("__import__('os') > 1", "stop_if"),
        ("", "comparison"),
    ],
)
def test_bad_conditions_are_refused_by_name(text, told):
    with pytest.raises(tr.InputError, match="stop_if") as caught:
        solve_sliding(tr.Case(), stop_if=text)
    assert told in str(caught.value)


def test_explained_counts_are_those_that_run(monkeypatch):
    """The printed plan tells the number of patches that the search really gets."""
    seen = searched_patches(monkeypatch)
    cases = [{"axial_force": 0.0}, {"axial_force": 0.0, "velocity": 10.0}, {"axial_force": 20.0}]
    told = {stage.name: stage for stage in explain(to_table(cases), Options())}
    solve_sliding(cases)
    assert [told["peak stress"].count] == seen == [3]
    assert told["peak stress"].total == 6
    assert not told["friction work"].runs and not told["subsurface sections"].runs
    off = {stage.name: stage for stage in explain(to_table(cases), Options(shortcuts=False))}
    assert off["peak stress"].count == 6


def test_no_stress_without_a_stress_output(monkeypatch):
    monkeypatch.setattr(ellipse_stresses, "find_peaks", lambda *a: pytest.fail("searched for a peak nobody asked for"))
    assert "peak_stress" not in solve_sliding(tr.Case(), outputs=("forces", "contact", "friction_work"))
