"""The explorer's columns: the numbers of the study, small, in words, and safe inside a page."""

from __future__ import annotations

import base64
import json
import re
import shlex
import zlib
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
import yaml
from synthetic_results import grid_study, results_of, sampled_study
from typer.testing import CliRunner

from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.report.explorer.candidate_columns import candidate_columns
from trackroller.report.explorer.pack import MOST_BYTES, MOST_ROWS, RARE, affordable_rows, pack, sample_rows
from trackroller.report.explorer.page import explorer, pareto_rows, secured, write_explorer
from trackroller.report.explorer.rows import STATES, ExplorerColumn, collect, flag_text, solve_inputs
from trackroller.report.figures import style
from trackroller.results.pareto import pareto
from trackroller.results.stored_study import open_study
from trackroller.study.file.load import parse_study

FACTORS = {
    "friction_coefficient": [0.05, 0.3],
    "material_pair": ["POM / POM", "</script><img src=x onerror=alert(1)>"],
    "guide_curve_radius": [220.0, float("inf")],
    "axial_force": [0.0, 30.0, 130.0],
}
NAMES = {**FACTORS, "material_pair": ["POM / POM", "PA6 / 1.7225-normalised"]}


@pytest.fixture(scope="module")
def study():
    return grid_study(NAMES)


def as_table(ds, **keys):
    """Return the results as those of a table of cases, from which `pareto` can restore the design."""
    told = yaml.safe_load(ds.attrs["study"]) | {"method": "table", "factors": {}} | keys
    return ds.assign_attrs(study=yaml.safe_dump(told))


def unpacked(header, block):
    """Return the columns of a page by name, decoded as the script decodes them."""
    data = np.frombuffer(zlib.decompress(base64.b64decode(block)), np.uint8)
    found = {}
    for entry in header:
        part = data[entry["start"] : entry["start"] + entry["bytes"]]
        kind = np.dtype("<" + entry["type"])
        found[entry["name"]] = part.reshape(kind.itemsize, -1).T.copy().view(kind).ravel()
    return found


def test_columns_hold_every_bit_of_the_study(study):
    results = results_of(study)
    columns = collect(results)
    header, block = pack(columns)
    found = unpacked(header, block)
    known = (study["regime"] == 0) & ((study["validity"] & 4) == 0)  # a roller that skids or breaks has no life
    life = study["roller_life_hours"].where(known).values.ravel()
    assert np.isnan(life).any() and np.isfinite(life).any()
    assert found["roller_life_hours"].tobytes() == life.astype("<f8").tobytes()
    levels = next(h for h in header if h["name"] == "guide_curve_radius")["levels"]
    assert levels == [220.0, "inf"]
    codes = found["guide_curve_radius"].astype(int) - 1
    wanted = results.table["guide_curve_radius"].to_numpy()
    assert np.array_equal(np.array([float(level) for level in levels])[codes], wanted)
    peak = study["peak_stress"].isel(contact=1, body=0).values.ravel()
    assert np.array_equal(found["peak_stress_roller_2"], peak.astype("f4"), equal_nan=True)


def test_states_tell_every_case_that_is_left_out(study):
    ds = study.copy(deep=True)
    first = tuple(int(i[0]) for i in np.nonzero(ds["regime"].values == 0))
    ds["converged"][first] = 0
    ds["regime"][0, 0, 0, 1] = 3
    ds["reason"] = xr.full_like(ds["regime"], "", dtype=object)
    ds["reason"][0, 0, 0, 1] = "no convergence"
    results = results_of(ds)
    columns = {c.name: c for c in collect(results)}
    state = np.array(STATES)[columns["state"].values]
    assert (state == "valid").sum() == results.valid.sum() and state[1] == "failed"
    assert (state == "not converged").sum() == 1 == (state == "failed").sum()
    assert (state == "lift-off").sum() == (ds["regime"] == 2).sum()
    assert (state == "outside the model").sum() == (results.rolling & ~results.valid).sum()
    assert columns["reason"].texts[columns["reason"].values[1]] == "no convergence"
    assert flag_text(5, ["half_space", "yield", "static"]).startswith(
        "the patch is too large for a half-space; the peak"
    )
    assert flag_text(0, ["yield"]) == "none"


def test_missing_values_stay_missing():
    column = ExplorerColumn("x", "x", "", "factor", np.array([-1, 0, 1]), ("a", "b"), ("a", "b"))
    header, block = pack([column, ExplorerColumn("y", "y", "mm", "output", np.array([np.nan, np.inf, 1.0]))])
    found = unpacked(header, block)
    assert found["x"].tolist() == [0, 1, 2] and header[0]["type"] == "u1"
    assert np.array_equal(found["y"], [np.nan, np.inf, 1.0], equal_nan=True)


