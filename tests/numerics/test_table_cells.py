"""Cells are read as a person reads them: decimal and thousands signs, minus signs, units, heads."""

from __future__ import annotations

import random

import pytest
from examples import EXAMPLES

from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.table_cells import (
    AmbiguousNumber,
    RefusedCell,
    Stored,
    decimal_signs,
    plain_cell,
    plain_column,
    plain_labels,
    split_head,
)
from trackroller.numerics.units import split_quantity


@pytest.mark.parametrize(
    ("cell", "signs", "read"),
    [
        ("9.000", ",", "9000"),
        ("9.000", ".", "9.000"),
        ("-1,200", ".", "-1200"),
        ("1.234.567,8", "", "1234567.8"),
        ("1,234.5", "", "1234.5"),
        ("1,234,567", "", "1234567"),
        ("1'234.5", "", "1234.5"),
        ("1’234", "", "1234"),
        ("1\u00a0234,5", "", "1234.5"),
        ("1\u202f234 N", "", "1234 N"),
        ("0.125", "", "0.125"),
        ("0,125", "", "0.125"),
        ("1234.500", "", "1234.500"),
        ("\u22120,2 kN", "", "-0.2 kN"),
        ("– 300", "", "-300"),
        ("+5", "", "5"),
        ("1,5E3", "", "1.5e3"),
        ("1.5D+3", "", "1.5e+3"),
        ("1.200E3", "", "1.200e3"),
        ("8,152 1/h", ".", "8152 /h"),
        ("∞", "", "inf"),
        (Stored("1.234"), ",", "1.234"),
    ],
)
def test_a_number_is_read_as_a_person_reads_it(cell, signs, read):
    assert plain_cell(cell, signs) == read


@pytest.mark.parametrize("cell", ["9.000", "1,200", "12.345 kN", "8.152 1/h"])
@pytest.mark.parametrize("signs", ["", ".,"])
def test_a_number_that_other_cells_do_not_decide_is_refused(cell, signs):
    with pytest.raises(AmbiguousNumber, match="other cells do not tell"):
        plain_cell(cell, signs)
    (read,) = plain_column([cell], signs)
    assert isinstance(read, RefusedCell) and read == cell and read.message[1].startswith("Write ")


@pytest.mark.parametrize(
    "cell", ["dry", "", "-", "n/a", "200-", "(200)", "1_000", "1,00,000", "12.3.4", "1.2.2026", "1:30", "1/2", "0 123"]
)
def test_what_is_no_number_stays_and_no_reader_takes_it_for_one(cell):
    assert plain_cell(cell, ".") == cell
    assert number_or_nan(cell) != number_or_nan(cell) and split_quantity(cell) is None


def test_the_other_numbers_of_a_file_decide():
    assert decimal_signs(["9.000", "1,200", "7", "dry", Stored("1.5")]) == frozenset()
    assert decimal_signs(["9.000", "10,5"]) == {","}
    assert decimal_signs(["1,234,567"]) == {"."}
    assert decimal_signs(["10,5", "0.5"]) == {".", ","}


@pytest.mark.parametrize(
    ("column", "numbers"),
    [
        (["00123", "00124"], False),
        (["3E5", "1E2"], False),
        (["1.10", "1.9"], False),
        (["12345678901234567890"], False),
        (["+5"], False),
        (["1.9", "1,5"], False),
        (["1.200", "7"], False),
        (["1", "2.5", "-3"], True),
        (["1,5", "2"], True),
        ([Stored("1e+20"), Stored("3")], True),
        ([Stored("3"), "x"], False),
        ([RefusedCell("12", "", "")], False),
    ],
)
def test_a_column_of_labels_holds_numbers_only_if_each_is_written_as_its_number(column, numbers):
    read = plain_labels(column, ())
    assert all(isinstance(cell, Stored) for cell in read) if numbers else read == column


@pytest.mark.parametrize(
    ("head", "parts"),
    [
        ("radial_force [kN]", ("radial_force", "kN")),
        ("radial_force(kN)", ("radial_force", "kN")),
        ("radial_force / kN", ("radial_force", "kN")),
        ("radial_force, kN", ("radial_force", "kN")),
        ("radial_force in kN", ("radial_force", "kN")),
        ("velocity / (m/min)", ("velocity", "m/min")),
        ("velocity / m/min", ("velocity", "m/min")),
        ("friction_coefficient [-]", ("friction_coefficient", "-")),
        ("x", ("x", "")),
    ],
)
def test_a_head_has_a_name_and_a_unit(head, parts):
    assert split_head(head) == parts


def test_whatever_is_read_as_a_number_later_was_understood():
    """A cell that `plain` leaves alone is no number with a point or comma to the readers behind it."""
    rng = random.Random(1)
    pieces = ["1", "12", "123", "1234", "0", ".", ",", " ", "'", "-", "+", "e", "E3", "d", "N", "kN", "1/h", "/", "mm"]
    for _ in range(50 * EXAMPLES):
        cell = "".join(rng.choices(pieces, k=rng.randint(1, 6)))
        try:
            read = plain_cell(cell, "")
        except AmbiguousNumber:
            continue
        if read == cell and "." in cell and (split_quantity(cell) or number_or_nan(cell) == number_or_nan(cell)):
            assert decimal_signs([cell]) == {"."}, f"{cell!r} is read with a decimal point that nothing shows"
