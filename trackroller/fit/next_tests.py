"""Rank candidate tests by how much they narrow the life of a design.

A test that has not run yet can end in many ways. For each candidate, lives are drawn from the
posterior, the end of each is weighed by its likelihood, and the variance of ln B10 of the design
that would remain is averaged over the ends (a preposterior analysis). Tests are added one by one,
each the one that lowers the variance most.

ASSUME: a test runs until its roller fails, or until the longest travel that is allowed.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from scipy.special import log_ndtr

from trackroller.errors import InputError
from trackroller.fit.line import Line, Tests, Values
from trackroller.fit.material_fit import Group, MaterialFit, share
from trackroller.fit.posterior import Posterior
from trackroller.fit.solved_rollers import check_same, fields_of, solved_rollers
from trackroller.numerics.numbers import finite_number, number_or_nan
from trackroller.parameters import BODIES, PARAMETERS
from trackroller.roller.case import Case, to_table
from trackroller.roller.settings import checked_case

OUTCOMES = 200  # ends drawn for each candidate
POINTS = 3000  # points of the posterior that are kept, drawn by their weight
MOST_CANDIDATES = 500
FARTHEST = 1e9  # km, the longest travel of a test
CAMPAIGNS = 100  # that are simulated for the number of tests
MOST_TESTS = 128  # of a simulated campaign


def next_tests(
    fit: MaterialFit,
    candidates: Any,
    design: Any,
    tests: int = 3,
    *,
    failure_probability: float = 0.1,
    longest: float = math.inf,
    seed: int = 1,
) -> xr.Dataset:
    """Rank candidate tests by how much they narrow ln B10 of a design.

    Parameters
    ----------
    fit : MaterialFit
        Result of `trackroller.fit_bench` or `trackroller.fit_sn` so far.
    candidates : list of cases, or xarray.Dataset along `case`
        Rollers that could be tested, such as `load_study(file).design()`.
    design : Case or mapping
        The design whose life matters.
    tests : int
        How many tests are planned.
    failure_probability : float
        Failure probability of the life that matters, 0.1 for B10.
    longest : float
        Travel after which a test stops without failure [km].
    seed : int
        Of the draws.

    Returns
    -------
    xarray.Dataset
        Along `candidate`: `deviation`, the standard deviation of ln B10 that remains on average
        after one test, `hours` of that test in the median and `travel`. Along `test`: `chosen`
        candidates in their order and `deviation_after`; `deviation_now` and `deviation_random`,
        what as many random candidates would leave. `interval_now` is the interval of B10 by the
        tests so far. `trackroller.fit.next_tests.tests_until` takes the result and says how many
        tests are needed.

    Raises
    ------
    InputError
        If the fit has no line of fatigue, or a design or candidate does not roll.

    Examples
    --------
    >>> import trackroller as tr
    >>> rows = {"amplitude": [520, 500, 480, 460], "failed": [True] * 4}
    >>> rows["cycles"] = [2e5, 4e5, 5e5, 9e5]
    >>> fit = tr.fit_sn(rows, load_type="rolling contact", stress_ratio=-1)
    >>> free = {"motor_force": 0, "friction_coefficient": 0.1}
    >>> candidates = [free | {"radial_force": force} for force in (-150, -250)]
    >>> plan = tr.next_tests(fit, candidates, free | {"radial_force": -120}, tests=1)
    >>> bool(plan.deviation_after[0] < plan.deviation_now)
    True
    """
    if isinstance(tests, (bool, np.bool_)) or not (
        isinstance(tests, (int, np.integer)) and 1 <= tests <= 20
    ):
        raise InputError("tests", tests, "a whole number from 1 to 20", "Give 3 for three tests.")
    longest = _longest_travel(longest)
    failure_probability = share("failure_probability", failure_probability)
    own = fit.group("fatigue")
    body = str(fit.given.get("body", "roller"))
    cases = _cases(candidates)
    chosen_design, options, _ = checked_case(fields_of(design))
    check_same(fit.given, options, fit.name)
    stresses = _stresses([*cases, chosen_design], options, body)
    ds = ranked(own, stresses, tests, failure_probability, longest, seed)
    differ = [n for n in PARAMETERS if len({str(getattr(case, n)) for case in cases}) > 1]
    ds.attrs["varied"] = differ
    for name in differ:
        ds[name] = (
            "candidate",
            np.array([getattr(case, name) for case in cases]),
            {"units": PARAMETERS[name].unit},
        )
    return ds


def _longest_travel(longest: Any) -> float:
    """Return the travel after which a test stops [km]; inf, the default, stands for tests until
    failure.
    """
    number = number_or_nan(longest, "km", "longest")
    if not (0 < number <= FARTHEST or number == math.inf):
        allowed = f"a travel above 0 and of at most {FARTHEST:g} km"
        raise InputError("longest", longest, allowed, "Leave it out for tests until failure.")
    return number


Stresses = tuple[np.ndarray, np.ndarray, np.ndarray]


def ranked(
    own: Group,
    stresses: Stresses,
    tests: int,
    failure_probability: float,
    longest: float,
    seed: int,
) -> xr.Dataset:
    """Rank candidate tests as `next_tests` does, from what the solutions of candidates and design
    give.

    Parameters
    ----------
    own : Group
        The line of fatigue so far.
    stresses : tuple of numpy.ndarray
        ln S, overrollings of a km, and overrollings of an hour, (n,) each; those of the design
        stand last.
    tests, failure_probability, longest, seed
        See `next_tests`.
    """
    line = own.line
    draws = _fewer_points(own.posterior, seed)
    goal = np.asarray(line.log_life(draws.values, stresses[0][-1], failure_probability))
    if not np.isfinite(goal).all():
        remedy = "Give a design that is loaded above the fatigue limit."
        raise InputError(
            "design", "B10", "a finite life under all values that the tests allow", remedy
        )
    limits = np.log(longest * stresses[1][:-1])
    rng = np.random.default_rng(seed)
    ends = [
        _Candidate(line, draws, x, limit) for x, limit in zip(stresses[0][:-1], limits, strict=True)
    ]
    ds = _ranked(ends, goal, stresses, tests, rng)
    return _with_design(ds, line, stresses, np.exp(limits), failure_probability)


def _with_design(
    ds: xr.Dataset,
    line: Line,
    stresses: Stresses,
    limits: np.ndarray,
    probability: float,
) -> xr.Dataset:
    """Add what is known of the design now, and what a simulated campaign needs of the
    candidates.
    """
    log_stress, _, per_hour = stresses
    now = [
        float(np.exp(end)) / per_hour[-1]
        for end in line.interval_of_life(float(log_stress[-1]), probability)
    ]
    words = "90 % interval of B10 of the design by the tests so far"
    ds["interval_now"] = ("end", np.array(now), {"units": "h", "long_name": words})
    ds["design_stress"] = (
        (),
        float(np.exp(log_stress[-1])),
        {"units": "MPa", "long_name": "stress of the design"},
    )
    ds["longest_cycles"] = (
        "candidate",
        limits,
        {"units": "1", "long_name": "overrollings at which a test stops"},
    )
    ds["overrollings_per_hour"] = (
        "candidate",
        per_hour[:-1],
        {"units": "1/h", "long_name": "overrollings of an hour"},
    )
    ds.attrs["failure_probability"] = probability
    return ds


class _Candidate:
    """A test that could run: its end under drawn values, and the likelihood of each end under all
    values.
    """

    def __init__(self, line: Line, draws: Posterior, stress: float, limit: float) -> None:
        values = draws.values
        scatter = np.exp(draws.values.log_scatter)
        mean = np.asarray(line.log_life(values, stress, 0.5))
        self.median = float(np.exp(np.median(np.minimum(mean, limit))))
        self.mean = mean
        self.scatter = scatter
        self.limit = limit

    def log_likelihood(self, outcome: np.ndarray) -> np.ndarray:
        """Return ln L of ends (m,) under all values, (m, points); an end at the limit is a
        suspension.
        """
        z = (outcome[:, None] - self.mean) / self.scatter
        observed = -0.5 * z**2 - np.log(self.scatter)
        return np.where((outcome >= self.limit)[:, None], log_ndtr(-z), observed)

    def sampled(self, points: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Return the end under the values of some points, with standard normal numbers, both
        (m,).
        """
        return np.minimum(self.mean[points] + self.scatter[points] * normal, self.limit)


