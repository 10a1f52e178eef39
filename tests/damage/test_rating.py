"""The standard rating of wheel and rail, and static failure."""

import math

import numpy as np
import pytest

import trackroller as tr
from trackroller.damage.pressure_line import pressure_of_hardness
from trackroller.damage.rating import contacts_to_limit, static_pressure
from trackroller.errors import InputError
from trackroller.materials import load_database
from trackroller.results.placeholders import guess_cautions, placeholders_part

STEEL = {"like": "1.7225-normalised", "hardness": 220.0, "yield_strength": 480.0}


def line_pressure(force, diameter, width, modulus, poisson):
    """Hertz: p_0 = sqrt(F E* / (pi b R)) of a wheel on a flat rail of the same material [MPa]."""
    return math.sqrt(force * modulus / (2 * (1 - poisson**2)) / (math.pi * width * diameter / 2))


@pytest.mark.parametrize(("hardened", "factor"), [(False, 7 * 220.0), (True, 4.2 * 480.0)])
def test_static_pressure_gives_the_line_contact_force_of_the_standard(hardened, factor):
    """F_Rd,s = factor^2 / gamma_m pi D b (1 - nu^2) / E, as marsDemonstrator computes it."""
    d, b, e, nu = 400.0, 60.0, 210000.0, 0.3
    force = factor**2 / 1.1 * math.pi * d * b * (1 - nu**2) / e
    assert static_pressure(220.0, 480.0, hardened) == pytest.approx(line_pressure(force, d, b, e, nu), rel=1e-12)


@pytest.mark.parametrize(("hardened", "factor"), [(False, 3 * 220.0), (True, 1.8 * 480.0)])
def test_contacts_follow_the_force_of_the_standard(hardened, factor):
    """F_Rd,f = F_u / s_c^(1/m) with m = 10/3 and s_c the contacts over 6.4e6."""
    d, b, e, nu = 400.0, 60.0, 210000.0, 0.3
    for share in (0.01, 1.0, 30.0):
        force = factor**2 * math.pi * d * b * (1 - nu**2) / e / share ** (3 / 10)
        pressure = line_pressure(force, d, b, e, nu)
        assert contacts_to_limit(pressure, 220.0, 480.0, hardened) == pytest.approx(6.4e6 * share, rel=1e-12)


def notes(ds):
    """The notes on the rating; other limits lack values of their own."""
    return [note for note in ds.attrs["limits_notes"].splitlines() if note.startswith("rating: ")]


def test_rating_of_a_roller_uses_its_own_hardness():
    case = tr.Case(motor_force=0, roller_material=STEEL, guide_material="POM", guide_overrollings_per_hour=30)
    ds = tr.solve(case, outputs=("rating", "contact", "limits"), contact_model="sliding")
    used = ds.rating_utilisation_static
    assert used.sel(body="roller").values == pytest.approx(
        ds.max_pressure.values * math.sqrt(1.1) / (7 * 220), rel=1e-14
    )
    assert np.isnan(used.sel(body="guide")).all()
    radius = 21.75 - 6 * math.cos(math.radians(30))
    per_hour = 60.0 * 60e3 / (2 * math.pi * radius)  # 60 m/min
    contacts = contacts_to_limit(ds.max_pressure.values, 220.0, 480.0, False)
    assert ds.rating_life_hours.sel(body="roller").values == pytest.approx(contacts / per_hour, rel=1e-12)
    (note,) = notes(ds)
    assert note.startswith(
        "rating: material 'POM' has no hardness. Enter it in config/materials.yaml under materials.POM"
    )
    assert note.endswith("or in the case: {like: POM, hardness: NUMBER}.")


def test_a_value_that_nobody_measured_is_named_with_its_range():
    case = tr.Case(motor_force=0, guide_overrollings_per_hour=30)
    ds = tr.solve(case, outputs=("rating", "limits"), contact_model="sliding")
    told = "rating: placeholders of material '1.7225-normalised': hardness (expected from 200 to 240 HB)."
    assert notes(ds) == [told]


