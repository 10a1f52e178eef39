"""Findings of a study in words."""

from __future__ import annotations

from trackroller.report.words.cases import event_words
from trackroller.report.words.factors import effect_words
from trackroller.report.words.indices import (
    coded_levels,
    group_words,
    idle_factors,
    index_words,
    level_words,
    named_words,
)
from trackroller.report.words.limits import limit_words
from trackroller.report.words.sentence import Sentence
from trackroller.results.findings import Finding
from trackroller.results.results import Results

INDICES = {
    "index": index_words,
    "interaction": named_words,
    "morris": named_words,
    "groups": group_words,
    "levels": level_words,
}
EFFECTS = ("pairs", "pairs_same", "pairs_both", "classes", "classes_both", "classes_none")
EVENTS = ("everywhere", "only", "crossed", "cases", "share", "frequent", "slip_law")
LIMITS = ("first_limits", "turned", "whichever_first")
OF_STUDY = (
    dict.fromkeys(EFFECTS, effect_words) | dict.fromkeys(EVENTS, event_words) | dict.fromkeys(LIMITS, limit_words)
)


def sentence_of(results: Results, finding: Finding) -> Sentence:
    """Say a finding in words; its numbers stay with the sentence."""
    if finding.kind == "index":
        sens = results.indices()
        return index_words(sens, finding, idle_factors(results, finding), coded_levels(results, sens))
    if finding.kind in INDICES:
        return INDICES[finding.kind](results.indices(), finding)
    return OF_STUDY[finding.kind](results, finding)
