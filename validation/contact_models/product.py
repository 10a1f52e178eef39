"""The comparison of contact models: a study like any other, and the errors of its cheaper models."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import trackroller as tr
from trackroller.report.build import build_report
from trackroller.results.model_errors import GOOD, errors, pairs
from trackroller.results.results import Results
from trackroller.study.store.folder import StudyFolder


def compare(study: Mapping[str, Any], out: Path) -> dict[str, Any]:
    """Solve and report a study in `out/study`; return how far each cheaper model is from the exact theory."""
    solved = tr.run({**study, "name": "study"}, progress=False, results=out)
    build_report(StudyFolder(out / "study"))
    found = model_errors(solved)
    models = {
        model: {str(name): spread(found[name].sel(contact_model=model).values) for name in found.data_vars}
        for model in found.contact_model.values.tolist()
    }
    return {"designs": found.sizes["design"], "models": models}


def model_errors(solved: Results) -> xr.Dataset:
    """Return the errors of each cheaper model, with the inputs of the designs that vary."""
    paired = pairs(solved)
    if paired is None:
        raise ValueError("the study must compare contact models")
    return errors(paired).assign_coords(paired.drop_dims("contact_model").coords)


def spread(error: np.ndarray) -> dict[str, float]:
    """Return the number of known errors, the share of good ones, the median, the 90th percentile and the largest."""
    known = error[~np.isnan(error)]
    if not known.size:
        return {"designs": 0}
    levels = dict(zip(("median", "90", "largest"), np.quantile(known, (0.5, 0.9, 1.0)).tolist(), strict=True))
    return {"designs": known.size, "good": float(np.mean(known <= GOOD)), **levels}
