"""Which contact model a case needs: the cheapest whose measured error keeps a tolerance (`contact_model="auto"`).

Compared with the exact theory are

- the normal forces, relative,
- lateral and driving force over F_N, and the spin moment over F_N sqrt(a b), of each contact,
- the peak stress of each contact and body, relative.

The error of the forces is measured case by case, against the table of exact results (`choice_probe`), and raised by
what the table may be off itself. The error of the peak stress cannot be had so cheaply: its logarithm is a polynomial
of second degree in that difference of the forces and in what geometry, friction and slip make of a case, raised until
the stated share of random designs that it was not fitted to lies below it (validation/benchmarks/contact_choice.py).

Small friction forces may be off by much more than the tolerance of themselves, and life, which goes with the k-th power
of stress, by about k times. All this holds for a constant friction law, Hertzian patches and the skewed spin pole;
outside the range of the designs, and where the models differ in their regime, the exact theory is taken. So it is
where the solution of full sliding says itself that it may be off by more (`in_doubt`).
"""

from __future__ import annotations

from functools import lru_cache
from importlib import resources
from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact.common import Elastic, Ellipse
from trackroller.contact.hertz import contact_modulus, exact_shape
from trackroller.contact.linear import creepage_coefficients
from trackroller.contact.table import LARGEST_COUPLING
from trackroller.parameters import CONTACT_MODELS
from trackroller.roller.choice.probe import Probe, force_error, probe
from trackroller.roller.equilibrium import ROLLING
from trackroller.roller.geometry import contact_geometry
from trackroller.roller.stages.case import split_pole
from trackroller.roller.stages.models import bodies

if TYPE_CHECKING:
    from trackroller.roller.blocks import Block
    from trackroller.roller.case import CaseTable
    from trackroller.roller.options import Options

MAP = "contact_choice.npz"
CHEAPER = ("sliding", "fastsim")  # cheapest first; then the exact theory
SMALLEST, LARGEST = 1e-5, 3.0  # of a difference that is worth telling apart
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
}
PEAK_FEATURES = ("spin", "friction", "ellipticity", "angle", "arc", "coupling")  # of them, for the peak stress


def features(table: CaseTable) -> np.ndarray:
    """The numbers that the error depends on, shape (n, len(FEATURES)); NaN or inf without friction or patch."""
    alpha, r_a, k_x, k_y = contact_geometry(vars(table))
    sine, cosine, mu = np.sin(alpha), np.cos(alpha), table.friction_coefficient
    elastic = Elastic.of_pair(*bodies(table))
    with np.errstate(divide="ignore", invalid="ignore"):
        normal = np.abs(table.radial_force) / (2.0 * cosine)
        patch: Ellipse = exact_shape(k_x, k_y, contact_modulus(*bodies(table))).at(normal)
        a, b = patch.semi_axis_lateral, patch.semi_axis_rolling
        g, square = b / a, a * b
        c11 = creepage_coefficients(np.clip(np.nan_to_num(g, nan=1.0), 0.02, 50.0), elastic.poisson_ratio).c11
        arm = np.sqrt(square * (g + 1.0 / g)) / 2.0
        spin = sine / r_a * arm * elastic.shear_modulus * square * c11 / (mu * normal)
        wedge = mu / np.tan(alpha)
        axial = np.abs(table.axial_force) * cosine / (np.abs(table.radial_force) * sine)
        return np.stack(
            [
                np.log(spin),
                np.log(mu),
                np.log(g),
                np.log(wedge),
                np.log(np.maximum(1.0 - axial, 0.02)),
                np.abs(table.motor_force) / (mu * 2.0 * normal),
                np.minimum(wedge, 3.0),
                np.log(a / (table.guide_profile_radius * np.sin(2.0 * alpha))),
                np.arcsinh(elastic.coupling / mu),
            ],
            axis=1,
        )


def monomials(x: np.ndarray) -> np.ndarray:
    """1, x_i and x_i x_j of scaled features (n, k); shape (n, 1 + k + k (k + 1)/2)."""
    n, k = x.shape
    pairs = [x[:, i] * x[:, j] for i in range(k) for j in range(i, k)]
    return np.stack([np.ones(n), *x.T, *pairs], axis=1)


@lru_cache(maxsize=1)
def stored() -> dict[str, np.ndarray]:
    """The measured map: range and scales of the features, coefficients by model and the margins that cover."""
    path = resources.files("trackroller.roller.choice").joinpath(MAP)
    with resources.as_file(path) as file, np.load(file, allow_pickle=False) as f:
        return {name: f[name] for name in f.files}


def peak_features(x: np.ndarray, numbers: np.ndarray, force: np.ndarray) -> np.ndarray:
    """What the error of the peak stress depends on, shape (n, 10), from `features`, `Probe.numbers` and the forces."""
    names = list(FEATURES)
    own = x[:, [names.index(name) for name in PEAK_FEATURES]]
    return np.column_stack([own, numbers, np.log(np.clip(force, SMALLEST, LARGEST))])


