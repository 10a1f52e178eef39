"""The material database: published values, the user's file over it, bad input, and safe editing."""

import dataclasses
import os
import pickle
from pathlib import Path

import numpy as np
import pytest
import yaml
from command_line import trackroller
from hypothesis import given
from hypothesis import strategies as st
from reference_cases import solve_sliding

from trackroller.damage.sn_curve import SNCurve
from trackroller.errors import InputError
from trackroller.materials import (
    Material,
    add_material,
    builtin_database,
    load_database,
)
from trackroller.materials.file import BUILTIN_FILE, MATERIALS, build_database
from trackroller.materials.properties import MARKS, OF_LIMITS, REQUIRED
from trackroller.materials.tables import friction_rows, material_details, material_rows
from trackroller.roller.case import Case, to_table

ROOT = Path(__file__).parents[2]
BARS = tuple(f"42CrMo4+QT-{diameter}" for diameter in (16, 40, 100, 160, 250))  # largest diameter [mm]
PUBLISHED = {  # E, nu, R_m, sigma_D/R_m, N_Rm, N_k
    "1.7225-normalised": (210000, 0.33, 720, 0.5, 1e4, 5e6),
    "1.7225-quenched-tempered": (210000, 0.33, 1200, 0.5, 1e4, 5e6),
    "EN AW-7075": (70000, 0.33, 540, 0.5, 1e4, 5e6),
    "PA6": (5000, 0.30, 60, 0.3, 1e4, 5e6),
    "POM": (3000, 0.30, 80, 0.4, 1e4, 5e6),
}
FRICTION = {  # typical, upper, lower and which of them have no source
    ("metal", "metal"): (0.19, 0.30, 0.16, ()),
    ("metal", "PA6"): (0.22, 0.30, 0.10, ()),
    ("metal", "POM"): (0.14, 0.30, 0.06, ("upper",)),
    ("PA6", "PA6"): (0.20, 0.30, 0.10, ("typical", "upper", "lower")),
    ("PA6", "POM"): (0.20, 0.30, 0.10, ("typical", "upper", "lower")),
    ("POM", "POM"): (0.20, 0.30, 0.06, ("typical", "upper", "lower")),
}
STEEL = {
    "family": "metal",
    "youngs_modulus": 206e3,
    "poisson_ratio": 0.3,
    "tensile_strength": 900,
    "fatigue_strength_ratio": 0.45,
    "cycles_at_tensile_strength": 1e3,
    "cycles_at_fatigue_limit": 2e6,
}


@pytest.fixture
def db():
    return builtin_database()


@pytest.fixture
def user(tmp_path, monkeypatch):
    """Write a user's file and return its path; no file of the machine is read."""
    monkeypatch.delenv(MATERIALS, raising=False)
    monkeypatch.chdir(tmp_path)

    def write(text):
        path = tmp_path / "own.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


# ---------------------------------------------------------------- built-in values


def test_published_materials_are_all_there_with_their_values(db):
    assert db.names()[: len(PUBLISHED)] == tuple(PUBLISHED)
    for name, values in PUBLISHED.items():
        m = db.material(name)
        assert (
            m.youngs_modulus,
            m.poisson_ratio,
            m.tensile_strength,
            m.fatigue_strength_ratio,
            m.cycles_at_tensile_strength,
            m.cycles_at_fatigue_limit,
        ) == values
    assert db.material("POM").fatigue_limit == pytest.approx(32.0)


@pytest.mark.parametrize("pair", FRICTION)
def test_published_friction_in_either_order_with_its_placeholders(db, pair):
    *values, guesses = FRICTION[pair]
    for level, value in zip(("typical", "upper", "lower"), values, strict=True):
        there, back = db.friction(*pair, level=level), db.friction(*reversed(pair), level=level)
        assert there == back and there.value == value
        assert there.placeholder == (level in guesses)


def test_sources_are_those_published(db):
    assert "Popov" in db.friction("metal", "metal").source
    assert "schweizer-fn" in db.friction("metal", "metal", "upper").source
    assert "Triboplast" in db.friction("metal", "POM", "lower").source


def test_bars_by_diameter_have_the_values_of_the_standard(db):
    rows = [(db.material(name).tensile_strength, db.material(name).yield_strength) for name in BARS]
    assert rows == [(1100, 900), (1000, 750), (900, 650), (800, 550), (750, 500)]
    for name in BARS:
        own = db.material(name)
        assert own.records["tensile_strength"].range[0] == own.tensile_strength
        assert own.hardness == pytest.approx(own.tensile_strength / 3.33, rel=0.01)
        assert own.youngs_modulus == db.material("1.7225-quenched-tempered").youngs_modulus
        assert "measure" in own.records["cycles_at_tensile_strength"].note


