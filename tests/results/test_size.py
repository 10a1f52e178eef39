"""The least roller of a shelf that is enough, against single sheets and by hand from their numbers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import trackroller as tr
from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.report.sizing import lead_of

HEAD = "name;axis_distance;roller_profile_radius;roller_material;price [EUR]"
ROWS = (
    "soft;19;-6.5;1.7225-normalised;10.8",
    "small;16;-6.4;1.7225-quenched-tempered;12.4",
    "mid;21.75;-6.4;1.7225-quenched-tempered;18.3",
    "same price;27;-6.7;1.7225-quenched-tempered;18.3",
    "no price;34;-6.7;1.7225-quenched-tempered;",
)
CASE = {
    "radial_force": -150,
    "axial_force": 20,
    "motor_force": 0,
    "friction_coefficient": 0.15,
    "guide_overrollings_per_hour": 200,
    "guide_material": "1.7225-quenched-tempered",
    "roller_profile_radius": -7,  # the shelf takes its place
}
QUICK = {"contact_model": "sliding", "accuracy": "preview"}
DUTY = {"duty": {"hours_per_day": 8, "days_per_year": 250}}


@pytest.fixture
def shelf(tmp_path) -> Path:
    """Return the file of a shelf."""
    path = tmp_path / "rollers.csv"
    path.write_text("\n".join([HEAD, *ROWS]) + "\n")
    return path


def alone(row, factor=1.0):
    """Return the result of a row of the shelf as a single sheet, with all forces times a factor."""
    _, axis, groove, material, _ = row.split(";")
    case = CASE | {"axis_distance": axis, "roller_profile_radius": groove, "roller_material": material}
    case |= {name: factor * case[name] for name in ("radial_force", "axial_force", "motor_force")}
    return tr.solve(case, **QUICK)


MATERIALS = """
materials:
  soft steel:
    like: 1.7225-normalised
    scatter_in_cycles: {value: 4, source: test}
  hard steel:
    like: 1.7225-quenched-tempered
    scatter_in_cycles: {value: 4, source: test}
