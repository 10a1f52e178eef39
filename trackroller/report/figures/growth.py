"""The figure of a sample that grew: intervals against cases."""

from __future__ import annotations

import numpy as np

from trackroller.analysis.looks import looks_of
from trackroller.analysis.table import StudyView
from trackroller.report.figures import style
from trackroller.report.numbers import capital, count
from trackroller.report.words.growth import grown, quantity_words


def intervals(view: StudyView) -> style.Drawn:
    """Draw the half width of the widest interval of each output of `until` against the number of cases.

    It answers: was growing worth its cases? None for a study with fewer than two looks.
    """
    growth, said = looks_of(view.solved), grown(view)
    if growth is None or said is None or len(growth["looks"]) < 2:
        return None
    cases = [one["cases"] for one in growth["looks"]]
    names = list(growth["looks"][0]["half_width"])
    figure, (axes,) = style.panels("Intervals as the sample grew", 58)
    for i, (name, colour) in enumerate(zip(names, style.palette(len(names)), strict=True)):
        width = np.array([one["half_width"][name] for one in growth["looks"]], dtype=float)
        look = {"marker": style.MARKERS[i % len(style.MARKERS)], "linestyle": style.LINES[i % len(style.LINES)]}
        axes.plot(cases, width, color=colour, label=capital(quantity_words(name, view.solved.design.method)), **look)
    axes.axhline(growth["half_width"], color="0.3", linewidth=0.8, linestyle=":", label="wanted")
    axes.set_xscale("log", base=2)
    axes.set_xticks(cases, [count(n) for n in cases])
    axes.minorticks_off()
    axes.set(ylim=(0.0, None), xlabel="cases [–]", ylabel="half width of the\nwidest interval [–]")
    figure.legend(loc="outside lower center", ncols=2)
    caption = f"95 % intervals from {growth['replicates']} independent replicates at each doubling of the sample."
    return figure, style.FigureInfo("intervals-against-cases", caption, said.text)