def _fewer_points(posterior: Posterior, seed: int) -> Posterior:
    """Return a posterior with fewer points of equal weight."""
    rng = np.random.default_rng(seed)
    rows = rng.choice(len(posterior.weight), POINTS, p=posterior.weight)
    values = [np.broadcast_to(value, posterior.weight.shape)[rows] for value in posterior.values]
    return Posterior(type(posterior.values)(*values), np.full(POINTS, 1.0 / POINTS))


def _cases(candidates: Any) -> list[Case]:
    """Return the candidates as cases."""
    if hasattr(candidates, "data_vars"):
        table = to_table(candidates)
        if len(table) > MOST_CANDIDATES:
            raise InputError(
                "candidates",
                len(table),
                f"at most {MOST_CANDIDATES} candidates",
                "Give fewer levels.",
            )
        names = [
            name
            for name in (*PARAMETERS, "roller_material", "guide_material")
            if name in candidates
        ]
        columns = {name: np.broadcast_to(candidates[name].values, len(table)) for name in names}
        given = [{n: _plain(column[i]) for n, column in columns.items()} for i in range(len(table))]
    else:
        if isinstance(candidates, (str, bytes, Mapping)) or not isinstance(candidates, Iterable):
            remedy = "Write a list, such as [{'radial_force': -150}, {'radial_force': -200}]."
            raise InputError(
                "candidates", candidates, "a list of cases, or a data set along case", remedy
            )
        given = [fields_of(one, "candidates") for one in candidates]
    if not given:
        raise InputError("candidates", None, "at least one candidate")
    return [Case.from_dict({n: v for n, v in one.items() if v is not None}) for one in given]


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and math.isnan(value):
        return None
    return value


