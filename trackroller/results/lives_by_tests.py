"""Lives over what the tests of fitted materials leave open: their posterior moves and spreads the
lives of a study.

Each draw from the posterior of a fitted line moves the lives by fatigue of its material by the
ratio of both lines at the stress of the case. A band holds 90 % of the draws.

ASSUME: lives by fatigue move; other limits stay. Below the fatigue limit the ratio is that of both
straight lines.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from scipy.special import ndtr, ndtri

from trackroller.errors import InputError, listing
from trackroller.fit.line import Values
from trackroller.fit.posterior import Posterior
from trackroller.fit.solved_rollers import DEFAULTS, check_same
from trackroller.fit.stored import StoredFit, stored_fit
from trackroller.methods.b10 import b10
from trackroller.parameters import BODIES, FIRST_TO_FAIL
from trackroller.results.first_limits import hours_by_body, reached_by_body
from trackroller.results.life_columns import body_lives, past_data
from trackroller.results.solved_cases import SAME_ENDS, SolvedCases, made_once
from trackroller.results.targets import hits_of, scattering_body
from trackroller.roller.output_names import body_of, is_life
from trackroller.study.design.factor_names import OPTION_FACTORS
from trackroller.study.outputs import Output, of_fatigue, of_first_limit, outputs

PARTS = 8  # of equal weight, into which each value of a line divides its posterior
DRAWS = PARTS**3  # one for each part of level, slope and scatter
BAND = (0.05, 0.95)  # quantiles of the draws between which a life lies by the tests
WANTED = "fitted"
DEVIATES = math.log(10.0)
AT_ONCE = 2_000_000  # elements of an array of cases and draws, which bounds the memory
Shift = Callable[[str], np.ndarray]  # of ln life by body, (n,)


def materials_fitted(results: SolvedCases) -> dict[str, StoredFit]:
    """Return the fits of the materials of a study by the names of the materials, whether they hold
    for it or not.
    """
    stored = json.loads(str(results.data.attrs.get("materials", "{}")))
    fits = {
        name: stored_fit(name, values, results.materials_file) for name, values in stored.items()
    }
    return {name: fit for name, fit in fits.items() if fit is not None}


def options_of(results: SolvedCases) -> dict[str, Any]:
    """Return the options by which the compared cases of a study were solved."""
    levels = {name: results.held_level(name) for name in results.factors if name in OPTION_FACTORS}
    return {key: value for key, value in results.data.attrs.items() if key in DEFAULTS} | levels


def not_held(results: SolvedCases) -> dict[str, str]:
    """Return the fitted materials of a study that was solved with other options than their fit,
    with these options.
    """
    used = options_of(results)
    reasons = {}
    for name, fit in materials_fitted(results).items():
        other = [
            f"{k} {fit.given[k]}"
            for k in DEFAULTS
            if str(used.get(k, DEFAULTS[k])) != fit.given.get(k, used.get(k))
        ]
        if other:
            reasons[name] = listing(other)
    return reasons


@made_once
def by_tests_of(results: SolvedCases) -> ByTests | None:
    """Return the fits of the materials of a study that hold for it, with the draws of their
    posteriors.

    Returns
    -------
    ByTests or None
        None without a material that was fitted to tests.
    """
    other = not_held(results)
    fits = {name: fit for name, fit in materials_fitted(results).items() if name not in other}
    if fits:
        return ByTests(results, fits)
    return None


def beyond_sn_data(results: SolvedCases, column: str) -> np.ndarray:
    """Mark the cases in which a life lies beyond the S-N data, shape (n,); no case for another
    quantity.

    The body stays below its fatigue limit, or lasts more than `DATA_END` overrollings. Of a
    material that was fitted to tests, its stress or its life lies beyond the tests. For the pair
    the body that fails first counts, or the roller where no body is known to fail first. A life to
    the first limit that wear or the bearing ends rests on no S-N data.

    Parameters
    ----------
    results : SolvedCases
        The solved study.
    column : str
        A life, such as `pair_life_hours` or `life_cycles_guide`.
    """
    if not (of_fatigue(column) or of_first_limit(column)):
        return np.zeros(len(results.table), dtype=bool)
    body = body_of(column)
    if not body:
        guide = results.first_failing(column) == FIRST_TO_FAIL.index("guide")
        own = body_lives(column)
        return np.where(
            guide, *(beyond_sn_data(results, own[body]) for body in ("guide", "roller"))
        )
    if of_first_limit(column):
        fatigue = results.column(f"limiting_mechanism_{body}") == results.limits.index("fatigue")
        return np.asarray(fatigue & beyond_sn_data(results, f"{body}_life_hours"))
    names = pd.Series(results.material(body))
    stored = json.loads(str(results.data.attrs.get("materials", "{}")))
    knees = {
        n: float(stored.get(n, {}).get("cycles_at_fatigue_limit", np.inf)) for n in names.unique()
    }
    endless = np.isposinf(results.column(f"{body}_life_hours"))
    cycles = results.column(f"life_cycles_{body}")
    past = past_data(cycles, names.map(knees).to_numpy(dtype=float)) | endless
    tests = by_tests_of(results)
    if tests is None:
        return past
    return np.where(tests.named[body] != "", tests.beyond(body), past)


def required(results: SolvedCases) -> ByTests:
    """Return the fits that hold for a study with `material_scatter: fitted`.

    Raises
    ------
    InputError
        If no material of the study was fitted, or the study has other options than a fit.
    """
    fits = materials_fitted(results)
    if not fits:
        stored = list(json.loads(str(results.data.attrs.get("materials", "{}"))))
        allowed = "a study with a material that `trackroller fit` wrote"
        remedy = (
            f"Fit {listing(stored, 'or')} to tests, or set material_scatter to true or a number."
        )
        raise InputError("analysis.material_scatter", WANTED, allowed, remedy)
    for fit in fits.values():
        check_same(fit.given, options_of(results), fit.name)
    return ByTests(results, fits)


@dataclasses.dataclass(frozen=True, eq=False)
class ByTests:
    """The fits of the materials of a study, with draws of their posteriors.

    Attributes
    ----------
    results : the solved study
    fits : fit of each fitted material by its name
    """

    results: SolvedCases
    fits: Mapping[str, StoredFit]

    @cached_property
    def drawn(self) -> dict[str, Values]:
        """Return values of the line of each material, (draws,) each.

        The draws have equal weights, and those of the first material rise with the life at its mean
        tested stress. Those of further materials are shuffled, because posteriors of different
        materials are independent.
        """
        out = {}
        for i, (name, fit) in enumerate(self.fits.items()):
            rows = _spread_evenly(fit.posterior)
            if i != 0:
                rows = np.random.default_rng(i).permutation(rows)
            out[name] = Values(
                *(
                    np.broadcast_to(v, fit.posterior.weight.shape)[rows]
                    for v in fit.posterior.values
                )
            )
        return out

    @cached_property
    def stress(self) -> dict[str, np.ndarray]:
        """Return the stress of each body that enters its line, at its worse contact, (n,) [MPa].

        A study without stresses gives those of fitted materials by their lines, from which its
        lives follow.
        """
        out = {}
        for body in BODIES:
            names = (f"fatigue_stress_{body}", f"peak_stress_{body}")
            known = next((name for name in names if self.results.has(name)), "")
            if known:
                out[body] = self.results.column(known)
            else:
                out[body] = self._by_line(body)
        return out

    def _by_line(self, body: str) -> np.ndarray:
        """Return the stress of a body at which the line of its material gives its life, (n,) [MPa];
        else NaN.
        """
        names = self.results.material(body)
        cycles = self.results.column(f"life_cycles_{body}")
        out = np.full(len(names), np.nan)
        for name, fit in self.fits.items():
            best = fit.line.best
            rows = (names == name) & (cycles > 0) & np.isfinite(cycles)
            out[rows] = np.exp(
                fit.line.reference + (best.level - np.log(cycles[rows])) / best.slope
            )
        return out

    @cached_property
    def named(self) -> dict[str, np.ndarray]:
        """Return the fitted material of each body in each case, (n,); '' where it was not
        fitted.
        """
        names = {body: self.results.material(body) for body in BODIES}
        return {
            b: np.where(np.isin(n, list(self.fits)) & (self.stress[b] > 0), n, "")
            for b, n in names.items()
        }

    @cached_property
    def _hours(self) -> dict[str, np.ndarray]:
        """Return hours by each limit at each end of the ranges of placeholders, (n, limit,
        body).
        """
        return {end: hours_by_body(self.results, end) for end in ("", "_low", "_high")}

    def beyond(self, body: str) -> np.ndarray:
        """Return the cases whose stress or life of a body lies beyond the tests of its material,
        (n,).
        """
        names = self.named[body]
        stress = self.stress[body]
        cycles = self.results.column(f"life_cycles_{body}")
        out = np.zeros(len(names), dtype=bool)
        for name, fit in self.fits.items():
            rows = names == name
            out[rows] = fit.extrapolates(stress[rows], cycles[rows])
        return out

    def moved(
        self, body: str, rows: np.ndarray, draws: Any = slice(None), probability: float = 0.5
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the shift of ln life of a body, and the deviation of log10 life of its material,
        (rows, draws) each.

        Parameters
        ----------
        body : str
            The body.
        rows : numpy.ndarray
            Numbers of cases.
        draws : slice or list of int
            Which draws.
        probability : float
            Failure probability of the lives [1].

        Returns
        -------
        tuple of numpy.ndarray
            0 and NaN where the material was not fitted.
        """
        names = self.named[body][rows]
        stress = self.stress[body][rows]
        if isinstance(draws, slice):
            size = len(range(*draws.indices(DRAWS)))
        else:
            size = len(draws)
        shift, deviation = np.zeros((len(rows), size)), np.full((len(rows), size), np.nan)
        deviate = float(ndtri(probability))
        for name, fit in self.fits.items():
            own = names == name
            best = fit.line.best
            values = Values(*(np.asarray(value)[draws] for value in self.drawn[name]))
            away = np.log(stress[own])[:, None] - fit.line.reference
            spread = np.exp(values.log_scatter)
            shift[own] = (values.level - best.level) - (values.slope - best.slope) * away
            shift[own] += deviate * (spread - math.exp(float(best.log_scatter)))
            deviation[own] = spread / DEVIATES
        return shift, deviation

    def ends(self, body: str, probability: float = 0.5) -> np.ndarray:
        """Return the shift of ln life of a body at both ends of the band, (2, n)."""
        out = np.zeros((2, len(self.results.table)))
        fitted = np.flatnonzero(self.named[body] != "")
        step = max(AT_ONCE // DRAWS, 1)
        for part in (fitted[i : i + step] for i in range(0, len(fitted), step)):
            out[:, part] = np.quantile(
                self.moved(body, part, probability=probability)[0], BAND, axis=1
            )
        return out

    def hours(self, shift: Shift, end: str = "") -> np.ndarray:
        """Return the hours by each limit when those by fatigue are moved, see `lives`, (n, limit,
        body) [h].
        """
        out = self._hours[end].copy()
        limits = self.results.data["limit"].values.tolist()
        for i, body in enumerate(BODIES):
            if "fatigue" in limits:
                out[:, limits.index("fatigue"), i] *= np.exp(shift(body))
        return out

    def lives(self, name: str, values: np.ndarray, shift: Shift, end: str = "") -> np.ndarray:
        """Return a column of lives after each life by fatigue has been moved.

        Parameters
        ----------
        name : str
            Column of the lives; values of another column stay.
        values : numpy.ndarray
            The lives, (n,).
        shift : callable
            Returns the shift of ln life by fatigue of a body, (n,).
        end : str
            `_low` or `_high` for the ends of the ranges of placeholders, to which the values
            belong.
        """
        body = body_of(name)
        if of_fatigue(name) and body:
            return np.asarray(values * np.exp(shift(body)))
        if of_fatigue(name):
            own = [self.results.column(column) for column in body_lives(name).values()]
            before, after = (
                np.fmin.reduce(
                    [life * np.exp(s * shift(b)) for b, life in zip(BODIES, own, strict=True)]
                )
                for s in (0, 1)
            )
        elif of_first_limit(name):
            if body:
                places = [BODIES.index(body)]
            else:
                places = list(range(len(BODIES)))
            before, after = (
                reached_by_body(self.results, end, hours)[:, :, places].min(axis=(1, 2))
                for hours in (self._hours[end], self.hours(shift, end))
            )
        else:
            return values
        known = np.isfinite(before) & (before > 0) & np.isfinite(values)
        return np.where(known, values * after / np.where(known, before, 1.0), values)

    def at(self, draw: int, rows: np.ndarray | None = None, probability: float = 0.5) -> Shift:
        """Return the shifts of ln life of one draw by body."""
        if rows is None:
            rows = np.arange(len(self.results.table))
        return lambda body: self.moved(body, rows, [draw], probability)[0][:, 0]

    def words(self, names: Iterable[str]) -> str:
        """Return the words for the tests of some materials: 'the 6 tests of rig steel'."""
        return listing([f"the {self.fits[name].rows} tests of {name}" for name in names])


def _spread_evenly(posterior: Posterior) -> np.ndarray:
    """Return numbers of points of a posterior that stand for equal shares of its weight, (draws,).

    Points are sorted by the level into parts, each of these by the slope, and each of these by the
    scatter; the points at equal steps of the weight in this order are taken.
    """
    weight = posterior.weight
    parts: list[np.ndarray] = [np.arange(len(weight))]
    for value in (posterior.values.level, posterior.values.slope, posterior.values.log_scatter):
        own = np.broadcast_to(value, weight.shape)
        halves = []
        for part in parts:
            order = part[np.argsort(own[part], kind="stable")]
            share = np.cumsum(weight[order])
            cuts = []
            if len(order):
                cuts = np.searchsorted(share, np.arange(1, PARTS) / PARTS * share[-1])
            halves += np.split(order, cuts)
        parts = halves
    order = np.concatenate(parts)
    below = np.cumsum(weight[order])
    return np.asarray(order[np.searchsorted(below, (np.arange(DRAWS) + 0.5) / DRAWS * below[-1])])


def probability_of(results: SolvedCases, name: str) -> float:
    """Return the failure probability that a life of a study belongs to [1]: lives to a limit have
    that of the study.
    """
    if of_first_limit(name):
        return float(results.data.attrs.get("failure_probability", 0.5))
    return 0.5


def _drawn_lives(
    own: ByTests, column: Output, given: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the lives of a column and the deviations of log10 life under each draw, (n, draws)
    each.
    """
    name = column.name
    n = len(column.values)
    every = np.arange(n)
    p = probability_of(own.results, column.name)
    lives = np.stack(
        [own.lives(name, column.values, own.at(i, probability=p)) for i in range(DRAWS)], axis=1
    )
    deviation = own.moved(scattering_body(name), every)[1]
    if given is None:
        given = np.zeros(n)
    return lives, np.where(np.isnan(deviation), given[:, None], deviation)


def bands(results: SolvedCases, deviations: Mapping[str, np.ndarray]) -> xr.Dataset:
    """Return the bands of targets and of B10 by the tests, for a study with `material_scatter:
    fitted`.

    Parameters
    ----------
    results : SolvedCases
        Solved study.
    deviations : mapping of str to numpy.ndarray
        Standard deviation of log10 life of the material of each body [1], (n,).

    Returns
    -------
    xarray.Dataset
        `tests_low` and `tests_high` along `target`, over all cases; NaN for a target that is no
        life. For each life of the study `b10_tests_low` and `b10_tests_high` along `life`, and
        along `point` of a design with design points, beside `b10_tests`, B10 by the fitted values
        with the scatter of the material; over the cases that roll. Their attributes `tests` and
        `materials` say how many tests the bands rest on, and of which materials.
    """
    own = required(results)
    requirement = results.config.requirement
    words = {
        "tests": str(sum(fit.rows for fit in own.fits.values())),
        "materials": listing(list(own.fits)),
    }
    columns = _columns(results, list(requirement))
    parts = []
    for column in columns:
        judged = results.judged_targets.get(column.name)
        sooner = judged is not None and bool(
            (results.valid & (judged < column.values * (1 - SAME_ENDS))).any()
        )
        if not is_life(column.name) or sooner:
            parts.append((math.nan, math.nan))
            continue
        lives, scatter = _drawn_lives(own, column, deviations.get(scattering_body(column.name)))
        goal = requirement[column.name]
        shares = [
            float(
                hits_of(dataclasses.replace(column, values=lives[:, i]), goal, scatter[:, i]).mean()
            )
            for i in range(DRAWS)
        ]
        parts.append(tuple(np.quantile(shares, BAND)))
    out = xr.Dataset()
    if columns:
        low, high = np.array(parts, float).T
        attrs = {"units": "1", "long_name": "probability over all cases, 90 % by the tests"} | words
        ends = {"tests_low": ("target", low, attrs), "tests_high": ("target", high, attrs)}
        out = xr.Dataset(ends, {"target": [column.name for column in columns]})
    return out.merge(_b10_bands(own, deviations, words))


def _columns(results: SolvedCases, names: list[str]) -> list[Output]:
    """Return these outputs as they are, without a limit of their number."""
    factors = results.design.factors
    if names:
        return outputs(
            results.data, factors, names, scale="natural", unlimited=True, allowed=results.allowed
        )
    return []


def _b10_bands(
    own: ByTests, deviations: Mapping[str, np.ndarray], words: Mapping[str, str]
) -> xr.Dataset:
    """Return B10 of each life and its band by the tests, at each design point or over all cases of
    a sample.
    """
    results = own.results
    design = own.results.design
    lives = _lives_of(results)
    if not (design.method.points or design.method.sampled) or not lives:
        return xr.Dataset()
    columns = _columns(results, lives)
    points: list[Any] = [design.method.independent_rows(design)]
    if design.method.points:
        points = list(design.points)
    values = np.full((3, len(columns), len(points)), np.nan)
    for i, column in enumerate(columns):
        values[:, i] = _b10_of(own, column, points, deviations)
    names = {
        "b10_tests": "life that 90 % reach, with the scatter of the material",
        "b10_tests_low": "its low end, 90 % by the tests",
        "b10_tests_high": "its high end, 90 % by the tests",
    }
    axes: tuple[str, ...] = ("life", "point")
    if not design.method.points:
        axes = ("life",)
        values = values[:, :, 0]
    return xr.Dataset(
        {
            n: (axes, v, {"long_name": names[n]} | dict(words))
            for n, v in zip(names, values, strict=True)
        },
        {
            "life": [column.name for column in columns],
            "life_name": ("life", [column.long_name for column in columns]),
            "life_units": ("life", [column.units for column in columns]),
        },
    )


def _lives_of(results: SolvedCases) -> list[str]:
    """Return the names of the lives of a study: the compared one first, then those of fatigue."""
    names = [name for name, _, _ in results.fatigue_lives]
    if results.life:
        names.insert(0, results.life[0])
    return [name for name in dict.fromkeys(names) if name in results.table and is_life(name)]


def _b10_of(
    own: ByTests, column: Output, points: list[Any], deviations: Mapping[str, np.ndarray]
) -> np.ndarray:
    """Return B10 of a life by the fitted values, and both ends of its band by the tests, (3,
    points); NaN at a point with fewer than two lives.
    """
    design = own.results.design
    lives = own.results.with_breaks(column)
    given = deviations.get(scattering_body(column.name))
    drawn, drawn_scatter = _drawn_lives(own, dataclasses.replace(column, values=lives), given)
    scatter = np.zeros(design.size)
    if given is not None:
        scatter = given
    out = np.full((3, len(points)), np.nan)
    for p, rows in enumerate(points):
        counted = np.arange(design.size)[rows]
        counted = counted[~np.isnan(lives[counted])]
        if counted.size < 2:
            continue
        out[0, p] = b10(lives[counted], scatter[counted])[0]
        draws = b10_of_draws(drawn[counted], drawn_scatter[counted])
        out[1:, p] = np.quantile(draws, BAND)
    return out


def b10_of_draws(lives: np.ndarray, scatter: np.ndarray) -> np.ndarray:
    """Return the life that 90 % reach under each draw, (draws,).

    Parameters
    ----------
    lives : numpy.ndarray
        Median lives at the sampled conditions, (n, draws); 0 and inf are allowed.
    scatter : numpy.ndarray
        Standard deviation of log10 life of the material, (n, draws) [1].

    Notes
    -----
    The root of mean_i Phi((lg t - lg N_i) / s) = 0.1 by bisection, as `trackroller.methods.b10.b10`
    finds it for one set of lives.
    """
    with np.errstate(divide="ignore"):
        logs = np.log10(lives)
    finite = np.isfinite(logs)
    if not finite.any():
        return np.asarray(np.quantile(lives, 0.1, axis=0, method="inverted_cdf"))
    spread = np.maximum(scatter, 1e-9)
    reach = 6.0 * float(spread.max()) + 1.0
    low = np.full(lives.shape[1], float(logs[finite].min()) - reach)
    high = np.full(lives.shape[1], float(logs[finite].max()) + reach)
    with np.errstate(invalid="ignore"):
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = ndtr((middle - logs) / spread).mean(axis=0) < 0.1
            low, high = np.where(below, middle, low), np.where(below, high, middle)
    # 0 or without end: scatter changes nothing
    ends = np.quantile(lives, 0.1, axis=0, method="inverted_cdf")
    return np.asarray(np.where((ends == 0) | np.isinf(ends), ends, 10.0 ** (0.5 * (low + high))))
