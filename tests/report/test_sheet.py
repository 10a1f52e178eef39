"""The sheet of one roller: every number is the solver's, defaults are marked, flags name their body."""

from __future__ import annotations

import html
import json
import re
import shlex
import shutil
import subprocess

import numpy as np
import pytest
import yaml
from command_line import trackroller
from reference_cases import solve_sliding
from typer.testing import CliRunner

import trackroller as tr
from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.materials import builtin_database
from trackroller.report.pages.sheet import render
from trackroller.report.pages.sheet_facts import collect
from trackroller.report.pages.sheet_text import as_json
from trackroller.report.words.flags import flags_of
from trackroller.roller.dataset import validity_bit
from trackroller.roller.limits import limits

SCATTER = {"like": "PA6", "name": "PA6 with scatter", "scatter_in_cycles": 4.0}
CASES = {
    "example": tr.Case(),
    "plastic": tr.Case(
        roller_material=SCATTER, radial_force=-20, axial_force=3, motor_force=0, guide_overrollings_per_hour=120
    ),
    "lifted": tr.Case(axial_force=300),
    "skidding": tr.Case(motor_force=-300),
    "overloaded": tr.Case(radial_force=-3000, axial_force=0, motor_force=0),
}


@pytest.fixture(scope="module", autouse=True)
def limits_searched_once():
    """Keep the limits of each case: a page, a text and their facts would search them anew."""
    kept = {}

    def searched(case, model):
        key = repr((case, model))
        return kept[key] if key in kept else kept.setdefault(key, limits(case, model))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("trackroller.report.pages.sheet_facts.limits", searched)
        yield


@pytest.fixture(scope="module")
def solved():
    return {name: solve_sliding(case) for name, case in CASES.items()}


@pytest.fixture(scope="module")
def facts(solved):
    return {name: collect(ds) for name, ds in solved.items()}


def test_inputs_are_told_with_defaults_marked(facts):
    rows = {row.words.split()[0]: row for row in facts["plastic"].inputs}
    assert not rows["radial"].default and not rows["overrollings"].default
    assert rows["friction"].default and rows["friction"].value == "0.3"
    assert all(row.default for row in facts["example"].inputs)


def test_stress_and_life_are_those_of_the_solver(solved, facts):
    for name in ("example", "plastic"):
        for contact in facts[name].contacts:
            for body in contact.bodies:
                own = solved[name].sel(contact=contact.number, body=body.body)
                assert body.peak == float(own.peak_stress) and body.cycles == float(own.life_cycles)
                assert body.of_strength < body.of_fatigue_limit


def test_utilisation_is_stress_over_the_values_of_the_material(solved, facts):
    database = tr.load_database()
    steel = database.material("1.7225-normalised")
    body = facts["example"].contacts[1].bodies[0]
    assert body.of_strength == pytest.approx(body.peak / steel.tensile_strength)
    assert body.of_fatigue_limit == pytest.approx(body.peak / steel.fatigue_limit)


def test_scatter_gives_lives_at_three_probabilities(solved, facts):
    """With N_90/N_10 = T_N lives at 10 and 90 % lie a factor sqrt(T_N) around the median."""
    lives = {row.words: float(row.value) for row in facts["plastic"].lives if "roller" in row.words}
    median = float(solved["plastic"].roller_life_hours)
    ten, fifty, ninety = (lives[f"roller, until {p} % have failed"] for p in (10, 50, 90))
    assert fifty == pytest.approx(median, rel=5e-3)
    assert ten == pytest.approx(median / 2, rel=5e-3) and ninety == pytest.approx(2 * median, rel=5e-3)


def test_the_verdict_names_what_decides(solved, facts):
    assert facts["example"].verdict.startswith("Rolls. The roller lasts 3.78 h (median); contact 2 decides.")
    weakest = int(solved["example"].contact.values[solved["example"].life_hours.sel(body="roller").values.argmin()])
    assert weakest == 2
    assert facts["skidding"].verdict.startswith("Skids")


