"""Sentences that earlier reports got wrong, each on data where the old sentence fails."""

from __future__ import annotations

import itertools
import json
import re
from pathlib import Path

import numpy as np
import openpyxl
import pytest
import xarray as xr
import yaml
from synthetic_results import grid_study, results_of
from told import effect_of, occurrence

from trackroller.report.numbers import percent, percent_up, plus_minus, share
from trackroller.report.pages.study import contents
from trackroller.report.tables.table import Table
from trackroller.report.words.accuracy import SLIDING_ERROR, friction_error, full_sliding
from trackroller.report.words.cases import validity_table
from trackroller.report.words.pareto import pareto_sentence
from trackroller.report.words.targets import robust_tables
from trackroller.report.workbook import export
from trackroller.study.file.load import parse_study


def study(columns, **results):
    """Return a gathered study along `case` from columns of factors and results."""
    n = len(next(iter(columns.values())))
    ds = xr.Dataset({k: ("case", np.asarray(v)) for k, v in results.items()}, coords={"case": np.arange(n)})
    ds = ds.assign_coords({k: ("case", np.asarray(v)) for k, v in columns.items()})
    ds.attrs["study"] = yaml.safe_dump({"factors": {k: {} for k in columns}})
    return ds


def test_a_trend_that_pooling_turns_is_told_by_category():
    """Life falls with friction in both materials, but the durable one was tried at high friction: pooled it rises."""
    rng = np.random.default_rng(0)
    pair = np.repeat(["PA6 / steel", "steel / steel"], 200)
    friction = np.where(pair == "PA6 / steel", rng.uniform(0.0, 0.3, 400), rng.uniform(0.2, 0.5, 400))
    life = 10 ** (2 - 3 * friction + 3 * (pair == "steel / steel") + rng.normal(0, 0.05, 400))
    low, high = np.median(life[friction < 0.2]), np.median(life[friction > 0.3])
    assert high > low  # all rows together suggest that friction lengthens the life
    results = results_of(study({"friction_coefficient": friction, "material_pair": pair}, roller_life_hours=life))
    said = effect_of(results, "roller_life_hours", "friction_coefficient", results.valid)
    effect = said.values["effect"]
    assert said.values["verb"] == "shortens"
    assert effect.ratio == pytest.approx(10 ** (-3 * (effect.high - effect.low)), rel=0.05)


def test_a_single_event_is_counted_and_attributed_to_nothing():
    results = results_of(grid_study())
    hit = np.zeros(len(results.table), bool)
    hit[77] = True
    said = occurrence(results, hit, "Lift-off")
    assert said.kind == "cases"
    assert (said.values["count"], said.values["of"]) == (1, len(hit))


def test_rolling_cases_outside_the_model_are_counted_by_body():
    ds = grid_study()
    roller, guide = (ds["validity"] & 4) > 0, (ds["validity"] & 8) > 0
    bits = xr.concat([roller * 4 + guide * 8, guide * 8 + 0 * roller], "body").astype("int32")
    ds["validity_body"] = bits.transpose(..., "body")
    results = results_of(ds)
    rolls = ds["regime"] == 0
    exceeds = int((roller & rolls).sum())
    rows = {(row[0], row[1]): row[3] for row in validity_table(results).rows}
    assert rows[("static", "roller")] == exceeds and ("static", "guide") not in rows


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
    asked = parse_study({"name": "e", "design": "lhs", "samples": 60, "factors": factors})
    ds = asked.design()
    power = np.random.default_rng(3).uniform(1, 5, 60)
    ds["roller_life_hours"], ds["energy_residual"] = ("case", 1e3 * power), ("case", np.full(60, middle))
    both = np.stack([power, power], axis=1)
    ds["friction_power"] = (("case", "contact"), both, {"units": "W", "long_name": "friction power"})
    ds["regime"] = ("case", np.zeros(60, "i1"))
    return ds.assign_coords(contact=[1, 2])


def test_full_sliding_is_told_where_no_friction_work_tells_its_error():
    whole = with_error(1.27).assign(contact_model_used=("case", np.repeat([0, 2], 30)))
    forces = whole.drop_vars(["energy_residual", "friction_power"])
    found = full_sliding(results_of(forces))
    assert found is not None and found.values["known"] == [SLIDING_ERROR] and "kalker" in found.text
    exact = forces.assign(contact_model_used=("case", np.full(60, 2)))
    assert full_sliding(results_of(whole)) is None and full_sliding(results_of(exact)) is None


def test_error_of_full_sliding_that_is_told_is_the_measured_one():
    told = [float(n) for n in re.findall(r"[0-9]+", SLIDING_ERROR)]
    found = json.loads((Path(__file__).parents[2] / "docs/data/contact_spin.json").read_text())["all"]["friction_force"]
    assert told == [round(100 * found["median"]), found["designs"]]