"""


def test_failures_take_the_scatter_of_the_material_or_the_typical_one(shelf, tmp_path, monkeypatch):
    """T_N is N_90/N_10, so that the life at 10 % failures is the median one over its root, if fatigue alone ends it."""
    monkeypatch.chdir(tmp_path)
    unknown = tr.size(CASE | QUICK, shelf, life=2000, failures="10%", least="price")
    low = unknown.table.set_index("roller")["life_hours"]  # by the upper end of the typical scatter
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "materials.yaml").write_text(MATERIALS)
    text = (
        shelf.read_text().replace("1.7225-normalised", "soft steel").replace("1.7225-quenched-tempered", "hard steel")
    )
    shelf.write_text(text)
    case = CASE | QUICK | {"guide_material": "hard steel"}
    median = tr.size(case, shelf, life=2000).table.set_index("roller")
    tenth = tr.size(case, shelf, life=2000, failures="10%", least="price")
    lives = tenth.table.set_index("roller")["life_hours"]
    assert low.to_dict() == pytest.approx((lives * 2.0 / 16.1**0.5).to_dict(), rel=1e-9)
    assert (lives * 2.0).to_dict() == pytest.approx(median["life_hours"].to_dict(), rel=1e-9)
    assert tenth.least != ""


def test_lives_are_those_of_single_sheets_and_the_least_is_found_by_hand(shelf):
    found = tr.size(CASE | QUICK | DUTY, shelf, life="2 years", least="price")
    table = found.table.set_index("roller")
    enough = {}
    for row in ROWS:
        name, *_, price = row.split(";")
        sheet = alone(row)
        life, longest = (sheet[f"pair_life_to_first_limit_hours_{end}"].item() for end in ("low", "high"))
        assert table.loc[name, "life_hours"] == life
        assert table.loc[name, "life_ratio"] == life / 4000.0  # 8 h on 250 days
        if life > 1.4 * 4000.0:  # beyond the told error
            assert table.loc[name, "verdict"] == "enough"
            enough[name] = (float(price or "inf"), -life)
        if longest < 4000.0 / 1.4:
            assert table.loc[name, "verdict"] == "not enough" and "fatigue" in table.loc[name, "excluded_by"]
        if life < 4000.0 / 1.4 and longest > 1.4 * 4000.0:
            assert table.loc[name, "verdict"] == "open"
            assert (
                f"between {life:.4g} and {longest:.4g} h: fatigue in rolling contact" in table.loc[name, "excluded_by"]
            )
    assert found.least == min(enough, key=enough.get)
    assert found.unranked == ("no price",) and found.table["roller"].iloc[len(enough) - 1] == "no price"


def test_equal_prices_rank_by_life_and_the_order_of_rows_changes_nothing(shelf):
    first = tr.size(CASE | QUICK, shelf, life=6000, least="price")
    lives = first.table.set_index("roller")["life_hours"]
    assert first.table["roller"].tolist()[:2] == ["mid", "same price"] and lives["mid"] > lives["same price"]
    shelf.write_text("\n".join([HEAD, *ROWS[::-1]]) + "\n")
    second = tr.size(CASE | QUICK, shelf, life=6000, least="price")
    assert second.table.equals(first.table)


def test_no_limit_is_exceeded_at_the_forces_times_the_safety(shelf):
    found = tr.size(CASE | QUICK, shelf, safety=30).table.set_index("roller")
    for row in ROWS:
        result = alone(row, factor=30.0)
        most = (
            result["utilisation"].drop_sel(limit=["fatigue", "pressure_line"]).max().item()
        )  # they end a life, not at once
        name = row.split(";")[0]
        assert (found.loc[name, "overload"] == "held") == (most <= 1.0)
        assert (found.loc[name, "verdict"] == "enough") == (most <= 1.0)


def test_what_nothing_meets_is_said(shelf):
    found = tr.size(CASE | QUICK, shelf, life=1e14, least="price")
    assert found.least == "" and set(found.table["verdict"]) == {"not enough"}
    assert (found.table["excluded_by"] != "").all()
    all_three = tr.size(WARM, shelf, life=1e7, safety=400, temperature=20.1)
    table = all_three.table.set_index("roller")
    lead = lead_of(all_three)
    coolest = table["temperature_ratio"].idxmax()
    rise = 1 / table["temperature_ratio"].max()
    assert f"{coolest} warms by {rise:.3g} times the permitted rise" in lead
    assert f" at {table['load_ratio'].max():.3g} times the forces" in lead
    assert f"{found.table['life_ratio'].max():.3g} times the required life" in lead_of(found)


def test_a_shelf_of_one_roller_and_a_study_are_sized_too(shelf):
    shelf.write_text(f"{HEAD}\n{ROWS[2]}\n")
    single = tr.size(CASE | QUICK, shelf, life=500, safety=1.2)
    assert single.least == "mid" and single.table["overload"].tolist() == ["held"]
    base = {name: value for name, value in CASE.items() if name != "friction_coefficient"}
    study = {"name": "two", "base": base, "factors": {"friction_coefficient": {"values": [0.15, 0.3]}}}
    worst = tr.size(study | QUICK, shelf, life=500)
    assert worst.table["life_hours"].item() < single.table["life_hours"].item()


@pytest.mark.parametrize(
    ("case", "how", "message"),
    [
        ({}, {}, "a required life, a safety, a temperature or a wear depth"),
        ({}, {"safety": 0.5}, "safety .*a number >= 1"),
        ({}, {"life": "3 years"}, "^life = '3 years' needs a duty"),
        ({}, {"life": "soon"}, "^life = 'soon'"),
        ({}, {"life": -3}, "^life = -3 .*a life above 0"),
        ({}, {"life": 100, "least": "prize"}, "^least = 'prize'.*Did you mean 'price'"),
        ({}, {"safety": 2, "least": "prize"}, "^least = 'prize'.*Did you mean 'price'"),
        ({}, {"life": 100, "failures": "105 %"}, "^failures = '105 %'.*a number in"),
        ({}, {"life": 100, "failures": "inf"}, "^failures = 'inf'.*a number in"),
        ({}, {"safety": 1e300}, "^safety = 1e.300 takes radial_force to -1.5e.302 N.*such as 1.5"),
        ({}, {"wear_depth": 0.1}, "^wear_depth = 0.1 .*required_travel"),
        ({}, {"life": 10, "wear_depth": "0.1 kg"}, "^wear_depth = '0.1 kg'.*converted to mm"),
        ({}, {"temperature": "hot"}, "^temperature = 'hot'.*degC"),
        ({"failure_probability": 2} | CASE | QUICK, {"life": 100}, "^failure_probability = 2"),
        ({"name": "v", "factors": {"radial_force": {"values": [-1, -2]}}}, {"safety": 2}, "forces under base"),
    ],
)
def test_requirements_that_make_no_sense_are_refused(case, how, message, shelf):
    with pytest.raises(InputError, match=message):
        tr.size(case or CASE | QUICK, shelf, **how)


@pytest.mark.parametrize("name", ["verdict", "load_ratio", "excluded_by", "ends"])
def test_a_column_that_the_answer_has_is_refused(name, shelf):
    shelf.write_text(shelf.read_text().replace("price [EUR]", name))
    with pytest.raises(InputError, match=f"column = '{name}'"):
        tr.size(CASE | QUICK, shelf, life=100)
    shelf.write_text(shelf.read_text().replace(name, f"own_{name}"))  # as the message says
    assert f"own_{name}" in tr.size(CASE | QUICK, shelf, life=100).table


def test_a_shelf_elsewhere_is_not_replaced_by_its_namesake_here(shelf, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for missing in ("folder/rollers.csv", "~/rollers.csv", f"{'a' * 300}.csv"):
        with pytest.raises(InputError, match="is no file"):
            tr.size(CASE | QUICK, missing, life=100)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--life", "soon"], "--life = 'soon'"),
        (["--life", "50", "--failures", "2"], "--failures = '2'"),
        (["--life", "50", "--least", "Price"], "--least = 'Price' is not known. Did you mean 'price'"),
        (["--safety", "0.5"], "--safety = '0.5'"),
        ([], "--life is missing"),
    ],
)
def test_the_command_names_its_options(words, message, shelf, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("case.yaml").write_text("\n".join(f"{name}: {value}" for name, value in (CASE | QUICK).items()))
    done = CliRunner().invoke(app, ["size", "case.yaml", "--shelf", "rollers.csv", *words])
    assert isinstance(done.exception, InputError) and str(done.exception).startswith(message)


def test_the_command_writes_studies_that_are_kept(shelf, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("case.yaml").write_text("\n".join(f"{name}: {value}" for name, value in (CASE | QUICK).items()))
    words = ["size", "case.yaml", "--shelf", "rollers.csv", "--life", "2000", "--least", "price", "-q"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0 and "is the least of" in done.output and "no price: no price" in done.output
    assert "all forces may be multiplied by" in done.output
    assert CliRunner().invoke(app, ["verify", "results/size-case-rollers"]).exit_code == 0
    record = json.loads(CliRunner().invoke(app, [*words, "--json"]).stdout)
    assert record["unranked"] == ["no price"] and len(record["rollers"]) == len(ROWS)
    words[words.index("2000")] = "1e7"
    assert CliRunner().invoke(app, words).exit_code == 1


HARD = "1.7225-quenched-tempered"


def test_the_load_ratios_bring_each_limit_of_a_single_sheet_to_100_per_cent(shelf):
    catalogue = {"radial_force": 800, "axial_force": 300, "basic_life": 100}
    case = CASE | QUICK | {"catalogue": catalogue, "motor_force": -10}
    found = tr.size(case, shelf, life=500)
    table = found.ratios.table
    assert set(table) >= {"static", "shakedown", "catalogue", "pressure"} and not {"fatigue", "wear"} & {*table}
    for row in ROWS[:3]:
        name = row.split(";")[0]
        for limit in ("static", "shakedown", "pressure"):
            ratio = table.loc[name, limit]
            loaded = CASE | {"motor_force": -10}
            loaded |= {force: ratio * loaded[force] for force in ("radial_force", "axial_force", "motor_force")}
            _, axis, groove, material, _ = row.split(";")
            loaded |= {"axis_distance": axis, "roller_profile_radius": groove, "roller_material": material}
            result = tr.solve(loaded, **QUICK)
            if limit == "pressure":
                strengths = [tr.load_database().material(one).tensile_strength for one in (material, HARD)]
                used = result["max_pressure"].max().item() / (1.6 * min(strengths))
            else:
                used = result["utilisation"].sel(limit=limit).max().item()
            assert used == pytest.approx(1.0, abs=2e-4)
        # the catalogue by hand: radial force and drive force are perpendicular
        factor = (150**2 + 10**2) ** 0.5 / 800 + 20 / 300
        assert table.loc[name, "catalogue"] == pytest.approx(1.0 / factor, rel=2e-4)
        shown = found.table.set_index("roller").loc[name]
        assert shown["load_ratio"] == table.loc[name].min()
    assert (found.table["load_ratio"] > 0).all()
    assert found.to_dict()["load_ratios"][0].keys() >= {"roller", "static"}


def test_a_safety_alone_gives_the_same_load_ratios_and_the_worst_condition_counts(shelf):
    by_life = tr.size(CASE | QUICK, shelf, life=500).ratios.table
    by_safety = tr.size(CASE | QUICK, shelf, safety=2).ratios.table
    assert (by_safety / by_life - 1).abs().max().max() < 5e-4
    base = {name: value for name, value in CASE.items() if name != "friction_coefficient"}
    study = {"name": "two", "base": base, "factors": {"friction_coefficient": {"values": [0.05, 0.15]}}}
    both = tr.size(study | QUICK, shelf, life=500).ratios.table
    assert (both["shakedown"] <= by_life["shakedown"] * 1.0002).all()


def test_a_pressure_beyond_the_safety_excludes_a_roller(shelf):
    found = tr.size(CASE | QUICK, shelf, safety=22).table.set_index("roller")  # pressure of small at 20.5
    assert found.loc["small", "verdict"] == "not enough"
    assert "pressure of the roller" in found.loc["small", "excluded_by"]
    assert found.loc["mid", "verdict"] == "enough"


def test_forty_rollers_equal_forty_single_sheets_bit_for_bit(tmp_path):
    rows = [f"R{i};{16 + 0.6 * i:.1f};{-6.4 - 0.02 * (i % 7):.2f};{HARD};{i}" for i in range(40)]
    path = tmp_path / "rollers.csv"
    path.write_text("\n".join([HEAD, *rows]) + "\n")
    table = tr.size(CASE | QUICK, path, life=1).table.set_index("roller")
    for row in rows:
        life = alone(row)["pair_life_to_first_limit_hours_low"].item()
        assert table.loc[row.split(";")[0], "life_hours"] == life


def test_the_bearing_ends_a_roller_after_its_life_by_hand(tmp_path):
    """C = 3000 N and P = 500 N a row: (C/P)^3 million turns, times 2^-0.9; the distance drops moments."""
    head = "name;axis_distance;roller_profile_radius;roller_material;bearing_rows;bearing_row_distance;bearing_kind"
    head += ";bearing_dynamic_rating;bearing_static_rating;bearing_e;bearing_X;bearing_Y;bearing_X0;bearing_Y0"
    path = tmp_path / "rollers.csv"
    path.write_text(f"{head}\nA;30;-6.4;{HARD};2;1000000;ball;3000;1500;0.3;0.56;1.5;0.6;0.5\n")
    case = CASE | QUICK | {"radial_force": -1000, "axial_force": 0, "motor_force": 0, "failure_probability": 0.1}
    found = tr.size(case, path, life=100)
    radius = 30 - 6 * (3**0.5) / 2
    turns = (3000 / 500) ** 3 * 2**-0.9 * 1e6
    bearing = found.results.data["life_hours_by_limit"].sel(limit="bearing", body="roller").max().item()
    assert bearing == pytest.approx(turns * 2 * 3.141592653589793 * radius / 1e3 / (60 * 60), rel=1e-4)


def test_a_catalogue_that_misses_the_life_is_said(tmp_path):
    """By fatigue the roller lasts; the maker's catalogue allows a fiftieth of the required life."""
    path = tmp_path / "rated.csv"
    head = "name;axis_distance;roller_profile_radius;catalogue_radial_force [N];catalogue_axial_force [N]"
    rows = ["small;20;-6.3;260;80", "large;20;-6.3;2600;800"]
    path.write_text("\n".join([f"{head};catalogue_basic_life [km]", *(f"{row};100" for row in rows)]) + "\n")
    case = {name: value for name, value in CASE.items() if name != "roller_profile_radius"}
    case |= {"roller_material": "1.7225-quenched-tempered", "velocity": 30, "guide_overrollings_per_hour": 1}
    sizing = tr.size(case | QUICK, path, life=1500)
    table = sizing.table.set_index("roller")
    hours = {}
    for name, radial, axial in (("small", 260, 80), ("large", 2600, 800)):
        load = 150 / radial + 20 / axial
        hours[name] = 100 / (0.03 + 0.97 * load) ** 2 / (30 * 60 / 1000)  # the law `dry`, km over km/h
    assert (table["life_hours"] > 1500).all(), "by fatigue both last"
    assert hours["small"] < 1500 < hours["large"]
    assert table.loc["small", "second_model"] == f"catalogue misses the life: {hours['small']:.3g} h"
    assert table.loc["large", "second_model"] == ""
    said = lead_of(sizing)
    assert ("but the catalogue misses" in said) == (sizing.least == "small")


