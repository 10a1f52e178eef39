"""Solve cases: turn them into a labelled data set and run only the stages that the outputs need."""

from __future__ import annotations

import importlib
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numba.core.registry import cpu_target

from trackroller.damage import checked_limits, fatigue, first_limit, limits_of
from trackroller.damage.limit import Limit
from trackroller.errors import InputError
from trackroller.materials import load_database
from trackroller.parameters import CONTACT_MODELS, MECHANICAL_MAPPINGS, OPTIONS
from trackroller.parameters.accuracy import RUNGS, Accuracy
from trackroller.roller import distinct_contacts, temperature
from trackroller.roller.block_results import BlockResults, join
from trackroller.roller.case import Case, CaseTable, is_single, to_table
from trackroller.roller.case_limits import marks_of_limits, solved_of, to_compute, with_weakest
from trackroller.roller.dataset import NOTES, VARIABLES, build, file_attributes, joined
from trackroller.roller.expected_errors import tell_errors
from trackroller.roller.failures import with_reasons
from trackroller.roller.limit_notes import notes_on_limits
from trackroller.roller.options import Options, check_surface, model_in_use, options_of_cases
from trackroller.roller.reflection import handed, reflect
from trackroller.roller.stages import mechanics as stages
from trackroller.roller.stages import outcome as stages_outcome
from trackroller.roller.stages import stress as stages_stress
from trackroller.roller.stages.balance import balance
from trackroller.roller.stages.models import depends_on_smoothing, finer_across
from trackroller.roller.stages.scene import StageResults
from trackroller.roller.stored_inputs import with_coordinates, with_design, with_inputs
from trackroller.roller.told_errors import calibrate
from trackroller.roller.tolerance import meet
from trackroller.roller.travel import with_travel

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import MaterialDatabase

# Every solution needs these modules; loading them here makes the first call as quick as the others.
importlib.import_module("scipy.special")
cpu_target.typing_context.refresh()
cpu_target.target_context.refresh()

BLOCK = 2048  # number of cases that are solved at once, which bounds the memory
WINDOW = 16 * BLOCK  # among this many consecutive cases, those with equal mechanics are solved once


