"""Random extremes over all limits: a number, or the reason why there is none."""

import os
import warnings

import numpy as np
import pytest

import trackroller as tr
from trackroller.damage import LIMITS, groups_of
from trackroller.roller.dataset import validity_bit
from validation.extremes.random_cases import random_extremes

GROUPS = (*groups_of("limits", ["all"]), "multiaxial", "forces", "contact", "peak_stress", "friction_work", "life")


def spread(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def limit_values(material, rng):
    """Add the values of all limits, of any size that a material accepts."""
    strength = material["tensile_strength"]
    return material | {
        "yield_strength": strength * rng.uniform(0.01, 1.0),
        "hardness": spread(rng, 1.0, 900.0),
        "wear_coefficient": rng.choice([0.0, spread(rng, 1e-12, 0.9)]),
        "loss_fraction": rng.choice([0.0, 1.0, rng.uniform(0, 1)]),
        "thermal_conductivity": spread(rng, 1e-3, 4e3),
        "heat_capacity": spread(rng, 10.0, 1e4),
        "density": spread(rng, 10.0, 2.5e4),
        "temperature_limit": rng.uniform(-50.0, 2000.0),
        "fatigue_limit_torsion": strength * material["fatigue_strength_ratio"] * rng.uniform(0.501, 0.999),
    }


def cases(count, seed):
    """Return extreme cases with all values that the limits ask for."""
    rng = np.random.default_rng(seed + 1)
    out = []
    for case in random_extremes(count, seed):
        bearing = {"rows": 2, "row_distance": spread(rng, 0.1, 100), "kind": str(rng.choice(["ball", "roller"]))}
        bearing |= {name: spread(rng, 1e-2, 1e7) for name in ("dynamic_rating", "static_rating")}
        bearing |= {"e": rng.uniform(0.1, 0.9), "X": 0.5, "Y": 1.5, "X0": 0.6, "Y0": 0.5}
        maker = {name: spread(rng, 1e-2, 1e7) for name in ("radial_force", "axial_force", "moment", "basic_life")}
        out.append(
            case
            | {body: limit_values(case[body], rng) for body in ("roller_material", "guide_material")}
            | {"bearing": bearing, "catalogue": maker | {"law": str(rng.choice(["dry", "lubricated", "cubic"]))}}
            | {"permissible_wear_depth": spread(rng, 1e-6, 10), "required_travel": spread(rng, 1e-3, 1e6)}
            | {"heat_transfer_coefficient": spread(rng, 1e-2, 1e5), "cooled_area": spread(rng, 1e-2, 1e6)}
            | {"permissible_radial_force": spread(rng, 1e-3, 1e7), "ambient_temperature": rng.uniform(-50, 500)}
        )
    return out


def check(count, seed, **options):
    """Solve, and check every result of every limit of rolling cases."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ds = tr.solve(cases(count, seed), GROUPS, accuracy="preview", **options)
    rolls = (ds.regime.values == 0) & (ds.converged.values == 1)
    assert rolls.sum() > 0.3 * count and not ds.attrs.get("limits_notes")
    for limit in LIMITS.values():
        for name in (own.name for own in limit.results if own.name in ds):
            undefined = ds[name].isnull().values.reshape(count, -1).any(axis=1) & rolls
            if LIMITS["fatigue"] is limit:  # bodies above their tensile strength have no fatigue life
                undefined &= (ds.validity_body.values & validity_bit("static") == 0).all(axis=1)
            if name == "wear_place":  # where nothing wears
                undefined &= (ds.wear_depth_per_overrolling > 0).all(["contact", "body"]).values
            assert not undefined.any(), (name, np.flatnonzero(undefined))
    for name in ("utilisation", "life_hours_by_limit"):
        assert not (ds[name] < 0).any()
    first = ds.life_to_first_limit_hours.values[rolls]
    assert (first >= 0).all()
    of_contacts = [name for name in ds.limit.values if name not in ("bearing", "catalogue")]
    lifted = ds.regime.values >= 2  # the loads on bearing and stud are known without contacts
    assert ds.utilisation.sel(limit=of_contacts).isnull().any("body").values[lifted].all()
    return ds


@pytest.mark.long
def test_thirty_random_extremes_have_all_limits():
    check(30, 1, contact_model="kalker")


@pytest.mark.long
@pytest.mark.parametrize("seed", range(10, 10 + int(os.environ.get("EXTREME_FIFTIES", "1"))))
def test_hundreds_of_random_extremes_have_all_limits(seed):
    check(50, seed, contact_model="kalker" if seed % 2 else "sliding")
