"""Figures of a fit: S-N diagram with tests and band, predicted against observed lives, and pairs of
the posterior.
"""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from scipy.interpolate import PchipInterpolator

from trackroller.fit.material_fit import Group, MaterialFit
from trackroller.report.figures import style
from trackroller.report.figures.panels import legend
from trackroller.report.numbers import rounded

ACROSS, FINE = 25, 400  # stresses at which the band is computed, and at which curves are drawn
MOST_DRAWN = 1500  # points of a posterior
UP, DOWN = style.PAIR


def sn_line(fit: MaterialFit) -> style.Drawn:
    """Draw stress over life: failures, run-outs as arrows, the line, and its 90 % band for 50 and
    10 % failures.
    """
    own = fit.of_life
    if own is None:
        return None
    line = own.line
    tests = line.tests
    failed = line.tests.failed
    title, load = ("S-N line", "Stress amplitude [MPa]")
    name = "line"
    if own.kind == "rolling":
        title, load = ("Line of pressure", "Largest Hertzian pressure [MPa]")
        name = "line of pressure"
    figure, (axes,) = style.panels(f"{title} of {fit.name}", 95)
    reach = max(np.ptp(tests.stress), 0.1)
    low, high = tests.stress.min() - 0.6 * reach, tests.stress.max() + 0.2 * reach
    stresses = np.linspace(low, high, ACROSS)
    fine = np.linspace(low, high, FINE)
    entries = [("failure", {"marker": "o", "linestyle": "none", "color": "0.1"})]
    if failed.any():
        for probability, colour, dash in ((0.5, UP, "-"), (0.1, DOWN, "--")):
            best = np.array([float(line.log_life(line.best, x, probability)) for x in fine])
            ends = np.array([line.interval_of_life(x, probability) for x in stresses])
            ends = np.clip(np.where(np.isfinite(ends), ends, np.sign(ends) * 60.0), -60.0, 60.0)
            known = np.isfinite(best)
            axes.plot(np.exp(best[known]), np.exp(fine[known]), color=colour, linestyle=dash)
            # an end that jumps where a fatigue limit ends it must not swing, so that the curve
            # keeps its monotony
            band = [np.exp(PchipInterpolator(stresses, end)(fine)) for end in ends.T]
            axes.fill_betweenx(np.exp(fine), *band, color=colour, alpha=0.15, lw=0)
            entries.append(
                (
                    f"{100 * probability:.0f} % fail, with its 90 % interval",
                    {"color": colour, "linestyle": dash},
                )
            )
    _marks(axes, np.exp(tests.middle), np.exp(tests.stress), failed)
    if not failed.all():
        entries.append(
            (
                "run-out or suspended",
                {"marker": ">", "linestyle": "none", "color": "0.1", "mfc": "white"},
            )
        )
    lives = np.exp(tests.middle)
    axes.set(xscale="log", yscale="log", xlim=(lives.min() / 5.0, lives.max() * 10.0))
    axes.set(xlabel="Cycles to failure $N$ [–]", ylabel=load)
    style.log_ticks(axes.yaxis, *axes.get_ylim())
    legend(figure, entries)
    caption = (
        f"Tests, fitted {name}, and the interval that holds the true life in nine of ten fits, at "
        "each stress. Arrows: tests that ended without a failure of this kind. Beyond the tests "
        "the line is extrapolated."
    )
    return figure, style.FigureInfo("fit_sn_line", caption)


def _marks(axes: Axes, x: np.ndarray, y: np.ndarray, failed: np.ndarray) -> None:
    axes.scatter(x[failed], y[failed], s=16, color="0.1", zorder=4)
    axes.scatter(
        x[~failed], y[~failed], s=26, marker=">", facecolor="white", edgecolor="0.1", zorder=4
    )