def _stresses(cases: Sequence[Case], options: Mapping[str, Any], body: str) -> Stresses:
    """Return ln S in the contact that fails first, overrollings of a km, and overrollings of an
    hour, (n,) each.
    """
    solved = solved_rollers(cases, options)
    for i, regime in enumerate(solved.regime):
        if regime != "rolling":
            case = f"candidate {i + 1}"
            if i == len(cases) - 1:
                case = "design"
            raise InputError(
                case, regime, "a roller that rolls", "Change its loads, or leave it out."
            )
    b = BODIES.index(body)
    worse = np.argmax(solved.stress[:, :, b], axis=1)
    rows = np.arange(len(cases))
    stress, per_km, per_hour = (
        array[rows, worse, b] for array in (solved.stress, solved.per_km, solved.per_hour)
    )
    if np.isnan(per_km).any():
        raise InputError("guide_overrollings_per_hour", None, "a number in design and candidates")
    return np.log(stress), per_km, per_hour


def _remaining(
    tests: Sequence[_Candidate], goal: np.ndarray, points: np.ndarray, normal: np.ndarray
) -> float:
    """Return the mean variance of ln B10 after tests whose ends are drawn."""
    log_weight = np.zeros((len(points), len(goal)))
    for i, test in enumerate(tests):
        log_weight += test.log_likelihood(test.sampled(points, normal[:, i]))
    weight = np.exp(log_weight - log_weight.max(axis=1, keepdims=True))
    weight /= weight.sum(axis=1, keepdims=True)
    mean = weight @ goal
    return float(np.mean(weight @ goal**2 - mean**2))


def _ranked(
    candidates: Sequence[_Candidate],
    goal: np.ndarray,
    stresses: Stresses,
    tests: int,
    rng: np.random.Generator,
) -> xr.Dataset:
    """Return the ranking of the candidates, and a plan of several tests beside random ones."""
    # the same ends for all candidates: differences are no chance
    points = rng.integers(0, len(goal), OUTCOMES)
    normal = rng.normal(size=(OUTCOMES, tests))
    centred = goal - goal.mean()
    alone = np.array([_remaining([one], centred, points, normal) for one in candidates])
    chosen = [int(np.argmin(alone))]
    after = [float(alone.min())]
    while len(chosen) < tests:
        before = [candidates[i] for i in chosen]
        variances = np.array(
            [_remaining([*before, one], centred, points, normal) for one in candidates]
        )
        chosen.append(int(np.argmin(variances)))
        after.append(float(variances.min()))
    random = [
        _remaining(
            [candidates[i] for i in rng.integers(0, len(candidates), tests)],
            centred,
            points,
            normal,
        )
        for _ in range(12)
    ]
    cycles = np.array([one.median for one in candidates])
    words = {"units": "1", "long_name": "standard deviation of ln B10 of the design"}
    return xr.Dataset(
        {
            "deviation": ("candidate", np.sqrt(alone), words),
            "hours": (
                "candidate",
                cycles / stresses[2][:-1],
                {"units": "h", "long_name": "median of the test's hours"},
            ),
            "travel": (
                "candidate",
                cycles / stresses[1][:-1],
                {"units": "km", "long_name": "median travel of the test"},
            ),
            "stress": (
                "candidate",
                np.exp(stresses[0][:-1]),
                {"units": "MPa", "long_name": "stress of the test"},
            ),
            "chosen": (
                "test",
                np.array(chosen),
                {"long_name": "candidates in the order of the plan"},
            ),
            "deviation_after": ("test", np.sqrt(after), words),
            "deviation_now": ((), float(np.std(goal)), words),
            "deviation_random": ((), float(np.sqrt(np.mean(random))), words),
        }
    )


