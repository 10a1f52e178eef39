"""Elastic shakedown by Melan's theorem."""

import numpy as np
import pytest
from scipy.optimize import minimize

import trackroller as tr
from trackroller.damage.ball import GAP, ball_of_plane, smallest_ball, top_of_depths
from trackroller.damage.deep_planes import BESIDE, deep_planes, ladder_of, loads_on_ladder, steps_on_ladder
from trackroller.damage.histories import DEPTHS, RollerTractions, planes
from trackroller.damage.shakedown import largest_shears, shears
from trackroller.halfspace.stress import stress_from_tractions, stress_on_grid, von_mises


def ellipse(a, b, mu=0.0, nodes=36):
    """Hertzian pressure of p_0 = 1 with full sliding along y, on one contact of a roller."""
    unit = (2 * np.arange(nodes) + 1) / nodes - 1
    p = np.sqrt(np.maximum(1 - unit[None, :] ** 2 - unit[:, None] ** 2, 0))
    fields = [np.stack([f, np.nan * f])[None] for f in (a * unit, b * unit, p, 0 * p, mu * p, 0 * p, 0 * p)]
    return RollerTractions(*fields, np.zeros(1, bool))


@pytest.mark.parametrize(
    ("a", "b", "mu", "expected"),
    [
        (1, 1, 0, 4.65),
        (2, 1, 0, 4.22),
        (5, 1, 0, 4.04),
        (10, 1, 0, 4.01),
        (1, 2, 0, 4.23),
        (5, 1, 0.2, 3.23),
        (5, 1, 0.4, 2.5),
    ],
)
def test_limits_of_ellipses(a, b, mu, expected):
    """p_0/k at nu = 0.3, computed independently; at mu = 0.4 the surface governs with 1/mu."""
    limits = 1 / shears(ellipse(a, b, mu), np.array([[0.3, 0.3]]))[0, 0]
    assert limits[0] == pytest.approx(expected, rel=0.015)
    assert limits[1] == pytest.approx(limits[0], rel=2e-3)  # mirrored along y


def sliding_ellipses(ratios, frictions, angles, nodes=24):
    """Ellipses of all ratios, frictions and directions of sliding, each as contact 1 of a roller."""
    unit = (2 * np.arange(nodes) + 1) / nodes - 1
    ratio, mu, angle = (part.ravel() for part in np.meshgrid(ratios, frictions, angles, indexing="ij"))
    p = np.sqrt(np.maximum(1 - unit[None, :] ** 2 - unit[:, None] ** 2, 0))[None, None]
    p = np.concatenate([p + np.zeros((ratio.size, 1, 1, 1)), np.full((ratio.size, 1, nodes, nodes), np.nan)], axis=1)
    x = np.stack([ratio[:, None] * unit, np.full((ratio.size, nodes), np.nan)], axis=1)
    y = np.stack([unit + np.zeros((ratio.size, 1)), np.full((ratio.size, nodes), np.nan)], axis=1)
    share = mu[:, None, None, None]
    across, along = (share * turned(angle)[:, None, None, None] * p for turned in (np.sin, np.cos))
    return RollerTractions(x, y, p, across, along, 0 * p, 0 * p, np.zeros(ratio.size, bool))


def test_the_depths_around_the_summit_are_enough_below_ellipses():
    """Line-like and round ellipses, without and with high friction in any direction; the same bits as of all depths."""
    t = sliding_ellipses(np.geomspace(0.03, 30, 9), (0.0, 0.1, 0.2, 0.28, 0.32, 0.36, 0.5, 1.0), (0.0, 0.6, 1.5708))
    ratio = np.tile([0.3, 0.42], (len(t.x), 1))
    every = shears(t, ratio)
    np.testing.assert_array_equal(shears(t, ratio, hertzian=True), every)
    assert np.isfinite(every[:, 0]).all() and np.isnan(every[:, 1]).all()


def test_the_contact_that_decides_has_its_number():
    """Both contacts, loaded more or less unequally: the largest is that of all numbers, and bounds stand beside it."""
    t = sliding_ellipses((0.5, 1.0, 2.0), (0.05, 0.3), (0.0,))
    for name in ("x", "y"):
        getattr(t, name)[:, 1] = getattr(t, name)[:, 0]
    for name in ("pressure", "shear_lateral", "shear_rolling"):
        getattr(t, name)[:, 1] = np.array([0.0, 0.5, 0.99, 1.0, 1.01, 2.0])[:, None, None] * getattr(t, name)[:, 0]
    ratio, bounded = np.full((6, 2), 0.3), np.zeros((6, 2), bool)
    bounded[3, 0] = True
    every = shears(t, ratio)
    most = 1.2 * every
    most[4] = np.nan
    found = largest_shears(t, ratio, most, bounded)
    np.testing.assert_array_equal(found.max(axis=1), np.where(bounded, np.nan, every.max(axis=1)))
    np.testing.assert_array_equal(found[1, 1], most[1, 1])
    np.testing.assert_array_equal(found[[2, 4]], every[[2, 4]])


