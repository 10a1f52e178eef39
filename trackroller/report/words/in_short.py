"""The sentences of a report by the part of the page that they stand in."""

from __future__ import annotations

from trackroller.report.words.accuracy import accuracy, friction_error, friction_guess, full_sliding
from trackroller.report.words.cases import silent_drive, valid_cases
from trackroller.report.words.designs import life_error, within_words
from trackroller.report.words.findings import sentence_of
from trackroller.report.words.limits import guesses, worn
from trackroller.report.words.optimum import optimum_sentences, searched
from trackroller.report.words.pareto import pareto_sentence
from trackroller.report.words.samples import grown, of_target, samples, undecided
from trackroller.report.words.sentence import Sentence, say
from trackroller.report.words.targets import b10_by_tests
from trackroller.report.words.verdict import verdict_sentences
from trackroller.results.looks import looks_of
from trackroller.results.pareto import given_pareto, goals_of
from trackroller.results.ranking import main_lives, robust_design
from trackroller.results.results import Results

Line = tuple[str, list[Sentence]]


SETTLED = ("lasts", "none", "a_or_b")  # kinds of verdict for which the samples are enough


def in_short(results: Results, models: list[str]) -> list[Line]:
    """Return what a study says: the part of the page, and its sentences.

    A part without content is left out.

    Parameters
    ----------
    results : the solved study
    models : sentences of the comparison of contact models, if the study has one
    """
    search = optimum_sentences(results)
    verdict = search or verdict_sentences(results)
    told = {place: [sentence_of(results, one) for one in found] for place, found in results.findings.items()}
    lines: list[tuple[str, list[Sentence | None]]] = [
        ("Best" if search else "Verdict", [*verdict]),
        (
            "Decide",
            [
                None if results.analysis is None else b10_by_tests(results.analysis),
                _front(results, verdict),
            ],
        ),
        ("Why", [*told["why"], _within(results, told["why"]), _enough(results)]),
        ("Where it ends", [valid_cases(results), stopped(results), *told["ends"], silent_drive(results)]),
        (
            "How sure",
            [
                *(friction_guess(results), guesses(results), worn(results)),
                *(friction_error(results), full_sliding(results), *accuracy(results), life_error(results)),
                *(*searched(results), grown(results)),
                *(Sentence("models", text) for text in models),
            ],
        ),
    ]
    return [(head, kept) for head, said in lines if (kept := [s for s in said if s is not None])]


def _front(results: Results, verdict: list[Sentence]) -> Sentence | None:
    """State the ends of the Pareto set of the goals that a study gives, where its verdict does not name them."""
    front = given_pareto(results)
    if front is None or {"requirement", "tradeoff"} & {one.kind for one in verdict}:
        return None
    several = min(len(goals_of(front)), int(front["optimal"].sum())) > 1  # one design is the verdict of a search
    return pareto_sentence(front, results) if several or not results.config.method.proposes else None


def _within(results: Results, told: list[Sentence]) -> Sentence | None:
    """Say that the findings hold at the values of the placeholders, where lives are ranges."""
    return say("limits", "within", ends=within_words(results)) if told and results.ranged else None


def _enough(results: Results) -> Sentence | None:
    """Say whether there are samples enough for what decides; None for a sample that grows or is not finished."""
    sens = results.analysis
    if sens is None or results.unfinished or looks_of(results) is not None:
        return None
    found, asked, method = results.verdict, results.config.samples, results.config.method
    if found is not None and (found.kind, found.why) == ("cannot_tell", "sample"):
        return undecided(found, len(results.table) if method.observed else asked, method.observed)
    if "target" in sens.dims and method.sampled and (said := of_target(sens, asked)) is not None:
        return said
    told = [one.values["output"] for one in results.findings["why"] if one.kind == "index"]
    lives = main_lives(sens) if robust_design(sens) else []
    about = next(iter([*told, *lives]), None)
    kinds = ("build", *SETTLED) if found is not None and found.target else ("build",)
    settled = found is not None and found.sampled and found.kind in kinds
    return None if about is None else samples(sens, asked, about, settled)


def stopped(results: Results) -> Sentence | None:
    """Count the cases in which the condition of `stop_if` ended the search for stresses."""
    stopped = int((results.column("stopped", 0.0) == 1).sum())
    return say("cases", "stopped", count=stopped, of=len(results.table)) if stopped else None