def test_published_fatigue_strengths_are_those_of_their_tests(db):
    limits = {
        "C45": 316,
        "1.4301-annealed": 240,
        "EN AW-7075-T651": 159,
        "PA6-dry": 19,
        "PA66-dry": 35,
        "PA66-moist": 21,
        "POM-C": 5,
    }
    for name, limit in limits.items():
        own = db.material(name)
        assert own.fatigue_limit == pytest.approx(limit) and "fatigue_strength_ratio" not in own.placeholders
    tests = [(224, 52990), (190, 159000), (188, 197275), (180, 244403), (162, 421560), (165, 437636), (145, 1060730)]
    stress, cycles = np.log([*tests, (145, 1235690)]).T
    slope, _ = np.polyfit(stress, cycles, 1)
    alloy = db.material("EN AW-6082-T6")
    assert alloy.woehler_exponent == pytest.approx(-slope, rel=1e-3)
    assert np.allclose(np.log(SNCurve.of(alloy).life_cycles(np.exp(stress))), cycles, atol=0.3)
    assert SNCurve.of(db.material("PA66-dry")).life_cycles(40.7) == pytest.approx(1e5)


def test_friction_is_dry_or_lubricated_where_tables_say_so(db):
    typical, dry, lubricated = (
        db.friction("42CrMo4+QT-40", "C45", level) for level in ("typical", "dry", "lubricated")
    )
    assert lubricated.value < typical.value < dry.range[0] and dry.range == (0.45, 0.8)
    discs = [0.473, 0.454, 0.454, 0.454, 0.504]  # twin discs at 3 to 20 % slip: heat over load and sliding speed
    assert (
        dry.range[0] <= min(discs)
        and max(discs) <= dry.range[1]
        and dry.value == pytest.approx(np.mean(discs), abs=0.05)
    )
    assert "say dry or lubricated" in typical.note
    assert "say dry or lubricated" in db.friction_record("C45", "C45", None)["note"]
    with pytest.raises(InputError, match="has no dry value"):
        db.friction("PU", "C45", "dry")


@pytest.mark.parametrize("body", ["POM-C", "PA6-dry", "PA66-moist", "PU"])
def test_wear_of_a_plastic_on_steel_asks_for_a_measurement(db, body):
    guess = db.on(body, "42CrMo4+QT-100").guesses_of_limits["wear_coefficient"]
    assert guess.note == "on 42CrMo4+QT-100, measure" and guess.range is not None


@pytest.mark.parametrize(("body", "rates"), [("POM-H", (2.5e-7, 7.5e-7)), ("PA66-dry", (2.5e-7, 1.3e-6))])
def test_wear_of_plastics_on_steel_holds_the_standard_test(db, body, rates):
    """Depths an hour [m/h] at 0.0875 MPa m/s, which is 315 MPa m an hour: k is the depth over pressure and travel."""
    record = db.on(body, "C45").records["wear_coefficient"]
    measured = [1e3 * rate / (0.0875 * 3600) for rate in rates]  # mm over MPa m is mm3/(N m)
    assert record.range[0] <= measured[0] and measured[1] <= record.range[1]
    assert measured[0] <= record.value <= measured[1] * 1.01
    assert record.source.startswith("ASTM D3702") and record.placeholder and record.mark == "derived"


def test_every_builtin_material_solves(db):
    case = {"guide_material": "42CrMo4+QT-40", "radial_force": -20, "axial_force": 0, "motor_force": 0}
    cases = [Case(**case, roller_material=name, friction_coefficient="typical") for name in db.names()]
    ds = solve_sliding(cases, outputs=("peak_stress", "life"), database=db)
    assert ds.converged.all() and (ds.roller_life_hours > 0).all()


def test_every_builtin_value_has_unit_source_and_mark():
    """Nothing in the built-in file stands without unit, source and an explicit placeholder mark."""
    data = yaml.safe_load(BUILTIN_FILE.read_text(encoding="utf-8"))
    tables = [m.pop("energy_wear") for m in data["materials"].values() if "energy_wear" in m]
    assert tables and all({"source", "placeholder"} <= set(table) for table in tables)
    values = [v for m in data["materials"].values() for v in m.values() if isinstance(v, dict)]
    values += [v for entry in data["friction"] for key, v in entry.items() if key != "pair"]
    published = [m for name, m in data["materials"].items() if name in PUBLISHED]
    assert len([name for m in published for name in m if name in REQUIRED]) == 5 * 6
    assert len(data["friction"]) == 12
    for value in values:
        assert {"value", "unit", "source", "placeholder"} <= set(value)
        assert value["placeholder"] in (True, False)
        # a guess has no source, or a note that says what was measured instead
        has_source = "no source named" not in value["source"]
        assert has_source or value["placeholder"]
        assert not (has_source and value["placeholder"]) or value["note"]
    for material in data["materials"].values():
        for name in filter(material.__contains__, OF_LIMITS):
            low, high = material[name].get("range", (0, 1))
            assert low < high and ("range" in material[name] or name in ("rolling_cycles", "rolling_exponent"))


