"""Warn where a result takes the typical friction of a pair although tests of the dry pair lie above
it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from trackroller.errors import listing
from trackroller.results.answer import Caution
from trackroller.roller.stored_inputs import friction_records


def friction_cautions(attrs: Mapping[str, Any]) -> Iterator[Caution]:
    """Yield one warning for each pair whose typical friction lies below the tests of the dry pair.

    Parameters
    ----------
    attrs : mapping
        Attributes of a solved case or study, which hold the coefficients from the database.
    """
    for record in friction_records(attrs):
        tests = record.get("dry_tests")
        if tests is None:
            continue
        low, high = tests["range"]
        choices = [*tests["words"], "a number"]
        text = (
            f"friction of {record['material_pair']}: {record['value']:g} is the typical "
            f"coefficient, and tests of the dry pair give {low:g} to {high:g}. "
            f"Give friction_coefficient: {listing(choices, 'or')}."
        )
        yield Caution("doubtful", 1, 1, text, "")
