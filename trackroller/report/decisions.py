"""What the report says for a decision: sensitivities, best designs, design points where conditions scatter."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.damage.fatigue import DECADES
from trackroller.report.comparison import report_section
from trackroller.report.figures import style

if TYPE_CHECKING:
    import xarray as xr

log = logging.getLogger(__name__)
MAX_DESIGNS = 12  # rows of the table of the Pareto set
MAX_POINTS = 24  # rows of the table of design points
OTHERS = {"full_slip": "full slip", "lift_off": "lift-off", "failed": "failure"}
MEASURES = (
    ("S1", "Sobol index, alone"),
    ("ST", "Sobol index, total"),
    ("main_share", "share of variance, alone"),
    ("mu_star", "mean absolute effect μ*"),
    ("sigma", "spread of effects σ"),
    ("effect", "change over the range"),
    ("curvature", "curvature of the fit"),
    ("first", "share of variance, given data"),
    ("fit_alone", "share of variance, fitted polynomial"),
    ("delta", "delta"),
    ("pawn", "PAWN"),
    ("prcc", "partial rank correlation"),
)


def decisions(ds: xr.Dataset, analysis: Path | None) -> dict[str, Any]:
    """Contents of the report's sections `models`, `sensitivity`, `robust`, `pareto`; {} for what a study does not have.

    Parameters
    ----------
    ds : gathered study
    analysis : file of `trackroller.analysis.sensitivity.analyse`, if there is one
    """
    import xarray as xr

    found: dict[str, Any] = {"sensitivity": {}, "robust": {}, "pareto": {}}
    if analysis is not None and Path(analysis).is_file():
        with xr.open_dataset(analysis) as opened:
            sens = opened.load()
        name = "robust" if sens.attrs.get("method") == "inner_outer" else "sensitivity"
        found[name] = _guarded(robust_points if name == "robust" else sensitivity, sens)
    found["pareto"] = _guarded(pareto_designs, ds)
    found["models"] = _guarded(report_section, ds)
    return found


def _guarded(make: Any, ds: xr.Dataset) -> dict[str, Any]:
    try:
        return dict(make(ds))
    except Exception as problem:  # a table never fails a report
        log.warning("%s is left out of the report: %s", make.__name__, problem, exc_info=True)
        return {}


def sensitivity(sens: xr.Dataset) -> dict[str, Any]:
    """Ranking of the factors for each analysed output, with intervals, in words and as tables."""
    from trackroller.report import sentences as words
    from trackroller.report.figures.sensitivity import effect_unit, main_outputs

    rows = []
    for output in map(str, sens["output"].values):
        part = sens.sel(output=output)
        ranks = [
            f"{r.name} {_value(r.value, r.low, r.high)}"
            for r in words.order(sens, output)[:4]
            if r.value > 0 or (r.value and words.headline(sens) in words.SIGNED)
        ]
        advice = words.advice_of(sens, output)
        unit = f" [{effect_unit(sens, output)}]" if words.headline(sens) in ("mu_star", "effect") else ""
        rows.append((words.upper(words.of_output(sens, output)) + unit, ranks, str(part["note"].item()), advice))
    index = words.headline(sens)
    return {
        "method": str(sens.attrs.get("method", "")),
        "index": str(sens[index].attrs.get("long_name", index)),
        "rows": rows,
        "sentence": words.overview(sens),
        "needs": str(sens.attrs.get("needs", "")),
        "treatment": str(sens.attrs.get("treatment", "")),
        "measures": [measures(sens, name) for name in main_outputs(sens, 2)],
    }


def measures(sens: xr.Dataset, output: str) -> dict[str, Any]:
    """Every index of every factor on one output, with 95 % intervals; those within chance are put in brackets."""
    from trackroller.report import sentences as words

    part = sens.sel(output=output)
    shown = [(key, text) for key, text in MEASURES if key in part and np.isfinite(part[key]).any()]
    ranks = words.order(sens, output)
    rows = []
    for rank in ranks:
        one = part.sel(factor=rank.factor)
        cells = []
        for key, _ in shown:
            low, high = (float(one[f"{key}_{end}"]) if f"{key}_{end}" in one else np.nan for end in ("low", "high"))
            value = max(0.0, float(one[key])) if key == "first" else float(one[key])  # no share is below nothing
            text = _value(value, low, high)
            noise = float(one[f"{key}_noise"]) if f"{key}_noise" in one else np.nan
            cells.append(f"({text})" if float(one[key]) <= noise else text)
        rows.append((words.upper(rank.name), cells))
    return {"title": words.upper(words.of_output(sens, output)), "columns": [text for _, text in shown], "rows": rows}


def _value(value: float, low: float = np.nan, high: float = np.nan) -> str:
    """0.61 ± 0.03."""
    if not np.isfinite(value):
        return "–"
    half = max(high - value, value - low)  # an interval may end at 0
    if not np.isfinite(half):
        return style.rounded(value, 3)
    digits = max(0, 1 - int(np.floor(np.log10(half)))) if half > 0 else 3
    return f"{value:.{min(digits, 6)}f} ± {half:.{min(digits, 6)}f}".replace("-", "−")


def robust_points(table: xr.Dataset) -> dict[str, Any]:
    """Design points with their life and how often they slip or lift off, the best first."""
    from trackroller.report import sentences as words

    lives = [str(n) for n in table["output"].values if "life" in str(n)]
    lives = [n for n in lives if np.isfinite(table["percentile_value"].sel(output=n)).any()] or lives
    tables = [_points(table, name) for name in lives[:2]]
    scatter = float(table.attrs.get("log_life_scatter", 0.0))
    text = "B10 holds the scatter of the study's factors alone, not that of the material."
    if scatter > 0:
        text = f"B10 holds the material's own scatter of life, T_N = {style.rounded(10 ** (DECADES * scatter), 3)}."
    return {
        "tables": tables,
        "sentence": " ".join(words.robustness(table, name) for name in lives[:2]),
        "scatter": text,
        "samples": int(table.attrs.get("inner_samples", 0)),
        "treatment": words.upper(str(table.attrs.get("treatment", ""))),
        "inner": str(table.attrs.get("inner_factors", "")).replace("_", " "),
    }


def _points(table: xr.Dataset, output: str) -> dict[str, Any]:
    from trackroller.report import sentences as words

    part = table.sel(output=output)
    key = np.lexsort((-np.nan_to_num(part["b10"].values), -np.nan_to_num(part["b10_safe"].values)))
    share = part["percentile_value"].sel
    seen = [r for r in OTHERS if float(table["probability"].sel(regime=r).max()) > 0]
    rows = []
    for p in key[:MAX_POINTS]:
        b10, low, high = (float(part[n][p]) for n in ("b10", "b10_low", "b10_high"))
        spread = [style.rounded(float(share(percentile=q)[p]), 3) for q in (5.0, 50.0, 95.0)]
        chances = [_chance(table, regime, int(p)) for regime in seen]
        interval = f" ({style.rounded(low, 3)} … {style.rounded(high, 3)})" if np.isfinite(high) else ""
        rows.append(
            (
                words.upper(words.point_words(table, int(p))),
                [f"{style.rounded(b10, 3)}{interval}", style.rounded(float(part["b10_safe"][p]), 3), *spread, *chances],
            )
        )
    unit = style.unit_text(str(part["output_units"].item()))
    never = [OTHERS[r] for r in OTHERS if r not in seen]
    high = 100 * float(table["probability_high"].sel(regime=[r for r in OTHERS if r not in seen]).max()) if never else 0
    said = f"No case of any point shows {words.listing(never)}: below {high:.2g} % at each (95 %)." if never else ""
    return {
        "title": words.upper(str(part["output_name"].item())),
        "unit": unit,
        "rows": rows,
        "never": said,
        "columns": [words.upper(OTHERS[r]) for r in seen],
        "left": max(0, table.sizes["point"] - MAX_POINTS),
    }


def _chance(table: xr.Dataset, regime: str, point: int) -> str:
    value, low, high = (
        100 * float(table[n].sel(regime=regime)[point]) for n in ("probability", "probability_low", "probability_high")
    )
    return f"{value:.3g} % ({low:.2g} … {high:.2g})" if value else f"0 (below {high:.2g} %)"


def pareto_designs(ds: xr.Dataset) -> dict[str, Any]:
    """The designs that no other beats, along the first goal."""
    from trackroller.analysis.pareto import study_pareto
    from trackroller.report import sentences as words

    front = study_pareto(ds)
    if front is None:
        return {}
    goals = [tuple(item.split(" ")) for item in front.attrs["objectives"].split(", ")]
    best = np.flatnonzero(front["optimal"].values == 1)
    first, way = goals[0]
    best = best[np.argsort(front[first].values[best] * (-1 if way == "max" else 1), kind="stable")]
    along = np.linspace(0, len(best) - 1, min(MAX_DESIGNS, len(best)))
    shown = best[np.unique(along.astype(int))]
    names = [n for n, _ in goals]
    others = [str(n) for n in front.data_vars if n not in names and n != "optimal"]
    columns = [*names, *others]
    arrows = {name: " ↑" if way == "max" else " ↓" for name, way in goals}
    return {
        "columns": [_heading(front, n) + arrows.get(n, "") for n in columns],
        "rows": [(int(front["row"][i]), [_cell(n, front[n].values[i]) for n in columns]) for i in shown],
        "sentence": words.pareto(front),
        "count": len(best),
        "constraints": str(front.attrs.get("constraints", "")),
        "goals": words.upper(
            "; ".join(f"{_words(front, n)} as {'high' if w == 'max' else 'low'} as possible" for n, w in goals)
        ),
    }


def _words(front: xr.Dataset, name: str) -> str:
    return str(front[name].attrs.get("long_name") or style.long_name(name))


def _heading(front: xr.Dataset, name: str) -> str:
    units = str(front[name].attrs.get("units", "")) or (style.PARAMETERS[name].unit if name in style.PARAMETERS else "")
    text = style.capital(_words(front, name))
    return style.with_unit(text, units) if units and units != "1" else text


def _cell(name: str, value: Any) -> str:
    return style.level_text(name, value if isinstance(value, str) else float(value) + 0.0, unit=False)  # -0 is 0