def solve(
    cases: Any,
    outputs: Iterable[str] | str | None = None,
    *,
    contact_model: str | None = None,
    spin_model: str | None = None,
    accuracy: str | float | Mapping[str, float] | Accuracy | None = None,
    hertz: str | None = None,
    stress_bodies: str | None = None,
    life_rule: str | None = None,
    life_criterion: str | None = None,
    credit_pressure: bool | None = None,
    wear_law: str | None = None,
    failure_probability: float | None = None,
    not_checked: Collection[str] | str | None = None,
    at_most: Collection[str] | str | None = None,
    normal: str | None = None,
    stop_if: str | None = None,
    shortcuts: bool | None = None,
    slip_terms: Collection[str] | str | None = None,
    database: MaterialDatabase | None = None,
) -> xr.Dataset:
    """Compute contact forces, tractions, stresses and life of track rollers.

    An option that is not given takes the value of the study file of a design, otherwise the first
    value of its list.

    Parameters
    ----------
    cases : Case, mapping, list or data frame of them, or xarray.Dataset
        What is solved. A list, a data frame with a case a row, and a data set with the dimension
        `case` give results along `case`. Parameters of a data set are variables or coordinates; any
        other name is refused. The results of a study's design can be analysed and reported: see
        `trackroller.open_study`.
    outputs : str or iterable of str
        Groups of results; a group is computed only if it is asked for: "forces", "contact",
        "peak_stress", "life", "limits" (by default these five), "friction_work", "tractions",
        "subsurface", one a limit. "limits" stands for the use and the life of every limit whose
        inputs the case gives.
    contact_model : str
        How friction is distributed over a patch: "kalker" (exact theory), "kalker_table" (table of
        exact solutions), or "sliding" (full slip everywhere, as published). "kalker" uses its table
        at accuracy "preview".
    spin_model : str
        Assumption 0, 1, 2 of the publication on the spin pole, for "sliding": "concentric", "edge",
        "skewed" (default).
    accuracy : str, float, mapping or Accuracy
        Discretisation: "preview", "standard", "reference", or a relative tolerance of forces and
        peak stress, also by quantity, down to `{"forces": 1e-3, "peak": 0.01, "life": 0.1}`. A
        tolerance is met case by case: a case takes the result of the first of these three whose
        estimated errors are within the tolerance, and `accuracy_used` names it.
        `error_over_tolerance` is at most 1, or the case has the flag `tolerance_missed`.
    hertz : str
        "exact" elliptic integrals, or "published" for the table of the published program.
    stress_bodies : str
        "both" bodies with their own Poisson's ratios, or "published" for one body with the mean.
    life_rule : str
        S-N curve below the fatigue limit: "elementary", "haibach" or "unlimited".
    life_criterion : str
        Stress that enters the S-N curve: "von_mises_peak", "von_mises_amplitude", "goodman",
        "findley" or "dang_van".
    credit_pressure : bool
        Whether hydrostatic pressure lowers Dang Van's stress (default).
    wear_law : str
        Law of wear: "archard" with the wear coefficient of the pair, or "energy" with the
        `wear_table` of the case.
    failure_probability : float
        Failure probability in (0, 1) at which the group "limits" states each life.
    not_checked : str or collection of str
        Limits that the group "limits" leaves out.
    at_most : str or collection of str
        Limits, such as "shakedown", whose utilisation is not computed where a cheap bound shows
        that they are kept: `utilisation` is NaN there, and `utilisation_at_most` the bound. One
        case alone gets its numbers.
    normal : str
        "hertz" for Hertzian patches, "halfspace" for non-Hertzian ones by boundary elements, which
        drawn profiles need.
    stop_if : str, optional
        Condition, where no peak stress is searched for, such as "peak_stress > R_m". See
        `trackroller.roller.stop`.
    shortcuts : bool
        Whether symmetry and repetition among the cases are used (default), so that mirrored rollers
        have mirrored bits.
    slip_terms : str or collection of str
        What the rigid slip of kalker counts beyond the tangent of a straight guide: "profile", the
        slip by eq. (20), which sliding always counts, and "curve", the turning of the roller with
        the guide's curve.
    database : MaterialDatabase, optional
        The materials; by default the built-in ones with the user's own over them.

    Returns
    -------
    xarray.Dataset
        Results with `units`, `long_name` and the symbol of the publication. The dimensions are
        `contact` (1, 2), `body` ("roller", "guide") and `case`, which a single case does not have.
        A quantity that the regime leaves undefined is NaN. `regime`, `converged`, `residual`,
        `validity` and `contact_model_used` are always there. Inputs of cases are coordinates:
        parameters that are given or have a default, and names of materials.

    Raises
    ------
    InputError
        For bad input. A case that cannot be solved raises nothing: its `regime` is failed, and a
        text `reason` says why and what to do.

    Notes
    -----
    A case takes from 1 ms (sliding) to some seconds (kalker at accuracy "reference") of processor
    time.

    Examples
    --------
    >>> import trackroller as tr
    >>> ds = tr.solve(tr.Case(), outputs=("forces", "peak_stress"))
    >>> ds.normal_force.dims, ds.normal_force.attrs["units"]
    (('contact',), 'N')
    >>> float(ds.peak_stress.sel(contact=1, body="roller").round())
    412.0
    >>> both = tr.solve([tr.Case(friction_coefficient=mu) for mu in (0.0, 0.3)])
    >>> dict(both.roller_life_hours.sizes)
    {'case': 2}
    """
    given = {
        name: value for name, value in locals().items() if name in OPTIONS and value is not None
    }
    if hasattr(cases, "data_vars"):
        return _solve_design(cases, given, database)
    single = is_single(cases)
    if database is None:
        database = load_database()
    table = to_table(cases, database)
    options = Options(**given)
    if single:  # what is said of one roller takes numbers
        options = options.changed(at_most=())
    ds = with_coordinates(_solve_table(table, options, single), table)
    if not single:
        return ds
    case = cases
    if not isinstance(cases, Case):
        case = Case.from_dict(cases)
    return with_inputs(ds, case, database)


