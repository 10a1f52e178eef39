"""One declaration makes a parameter: case, table, study file, units, `--set` and schema follow from it."""

from __future__ import annotations

import subprocess
import sys

import pytest

PROGRAM = """
from trackroller.parameters import PARAMETERS, Parameter

PARAMETERS["gauge"] = Parameter("gauge", "g", "mm", 7.5, "an example", lower=1.0)
import trackroller as tr
from trackroller.cli.case import case_of
from trackroller.parameters.example import with_unit
from trackroller.roller.case import to_table
from trackroller.study.file.schema import schema

assert tr.Case().gauge == 7.5 and "gauge" in tr.Case().not_given
assert to_table([tr.Case(gauge="2 cm"), tr.Case()]).gauge.tolist() == [20.0, 7.5]
assert case_of(None, ["gauge=3"])[0].gauge == 3.0
study = tr.load_study({"name": "g", "factors": {"gauge": {"values": [2, 4]}}, "outputs": ["forces"]})
assert study.design()["gauge"].values.tolist() == [2.0, 4.0]
assert "gauge" in schema()["properties"]["base"]["properties"] and with_unit("gauge", 2) == "gauge 2 mm"
try:
    tr.Case(gauge=0.5)
except tr.InputError as error:
    assert "gauge = 0.5" in str(error)
else:
    raise AssertionError
print("done")
"""


@pytest.mark.slow
def test_one_declaration_makes_a_parameter(tmp_path):
    done = subprocess.run([sys.executable, "-c", PROGRAM], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.stdout == "done\n", done.stderr
