"""What a report says of a table of own cases: each row, no effects of columns, the error of a life."""

import re

import numpy as np
import pytest
import yaml

import trackroller as tr
from trackroller.report.build import report_text
from trackroller.report.numbers import quantity
from trackroller.report.pages.study import contents
from trackroller.report.words.designs import rows_table, unanswered
from trackroller.report.words.in_short import in_short
from trackroller.report.words.verdict import verdict_sentences
from trackroller.results.candidates import Candidates

ROWS = """roller_material,roller_profile_radius,radial_force,axial_force
1.7225-quenched-tempered,-6.4,-90,6
1.7225-quenched-tempered,-6.4,-240,20
PA6,-7,-90,6
PA6,-6.4,-900,20
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Three designs that do not share their conditions, one of them outside the half-space."""
    folder = tmp_path_factory.mktemp("table")
    (folder / "cases.csv").write_text(ROWS)
    base = "{motor_force: 0, friction_coefficient: 0.15, guide_overrollings_per_hour: 120, contact_angle: 40}"
    text = f"name: rows\nbase: {base}\ndesign: table\ntable: cases.csv\ncontact_model: sliding\n"
    (folder / "rows.yaml").write_text(text + "analysis: {target: {min: 100}}\n")
    return tr.run(folder / "rows.yaml", progress=False)


def test_each_row_has_its_life(results):
    """The life of each row, or why the model does not judge it."""
    table = rows_table(results)
    lives = results.data["pair_life_to_first_limit_hours"].values
    assert len(table.rows) == len(lives) == 4
    judged = ~results.flagged("half_space")
    assert judged.any() and not judged.all()
    for row, life, inside in zip(table.rows, lives, judged, strict=True):
        text = str(row[-2])
        if not inside:
            assert (text, row[-1]) == ("outside the half-space", "–")
            continue
        number = float(text.partition(" h")[0].replace(",", ""))
        assert number == pytest.approx(float(life), rel=5e-3) and str(row[-1]).startswith("fatigue, ")


def test_no_effect_is_told_of_columns_that_go_together(results):
    """Material and groove change together, so that neither is said to change the target most."""
    page = contents(results)
    (table,) = (t for t in page["tables"]["decide"] if t.name == "targets")
    assert [row[0] for row in table.rows] == ["All cases"]
    assert unanswered(Candidates.grouped(results, results.life)).values["observed"]


def test_a_coarse_life_states_its_error():
    """At preview the error of the life exceeds a tenth; full sliding at standard resolves it better."""
    study = {"name": "coarse", "base": {"motor_force": 0, "guide_overrollings_per_hour": 120}}
    study["factors"] = {"roller_profile_radius": {"values": [-6.4, -7]}}

    def sure(**options):
        found = tr.run(study | options, progress=False)
        listed = dict(in_short(found, []))["How sure"]
        return found, [one.values for one in listed if one.kind == "life"]

    coarse, said = sure(contact_model="kalker", accuracy="preview")
    error = coarse.verdict.best[0].error
    place = {"roller_profile_radius": coarse.verdict.best[0].choices["roller_profile_radius"]}
    own = coarse.data["life_error_estimate"].sel(place)
    shortest = coarse.data["life_cycles"].sel(place).sel(body=coarse.verdict.best[0].body)
    worst = int(np.argmin(shortest.values))
    assert error == pytest.approx(float(own.sel(body=coarse.verdict.best[0].body).values[worst])) and error > 0.1
    assert said == [{"error": error, "name": f"roller profile radius −{-place['roller_profile_radius']:g} mm"}]
    assert sure(contact_model="sliding")[1] == []


PROPOSALS = """roller_profile_radius,radial_force,axial_force
-6.4,-90,6
-6.4,-180,12
-6.4,-240,20
-7,-90,6
-7,-180,12
-6.6,-90,6
-6.6,-180,12
-6.6,-240,20
"""


