"""Stresses under sampled tractions: closed forms, limits, load balance, order of convergence, fast convolution."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from trackroller.errors import InputError
from trackroller.halfspace import influence, stress
from validation.exact import stresses as reference

NU = 0.3


def _hertz(n, a=1.0, b=1.0, margin=1.0):
    x, y = np.linspace(-a * margin, a * margin, n), np.linspace(-b * margin, b * margin, n)
    return x, y, np.sqrt(np.clip(1 - (x / a) ** 2 - (y[:, None] / b) ** 2, 0, None))


@pytest.mark.parametrize("shape", [(1.5, 0.6), (0.3, 1.2)])
def test_elliptical_hertz_on_the_axis(shape):
    """Field on the z-axis of a Hertz ellipse is Johnson's closed form, in both orientations."""
    x, y, p = _hertz(161, *shape)
    z = np.array([0.0, 1e-6, 0.05, 0.3, 1.0, 4.0])
    found = stress.stress_from_tractions(x, y, p, 0, 0, np.stack([0 * z, 0 * z, z], -1), NU)
    assert np.allclose(found, reference.hertz_ellipse_axis(z, *shape, 1.0, NU), atol=1e-4)
    assert np.allclose(found[0], reference.hertz_ellipse_centre(*shape, 1.0, NU), atol=2e-5)


def test_circular_hertz_axis_and_its_known_maximum():
    """0.620 p0 at 0.481 a for nu = 0.3, and the axis in closed form."""
    x, y, p = _hertz(121)
    z = np.linspace(0, 3, 13)
    found = stress.stress_from_tractions(x, y, p, 0, 0, np.stack([0 * z, 0 * z, z], -1), NU)
    assert np.allclose(found, reference.hertz_circle_axis(z, 1.0, 1.0, NU), atol=1e-4)
    best = minimize_scalar(
        lambda d: -float(stress.von_mises(reference.hertz_circle_axis(d, 1.0, 1.0, NU))),
        bounds=(0.2, 1),
        method="bounded",
    )
    assert -best.fun == pytest.approx(0.620, abs=5e-4) and best.x == pytest.approx(0.481, abs=1e-3)


def test_circular_hertz_surface_inside_outside_and_at_the_edge():
    """Surface stresses of the Hertz circle on both sides of the edge, the edge itself finite and close."""
    x, y, p = _hertz(161)
    at = np.array([[0, 0], [0.2, 0.1], [0.5, -0.6], [0.3, 0.8], [1.2, 0.3], [-2.0, 1.0], [0.0, 3.0]])
    points = np.column_stack([at, np.zeros(len(at))])
    found = stress.stress_from_tractions(x, y, p, 0, 0, points, NU)
    assert np.allclose(found, reference.hertz_circle_surface(at[:, 0], at[:, 1], 1.0, 1.0, NU), atol=1e-4)
    edge = stress.stress_from_tractions(x, y, p, 0, 0, [0.6, 0.8, 0.0], NU)
    assert np.allclose(edge, reference.hertz_circle_surface(0.6, 0.8, 1.0, 1.0, NU), atol=0.1)


def test_sliding_circle_on_the_surface_and_the_axis():
    """Hamilton's sliding sphere, tangential part: the whole surface inside and tau_xz on the axis."""
    x, y, p = _hertz(161)
    at = np.array([[0, 0], [0.2, 0.1], [0.5, -0.6], [-0.7, 0.1]])
    found = stress.stress_from_tractions(x, y, 0, p, 0, np.column_stack([at, np.zeros(4)]), NU)
    assert np.allclose(found, reference.sliding_circle_surface(at[:, 0], at[:, 1], 1.0, 1.0, NU), atol=5e-4)
    z = np.array([0.0, 0.2, 0.7, 2.0])
    found = stress.stress_from_tractions(x, y, 0, p, 0, np.stack([0 * z, 0 * z, z], -1), NU)
    assert np.allclose(found, reference.sliding_circle_axis(z, 1.0, 1.0), atol=1e-4)


def test_rolling_shear_is_lateral_shear_turned_by_a_right_angle():
    """q_y at (x, y) gives what q_x gives at (y, -x), components renamed: the two loads are consistent."""
    x, y, p = _hertz(31, 1.3, 0.7)
    point = np.array([0.4, -0.2, 0.3])
    along_y = stress.stress_from_tractions(x, y, 0, 0, p, point, NU)
    turned = stress.stress_from_tractions(y, x, 0, p.T, 0, [point[1], point[0], point[2]], NU)
    assert np.allclose(along_y, turned[[1, 0, 2, 3, 5, 4]], atol=1e-13)