def test_every_builtin_value_says_how_it_was_taken_from_its_source(db):
    records = [record for name in db.names() for record in db.material(name).records.values()]
    records += [record for levels in db.friction_table.values() for record in levels.values()]
    records += [record for classes in db.wear_table.values() for record in classes.values()]
    assert len(records) > 400
    for record in records:
        assert record.mark in MARKS, record
        assert (record.mark == "guess") == ("no source named" in record.source), record
        assert record.mark != "guess" or record.placeholder
        if "second hand" in record.source:
            assert record.mark == "second hand", record
    sources = yaml.safe_load(BUILTIN_FILE.read_text(encoding="utf-8"))
    marked = [name for names in sources["marks"].values() for name in names]
    assert sorted(marked) == sorted(sources["sources"])  # each source once
    guesses = [record for record in records if record.placeholder]
    assert len(guesses) < 0.65 * len(records)
    rows = {row["field"]: row["mark"] for row in material_details(db, "C45")}
    assert (rows["youngs_modulus"], rows["fatigue_limit_torsion"], rows["rolling_pressure"]) == (
        "table",
        "guess",
        "formula",
    )


def test_a_mark_of_a_user_is_checked(user):
    text = "sources: {own: tests of March}\nmarks: {table: [own]}\n"
    own = load_database(user(text + "materials: {POM: {youngs_modulus: {value: 2900, source: own}}}"))
    assert own.material("POM").records["youngs_modulus"].mark == "table"
    for wrong, message in (
        ("marks: {printed: [own]}", "'printed' is not known"),
        ("marks: {table: [other]}", "'other' is not known"),
        ("marks: {table: own}", "a list of names of sources"),
        ("materials: {POM: {youngs_modulus: {value: 2900, mark: printed}}}", "'printed' is not known"),
    ):
        with pytest.raises(InputError, match=message):
            load_database(user("sources: {own: tests of March}\n" + wrong))


def test_friction_by_material_material_object_and_family(db):
    steel, pa6 = db.material("EN AW-7075"), db.material("PA6")
    assert db.friction(steel, pa6) == db.friction("1.7225-normalised", "PA6") == db.friction("Metal", "pa6")


def test_case_without_friction_takes_it_from_the_pair(db):
    cases = [{"friction_coefficient": level, "guide_material": "POM"} for level in (None, "upper", "lower", 0.07)]
    assert to_table(cases, db).friction_coefficient.tolist() == [0.14, 0.30, 0.06, 0.07]


def test_materials_survive_the_way_to_another_process(db):
    again = pickle.loads(pickle.dumps(db))
    assert again == db and again.material("PA6").records == db.material("PA6").records


# ---------------------------------------------------------------- the user's file


def test_user_file_changes_single_values_and_adds_materials(user, db):
    own = load_database(
        user("""
        materials:
          PA6:
            youngs_modulus: {value: 2.8, unit: GPa, source: data sheet 12, placeholder: true}
          "1.4301":
            family: metal
            youngs_modulus: 200000
            poisson_ratio: 0.3
            tensile_strength: 5.4e2
            fatigue_strength_ratio: 0.45
            cycles_at_tensile_strength: 1e4
            cycles_at_fatigue_limit: 5e6
            scatter_in_cycles: 4
        """)
    )
    pa6 = own.material("PA6")
    assert pa6.youngs_modulus == pytest.approx(2800) and pa6.tensile_strength == 60 and pa6.family == "PA6"
    assert pa6.placeholders == ("youngs_modulus",)
    assert pa6.records["youngs_modulus"].source == "data sheet 12"
    assert pa6.records["youngs_modulus"].origin == "own.yaml"
    assert pa6.records["tensile_strength"].origin == "built-in"
    assert own.names() == (*db.names(), "1.4301")
    assert own.material("1.4301").cycles_at_fatigue_limit == 5e6
    assert own.material("1.4301").scatter_in_cycles == 4
    assert own.friction("1.4301", "PA6").value == 0.22
    assert builtin_database().material("PA6").youngs_modulus == 5000, "the built-in one must stay"


def test_like_takes_the_rest_from_another_material(user):
    own = load_database(user("materials: {rail: {like: 1.7225-quenched-tempered, tensile_strength: 1400}}"))
    rail = own.material("rail")
    assert (rail.tensile_strength, rail.youngs_modulus, rail.family) == (1400, 210000, "metal")
    assert rail.fatigue_limit == 700


def test_user_friction_single_level_new_pair_and_pair_of_materials(user):
    """A changed level leaves the other levels; a pair that names a material stands over its family's."""
    own = load_database(
        user("""
        friction:
          - {pair: [PA6, metal], typical: {value: 0.18, source: own tests}}
          - {pair: [metal, PEEK], typical: 0.2}
          - {pair: [EN AW-7075, PA6], typical: 0.25}
        """)
    )
    assert own.friction("metal", "PA6").value == 0.18 and own.friction("metal", "PA6").source == "own tests"
    assert own.friction("metal", "PA6", "upper").value == 0.30
    assert own.friction("PEEK", "metal").value == 0.2
    assert own.friction("PA6", "EN AW-7075").value == 0.25
    assert own.friction("PA6", "EN AW-7075", "lower").value == 0.10


def test_user_file_is_found_by_argument_variable_and_folder(user, tmp_path, monkeypatch):
    """The argument overrides the environment variable, which overrides config/materials.yaml."""

    def strength():
        return load_database().material("POM").tensile_strength

    def file(name, value):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(f"materials: {{POM: {{tensile_strength: {value}}}}}")
        return path

    user("")
    assert strength() == 80
    file("config/materials.yaml", 81)
    assert strength() == 81
    monkeypatch.setenv(MATERIALS, str(file("variable.yaml", 82)))
    assert strength() == 82
    assert load_database(file("argument.yaml", 83)).material("POM").tensile_strength == 83


