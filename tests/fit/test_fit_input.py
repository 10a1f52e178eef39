"""What fits refuse in words: numbers that are not finite, tables that are none, priors, and a disk that fills."""

from __future__ import annotations

import errno
import math
import os
import re
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import trackroller as tr
from trackroller.errors import WorkError
from trackroller.fit.coupons import of_words
from trackroller.fit.depths import fit_wear
from trackroller.fit.stored import stored_fit
from trackroller.materials.file import posterior_path

UNDER = {"load_type": "axial", "stress_ratio": -1, "like": "1.7225-normalised"}
RIG = {"motor_force": 0, "friction_coefficient": 0.1, "axial_force": 20, "contact_model": "sliding"}
ROWS = {
    "amplitude": [900, 900, 800, 800, 700, 700], "cycles": [9e4, 1.3e5, 2e5, 3.5e5, 8e5, 1e6], "failed": [True] * 6,
}  # fmt: skip
BENCH = {
    "radial_force": [-120, -120, -150, -150, -180, -180, -210, -210, -130, -165],
    "travel_from": [130, 200, 100, 50, 41.5, 25, 43.4, 31.7, 90, 23.7],
    "travel_to": [130, None, 150, 75, 41.5, 50, 43.4, 31.7, 90, 23.7],
    "end": ["fatigue roller", "none", *["fatigue roller"] * 6, "bearing", "fatigue roller"],
}


def with_cell(rows, column, value, row=1):
    cells = list(rows[column])
    cells[row] = value
    return rows | {column: cells}


@pytest.mark.parametrize("value", [math.inf, -math.inf, "inf", "-inf", 1e300, np.float64(np.inf)])
@pytest.mark.parametrize("column", ["amplitude", "cycles"])
@pytest.mark.parametrize("kind", [dict, pd.DataFrame])
def test_an_infinite_or_impossible_number_is_refused_by_row_and_column(column, value, kind):
    with pytest.raises(tr.InputError, match=rf"row 2, {column} = .*a finite number"):
        tr.fit_sn(kind(with_cell(ROWS, column, value)), **UNDER)


@pytest.mark.parametrize("column", ["amplitude", "cycles"])
def test_an_infinite_cell_of_a_file_is_refused_by_line(tmp_path, column):
    path = tmp_path / "tests.csv"
    pd.DataFrame(with_cell(ROWS, column, "inf")).to_csv(path, index=False)
    with pytest.raises(tr.InputError, match=rf"tests\.csv, line 3: {column} = 'inf.*finite"):
        tr.fit_sn(path, **UNDER)


@pytest.mark.parametrize("column", ["travel_from", "travel_to"])
def test_an_infinite_travel_is_no_suspension(column):
    """An end at an infinite travel counts neither as an end nor as a suspension; the remedy gives a suspension."""
    with pytest.raises(tr.InputError, match=rf"row 1, {column} = inf.*finite"):
        tr.fit_bench(with_cell(BENCH, column, math.inf, 0), base=RIG)
    mended = with_cell(with_cell(BENCH, "travel_to", None, 0), "end", "none", 0)
    assert tr.fit_bench(mended, base=RIG).groups[0].line.tests.failed.sum() == 7


@pytest.mark.parametrize("value", [math.inf, 1e300])
def test_an_infinite_or_impossible_depth_or_travel_is_refused(value):
    table = {"travel": [100.0, 220.0, 400.0], "wear_depth": [0.01, 0.02, 0.03]}
    for column in table:
        with pytest.raises(tr.InputError, match=rf"row 2, {column} = (inf|1e\+300).*a finite number"):
            fit_wear(with_cell(table, column, value))
    with pytest.raises(
        tr.InputError, match=rf"row 1, end = 'wear roller {value:g} mm'.*finite depth".replace("+", r"\+")
    ):
        tr.fit_bench(with_cell(BENCH, "end", f"wear roller {value:g} mm", 0), base=RIG)
    for column in ("travel_from", "travel_to"):
        with pytest.raises(tr.InputError, match=rf"{column} = "):
            tr.fit_bench(with_cell(BENCH, column, value, 2), base=RIG)


