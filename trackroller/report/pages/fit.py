"""The page of a fit: values with their intervals, figures, what the tests cannot tell, and the
tests themselves.
"""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from trackroller.errors import listing
from trackroller.fit.catalogue import CatalogueFit
from trackroller.fit.material_fit import WORDS, Group, MaterialFit
from trackroller.report import html
from trackroller.report.numbers import capital, rounded, with_unit
from trackroller.report.pages.record import pictures, versions_text
from trackroller.report.tables.table import Table, cell, heading

SYMBOLS = {
    "fatigue_limit": "Fatigue strength sigma_D",
    "woehler_exponent": "Slope k",
    "scatter_in_cycles": "Scatter of the life T_N",
    "scatter_in_stress": "Scatter of the fatigue limit T_S",
    "rolling_pressure": "Pressure p_R in rolling contact",
    "rolling_exponent": "Exponent k_R of the line of pressure",
    "wear_coefficient": "Wear coefficient",
    "wear_scatter": "Scatter of the travel to a depth",
    "friction_coefficient": "Friction coefficient",
    "friction_scatter": "Scatter of the friction coefficient",
}
WIDE = 5.0  # times that an interval of a life spans, above which the page says so
SYNTHETIC = "synthetic"  # in the name of a table of tests


def value_table(fit: MaterialFit) -> Table:
    """List the fitted values: estimate, 90 % interval, posterior, prior."""
    rows = []
    for own in fit.groups:
        for name in own.names:
            unit = WORDS[name][0]
            low, high = own.interval(name)
            if name in own.unidentified:
                estimate = "not identified"
            else:
                estimate = cell(own.estimate(name))
            if own.line.tests.failed.any():
                band = own.band(name)
                after = f"{cell(band[1])} ({cell(band[0])} to {cell(band[2])})"
            else:
                after = "–"
            rows.append(
                [
                    with_unit(SYMBOLS[name], unit),
                    estimate,
                    _ends(low, high),
                    after,
                    _prior(own, name),
                ]
            )
    heads = ["Value", "Most likely", "90 % interval", "Posterior: median (5 to 95 %)", "Prior"]
    return Table("fit_values", "Fitted values", heads, rows)


def _prior(own: Group, name: str) -> str:
    key = {
        "woehler_exponent": "slope",
        "scatter_in_cycles": "log_scatter",
        "fatigue_limit": "log_strength",
        "rolling_pressure": "log_strength",
        "rolling_exponent": "slope",
    }.get(name)
    if key is None or key not in own.priors:
        if name in ("woehler_exponent", "rolling_exponent"):
            return "flat"
        return "flat in its logarithm"
    prior = own.priors[key]
    if key == "slope":
        return f"{cell(prior.mean)} ± {cell(prior.deviation)}"
    if key == "log_strength":
        middle = math.exp(prior.mean)
    else:
        middle = math.exp(2.563 * math.exp(prior.mean))
    return f"median {cell(middle)}, ± {cell(prior.deviation)} in ln"


def _ends(low: float, high: float) -> str:
    if math.isinf(high) and low <= 0:
        return "any value"
    if math.isinf(high):
        return f"at least {cell(low)}"
    if low <= 0 or math.isinf(low):
        return f"at most {cell(high)}"
    return f"{cell(low)} to {cell(high)}"


def sentences(fit: MaterialFit) -> list[str]:
    """Return the statements at the head of the page: what was fitted, and what is not
    identified.
    """
    texts = []
    for own in fit.groups:
        failed = int(own.line.tests.failed.sum())
        size = own.line.size
        ends = {
            "fatigue": "failed by fatigue",
            "rolling": "failed by fatigue",
            "wear": "reached a depth",
            "friction": "gave a drive force",
        }[own.kind]
        values = []
        for name in own.names:
            if WORDS[name][0] == "1":
                unit = ""
            else:
                unit = f" {WORDS[name][0]}"
            low, high = own.interval(name)
            if name in own.unidentified:
                values.append(f"{_short(name)} not identified ({_ends(low, high)}{unit})")
            else:
                values.append(
                    f"{_short(name)} {cell(own.estimate(name))}{unit} ({_ends(low, high)})"
                )
        texts.append(
            f"{failed} of {size} tests {ends}: {', '.join(values)}; 90 % intervals in brackets."
        )
    return texts


