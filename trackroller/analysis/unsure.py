"""Compare designs whose wear coefficients are known within a range only."""

from __future__ import annotations

import numpy as np

from trackroller.analysis.designs import Designs
from trackroller.parameters import MATERIAL_FIELDS

COEFFICIENT = "wear_coefficient_factor"
OF_MATERIALS = ("material_pair", *MATERIAL_FIELDS)


def unbeaten(designs: Designs) -> np.ndarray | None:
    """Return the designs that are the best for some wear coefficients within their ranges.

    Parameters
    ----------
    designs : Designs
        The designs of a study with the condition `wear_coefficient_factor`.

    Returns
    -------
    numpy.ndarray or None
        Numbers of the designs, as in the index of `Designs.table`. None if the study does not vary the coefficient, or
        cannot compare its designs.

    Notes
    -----
    At each level of the factor a design counts with its worst life over the other conditions; a case that is not valid
    counts as 0. Designs of the same materials share their coefficients, so they are compared level by level. The
    coefficients of other materials differ independently: a design is beaten if its longest life is shorter than the
    shortest life of another design.
    """
    view = designs.view
    if COEFFICIENT not in designs.conditions or not designs.rising or not designs.matched:
        return None
    lives = np.where(designs.usable, view.column(designs.goal[0]), 0.0)
    levels, level = np.unique(view.table[COEFFICIENT].to_numpy(float), return_inverse=True)
    worst = np.full((len(designs.size), len(levels)), np.inf)
    own = designs.place >= 0
    np.minimum.at(worst, (designs.place[own], level[own]), lives[own])
    named = [name for name in OF_MATERIALS if name in designs.choices]
    pairs = designs.table.sort_index()[named].astype(str).agg(" / ".join, axis=1).to_numpy() if named else None
    alike = np.ones((len(worst), len(worst)), bool) if pairs is None else pairs[:, None] == pairs[None, :]
    least, most = worst.min(axis=1), worst.max(axis=1)
    level_by_level = (worst[None] >= worst[:, None]).all(axis=2) & (worst[None] > worst[:, None]).any(axis=2)
    beaten = np.where(alike, level_by_level, least[None, :] > most[:, None])
    return np.flatnonzero(~beaten.any(axis=1) & (most > 0.0))