def test_a_changed_file_is_read_again(user):
    path = user("materials: {POM: {tensile_strength: 81}}")
    assert load_database(path).material("POM").tensile_strength == 81
    user("materials: {POM: {tensile_strength: 82.5}}")
    assert load_database(path).material("POM").tensile_strength == 82.5


@pytest.mark.parametrize("text", ["", "# nothing but a remark\n", "materials:\nfriction:\nsources:\n"])
def test_an_empty_user_file_changes_nothing(user, db, text):
    own = load_database(user(text))
    assert own.materials == db.materials and own.friction_table == db.friction_table


def test_example_file_changes_nothing_and_its_example_works(db):
    """The file delivered in config/ overrides nothing; what it shows in comments is valid as it stands."""
    text = (ROOT / "config" / "materials.yaml").read_text(encoding="utf-8")
    assert yaml.safe_load(text) is None
    example = text[text.index("# materials:\n") :].splitlines()
    own = build_database("\n".join(line[2:] for line in example), "example", over=db)
    assert own.material("1.4301").youngs_modulus == 200000
    assert own.material("hardened rail").tensile_strength == 1400
    assert own.friction("metal", "PEEK", "lower").value == 0.12


# ---------------------------------------------------------------- inline materials


def test_inline_material_of_a_case(db):
    material = db.material({"name": "tested steel", **STEEL})
    assert material.name == "tested steel" and material.fatigue_limit == pytest.approx(405)
    table = to_table([Case(roller_material=STEEL), Case(roller_material={"like": "PA6", "poisson_ratio": 0.4})], db)
    assert table.roller.youngs_modulus.tolist() == [206e3, 5000]
    assert table.roller.poisson_ratio.tolist() == [0.3, 0.4]


def test_inline_material_takes_nothing_unasked_from_a_namesake(db):
    with pytest.raises(InputError, match="lacks poisson_ratio"):
        db.material({"name": "PA6", "youngs_modulus": 3000})
    assert db.material({"name": "PA6", "like": "PA6", "youngs_modulus": 3000}).tensile_strength == 60


def test_material_as_dict_makes_the_same_material_inline(db):
    pa6 = db.material("PA6")
    assert db.material(pa6.as_dict()) == pa6


def test_unknown_family_says_how_to_give_the_friction(db):
    peek = db.material({**STEEL, "family": "PEEK"})
    with pytest.raises(InputError) as caught:
        db.friction(peek, "PA6")
    text = str(caught.value)
    assert "PEEK" in text and "friction_coefficient" in text and "friction:" in text
    table = to_table([Case(roller_material={**STEEL, "family": "PEEK"}, friction_coefficient=0.2)], db)
    assert table.friction_coefficient[0] == 0.2


# ---------------------------------------------------------------- bad input

BAD_VALUES = [
    ("youngs_modulus", -1),
    ("youngs_modulus", 0),
    ("youngs_modulus", 210e9),
    ("youngs_modulus", "stiff"),
    ("youngs_modulus", True),
    ("youngs_modulus", float("nan")),
    ("youngs_modulus", None),
    ("poisson_ratio", 0.51),
    ("poisson_ratio", -0.1),
    ("tensile_strength", 0),
    ("tensile_strength", float("inf")),
    ("fatigue_strength_ratio", 0),
    ("fatigue_strength_ratio", 1),
    ("fatigue_strength_ratio", 360),
    ("cycles_at_tensile_strength", 0),
    ("cycles_at_tensile_strength", 2e6),
    ("cycles_at_fatigue_limit", 999),
    ("scatter_in_cycles", 0.25),
    ("scatter_in_stress", 0.9),
]


