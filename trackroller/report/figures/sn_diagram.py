"""The S-N diagram (Wöhler diagram) of each body with the operating points of a study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from trackroller.damage.sn_curve import CONVENTIONS, GIVEN_SLOPE, PROBABILITIES, SNCurve
from trackroller.materials import Material
from trackroller.materials.properties import REQUIRED
from trackroller.parameters import BODIES
from trackroller.report.figures import style
from trackroller.report.figures.panels import Entries, legend
from trackroller.report.numbers import capital, listing, rounded, with_unit
from trackroller.report.tables.inputs import stored_materials
from trackroller.results.results import Results
from trackroller.roller.stored_inputs import as_material

BEYOND = 1e4  # the axis ends at this multiple of the cycles at the fatigue limit
MAX_MATERIALS = 6
_DASHES = {0.1: (0, (1, 1.2)), 0.9: (0, (4, 1.5))}
_WORDS = {"peak_stress": "peak von Mises stress", "fatigue_stress": "stress of the life criterion"}
Points = dict[str, tuple[np.ndarray, np.ndarray]]


def sn_diagram(results: Results) -> style.Drawn:
    """Draw the S-N curve of every material with peak stress and life of the rolling cases, one
    panel a body.

    It answers: where on its curve does each material work, above its strength, below it, or below
    its fatigue limit? A body without a life on the axis gets no panel, because marks piled up at
    the edge would not be readable.
    """
    known = _known(results)
    rule = results.config.life_rule
    bodies = [(body, points) for body in BODIES if (points := _points(results, body, known, rule))]
    if not bodies:
        return None
    ends = _ends(
        [points[n] for _, points in bodies for n in points],
        [known[n] for _, p in bodies for n in p],
    )
    shown = [
        (b, points)
        for b, points in bodies
        if any((life <= ends[1]).any() for _, life in points.values())
    ]
    if not shown:
        return None
    names = list(dict.fromkeys(name for _, points in shown for name in points))[:MAX_MATERIALS]
    colours = dict(zip(names, style.colours(names, True), strict=True))
    figure, panels = style.panels(
        "S-N diagram with the cases of the study",
        68 + 2.4 * (len(names) + 3),
        len(shown),
        sharey=True,
    )
    for axes, (body, points) in zip(panels, shown, strict=True):
        for i, name in enumerate(names):
            if name not in points:
                continue
            _lines(axes, known[name], rule, colours[name], ends)
            _cases(
                axes,
                *points[name],
                {"color": colours[name], "marker": style.MARKERS[i % 10]},
                ends[1],
            )
        axes.set(xscale="log", yscale="log", xlim=ends, xlabel="Overrollings to failure $N$ [–]")
        axes.set_title(body.capitalize())
        style.log_ticks(axes.yaxis, *axes.get_ylim())
    panels[0].set_ylabel(with_unit(capital(_WORDS[_amplitude(results)]), "MPa"))
    legend(figure, _entries(names, colours, known), columns=4)
    return figure, _info(results, shown, known, rule)


def _known(results: Results) -> dict[str, Material]:
    stored = stored_materials(results.data.attrs)
    return {
        n: as_material({"name": n} | values)
        for n, values in stored.items()
        if set(REQUIRED) <= set(values)
    }


def _points(results: Results, body: str, known: Mapping[str, Material], rule: str) -> Points:
    """Return stress [MPa] and life [1] of the rolling cases of each material.

    If no rolling case has a life, return those of all cases with a life.
    """
    life = results.column(f"life_cycles_{body}")
    if ((life > 0) & results.rolling).any():
        rows = (life > 0) & results.rolling
    else:
        rows = life > 0
    given = results.material(body)
    points = {}
    for material in dict.fromkeys(given):
        mine = (given == material) & rows
        if material not in known or not mine.any():
            continue
        stress = results.column(f"{_amplitude(results)}_{body}")[mine]
        if np.isnan(stress).all():  # the study has lives but no stresses
            with np.errstate(invalid="ignore"):
                stress = SNCurve.of(known[material], rule).allowable_stress(life[mine])
        points[material] = stress, life[mine]
    return points


def _amplitude(results: Results) -> str:
    """Name the result that entered the S-N curve: the peak stress, or that of another life
    criterion.
    """
    if results.has("fatigue_stress_roller"):
        return "fatigue_stress"
    return "peak_stress"


def _ends(points: list, materials: list[Material]) -> tuple[float, float]:
    lives = np.concatenate([p[1] for p in points])
    low = min(m.sn_line[0][1] for m in materials)
    knee = max(m.cycles_at_fatigue_limit for m in materials)
    finite = lives[np.isfinite(lives)]
    high = 20 * knee
    if finite.size:
        low = min(low, finite.min())
        high = max(high, 2 * finite.max())
    return max(low / 2, 1.0), min(high, BEYOND * knee)


def _lines(
    axes: Axes, material: Material, rule: str, colour: Any, ends: tuple[float, float]
) -> None:
    """Draw the S-N curve of a material, with its scatter if it gives one."""
    at = np.geomspace(*ends, 400)
    median = SNCurve.of(material, rule)
    probabilities: tuple[float, ...] = (0.5,)
    if median.scatters:
        probabilities = PROBABILITIES
    for probability in probabilities:
        stress = median.changed(failure_probability=probability).allowable_stress(at)
        width = 0.8
        if probability == 0.5:
            width = 1.0
        axes.plot(
            at,
            stress,
            color=colour,
            linewidth=width,
            linestyle=_DASHES.get(probability, "-"),
            zorder=2,
        )
    points = [
        (cycles, stress) for stress, cycles in material.sn_line if ends[0] <= cycles <= ends[1]
    ]
    ends_look: dict[str, Any] = {
        "marker": "|",
        "markersize": 9,
        "markeredgewidth": 0.9,
        "linestyle": "none",
    }
    axes.plot(*zip(*points, strict=True), color="0.1", zorder=3, **ends_look)


def _cases(
    axes: Axes, stress: np.ndarray, life: np.ndarray, look: dict[str, Any], top: float
) -> None:
    """Draw where the cases of a material lie on its curve: a thick line spans 90 % of them, a large
    mark is the median.

    Cases beyond the end of the axis are left out.
    """
    order = np.argsort(life)[: int((life <= top).sum())]
    if not order.size:
        return
    middle = order[order.size // 2]
    most = order[np.round(np.linspace(0.05, 0.95, 50) * (order.size - 1)).astype(int)]
    axes.plot(life[most], stress[most], color=look["color"], linewidth=4, alpha=0.5, zorder=3)
    large = {"marker": look["marker"], "facecolor": "white", "edgecolor": "0.1", "linewidth": 0.9}
    axes.scatter(life[middle], stress[middle], s=30, zorder=5, **large)


def _entries(
    names: list[str], colours: Mapping[str, Any], known: Mapping[str, Material]
) -> Entries:
    entries: Entries = [
        (n, {"color": colours[n], "marker": style.MARKERS[i % 10], "markersize": 3})
        for i, n in enumerate(names)
    ]
    none = {"linestyle": "none", "color": "0.1"}
    entries.append(("90 % of the cases", {"color": "0.5", "linewidth": 4}))
    entries.append(("their median", {"marker": "o", "markerfacecolor": "white", **none}))
    ends = r"$R_\mathrm{m}$ and $\sigma_\mathrm{D}$"
    given = ends
    if any(known[n].sn_points for n in names):
        given = f"{ends}, or points as given"
    entries.append((given, {"marker": "|", "markersize": 8, **none}))
    if any(SNCurve.of(known[n]).scatters for n in names):
        dashes = [(p, {"color": "0.3", "linestyle": _DASHES.get(p, "-")}) for p in PROBABILITIES]
        entries += [(f"{100 * p:.0f} % fail", look) for p, look in dashes]
    return entries


def _info(
    results: Results, shown: list, known: Mapping[str, Material], rule: str
) -> style.FigureInfo:
    caption = (
        "S-N curves of the materials (failure probability 50 %, and 10 and 90 % where the "
        f"material gives its scatter) with the {_WORDS[_amplitude(results)]} (MPa) and the life in "
        f"overrollings of the rolling cases at the worse contact. {CONVENTIONS[rule]}."
    )
    if any(known[name].second_exponent is not None for _, points in shown for name in points):
        caption += f" {capital(GIVEN_SLOPE)}."
    scatter = [text for _, names in shown[:1] if (text := _scatter_words(known, names))]
    return style.FigureInfo("sn_diagram", " ".join([caption, *scatter]))


def _scatter_words(known: Mapping[str, Material], names: Points) -> str:
    """Say at which share of the median life one in ten has failed, for each material that gives its
    scatter.
    """
    texts = []
    for name in (n for n in names if SNCurve.of(known[n]).scatters):
        scatter = float(SNCurve.of(known[name]).scatter_ranges[0])
        texts.append(f"{rounded(scatter**-0.5, 2)} times its median life ({name})")
    if texts:
        return f"By the scatter of the material, 10 % have failed at {listing(texts)}."
    return ""
