"""Solve the blocks of a load spectrum and sum their damage to the life of roller and guide in
shifts.

ASSUME: damage adds up linearly, independent of the order of the blocks (Palmgren-Miner). A limit
without a life is reached by the worst block alone. ASSUME: the blocks load the same two tracks of
the roller and the same point of the guide.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS, fatigue, first_limit, miner
from trackroller.damage.limit import Limit, skidding
from trackroller.damage.pair import first_failure
from trackroller.damage.sn_curve import CONVENTIONS, SNCurve, typical_scatter
from trackroller.materials import load_database
from trackroller.parameters import BODIES, PARAMETERS
from trackroller.roller.case import Case, to_table
from trackroller.roller.doubts import doubts
from trackroller.roller.duty import OVERROLLINGS, with_duty
from trackroller.roller.requirement import KEY
from trackroller.roller.run_in import groups_for_run_in, with_run_in
from trackroller.roller.stored_inputs import DOUBTS, NOT_GIVEN, material_values, plain_inputs
from trackroller.roller.temperature import temperatures_of
from trackroller.study.spectrum.file import LOAD_FIELDS, Spectrum, overrollings_per_shift

if TYPE_CHECKING:
    from trackroller.materials import Material, MaterialDatabase

# values of a material that make its S-N curve
OF_CURVE = (
    *("tensile_strength", "fatigue_limit", "cycles_at_tensile_strength", "cycles_at_fatigue_limit"),
    *("scatter_in_cycles", "scatter_in_stress", "second_exponent"),
)
_BCB = ("block", "contact", "body")
_CB = ("contact", "body")


def solve_spectrum(
    spectrum: Spectrum,
    database: MaterialDatabase | None = None,
    solve: Callable[..., xr.Dataset] | None = None,
) -> xr.Dataset:
    """Return the damage of each block, the damage sum, and the life of roller and guide in shifts.

    Parameters
    ----------
    spectrum : Spectrum
        The blocks and the options of their solution.
    database : MaterialDatabase, optional
        Materials. Default: the built-in database, changed and extended by the user's own file.
    solve : callable, optional
        Function that solves the cases, with the signature of `trackroller.solve`, which is the
        default.

    Returns
    -------
    xarray.Dataset
        Dimensions block, contact and body, and probability where a material gives scatter.
        Overrollings per shift, peak stress [MPa], damage per shift [1], life in shifts of each
        track and to the first failure of each body. A block that cannot be solved, in which a
        contact lifts off or the roller skids, or whose peak stress exceeds R_m, makes the lives
        that depend on it NaN; `regime` and `validity_body` state why. The life of the guide is NaN
        where its overrollings are not known. The results of `by_limit` say which limit comes first.

    Notes
    -----
    Damage adds up linearly, independent of the order of the blocks (Palmgren-Miner).
    """
    solve_cases: Callable[..., xr.Dataset]
    if solve is None:
        from trackroller.roller.solver import solve as solve_cases  # numba compiles on import
    else:
        solve_cases = solve
    if database is None:
        database = load_database()
    overrollings = overrollings_per_shift(spectrum)
    cases = cases_of(spectrum, overrollings)
    named = ("forces", "peak_stress", "life", first_limit.GROUP, *spectrum.groups)
    outputs = dict.fromkeys((*named, *groups_for_run_in(cases)))
    solved = solve_cases(cases, outputs=tuple(outputs), database=database, **spectrum.options)
    return _damage(spectrum, solved, database, overrollings)


def curves(
    spectrum: Spectrum, solved: xr.Dataset, bodies: list[Material], rule: str
) -> list[SNCurve]:
    """Return the S-N curves of roller and guide at their temperature in each block, values (block,
    1).
    """
    reached = temperatures_of(
        solved, [[block.case.ambient_temperature] for block in spectrum.blocks]
    )
    out = []
    for material, at in zip(bodies, reached.T, strict=True):
        warm = [material.at(temperature) for temperature in at]
        values = {
            name: np.array([[getattr(own, name)] for own in warm], dtype=float) for name in OF_CURVE
        }
        # the line by points moves with the knee, so that its shape does not depend on the
        # temperature
        out.append(SNCurve.of(values | {"sn_points": material.sn_points}, rule))
    return out


def damage_per_shift(
    stress: np.ndarray,
    cycles: np.ndarray,
    bodies: list[SNCurve],
    living: np.ndarray,
    probability: float = 0.5,
) -> tuple[np.ndarray, np.ndarray]:
    """Return cycles to failure and damage per shift of each block, (block, contact, body) [1] each.

    Parameters
    ----------
    stress, cycles : numpy.ndarray, shape (block, contact, body)
        Peak stress [MPa] and cycles per shift [1].
    bodies : list of SNCurve
        S-N curves of roller and guide.
    living : numpy.ndarray of bool
        Where a body has a fatigue life, (block, contact, body).
    probability : float
        Failure probability [1]. For values other than 0.5, a curve without scatter gives NaN.
    """
    life = np.full(stress.shape, np.nan)
    for i, curve in enumerate(bodies):
        if probability == 0.5 or curve.scatters.all():
            life[..., i] = curve.changed(failure_probability=probability).life_cycles(
                stress[..., i]
            )
    life[~living] = np.nan
    return life, miner.block_damage(cycles, life)


@dataclass(frozen=True)
class _Fatigue:
    """The stresses, cycles and S-N curves of roller and guide in the blocks of a spectrum.

    Attributes
    ----------
    peak, stress : numpy.ndarray, shape (block, contact, body)
        Peak stress, and the stress that counts for fatigue [MPa].
    cycles : numpy.ndarray, shape (block, 1, body)
        Overrollings per shift [1].
    curves : list of SNCurve
        S-N curves of roller and guide.
    breaks : numpy.ndarray of bool, shape (block, body)
        Where a body breaks at once.
    living : numpy.ndarray of bool, shape (block, contact, body)
        Where a body has a fatigue life.
    """

    peak: np.ndarray
    stress: np.ndarray
    cycles: np.ndarray
    curves: list[SNCurve]
    breaks: np.ndarray
    living: np.ndarray

    def damage(self, probability: float = 0.5) -> tuple[np.ndarray, np.ndarray]:
        """Return cycles to failure and damage per shift; see `damage_per_shift`."""
        return damage_per_shift(self.stress, self.cycles, self.curves, self.living, probability)

    def assuming_scatter(self, scatter: np.ndarray) -> _Fatigue:
        """Return the blocks with a scatter T_N [1] for the curves that state none."""
        return replace(self, curves=[curve.assuming(scatter) for curve in self.curves])


def _damage(
    spectrum: Spectrum, solved: xr.Dataset, database: MaterialDatabase, overrollings: np.ndarray
) -> xr.Dataset:
    """Return the damage of the solved blocks as a data set; see `solve_spectrum`."""
    rule = spectrum.options.get("life_rule", "elementary")
    fatigue_of_blocks = _fatigue_of_blocks(spectrum, solved, database, overrollings, rule)
    variables = _travel_of_blocks(spectrum, overrollings)
    variables |= _by_curve(spectrum, fatigue_of_blocks)
    variables |= _loads(spectrum, database)
    if "limit" in solved.coords:
        by_curve = _damage_over_range(spectrum, fatigue_of_blocks)
        variables |= by_limit(spectrum, solved, by_curve, fatigue_of_blocks.breaks)
        solved = _with_run_in(spectrum, solved, variables["life_to_first_limit_shifts"][1])
    if "fatigue_stress" in solved:
        meta = dict(solved["fatigue_stress"].attrs)
        variables["fatigue_stress"] = (_BCB, fatigue_of_blocks.stress, meta)
    if any(curve.scatters.any() for curve in fatigue_of_blocks.curves):
        variables["life_shifts_at_probability"] = _at_probabilities(spectrum, fatigue_of_blocks)
    labelled = _labelled(spectrum, variables, solved, rule)
    labelled = labelled.assign_attrs(_inputs(spectrum, database))
    return with_duty(labelled, spectrum.duty, spectrum.strokes)


def _fatigue_of_blocks(
    spectrum: Spectrum,
    solved: xr.Dataset,
    database: MaterialDatabase,
    overrollings: np.ndarray,
    rule: str,
) -> _Fatigue:
    """Return the stresses, cycles and S-N curves of roller and guide in the solved blocks."""
    peak = solved["peak_stress"].transpose("case", "contact", "body").values
    stress = peak
    if "fatigue_stress" in solved:
        stress = solved["fatigue_stress"].transpose("case", "contact", "body").values
    case = spectrum.blocks[0].case
    materials = [database.material(getattr(case, f"{body}_material")) for body in BODIES]
    of_bodies = curves(spectrum, solved, materials, rule)
    strength = np.concatenate([curve.tensile_strength for curve in of_bodies], axis=1)
    breaks = fatigue.overloaded(peak, strength)
    skids = skidding(solved["regime"].values)
    living = np.broadcast_to(~(breaks | skids)[:, None, :], stress.shape)
    return _Fatigue(peak, stress, overrollings[:, None, :], of_bodies, breaks, living)


def _travel_of_blocks(spectrum: Spectrum, overrollings: np.ndarray) -> dict[str, Any]:
    """Return distance, duration and overrollings of each block as variables."""
    distances = [block.distance for block in spectrum.blocks]
    hours = [block.hours for block in spectrum.blocks]
    passes = _attrs("1", "overrollings per shift", "n")
    return {
        "distance": ("block", distances, _attrs("m", "distance per shift", "s")),
        "duration": ("block", hours, _attrs("h", "hours of travel per shift", "t")),
        "overrollings": (("block", "body"), overrollings, passes),
    }


def _by_curve(spectrum: Spectrum, of_blocks: _Fatigue) -> dict[str, Any]:
    """Return stresses, damage and lives by the S-N curves at 50 % failures as variables."""
    life, damage = of_blocks.damage()
    total = damage.sum(axis=0)
    shifts = miner.repetitions_to_failure(total, spectrum.critical_damage)
    first = shifts.min(axis=0)  # A track whose life is not known makes the result NaN.
    peak_meta = _attrs("MPa", "peak equivalent stress of the block", "sigma_DEH,max")
    life_meta = _attrs("1", "overrollings to failure at the stress of the block", "N")
    return {
        "peak_stress": (_BCB, of_blocks.peak, peak_meta),
        "life_cycles": (_BCB, life, life_meta),
        "damage": (_BCB, damage, _attrs("1", "damage of the block per shift", "n/N")),
        "damage_sum": (_CB, total, _attrs("1", "damage per shift", "D")),
        "life_shifts": (_CB, shifts, _attrs("1", "shifts to failure of each track", "L_S")),
        **_lives_of_bodies(spectrum, first),
    }


def _damage_over_range(spectrum: Spectrum, of_blocks: _Fatigue) -> dict[str, np.ndarray]:
    """Return the damage per shift at the failure probability of the spectrum, (block, contact,
    body), by the ends of `first_limit.ENDS`: those of the scatter of curves that state none.
    """
    chance = spectrum.options.get("failure_probability", 0.5)
    given = spectrum.blocks[0].case.placeholder_position
    damage = {}
    for end, place in zip(first_limit.ENDS, (0.0, -1.0, 1.0), strict=True):
        if given is not None:
            place = given
        scattering = of_blocks.assuming_scatter(typical_scatter(place, chance))
        damage[end] = scattering.damage(chance)[1]
    return damage


def _with_run_in(spectrum: Spectrum, solved: xr.Dataset, shifts: np.ndarray) -> xr.Dataset:
    """Return the solved blocks with the flag `worn` for the lives of roller and guide in shifts,
    (body,), over all blocks.
    """
    travel = np.array([block.distance for block in spectrum.blocks]) / 1e3
    one_roller = np.zeros(len(travel), dtype=int)
    return with_run_in(solved, one_roller, travel, shifts[None])


def _lives_of_bodies(spectrum: Spectrum, shifts: np.ndarray) -> dict[str, Any]:
    """Return the lives of roller and guide in shifts, (2,), as variables in shifts, km and hours of
    travel.
    """
    distance = float(np.sum([block.distance for block in spectrum.blocks]))
    duration = float(np.sum([block.hours for block in spectrum.blocks]))
    variables = {}
    for body, index, life in zip(BODIES, ("TR", "G"), shifts, strict=True):
        to = f"to the first failure of the {body}"
        for unit, name, words, letter, scale in (
            ("1", "shifts", "shifts", "S", 1.0),
            ("km", "km", "distance", "k", distance / 1e3),
            ("h", "hours", "hours of travel", "h", duration),
        ):
            meta = _attrs(unit, f"{words} {to}", f"L_{letter},{index}")
            variables[f"{body}_life_{name}"] = ((), life * scale, meta)
    return variables


def _at_probabilities(spectrum: Spectrum, of_blocks: _Fatigue) -> xr.DataArray:
    """Return the shifts to failure at each failure probability, (probability, contact, body)."""
    levels = list(spectrum.failure_probabilities)
    damage = np.stack([of_blocks.damage(level)[1].sum(axis=0) for level in levels])
    meta = {"units": "1", "long_name": "failure probability"}
    return xr.DataArray(
        miner.repetitions_to_failure(damage, spectrum.critical_damage),
        {"probability": ("probability", levels, meta)},
        ("probability", *_CB),
        attrs=_attrs("1", "shifts to failure at a failure probability", "L_S,p"),
    )


def _inputs(spectrum: Spectrum, database: MaterialDatabase) -> dict[str, str]:
    """Return the attributes that hold the inputs: roller, materials, values that were not given,
    and doubts.
    """
    case = spectrum.blocks[0].case
    return {
        "roller": json.dumps(
            {name: v for name, v in plain_inputs(case).items() if name not in LOAD_FIELDS}
        ),
        "materials": json.dumps(material_values(case, database)),
        NOT_GIVEN: json.dumps(spectrum.not_given),
        DOUBTS: json.dumps(doubts_of_spectrum(spectrum, database)),
    }


def doubts_of_spectrum(spectrum: Spectrum, database: MaterialDatabase) -> list[str]:
    """Return a sentence for each unusual value of the blocks, see `trackroller.roller.doubts`."""
    cases = [block.case.as_dict() for block in spectrum.blocks]
    values = cases[0] | {name: [case[name] for case in cases] for name in LOAD_FIELDS}
    return doubts(values, (database.material(cases[0][f"{body}_material"]) for body in BODIES))


def _loads(spectrum: Spectrum, database: MaterialDatabase) -> dict[str, Any]:
    """Return the loads of each block, dimension `block`. Friction given by the pair of materials
    becomes a number.
    """
    table = to_table([block.case for block in spectrum.blocks], database)
    out = {}
    for name in LOAD_FIELDS:
        parameter = PARAMETERS[name]
        meta = _attrs(parameter.units, parameter.long_name, parameter.symbol)
        out[name] = ("block", np.asarray(getattr(table, name), dtype=float), meta)
    return out


def _attrs(units: str, long_name: str, symbol: str = "") -> dict[str, str]:
    return {"units": units, "long_name": long_name, "symbol": symbol}


def _labelled(
    spectrum: Spectrum, variables: dict[str, Any], solved: xr.Dataset, rule: str
) -> xr.Dataset:
    coords = {
        "block": (
            "block",
            [b.name for b in spectrum.blocks],
            {"long_name": "block of the spectrum"},
        ),
        "contact": solved["contact"],
        "body": solved["body"],
        **({"limit": solved["limit"]} if "limit" in solved.coords else {}),
    }
    for name in ("regime", "converged", "validity", "validity_body"):
        if name in solved:
            dims = ("block", "body")[: solved[name].ndim]
            variables[name] = (dims, solved[name].values, dict(solved[name].attrs))
    attrs = {key: value for key, value in solved.attrs.items() if key != "life_conventions"} | {
        "title": spectrum.name,
        "description": spectrum.description,
        "life_rule": rule,
        "life_conventions": f"{fatigue.AMPLITUDE}; {CONVENTIONS[rule]}; linear damage sum, "
        "failure at "
        f"D = {spectrum.critical_damage:g}",
        "critical_damage": spectrum.critical_damage,
        "period": spectrum.period,
        KEY: json.dumps({name: {"min": hours} for name, hours in spectrum.required.items()}),
    }
    ds = xr.Dataset(variables, coords=coords, attrs=attrs)
    if spectrum.by_share:  # a shift of these blocks is an hour of travel
        for variable in ds.data_vars.values():
            variable.attrs["long_name"] = variable.attrs.get("long_name", "").replace(
                "shift", "hour of travel"
            )
    return ds


def cases_of(spectrum: Spectrum, overrollings: np.ndarray) -> list[Case]:
    """Return the cases of the blocks, with the overrollings of the guide per hour of travel.

    Parameters
    ----------
    spectrum : Spectrum
        The load spectrum.
    overrollings : numpy.ndarray
        Overrollings per shift, (block, body) [1].
    """
    cases = []
    for block, passes in zip(spectrum.blocks, overrollings, strict=True):
        case = block.case
        if block.guide_overrollings and block.hours > 0:
            case = replace(case, **{OVERROLLINGS: float(passes[1]) / block.hours})
        cases.append(case)
    return cases


def _of_worse_track(damage: np.ndarray) -> np.ndarray:
    """Return the damage of the track with more of it, (block, body), from (block, contact, body)
    [1].
    """
    unknown = np.isnan(damage.sum(axis=0))  # such a track counts before a known one
    counted = unknown == unknown.any(axis=0)
    worst = np.argmax(np.where(counted, np.nansum(damage, axis=0), -1.0), axis=0)
    return np.asarray(np.take_along_axis(damage, worst[None, None], axis=1)[:, 0])


def by_limit(
    spectrum: Spectrum, solved: xr.Dataset, by_curve: dict[str, np.ndarray], breaks: np.ndarray
) -> dict[str, Any]:
    """Return damage, utilisation and shifts of each limit, and the first limit of each body.

    Parameters
    ----------
    spectrum : Spectrum
        The load spectrum.
    solved : xarray.Dataset
        Its solved blocks with the group `limits`.
    by_curve : dict of str to numpy.ndarray
        Damage of each track by the S-N curve per shift, (block, contact, body) [1], by the ends of
        `first_limit.ENDS`.
    breaks : numpy.ndarray of bool
        Where a body breaks at once, (block, body).

    Returns
    -------
    dict of str to tuple
        Variables of a data set. A block of no distance does not count. Fatigue adds up track by
        track; of the other limits the worse contact of each block counts.
    """
    limits = [LIMITS[name] for name in solved["limit"].values.tolist()]
    travel = np.array([block.hours for block in spectrum.blocks])[:, None, None]
    # D_crit belongs to Miner's rule of the S-N curve; other limits are reached at a sum of 1
    is_fatigue = np.array([limit.name == "fatigue" for limit in limits])
    critical = np.where(is_fatigue, spectrum.critical_damage, 1.0)[:, None]
    timed = solved["life_hours_by_limit"].notnull().any(["case", "body"]).values
    broken = first_limit.breaking(np.any(breaks & (travel[:, 0] > 0), axis=0), limits)
    out = _uses_of_limits(solved, travel)
    most = out["utilisation"][1]
    for end in first_limit.ENDS:
        lives = solved[f"life_hours_by_limit{end}"].transpose("case", "limit", "body").values
        damage = miner.block_damage(travel, lives)
        damage[:, is_fatigue] = _of_worse_track(by_curve[end])[:, None]
        total = damage.sum(axis=0)
        shifts = critical * miner.repetitions_to_failure(total)
        first, which = first_limit.first_of(
            shifts[None], most[None], timed, limits, broken[None], end=end
        )
        out |= _lives_by_limit(shifts, first[0], float(travel.sum()), end)
        if end == "":
            out |= _damage_by_limit(damage, total)
            out["limiting_mechanism"] = _limiting_mechanism(limits, which[0])
    return out


def _uses_of_limits(solved: xr.Dataset, travel: np.ndarray) -> dict[str, Any]:
    """Return the largest use and the worst state of each limit over the blocks with travel
    (block, 1, 1) [h], and its state in each block, as variables.
    """
    ordered = solved.transpose("case", "limit", "body", ...)
    used = np.where(travel > 0, ordered["utilisation"].values, 0.0)
    states = np.where(travel > 0, ordered["limit_state"].values, 0).astype(np.int8)
    meaning = _attrs("1", "largest utilisation of a limit in a block")
    meta = solved["limit_state"].attrs
    return {
        "utilisation": (("limit", "body"), np.max(used, axis=0), meaning),
        "limit_state": (("limit", "body"), states.max(axis=0), dict(meta)),
        "limit_state_of_block": (("block", "limit", "body"), states, dict(meta)),
    }


def _lives_by_limit(
    shifts: np.ndarray, first: np.ndarray, hours: float, end: str
) -> dict[str, Any]:
    """Return the life by each limit and to the first one, of each body and of the pair, at an end
    of its range, in shifts and in hours of travel as variables.

    Parameters
    ----------
    shifts : numpy.ndarray, shape (limit, body)
        Shifts to each limit [1].
    first : numpy.ndarray, shape (body,)
        Shifts to the first known limit [1].
    hours : float
        Hours of travel per shift [h].
    end : str
        One of `first_limit.ENDS`.
    """
    head = {"": "", "_low": "low end of the ", "_high": "high end of the "}[end]
    pair = float(first_failure(*first)[0])
    variables: dict[str, Any] = {}
    for name, dims, life, meaning in (
        ("life_{}_by_limit", ("limit", "body"), shifts, "until a limit with a life is reached"),
        ("life_to_first_limit_{}", "body", first, "until the first known limit is reached"),
        (
            "pair_life_to_first_limit_{}",
            (),
            pair,
            "until roller or guide reaches its first known limit",
        ),
    ):
        in_shifts = _attrs("1", f"{head}shifts {meaning}")
        in_hours = _attrs("h", f"{head}hours of travel {meaning}")
        variables[name.format("shifts") + end] = (dims, life, in_shifts)
        variables[name.format("hours") + end] = (dims, life * hours, in_hours)
    return variables


def _damage_by_limit(damage: np.ndarray, total: np.ndarray) -> dict[str, Any]:
    """Return the damage per shift by each limit, (block, limit, body), and its sum over the
    blocks, (limit, body), as variables.
    """
    of_block = _attrs("1", "damage of the block per shift by a limit")
    of_shift = _attrs("1", "damage per shift by a limit")
    return {
        "damage_by_limit": (("block", "limit", "body"), damage, of_block),
        "damage_sum_by_limit": (("limit", "body"), total, of_shift),
    }


def _limiting_mechanism(limits: list[Limit], which: np.ndarray) -> tuple[Any, ...]:
    """Return the limit that each body reaches first as a variable.

    `which` (body,) holds places in `limits`, -1 where no limit is known.
    """
    words = (*LIMITS, "unknown")
    flags: dict[str, Any] = {
        "long_name": "limit that the body reaches first",
        "flag_meanings": " ".join(words),
    }
    flags["flag_values"] = np.arange(len(words), dtype=np.int8)
    names = [*(limit.name for limit in limits), "unknown"]
    numbers = np.array([words.index(name) for name in names])[which]
    return ("body", numbers.astype(np.int8), flags)