@pytest.mark.parametrize(("field", "value"), BAD_VALUES)
def test_impossible_values_are_refused_by_name_wherever_they_stand(user, db, field, value):
    """In a file the message names file, material, field and value; directly and inline all but the file."""
    values = STEEL | {field: value}
    path = user(yaml.safe_dump({"materials": {"odd": values}}))
    with pytest.raises(InputError) as caught:
        load_database(path)
    text = str(caught.value)
    named = "cycles_at" if field.startswith("cycles_at") else field
    assert "own.yaml" in text and "odd" in text and named in text
    if value is not None and field != "cycles_at_fatigue_limit":
        assert repr(value) in text or repr(float(value)) in text
    with pytest.raises(InputError, match=named):
        Material(name="odd", **values)
    if value is not None:
        with pytest.raises(InputError, match=named):
            db.material(values)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("materials: [PA6]", ("own.yaml", "materials", "mapping")),
        ("materials: {PA6: 3}", ("PA6", "3", "mapping")),
        ("materials: {PA6: {youngsmodulus: 3}}", ("PA6", "youngsmodulus", "youngs_modulus")),
        ("materials: {PA6: {youngs_modulus: {value: 3, unti: MPa}}}", ("unti", "'unit'")),
        ("materials: {PA6: {youngs_modulus: {value: 3, source: a, b}}}", ("'b'", "comma")),
        ("materials: {PA6: {youngs_modulus: {unit: MPa}}}", ("PA6", "youngs_modulus", "value")),
        ("materials: {PA6: {youngs_modulus: {value: 3, unit: kg}}}", ("kg", "MPa")),
        (
            "materials: {PA6: {youngs_modulus: {value: 3, placeholder: maybe}}}",
            ("placeholder", "maybe", "true or false"),
        ),
        ("materials: {PA6: {family: 6}}", ("family", "6", "quotes")),
        ("materials: {1.4301: {like: PA6}}", ("1.4301", "quotes")),
        ("materials: {rail: {like: PA7}}", ("like", "PA7", "'PA6'")),
        ("materials: {rail: {youngs_modulus: 3}}", ("rail", "lacks", "poisson_ratio", "like")),
        ("material: {}", ("section", "material", "'materials'")),
        ("materials: {PA6: {poisson_ratio: 0.3}, PA6: {poisson_ratio: 0.4}}", ("PA6", "twice", "line 1")),
        ("friction: {metal: 0.2}", ("friction", "list")),
        ("friction: [{pair: [metal], typical: 0.2}]", ("pair", "two")),
        ("friction: [{pair: [metal, PEEK]}]", ("metal-PEEK", "typical")),
        ("friction: [{pair: [metal, PEEK], mean: 0.2}]", ("metal-PEEK", "mean", "typical")),
        ("friction: [{pair: [metal, PEEK], typical: -0.2}]", ("metal-PEEK", "typical", "-0.2")),
        ("- a\n- b", ("own.yaml", "mapping")),
        ("materials: {PA6: [", ("own.yaml", "YAML", "line")),
        ("materials: !!python/object/apply:os.getcwd []", ("own.yaml", "YAML")),
        ("materials: {PA6: {description: 030}}", ("own.yaml", "ambiguous", "030")),
        ("materials: &a {PA6: *a}", ("own.yaml", "itself")),
        ("materials: " + "[" * 5000, ("own.yaml", "YAML")),
    ],
)
def test_a_bad_file_is_refused_with_file_field_and_remedy(user, text, parts):
    path = user(text)
    with pytest.raises(InputError) as caught:
        load_database(path)
    message = str(caught.value)
    assert all(part in message for part in parts), message


def test_a_missing_file_is_named(user, monkeypatch):
    with pytest.raises(InputError, match=r"nowhere\.yaml"):
        load_database("nowhere.yaml")
    monkeypatch.setenv(MATERIALS, "gone.yaml")
    with pytest.raises(InputError, match=f"{MATERIALS}.*gone.yaml"):
        load_database()


@pytest.mark.parametrize(
    ("call", "parts"),
    [
        (lambda db: db.material("PA 6"), ("'PA 6'", "Did you mean 'PA6'")),
        (lambda db: db.material(6), ("material", "quotes")),
        (lambda db: db.friction("PA6", "metall"), ("metall", "'metal'")),
        (lambda db: db.friction("PA6", "POM", "mean"), ("mean", "typical")),
    ],
)
def test_unknown_names_are_refused_with_the_nearest_right_one(db, call, parts):
    with pytest.raises(InputError) as caught:
        call(db)
    assert all(part in str(caught.value) for part in parts)


# ---------------------------------------------------------------- editing the user's file

COMMENTED = """\
# top remark

materials:
  # about the next
  PA6:
    youngs_modulus: 2800   # dry
    # between
    poisson_ratio: 0.39
  "1.4301":
    like: '1.7225-normalised'

# before friction
friction:
  - pair: [metal, PEEK]   # tested
    typical: 0.2
# end
"""


def comments(text):
    return [line.partition("#")[2].strip() for line in text.splitlines() if "#" in line]


@pytest.mark.parametrize(
    "text",
    [
        COMMENTED,
        "",
        "# only a remark\n",
        "# no newline at the end",
        "materials: {}   # empty\n# end\n",
        "# a\nmaterials:\n# b\n",
        "# a\nmaterials:   # c\n  # b\n\nfriction:\n  - {pair: [metal, PEEK], typical: 0.2}\n",
        "friction: # x\n  - pair: [metal, PEEK]\n    typical: 0.2  # y\n",
    ],
)
def test_adding_keeps_comments_and_everything_else(user, text):
    path = user(text)
    before = yaml.safe_load(text) or {}
    material = add_material(path, "new steel", description="for the test", source="test 7", **STEEL)
    after_text = path.read_text(encoding="utf-8")
    after = yaml.safe_load(after_text)
    assert sorted(comments(text)) == sorted(comments(after_text))
    entry = after["materials"].pop("new steel")
    assert after["materials"] == (before.get("materials") or {})
    assert after.get("friction") == before.get("friction")
    assert entry["youngs_modulus"] == {
        "value": 206000,
        "unit": "MPa",
        "source": "test 7",
        "placeholder": False,
    }
    assert load_database(path).material("new steel") == material
    assert material.tensile_strength == 900 and material.family == "metal"


def test_adding_leaves_the_other_lines_as_they_are(user):
    """Quotes, order and layout of the user's own lines do not change."""
    path = user(COMMENTED)
    add_material(path, "new", like="PA6", tensile_strength=70)
    lines = path.read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if line in COMMENTED.splitlines()]
    assert kept == COMMENTED.splitlines()


