"""The sheet of one roller: every number is the solver's, defaults are marked, flags name their body."""

from __future__ import annotations

import dataclasses
import html
import json
import re
import shlex

import numpy as np
import openpyxl
import pytest
import yaml
from browser import CHROMIUM, Browser
from command_line import trackroller
from limit_rows import headline, limit_row, part_of
from reference_cases import solve_sliding
from typer.testing import CliRunner

import trackroller as tr
from trackroller.cli.case import COMPLETE, SHEET_OUTPUTS, case_of, groups_of, solve_case
from trackroller.cli.main import app
from trackroller.damage import LIMITS
from trackroller.errors import InputError
from trackroller.materials import builtin_database
from trackroller.parameters.validity import VALIDITY
from trackroller.report.figures.roller_section import _roller as roller_outline
from trackroller.report.figures.roller_section import content_of
from trackroller.report.pages.record import command_of, options_text
from trackroller.report.pages.sheet import as_json, notes_of_sheet, render, sheet_inputs
from trackroller.report.workbook import write_roller
from trackroller.results.roller_answer import answer_of_roller
from trackroller.results.validity_flags import flags_of
from trackroller.roller.dataset import validity_bit
from trackroller.roller.regime_limits import limits
from trackroller.roller.settings import sheet_of

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
        patch.setattr("trackroller.results.roller_answer.limits", searched)
        yield


@pytest.fixture(scope="module")
def solved():
    return {name: solve_sliding(case) for name, case in CASES.items()}


@pytest.fixture(scope="module")
def answers(solved):
    return {name: answer_of_roller(ds) for name, ds in solved.items()}


@pytest.mark.slow
def test_inputs_are_told_with_defaults_marked(solved):
    rows = {row.words.split()[0]: row for row in sheet_inputs(solved["plastic"])}
    assert not rows["radial"].default and not rows["overrollings"].default
    assert rows["friction"].default and rows["friction"].value == "0.3"
    assert all(row.default for row in sheet_inputs(solved["example"]))


def test_stress_and_life_are_those_of_the_solver(solved, answers):
    for name in ("example", "plastic"):
        table = part_of(answers[name], "contacts").set_index("quantity")[["contact_1", "contact_2"]]
        for body in ("roller", "guide"):
            own = solved[name].sel(body=body)
            stresses = table.loc[f"peak stress of the {body} (von Mises)"]
            np.testing.assert_array_equal(stresses, own.peak_stress.values)
            depths = table.loc[f"depth of the peak in the {body}"]
            assert np.all(np.abs(depths - own.peak_z.values) < 0.01 * own.semi_axis_rolling.values)


def test_scatter_gives_lives_at_three_probabilities(solved, answers):
    """With N_90/N_10 = T_N lives at 10 and 90 % lie a factor sqrt(T_N) around the median."""
    lives = part_of(answers["plastic"], "lives")
    ten, fifty, ninety = lives[lives["body"] == "roller"]["low"]
    assert fifty == pytest.approx(float(solved["plastic"].roller_life_hours), rel=1e-9)
    assert ten == pytest.approx(fifty / 2, rel=1e-9) and ninety == pytest.approx(2 * fifty, rel=1e-9)


def test_the_headline_names_what_decides(solved, answers):
    own, answer = solved["example"], answers["example"]
    hours = float(own.roller_life_hours)
    assert (answer.kind, answer.headline["body"], answer.headline["ends"]) == ("lasts", "roller", ["fatigue"])
    by_pressure = [
        float(own[f"life_hours_by_limit_{end}"].sel(limit="pressure_line", body="roller")) for end in ("low", "high")
    ]
    assert answer.headline["low"] == min(hours, by_pressure[0])
    assert answer.headline["high"] == max(hours, by_pressure[1])
    ends = re.match(r"([\d.]+) to ([\d.]+) h \(placeholders\), then fatigue of the roller", headline(answer)).groups()
    assert [float(end) for end in ends] == pytest.approx([answer.headline["low"], answer.headline["high"]], rel=5e-3)
    lives = part_of(answer, "lives").set_index("body")
    assert lives.loc["roller", "contact"] == own.life_hours.sel(body="roller").values.argmin() + 1 == 2


