"""Findings of a study in words."""

from __future__ import annotations

from trackroller.report.words.cases import event_words
from trackroller.report.words.factors import effect_words
from trackroller.report.words.indices import (
    coded_levels,
    group_words,
    index_words,
    interaction_words,
    level_words,
)
from trackroller.report.words.limits import limit_words
from trackroller.report.words.sentence import Sentence
from trackroller.results.findings import Finding
from trackroller.results.results import Results

INDICES = {
    "index": index_words,
    "interaction": interaction_words,
    "groups": group_words,
    "levels": level_words,
}
EFFECTS = ("pairs", "pairs_both", "fitted")
EVENTS = ("everywhere", "only", "crossed", "cases", "share", "frequent", "slip_law")
OF_STUDY = {"first_limits": limit_words} | dict.fromkeys(EFFECTS, effect_words) | dict.fromkeys(EVENTS, event_words)


def sentence_of(results: Results, finding: Finding) -> Sentence:
    """Say a finding in words; its numbers stay with the sentence."""
    if finding.kind == "index":
        sens = results.indices()
        return index_words(sens, finding, coded_levels(results, sens))
    if finding.kind in INDICES:
        return INDICES[finding.kind](results.indices(), finding)
    return OF_STUDY[finding.kind](results, finding)
