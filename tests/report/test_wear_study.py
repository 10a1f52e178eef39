"""What the report of a study says of wear: placeholders, run-in, the error of full sliding, the best whatever k is."""

import pytest
import yaml

import trackroller as tr
from trackroller.report.explorer.rows import collect

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


def test_run_in_and_wear_life_are_axes_goals_and_analysed(study):
    columns = {column.name: column for column in collect(study)}
    for name in ("run_in_distance", "wear_life_hours_roller", "wear_life_hours_guide"):
        assert columns[name].role == "output" and columns[name].log
        assert name in study.indices().output.values
    assert "wear_life_hours_roller:beyond" not in columns  # no S-N data behind it
    assert len(study.pareto()) > 0
