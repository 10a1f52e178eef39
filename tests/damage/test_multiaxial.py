"""Multiaxial fatigue criteria against closed forms and brute force."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import trackroller as tr
from trackroller.damage import multiaxial as m
from trackroller.damage import paths
from trackroller.errors import InputError
from trackroller.halfspace.stress import principal_stresses, von_mises

TIME = np.linspace(0, 2 * np.pi, 48, endpoint=False)
K, F = m.findley_constants(np.array(300.0), np.array(190.0))
A, B = m.dang_van_constants(np.array(300.0), np.array(190.0))


def amplitude(path):
    """Half the longest chord as a von Mises stress."""
    return np.sqrt(3.0) * paths.governing(path[None], np.nan, np.nan, np.inf)[0]


def deviators(stress):
    """Return coordinates of deviators (n, 5) and mean stresses (n,)."""
    u = np.empty((len(stress), 5))
    return u, np.array([paths.deviator(s, own) for s, own in zip(stress, u, strict=True)])


def history(bending=0.0, torsion=0.0, mean=0.0):
    path = np.zeros((TIME.size, 6))
    path[:, 0], path[:, 3] = mean + bending * np.sin(TIME), torsion * np.sin(TIME)
    return path


def tensors(path):
    return path[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]


def turned(path, seed):
    turn = Rotation.random(random_state=seed).as_matrix()
    s = turn @ tensors(path) @ turn.T
    return np.stack([s[:, 0, 0], s[:, 1, 1], s[:, 2, 2], s[:, 0, 1], s[:, 1, 2], s[:, 0, 2]], axis=1)


def test_constants_make_both_limits_just_bearable():
    """Fully reversed bending and torsion at their limits give a utilisation of 1 by both criteria."""
    for path in (history(bending=300.0), history(torsion=190.0)):
        assert paths.findley(path, float(K)) == pytest.approx(float(F), rel=1e-4)
        assert paths.dang_van(path, float(A))[0] == pytest.approx(float(B), rel=1e-6)


def test_closed_forms_of_the_amplitude_and_of_combined_stress():
    path = history(200.0, 90.0, mean=500.0)
    assert amplitude(path) == pytest.approx(np.sqrt(200**2 + 3 * 90**2), rel=1e-12)
    both = history(200.0, 90.0)
    root = np.sqrt(200**2 + 4 * 90**2)
    assert paths.findley(both, float(K)) == pytest.approx(0.5 * (K * 200 + np.sqrt(1 + K**2) * root), rel=1e-4)
    assert paths.dang_van(both, float(A))[0] == pytest.approx(root / 2 + A * 200 / 3, rel=1e-6)
    shifted = history(200.0, 90.0, mean=-1000.0)
    assert paths.dang_van(shifted, float(A))[1] == pytest.approx(root / 2, rel=1e-6)
    assert paths.dang_van(shifted, float(A))[0] == pytest.approx(root / 2 + A * (-1000 + 200) / 3, rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_the_frame_does_not_matter_and_brute_force_agrees(seed):
    rng = np.random.default_rng(seed)
    waves = rng.normal(size=(3, 6)) * 100
    path = sum(np.sin((i + 1) * TIME + rng.uniform(0, 6))[:, None] * w for i, w in enumerate(waves)) - 80 * np.eye(6)[2]
    value = paths.findley(path, float(K))
    normals = rng.normal(size=(2000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    best = 0.0
    for n in normals:
        traction = tensors(path) @ n
        normal = traction @ n
        shear = traction - normal[:, None] * n
        chord = np.linalg.norm(shear[:, None] - shear[None], axis=2).max()
        best = max(best, 0.5 * chord + K * normal.max())
    assert best <= value * (1 + 1e-12) and value == pytest.approx(best, rel=0.01)
    for other in (turned(path, seed), turned(path, seed + 50)):
        assert paths.findley(other, float(K)) == pytest.approx(value, rel=5e-3)
        assert paths.dang_van(other, float(A)) == pytest.approx(paths.dang_van(path, float(A)), rel=1e-3)
        assert amplitude(other) == pytest.approx(amplitude(path), rel=1e-12)


def test_coordinates_of_the_deviator():
    stress = np.random.default_rng(3).normal(size=(20, 6))
    u, mean = deviators(stress)
    assert np.sum(u**2, axis=1) == pytest.approx(von_mises(stress) ** 2 / 3, rel=1e-12)
    ends = np.array([paths.principal_deviators(own) for own in u]) + mean[:, None]
    assert ends == pytest.approx(principal_stresses(stress)[:, [0, 2]], rel=1e-9)


def test_skipped_lines_do_not_change_the_result():
    """The search returns the largest of the values that all paths have."""
    rng = np.random.default_rng(5)
    for k, a in ((0.3, 0.4), (0.0, 0.0), (1.5, 2.0)):
        some = rng.normal(size=(60, 20, 6)) * rng.uniform(0.2, 1, (60, 1, 1)) - 0.5 * np.eye(6)[0]
        mises, pressed = [amplitude(path) for path in some], np.array([paths.dang_van(path, a) for path in some])
        found = paths.governing(some, k, a, np.inf)
        assert np.sqrt(3.0) * found[0] == max(mises) and found[1] == max(paths.findley(path, k) for path in some)
        assert found[2:4].tolist() == pressed.max(axis=0).tolist()
        for strength in (1.5, 4.0, 12.0, np.inf):
            worst = max(paths.goodman(deviators(path)[0], strength) for path in some)
            assert paths.governing(some, k, a, strength)[4] == worst
        assert worst == pytest.approx(max(mises), rel=1e-12)  # a material that never breaks knows no mean stress


def goodman(path, strength):
    return paths.governing(path[None], np.nan, np.nan, strength)[4]


def test_goodman_in_closed_form():
    """No mean stress changes nothing; the strength falls on a line, and is zero at a mean of R_m."""
    assert goodman(history(bending=200.0), 800.0) == pytest.approx(200.0, rel=1e-12)
    assert goodman(history(torsion=100.0), 800.0) == pytest.approx(np.sqrt(3) * 100.0, rel=1e-12)
    for mean in (100.0, 400.0, 700.0, -400.0):
        shifted = history(bending=50.0, mean=mean)
        expected = 50.0 / (1.0 - abs(mean) / 800.0)
        pulse = np.abs(shifted[:, 0]).max()  # of the states of the path alone, none is unloaded
        assert goodman(shifted, 800.0) == pytest.approx(expected, rel=1e-12) and pulse > 50.0
    assert goodman(history(bending=1e-3, mean=800.0), 800.0) == np.inf
    assert goodman(history(mean=500.0), 800.0) == 0.0  # a steady stress is no amplitude
    pulsating = np.array([np.zeros(6), np.eye(6)[0] * 300.0])
    assert goodman(pulsating, 600.0) == pytest.approx(150.0 / (1.0 - 150.0 / 600.0), rel=1e-12)
    assert goodman(pulsating - np.array([70.0, 70.0, 70.0, 0, 0, 0]), 600.0) == pytest.approx(200.0, rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_goodman_of_any_path_is_that_of_its_worst_two_states(seed):
    rng = np.random.default_rng(seed)
    path = rng.normal(size=(15, 6)) * 100
    pairs = [(p, q) for i, p in enumerate(path) for q in path[:i]]
    amplitudes, means = (np.array([von_mises(f(p, q) / 2.0) for p, q in pairs]) for f in (np.subtract, np.add))
    strength = 1.2 * means.max()
    worst = np.max(amplitudes / (1.0 - means / strength))
    assert goodman(path, strength) == pytest.approx(worst, rel=1e-12)
    assert goodman(turned(path, seed), strength) == pytest.approx(worst, rel=1e-12)
    peak = np.sqrt(np.max(von_mises(path) ** 2))
    chord = amplitude(path)
    assert worst <= paths.goodman_bound(chord, peak, strength) * (1 + 1e-12)


def test_a_frictionless_roller_has_the_amplitude_of_its_path():
    """Amplitudes grow with friction, Findley's and Dang Van's faster than the peak stress."""
    steel = {"like": "1.7225-normalised", "fatigue_limit_torsion": 216.0}
    case = {"motor_force": 0, "axial_force": 0, "roller_material": steel, "guide_material": steel}
    cases = [tr.Case(**case, friction_coefficient=mu) for mu in (0.0, 0.4)]
    ds = tr.solve(cases, ("multiaxial", "peak_stress"), contact_model="sliding").sel(body="roller", contact=1)
    peak, half = ds.peak_stress.values, ds.von_mises_amplitude.values
    assert (half < peak).all() and (half > 0.49 * peak).all()
    grown = [float(ds[name][1] / ds[name][0]) for name in ("peak_stress", "findley_stress", "dang_van_stress")]
    assert grown[0] < grown[1] < grown[2]
    assert (ds.dang_van_stress <= ds.dang_van_stress_without_pressure).all()


def test_limits_outside_the_range_of_the_criteria_are_refused():
    for torsion in (170.0, 380.0):
        with pytest.raises(InputError, match="fatigue_limit_torsion"):
            tr.solve(
                tr.Case(roller_material={"like": "1.7225-normalised", "fatigue_limit_torsion": torsion}), "multiaxial"
            )


def test_a_placeholder_that_contradicts_a_given_value_is_left_out():
    """R_m = 400 MPa of the user's own material lies below the yield strength that it would inherit."""
    soft = tr.Case(roller_material={"like": "1.7225-normalised", "tensile_strength": 400.0}, motor_force=0)
    ds = tr.solve(soft, ("shakedown", "limits", "peak_stress"), contact_model="sliding")
    assert (
        np.isnan(ds.shakedown_utilisation.sel(body="roller")).all() and "no yield_strength" in ds.attrs["limits_notes"]
    )


def test_places_between_the_nodes_are_exact_for_cubics():
    y = np.linspace(-1.0, 1.0, 9)
    twice = np.linspace(-1.0, 1.0, 17)

    def cubic(t):
        return 1.0 - 2.0 * t + 3.0 * t**2 - 4.0 * t**3

    found = m._twice(np.stack([cubic(y), y]))
    assert found[0, 2:-2] == pytest.approx(cubic(twice)[2:-2], rel=1e-12)
    assert found[1] == pytest.approx(twice, abs=1e-12) and found[0, ::2].tolist() == cubic(y).tolist()