WARM = CASE | QUICK | {"heat_transfer_coefficient": 20, "cooled_area": 8000}


def test_a_temperature_alone_is_a_requirement_by_the_rise_of_single_sheets(shelf):
    found = tr.size(WARM, shelf, temperature="26 degC").table.set_index("roller")
    for row in ROWS:
        name, axis, groove, material, _ = row.split(";")
        case = WARM | {"axis_distance": axis, "roller_profile_radius": groove, "roller_material": material}
        options = {key: case.pop(key) for key in QUICK}
        ds = tr.solve(case, ("heat",), **options)
        rise = (ds["flash_temperature_rise"] + ds["bulk_temperature_rise"]).max().item()
        assert found.loc[name, "temperature_ratio"] == pytest.approx(6.0 / rise, rel=1e-12)
        assert (found.loc[name, "verdict"] == "enough") == (rise <= 6.0)
    assert "life_hours" not in found and set(found["verdict"]) == {"enough"}
    hot = tr.size(WARM, shelf, temperature=20.1)
    assert hot.least == "" and hot.table["excluded_by"].str.startswith("heat of the").all()


def test_an_unknown_temperature_is_open_and_the_message_names_what_to_give(shelf):
    bare = {name: value for name, value in WARM.items() if name != "cooled_area"}
    found = tr.size(bare, shelf, temperature=60).table
    assert set(found["verdict"]) == {"open"} and found["temperature_ratio"].isna().all()
    assert found["excluded_by"].str.contains("temperature is not known: the case gives no cooled_area").all()
    assert set(tr.size(bare | {"cooled_area": 8000}, shelf, temperature=60).table["verdict"]) == {"enough"}


