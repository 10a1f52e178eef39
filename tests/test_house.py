"""The rules of the code are kept: rooms in one order, so no circles, small files, small functions.

ruff holds the number of arguments and imports inside functions.
"""

from __future__ import annotations

import pytest

from validation.house import LONGEST_FUNCTION, MOST_LINES, survey

LINES_OF_CODE = 27_685  # most lines of code in the package, without FOR_LIMITS
FOR_LIMITS = 1_835  # lines of the limits in the room `damage`, and of what declares and serves them
# formulas that a compiled kernel evaluates at one go; cutting them up would pass dozens of numbers around
LONG_FUNCTIONS = {
    "trackroller/halfspace/kernels.py:point_kernel": "six stresses below a point load",
    "trackroller/halfspace/kernels.py:bilinear_corner": "closed form of the corner of a bilinear cell",
}


@pytest.fixture(scope="module")
def house():
    return survey()


def test_the_top_of_the_package_has_few_entries(house):
    assert len(house.entries) <= 18, house.entries


def test_no_room_imports_a_later_room(house):
    assert house.upward == []


def test_files_are_short(house):
    assert not house.long_files(), f"over {MOST_LINES} lines: {house.long_files()}"


def test_functions_are_short(house):
    long = house.long_functions()
    assert set(long) <= set(LONG_FUNCTIONS), f"over {LONGEST_FUNCTION} lines of code: {long}"


def test_the_package_keeps_its_budget(house):
    assert sum(house.code.values()) <= LINES_OF_CODE + FOR_LIMITS


def test_the_counter_finds_what_it_counts(tmp_path):
    """A made-up package breaks each rule once."""
    lower, upper = tmp_path / "trackroller" / "contact", tmp_path / "trackroller" / "roller"
    for room in (lower, upper):
        room.mkdir(parents=True)
        (room / "__init__.py").write_text('"""A room."""\n')
    (tmp_path / "trackroller" / "__init__.py").write_text("")
    (upper / "case.py").write_text("from ..contact import hertz\n")
    (lower / "hertz.py").write_text(
        '"""Two lines\n\nof words."""\n\n# a comment\ndef f(a, b):\n    """Say."""\n'
        "    from trackroller.roller.case import Case\n" + 60 * "    a = b\n" + 300 * "\n"
    )
    house = survey(tmp_path)
    assert house.entries == ["__init__.py", "contact", "roller"]
    assert house.upward == ["trackroller/contact/hertz.py:8 imports trackroller.roller.case"]
    assert house.code["trackroller/contact/hertz.py"] == 62
    assert list(house.long_files()) == ["trackroller/contact/hertz.py"]
    assert house.long_functions() == {"trackroller/contact/hertz.py:f": 62}
