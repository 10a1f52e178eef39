"""Study files: what is right is read, what is wrong is refused with field, value and remedy."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.errors import InputError
from trackroller.roller.dataset import solved_by
from trackroller.study.file import schema
from trackroller.study.file.load import parse_study
from trackroller.yaml_file import parse_mapping

STUDIES = sorted((Path(__file__).parents[3] / "config" / "studies").glob("*.yaml"))
PAIR = ["1.7225-normalised", "PA6"]


@pytest.mark.parametrize("path", STUDIES, ids=lambda p: p.stem)
def test_every_study_beside_the_default_one_is_valid(path):
    study = tr.load_study(path)
    assert study.name == path.stem
    assert study.design().sizes["case"] > 0


def test_default_study_is_the_full_grid_of_5400_cases():
    design = tr.load_study(STUDIES[0].parent / "default.yaml").design()
    assert design.sizes["case"] == 8 * 5 * 5 * 3 * 3 * 3


def test_grid_has_one_row_a_combination_the_last_factor_fastest():
    study = parse_study(
        {
            "name": "g",
            "factors": {"axial_force": {"values": [1, 2]}, "friction_coefficient": {"linspace": [0.1, 0.3, 3]}},
        }
    )
    design = study.design()
    np.testing.assert_allclose(design["axial_force"], [1, 1, 1, 2, 2, 2])
    np.testing.assert_allclose(design["friction_coefficient"], [0.1, 0.2, 0.3] * 2)
    assert design["roller_material"].dtype == object


def test_studies_and_cases_take_the_exact_theory_unless_told_otherwise():
    shipped = [tr.load_study(path).config for path in STUDIES]
    asked = {(config.contact_model, config.accuracy) for config in [parse_study({"name": "a"}).config, *shipped]}
    assert asked == {("kalker", "standard")}
    found = tr.solve(tr.Case(motor_force=0, friction_coefficient=0.1), "forces")
    assert found.attrs["contact_model"] == "kalker" and solved_by(found).item() == "kalker"


def test_design_is_what_solve_takes_and_keeps_infinity():
    study = parse_study({"name": "g", "factors": {"guide_curve_radius": {"values": ["inf", 220]}}})
    design = study.design()
    assert math.isinf(design["guide_curve_radius"][0])
    assert solve_sliding(design, outputs=("forces",)).sizes["case"] == 2


def test_material_pairs_and_friction_by_pair_are_resolved():
    study = parse_study(
        {
            "name": "g",
            "base": {"friction_coefficient": None},
            "factors": {"material_pair": {"values": [PAIR, [PAIR[0], PAIR[0]]]}},
        }
    )
    design = study.design()
    assert list(design["guide_material"].values) == ["PA6", PAIR[0]]
    np.testing.assert_allclose(design["friction_coefficient"], [0.22, 0.19])


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"nam": "x"}, ["nam", "name"]),
        ({}, ["name"]),
        ({"name": "../up"}, ["name", "../up"]),
        ({"name": "a/b"}, ["name"]),
        ({"name": "a", "bas": {}}, ["bas", "base"]),
        ({"name": "a", "base": {"friction_coeficient": 0.1}}, ["friction_coeficient", "friction_coefficient"]),
        ({"name": "a", "factors": {"axial_forc": {"values": [1]}}}, ["axial_forc", "axial_force"]),
        ({"name": "a", "factors": {"axial_force": {"values": []}}}, ["factors.axial_force", "not empty"]),
        ({"name": "a", "factors": {"axial_force": {"values": [1, 1]}}}, ["axial_force", "once"]),
        ({"name": "a", "factors": {"axial_force": {"linspce": [1, 2, 3]}}}, ["linspce", "linspace"]),
        ({"name": "a", "factors": {"axial_force": {"uniform": [1, 2]}}}, ["axial_force", "grid"]),
        ({"name": "a", "factors": {"friction_coefficient": {"values": [0.1, -0.1]}}}, ["friction_coefficient", "-0.1"]),
        ({"name": "a", "base": {"friction_coefficient": math.nan}}, ["friction_coefficient", "nan"]),
        ({"name": "a", "base": {"radial_force": 10}}, ["radial_force", "10"]),
        ({"name": "a", "hertz": "published", "normal": "halfspace"}, ["hertz", "published", "normal: halfspace"]),
        ({"name": "a", "hertz": "published", "normal": ["hertz", "halfspace"]}, ["hertz", "normal: halfspace"]),
        ({"name": "a", "base": {"roller_profile_radius": -5}}, ["base.roller_profile_radius", "conform"]),
        (
            {"name": "a", "factors": {"roller_profile_radius": {"values": [-7, -5]}}},
            ["factors.roller_profile_radius", "-5", "conform"],
        ),
        ({"name": "a", "method": "lhs", "factors": {"roller_profile_radius": {"uniform": [-7, -5]}}}, ["-5"]),
        ({"name": "a", "base": {"contact_angle": 90}}, ["contact_angle", "90"]),
        ({"name": "a", "base": {"roller_material": "PA7"}}, ["PA7", "PA6"]),
        ({"name": "a", "factors": {"material_pair": {"values": [["PA6"]]}}}, ["material_pair", "pair"]),
        (
            {"name": "a", "factors": {"material_pair": {"values": [PAIR]}}, "base": {"roller_material": "PA6"}},
            ["not both"],
        ),
        ({"name": "a", "base": {"axial_force": 1}, "factors": {"axial_force": {"values": [1, 2]}}}, ["axial_force"]),
        ({"name": "a", "contact_model": "slidng"}, ["slidng", "sliding"]),
        ({"name": "a", "contact_model": []}, ["contact_model"]),
        ({"name": "a", "outputs": ["force"]}, ["force", "forces"]),
        ({"name": "a", "outputs": []}, ["outputs"]),
        ({"name": "a", "accuracy": 2}, ["accuracy", "2"]),
        ({"name": "a", "accuracy": "standart"}, ["standart", "standard"]),
        ({"name": "a", "method": "gird"}, ["gird", "grid"]),
        ({"name": "a", "method": "table"}, ["table is missing", "CSV", "Write 'table: cases.csv' too"]),
        (
            {"name": "a", "method": "central_composite", "factors": {"axial_force": {"values": [1, 2]}}},
            ["with 0 numeric factors", "Give the factors ranges"],
        ),
        ({"name": "a", "table": "t.xlsx"}, ["table = 't.xlsx'", "Write 'method: table' too"]),
        ({"name": "a", "cases": 120}, ["similar meaning: samples, table"]),
        ({"name": "a", "chunk_size": 0}, ["chunk_size", "0"]),
        ({"name": "a", "seed": -1}, ["seed", "-1"]),
        ({"name": "a", "factors": [1]}, ["factors"]),
        ({"name": "a", "factors": {"travel": {"values": [0, 5]}}}, ["normal = 'hertz'", "travel", "normal: halfspace"]),
        ({"name": "a", "base": {"travel": "5 km"}}, ["normal = 'hertz'", "travel"]),
        (
            {
                "name": "a",
                "factors": {"axial_force": {"linspace": [0, 1, 10**8]}, "velocity": {"linspace": [1, 2, 10**8]}},
            },
            ["linspace"],
        ),
    ],
)
def test_wrong_study_is_refused_with_field_value_and_remedy(data, words):
    with pytest.raises(InputError) as error:
        parse_study(data).design()
    for word in words:
        assert word in str(error.value)


@pytest.mark.parametrize(
    "text",
    [
        "a: [",
        "- 1",
        "",
        "a: 1\na: 2",
        "&a [*a]",
        "a: !!python/object:os.system x",
        "\0",
        "a: &b {c: *b}",
        "? [1]\n: 2",
        "[" * 5000,
    ],
)
def test_text_that_is_no_yaml_mapping_is_refused(text):
    with pytest.raises(InputError):
        parse_mapping(text, "study file")


def test_a_billion_laughs_are_refused():
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 9)]
    with pytest.raises(InputError, match="at most"):
        parse_mapping("\n".join(lines), "study file")


@settings(max_examples=300, deadline=None)
@given(st.text(max_size=200))
def test_any_text_is_a_mapping_or_a_clean_error(text):
    try:
        assert isinstance(parse_mapping(text, "study file"), dict)
    except InputError:
        pass


_scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=8)
    | st.sampled_from(["axial_force", "values", "grid", "lhs", "PA6", "typical", "inf"])
)
_values = st.recursive(
    _scalars,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["values", "linspace", "uniform", "normal", "expression", "scatter"]) | st.text(max_size=4),
            inner,
            max_size=2,
        )
    ),
    max_leaves=6,
)
_keys = st.sampled_from([*parse_study({"name": "a"}).config.model_dump(), "nam"])
_names = st.sampled_from(["axial_force", "friction_coefficient", "material_pair", "roller_material", "u"])


@pytest.mark.long
@settings(max_examples=400, deadline=None)
@given(st.dictionaries(_keys, _values, max_size=4), st.dictionaries(_names, _values, max_size=3))
def test_any_mapping_is_a_study_or_a_clean_error(data, factors):
    data = {"name": "a", "factors": factors} | data
    try:
        parse_study(data)
    except InputError as error:
        assert str(error)


def test_schema_in_the_repository_is_that_of_the_code():
    assert schema.FILE.read_text(encoding="utf-8") == schema.text(), "run: python -m trackroller.study.file.schema"


@pytest.mark.slow
@pytest.mark.parametrize("path", STUDIES, ids=lambda p: p.stem)
def test_schema_accepts_the_studies_and_refuses_misspelt_keys(path):
    import jsonschema
    import yaml

    data = yaml.safe_load(path.read_text(encoding="utf-8"))
    jsonschema.validate(data, schema.schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(data | {"outptus": []}, schema.schema())


def test_merged_study_reads_back_as_itself():
    for path in STUDIES:
        study = tr.load_study(path)
        again = parse_study(parse_mapping(study.merged(), "study"))
        assert again.merged() == study.merged()


def test_a_duty_that_no_output_uses_is_refused():
    """A duty turns lives into years, and a study of forces has no lives."""
    study = {"name": "d", "factors": {"radial_force": {"values": [-60, -90]}}, "duty": {"hours_per_day": 8}}
    with pytest.raises(InputError, match=r"duty.*turns lives into years.*Add limits"):
        parse_study(study | {"outputs": ["forces"]})
    assert parse_study(study | {"outputs": ["forces", "life"]}).config.duty["hours_per_day"] == 8