def _short(name: str) -> str:
    return {
        "fatigue_limit": "fatigue strength",
        "woehler_exponent": "slope",
        "scatter_in_cycles": "T_N",
        "scatter_in_stress": "T_S",
        "rolling_pressure": "p_R",
        "rolling_exponent": "k_R",
    }.get(name, name.replace("_", " "))


def cannot_tell(fit: MaterialFit) -> list[str]:
    """Return sentences on what the tests do not tell."""
    texts = []
    for name in fit.unidentified:
        texts.append(
            f"The tests do not identify the {_short(name)}: its estimate lies at a bound, "
            "and is no number."
        )
    if fit.has("fatigue"):
        limit = math.nan
        if "fatigue_limit" in fit.material:
            limit = fit.knee
        texts += _of_line(fit.group("fatigue"), limit)
    elif fit.has("rolling"):
        own = fit.group("rolling")
        texts += _of_line(own, own.at)
    return [*texts, *fit.notes, *fit.not_given]


def _of_line(own: Group, knee: float) -> list[str]:
    """Return sentences on the range of a line, and on how wide its lives are."""
    low, high, longest = own.tested
    load, loads = ("stress", "Stresses")
    if own.kind == "rolling":
        load, loads = ("pressure", "Pressures")
    texts = [
        f"{loads} of {rounded(low)} to {rounded(high)} MPa and up to {rounded(longest)} cycles "
        f"were tested. A life at another {load}, or a longer one, is an extrapolation of the line."
    ]
    if not own.line.knee and knee > 1.05 * longest:
        texts.append(
            f"The strength is stated at {rounded(knee)} cycles, beyond the longest test: "
            "it is extrapolated."
        )
    if own.line.tests.failed.any():
        ends = own.line.interval_of_life(math.log(low), 0.1)
        width = math.exp(min(ends.high - ends.low, 50.0))
        if width > WIDE:
            texts.append(
                f"B10 at {rounded(low)} MPa is known within a factor of {rounded(width, 2)}. "
                "`trackroller fit next` says which test narrows it most."
            )
    texts.append(
        "B10 lies below its interval in up to some 8 % of the fits where 5 % are nominal (page "
        "'Intervals of fitted S-N lines')."
    )
    return texts


def table_of_tests(fit: MaterialFit | CatalogueFit) -> Table:
    """List the tests as they were given."""
    names = list(dict.fromkeys(name for row in fit.tests.rows for name in row))
    rows = [
        [str(fit.tests.lines[i]), *(fit.tests.text(i, name) for name in names)] for i in fit.tests
    ]
    return Table("fit_tests", "Tests", ["Row", *names], rows)


def write_fit(fit: MaterialFit, path: Path | str) -> Path:
    """Write the page of a fit as one HTML file that stands alone, or as PDF by the name of the
    file.

    Parameters
    ----------
    fit : MaterialFit
        Result of `trackroller.fit_sn`, `trackroller.fit_bench` or
        `trackroller.fit.depths.fit_wear`.
    path : Path or str
        The file to write.

    Returns
    -------
    Path
        The file.
    """
    from trackroller.report.figures import fit as figures  # heavy: matplotlib

    drawn = pictures(
        partial(figures.sn_line, fit), partial(figures.predicted, fit), partial(figures.pairs, fit)
    )
    under = [f"{capital(key.replace('_', ' '))}: {value}" for key, value in fit.given.items()]
    digest = ""
    if fit.tests.digest:
        digest = f", sha256 {fit.tests.digest[:16]}"
    content = {
        "name": fit.name,
        "synthetic": SYNTHETIC in fit.tests.name.lower(),
        "said": sentences(fit),
        "figures": list(drawn.values()),
        "values": value_table(fit),
        "cannot": cannot_tell(fit),
        "under": under,
        "tests": table_of_tests(fit),
        "source": f"{len(fit.tests)} tests of {fit.tests.name}{digest}",
        "versions": versions_text(),
    }
    return html.write_page(Path(path), html.render("fit.html.j2", content))


