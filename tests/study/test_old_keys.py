"""A study file of an earlier version holds keys of the program's own: it still opens, and says what it leaves out."""

import numpy as np
import pytest
import yaml

import trackroller as tr

STUDY = {
    "name": "old",
    "design": "inner_outer",
    "inner": "lhs",
    "samples": 8,
    "factors": {"friction_coefficient": {"uniform": [0.1, 0.3]}, "contact_angle": {"values": [30, 36]}},
    "contact_model": "sliding",
    "accuracy": "preview",
    "outputs": ["forces"],
}
OWN = {"grown_from": [4], "point_samples": [8, 4]}


def test_a_study_file_with_keys_of_the_program_is_read_without_them():
    with pytest.warns(UserWarning, match="Ignored: grown_from and point_samples, because a Latin hypercube is drawn"):
        study = tr.load_study(STUDY | OWN)
    assert study.as_dict() == tr.load_study(STUDY).as_dict() and not {*OWN} & {*study.as_dict()}


def test_results_of_an_earlier_version_keep_their_rows():
    solved = tr.run(STUDY, progress=False)
    stored = yaml.safe_load(solved.data.attrs["study"]) | OWN
    with pytest.warns(UserWarning, match="Ignored: grown_from and point_samples"):
        again = tr.open_study(solved.data.assign_attrs(study=yaml.safe_dump(stored, sort_keys=False)))
    assert np.array_equal(again.design.unit, solved.design.unit) and again.data.sizes == solved.data.sizes
