"""Heads and codes of tables of tests as people write them, each against the table with the names of the program."""

from __future__ import annotations

import pandas as pd
import pytest

import trackroller as tr
from trackroller.fit.heads import normal

UNDER = {"load_type": "axial", "stress_ratio": -1}
STRESS = [460, 460, 430, 430, 400, 400, 370, 350, 370, 350, 330, 330]
CYCLES = [61000, 98000, 120000, 75000, 210000, 310000, 420000, 900000, *[10000000] * 4]
FAILED = [True] * 8 + [False] * 4


def line_of(table):
    return tr.fit_sn(table, **UNDER).groups[0].line


@pytest.fixture(scope="module")
def expected():
    return line_of({"amplitude": STRESS, "cycles": CYCLES, "failed": FAILED}).estimate.tolist()


def written(tmp_path, heads, stress=STRESS, codes=FAILED):
    path = tmp_path / "tests.csv"
    pd.DataFrame(dict(zip(heads, (stress, CYCLES, codes), strict=True))).to_csv(path, index=False)
    return path


HEADS = [
    ("stress_amplitude_MPa", "cycles_to_failure", "fracture"),
    ("stress_amplitude [MPa]", "N", "failure"),
    ("load", "cycles", "fracture"),
    ("Stress S [MPa]", "Cycles N [-]", "Failed"),
    ("Spannungsamplitude (N/mm2)", "Schwingspielzahl", "Bruch"),
    ("sigma_a / MPa", "Number of cycles", "broken"),
    ("S_a [MPa]", "Nf", "is_failed"),
]


@pytest.mark.parametrize("heads", HEADS)
@pytest.mark.parametrize("framed", [False, True])
def test_usual_heads_are_taken_and_told(tmp_path, expected, heads, framed):
    table = dict(zip(heads, (STRESS, CYCLES, FAILED), strict=True)) if framed else written(tmp_path, heads)
    fit = tr.fit_sn(table, **UNDER)
    assert fit.groups[0].line.estimate.tolist() == pytest.approx(expected, rel=1e-9)
    assert fit.notes[0].startswith("Columns were read by other names: ")
    assert "as amplitude [MPa]" in fit.notes[0] or heads[0] == "amplitude"


@pytest.mark.parametrize("head", ["censored", "runout", "run_out", "Run-out", "suspended", "Durchläufer", "survived"])
@pytest.mark.parametrize(
    ("runs_out", "fails"), [(1, 0), ("yes", "no"), (True, False), ("x", ""), ("run-out", "failed"), ("Y", "n")]
)
@pytest.mark.parametrize("framed", [False, True])
def test_a_column_of_run_outs_is_the_opposite_of_failed(tmp_path, expected, head, runs_out, fails, framed):
    codes = [fails if one else runs_out for one in FAILED]
    heads = ("amplitude", "cycles", head)
    table = dict(zip(heads, (STRESS, CYCLES, codes), strict=True)) if framed else written(tmp_path, heads, codes=codes)
    fit = tr.fit_sn(table, **UNDER)
    assert fit.groups[0].line.estimate.tolist() == pytest.approx(expected, rel=1e-9)
    assert "opposite of failed" in fit.notes[0]
    assert f"By the column '{head}' 4 of 12 specimens ran out." in fit.notes


@pytest.mark.parametrize(
    ("fails", "runs_out"),
    [("yes", "no"), (1, 0), ("x", ""), ("failed", "run-out"), ("Failure", "RunOut"), ("ja", "nein"), ("TRUE", "FALSE")],
)
@pytest.mark.parametrize("head", ["failed", "fracture"])
def test_codes_of_failures_are_read(tmp_path, expected, fails, runs_out, head):
    codes = [fails if one else runs_out for one in FAILED]
    path = written(tmp_path, ("amplitude", "cycles", head), codes=codes)
    assert line_of(path).estimate.tolist() == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("head", ["status", "Comment", "Result", "outcome"])
def test_a_column_of_words_alone_says_how_a_test_ended(tmp_path, expected, head):
    codes = ["Failure" if one else "RunOut" for one in FAILED]
    assert line_of(written(tmp_path, ("amplitude", "cycles", head), codes=codes)).estimate.tolist() == pytest.approx(
        expected, rel=1e-9
    )
    with pytest.raises(tr.InputError, match=r"failed is missing.*a column failed, with yes for a failure"):
        line_of(written(tmp_path, ("amplitude", "cycles", head), codes=[int(one) for one in FAILED]))


