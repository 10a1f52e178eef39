"""The one entry: from cases and wanted outputs to a labelled data set, running only the stages they need."""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numba.core.registry import cpu_target

from trackroller import equilibrium as eq
from trackroller import stages
from trackroller.accuracy import Accuracy, accuracy_settings
from trackroller.case import Case, CaseTable, to_table
from trackroller.errors import InputError, unknown_name
from trackroller.parameters import (
    CONTACT_MODELS,
    DEFAULT_OUTPUTS,
    HERTZ,
    LIFE_RULES,
    OUTPUT_GROUPS,
    SPIN_MODELS,
    STRESS_BODIES,
)

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import MaterialDatabase

# What every solution needs anyway is loaded with this module, so that the first call is as quick as the others.
importlib.import_module("scipy.special")
importlib.import_module("dask.array")  # xarray asks for it at the first data set
cpu_target.typing_context.refresh()
cpu_target.target_context.refresh()

BLOCK = 2048  # cases worked on at once: bounds the memory whatever the size of the batch


@dataclass(frozen=True)
class Options:
    """Checked options of a solution; see `solve`."""

    outputs: tuple[str, ...] = DEFAULT_OUTPUTS
    contact_model: str = "sliding"
    spin_model: str = "skewed"
    accuracy: str | float = "standard"
    hertz: str = "exact"
    stress_bodies: str = "both"
    life_rule: str = "elementary"

    def __post_init__(self) -> None:
        outputs = (self.outputs,) if isinstance(self.outputs, str) else tuple(self.outputs)
        object.__setattr__(self, "outputs", tuple(dict.fromkeys(outputs)))
        for name in self.outputs:
            if name not in OUTPUT_GROUPS:
                raise unknown_name("outputs", str(name), OUTPUT_GROUPS)
        if not self.outputs:
            raise InputError("outputs", outputs, "at least one of " + ", ".join(OUTPUT_GROUPS))
        for field, options in (("contact_model", CONTACT_MODELS), ("spin_model", SPIN_MODELS), ("hertz", HERTZ),
                               ("stress_bodies", STRESS_BODIES), ("life_rule", LIFE_RULES)):  # fmt: skip
            if getattr(self, field) not in options:
                raise unknown_name(field, str(getattr(self, field)), options)
        accuracy_settings(self.accuracy)

    @property
    def settings(self) -> Accuracy:
        """What the accuracy means for each stage."""
        return accuracy_settings(self.accuracy)


def solve(
    cases: Any, outputs: Iterable[str] | str = DEFAULT_OUTPUTS, *, contact_model: str = "sliding",
    spin_model: str = "skewed", accuracy: str | float = "standard", hertz: str = "exact",
    stress_bodies: str = "both", life_rule: str = "elementary", database: MaterialDatabase | None = None,
) -> xr.Dataset:  # fmt: skip
    """Contact forces, tractions, stresses and life of track rollers.

    Parameters
    ----------
    cases : `Case` or mapping (result without case dimension), list of them or design data set (dimension `case`)
    outputs : groups among forces, contact, friction_work, peak_stress, life, tractions, subsurface
    contact_model : 'sliding' | 'fastsim' | 'kalker'
    spin_model : 'concentric' | 'edge' | 'skewed', for sliding only
    accuracy : 'preview' | 'standard' | 'reference' or a relative tolerance of the peak stress
    hertz : 'exact' or 'published' (the table of the published program)
    stress_bodies : 'both', or 'published' (one body with the mean Poisson's ratio)
    life_rule : 'elementary' | 'haibach' | 'unlimited' below the fatigue limit
    database : materials; the built-in and the user's own if not given

    Returns
    -------
    xarray.Dataset with units, long names and the paper's symbols; NaN where a regime leaves a quantity undefined.

    Raises `InputError` for bad input only: a case that cannot be solved is a row with `regime` failed.
    """
    options = Options(tuple([outputs] if isinstance(outputs, str) else outputs), contact_model, spin_model, accuracy,
                      hertz, stress_bodies, life_rule)  # fmt: skip
    single = isinstance(cases, Case) or (hasattr(cases, "keys") and not hasattr(cases, "data_vars"))
    if hasattr(cases, "data_vars"):
        single = "case" not in cases.dims
    table = to_table(cases, database)
    blocks = [_solve_block(table.take(np.arange(i, min(i + BLOCK, len(table)))), options)
              for i in range(0, max(len(table), 1), BLOCK)]  # fmt: skip
    return _assemble(blocks, options, single)


def _solve_block(table: CaseTable, options: Options) -> stages.Results:
    scene = stages.prepare(table, options)
    balance = eq.solve_equilibrium(scene.loads, scene.model.law)
    results = stages.Results.start(scene, balance)
    wanted = set(options.outputs)
    stages.forces(results)
    stages.contact(results, options)
    if "friction_work" in wanted:
        stages.friction_work(results, options)
    if wanted & {"peak_stress", "life", "subsurface"}:
        stages.peak_stress(results, options)
    if "life" in wanted:
        stages.life(results, options)
    if "tractions" in wanted:
        stages.tractions(results, options)
    if "subsurface" in wanted:
        stages.subsurface(results, options)
    stages.validity(results)
    return results


def _assemble(blocks: list[stages.Results], options: Options, single: bool) -> xr.Dataset:
    from trackroller import __version__
    from trackroller.dataset import VARIABLES, build

    keep = [name for name in blocks[0].values
            if VARIABLES[name].group in options.outputs or name == "residual"
            or (name == "error_estimate" and "peak_stress" in options.outputs)]  # fmt: skip
    values = {name: np.concatenate([b.values[name] for b in blocks]) for name in keep}
    attrs = {
        "Conventions": "CF-1.11",
        "source": f"trackroller {__version__}",
        "contact_model": options.contact_model,
        "spin_model": options.spin_model if options.contact_model == "sliding" else "",
        "accuracy": str(options.accuracy),
        "hertz": options.hertz,
        "stress_bodies": options.stress_bodies,
        "life_rule": options.life_rule,
        "life_conventions": stages.LIFE_CONVENTIONS,
        "sign_conventions": stages.SIGN_CONVENTIONS,
    }
    regime, converged, bits = (np.concatenate([getattr(b, n) for b in blocks]) for n in ("regime", "converged", "bits"))
    return build(values, regime, converged, bits, attrs, single)
