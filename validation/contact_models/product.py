"""The shipped comparison of contact models: a study like any other, and its patches.

snakemake -s validation/Snakefile --cores all contact_models
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.analysis.contact_models import GOOD, errors, pairs
from trackroller.analysis.stored_study import read_results
from trackroller.files import write_whole
from trackroller.report.build import analyse_study, draw_study, report_study
from trackroller.report.figures import style
from trackroller.roller.case import Case
from trackroller.roller.solver import solve
from trackroller.study.file.load import load_study
from trackroller.study.run import run_study
from trackroller.study.store.seal import sealing
from validation.contact_models import patches as ladder_patches

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.report.figures.style import FigureInfo

MODELS = ("sliding", "fastsim", "kalker")
# pictures of the patch: friction coefficient, and motor force over the largest force that friction can transmit
PATCHES = ((0.05, 0.0), (0.15, 0.0), (0.15, 0.5), (0.5, 0.0), (0.5, 0.5))


def compare(study_file: Path, out: Path) -> None:
    """Solve the study, then figures, errors and report as of any study, with pictures of the patch, into `out`."""

    study = load_study(study_file)
    plan = run_study(study, out.parent)
    if plan.folder.root != out:
        raise ValueError(f"the study must be named {out.name}")
    gathered, analysis, figures = str(plan.folder.gathered), str(out / "sensitivity.nc"), out / "figures"
    analyse_study(gathered, analysis)
    draw_study(gathered, analysis, str(figures))
    base = {k: v for k, v in study.config.base.items() if k not in study.factors}
    with sealing(figures):  # the pictures of the patch join the figures of the study
        draw_patches(Case.from_dict(base), figures)
    write_errors(gathered, out / "contact_models.json")
    report_study(gathered, str(figures), analysis, str(out / "report.html"))


def write_errors(study_nc: str, path: Path) -> None:
    """Write how far each cheaper model is from the exact theory: quantity by quantity, as JSON."""
    paired = pairs(read_results(study_nc).view)
    if paired is None:
        raise ValueError("the study must compare contact models")
    found = errors(paired)
    told = {
        model: {str(name): spread(found[name].sel(contact_model=model).values) for name in found.data_vars}
        for model in found.contact_model.values.tolist()
    }
    told = {"designs": paired.sizes["design"], "models": told}
    write_whole(path, lambda beside: beside.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8"))


def spread(found: np.ndarray) -> dict[str, float]:
    """Return the number of known errors, the share of good ones, the median, the 90th percentile and the largest."""
    known = found[~np.isnan(found)]
    if not known.size:
        return {"designs": 0}
    levels = dict(zip(("median", "90", "largest"), np.quantile(known, (0.5, 0.9, 1.0)).tolist(), strict=True))
    return {"designs": known.size, "good": float(np.mean(known <= GOOD)), **levels}


def draw_patches(case: Any, out: Path) -> list[FigureInfo]:
    """Draw the patches of a case by model, with their index, in the folder `out`."""
    name = "models-patches"
    caption = "Friction, stick and dissipation across contact 1 by contact model, free and driven."
    infos = [style.FigureInfo(name, caption, "")]
    with style.look():
        style.save(ladder_patches.patches(patch_fields(case)), out, name)
    style.write_index(infos, out, "index-models.json")
    return infos


def patch_fields(case: Any, wanted: Sequence[tuple[float, float]] = PATCHES) -> xr.Dataset:
    """Return tractions, slip and stick over both patches of `case` by model; dimensions contact_model x row.

    `wanted`: friction coefficient of each row, and the drive as a share of mu times the sum of the normal forces that
    the load alone causes.
    """

    press = abs(case.radial_force) / np.cos(np.deg2rad(case.contact_angle))
    drives = [-float(f"{share * mu * press:.1g}") if share else 0.0 for mu, share in wanted]
    cases = [
        dataclasses.replace(case, motor_force=drive, friction_coefficient=mu)
        for (mu, _), drive in zip(wanted, drives, strict=True)
    ]
    parts = []
    for model in MODELS:
        ds = solve(cases, outputs=("forces", "contact", "tractions"), contact_model=model)
        parts.append(
            ds.rename(case="row").assign_coords(
                friction_coefficient=("row", [mu for mu, _ in wanted]),
                motor_force=("row", drives),
                contact_model=model,
            )
        )
    # full sliding is drawn on its own number of points
    points = {n: max(p.sizes[n] for p in parts) for n in ("x", "y")}
    parts = [_resampled(p, points) for p in parts]
    return xr.concat(parts, "contact_model", combine_attrs="drop_conflicts")


def _resampled(ds: xr.Dataset, points: dict[str, int]) -> xr.Dataset:
    """Return fields on a grid of `points` positions, each from the nearest point of the field."""
    pick = {n: np.minimum((np.arange(m) * ds.sizes[n]) // m, ds.sizes[n] - 1) for n, m in points.items()}
    return ds.isel(pick).drop_vars([n for n in ("x", "y") if n in ds.coords])
