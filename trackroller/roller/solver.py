"""The one entry: from cases and wanted outputs to a labelled data set, running only the stages they need."""

from __future__ import annotations

import importlib
from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numba.core.registry import cpu_target

from trackroller.errors import InputError
from trackroller.parameters import CONTACT_MODELS, DEFAULT_OUTPUTS, MAPPING_FIELDS, OPTIONS
from trackroller.roller import equilibrium as eq
from trackroller.roller import requirements
from trackroller.roller.accuracy import Accuracy, error_attributes
from trackroller.roller.blocks import Block, join
from trackroller.roller.case import Case, CaseTable, to_table
from trackroller.roller.failures import with_reasons
from trackroller.roller.options import Options, model_in_use
from trackroller.roller.stages import case as stages_case
from trackroller.roller.stages import mechanics as stages
from trackroller.roller.stages import stress as stages_stress
from trackroller.roller.stages.scene import Results

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import MaterialDatabase

# What every solution needs anyway is loaded with this module, so that the first call is as quick as the others.
importlib.import_module("scipy.special")
importlib.import_module("dask.array")  # xarray asks for it at the first data set
cpu_target.typing_context.refresh()
cpu_target.target_context.refresh()

BLOCK = 2048  # cases worked on at once: bounds the memory whatever the size of the batch
WINDOW = 16 * BLOCK  # cases among which equal mechanics are looked for


def solve(
    cases: Any,
    outputs: Iterable[str] | str = DEFAULT_OUTPUTS,
    *,
    contact_model: str = "sliding",
    spin_model: str = "skewed",
    accuracy: str | float | Accuracy = "standard",
    hertz: str = "exact",
    stress_bodies: str = "both",
    life_rule: str = "elementary",
    normal: str = "hertz",
    contact_tolerance: float = 0.05,
    stop_if: str | None = None,
    shortcuts: bool = True,
    slip_terms: Collection[str] | str = (),
    database: MaterialDatabase | None = None,
) -> xr.Dataset:
    """Contact forces, tractions, stresses and life of track rollers.

    Parameters
    ----------
    cases : `Case` or mapping (result without case dimension), list of them or design data set (dimension `case`)
    outputs : groups among forces, contact, friction_work, peak_stress, life, tractions, subsurface
    contact_model : 'sliding' | 'fastsim' | 'kalker' | 'auto', the cheapest of them that meets `contact_tolerance`
    spin_model : 'concentric' | 'edge' | 'skewed', for sliding only
    accuracy : 'preview' | 'standard' | 'reference' or a relative tolerance of forces and peak stress, which picks the
        cheapest measured setting (see `trackroller.roller.accuracy`); attributes of the results tell the expected errors
    hertz : 'exact' or 'published' (the table of the published program)
    stress_bodies : 'both', or 'published' (one body with the mean Poisson's ratio)
    life_rule : 'elementary' | 'haibach' | 'unlimited' below the fatigue limit
    normal : 'hertz' pressures, or 'halfspace': patch and pressure solved on a grid, for drawn profiles too
    contact_tolerance : for `auto`: of normal forces and peak stress, and of friction forces over the normal force
    stop_if : a condition such as 'peak_stress > R_m' on which the search for peak stresses is not worth while; such
        cases are marked `stopped` and have no peak stress and life (see `trackroller.roller.stop`)
    shortcuts : spare what symmetry and repetition make superfluous; numbers are the same to rounding
    slip_terms : what the rigid slip of fastsim and kalker counts beyond the tangent of a straight guide: 'profile', the
        slip of the guide's profile, eq. (20), which sliding has anyway, and 'curve', the turning of the roller with the
        guide's curve, 1/(r_Curve + r_C,G cos(alpha)) added to 1/r_A in the spin, not for sliding; with any of them
        `auto` takes kalker. A contact beyond the axis of a concave guide is a failed row with 'curve'
    database : materials; the built-in and the user's own if not given

    Returns
    -------
    xarray.Dataset with units, long names and the paper's symbols; NaN where a regime leaves a quantity undefined. Where
    a case failed or misses its tolerance there is a text `reason`, with what to do about it.

    Raises `InputError` for bad input only: a case that cannot be solved is a row with `regime` failed.
    """
    given = locals()
    options = Options(**{name: given[name] for name in OPTIONS if name in given})
    single = isinstance(cases, Case) or (hasattr(cases, "keys") and not hasattr(cases, "data_vars"))
    if hasattr(cases, "data_vars"):
        single = "case" not in cases.dims
    table = to_table(cases, database)
    _check_cases(table, options)
    windows = [_solve_window(part, options) for part in _cut(table, WINDOW)]
    return with_reasons(_assemble(join(windows), options, single), table, options)