@pytest.mark.parametrize(("middle", "told"), [(1.27, True), (0.03, False)])
def test_a_known_model_error_above_5_percent_is_told_with_its_size(middle, told):
    ds = with_error(middle)
    said = friction_error(results_of(ds))
    assert (said is not None) == told
    assert said is None or said.values["median"] == pytest.approx(middle)
    found = contents(results_of(ds))
    sure = [s.text for s in dict(found["summary"]).get("How sure", [])]
    assert ((said and said.text) in sure) == told


def test_a_set_with_designs_outside_the_model_says_how_many():
    front = xr.Dataset(
        {
            "a": ("row", [3.0, 1.0], {"units": "h", "long_name": "life"}),
            "b": ("row", [3.0, 1.0], {"units": "W", "long_name": "power"}),
            "optimal": ("row", [1, 1]),
        },
        coords={"row": [0, 1]},
        attrs={"objectives": "a max, b min"},
    )
    ds = study({"axial_force": [0.0, 1.0]}, regime=[0, 1])
    assert pareto_sentence(front, results_of(ds)).values["outside"] == 1


def test_every_output_of_an_inner_outer_design_that_was_asked_for_has_a_table():
    names = ["roller_life_hours", "friction_power", "max_pressure"]
    dims, points = ("output", "point"), 2
    table = xr.Dataset(
        {
            **{n: (dims, np.ones((3, points))) for n in ("b10", "b10_low", "b10_high", "b10_safe", "mean")},
            "percentile_value": ((*dims, "percentile"), np.ones((3, points, 4))),
            "beyond_data": (dims, np.full((3, points), np.nan)),
            **{n: (("regime", "point"), np.zeros((4, points))) for n in ("probability", "probability_low")},
            "probability_high": (("regime", "point"), np.full((4, points), 0.03)),
        },
        coords={
            "output": names,
            "output_name": ("output", names),
            "output_units": ("output", ["h", "W", "MPa"]),
            "percentile": [5.0, 10.0, 50.0, 95.0],
            "regime": ["rolling", "full_slip", "lift_off", "failed"],
            "velocity": ("point", [30.0, 60.0]),
        },
        attrs={
            "outer_factors": "velocity",
            "log_life_scatter": 0.2,
            "outputs_named": 1,
        },
    )
    found = {t.name: t for t in robust_tables(table, None)}
    assert {f"percentiles_{n}" for n in names} | {"b10_roller_life_hours"} == set(found)
    assert not {"5 %", "50 %", "95 %", "Mean"} & set(found["b10_roller_life_hours"].heads)
    assert "T_N" in found["b10_roller_life_hours"].note


def test_tables_are_exported_as_csv_and_one_workbook_with_units_in_the_head(tmp_path):
    import csv

    tables = [t for t in contents(results_of(grid_study()))["tables"]["decide"] if t]
    paths = export(tables, tmp_path)
    assert paths[-1].name == "tables.xlsx" and len(paths) == len(tables) + 1
    with paths[0].open(encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert rows[0][1] == "Candidate 1" and any(row[0] == "Life of the roller, worst condition [h]" for row in rows)
    sheet = openpyxl.load_workbook(paths[-1]).worksheets[0]
    numbers = [value for row in sheet.values for value in row if isinstance(value, float)]
    life = next(row for row in tables[0].rows if row[0] == "Life of the roller, worst condition [h]")
    assert {f"{value:.14g}" for value in life[1:]} <= {f"{value:.14g}" for value in numbers}


def test_texts_that_a_spreadsheet_would_run_are_inert_in_csv_files(tmp_path):
    import csv

    hostile = ["=cmd|'/C calc'!A0", "+1+1", "@SUM(A1)", "-2+3", "\tx"]
    harmless = ["-6.4", "1.7225-normalised", "−7 mm", -3.5, 1e-5]
    paths = export([Table("t", "Title", ["Name", "=head"], [[text, 1] for text in hostile + harmless])], tmp_path)
    with paths[0].open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert [row[0] for row in rows[1:]] == [f"'{text}" for text in hostile] + [str(v) for v in harmless]
    assert rows[0] == ["Name", "'=head"]


def test_pairs_agree_with_a_closed_form():
    """Life 10^(3 - friction) exactly: every pair of friction 0 and 0.4 differs by 10^0.4."""
    friction, axial = np.array(list(itertools.product([0.0, 0.2, 0.4], [0.0, 10.0, 20.0, 30.0, 40.0, 50.0]))).T
    ds = study({"friction_coefficient": friction, "axial_force": axial}, roller_life_hours=10 ** (3 - friction))
    results = results_of(ds)
    said = effect_of(results, "roller_life_hours", "friction_coefficient", results.valid)
    values = said.values
    assert (values["low"], values["high"], values["ratio"]) == (0.0, 0.4, pytest.approx(10**-0.4))
    assert (said.kind, values["size"], values["rising"], values["falling"]) == ("pairs", 6, 0, 6)
    assert (values["fold"], values["verb"], values["changed"]) == ("2.51-fold", "shortens", [])
