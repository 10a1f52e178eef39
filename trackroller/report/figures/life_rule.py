"""The figure of a rule that was fitted to a maker's catalogue: life over load factor."""

from __future__ import annotations

import numpy as np

from trackroller.damage.catalogue import LAWS, OFFSETS, POWERS, travel_km
from trackroller.fit.catalogue import CatalogueFit
from trackroller.report.figures import style
from trackroller.report.figures.panels import legend

FINE = 200  # places of a curve


def life_over_load(fit: CatalogueFit) -> style.Drawn:
    """Draw the lives of the table, the fitted rule, and the nearest law of a catalogue."""
    figure, (axes,) = style.panels(f"Life over load factor of {fit.tests.name}", 80)
    rule, law_colour = style.PAIR
    low, high = 0.7 * fit.load_factor.min(), 1.3 * fit.load_factor.max()
    factor = np.geomspace(low, high, FINE)
    nearest = min(LAWS, key=lambda law: fit.laws[law])
    power, offset = POWERS[nearest], OFFSETS[nearest]
    of_law = travel_km(fit.load_factor, 1.0, power, offset)
    basic = float(np.exp(np.mean(np.log(fit.life / of_law))))
    axes.plot(factor, travel_km(factor, fit.basic_life, fit.exponent, fit.offset), color=rule)
    axes.plot(factor, travel_km(factor, basic, power, offset), color=law_colour, linestyle="--")
    axes.plot(fit.load_factor, fit.life, "o", color="0.1")
    axes.set(xscale="log", yscale="log", xlabel="Load factor [–]", ylabel="Life [km]")
    style.log_ticks(axes.xaxis, *axes.get_xlim())
    style.log_ticks(axes.yaxis, *axes.get_ylim())
    entries = [
        ("table", {"marker": "o", "linestyle": "none", "color": "0.1"}),
        ("fitted rule", {"color": rule}),
        (f"law '{nearest}'", {"color": law_colour, "linestyle": "--"}),
    ]
    legend(figure, entries)
    caption = "Lives of the table, the fitted rule, and the nearest law with a fitted basic life."
    return figure, style.FigureInfo("life_rule", caption)
