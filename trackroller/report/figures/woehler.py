"""The S-N (Woehler) diagram of each body with the operating points of a study."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.damage import fatigue
from trackroller.report.figures import style
from trackroller.report.figures.study_life import MAX_POINTS, legend
from trackroller.report.figures.study_view import StudyView, study_settings

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BODIES = ("roller", "guide")
BEYOND = 1e4  # the axis ends at so many times the cycles of the knee; what lives longer is marked at its edge
MAX_MATERIALS = 6
_FIELDS = ("tensile_strength", "fatigue_strength_ratio", "cycles_at_tensile_strength", "cycles_at_fatigue_limit")
Line = tuple[float, float, float, float]


def line_of(material: Mapping[str, Any]) -> Line:
    """R_m, sigma_D [MPa], N_Rm and N_k [1] of a material's values."""
    strength, ratio, first, knee = (float(material[name]) for name in _FIELDS)
    return strength, strength * ratio, first, knee


def curve(material: Mapping[str, Any], rule: str, probability: float, cycles: np.ndarray) -> np.ndarray:
    """Stress [MPa] of the line at a failure probability over cycles [1], shape as `cycles`.

    Parameters
    ----------
    material : its values, `scatter_in_cycles` or `scatter_in_stress` among them for probabilities other than 0.5
    rule : life rule beyond the knee
    """
    t_n, t_s = material.get("scatter_in_cycles"), material.get("scatter_in_stress")
    return fatigue.allowable_stress(
        cycles, *line_of(material), rule, failure_probability=probability, scatter_cycles=t_n, scatter_stress=t_s
    )


def scatters(material: Mapping[str, Any]) -> bool:
    """Does the material give a scatter range?"""
    return material.get("scatter_in_cycles") is not None or material.get("scatter_in_stress") is not None


def woehler(view: StudyView) -> tuple[Figure, style.FigureInfo] | None:
    """S-N line of every material with the peak stress and life of every case, one panel a body."""
    known = _materials(view)
    rule = str(study_settings(view.attrs).get("life_rule", "elementary"))
    shown = [(body, points) for body in BODIES if (points := _points(view, body, known, rule))]
    if not shown:
        return None
    names = list(dict.fromkeys(name for _, points in shown for name in points))[:MAX_MATERIALS]
    colours = dict(zip(names, style.palette(len(names)), strict=True))
    figure = style.new_figure(24 + 52 * len(shown) + 2.4 * (len(names) + 5))
    panels = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    ends = _ends([points[n] for _, points in shown for n in points], [known[n] for n in names])
    beyond = 0
    for axes, (body, points) in zip(panels, shown, strict=True):
        for i, name in enumerate(names):
            if name in points:
                beyond += _draw(axes, known[name], rule, *points[name], colours[name], style.MARKERS[i % 10], ends)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlim(*ends)
        style.log_ticks(axes.yaxis, *axes.get_ylim())
        axes.set_title(body.capitalize(), loc="left", fontsize=7.5, pad=3)
        axes.set_ylabel(style.with_unit("Peak von Mises stress", "MPa"))
    panels[-1].set_xlabel(style.with_unit("Overrollings to failure", "1").replace("[1]", "[–]"))
    legend(figure, _entries(names, colours, known), columns=2)
    style.head(figure, "S-N diagram with the cases of the study", "Dots: peak stress and life, the worse contact.")
    style.finish(figure)
    return figure, _info(shown, known, rule, beyond)


def _materials(view: StudyView) -> dict[str, dict[str, Any]]:
    try:
        found = json.loads(str(view.attrs.get("materials", "{}")))
    except ValueError:
        return {}
    return {name: dict(m) for name, m in found.items() if isinstance(m, Mapping) and all(f in m for f in _FIELDS)}


def _points(
    view: StudyView, body: str, known: Mapping[str, Any], rule: str
) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """For each material: stress [MPa], life [1] and whether it rolls, of every case that has a life."""
    table, column = view.table, f"life_cycles_{body}"
    if column not in table:
        return {}
    life = table[column].to_numpy(dtype=float)
    name = f"{body}_material"
    given = table[name].to_numpy() if name in table else np.full(len(table), str(view.base.get(name, "")), dtype=object)
    if "material_pair" in table and name not in table:
        pairs = [str(p).split(" / ") for p in table["material_pair"]]
        given = np.array([p[0] if body == "roller" else p[-1] for p in pairs], dtype=object)
    rolls = table["regime"].to_numpy() == 0 if "regime" in table else np.ones(len(table), dtype=bool)
    found = {}
    for material in dict.fromkeys(map(str, given)):
        mine = (given.astype(str) == material) & (life > 0)
        if material not in known or not mine.any():
            continue
        if f"peak_stress_{body}" in table:
            stress = table[f"peak_stress_{body}"].to_numpy(dtype=float)[mine]
        else:
            with np.errstate(invalid="ignore"):
                stress = curve(known[material], rule, 0.5, life[mine])
        found[material] = (stress, life[mine], rolls[mine])
    return found


def _ends(points: list, materials: list) -> tuple[float, float]:
    lives = np.concatenate([p[1] for p in points])
    lines = [line_of(m) for m in materials]
    low, knee = min(line[2] for line in lines), max(line[3] for line in lines)
    finite = lives[np.isfinite(lives)]
    top = min(max(finite.max() * 2 if finite.size else knee, 20 * knee), BEYOND * knee)
    low = min(low, finite.min() if finite.size else low)
    return max(low / 2, 1.0), top


