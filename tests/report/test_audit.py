"""Audit of what a report says on solved random studies, recomputed with pandas from the raw rows.

Nothing here uses analysis or sentences of the program: rows come from the data set, claims from the text.
"""

from __future__ import annotations

import itertools
import json
import os

import numpy as np
import pandas as pd

STUDIES = int(os.environ.get("TRACKROLLER_AUDITS", "8"))
NUMBER = r"(−?[\d,]+(?:\.\d+)?(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?)"
PLAIN = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
OUTSIDE = ("half_space", "yield", "static", "conformal", "steep_friction")
STEEL, HARD, ALU = "1.7225-normalised", "1.7225-quenched-tempered", "EN AW-7075"
CHOICES = {
    "roller_profile_radius": [-6.3, -6.6, -7.5, -9.0],
    "contact_angle": [25.0, 32.0, 40.0],
    "material_pair": [[HARD, STEEL], [STEEL, "PA6"], ["POM", STEEL], [ALU, HARD], ["PA6", "POM"]],
    "axis_distance": [20.0, 24.0],
}
CONDITIONS = {
    "friction_coefficient": [0.02, 0.1, 0.2, 0.35],
    "motor_force": [-25.0, -5.0, 0.0, 12.0],
    "axial_force": [-20.0, 0.0, 15.0, 45.0],
    "radial_force": [-20.0, -90.0, -200.0],
    "guide_curve_radius": [220.0, -150.0, float("inf")],
}


def random_file(seed):
    """Return a random study file: a grid, or now and then an inner/outer array design."""
    rng = np.random.default_rng([7, seed])

    def take(table, low, high):
        return {
            str(n): sorted(rng.choice(len(table[n]), rng.integers(2, min(4, len(table[n]) + 1)), replace=False))
            for n in rng.permutation(list(table))[: rng.integers(low, high)]
        }

    picked = {**take(CHOICES, 1, 3), **take(CONDITIONS, 0 if seed % 9 == 4 else 1, 3)}
    every = CHOICES | CONDITIONS
    factors = {n: {"values": [every[n][i] for i in places]} for n, places in picked.items()}
    told = {"name": f"audit-{seed}", "contact_model": "sliding", "accuracy": "preview", "factors": factors, "base": {}}
    if rng.random() < 0.6:
        told["base"]["guide_overrollings_per_hour"] = float(rng.choice([60, 600, 2e5]))
    told["life_rule"] = str(rng.choice(["elementary", "haibach", "unlimited"]))
    if seed % 5 == 3:
        told |= {"method": "inner_outer", "samples": 32, "seed": int(seed)}
        factors |= {"friction_coefficient": {"uniform": [0.05, 0.3]}, "axial_force": {"uniform": [0.0, 60.0]}}
        for name in ("motor_force", "radial_force", "guide_curve_radius"):
            factors.pop(name, None)
    if rng.random() < 0.4:
        told["constraints"] = [f"max_pressure < {rng.choice([80, 300, 900, 1400])}"]
    if rng.random() < 0.7:
        told["analysis"] = {"target": {"pair_life_hours": {"min": float(rng.choice([5, 100, 5000]))}}}
    return told


def rows_of(ds, told):
    """Return the raw rows as one table, with what makes a case valid and which lives lie beyond the data."""
    dims = [d for d in ds["regime"].dims]
    flat = lambda v: v.broadcast_like(ds["regime"]).transpose(*dims).values.ravel()  # noqa: E731
    names = [n for n in told["factors"]]
    frame = pd.DataFrame({n: flat(ds[n]) for n in names})
    for n in ("regime", "converged", "validity", "first_to_fail", "motor_force", "friction_coefficient"):
        frame[n] = flat(ds[n]) if n in ds.variables else float(told["base"].get(n, np.nan))
    for n in ("radial_force", "contact_angle"):
        frame[n] = flat(ds[n])
    for n in ("roller", "guide", "pair"):
        frame[n] = flat(ds[f"{n}_life_hours"])
    load = ds["normal_force"]
    frame["lift"] = flat(load.min("contact") / load.max("contact"))
    frame["pressure"] = flat(ds["max_pressure"].max("contact"))
    bits = ds["validity"].attrs["flag_meanings"].split()
    outside = sum(1 << bits.index(flag) for flag in OUTSIDE if flag in bits)
    frame["rolls"] = (frame["regime"] == 0) & (frame["converged"] == 1)
    frame["inside"] = frame["rolls"] & ((frame["validity"].astype(int) & outside) == 0)
    frame["valid"] = frame["inside"]
    materials = json.loads(ds.attrs["materials"])
    for body in ("roller", "guide"):
        knee = np.array([materials[m]["cycles_at_fatigue_limit"] for m in flat(ds[f"{body}_material"]).astype(str)])
        cycles = flat(ds["life_cycles"].sel(body=body).min("contact"))
        frame[f"{body}_beyond"] = (cycles > np.minimum(knee, 1e8)) | np.isposinf(frame[body])
    frame["pair_beyond"] = np.where(frame["first_to_fail"] == 1, frame["guide_beyond"], frame["roller_beyond"])
    with np.errstate(divide="ignore", invalid="ignore"):
        hold = frame["friction_coefficient"] * frame["radial_force"].abs() / np.cos(np.deg2rad(frame["contact_angle"]))
        frame["slip"] = 1 - frame["motor_force"].abs() / hold
    return frame


def value(text):
    mantissa, _, power = text.replace(",", "").replace("−", "-").partition("·10")
    return float(mantissa) * (10.0 ** int(power.translate(PLAIN)) if power else 1.0)


def level(name, given):
    """Write a level as the page does, from the conventions of the documentation."""
    if name == "material_pair":
        a, b = str(given).split(" / ")
        return f"{a} on itself" if a == b else f"{a} on {b}"
    text = f"{given:.4g}".replace("-", "−")
    if name == "motor_force":
        return "free rolling" if given == 0 else f"{'driven' if given < 0 else 'braked'} {text} N"
    if name == "guide_curve_radius":
        side = "outer" if given > 0 else "inner"
        return "straight track" if np.isinf(given) else f"{side} curve {abs(given):.4g} mm"
    unit = {"contact_angle": "°", "friction_coefficient": ""}.get(name, " N" if "force" in name else " mm")
    return f"{name.replace('_', ' ')} {text}{unit}"


def test_the_random_studies_hold_what_they_must():
    """Polymers, both designs of experiments, constraints, targets, and guides with and without hours."""
    files = [random_file(seed) for seed in range(40)]
    pairs = list(itertools.chain(*(f["factors"].get("material_pair", {}).get("values", []) for f in files)))
    assert any("PA6" in pair for pair in pairs) and any("POM" in pair for pair in pairs)
    for key in ("constraints", "analysis", "method"):
        assert 0 < sum(key in f for f in files) < len(files)
    assert 0 < sum("guide_overrollings_per_hour" in f["base"] for f in files) < len(files)
