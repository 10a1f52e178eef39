"""The errors of discretisation that options are expected to have, as they were measured."""

from __future__ import annotations

from collections.abc import Mapping
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
from trackroller.roller.measured_errors import Levels, measured
from trackroller.roller.options import model_in_use

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.roller.case_table import CaseTable
    from trackroller.roller.options import Options

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
# other quantities: to themselves
_RELATIVE_TO = {"friction_force": "mu F_N", "spin_moment": "mu F_N sqrt(a b)"}


def is_rung(options: Options) -> bool:
    """Return whether the settings of the options are those of a rung."""
    settings = options.settings
    return settings.name in RUNGS and settings in (
        settings_of(settings.name, rough) for rough in (False, True)
    )


def told_weights(accuracy: str, contact_model: str) -> dict[str, float]:
    """Return the factors on the estimated errors of a rung, see `told_errors`; nothing if they were
    not measured.

    Parameters
    ----------
    accuracy : str
        Name of a rung.
    contact_model : str
        Contact model.

    Returns
    -------
    dict of str to float
        By `friction_force`, `normal_force`, `friction_energy`, and for peaks `below_surface` and
        `at_surface` [1].
    """
    factors: dict[str, float] = _calibration(accuracy, contact_model).get("weights", {})
    return factors


def ratio_error(accuracy: str, contact_model: str, quantity: str = "life") -> float | None:
    """Return the error that 95 % of the ratios of two designs keep, as a factor less 1.

    Parameters
    ----------
    accuracy : str
        Name of a rung.
    contact_model : str
        Contact model.
    quantity : str
        `life` or `peak_stress`.

    Returns
    -------
    float or None
        The error [1]; None where it was not measured: other accuracies and contact models.

    Notes
    -----
    Measured on pairs of ordinary designs that differ by the groove or by the contact angle, under
    the same load (`validation.tradeoff.told`). Errors of such neighbours are alike, so that their
    ratio errs less than each of them.

    Examples
    --------
    >>> ratio_error("reference", "kalker") < ratio_error("preview", "kalker")
    True
    """
    error: float | None = _calibration(accuracy, contact_model).get("ratio", {}).get(quantity)
    return error


def _calibration(accuracy: str, contact_model: str) -> dict[str, Any]:
    """Return what was measured of the told errors of a rung; nothing if it was not."""
    calibration: dict[str, Any] = measured()["told"].get(contact_model, {}).get(accuracy, {})
    return calibration


def expected_errors(options: Options, contact_model: str, plain: bool) -> dict[str, Levels]:
    """Return the measured errors of discretisation by quantity; nothing where this combination was
    not measured.

    The measurements hold for the rungs, ellipses, `plain` surfaces, which have constant friction
    and no film, and the rigid slip that each model has by itself.
    """
    if (
        options.normal != "hertz"
        or options.slip_terms
        or not plain
        or options.tolerance is not None
    ):
        return {}
    errors = CLASSES[contact_model].errors()
    if not errors and is_rung(options):
        errors = measured()["models"].get(contact_model, {}).get(options.settings.name, {})
    # its life alone was measured
    published = options.life_criterion == OPTIONS["life_criterion"].default
    return {name: Levels(*levels) for name, levels in errors.items() if published or name != "life"}


def least_errors(table: CaseTable, options: Options) -> tuple[np.ndarray, np.ndarray]:
    """Return the least error of the forces and of the peaks that a rung can tell for each case,
    (n,) each.

    They are the constant parts of the estimated errors, which contact models from a table have.
    """
    given = zip(table.friction_law.tolist(), table.layer_flexibility.tolist(), strict=True)
    models = [CLASSES[model_in_use(options, text, film)] for text, film in given]
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
    """Add as attributes the limit of the residual, and the errors of discretisation if they were
    measured.
    """
    ds.variables["residual"].attrs["converged_up_to"] = converged_up_to(
        options.contact_model, options.normal
    )
    constant = all(law_of(text).is_constant for text in set(table.friction_law.tolist()))
    plain = constant and not np.any(table.layer_flexibility)
    cheaper = DECLARED[options.contact_model].cheaper
    model = options.contact_model
    if cheaper and np.any(solved_by(ds) == cheaper):
        model = cheaper
    for name, errors in error_attributes(expected_errors(options, model, plain)).items():
        if name in ds.variables:
            ds.variables[name].attrs.update(errors)
