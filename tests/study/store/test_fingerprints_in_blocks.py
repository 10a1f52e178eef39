"""Cases are checked and fingerprinted in blocks, with the results and messages of all cases at once."""

import numpy as np
import pytest

from trackroller.errors import InputError
from trackroller.roller.case import to_table
from trackroller.study.file.load import parse_study
from trackroller.study.store import fingerprint

STUDY = {
    "name": "blocks",
    "factors": {"axial_force": {"linspace": [0, 6, 7]}, "contact_model": {"values": ["sliding", "kalker_table"]}},
}


def test_fingerprints_do_not_depend_on_the_blocks(monkeypatch):
    study = parse_study(STUDY)
    cases = fingerprint.StudyCases(study)
    options, group = cases.options
    table = to_table(cases.design.drop_vars(list(cases.design.coords)), study.materials)
    whole = fingerprint.fingerprints(table, *options, group=group)
    monkeypatch.setattr(fingerprint, "BLOCK", 3)
    assert len(np.unique(whole)) == 14
    np.testing.assert_array_equal(cases.fingerprints, whole)


def test_a_bad_case_is_named_by_its_number_in_the_design(monkeypatch):
    monkeypatch.setattr(fingerprint, "BLOCK", 3)
    cases = fingerprint.StudyCases(parse_study(STUDY))
    design = cases.design.assign(velocity=("case", np.append(np.full(13, 60.0), -1.0)))
    cases.__dict__["design"] = design
    with pytest.raises(InputError, match=r"case 13"):
        _ = cases.fingerprints
