"""The head of the report: six lines that answer what an engineer asks first."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from trackroller.analysis.convergence import HALF_WIDTH
from trackroller.analysis.ranking import estimate, headline, order, robust_design
from trackroller.analysis.table import StudyView
from trackroller.parameters import REGIME_LABELS, REGIMES
from trackroller.report.numbers import capital, count, rounded
from trackroller.report.tables.indices import part_sentences
from trackroller.report.words import indices as words
from trackroller.report.words import pareto as choices
from trackroller.report.words.cases import best_design, occurrence, valid_designs
from trackroller.report.words.flags import accuracy, friction_error, full_sliding
from trackroller.report.words.indices import of_output
from trackroller.report.words.pareto import robustness
from trackroller.report.words.sentence import Sentence
from trackroller.report.words.targets import target, target_words
from trackroller.study.design.sampling import ARRAYS

Line = tuple[str, list[Sentence]]
HALF_B10 = 0.1  # of B10 at the best design point, relative: a narrower interval is good enough
FEWEST = 64  # with fewer samples the lower bound of B10 is just the shortest life


def in_short(view: StudyView, models: list[str]) -> list[Line]:
    """Return the lines of *In short*: a head and its sentences.

    A line without content is left out.

    Parameters
    ----------
    view : the study as a table, with its analysis if there is one
    models : sentences of the comparison of contact models, if the study has one
    """
    sens = view.analysis
    robust = sens is not None and robust_design(sens)
    met = [target(sens, -1)] if sens is not None and "target" in sens.dims else []  # the last one joins several
    compared = [Sentence("models", text) for text in models]
    lines = [
        ("Valid designs", [valid_designs(view), stopped(view)]),
        ("Best design point", [*decides(sens), *met]) if robust else ("What decides", decides(sens)),
        ("Best", [best_design(view), *([] if robust else met)]),
        ("What limits", [occurrence(view, view.regime == c, capital(REGIME_LABELS[c])) for c in (1, 2, 3)]),
        ("How sure", [friction_error(view), full_sliding(view), *accuracy(view), *compared]),
        ("Enough samples?", [samples(sens, int(view.study.get("samples", 0))) if sens is not None else None]),
    ]
    return [(head, kept) for head, said in lines if (kept := [s for s in said if s is not None])]


def stopped(view: StudyView) -> Sentence | None:
    """Count the cases in which the condition of `stop_if` ended the search for stresses."""
    hit = view.column("stopped", 0.0) == 1
    if not hit.any():
        return None
    cases = int(hit.sum())
    text = f"{count(cases)} of {count(len(hit))} cases met the condition of `stop_if`: they have no stress and no life."
    return Sentence("stopped", text, {"count": cases}, np.ones(len(hit), dtype=bool))


def decides(sens: xr.Dataset | None) -> list[Sentence | None]:
    """Name the factors that decide life, or else the first output with an index; or name the best design point."""
    if sens is None:
        return []
    names = [str(n) for n in sens["output"].values]
    lives = sorted((n for n in names if "life" in n), key=lambda n: "roller" not in n)
    if robust_design(sens):
        return [choices.robustness(sens, lives[0])] if lives else []
    ranked = [n for n in [*lives, *names] if order(sens, n)]
    if not ranked:
        return []
    said, more = words.decides(sens, ranked[0]), part_sentences(sens, ranked[0])
    by_group = "group_ST" in sens and headline(sens) == "first"  # the design serves groups better than factors
    return [*more, said] if by_group else [said, *more]


def samples(sens: xr.Dataset, asked: int) -> Sentence | None:
    """Say whether the samples suffice, and if not, which number to write into the study file.

    Parameters
    ----------
    sens : analysis
    asked : `samples` of the study file

    Returns
    -------
    The sentence; None for a design without samples, or if no output has an interval.

    Notes
    -----
    A half width falls as one over the root of the samples, measured by ``tests/analysis/test_enough.py``. The number is
    `asked` times a power of two, so that a Sobol sequence stays balanced and a Latin hypercube grows.
    """
    method = str(sens.attrs.get("method"))
    if method == "inner_outer":
        return _of_points(sens, asked)
    if method in ARRAYS or "take_times" not in sens:
        return None
    asked = 1 << max(0, asked - 1).bit_length() if method == "saltelli" else asked
    needed = {str(o): float(sens["take_times"].sel(output=o)) for o in sens["output"].values if str(o) not in REGIMES}
    needed = {name: value for name, value in needed.items() if np.isfinite(value)}
    if not needed:
        return None
    worst = max(needed, key=lambda name: (needed[name], float(sens["half_width"].sel(output=name))))
    half, times = float(sens["half_width"].sel(output=worst)), needed[worst]
    values = {"take_times": times, "output": worst, "half": half}
    share = "the largest effect" if method == "morris" else "the variance"
    if times <= 1:
        apart = ", those of regimes apart" if set(map(str, sens["output"].values)) & set(REGIMES) else ""
        text = f"Yes: the indices of all outputs{apart} are known to ± {_percent(half)} of {share} or better."
        return Sentence("enough", text, values)
    number = int(times * (sens.attrs.get("rows", asked) if method == "table" else asked))
    text = f"No: the indices of {of_output(sens, worst)} are known to ± {_percent(half)} of {share} only."
    write = f"A table of {number} rows gives" if method == "table" else f"Write `samples: {number}` for"
    values |= {"number": number, "predicted": half / math.sqrt(times)}
    return Sentence("more", f"{text} {write} ± {_percent(half / math.sqrt(times))}.", values)


def _percent(half: float) -> str:
    return f"{rounded(100 * half, 2)} %"


def _of_points(sens: xr.Dataset, asked: int) -> Sentence | None:
    """Judge B10 of each life at its best design point, and the probability of each target at all design points."""
    found = []
    for output in (str(n) for n in sens["output"].values if "life" in str(n)):
        best = robustness(sens, output).values.get("point")
        part = sens.sel(output=output).isel(point=best) if best is not None else sens
        if best is None or not 0 < float(part["b10"]) < np.inf or not np.isfinite(float(part["b10_high"])):
            continue
        half = float(np.ptp(estimate(part, "b10")[1:])) / 2 / float(part["b10"])
        found.append((half, HALF_B10, f"B10 of the {part['output_name'].item()} at the best design point"))
    for t in range(sens.sizes.get("target", 0)):
        own = sens.isel(target=t)
        half = float(np.ptp(estimate(own, "target_probability")[1:], axis=0).max()) / 2
        found.append((half, HALF_WIDTH, f"the probability of {target_words(sens, t)}"))
    if not found:
        return None
    half, wanted, what = max(found, key=lambda item: item[0] / item[1])
    values = {"half": half, "wanted": wanted, "asked": asked}
    lives = any(limit == HALF_B10 for _, limit, _ in found)
    if half <= wanted and (asked >= FEWEST or not lives):
        return Sentence("enough", f"Yes: {what} is known to ± {_percent(half)}, and no other less well.", values)
    times = 2.0 ** max(0, math.ceil(math.log2((half / wanted) ** 2) - 1e-9))
    while lives and times * asked < FEWEST:
        times *= 2
    number, predicted = int(times * asked), half / math.sqrt(times)
    values |= {"number": number, "predicted": predicted}
    text = f"No: {what} is known to ± {_percent(half)} only. Write `samples: {number}` for ± {_percent(predicted)}."
    if half <= wanted:
        text = f"No: {asked} samples are too few for the interval of a B10. Write `samples: {number}`."
    return Sentence("more", text, values)
