"""The line of pressure from rollers on a bench: values, intervals, round trip to a case, and its page."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import norm

import trackroller as tr
from trackroller.fit.solved_rollers import solved_rollers
from trackroller.roller.case import Case

RIG = {"motor_force": 0, "friction_coefficient": 0.1, "axial_force": 20}
OPTIONS = {"contact_model": "sliding", "accuracy": "preview"}
LOADS = np.array([-120, -140, -160, -180, -200, -220, -130, -170])
TRUE = {"pressure": 760.0, "exponent": 14.0, "scatter": 0.6}
LINE = ("rolling_pressure", "rolling_exponent", "scatter")


@pytest.fixture(scope="module")
def bench():
    """Return ln p_0 of the worse contact, and overrollings of a km, of rollers at some loads."""
    solved = solved_rollers([Case.from_dict(RIG | {"radial_force": load}) for load in LOADS.tolist()], OPTIONS)
    return np.log(solved.pressure[:, :, 0].max(axis=1)), solved.per_km[:, 0, 0]


def lives(bench, seed=3):
    """Return ln N of rollers by a known line with log-normal scatter."""
    x, _ = bench
    noise = TRUE["scatter"] * np.random.default_rng(seed).normal(size=len(x))
    return math.log(1e7) - TRUE["exponent"] * (x - math.log(TRUE["pressure"])) + noise


def fitted(bench, log_lives, stopped=(), values=LINE, **more):
    """Return the fit of rollers that failed, or were stopped, after these lives."""
    km = (np.exp(log_lives) / bench[1]).tolist()
    rows = {"test": [f"R{i}" for i in range(len(km))], "radial_force": LOADS.tolist(), "travel_from": km}
    whole = [i in stopped for i in range(len(km))]
    rows["travel_to"] = [None if stop else one for one, stop in zip(km, whole, strict=True)]
    rows["end"] = ["none" if stop else "fatigue roller" for stop in whole]
    return tr.fit_bench(rows, values, base=RIG | OPTIONS, name="rig steel", **more)


def test_without_suspensions_the_line_is_that_of_least_squares(bench):
    x, _ = bench
    y = lives(bench)
    fit = fitted(bench, y)
    slope, level = np.polyfit(x - x.mean(), y, 1)
    rest = y - level - slope * (x - x.mean())
    deviation = math.sqrt((rest**2).mean())
    pressure = math.exp(x.mean() + (level - math.log(1e7)) / -slope)
    assert fit.material["rolling_exponent"] == pytest.approx(-slope, rel=1e-5)
    assert fit.material["rolling_pressure"] == pytest.approx(pressure, rel=1e-6)
    assert fit.material["scatter_in_cycles"] == pytest.approx(math.exp(2 * norm.ppf(0.9) * deviation), rel=1e-4)
    assert fit.material["rolling_cycles"] == 1e7


def test_with_suspensions_it_is_the_best_of_twelve_starts_of_another_optimiser(bench):
    x, _ = bench
    y = np.minimum(lives(bench), math.log(1.5e7))
    stopped = np.flatnonzero(y == math.log(1.5e7))
    assert 0 < len(stopped) < 5
    failed = np.setdiff1d(np.arange(len(y)), stopped)

    def loss(v):
        level, slope, log_s = v
        z = (y - level + slope * (x - x.mean())) / math.exp(log_s)
        return -(norm.logpdf(z[failed]) - log_s).sum() - norm.logsf(z[stopped]).sum()

    rng = np.random.default_rng(1)
    starts = np.stack([rng.uniform(10, 22, 12), rng.uniform(3, 30, 12), rng.uniform(-2, 1, 12)], axis=1)
    found = [
        minimize(loss, start, method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12, "maxiter": 20000})
        for start in starts
    ]
    level, slope, log_s = min(found, key=lambda one: one.fun).x
    fit = fitted(bench, y, stopped)
    assert fit.group("rolling").line.tests.failed.sum() == len(failed)
    assert fit.material["rolling_exponent"] == pytest.approx(slope, rel=1e-4)
    pressure = math.exp(x.mean() + (level - math.log(1e7)) / slope)
    assert fit.material["rolling_pressure"] == pytest.approx(pressure, rel=1e-5)
    t_n = math.exp(2 * norm.ppf(0.9) * math.exp(log_s))
    assert fit.material["scatter_in_cycles"] == pytest.approx(t_n, rel=1e-3)
    for name, value in (("rolling_pressure", pressure), ("rolling_exponent", slope), ("scatter", t_n)):
        low, high = fit.interval(name)
        assert low < value < high
    # as long lives in place of suspensions the same rollers seem weaker
    assert pressure > fitted(bench, y).material["rolling_pressure"]


def test_the_interval_of_a_complete_line_is_that_of_student(bench):
    """The mean life at the mean pressure of n complete tests has the interval of a mean with n - 2 degrees."""
    x, _ = bench
    y = lives(bench)
    fit = fitted(bench, y, values=LINE[::2], slope=14.0)
    rest = y + 14.0 * (x - x.mean())
    from scipy.stats import t

    half = t.ppf(0.95, len(y) - 2) * math.sqrt((rest**2).mean() - rest.mean() ** 2) / math.sqrt(len(y) - 2)
    low, high = fit.interval("cycles", amplitude=float(np.exp(x.mean())))
    assert 0.5 * math.log(high / low) == pytest.approx(half, rel=0.1)
    assert math.sqrt(low * high) == pytest.approx(math.exp(rest.mean()), rel=1e-3)


def test_the_written_line_gives_the_lives_of_its_tests(bench, tmp_path, monkeypatch):
    """Round trip: fit, file, case; the hours of the limit are those of the line, and the range names it."""
    y = lives(bench)
    fit = fitted(bench, y)
    monkeypatch.chdir(tmp_path)
    made = fit.write()
    assert made.rolling_pressure == pytest.approx(fit.material["rolling_pressure"], rel=1e-12)
    assert made.sn_in_rolling is None
    assert made.records["rolling_pressure"].range is None  # of tests, not by hardness
    case = RIG | {"radial_force": -160.0, "roller_material": "rig steel"}
    ds = tr.solve(case, **OPTIONS)
    assert "rolling_pressure" not in ds.attrs["limits_notes"].partition("rig steel")[2].partition("\n")[0]
    hours = ds.life_hours_by_limit.sel(limit="pressure_line", body="roller")
    per_hour = float((ds.life_cycles / ds.life_hours).sel(body="roller").isel(contact=0))
    best = fit.group("rolling").line.best
    log_life = best.level - best.slope * (math.log(float(ds.max_pressure.max())) - fit.group("rolling").line.reference)
    assert float(hours) * per_hour == pytest.approx(math.exp(log_life), rel=1e-9)
    by_fit = fit.life_hours(case | OPTIONS | {"roller_material": "1.7225-normalised"})
    assert by_fit.low < float(hours) < by_fit.high
    ends = [float(ds[f"life_to_first_limit_hours_{end}"].sel(body="roller")) for end in ("low", "high")]
    both = sorted([float(hours), float(ds.roller_life_hours)])
    assert ends == pytest.approx(both, rel=1e-12)


def test_a_stress_line_of_rollers_is_no_line_of_bending(bench, tmp_path, monkeypatch):
    """Its hardness gives it no second line, so that the life by its tests has no range."""
    fit = fitted(bench, lives(bench), values=("fatigue_strength", "slope", "scatter"))
    monkeypatch.chdir(tmp_path)
    made = fit.write()
    assert made.sn_in_rolling == 1.0
    assert made.rolling_pressure is None
    ds = tr.solve(RIG | {"radial_force": -160.0, "roller_material": "rig steel"}, **OPTIONS)
    ends = [float(ds[f"life_to_first_limit_hours_{end}"].sel(body="roller")) for end in ("low", "high")]
    assert ends[0] == ends[1] == float(ds.roller_life_hours)
    bending = tr.solve(RIG | {"radial_force": -160.0}, **OPTIONS)
    low, high = (float(bending[f"life_to_first_limit_hours_{end}"].sel(body="roller")) for end in ("low", "high"))
    assert low < high


def test_the_page_shows_the_line_of_pressure(bench, tmp_path):
    fit = fitted(bench, np.minimum(lives(bench), math.log(1.5e7)), stopped=(0,))
    page = fit.report(tmp_path / "fit.html").read_text()
    for words in ("Pressure p_R in rolling contact", "Exponent k_R of the line of pressure", "fitted line of pressure"):
        assert words in page
    assert "Pressures of" in page


def test_both_lines_from_the_same_tests_are_refused_and_the_remedies_work(bench):
    y = lives(bench)
    with pytest.raises(tr.InputError, match=r"values of one line.*Fit fatigue_strength and slope, or rolling_pressure"):
        fitted(bench, y, values=("fatigue_strength", "rolling_pressure"))
    with pytest.raises(tr.InputError, match=r"rolling_exponent.*--slope 18"):
        tr.fit_bench(
            {"radial_force": [-150, -160], "travel_from": [5, 4], "travel_to": [5, 4], "end": ["fatigue roller"] * 2},
            "rolling_pressure",
            base=RIG | OPTIONS | {"roller_material": "EN AW-7075"},
            scatter_in_cycles=4,
        )
    held = fitted(bench, y, values="rolling_pressure", slope=18, scatter_in_cycles=4)
    assert held.material["rolling_exponent"] == 18
    assert held.material["scatter_in_cycles"] == pytest.approx(4.0)
