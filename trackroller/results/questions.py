"""Which question a study asks, and its answer."""

from __future__ import annotations

import dataclasses

from trackroller.parameters import REGIMES
from trackroller.results.answer import Answer
from trackroller.results.best import answer_of_search
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.comparison import Comparison, compared_output
from trackroller.results.decide import answer_decide
from trackroller.results.how_it_behaves import answer_how_it_behaves
from trackroller.results.how_sure import answer_how_sure
from trackroller.results.output_ranges import output_ranges
from trackroller.results.requirement import required_of
from trackroller.results.search_fitness import optimum_of
from trackroller.results.solved_cases import SolvedCases, made_once
from trackroller.results.what_matters import answer_what_matters, shown_ranges
from trackroller.results.which_model import answer_which_model, models_of
from trackroller.roller.output_names import is_life

SENSITIVITY = ("saltelli", "morris", "central_composite", "box_behnken", "plackett_burman")


def question_of(results: SolvedCases) -> str:
    """Return which of `trackroller.results.answer.QUESTIONS` a study asks; the key `question` of
    its file decides.

    Parameters
    ----------
    results : SolvedCases
        A solved study.

    Notes
    -----
    The first that applies: best (a search), which model (several contact models; each has its own
    decision), what matters (a method of sensitivity analysis, or a random sample whose candidates
    share no conditions), decide (two candidates or more), how sure (one candidate with a
    requirement), how it behaves.
    """
    if results.config.question:
        return str(results.config.question)
    method = results.config.method
    if method.proposes:
        return "best"
    required = required_of(results)
    if compared_output(results, required) is None:
        if method.name in SENSITIVITY:
            return "what matters"
        return "how it behaves"
    own = Comparison.of(results)
    if own is None:
        return "how it behaves"
    if len(models_of(results)) > 1:
        return "which model"
    if method.name in SENSITIVITY or (method.sampled and not method.points and not _shared(own)):
        return "what matters"
    if own.count > 1 and not _about_another_output(results):
        return "decide"
    if required and own.count == 1:
        return "how sure"
    return "how it behaves"


def _shared(own: Comparison) -> bool:
    """Return whether candidates of a sample repeat, so that each has conditions that compare with
    those of others.
    """
    return own.groups.matched or own.count == 1 or bool(own.groups.size.min() > 1)


def _about_another_output(results: SolvedCases) -> bool:
    """Return whether a study without a requirement asks for outputs that rank no design, such as a
    force.
    """
    named = [name for name in results.config.analysis.outputs or () if name not in REGIMES]
    return bool(named) and not required_of(results) and not any(_ranks(name) for name in named)


def _ranks(name: str) -> bool:
    return is_life(name) or name.startswith("peak_stress")


@made_once
def answer_of_study(results: SolvedCases) -> Answer | None:
    """Return the answer to a study; None for a search that did not come to its end.

    Parameters
    ----------
    results : SolvedCases
        A solved study, finished or not.
    """
    question = question_of(results)
    if question == "best":
        if optimum_of(results) is None:
            return None
        return answer_of_search(results)
    needs_output = question in ("decide", "how sure")
    if needs_output and Comparison.of(results) is None:
        return answer_how_it_behaves(results)
    if question == "which model" and len(models_of(results)) < 2:
        return answer_how_it_behaves(results)
    if question == "what matters" and shown_ranges(results) is None:
        return answer_how_it_behaves(results)
    makers = {
        "decide": answer_decide,
        "how sure": answer_how_sure,
        "what matters": answer_what_matters,
        "which model": answer_which_model,
        "how it behaves": answer_how_it_behaves,
    }
    return _with_outputs(makers[question](results), results)


def _with_outputs(answer: Answer, results: SolvedCases) -> Answer:
    """Return an answer with the range of each usual output of the study."""
    ranges = CaseRanges(results, answer.output, is_life(answer.output[0]))
    return dataclasses.replace(answer, outputs=output_ranges(results, ranges))
