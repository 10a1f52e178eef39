"""The head of the report: six lines that answer what an engineer asks first."""

from __future__ import annotations

import xarray as xr

from trackroller.parameters import REGIME_LABELS
from trackroller.report.numbers import capital
from trackroller.report.words import indices
from trackroller.report.words.accuracy import accuracy, friction_guess, known_errors
from trackroller.report.words.cases import occurrence, silent_drive, valid_cases
from trackroller.report.words.indices import part_sentences
from trackroller.report.words.limits import guesses, worn
from trackroller.report.words.optimum import optimum_sentences
from trackroller.report.words.samples import grown, samples
from trackroller.report.words.sentence import Sentence, say
from trackroller.report.words.targets import target
from trackroller.report.words.verdict import verdict_sentences
from trackroller.results.ranking import decisive, headline, order, robust_design
from trackroller.results.results import Results

Line = tuple[str, list[Sentence]]


def in_short(results: Results, models: list[str]) -> list[Line]:
    """Return the lines of *In short*: a head and its sentences.

    A line without content is left out.

    Parameters
    ----------
    results : the solved study
    models : sentences of the comparison of contact models, if the study has one
    """
    sens = results.analysis
    complete = sens if not results.unfinished else None  # the study asks for more samples than are solved
    enough = samples(complete, results.config.samples) if complete is not None else None
    compared = [Sentence("models", text) for text in models]
    search = optimum_sentences(results)
    lines: list[tuple[str, list[Sentence | None]]] = [
        # first, so that the first screen answers what to build
        ("Best" if search else "Verdict", [*(search or verdict_sentences(results)), _target(results)]),
        ("Valid cases", [valid_cases(results), stopped(results)]),
        ("What decides", decides(sens)),
        (
            "What limits",
            [
                *(occurrence(results, results.regime == c, capital(REGIME_LABELS[c])) for c in (1, 2, 3)),
                silent_drive(results),
            ],
        ),
        (
            "How sure",
            [
                friction_guess(results),
                guesses(results),
                worn(results),
                *known_errors(results),
                *accuracy(results),
                *compared,
            ],
        ),
        ("Enough samples?", [grown(results) or enough]),
    ]
    return [(head, kept) for head, said in lines if (kept := [s for s in said if s is not None])]


def _target(results: Results) -> Sentence | None:
    """Say how often all targets of the study are met, where its verdict does not say which candidates meet them."""
    sens, found = results.analysis, results.verdict
    if sens is None or "target" not in sens.dims:
        return None
    answered = found is not None and found.kind != "cannot_tell" and not found.sampled
    return None if answered and not robust_design(sens) else target(sens, -1)  # the last target joins several


def stopped(results: Results) -> Sentence | None:
    """Count the cases in which the condition of `stop_if` ended the search for stresses."""
    stopped = int((results.column("stopped", 0.0) == 1).sum())
    return say("cases", "stopped", count=stopped, of=len(results.table)) if stopped else None


def decides(sens: xr.Dataset | None) -> list[Sentence | None]:
    """Name the factors that decide life, or else the first output with an index; none for design points."""
    if sens is None or robust_design(sens):
        return []
    names = [str(n) for n in sens["output"].values]
    lives = sorted((n for n in names if "life" in n), key=lambda n: ("pair" not in n, "roller" not in n))
    ranked = [n for n in dict.fromkeys([*lives, *names]) if order(sens, n)]
    first = next((n for n in ranked if decisive(sens, n)), None)
    skipped = [indices.decides(sens, n) for n in ranked[:1] if n != first]  # why the life decides nothing
    if first is None:
        return [*skipped]
    said, more = indices.decides(sens, first), part_sentences(sens, first)
    by_group = "group_ST" in sens and headline(sens) == "first"  # the design serves groups better than factors
    return [*skipped, *([*more, said] if by_group else [said, *more])]
