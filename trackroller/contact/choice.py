"""Which contact model a case needs: the cheapest whose measured error keeps a tolerance (`contact_model="auto"`).

The error of `sliding` and `fastsim` against the exact theory was measured on random designs (benchmarks/
contact_choice.py). Its logarithm is a polynomial of second degree in what geometry, load, friction and drive make of a
case; the polynomial is raised until the stated share of designs that it was not fitted to lies below it. Compared are:

- the normal forces, relative,
- lateral and driving force over F_N, and the spin moment over F_N sqrt(a b), of each contact,
- the peak stress of each contact and body, relative.

Small friction forces may thus be off by much more than the tolerance of themselves, and life, which goes with the k-th
power of stress, by about k times. The map holds for a constant friction law, Hertzian patches and the skewed spin
pole; outside its range, and where the models need not even agree in their regime, the exact theory is taken.
"""

from __future__ import annotations

from functools import lru_cache
from importlib import resources
from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact.common import Elastic, Ellipse
from trackroller.contact.hertz import contact_modulus, exact_shape
from trackroller.contact.linear import creepage_coefficients
from trackroller.geometry import curvatures, rolling_radius

if TYPE_CHECKING:
    from trackroller.case import CaseTable
    from trackroller.solver import Options

MAP = "contact_choice.npz"
CHEAPER = ("sliding", "fastsim")  # cheapest first; then the exact theory
FEATURES = {
    "spin": "ln of the spin creepage over what friction bends, phi L G c^2 C11/(mu N) at the mean normal force",
    "friction": "ln of mu",
    "ellipticity": "ln of b/a",
    "angle": "ln of mu/tan(alpha), 0 at self-locking",
    "lift": "ln of 1 - |F_ax|/(axial force that would lift a contact off without friction), at least ln 0.02",
    "drive": "|F_Motor| over mu times the sum of the frictionless normal forces",
    "wedge": "mu/tan(alpha), at most 3",
    "arc": "ln of the half-width a over the radius of the guide's contour times sin(2 alpha)",
    "coupling": "asinh of K/mu",
}  # fmt: skip


def features(table: CaseTable) -> np.ndarray:
    """The numbers that the error depends on, shape (n, len(FEATURES)); NaN or inf without friction or patch."""
    alpha = np.deg2rad(table.contact_angle)
    sine, cosine, mu = np.sin(alpha), np.cos(alpha), table.friction_coefficient
    r_a = rolling_radius(table.axis_distance, table.guide_profile_radius, alpha)
    k_x, k_y = curvatures(table.roller_profile_radius, table.guide_profile_radius, table.guide_curve_radius, r_a, alpha)
    bodies = (table.roller.youngs_modulus, table.roller.poisson_ratio,
              table.guide.youngs_modulus, table.guide.poisson_ratio)  # fmt: skip
    elastic = Elastic.of_pair(*bodies)
    with np.errstate(divide="ignore", invalid="ignore"):
        normal = np.abs(table.radial_force) / (2.0 * cosine)
        patch: Ellipse = exact_shape(k_x, k_y, contact_modulus(*bodies)).at(normal)
        a, b = patch.semi_axis_lateral, patch.semi_axis_rolling
        g, square = b / a, a * b
        c11 = creepage_coefficients(np.clip(np.nan_to_num(g, nan=1.0), 0.02, 50.0), elastic.poisson_ratio).c11
        arm = np.sqrt(square * (g + 1.0 / g)) / 2.0
        spin = sine / r_a * arm * elastic.shear_modulus * square * c11 / (mu * normal)
        wedge = mu / np.tan(alpha)
        axial = np.abs(table.axial_force) * cosine / (np.abs(table.radial_force) * sine)
        return np.stack([
            np.log(spin), np.log(mu), np.log(g), np.log(wedge), np.log(np.maximum(1.0 - axial, 0.02)),
            np.abs(table.motor_force) / (mu * 2.0 * normal), np.minimum(wedge, 3.0),
            np.log(a / (table.guide_profile_radius * np.sin(2.0 * alpha))), np.arcsinh(elastic.coupling / mu),
        ], axis=1)  # fmt: skip


def monomials(x: np.ndarray) -> np.ndarray:
    """1, x_i and x_i x_j of scaled features (n, k); shape (n, 1 + k + k (k + 1)/2)."""
    n, k = x.shape
    pairs = [x[:, i] * x[:, j] for i in range(k) for j in range(i, k)]
    return np.stack([np.ones(n), *x.T, *pairs], axis=1)


@lru_cache(maxsize=1)
def stored() -> dict[str, np.ndarray]:
    """The measured map: scales of the features, range, coefficients by model and the margin that covers."""
    path = resources.files("trackroller").joinpath("data", MAP)
    with resources.as_file(path) as file, np.load(file, allow_pickle=False) as f:
        return {name: f[name] for name in f.files}


def scaled(x: np.ndarray, centre: np.ndarray, width: np.ndarray) -> np.ndarray:
    """Features of mean 0 and spread 1 over the designs of the map."""
    return (x - centre) / width


def expected_errors(table: CaseTable) -> np.ndarray:
    """Error that the stated share of designs stays below, shape (n, len(CHEAPER)); inf outside the map's range."""
    m = stored()
    x = features(table)
    inside = np.all(np.isfinite(x) & (x >= m["lower"]) & (x <= m["upper"]), axis=1)
    x = scaled(np.where(inside[:, None], x, m["centre"]), m["centre"], m["width"])
    with np.errstate(over="ignore"):
        error = np.exp(monomials(x) @ m["coefficients"] + m["margin"])
    return np.where(inside[:, None], error, np.inf)


def choose(table: CaseTable, options: Options) -> np.ndarray:
    """Name of the contact model of each case, object array (n,).

    Parameters
    ----------
    table : cases
    options : with `contact_tolerance`, what the errors named above may reach

    The choice for a case depends on nothing but the case and the tolerance.
    """
    error = expected_errors(table)
    unknown = (table.friction_law != "") | (table.guide_profile != "") | (table.roller_profile != "")
    if options.normal != "hertz" or options.hertz != "exact":
        unknown[:] = True
    model = np.full(len(table), "kalker", dtype=object)
    for k in reversed(range(len(CHEAPER))):
        good = (error[:, k] <= options.contact_tolerance) & ~unknown
        if CHEAPER[k] == "sliding":
            good &= options.spin_model == "skewed"
        model[good] = CHEAPER[k]
    return model
