"""What a report says of a table of own cases: each row, no effects of columns, the error of a life."""

import pytest
import yaml

import trackroller as tr

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


def test_a_load_that_only_some_proposals_were_tried_under_counts_for_the_target(tmp_path, monkeypatch):
    """The row at 240 N is known: a design that is too weak there misses the target, and one without it is open."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cases.csv").write_text(PROPOSALS, encoding="utf-8")
    keys = {"name": "proposals", "method": "table", "table": "cases.csv", "contact_model": "sliding"}
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
    status = dict(zip(found.answer.table["roller_profile_radius"], found.answer.table["state"], strict=True))
    untried = set(radius) - set(radius[heavy])
    assert all(status[r] == "missed" for r in set(radius[heavy]))
    assert all(status[r] == ("open" if shared[r] >= weak else "missed") for r in untried)


def test_one_shared_load_is_too_little_to_compare_proposals(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = [line for line in PROPOSALS.splitlines() if line != "-7,-180,12"]
    (tmp_path / "cases.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    keys = {"name": "proposals", "method": "table", "table": "cases.csv", "contact_model": "sliding"}
    results = tr.run(_file(tmp_path, keys | {"base": {"motor_force": 0}}), progress=False)
    assert results.answer.kind == "cannot_tell" and not results.candidates().untried.any()


def _file(folder, keys):
    """Write a study file, beside which its table is found."""
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(keys), encoding="utf-8")
    return path
