"""Influence functions and their fast products against definitions."""

import numpy as np
import pytest
from scipy.integrate import dblquad

from trackroller.contact import influence
from trackroller.contact.kalker.cells import unit_cells
from trackroller.contact.kalker.newton import Problem, newton, room_for

NU = 0.31


@pytest.mark.parametrize("offset", [(2, 1), (-3, 2), (0, 4)])
def test_influence_numbers_are_the_integrals_of_cerruti_and_boussinesq(offset):
    """Elements away from the point, where plain quadrature of the kernels of Kalker (1990) converges."""
    hx, hy, n = 0.3, 0.2, 6
    i, j = offset
    u = influence.displacements(hx, hy, NU, n, n, 0, 0)[:, j + n - 1, i + n - 1]
    v = influence.pressure_displacements(hx, hy, n, n, 0, 0)[:, j + n - 1, i + n - 1]
    kernels = (
        lambda y, x: (1 - NU) / np.hypot(x, y) + NU * x**2 / np.hypot(x, y) ** 3,
        lambda y, x: (1 - NU) / np.hypot(x, y) + NU * y**2 / np.hypot(x, y) ** 3,
        lambda y, x: NU * x * y / np.hypot(x, y) ** 3,
        lambda y, x: -x / (x * x + y * y),
        lambda y, x: -y / (x * x + y * y),
    )
    for value, kernel in zip([*u, *v], kernels, strict=True):
        exact = dblquad(kernel, (i - 0.5) * hx, (i + 0.5) * hx, (j - 0.5) * hy, (j + 0.5) * hy)[0] / np.pi
        assert value == pytest.approx(exact, rel=1e-8, abs=1e-12)


def test_fast_product_equals_the_sum_over_elements():
    ny, nx, hx, hy = 9, 7, 0.11, 0.07
    rng = np.random.default_rng(5)
    field = rng.normal(size=(2, ny, nx))
    moved = influence.influence(hx, hy, NU, ny, nx, rolling=False).product(field[0] + 1j * field[1])
    slip = influence.influence(hx, hy, NU, ny, nx).product(field[0] + 1j * field[1])
    u = influence.displacements(hx, hy, NU, ny, nx, 1, 2)
    for row, column in ((0, 0), (4, 6), (ny - 1, 3)):
        j = row + ny - 1 - np.arange(ny)[:, None]
        i = column + nx - 1 - np.arange(nx)[None, :]
        halo = []
        for k in range(4):
            xx, yy, xy = u[:, j + k, i]
            halo.append((xx * field[0] + xy * field[1]).sum() + 1j * (xy * field[0] + yy * field[1]).sum())
        assert moved[row, column] == pytest.approx(halo[1], abs=1e-12)
        assert slip[row, column] == pytest.approx(influence.difference(*halo, hy), abs=1e-12)


def shift_of_carter(elements, share, sharpened):
    """Return how far the computed end of the adhesion area lies ahead of Carter's (1926), in elements.

    It is the mean over ten positions of the elements against the contact. Rolling in plane strain (Johnson 1985,
    section 8.3): the half length of the contact is 1, the creepage 2 (1 - nu) (1 - c) mu p0/G. A part of length 2 c
    from the leading edge on adheres; c is `share`. The rest slides.
    """
    h, shifts = 2.0 / elements, []
    line = influence.influence(1e4, h, NU, elements + 1, 1, sharpened=sharpened)  # wide elements: plane strain
    u = influence.displacements(1e4, h, NU, 4, 2, 0, 0)
    here, ahead, far = (influence._sharpened(u) if sharpened else u[:, 1:-1, 1:-1])[1, 2:, 0]
    # slip of an element along the line by its own traction; `line.own` is the mean of this slip and the lateral one
    own = (1.5 * here - 2.0 * ahead + 0.5 * far) / h
    # Sharpening also subtracts the second difference across the line. The line has no neighbours there, so that its
    # influence grows by this factor.
    wide = 1.0 + 2.0 * influence.SHARPER * sharpened
    for phase in np.arange(10) / 10:
        y = h * (np.arange(elements + 1) + 0.5 - phase) - 1.0
        height = np.sqrt(np.maximum(1.0 - y * y, 0.0))[:, None]
        rigid = np.full(height.shape, -2.0j * wide * (1.0 - NU) * (1.0 - share))
        problem = Problem(line, rigid, height, 1.0, np.zeros(1), np.ones(1))
        (traction, slip), residual, *_ = newton(problem, room_for(*height.shape, 80), 0j * rigid, 1e-10, 60)
        assert residual <= 1e-10
        z = (traction.imag / np.maximum(height, 0.1) - slip.imag / (own * np.maximum(height, 0.1)))[:, 0]
        first = np.flatnonzero((z < 1.0) & (np.abs(y) < 0.9))[0]
        begins = y[first] - h * (1.0 - z[first]) / (z[first - 1] - z[first])
        shifts.append((begins - (1.0 - 2.0 * share)) / h)
    return np.mean(shifts)


