"""E and R_m of a material at the temperature of its body, as a fixed point."""

import json

import numpy as np
import pytest
from limit_rows import limit_row

import trackroller as tr
from trackroller.errors import InputError
from trackroller.materials import Material, load_database
from trackroller.materials.tables import material_details
from trackroller.results.roller_answer import answer_of_roller
from trackroller.roller import temperature
from trackroller.roller.case import to_table
from trackroller.study.spectrum.file import load_spectrum
from trackroller.study.spectrum.solve import solve_spectrum
from trackroller.study.store.fingerprint import fingerprints

TABLE = {
    "temperature": [20, 40, 60, 80, 100],
    "youngs_modulus": [3000, 2600, 2000, 1500, 1100],
    "tensile_strength": [80, 70, 55, 42, 32],
    "source": "own tests",
}
CASE = {"guide_material": "1.7225-normalised", "friction_coefficient": 0.2, "radial_force": -1500.0, "motor_force": 0.0}
CASE |= {"axial_force": 100.0, "velocity": 120.0, "heat_transfer_coefficient": 15.0, "cooled_area": 8000.0}
OUTPUTS = ("heat", "forces", "contact", "peak_stress", "life")


def pom(**table):
    return {"like": "POM", "temperature_dependence": TABLE | table}


def solve(material, outputs=OUTPUTS, **fields):
    return tr.solve(tr.Case(**CASE | {"roller_material": material} | fields), outputs, contact_model="sliding")


def roller_temperature(ds):
    return 20.0 + float(ds.bulk_temperature_rise.sel(contact=1, body="roller"))


def same_bits(one, other):
    return all(np.array_equal(one[name], other[name], equal_nan=True) for name in other.data_vars if name != "reason")


@pytest.fixture(scope="module")
def warm():
    return solve(pom())


@pytest.fixture(scope="module")
def cold():
    return solve("POM")


def test_fixed_point_is_the_one_found_by_hand(warm, cold):
    """Repeat single solutions with constant values; the strength of the S-N curve follows as well."""
    reached = roller_temperature(cold)
    for _ in range(12):
        values = {
            name: float(np.interp(reached, TABLE["temperature"], TABLE[name]))
            for name in ("youngs_modulus", "tensile_strength")
        }
        by_hand = solve({"like": "POM", **values})
        reached = roller_temperature(by_hand)
    assert reached > 50.0 and roller_temperature(warm) == pytest.approx(reached, abs=1e-3)
    for name in ("max_pressure", "peak_stress", "patch_area", "life_cycles", "flash_temperature_rise"):
        assert warm[name].values == pytest.approx(by_hand[name].values, rel=1e-3, nan_ok=True), name


def test_warm_roller_is_softer(warm, cold):
    assert (warm.max_pressure < 0.9 * cold.max_pressure).all() and (warm.patch_area > 1.1 * cold.patch_area).all()
    slow, fast = (solve(pom(), velocity=v).max_pressure for v in (20.0, 240.0))
    assert (slow > warm.max_pressure).all() and (warm.max_pressure > fast).all()


def test_constant_table_changes_no_bit(cold):
    constant = solve(pom(youngs_modulus=[3000] * 5, tensile_strength=[80] * 5))
    assert same_bits(constant, cold) and "at its bulk temperature" in constant.limits_notes


def test_without_heat_a_table_changes_no_bit():
    outputs = ("forces", "contact", "peak_stress", "life")
    with_table, without = (solve(material, outputs) for material in (pom(), "POM"))
    assert same_bits(with_table, without) and "limits_notes" not in with_table.attrs


def test_alone_and_in_a_batch(warm, cold):
    """A mirrored case, too; a case without a table keeps its bits beside one with a table."""
    fields = [{"roller_material": pom()}, {"roller_material": "POM"}, {"roller_material": pom(), "axial_force": -100.0}]
    batch = tr.solve([tr.Case(**CASE | own) for own in fields], OUTPUTS, contact_model="sliding")
    assert same_bits(batch.isel(case=0), warm) and same_bits(batch.isel(case=1), cold)
    assert np.array_equal(batch.max_pressure[2], batch.max_pressure[0, ::-1])


