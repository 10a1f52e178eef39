"""The recorded cases: deterministic, many cheap ones and few expensive ones."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

import trackroller as tr

FORCES = ("forces", "contact", "friction_work")
COMPLETE = (*FORCES, "peak_stress", "life")
EVERYTHING = (*COMPLETE, "tractions", "subsurface")
STEEL, HARD, ALUMINIUM = "1.7225-normalised", "1.7225-quenched-tempered", "EN AW-7075"
PAIRS = ((STEEL, STEEL), (HARD, STEEL), (ALUMINIUM, STEEL), ("PA6", STEEL), ("POM", HARD), ("PA6", "POM"))
Cases = list[dict[str, Any]]


@dataclass(frozen=True)
class Group:
    """Cases that are solved in one call.

    `contact_model` and `normal` of the options name the group in a comparison.
    """

    name: str
    cases: Cases
    options: dict[str, Any] = field(default_factory=dict)


def ordinary(count: int, seed: int) -> Cases:
    """Return rollers as they are built: `count` cases drawn over the usual ranges of all parameters."""
    rng = np.random.default_rng(seed)
    found = []
    for i in range(count):
        guide = rng.uniform(3, 12)
        angle = rng.uniform(15, 60)
        radial = -float(np.exp(rng.uniform(np.log(30), np.log(2000))))
        mu = float((0.05, 0.12, 0.3, 0.45)[i % 4] * rng.uniform(0.8, 1.2))
        roller, track = PAIRS[i % len(PAIRS)]
        found.append(
            {
                "axis_distance": float(guide * rng.uniform(2.5, 6)),
                "guide_profile_radius": float(guide),
                "roller_profile_radius": float(-guide * rng.uniform(1.03, 2.0)) if i % 5 else 40.0,
                "guide_curve_radius": (math.inf, 220.0, -400.0)[i % 3],
                "contact_angle": float(angle),
                "radial_force": radial,
                "axial_force": 0.0 if i % 4 == 0 else float(-radial * rng.uniform(-0.5, 0.5) * math.tan(angle / 57.3)),
                "motor_force": 0.0 if i % 4 == 1 else float(radial * mu * rng.uniform(-0.6, 0.9)),
                "friction_coefficient": mu,
                "velocity": float(rng.uniform(5, 300)),
                "guide_overrollings_per_hour": None if i % 2 else 600.0,
                "roller_material": roller,
                "guide_material": track,
            }
        )
    return found


def extreme(count: int, seed: int) -> Cases:
    """Return `count` valid cases with all parameters log-uniform, far beyond what is built."""
    rng = np.random.default_rng(seed)
    found: Cases = []
    while len(found) < count:
        case = _extreme(rng)
        try:
            tr.Case(**case)
        except tr.InputError:
            continue
        found.append(case)
    return found


def _extreme(rng: np.random.Generator) -> dict[str, Any]:
    def log(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    def one(*several: Any) -> Any:
        return several[rng.integers(len(several))]

    angle = one(0.01, 89.99, float(rng.uniform(1, 89)), log(0.01, 45))
    guide = log(1e-3, 1e4)
    radius = guide * math.cos(math.radians(angle)) * log(1e-3, 1e3)
    force, mu = log(1e-3, 1e6), one(0.0, log(1e-12, 2), float(rng.uniform(0, 1)))
    material = {
        "name": "any",
        "youngs_modulus": log(1e-3, 3e5),
        "poisson_ratio": one(0.0, 0.5, 0.3, float(rng.uniform(0, 0.5))),
        "tensile_strength": log(0.1, 4e4),
        "fatigue_strength_ratio": float(rng.uniform(0.05, 0.95)),
        "cycles_at_tensile_strength": 1e4,
        "cycles_at_fatigue_limit": 5e6,
    }
    return {
        "axis_distance": radius + guide * math.cos(math.radians(angle)),
        "guide_profile_radius": guide,
        "roller_profile_radius": one(-guide * (1 + log(1e-6, 1e2)), guide * log(1e-3, 1e3), math.inf),
        "guide_curve_radius": one(math.inf, -math.inf, radius * log(1e-3, 1e4), -radius * (1 + log(1e-6, 1e4))),
        "contact_angle": angle,
        "radial_force": -force,
        "axial_force": one(0.0, force * log(1e-9, 1e1), -force * math.tan(math.radians(angle)) * rng.uniform(0, 1.1)),
        "motor_force": one(0.0, force * log(1e-9, 1e1), float(force * mu * rng.uniform(-1.2, 1.2))),
        "friction_coefficient": mu,
        "velocity": log(1e-3, 1e4),
        "roller_material": material,
        "guide_material": one(material, STEEL, "PA6"),
    }


def regimes() -> Cases:
    """Return cases around the borders of all regimes, frictionless and frictional, driven and braked."""
    axes = {
        "friction_coefficient": (0.0, 0.02, 0.3, 1.2),
        "motor_force": (0.0, -30.0, 30.0, -500.0),
        "axial_force": (0.0, 30.0, -30.0, 140.0),
    }
    return [dict(zip(axes, row, strict=True)) for row in itertools.product(*axes.values())]


def friction_laws() -> Cases:
    """Return cases with every kind of friction law, slow and fast."""
    laws = (
        {"kind": "constant"},
        {"kind": "linear", "speed": 40.0, "lowest": 0.5},
        {"kind": "exponential", "speed": 25.0, "lowest": 0.4},
        {"kind": "exponential", "speed": 300.0},
        {"kind": "table", "speed": [0.0, 10.0, 60.0, 400.0], "friction": [0.28, 0.3, 0.2, 0.12]},
    )
    return [{"friction_law": law, "velocity": v, "motor_force": -20.0} for law in laws for v in (6.0, 120.0)]


def material_cases() -> Cases:
    """Return cases with like and unlike bodies, inline materials and friction from the database."""
    inline = {"name": "hardened", "like": HARD, "tensile_strength": 1500.0}
    pairs = (*PAIRS, ("POM", "POM"), (inline, STEEL), (STEEL, inline), (inline, "PA6"))
    levels = (None, "upper", "lower", 0.2)
    return [
        {
            "roller_material": a,
            "guide_material": b,
            "friction_coefficient": levels[i % 4],
            "radial_force": -60.0 - 90 * k,
        }
        for i, (a, b) in enumerate(pairs)
        for k in range(2)
    ]


def profiles() -> Cases:
    """Return cases with every form of drawn cross-section."""
    x = np.linspace(-5.4, 5.4, 61)
    guide = np.stack([x, np.sqrt(36.0 - x**2)], axis=1).round(6).tolist()
    flank = np.linspace(-2.0, 2.0, 41)
    groove = np.stack([flank, 7.0 - np.sqrt(49.0 - flank**2)], axis=1).round(7).tolist()
    arcs = [{"radius": 5.0, "to": -0.6}, {"radius": 6.0, "to": 0.6}, {"radius": 5.0}]
    return [
        {"guide_profile": {"arc": 6.0}},
        {"guide_profile": {"parabola": 6.0}, "roller_profile": {"parabola": -7.0}},
        {"guide_profile": {"arcs": arcs}, "axial_force": 0.0},
        {"guide_profile": {"points": guide}},
        {"roller_profile": {"points": groove, "frame": "contact"}},
        {"roller_profile": {"points": groove, "frame": "contact", "smooth": 1e-5}},
        {"roller_profile": {"arc": -7.0, "edge": {"inner": 0.35, "outer": 0.5, "chamfer": 0.1}}},
        {"guide_profile": {"arc": 6.0, "width": 6.5}},
    ]


def curved() -> Cases:
    """Return cases in which the turning with the curve and the guide's profile matter."""
    names = ("guide_curve_radius", "roller_profile_radius", "motor_force")
    rows = ((60.0, -6.4, -20.0), (-60.0, -6.4, 0.0), (math.inf, -6.2, 15.0), (220.0, -8.0, 0.0))
    return [dict(zip(names, row, strict=True)) for row in rows]


