"""Compare the preconditioner of the tangential problem with systems solved by NumPy."""

import numpy as np
import pytest

from trackroller.contact.kalker import newton as columns


def _derivative(height, rng):
    """Return a derivative of the friction law with sticking, sliding and unloaded elements."""
    angle, sticks = rng.uniform(-np.pi, np.pi, height.shape), rng.random(height.shape) < 0.4
    sticks[:, 0] = False  # a column that slides as a whole
    along = (sticks & (height > 0)).astype(np.float32)
    across = np.where(sticks, 1.0, rng.random(height.shape)) * (height > 0)
    return np.stack([along, across, np.cos(angle), np.sin(angle)]).astype(np.float32)


@pytest.mark.long
@pytest.mark.parametrize(("ny", "nx"), [(6, 5), (9, 8), (12, 21), (31, 11)])
def test_each_column_is_solved_as_its_own_system(ny, nx):
    """Columns of different lengths are solved side by side in one group; one column has no load.

    Elements further apart than `BAND` have no influence on each other.
    """
    rng = np.random.default_rng(3)
    height = np.zeros((ny, nx))
    for j in range(nx):
        height[j % 3 : ny - j % 2, j] = 1.0
    height[:, 2] = 0.0
    first, count = columns.column_ranges(height)
    slips = rng.normal(size=(2, 2 * ny - 1)) * 0.1
    slips[:, ny - 1] = 1.0
    derivative, rho = _derivative(height, rng), 1.3
    systems = columns.systems_for(ny, nx)
    groups = columns.factorise(slips, derivative, rho, first, count, systems)
    field = rng.normal(size=(ny, nx, 2)).astype(np.float32)
    found = np.empty_like(field)
    columns.apply_inverse(systems, groups, field, found)
    expected = np.zeros_like(field)
    along, across, c, s = derivative
    for weight, x, y in ((along, c, s), (across, -s, c)):
        part = x * field[:, :, 0] + y * field[:, :, 1]
        for j in range(nx):
            at = np.arange(ny)
            distance = at[:, None] - at + ny - 1
            own = x[:, j, None] * slips[0, distance] * x[:, j] + y[:, j, None] * slips[1, distance] * y[:, j]
            own[np.abs(at[:, None] - at) > columns.BAND] = 0.0
            w, solved, moves = weight[:, j, None], part[:, j].copy(), np.flatnonzero(weight[:, j])
            if moves.size:
                range_ = slice(moves[0], moves[-1] + 1)
                matrix = np.eye(ny) * (1.0 - w) + rho * w * own
                solved[range_] = np.linalg.solve(matrix[range_, range_], part[range_, j])
            expected[:, j] += solved[:, None] * np.stack([x[:, j], y[:, j]], axis=1)
    np.testing.assert_allclose(found, expected, atol=3e-6)
