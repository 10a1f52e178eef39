"""The derived kernels: same text again, same numbers as numerical differentiation, equilibrium, exact rectangles."""

import ast
import itertools
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

from trackroller.halfspace import kernels
from validation.derivations import kernel_writer, potentials
from validation.exact import stresses as reference

COMPONENTS = potentials.COMPONENTS
POINTS = [(0.7, -0.4, 0.5), (-0.3, 0.2, 1.5), (1e-3, 2e-3, 0.8), (0.9, 0.6, 0.02), (-0.5, -0.8, 0.3)]


def _numerical_stress(load: str, point, nu):
    """Return 2 pi sigma from Hooke's law (4) and the displacements (5), differentiated numerically in 50 digits."""

    def omega(x, y, z):
        r = mp.sqrt(x * x + y * y + z * z)
        return z * mp.log(r + z) - r

    def d(orders, x, y, z):
        return mp.diff(omega, (x, y, z), orders)

    def along(*names):
        return tuple(names.count(axis) for axis in "xyz")

    def displacement(i):
        def u(x, y, z):
            value = 2 * nu * d(along(load, i), x, y, z) - z * d(along(load, "z", i), x, y, z)
            if i == "z":  # the third component is written with (1 - 2 nu)
                value = (1 - 2 * nu) * d(along(load, "z"), x, y, z) - z * d(along(load, "z", "z"), x, y, z)
            if i == load:
                value += (1 if i == "z" else 2) * d((0, 0, 2), x, y, z)
            if load == "z" != i:
                value -= d(along("z", i), x, y, z)
            return value

        return u

    gradient = {(i, j): mp.diff(displacement(i), point, along(j)) for i in "xyz" for j in "xyz"}
    dilatation = sum(gradient[i, i] for i in "xyz")
    return [
        (gradient[i, j] + gradient[j, i]) / 2 + (nu / (1 - 2 * nu) * dilatation if i == j else 0) for i, j in COMPONENTS
    ]


@pytest.mark.slow
def test_regeneration_gives_the_same_file():
    """`kernels.py` is what the derivation writes today (up to the formatter's white space)."""
    written = ast.parse(Path(kernels.__file__).read_text(encoding="utf-8"))
    assert ast.dump(written) == ast.dump(ast.parse(kernel_writer.module_source()))


def test_double_antiderivative_gives_omega_back_numerically():
    """d4W/dx2dy2 = z ln(R + z) - R, W evaluated from its definition and differentiated in 40 digits."""
    w = potentials.double_antiderivative().as_expr()

    def value(x, y, z):
        r = mp.sqrt(x * x + y * y + z * z)
        names = {
            "x": x,
            "y": y,
            "z": z,
            "R": r,
            "Lx": mp.asinh(x / mp.sqrt(y * y + z * z)),
            "Ly": mp.asinh(y / mp.sqrt(x * x + z * z)),
            "Lz": mp.log(r + z),
            "Ax": mp.atan2(x * y * (r - z), x * x * r + y * y * z),
            "Ay": mp.atan2(x * y * (r - z), y * y * r + x * x * z),
        }
        total = mp.mpf(0)
        for term in w.as_ordered_terms():
            factor = mp.mpf(1)
            for base, power in term.as_powers_dict().items():
                number = mp.mpf(base.p) / base.q if base.is_Rational else names[str(base)]
                factor *= number ** int(power)
            total += factor
        return total

    with mp.workdps(40):
        for x, y, z in ((0.7, -0.4, 0.5), (-0.3, -0.9, 1.1)):
            r = mp.sqrt(mp.mpf(x) ** 2 + mp.mpf(y) ** 2 + mp.mpf(z) ** 2)
            found = mp.diff(value, (x, y, z), (2, 2, 0))
            assert abs(found - (z * mp.log(r + z) - r)) < 1e-12


@pytest.mark.parametrize("load", range(3))
@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_point_kernel_is_hookes_law_of_the_potentials(load, nu):
    """Kernels against eqs. (2)-(5) differentiated numerically with mpmath: derivation and code are right."""
    for point in POINTS[:2]:
        k = np.array(kernels.point_kernel(*point)).reshape(2, 3, 6)
        with mp.workdps(50):
            expected = _numerical_stress("xyz"[load], tuple(map(mp.mpf, point)), mp.mpf(nu))
            expected = np.array([float(e / (2 * mp.pi)) for e in expected])
        assert np.allclose(k[0, load] + nu * k[1, load], expected, rtol=1e-11, atol=1e-12)