def test_proposals_are_compared_over_the_loads_that_each_was_tried_under(tmp_path, monkeypatch):
    """One proposal was not tried at the largest load: it is not worse or better for that, and the page says so."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cases.csv").write_text(PROPOSALS, encoding="utf-8")
    keys = {"name": "proposals", "design": "table", "table": "cases.csv", "contact_model": "sliding"}
    target = {"analysis": {"target": {"roller_life_hours": {"min": 1}}}}
    study = keys | {"base": {"motor_force": 0, "friction_coefficient": 0.15}} | target
    results = tr.run(_file(tmp_path, study), progress=False)
    candidates, table = results.candidates(), results.table
    life = table["pair_life_to_first_limit_hours"].to_numpy()
    both = table["radial_force"] > -200
    worst = {radius: life[both & (table["roller_profile_radius"] == radius)].min() for radius in (-6.4, -6.6, -7.0)}
    assert candidates.matched and candidates.untried.sum() == 2
    assert results.verdict.kind == "build"
    (best,) = results.verdict.best
    assert best.choices["roller_profile_radius"] == max(worst, key=worst.get)
    assert best.low == max(worst.values())
    (said,) = (one.values for one in verdict_sentences(results) if one.kind == "untried")
    assert said["shared"] == 2
    assert [re.findall(r"\d+", text) for text in said["named"]] == [["240", "20"]]


def test_a_load_that_only_some_proposals_were_tried_under_counts_for_the_target(tmp_path, monkeypatch):
    """The row at 240 N is known: a design that is too weak there misses the target, and one without it is open."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cases.csv").write_text(PROPOSALS, encoding="utf-8")
    keys = {"name": "proposals", "design": "table", "table": "cases.csv", "contact_model": "sliding"}
    keys |= {"base": {"motor_force": 0, "friction_coefficient": 0.15}}

    def judged(least):
        study = keys | {"analysis": {"target": {"roller_life_hours": {"min": float(least)}}}}
        return tr.run(_file(tmp_path, study), progress=False)

    results = judged(1)
    table = results.table.assign(life=results.column("pair_life_to_first_limit_hours"))
    heavy = table["radial_force"] < -200
    radius = table["roller_profile_radius"]
    shared = table[~heavy].groupby("roller_profile_radius")["life"].min()
    every = table.groupby("roller_profile_radius")["life"].min()
    weak = float(every[sorted(set(radius[heavy]))].max() * 1.3)  # more than any design lasts at the heavy load
    assert weak < shared.max()
    found = judged(weak)
    status = {one.choices["roller_profile_radius"]: one.status for one in found.verdict.candidates}
    untried = set(radius) - set(radius[heavy])
    assert all(status[r] == "missed" for r in set(radius[heavy]))
    assert all(status[r] == ("open" if shared[r] >= weak else "missed") for r in untried)
    assert found.verdict.kind == ("cannot_tell" if any(shared[r] >= weak for r in untried) else "none")
    best = results.verdict.best[0].choices["roller_profile_radius"]
    assert "worst shared condition" in report_text(results)
    if best in set(radius[heavy]):
        own = table["life"][heavy & (radius == best)].min()
        assert f"(the first design lasts {quantity(own, 'h')} there)" in report_text(results)


def test_one_shared_load_is_too_little_to_compare_proposals(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = [line for line in PROPOSALS.splitlines() if line != "-7,-180,12"]
    (tmp_path / "cases.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    keys = {"name": "proposals", "design": "table", "table": "cases.csv", "contact_model": "sliding"}
    results = tr.run(_file(tmp_path, keys | {"base": {"motor_force": 0}}), progress=False)
    assert results.verdict.kind == "cannot_tell" and not results.candidates().untried.any()


def _file(folder, keys):
    """Write a study file, beside which its table is found."""
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(keys), encoding="utf-8")
    return path


def test_a_share_of_time_that_changes_no_case_is_told(tmp_path):
    """A column of numbers that no case and no expression uses is named, with what would add up the damage."""
    rows = "block,share,lever,radial_force\nlight,0.7,2,-60\nheavy,0.3,2,-110\n"
    (tmp_path / "cases.csv").write_text(rows)
    text = "name: shares\nbase: {motor_force: 0}\ndesign: table\ntable: cases.csv\ncontact_model: sliding\n"
    text += 'factors: {axial_force: {expression: "5 * lever"}}\naccuracy: preview\n'
    (tmp_path / "shares.yaml").write_text(text)
    results = tr.run(tmp_path / "shares.yaml", progress=False)
    note = rows_table(results).note
    assert verdict_sentences(results)[-1].values["vain"] == ["share"]
    assert "share changes no case" in note.lower() and "spectrum" in note and "ever" not in note