def test_overload_and_skidding_rule_before_any_life(solved, facts):
    """No life stands on the sheet of a body that breaks at once, or of a roller that skids."""
    over, skid = facts["overloaded"], facts["skidding"]
    worst = float(solved["overloaded"].peak_stress.sel(body="roller").max()) / 720.0
    assert worst > 1 and over.verdict.startswith(f"Overloaded: at the roller the peak stress is {worst:.2g} times its")
    assert "lasts" not in over.verdict + skid.verdict and skid.verdict.startswith("Skids")
    for fact, why in ((over, "tensile strength"), (skid, "skids")):
        assert [why in row.value for row in fact.lives] == [True] * len(fact.lives) and fact.lives
        assert all(np.isnan([body.cycles, body.hours]).all() for contact in fact.contacts for body in contact.bodies)
    assert "lasts" in facts["example"].verdict and "Overloaded" not in facts["example"].verdict
    page = render(solved["overloaded"])
    assert "no fatigue life" in page and "overrollings," not in page


def test_limits_over_friction_include_lift_off():
    """Free rolling at 55 N: friction alone lifts contact 1; just below the stated coefficient both contacts carry."""
    case = tr.Case(motor_force=0, axial_force=55, friction_coefficient=0.05)
    lifts = limits(case, "sliding").lift_off_friction
    assert 0.05 < lifts < 2
    for share, regime in ((0.99, 0), (1.01, 2)):
        changed = tr.Case(motor_force=0, axial_force=55, friction_coefficient=share * lifts)
        assert int(solve_sliding(changed, "forces").regime) == regime
    rows = {
        row.words.split(":")[0]: row.value for row in collect(solve_sliding(case)).limits if "friction" in row.words
    }
    assert rows["lift-off"].startswith("from ") and "now 0.05" in rows["lift-off"]


def test_a_lift_off_answers_with_the_axial_force_that_holds(facts):
    bound = re.search(r"to ([\d.]+) N", facts["lifted"].verdict)
    assert bound is not None
    at = float(bound[1])
    assert int(solve_sliding(tr.Case(axial_force=0.98 * at), "forces").regime) == 0
    assert int(solve_sliding(tr.Case(axial_force=1.02 * at), "forces").regime) == 2


def test_flags_name_the_body_they_hold_for(facts):
    plastic = {flag.name: flag.sentence for flag in facts["plastic"].flags}
    assert "fatigue limit of the guide" in plastic["deep_life"]  # a steel guide under a plastic roller
    assert "static" in {flag.name for flag in facts["overloaded"].flags}
    assert all(flag.remedy for fact in facts.values() for flag in fact.flags)


def test_deep_life_is_flagged_where_the_worse_contact_stays_below_the_fatigue_limit():
    """The life of a body is that of its worse contact, so a case with one contact above the limit has no deep life."""
    found = set()
    for radial, axial in ((-60, 0), (-20, 2), (-200, 30), (-200, 60)):
        case = tr.Case(radial_force=radial, axial_force=axial, motor_force=0)
        ds = solve_sliding(case, ("forces", "peak_stress", "life"))
        for body in ("roller", "guide"):
            limit = builtin_database().material("1.7225-normalised").fatigue_limit
            stress = ds.peak_stress.sel(body=body).values
            flagged = bool(int(ds.validity_body.sel(body=body)) & validity_bit("deep_life"))
            assert flagged == (stress.max() < limit)
            found.add((flagged, bool((stress < limit).any())))
    assert found >= {(True, True), (False, True)}


def test_friction_energy_of_full_sliding_is_flagged_and_that_of_the_exact_theory_is_not():
    for model, told in (("sliding", True), ("kalker", False)):
        ds = tr.solve(CASES["example"], ("forces", "friction_work"), contact_model=model, accuracy="preview")
        assert ("energy_residual" in {flag.name for flag in flags_of(ds)}) == told
        forces = ds.drop_vars("energy_residual")
        assert ("full_sliding" in {flag.name for flag in flags_of(forces)}) == told
        named = {"sliding": "contact model sliding, ", "kalker": "contact model kalker (solved by kalker_table), "}
        assert collect(ds).options.startswith(named[model])
        assert json.loads(as_json(ds))["contact_model_used"]["meaning"] == ("sliding" if told else "kalker_table")


