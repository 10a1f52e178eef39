"""The errors of discretisation that options are expected to have, as they were measured."""

from __future__ import annotations

import functools
import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.contact.friction_laws import law_of
from trackroller.contact.models import CLASSES
from trackroller.contact.rollers import converged_up_to
from trackroller.numerics.numbers import rounded_up
from trackroller.parameters import OPTIONS
from trackroller.parameters.accuracy import PEAK_OUTPUTS, RUNGS, settings_of
from trackroller.parameters.contact_models import DECLARED
from trackroller.roller.dataset import solved_by
from trackroller.roller.options import model_in_use

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.roller.case_table import CaseTable
    from trackroller.roller.options import Options

FILE = "expected_errors.json"  # measured errors by contact model, rung and quantity
_QUANTITY_OF = {
    "normal_force": "normal_force",
    "lateral_force": "friction_force",
    "driving_force": "friction_force",
    "spin_moment": "spin_moment",
    "friction_power": "friction_energy",
    "friction_energy_per_distance": "friction_energy",
    "peak_stress": "peak_stress",
    "life_cycles": "life",
    "life_hours": "life",
    "roller_life_hours": "life",
    "guide_life_hours": "life",
    "pair_life_hours": "life",
}
_RELATIVE_TO = {"friction_force": "mu F_N", "spin_moment": "mu F_N sqrt(a b)"}  # other quantities: to themselves


@dataclass(frozen=True)
class Levels:
    """Measured relative errors over the sample of designs: percentiles, and `bound`, which 99 % of all cases keep."""

    median: float
    p95: float
    p99: float
    bound: float


@functools.cache
def _measured() -> Any:
    text = resources.files("trackroller.roller").joinpath(FILE).read_text(encoding="utf-8")
    return json.loads(text)["models"]


def expected_errors(options: Options, contact_model: str, constant_friction: bool) -> dict[str, Levels]:
    """Return the measured errors of discretisation by quantity; nothing where this combination was not measured.

    The measurements hold for the rungs, ellipses, constant friction and the rigid slip that each model has by itself.
    """
    if options.normal != "hertz" or options.slip_terms or not constant_friction or options.tolerance is not None:
        return {}
    errors = CLASSES[contact_model].errors()
    settings = options.settings
    is_rung = settings.name in RUNGS and settings in (settings_of(settings.name, rough) for rough in (False, True))
    if not errors and is_rung:
        errors = _measured().get(contact_model, {}).get(settings.name, {})
    published = options.life_criterion == OPTIONS["life_criterion"].default  # its life alone was measured
    return {name: Levels(*levels) for name, levels in errors.items() if published or name != "life"}


def least_errors(table: CaseTable, options: Options) -> tuple[np.ndarray, np.ndarray]:
    """Return the least error of the forces and of the peaks that a rung can tell for each case, (n,) each.

    They are the constant parts of the estimated errors, which contact models from a table have.
    """
    models = [CLASSES[model_in_use(options, text)] for text in table.friction_law.tolist()]
    forces = np.zeros(len(models))
    peaks = np.zeros(len(models))
    for i, model in enumerate(models):
        if model.errors():
            forces[i] = model.errors()["friction_force"][2]
        if PEAK_OUTPUTS & set(options.outputs):
            peaks[i] = model.peak_error * table.friction_coefficient[i]
    return forces, peaks


def error_attributes(levels: Mapping[str, Levels]) -> dict[str, dict[str, Any]]:
    """Return attributes with the expected errors of discretisation, by result variable."""
    return {
        variable: {
            "expected_relative_error": rounded_up(max(levels[q].median, 1e-16)),
            "relative_error_99_percent": rounded_up(max(levels[q].bound, levels[q].p99, 1e-16)),
            "relative_error_refers_to": _RELATIVE_TO.get(q, "itself"),
        }
        for variable, q in _QUANTITY_OF.items()
        if q in levels
    }


def tell_errors(ds: xr.Dataset, table: CaseTable, options: Options) -> None:
    """Add as attributes the limit of the residual, and the errors of discretisation if they were measured."""
    ds.variables["residual"].attrs["converged_up_to"] = converged_up_to(options.contact_model, options.normal)
    constant = all(law_of(text).is_constant for text in set(table.friction_law.tolist()))
    cheaper = DECLARED[options.contact_model].cheaper
    model = options.contact_model
    if cheaper and np.any(solved_by(ds) == cheaper):
        model = cheaper
    for name, errors in error_attributes(expected_errors(options, model, constant)).items():
        if name in ds.variables:
            ds.variables[name].attrs.update(errors)
