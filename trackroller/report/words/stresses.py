"""Sentences on peak stresses: where they lie, and how they compare with the strength of the material."""

from __future__ import annotations

import numpy as np

from trackroller.analysis.table import StudyView
from trackroller.report.numbers import count, share
from trackroller.report.words.sentence import Sentence


def surface(view: StudyView, body: str, rows: np.ndarray) -> Sentence | None:
    """Say in how many cases the peak stress of a body lies at the surface."""
    flags = view.column(f"at_surface_{body}")
    known, hit = int((rows & ~np.isnan(flags)).sum()), int((rows & (flags == 1)).sum())
    if not known:
        return None
    where = f"at the surface in {count(hit)} of {count(known)} valid cases ({share(hit, known)})"
    if hit in (0, known):
        where = f"{'at' if hit else 'below'} the surface in all {count(known)} valid cases"
    text = f"The peak stress of the {body} lies {where}."
    return Sentence("surface", text, {"body": body, "count": hit, "of": known}, rows)


def strength(body: str, stress: np.ndarray, limit: np.ndarray, most: np.ndarray, rows: np.ndarray) -> Sentence | None:
    """Say how many rolling cases stay below the fatigue limit of a body and how many exceed its tensile strength.

    Parameters
    ----------
    stress, limit, most : peak stress, fatigue limit and tensile strength [MPa], shape (n,)
    rows : rolling cases, shape (n,) bool
    """
    rows = rows & np.isfinite(stress) & np.isfinite(limit)
    of, below, above = (int(part.sum()) for part in (rows, rows & (stress < limit), rows & (stress > most)))
    if not of:
        return None
    first = f"{share(below, of)} of the {count(of)} rolling cases stay" if below else "No rolling case stays"
    text = f"{first} below the fatigue limit of the {body}"
    text += f"; {share(above, of)} exceed its tensile strength and have no fatigue life" if above else ""
    return Sentence("strength", f"{text}.", {"body": body, "of": of, "below": below, "above": above}, rows)
