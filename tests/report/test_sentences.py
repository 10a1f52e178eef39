"""Sentences that earlier reports got wrong, each on data where the old sentence fails."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml

from trackroller.report.numbers import percent, percent_up, plus_minus, share
from trackroller.report.tables.table import Table
from trackroller.report.workbook import export
from trackroller.results.validity_flags import SLIDING_ERROR
from trackroller.study.file.load import parse_study


def study(columns, **results):
    """Return a gathered study along `case` from columns of factors and results."""
    n = len(next(iter(columns.values())))
    ds = xr.Dataset({k: ("case", np.asarray(v)) for k, v in results.items()}, coords={"case": np.arange(n)})
    ds = ds.assign_coords({k: ("case", np.asarray(v)) for k, v in columns.items()})
    ds.attrs["study"] = yaml.safe_dump({"factors": {k: {} for k in columns}})
    return ds


def test_a_share_is_never_rounded_to_all_or_none():
    assert share(5399, 5400) == "99.98 %" and share(1, 5400) == "0.02 %"
    assert share(5400, 5400) == "100 %" and share(0, 5400) == "0 %"
    for whole in (7, 300, 12345):
        for part in range(1, whole, max(whole // 50, 1)):
            told = float(share(part, whole).removesuffix(" %"))
            assert 0 < told < 100 and told == pytest.approx(100 * part / whole, abs=0.51)


def test_a_largest_error_is_never_rounded_down():
    told = [percent_up(error) for error in (0.01487, 0.0013, 1.591, 0.0999, 0.0)]
    assert told == ["1.5 %", "0.13 %", "160 %", "10 %", "0 %"]
    for error in np.random.default_rng(2).uniform(1, 10, 300) * 10.0 ** np.arange(-5, 1).repeat(50):
        percents = float(percent_up(error).removesuffix(" %").replace(",", ""))
        assert 100 * error * (1 - 1e-9) <= percents <= 110 * error


def test_plus_minus_is_half_the_interval_in_sentence_and_table():
    assert percent(0.5, 0.40, 0.52) == "50 ± 6 %" and plus_minus(0.5, 0.40, 0.52) == "0.500 ± 0.060"


def with_error(middle):
    """Return a sample whose friction energy misses the work put in by about `middle`."""
    factors = {"roller_profile_radius": {"uniform": [-9, -7]}, "contact_angle": {"uniform": [30, 40]}}
    asked = parse_study({"name": "e", "method": "lhs", "samples": 60, "factors": factors})
    ds = asked.design()
    power = np.random.default_rng(3).uniform(1, 5, 60)
    ds["roller_life_hours"], ds["energy_residual"] = ("case", 1e3 * power), ("case", np.full(60, middle))
    both = np.stack([power, power], axis=1)
    ds["friction_power"] = (("case", "contact"), both, {"units": "W", "long_name": "friction power"})
    ds["regime"] = ("case", np.zeros(60, "i1"))
    return ds.assign_coords(contact=[1, 2])


def test_error_of_full_sliding_that_is_told_is_the_measured_one():
    told = [float(n) for n in re.findall(r"[0-9]+", SLIDING_ERROR)]
    found = json.loads((Path(__file__).parents[2] / "docs/data/contact_spin.json").read_text())["all"]["friction_force"]
    assert told == [round(100 * found["median"]), found["designs"]]


def test_texts_that_a_spreadsheet_would_run_are_inert_in_csv_files(tmp_path):
    import csv

    hostile = ["=cmd|'/C calc'!A0", "+1+1", "@SUM(A1)", "-2+3", "\tx"]
    harmless = ["-6.4", "1.7225-normalised", "−7 mm", -3.5, 1e-5]
    paths = export([Table("t", "Title", ["Name", "=head"], [[text, 1] for text in hostile + harmless])], tmp_path)
    with paths[0].open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert [row[0] for row in rows[1:]] == [f"'{text}" for text in hostile] + [str(v) for v in harmless]
    assert rows[0] == ["Name", "'=head"]
