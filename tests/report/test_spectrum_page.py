"""The sentences, the table, the figure and the page of a load spectrum, recomputed from the raw blocks."""

import math
import re

import numpy as np
import pytest
import xarray as xr
from limit_rows import limit_row, part_of

import trackroller as tr
from trackroller.materials import builtin_database
from trackroller.report.figures.spectrum import damage_by_block
from trackroller.report.headlines import headline_of
from trackroller.results.spectrum_answer import answer_of_spectrum
from trackroller.study.spectrum.file import Spectrum
from trackroller.study.spectrum.solve import solve_spectrum

DB = builtin_database()


def random_spectrum(seed, **material):
    """Solve two to six blocks by a made-up solver: stresses, lift-offs and failures at random."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 7))
    blocks = [
        {"name": f"b{i}", "distance": float(rng.uniform(1, 5000)), "velocity": float(rng.uniform(5, 90))}
        for i in range(count)
    ]
    passes = {"guide_overrollings_per_hour": 100.0} if rng.random() < 0.7 else {}
    spec = Spectrum.from_dict(
        {"blocks": blocks, "base": passes | material, "life_rule": rng.choice(["haibach", "unlimited"])}
    )
    stress = rng.uniform(80, 700, (count, 2, 2)) if rng.random() < 0.9 else np.full((count, 2, 2), 100.0)
    regime = rng.choice([0, 2, 3], count, p=[0.9, 0.06, 0.04])
    stress[regime > 0] = np.nan

    def solve(cases, outputs, database, **options):
        variables = {"peak_stress": (("case", "contact", "body"), stress), "regime": ("case", regime.astype(np.int8))}
        return xr.Dataset(variables, coords={"contact": [1, 2], "body": ["roller", "guide"]})

    return spec, solve_spectrum(spec, DB, solve=solve)


@pytest.mark.slow
def test_every_number_of_a_spectrum_is_that_of_its_blocks():
    kinds = set()
    for seed in range(150):
        spec, ds = random_spectrum(seed)
        answer = answer_of_spectrum(ds)
        lives = part_of(answer, "lives").set_index("body")
        kinds.add(answer.kind)
        for body in ("roller", "guide"):
            damage = ds["damage"].sel(body=body).values
            total = damage.sum(axis=0)
            row, life = limit_row(answer, "fatigue", body), lives.loc[body]
            assert (life["why"] != "") == np.isnan(row["low"]) == np.isnan(total).any()
            assert math.isinf(row["low"]) == (total == 0).all()
            if not total.max() > 0:
                continue
            worst = int(np.argmax(total))
            drive = sum(b.distance / 60 / b.case.velocity for b in spec.blocks)
            assert row["low"] == life["hours"] == pytest.approx(drive / total[worst], rel=1e-9)
            assert row["km_low"] == pytest.approx(sum(b.distance for b in spec.blocks) / 1e3 / total[worst], rel=1e-9)
            assert row["contact"] == life["contact"] == worst + 1
            most = int(np.argmax(damage[:, worst]))
            assert row["block"].startswith(f"{spec.blocks[most].name}, ")
            assert row["share"] == pytest.approx(damage[most, worst] / total[worst], rel=1e-9)
    assert kinds == {"lasts", "unknown", "unlimited"}


def test_table_has_units_and_its_shares_add_up():
    _, ds = random_spectrum(5)
    blocks = next(part for part in answer_of_spectrum(ds).parts if part.name == "blocks")
    columns = {column.name: column for column in blocks.columns}
    assert columns["velocity"].units == "m min-1" and columns["peak_roller"].units == "MPa"
    assert blocks.table["share_roller"].sum() == pytest.approx(1.0) and (blocks.table["radial_force"] == -200.0).all()


def test_lives_at_failure_probabilities_have_three_units():
    _, ds = random_spectrum(5, roller_material={"like": "1.7225-normalised", "scatter_in_cycles": 4.0})
    lives = part_of(answer_of_spectrum(ds), "lives")
    row = lives[(lives["body"] == "roller") & (lives["probability"] == 0.1)].iloc[0]
    assert row["km"] / row["shifts"] == pytest.approx(float(ds["roller_life_km"] / ds["roller_life_shifts"]), rel=1e-9)
    assert row["hours"] / row["shifts"] == pytest.approx(float(ds["duration"].sum()), rel=1e-9)
    assert row["shifts"] == pytest.approx(float(ds["roller_life_shifts"]) / 2, rel=1e-9)  # 4^-1/2


def test_figure_shows_the_blocks_of_known_damage_and_joins_the_small_ones():
    _, ds = random_spectrum(5)
    figure, info = damage_by_block(ds)
    bars = figure.axes[0].patches
    assert sum(bar.get_width() for bar in bars) == pytest.approx(100)
    assert max(float(w) for w in re.findall(r"([\d.]+) %", info.sentence)) <= 100
    many = xr.concat([ds.isel(block=[0])] * 30, "block", data_vars="minimal").assign_coords(
        block=[f"b{i}" for i in range(30)]
    )
    figure, _ = damage_by_block(many)
    assert figure.axes[0].get_yticklabels()[-1].get_text() == "14 others"
    assert damage_by_block(ds.assign(damage=ds["damage"] * np.nan)) is None


def test_page_of_a_spectrum_stands_alone(tmp_path):
    from typer.testing import CliRunner

    from trackroller.cli.main import app

    (tmp_path / "shift.yaml").write_text(
        "name: sorter\nbase: {motor_force: 0, axial_force: 5}\ncontact_model: sliding\nblocks:\n"
        "- {name: loaded, distance: 100}\n- {name: empty, distance: 50, radial_force: -60}\n"
    )
    page = tmp_path / "page.html"
    done = CliRunner().invoke(app, ["spectrum", str(tmp_path / "shift.yaml"), "--report", str(page)])
    assert done.exit_code == 0, done.output
    text = page.read_text(encoding="utf-8")
    for part in (
        "Blocks of a shift",
        "data:image/svg",
        "Roller peak",
        "Source:",
        "trackroller spectrum shift.yaml",
    ):
        assert part in text
    assert not re.search(r"(?:src|href)=\"(?!data:|#)", text)
    ds = solve_spectrum(
        Spectrum.from_dict({"blocks": [{"distance": 9, "axial_force": 200}], "contact_model": "sliding"}), DB
    )
    assert part_of(answer_of_spectrum(ds), "blocks")["regime"].tolist() == ["lift-off"]
    assert tr.report(ds, tmp_path / "again.html").read_text(encoding="utf-8").startswith("<!doctype html>")


def test_one_unsolved_block_leaves_the_track_and_the_damage_of_the_others():
    """Contact 2 takes 325 times the damage of contact 1: table, figure and bound of the life are those of contact 2."""
    stress = np.array([[[200.0, 200.0], [400.0, 420.0]], [[180.0, 180.0], [380.0, 390.0]], np.full((2, 2), np.nan)])
    regime = np.array([0, 0, 2], np.int8)

    def solve(cases, outputs, database, **options):
        variables = {"peak_stress": (("case", "contact", "body"), stress), "regime": ("case", regime)}
        return xr.Dataset(variables, coords={"contact": [1, 2], "body": ["roller", "guide"]})

    blocks = [{"name": name, "distance": 1000.0, "guide_overrollings": 50.0} for name in ("one", "two", "lifted")]
    ds = solve_spectrum(Spectrum.from_dict({"blocks": blocks}), DB, solve=solve)
    damage = ds["damage"].values[:2, 1, :]
    assert damage.sum() > 100 * ds["damage"].values[:2, 0, :].sum()
    answer = answer_of_spectrum(ds)
    blocks = next(part for part in answer.parts if part.name == "blocks")
    np.testing.assert_array_equal(blocks.table["damage_roller"], [*damage[:, 0], np.nan])
    assert "damage sum at least " in blocks.note
    figure, info = damage_by_block(ds)
    assert sum(bar.get_width() for bar in figure.axes[0].patches) == pytest.approx(100)
    assert "not counted: lifted" in info.caption and len(figure.axes[0].patches) == 2
    life = part_of(answer, "lives").set_index("body").loc["roller"]
    assert life["at_most"] == pytest.approx(float(ds["duration"].sum()) / damage[:, 0].sum(), rel=1e-9)
    assert "lifted (lift-off)" in life["why"] and life["contact"] == 2


@pytest.mark.parametrize(("share", "state"), [(0.9, "met"), (1.1, "missed")])
def test_a_required_travel_is_judged_by_the_first_limit(share, state):
    """One block by a made-up solver, so that the travel to the first limit follows from one life."""
    blocks = [{"name": "b", "distance": 1000.0}]

    def solve(cases, outputs, database, **options):
        variables = {
            "peak_stress": (("case", "contact", "body"), np.full((1, 2, 2), 500.0)),
            "regime": ("case", np.zeros(1, dtype=np.int8)),
        }
        return xr.Dataset(variables, coords={"contact": [1, 2], "body": ["roller", "guide"]})

    def solved(keys=(), **more):
        base = {"guide_overrollings_per_hour": 1.0, **more}
        return solve_spectrum(Spectrum.from_dict({"blocks": blocks, "base": base, **dict(keys)}), DB, solve=solve)

    free = solved()
    assert answer_of_spectrum(free).required == () and answer_of_spectrum(free).headline["states"] == []
    travel = float(free["roller_life_shifts"]) * 1.0  # km: a shift is one
    answer = answer_of_spectrum(solved(required_travel=share * travel))
    assert answer.headline["states"] == [state]
    assert answer.required[0].least == pytest.approx(share * travel)
    assert headline_of(answer).text.endswith(f"km: {state}.")
    hours = answer.headline["low"]
    duty = {"hours_per_day": 10, "days_per_year": 100}
    for wanted in (f"{share * hours} h", f"{share * hours / 1000} years"):
        asked = {"requirement": {"pair_life_to_first_limit_hours": {"min": wanted}}, "duty": duty}
        by_life = answer_of_spectrum(solved(asked))
        assert by_life.headline["states"] == [state]
        assert by_life.required[0].least == pytest.approx(share * hours)
        assert "required" in headline_of(by_life).text and headline_of(by_life).text.endswith(f": {state}.")


@pytest.mark.parametrize(
    ("wanted", "part"),
    [
        ({"min": "2 years"}, "needs a duty"),
        ({"peak_stress_roller": {"max": 500}}, "is not judged for a spectrum"),
        ({"roller_life_hours": {"min": 500}}, "Write requirement: {pair_life_to_first_limit_hours: {min: 5000}}"),
        ({"pair_life_hours": {"min": 500, "probability": 0.9}}, "min alone"),
    ],
)
def test_a_requirement_that_a_spectrum_does_not_judge_is_refused(wanted, part):
    blocks = [{"name": "b", "distance": 1000.0}]
    with pytest.raises(tr.InputError, match=re.escape(part)):
        Spectrum.from_dict({"blocks": blocks, "requirement": wanted})
    remedy = {"pair_life_to_first_limit_hours": {"min": 5000}}
    assert Spectrum.from_dict({"blocks": blocks, "requirement": remedy}).required == {
        "pair_life_to_first_limit_hours": 5000.0
    }