@pytest.mark.parametrize("seed", range(3))
def test_the_residual_stress_of_a_plane_is_the_best_one(seed):
    """An optimiser over xx, yy and xy finds the same largest J2 of four places and of the unloaded state."""
    stress = np.random.default_rng(seed).normal(size=(6, 2, 2))
    states = np.append(stress.reshape(6, 4).T, np.zeros((1, 6)), axis=0)

    def largest(residual):
        return (von_mises(states - np.array([*residual[:2], 0, residual[2], 0, 0])) ** 2 / 3).max()

    tried = [
        minimize(largest, start, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-12})
        for start in -states[:, [0, 1, 3]]
    ]
    assert ball_of_plane(stress) == pytest.approx(min(own.fun for own in tried), rel=1e-4)


def test_parabolas_find_the_summits_between_the_places():
    """Two opposed hills of yz whose tops lie between the places; the unloaded state does not matter."""
    x, y = np.arange(9) - 4.3, np.arange(12) - 5.6
    stress = np.zeros((6, 12, 9))
    stress[4] = np.exp(-0.01 * (x[None, :] ** 2 + y[:, None] ** 2))
    assert np.max(stress[4] ** 2) < 0.997 and ball_of_plane(stress) == pytest.approx(1.0, abs=3e-4)


def test_the_depth_of_the_largest_shear_may_lie_between_the_planes():
    """A parabola over the logarithm of the depth is met exactly, a rise to the last plane ends there."""
    log_depth = np.log(DEPTHS)
    shear = np.stack([3.0 - 0.4 * (log_depth - np.log(0.43)) ** 2, 1.0 + DEPTHS])
    tops = [top_of_depths(own, log_depth) for own in shear]
    assert tops == pytest.approx([3.0, 1.0 + DEPTHS[-1]], rel=1e-12)
    assert shear[0].max() < 2.995


def test_smallest_ball_is_the_minimax():
    rng = np.random.default_rng(2)
    points, height = rng.normal(size=(6, 40, 3)), rng.uniform(0, 1, (6, 40))
    for own, lift in zip(points, height, strict=True):
        value, centre, few, weight = smallest_ball(own, lift, GAP)
        start = np.append(own.mean(0), 30.0)
        inside = {"type": "ineq", "fun": lambda v, own=own, lift=lift: v[3] - np.sum((own - v[:3]) ** 2, axis=1) - lift}
        tried = minimize(lambda v: v[3], start, constraints=[inside], method="SLSQP", options={"ftol": 1e-10})
        assert value == pytest.approx(tried.x[3], rel=2e-5)
        assert weight.sum() == pytest.approx(1) and (weight > 0).all() and weight @ own[few] == pytest.approx(centre)


def test_planes_are_the_stresses_of_the_half_space():
    t = ellipse(1.3, 0.8, 0.2, nodes=12)
    x, y = t.x[0, 0], t.y[0, 0]
    depths = np.array([0.0, 0.36])
    stress = planes(t.loads(0, 0), depths, np.array([0.3, 0.25]))
    for body, (nu, sign) in enumerate(((0.3, 1), (0.25, -1))):
        direct = stress_on_grid(x, y, t.pressure[0, 0], 0.0, sign * t.shear_rolling[0, 0], depths, nu)
        assert np.moveaxis(stress[body, :, :, 3:15], 1, -1) == pytest.approx(direct, abs=2e-6)  # over p_0 = 1


def on_ladder(loads):
    """Return the loads of a patch on the nodes of a ladder, their spacings, and the sides of its box."""
    _, ny, nx = loads.tractions.shape
    nodes = ladder_of((nx, ny)).nodes
    steps = steps_on_ladder((nx * loads.step_x, ny * loads.step_y), nodes)
    own = loads_on_ladder(loads.tractions, (loads.step_x / steps[0], loads.step_y / steps[1]), nodes)
    return own, steps, (nodes[0] * steps[0], nodes[1] * steps[1])