def test_adding_to_the_delivered_file_keeps_all_its_remarks(user):
    text = (ROOT / "config" / "materials.yaml").read_text(encoding="utf-8")
    path = user(text)
    add_material(path, "new", like="PA6", tensile_strength=70)
    add_material(path, "newer", like="new", poisson_ratio=0.4)
    assert path.read_text(encoding="utf-8").startswith(text)
    assert load_database(path).material("newer").tensile_strength == 70


def test_a_missing_file_and_folder_are_made(user, tmp_path):
    path = tmp_path / "deep" / "materials.yaml"
    add_material(path, "rail", like="1.7225-normalised", tensile_strength=800)
    assert load_database(path).material("rail").tensile_strength == 800


@pytest.mark.parametrize("name", ["1.4301", "yes", "null", "12:30", "a: b", "#1", "Stahl für Räder", "x" * 200, "~"])
def test_awkward_names_come_back_as_texts(user, name):
    path = user("")
    add_material(path, name, like="PA6", description=name, source=name, tensile_strength=70)
    material = load_database(path).material(name)
    assert material.description == name and material.records["tensile_strength"].source == name


def test_an_existing_material_is_replaced_on_demand_only(user):
    path = user(COMMENTED)
    with pytest.raises(InputError, match="already"):
        add_material(path, "PA6", youngs_modulus=3100)
    assert path.read_text(encoding="utf-8") == COMMENTED
    add_material(path, "PA6", replace=True, youngs_modulus={"value": 3.1, "unit": "GPa"})
    pa6 = load_database(path).material("PA6")
    assert (pa6.youngs_modulus, pa6.poisson_ratio) == (pytest.approx(3100), 0.39)
    assert "# between" in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "values",
    [
        {"youngs_modulus": -5, "like": "PA6"},
        {"youngsmodulus": 5},
        {"youngs_modulus": 5},
        {},
        {"like": "PA6", "tensile_strength": "strong"},
        {"like": "PA6", "poisson_ratio": {"valu": 0.3}},
        {"like": "PA6", "placeholder": "perhaps", "poisson_ratio": 0.3},
    ],
)
def test_a_refused_material_leaves_the_file_alone(user, tmp_path, values):
    path = user(COMMENTED)
    with pytest.raises(InputError):
        add_material(path, "odd", **values)
    assert path.read_text(encoding="utf-8") == COMMENTED
    assert os.listdir(tmp_path) == ["own.yaml"]


def test_a_broken_file_is_not_touched(user):
    path = user("materials: {PA6: [")
    with pytest.raises(InputError, match="YAML"):
        add_material(path, "rail", like="PA6", tensile_strength=70)
    assert path.read_text() == "materials: {PA6: ["


def test_a_write_that_fails_leaves_the_old_file_and_no_rest(user, tmp_path, monkeypatch):
    path = user(COMMENTED)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(InputError, match="the disk is full"):
        add_material(path, "rail", like="PA6", tensile_strength=70)
    assert path.read_text(encoding="utf-8") == COMMENTED and os.listdir(tmp_path) == ["own.yaml"]


def test_a_link_stays_a_link_and_the_mode_stays(user, tmp_path):
    path = user(COMMENTED)
    path.chmod(0o640)
    link = tmp_path / "link.yaml"
    link.symlink_to(path)
    add_material(link, "rail", like="PA6", tensile_strength=70)
    assert link.is_symlink() and "rail" in path.read_text(encoding="utf-8")
    assert path.stat().st_mode & 0o777 == 0o640


@pytest.mark.slow
@given(
    st.floats(1e-2, 1.9e6),
    st.floats(0, 0.5),
    st.floats(1e-3, 0.999),
    st.floats(1e-3, 1e6),
    st.floats(1.01, 1e9),
)
def test_any_number_comes_back_as_it_was_given(tmp_path_factory, modulus, ratio, fatigue, first, factor):
    """Writing and reading a value changes no bit of it, whatever way YAML writes the number."""
    path = tmp_path_factory.mktemp("numbers") / "own.yaml"
    values = dict(
        STEEL,
        youngs_modulus=modulus,
        poisson_ratio=ratio,
        fatigue_strength_ratio=fatigue,
        cycles_at_tensile_strength=first,
        cycles_at_fatigue_limit=first * factor,
    )
    written = add_material(path, "any", **values)
    read = load_database(path).material("any")
    assert written == read and {key: getattr(read, key) for key in values} == values


# ---------------------------------------------------------------- lists


def test_rows_show_values_marks_and_origin(user):
    own = load_database(user("materials: {PA6: {youngs_modulus: {value: 2800, placeholder: true}}}"))
    rows = {row["name"]: row for row in material_rows(own)}
    assert rows["PA6"]["E [MPa]"] == "2800" and rows["PA6"]["placeholders"] == "8"  # seven of limits
    assert set(rows["PA6"]["origin"].split(", ")) == {"own.yaml", "built-in"}
    details = {row["field"]: row for row in material_details(own, "PA6")}
    assert details["youngs_modulus"]["placeholder"] == "placeholder"
    assert details["fatigue_limit"]["value"] == "18"
    assert "Wenzel" in details["tensile_strength"]["source"]
    friction = [row for row in friction_rows(own) if row["field"] == "friction_coefficient"]
    assert len(friction) == 38 and sum(bool(row["placeholder"]) for row in friction) == 13
    with pytest.raises(InputError, match="PA6"):
        material_details(own, "PA 6")