def test_guide_has_the_ambient_temperature():
    ds = solve("1.7225-normalised", guide_material=pom(), ambient_temperature=40.0)
    by_hand = {"like": "POM", "youngs_modulus": 2600.0, "tensile_strength": 70.0}
    assert ds.max_pressure.values == pytest.approx(
        solve("1.7225-normalised", guide_material=by_hand).max_pressure.values, rel=1e-12
    )


def test_end_of_the_table_is_told(cold):
    ds = solve(pom(), velocity=600.0)
    end = solve({"like": "POM", "youngs_modulus": 1100.0, "tensile_strength": 32.0}, velocity=600.0)
    assert roller_temperature(ds) > 100.0 and ds.max_pressure.values == pytest.approx(end.max_pressure.values)
    assert "leaves its table from 20 to 100 degC" in ds.limits_notes and ds.converged == 1


def test_sheet_names_the_table_among_what_the_data_rest_on(warm):
    words = "temperature: youngs_modulus and tensile_strength of material 'inline' are those at its bulk temperature."
    answer = answer_of_roller(warm)
    assert words in [caution.where for caution in answer.warnings if caution.code == "flagged"]
    assert not any("temperature: " in text for texts in answer.not_checked.values() for text in texts)


def test_unknown_temperature_is_told():
    ds = solve(pom(), cooled_area=None)
    assert "is not known, its table is not used" in ds.limits_notes
    assert np.array_equal(ds.max_pressure, solve("POM", cooled_area=None).max_pressure)


def test_unsettled_case_says_so(monkeypatch):
    monkeypatch.setattr(temperature, "PASSES", 1)
    ds = solve(pom())
    assert ds.converged == 0 and "the temperature still changes" in str(ds.reason.values)


def test_strength_values_keep_their_ratio():
    table = to_table(tr.Case(**CASE | {"roller_material": pom()}))
    hot = temperature.at_temperatures(table, np.array([[60.0, np.nan]])).roller
    for name in ("tensile_strength", "fatigue_limit", "yield_strength", "fatigue_limit_torsion"):
        assert getattr(hot, name) == pytest.approx(55 / 80 * getattr(table.roller, name), rel=1e-14), name
    assert hot.youngs_modulus == 2000.0 and hot.poisson_ratio == table.roller.poisson_ratio


def test_given_value_replaces_its_inherited_column():
    database = load_database()
    base = database.material(pom())
    assert Material(**json.loads(json.dumps(base.as_dict()))) == base and hash(base) != hash(database.material("POM"))
    assert Material(**base.as_dict() | {"temperature_dependence": None}) != base
    rows = {row["field"]: row["value"] for row in material_details(database, base)}
    assert rows["youngs_modulus over temperature"] == "3000, 2600, 2000, 1500, 1100"


def test_like_inherits_the_table(tmp_path):
    path = tmp_path / "materials.yaml"
    path.write_text(json.dumps({"materials": {"warm": pom()}}))
    database = load_database(path)
    assert database.material({"like": "warm", "poisson_ratio": 0.35}).temperature_dependence is not None
    stiff = database.material({"like": "warm", "youngs_modulus": 2500.0}).temperature_dependence
    assert list(stiff.columns) == ["tensile_strength"]
    assert (
        database.material({"like": "warm", "youngs_modulus": 1, "tensile_strength": 60}).temperature_dependence is None
    )


def test_table_is_part_of_the_identity():
    one, other = (
        fingerprints(to_table(tr.Case(**CASE | {"roller_material": material})), {})
        for material in (pom(), pom(temperature=[20, 41, 60, 80, 100]))
    )
    assert one[0] != other[0]