def test_field_inside_against_independent_quadrature():
    """All six components under a varying traction against a quadrature that shares only the point kernel."""

    def tractions(x, y):
        p = np.sqrt(np.clip(1 - (x / 1.5) ** 2 - (y / 0.6) ** 2, 0, None))
        return 0.3 * p * np.cos(x), 0.2 * p * np.exp(y), p

    for depth in (0.002, 0.15):
        point = (0.4, -0.2, depth)
        truth = reference.quadrature_on_ellipse(tractions, 1.5, 0.6, point, NU)
        errors = []
        for n in (81, 321):
            x, y, _ = _hertz(n, 1.5, 0.6)
            qx, qy, p = tractions(x, y[:, None])
            errors.append(np.abs(stress.stress_from_tractions(x, y, p, qx, qy, point, NU) - truth).max())
        assert errors[1] < 2e-5 * 3
        assert np.log(errors[0] / errors[1]) / np.log(4) > 1.3  # a square-root edge allows 1.5


def test_smooth_tractions_converge_with_second_order():
    """For tractions without an edge singularity the bilinear error falls as h^2."""
    values = []
    for n in (11, 21, 41, 161):
        x = np.linspace(-1, 1, n)
        p = np.outer(np.cos(np.pi * x / 2) ** 2, np.cos(np.pi * x / 2) ** 2)
        values.append(stress.stress_from_tractions(x, x, p, 0.3 * p, 0, [0.23, 0.31, 0.1], NU))
    errors = [np.abs(v - values[-1]).max() for v in values[:3]]
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(rates > 1.7), rates


def test_surface_tractions_are_returned_and_the_limit_is_right():
    """sigma_z = -p, tau_xz = -q_x, tau_yz = -q_y at z = 0 for interpolated tractions; z = 1e-9 is next to z = 0."""
    x, y, p = _hertz(21, 1.0, 0.5)
    qx, qy = 0.3 * p * (1 + x), -0.2 * p
    nodes = np.stack([*np.meshgrid(x, y), np.zeros(p.shape)], -1)
    found = stress.stress_from_tractions(x, y, p, qx, qy, nodes, NU)
    assert np.allclose(found[..., 2], -p, atol=1e-12)
    assert np.allclose(found[..., 5], -qx, atol=1e-12) and np.allclose(found[..., 4], -qy, atol=1e-12)
    below = stress.stress_from_tractions(x, y, p, qx, qy, nodes + np.array([0, 0, 1e-9]), NU)
    assert np.abs(below - found).max() < 1e-6
    outside = stress.stress_from_tractions(x, y, p, qx, qy, [[1.5, 0.2, 0.0], [0.0, -0.8, 0.0]], NU)
    assert np.allclose(outside[:, [2, 4, 5]], 0.0, atol=1e-12)


@pytest.mark.parametrize("depth", [0.05, 0.5, 2.0])
def test_plane_integrals_equal_the_loads(depth):
    """Integrals of sigma_z, tau_xz, tau_yz over any plane balance the surface loads to 1e-6."""
    x, y, p = _hertz(15, 1.0, 0.6)
    qx, qy = 0.3 * p, -0.2 * p * (1 + 0.5 * x)
    cell = (x[1] - x[0]) * (y[1] - y[0])
    load = -cell * np.array([p.sum(), qy.sum(), qx.sum()])
    g, w = np.polynomial.legendre.leggauss(80)
    # r = c tan(..): the plane out to infinity; the trapezoid over angles is spectral
    t, wt = 0.25 * np.pi * (g + 1), 0.25 * np.pi * w
    r, wr = np.tan(t), wt / np.cos(t) ** 2
    angle = 2 * np.pi * (np.arange(96) + 0.5) / 96
    rr, aa = np.meshgrid(r, angle, indexing="ij")
    points = np.stack([rr * np.cos(aa), rr * np.sin(aa), np.full(rr.shape, depth)], -1)
    field = stress.stress_from_tractions(x, y, p, qx, qy, points, NU)[..., [2, 4, 5]]
    total = np.einsum("i,ijc->c", wr * r, field) * 2 * np.pi / 96
    tolerance = 1e-6 if depth > 0.2 else 1e-5  # near the surface the kinks of the interpolation slow the quadrature
    assert np.allclose(total, load, atol=tolerance * np.abs(load).max())


