"""The command and the page of one contact: what they print and write, and what they refuse."""

import json

import numpy as np
import pytest
import xarray as xr
from command_line import trackroller

import trackroller as tr
from trackroller.one_patch.inputs import creepage_range
from trackroller.report.figures import patch as figures
from trackroller.report.pages.patch import sentences, table_of_cases

FILE = """
description: a twin-disc test
normal_force: 7 kN
curvature_rolling: 0.04 1/mm
curvature_lateral: 0
width: 1 cm
materials: {youngs_modulus: 210 GPa, poisson_ratio: 0.28}
friction_coefficient: 0.3
accuracy: preview
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "twin.yaml").write_text(FILE)
    return tmp_path


def test_the_command_prints_a_row_a_creepage_and_writes_page_and_data(folder):
    done = trackroller("patch", "twin.yaml", "--creepage", "0:2%:5", "--report", "twin.html", cwd=folder)
    assert "100 % of mu F_N, at longitudinal creepage 1 %" in done.stdout
    assert next(row for row in done.stdout.splitlines() if row.startswith("│ 4 ")).split("│")[2].strip() == "2"
    page = (folder / "twin.html").read_text(encoding="utf-8")
    assert "trackroller patch twin.yaml --report twin.html --creepage 0:2%:5" in page
    assert page.count("<figure>") == 2 and "a twin-disc test" in page
    trackroller("patch", "twin.yaml", "--creepage", "0:2%:5", "-o", "twin.nc", cwd=folder)
    with xr.open_dataset(folder / "twin.nc") as read:
        np.testing.assert_allclose(read["longitudinal_creepage"], [0.0, 0.005, 0.01, 0.015, 0.02])
        tr.report(read.load(), folder / "again.html")
    assert (folder / "again.html").read_text(encoding="utf-8").count("<figure>") == 2


def test_json_holds_the_numbers_of_the_function(folder):
    printed = json.loads(trackroller("patch", "twin.yaml", "--creepage", "1:2%:2", "--json", cwd=folder).stdout)
    own = tr.patch(
        7000.0, curvature_rolling=0.04, curvature_lateral=0, width=10.0, friction_coefficient=0.3,
        materials={"youngs_modulus": 210e3, "poisson_ratio": 0.28}, longitudinal_creepage=[0.01, 0.02],
        accuracy="preview",
    )  # fmt: skip
    assert printed["driving_force"]["value"] == own["driving_force"].values.tolist()


def test_the_table_leaves_out_what_is_rounding_and_keeps_what_is_not():
    given = {
        "normal_force": 1000.0, "semi_axes": (0.6, 0.4), "friction_coefficient": 0.3, "accuracy": "preview",
        "materials": {"youngs_modulus": 210e3, "poisson_ratio": 0.28},
    }  # fmt: skip
    plain = table_of_cases(tr.patch(**given, longitudinal_creepage=[0.0, 1e-3]))
    assert "F_x [N]" not in plain.heads and "Spin [1/mm]" not in plain.heads
    turned = table_of_cases(tr.patch(**given, spin=[0.0, 1e-2]))
    assert {"F_x [N]", "Spin [1/mm]", "Spin moment [N·mm]"} <= set(turned.heads)


def test_a_single_case_has_fields_and_no_curve():
    own = tr.patch(
        1000.0, semi_axes=(0.6, 0.4), friction_coefficient=0.3, materials="PA6", spin=0.01, accuracy="preview"
    )
    assert figures.creep_curve(own) is None
    _, info = figures.fields(own)
    assert "spin creepage 0.01 /mm" in info.caption
    missed = own.assign(converged=own["converged"] * 0)
    assert any("1 of 1 cases have not converged" in text for text in sentences(missed))


def test_a_range_of_creepages():
    assert creepage_range("0:2%:3") == [0.0, 0.01, 0.02]
    assert creepage_range(" -1% : 1 %")[::40] == [-0.01, 0.01]
    assert len(creepage_range("0:1%")) == 41


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--creepage", "0:2"], "is no range in per cent"),
        (["--creepage", "2%"], "is no range in per cent"),
        (["--creepage", "0:300%"], "between -100 and 100"),
        (["--creepage", "a:b%"], "between -100 and 100"),
        (["--creepage", "0:2%:1"], "2 to 1000 points"),
        (["-o", "twin.csv"], "name ends in .nc"),
        (["--report", "twin.txt"], "ends in .html or .pdf"),
    ],
)
def test_the_command_refuses_in_one_line(folder, words, said):
    done = trackroller("patch", "twin.yaml", *words, cwd=folder, code=2)
    assert said in done.stderr and done.stderr.count("\n") == 1


def test_a_range_beside_lists_of_another_length_names_both(folder):
    (folder / "twin.yaml").write_text(FILE.replace("7 kN", "[7 kN, 8 kN]"))
    done = trackroller("patch", "twin.yaml", "--creepage", "0:2%:5", cwd=folder, code=2)
    assert "normal_force = '2 values'" in done.stderr and "5 values as longitudinal_creepage has" in done.stderr