def _draw(
    axes: Axes,
    material: Mapping[str, Any],
    rule: str,
    stress: np.ndarray,
    life: np.ndarray,
    rolls: np.ndarray,
    colour: Any,
    marker: str,
    ends: tuple[float, float],
) -> int:
    """One material's lines and points; how many of them lie beyond the axis."""
    at = np.geomspace(*ends, 400)
    axes.plot(at, curve(material, rule, 0.5, at), color=colour, linewidth=1.0, zorder=2)
    if scatters(material):
        for probability in fatigue.PROBABILITIES:
            if probability != 0.5:
                axes.plot(
                    at,
                    curve(material, rule, probability, at),
                    color=colour,
                    linewidth=0.8,
                    linestyle=_STYLE[probability],
                    zorder=2,
                )
    strength, limit, first, knee = line_of(material)
    axes.plot(
        [first, knee],
        [strength, limit],
        color="0.1",
        marker="|",
        markersize=9,
        markeredgewidth=0.9,
        linestyle="none",
        zorder=3,
    )
    use = np.flatnonzero(rolls if rolls.any() else np.isfinite(stress))
    far = use[life[use] > ends[1]]
    use = use[life[use] <= ends[1]]
    if use.size:
        middle = use[np.argsort(life[use])[use.size // 2]]
        use = use[:: -(-use.size // MAX_POINTS)]
        axes.scatter(
            life[use],
            stress[use],
            s=8,
            marker=marker,
            color=colour,
            alpha=0.35,
            linewidth=0,
            zorder=3,
            rasterized=use.size > 500,
        )
        axes.scatter(
            life[middle],
            stress[middle],
            s=30,
            marker=marker,
            facecolor="white",
            edgecolor="0.1",
            linewidth=0.9,
            zorder=5,
        )
    axes.scatter(
        np.full(far.size, ends[1]),
        stress[far],
        s=9,
        marker=">",
        facecolor="white",
        edgecolor=colour,
        linewidth=0.5,
        clip_on=False,
        zorder=4,
    )
    return int(far.size)


_STYLE = {0.1: (0, (1, 1.2)), 0.9: (0, (4, 1.5))}


def _entries(names: list[str], colours: Mapping[str, Any], known: Mapping[str, Any]) -> list:
    small = {"markersize": 3}
    entries = [(n, {"color": colours[n], "marker": style.MARKERS[i % 10], **small}) for i, n in enumerate(names)]
    none = {"linestyle": "none"}
    entries.append(("median of the cases", {"color": "0.1", "marker": "o", "markerfacecolor": "white", **none}))
    ends = {"color": "0.1", "marker": "|", "markersize": 8, **none}
    entries.append((r"$R_\mathrm{m}$ and $\sigma_\mathrm{D}$", ends))
    if any(scatters(known[n]) for n in names):
        entries += [
            (f"{100 * p:.0f} % fail", {"color": "0.3", "linestyle": _STYLE.get(p, "-")}) for p in fatigue.PROBABILITIES
        ]
    return entries


def _info(shown: list, known: Mapping[str, Any], rule: str, beyond: int) -> style.FigureInfo:
    caption = (
        "Woehler lines of the materials (failure probability 50 %, and 10 and 90 % where the material gives its "
        "scatter) with the peak von Mises stress (MPa) and the life in overrollings of every case. "
        f"{fatigue.CONVENTIONS[rule]}."
    )
    left = sum(int((~rolls).sum()) for _, points in shown[:1] for _, _, rolls in points.values())
    if left and any(rolls.any() for _, points in shown for _, _, rolls in points.values()):
        caption += f" {left} cases in full slip or lift-off are not drawn."
    if beyond:
        caption += f" {beyond} lives beyond the axis are marked at its right edge."
    sentences = [_sentence(body, points, known) for body, points in shown]
    return style.FigureInfo("woehler", caption, " ".join(s for s in sentences if s))


def _sentence(body: str, points: Mapping[str, Any], known: Mapping[str, Any]) -> str:
    """Where a body's cases lie on its lines; the rolling ones where there are any."""
    use = {n: rolls if rolls.any() else np.ones_like(rolls) for n, (_, _, rolls) in points.items()}
    stress = np.concatenate([p[0][use[n]] for n, p in points.items()])
    limit = np.concatenate([np.full(use[n].sum(), line_of(known[n])[1]) for n in points])
    strength = np.concatenate([np.full(use[n].sum(), line_of(known[n])[0]) for n in points])
    good = np.isfinite(stress)
    if not good.any():
        return ""
    below, above = float((stress < limit)[good].mean()), float((stress > strength)[good].mean())
    ratio = float(np.median((stress / limit)[good]))
    text = f"Half of the cases load the {body} to more than {style.rounded(ratio, 2)} times its fatigue limit"
    said = [f"{_share(below)} stay below it" if below else "none stays below it"]
    if above:
        said.append(f"{_share(above)} lie above the tensile strength, where there is no fatigue life in earnest")
    text += f"; {' and '.join(said)}."
    ranges = {}
    for name in points:
        if scatters(known[name]):
            k = fatigue.woehler_exponent(*line_of(known[name]))
            t_n = float(
                fatigue.scatter_ranges(k, known[name].get("scatter_in_cycles"), known[name].get("scatter_in_stress"))[0]
            )
            ranges[name] = t_n**-0.5
    if ranges:
        name = min(ranges, key=lambda n: ranges[n])
        text += (
            f" By the scatter of {name} one in ten has failed at {style.rounded(ranges[name], 2)} times the life "
            "of the 50 % line."
        )
    return text


def _share(share: float) -> str:
    return "all" if share == 1 else f"{min(99.0, max(1.0, 100 * share)):.0f} %"
