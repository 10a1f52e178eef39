"""A sentence on a study as an object that can be checked.

A `Sentence` holds its text, what it claims as plain values, and the rows that it holds for.
`tests/report/test_truth.py` recomputes the claims from the raw rows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Sentence:
    """One statement on a study.

    Attributes
    ----------
    kind : name of the kind of sentence; each kind has its own check in the truth test
    text : the sentence
    values : what it claims, in plain numbers and names
    rows : cases that the statement is on, shape (n,) bool; None for a statement on the analysis
    """

    kind: str
    text: str
    values: Mapping[str, Any] = field(default_factory=dict)
    rows: np.ndarray | None = None