def _sliding() -> Iterator[Group]:
    for accuracy in ("preview", "standard", "reference", 1e-2, 1e-3):
        yield Group(f"sliding_{accuracy}", ordinary(24, 1), {"outputs": COMPLETE, "accuracy": accuracy})
    for spin in ("concentric", "edge"):
        yield Group(f"sliding_{spin}", ordinary(18, 2), {"outputs": COMPLETE, "spin_model": spin})
    yield Group("sliding_regimes", regimes(), {"outputs": COMPLETE})
    yield Group("sliding_extreme", extreme(60, 3), {"outputs": COMPLETE, "accuracy": "preview"})
    yield Group("sliding_materials", material_cases(), {"outputs": COMPLETE})
    yield Group("sliding_laws", friction_laws(), {"outputs": COMPLETE})
    for rule in ("haibach", "unlimited"):
        yield Group(f"sliding_{rule}", material_cases(), {"outputs": "life", "life_rule": rule})
    published = {"hertz": "published", "stress_bodies": "published", "outputs": COMPLETE}
    yield Group("sliding_published", ordinary(18, 4), published)
    yield Group("sliding_published_hertz", ordinary(12, 4), {"hertz": "published", "outputs": COMPLETE})
    yield Group("sliding_published_bodies", ordinary(12, 5), {"stress_bodies": "published", "outputs": COMPLETE})
    yield Group("sliding_slip_profile", curved(), {"slip_terms": ["profile"], "outputs": COMPLETE})
    yield Group("sliding_no_shortcuts", regimes()[::4], {"shortcuts": False, "outputs": COMPLETE})
    for i, condition in enumerate(("peak_stress > R_m", "max_pressure > 900 or regime == full_slip")):
        yield Group(f"sliding_stop_{i}", ordinary(18, 6), {"stop_if": condition, "outputs": COMPLETE})
    for output in ("forces", "contact", "friction_work", "peak_stress", "life", "tractions"):
        yield Group(f"sliding_only_{output}", ordinary(4, 7), {"outputs": (output,)})
    yield Group("sliding_everything", [{}, *ordinary(3, 8), *regimes()[-2:]], {"outputs": EVERYTHING})