def _solve_design(
    cases: xr.Dataset, given: Mapping[str, Any], database: MaterialDatabase | None
) -> xr.Dataset:
    """Solve a data set of cases, each with the options that belong to it."""
    different, group = options_of_cases(cases, given)
    options = [Options(**one) for one in different]
    if "case" not in cases.dims:
        options = [one.changed(at_most=()) for one in options]
    table = to_table(cases, database)
    if len(options) == 1:
        return with_design(
            _solve_table(table, options[0], "case" not in cases.dims), cases, database
        )
    rows = [np.flatnonzero(group == number) for number in range(len(options))]
    parts = [
        _solve_table(table.take(own), one, single=False).assign_coords(case=own)
        for own, one in zip(rows, options, strict=True)
    ]
    return with_design(
        joined(parts).sel(case=np.arange(len(table))).drop_vars("case"), cases, database
    )


def _solve_table(table: CaseTable, options: Options, single: bool) -> xr.Dataset:
    """Solve checked cases with the same options."""
    _check_cases(table, options)
    worn, lost = with_travel(table, options)
    windows = [_solve_window(part, options) for part in _cut(worn, WINDOW)]
    block = join(windows)
    block.fail(list(lost))
    ds = with_reasons(
        assemble(block, options, single), worn, options, temperature.reasons(block) | lost
    )
    tell_errors(ds, worn, options)
    checks_limits = (
        first_limit.GROUP in options.outputs or options.life_criterion in fatigue.STRESS_OF
    )
    warm = temperature.notes(worn, block)
    if checks_limits or warm or any(limit.shared for limit in limits_of(options.outputs)):
        ds.attrs[NOTES] = "\n".join([*notes_on_limits(worn, options), *warm])
    return ds


def _check_cases(table: CaseTable, options: Options) -> None:
    """Refuse profiles, friction laws and films that the options cannot serve."""
    for law in dict.fromkeys(table.friction_law.tolist()):
        check_surface(options.contact_model, law, 0.0)
    for film in table.layer_flexibility[table.layer_flexibility > 0.0][:1].tolist():
        check_surface(options.contact_model, "", film)
    for name in ("guide_profile", "roller_profile"):
        if options.normal != "halfspace" and np.any(getattr(table, name) != ""):
            remedy = f"Set normal to halfspace, or remove {name}."
            raise InputError(
                "normal", options.normal, f"halfspace, for a case with a {name}", remedy
            )


def _cut(table: CaseTable, size: int) -> Iterator[CaseTable]:
    for i in range(0, max(len(table), 1), size):
        yield table.take(np.arange(i, min(i + size, len(table))))


def _solve_window(table: CaseTable, options: Options) -> BlockResults:
    """Solve each distinct mechanics once; then compute power, life and warnings of every case."""
    if options.shortcuts:
        one_handed, mirrored = handed(table)
    else:
        one_handed = table
        mirrored = np.zeros(len(table), bool)

    def solve_all(cases: CaseTable) -> BlockResults:
        return join([meet(few, options, _solve_block) for few in _cut(cases, BLOCK)])

    distinct = one_handed
    number = np.arange(len(table))
    if options.shortcuts and len(table) > 1:
        marks = marks_of_limits(one_handed, options)
        rows, number = distinct_contacts.distinct_mechanics(one_handed, marks)
        distinct = one_handed.take(rows)
        if options.at_most:
            distinct = with_weakest(distinct, one_handed, number)
    at_temperature, block = temperature.settle(
        one_handed, solve_all(distinct).take(number), options, solve_all
    )
    calibrate(at_temperature, block, options)
    stages_outcome.finish(at_temperature, block, options)
    reflect(block.values, mirrored)
    return block


def _solve_block(table: CaseTable, options: Options) -> BlockResults:
    """Solve cases together that share a contact model, a friction law and profiles."""
    groups = list(_groups(table, options))
    if len(groups) == 1:  # its rows are in order
        model, n, _ = groups[0]
        return _solve_group(table, options.changed(contact_model=model), n)
    parts = [
        _solve_group(table.take(rows), options.changed(contact_model=model), n)
        for model, n, rows in groups
    ]
    return join(parts).take(np.argsort(np.concatenate([rows for *_, rows in groups])))


