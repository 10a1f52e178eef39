"""Calibrate the told errors: scale estimated errors by factors that were measured on ordinary
designs.

The solution estimates its errors with care, so that nearly all are smaller. Such bounds are far
larger than usual errors, and a verdict needs usual ones: the told errors of ordinary designs cover
95 to 99 %. The factors depend on the contact model, the rung and the kind of peak.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact.friction_laws import law_of
from trackroller.contact.models import CLASSES
from trackroller.parameters.accuracy import RUNGS
from trackroller.roller.expected_errors import is_rung, told_weights
from trackroller.roller.measured_errors import ORDINARY_FRICTION
from trackroller.roller.options import model_in_use

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.roller.block_results import BlockResults
    from trackroller.roller.case import Case, CaseTable
    from trackroller.roller.options import Options

FORCES = {
    "friction_force": "force_error_estimate",
    "normal_force": "normal_force_error_estimate",
    "friction_energy": "friction_energy_error_estimate",
}
PEAKS = ("below_surface", "at_surface")


def calibrate(table: CaseTable, block: BlockResults, options: Options) -> None:
    """Scale the estimated errors of a block of solved cases, in place.

    Cases with more friction than ordinary ones, falling friction, a film, solved patches and
    settings of a user keep their estimates, because no factors were measured for them.

    Parameters
    ----------
    table : CaseTable
        The n cases.
    block : BlockResults
        Their results. Errors of F_N, F_T, F_A and friction energy have the shape (n, 2), those of
        peaks (n, 2, 2).
    options : Options
        The options of the solution. With a tolerance each case has the factors of the rung that
        served it.
    """
    if (
        options.normal != "hertz"
        or options.slip_terms
        or not (options.tolerance is not None or is_rung(options))
    ):
        return
    texts = table.friction_law.tolist()
    constant = {text: law_of(text).is_constant for text in set(texts)}
    ordinary = np.array([constant[text] for text in texts], bool)
    ordinary &= table.friction_coefficient <= ORDINARY_FRICTION
    ordinary &= table.layer_flexibility == 0.0
    for place, rung in enumerate(RUNGS):
        rows = np.flatnonzero(ordinary & (block.rung == place))
        if not rows.size:
            continue
        model = model_in_use(options.changed(accuracy=rung), "")
        weights = told_weights(rung, model)
        if weights:
            constant_part = CLASSES[model].peak_error * table.friction_coefficient[rows]
            _scale(block.values, rows, weights, constant_part)


def _scale(
    values: dict[str, np.ndarray],
    rows: np.ndarray,
    weights: Mapping[str, float],
    constant: np.ndarray,
) -> None:
    """Scale the errors of some rows; `constant` (m,) is the part of the errors of peaks that the
    model adds.
    """
    for quantity, name in FORCES.items():
        if name in values:
            values[name] = values[name].copy()
            values[name][rows] *= weights[quantity]
    if "error_estimate" in values:
        error = values["error_estimate"].copy()
        weight = np.where(
            values["peak_z"][rows] == 0.0, weights["at_surface"], weights["below_surface"]
        )
        error[rows] = weight * np.maximum(error[rows] - constant[:, None, None], 0.0)
        values["error_estimate"] = error


def raw_errors(ds: xr.Dataset, cases: Sequence[Case], model: str) -> dict[str, np.ndarray]:
    """Return the errors that are scaled, of a data set that was not calibrated, by quantity [1].

    Parameters
    ----------
    ds : xarray.Dataset
        Results of n cases.
    cases : sequence of Case
        The cases.
    model : str
        Contact model.

    Returns
    -------
    dict of str to numpy.ndarray
        `friction_force`, `normal_force` and `friction_energy` (n, 2), `peak_stress` (n, 2, 2).
    """
    friction = np.array([case.friction_coefficient for case in cases])
    own = ds.error_estimate.transpose("case", "contact", "body").values
    constant = CLASSES[model].peak_error * friction[:, None, None]
    raw = {quantity: ds[name].values for quantity, name in FORCES.items()}
    return raw | {"peak_stress": np.maximum(own - constant, 0.0)}