def _rolling(model: str, counts: dict[Any, int]) -> Iterator[Group]:
    same = {"contact_model": model, "outputs": COMPLETE}
    for accuracy, count in counts.items():
        yield Group(f"{model}_{accuracy}", ordinary(count, 9), same | {"accuracy": accuracy})
    yield Group(f"{model}_regimes", regimes()[::3], same | {"accuracy": "preview"})
    yield Group(f"{model}_extreme", extreme(10, 10), same | {"accuracy": "preview"})
    if model != "auto":
        yield Group(f"{model}_laws", friction_laws()[1::2], same)
        yield Group(f"{model}_no_shortcuts", regimes()[1::21], same | {"shortcuts": False})
        yield Group(f"{model}_everything", [{}, *ordinary(2, 11)], same | {"outputs": EVERYTHING})
        yield Group(f"{model}_published", ordinary(3, 4), same | {"hertz": "published", "stress_bodies": "published"})
        yield Group(f"{model}_stop", ordinary(4, 6), same | {"stop_if": "peak_stress > R_m"})
    for terms in (["profile"], ["curve"], ["curve", "profile"]):
        yield Group(f"{model}_slip_{'_'.join(terms)}", curved()[:2], same | {"slip_terms": terms})


def _halfspace() -> Iterator[Group]:
    same = {"normal": "halfspace", "outputs": COMPLETE}
    yield Group("halfspace_sliding", ordinary(5, 12), same)
    yield Group("halfspace_sliding_preview", [*ordinary(6, 13), *regimes()[::17]], same | {"accuracy": "preview"})
    yield Group("halfspace_profiles", profiles(), same | {"accuracy": "preview"})
    yield Group("halfspace_extreme", extreme(2, 14), same | {"accuracy": "preview"})
    for model in ("fastsim", "kalker"):
        several = [{}, *ordinary(2, 15)]
        yield Group(f"halfspace_{model}", several, same | {"contact_model": model, "accuracy": "preview"})
        rolling = {"contact_model": model, "accuracy": "preview", "outputs": FORCES}
        yield Group(f"halfspace_{model}_profiles", profiles()[2::4], same | rolling)
    yield Group("halfspace_everything", [{}], same | {"outputs": EVERYTHING, "accuracy": "preview"})


def groups() -> list[Group]:
    """Return all groups.

    Returns
    -------
    list of Group
        About 800 cases, two to three minutes of one core.
    """
    makers: tuple[Callable[[], Iterator[Group]], ...] = (
        _sliding,
        lambda: _rolling("fastsim", {"preview": 12, "standard": 18, "reference": 4, 0.1: 6}),
        lambda: _rolling("kalker", {"preview": 40, "standard": 36, "reference": 2, 0.1: 6}),
        lambda: _rolling("kalker_table", {"preview": 24}),
        _halfspace,
    )
    return [replace(g, options={"contact_model": "sliding"} | g.options) for maker in makers for g in maker()]