def test_overload_and_skidding_rule_before_any_life(solved, answers):
    """No life by fatigue stands on the sheet of a body that breaks at once, or of a roller that skids."""
    over, skid = answers["overloaded"], answers["skidding"]
    worst = float(solved["overloaded"].peak_stress.max()) / 720.0
    assert worst > 1 and over.kind == "breaks" and headline(over).startswith("The roller and guide break at once")
    assert float(re.search(r"(\d+) %", headline(over))[1]) == pytest.approx(100 * worst, abs=0.5)
    assert skid.kind == "skids" and headline(skid).startswith("The roller skids: friction transmits −69.3 to 69.3 N")
    for answer, why in ((over, "tensile strength"), (skid, "friction heat")):
        lives = part_of(answer, "lives")
        assert lives["low"].isna().all() and all(why in text for text in lives["why"])
        for body in ("roller", "guide"):
            row = limit_row(answer, "fatigue", body)
            assert row["state"] == "none" and np.isnan(row["low"])
    assert over.table["low"].iloc[0] == 0.0 and skid.table["limit"].iloc[0] == "full slip"
    assert "no fatigue life" in render(solved["skidding"]) and "Overrollings" in render(solved["example"])


@pytest.mark.slow
def test_limits_over_friction_include_lift_off():
    """Free rolling at 55 N: friction alone lifts contact 1; just below the stated coefficient both contacts carry."""
    case = tr.Case(motor_force=0, axial_force=55, friction_coefficient=0.05)
    lifts = limits(case, "sliding").lift_off_friction
    assert 0.05 < lifts < 2
    for share, regime in ((0.99, 0), (1.01, 2)):
        changed = tr.Case(motor_force=0, axial_force=55, friction_coefficient=share * lifts)
        assert int(solve_sliding(changed, "forces").regime) == regime
    row = limit_row(answer_of_roller(solve_sliding(case)), "lift_off_friction", "pair")
    assert row["value"] == 0.05 and row["used_low"] == pytest.approx(0.05 / lifts)


def test_a_lift_off_answers_with_the_axial_force_that_holds(answers):
    assert answers["lifted"].kind == "lifts_off"
    at = float(re.search(r"to ([\d.]+) N", headline(answers["lifted"]))[1])
    assert at == pytest.approx(answers["lifted"].headline["axial_high"], rel=5e-3)
    assert int(solve_sliding(tr.Case(axial_force=0.98 * at), "forces").regime) == 0
    assert int(solve_sliding(tr.Case(axial_force=1.02 * at), "forces").regime) == 2


def test_flags_name_the_body_they_hold_for(solved, answers):
    plastic = {flag.name: flag for flag in flags_of(solved["plastic"])}
    assert plastic["deep_life"].sentence.endswith("of the guide.")  # a steel guide under a plastic roller
    assert "static" in {flag.name for flag in flags_of(solved["overloaded"])}
    for name, ds in solved.items():
        told = [caution.where for caution in answers[name].warnings]
        assert all(flag.remedy and f"{flag.sentence} {flag.remedy}" in told for flag in flags_of(ds))


def test_every_validity_flag_has_words_and_a_remedy(solved):
    """A roller with every flag set; the flag of the heat limit once had no words and ended the sheet."""
    every = sum(validity_bit(name) for name in VALIDITY)
    ds = solved["example"].assign(validity=every, validity_body=("body", [every, every]))
    flags = [flag for flag in flags_of(ds) if flag.name in VALIDITY]
    assert [flag.name for flag in flags] == list(VALIDITY) and all(flag.remedy for flag in flags)
    assert all({"roller", "guide"} <= set(re.findall(r"\w+", f.sentence)) for f in flags if VALIDITY[f.name].of_body)


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


@pytest.mark.slow
def test_friction_energy_of_full_sliding_is_flagged_and_that_of_the_exact_theory_is_not():
    for model, told in (("sliding", True), ("kalker", False)):
        ds = tr.solve(CASES["example"], ("forces", "friction_work"), contact_model=model, accuracy="preview")
        assert ("energy_residual" in {flag.name for flag in flags_of(ds)}) == told
        forces = ds.drop_vars("energy_residual")
        assert ("full_sliding" in {flag.name for flag in flags_of(forces)}) == told
        named = {"sliding": "contact model sliding, ", "kalker": "contact model kalker (solved by kalker_table), "}
        assert options_text(ds).startswith(named[model])
        assert json.loads(as_json(ds))["contact_model_used"]["meaning"] == ("sliding" if told else "kalker_table")


