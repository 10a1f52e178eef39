"""Catalogue of edge scenes as data: series of cases that run to the ends of the parameters, and what must hold there.

A scene is a series of cases along one quantity. Its claims are names of `validation.extremes.checks.CHECKS`.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from trackroller.roller.equilibrium.roller import LIFTED

CaseDict = dict[str, Any]
STEEL: CaseDict = {
    "name": "steel",
    "youngs_modulus": 210000.0,
    "poisson_ratio": 0.3,
    "tensile_strength": 720.0,
    "fatigue_strength_ratio": 0.5,
    "cycles_at_tensile_strength": 1e4,
    "cycles_at_fatigue_limit": 5e6,
}
BASE: CaseDict = {
    "axis_distance": 21.75,
    "guide_profile_radius": 6.0,
    "roller_profile_radius": -7.0,
    "guide_curve_radius": 220.0,
    "contact_angle": 30.0,
    "radial_force": -200.0,
    "axial_force": 30.0,
    "motor_force": -10.0,
    "friction_coefficient": 0.2,
    "velocity": 60.0,
    "guide_overrollings_per_hour": 100.0,
    "roller_material": STEEL,
    "guide_material": STEEL,
}
ALWAYS = ("finite", "solved", "residual", "scaling", "mirror", "condition")
FLAT_TAN = math.tan(math.radians(30.0))
COMPLETE = 0.2 * 200.0 / math.cos(math.radians(30.0))  # what the base case can transmit in complete slip [N]
LENGTHS = ("axis_distance", "guide_profile_radius", "roller_profile_radius", "guide_curve_radius")
FORCES = ("radial_force", "axial_force", "motor_force")


@dataclass(frozen=True)
class Scene:
    """A series of cases along `quantity` and the claims made on it.

    `rising` and `falling` name results that may only rise or fall along the series; `pairs` says that cases come in
    pairs just below and just above a border; `limit` says that the last case is the limit of the cases before. The
    contact models `models` are run. Models in `reach` may fail for patches that are too slender for their coefficients
    or grid. `close` says that neighbours closer than 1e-4 must have close results.

    Where a case depends on the answer (the force at which a contact lifts, the motor force that puts the spin pole on
    the edge), `build` makes it from a number between `span`: with `pairs` the border is searched for there and
    `values` are shares of it, otherwise `values` are places of the pole that numbers are found for.
    """

    name: str
    quantity: str
    values: tuple[float, ...]
    cases: tuple[CaseDict, ...]
    rising: tuple[str, ...] = ()
    falling: tuple[str, ...] = ()
    constant: tuple[str, ...] = ()
    pairs: bool = False
    limit: bool = False
    models: tuple[str, ...] = ("sliding", "kalker")
    reach: tuple[str, ...] = ()
    close: bool = False
    build: Callable[[float], CaseDict] | None = None
    span: tuple[float, float] = (0.0, 0.0)

    @property
    def claims(self) -> tuple[str, ...]:
        """Return the names of the checks that apply."""
        more = [
            name
            for name, on in (
                ("monotone", self.rising or self.falling),
                ("constant", self.constant),
                ("border", self.pairs),
                ("limit", self.limit),
                ("close", self.close),
            )
            if on
        ]
        return (*ALWAYS, *more)


def _series(name: str, quantity: str, values: Any, build: Any, **options: Any) -> Scene:
    values = tuple(float(v) for v in values)
    return Scene(name, quantity, values, tuple(BASE | build(v) for v in values), **options)


def _searched(name: str, quantity: str, values: Any, build: Any, span: Any, **options: Any) -> Scene:
    return Scene(name, quantity, tuple(map(float, values)), (), build=lambda v: BASE | build(v), span=span, **options)


def _material(**changes: Any) -> CaseDict:
    return STEEL | changes


def _of_ellipticity(ratio: float) -> CaseDict:
    """Return a case with the curvature ratio k_x/k_y, under a load that keeps the patch small."""
    guide = 6.0 if ratio < 1 else 6.0 / ratio**0.5
    k_y = math.cos(math.radians(30.0)) / 20.0
    groove = 1.0 / (k_y * ratio - 1.0 / guide)
    return {
        "guide_profile_radius": guide,
        "roller_profile_radius": groove,
        "guide_curve_radius": math.inf,
        "axis_distance": 20.0 + guide * math.cos(math.radians(30.0)),
        "radial_force": -1e-3,
        "axial_force": 1e-4,
        "motor_force": -5e-5,
    }


def _steep(angle: float) -> CaseDict:
    alpha = math.radians(angle)
    slope = min(math.tan(alpha), 1.0 / math.tan(alpha))
    return {
        "contact_angle": angle,
        "axial_force": 60.0 * math.tan(alpha),
        "motor_force": 0.0,
        "friction_coefficient": 0.2 * min(slope, 1.0),
    }


def _loads(force: float) -> CaseDict:
    return {"radial_force": -force, "axial_force": 0.15 * force, "motor_force": -0.05 * force}


def _brake(share: float) -> CaseDict:
    return {"motor_force": share * COMPLETE}


def _edge(place: float) -> tuple[float, ...]:
    return tuple(place + d for d in (-1e-2, -1e-5, 0.0, 1e-5, 1e-2))


def _over(curvature: float) -> float:
    return 1.0 / curvature if curvature else math.copysign(math.inf, curvature)


def _lift_share() -> float:
    """Return the axial force over |F_rad| tan(alpha) at which a frictionless contact carries `LIFTED` of the load."""
    share = 2.0 * LIFTED * math.cos(math.radians(30.0))
    return (1.0 - share) / (1.0 + share * FLAT_TAN)


def _border(limit: float, steps: tuple[float, ...] = (1e-3, 1e-6, 1e-9)) -> tuple[float, ...]:
    return tuple(limit * (1 + sign * step) for step in steps for sign in (-1, 1))


def scenes() -> tuple[Scene, ...]:
    """Return the catalogue."""
    return (*_friction_and_load(), *_geometry(), *_materials(), *_borders())


def _friction_and_load() -> tuple[Scene, ...]:
    return (
        _series(
            "friction to 0",
            "mu",
            (1e-2, 1e-4, 1e-6, 1e-9, 1e-12, 0.0),
            lambda v: {"friction_coefficient": v, "motor_force": 0.0},
            falling=("max_shear",),
            limit=True,
        ),
        _series(
            "friction to 2",
            "mu",
            (0.1, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0),
            lambda v: {"friction_coefficient": v, "contact_angle": 60.0, "motor_force": 0.0},
            rising=("max_shear_sum",),
        ),
        _series(
            "loads",
            "F_rad [N]",
            10.0 ** np.arange(-3, 6.5),
            _loads,
            rising=("normal_force", "max_pressure", "peak_stress"),
            falling=("life_cycles",),
        ),
        _series(
            "no axial, no motor force",
            "F_ax = F_motor [N]",
            (1.0, 1e-3, 1e-6, 1e-9, 0.0),
            lambda v: {"axial_force": v, "motor_force": v},
            limit=True,
        ),
        _series(
            "spin pole",
            "F_motor [N]",
            40.0 * np.array([-0.999, -0.9, -0.5, -0.2, -0.05, 0, 0.05, 0.2, 0.5, 0.9, 0.999]),
            lambda v: {"motor_force": v, "axial_force": 0.0},
            rising=("rolling_radius_shift",),
        ),
        _searched(
            "spin pole on the edge",
            "x_spin/a",
            (-50, -3, *_edge(-1.0), -0.5, 0, 0.5, *_edge(1.0), 3, 50),
            lambda v: {"motor_force": v * COMPLETE, "axial_force": 0.0},
            (-1.0, 1.0),
            close=True,
        ),
    )


def _geometry() -> tuple[Scene, ...]:
    r_a = 21.75 - 6.0 * math.cos(math.radians(30.0))
    return (
        _series(
            "ellipticity",
            "k_x/k_y",
            10.0 ** np.arange(-5, 5.5),
            _of_ellipticity,
            reach=("kalker",),
        ),
        _series(
            "near circle",
            "k_x/k_y - 1",
            (1e-2, 1e-4, 1e-6, 1e-9, 1e-12, 0.0),
            lambda v: _of_ellipticity(1.0 + v),
            limit=True,
        ),
        _series(
            "contact angle",
            "alpha [deg]",
            (0.01, 0.1, 1, 10, 30, 60, 80, 89, 89.9, 89.99),
            _steep,
        ),
        _series(
            "outer curve to straight",
            "r_Curve [mm]",
            (1e1, 1e2, 1e4, 1e6, 1e9, math.inf),
            lambda v: {"guide_curve_radius": v},
            falling=("max_pressure",),
            limit=True,
        ),
        _series(
            "outer straight, inner straight",
            "1/r_Curve [1/mm]",
            (1e-9, 1e-12, 0.0, -0.0, -1e-12, -1e-9),
            lambda v: {"guide_curve_radius": _over(v)},
            constant=("max_pressure", "peak_stress", "slip"),
        ),
        _series(
            "straight to inner curve",
            "-r_Curve/r_A - 1",
            (1e3, 1e1, 1e0, 1e-2, 1e-4, 1e-6, 1e-8),
            lambda v: {"guide_curve_radius": -r_a * (1 + v), **_loads(1e-2)},
            falling=("max_pressure",),
            reach=("kalker",),
        ),
        _series(
            "close groove",
            "r_C,TR/r_C,G - 1",
            (1e1, 1e0, 1e-2, 1e-4, 1e-6, 1e-8),
            lambda v: {"roller_profile_radius": -6.0 * (1 + v), **_loads(1e-2)},
            falling=("max_pressure",),
            reach=("kalker",),
        ),
        _series(
            "size",
            "scale",
            (1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3),
            lambda v: {k: BASE[k] * v for k in LENGTHS} | {k: BASE[k] * v * v for k in FORCES},
            constant=("max_pressure", "peak_stress", "slip"),
        ),
    )


def _materials() -> tuple[Scene, ...]:
    return (
        _series(
            "Poisson's ratio",
            "nu",
            (0.0, 0.1, 0.3, 0.4, 0.49, 0.4999, 0.5 - 1e-9, 0.5),
            lambda v: dict.fromkeys(("roller_material", "guide_material"), _material(poisson_ratio=v)),
            rising=("max_pressure",),
            limit=True,
        ),
        _series(
            "soft guide",
            "E_G/E_TR",
            10.0 ** np.arange(-6, 0.5),
            lambda v: {"guide_material": _material(youngs_modulus=210000.0 * v), **_loads(1e-3)},
            rising=("max_pressure", "peak_stress"),
        ),
        _series(
            "soft roller",
            "E_G/E_TR",
            10.0 ** np.arange(0, 6.5),
            lambda v: {"roller_material": _material(youngs_modulus=210000.0 / v), **_loads(1e-3)},
            falling=("max_pressure", "peak_stress"),
        ),
    )


def _borders() -> tuple[Scene, ...]:
    lift = 200.0 * FLAT_TAN
    return (
        _series(
            "slip limit, braking",
            "share of limit",
            _border(1.0),
            _brake,
            pairs=True,
            models=("sliding",),
        ),
        # table and elements reach the complete friction within their error
        _series(
            "slip limit, braking",
            "share of limit",
            _border(1.0, (1e-3, 1e-4, 1e-5)),
            _brake,
            pairs=True,
            models=("kalker",),
        ),
        _searched(
            "slip limit, driving",
            "share of limit",
            _border(1.0, (1e-2, 1e-4, 1e-5)),
            lambda v: {"motor_force": -v * COMPLETE},
            (0.5, 1.2),
            pairs=True,
        ),
        _series(
            "lift-off without friction",
            "share of limit",
            _border(_lift_share()),
            lambda v: {"axial_force": v * lift, "friction_coefficient": 0.0, "motor_force": 0.0},
            pairs=True,
        ),
        _searched(
            "lift-off with friction",
            "share of limit",
            _border(1.0, (1e-2, 1e-4, 1e-5)),
            lambda v: {"axial_force": v * lift, "motor_force": 0.0},
            (0.1, 1.2),
            pairs=True,
        ),
        _series(
            "self-locking, no axial force",
            "mu/tan(alpha)",
            (0.5, 0.9, 1.1, 1.5, 3.0),
            lambda v: {
                "contact_angle": 11.0,
                "friction_coefficient": v * math.tan(math.radians(11.0)),
                "axial_force": 0.0,
                "motor_force": 0.0,
            },
        ),
        _series(
            "self-locking",
            "mu/tan(alpha)",
            (0.5, 0.9, 0.99, 1.01, 1.1, 1.5, 3.0),
            lambda v: {
                "contact_angle": 11.0,
                "friction_coefficient": v * math.tan(math.radians(11.0)),
                "axial_force": 1.0,
                "motor_force": 0.0,
            },
        ),
    )


def scaled(case: Mapping[str, Any], length: float, modulus: float) -> CaseDict:
    """Return the case in other units: lengths times `length`, moduli and strengths times `modulus`, forces to match."""
    changed = {k: case[k] * length for k in LENGTHS} | {k: case[k] * length**2 * modulus for k in FORCES}
    for body in ("roller_material", "guide_material"):
        m = case[body]
        changed[body] = m | {k: m[k] * modulus for k in ("youngs_modulus", "tensile_strength")}
    return dict(case) | changed


def mirrored(case: Mapping[str, Any]) -> CaseDict:
    """Return the mirror image of a case: the axial force changes its sign, contacts 1 and 2 swap."""
    return dict(case) | {"axial_force": -case["axial_force"]}


def some(names: tuple[str, ...]) -> tuple[Scene, ...]:
    """Return the scenes of these names."""
    return tuple(s for s in scenes() if s.name in names)


def thinned(scene: Scene, every: int) -> Scene:
    """Return the scene with every n-th case, the last included."""
    keep = sorted({*range(0, len(scene.cases), every), len(scene.cases) - 1})
    return dataclasses.replace(
        scene, values=tuple(scene.values[i] for i in keep), cases=tuple(scene.cases[i] for i in keep)
    )
