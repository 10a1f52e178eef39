"""Declare the designs of a study, each once: the keys that it takes, and what its rows can be used for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Kind:
    """A design.

    Parameters
    ----------
    takes : mapping of str to object
        Keys of the study file that other designs refuse, with the values that they have if they are not given.
    array : bool
        Whether the factors alone decide the rows, so that the key `samples` does not count.
    coded : bool
        Whether the ends of a range are coded as -1 and 1.
    follows : bool
        Whether the places of the rows follow from their values.
    weighs : bool
        Whether the values of a list are drawn at random, in proportion to their weights.
    weighted : bool
        Whether rows have known weights, so that they give probabilities of a target.
    grows : bool
        Whether more samples keep the rows of fewer samples.
    grouped, conditional : bool
        Whether the rows give indices of groups of factors, and indices within each level of a category.
    """

    takes: Mapping[str, Any] = field(default_factory=dict)
    array: bool = False
    coded: bool = False
    follows: bool = False
    weighs: bool = False
    weighted: bool = False
    grows: bool = False
    grouped: bool = False
    conditional: bool = False


_COPIES: dict[str, Any] = {"replicates": 1}
_CORRELATED: dict[str, Any] = {"rank_correlations": ()}
_RANDOM = dict.fromkeys(("weighs", "weighted", "conditional"), True)
DESIGNS = {
    "grid": Kind(array=True, follows=True, weighted=True, grouped=True, conditional=True),
    "lhs": Kind(_CORRELATED, **_RANDOM),
    "sobol": Kind(_CORRELATED | _COPIES, grows=True, **_RANDOM),
    "morris": Kind(_COPIES | {"levels": 4}, grows=True),
    "saltelli": Kind(_COPIES | {"second_order": True, "groups": None}, grows=True, grouped=True, **_RANDOM),
    "central_composite": Kind(array=True, coded=True),
    "box_behnken": Kind(array=True, coded=True),
    "plackett_burman": Kind(array=True, coded=True),
    "inner_outer": Kind(_CORRELATED | _COPIES | {"inner": "sobol", "point_samples": ()}, weighted=True, grows=True),
    "table": Kind({"table": None}, follows=True, weighted=True, conditional=True),
    "optimise": Kind({"conditions": (), "population": 32, "table": None}, weighted=True),
}
METHODS = tuple(DESIGNS)


def those_that_take(key: str) -> list[str]:
    """Return the designs that take a key of the study file."""
    return [name for name, kind in DESIGNS.items() if key in kind.takes]


def those_with(trait: str) -> list[str]:
    """Return the designs for which a field of `Kind` is true."""
    return [name for name, kind in DESIGNS.items() if getattr(kind, trait)]