def test_the_command_repeats_the_case(solved):
    for name in ("example", "plastic"):
        words = shlex.split(command_of(solved[name]))
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
    assert {flag["name"] for flag in told["flags"]} == {flag.name for flag in flags_of(solved["plastic"])}
    assert told["answer"] == json.loads(json.dumps(answer_of_roller(solved["plastic"]).to_dict()))


def test_the_page_stands_alone_and_escapes_names(solved):
    bad = tr.Case(roller_material={"like": "PA6", "name": "<script>alert(1)</script>"}, radial_force=-20, axial_force=0)
    page = render(solve_sliding(bad), name="<b>A & B</b>")
    assert "<script" not in page and "<b>A &" not in page
    assert html.escape("<b>A & B</b>", quote=False) in page
    assert "default-src 'none'" in page
    assert not re.search(r"(?:src|href)=[\"'](?!data:)", page)


@pytest.mark.slow
def test_the_head_holds_texts_to_sign_and_inputs_the_outer_radius_and_the_duty(tmp_path):
    """Texts of a case file stand escaped above lines to sign; what is missing stays blank, and --set replaces them."""
    radii = "outer_radius: 2.6 cm\ngroove_depth: 3\nroller_profile_radius: -6.6\n"
    options = "contact_model: sliding\naccuracy: preview\n"
    texts = 'duty: {hours_per_day: 16}\nsheet: {project: "<i>Lift</i> 7", revision: 2, checker: null}\n'
    (tmp_path / "case.yaml").write_text(radii + options + texts)
    told = trackroller("solve", "case.yaml", "--report", "sheet.html", cwd=tmp_path).stdout
    page = (tmp_path / "sheet.html").read_text(encoding="utf-8")
    signed = dict(re.findall(r"<span>(\w+)</span><b [^>]*>(.*?)</b>", page))
    blank = dict.fromkeys(("Part", "Date", "Author", "Checker", "Signature"), "")
    assert signed == {"Project": "&lt;i&gt;Lift&lt;/i&gt; 7", "Revision": "2", **blank}
    inputs = dict(re.findall(r"<tr[^>]*><th scope=\"row\">(.*?)</th><td>(.*?)</td>", page))
    assert inputs["outer radius of the roller"] == "26&nbsp;mm" and inputs["groove depth of the roller"] == "3&nbsp;mm"
    assert re.findall(r"\d+", inputs["duty"]) == ["16", "365"] and f"│ {inputs['duty']} │" in told
    again = shlex.split(html.unescape(re.search(r"<code>(trackroller solve.*?)</code>", page)[1]))[1:]
    assert trackroller(*again, cwd=tmp_path).stdout.splitlines()[0] == told.splitlines()[0]  # in years, too
    ds = solve_case(*case_of(tmp_path / "case.yaml", ["sheet={author: Ada}", "axis_distance=29"]))
    assert sheet_of(ds) == {"author": "Ada"}
    assert "outer radius of the roller" not in {row.words for row in sheet_inputs(ds)}


@pytest.mark.parametrize(
    ("texts", "told"),
    [
        ("{projekt: Lift}", "'project'"),
        ("Lift 7", "sheet = 'Lift 7'.*project, part, revision"),
        ("{part: [1, 2]}", r"sheet.part = \[1, 2\].*at most 200 signs"),
        ("{author: true}", "sheet.author = True"),
    ],
)
def test_a_wrong_head_of_a_sheet_is_refused_by_name(texts, told):
    with pytest.raises(InputError, match=told):
        case_of(None, [f"sheet={texts}"])


def test_every_regime_has_a_page(solved):
    for ds in solved.values():
        page = render(ds)
        assert "nan" not in re.sub(r"<style.*?</style>", "", page, flags=re.S).lower()


