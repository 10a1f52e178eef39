"""Indices of each method: closed forms, other programs, and no silent bias."""

import numpy as np
import pytest
from known_functions import PI, ishigami, ishigami_indices

from trackroller.methods import convergence
from trackroller.methods import morris as elementary
from trackroller.methods.arrays import effects
from trackroller.methods.given_data import first_order, given_data, prcc
from trackroller.methods.grid import grid_shares
from trackroller.methods.saltelli import sobol
from trackroller.study.design.sampling import sample

X3 = {f"x{i}": {"uniform": [-PI, PI]} for i in (1, 2, 3)}


def test_sobol_g_function_matches_its_closed_form():
    """g-function with a = 0, 1, 4.5, 9, 99: first and total indices from prod (1 + V_i) - 1."""
    a = np.array([0, 1, 4.5, 9, 99.0])
    design = sample({f"x{i}": {"uniform": [0, 1]} for i in range(5)}, "saltelli", 2048, 1, second_order=False)
    y = np.prod([(abs(4 * c - 2) + ai) / (1 + ai) for c, ai in zip(design.columns.values(), a, strict=True)], axis=0)
    part = 1 / (3 * (1 + a) ** 2)
    v = np.prod(1 + part) - 1
    total = part * np.prod(1 + part) / (1 + part) / v
    found = sobol(y, 5, False)
    np.testing.assert_allclose(found["S1"], part / v, atol=0.03)
    np.testing.assert_allclose(found["ST"], total, atol=0.03)
    assert found["ST_high"][4] - found["ST_low"][4] < 1e-3  # nearly inert: nearly no noise


def test_sobol_agrees_with_salib_and_is_not_wider():
    """SALib on the same rows: within its own interval; our intervals are no wider."""
    from SALib.analyze import sobol as oracle

    design = sample(X3, "saltelli", 512, 2)
    y = ishigami(*design.columns.values())
    ours = sobol(y, 3, True)
    theirs = oracle.analyze({"num_vars": 3, "names": list(X3), "bounds": [[-PI, PI]] * 3}, y, seed=1)
    assert (np.abs(ours["S1"] - theirs["S1"]) <= theirs["S1_conf"]).all()
    assert (np.abs(ours["ST"] - theirs["ST"]) <= theirs["ST_conf"]).all()
    assert (ours["S1_high"] - ours["S1_low"]).max() < 2 * theirs["S1_conf"].max()


def test_sobol_error_falls_with_sample_size():
    """Mean error over seeds falls at least as one over the root of the samples: 16 times the samples, 1/4."""
    first, total, _ = ishigami_indices()

    def error(n):
        found = [
            sobol(ishigami(*sample(X3, "saltelli", n, s).columns.values()), 3, True, resamples=2) for s in range(8)
        ]
        return np.mean([np.abs(np.r_[f["S1"] - first, f["ST"] - total]) for f in found])

    assert error(512) < 0.25 * error(32)


def categorical(x, c):
    return x + np.array([{"a": 0.0, "b": 0.0, "c": 3.0}[k] for k in c])


def test_categorical_function_comes_right_in_every_analysis():
    """y = x + g(c), x uniform on 0..1, g = 0, 0, 3: V_x = 1/12, V_c = 2; Sobol, grid, Morris, given data."""
    spec = {"x": {"uniform": [0.0, 1.0]}, "c": {"values": ["a", "b", "c"]}}
    share = (1 / 12) / (1 / 12 + 2)
    design = sample(spec, "saltelli", 1024, 1)
    found = sobol(categorical(**design.columns), 2, True)
    np.testing.assert_allclose(found["S1"], [share, 1 - share], atol=0.02)
    np.testing.assert_allclose(found["ST"], [share, 1 - share], atol=0.02)

    design = sample(spec, "lhs", 1500, 1)
    given = given_data(categorical(**design.columns), design.places, np.array([True, False]))
    np.testing.assert_allclose(given["first"], [share, 1 - share], atol=0.03)
    assert np.isnan(given["prcc"][1]) and given["prcc"][0] > 0.95  # the category taken out

    design = sample(spec, "morris", 300, 1)
    morris = elementary.morris(categorical(**design.columns), design.unit, np.array([False, True]))
    assert morris["mu_star"][0] == pytest.approx(1.0)
    assert morris["sigma"][0] == pytest.approx(0.0, abs=1e-9)
    assert morris["mu_star"][1] == pytest.approx(2.0, abs=0.2)  # pairs ab 0, ac 3, bc 3

    levels = {"x": {"linspace": [0.0, 1.0, 5]}, "c": spec["c"]}
    design = sample(levels, "grid", 0, 0)
    grid = grid_shares(categorical(**design.columns).reshape(design.meta["shape"]))
    np.testing.assert_allclose(grid["main_share"], np.array([0.125, 2.0]) / 2.125)
    assert grid["interaction_share"][0, 1] == pytest.approx(0.0, abs=1e-12)