def test_static_failure_is_the_peak_stress_over_the_tensile_strength():
    ds = tr.solve(tr.Case(motor_force=0), outputs=("peak_stress", "limits"), contact_model="sliding")
    assert ds.utilisation.sel(limit="static").values == pytest.approx(
        ds.peak_stress.max("contact").values / 720, rel=1e-14
    )


def test_a_yield_strength_above_the_tensile_strength_is_refused():
    with pytest.raises(InputError, match=r"yield_strength = 800.*R_m = 720"):
        tr.solve(tr.Case(roller_material=STEEL | {"yield_strength": 800.0}), outputs="rating")


def test_a_hardened_surface_needs_its_yield_strength_instead_of_a_hardness():
    case = {"motor_force": 0, "guide_overrollings_per_hour": 30, "guide_material": STEEL}
    polymer = {"like": "POM", "surface_hardened": 1}
    ds = tr.solve(tr.Case(**case, roller_material=polymer), outputs=("rating", "limits"), contact_model="sliding")
    assert np.isfinite(ds.rating_utilisation_static).all()
    told = "rating: placeholders of material 'inline': yield_strength (expected from 60 to 72 MPa)."
    assert notes(ds) == [told]
    bare = {"name": "new", "like": "POM", "yield_strength": 65.0, "surface_hardened": 0}
    for name, how in ((None, "Add hardness: NUMBER to the material of the case."), ("new", "Enter it in config")):
        ds = tr.solve(
            tr.Case(**case, roller_material=bare | {"name": name}), ("rating", "limits"), contact_model="sliding"
        )
        assert f"material '{name or 'inline'}' has no hardness. {how}" in ds.attrs["limits_notes"]
    with pytest.raises(InputError, match=r"surface_hardened = 0.5 .*0 or 1"):
        tr.solve(tr.Case(**case, roller_material=STEEL | {"surface_hardened": 0.5}), outputs="rating")


def test_placeholders_are_one_warning_for_a_material_and_a_row_for_each_value():
    ds = tr.solve(tr.Case(motor_force=0), outputs=("rating", "shakedown", "limits"), contact_model="sliding")
    part = placeholders_part(ds)
    rows = part.table[part.table["limit"] != ""]
    found = [(row.material, row.limit, row.value, row.low, row.high, row.units) for row in rows.itertuples()]
    line = tuple(float(f"{end:g}") for end in pressure_of_hardness(215.0))
    assert found == [
        ("1.7225-normalised", "pressure line", "rolling_pressure", *line, "MPa"),
        ("1.7225-normalised", "rating", "hardness", 200.0, 240.0, "HB"),
        ("1.7225-normalised", "shakedown", "yield_strength", 400.0, 550.0, "MPa"),
    ]
    (caution,) = guess_cautions(part)
    assert caution.where == (
        "1.7225-normalised: 3 values; pressure line, rating and shakedown rest on them; see its notes"
    )


def test_a_warning_counts_the_guesses_of_a_material_and_the_table_has_its_notes():
    pair = {"roller_material": "PA66-moist", "guide_material": "EN AW-6082-T6"}
    case = tr.Case(**pair, motor_force=0, radial_force=-20, axial_force=2, permissible_wear_depth=0.1)
    part = placeholders_part(tr.solve(case, ("wear", "shakedown", "limits"), contact_model="sliding"))
    database = load_database()
    for material in pair.values():
        values = database.material(material).with_sources()
        rows = (part.table["material"] == material) & (part.table["limit"] == "")
        own = part.table[rows].set_index("value")
        assert own.index.is_unique and {*own[own["guessed"] == "yes"].index} == {*values["guesses"]}
        assert {key: own["note"][key] for key in values["notes"]} == values["notes"]
        assert bool((own["guessed"] == "").any())
    texts = [caution.where for caution in guess_cautions(part)]
    # the S-N line of the alloy has tests behind it, and is no guess
    assert texts == [
        "PA66-moist: 7 values; shakedown and wear rest on them; see its notes",
        "EN AW-6082-T6: 2 values; wear rests on them; see its notes",
    ]
