"""The head of the report: six lines that answer what an engineer asks first."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.parameters import REGIME_LABELS
from trackroller.report import choices, parts
from trackroller.report import sentences as words
from trackroller.report.aims import target
from trackroller.report.claims import Sentence
from trackroller.report.enough import samples
from trackroller.report.findings import best_design, occurrence, valid_designs
from trackroller.report.known_errors import accuracy, friction_error, full_sliding
from trackroller.report.numbers import capital, count
from trackroller.report.view import StudyView

Line = tuple[str, list[Sentence]]
LIVES = ("roller_life_hours", "roller_life_cycles", "guide_life_hours", "guide_life_cycles")


def in_short(view: StudyView, sens: xr.Dataset | None, models: list[str]) -> list[Line]:
    """Return the lines of *In short*: a head and its sentences.

    A line without content is left out.

    Parameters
    ----------
    view : the study
    sens : its analysis, if there is one
    models : sentences of the comparison of contact models, if the study has one
    """
    robust = sens is not None and words.robust_design(sens)
    met = [target(sens, -1)] if sens is not None and "target" in sens.dims else []  # the last one joins several
    lines = [
        ("Valid designs", [valid_designs(view), stopped(view)]),
        ("Best design point", [*decides(sens), *met]) if robust else ("What decides", decides(sens)),
        ("Best", [best_design(view), *([] if robust else met)]),
        ("What limits", [occurrence(view, view.regime == c, capital(REGIME_LABELS[c])) for c in (1, 2, 3)]),
        (
            "How sure",
            [
                friction_error(view),
                full_sliding(view),
                *accuracy(view),
                *(Sentence("models", text) for text in models),
            ],
        ),
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
    """State what decides life (else the first output that has an index), or the best design point."""
    if sens is None:
        return []
    names = [str(n) for n in sens["output"].values]
    if words.robust_design(sens):
        lives = [n for n in LIVES if n in names]
        return [choices.robustness(sens, lives[0])] if lives else []
    ranked = [n for n in [*LIVES, *names] if n in names and words.order(sens, n)]
    if not ranked:
        return []
    said, more = words.decides(sens, ranked[0]), parts.sentences(sens, ranked[0])
    by_group = "group_ST" in sens and words.headline(sens) == "first"  # the design serves groups better than factors
    return [*more, said] if by_group else [said, *more]
