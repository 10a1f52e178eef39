"""Check what must hold at the ends of the parameters; a check gives the largest deviation of a scene and its place."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.contact.rollers import converged_up_to
from trackroller.roller.dataset import validity_bit
from trackroller.roller.solver import solve
from validation.extremes.scenes import FORCES, Scene, mirrored, scaled
from validation.extremes.search import located

if TYPE_CHECKING:
    import xarray as xr

EPS = float(np.finfo(float).eps)
ROLLING, FULL_SLIP, LIFT_OFF, FAILED = range(4)
OUTPUTS = ("forces", "contact", "peak_stress", "life")
NEEDED = (
    "normal_force",
    "lateral_force",
    "driving_force",
    "spin_moment",
    "semi_axis_lateral",
    "semi_axis_rolling",
    "max_pressure",
    "peak_stress",
    "error_estimate",
    "life_cycles",
)
COMPARED = {"normal_force": (2, 1), "max_pressure": (0, 1), "peak_stress": (0, 1), "transmitted_force": (2, 1)}
TURNED = ("lateral_force", "spin_moment", "spin_pole_lateral")
# tolerances by contact model of the difference of two solutions: exact sums, or patches solved by iteration on a grid,
# whose forces balance within 1e-4 in each solution
NUMERICAL = {"sliding": 1e-7, "kalker": 2e-4}


@dataclass(frozen=True)
class Finding:
    """Largest deviation of a check on a scene, its tolerance, and the value of the quantity where it occurs."""

    check: str
    deviation: float
    tolerance: float
    where: float

    @property
    def holds(self) -> bool:
        """Return True if the claim holds."""
        return bool(self.deviation <= self.tolerance)


@dataclass
class Run:
    """A scene solved with one contact model."""

    scene: Scene
    model: str
    accuracy: str
    result: xr.Dataset
    warned: int

    def again(self, cases: list[Any]) -> xr.Dataset:
        """Solve other cases in the same way."""
        return run_cases(cases, self.model, self.accuracy)[0]

    def regime(self) -> np.ndarray:
        """Return the regime of each case (n,)."""
        return np.asarray(self.result.regime.values)


def run_cases(cases: Any, model: str, accuracy: str) -> tuple[xr.Dataset, int]:
    """Return the result and the number of warnings."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = solve(list(cases), OUTPUTS, contact_model=model, accuracy=accuracy)
    return result, sum(issubclass(w.category, RuntimeWarning) for w in caught)


def run_scene(scene: Scene, model: str, accuracy: str) -> Run:
    """Solve the scene."""
    scene = located(scene, model, accuracy)
    result, warned = run_cases(scene.cases, model, accuracy)
    return Run(scene, model, accuracy, result, warned)


def _worst(run: Run, check: str, deviation: np.ndarray, tolerance: float) -> Finding:
    deviation = np.nan_to_num(np.asarray(deviation, float), nan=0.0, posinf=np.inf)
    i = int(np.argmax(deviation)) if deviation.size else 0
    values = run.scene.values
    return Finding(check, float(deviation[i]) if deviation.size else 0.0, tolerance, values[min(i, len(values) - 1)])


def missing(ds: xr.Dataset, name: str) -> np.ndarray:
    """Return where numbers of a result are undefined that ought to be there, (n, m): where both contacts carry.

    A skidding roller and a body above its tensile strength have no fatigue life.
    """
    values, regime = ds[name].transpose("case", ...), ds["regime"].values
    due = np.broadcast_to((regime <= FULL_SLIP).reshape(-1, *(1,) * (values.ndim - 1)), values.shape)
    if name == "life_cycles":
        lasts = (ds["validity_body"].transpose("case", "body").values & validity_bit("static")) == 0
        due = due & (lasts & (regime == ROLLING)[:, None])[:, None, :]
    return _rows(np.isnan(values.values) & due)


def _rows(values: np.ndarray) -> np.ndarray:
    return values.reshape(len(values), -1)


def finite(run: Run) -> Finding:
    """Return the share of undefined numbers where both contacts carry; each warning counts as one."""
    bad = np.mean([missing(run.result, name).mean(axis=1) for name in NEEDED], axis=0)
    return _worst(run, "finite", bad + run.warned, 0.0)


