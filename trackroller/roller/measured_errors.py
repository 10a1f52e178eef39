"""The errors of discretisation that `validation.tradeoff` measured; a plan reads them without the
solver.
"""

from __future__ import annotations

import functools
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

# measured errors by contact model, rung and quantity
FILE = Path(__file__).with_name("expected_errors.json")
# largest friction of the designs that the factors of told errors were measured on
ORDINARY_FRICTION = 0.4


@dataclass(frozen=True)
class Levels:
    """Measured relative errors over the sample of designs: percentiles, and `bound`, which 99 % of
    all cases keep.
    """

    median: float
    p95: float
    p99: float
    bound: float


@functools.cache
def measured() -> Any:
    """Return what was measured: errors by contact model and rung, and the factors of told
    errors.
    """
    return json.loads(FILE.read_text(encoding="utf-8"))


def errors_of_rung(contact_model: str, rung: str) -> dict[str, Levels]:
    """Return the measured errors of a contact model on a rung by quantity; nothing if they were not
    measured.

    Examples
    --------
    >>> errors_of_rung("kalker", "reference")["peak_stress"].p95 < 0.01
    True
    """
    errors = measured()["models"].get(contact_model, {}).get(rung, {})
    return {name: Levels(*levels) for name, levels in errors.items()}
