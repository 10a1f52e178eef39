"""Tables of the design points of an inner/outer design: B10, regimes and percentiles."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.analysis.ranking import best_points, estimate, main_lives
from trackroller.damage.sn_curve import DEVIATES_10_TO_90
from trackroller.parameters import REGIME_LABELS, REGIMES
from trackroller.report.numbers import Life, capital, chance, head_unit, listing, rounded
from trackroller.report.tables.table import Table
from trackroller.report.tables.targets import MAX_POINTS
from trackroller.report.words.accuracy import FRICTION_OUTPUTS
from trackroller.report.words.sentence import Sentence
from trackroller.report.words.targets import point_words

OTHERS = dict(zip(REGIMES[1:], REGIME_LABELS[1:], strict=True))  # regimes in which the roller does not roll, in words


def robust_tables(table: xr.Dataset, error: Sentence | None) -> list[Table]:
    """List every analysed output of an inner/outer design by design point: lives first, the best point on top."""
    names = [str(n) for n in table["output"].values]
    asked = table.attrs.get("outputs_named")
    lives = main_lives(table)
    others = [n for n in names if "life" not in n] if asked or not lives else []
    tables = [part for n in lives for part in _life_tables(table, n)]
    return tables + [_point_table(table, n, error) for n in others]


def _life_tables(table: xr.Dataset, output: str) -> list[Table]:
    """Return the tables of B10, regimes and percentiles of the design points.

    Percentiles have a table of their own where B10 holds the scatter of the material, because they do not hold it.
    """
    part, scatter = table.sel(output=output), float(table.attrs.get("log_life_scatter", 0.0))
    points = best_points(part)[:MAX_POINTS]
    seen = [r for r in OTHERS if float(table["probability"].sel(regime=r).max()) > 0]
    heads = ["Design point", "B10", "B10, 95 % interval", "B10, other cases as life 0"]
    heads += [f"{capital(OTHERS[r])} (95 % interval)" for r in seen]
    rows = []
    for p in map(int, points):
        b10, low, high = map(float, estimate(part, "b10")[:, p])
        span = f"{rounded(low)} to {rounded(high)}" if np.isfinite(high) else "–"
        chances = [chance(*estimate(table.sel(regime=r), "probability")[:, p]) for r in seen]
        lives = [life_at(part, p, value) for value in (b10, float(part["b10_safe"][p]))]
        rows.append([capital(point_words(table, p)), lives[0], span, lives[1], *chances])
    unit = head_unit(str(part["output_units"].item()))
    name = capital(str(part["output_name"].item()))
    own = f"B10 holds the material's own scatter of life, T_N = {rounded(10 ** (DEVIATES_10_TO_90 * scatter))}."
    note = own if scatter > 0 else "B10 holds the scatter of the study's factors alone, not that of the material."
    if never := [r for r in OTHERS if r not in seen]:
        high = 100 * float(table["probability_high"].sel(regime=never).max())
        shown = listing([OTHERS[r] for r in never], "or")
        note += f" No case shows {shown}: its probability is below {high:.2g} % at each design point (95 % confidence)."
    if (left := table.sizes["point"] - MAX_POINTS) > 0:
        note += f" {left} more design points are in sensitivity.nc."
    first = Table(f"b10_{output}", f"{name}: B10 [{unit}], best design points first", heads, rows, note)
    return [first, _point_table(table, output, None, points)]


def _point_table(table: xr.Dataset, output: str, error: Sentence | None, points: np.ndarray | None = None) -> Table:
    """Return the mean and percentiles of an output at each design point, by the scatter of the study's factors only."""
    part = table.sel(output=output)
    points = np.arange(min(table.sizes["point"], MAX_POINTS)) if points is None else points
    shares, life = (5.0, 50.0, 95.0), "life" in output
    rows = []
    for p in map(int, points):
        spread = [float(part["percentile_value"].sel(percentile=q)[p]) for q in shares]
        values = [float(part["mean"][p]), *spread]
        rows.append([capital(point_words(table, p)), *([life_at(part, p, v) for v in values] if life else values)])
    heads = ["Design point", "Mean", *(f"{q:.0f} %" for q in shares)]
    name, unit = capital(str(part["output_name"].item())), head_unit(str(part["output_units"].item()))
    note = "Rolling cases; scatter of the study's factors alone, without that of the material."
    note += f" {error.text}" if error and output in FRICTION_OUTPUTS else ""
    return Table(f"percentiles_{output}", f"{name} [{unit}]: mean and percentiles", heads, rows, note)


def life_at(part: xr.Dataset, point: int, value: float) -> Life:
    """Return a life of a design point, marked if lives beyond the S-N data enter it.

    With the material's own scatter B10 lies below the lives that it rests on: then the life that nine of ten conditions
    reach decides.
    """
    least = float(part["percentile_value"].sel(percentile=10.0)[point]) if value > 0 else 0.0
    value = float(value)
    rests = max(value, least) if value == float(part["b10"][point]) else value
    return Life(value, bool(rests >= float(part["beyond_data"][point])))