def test_a_large_study_is_sampled_with_all_rare_states_and_kept_cases():
    state = np.zeros(50_000, int)
    state[:20_000] = 1
    state[100:130] = 3
    keep = np.zeros(50_000, bool)
    keep[[5, 49_999]] = True
    rows = sample_rows(state, keep, most=10_000)
    assert len(rows) == pytest.approx(10_000, abs=5) and (np.diff(rows) > 0).all()
    assert {5, 49_999, *range(100, 130)} <= set(rows.tolist())
    assert (state[rows] == 1).sum() == pytest.approx(4_000, abs=60)
    assert np.array_equal(rows, sample_rows(state, keep, most=10_000))
    assert np.array_equal(sample_rows(state, keep, most=50_000), np.arange(50_000))


def test_a_state_of_small_share_keeps_its_least_number_of_cases():
    state = np.repeat([0, 1], [100_000, 2 * RARE])  # its share of 5,000 rows would be 98 cases
    rows = sample_rows(state, np.zeros(len(state), bool), most=5_000)
    assert np.bincount(state[rows])[1] == RARE


@pytest.mark.slow
def test_a_sampled_page_says_so_and_keeps_the_pareto_set(monkeypatch):
    monkeypatch.setattr(
        "trackroller.report.explorer.page.sample_rows", lambda s, k, most: sample_rows(s, k, min(most, 300))
    )
    monkeypatch.setattr("trackroller.report.explorer.pack.RARE", 10)
    ds = as_table(sampled_study(2_000), pareto={"roller_life_hours": "max", "friction_coefficient": "max"})
    content = explorer(results_of(ds))
    header = json.loads(content["header"])
    rows = unpacked(header["columns"], content["rows"])["row"]
    assert header["rows"] == len(rows) < header["cases"] == 2_000
    assert "of 2,000 cases are shown" in content["sampled"]
    front = np.flatnonzero(pareto_rows(results_of(ds), 2_000))
    assert len(front) and set(front) <= set(rows)
    for name in ("axial_force", "roller_life_hours"):
        values = ds[name].values[np.isfinite(ds[name].values) & (ds["regime"].values == 0)]
        shown = ds[name].values[rows.astype(int)]
        assert {values.min(), values.max()} <= set(shown.tolist())
    assert explorer(results_of(sampled_study(40)))["sampled"] == ""


def test_the_pareto_set_marks_the_rows_of_the_data_set():
    """Gathered dimensions stand in the order of the study file, here not that of the alphabet."""
    ds = grid_study({"velocity": [1.0, 2.0], "friction_coefficient": [0.1, 0.2, 0.3], "axial_force": [0.0, 30.0]})
    goals = {"roller_life_hours": "max", "friction_coefficient": "max"}
    ds.attrs["study"] = yaml.safe_dump(yaml.safe_load(ds.attrs["study"]) | {"pareto": goals}, sort_keys=False)
    rows = np.flatnonzero(pareto_rows(results_of(ds), 12))
    front = pareto(results_of(ds), goals)
    lives = front["roller_life_hours"].values[front["optimal"].values == 1]
    told = results_of(ds).table["roller_life_hours"].to_numpy()
    assert sorted(told[rows]) == sorted(lives) and len(rows)


def test_only_rows_of_the_most_exact_model_are_compared():
    ds = grid_study({"velocity": [1.0, 2.0], "axial_force": [0.0, 30.0]})
    models = ds.rename(velocity="contact_model").assign_coords(contact_model=["sliding", "kalker"])
    models.attrs["study"] = ds.attrs["study"].replace("velocity:", "contact_model:")
    told = [json.loads(explorer(results_of(each))["header"])["compared"] for each in (models, ds)]
    assert told == ["kalker", ""]


def test_a_material_has_the_colour_of_the_figures_in_every_study():
    """The same pairs in another order, beside another factor, keep their colours; other levels take the palette."""
    pairs = ["POM / POM", "PA6 / 1.7225-normalised", "1.7225-normalised / 1.7225-normalised"]
    found = []
    for order in (pairs, pairs[::-1]):
        ds = grid_study({"axial_force": [0.0, 30.0], "material_pair": order})
        entries = {c["name"]: c for c in json.loads(explorer(results_of(ds))["header"])["columns"]}
        pair = entries["material_pair"]
        found.append(dict(zip(pair["texts"], pair["colours"], strict=True)))
        assert entries["axial_force"]["colours"] == style.palette(2) and "colours" not in entries["state"]
    assert found[0] == found[1] and len(set(found[0].values())) == 3
    assert list(found[0].values()) == style.colours(list(found[0]), True)


def test_a_uniform_factor_does_not_stand_on_a_logarithmic_axis():
    """A uniform draw from 0.001 to 1 spans more than two decades; only a logarithmic distribution has such an axis."""
    for kind, log in (("uniform", False), ("loguniform", True)):
        factors = {"friction_coefficient": {kind: [0.001, 1.0]}, "axial_force": {"uniform": [0, 50]}}
        data = {"name": "axes", "method": "lhs", "samples": 400, "factors": factors, "outputs": ["forces"]}
        study = parse_study(data)
        ds = study.design().assign(regime=("case", np.zeros(400, np.int8))).assign_attrs(study=study.merged())
        column = collect(results_of(ds))[0]
        assert column.name == "friction_coefficient" and column.values.max() > 100 * column.values.min()
        assert column.log == log


