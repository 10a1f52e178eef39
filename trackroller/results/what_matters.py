"""Which factors matter: the answer to a sensitivity analysis, a screening or a response surface."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.parameters import REGIMES
from trackroller.parameters.carriage_fields import long_name_of
from trackroller.results.answer import Answer, Column, Curve
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.comparison import Comparison, compared_output
from trackroller.results.effect_curves import Effects
from trackroller.results.ends_by_factor import ends_by_factor
from trackroller.results.factor_levels import BINS, groups
from trackroller.results.ranking import estimate, headline, index_words, order, robust_design
from trackroller.results.requirement import required_of
from trackroller.results.sensitivity import analysis_of
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.study_facts import (
    case_cautions,
    checks_left_out,
    facts_of,
    given_for_nothing,
    not_given_words,
)
from trackroller.results.subgroups import level_text
from trackroller.roller.output_names import is_life
from trackroller.study.design.factor_names import OPTION_FACTORS
from trackroller.study.outputs import default_names

# indices of pairs of factors, the most exact first
PAIRED = ("S2", "interaction_share", "interaction")
ROUNDING = 1e-12  # of the largest effect: a smaller one is 0 but for rounding
OF_GROUPS = "group_ST"  # total index of a group of factors
WORTH = 0.02  # of the variance: a smaller interaction is not named


def shown_ranges(results: SolvedCases) -> CaseRanges | None:
    """Return the output that a study without candidates is about: its first wanted one, its life or
    a stress.
    """
    required = required_of(results)
    named = [name for name in results.config.analysis.outputs or () if name not in REGIMES]
    if named and not required:
        _, units, words = results.quantity(named[0])
        life = results.life
        if life is not None and named[0] == life[0]:
            return CaseRanges(results, life, True)
        return CaseRanges(results, (named[0], words, units), is_life(named[0]))
    compared = compared_output(results, required)
    if compared is not None:
        return CaseRanges(results, *compared)
    for name in default_names(results.data, results.design.factors, results.dims):
        _, units, words = results.quantity(name)
        return CaseRanges(results, (name, words, units), False)
    return None


def answer_what_matters(results: SolvedCases) -> Answer:
    """Return which factors of a study matter for its output, the largest effect first.

    Parameters
    ----------
    results : SolvedCases
        A solved study.

    Notes
    -----
    `kind` is `indices` where the method has them for this output, otherwise `curves`. The total
    index ranks the factors of a Saltelli design; the height of their curves ranks all others.
    Where a study asks for groups of factors (`analysis.groups`), a row is a group with its total
    index, and the curve is that of its member with the largest effect.
    """
    ranges = shown_ranges(results)
    assert ranges is not None
    effects = Effects.of(ranges)
    curves = effects.curves()
    sens = _indices(results, ranges)
    table = _table(results, ranges, curves)
    if sens is not None and OF_GROUPS in sens:
        table = _by_group(table, sens.sel(output=ranges.output[0]), curves)
    rows = results.of_one_model()
    kind = "indices"
    if sens is None:
        kind = "curves"
    return Answer(
        question="what matters",
        kind=kind,
        headline={
            "factors": [_named(table, curves, place) for place in range(min(2, len(table)))],
            **_met_by(results, rows),
        },
        output=ranges.output,
        table=table,
        columns=_columns(ranges, table, sens, effects.by_ratio),
        required=required_of(results),
        curves=_in_order(curves, table),
        ends=ends_by_factor(results, ranges),
        picture=pair_shares(sens, ranges.output[0]),
        not_checked=checks_left_out(results),
        not_used=given_for_nothing(results),
        not_given=not_given_words(results),
        warnings=tuple(case_cautions(results, ranges, rows)),
        facts=facts_of(results),
    )


def _indices(results: SolvedCases, ranges: CaseRanges) -> xr.Dataset | None:
    """Return the analysis of a study if it has indices that are shares of variance, or elementary
    effects.
    """
    sens = analysis_of(results)
    name = ranges.output[0]
    if sens is None or robust_design(sens) or name not in sens["output"].values:
        return None
    if order(sens, name) and headline(sens) in sens:
        return sens
    return None


def _by_group(table: pd.DataFrame, part: xr.Dataset, curves: tuple[Curve, ...]) -> pd.DataFrame:
    """Return one row a group of factors: its indices, and the curve of the member with the largest
    effect.
    """
    place = {curve.factor: number for number, curve in enumerate(curves)}  # the largest one first
    own = table.set_index("name", drop=False)
    value, low, high = estimate(part, OF_GROUPS).clip(0.0, 1.0)
    rows = []
    for number, title in enumerate(part["group_name"].values):
        words = str(part["group_members"].values[number])
        members = [name for name in own.index if long_name_of(name) in words.split(", ")]
        first = min(members, key=lambda name: place.get(name, len(place)))
        row = own.loc[first].to_dict()
        row |= {"factor": str(title), "members": words, "largest": long_name_of(first)}
        row |= {"index": value[number], "index_low": low[number], "index_high": high[number]}
        row |= {"lost": int(own.loc[members, "lost"].max()), "interacts": ""}
        if len(members) > 1:
            roles = own.loc[members, "role"].unique()
            row["role"] = " and ".join(roles)
        rows.append(row)
    return (
        pd.DataFrame(rows)
        .sort_values("index", ascending=False, kind="stable")
        .reset_index(drop=True)
    )


def _met_by(results: SolvedCases, rows: np.ndarray) -> dict[str, Any]:
    """Return how many cases meet the requirement, surely and perhaps; {} without one."""
    own = Comparison.of(results)
    if own is None or not own.required:
        return {}
    sure, may = own.met()
    counts = {"meets": int(sure[rows].sum()), "perhaps": int(may[rows].sum())}
    return counts | {"of": int(rows.sum())}


def _table(results: SolvedCases, ranges: CaseRanges, curves: tuple[Curve, ...]) -> pd.DataFrame:
    """Return one row a factor: index with its interval, height and shape of its curve, and both of
    its ends.
    """
    sens = _indices(results, ranges)
    known = {curve.factor: curve for curve in curves}
    lost = _lost(results, ranges)
    met = _met_at(results)
    rows = []
    for name in (n for n in results.factors if n not in OPTION_FACTORS):
        row: dict[str, Any] = {
            "factor": long_name_of(name),
            "name": name,
            "role": results.roles.get(name, ""),
            "range": _range(results, name),
            "height": np.nan,
            "shape": "",
            "at_low": np.nan,
            "at_high": np.nan,
            "lost": lost[name],
        } | met.get(name, {})
        curve = known.get(name)
        if curve is not None:
            row["height"] = curve.height
            row["shape"] = curve.shape
            row["at_low"] = float(curve.middle[0])
            row["at_high"] = float(curve.middle[-1])
        if sens is not None:
            row |= _index(sens, ranges.output[0], name)
        rows.append(row)
    table = pd.DataFrame(rows)
    by_index = sens is not None and not index_words(sens, headline(sens)).sized
    if by_index and "index" in table:
        keys = ["index", "height"]
    else:
        keys = ["height"]
    return table.sort_values(keys, ascending=False, na_position="last", kind="stable").reset_index(
        drop=True
    )


def _index(sens: xr.Dataset, output: str, name: str) -> dict[str, Any]:
    """Return the index of a factor with its interval, a share cut to 0 to 1, and the factors that
    it interacts with.
    """
    index = headline(sens)
    part = sens.sel(output=output)
    names = [str(one) for one in part["factor"].values]
    if name not in names:
        return {"index": np.nan, "index_low": np.nan, "index_high": np.nan, "interacts": ""}
    value, low, high = estimate(part, index)[:, names.index(name)]
    if index_words(sens, index).sized:
        largest = float(np.nanmax(np.abs(estimate(part, index)[0])))
        if abs(value) < ROUNDING * largest:
            value = 0.0
    else:
        value, low, high = (float(np.clip(one, 0.0, 1.0)) for one in (value, low, high))
    return {
        "index": float(value),
        "index_low": float(low),
        "index_high": float(high),
        "interacts": ", ".join(_partners(part, names.index(name))),
    }


def _partners(part: xr.Dataset, place: int) -> list[str]:
    """Return the factors whose interaction with a factor surely holds at least `WORTH` of the
    variance.
    """
    name = next((one for one in PAIRED[:2] if one in part), "")
    if not name:
        return []
    value, low, _ = estimate(part, name)
    both = np.fmax(value, value.T)
    sure = np.fmax(np.where(np.isnan(low), value, low), np.where(np.isnan(low), value, low).T)
    titles = [str(one) for one in part["factor_name"].values]
    hits = np.flatnonzero((both[place] >= WORTH) & (sure[place] > 0))
    return [titles[i] for i in hits if i != place]


def pair_shares(sens: xr.Dataset | None, output: str) -> dict[str, Any]:
    """Return the shares of variance of all pairs of factors as a matrix with its names; {} without
    them.
    """
    if sens is None:
        return {}
    part = sens.sel(output=output)
    name = next(
        (one for one in PAIRED[:2] if one in part and np.isfinite(part[one].values).any()), ""
    )
    if not name:
        return {}
    value = part[name].values.astype(float)
    return {
        "pairs": np.fmax(value, value.T),
        "titles": [str(one) for one in part["factor_name"].values],
    }


def _lost(results: SolvedCases, ranges: CaseRanges) -> dict[str, int]:
    """Return how many cases are lost (skids, lift-offs and others) between the levels of a factor,
    or its classes of equally many cases: most less fewest.
    """
    rows = results.of_one_model()
    lost = ~ranges.holds[rows]
    out = {}
    for name in results.factors:
        classes = groups(results.table, name, rows)
        counts = np.bincount(classes.index, weights=lost, minlength=len(classes))
        out[name] = int(counts.max() - counts.min())
    return out


def _met_at(results: SolvedCases) -> dict[str, dict[str, float]]:
    """Return the smallest and the largest share of cases that surely meet the requirement among the
    levels of each factor, or its classes; {} without a requirement.
    """
    own = Comparison.of(results)
    if own is None or not own.required:
        return {}
    rows = results.of_one_model()
    sure = own.met()[0][rows]
    out = {}
    for name in results.factors:
        classes = groups(results.table, name, rows)
        number = np.bincount(classes.index, minlength=len(classes))
        hits = np.bincount(classes.index, weights=sure, minlength=len(classes))
        shares = hits[number > 0] / number[number > 0]
        out[name] = {"meets_low": float(shares.min()), "meets_high": float(shares.max())}
    return out


def _range(results: SolvedCases, name: str) -> str:
    """Return the levels of a factor in words: both ends of a number, or its names."""
    levels = results.levels(name)
    if results.numeric(name) and len(levels) > 2:
        return f"{level_text(name, levels[0])} to {level_text(name, levels[-1])}"
    return ", ".join(level_text(name, level) for level in levels[:6])


def _named(table: pd.DataFrame, curves: tuple[Curve, ...], place: int) -> dict[str, Any]:
    """Return what a headline says of a factor."""
    row = table.iloc[place]
    curve = next((one for one in curves if one.factor == row["name"]), None)
    head: dict[str, Any] = {
        "title": row["factor"],
        "name": row["name"],
        "height": float(row["height"]),
    }
    if row.get("largest", row["factor"]) != row["factor"]:
        head["largest"] = row["largest"]
    head |= {key: float(row.get(key, np.nan)) for key in ("index", "index_low", "index_high")}
    if curve is not None:
        low, high = (0, len(curve.levels) - 1)
        if not curve.ordered or curve.shape in ("hump", "dip"):
            low, high = int(curve.middle.argmin()), int(curve.middle.argmax())
        head |= {
            "units": curve.units,
            "from": curve.levels[low],
            "to": curve.levels[high],
            "at_from": float(curve.middle[low]),
            "at_to": float(curve.middle[high]),
            "by_ratio": curve.by_ratio,
        }
    return head


def _in_order(curves: tuple[Curve, ...], table: pd.DataFrame) -> tuple[Curve, ...]:
    place = {name: i for i, name in enumerate(table["name"])}
    return tuple(sorted(curves, key=lambda curve: place.get(curve.factor, len(place))))


def _index_columns(ranges: CaseRanges, table: pd.DataFrame, sens: xr.Dataset) -> list[Column]:
    """Return the columns of the index of each factor, and of the factors it acts together with."""
    index = headline(sens)
    if "members" in table:
        index = OF_GROUPS
    meaning = str(sens[index].attrs.get("long_name", index))
    scale = ""
    if "scale" in sens.coords:
        scale = str(sens["scale"].sel(output=ranges.output[0]).item())
    if index_words(sens, index).sized:
        title = "Main effect"
        kind = "number"
        unit = ranges.output[2]
        if scale == "log10":
            unit = "decades"
    else:
        title = "Index"
        kind = "share"
        unit = "1"
        meaning += ", cut to 0 to 100 %"
    columns = [
        Column("index", title, unit, meaning, kind),
        Column("index_low", "95 %", unit, "interval of the index", kind, until="index_high"),
    ]
    if table["interacts"].any():
        meaning = (
            f"factors with which a pair surely holds {100 * WORTH:.0f} % of the variance or more"
        )
        columns.append(Column("interacts", "Interacts with", "", meaning, "text"))
    return columns


def _columns(
    ranges: CaseRanges, table: pd.DataFrame, sens: xr.Dataset | None, by_ratio: bool
) -> tuple[Column, ...]:
    """Return the columns of the table of factors."""
    _, words, units = ranges.output
    columns = [
        Column("factor", "Factor", "", "factor of the study", "text", role="name"),
        Column("role", "Role", "", "choice: the designer sets it. Condition: the use does", "text"),
        Column("range", "Range", "", "levels of the factor in this study", "text"),
    ]
    grouped = "members" in table
    if grouped:
        of_largest = "member of the group with the largest effect, which range and curve are of"
        columns = [
            Column(
                "factor", "Group", "", "factors that the study puts together", "text", "", "name"
            ),
            Column("members", "Factors", "", "factors of the group", "text"),
            columns[1],
            Column("largest", "Its largest", "", of_largest, "text"),
            columns[2],
        ]
    if sens is not None:
        columns += _index_columns(ranges, table, sens)
    height = Column("height", "Height", units, "largest less smallest value of the curve")
    if by_ratio:
        height = Column("height", "Height", "", "largest over smallest value of the curve", "ratio")
    columns += [
        height,
        Column(
            "at_low",
            "At the first level",
            units,
            f"{words}: the curve at the smallest or first level",
        ),
        Column(
            "at_high",
            "At the last level",
            units,
            f"{words}: the curve at the largest or last level",
        ),
        Column(
            "shape",
            "Shape",
            "",
            "rise, fall, hump, dip, cliff (in one step), groups or flat",
            "text",
        ),
        Column(
            "lost",
            "Rows lost",
            "",
            "cases that are not held: most of a level less fewest of a level; many levels stand in "
            f"{BINS} classes of equally many cases",
            "count",
        ),
    ]
    if "meets_low" in table:
        meaning = (
            "cases that surely meet the requirement: smallest and largest share of a level, or of "
            "a class"
        )
        columns.append(Column("meets_low", "Meets it", "1", meaning, "share", until="meets_high"))
    return tuple(columns)
