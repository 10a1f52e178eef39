"""Figures for decisions: Pareto front, parallel coordinates of the best designs, robustness of design points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.report import sentences as words
from trackroller.report.figures import style
from trackroller.study.design.entries import OPTION_FACTORS

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

MAX_LINES = 40
CONDITIONS = ("radial_force", "axial_force", "motor_force", "friction_coefficient", "velocity")
Drawn = tuple["Figure", style.FigureInfo] | None


def _objectives(front: xr.Dataset) -> list[tuple[str, str]]:
    return [tuple(item.split(" ")) for item in front.attrs["objectives"].split(", ")]  # type: ignore[misc]


def _given(front: xr.Dataset) -> str:
    """A warning where conditions of use are among the factors: their best value is nobody's to choose."""
    given = [
        n.replace("_", " ")
        for n in front.attrs["factors"].split(", ")
        if n in CONDITIONS or "load" in n or "drive" in n
    ]
    told = f" Treated as free to choose, though set by the use: {words.listing(given)}." if given else ""
    models = [style.long_name(n) for n in front.attrs["factors"].split(", ") if n in OPTION_FACTORS]
    if models:
        told += f" Not a choice of design but of how it is computed: {words.listing(models)}."
    return told


def _label(front: xr.Dataset, name: str) -> str:
    units, text = front[name].attrs.get("units", ""), front[name].attrs.get("long_name", name)
    return style.with_unit(words.upper(text), units) if units else style.factor_label(name)


def pareto_front(front: xr.Dataset) -> Drawn:
    """All allowed designs, those that no other beats marked: a panel for the first goal over each other one.

    Parameters
    ----------
    front : dataset of `trackroller.analysis.pareto.pareto`
    """
    goals = _objectives(front)
    if not (front["optimal"].values == 1).any():
        return None
    others = goals[1:4]
    figure = style.new_figure(22 + 48 * len(others))
    panels = figure.subplots(len(others), 1, squeeze=False)[:, 0]
    for axes, (x, up_x) in zip(panels, others, strict=True):
        _trade(axes, front, (x, up_x), goals[0], joined=len(goals) == 2)
    handles, texts = panels[0].get_legend_handles_labels()
    figure.legend(handles, texts, loc="outside lower center", ncols=2)
    style.head(figure, "Designs that no other beats", "Arrows on the axes: the wanted direction.")
    style.finish(figure)
    wanted = words.listing([f"{front[n].attrs.get('long_name') or style.long_name(n)} {_WAYS[w]}" for n, w in goals])
    limits = f" where {front.attrs['constraints']}" if front.attrs.get("constraints") else ""
    caption = (
        f"Pareto set for {wanted}; {front.sizes['row']} allowed designs of {front.attrs['rows']}{limits}. Left "
        f"out: {front.attrs['excluded']}.{_given(front)}"
    )
    return figure, style.FigureInfo("pareto-front", caption, words.pareto(front))


_WAYS = {"max": "up", "min": "down"}


def _trade(axes: Any, front: xr.Dataset, across: tuple[str, str], upwards: tuple[str, str], joined: bool) -> None:
    """One panel: a goal over another; of two goals the set is joined by the steps that bound it."""
    (x, up_x), (y, up_y) = across, upwards
    best = front["optimal"].values == 1
    xs, ys = front[x].values.astype(float), front[y].values.astype(float)
    colours = style.palette(4)
    finite = np.isfinite(xs) & np.isfinite(ys)
    rest = ~best & finite
    axes.scatter(xs[rest], ys[rest], s=5, color="0.65", marker=".", rasterized=True, label="beaten by another")
    shown = best & finite
    if joined:
        order = np.argsort(xs[shown])
        step = {"max": "steps-pre", "min": "steps-post"}[up_x]
        axes.plot(xs[shown][order], ys[shown][order], color=colours[3], linewidth=0.8, drawstyle=step)
    axes.scatter(
        xs[shown],
        ys[shown],
        s=14,
        color=colours[3],
        marker="D",
        edgecolor="0.1",
        linewidth=0.5,
        zorder=3,
        label="Pareto set",
    )
    for name, set_scale, values in ((x, axes.set_xscale, xs[finite]), (y, axes.set_yscale, ys[finite])):
        if values.size and "life" in name and values.min() > 0 and values.max() > 20 * values.min():
            set_scale("log")
            style.log_ticks(axes.xaxis if name == x else axes.yaxis, values.min(), values.max())
    axes.set_xlabel(_label(front, x) + (" →" if up_x == "max" else " ←"))
    axes.set_ylabel(_label(front, y) + (" →" if up_y == "max" else " ←"))