@pytest.mark.long
@pytest.mark.parametrize("elements", [40, 160])
@pytest.mark.parametrize("share", [0.3, 0.4])
def test_sharpened_elements_see_where_sliding_begins_without_an_error_of_first_order(elements, share):
    """On 40 and 160 elements, constant tractions shift the end of the adhesion area by the same part of an element."""
    assert shift_of_carter(elements, share, sharpened=False) == pytest.approx(0.16, abs=0.02)
    assert abs(shift_of_carter(elements, share, sharpened=True)) < 0.03


def test_coupling_slip_of_a_hertzian_circle():
    """u_r of Hertz pressure on a circle: -(K/G) p0 (a^2/3r)(1 - (1 - r^2/a^2)^1.5) 2 (Johnson 1985, eq. 3.41b)."""
    n = 40
    height, _ = unit_cells(n, n)
    slip = influence.coupling_slip(np.array(height), 2 / n, 2 / n)
    x = (2 * np.arange(n) + 1) / n - 1
    xx, yy = np.meshgrid(x, x)

    def displacement(px, py):
        r2 = px**2 + py**2
        radial = -2 / 3 * (1 - (1 - r2) ** 1.5) / r2
        return radial * px, radial * py

    inside = xx**2 + yy**2 < 0.6
    px, py, step = xx[inside], yy[inside], 1e-5
    for component, found in ((0, slip.real), (1, slip.imag)):
        ahead, behind = (displacement(px, py + d)[component] for d in (step, -step))
        np.testing.assert_allclose(found[inside], -(ahead - behind) / (2 * step), atol=6e-3)


@pytest.mark.parametrize(("a", "b"), [(1.0, 1.0), (0.6, 1.7), (2.0, 0.3)])
def test_closed_form_of_the_slip_under_an_ellipse_is_the_limit_of_small_elements(a, b):
    """The difference to sums over elements falls with their size; the centre has 2 a/(a + b), as inside a layer."""
    off = []
    for n in (20, 80):
        height, _ = unit_cells(n, n)
        exact = influence.hertz_coupling_slip(a, b, n, n)
        found = influence.coupling_slip(np.array(height), 2 * a / n, 2 * b / n)
        off.append(np.abs(found - exact)[height > 0.3].max())
    assert off[1] < 0.25 * off[0] and off[1] < 0.02
    assert influence.hertz_coupling_slip(a, b, 9, 9)[4, 4] == pytest.approx(2j * a / (a + b), rel=1e-5)


def test_differences_are_exact_for_cubic_displacements():
    hy = 0.1
    y = hy * np.arange(-1, 7)
    u = y**3 - 1j * y**2
    slip = influence.difference(u[:-3], u[1:-2], u[2:-1], u[3:], hy)
    inner = y[1:6]
    np.testing.assert_allclose(slip, -(3 * inner**2) + 2j * inner, atol=1e-12)


def test_element_means_carry_the_load_and_area_of_the_patch():
    for ny, nx in ((20, 20), (40, 24)):
        height, share = unit_cells(ny, nx)
        cell = 4 / (nx * ny)
        assert height.sum() * cell == pytest.approx(2 * np.pi / 3, rel=1e-12)
        assert share.sum() * cell == pytest.approx(np.pi, rel=1e-12)
        assert np.all((share >= 0) & (share < 1.001))
        y, x = (2 * ny // 4, 2 * nx // 4)
        at_centre = np.sqrt(1 - ((2 * y + 1) / ny - 1) ** 2 - ((2 * x + 1) / nx - 1) ** 2)
        assert height[y, x] == pytest.approx(at_centre, rel=2e-3)