def test_a_wear_depth_ends_the_life_of_single_sheets_and_is_open_by_its_coefficient(shelf):
    found = tr.size(CASE | QUICK, shelf, life=10, wear_depth="0.05 mm").table.set_index("roller")
    for row in ROWS:
        name, axis, groove, material, _ = row.split(";")
        case = CASE | {"axis_distance": axis, "roller_profile_radius": groove, "roller_material": material}
        ds = tr.solve(case | {"permissible_wear_depth": 0.05}, **QUICK)
        wear = ds["life_hours_by_limit_low"].sel(limit="wear").min().item()
        assert found.loc[name, "wear_ratio"] == wear / 10
        if wear < 10 < ds["life_hours_by_limit_high"].sel(limit="wear").min().item():
            assert found.loc[name, "verdict"] == "open"
            assert f"wear_coefficient of {material} (" in found.loc[name, "excluded_by"]
    assert "open" in set(found["verdict"])
    by_travel = tr.size(CASE | QUICK | {"required_travel": "36 km"}, shelf, wear_depth=0.05).table
    assert by_travel.set_index("roller")["wear_ratio"].to_dict() == pytest.approx(found["wear_ratio"].to_dict())


def test_a_column_of_the_shelf_and_the_requirement_do_not_both_permit(shelf):
    shelf.write_text(shelf.read_text().replace("price [EUR]", "permissible_wear_depth [mm]"))
    shelf.write_text("\n".join(line for line in shelf.read_text().splitlines() if "no price" not in line) + "\n")
    with pytest.raises(InputError, match="remove the column permissible_wear_depth of the shelf"):
        tr.size(CASE | QUICK, shelf, life=10, wear_depth=0.05)