def parallel(front: xr.Dataset) -> Drawn:
    """The best designs over all factors and objectives, each axis from its least to its largest value."""
    best = front["optimal"].values == 1
    factors = [n for n in front.attrs["factors"].split(", ") if n in front]
    goals = [n for n, _ in _objectives(front)]
    if not best.any() or not factors:
        return None
    names = [*factors, *(g for g in goals if g not in factors)]
    scaled, ends = zip(*(_scaled(n, front[n].values) for n in names), strict=True)
    table = np.stack(scaled, axis=1)
    figure = style.new_figure(92, 170.0 if len(names) > 6 else style.COLUMN_MM)
    axes = figure.add_subplot()
    chosen = np.flatnonzero(best)
    rank = np.argsort(-table[chosen, names.index(goals[0])])
    chosen = chosen[rank][np.unique(np.linspace(0, len(chosen) - 1, min(MAX_LINES, len(chosen))).astype(int))]
    rest = np.flatnonzero(~best)
    for row in rest[:: max(1, len(rest) // 150)]:
        axes.plot(table[row], color="0.86", linewidth=0.4, zorder=1)
    import matplotlib

    shades = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.85, len(chosen)))
    for i, (row, shade) in enumerate(zip(chosen, shades, strict=True)):
        axes.plot(table[row], color=shade, linewidth=1.0, linestyle=style.LINES[i % 2], zorder=2)
    for j, (low, high) in enumerate(ends):
        axes.vlines(j, 0.0, 1.0, color="0.3", linewidth=0.7, zorder=3)
        axes.annotate(high, (j, 1.0), xytext=(0, 3), textcoords="offset points", ha="center", fontsize=6)
        axes.annotate(low, (j, 0.0), xytext=(0, -8), textcoords="offset points", ha="center", fontsize=6)
    axes.set_xticks(
        range(len(names)), [_label(front, n) for n in names], rotation=35, ha="right", rotation_mode="anchor"
    )
    axes.tick_params(axis="x", pad=9, length=0)
    axes.set_yticks([])
    axes.set_ylim(-0.06, 1.08)
    axes.grid(visible=False)
    leading = front[goals[0]].attrs.get("long_name", goals[0])
    style.head(
        figure, "Parallel coordinates of the best designs", f"Dark to bright: falling {leading}; grey: other designs."
    )
    style.finish(figure)
    axes.spines["left"].set_visible(False)
    axes.spines["bottom"].set_visible(False)
    return figure, style.FigureInfo(
        "pareto-parallel",
        "The Pareto set over factors and objectives, each axis from its least to its largest value.",
        _common(front, factors, best),
    )


def _common(front: xr.Dataset, factors: list[str], best: np.ndarray) -> str:
    """Where the best designs lie: factors whose values they share."""
    said = []
    for name in factors:
        values = front[name].values
        if values.dtype.kind not in "fiu" or not np.isfinite(values).all():
            kinds = sorted({str(v) for v in values[best]})
            if len(kinds) == 1 and len({str(v) for v in values}) > 1:
                said.append((0.0, f"{style.long_name(name)} {style.level_text(name, kinds[0])}"))
            continue
        low, high = np.percentile(values[best], [10, 90])
        wide = (high - low) / max(np.ptp(values), 1e-300)
        if wide < 0.5:
            span = "" if low == high else f"{words.number(low)} to "
            bare = name in ("motor_force", "guide_curve_radius")  # 'driven 30 N' says alone which it is
            text = style.level_text(name, float(f"{high:.3g}"), unit=not (bare and span))
            said.append((wide, text if bare and not span else f"{style.long_name(name)} {span}{text}"))
    said.sort()
    if not said:
        return "The best designs share no narrow range of any factor."
    return f"Most of the best designs have {words.listing([text for _, text in said[:4]])}."