def test_loads_on_the_ladder_keep_resultants_and_first_moments():
    """The second moments grow by a quarter of the squared spacing, as the kernels expect."""
    for a, b, nodes in ((1.3, 0.8, 28), (1.0, 2.9, 21)):
        fine = ellipse(a, b, 0.2, nodes).loads(0, 0)
        coarse, steps, box = on_ladder(fine)
        sums, spreads = [], []
        for own, (step_x, step_y) in ((fine.tractions, (fine.step_x, fine.step_y)), (coarse, steps)):
            _, ny, nx = own.shape
            x, y = step_x * (np.arange(nx) - 0.5 * (nx - 1)) + 0.1, step_y * (np.arange(ny) - 0.5 * (ny - 1))
            load = own * step_x * step_y
            sums.append([load.sum((1, 2)), (load * x).sum((1, 2)), (load.sum(2) * y).sum(1)])
            spreads.append([(load * x**2).sum((1, 2))[2], (load.sum(2) * y**2).sum(1)[2]])
        assert np.array(sums[1]) == pytest.approx(np.array(sums[0]), abs=1e-12)
        grown = np.array(steps) ** 2 / 4 * sums[0][0][2]
        assert np.subtract(*spreads[::-1]) == pytest.approx(grown, rel=1e-9)
        assert box[0] * box[1] <= 1.5 * 4 * a * b
        assert coarse.shape[1:] == tuple((n + 1) // 2 + 2 * BESIDE for n in fine.tractions.shape[1:])


@pytest.mark.slow
@pytest.mark.parametrize(("a", "b"), [(1.0, 1.0), (4.1, 1.0), (1.0, 3.3)])
def test_deep_planes_converge_with_the_fourth_order(a, b):
    """Against the exact stresses of a fine grid under a smooth load, from a depth of 0.3 downwards."""

    def load(nodes):
        unit = (2 * np.arange(nodes) + 1) / nodes - 1
        p = np.maximum(1 - unit[None, :] ** 2 - unit[:, None] ** 2, 0) ** 2
        fields = [f[None, None] for f in (a * unit, b * unit, p, -0.1 * p, 0.3 * p, 0 * p, 0 * p)]
        return RollerTractions(*fields, np.zeros(1, bool))

    errors, exact = [], load(112)
    for nodes in (14, 28):
        loads = load(nodes).loads(0, 0)
        (_, (step_x, step_y), box), stress = on_ladder(loads), deep_planes(loads, np.array([0.3, 0.4]))
        worst = []
        for k, depth in enumerate(0.5 * min(box) * DEPTHS[4:], 4):
            ny, nx = stress.shape[3:]
            x, y = step_x * (np.arange(nx) - 0.5 * (nx - 1)), step_y * (np.arange(ny) - 0.5 * (ny - 1))
            points = np.stack(np.broadcast_arrays(x[::3], y[::2, None], depth), axis=-1)
            for body, (nu, sign) in enumerate(((0.3, 1), (0.4, -1))):
                q = sign * exact.shear_lateral[0, 0], sign * exact.shear_rolling[0, 0]
                direct = stress_from_tractions(exact.x[0, 0], exact.y[0, 0], exact.pressure[0, 0], *q, points, nu)
                worst.append(np.abs(np.moveaxis(stress[body, k][:, ::2, ::3], 0, -1) - direct).max())
        errors.append(max(worst))
    assert errors[1] < 2e-3 and np.log2(errors[0] / errors[1]) > 2.9


def test_shakedown_allows_more_than_the_elastic_limit():
    steel = {"like": "1.7225-normalised", "yield_strength": 500.0}
    case = tr.Case(motor_force=0, axial_force=0, friction_coefficient=0.0, roller_material=steel, guide_material=steel)
    ds = tr.solve(case, ("shakedown", "peak_stress", "contact", "limits"), contact_model="sliding")
    elastic, shaken = ds.elastic_utilisation.values, ds.shakedown_utilisation.values
    assert elastic == pytest.approx(ds.peak_stress.values / 500, rel=1e-12)
    assert (shaken < elastic).all() and shaken[0] == pytest.approx(shaken[1], rel=1e-9)
    limit = ds.max_pressure.values[:, None] / shaken / (500 / np.sqrt(3))
    assert (limit > 3.99).all() and (limit < 4.72).all()
    assert ds.surface_fatigue_index.values == pytest.approx(-500 / np.sqrt(3) / ds.max_pressure.values, rel=1e-12)
    assert ds.utilisation.sel(limit="shakedown").values == pytest.approx(shaken.max(axis=0))


def test_cases_that_share_their_mechanics_keep_their_own_yield_strength():
    cases = [
        tr.Case(motor_force=0, roller_material={"like": "1.7225-normalised", "yield_strength": y})
        for y in (300.0, 600.0)
    ]
    ds = tr.solve(cases, "shakedown", contact_model="sliding")
    one, two = ds.shakedown_utilisation.sel(body="roller").values
    assert one == pytest.approx(2 * two, rel=1e-12)


def test_full_slip_has_a_shakedown_limit_too():
    ds = tr.solve(tr.Case(motor_force=-60, friction_coefficient=0.1), ("shakedown", "forces"), contact_model="sliding")
    assert int(ds.regime) == 1 and np.isfinite(ds.shakedown_utilisation).all()