def _groups(table: CaseTable, options: Options) -> Iterator[tuple[str, int, np.ndarray]]:
    """Yield contact model, factor on the elements across, and rows of cases that can be solved in
    one batch.

    Frictionless cases and those with a film are batches alone, and so are cases with the same
    limits.
    """
    bare = distinct_contacts.is_frictionless(table) & options.shortcuts
    across = finer_across(table, options)
    has_film = (table.layer_flexibility > 0.0).astype(float)
    limits = marks_of_limits(table, options)[:, 0]
    mappings = (getattr(table, name) for name in MECHANICAL_MAPPINGS)
    columns = limits, bare, *mappings, has_film, across
    keys = list(zip(*(column.tolist() for column in columns), strict=True))
    rows: dict[tuple, list[int]] = {}
    for i, key in enumerate(keys):
        rows.setdefault(key, []).append(i)
    for key, own in rows.items():
        yield model_in_use(options, key[2], key[-2]), key[-1], np.array(own)
    if not keys:
        yield options.contact_model, 1, np.arange(0)


def _solve_group(table: CaseTable, options: Options, across: int) -> BlockResults:
    scene = stages.prepare(table, options, across)
    results = StageResults.start(scene, balance(scene))
    results.flag(
        "smoothing", depends_on_smoothing(table, options, across, results.balance.normal_force)
    )
    return block_of(results, options)


def block_of(results: StageResults, options: Options) -> BlockResults:
    """Return the results of balanced rollers with the stages that the outputs need."""
    scene = results.scene
    outputs = set(options.outputs)
    limits = _limits(scene.table, options)
    outputs |= {need for limit in limits for need in limit.needs}
    stages.forces(results)
    stages.force_error(results, options)
    stages.contact(results, options)
    stages.steep_friction(results, options)
    if "friction_work" in outputs:
        stages.friction_work(results, options)
    stages_stress.stop(results, options)
    if outputs & {"peak_stress", "subsurface"}:
        stages_stress.peak_stress(results, options)
    if "tractions" in options.outputs:
        stages.tractions(results, options)
    if "subsurface" in outputs:
        stages_stress.subsurface(results, options)
    stages.settle(results)
    # the limits take N and mm
    results.values |= {name: results.in_mm(name) for name in results.values}
    stages_outcome.patch_limits(results, options, limits)
    model = np.array(
        [CONTACT_MODELS.index(name) for name in scene.model.used(scene.n)], dtype=np.int8
    )
    settings = options.settings.name
    rung = np.zeros(scene.n, dtype=np.int8)
    if settings in RUNGS:
        rung[:] = RUNGS.index(settings)
    return BlockResults(
        results.values,
        results.regime,
        results.converged,
        results.bits,
        model,
        rung,
        results.stopped,
    )


def _limits(table: CaseTable, options: Options) -> tuple[Limit, ...]:
    """Return the limits to compute for cases that are not solved yet."""
    return to_compute(solved_of(table, {}, options), options)


def assemble(block: BlockResults, options: Options, single: bool) -> xr.Dataset:
    """Return a block of finished cases as a labelled data set; `single` drops the dimension
    `case`.
    """
    keep = [
        name
        for name in block.values
        if (
            name in VARIABLES
            and VARIABLES[name].group in options.outputs
            and name != first_limit.AT_MOST
        )
        or name == "residual"
        or (name == first_limit.AT_MOST and options.at_most)
        or (name == "error_estimate" and "peak_stress" in options.outputs)
        # the materials of these results are those at this temperature
        or (name == "bulk_temperature_rise" and first_limit.GROUP in options.outputs)
    ]
    attrs: dict[str, Any] = {
        **file_attributes("Forces, stresses and life of track rollers", "solved"),
        **options.attributes(),
        "life_conventions": stages_outcome.LIFE_CONVENTIONS,
        "sign_conventions": stages.SIGN_CONVENTIONS,
    }
    flags = {"regime": block.regime, "converged": block.converged, "validity": block.bits}
    if block.bodies is not None:
        flags["validity_body"] = block.bodies
    flags["contact_model_used"] = block.model
    if options.tolerance is not None:
        flags["accuracy_used"] = block.rung
    grouped = {
        "first_to_fail": "life",
        "limiting_mechanism": first_limit.GROUP,
        "limit_state": first_limit.GROUP,
    }
    flags |= {
        name: block.values[name] for name, group in grouped.items() if group in options.outputs
    }
    if first_limit.GROUP in options.outputs:
        attrs["limits"] = " ".join(
            limit.name for limit in checked_limits(options.outputs, options.not_checked)
        )
    if options.stop_if is not None:
        flags["stopped"] = block.stopped
    return build({name: block.values[name] for name in keep}, flags, attrs, single)