def test_what_the_file_requires_counts_too(shelf):
    case = CASE | QUICK | {"requirement": {"peak_stress_roller": {"max": "400 MPa"}}}
    found = tr.size(case, shelf).table.set_index("roller")
    for row in ROWS:
        stress = alone(row)["peak_stress"].sel(body="roller").max().item()
        own = found.loc[row.split(";")[0]]
        assert own["peak_stress_roller"] == stress and own["peak_stress_roller_ratio"] == 400 / stress
        if abs(stress / 400 - 1) > 0.05:  # beyond the told error
            assert (own["verdict"] == "enough") == (stress < 400)
    assert set(found["verdict"]) == {"enough", "not enough"}


def test_a_condition_in_which_every_roller_lifts_off_excludes_all(shelf):
    base = {name: value for name, value in CASE.items() if name != "radial_force"}
    study = {"name": "two", "base": base, "factors": {"radial_force": {"values": [-150, -3]}}}
    found = tr.size(study | QUICK, shelf, life=1)
    assert found.least == "" and found.table["excluded_by"].str.contains("lifts off in 1 of 2 conditions").all()


def test_without_a_price_the_larger_load_ratio_leads_and_names_break_ties(shelf):
    twin = "twin;19;-6.5;1.7225-normalised;10.8"  # a second row like the first one
    for rows in ((*ROWS, twin), (twin, *ROWS[::-1])):
        shelf.write_text("\n".join([HEAD, *rows]) + "\n")
        table = tr.size(CASE | QUICK, shelf, safety=1.1).table
        assert (table["load_ratio"].diff().dropna() <= 0).all() and table["roller"].tolist()[-2:] == ["soft", "twin"]