def test_designs_and_conditions_are_numbered_where_designs_repeat(study):
    results = results_of(study)
    columns, lists = candidate_columns(results)
    found = {c.name: c.values for c in columns}
    assert set(found) == {"design", "design_worst", "condition"} and lists["design"]["factors"] == ("material_pair",)
    pair = results.table["material_pair"].to_numpy()
    lives = results.table["roller_life_hours"].where(results.valid).groupby(pair).min()
    assert np.array_equal(found["design_worst"], lives[pair].to_numpy(), equal_nan=True)
    assert [len(np.unique(pair[found["design"] == i])) for i in (0, 1)] == [1, 1]
    valid = np.bincount(found["condition"], results.valid)
    assert (np.diff(valid) >= 0).all() and lists["condition"]["of"] == len(valid) == 12
    hard = [row[-3] for row in lists["condition"]["rows"]]
    assert hard == [f"{int(n)} of 2" for n in valid]
    assert candidate_columns(results_of(sampled_study(40))) == ([], {})


def test_names_of_users_cannot_end_the_data_and_the_policy_allows_nothing_else(tmp_path):
    ds = grid_study({**FACTORS, "material_pair": ["POM / POM", "PA6 / 1.7225-normalised"]})
    ds = ds.assign_coords(material_pair=FACTORS["material_pair"])
    ds.attrs["study"] = ds.attrs["study"].replace("friction-and-fit", "'<b>x</b>'")
    text = write_explorer(results_of(ds), tmp_path / "explorer.html").read_text(encoding="utf-8")
    assert "<img" not in text and "<b>x" not in text and text.count("</script>") == 3
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]+)"', text)
    assert policy.startswith("default-src 'none'") and "unsafe" not in policy and "http" not in policy
    assert policy.count("sha256-") == 3 and "eval(" not in text and "new Function" not in text
    assert secured("<script>a</script>@content-security-policy@").endswith("style-src 'none'")


def test_a_page_of_5400_cases_stays_below_its_size():
    content = explorer(results_of(grid_study()))
    assert json.loads(content["header"])["rows"] == 5400
    assert sum(len(str(part).encode()) for part in content.values()) < 1_200_000


STUDY = """name: two rollers
base: {motor_force: 0}
factors:
  material_pair: {values: [[PA6, 1.7225-normalised], [POM, POM]]}
  guide_curve_radius: {values: [inf, -100.0]}
outputs: [forces, peak_stress, life]
contact_model: sliding
"""


@pytest.mark.slow
def test_the_commands_of_a_case_are_those_of_repeat(tmp_path, monkeypatch):
    """`explore` writes the page, and its settings are the ones that `repeat` prints for the same case."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.yaml").write_text(STUDY.replace("two rollers", "two-rollers"))
    runner = CliRunner()
    assert runner.invoke(app, ["run", "study.yaml", "-q"]).exit_code == 0
    done = runner.invoke(app, ["explore", "results/two-rollers"])
    assert done.exit_code == 0 and done.output.strip() == "results/two-rollers/explorer.html"
    with xr.open_dataset("results/two-rollers/study.nc") as opened:
        ds = opened.load()
    results = results_of(ds)
    columns = {c.name: c for c in collect(results)}
    settings, more = solve_inputs(results, columns)
    columns |= {c.name: c for c in more}
    for row in range(4):
        told = {}
        for key, value in settings:
            if isinstance(value, list):
                column = columns[value[0]]
                value = column.values[row] if column.levels is None else column.levels[column.values[row]]
            told[key] = str(value)
        printed = runner.invoke(app, ["repeat", "two-rollers", str(row)])
        assert printed.exit_code == 0
        words = shlex.split(printed.output.splitlines()[0])
        assert told == dict(word.split("=", 1) for word in words if "=" in word)


def test_a_folder_without_results_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"study.nc"):
        open_study(tmp_path)
    done = CliRunner().invoke(app, ["explore", str(tmp_path / "missing")])
    assert done.exit_code != 0


@pytest.mark.slow
def test_a_page_of_many_cases_and_columns_stays_below_its_size():
    """Random numbers do not compress: 40 such columns leave room for a fifth of 60,000 cases."""
    rng = np.random.default_rng(0)
    columns = [ExplorerColumn(f"x{i}", "x", "mm", "output", rng.normal(size=60_000)) for i in range(40)]
    rows = affordable_rows(columns)
    _, block = pack([replace(c, values=c.values[:rows]) for c in columns])
    assert 0.97 * MOST_BYTES < len(block) < 1.03 * MOST_BYTES and rows < 15_000
    assert affordable_rows([ExplorerColumn("x", "x", "mm", "output", np.zeros(60_000))]) == MOST_ROWS