def test_a_report_is_written_for_one_case_only(tmp_path, solved):
    assert tr.report(solved["example"], tmp_path / "sheet.html").is_file()
    with pytest.raises(InputError, match="one case"):
        tr.report(solve_sliding([tr.Case(), tr.Case()], "forces"), tmp_path / "two.html")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Return the sheet of the case with most rows, as the command line writes it, and what is printed."""
    place = tmp_path_factory.mktemp("sheet")
    case = CASES["plastic"]
    (place / "my-roller.yaml").write_text(
        yaml.safe_dump(case.as_dict() | {"contact_model": "sliding", "permissible_wear_depth": 0.1})
    )
    done = trackroller("solve", "my-roller.yaml", "--report", "sheet.html", cwd=place)
    return place / "sheet.html", done.stdout


@pytest.mark.slow
def test_the_command_line_writes_sheet_and_text(written):
    page = written[0].read_text(encoding="utf-8")
    assert "my-roller" in page and page.count("<img ") == 4
    rows = {cells[1].strip(): cells[2:5] for line in written[1].splitlines() if len(cells := line.split("│")) == 6}
    assert [cell.strip() for cell in rows["radial force F_rad"]] == ["−20", "N", "given"]
    assert rows["friction coefficient mu"][0].strip() == "0.3"


@pytest.fixture(scope="module")
def complete():
    """Return the record of a case with all limits, of which heat lacks a value, and its data set."""
    case = tr.Case(guide_overrollings_per_hour=100, cooled_area=500, guide_material="PA6", friction_coefficient=None)
    case = dataclasses.replace(case, radial_force=-30.0, axial_force=3.0, motor_force=0.0)
    ds = tr.solve(case, (*SHEET_OUTPUTS, *groups_of("all")), contact_model="sliding")
    return answer_of_roller(ds), ds


def test_limits_are_the_utilisations_ranked_by_what_comes_first(complete):
    answer, ds = complete
    rows = answer.table
    for name in ds["limit"].values:
        for body in LIMITS[name].bodies:
            used = float(ds.utilisation.sel(limit=name, body=body))
            own = rows[(rows["name"] == name) & rows["body"].isin([body, "roller and guide"])]
            assert own.empty == np.isnan(used) if np.isnan(used) else own["used_low"].iloc[0] == used
    kept = rows[rows["state"] != "exceeded"]
    assert (rows["state"] == "exceeded").iloc[: len(rows) - len(kept)].all() and len(rows) > 8
    reached = kept["low"].fillna(np.inf).tolist()
    assert reached[1:] == sorted(reached[1:]) and kept["hours"].iloc[0] == answer.headline["high"]
    hours = [float(h) for h in ds.life_hours_by_limit.sel(limit="fatigue")]
    assert sorted(rows[rows["name"] == "fatigue"]["hours"]) == sorted(hours)


def test_what_must_not_be_exceeded_is_the_value_over_its_share(complete):
    """Peak stress over the utilisation is R_m, and the fatigue limit."""
    for name, bound, words in (("static", 60.0, "tensile strength"), ("fatigue", 18.0, "fatigue limit")):
        own = limit_row(complete[0], name, "guide")
        assert own["permitted"] == pytest.approx(bound, rel=1e-9) and own["bound"].startswith(words)
        assert own["units"] == "MPa"


def test_a_limit_that_is_not_used_at_all_and_one_of_a_users_own_have_rows(monkeypatch):
    """Without friction the guide stays cold; a user's own limit need not say what it compares."""
    monkeypatch.setitem(LIMITS, "static", dataclasses.replace(LIMITS["static"], compares=("", "")))
    case = tr.Case(friction_coefficient=0, motor_force=0, axial_force=0, cooled_area=500, heat_transfer_coefficient=20)
    answer = answer_of_roller(tr.solve(case, ("forces", "contact", "heat", "peak_stress", "limits")))
    cold = limit_row(answer, "heat", "guide")
    assert cold["used_low"] == 0.0 and np.isnan(cold["permitted"])
    static = limit_row(answer, "static", "roller")
    assert static["value"] == static["used_low"] and static["permitted"] == pytest.approx(1.0)


