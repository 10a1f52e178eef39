"""Sentences and tables on targets and design points: probabilities of targets, B10, regimes and percentiles."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.damage.sn_curve import DEVIATES_10_TO_90
from trackroller.parameters import REGIME_LABELS, REGIMES
from trackroller.report.numbers import (
    Life,
    as_given,
    capital,
    chance,
    head_unit,
    level_text,
    long_name,
    number,
    part_of,
    percent,
    quantity,
    rounded,
    setting,
)
from trackroller.report.tables.table import Table
from trackroller.report.words.accuracy import FRICTION_OUTPUTS
from trackroller.report.words.sentence import Sentence, phrase, say
from trackroller.results.ranking import best_points, estimate, main_lives, method_of
from trackroller.results.results import Results
from trackroller.roller.output_names import is_life
from trackroller.study.design.entries import OPTION_FACTORS
from trackroller.study.design.levels import in_words


def target_words(table: xr.Dataset, target: int) -> str:
    """Name a target: 'life of the roller of at least 500 h', 'slip from 0.1 to 0.2', 'all targets'."""
    part = table.isel(target=target)
    name, unit = str(part["target_name"].item()), str(part["target_units"].item())
    low, high = float(part["target_min"]), float(part["target_max"])
    if np.isfinite(low) and np.isfinite(high):
        return f"{name} from {as_given(low, unit)} to {as_given(high, unit)}"
    if np.isfinite(low):
        return f"{name} of at least {as_given(low, unit)}"
    return f"{name} of at most {as_given(high, unit)}" if np.isfinite(high) else name


def _whole(table: xr.Dataset) -> str:
    """Return the words for the rows of a design whose shares have no interval; '' for a random sample."""
    method = method_of(table)
    return "" if method is None else method.whole


def _by_tests(table: xr.Dataset, number: int) -> str:
    """Say how far the tests of fitted materials leave a probability over all cases open; '' without tests."""
    if "tests_low" not in table or np.isnan(float(table["tests_low"][number])):
        return ""
    low, high = (percent(float(table[f"tests_{end}"][number])).removesuffix(" %") for end in ("low", "high"))
    words = table["tests_low"].attrs
    over = f"over all cases {low} to {high} % by the {words['tests']} tests of {words['materials']}"
    return f"{capital(target_words(table, number))}: {over}."


def b10_by_tests(table: xr.Dataset) -> Sentence | None:
    """State the life that 90 % of all cases of a sample reach, with its band by the tests; None without."""
    if "b10_tests" not in table or "point" in table["b10_tests"].dims:
        return None
    part = table.isel(life=0)
    low, middle, high = (float(part[name]) for name in ("b10_tests_low", "b10_tests", "b10_tests_high"))
    if not 0.0 < low <= high < np.inf:
        return None
    words = {"name": str(part["life_name"].item()), **part["b10_tests"].attrs}
    unit = str(part["life_units"].item())
    return say(
        "targets", "b10_by_tests", **words, middle=quantity(middle, unit), low=rounded(low), high=quantity(high, unit)
    )


def _cell(part: xr.Dataset, kind: str, place: int | None) -> str:
    estimates = estimate(part, f"{kind}_probability")
    return chance(*(estimates if place is None else estimates[:, place]))


def _level_words(part: xr.Dataset, level: int) -> str:
    """Name a level, or the range of a class: 'friction coefficient 0.1 to 0.15'."""
    name, text = str(part["level_factor"][level].item()), str(part["level_text"][level].item())
    low, high = float(part["level_low"][level]), float(part["level_high"][level])
    if text or low == high:
        return setting(name, text or low)
    return f"{long_name(name)} {number(low)} to {level_text(name, high, words=False)}"


def point_words(table: xr.Dataset, point: int) -> str:
    """Name a design point: 'profile ratio 1.1, contact angle 30°'."""
    names = [n for n in str(table.attrs.get("outer_factors", "")).split(", ") if n]
    values = [table[name].values[point] for name in names]
    said = [setting(n, v if isinstance(v, str) else float(v)) for n, v in zip(names, values, strict=True)]
    return ", ".join(said) or "the one design point"


MAX_POINTS = 24  # rows of the table of design points


def target_tables(table: xr.Dataset, results: Results) -> list[Table]:
    """List the probability of each target at each design point (or in all cases), and at each level of a factor.

    The rows of a table, or of several contact models, are not told apart by levels. Where designs repeat over
    conditions, a column counts the designs that meet all targets in all their conditions.
    """
    if "target_probability" not in table:
        return []
    targets = range(table.sizes["target"])
    sure = "share of the cases" if _whole(table) else "95 % interval"
    heads = [f"{capital(target_words(table, t))} ({sure})" for t in targets]
    said = ["A case that does not hold, or has no value, misses every target."]
    if results.ranged and results.judged_targets:
        said.append("A life that is a range counts by its low end.")
    if (results.valid & results.any_limit_in("open")).any():
        said.append("A limit that a placeholder leaves open counts as kept.")
    if float(table.attrs.get("log_life_scatter", 0.0)) > 0:
        said.append("Lives hold the material's own scatter.")
    said += filter(None, (_by_tests(table, t) for t in targets))
    apart = not results.config.method.observed and not set(OPTION_FACTORS) & set(results.factors)
    places = range(table.sizes.get("target_level", 0) if apart else 0)
    levels = [[capital(_level_words(table, i)), *_cells(table, "level", i)] for i in places]
    title = "Targets by level of a factor" if levels else "Targets"
    if table["target_probability"].ndim == 1:
        rows = [["All cases", *_cells(table, "target")], *levels]
        if met := _designs_that_meet(table, results)[: len(rows)]:  # a table shows no levels
            heads.insert(0, "Designs that meet all in all conditions")
            rows = [[row[0], count_of, *row[1:]] for row, count_of in zip(rows, met, strict=True)]
        return [Table("targets", title, ["Level", *heads], rows, " ".join(said))]
    order = np.argsort(-table["target_probability"].values[-1], kind="stable")
    rows = [[capital(point_words(table, int(p))), *_cells(table, "target", int(p))] for p in order[:MAX_POINTS]]
    if len(order) > len(rows):
        said.append(f"{len(order) - len(rows)} more design points are in sensitivity.nc.")
    tables = [Table("targets", "Targets: probability by design point", ["Design point", *heads], rows, " ".join(said))]
    note = "Mean over the design points at each level."
    return [*tables, Table("targets_levels", title, ["Level", *heads], levels, note)] if levels else tables


def _cells(table: xr.Dataset, kind: str, place: int | None = None) -> list[str]:
    return [_cell(table.isel(target=t), kind, place) for t in range(table.sizes["target"])]


def _designs_that_meet(table: xr.Dataset, results: Results) -> list[str]:
    """Write how many designs meet all targets in all their conditions: of all designs, then at each level of a choice.

    A level of a condition has a dash. The list is empty where designs do not repeat over conditions.
    """
    candidates = results.candidates()
    if candidates is None or not (candidates.comparable and candidates.conditions and candidates.choices):
        return []
    met = candidates.targets_met()
    if met is None:
        return []
    found = results.verdict  # what a range, an error or an untried row leaves open is not met
    every, chosen = met[0] == met[1], [np.ones(len(met[0]), dtype=bool)]
    every[[one.number for one in found.candidates if one.status != "met"] if found is not None else []] = False
    choices = candidates.table.sort_index()
    for i in range(table.sizes.get("target_level", 0)):
        name, text = str(table["level_factor"][i].item()), str(table["level_text"][i].item())
        own = choices[name] if name in choices else None
        low, high = float(table["level_low"][i]), float(table["level_high"][i])
        at = (
            np.zeros(len(every), dtype=bool)
            if own is None
            else [in_words(name, v) == text for v in own]
            if text
            else own.between(low, high)
        )
        chosen.append(np.asarray(at))
    return [part_of(every[at].sum(), at.sum()) if at.any() else "–" for at in chosen]


OTHERS = dict(zip(REGIMES[1:], REGIME_LABELS[1:], strict=True))  # names of the regimes in which no roller rolls


def robust_tables(table: xr.Dataset, error: Sentence | None) -> list[Table | None]:
    """List every analysed output of an inner/outer design by design point: lives first, the best point on top."""
    lives = main_lives(table)
    others = [n for n in map(str, table["output"].values) if not is_life(n)]
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
        if "b10_tests_low" in table and output in table["life"].values:
            ends = [float(table[f"b10_tests_{end}"].sel(life=output)[p]) for end in ("low", "high")]
            row[f"B10, 90 % by the {table['b10_tests'].attrs['tests']} tests"] = " to ".join(map(rounded, ends))
        row["B10, other cases as life 0"] = life_at(part, p, float(part["b10_safe"][p]))
        for regime in seen:
            chances = estimate(table.sel(regime=regime), "probability")[:, p]
            row[f"{capital(OTHERS[regime])} (95 % interval)"] = chance(*chances)
        rows.append(row)
    least = float(table.attrs.get("least_log_life_scatter", scatter))
    values = {
        "spread": 10 ** (DEVIATES_10_TO_90 * scatter),
        "least": 10 ** (DEVIATES_10_TO_90 * least),
    }
    note = phrase("targets", "b10_note", **values, left=table.sizes["point"] - MAX_POINTS)
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
        lives = {head: life_at(part, p, value) for head, value in values.items()} if is_life(output) else values
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