def test_material_is_frozen(db):
    with pytest.raises(dataclasses.FrozenInstanceError):
        db.material("PA6").youngs_modulus = 1.0


def test_a_range_holds_its_value(user):
    entry = "materials: {PA6: {yield_strength: {value: 0.05, unit: GPa, placeholder: true, range: [0.04, 0.055]}}}"
    record = load_database(user(entry)).material("PA6").records["yield_strength"]
    assert record.value == pytest.approx(50) and record.range == pytest.approx((40, 55))
    for wrong in ("[51, 60]", "[40]", "50", "[60, 40]"):
        with pytest.raises(InputError, match="range"):
            load_database(user(f"materials: {{PA6: {{yield_strength: {{value: 50, range: {wrong}}}}}}}"))


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("42CrMo4", ("1.7225-normalised", "1.7225-quenched-tempered", *BARS)),
        ("42crmo4 + QT", ("1.7225-quenched-tempered", *BARS)),
        ("1.7225", ("1.7225-normalised", "1.7225-quenched-tempered", *BARS)),
        ("aw 7075", ("EN AW-7075", "EN AW-7075-T651")),
        ("nylon", ("PA6", "PA6-dry", "PA66-dry", "PA66-moist")),
        ("acetal", ("POM", "POM-H", "POM-C")),
        ("bronze", ()),
        (" ", ()),
    ],
)
def test_materials_are_found_by_the_words_of_a_designer(text, names):
    database = builtin_database()
    assert database.search(text) == names
    with pytest.raises(InputError) as error:
        database.material(text)
    assert all(name in str(error.value) for name in names)


def test_the_list_of_materials_can_be_searched(tmp_path):
    told = trackroller("materials", "list", "42CrMo4", cwd=tmp_path).stdout
    assert "1.7225-normalised" in told and "POM" not in told
    assert "POM" in trackroller("materials", "list", cwd=tmp_path).stdout
    told = trackroller("materials", "list", "unobtainium", cwd=tmp_path, code=2).stderr
    assert "unobtainium" in told and "`trackroller materials list` shows all materials" in told


def test_wear_coefficient_by_pair_and_body():
    database = builtin_database()
    pom, steel = database.on("POM", "1.7225-normalised"), database.on("1.7225-normalised", "POM")
    assert pom.wear_coefficient > 10 * steel.wear_coefficient > 0
    quenched = "1.7225-quenched-tempered"
    named, family = (database.on(body, quenched).wear_coefficient for body in ("EN AW-7075-T651", quenched))
    assert named == 1e-4 and family == 3.1e-4  # a pair of names goes before a pair of families
    record = pom.records["wear_coefficient"]
    assert record.placeholder and record.range[0] <= record.value <= record.range[1]
    guess = pom.guesses_of_limits["wear_coefficient"]
    assert guess.note == "on 1.7225-normalised, measure" and guess.range is not None
    own = {"like": "POM", "wear_coefficient": 5e-7}
    assert database.on(own, quenched).wear_coefficient == 5e-7  # a material's own value goes first
    rows = {row["pair"]: row for row in friction_rows(database) if row["field"] == "wear_coefficient"}
    assert rows["POM on metal"]["value"] == "1e-06" and rows["POM on metal"]["placeholder"]


def test_wear_of_steel_follows_its_hardness_and_holds_the_evidence_of_rolling_with_sliding(user):
    """The rates of twin discs, 5.3 ug/(m mm2) per N/mm2 and 55 from 10.4 to 77.2 N/mm2, times their friction."""
    database = load_database(None)

    def range_of(hardness, db=database):
        return db.on({"like": "C45", "hardness": hardness}, "C45").records["wear_coefficient"].range

    density, friction = 7850.0, 0.46
    rates = np.array([5.3, 55 / 10.4, 55 / 77.2, (61.9 * 100 - 4778.7) / 100, (61.9 * 100 - 4723.7) / 100])
    low, high = range_of(260)
    discs = friction * rates / density
    assert low <= discs.min() * 1.01 and discs.max() <= high * 1.05  # the third branch is quoted with a gap
    assert database.on("C45", "C45").wear_coefficient == pytest.approx(friction * 5.3 / density, rel=0.01)
    assert high < 1e3 * 7e-3 / 1860  # pins on rings of mild steel are no part of it
    assert range_of(390) == (low, high) and range_of(400)[1] < high
    assert range_of(615)[0] <= 1e3 * 1.3e-4 / 8500 <= range_of(615)[1]  # pins of hardened tool steel
    bare = {"like": "C45", "name": "bare", "hardness": None}
    record = database.on(Material(**database.material("C45").as_dict() | {"hardness": None}), "C45").records
    assert (
        record["wear_coefficient"].range == (range_of(615)[0], high)
        and "give hardness" in record["wear_coefficient"].note
    )
    assert database.on(bare, "C45").hardness == 170  # a value that is left out is inherited
    mine = load_database(user("wear: [{pair: [metal, metal], hardness: [500, 2000], first: 2.0e-6}]"))
    assert mine.on("100Cr6", "C45").wear_coefficient == 2e-6 and range_of(260, mine) == (low, high)
    every = load_database(user("wear: [{pair: [metal, metal], first: 2.0e-6}]"))
    assert {every.on(name, "C45").wear_coefficient for name in ("C45", "100Cr6", "1.7225-normalised")} == {2e-6}
    levels = [row["level"] for row in friction_rows(database) if row["pair"] == "metal on metal"]
    assert levels[-3:] == ["wear of metal of 400 to 2000 HB", "wear of metal of 0 to 400 HB", "wear of metal"]