def beyond_table(x: np.ndarray) -> np.ndarray:
    """Which of the cases with `features` x have materials more unlike than the table holds, (n,)."""
    return np.abs(np.sinh(x[:, list(FEATURES).index("coupling")])) > LARGEST_COUPLING


def expected_errors(x: np.ndarray, exact: Probe, force: np.ndarray, model: int) -> np.ndarray:
    """Error that the stated share of designs stays below, shape (n,); inf outside the map's range.

    Parameters
    ----------
    x : `features` of n cases
    exact : their solution by the table
    force : difference of the forces from it, (n,); 0 in full slip and lift-off, where all models are one
    model : number in `CHEAPER`
    """
    m = stored()
    known = in_range(x, m) & exact.rolls & np.isfinite(force)
    z = peak_features(x, exact.numbers(), force)
    z = np.where(known[:, None], (z - m["centre"][model]) / m["width"][model], 0.0)
    with np.errstate(over="ignore"):
        peak = np.exp(monomials(z) @ m["coefficients"][model] + m["margin"][model])
    table_error = m["table_error"][model][beyond_table(x).astype(int)]
    rolling = np.maximum(peak, m["factor"][model] * force + table_error * exact.friction)
    return np.where(known, rolling, np.where(exact.rolls, np.inf, force))


def in_range(x: np.ndarray, m: dict[str, np.ndarray]) -> np.ndarray:
    """Which cases lie within the range of the rolling designs of a map, (n,)."""
    return np.all((x >= m["lower"]) & (x <= m["upper"]), axis=1)


def measured_errors(table: CaseTable, options: Options, enough: float = 0.0) -> np.ndarray:
    """Error of each cheaper model, shape (n, len(CHEAPER)); inf where nothing was measured.

    `enough`: dearer models are not tried where a cheaper one has no larger error. It takes 1 ms a case, and where
    FASTSIM is tried as long as it takes for the forces at `preview`, 16 ms.
    """
    error = np.full((len(table), len(CHEAPER)), np.inf)
    if options.normal != "hertz" or options.hertz != "exact" or options.slip_terms:
        return error
    drawn = (table.friction_law != "") | (table.guide_profile != "") | (table.roller_profile != "")
    error[~drawn & (table.friction_coefficient == 0.0)] = 0.0  # without friction all are one
    x = features(table)
    rows = np.flatnonzero(~drawn & np.all(np.isfinite(x), axis=1))
    if not rows.size:
        return error
    exact, kept = probe(table.take(rows), options), np.arange(rows.size)
    measured = exact.rolls & in_range(x[rows], stored())
    kept = kept[measured | ~exact.rolls]
    for k, name in enumerate(CHEAPER):
        if (name == "sliding" and options.spin_model != "skewed") or (name == "fastsim" and _by_table(options)):
            continue
        own = table.take(rows[kept])
        force = force_error(own, options, name, exact.take(kept))
        found = expected_errors(x[rows[kept]], exact.take(kept), force, k)
        error[rows[kept], k] = found
        kept = kept[~(found <= enough) & measured[kept]]
        if not kept.size:
            break
    return error


def _by_table(options: Options) -> bool:
    """Is the exact theory cheaper than FASTSIM? Where its table gives all that is asked for.

    ASSUME: materials as like as the table holds them; with others `kalker` at `preview` is the dearer, not the worse.
    """
    return options.settings.name == "preview" and not {*options.outputs} & {
        "peak_stress",
        "life",
        "tractions",
        "subsurface",
    }


def choose(table: CaseTable, options: Options) -> np.ndarray:
    """Name of the contact model of each case, object array (n,).

    Parameters
    ----------
    table : cases
    options : with `contact_tolerance`, what the errors named above may reach

    The choice for a case depends on nothing but the case and the tolerance.
    """
    return cheapest(measured_errors(table, options, options.contact_tolerance), options.contact_tolerance)


def in_doubt(table: CaseTable, block: Block, tolerance: float) -> np.ndarray:
    """Rows of solved cases where full sliding has an infinite or badly known peak stress, to be solved exactly.

    That is where the slip of the sliding model vanishes apart from its spin pole, and where the estimate of the peak's
    error exceeds the tolerance. (That of FASTSIM tells of its elements, which the exact theory has as well.)
    """
    v = block.values
    doubt = split_pole(table, v)
    if "error_estimate" in v:
        with np.errstate(invalid="ignore"):
            doubt |= np.any(v["error_estimate"] > tolerance, axis=(1, 2))
    sliding = (block.model == CONTACT_MODELS.index("sliding")) & (table.friction_coefficient > 0)
    return np.flatnonzero(doubt & sliding & (block.regime == ROLLING))


def cheapest(error: np.ndarray, tolerance: float) -> np.ndarray:
    """Name of the cheapest model within the tolerance, object array (n,), from errors (n, len(CHEAPER))."""
    model = np.full(len(error), "kalker", dtype=object)
    for k in reversed(range(len(CHEAPER))):
        model[error[:, k] <= tolerance] = CHEAPER[k]
    return model
