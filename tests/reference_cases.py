"""The reference cases as tests use them."""

import functools
import json
from pathlib import Path

import xarray as xr

import trackroller as tr

DATA = Path(__file__).parent / "data"


@functools.cache
def published_cases() -> list[dict]:
    """Return the cases of the published program with `exact` numbers of an independent quadrature."""
    return json.loads((DATA / "published_program.json").read_text())["cases"]


def case_of(record: dict) -> tr.Case:
    """Return the `Case` of a record. The record holds infinity as text, because JSON has no infinity."""
    return tr.Case.from_dict({k: float(v) if v == "inf" else v for k, v in record["case"].items()})


def solve_sliding(*args, **options) -> xr.Dataset:
    """Solve in full sliding, as published: quick, and independent of the default contact model."""
    return tr.solve(*args, contact_model="sliding", **options)