def test_lives_stand_in_hours_kilometres_and_turns(solved, answers):
    """1 h at 60 m/min is 3.6 km; a turn of the roller is 2 pi r_A."""
    radius, ds = 21.75 - 6 * np.cos(np.pi / 6), solved["example"]
    row = part_of(answers["example"], "lives").set_index("body").loc["roller"]
    assert row["low"] == pytest.approx(float(ds.roller_life_hours), rel=1e-9)
    assert row["km_low"] == pytest.approx(3.6 * row["low"], rel=1e-9)
    assert row["cycles_low"] * 2e-6 * np.pi * radius == pytest.approx(row["km_low"], rel=1e-3)


def test_the_body_that_fails_first_ends_the_pair(complete):
    answer, ds = complete
    hours = float(ds.guide_life_hours)
    assert hours < float(ds.roller_life_hours)
    pair = part_of(answer, "lives").set_index("body").loc["pair"]
    assert pair["low"] == hours and "guide fails first" in pair["why"]
    assert answer.headline["body"] == "guide" and "fatigue of the guide" in headline(answer)


def test_a_life_beyond_the_data_says_so():
    steel = {"roller_material": "1.7225-quenched-tempered", "guide_material": "1.7225-quenched-tempered"}
    case = tr.Case(radial_force=-20, axial_force=0, motor_force=0, **steel)
    answer = answer_of_roller(tr.solve(case, (*COMPLETE, "limits"), contact_model="sliding"))
    assert answer.headline["extrapolated"] and "extrapolated" in headline(answer)
    lives = part_of(answer, "lives").set_index("body")
    assert (lives.loc[["roller", "pair"], "extrapolated"] == "yes").all()
    assert limit_row(answer, "fatigue", "roller")["extrapolated"] == "yes"


def test_the_sheet_names_what_it_rests_on(complete):
    """The standards of limits that were checked, and what was not; the golden page `limits` holds the other words."""
    answer, ds = complete
    notes = notes_of_sheet(ds)
    (standards,) = notes["Standards"]
    assert "ISO" not in standards and "EN 13001-3-3" in standards  # no bearing was given
    assert "heat (give heat_transfer_coefficient)" in answer.not_checked["roller"]
    assert "bearing (give bearing)" in answer.not_checked["roller"]
    assert not any(text.startswith("heat") for text in answer.not_checked["guide"])
    (value,) = (text for text in notes["Values of the materials"] if text.startswith("Friction coefficient"))
    known = builtin_database().friction("1.7225-normalised", "PA6")
    assert float(value.split()[2].rstrip(":")) == pytest.approx(known.value, rel=5e-3)


def test_a_drawn_profile_stands_in_the_drawing_as_given():
    alpha, nominal = np.radians(30.0), 6.0 * np.sin(np.radians(30.0))
    curve = lambda x: -np.tan(alpha) * (x - nominal) - 0.05 * (x - nominal) ** 2  # noqa: E731
    x = np.linspace(0.3, 5.7, 109)
    points = np.stack([x, curve(x)], axis=1).tolist()
    values = {"contact_angle": 30.0, "guide_profile_radius": 6.0, "roller_profile_radius": -7.0}
    outline = roller_outline(values | {"roller_profile": {"points": points, "frame": "section"}}, 20.0)
    flank = outline[(outline[:, 0] > 0) & (outline[:, 1] < 12.0) & (outline[:, 0] < 7.0)]
    away = flank[:, 1] - 6.0 * np.cos(alpha) - curve(flank[:, 0])
    assert len(flank) > 20 and np.abs(away).max() < 1e-6
    circle = roller_outline(values, 20.0)
    centre = (6.0 - 7.0) * np.array([np.sin(alpha), np.cos(alpha)])
    flank = circle[(circle[:, 0] > 0) & (circle[:, 1] < 12.0) & (circle[:, 0] < 7.0)]
    np.testing.assert_allclose(np.hypot(*(flank - centre).T), 7.0, rtol=1e-9)


