"""The rule behind a maker's catalogue: exponent and offset from made lives, what a table cannot tell, bad tables."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import trackroller as tr
from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.fit.catalogue import CatalogueFit
from trackroller.report.pages.life_rule import OURS, entry_text, sentences

ROOT = Path(__file__).parents[2]
FACTORS = np.array([0.05, 0.1, 0.2, 0.4, 0.7, 1.0])


def lives(power, offset, basic=100.0, digits=4):
    """Return the lives of a rule, printed with so many digits as catalogues do."""
    exact = basic / (offset + (1.0 - offset) * FACTORS) ** power
    return [float(f"{life:.{digits}g}") for life in exact]


@pytest.mark.parametrize(("power", "offset", "law"), [(2, 0.03, "dry"), (3, 0.03, "lubricated"), (3, 0, "cubic")])
def test_the_rule_of_a_table_is_found(power, offset, law):
    fit = tr.fit_catalogue({"load_factor": FACTORS, "life": lives(power, offset)})
    assert fit.exponent == pytest.approx(power, abs=2e-3) and fit.offset == pytest.approx(offset, abs=2e-4)
    assert fit.basic_life == pytest.approx(100.0, rel=1e-3)
    for name, true in (("exponent", power), ("offset", offset)):
        low, high = fit.interval(name)
        assert low - 1e-9 <= true <= high, name
    others = [deviation for name, deviation in fit.laws.items() if name != law]
    assert fit.laws[law] < 1e-3 < min(others)


def test_the_found_entry_gives_the_lives_of_the_table():
    loads = [40, 100, 250, 800]
    km = [100 / (0.05 + 0.95 * load / 800) ** 2.4 for load in loads]
    fit = tr.fit_catalogue({"load": loads, "permissible_load": [800] * 4, "life": km})
    assert fit.catalogue["radial_force"] == 800.0
    own = fit.catalogue | {"axial_force": 300}
    cases = [tr.Case(radial_force=-load, motor_force=0, axial_force=0, catalogue=own) for load in loads]
    ds = tr.solve(cases, ("bearing",), contact_model="sliding", accuracy="preview")
    assert ds.catalogue_life_km.values == pytest.approx(km, rel=1e-4)


@pytest.mark.slow
def test_nine_of_ten_intervals_hold_the_truth():
    """Lives that scatter by 10 %; 300 tables, of which 90 % +- 3.5 % (two deviations) hold each value."""
    rng = np.random.default_rng(5)
    factors = np.repeat(FACTORS, 3)
    inside = np.zeros(2)
    for _ in range(300):
        km = 100 / (0.05 + 0.95 * factors) ** 2.5 * np.exp(0.1 * rng.standard_normal(len(factors)))
        fit = CatalogueFit(None, factors, km)  # these lives need not fall from row to row
        for i, (name, true) in enumerate((("exponent", 2.5), ("offset", 0.05))):
            low, high = fit.interval(name)
            inside[i] += low <= true <= high
    assert (np.abs(inside / 300 - 0.9) < 0.045).all()


def test_an_offset_that_no_small_load_shows_is_said():
    table = {"load_factor": [0.6, 0.8, 1.0, 1.2], "travel": [275, 156, 100, 70]}
    fit = tr.fit_catalogue(table)
    assert any(text.startswith("The loads hardly tell the offset") for text in sentences(fit))
    held = tr.fit_catalogue(table, offset=0.03)
    assert held.offset == 0.03 and held.interval("offset") == (0.03, 0.03)
    low, high = held.interval("exponent")
    assert high - low < 0.5 * (fit.interval("exponent").high - fit.interval("exponent").low)
    assert any("(held)" in text for text in sentences(held))


def test_as_many_rows_as_values_have_no_interval():
    fit = tr.fit_catalogue({"load_factor": [0.25, 1.0], "life": [1600, 100]}, offset=0)
    assert fit.exponent == pytest.approx(2.0) and np.isnan(fit.interval("exponent")).all()
    assert "90 %" not in sentences(fit)[0]


def test_our_exponents_are_those_of_the_page_of_measurements():
    measured = json.loads((ROOT / "docs" / "data" / "measured.json").read_text(encoding="utf-8"))
    for limit, exponent in measured["lives"]["exponents"].items():
        assert -exponent == pytest.approx(OURS[limit], abs=5e-3)


BAD = (
    ("load_factor,life\n0.1,1000\n0.2,2000\n0.5,100\n", "line 3", "larger load factor"),
    ("load_factor,life\n0.1,1000\n0.2,\n0.5,100\n", "line 3", "empty"),
    ("load_factor,life\n0.1,1000\n0.2,often\n0.5,100\n", "line 3", "life"),
    ("load_factor,life\n0.1,1000\n0.5,100\n", "", "hold the offset: --offset 0"),
    ("load_factor,life\n0.5,100\n0.5,100\n", "", "Add rows with other loads."),
    ("load_factor,load,life\n0.1,80,1000\n0.2,160,200\n", "", "Remove load"),
    ("load,life\n80,1000\n160,200\n", "", "permissible_radial_force"),
    ("load,permissible_load,life\n80,800,1000\n-160,800,200\n240,800,100\n", "line 3", "above 0"),
    ("load_factor\n0.1\n0.2\n", "line 1", "column travel"),
)


@pytest.mark.parametrize(("text", "line", "words"), BAD, ids=[words for _, _, words in BAD])
def test_a_bad_table_is_told(tmp_path, text, line, words):
    path = tmp_path / "series.csv"
    path.write_text(text)
    with pytest.raises(InputError) as error:
        tr.fit_catalogue(path)
    assert line in str(error.value) and words in str(error.value)


@pytest.mark.parametrize("offset", [-0.1, 1, "much"])
def test_an_offset_is_a_share(offset):
    with pytest.raises(InputError, match="offset"):
        tr.fit_catalogue({"load_factor": FACTORS, "life": lives(2, 0)}, offset=offset)


def test_the_command_prints_the_rule_and_writes_its_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = "\n".join(f"{800 * f:g},0.8,{km:g}" for f, km in zip(FACTORS, lives(3, 0.03), strict=True))
    (tmp_path / "series.csv").write_text(f"load [N],permissible_load [kN],life [km]\n{rows}\n")
    done = CliRunner().invoke(app, ["fit", "catalogue", "series.csv", "--report", "rule.html"])
    assert done.exit_code == 0, done.output
    fit = tr.fit_catalogue("series.csv")
    assert entry_text(fit.catalogue) in done.output and "the nearest law, 'lubricated'" in done.output
    assert "Read load as radial_force" in done.output
    page = (tmp_path / "rule.html").read_text()
    assert "our life by wear, rolling freely" in page and "law: lubricated" in page
    assert tr.report(fit, tmp_path / "again.html").read_text().count("<figure>") == 1


def test_the_name_of_the_page_reaches_the_terminal_escaped(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = "\n".join(f"{f:g},{km:g}" for f, km in zip(FACTORS, lives(3, 0.03), strict=True))
    (tmp_path / "series.csv").write_text(f"load_factor,travel [km]\n{rows}\n")
    done = CliRunner().invoke(app, ["fit", "catalogue", "series.csv", "--report", "a\x1b[31m.html"])
    assert done.exit_code == 0 and "\x1b" not in done.output and r"a\x1b[31m.html" in done.output
