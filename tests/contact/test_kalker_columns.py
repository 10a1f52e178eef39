"""The preconditioner of the tangential problem against dense systems."""

import numpy as np
import pytest

from trackroller.contact.kalker import columns


@pytest.mark.parametrize(("ny", "nx"), [(6, 5), (9, 8)])
def test_each_column_is_solved_as_its_own_dense_system(ny, nx):
    """Columns of different lengths, one without load, share the lanes of a group."""
    rng = np.random.default_rng(3)
    height = np.zeros((ny, nx))
    for j in range(nx):
        height[j % 3 : ny - j % 2, j] = 1.0
    height[:, 2] = 0.0
    first, count = columns.column_ranges(height)
    slips = rng.normal(size=(2, 2 * ny - 1)) * 0.1
    slips[:, ny - 1] = 1.0
    projection, rho = rng.random((3, ny, nx)) * (height > 0), 1.3
    factors = columns.factors_of(ny, nx)
    columns.factorise(slips, projection, rho, first, count, factors)
    field = rng.normal(size=(ny, nx, 2))
    found = np.empty_like(field)
    columns.apply_inverse(factors, first, count, field, found)
    expected = field.copy()
    for j in range(nx):
        own = slice(first[j], first[j] + count[j])
        at = np.arange(count[j])
        for c in range(2):
            p = projection[2 * c, own, j]
            matrix = np.diag(1.0 - p) + rho * p[:, None] * slips[c, at[:, None] - at + ny - 1]
            expected[own, j, c] = np.linalg.solve(matrix, field[own, j, c])
    np.testing.assert_allclose(found, expected, atol=1e-12)
