"""The live page in a real browser: what a designer does, by pointer and by keyboard, at three widths."""

from __future__ import annotations

import json
import time
from contextlib import closing
from pathlib import Path

import pytest
import yaml
from browser import CHROMIUM, Page
from live_page import LivePage

pytestmark = [pytest.mark.browser, pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")]

AXE = Path(__file__).resolve().parents[2] / "web" / "node_modules" / "axe-core" / "axe.min.js"
SETTLED = "document.querySelector('.stage')?.dataset.stage === 'complete'"
DAY = "hours_per_day"
ASKED = "document.querySelector('[data-field={}]').closest('.field').querySelector('.asked')"
STORED = """name: markup
description: "<img src=x onerror=document.title='broken'>"
factors: {friction_coefficient: {values: [0.1, 0.2]}}
contact_model: sliding
accuracy: preview
"""


@pytest.fixture
def page(browser, live):
    with closing(Page(browser, live.address + "#tab=roller", width=1280, height=800)) as shown:
        shown.until(SETTLED)
        yield shown
        assert [c for c in shown.complaints if "422" not in c] == []  # a wrong value is an answer with this status
        assert all(url.startswith(f"http://{live.host}/") for url in shown.requests)


def verdict(page):
    return page.run("document.querySelector('.verdict').textContent")


def type_into(page, field, text):
    page.run(f"""(() => {{ const f = document.querySelector('[data-field={field}]'); f.value = {json.dumps(text)};
        document.querySelector('.stage').dataset.stage = 'old'; f.dispatchEvent(new Event('change')); }})()""")


def show(page, tab):
    page.run(f"document.querySelector('#tab-{tab}').click()")


def test_a_slider_moves_the_picture_first_in_preview_then_in_standard(page):
    stages = page.run("""(async () => { const seen = []; const stage = document.querySelector('.stage');
        new MutationObserver(() => seen.at(-1) !== stage.dataset.stage && seen.push(stage.dataset.stage))
          .observe(stage, {attributes: true});
        const slider = document.querySelector('[aria-label="Axial force, slider"]');
        for (const value of [35, 40, 50, 60, 70]) { slider.value = value; slider.dispatchEvent(new Event('input'));
          await new Promise((done) => setTimeout(done, 60)); }
        slider.dispatchEvent(new Event('change'));
        while (!seen.length || stage.dataset.stage !== 'complete')
          await new Promise((done) => setTimeout(done, 50));
        return seen; })()""")
    assert stages == ["preview", "standard", "complete"]
    assert page.run("location.hash") == "#axial_force=70"
    assert "then fatigue of the" in verdict(page)
    page.run("[...document.querySelectorAll('header button')].find((b) => b.textContent === 'Undo').click()")
    page.until("!location.hash.includes('axial_force')")  # one movement is one step
    page.until(SETTLED)


def test_the_page_begins_with_the_roller_of_the_readme(browser, live):
    readme = (Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")
    with closing(Page(browser, live.address, width=1280, height=800)) as shown:
        shown.until(SETTLED)
        given = dict(pair.split("=") for pair in shown.run("location.hash.slice(1)").split("&"))
        assert shown.run("document.documentElement.scrollHeight") <= 800  # one screen without scrolling
        assert given["roller_material"] in readme and given["guide_material"] in readme
        call = readme.partition("tr.solve(tr.Case(")[2].partition(", **")[0]
        assert call == ", ".join(f"{name}={value}" for name, value in given.items() if not name.endswith("material"))
        assert float(verdict(shown).split()[0].replace(",", "")) > 8.0
        shown.run("document.querySelector('[data-field=axial_force]').focus()")
        type_into(shown, "axial_force", "70")
        shown.until(SETTLED)
        shown.run("[...document.querySelectorAll('header button')].find((b) => b.textContent === 'Reset').click()")
        shown.until("!location.hash.includes('axial_force')")
        assert dict(pair.split("=") for pair in shown.run("location.hash.slice(1)").split("&")) == given


@pytest.mark.parametrize(("roller", "guide"), [("PA6", "PA6"), ("1.7225-quenched-tempered", "EN AW-7075")])
def test_a_roller_with_many_warnings_stands_on_one_screen(page, roller, guide):
    loads = {"radial_force": -3000, "friction_coefficient": 0.6, "motor_force": -60, "velocity": 2000}
    page.run(f"""document.querySelector('.stage').dataset.stage = 'old';
        trackroller.state.replace({json.dumps(loads | {"roller_material": roller, "guide_material": guide})})""")
    page.until(SETTLED)
    assert page.run("document.querySelectorAll('.warnings li').length") >= 3
    assert page.run("document.documentElement.scrollHeight") <= 800
    page.run("document.querySelector('.full').click()")
    assert page.run("[...document.querySelectorAll('.warnings li')].every((w) => w.scrollWidth <= w.clientWidth)")
    assert page.run("[...document.querySelectorAll('.warnings li')].every((w) => w.clientHeight > 0)")


def test_a_profile_is_chosen_among_the_files_of_the_folder(browser, live):
    rows = [f"{0.05 * i:.2f},{-(7 - (49 - (0.05 * i) ** 2) ** 0.5):.6f}" for i in range(-120, 121)]
    (live.folder / "groove one.csv").write_text("x [mm],z [mm]\n" + "\n".join(rows))
    with closing(Page(browser, live.address + "#normal=halfspace", width=1280, height=800)) as shown:
        shown.until(SETTLED)
        assert "r 7 mm" in shown.run("document.querySelector('.drawing').textContent").replace("C,TR", "")
        field = "document.querySelector('[data-field=roller_profile]')"
        offered = shown.run(f"[...{field}.list.options].map((option) => option.value)")
        type_into(shown, "roller_profile", next(one for one in offered if "groove one" in one))
        shown.until(SETTLED)
        assert "drawn profile" in shown.run("document.querySelector('.drawing').textContent")
        shown.run("document.querySelectorAll('.stage').forEach((s) => (s.dataset.stage = 'old'))")


def test_wear_over_a_travel_waits_until_the_fields_rest(browser, live):
    address = live.address + "#normal=halfspace&wear_coefficient_factor=1"
    with closing(Page(browser, address, width=1280, height=800)) as shown:
        shown.until(SETTLED)
        new = verdict(shown)
        told = shown.run("""(async () => { const seen = []; const stage = document.querySelector('.stage');
            new MutationObserver(() => seen.push(stage.textContent)).observe(stage, {childList: true});
            const field = document.querySelector('[data-field=travel]'); field.value = '1';
            stage.dataset.stage = 'old'; field.dispatchEvent(new Event('change'));
            while (stage.dataset.stage !== 'complete') await new Promise((done) => setTimeout(done, 50));
            return seen; })()""")
        assert all("before the travel" in text for text in told[:2]) and "travel" not in told[-1]
        assert verdict(shown) != new


def test_a_wrong_value_is_named_beside_its_field_and_the_last_picture_stays(page):
    before = page.run("document.querySelector('.drawing').outerHTML")
    type_into(page, "contact_angle", "95")
    page.until("document.querySelector('.stage').dataset.stage === 'refused'")
    said = page.run("document.querySelector('#field-contact_angle-said').textContent")
    assert "contact_angle = 95" in said and "< 90" in said
    assert page.run("document.querySelector('[data-field=contact_angle]').getAttribute('aria-invalid')") == "true"
    assert page.run("document.querySelector('.drawing').outerHTML") == before
    type_into(page, "contact_angle", "35")
    page.until(SETTLED)
    assert page.run("document.querySelector('#field-contact_angle-said').textContent") == ""


@pytest.mark.parametrize(
    "text, said",
    [
        ("name: a\noutputs: 5\nfactors: {velocity: {values: [1, 2]}}", "outputs"),
        ("name: a\nfactors: {velocity: {values: 3}, motor_force: null}", "factors.velocity"),
        ("name: a\nfactors: 7\nroles: 3", "factors"),
        ("name: [", "study file"),
        ("- 1", "study file"),
    ],
)
def test_every_wrong_study_file_is_named_in_words(page, text, said):
    show(page, "study")
    page.run(f"""(() => {{ const area = document.querySelector('textarea'); area.value = {json.dumps(text)};
        area.dispatchEvent(new Event('input')); }})()""")
    page.until(f"document.querySelector('#study-said').textContent.includes({json.dumps(said)})")
    assert "TypeError" not in page.run("document.querySelector('#study-said').textContent")
    assert page.run("document.querySelector('button.main').disabled")


def test_a_factor_keeps_its_range_when_its_kind_changes(page):
    page.run("document.querySelector('[aria-label=\"Make Axial force a factor of the study\"]').click()")
    kind, values = (
        f"document.querySelector('[aria-label=\"Axial force: {name}\"]')" for name in ("kind of values", "values")
    )
    seen = {}
    # answers that come after the next change must not take it back
    late = "(...all) => new Promise((go) => setTimeout(go, 250)).then(() => own(...all))"
    page.run(f"own = window.fetch; window.fetch = {late}")
    for name in ("linspace", "normal", "uniform", "triangular", "values"):
        page.run(f"{kind}.value = '{name}'; {kind}.dispatchEvent(new Event('change'))")
        seen[name] = page.run(f"{values}.value")
        time.sleep(0.45)
    page.run("window.fetch = own")
    assert seen["linspace"] == "24, 36, 5" and seen["normal"] == "30, 3"
    assert seen["uniform"] == "24, 36" and seen["triangular"] == seen["values"] == "24, 30, 36"


def asked(page, field):
    return page.run(f"{ASKED.format(field)}.textContent")


def answer(page, field):
    page.run(f"{ASKED.format(field)}.querySelector('button').click()")


def case_of(page):
    return page.run("({...trackroller.state.values})")


def test_the_page_takes_the_words_of_a_drawing(page):
    """Outer radius, groove depth, rail diameter, duty and a straight track; a groove typed with the wrong sign asks."""
    page.run("trackroller.state.replace({axis_distance: '22', motor_force: '0'})")
    type_into(page, "roller_profile_radius", "6,6")
    assert case_of(page)["roller_profile_radius"] == "6.6"
    assert "Is a groove meant? −6.6" in asked(page, "roller_profile_radius")
    answer(page, "roller_profile_radius")
    assert case_of(page)["roller_profile_radius"] == "-6.6" and asked(page, "roller_profile_radius") == ""
    typed = {"outer_radius": "26", "groove_depth": "3", "rail_diameter": "11.8", "guide_curve_radius": "Straight"}
    for field, text in typed.items():
        type_into(page, field, text)
    type_into(page, "days_per_year", "250")
    type_into(page, "hours_per_day", "16")
    sizes = {"outer_radius": "26", "groove_depth": "3", "guide_profile_radius": "5.9", "guide_curve_radius": "inf"}
    duty = {"duty": "{hours_per_day: 16, days_per_year: 250}"}
    assert case_of(page) == {"motor_force": "0", "roller_profile_radius": "-6.6", **sizes, **duty}
    page.until(SETTLED)
    assert "(up to 1.5 years" in verdict(page)  # the shorter end is less than one
    fields = [f"document.querySelector('[data-field={n}]').value" for n in ("axis_distance", "rail_diameter", DAY)]
    assert [page.run(field) for field in fields] == ["", "11.8", "16"]


def test_a_range_in_a_field_becomes_a_factor_and_lists_take_decimal_commas(page):
    before = case_of(page)
    type_into(page, "friction_coefficient", "0,12–0,25")
    assert case_of(page) == before and "Is 0,12–0,25 a range?" in asked(page, "friction_coefficient")
    answer(page, "friction_coefficient")
    page.until("document.querySelector('textarea').value.includes('linspace')")
    field = "document.querySelector('[aria-label=\"Friction coefficient: values\"]')"
    assert page.run(f"{field}.value") == "0.12, 0.25, 5"
    kind = "document.querySelector('[aria-label=\"Friction coefficient: kind of values\"]')"
    page.run(f"{kind}.value = 'values'; {field}.value = '0,1; 0,25; 0.3'; {field}.dispatchEvent(new Event('change'))")
    page.until("document.querySelector('.plan').textContent.includes('3, 0 of them')")
    written = yaml.safe_load(page.run("document.querySelector('textarea').value"))
    assert written["factors"] == {"friction_coefficient": {"values": [0.1, 0.25, 0.3]}}


def test_results_offer_sheet_and_workbook_of_the_roller(page):
    type_into(page, "axial_force", "44")
    show(page, "results")
    page.until("document.querySelectorAll('.results .tools a').length === 3")
    told = "[a.textContent, decodeURIComponent(a.href)]"
    links = page.run(f"[...document.querySelectorAll('.results .tools a')].map((a) => {told})")
    assert [words for words, _ in links] == ["Sheet", "Sheet as PDF", "Workbook"]
    assert all('"axial_force":"44"' in address for _, address in links)


def test_a_wrong_material_is_named_beside_its_field(page):
    type_into(page, "guide_material", "no such")
    page.until("document.querySelector('#field-guide_material-said').textContent.includes(\"'no such'\")")
    type_into(page, "guide_material", "1.7225-normalised")
    page.until(SETTLED)


def test_the_address_repeats_what_is_on_the_screen(page, browser, live):
    type_into(page, "roller_material", "PA6")
    type_into(page, "guide_curve_radius", "inf")
    page.until(SETTLED)
    page.run("[...document.querySelectorAll('header button')].find((b) => b.textContent === 'Pin').click()")
    page.until("location.hash.includes('pin=')")
    told = verdict(page)
    with closing(Page(browser, live.address + page.run("location.hash"), width=1280, height=800)) as again:
        again.until(SETTLED)
        assert verdict(again) == told
        show(again, "whatif")
        again.until("document.querySelectorAll('.variants tbody tr').length > 20")
        assert again.run("document.querySelectorAll('.variants .other').length") == 0


def test_variants_show_their_differences_and_a_curve_follows(page):
    page.run("[...document.querySelectorAll('header button')].find((b) => b.textContent === 'Pin').click()")
    type_into(page, "axial_force", "60")
    page.run("document.querySelector('[aria-label=\"Curve over Axial force\"]').click()")
    page.until("document.querySelectorAll('.variants .other').length > 5")
    page.until("!document.querySelector('.variants').textContent.includes('…')")
    marked = page.run("[...document.querySelectorAll('.variants tr.differs th')].map((th) => th.textContent)")
    assert "axial force Fax" in marked and "radial force Frad" not in marked
    page.until("document.querySelectorAll('.whatif details tbody tr').length === 21")
    page.until("document.querySelector('.whatif pre').textContent.includes('axial_force=60')")


def test_what_if_sums_loads_by_share_and_finds_how_far_a_force_may_go(page):
    type_into(page, "motor_force", "0")
    page.until(SETTLED)
    show(page, "whatif")
    page.until("document.querySelectorAll('.blocks tbody tr').length === 3")
    clicked = "[...document.querySelectorAll('.whatif button')].find((b) => b.textContent === %s).click()"
    page.run(clicked % json.dumps("Sum up"))
    page.until("document.querySelector('.spectrum').textContent.includes('then fatigue')")
    page.run("""(() => { const f = document.querySelector('[aria-label="share of the time of load 1"]');
        f.value = '40 %'; f.dispatchEvent(new Event('change')); })()""")
    page.run(clicked % json.dumps("Sum up"))
    page.until("document.querySelector('.spectrum').textContent.includes('add up to 1')")
    page.until("document.querySelector('.side').textContent.includes('Solved with preview')")
    page.run("""document.querySelector('[aria-label="Value that the result has to meet"]').value = '5,5'""")
    chosen = page.run("document.querySelector('.side select').selectedIndex")
    page.run("document.querySelector('.side select').selectedIndex = -1")  # as before the curve is solved
    page.run(clicked % json.dumps("How far may it go?"))
    assert "still being solved" in page.run("document.querySelector('.side').textContent")
    page.run(f"document.querySelector('.side select').selectedIndex = {chosen}")
    page.run(clicked % json.dumps("How far may it go?"))
    page.until("document.querySelector('.side').textContent.includes('pair_life_to_first_limit_hours >= 5.5')")


def test_a_study_is_made_by_clicks_and_by_text(page):
    type_into(page, "axial_force", "45")
    page.run("document.querySelector('[aria-label=\"Make Friction coefficient a factor of the study\"]').click()")
    page.until("!document.querySelector('button.main').disabled")
    text = page.run("document.querySelector('textarea').value")
    assert "friction_coefficient" in text and "axial_force: 45" in text
    assert "3, 0 of them solved" in page.run("document.querySelector('.plan').textContent")
    page.run("""(() => { const area = document.querySelector('textarea');
        area.value += 'method: lhs\\nsamples: seven\\n'; area.focus(); area.dispatchEvent(new Event('input')); })()""")
    page.until("document.querySelector('.study .warnings').textContent.includes('samples')")
    assert page.run("document.querySelector('button.main').disabled")
    page.run("""(() => { const area = document.querySelector('textarea');
        area.value = area.value.replace('seven', '7').replace(/values:[^b]*/, 'uniform: [0.1, 0.3]\\n');
        area.dispatchEvent(new Event('input')); })()""")
    page.until("!document.querySelector('button.main').disabled")
    fields = page.run("[...document.querySelectorAll('.study select, .study input')].map((f) => f.value)")
    assert {"lhs", "7", "uniform", "0.1, 0.3"} <= set(fields)


def test_a_study_takes_profile_duty_and_options_of_the_roller(page, live):
    rows = [f"{0.05 * i:.2f},{-(7 - (49 - (0.05 * i) ** 2) ** 0.5):.6f}" for i in range(-120, 121)]
    (live.folder / "arc.csv").write_text("x [mm],z [mm]\n" + "\n".join(rows))
    given = {"normal": "halfspace", "roller_profile": '{file: "arc.csv"}', "credit_pressure": "false"}
    given |= {"duty": "{hours_per_day: 16, days_per_year: 250}", "contact_model": "sliding"}
    page.run(f"trackroller.state.replace({json.dumps(given)})")
    page.run("document.querySelector('[aria-label=\"Make Axial force a factor of the study\"]').click()")
    page.until("document.querySelector('.plan').textContent.includes('3, 0 of them')")
    written = yaml.safe_load(page.run("document.querySelector('textarea').value"))
    assert written["base"] == {"roller_profile": {"file": "arc.csv"}}
    assert written["duty"] == {"hours_per_day": 16, "days_per_year": 250} and written["credit_pressure"] is False
    page.run("trackroller.state.replace({motor_force: 0})")
    page.run("[...document.querySelectorAll('button')].find((b) => b.textContent.startsWith('Take the')).click()")
    page.until("!document.querySelector('textarea').value.includes('duty')")
    again = yaml.safe_load(page.run("document.querySelector('textarea').value"))
    assert again["base"] == {"motor_force": 0} and not {"normal", "credit_pressure"} & set(again)


def test_names_with_markup_stay_text(page, live):
    assert live.ask("start", text=STORED)[0] == 200
    show(page, "results")
    page.until("document.querySelector('.studies').textContent.includes('<img src=x')")
    live.until("markup", "done")
    page.until("document.querySelector('[aria-label=\"Report of markup\"]') !== null")
    assert page.run("document.title") == "trackroller – one roller, live"
    assert page.run("document.querySelectorAll('.studies img').length") == 0
    page.until("document.querySelector('[aria-label=\"Delete markup\"]') !== null")
    page.run("document.querySelector('[aria-label=\"Delete markup\"]').click()")
    assert live.entry("markup")["state"] == "done"  # the question stands on the page
    page.run("document.querySelector('dialog .danger').click()")
    page.until("!document.querySelector('.studies').textContent.includes('markup')")


def test_two_pages_disturb_each_other_not(page, browser, live):
    with closing(Page(browser, live.address + "#axial_force=20", width=800, height=600)) as other:
        type_into(page, "axial_force", "55")
        other.until(SETTLED)
        page.until(SETTLED)
        forces = [p.run("document.querySelector('.drawing').textContent") for p in (page, other)]
        assert "55 N" in forces[0] and "20 N" in forces[1]


SHELF = """name;axis_distance;roller_profile_radius;roller_material;price [EUR]
mid;30;-6.4;1.7225-quenched-tempered;3
large;40;-6.2;1.7225-quenched-tempered;5
soft;19;-7;1.7225-normalised;1
"""


def sized(page, folder=None):
    """Ask the tab Requirement for the least roller of a shelf in the folder of the page."""
    steel = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
    values = steel | {"motor_force": 0, "friction_coefficient": 0.1, "contact_model": "sliding"}
    page.run(f"trackroller.state.replace({json.dumps(values)})")
    show(page, "requirement")
    fill = '(label, value) => { const f = document.querySelector(`[aria-label="${label}"]`); f.value = value; '
    fill += "f.dispatchEvent(new Event('change')); }"
    for label, value in (
        ("Shelf: a table of rollers", "shelf-of-a-test.csv"),
        ("Life", "5000"),
        ("Safety against overload", "1.5"),
        ("Permissible wear depth [mm]", "900"),
        ("Least", "price"),
    ):
        page.run(f"({fill})({json.dumps(label)}, {json.dumps(value)})")
    page.run(
        "[...document.querySelectorAll('.requirement button')].find((b) => b.textContent === 'Find the roller').click()"
    )
    page.until("document.querySelector('.cards')?.dataset.accuracy === 'standard'")


@pytest.fixture(autouse=True)
def shelf(live):
    (live.folder / "shelf-of-a-test.csv").write_text(SHELF, encoding="utf-8")


def test_a_requirement_finds_the_least_roller_first_in_preview(page):
    page.run("""window.seen = []; new MutationObserver(() => { const t = document.querySelector('.cards');
        if (t && seen.at(-1) !== t.dataset.accuracy) seen.push(t.dataset.accuracy); })
        .observe(document.querySelector('.requirement'), {childList: true, subtree: true}); 0""")
    sized(page)
    assert page.run("seen") == ["preview", "standard"]
    lead = page.run("document.querySelector('.requirement .verdict').textContent")
    assert lead.startswith("mid is the least of 2 that are enough: price 3")
    cells = page.run(
        "[...document.querySelectorAll('.cards .exceeded')].map((c) => c.parentElement.cells[0].textContent)"
    )
    assert cells == ["soft"]
    heads = page.run(
        "[...document.querySelectorAll('.cards')[0].querySelectorAll('thead th')].map((c) => c.textContent)"
    )
    assert "wear ratio" in heads


def test_rollers_are_cards_on_a_phone(page):
    page.resize(400, 800)
    sized(page)
    assert page.run("getComputedStyle(document.querySelector('.cards thead')).display") == "none"
    assert page.run("getComputedStyle(document.querySelector('.cards tr')).display") == "block"
    heads = page.run("[...document.querySelectorAll('.cards tbody tr:first-child td')].map((c) => c.dataset.head)")
    assert "verdict" in heads and "price [EUR]" in heads
    assert page.run("document.documentElement.scrollWidth") <= 400


def test_a_requirement_takes_strokes_and_keeps_their_unit(page):
    show(page, "requirement")
    fill = '(label, value) => { const f = document.querySelector(`.requirement [aria-label="${label}"]`); '
    fill += "f.value = value; f.dispatchEvent(new Event('change')); }"
    for label, value in (("Strokes a day", "400"), ("Stroke [m]", "800 mm"), ("Days a year", "250")):
        page.run(f"({fill})({json.dumps(label)}, {json.dumps(value)})")
    duty = page.run("trackroller.state.values.duty")
    assert yaml.safe_load(duty) == {"days_per_year": 250, "strokes_per_day": 400, "stroke": "800 mm"}


def test_what_a_requirement_lacks_is_said(page):
    show(page, "requirement")
    page.run(
        "[...document.querySelectorAll('.requirement button')].find((b) => b.textContent === 'Find the roller').click()"
    )
    page.until("document.querySelector('.requirement [role=status]').textContent.includes('Choose a file')")


@pytest.mark.skipif(not AXE.is_file(), reason="needs axe-core: npm ci in web/")
@pytest.mark.parametrize("tab", ["roller", "whatif", "study", "results", "carriage", "requirement"])
@pytest.mark.parametrize("width, scheme", [(1280, "light"), (1280, "dark"), (400, "light")])
def test_axe_finds_nothing(page, tab, width, scheme):
    page.resize(width, 800)
    page.media(prefers_color_scheme=scheme)
    show(page, tab)
    page.run("document.querySelectorAll('details').forEach((d) => (d.open = true))")
    if tab == "whatif":
        page.run("trackroller.state.pin()")
        page.until("document.querySelectorAll('.variants tbody tr').length > 20")
    if tab == "carriage":
        page.until("document.querySelector('.carriage .stage').dataset.stage === 'complete'")
    if tab == "requirement":
        sized(page)
    page.call("Page.setBypassCSP", enabled=True)
    page.run(AXE.read_text(encoding="utf-8") + "; 0")
    found = page.run("axe.run().then((r) => r.violations.map((v) => [v.id, v.nodes.map((n) => n.html.slice(0, 90))]))")
    assert found == []


@pytest.mark.parametrize("width", [400, 800, 1280, 1600])
def test_no_width_scrolls_sideways(page, width):
    page.resize(width, 800)
    steel = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
    page.run(f"trackroller.state.replace({json.dumps(steel | {'motor_force': 0, 'friction_coefficient': 0.1})})")
    page.until("document.querySelector('.margins').textContent.includes('kept')")
    for tab in ("roller", "whatif", "study", "results", "carriage", "requirement"):
        show(page, tab)
        if tab == "carriage":
            page.until("document.querySelectorAll('.views .handle').length > 0")
        assert page.run("document.documentElement.scrollWidth") <= width, tab


def test_margins_with_years_fit_a_phone_and_name_their_body(browser, live):
    of_a_duty = "permissible_wear_depth=0.1&guide_overrollings_per_hour=60&motor_force=0"
    of_a_duty += "&duty=%7Bhours_per_day%3A+16%2C+days_per_year%3A+250%7D"
    with closing(Page(browser, f"{live.address}#tab=roller&{of_a_duty}", width=400, height=800)) as shown:
        shown.until(SETTLED)
        rows = shown.run("""[...document.querySelectorAll('.margins tbody tr')].map((r) => [...r.cells].filter(
            (c) => getComputedStyle(c).display !== 'none').map((c) => c.textContent))""")
        assert shown.run("document.querySelector('.margins').getBoundingClientRect().right <= innerWidth")
        wear = [row for row in rows if row[0].startswith("wear")]
        assert {row[1] for row in wear} == {"roller", "guide"}
        assert all(" to " in row[-1] for row in wear)  # a life with both ends


def test_everything_is_reached_by_the_keyboard(page):
    page.run("document.querySelector('#tab-roller').focus()")
    page.key("ArrowRight")
    assert page.run("trackroller.state.tab") == "whatif"
    page.key("ArrowLeft")
    reached = []
    for _ in range(70):
        page.key("Tab")
        reached.append(page.run("document.activeElement.getAttribute('aria-label') ?? document.activeElement.id"))
    assert {"Axial force, slider", "field-axial_force", "field-roller_material", "Curve over Axial force"} <= set(
        reached
    )
    page.run("document.querySelector('[aria-label=\"Axial force, slider\"]').focus()")
    page.key("ArrowRight", "ArrowRight")
    page.until("document.querySelector('#field-axial_force').value === '34'")
    page.until(SETTLED)


def test_the_notebook_shows_the_case_in_a_frame(tmp_path, monkeypatch):
    import trackroller as tr

    monkeypatch.chdir(tmp_path)
    shown = tr.app(tr.Case(axial_force=70, guide_curve_radius=float("inf")))
    try:
        frame = shown._repr_html_()
        assert frame.startswith("<iframe") and "#guide_curve_radius=inf&amp;axial_force=70.0" in frame
        live = LivePage.__new__(LivePage)
        live.address = shown.address.partition("#")[0]
        assert "http://localhost:*" in live.get("")[2]["Content-Security-Policy"].partition("frame-ancestors")[2]
    finally:
        shown.close()