def test_grid_shares_of_a_product_are_exact():
    """y = x1 x2 + x3 on {-1, 1}^3: all of the product is interaction."""
    x1, x2, x3 = np.meshgrid([-1, 1], [-1, 1], [-1, 1], indexing="ij")
    found = grid_shares((x1 * x2 + x3).astype(float))
    np.testing.assert_allclose(found["main_share"], [0, 0, 0.5], atol=1e-12)
    assert found["interaction_share"][0, 1] == pytest.approx(0.5)
    triple = grid_shares((x1 * x2 * x3).astype(float))
    assert float(triple["higher_share"]) == pytest.approx(1.0)


def test_grid_with_holes_drops_levels_and_says_how_many_cells():
    """A corner without results removes levels; the remaining levels stay balanced."""
    y = np.add.outer(np.arange(5.0) ** 2, 10 * np.arange(4.0))
    y[4, 3] = np.nan
    found = grid_shares(y)
    assert int(found["cells"]) == 20 and int(found["cells_used"]) in (15, 16)
    assert found["interaction_share"][0, 1] == pytest.approx(0, abs=1e-12)
    assert np.isnan(grid_shares(np.full((3, 3), np.nan))["main_share"]).all()


def test_morris_agrees_with_salib_and_uses_what_is_left():
    """mu, mu*, sigma as SALib gives them; a lost row costs its two effects only."""
    from SALib.analyze import morris as oracle

    design = sample(X3, "morris", 50, 3)
    table = np.stack(list(design.columns.values()), axis=1)
    y = ishigami(*table.T)
    none = np.zeros(3, dtype=bool)
    found = elementary.morris(y, design.unit, none)
    theirs = oracle.analyze({"num_vars": 3, "names": list(X3), "bounds": [[-PI, PI]] * 3}, table, y)
    for name in ("mu", "mu_star", "sigma"):
        np.testing.assert_allclose(found[name], theirs[name], atol=1e-9)
    y[1] = np.nan
    assert elementary.morris(y, design.unit, none)["effects_used"].sum() == 150 - 2


def test_partial_rank_correlation_sees_through_other_factors():
    """y = x1^3 - 2 x2: +1 and -1 with each other taken out, 0 for the inert one, inside its interval."""
    rng = np.random.default_rng(1)
    unit = rng.random((400, 3))
    value, low, high = prcc((unit[:, 0] - 0.5) ** 3 * 8 - 2 * unit[:, 1], unit, np.ones(3, dtype=bool))
    assert value[0] > 0.85 and value[1] < -0.95 and low[2] < 0 < high[2]


def test_share_from_groups_is_free_of_bias_for_noise():
    """The index of an inert grouping of pure noise is 0 on average (the raw ratio is 10 %)."""
    rng = np.random.default_rng(2)
    found = [first_order(rng.normal(size=200), rng.integers(0, 20, 200))[0] for _ in range(60)]
    assert abs(np.mean(found)) < 0.02


@pytest.mark.parametrize("method", ["central_composite", "box_behnken"])
def test_response_surface_recovers_a_quadratic(method):
    """y = 1 + 2a - 3b + a b + 4 c^2 in coded units: effects 4, -6, 0; interaction 2; curvature 4."""
    design = sample({k: {"uniform": [0, 10]} for k in "abc"}, method, 0, 1)
    a, b, c = design.unit.T
    found = effects(1 + 2 * a - 3 * b + a * b + 4 * c**2, design.unit, np.zeros(3, dtype=bool), True)
    np.testing.assert_allclose(found["effect"], [4, -6, 0], atol=1e-9)
    assert found["interaction"][0, 1] == pytest.approx(2) and found["curvature"][2] == pytest.approx(4)
    assert float(found["r_squared"]) == pytest.approx(1)


def test_plackett_burman_keeps_main_effects_clear_of_interactions():
    """Folded over: a strong interaction does not leak into any main effect."""
    design = sample({k: {"uniform": [0, 1]} for k in "abcdefg"}, "plackett_burman", 0, 1)
    u = design.unit
    found = effects(u[:, 0] + 5 * u[:, 1] * u[:, 2], u, np.zeros(7, dtype=bool), False)
    np.testing.assert_allclose(found["effect"], [2, 0, 0, 0, 0, 0, 0], atol=1e-9)


def test_advice_on_sample_size_follows_the_width():
    """Half width 0.1 against 0.05 wants 4 times the samples; 0.04 is enough."""
    assert convergence.take_times(np.array([0.4]), np.array([0.6]), 0.05) == 4
    assert convergence.take_times(np.array([0.46]), np.array([0.54]), 0.05) == 1