def _check_cases(table: CaseTable, options: Options) -> None:
    """Refuse profiles and friction laws that the options cannot serve."""
    laws = table.friction_law[table.friction_law != ""]
    if options.contact_model == "kalker_table" and laws.size:
        raise InputError(
            "friction_law",
            laws[0],
            "constant friction with contact_model: kalker_table",
            "Take contact_model: kalker, or leave friction_law out.",
        )
    for name in ("guide_profile", "roller_profile"):
        if options.normal != "halfspace" and np.any(getattr(table, name) != ""):
            raise InputError(
                "normal",
                options.normal,
                f"a case with a {name} needs normal: halfspace",
                f"Set normal to halfspace, or remove {name}.",
            )


def _cut(table: CaseTable, size: int) -> Iterator[CaseTable]:
    for i in range(0, max(len(table), 1), size):
        yield table.take(np.arange(i, min(i + size, len(table))))


def _solve_window(table: CaseTable, options: Options) -> Block:
    """Mechanics of the cases that differ in them; then what each case makes of them."""
    rows = number = np.arange(len(table))
    if options.shortcuts and len(table) > 1:
        rows, number = requirements.distinct_mechanics(table)
    found = join([_solve_block(part, options) for part in _cut(table.take(rows), BLOCK)])
    block = found.take(number)
    stages_case.finish(table, block, options)
    return block


def _solve_block(table: CaseTable, options: Options) -> Block:
    """Cases that share a contact model, a friction law and profiles are solved together."""
    groups = list(_groups(table, options))
    parts = [_solve_group(table.take(rows), replace(options, contact_model=model)) for model, rows in groups]
    order = np.argsort(np.concatenate([rows for _, rows in groups]))
    found = parts[0] if len(parts) == 1 else join(parts).take(order)  # one group has them in order
    return _without_doubt(table, found, options) if options.contact_model == "auto" else found


def _without_doubt(table: CaseTable, found: Block, options: Options) -> Block:
    """The solutions of `auto`, those exactly that say themselves that they may miss the tolerance."""
    from trackroller.roller.choice.choose import in_doubt

    again = in_doubt(table, found, options.contact_tolerance)
    if not again.size:
        return found
    place = np.arange(len(table))
    place[again] = len(table) + np.arange(again.size)
    return join([found, _solve_block(table.take(again), replace(options, contact_model="kalker"))]).take(place)


def _groups(table: CaseTable, options: Options) -> Iterator[tuple[str, np.ndarray]]:
    """Contact model and rows of cases that can be solved in one batch; without friction there are no tractions."""
    model = np.full(len(table), options.contact_model, dtype=object)
    if options.contact_model == "auto":
        from trackroller.roller.choice.choose import choose

        model = choose(table, options)
    bare = requirements.is_frictionless(table) & options.shortcuts
    keys = list(zip(model, bare.tolist(), *(getattr(table, name) for name in MAPPING_FIELDS), strict=True))
    rows: dict[tuple, list[int]] = {}
    for i, key in enumerate(keys):
        rows.setdefault(key, []).append(i)
    for key, own in rows.items():
        yield model_in_use(options, str(key[0]), key[2]), np.array(own)
    if not keys:
        yield "kalker" if options.contact_model == "auto" else options.contact_model, np.arange(0)


def _solve_group(table: CaseTable, options: Options) -> Block:
    scene = stages.prepare(table, options)
    balance = eq.solve_equilibrium(scene.loads, scene.mirror.law(scene.law))
    results = Results.start(scene, balance)
    wanted = set(options.outputs)
    stages.forces(results)
    stages.contact(results, options)
    stages.steep_friction(results, options)
    if "friction_work" in wanted:
        stages.friction_work(results, options)
    stages_stress.stop(results, options)
    if wanted & {"peak_stress", "life", "subsurface"}:
        stages_stress.peak_stress(results, options)
    if "tractions" in wanted:
        stages.tractions(results, options)
    if "subsurface" in wanted:
        stages_stress.subsurface(results, options)
    model = np.array([CONTACT_MODELS.index(name) for name in scene.model.used(len(table))], dtype=np.int8)
    return Block(results.values, results.regime, results.converged, results.bits, model, results.stopped)


def _assemble(block: Block, options: Options, single: bool) -> xr.Dataset:
    from trackroller import __version__
    from trackroller.roller.dataset import VARIABLES, build

    keep = [
        name
        for name in block.values
        if VARIABLES[name].group in options.outputs
        or name == "residual"
        or (name == "error_estimate" and "peak_stress" in options.outputs)
    ]
    attrs: dict[str, Any] = {
        "Conventions": "CF-1.11",
        "source": f"trackroller {__version__}",
        **options.attributes(),
        "life_conventions": stages_case.LIFE_CONVENTIONS,
        "sign_conventions": stages.SIGN_CONVENTIONS,
    }
    flags = {"regime": block.regime, "converged": block.converged, "validity": block.bits}
    flags["contact_model_used"] = block.model
    if options.stop_if is not None:
        flags["stopped"] = block.stopped
    ds = build({name: block.values[name] for name in keep}, flags, attrs, single)
    for name, told in error_attributes(options.settings, options.contact_model).items():
        if name in ds:
            ds[name].attrs.update(told)
    return ds
