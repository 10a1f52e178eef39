"""The page "Against measurements": its numbers against closed forms, and what it says of them."""

import json
from pathlib import Path

import numpy as np
import pytest

from trackroller.materials.properties import Value
from validation.measured import page, solve
from validation.measured.facts import column, read
from validation.pages import render

ROOT = Path(__file__).parents[2]
OWN = json.loads((ROOT / "docs" / "data" / "measured.json").read_text(encoding="utf-8"))


def comparisons():
    """Return all sets by their titles."""
    facts = page.facts({"measured": OWN})
    return {one.title: one for one in (*facts["outside"], *facts["inside"])}


def test_the_twin_disc_follows_carter():
    """F/(mu F_N) = 1 - (1 - xi/(mu k b))^2 for like discs."""
    half = np.sqrt(4.0 * solve.DISC_FORCE * (1.0 - 0.3**2) * 2.0 / 206e3 / (np.pi * 10.0 * 2.0 / 23.5))
    creepage = 0.01 * column(read("twin_disc"), "longitudinal_creepage")
    friction = OWN["twin_disc"]["friction"]
    sticking = np.maximum(1.0 - creepage * 23.5 / (2.0 * friction * half), 0.0)
    np.testing.assert_allclose(OWN["twin_disc"]["traction"], friction * (1.0 - sticking**2), rtol=1e-3)
    pressure = 2.0 * solve.DISC_FORCE / (np.pi * half * 10.0)
    assert pressure == pytest.approx(1500.0, rel=1e-3)


def test_the_flash_of_the_twin_disc_is_that_of_one_dimensional_conduction():
    """int q(s)/sqrt(y - s) ds/sqrt(pi V/kappa)/K (Blok, Jaeger), whose error at this Péclet number is below 5 %."""
    half = 0.3114
    mean, largest = solve.flash_per_watt(half)
    conductivity, diffusivity = 0.046, 46e-3 / (7850e-9 * 460.0)
    place = np.linspace(-half, half, 4001)
    step = place[1] - place[0]
    heat = np.sqrt(1.0 - (place / half) ** 2) * 2.0 / (np.pi * half * 10.0) * 0.5
    rise = np.zeros(len(place))
    for i in range(1, len(place)):  # heat released at s reached the place y after the time (y - s)/V
        root = np.sqrt(np.arange(i + 1) * step)
        middle = 0.5 * (heat[i:0:-1] + heat[i - 1 :: -1])
        rise[i] = np.sum(middle * 2.0 * np.diff(root)) / np.sqrt(np.pi * 984.0 / diffusivity) / conductivity
    assert largest == pytest.approx(rise.max(), rel=0.05)
    assert mean == pytest.approx(rise.mean(), rel=0.05)


def test_the_flash_of_the_twin_disc_is_near_that_of_its_authors():
    """Their calculation has other thermal values, which are not stated, and an even heat density."""
    for name in ("flash_mean", "flash_largest"):
        ratio = np.array(OWN["twin_disc"][name]) / column(read("twin_disc"), name)
        assert (ratio > 1.0).all() and (ratio < 1.25).all()


def test_a_range_of_wear_that_was_taken_from_the_twin_disc_holds_it():
    """Without such a range the page says that the database lies outside."""
    own = page.wear_value(page.WHEEL_STEEL)
    coefficients = [page.measured_wear(regime, regime["work_to"]) for regime in read("twin_disc_wear")]
    holds = own.range[0] * 0.98 <= min(coefficients) and max(coefficients) <= own.range[1] * 1.02
    assert holds == (page.WEAR_SOURCE in own.source)
    assert holds or page.wear_of_twin_discs().outside


def test_wear_of_the_twin_disc_is_a_coefficient():
    """5.3 ug/(m mm2) for each N/mm2 at 7850 kg/m3 is 6.75e-4 mm3/J, and 3.1e-4 mm3/(N m) at mu 0.46."""
    mild, severe, _ = read("twin_disc_wear")
    assert page.measured_wear(mild, 10.4) == pytest.approx(0.46 * 5.3 / 7850.0)
    assert page.measured_wear(mild, 10.4) == pytest.approx(3.1e-4, rel=5e-3)
    assert page.measured_wear(severe, 77.2) == pytest.approx(4.2e-5, rel=1e-2)
    assert page.measured_wear(severe, 10.4) == pytest.approx(3.1e-4, rel=5e-3)


def test_the_film_meets_the_locomotive_and_bare_bodies_do_not():
    points = read("locomotive_creep")
    mean, deviation = column(points, "traction_mean"), column(points, "traction_deviation")
    film, bare = (np.array(OWN["locomotive"][name]) for name in ("film", "half_space"))
    assert np.mean(np.abs(film - mean) <= 2.0 * deviation) > 0.8
    assert np.mean(bare > mean + 2.0 * deviation) > 0.5


def test_what_lies_outside_stands_first():
    text = render("measured.md")
    first = text.index("## Where we are outside")
    second = text.index("## Where we are inside")
    for title, one in comparisons().items():
        place = text.index(f"### {title}")
        assert (first < place < second) == one.outside, title
    for title in ("Creep curve of a locomotive", "Creep curve of dry twin discs", "Makers' lives"):
        assert comparisons()[title].outside, title


def test_a_set_does_not_judge_what_was_taken_from_it():
    sets = comparisons()
    judged = [row.quantity for row in sets["Wheel in close grooves, differential slip"].rows if row.agrees is not None]
    assert judged and all(quantity.startswith("largest pressure") for quantity in judged)
    judged = [row.quantity for row in sets["Pin in a hole"].rows if row.agrees is not None]
    assert judged and all(quantity.startswith("width") for quantity in judged)


def test_every_table_has_a_source():
    text = (ROOT / "validation" / "measured" / "README.md").read_text(encoding="utf-8")
    for path in (ROOT / "validation" / "measured").glob("*.csv"):
        assert f"## {path.name}" in text, path.name


@pytest.mark.parametrize(
    ("ends", "source", "verdict"),
    [
        ((4e-5, 9e-4), "another test", "inside"),
        ((1e-5, 1e-4), "a guess", "outside in 4 of 6"),
        ((4e-5, 9e-4), "Lewis, Dwyer-Joyce", "not judged"),
    ],
)
def test_a_range_holds_the_wear_of_twin_discs_or_not(monkeypatch, ends, source, verdict):
    """The regimes give 3.1e-4, 4.2e-5 and 8.3e-4; a range that was taken from them is not judged by them."""
    own = Value(1e-4, "mm3/(N m)", source, placeholder=True, range=ends)
    monkeypatch.setattr(page, "wear_value", lambda steel: own)
    assert page.wear_of_twin_discs().verdict == verdict


@pytest.mark.slow
def test_the_stored_numbers_are_those_of_the_program():
    fresh = solve.locomotive("standard")
    np.testing.assert_allclose(fresh["film"], OWN["locomotive"]["film"], rtol=1e-6)
    own = solve.spin("standard")
    assert own["spin_moment"] == pytest.approx(OWN["spin"]["spin_moment"], rel=1e-6)