@pytest.mark.parametrize(
    ("table", "field", "words"),
    [
        ([20, 60], "temperature_dependence", "a mapping with the lists"),
        ({"temperature": [20, 60]}, "temperature_dependence", "youngs_modulus or tensile_strength"),
        (TABLE | {"youngs_moduls": [1]}, "temperature_dependence", "youngs_modulus"),
        (TABLE | {"temperature": [20, 60, 40, 80, 100]}, "temperature_dependence.temperature", "rising"),
        (TABLE | {"temperature": [20, 20, 40, 80, 100]}, "temperature_dependence.temperature", "rising"),
        (TABLE | {"temperature": [20, 60]}, "temperature_dependence.youngs_modulus", "each of the 2 temperatures"),
        (TABLE | {"temperature": 20}, "temperature_dependence.temperature", "at least two"),
        (TABLE | {"temperature": [-300, 40, 60, 80, 100]}, "temperature_dependence.temperature", "-273"),
        (TABLE | {"youngs_modulus": [3e9, 2, 1, 1, 1]}, "temperature_dependence.youngs_modulus", "MPa"),
        (TABLE | {"youngs_modulus": [3000, "soft", 1, 1, 1]}, "temperature_dependence.youngs_modulus", "number"),
        (TABLE | {"youngs_modulus": [2900, 2, 1, 1, 1]}, "temperature_dependence.youngs_modulus", "3000"),
        (TABLE | {"placeholder": "yes"}, "temperature_dependence.placeholder", "true or false"),
    ],
)
def test_bad_tables_are_refused_by_name(table, field, words):
    with pytest.raises(InputError) as error:
        load_database().material({"name": "warm", "like": "POM", "temperature_dependence": table})
    assert f"warm.{field}" in str(error.value) and words in str(error.value)


def test_units_of_a_table():
    given = pom(youngs_modulus=["3 GPa", "2.6 GPa", 2000, 1500, 1100], temperature=["293.15 K", 40, 60, 80, 100])
    table = load_database().material(given).temperature_dependence
    assert table.youngs_modulus[:3] == (3000.0, 2600.0, 2000.0) and table.temperature[0] == 20.0


def test_the_sheet_compares_with_the_strength_at_the_temperature_of_the_body(warm):
    strength = np.interp(roller_temperature(warm), TABLE["temperature"], TABLE["tensile_strength"])
    answer = answer_of_roller(warm)
    own = {body: limit_row(answer, "pressure", body)["used_low"] for body in ("roller", "guide")}
    pressure = float(warm.max_pressure.max())
    assert strength < 79.0 and own["roller"] == pytest.approx(pressure / (1.6 * strength), rel=1e-12)
    assert own["guide"] == pytest.approx(pressure / (1.6 * 720), rel=1e-12)


def test_a_spectrum_counts_damage_by_the_strength_at_the_temperature_of_each_block(tmp_path):
    """Each block has the overrollings to failure that its case has alone; without heat those of the cold material."""
    loads = [{"radial_force": -400.0, "velocity": 120.0}, {"radial_force": -200.0, "velocity": 20.0}]
    loads = [load | {"axial_force": 20.0} for load in loads]
    material = pom() | {"scatter_in_cycles": 4.0}
    told = {"name": "warm", "base": {k: v for k, v in CASE.items() if k not in loads[0]}, "contact_model": "sliding"}
    told["base"] |= {"roller_material": material, "guide_overrollings_per_hour": 60.0}
    told["blocks"] = [{"name": f"b{i}", "distance": 1000} | load for i, load in enumerate(loads)]
    for limits, outputs in (({}, OUTPUTS), ({"not_checked": ["heat"]}, OUTPUTS[1:])):
        path = tmp_path / "spectrum.yaml"
        path.write_text(json.dumps(told | limits))
        ds = solve_spectrum(load_spectrum(path))
        alone = [solve(material, outputs, **load) for load in loads]
        for i, one in enumerate(alone):
            assert ds.life_cycles[i].sel(body="roller").values == pytest.approx(
                one.life_cycles.sel(body="roller").values, rel=2e-4
            )  # the last pass changes the temperature by less than its tolerance
        half = ds.life_shifts_at_probability.sel(probability=0.5, body="roller").values
        assert half == pytest.approx(ds.life_shifts.sel(body="roller").values, rel=1e-12)


def test_a_table_is_not_used_where_the_case_lacks_what_heat_needs():
    """By default every limit is asked for; without a heat transfer the material stays as cold as without a table."""
    cold = pom()
    cold.pop("temperature_dependence")
    given = {"radial_force": -20, "axial_force": 1, "motor_force": 0}
    lives = [
        float(tr.solve(tr.Case(**given, roller_material=own), contact_model="sliding").roller_life_hours)
        for own in (pom(), cold)
    ]
    assert np.isfinite(lives).all() and lives[0] == lives[1]
