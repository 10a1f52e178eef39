"""What a report says of a table of own cases: each row, no effects of columns, the error of a life."""

import numpy as np
import pytest

import trackroller as tr
from trackroller.report.pages.study import contents
from trackroller.report.words.designs import rows_table, unanswered
from trackroller.report.words.in_short import in_short
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
    said = " ".join(one.text for listed in page["said"].values() for one in listed if hasattr(one, "text"))
    assert "met by" in said and "changes it most" not in said
    assert (
        "give each design a row for each of the conditions"
        in unanswered(Candidates.grouped(results, results.life)).text
    )


def test_a_coarse_life_states_its_error():
    """At preview the error of the life exceeds a tenth; full sliding at standard resolves it better."""
    study = {"name": "coarse", "base": {"motor_force": 0, "guide_overrollings_per_hour": 120}}
    study["factors"] = {"roller_profile_radius": {"values": [-6.4, -7]}}

    def sure(**options):
        found = tr.run(study | options, progress=False)
        return found, [one.text for head, said in in_short(found, []) if head == "How sure" for one in said]

    coarse, said = sure(contact_model="kalker", accuracy="preview")
    error = coarse.verdict.best[0].error
    place = {"roller_profile_radius": coarse.verdict.best[0].choices["roller_profile_radius"]}
    own = coarse.data["life_error_estimate"].sel(place)
    shortest = coarse.data["life_cycles"].sel(place).sel(body=coarse.verdict.best[0].body)
    worst = int(np.argmin(shortest.values))
    assert error == pytest.approx(float(own.sel(body=coarse.verdict.best[0].body).values[worst])) and error > 0.1
    assert sum("is resolved to" in text and text.startswith("The life of the first candidate") for text in said) == 1
    assert not any(text.startswith("The life of the first candidate") for text in sure(contact_model="sliding")[1])