@pytest.mark.parametrize("value", [pd.NA, pd.NaT, None, math.nan, " "])
@pytest.mark.parametrize("column", ["amplitude", "cycles"])
@pytest.mark.parametrize("kind", [dict, pd.DataFrame])
def test_an_empty_cell_is_named_and_the_remedies_work(value, column, kind):
    with pytest.raises(tr.InputError, match=rf"row 2, {column}.*the cell is empty. Fill the cell, or remove the row"):
        tr.fit_sn(kind(with_cell(ROWS, column, value)), **UNDER)
    removed = {name: cells[:1] + cells[2:] for name, cells in ROWS.items()}
    assert tr.fit_sn(kind(removed), **UNDER).groups[0].line.size == 5


@pytest.mark.parametrize("contact", [1.5, 3, "left", math.inf])
def test_a_contact_is_one_of_two(contact):
    with pytest.raises(tr.InputError, match=r"row 3, contact = "):
        tr.fit_bench(BENCH | {"contact": [1, 1, contact, *[1] * 7]}, base=RIG)


@pytest.mark.parametrize("name", ["slope", "scatter_in_cycles", "fatigue_strength"])
@pytest.mark.parametrize("place", [0, 1])
@pytest.mark.parametrize("value", [math.inf, math.nan, 1e300, 0.0, -5.0, "many"])
def test_a_prior_has_two_possible_numbers(name, place, value):
    pair = [8.0, 2.0]
    pair[place] = value
    with pytest.raises(tr.InputError, match=rf"prior\.{name}") as refused:
        tr.fit_sn(ROWS, prior={name: pair}, **UNDER)
    if advised := re.search(r"--prior (\S+)\.$", str(refused.value)):
        assert tr.fit_sn(ROWS, prior=of_words([advised[1]], "--prior"), **UNDER).groups[0].priors


@pytest.mark.parametrize("word", ["slope=inf,2", "slope=8,inf", "slope=8", "slope", "slope=8,2,1"])
def test_words_of_a_prior_are_two_finite_numbers(word):
    with pytest.raises(tr.InputError, match=r"--prior = .*For example slope=8,2"):
        of_words([word], "--prior")


def test_a_prior_that_stands_twice_is_refused():
    with pytest.raises(tr.InputError, match=r"--prior = 'slope=9,1' stands beside another slope.*Give slope once"):
        of_words(["slope=8,2", "slope=9,1"], "--prior")
    assert of_words(["slope=8,2", "scatter_in_cycles=4,1"], "--prior")["slope"] == [8, 2]


@pytest.mark.parametrize("prior", [[8, 2], "slope=8,2", 8, np.array([8, 2])])
def test_priors_without_names_are_refused_and_the_remedy_works(prior):
    with pytest.raises(tr.InputError, match=r"prior = .*such as \{'slope': \[8, 2\]\}"):
        tr.fit_sn(ROWS, prior=prior, **UNDER)
    assert tr.fit_sn(ROWS, prior={"slope": np.array([8, 2])}, **UNDER).groups[0].priors["slope"].mean == 8


@pytest.mark.parametrize("table", [None, 5, True, np.ones((4, 3)), [[900, 9e4, True]], [1, 2], {"amplitude": 900}])
@pytest.mark.parametrize("fitted", [tr.fit_sn, tr.fit_bench])
def test_what_is_no_table_is_refused(table, fitted):
    with pytest.raises(tr.InputError, match="tests"):
        fitted(table)


def test_columns_may_be_arrays_and_rows_mappings():
    expected = tr.fit_sn(ROWS, **UNDER).material
    arrays = {name: np.array(values) for name, values in ROWS.items()}
    assert tr.fit_sn(arrays, **UNDER).material == expected
    assert tr.fit_sn(pd.DataFrame(ROWS).to_dict("records"), **UNDER).material == expected


@pytest.mark.parametrize("design", [None, 5, [1, 2], "case"])
def test_a_life_is_asked_for_a_case(design):
    fit = tr.fit_sn(ROWS, **UNDER)
    with pytest.raises(tr.InputError, match=r"design.*a case, or a mapping"):
        fit.life_hours(design)
    assert fit.life_hours({"radial_force": -150, "motor_force": 0}).low > 0


