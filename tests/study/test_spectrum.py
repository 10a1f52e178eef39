"""Load spectra: overrollings and damage per shift, life in shifts, and files that are wrong."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from limit_rows import part_of

import trackroller as tr
from trackroller.damage.sn_curve import SNCurve
from trackroller.errors import InputError
from trackroller.materials import builtin_database
from trackroller.results.spectrum_answer import answer_of_spectrum
from trackroller.study.spectrum.file import Spectrum, load_spectrum, overrollings_per_shift
from trackroller.study.spectrum.solve import solve_spectrum

ROOT = Path(__file__).parents[2]
RADIUS = 21.75 - 6 * math.cos(math.radians(30))
STEEL = SNCurve(720.0, 360.0, 1e4, 5e6)
SCATTERED = {"like": "1.7225-normalised", "scatter_in_cycles": 4.0}
DB = builtin_database()


def life_of(ds, body):
    """Return the row of the median life of a body by fatigue."""
    lives = part_of(answer_of_spectrum(ds), "lives")
    return lives[(lives["body"] == body) & (lives["probability"] == 0.5)].iloc[0]


def spectrum(*blocks, **more):
    return Spectrum.from_dict({"blocks": list(blocks), **more})


def stand_in(regimes=None, stress=None):
    """Return a solver whose peak stress is 2 MPa per N of radial force in contact 1 and 3 in contact 2, both bodies."""

    def solve(cases, outputs, database, **options):
        force = np.array([-case.radial_force for case in cases])
        peaks = force[:, None, None] * np.array([2.0, 3.0])[None, :, None] * np.ones((1, 1, 2))
        return xr.Dataset(
            {
                "peak_stress": (("case", "contact", "body"), peaks if stress is None else np.array(stress)),
                "regime": ("case", np.zeros(len(cases), np.int8) if regimes is None else np.array(regimes)),
            },
            coords={"contact": [1, 2], "body": ["roller", "guide"]},
        )

    return solve


def solved(spec, **kwargs):
    return solve_spectrum(spec, DB, solve=stand_in(**kwargs))


def test_roller_turns_distance_over_circumference_and_guide_counts_its_passes():
    spec = spectrum(
        {"distance": 3600, "velocity": 60, "guide_overrollings_per_hour": 120},  # one hour
        {"distance": 1800, "velocity": 30, "guide_overrollings": 7},
        {"distance": 100},
    )
    roller, guide = overrollings_per_shift(spec).T
    assert roller == pytest.approx(np.array([3600, 1800, 100]) * 1e3 / (2 * math.pi * RADIUS), rel=1e-12)
    assert guide[:2].tolist() == [120, 7] and np.isnan(guide[2])


def test_one_block_lasts_its_life_over_its_cycles():
    """Closed form: shifts = N(stress) / overrollings per shift, for each track and the first of them."""
    ds = solved(spectrum({"distance": 1000, "radial_force": -200, "guide_overrollings": 50}))
    turns = 1e6 / (2 * math.pi * RADIUS)
    lives = STEEL.life_cycles([400.0, 600.0])
    assert ds.life_shifts.sel(body="roller").values == pytest.approx(lives / turns, rel=1e-12)
    assert ds.life_shifts.sel(body="guide").values == pytest.approx(lives / 50, rel=1e-12)
    assert ds.roller_life_shifts.item() == pytest.approx(lives[1] / turns)
    assert ds.guide_life_shifts.item() == pytest.approx(lives[1] / 50)


def test_rates_of_damage_add_up():
    """One over the life of two blocks together is the sum of one over the life of each."""
    a = {"name": "a", "distance": 1000, "radial_force": -200, "guide_overrollings": 5}
    b = {"name": "b", "distance": 500, "radial_force": -230, "guide_overrollings": 9}
    both, one, other = (solved(spectrum(*blocks)).life_shifts for blocks in ((a, b), (a,), (b,)))
    assert (1 / both).values == pytest.approx((1 / one + 1 / other).values, rel=1e-12)


@pytest.mark.slow
@given(st.floats(10, 1e5), st.floats(1.01, 3), st.floats(20, 75))
@settings(max_examples=25, deadline=None)
def test_more_load_or_way_shortens_life(distance, factor, force):
    lives = [
        solved(spectrum({"distance": d, "radial_force": -f})).roller_life_shifts.item()
        for d, f in ((distance, force), (distance * factor, force), (distance, force * factor))
    ]
    assert lives[1] == pytest.approx(lives[0] / factor, rel=1e-9)
    assert lives[2] < lives[0]


def test_rules_and_critical_damage_change_life_as_they_should():
    """Small loads harm less by Haibach and not at all by Miner original; half the damage, half the life."""
    blocks = (
        {"name": "small", "distance": 1e4, "radial_force": -60},
        {"name": "big", "distance": 1, "radial_force": -200},
    )
    lives = [
        solved(spectrum(*blocks, life_rule=r)).roller_life_shifts.item() for r in ("elementary", "haibach", "unlimited")
    ]
    assert lives[0] < lives[1] < lives[2]
    half = solved(spectrum(*blocks, critical_damage=0.5)).roller_life_shifts.item()
    assert half == pytest.approx(lives[0] / 2)
    assert solved(spectrum(blocks[0], life_rule="unlimited")).roller_life_shifts.item() == math.inf


def test_a_block_in_which_a_contact_lifts_off_makes_the_life_unknown():
    """The solver has no stress after lift-off, so the damage of the block is not known, nor the life."""
    lifted = {"name": "lifted", "distance": 10, "axial_force": 200}
    ds = solve_spectrum(spectrum({"name": "calm", "distance": 10}, lifted, contact_model="sliding"))
    assert ds.regime.values.tolist() == [0, 2] and np.isnan(ds.damage.isel(block=1)).all()
    assert np.isnan(ds.roller_life_shifts) and "lifted (lift-off)" in life_of(ds, "roller")["why"]


def test_a_body_that_breaks_and_a_roller_that_skids_have_no_fatigue_life():
    """R_m of the steel is 720 MPa: contact 2 exceeds it from 240 N on; the other limits and blocks stay."""
    calm = {"name": "calm", "distance": 10, "radial_force": -100}
    heavy = {"name": "heavy", "distance": 10, "radial_force": -245}
    for blocks, regimes in (((calm, heavy), [0, 0]), ((calm, calm | {"name": "skids"}), [0, 1])):
        ds = solved(spectrum(*blocks, base={"roller_material": SCATTERED}), regimes=regimes)
        assert np.isnan(ds.damage.isel(block=1)).all() and np.isfinite(ds.damage.isel(block=0, body=0)).all()
        assert np.isnan(ds.roller_life_shifts) and np.isnan(ds.life_shifts_at_probability).all()
        still = solved(spectrum(blocks[0], blocks[1] | {"distance": 0}), regimes=regimes)
        assert np.isfinite(still.roller_life_shifts)


def test_a_spectrum_says_where_a_body_breaks_and_where_a_roller_skids():
    base = {"guide_overrollings_per_hour": 600, "friction_coefficient": 0.1, "motor_force": 0}
    calm = {"name": "calm", "distance": 10, "radial_force": -200}
    skids, breaks = ({**calm, "name": "slips", "motor_force": -60}, {**calm, "name": "blow", "radial_force": -4000})
    more = {"base": base, "contact_model": "sliding", "accuracy": "preview", "limits": ["fatigue"]}
    ds = solve_spectrum(spectrum(calm, skids, breaks, **more))
    row = life_of(ds, "roller")
    assert ds.regime.values.tolist() == [0, 1, 0] and np.isnan(ds.roller_life_hours)
    assert row["why"] == "its peak stress exceeds its tensile strength in blow; the roller skids in slips"
    assert np.isnan(row["hours"]) and row["at_most"] > 0
    assert ds.life_to_first_limit_shifts.values.tolist() == [0, 0], "it breaks in each shift"
    assert ds.limiting_mechanism.attrs["flag_meanings"].split()[int(ds.limiting_mechanism[0])] == "fatigue"
    slips = solve_spectrum(spectrum(calm, skids, **more))
    assert np.isnan(slips.life_to_first_limit_shifts).all(), "no life is known, and nothing ends it at once"


def test_a_failed_block_is_not_hidden_and_named():
    """A life that rests on a block without a stress is NaN, and the summary says which block."""
    stress = [[[400, 400], [500, 500]], np.full((2, 2), np.nan)]
    blocks = ({"name": "a", "distance": 10}, {"name": "jam", "distance": 10})
    ds = solved(spectrum(*blocks), regimes=[0, 3], stress=stress)
    assert np.isnan(ds.roller_life_shifts)
    assert "jam (failed)" in life_of(ds, "roller")["why"]
    bound = solved(spectrum(blocks[0]), stress=stress[:1]).roller_life_shifts.item()
    assert life_of(ds, "roller")["at_most"] == pytest.approx(bound * float(ds.duration.sum()), rel=1e-12)
    blocks[1]["distance"] = 0
    assert np.isfinite(solved(spectrum(*blocks), regimes=[0, 3], stress=stress).roller_life_shifts)


def test_a_block_by_distance_by_hours_and_by_share_of_the_time_are_the_same():
    """100 m/min: 6000 m are an hour. Three loads by share have the lives in hours that they have by distance."""
    base, loads = {"guide_overrollings_per_hour": 60.0}, ((-200, 100), (-100, 100), (-40, 50))
    stress = [[[400, 420], [500, 480]], [[300, 310], [350, 360]], [[200, 210], [250, 260]]]
    ways = {
        "distance": [n * 60.0 * v for n, (_, v) in zip((2, 5, 3), loads, strict=True)],
        "hours": [2, "5 h", 180.0 / 60.0],
        "share": ["20 %", 0.5, 0.3],
    }
    found = {}
    for key, amounts in ways.items():
        blocks = [
            {"name": str(n), key: amount, "radial_force": force, "velocity": speed}
            for n, (amount, (force, speed)) in enumerate(zip(amounts, loads, strict=True))
        ]
        made = spectrum(*blocks, base=base)
        assert made.by_share == (key == "share") and made.period == ("hour" if made.by_share else "shift")
        found[key] = solved(made, regimes=[0, 0, 0], stress=stress)
    for name in ("roller_life_hours", "guide_life_hours", "roller_life_km"):
        lives = [float(ds[name]) for ds in found.values()]
        assert lives == pytest.approx([lives[0]] * 3, rel=1e-12), name
    assert float(found["share"].duration.sum()) == pytest.approx(1.0)
    assert float(found["hours"].roller_life_shifts) == pytest.approx(float(found["share"].roller_life_hours) / 10)
    shifts = [column.name for column in answer_of_spectrum(found["share"]).columns if "shift" in column.name]
    assert shifts == []


def test_guide_life_is_unknown_without_its_overrollings_and_the_summary_says_what_to_give():
    ds = solved(spectrum({"distance": 10}))
    assert np.isnan(ds.guide_life_shifts) and np.isfinite(ds.roller_life_shifts)
    assert "guide_overrollings" in life_of(ds, "guide")["why"]


def test_scatter_of_the_material_gives_lives_at_failure_probabilities():
    """T_N = 4: the 90 % life is four times the 10 % one; the guide, of a material without scatter, has none."""
    ds = solved(spectrum({"distance": 10, "guide_overrollings": 1}, base={"roller_material": SCATTERED}))
    lives = ds.life_shifts_at_probability.sel(body="roller", contact=1)
    assert (lives.sel(probability=0.9) / lives.sel(probability=0.1)).item() == pytest.approx(4)
    assert lives.sel(probability=0.5).item() == pytest.approx(ds.life_shifts.sel(body="roller", contact=1).item())
    guide = ds.life_shifts_at_probability.sel(body="guide", contact=1)
    assert np.isnan(guide.sel(probability=0.1)) and np.isfinite(guide.sel(probability=0.5))
    assert "life_shifts_at_probability" not in solved(spectrum({"distance": 10}))


def test_every_variable_says_unit_and_meaning_and_the_set_survives_a_file(tmp_path):
    ds = solved(spectrum({"distance": 10, "name": "a"}, base={"roller_material": SCATTERED}))
    for name in ("distance", "overrollings", "peak_stress", "damage", "life_shifts", "roller_life_shifts"):
        assert {"units", "long_name"} <= set(ds[name].attrs)
    ds.to_netcdf(tmp_path / "spectrum.nc")
    with xr.open_dataset(tmp_path / "spectrum.nc") as again:
        assert again.block.values.tolist() == ["a"] and again.attrs["life_rule"] == "elementary"
        assert "failure at D = 1" in again.attrs["life_conventions"]


def test_delivered_example_with_the_real_solver():
    """The file in config/spectra runs; its damage is that of the lives the solver itself gives."""
    spec = load_spectrum(ROOT / "config" / "spectra" / "sorter.yaml")
    ds = solve_spectrum(spec, DB)
    lives = tr.solve([block.case for block in spec.blocks], outputs="life", life_rule="haibach", database=DB)
    expected = (ds.overrollings.values[:, None, :] / lives.life_cycles.values).sum(axis=0)
    assert ds.damage_sum.values == pytest.approx(expected, rel=1e-9)
    assert answer_of_spectrum(ds).kind == "lasts"


def test_blocks_from_a_table_are_those_of_the_list(tmp_path):
    (tmp_path / "shift.csv").write_text(
        "name,distance,radial_force,friction_coefficient,guide_overrollings\na,100,-50,0.2,10\n\nb,1e3,-80,upper,\n"
    )
    (tmp_path / "spec.yaml").write_text("blocks: shift.csv\nbase: {guide_overrollings_per_hour: 60}\n")
    spec = load_spectrum(tmp_path / "spec.yaml")
    same = spectrum(
        {"name": "a", "distance": 100, "radial_force": -50, "friction_coefficient": 0.2, "guide_overrollings": 10},
        {"name": "b", "distance": 1000, "radial_force": -80, "friction_coefficient": "upper"},
        name="spec",
        base={"guide_overrollings_per_hour": 60},
    )
    assert spec.name == "spec"
    assert [b.distance for b in spec.blocks] == [b.distance for b in same.blocks]
    assert np.array_equal(overrollings_per_shift(spec), overrollings_per_shift(same))
    assert [float(b.case.radial_force) for b in spec.blocks] == [-50, -80]


@pytest.mark.parametrize(
    ("values", "parts"),
    [
        ({"blocks": []}, ("blocks", "[]")),
        ({"block": []}, ("block", "'blocks'")),
        ({"blocks": [{"distance": 1}], "base": 3}, ("base", "3")),
        ({"blocks": ["loaded"]}, ("blocks[1]", "loaded")),
        ({"blocks": [{"name": "x"}]}, ("block 'x'.distance", "per shift")),
        ({"blocks": [{"distance": 1, "hours": 1}]}, ("block 'block 1'.hours", "one of distance, hours and share")),
        ({"blocks": [{"share": 0.5}, {"name": "b", "share": 0.4}]}, ("share", "add up to 1")),
        ({"blocks": [{"share": 1}, {"name": "b", "hours": 4}]}, ("block 'b'.share", "share in all blocks")),
        ({"blocks": [{"share": 1, "guide_overrollings": 9}]}, ("guide_overrollings", "per_hour")),
        ({"blocks": [{"distance": -1}]}, ("block 1", "distance", "-1")),
        ({"blocks": [{"distance": "far"}]}, ("distance", "far")),
        ({"blocks": [{"distance": float("inf")}]}, ("distance", "inf")),
        ({"blocks": [{"distance": 0}]}, ("distance", "more than 0")),
        ({"blocks": [{"distance": 1, "radial_forc": -3}]}, ("radial_forc", "'radial_force'")),
        ({"blocks": [{"distance": 1, "radial_force": 3}]}, ("block 'block 1'.radial_force", "3")),
        ({"blocks": [{"distance": 1, "axis_distance": 30}]}, ("axis_distance", "same in all blocks", "base")),
        ({"blocks": [{"distance": 1}], "base": {"axis_distance": -3}}, ("base.axis_distance", "-3")),
        ({"blocks": [{"distance": 1, "name": "a"}, {"distance": 1, "name": "a"}]}, ("blocks", "'a'", "own")),
        ({"blocks": [{"distance": 1}], "critical_damage": 0}, ("critical_damage", "0")),
        ({"blocks": [{"distance": 1}], "failure_probabilities": [10]}, ("failure_probabilities", "10")),
        ({"blocks": [{"distance": 1}], "life_rule": "haibuch"}, ("haibuch", "'haibach'")),
        ({"blocks": [{"distance": 1, "guide_overrollings": -2}]}, ("guide_overrollings", "-2")),
    ],
)
def test_a_wrong_spectrum_is_refused_with_block_field_and_remedy(values, parts):
    with pytest.raises(InputError) as caught:
        Spectrum.from_dict(values)
    assert all(part in str(caught.value) for part in parts), str(caught.value)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("blocks: [", ("YAML",)),
        ("blocks: nowhere.csv", ("blocks = 'nowhere.csv'", "a file below", "Check its name, or put it there")),
        ("blocks: short.csv", ("short.csv", "line 3", "2 cells")),
        ("blocks: twice.csv", ("distance, distance",)),
    ],
)
def test_a_file_that_cannot_be_read_is_named(tmp_path, text, parts):
    (tmp_path / "short.csv").write_text("name,distance\na,1\nb\n")
    (tmp_path / "twice.csv").write_text("distance,distance\n1,2\n")
    (tmp_path / "spec.yaml").write_text(text)
    with pytest.raises(InputError) as caught:
        load_spectrum(tmp_path / "spec.yaml")
    assert all(part in str(caught.value) for part in parts), str(caught.value)
    with pytest.raises(InputError, match=r"gone\.yaml"):
        load_spectrum(tmp_path / "gone.yaml")


def test_command_prints_the_shifts_of_the_delivered_example(tmp_path):
    """`trackroller spectrum FILE`: table and sentences, JSON, netCDF; a misspelt field ends with its name."""
    from typer.testing import CliRunner

    from trackroller.cli.main import app

    path = str(ROOT / "config" / "spectra" / "sorter.yaml")
    said = CliRunner().invoke(app, ["spectrum", path])
    assert said.exit_code == 0 and "then fatigue of the roller" in said.output and "empty return" in said.output
    told = json.loads(CliRunner().invoke(app, ["spectrum", path, "--json"]).output)
    assert told["regime"]["meaning"] == ["rolling"] * 3
    lives = {row["body"]: row for row in told["answer"]["parts"]["lives"]["rows"]}
    assert lives["roller"]["shifts"] == told["roller_life_shifts"]["value"]
    assert CliRunner().invoke(app, ["spectrum", path, "-o", str(tmp_path / "out.nc")]).exit_code == 0
    with xr.open_dataset(tmp_path / "out.nc") as kept:
        assert float(kept["roller_life_shifts"]) == told["roller_life_shifts"]["value"]
    (tmp_path / "wrong.yaml").write_text("blocks: [{name: a, distanc: 3}]")
    refused = CliRunner().invoke(app, ["spectrum", str(tmp_path / "wrong.yaml")])
    assert isinstance(refused.exception, InputError) and "distanc" in str(refused.exception)


def test_a_life_beyond_the_data_is_said_to_be():
    """More overrollings than N_k, or than 1e8, lie beyond the S-N data; fewer do not."""
    for force, beyond in ((-40.0, True), (-300.0, False)):
        ds = solved(spectrum({"distance": 1000.0, "radial_force": force, "guide_overrollings": 10.0}))
        total = float(ds.roller_life_shifts) * float(ds.overrollings.sel(body="roller").sum())
        assert (total > 5e6) == beyond and answer_of_spectrum(ds).headline["extrapolated"] == beyond