@pytest.mark.parametrize(
    "change", [{}, {"motor_force": 0, "axial_force": -60}, {"contact_angle": 60}, {"axial_force": 0}]
)
@pytest.mark.parametrize("shape", [{}, {"roller_profile_radius": float("inf")}, {"axis_distance": 90}])
def test_no_label_of_the_drawing_lies_on_an_arrow_or_another_label(change, shape):
    content = content_of(solve_sliding(tr.Case(**change, **shape), ("forces",)))
    boxes = content["boxes"]
    for middle, half in boxes:
        for start, end in content["lines"]:
            points = np.linspace(start, end, 200)
            assert not np.any(np.all(np.abs(points - middle) < half - 1, axis=1))
    for i, (middle, half) in enumerate(boxes):
        assert all(np.any(np.abs(middle - other) >= half + own) for other, own in boxes[i + 1 :])
    texts = [label["text"] for label, _ in content["labels"]]
    assert "A 21.75 mm" in texts or (shape.get("axis_distance") and "A 90 mm" in texts)
    assert {"N1", "N2", "rad", "ax"} - {label["index"] for label, _ in content["labels"]} <= {"ax"}
    assert "r 6 mm" in texts and ("r 7 mm" in texts or "straight profile" in texts)


def test_lengths_of_the_drawing_have_the_digits_of_a_drawing():
    case = tr.Case.from_dict({"outer_radius": 26, "groove_depth": 3, "roller_profile_radius": -6.6})
    texts = [label["text"] for label, _ in content_of(solve_sliding(case, ("forces",)))["labels"]]
    assert f"A {case.axis_distance:.5g} mm" in texts and len(str(case.axis_distance)) > 7


LETTERS = """(() => { let least = 99; const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) { const owner = texts.currentNode.parentElement;
    if (!texts.currentNode.textContent.trim() || !owner.getClientRects().length) continue;
    const drawing = owner.closest('svg');
    const scale = drawing ? drawing.getBoundingClientRect().width / drawing.viewBox.baseVal.width : 1;
    least = Math.min(least, 0.75 * scale * parseFloat(getComputedStyle(owner).fontSize)); }
  return least; })()"""
PAGE_WIDTH = 718  # px of A4 within the margins


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="needs chromium")
def test_the_sheet_prints_in_letters_of_7_points_and_fits_a_phone(written):
    browser = Browser()
    page = browser.open(written[0], width=PAGE_WIDTH)
    page.media("print")
    assert page.run(LETTERS) >= 7.0
    assert page.run("document.documentElement.scrollWidth") <= PAGE_WIDTH
    images = "[...document.querySelectorAll('figure:not(.small) img')].filter(i => i.width)"
    shown = f"{images}.map(i => i.width / i.naturalWidth)"
    assert all(share > 0.95 for share in page.run(shown))  # the figures have letters of 7 points at their own size
    assert len(re.findall(rb"/Type\s*/Page\b", page.pdf())) <= 4  # the last one has the figures
    page.media()
    page.resize(400)
    assert page.run("document.documentElement.scrollWidth") <= 400
    page.close()
    browser.close()


def test_a_sheet_outside_the_half_space_says_so_first():
    """A groove is judged up to 0.65 of the smallest radius, here the 6 mm of the guide."""
    case = tr.Case(
        axis_distance=20,
        roller_profile_radius=-6.1,
        contact_angle=45,
        radial_force=-300,
        axial_force=70,
        motor_force=-5,
        friction_coefficient=0.15,
        guide_overrollings_per_hour=100,
        roller_material="POM-C",
        guide_material="C45",
    )
    ds = tr.solve(case, (*COMPLETE, "limits"), contact_model="sliding", accuracy="preview")
    assert float(ds["semi_axis_lateral"].max()) > 0.65 * 6.0
    answer = answer_of_roller(ds)
    assert answer.headline["not_judged"] == ["outside the half-space"]
    assert "f the model holds (outside the half-space: not judged)" in headline(answer)
    assert answer.headline["low"] == float(ds["life_to_first_limit_hours"].min())
    closer = tr.solve(dataclasses.replace(case, roller_material="C45"), (*COMPLETE, "limits"), contact_model="sliding")
    assert answer_of_roller(closer).headline["not_judged"] == []


@pytest.mark.parametrize(("friction", "source"), [(None, "database"), ("upper", "database"), (0.2, "given")])
def test_friction_of_the_database_is_not_shown_as_given(friction, source, tmp_path):
    ds = tr.solve(tr.Case(friction_coefficient=friction, motor_force=0), contact_model="sliding")
    rows = openpyxl.load_workbook(write_roller(ds, tmp_path / "roller.xlsx"))["inputs"].values
    (row,) = [row for row in rows if row[0] == "friction_coefficient"]
    assert row[-1] == source