def test_point_forces_take_over_far_away_without_a_step():
    """The far form agrees with the corner sums where it takes over (2e-8 of the local stress)."""

    x, y, p = _hertz(21, 1.0, 0.6)
    loads = influence.corner_loads(x, y, np.stack([0.3 * p, -0.1 * p, p], -1))
    h = loads.length
    points = np.array([[0.2, 0.1, influence.FAR * h], [1.0 + influence.FAR * h, 0.3, 0.0]])
    near = influence.stress_parts(loads._replace(reach=np.inf), points)
    far = influence.stress_parts(loads._replace(reach=0.0), points)
    assert np.all(np.abs(near - far).max((1, 2)) < 2e-8 * np.abs(far).max((1, 2)))


def test_fast_convolution_is_the_direct_sum():
    """`stress_on_grid` and `stress_from_tractions` agree at every node, surface and edge included."""
    x, y, p = _hertz(24, 1.0, 0.4, margin=1.2)
    qx, qy = 0.3 * p, 0.1 * p * x
    depths = [0.0, 1e-6, 0.2, 2.0]
    fast = stress.stress_on_grid(x, y, p, qx, qy, depths, NU)
    for z, plane in zip(depths, fast, strict=True):
        points = np.stack([*np.meshgrid(x, y), np.full(p.shape, z)], -1)
        assert np.allclose(plane, stress.stress_from_tractions(x, y, p, qx, qy, points, NU), atol=1e-10)


@pytest.mark.parametrize("nu", [0.0, 0.25, 0.5])
def test_poisson_ratio_splits_linearly(nu):
    """The field is A + nu B: three Poisson's ratios, incompressible included, lie on one line."""
    x, y, p = _hertz(15)
    point = [0.3, -0.2, 0.1]
    at = [stress.stress_from_tractions(x, y, p, 0.3 * p, 0.2 * p, point, v) for v in (0.0, 0.5, nu)]
    assert np.allclose(at[2], at[0] + 2 * nu * (at[1] - at[0]), atol=1e-14)


def test_threads_and_chunks_do_not_change_a_bit(monkeypatch):
    """The cutting of the points into pieces changes cost, never the result."""
    x, y, p = _hertz(11)
    points = np.random.default_rng(1).uniform([-1, -1, 0], [1, 1, 1], (500, 3))
    one = stress.stress_from_tractions(x, y, p, 0.1 * p, 0, points, NU)
    monkeypatch.setattr(stress, "_CHUNK", 37)
    monkeypatch.setenv("NUMBA_NUM_THREADS", "2")
    assert np.array_equal(one, stress.stress_from_tractions(x, y, p, 0.1 * p, 0, points, NU))


def test_equivalent_principal_and_shear_stresses():
    """Uniaxial tension, pure shear and hydrostatic pressure have the textbook equivalents."""
    states = np.array([[5.0, 0, 0, 0, 0, 0], [0, 0, 0, 2.0, 0, 0], [-3.0, -3.0, -3.0, 0, 0, 0], [0, 0, 0, 0, 0, 4.0]])
    assert np.allclose(stress.von_mises(states), [5, 2 * np.sqrt(3), 0, 4 * np.sqrt(3)])
    assert np.allclose(stress.principal_stresses(states)[1], [2, 0, -2])
    assert np.allclose(stress.max_shear(states), [2.5, 2, 0, 4])


@pytest.mark.parametrize(
    "change",
    [
        {"x": [0.0, 1.0, 3.0]},
        {"pressure": np.ones((2, 2))},
        {"points": [0.0, 0.0, -1e-3]},
        {"points": [0.0, 0.0]},
        {"poisson_ratio": 0.7},
        {"shear_lateral": np.full((3, 3), np.nan)},
    ],
)
def test_bad_input_is_named(change):
    """Each kind of bad input raises InputError naming its field."""
    good = dict(
        x=[0.0, 1.0, 2.0],
        y=[0.0, 1.0, 2.0],
        pressure=np.ones((3, 3)),
        shear_lateral=0.0,
        shear_rolling=0.0,
        points=[0.0, 0.0, 1.0],
    )
    with pytest.raises(InputError) as caught:
        stress.stress_from_tractions(**{**good, **change})
    assert next(iter(change)) in str(caught.value)