@pytest.mark.parametrize(
    ("head", "factor"), [("stress_amplitude_ksi", 6.894757293168361), ("amplitude [ksi]", 6.894757293168361),
                         ("stress_GPa", 1000.0), ("load [Pa]", 1e-6)]
)  # fmt: skip
@pytest.mark.parametrize("framed", [False, True])
def test_a_unit_in_a_head_is_converted(tmp_path, expected, head, factor, framed):
    stress = [value / factor for value in STRESS]
    heads = (head, "cycles", "failed")
    table = dict(zip(heads, (stress, CYCLES, FAILED), strict=True)) if framed else written(tmp_path, heads, stress)
    assert line_of(table).estimate.tolist() == pytest.approx(expected, rel=1e-9)


def test_specimens_have_names(tmp_path):
    path = written(tmp_path, ("amplitude", "cycles", "failed"))
    frame = pd.read_csv(path).assign(specimen=["A"] * 12)
    frame.to_csv(path, index=False)
    with pytest.raises(tr.InputError, match=r"line 3: specimen = 'A' stands in row 2 as well"):
        line_of(path)


def test_specimen_p10_is_no_percentile(tmp_path):
    """The tenth specimen counts, though one amplitude and the longest life are its mean and maximum."""
    path = tmp_path / "tests.csv"
    cycles = [*range(100000, 180000, 10000), 10**6, 10**6]
    rows = [f"P{i},400,{n},{'yes' if i < 9 else 'no'}\n" for i, n in enumerate(cycles, 1)]
    path.write_text("specimen,amplitude [MPa],cycles,failed\n" + "".join(rows))
    assert tr.fit_sn(path, slope=8, **UNDER).groups[0].line.size == 10


@pytest.mark.parametrize("code", ["2", "f", "perhaps", "-1"])
@pytest.mark.parametrize("head", ["failed", "runout"])
def test_a_code_that_says_nothing_is_asked_back(tmp_path, code, head):
    codes = [code, *map(int, FAILED[1:])]
    with pytest.raises(tr.InputError, match=rf"line 2: {head} = '{code}'.*yes or no, 1 or 0.*Correct the cell"):
        line_of(written(tmp_path, ("amplitude", "cycles", head), codes=codes))


@pytest.mark.parametrize("code", ["yes", "1"])
def test_an_empty_cell_beside_plain_codes_is_asked_back_and_the_remedy_works(tmp_path, expected, code):
    codes = [code if one else "" for one in FAILED]
    with pytest.raises(tr.InputError, match=r"line 10: failed.*Fill the cell, or mark the others with x alone"):
        line_of(written(tmp_path, ("amplitude", "cycles", "failed"), codes=codes))
    for mended in ([one or "no" for one in codes], ["x" if one else "" for one in codes]):
        path = written(tmp_path, ("amplitude", "cycles", "failed"), codes=mended)
        assert line_of(path).estimate.tolist() == pytest.approx(expected, rel=1e-9)


def test_two_columns_of_one_meaning_are_refused_and_the_remedy_works(tmp_path, expected):
    path = written(tmp_path, ("amplitude", "cycles", "failed"))
    frame = pd.read_csv(path)
    for name, values in (("load", STRESS), ("runout", [not one for one in FAILED])):
        frame.assign(**{name: values}).to_csv(path, index=False)
        with pytest.raises(tr.InputError, match=rf"tests\.csv, line [12]: .*Remove .*{name}"):
            line_of(path)
        frame.to_csv(path, index=False)
        assert line_of(path).estimate.tolist() == pytest.approx(expected, rel=1e-9)


def test_a_load_in_newtons_is_no_amplitude(tmp_path):
    with pytest.raises(tr.InputError, match="MPa"):
        line_of(written(tmp_path, ("load [kN]", "cycles", "failed")))


@pytest.mark.parametrize("head", ["stress_range", "delta_sigma", "max_stress", "strain"])
def test_a_range_or_another_quantity_is_no_amplitude(tmp_path, head):
    with pytest.raises(tr.InputError, match=f"{head}' is not known"):
        line_of(written(tmp_path, (head, "cycles", "failed")))


def test_words_of_a_head():
    assert normal(" Run-Out ") == "run_out"
    assert normal("Stress S") == "stress_s"