def test_wear_of_the_user_goes_first_and_bad_entries_are_refused(user):
    own = load_database(user("wear: [{pair: [metal, POM], second: 3.0e-6}]"))
    assert own.on("POM", "1.7225-normalised").wear_coefficient == 3e-6
    assert own.on("1.7225-normalised", "POM").wear_coefficient == 1e-8  # the file leaves it as it is
    for text, message in (
        ("wear: [{pair: [POM, metal], third: 1.0e-6}]", "third"),
        ("wear: [{pair: [POM, metal]}]", "one of first, second"),
        ("wear: [{pair: [POM], first: 1.0e-6}]", "a list of two families"),
        ("wear: [{pair: [POM, metal], first: 2}]", "wear_coefficient = 2"),
        ("wear: [{pair: [POM, metal], first: -1.0e-6}]", "wear_coefficient"),
        ("wear: [{pair: [metal, metal], hardness: 300, first: 1.0e-6}]", r"hardness = 300.*Write hardness: \[0, 400\]"),
        ("wear: [{pair: [metal, metal], hardness: [400, 300], first: 1.0e-6}]", "a range that rises"),
        ("wear: [{pair: [metal, metal], hardness: [0, hard], first: 1.0e-6}]", "hardness = 'hard'"),
    ):
        with pytest.raises(InputError, match=message):
            load_database(user(text))


def test_a_table_over_temperature_can_be_added_and_listed(tmp_path):
    table = {"temperature": [20, 60.0, "100 degC"], "youngs_modulus": ["3 GPa", 2000, 1100]}
    warm = add_material(tmp_path / "m.yaml", "warm", like="POM", temperature_dependence=table, source="own tests")
    assert warm.temperature_dependence.youngs_modulus == (3000.0, 2000.0, 1100.0)
    assert warm.temperature_dependence.source == "own tests" and not warm.temperature_dependence.placeholder
    assert warm.at(80.0).youngs_modulus == 1550.0 and warm.at(80.0).yield_strength == warm.yield_strength
    assert warm.at(float("nan")) is warm
    text = (tmp_path / "m.yaml").read_text()
    with pytest.raises(InputError, match=r"temperature_dependence\.youngs_modulus"):
        add_material(tmp_path / "m.yaml", "w", like="POM", temperature_dependence=table | {"youngs_modulus": [1, 2]})
    with pytest.raises(InputError, match="temperature_dependence = 5"):
        add_material(tmp_path / "m.yaml", "w", like="POM", temperature_dependence=5)
    assert (tmp_path / "m.yaml").read_text() == text


def test_the_list_counts_the_guesses_of_limits_too():
    rows = {row["name"]: row["placeholders"] for row in material_rows(load_database(None))}
    marked = [row for row in material_details(load_database(None), "POM") if row["placeholder"]]
    assert rows["POM"] == str(len(marked)) == "6"


def test_the_energy_law_of_wear_can_be_added_listed_and_inherited(tmp_path):
    law = {"work_rate": [0, "10 N/mm2", 50], "loss": [0, 55, 60], "source": "own discs"}
    own = add_material(tmp_path / "m.yaml", "hub", like="C45", energy_wear=law).energy_wear
    assert (own.work_rate, own.loss, own.source, own.placeholder) == ((0, 10, 50), (0, 55, 60), "own discs", False)
    assert load_database(tmp_path / "m.yaml").material({"like": "hub", "hardness": 200}).energy_wear == own
    rows = {row["field"]: row for row in material_details(load_database(None), "C45")}
    assert rows["energy_wear"]["value"] == "0, 55, 55, 1466" and rows["energy_wear"]["placeholder"]
    assert "Lewis" in rows["energy_wear"]["source"] and rows["energy_wear"]["unit"] == "ug/(m mm2)"
    listed = {row["name"]: row["placeholders"] for row in material_rows(load_database(None))}
    assert listed["C45"] == str(sum(bool(row["placeholder"]) for row in material_details(load_database(None), "C45")))


@pytest.mark.parametrize("key", ["path", "name", "paht"])
def test_a_value_that_is_none_of_a_material_is_refused(tmp_path, key):
    with pytest.raises(InputError, match=f"'{key}' is not known"):
        add_material(tmp_path / "m.yaml", "new", like="PA6", **{key: 5})
    assert not (tmp_path / "m.yaml").exists()
