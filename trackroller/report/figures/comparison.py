"""Draw the errors of the cheaper contact models, for a study with the models as a factor."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.report.figures import style
from trackroller.report.figures.panels import band, legend, quantiles, set_axis
from trackroller.report.numbers import capital, factor_label, percent
from trackroller.report.words.comparison import FRICTION, by_drive
from trackroller.results.contact_models import GOOD, designs, errors, measured, pairs
from trackroller.results.groups import DRIVE, groups, ordered, spaced_by_ratio
from trackroller.results.results import Results

# distinguished by dash and mark as well as by colour
LOOKS: dict[str, dict[str, Any]] = {
    "sliding": {"color": "#000000", "linestyle": "-", "marker": "o"},
    "kalker_table": {"color": "#56b4e9", "linestyle": "-.", "marker": "v"},
}
LEAST = 6e-4  # error at the lower end of the axes [1]
LETTERS = 100  # letters of 7 pt across the figure
NOT_DRAWN = ("friction_energy_balance", "stick")  # quantities of the table alone


def model_errors(results: Results) -> style.Drawn:
    """Draw the error of the cheaper models against the reference over friction or another factor, by drive.

    It answers: where is a cheaper model good enough? None for a study without pairs of cases to compare.
    """
    paired = pairs(results)
    if paired is None or not paired.sizes["design"]:
        return None
    deviations, own = errors(paired), designs(paired)
    wanted = [q for q in measured(deviations) if q.name not in NOT_DRAWN]
    # friction, the first factor with an order, or the first factor
    in_order = {str(name): ordered(values) for name, values in own.items()}
    x = next(iter(sorted(in_order, key=lambda n: (n != FRICTION, not in_order[n]))), None)
    if x is None or not wanted:
        return None
    along, columns = groups(own, x), by_drive(own) if x != DRIVE else [("", np.ones(len(own), dtype=bool))]
    figure = style.new_figure(30.0 + 27.0 * len(wanted))
    axes = figure.subplots(len(wanted), len(columns), sharex=True, sharey="row", squeeze=False)
    handles: dict[str, Any] = {}
    for row, q in zip(axes, wanted, strict=True):
        top = 1.0
        for model in map(str, deviations["contact_model"].values):
            look = {"markersize": 2.8, "markeredgewidth": 0.7, **LOOKS[model]}
            at = along.at if along.ordered else along.at + 0.1 * (list(LOOKS).index(model) - 1)
            error = np.clip(deviations[q.name].sel(contact_model=model).values, LEAST, 1e3)
            for (_, rows), panel in zip(columns, row, strict=True):
                drawn = 100 * quantiles(np.where(rows, error, np.nan), along.index, len(along))
                handles[f"{model} against {paired.attrs['reference']}"] = band(panel, at, drawn, look, along.ordered)
                top = float(np.nanmax([top, np.nanmax(drawn, initial=0.0)]))
        row[0].set(ylabel=f"{q.label}\nerror [%]", yscale="log", ylim=(0.05, max(100.0, 1.5 * top)))
        for panel in row:
            panel.axhline(100 * GOOD, color="0.35", linewidth=0.8, linestyle=(0, (1, 2)), zorder=0)
    for first, last, (title, _) in zip(axes[0], axes[-1], columns, strict=True):
        first.set_title(capital(title))
        last.set_xlabel(factor_label(x))
        if along.ordered and spaced_by_ratio(along.at, 4.0):
            last.set_xscale("log")
            style.log_ticks(last.xaxis, float(along.at.min()), float(along.at.max()))
        else:
            set_axis(last, along, LETTERS // len(columns))
    legend(figure, handles)
    style.head(figure, "Errors of the cheaper contact models")
    caption = (
        f"Error of the cheaper contact models against {paired.attrs['reference']}, at the worse contact of the cases "
        f"that roll. Lines: medians of the cases; bands: 5 to 95 %. Dotted: {percent(GOOD)}. Marks at the lower end: "
        f"{percent(LEAST)} or less."
    )
    return figure, style.FigureInfo("models-error", caption)
