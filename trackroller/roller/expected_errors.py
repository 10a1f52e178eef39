"""The errors of discretisation that settings are expected to have, as they were measured."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.contact.friction_laws import law_of
from trackroller.contact.settings import Accuracy, converged_up_to
from trackroller.numerics.numbers import rounded_up
from trackroller.parameters import CONTACT_MODELS
from trackroller.parameters.contact_models import DECLARED
from trackroller.roller.accuracy import Levels, ladders, own_errors

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.roller.options import Options
    from trackroller.roller.table import CaseTable

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


@functools.lru_cache(maxsize=64)
def expected_errors(settings: Accuracy, contact_model: str) -> dict[str, Levels]:
    """Return the measured errors of settings by quantity; the errors of the stages are added.

    Quantities whose settings were not measured are missing.
    """
    declared = DECLARED[contact_model]
    if declared.own_errors:
        return own_errors(contact_model)
    rungs, ladder = ladders(), declared.ladder
    if not ladder:
        return {}
    own: dict[str, dict[str, Any]]
    own = {
        "forces": {"force_nodes": settings.force_nodes, "coarse_nodes": settings.coarse_nodes},
        "peak": {"peak": list(vars(settings.peak).values())},
    }
    if ladder != "forces":
        elements = settings.elements if declared.interpolates else settings.on_grids
        own = {ladder: {"elements": elements}, "peak": own["peak"]}
    total: dict[str, Levels] = {}
    unknown: set[str] = set()
    for ladder, wanted in own.items():
        rung = next((r for r in rungs[ladder] if all(r.settings[k] == v for k, v in wanted.items())), None)
        if rung is None:
            unknown.update(rungs[ladder][0].errors)
            continue
        for name, levels in rung.errors.items():
            total[name] = _sum(total[name], levels) if name in total else levels
    return {name: levels for name, levels in total.items() if name not in unknown}


def _sum(one: Levels, other: Levels) -> Levels:
    return Levels(*(a + b for a, b in zip(vars(one).values(), vars(other).values(), strict=True)))


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
    if cheaper and np.any(ds.variables["contact_model_used"].values == CONTACT_MODELS.index(cheaper)):
        model = cheaper
    for name, errors in error_attributes(options.expected_errors(model, constant)).items():
        if name in ds.variables:
            ds.variables[name].attrs.update(errors)
