"""Notes on limits: each reads back the sentence that it writes."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from trackroller.materials import builtin_database
from trackroller.roller.dataset import NOTES
from trackroller.roller.limit_notes import Lack, Placeholder, lacks_of, placeholder_line, placeholders_of


def read(*lines):
    return xr.Dataset(attrs={NOTES: "\n".join(lines)})


def same(one, other):
    return replace(one, low=0.0, high=0.0) == replace(other, low=0.0, high=0.0) and np.array_equal(
        (one.low, one.high), (other.low, other.high), equal_nan=True
    )


@pytest.mark.parametrize("name", list(builtin_database().materials))
def test_every_placeholder_of_the_database_is_read_back(name):
    values = builtin_database().materials[name].guesses_of_limits
    written = [Placeholder.of("wear", name, key, value) for key, value in values.items()]
    found = placeholders_of(read(placeholder_line(written))) if written else []
    assert len(found) == len(written)
    for one, other in zip(found, written, strict=True):
        assert (one.name, one.note, one.on, one.material) == (other.name, other.note, other.on, name)
        assert (one.low, one.high) == pytest.approx((other.low, other.high), rel=1e-5, nan_ok=True)
        assert one.units == other.units.strip("-")


def test_notes_with_commas_and_brackets_and_values_without_a_range_are_read_back():
    written = [
        Placeholder("wear", "my 'own' steel", "wear_coefficient", "on PA6, dry (20 degC)", 1e-5, 2e-5, "mm3/(N m)"),
        Placeholder("wear", "my 'own' steel", "density"),
        Placeholder("wear", "my 'own' steel", "hardness", "as delivered", 200.0, 240.0, "HB"),
    ]
    found = placeholders_of(read("temperature: density of material 'x' are those.", placeholder_line(written)))
    assert [one.on for one in found] == ["PA6", "", ""]
    assert all(same(one, other) for one, other in zip(found, written, strict=True))


def test_what_is_missing_is_read_back():
    lacks = [
        Lack("heat", "cooled_area", remedy="Add it to the case: the surface. A second sentence."),
        Lack("wear", "density", "mine", "Enter it."),
    ]
    assert lacks_of(read(*(one.line for one in lacks), "temperature: of material 'x' are those.")) == lacks
