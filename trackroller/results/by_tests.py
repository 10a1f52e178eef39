"""Band of the probability of targets by the tests of fitted materials (`material_scatter: fitted`).

Each draw from the posterior of a fitted line moves the lives of its material by the ratio of both lines at the stress
of the case, and gives the probability of a target. The band holds 90 % of the draws.

ASSUME: lives by fatigue move; other limits stay. The pair moves with its roller.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping

import numpy as np
import xarray as xr

from trackroller.errors import InputError, listing
from trackroller.fit.bench import check_same
from trackroller.fit.stored import StoredFit, stored_fit
from trackroller.results.results import SAME_ENDS, Results
from trackroller.results.targets import hits_of, scattering_body
from trackroller.study.outputs import outputs

DRAWS = 200
OF_FATIGUE = ("life_cycles", "life_hours", "roller_life_hours", "guide_life_hours", "pair_life_hours")
WANTED = "fitted"
DEVIATES = math.log(10.0)


def fits_of(results: Results) -> dict[str, StoredFit]:
    """Return the fits of the materials of a study by the names of the materials.

    Raises
    ------
    InputError
        If no material of the study was fitted, or the study has other options than a fit.
    """
    stored = json.loads(str(results.data.attrs.get("materials", "{}")))
    found = {name: fit for name, values in stored.items() if (fit := stored_fit(name, values)) is not None}
    if not found:
        allowed = "a study with a material that `trackroller fit` wrote"
        remedy = f"Fit {listing(list(stored), 'or')} to tests, or set material_scatter to true or a number."
        raise InputError("analysis.material_scatter", WANTED, allowed, remedy)
    for fit in found.values():
        check_same(fit.given, results.data.attrs, fit.name)
    return found


def bands(results: Results, deviations: Mapping[str, np.ndarray]) -> xr.Dataset:
    """Return the band of the probability of each target by the tests.

    Parameters
    ----------
    results : Results
        Solved study with targets and `material_scatter: fitted`.
    deviations : mapping of str to numpy.ndarray
        Standard deviation of log10 life of the material of each body [1], (n,).

    Returns
    -------
    xarray.Dataset
        `tests_low` and `tests_high` along `target`, over all cases; NaN for a target that is no life by fatigue. Their
        attributes `tests` and `materials` say how many tests the band rests on, and of which materials.
    """
    wanted, fits = results.config.analysis.target, fits_of(results)
    columns = outputs(
        results.data, results.design.factors, list(wanted), scale="natural", unlimited=True, allowed=results.valid
    )
    drawn = {name: _points(fit) for name, fit in fits.items()}
    found = []
    for column in columns:
        judged = results.judged_targets.get(column.name)
        sooner = judged is not None and bool((results.valid & (judged < column.values * (1 - SAME_ENDS))).any())
        if not column.name.startswith(OF_FATIGUE) or sooner:
            found.append((math.nan, math.nan))
            continue
        body = scattering_body(column.name)
        shift, scatter = _moved(results, body, fits, drawn, deviations.get(body))
        goal, shares = wanted[column.name], []
        for i in range(DRAWS):
            drawn_lives = dataclasses.replace(column, values=column.values * np.exp(shift[:, i]))
            shares.append(float(hits_of(drawn_lives, goal, scatter[:, i]).mean()))
        found.append(tuple(np.quantile(shares, (0.05, 0.95))))
    low, high = np.array(found, float).T
    words = {"units": "1", "long_name": "probability over all cases, 90 % by the tests"}
    words |= {"tests": str(sum(fit.rows for fit in fits.values())), "materials": listing(list(fits))}
    names = [column.name for column in columns]
    return xr.Dataset({"tests_low": ("target", low, words), "tests_high": ("target", high, words)}, {"target": names})


def _points(fit: StoredFit) -> np.ndarray:
    """Return points of the posterior of a fit, drawn by their weight."""
    weight = fit.posterior.weight
    return np.random.default_rng(1).choice(len(weight), DRAWS, p=weight)


def _moved(
    results: Results,
    body: str,
    fits: Mapping[str, StoredFit],
    drawn: Mapping[str, np.ndarray],
    deviation: np.ndarray | None,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the shift of ln life and the deviation of log10 life of each case under each draw, (n, draws)."""
    names = results.material(body)
    known = f"fatigue_stress_{body}" if results.has(f"fatigue_stress_{body}") else f"peak_stress_{body}"
    stress = results.column(known)
    shift = np.zeros((len(names), DRAWS))
    scatter = np.zeros(shift.shape) + (0.0 if deviation is None else deviation[:, None])
    for name, fit in fits.items():
        rows = np.flatnonzero((names == name) & (stress > 0))
        values = type(fit.posterior.values)(*(np.asarray(v)[drawn[name]] for v in fit.posterior.values))
        for row in rows:
            x = math.log(stress[row])
            straight = fit.line.best.level - fit.line.best.slope * (x - fit.line.reference)
            shift[row] = values.level - values.slope * (x - fit.line.reference) - straight
        scatter[rows] = np.exp(values.log_scatter)[None, :] / DEVIATES
    return shift, scatter