def _scaled(name: str, values: np.ndarray) -> tuple[np.ndarray, tuple[str, str]]:
    """Values on 0 to 1 with the labels of the ends; categories by their order of appearance."""
    log = "life" in name
    if values.dtype.kind not in "fiu":
        texts = style.short_levels([style.level_text(name, str(v)) for v in values])
        kinds, values = list(dict.fromkeys(texts)), np.array(texts, dtype=object)
        place = np.array([kinds.index(str(v)) for v in values]) / max(1, len(kinds) - 1)
        return place, (_cut(kinds[0]), _cut(kinds[-1]))
    values = values.astype(float)
    good = values[np.isfinite(values)]
    low, high = (good.min(), good.max()) if good.size else (0.0, 1.0)
    if log and low > 0:
        part = np.log(np.clip(values, low, high) / low) / max(np.log(high / low), 1e-300)
    else:
        part = (np.clip(values, low, high) - low) / max(high - low, 1e-300)
    span = 0.0 if log else float(high - low)
    more = ("unlimited" if log else "∞") if np.isposinf(values).any() else style.near(float(high), span)
    return part, (style.near(float(low), span), more)


def _cut(text: str) -> str:
    return text if len(text) <= 11 else text[:10] + "…"


def robust_points(table: xr.Dataset, output: str) -> Drawn:
    """Spread of life and B10 of each design point, and how often it slips or lifts off.

    Parameters
    ----------
    table : dataset of `trackroller.analysis.robustness.robustness`
    output : a life
    """
    part = table.sel(output=output)
    spread = part["percentile_value"]
    if not np.isfinite(spread.values).any():
        return None
    rank = np.argsort(-np.nan_to_num(part["b10"].values, nan=-1.0))[:24]
    figure = style.new_figure(34 + 5.4 * len(rank), 130.0)
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(2.4, 1))
    place = np.arange(len(rank))[::-1]
    colours = style.palette(4)
    q = {p: spread.sel(percentile=p).values[rank] for p in (5.0, 50.0, 95.0)}
    left.hlines(place, q[5.0], q[95.0], color=colours[0], alpha=0.35, linewidth=5, label="5 to 95 %")
    left.plot(q[50.0], place, color="0.1", marker="|", markersize=7, linestyle="none", label="median")
    b10 = part["b10"].values[rank]
    error = np.abs(np.stack([b10 - part["b10_low"].values[rank], part["b10_high"].values[rank] - b10]))
    left.errorbar(
        b10,
        place,
        xerr=error,
        color=colours[3],
        marker="D",
        markersize=3.5,
        linestyle="none",
        capsize=1.5,
        elinewidth=0.8,
        markeredgecolor="0.1",
        markeredgewidth=0.4,
        label="B10",
    )
    left.set_xscale("log")
    style.log_ticks(left.xaxis, *left.get_xlim())
    left.set_yticks(place, [words.upper(words.point_words(table, int(p))) for p in rank])
    left.set_xlabel(style.with_unit(words.upper(str(part["output_name"].item())), str(part["output_units"].item())))
    start = np.zeros(len(rank))
    for i, regime in ((1, "full_slip"), (2, "lift_off"), (3, "failed")):
        share = 100 * table["probability"].sel(regime=regime).values[rank]
        if not share.any():
            continue
        right.barh(
            place,
            share,
            0.62,
            left=start,
            color=style.REGIME_COLOURS[i],
            hatch=style.REGIME_HATCHES[i],
            edgecolor="0.15",
            linewidth=0.5,
            label=style.REGIME_LABELS[i],
        )
        start = start + share
    right.set_xlabel("share of cases [%]")
    right.set_xlim(0, max(5.0, 1.1 * float(start.max())))
    for axes in (left, right):
        axes.grid(axis="y", visible=False)
        axes.tick_params(axis="y", length=0)
    figure.legend(loc="outside lower center", ncols=6, columnspacing=1.0, handletextpad=0.4)
    style.head(figure, f"{words.upper(str(part['output_name'].item()))} where conditions scatter")
    style.finish(figure)
    inner = words.listing([style.long_name(n) for n in table.attrs["inner_factors"].split(", ")])
    own = float(table.attrs.get("log_life_scatter", 0.0))
    caption = (
        f"Design points by falling B10, each with the same {table.attrs['inner_samples']} samples of {inner}. "
        "Whiskers: 95 % intervals. Lives of the rolling cases; the share of the others on the right."
        + (" B10 holds the material's own scatter of life as well." if own > 0 else "")
    )
    return figure, style.FigureInfo(f"robustness-{output}", caption, words.robustness(table, output))