def solved(run: Run) -> Finding:
    """Return the cases without a solution whose regime is not lift-off."""
    return _worst(run, "solved", (run.regime() == FAILED).astype(float), float(run.model in run.scene.reach))


def residual(run: Run) -> Finding:
    """Return the relative residual of the equilibrium."""
    values = np.where(run.regime() == ROLLING, run.result.residual.values, 0.0)
    return _worst(run, "residual", values, converged_up_to(run.model, "hertz"))


def _difference(run: Run, other: xr.Dataset, length: float, modulus: float, mirror: bool) -> np.ndarray:
    """Return the largest relative difference of each case; another regime counts as infinite."""
    worst = np.zeros(len(run.scene.cases))
    both = (run.regime() <= FULL_SLIP) & (other.regime.values <= FULL_SLIP)
    for name, (p, q) in COMPARED.items():
        x, y = _rows(run.result[name].values), other[name].values / (length**p * modulus**q)
        if mirror and y.ndim > 1:
            y = y[:, ::-1]
        y = _rows(y)
        scale = np.max(np.abs(x), axis=1, initial=0.0)
        if name == "transmitted_force":  # measured against what friction can give
            scale = np.nansum(
                run.result.max_shear.values
                / np.maximum(run.result.max_pressure.values, 1e-300)
                * run.result.normal_force.values,
                axis=1,
            )
        gap = np.max(np.abs(x - y), axis=1)
        if name == "peak_stress":  # differences within the error estimates of both searches do not count
            known = np.nanmax(
                _rows(run.result.error_estimate.values) + _rows(other.error_estimate.values), axis=1, initial=0.0
            )
            gap = np.maximum(gap - known * scale, 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            worst = np.fmax(worst, np.where(both & (gap > 0), gap / scale, 0.0))
    return np.where(run.regime() == other.regime.values, worst, np.inf)


def scaling(run: Run) -> Finding:
    """Return the change of the results when the units change: lengths x 7.3, stresses x 0.37, forces accordingly."""
    other = run.again([scaled(c, 7.3, 0.37) for c in run.scene.cases])
    deviation = _difference(run, other, 7.3, 0.37, False)
    return _worst(run, "scaling", deviation, NUMERICAL[run.model])


def mirror(run: Run) -> Finding:
    """Return the change of the results when the axial force turns and the contacts swap."""
    other = run.again([mirrored(c) for c in run.scene.cases])
    return _worst(run, "mirror", _difference(run, other, 1.0, 1.0, True), NUMERICAL[run.model])


def condition(run: Run) -> Finding:
    """Return the condition number of the normal forces: their relative change over that of loads and friction."""
    step, worst = 1e-6 if run.model == "sliding" else 1e-3, np.zeros(len(run.scene.cases))
    base = run.result.normal_force.values
    for name in (*FORCES, "friction_coefficient"):
        grown = [c | {name: c[name] * (1 - step)} for c in run.scene.cases]
        other = solve(grown, "forces", contact_model=run.model, accuracy=run.accuracy)
        gap = np.max(np.abs(other.normal_force.values - base), axis=1) / np.max(base, axis=1)
        worst = np.fmax(worst, gap / step)
    return _worst(run, "condition", worst, 1e8)


def _quantity(run: Run, name: str) -> np.ndarray:
    if name == "max_shear_sum":
        return np.sum(run.result.max_shear.values, axis=1)[:, None]
    return _rows(run.result[name].values)


def monotone(run: Run) -> Finding:
    """Return the largest relative step in the wrong direction."""
    worst = np.zeros(len(run.scene.cases))
    for names, sign in ((run.scene.rising, 1.0), (run.scene.falling, -1.0)):
        for name in names:
            values = _quantity(run, name)
            known = np.flatnonzero(np.isfinite(values).all(axis=1))
            steps = sign * np.diff(values[known], axis=0)
            scale = np.maximum(np.abs(values[known][1:]), np.abs(values[known][:-1])) + 1e-300
            worst[known[1:]] = np.fmax(worst[known[1:]], np.max(-steps / scale, axis=1))
    return _worst(run, "monotone", np.maximum(worst, 0.0), 10 * NUMERICAL[run.model])


def constant(run: Run) -> Finding:
    """Return the largest relative change of a quantity that must be constant along the series."""
    worst = np.zeros(len(run.scene.cases))
    for name in run.scene.constant:
        values = _quantity(run, name)
        worst = np.fmax(worst, np.max(np.abs(values / values[-1] - 1), axis=1))
    return _worst(run, "constant", worst, NUMERICAL[run.model])


def border(run: Run) -> Finding:
    """Return the jump between the nearest cases on both sides of a border of regimes.

    Into full slip: normal forces, peak stress and transmitted force. Into lift-off: the load of the contact that
    leaves, over the other's. Infinite unless all cases below are of one regime and all above of another.
    """
    below, above = len(run.scene.cases) - 2, len(run.scene.cases) - 1
    regimes = run.regime()
    jumps = np.zeros(len(regimes))
    if regimes[below] == regimes[above] or len({*regimes[0::2]}) > 1 or len({*regimes[1::2]}) > 1:
        jumps[above] = np.inf
    elif regimes[above] == LIFT_OFF:
        n = run.result.normal_force.values[below]
        jumps[above] = np.min(n) / np.max(n)
    else:
        for name in ("normal_force", "peak_stress", "transmitted_force"):
            x = _rows(run.result[name].values)
            jumps[above] = max(jumps[above], np.max(np.abs(x[above] / x[below] - 1)))
    return _worst(run, "border", jumps, 5e-3)


def limit(run: Run) -> Finding:
    """Return the difference between the last case and the one before, which tends to it.

    Differences are relative; that of the spin pole is over the semi-axis, or over its distance if it is outside.
    """
    gaps, ds = np.zeros(len(run.scene.cases)), run.result
    pole = (ds["spin_pole_lateral"] / ds["semi_axis_lateral"]).values
    for name in ("normal_force", "max_pressure", "peak_stress", "pole"):
        x = _rows(pole if name == "pole" else ds[name].values)
        scale = max(float(np.max(np.abs(x[-1]))), 1.0 if name == "pole" else 0.0)
        known = 2.0 * np.max(ds["error_estimate"].values[-1]) if name == "peak_stress" else 0.0
        gaps[-1] = max(gaps[-1], np.max(np.abs(x[-1] - x[-2])) / (scale or 1.0) - known)
    return _worst(run, "limit", gaps, 1e-6 if run.model == "sliding" else 1e-3)


def close(run: Run) -> Finding:
    """Return the relative change of normal forces and peak stress between neighbours closer than 1e-4."""
    near = np.flatnonzero(np.abs(np.diff(run.scene.values)) < 1e-4)
    gaps = np.zeros(len(run.scene.cases))
    for name in ("normal_force", "peak_stress"):
        x = _rows(run.result[name].values)
        gaps[near + 1] = np.fmax(gaps[near + 1], np.max(np.abs(x[near + 1] / x[near] - 1), axis=1))
    return _worst(run, "close", gaps, 5e-3)


def estimate(run: Run) -> Finding:
    """Return the difference of the peaks from `reference` over the estimated errors of both."""
    fine, _ = run_cases(run.scene.cases, run.model, "reference")
    x, y = _rows(run.result.peak_stress.values), _rows(fine.peak_stress.values)
    promised = _rows(run.result.error_estimate.values) + _rows(fine.error_estimate.values)
    with np.errstate(invalid="ignore"):
        return _worst(run, "estimate", np.max(np.abs(x / y - 1) / promised, axis=1), 1.0)


CHECKS: dict[str, Callable[[Run], Finding]] = {
    f.__name__: f
    for f in (finite, solved, residual, scaling, mirror, condition, monotone, constant, border, limit, close, estimate)
}


def examine(scene: Scene, model: str, accuracy: str) -> tuple[Run, list[Finding]]:
    """Solve the scene and check every claim on it; the error estimate is checked for the sliding model only."""
    run = run_scene(scene, model, accuracy)
    claims = (*scene.claims, "estimate") if model == "sliding" and accuracy == "standard" else scene.claims
    return run, [CHECKS[name](run) for name in claims]