def test_the_command_repeats_the_case(solved, facts):
    for name in ("example", "plastic"):
        words = shlex.split(facts[name].command)
        assert words[:2] == ["trackroller", "solve"]
        done = CliRunner().invoke(app, [*words[1:], "--json"])
        assert done.exit_code == 0, done.output
        again = json.loads(done.output)
        np.testing.assert_array_equal(again["normal_force"]["value"], solved[name].normal_force.values)
        np.testing.assert_array_equal(again["peak_stress"]["value"], solved[name].peak_stress.values)


def test_json_tells_inputs_materials_flags_and_versions(solved):
    told = json.loads(as_json(solved["plastic"]))
    assert told["inputs"]["radial_force"] == {"value": -20.0, "default": False}
    assert told["inputs"]["contact_angle"]["default"] is True
    assert told["materials"]["guide_material"]["sources"]["tensile_strength"]
    assert told["regime"]["meaning"] == "rolling" and told["versions"]["numpy"] == np.__version__
    assert {flag["name"] for flag in told["flags"]} == {flag.name for flag in collect(solved["plastic"]).flags}


def test_the_page_stands_alone_and_escapes_names(solved):
    bad = tr.Case(roller_material={"like": "PA6", "name": "<script>alert(1)</script>"}, radial_force=-20, axial_force=0)
    page = render(solve_sliding(bad), name="<b>A & B</b>")
    assert "<script" not in page and "<b>A" not in page
    assert html.escape("<b>A & B</b>", quote=False) in page
    assert "default-src 'none'" in page
    assert not re.search(r"(?:src|href)=[\"'](?!data:)", page)


def test_every_regime_has_a_page(solved):
    for ds in solved.values():
        page = render(ds)
        assert (
            "Distance to the limits" in page and "nan" not in re.sub(r"<style.*?</style>", "", page, flags=re.S).lower()
        )


def test_a_report_is_written_for_one_case_only(tmp_path, solved):
    assert tr.report(solved["example"], tmp_path / "sheet.html").is_file()
    with pytest.raises(InputError, match="one case"):
        tr.report(solve_sliding([tr.Case(), tr.Case()], "forces"), tmp_path / "two.html")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Return the sheet of the case with most rows, as the command line writes it, and what is printed."""
    place = tmp_path_factory.mktemp("sheet")
    case = CASES["plastic"]
    (place / "my-roller.yaml").write_text(yaml.safe_dump(case.as_dict() | {"contact_model": "sliding"}))
    done = trackroller("solve", "my-roller.yaml", "--report", "sheet.html", cwd=place)
    return place / "sheet.html", done.stdout


def test_the_command_line_writes_sheet_and_text(written):
    page = written[0].read_text(encoding="utf-8")
    assert "my-roller" in page and page.count("<figure>") == 3
    told, default = re.findall(r"^(?:given|default) .*$", written[1], re.M)
    assert told.startswith("given    radial force F_rad −20 N, axial force F_ax 3 N")
    assert default.startswith("default ") and "friction coefficient mu 0.3" in default


@pytest.mark.browser
@pytest.mark.skipif(shutil.which("chromium") is None, reason="needs chromium")
def test_the_sheet_prints_on_one_page(written, tmp_path):
    flags = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-pdf-header-footer"]
    target = tmp_path / "sheet.pdf"
    command = ["chromium", *flags, f"--print-to-pdf={target}", f"--user-data-dir={tmp_path}/profile"]
    subprocess.run([*command, written[0].as_uri()], check=True, capture_output=True, timeout=120)
    assert len(re.findall(rb"/Type\s*/Page\b", target.read_bytes())) == 1
