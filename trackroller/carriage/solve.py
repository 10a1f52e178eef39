"""Solve a carriage: the loads of each roller in each load case, its margins, and the worst roller
by its life.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from trackroller.carriage.file import (
    CHANCE,
    IN_LINE,
    OF_LOADS,
    Carriage,
    MountedRoller,
    load_carriage,
)
from trackroller.carriage.lives import Lives, hours_per_km
from trackroller.carriage.loads import Wrenches, swing_of, wrenches_of
from trackroller.carriage.statics import (
    MOTIONS,
    Moves,
    RollerForces,
    Springs,
    equilibrium,
    free_ways,
    is_determinate,
    motion_of,
    multipliers,
    to_one_contact,
    without,
)
from trackroller.carriage.strokes import passes_per_km
from trackroller.contact.hertz import contact_modulus, unit_approach
from trackroller.damage import LIMITS, first_limit
from trackroller.damage.miner import block_damage
from trackroller.errors import InputError
from trackroller.materials import load_database
from trackroller.numerics.numbers import number_or_nan
from trackroller.parameters import BODIES, MATERIAL_FIELDS
from trackroller.parameters.example import used_of
from trackroller.roller.case import Case, to_table
from trackroller.roller.dataset import NOTES, file_attributes, validity_bit
from trackroller.roller.doubts import doubts, ratings, sentence_of_unusual
from trackroller.roller.duty import OVERROLLINGS, overrollings_per_hour, with_duty, years
from trackroller.roller.geometry import contact_geometry
from trackroller.roller.requirement import LIVES_OF_PAIR
from trackroller.roller.run_in import groups_for_run_in
from trackroller.roller.settings import LOADS
from trackroller.roller.stored_inputs import (
    DOUBTS,
    MATERIALS,
    NOT_GIVEN,
    material_values,
    plain_inputs,
)

LIFE = "pair_life_to_first_limit_hours"
CONVENTIONS = (
    "radial_force < 0 presses the roller on its rail; axial_force acts on the roller along "
    "its own x_R",
    "a rigid carriage and small displacements; the drive holds the carriage along the track, "
    "where it acts",
    "forces of a roller act at its point `at`, the middle of the rail section, where the "
    "normals of its contacts meet",
    "horizontal acceleration (v/R)^2 times each mass's own radius; v and R belong to the origin",
    "preload is the force between the pair with no other load",
    "a lifted roller carries no load; a locating roller carries axial load both ways while "
    "it carries radial load",
    "contacts without friction give the stiffness: Hertz's approach at the load of each roller",
    "shares are shares of the travel; damage adds up linearly over the load cases, limit by "
    "limit (Palmgren-Miner)",
)
ROUNDING = 1e-14  # of the largest radial force: an axial force below it is 0
DISTANCES = (10.0, 1e5)  # ASSUME: mm; the largest distance of the rollers of a carriage
ENDS = {
    "one_contact": "to the first roller on one contact, without friction",
    "lift_off": "to the first lift-off",
    "tipping": "to tipping",
}
TIPPING = MOTIONS[2:4]  # motions that a user calls tipping
_RC = ("load_case", "roller")
_R = ("roller",)
_C = ("load_case",)
_CasesAt = dict[tuple[int, int], Case]  # by the numbers of load case and roller


def solve_carriage(
    source: Path | str | Mapping[str, Any] | Carriage,
    lives: bool = True,
    advanced: Callable[[int], object] = int,
) -> xr.Dataset:
    """Compute the loads of the rollers of a carriage, and their lives.

    Parameters
    ----------
    source : pathlib.Path, str, mapping or Carriage
        A carriage file, or a mapping with its keys; see "Carriage" in the how-to guides.
    lives : bool
        Whether each roller is solved under its loads, by `trackroller.solve`.
    advanced : callable
        Called with the number of load cases whose forces and margins are done since the last call.

    Returns
    -------
    xarray.Dataset
        Dimensions `load_case` and `roller`. `radial_force` and `axial_force` [N] have the signs of
        `Case`; a lifted roller has 0 N. `approach` [mm] is that of the roller to its rail.
        `payload_to_lift_off`, `payload_to_tipping`, `loads_to_lift_off` and `loads_to_tipping`
        (load_case) are multipliers [1]. `converged` (load_case) is False where no state fulfils all
        conditions of an equilibrium; its forces, margins and the lives of all rollers are NaN. A
        margin beyond the one to a single contact is one of rollers that carry axial load both ways,
        which a roller on one contact does not; tables and sentences leave it out. With `lives`,
        `life_km` and `life_hours` (roller) are those to the first limit, and the attribute
        `worst_roller` names the roller with the shortest one.

    Raises
    ------
    InputError
        If an entry is wrong, or if the rollers do not hold the carriage; the error names the load
        case.

    Notes
    -----
    The margins take a tenth of a second a load case, up to two where many rollers lift. The lives
    take as long as `trackroller.solve` for each roller and load case.

    Examples
    --------
    >>> import trackroller as tr
    >>> down = {"pushes": [0, 0, -1], "x_R": [0, 1, 0]}
    >>> places = {"FL": [100, 50, 0], "FR": [100, -50, 0]}
    >>> places |= {"RL": [-100, 50, 0], "RR": [-100, -50, 0]}
    >>> cart = {"mass": {"value": "40 kg", "at": [0, 0, 0]}, "cases": [{"name": "stand"}]}
    >>> rollers = {name: {"at": at, "stiffness": 1e4} | down for name, at in places.items()}
    >>> ds = tr.carriage(cart | {"rollers": rollers})
    >>> ds.radial_force.values.round(2)
    array([[-98.07, -98.07, -98.07, -98.07]])
    """
    if isinstance(source, Carriage):
        whole = source
    else:
        whole = load_carriage(source)
    springs = springs_of(whole)
    wrenches, swings = _wrenches(whole, springs)
    ds = _solution(whole, springs, wrenches, swings).assign(
        _margins(whole, springs, wrenches, advanced)
    )
    ds.attrs[DOUBTS] = json.dumps(doubts_of_rollers(whole, ds))
    without_case = [roller.name for roller in whole.rollers if roller.case is None]
    if not lives:
        return ds
    if without_case:
        return ds.assign_attrs(without_case=", ".join(without_case))
    return with_lives(ds, whole)


def forces_of(whole: Carriage) -> xr.Dataset:
    """Return the forces of the rollers in each load case, without margins and lives; see
    `solve_carriage`.
    """
    springs = springs_of(whole)
    return _solution(whole, springs, *_wrenches(whole, springs))


def _wrenches(whole: Carriage, springs: Springs) -> tuple[list[Wrenches], np.ndarray]:
    """Return the wrenches of each load case, and the angles [rad] to which they swing a carriage on
    a line of rollers.
    """
    if springs.hinge is None:
        return [wrenches_of(whole, case) for case in whole.cases], np.full(len(whole.cases), np.nan)
    swings = []
    for case in whole.cases:
        swing = swing_of(whole, case, springs.hinge)
        if swing is None:
            wrong = (
                f"leave the carriage free: it {MOTIONS[2]} without any resistance, and falls in "
                f"case '{case.name}', "
                "because its loads do not hang below the line of its rollers"
            )
            raise _free(whole, wrong)
        swings.append(swing)
    pairs = zip(whole.cases, swings, strict=True)
    return [wrenches_of(whole, case, swing) for case, swing in pairs], np.array(swings)


def _solution(
    whole: Carriage, springs: Springs, wrenches: list[Wrenches], swings: np.ndarray
) -> xr.Dataset:
    """Return the forces of the rollers as a data set with places, load cases and conventions."""
    states = [
        _equilibrium(whole, springs, one, case.name)
        for one, case in zip(wrenches, whole.cases, strict=True)
    ]
    variables = _forces(whole, states, wrenches)
    variables |= _of_catalogue(whole, variables) | _places(whole)
    if springs.hinge is not None:
        long_name = (
            "angle to which the carriage swings about its line of rollers, in whose axes "
            "the forces stand"
        )
        variables["swing"] = (_C, np.degrees(swings), _attrs("degree", long_name))
    coords = {
        "load_case": ("load_case", [case.name for case in whole.cases], {"long_name": "load case"}),
        "roller": (
            "roller",
            [roller.name for roller in whole.rollers],
            {"long_name": "roller of the carriage"},
        ),
    }
    attrs = {
        **file_attributes("Loads of the rollers of a carriage", "solved"),
        "title": whole.name,
        "description": whole.description,
        "conventions": "; ".join(CONVENTIONS),
        "with_play": ", ".join(name for one in whole.preloads if one.play > 0 for name in one.pair),
    }
    return with_duty(xr.Dataset(variables, coords, attrs), whole.duty, whole.strokes)


def springs_of(whole: Carriage, unknown: Sequence[float] = ()) -> Springs:
    """Return the springs of the rollers of a carriage.

    Parameters
    ----------
    whole : Carriage
        The carriage.
    unknown : sequence of float
        Compliances [mm/N] of the rollers whose stiffness is not given, 1 without it.

    Raises
    ------
    InputError
        If the rollers leave the carriage free to move.
    """
    rollers = whole.rollers
    length = max(float(np.abs([roller.at for roller in rollers]).max()), 1.0)

    def rows(way: str) -> np.ndarray:
        turning = [np.cross(roller.at, getattr(roller, way)) / length for roller in rollers]
        return np.hstack([[getattr(roller, way) for roller in rollers], turning])[:, 1:]

    compliances = [_compliance(roller) for roller in rollers]
    for j, compliance in zip(_unknown(whole), unknown, strict=False):
        compliances[j] = (0.0, 1.0, (compliance, compliance))
    contact, tangent, series = (np.array(column) for column in zip(*compliances, strict=True))
    springs = Springs(
        radial=rows("pushes"),
        axial=rows("axis"),
        locating=np.array([roller.locating for roller in rollers]),
        contact=contact,
        tangent=tangent,
        radial_compliance=series[:, 0],
        axial_compliance=series[:, 1],
        offset=np.zeros(len(rollers)),
        length=length,
    )
    ways = free_ways(springs)
    if len(ways) == 0:
        return _preloaded(springs, whole)
    hinge = None
    if len(ways) == 1:
        hinge = _hinge(whole, ways[0], length)
    if hinge is None:
        raise _free(
            whole, f"leave the carriage free: it {motion_of(ways[-1])} without any resistance"
        )
    return _preloaded(without(springs, ways[0], hinge), whole)


def _free(whole: Carriage, wrong: str) -> InputError:
    """Return the error for rollers that do not hold the carriage."""
    names = ", ".join(roller.name for roller in whole.rollers)
    remedy = (
        "Add a roller, put the rollers further apart, or make one with kind: floating a "
        "locating one."
    )
    allowed = "rollers that hold the carriage in all directions across the track"
    return InputError("rollers", names, allowed, remedy, wrong)


def _hinge(whole: Carriage, way: np.ndarray, length: float) -> np.ndarray | None:
    """Return the place (2,) along y and z of the line of all rollers about which a motion (5,)
    turns, None without.
    """
    angle = way[2] / length
    if np.abs(way[3:]).max() > 1e-6 * abs(way[2]) or angle == 0:
        return None
    line = np.array([-way[1], way[0]]) / angle  # where the motion is 0
    off = max(float(np.abs(roller.at[1:] - line).max()) for roller in whole.rollers)
    return line if off <= IN_LINE * length else None


def _preloaded(springs: Springs, whole: Carriage) -> Springs:
    """Return springs with the approach that preload or play gives each roller."""
    places = {roller.name: i for i, roller in enumerate(whole.rollers)}
    force, play = np.zeros((2, len(places)))
    for preload in whole.preloads:
        for name in preload.pair:
            force[places[name]] = preload.force
            play[places[name]] = preload.play / 2
    return replace(springs, offset=springs.approach(force) - play)


def _compliance(roller: MountedRoller) -> tuple[float, float, tuple[float, float]]:
    """Return Hertz's factor of the radial approach [mm N^(-2/3)], tan(alpha), and the compliances
    in series [mm/N].
    """
    if roller.stiffness is not None:
        series = [
            own + 1 / one for own, one in zip(roller.compliance, roller.stiffness, strict=True)
        ]
        return 0.0, 1.0, (series[0], series[1])
    if roller.case is None:
        # the forces of a determinate arrangement depend on no stiffness
        return 0.0, 1.0, (1.0, 1.0)
    table = to_table([roller.case])
    geometry = contact_geometry(vars(table))
    bodies = ((body.youngs_modulus, body.poisson_ratio) for body in (table.roller, table.guide))
    modulus = contact_modulus(*(value for body in bodies for value in body))
    approach = float(
        unit_approach(geometry.curvature_lateral, geometry.curvature_rolling, modulus)[0]
    )
    cosine = float(np.cos(geometry.contact_angle[0]))
    # F_rad = 2 F_N cos(alpha), and each contact approaches by the radial approach times cos(alpha)
    return (
        approach / (2 * cosine) ** (2 / 3) / cosine,
        float(np.tan(geometry.contact_angle[0])),
        roller.compliance,
    )


def _reduced(wrench: np.ndarray, springs: Springs) -> np.ndarray:
    """Return the components of a wrench that the rollers carry; moments over `springs.length`."""
    return springs.basis.T @ np.concatenate([wrench[1:3], wrench[3:] / springs.length])


def _equilibrium(whole: Carriage, springs: Springs, wrenches: Wrenches, name: str) -> RollerForces:
    """Return the forces of the rollers in a load case; an error names the case."""
    try:
        state = equilibrium(springs, _reduced(wrenches.all, springs))
    except Moves as error:
        allowed = "loads that rollers which only press can carry"
        tips = "does not hold"
        if error.motion in TIPPING:
            tips = "tips"
        remedy = (
            "Move the masses between the rollers, put the rollers further apart, or give pairs a "
            "preload: a roller "
            "carries axial load only while it presses on its rail."
        )
        raise InputError(
            "case", name, allowed, remedy, f"{tips} the carriage: it {error.motion}"
        ) from None
    unknown = _unknown(whole)
    if unknown and not (is_determinate(springs, state) and _decided(whole, wrenches, state)):
        needs = (
            f"the stiffness, because the statics alone does not decide the forces in case '{name}'"
        )
        where = f"rollers.{whole.rollers[unknown[0]].name}.roller"
        raise InputError(where, None, needs, "Add roller: FILE, or stiffness: 5e4.")
    return state


def _unknown(whole: Carriage) -> list[int]:
    """Return the numbers of the rollers whose stiffness is not given."""
    return [
        j
        for j, roller in enumerate(whole.rollers)
        if roller.case is None and roller.stiffness is None
    ]


def _decided(whole: Carriage, wrenches: Wrenches, state: RollerForces) -> bool:
    """Return whether other values of the unknown stiffnesses give the same forces, and lift the
    same rollers.
    """
    steps = 10.0 ** -np.arange(float(len(_unknown(whole))))
    for compliance in (1e-5 * steps, 1e-5 * steps[::-1]):
        springs = springs_of(whole, compliance.tolist())
        try:
            other = equilibrium(springs, _reduced(wrenches.all, springs))
        except Moves:
            return False
        near = 1e-6 * float(state.radial.max(initial=0.0))
        if not (
            np.allclose(other.radial, state.radial, 0, near)
            and np.allclose(other.axial, state.axial, 0, near)
        ):
            return False
    return True


def _attrs(units: str, long_name: str, symbol: str = "") -> dict[str, str]:
    return {"units": units, "long_name": long_name, "symbol": symbol}


def _forces(
    whole: Carriage, states: list[RollerForces], wrenches: list[Wrenches]
) -> dict[str, Any]:
    """Return the forces of rollers and drive, and what the file says of the load cases, as
    variables.
    """
    settled = np.array([state.converged for state in states])[:, None]
    radial = np.where(settled, -np.array([state.radial for state in states]), np.nan)
    axial = np.where(settled, np.array([state.axial for state in states]), np.nan)
    axial = np.where(
        np.abs(axial) <= ROUNDING * np.abs(radial).max(axis=1, keepdims=True), 0.0, axial
    )
    speeds = np.array([case.speed for case in whole.cases], dtype=float)  # None becomes NaN
    return {
        "radial_force": (
            _RC,
            np.where(radial == 0, 0.0, radial),
            _attrs("N", "radial force", "F_rad"),
        ),
        "axial_force": (_RC, axial, _attrs("N", "axial force", "F_ax")),
        "approach": (
            _RC,
            np.where(settled, np.array([state.approach for state in states]), np.nan),
            _attrs("mm", "approach of the roller to its rail"),
        ),
        "drive_force": (
            _C,
            np.array([own.drive for own in wrenches]),
            _attrs("N", "force of the drive along the track"),
        ),
        "converged": (
            _C,
            np.array([state.converged for state in states]),
            {"long_name": "whether the forces are an equilibrium of the rollers"},
        ),
        "share": (
            _C,
            np.array([case.share for case in whole.cases]),
            _attrs("1", "share of the travel"),
        ),
        "speed": (_C, speeds, _attrs("m s-1", "speed")),
    }


def _places(whole: Carriage) -> dict[str, Any]:
    """Return places and directions of rollers and masses, which the picture shows, as variables."""
    masses = [whole.mass, *whole.payloads]
    names = ["carriage", *(f"payload {i + 1}" for i in range(len(whole.payloads)))]
    rd, md = ("roller", "direction"), ("mass_name", "direction")
    at, pushes, axis = (
        np.array([getattr(r, key) for r in whole.rollers]) for key in ("at", "pushes", "axis")
    )
    return {
        "roller_at": (rd, at, _attrs("mm", "place of the roller")),
        "roller_pushes": (
            rd,
            pushes,
            _attrs("1", "direction in which the roller presses on its rail"),
        ),
        "roller_axis": (rd, axis, _attrs("1", "axis x_R of the roller")),
        "locating": (
            "roller",
            np.array([r.locating for r in whole.rollers]),
            {"long_name": "carries axial load"},
        ),
        "mass": (("mass_name",), np.array([one.value for one in masses]), _attrs("kg", "mass")),
        "mass_at": (md, np.array([one.at for one in masses]), _attrs("mm", "place of the mass")),
        "direction": (
            ("direction",),
            np.array(["x", "y", "z"]),
            {"long_name": "x forward, y left, z up"},
        ),
        "mass_name": (("mass_name",), np.array(names), {"long_name": "name of the mass"}),
    }


def _margins(
    whole: Carriage, springs: Springs, wrenches: list[Wrenches], advanced: Callable[[int], object]
) -> dict[str, Any]:
    """Return the multipliers of payload and of all loads to one contact, to lift-off and to
    tipping.
    """
    angles = np.full(len(whole.rollers), np.nan)
    for j, roller in enumerate(whole.rollers):
        if roller.case is not None:
            angles[j] = roller.case.contact_angle
    tangent = np.tan(np.radians(angles))
    out: dict[str, list[float]] = {}
    for one in wrenches:
        payload, other = (_reduced(part, springs) for part in (one.payload, one.other))
        for name, fixed, varying in (
            ("payload", other, payload),
            ("loads", 0.0 * other, payload + other),
        ):
            if name == "payload" and _swings_further(springs, one):
                for end in ENDS:
                    out.setdefault(f"{name}_to_{end}", []).append(np.nan)
                continue
            lift_off, tipping = multipliers(springs, fixed, varying)
            one_contact = to_one_contact(springs, fixed, varying, tangent, lift_off)
            for end, value in zip(ENDS, (one_contact, lift_off, tipping), strict=True):
                out.setdefault(f"{name}_to_{end}", []).append(value)
        advanced(1)
    words = {"payload": "multiplier of the payload", "loads": "multiplier of all loads"}
    names = {f"{name}_to_{end}": f"{words[name]} {ENDS[end]}" for name in words for end in ENDS}
    return {name: (_C, np.array(out[name]), _attrs("1", long)) for name, long in names.items()}


def _swings_further(springs: Springs, wrenches: Wrenches) -> bool:
    """Return whether another payload swings a carriage on a line of rollers, so that no margin of
    it is known.
    """
    if springs.hinge is None:
        return False
    force = wrenches.payload[1:3]
    moment = wrenches.payload[3]
    about = moment - float(springs.hinge[0] * force[1] - springs.hinge[1] * force[0])
    return abs(about) > 1e-9 * springs.length * float(np.linalg.norm(force))


def _of_catalogue(whole: Carriage, variables: Mapping[str, Any]) -> dict[str, Any]:
    """Return load factor and life by the catalogues of the rollers, {} without a catalogue."""
    if not any(roller.catalogue for roller in whole.rollers):
        return {}
    radial, axial, shares = (
        variables[name][1] for name in ("radial_force", "axial_force", "share")
    )
    factor = np.full(radial.shape, np.nan)
    life = np.full(radial.shape[1], np.nan)
    for i, roller in enumerate(whole.rollers):
        if roller.catalogue is not None:
            factor[:, i] = roller.catalogue.load_factor(radial[:, i], axial[:, i])
            life[i] = 1 / np.sum(shares / roller.catalogue.life(factor[:, i]))
    return {
        "load_factor": (_RC, factor, _attrs("1", "load factor of the maker's catalogue", "LF")),
        "catalogue_life_km": (_R, life, _attrs("km", "life by the maker's catalogue")),
    }


def cases_of(whole: Carriage, ds: xr.Dataset) -> _CasesAt:
    """Return the `Case` of each roller that carries load, by the numbers of load case and
    roller.
    """
    cases = {}
    passes = passes_per_km(whole)
    for i, j in np.argwhere(ds["radial_force"].values < 0).tolist():
        speed = whole.cases[i].speed
        case = whole.rollers[j].case
        if case is not None:
            loads = {name: float(ds[name][i, j]) for name in ("radial_force", "axial_force")}
            if speed is not None:
                loads["velocity"] = 60 * speed
            if np.isfinite(passes[j]):
                loads[OVERROLLINGS] = float(overrollings_per_hour(passes[j], loads["velocity"]))
            cases[i, j] = replace(case, **loads)
    return cases


def doubts_of_rollers(whole: Carriage, ds: xr.Dataset) -> list[str]:
    """Return a sentence for each unusual value of the rollers and their loads, see
    `trackroller.roller.doubts`.
    """
    database = load_database()
    by_text: dict[str, list[str]] = {}
    cases = cases_of(whole, ds)
    for j, roller in enumerate(whole.rollers):
        if roller.case is None:
            continue
        loaded = [case for (_, own), case in cases.items() if own == j]
        values = {name: value for name, value in roller.case.as_dict().items() if name not in LOADS}
        values |= {name: [getattr(case, name) for case in loaded] for name in OF_LOADS if loaded}
        for text in _unused_loads(roller):
            by_text.setdefault(text, []).append(roller.name)
        known = doubts(values, (database.material(values[f"{body}_material"]) for body in BODIES))
        for text in [*known, *_doubted_ratings(roller, ds["radial_force"].values[:, j])]:
            by_text.setdefault(text, []).append(roller.name)
    if len(whole.rollers) == 1:
        return list(by_text)
    distances = _unusual_distances(whole)
    return distances + [f"Roller {', '.join(names)}: {text}" for text, names in by_text.items()]


def _unusual_distances(whole: Carriage) -> list[str]:
    """Return a sentence if the rollers stand far closer or wider than those of carriages."""
    places = np.array([roller.at for roller in whole.rollers])
    widest = float(np.ptp(places, axis=0).max())
    text = sentence_of_unusual("largest distance of the rollers", widest, "mm", DISTANCES, "")
    if text and widest > 0:
        return [text]
    return []


def _doubted_ratings(roller: MountedRoller, radial: np.ndarray) -> Iterator[str]:
    """Yield a sentence for each rating of a maker's catalogue that is small beside the radial
    forces (n,) [N], or unusual.
    """
    if roller.catalogue is None:
        return
    names = ("radial_force", "axial_force", "basic_life")
    rated = {name: getattr(roller.catalogue, name) for name in names}
    yield from ratings({"radial_force": radial, "catalogue": rated})
    if np.isfinite(roller.catalogue.moment):
        yield (
            f"catalogue.moment = {roller.catalogue.moment:g} N mm does not count: the statics of "
            "a carriage gives no "
            "moment of a roller. Put the catalogue into the file of the roller, where it does."
        )


def _unused_loads(roller: MountedRoller) -> Iterator[str]:
    """Yield a sentence for each force in the file of a roller, and for each requirement, that does
    not count.
    """
    for name in LOADS:
        if name in roller.given:
            yield (
                f"{name} = {roller.given[name]} in its file does not count: the carriage gives it. "
                "Remove it there."
            )
    for name, own in roller.required.items():
        if name not in LIVES_OF_PAIR or math.isfinite(own.most):
            yield (
                f"requirement.{name} in its file is not judged: of a carriage only a smallest life "
                f"of the pair is. Write {LIVES_OF_PAIR[0]}."
            )


def _flags(solved: xr.Dataset) -> np.ndarray:
    """Return the validity flags of rollers, shape (n,).

    `deep_life` is that of the body alone that ends the life, and `worn` that of the roller alone.
    """
    worn = validity_bit("worn")
    deep = validity_bit("deep_life")
    lives = solved["life_to_first_limit_hours"].transpose(..., "body").values
    own = solved["validity_body"].transpose(..., "body").values
    ends = np.where(
        lives[..., BODIES.index("guide")] < lives[..., BODIES.index("roller")],
        own[..., 1],
        own[..., 0],
    )
    of_roller = own[..., BODIES.index("roller")]
    return np.asarray(
        (solved["validity"].values & ~deep & ~worn) | (ends & deep) | (of_roller & worn)
    )


def _first_ends(lives: Lives, solved: xr.Dataset) -> np.ndarray:
    """Return which body of each roller ends first, and by which limit, (roller, 2), as texts."""
    hours = np.nan_to_num(lives.summed["life_to_first_limit_hours"], nan=np.inf)
    body = np.argmin(hours, axis=1)
    attrs = solved["limiting_mechanism"].attrs
    words = dict(
        zip(np.ravel(attrs["flag_values"]).tolist(), attrs["flag_meanings"].split(), strict=True)
    )
    numbers = lives.summed["limiting_mechanism"][np.arange(len(body)), body]
    return np.array(
        [[BODIES[k], words[number]] for k, number in zip(body, numbers.tolist(), strict=True)],
        dtype=object,
    )


def with_lives(
    ds: xr.Dataset, whole: Carriage, solve: Callable[..., xr.Dataset] | None = None
) -> xr.Dataset:
    """Return a solved carriage with the life of each roller, its regime, and the worst roller.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `forces_of`.
    whole : Carriage
        The carriage.
    solve : callable, optional
        Function with the signature of `trackroller.solve`, which is the default.
    """
    solve_cases: Callable[..., xr.Dataset]
    if solve is None:
        from trackroller.roller.solver import solve as solve_cases  # numba compiles on import
    else:
        solve_cases = solve
    lives = _LivesOfRollers(ds, whole)
    checks = _Checks(len(whole.rollers))
    for group in _groups_by_options(whole, cases_of(whole, ds)):
        solved = _solve_group(whole, group, solve_cases)
        summed = lives.summed(group, solved)
        lives.add(group, summed, solved)
        checks.add(summed, solved)
    lives.drop_unknown()
    materials = _materials_of_rollers(whole)
    variables = lives.variables() | checks.variables()
    variables |= _inputs_of_rollers(whole, materials, lives.pace)
    attrs = checks.attributes() | {NOT_GIVEN: json.dumps(_not_given(whole))}
    attrs |= {MATERIALS: json.dumps(_each_once(materials), default=str)}
    attrs |= {"worst_roller": lives.worst_roller()}
    return ds.assign(variables).assign_attrs(attrs, **_chance(whole))


def _groups_by_options(whole: Carriage, cases: _CasesAt) -> list[_CasesAt]:
    """Return the cases of rollers with the same options together."""
    groups: dict[str, _CasesAt] = {}
    for place, case in cases.items():
        options = whole.rollers[place[1]].options
        groups.setdefault(repr(options), {})[place] = case
    return list(groups.values())


def _solve_group(whole: Carriage, group: _CasesAt, solve: Callable[..., xr.Dataset]) -> xr.Dataset:
    """Solve the cases of rollers with the same options."""
    cases = list(group.values())
    _, roller = next(iter(group))
    options = dict(whole.rollers[roller].options)
    options.pop("outputs", None)
    outputs = ("forces", "peak_stress", "life", "limits", *groups_for_run_in(cases))
    return solve(cases, outputs=outputs, **options)


def _materials_of_rollers(whole: Carriage) -> list[dict[str, Any]]:
    """Return the values of the materials of each roller and its rail."""
    database = load_database()
    cases = [roller.case for roller in whole.rollers]
    return [material_values(case, database) for case in cases if case is not None]


class _LivesOfRollers:
    """The lives of the rollers of a carriage, under each load case alone and under all of them.

    A roller that is never loaded has no end of its life.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `forces_of`.
    whole : Carriage
        The carriage, each roller of which has a file.

    Attributes
    ----------
    pace : numpy.ndarray, shape (roller,)
        Hours that the carriage travels for a km with all its load cases [h/km].
    """

    def __init__(self, ds: xr.Dataset, whole: Carriage) -> None:
        shape = ds["radial_force"].shape
        number = len(whole.rollers)
        self.duty = whole.duty
        self.names = ds["roller"].values
        self.share = ds["share"].values
        self.converged = ds["converged"].values
        self.pace = _pace_of(ds, whole)
        self.case_hours = np.full(shape, np.inf)
        self.case_hours[~self.converged] = np.nan
        self.damage = np.zeros(shape)
        self.damage[~self.converged] = np.nan
        self.regime = np.full(shape, -1, dtype=np.int8)
        self.validity = np.zeros(shape, dtype=np.int64)
        self.hours = {end: np.full(number, np.inf) for end in first_limit.ENDS}
        self.at_most = np.full(number, np.inf)
        self.first_ends = np.full((number, 2), "", dtype=object)  # body and limit
        self.regime_attrs: Mapping[str, Any] = {}

    def summed(self, group: _CasesAt, solved: xr.Dataset) -> Lives:
        """Return the lives of rollers that were solved together, over their load cases."""
        load_case, roller = np.array(list(group)).T
        speed = np.array([0.06 * float(case.velocity) for case in group.values()])  # km/h
        return Lives(roller, self.share[load_case], speed, self.pace[roller], solved)

    def add(self, group: _CasesAt, lives: Lives, solved: xr.Dataset) -> None:
        """Take the lives of rollers that were solved together."""
        load_case, roller = np.array(list(group)).T
        self.case_hours[load_case, roller] = solved[LIFE].values
        self.damage[load_case, roller] = block_damage(lives.time, solved[LIFE].values)
        self.regime[load_case, roller] = solved["regime"].values
        self.regime_attrs = solved["regime"].attrs
        self.validity[load_case, roller] = _flags(lives.solved)
        for end, hours in self.hours.items():
            hours[lives.groups] = lives.summed[f"{LIFE}{end}"]
        self.at_most[lives.groups] = lives.at_most()
        self.first_ends[lives.groups] = _first_ends(lives, solved)

    def drop_unknown(self) -> None:
        """Drop the lives of a carriage with a load case without an equilibrium, the bounds of lives
        that are known, and the body and the limit of rollers whose life has no end.
        """
        if not self.converged[self.share > 0].all():
            for hours in self.hours.values():
                hours[:] = np.nan
            self.at_most[:] = np.inf
        self.at_most[~np.isnan(self.hours[""])] = np.nan
        self.first_ends[~np.isfinite(self.hours[""])] = ""

    def travel(self) -> np.ndarray:
        """Return the travel of the carriage to the first limit of each roller, (roller,) [km]."""
        return np.asarray(self.hours[""] / self.pace)

    def worst_roller(self) -> str:
        """Return the name of the roller with the shortest travel, by the bound where no life is
        known; "" if no travel has an end.
        """
        travel = self.travel()
        known = np.where(np.isnan(travel), self.at_most / self.pace, travel)
        if not np.isfinite(known).any():
            return ""
        return str(self.names[int(np.argmin(known))])

    def variables(self) -> dict[str, Any]:
        """Return the lives as variables."""
        return self._of_load_cases() | self._of_rollers() | self._of_duty()

    def _of_load_cases(self) -> dict[str, Any]:
        """Return life, damage, regime and validity of each roller under each load case alone."""
        return {
            "case_life_hours": (
                _RC,
                self.case_hours,
                _attrs("h", "life to the first limit under a load case alone"),
            ),
            "damage_per_km": (
                _RC,
                self.damage,
                _attrs("km-1", "damage of a load case by a km of travel with all load cases"),
            ),
            "roller_regime": (_RC, self.regime, _with_lifted(self.regime_attrs)),
            "roller_validity": (
                _RC,
                self.validity,
                {"long_name": "validity flags of the roller, as of `trackroller.solve`"},
            ),
        }

    def _of_rollers(self) -> dict[str, Any]:
        """Return the life of each roller under all load cases, with its range and what ends it."""
        first = "to the first limit of the roller or its rail"
        hours = f"hours of travel {first}"
        bound = "bound of a life that is not known, by the load cases whose damage is known"
        body = {"long_name": "roller or rail, whichever reaches its limit first"}
        limit = {"long_name": "limit that is reached first"}
        return {
            "life_km": (_R, self.travel(), _attrs("km", f"travel of the carriage {first}")),
            "life_hours": (_R, self.hours[""], _attrs("h", hours)),
            "life_hours_at_most": (_R, self.at_most, _attrs("h", bound)),
            "first_body": (_R, self.first_ends[:, 0].astype(str), body),
            "first_limit": (_R, self.first_ends[:, 1].astype(str), limit),
            "life_hours_low": (_R, self.hours["_low"], _attrs("h", f"low end of the {hours}")),
            "life_hours_high": (_R, self.hours["_high"], _attrs("h", f"high end of the {hours}")),
        }

    def _of_duty(self) -> dict[str, Any]:
        """Return the life of each roller in years, {} without a duty."""
        if self.duty is None:
            return {}
        meaning = _attrs("year", "years of the duty to the first limit")
        return {"life_years": (_R, years(self.hours[""], self.duty), meaning)}


def _pace_of(ds: xr.Dataset, whole: Carriage) -> np.ndarray:
    """Return the hours that the carriage travels for a km with all its load cases, by the rollers
    whose files state a velocity, (roller,) [h/km].
    """
    cases = [roller.case for roller in whole.rollers]
    velocity = np.array([case.velocity for case in cases if case is not None], dtype=float)
    speed = np.tile(ds["speed"].values, (len(whole.rollers), 1))
    return hours_per_km(ds["share"].values, speed, velocity)


def _with_lifted(attrs: Mapping[str, Any]) -> dict[str, Any]:
    """Return the attributes of the regime of a roller with the flag -1 of one that is lifted."""
    values = np.asarray(attrs.get("flag_values", []), dtype=np.int8)
    meanings = f"lifted {attrs.get('flag_meanings', '')}".strip()
    return {
        **attrs,
        "flag_values": np.append(np.int8(-1), values),
        "flag_meanings": meanings,
    }


def _chance(whole: Carriage) -> dict[str, float]:
    """Return the failure probability of the lives by its name; {} where the rollers differ in
    it.
    """
    chances = {number_or_nan(roller.options.get(CHANCE, 0.5), "-") for roller in whole.rollers}
    if len(chances) > 1:
        return {}
    return {CHANCE: chances.pop()}


class _Checks:
    """The limits of the rollers of a carriage over their load cases.

    Parameters
    ----------
    number : int
        Rollers of the carriage; the limits of a roller that is never loaded are not known.
    """

    def __init__(self, number: int) -> None:
        shape = (number, len(LIMITS), len(BODIES))
        self.names = list(LIMITS)
        self.used = np.full(shape, np.nan)
        self.hours = {end: np.full(shape, np.nan) for end in first_limit.ENDS}
        self.state = np.zeros(shape, dtype=np.int8)
        self.requested: list[str] = []
        self.notes: list[str] = []

    def add(self, lives: Lives, solved: xr.Dataset) -> None:
        """Take the limits of rollers that were solved together; one that is unknown in a load case
        is not known.
        """
        limits = solved["limit"].values.tolist()
        into = np.ix_(lives.groups, np.array([self.names.index(name) for name in limits]))
        self.state[into] = self._states(lives, solved)
        self.used[into] = lives.summed["utilisation"]
        for end, hours in self.hours.items():
            hours[into] = lives.summed[f"life_hours_by_limit{end}"]
        self.requested += [name for name in limits if name not in self.requested]
        notes = str(solved.attrs.get(NOTES, "")).split("\n")
        self.notes += [line for line in notes if line and line not in self.notes]

    @staticmethod
    def _states(lives: Lives, solved: xr.Dataset) -> np.ndarray:
        """Return the state of each limit over all load cases, (roller, limit, body): unknown if it
        is unknown in a load case that counts, unless another one exceeds it.
        """
        unknown = first_limit.STATES.index("unknown")
        exceeded = first_limit.STATES.index("exceeded")
        state = lives.summed["limit_state"].copy()
        counts = (lives.share != 0)[:, None, None]
        is_unknown = lives.of(counts & (solved["limit_state"].values == unknown), np.logical_or)
        state[is_unknown & (state != exceeded)] = unknown
        return state

    def variables(self) -> dict[str, Any]:
        """Return utilisation, hours and state of each limit as variables, with their labels."""
        dims = ("roller", "limit", "body")
        flags = {
            "flag_values": np.arange(len(first_limit.STATES), dtype=np.int8),
            "flag_meanings": " ".join(first_limit.STATES),
            "long_name": "whether the limit is kept over the load cases",
        }
        meaning = "hours of travel to the limit, with the damage of all load cases"
        heads = {"": "", "_low": "low end of the ", "_high": "high end of the "}
        hours = {
            f"life_hours_by_limit{end}": (dims, values, _attrs("h", heads[end] + meaning))
            for end, values in self.hours.items()
        }
        return {
            "limit": ("limit", self.names, {"long_name": "limit"}),
            "body": ("body", list(BODIES), {"long_name": "body"}),
            "utilisation": (
                dims,
                self.used,
                _attrs("1", "largest utilisation over the load cases"),
            ),
            **hours,
            "limit_state": (dims, self.state, flags),
        }

    def attributes(self) -> dict[str, str]:
        """Return which limits were asked for, and what they lack, as attributes."""
        return {"limits": " ".join(self.requested), NOTES: "\n".join(self.notes)}


def _inputs_of_rollers(
    whole: Carriage, materials: list[dict[str, Any]], pace: np.ndarray
) -> dict[str, Any]:
    """Return the materials of the rollers, and the life that their files require, as variables.

    A required travel is one of the carriage, which takes `pace` hours a km, (n,).
    """
    required = np.full(len(whole.rollers), np.nan)
    for j, roller in enumerate(whole.rollers):
        least = [own.least for name, own in roller.required.items() if name in LIVES_OF_PAIR]
        travel = None if roller.case is None else roller.case.required_travel
        if travel is not None:
            least.append(float(travel * pace[j]))
        required[j] = max(filter(math.isfinite, least), default=math.nan)
    names: dict[str, Any] = {
        field: (_R, [str(own[field]["name"]) for own in materials], {}) for field in MATERIAL_FIELDS
    }
    return names | {
        "required_hours": (_R, required, _attrs("h", "life that the file of the roller requires"))
    }


def _each_once(materials: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the values of the materials of all rollers and rails, those of equal pairs once."""
    pairs = {json.dumps(own, sort_keys=True, default=str): own for own in materials}
    return {
        f"{name}_{k}": values
        for k, own in enumerate(pairs.values())
        for name, values in own.items()
    }


def _not_given(whole: Carriage) -> dict[str, Any]:
    """Return the values of rollers that nobody gave and that the carriage does not give, by
    name.
    """
    given = {*LOADS, "travel"}
    if all(case.speed is not None for case in whole.cases):
        given |= {"velocity"}
    values: dict[str, Any] = {}
    for case in (roller.case for roller in whole.rollers if roller.case is not None):
        values |= used_of(
            plain_inputs(case), [name for name in case.not_given if name not in given]
        )
    return values