def tests_until(
    fit: MaterialFit, plan: xr.Dataset, factor: float, *, campaigns: int = CAMPAIGNS, seed: int = 1
) -> xr.Dataset:
    """Simulate how many more tests narrow the interval of B10 of a design to a factor.

    Parameters
    ----------
    fit : MaterialFit
        The fit so far.
    plan : xarray.Dataset
        What `next_tests` returned for it; a campaign repeats its `chosen` tests in their order.
    factor : float
        High over low end of the 90 % interval of B10 that is wanted [1].
    campaigns : int
        Number of simulated campaigns.
    seed : int
        Of the random numbers.

    Returns
    -------
    xarray.Dataset
        Along `campaign`: `tests` and `hours` until the interval is narrow enough; inf where `most`
        tests do not suffice.

    Raises
    ------
    InputError
        For a factor of 1 or less, and for a fit with a fatigue limit without a longest travel.

    Notes
    -----
    Each campaign has a line of its own, drawn from the posterior. Its tests end by that line, and
    the line is fitted to all tests as `fit_bench` does. The number of tests is found by doubling
    and halving, because the width of the interval falls with it but for chance.
    """
    factor = check_factor(factor)
    own = fit.group("fatigue")
    line = own.line
    values = own.posterior.values
    chosen = plan["chosen"].values
    stress, limit, rate = (
        plan[name].values[chosen] for name in ("stress", "longest_cycles", "overrollings_per_hour")
    )
    if line.knee and np.isinf(limit).any():
        remedy = (
            "Give it with --longest, in Python longest=...: a specimen below its limit never fails."
        )
        raise InputError("longest", None, "the travel after which a test stops", remedy)
    design = math.log(float(plan["design_stress"]))
    p = float(plan.attrs["failure_probability"])
    if _ln_width(line, design, p) <= math.log(factor):
        zeros = np.zeros(campaigns)
        return _campaigns(zeros, zeros)
    rng = np.random.default_rng(seed)
    campaigns_run = []
    for row in rng.choice(len(own.posterior.weight), campaigns, p=own.posterior.weight):
        truth = Values(
            *(float(np.broadcast_to(value, own.posterior.weight.shape)[row]) for value in values)
        )
        place = np.arange(MOST_TESTS) % len(chosen)
        x = np.log(stress[place])
        limits = np.log(limit[place])
        end = truth.level - truth.slope * (x - line.reference)
        end = end + math.exp(truth.log_scatter) * rng.normal(size=MOST_TESTS)
        if line.knee:
            own_limit = truth.log_limit + math.exp(truth.log_limit_scatter) * rng.normal(
                size=MOST_TESTS
            )
            end = np.where(x > own_limit, end, np.inf)
        tests = Tests(x, np.minimum(end, limits), np.where(end < limits, end, np.inf))
        number = _first(line, tests, design, p, math.log(factor))
        hours = np.exp(tests.low) / rate[place]
        if math.isfinite(number):
            campaigns_run.append((number, hours[: int(number)].sum()))
        else:
            campaigns_run.append((number, math.inf))
    return _campaigns(*np.array(campaigns_run, float).T)


def check_factor(factor: Any) -> float:
    """Return a factor between the ends of an interval; refuse what is no finite number above 1."""
    number = finite_number(factor)
    if not number > 1.0:
        allowed = "a finite number above 1: the high over the low end of the interval"
        raise InputError("until", factor, allowed, "Give 2 for an interval such as 100 to 200 h.")
    return number


def _campaigns(tests: np.ndarray, hours: np.ndarray) -> xr.Dataset:
    return xr.Dataset(
        {
            "tests": ("campaign", tests, {"units": "1", "long_name": "further tests"}),
            "hours": ("campaign", hours, {"units": "h", "long_name": "hours of the further tests"}),
        },
        attrs={"most": MOST_TESTS},
    )


def _ln_width(line: Line, log_stress: float, probability: float) -> float:
    """Return the width of the 90 % interval of ln life."""
    low, high = line.interval_of_life(log_stress, probability)
    return high - low


def _first(line: Line, tests: Tests, log_stress: float, probability: float, goal: float) -> float:
    """Return the number of further tests at which the interval is narrow enough, inf if all of them
    do not suffice.
    """

    def narrow(number: int) -> bool:
        every = [
            np.concatenate([a, b[:number]])
            for a, b in (
                (line.tests.stress, tests.stress),
                (line.tests.low, tests.low),
                (line.tests.high, tests.high),
            )
        ]
        specimens = line.size + number
        return (
            _ln_width(
                replace(line, tests=Tests(*every), specimens=specimens), log_stress, probability
            )
            <= goal
        )

    low, high = 0, 1
    while not narrow(high):
        if high >= MOST_TESTS:
            return math.inf
        low = high
        high = min(2 * high, MOST_TESTS)
    while high - low > 1:
        middle = (low + high) // 2
        if narrow(middle):
            high = middle
        else:
            low = middle
    return float(high)