def predicted(fit: MaterialFit) -> style.Drawn:
    """Draw the observed over the predicted value of each test, with arrows for suspensions, one
    panel a kind of end.
    """
    groups = [own for own in fit.groups if own.line.tests.failed.any()]
    if not groups:
        return None
    figure, panels = style.panels("Predicted and observed", 80, len(groups))
    for axes, own in zip(panels, groups, strict=True):
        _against(axes, own)
    caption = (
        "Median by the fit and what was observed; an interval is drawn at its middle, and an arrow "
        "is a test that ended without this failure. Dotted: between the lines lie nine of ten "
        "failures by the fitted scatter."
    )
    return figure, style.FigureInfo("fit_predicted", caption)


def _against(axes: Axes, own: Group) -> None:
    line = own.line
    failed = own.line.tests.failed
    median = np.array([float(line.log_life(line.best, x, 0.5)) for x in line.tests.stress])
    straight = float(line.best.level) - float(line.best.slope) * (
        line.tests.stress - line.reference
    )
    median = np.where(np.isfinite(median), median, straight)
    observed = line.tests.middle
    scatter = 1.645 * math.exp(float(line.best.log_scatter))
    _marks(axes, np.exp(median), np.exp(observed), failed)
    both = np.concatenate([median, observed])
    ends = np.array([both.min() - 0.5, both.max() + 0.5])
    for shift, look in ((0.0, "-"), (-scatter, ":"), (scatter, ":")):
        axes.plot(
            np.exp(ends), np.exp(ends + shift), color="0.5", linestyle=look, linewidth=0.8, zorder=1
        )
    words = {
        "fatigue": "cycles [–]",
        "rolling": "overrollings [–]",
        "wear": "travel over that of 1e-6 mm³/(N m) [–]",
        "friction": "friction coefficient [–]",
    }[own.kind]
    axes.set(xscale="log", yscale="log", xlabel=f"Predicted {words}", ylabel=f"Observed {words}")
    axes.set_title(own.kind.capitalize())


def pairs(fit: MaterialFit) -> style.Drawn:
    """Draw pairs of fitted values by points of the posterior."""
    own = fit.of_life
    if own is None or not own.line.tests.failed.any():
        return None
    names = [name for name in own.names if name not in own.unidentified]
    couples = [(a, b) for i, a in enumerate(names) for b in names[i + 1 :]][:3]
    if not couples:
        return None
    weight = own.posterior.weight
    rows = np.random.default_rng(1).choice(len(weight), MOST_DRAWN, p=weight)
    figure, panels = style.panels("What goes together in the posterior", 66, len(couples))
    labels = {
        "fatigue_limit": "Strength at the knee [MPa]",
        "woehler_exponent": "Slope $k$ [–]",
        "scatter_in_cycles": "$T_N$ [–]",
        "scatter_in_stress": "$T_S$ [–]",
        "rolling_pressure": "Pressure $p_R$ [MPa]",
        "rolling_exponent": "Exponent $k_R$ [–]",
    }
    for axes, (first, second) in zip(panels, couples, strict=True):
        x, y = (
            np.broadcast_to(own.values_of(name), weight.shape)[rows] for name in (first, second)
        )
        axes.scatter(x, y, s=2, color=UP, alpha=0.25, linewidth=0)
        axes.plot(own.estimate(first), own.estimate(second), "+", color="0.1", markersize=9)
        axes.set(xlabel=labels[first], ylabel=labels[second], xscale="log", yscale="log")
        low, high = (np.quantile(values, (0.01, 0.99)) for values in (x, y))
        axes.set(xlim=tuple(low), ylim=tuple(high))
        for axis, ends in ((axes.xaxis, low), (axes.yaxis, high)):
            style.log_ticks(axis, *ends)
    caption = (
        f"{rounded(MOST_DRAWN)} points of the posterior; the cross is the most likely value. A "
        "narrow diagonal cloud means that the tests know a combination of both values better than "
        "each of them."
    )
    return figure, style.FigureInfo("fit_pairs", caption)