def test_splitting_has_no_poisson_part_where_theory_has_none():
    """B vanishes for sigma_z, tau_yz and tau_xz of every load and kernel: A + nu B is a true splitting."""
    for name in potentials.KERNELS:
        k = np.array(getattr(kernels, name)(0.3, -0.7, 0.4)).reshape(2, 3, 6)
        assert np.all(k[1][:, [2, 4, 5]] == 0.0)
        assert np.all(np.any(k[1] != 0.0, axis=1))


def _divergence(function, point, scale):
    step = 1e-4 * scale
    gradient = np.zeros((3, 2, 3, 6))
    for axis in range(3):
        for shift, weight in ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12)):
            at = np.array(point)
            at[axis] += shift * step
            gradient[axis] += weight / step * np.array(function(*at)).reshape(2, 3, 6)
    rows = [[0, 3, 5], [3, 1, 4], [5, 4, 2]]
    return sum(gradient[axis][..., [rows[i][axis] for i in range(3)]] for axis in range(3)), gradient


def test_point_kernel_is_in_equilibrium():
    """div sigma = 0 for A and for B alone, for each load."""
    for point in POINTS:
        scale = min(np.linalg.norm(point), 1.0) * point[2]
        div, gradient = _divergence(kernels.point_kernel, point, scale)
        assert np.abs(div).max() < 1e-8 * np.abs(gradient).max()


def rectangle(point, size, step=1e-3):
    """Return the stresses (2, 3, 6) below a uniform rectangle about the origin: d2/dxdy of the bilinear corner."""
    out = np.zeros(36)
    for sx, sy in itertools.product((-1, 1), repeat=2):  # corners
        for i, j in itertools.product((-1, 1), repeat=2):
            x, y = point[0] + sx * size[0] / 2 + i * step, point[1] + sy * size[1] / 2 + j * step
            out += sx * sy * i * j * np.array(kernels.bilinear_corner(x, y, point[2])) / (4 * step**2)
    return out.reshape(2, 3, 6)


def test_love_rectangle_below_its_corner_and_at_its_middle():
    """The second derivative of the bilinear corner function serves Love's rectangle."""
    nu = 0.3
    for z in (0.1, 1.0, 5.0):
        found = rectangle((1.0, 0.5, z), (2.0, 1.0))[0, 2, 2]
        assert 3.0 * found == pytest.approx(reference.rectangle_corner_sigma_z(z, 2.0, 1.0, 3.0), rel=1e-4)
    pressed, by_nu = rectangle((0.0, 0.0, 0.0), (2.0, 1.0))[:, 2]
    assert 3.0 * (pressed + nu * by_nu) == pytest.approx(reference.rectangle_centre(2.0, 1.0, 3.0, nu), abs=1e-4)


def test_bilinear_corner_is_the_integral_of_a_hat():
    """Second differences of the bilinear corner function against Gauss quadrature of a hat load, 9 corners."""
    nu, (x, y, z) = 0.4, (0.7, -0.4, 0.6)
    weights = np.array([1.0, -2.0, 1.0])
    k = sum(
        weights[i] * weights[j] * np.array(kernels.bilinear_corner(x - (i - 1), y - (j - 1), z))
        for i in range(3)
        for j in range(3)
    )
    g, w = np.polynomial.legendre.leggauss(40)
    expected = np.zeros(36)
    for side_x in (-1, 1):
        for side_y in (-1, 1):
            for xi, wx in zip(0.5 * (g + side_x), 0.5 * w, strict=True):
                for eta, wy in zip(0.5 * (g + side_y), 0.5 * w, strict=True):
                    hat = (1 - abs(xi)) * (1 - abs(eta)) * wx * wy
                    expected += hat * np.array(kernels.point_kernel(x - xi, y - eta, z))
    assert np.allclose(k[:18] + nu * k[18:], expected[:18] + nu * expected[18:], atol=1e-11)


def test_kernels_are_finite_everywhere_down_to_the_surface():
    """No NaN or infinity at z = 0, on the axes, on edges and at the corner itself."""
    for name in potentials.KERNELS:
        for point in (
            (0, 0, 0),
            (1, 0, 0),
            (0, -1, 0),
            (-2, 0, 0),
            (1, 1, 0),
            (0, 0, 1),
            (0, 0, 1e-300),
            (1e-200, 0, 0),
        ):
            values = np.array(getattr(kernels, name)(*map(float, point)))
            if name != "point_kernel" or max(map(abs, point)) > 1e-100:
                assert np.all(np.isfinite(values)), (name, point)


def test_surface_is_the_right_limit():
    """The corner function at z = 1e-9 goes over into that at z = 0, off the edges."""
    function = kernels.bilinear_corner
    for x, y in ((0.5, 0.8), (-0.4, 0.3), (1.5, -0.2), (-0.1, -0.9)):
        assert np.allclose(function(x, y, 1e-9), function(x, y, 0.0), atol=1e-7)
