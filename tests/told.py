"""The sentences of findings, for tests."""

import numpy as np

from trackroller.report.words.findings import INDICES, sentence_of
from trackroller.results import findings
from trackroller.results.findings import OF_ANALYSIS, Finding

EVENTS = {"Full slip": "full_slip", "Lift-off": "lift_off", "Failure": "failed"}


def told(results, finding):
    """Return the sentence of a finding; None without one."""
    return None if finding is None else sentence_of(results, finding)


def occurrence(results, hit, what):
    """Return the sentence on an event."""
    return told(results, findings.occurrence(results, hit, EVENTS.get(what, what)))


def effect_of(results, column, factor, rows):
    """Return the sentence on the effect of a factor."""
    return told(results, findings.effect_of(results, column, factor, rows))


def of_analysis(sens, kind, output):
    """Return the sentence of a kind on an output of an analysis; None without one."""
    values = OF_ANALYSIS[kind](sens, output)
    if values is None:
        return None
    return INDICES[kind](sens, Finding(kind, values, "rolling", np.ones(0, dtype=bool), {}, ()))
