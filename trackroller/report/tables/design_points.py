"""Tables of the design points of an inner/outer design: B10, regimes and percentiles."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.analysis.ranking import best_points, estimate, main_lives
from trackroller.damage.sn_curve import DEVIATES_10_TO_90
from trackroller.parameters import REGIME_LABELS, REGIMES
from trackroller.report.numbers import Life, capital, chance, head_unit, listing, rounded
from trackroller.report.tables.table import Table
from trackroller.report.words.accuracy import FRICTION_OUTPUTS
from trackroller.report.words.sentence import Sentence
from trackroller.report.words.targets import MAX_POINTS, point_words

OTHERS = dict(zip(REGIMES[1:], REGIME_LABELS[1:], strict=True))  # regimes in which the roller does not roll, in words


def robust_tables(table: xr.Dataset, error: Sentence | None) -> list[Table | None]:
    """List every analysed output of an inner/outer design by design point: lives first, the best point on top."""
    lives = main_lives(table)
    others = [n for n in map(str, table["output"].values) if "life" not in n]
    others = others if table.attrs.get("outputs_named") or not lives else []
    first = np.arange(min(table.sizes["point"], MAX_POINTS))
    tables = [part for n in lives for part in _life_tables(table, n)]
    return tables + [_point_table(table, n, error, first) for n in others]


def _life_tables(table: xr.Dataset, output: str) -> list[Table | None]:
    """Return the tables of B10, regimes and percentiles of the design points.

    Percentiles have a table of their own where B10 holds the scatter of the material, because they do not hold it.
    """
    part, scatter = table.sel(output=output), float(table.attrs.get("log_life_scatter", 0.0))
    points = best_points(part)[:MAX_POINTS]
    seen = [r for r in OTHERS if float(table["probability"].sel(regime=r).max()) > 0]
    rows = []
    for p in map(int, points):
        b10, low, high = map(float, estimate(part, "b10")[:, p])
        row = {"Design point": capital(point_words(table, p)), "B10": life_at(part, p, b10)}
        row["B10, 95 % interval"] = f"{rounded(low)} to {rounded(high)}" if np.isfinite(high) else "–"
        row["B10, other cases as life 0"] = life_at(part, p, float(part["b10_safe"][p]))
        for regime in seen:
            chances = estimate(table.sel(regime=regime), "probability")[:, p]
            row[f"{capital(OTHERS[regime])} (95 % interval)"] = chance(*chances)
        rows.append(row)
    own = f"B10 holds the material's own scatter of life, T_N = {rounded(10 ** (DEVIATES_10_TO_90 * scatter))}."
    note = own if scatter > 0 else "B10 holds the scatter of the study's factors alone, not that of the material."
    if never := [r for r in OTHERS if r not in seen]:
        high = 100 * float(table["probability_high"].sel(regime=never).max())
        shown = listing([OTHERS[r] for r in never], "or")
        note += f" No case shows {shown}: its probability is below {high:.2g} % at each design point (95 % confidence)."
    if (left := table.sizes["point"] - MAX_POINTS) > 0:
        note += f" {left} more design points are in sensitivity.nc."
    name, unit = capital(str(part["output_name"].item())), head_unit(str(part["output_units"].item()))
    first = Table.of(f"b10_{output}", f"{name}: B10 [{unit}], best design points first", rows, note)
    return [first, _point_table(table, output, None, points)]


def _point_table(table: xr.Dataset, output: str, error: Sentence | None, points: np.ndarray) -> Table | None:
    """Return the mean and percentiles of an output at each design point, by the scatter of the study's factors only."""
    part = table.sel(output=output)
    columns = {"Mean": part["mean"]}
    columns |= {f"{q:.0f} %": part["percentile_value"].sel(percentile=q) for q in (5.0, 50.0, 95.0)}
    rows = []
    for p in map(int, points):
        values = {head: float(column[p]) for head, column in columns.items()}
        lives = {head: life_at(part, p, value) for head, value in values.items()} if "life" in output else values
        rows.append({"Design point": capital(point_words(table, p)), **lives})
    name, unit = capital(str(part["output_name"].item())), head_unit(str(part["output_units"].item()))
    note = "Rolling cases; scatter of the study's factors alone, without that of the material."
    note += f" {error.text}" if error and output in FRICTION_OUTPUTS else ""
    return Table.of(f"percentiles_{output}", f"{name} [{unit}]: mean and percentiles", rows, note)


def life_at(part: xr.Dataset, point: int, value: float) -> Life:
    """Return a life of a design point, marked if lives beyond the S-N data enter it.

    With the material's own scatter B10 lies below the lives that it rests on: then the life that nine of ten conditions
    reach decides.
    """
    least = float(part["percentile_value"].sel(percentile=10.0)[point]) if value > 0 else 0.0
    value = float(value)
    rests = max(value, least) if value == float(part["b10"][point]) else value
    return Life(value, bool(rests >= float(part["beyond_data"][point])))