@pytest.mark.parametrize("base", [5, [1], "rig.yaml"])
def test_a_base_is_a_mapping(base):
    depths = {"travel": [100.0, 220.0], "wear_depth": [0.01, 0.02]}
    for call in (lambda: tr.fit_bench(BENCH, base=base), lambda: fit_wear(depths, base)):
        with pytest.raises(tr.InputError, match=r"base = .*a mapping with fields of a case"):
            call()


@pytest.mark.parametrize("name", ["name", "like", "load_type", "knee"])
@pytest.mark.parametrize("value", [5, [1], np.array([1, 2]), math.inf, {"a": 1}])
def test_a_choice_of_another_type_is_refused(name, value):
    with pytest.raises(tr.InputError, match=name.replace("_", " ")):
        tr.fit_sn(ROWS, **UNDER | {name: value})


def test_a_group_of_a_table_without_groups_is_left_out():
    with pytest.raises(tr.InputError, match=r"group = 'A'.*has none. Leave the group out"):
        tr.fit_sn(ROWS, group="A", **UNDER)
    assert tr.fit_sn(ROWS, **UNDER).groups[0].line.size == 6


@pytest.mark.parametrize("quantity", [None, [1], np.array(["cycles", "slope"]), "zz"])
def test_an_unknown_quantity_of_a_fit_is_refused(quantity):
    fit = tr.fit_sn(ROWS, **UNDER)
    for call in (fit.interval, fit.estimate):
        with pytest.raises(tr.InputError, match="quantity"):
            call(quantity)


@pytest.mark.parametrize("value", [None, math.inf, 1e300, 1e-300, 0, "much", [900]])
def test_an_estimate_of_cycles_is_asked_for_a_finite_amplitude(value):
    fit = tr.fit_sn(ROWS, **UNDER)
    for call in (fit.estimate, fit.interval):
        with pytest.raises(tr.InputError, match="amplitude"):
            call("cycles", amplitude=value)
    with pytest.raises(tr.InputError, match=r"cycles.*a finite number from 1 to 1e\+15"):
        fit.interval("amplitude", cycles=value)


@pytest.mark.parametrize("more", [{"slope": math.inf}, {"scatter_in_cycles": math.inf}, {"stress_ratio": -math.inf}])
def test_a_choice_that_is_not_finite_is_refused(more):
    with pytest.raises(tr.InputError, match="inf"):
        tr.fit_sn(ROWS, **UNDER | more)


def test_held_values_may_be_texts():
    given = tr.fit_sn(ROWS, slope="8", scatter_in_cycles="4", **UNDER).material
    assert given == tr.fit_sn(ROWS, slope=8, scatter_in_cycles=4, **UNDER).material


def test_a_roller_with_two_contacts_is_one_test():
    """The contact that is whole counts in the likelihood, but neither among the tests nor for the cut-off."""
    fit = tr.fit_bench(BENCH | {"contact": [1] * 10}, base=RIG)
    line = fit.groups[0].line
    assert (line.size, len(line.tests.stress), int(line.tests.failed.sum())) == (10, 18, 8)
    assert line.cut_off(0.9) == tr.fit_bench(BENCH, base=RIG).groups[0].line.cut_off(0.9)
    assert fit.data.attrs["fatigue_tests"] == 10


WRITES = (
    (xr.Dataset, "to_netcdf"), (Path, "write_text"), (Path, "write_bytes"), (os, "fsync"), (os, "replace"),
    (shutil, "copy2"),
)  # fmt: skip


def fails_at(patch, number):
    """Let a write to the disk fail by its number, the first being 1; return the list of the writes so far."""
    made = []

    def counted(write):
        def call(*args, **more):
            made.append(write)
            if len(made) == number:
                raise OSError(errno.ENOSPC, "No space left on device")
            return write(*args, **more)

        return call

    for place, name in WRITES:
        patch.setattr(place, name, counted(getattr(place, name)))
    return made


def contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("existing", [False, True])
def test_a_disk_that_fills_changes_neither_material_nor_posterior(tmp_path, monkeypatch, existing):
    """Each write to the disk fails once; the same call then writes both."""
    fit = tr.fit_sn(ROWS, name="rail", **UNDER)
    failures = 0
    for number in range(1, 100):
        file = tmp_path / str(number) / "materials.yaml"
        if existing:
            tr.fit_sn(with_cell(ROWS, "cycles", 1.4e5), name="rail", **UNDER).write(file)
        before = contents(tmp_path)
        with monkeypatch.context() as patch:
            made = fails_at(patch, number)
            try:
                fit.write(file, replace=existing)
            except (tr.InputError, WorkError) as error:
                assert "disk is full" in str(error), number
                assert contents(tmp_path) == before, number
                failures += 1
        if file.exists() and not existing:
            assert posterior_path(file, "rail").is_file()
        fit.write(file, replace=True)
        stored = stored_fit("rail", tr.load_database(file).material("rail").as_dict(), file)
        assert stored.line.estimate.tolist() == pytest.approx(fit.groups[0].line.estimate.tolist(), rel=1e-9)
        if len(made) < number:
            break
    assert failures == (8 if existing else 6)  # that a folder is not flushed is no failure


def test_a_refused_name_keeps_the_posterior_and_the_remedy_works(tmp_path):
    file, other = tmp_path / "materials.yaml", with_cell(ROWS, "cycles", 1.4e5)
    tr.fit_sn(ROWS, name="rail", **UNDER).write(file)
    before = contents(tmp_path)
    with pytest.raises(tr.InputError, match=r"--replace"):
        tr.fit_sn(other, name="rail", **UNDER).write(file)
    assert contents(tmp_path) == before
    for more in ({"name": "rail", "replace": True}, {"name": "rail 2"}):
        name = more.pop("name")
        tr.fit_sn(other, name=name, **UNDER).write(file, **more)
        assert posterior_path(file, name).read_bytes() != before[posterior_path(file, "rail")]


def test_a_material_like_an_unknown_one_leaves_nothing(tmp_path):
    with pytest.raises(tr.InputError, match=r"like = 'nope' is not known"):
        tr.fit_sn(ROWS, name="rail", **UNDER | {"like": "nope"}).write(tmp_path / "config" / "materials.yaml")
    assert not list(tmp_path.iterdir())


def test_a_home_that_is_not_known_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(tr.InputError, match=r"materials file = '~nobody-here/m.yaml'.*Write the whole path"):
        tr.fit_sn(ROWS, name="rail", **UNDER).write("~nobody-here/m.yaml")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("place", [None, 5, [1], "", "/", "folder"])
def test_a_materials_file_is_the_path_of_a_file(tmp_path, monkeypatch, place):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder").mkdir()
    with pytest.raises(tr.InputError, match=r"materials file .*config/materials\.yaml"):
        tr.fit_sn(ROWS, name="rail", **UNDER).write(place)
    assert [path.name for path in tmp_path.rglob("*")] == ["folder"]
    tr.fit_sn(ROWS, name="rail", **UNDER).write("config/materials.yaml")


@pytest.mark.parametrize("place", [None, 5, "", "page.txt"])
def test_a_page_is_the_path_of_a_page(place):
    with pytest.raises(tr.InputError, match="report"):
        tr.fit_sn(ROWS, name="rail", **UNDER).report(place)


@pytest.mark.parametrize("name", ["x" * 101, "a\nb", "\x1b[31mred"])
def test_a_name_is_one_short_line(name):
    depths = {"travel": [100.0, 220.0], "wear_depth": [0.01, 0.02]}
    for call in (
        lambda: tr.fit_sn(ROWS, **UNDER, name=name),
        lambda: tr.fit_bench(BENCH, base=RIG, name=name),
        lambda: fit_wear(depths, RIG, name=name),
    ):
        with pytest.raises(tr.InputError, match=r"name = .*one line of at most 100 characters"):
            call()
    assert tr.fit_sn(ROWS, **UNDER, name="rig steel").name == "rig steel"


def test_a_table_without_columns_is_told_so():
    with pytest.raises(tr.InputError, match="The table has no columns"):
        tr.fit_sn([{}])