def next_rows(ds: xr.Dataset, most: int = 8) -> tuple[list[str], list[list[str]]]:
    """Return heads and cells of the best candidates of `trackroller.next_tests`, the best first."""
    varied = [str(name) for name in ds.attrs["varied"]]
    heads = [
        "Candidate",
        *(heading(name) for name in varied),
        "Stress [MPa]",
        "Hours",
        "Travel [km]",
        "B10 spans",
    ]
    rows = []
    for i in np.argsort(ds["deviation"].values, kind="stable")[:most]:
        own = ds.isel(candidate=int(i))
        rows.append(
            [
                str(int(i) + 1),
                *(cell(float(own[name])) for name in varied),
                *(rounded(float(own[name])) for name in ("stress", "hours", "travel")),
                _factor(ds, float(own["deviation"])),
            ]
        )
    return heads, rows


def _factor(ds: xr.Dataset, deviation: float) -> str:
    """Write the high over the low end of B10 after tests that leave so much of the deviation of its
    logarithm.

    The interval by the tests so far narrows as the deviation does.
    """
    low, high = np.log(ds["interval_now"].values)
    if math.isfinite(high - low):
        width = high - low
    else:
        width = 2.0 * 1.645 * float(ds["deviation_now"])
    return (
        "a factor of "
        f"{rounded(math.exp(min(width * deviation / float(ds['deviation_now']), 50.0)), 2)}"
    )


def next_sentences(ds: xr.Dataset) -> list[str]:
    """Return sentences on the plan of `trackroller.next_tests`."""
    chosen = [str(int(i) + 1) for i in ds["chosen"].values]
    now, after, random = (
        _factor(ds, float(d))
        for d in (ds["deviation_now"], ds["deviation_after"][-1], ds["deviation_random"])
    )
    hours = float(ds["hours"].values[ds["chosen"].values].sum())
    low, high = ds["interval_now"].values
    if math.isinf(low):
        known = "without end"
    elif math.isfinite(high):
        known = f"{rounded(low)} to {rounded(high)} h"
    else:
        known = f"at least {rounded(low)} h"
    return [
        f"B10 of the design is {known} by the tests so far (90 %), {now} between both ends.",
        f"Test {listing([f'candidate {i}' for i in chosen])}, about {rounded(hours)} h in all: on "
        f"average that leaves {after}. As many random candidates leave {random}.",
    ]


def until_sentences(ds: xr.Dataset, factor: float) -> list[str]:
    """Return sentences on how many more tests are needed, from the campaigns of `tests_until`."""
    tests = ds["tests"].values
    hours = ds["hours"].values
    most = int(ds.attrs["most"])
    if not tests.max() > 0:
        return [
            f"The ends of B10 lie within a factor of {cell(factor)} already: no further test "
            "is needed."
        ]
    ends = np.quantile(tests, (0.05, 0.5, 0.95), method="inverted_cdf")
    if math.isinf(ends[1]):
        many = int(np.isinf(tests).sum())
        return [
            f"For a factor of {cell(factor)} more than {most} tests are needed, in {many} of "
            f"{len(tests)} simulated campaigns that repeat this plan. Give other candidates, or a "
            "wider factor."
        ]
    low, middle, high = (
        str(int(end)) if math.isfinite(end) else f"more than {most}" for end in ends
    )
    times = np.quantile(hours, (0.05, 0.5, 0.95), method="inverted_cdf")
    longest = "h or more"
    if math.isfinite(times[2]):
        longest = f"to {rounded(times[2], 2)} h"
    return [
        f"For a factor of {cell(factor)} about {middle} more tests are needed, "
        f"{rounded(times[1], 2)} h of testing.",
        f"That is the median of {len(tests)} simulated campaigns that repeat this plan, each by a "
        f"line that the tests allow; nine of ten need {low} to {high} tests, "
        f"{rounded(times[0], 2)} {longest}. Ask again after each test.",
    ]
