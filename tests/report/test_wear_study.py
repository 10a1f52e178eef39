"""What the report of a study says of wear: placeholders, run-in, the error of full sliding, the best whatever k is."""

import pytest
import yaml

import trackroller as tr
from trackroller.report.explorer.rows import collect
from trackroller.report.words.accuracy import full_sliding
from trackroller.report.words.designs import condition_words
from trackroller.report.words.in_short import in_short
from trackroller.report.words.limits import guesses, worn

STUDY = """
name: dry
base:
  motor_force: 0
  axial_force: 5
  radial_force: -30
  guide_curve_radius: .inf
  guide_overrollings_per_hour: 60
  permissible_wear_depth: 0.05
factors:
  material_pair: {values: [[POM, 1.7225-quenched-tempered], [PA6, 1.7225-quenched-tempered]]}
  roller_profile_radius: {values: [-6.3, -8]}
  friction_coefficient: {values: [0.1, 0.2]}
  wear_coefficient_factor: {values: [0.5, 2]}
outputs: [forces, contact, peak_stress, life, wear, limits]
contact_model: sliding
accuracy: preview
analysis: {outputs: [run_in_distance, wear_life_hours_roller, wear_life_hours_guide]}
pareto: {wear_life_hours_roller: max, max_pressure: min}
chunk_size: 8
"""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return tr.run(yaml.safe_load(STUDY), progress=False, results=tmp_path_factory.mktemp("results"))


@pytest.mark.slow
def test_sentences_on_wear(study):
    results = study
    told = guesses(results)
    names = {name.split(" on ")[0] for name in told.values["placed"]["wear"]}
    assert names == {"POM", "PA6", "1.7225-quenched-tempered"}
    assert all(name in told.text for name in ("wear (", "POM", "PA6"))  # of both chunks
    km = study.data.run_in_distance.values
    beyond = worn(results)
    first = study.data.life_to_first_limit_hours.min("body").values
    outlives = 0.06 * float(study.data.velocity) * first > km
    assert beyond.values["count"] == outlives.sum() and 0 < outlives.sum() < 16
    assert beyond.values["least"] == pytest.approx(km[outlives].min())
    life = results.table.assign(life=results.column("pair_life_to_first_limit_hours"))
    by_design = life.groupby(["material_pair", "roller_profile_radius"])["life"].min()
    assert len(results.verdict.candidates) == len(by_design) == 4
    assert min(one.low for one in results.verdict.candidates) == by_design.min()
    said = [sentence.text for _, own in in_short(results, []) for sentence in own]
    assert {told.text, beyond.text, full_sliding(results).text} <= set(said)


def test_run_in_and_wear_life_are_axes_goals_and_analysed(study):
    columns = {column.name: column for column in collect(study)}
    for name in ("run_in_distance", "wear_life_hours_roller", "wear_life_hours_guide"):
        assert columns[name].role == "output" and columns[name].log
        assert name in study.indices().output.values
    assert "wear_life_hours_roller:beyond" not in columns  # no S-N data behind it
    assert len(study.pareto()) > 0


def test_a_study_without_wear_says_nothing_of_it(tmp_path):
    plain = yaml.safe_load(STUDY) | {"outputs": ["forces", "contact", "peak_stress", "life"], "name": "plain"}
    plain = {key: value for key, value in plain.items() if key not in ("analysis", "pareto")}
    plain["factors"] = {n: f for n, f in plain["factors"].items() if n != "wear_coefficient_factor"}
    plain["base"] = {n: value for n, value in plain["base"].items() if n != "permissible_wear_depth"}
    results = tr.run(plain, progress=False, results=tmp_path)
    assert guesses(results) is worn(results) is None and "wear" not in full_sliding(results).text


def test_the_worst_condition_names_no_place_of_a_placeholder(study):
    """A wear coefficient that nobody measured is no condition of the use."""
    designs = study.candidates()
    told = [condition_words(designs, case) for case in designs.table["worst_case"]]
    assert all(text.startswith("friction coefficient") and "wear" not in text for text in told)
