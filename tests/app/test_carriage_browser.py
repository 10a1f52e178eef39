"""The tab Carriage in a real browser: pointer, keyboard, fields, text and files."""

from __future__ import annotations

import json
from contextlib import closing

import pytest
from browser import CHROMIUM, Page

from trackroller.carriage.example import EXAMPLE
from trackroller.study.spectrum.file import load_spectrum
from trackroller.yaml_file import parse_mapping

pytestmark = [pytest.mark.browser, pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")]

STAGE = "document.querySelector('.carriage .stage').dataset.stage"
SETTLED = f"document.querySelector('.carriage') !== null && {STAGE} === 'complete'"


@pytest.fixture
def page(browser, live):
    with closing(Page(browser, live.address + "#tab=carriage", width=1280, height=800)) as shown:
        shown.until(SETTLED)
        yield shown
        assert [c for c in shown.complaints if "422" not in c] == []


def field(path):
    return f"document.querySelector('[data-path=\"{path}\"]')"


def value(page, path):
    return page.run(f"{field(path)}.value")


def type_into(page, path, text):
    page.run(f"{field(path)}.value = {json.dumps(text)}; {field(path)}.dispatchEvent(new Event('change'))")


def press(page, words):
    page.run(f"[...document.querySelectorAll('.carriage button')].find((b) => b.textContent === '{words}').click()")


def text(page):
    return page.run("document.querySelector('.carriage textarea').value")


def loads(page):
    """Return the texts of the table of loads, by roller."""
    rows = page.run("""[...document.querySelectorAll('.seen .numbers tbody tr')].map((row) =>
        [...row.children].map((cell) => cell.textContent))""")
    return {row[0]: row[1:-1] for row in rows}


def test_the_example_is_solved_at_once(page):
    assert "ends first" in page.run("document.querySelector('.carriage .verdict').textContent")
    assert text(page) == EXAMPLE
    assert list(loads(page)) == ["FL", "FR", "RL", "RR"]
    assert page.run("document.querySelectorAll('.views svg').length") == 2
    assert page.run("document.querySelectorAll('.views .shaft').length") > 4


def test_the_pointer_moves_a_roller_with_its_partner(page):
    before = loads(page)
    left, top, width, height = page.box("[data-handle='roller 0 y']")
    start = (left + width / 2, top + height / 2)
    page.drag(start, (start[0] - 60, start[1] - 20))
    page.until(SETTLED)
    x, y = (float(value(page, f"rollers.FL.at.{axis}")) for axis in (0, 1))
    assert x < 140 and y > 42
    assert float(value(page, "rollers.FR.at.0")) == x and float(value(page, "rollers.FR.at.1")) == -40
    written = parse_mapping(text(page), "file")["rollers"]
    assert written["FL"]["at"][:2] == [x, y] and "# front left" in text(page)
    assert loads(page) != before
    page.run("[...document.querySelectorAll('header button')].find((b) => b.textContent === 'Undo').click()")
    page.until(f"{field('rollers.FL.at.0')}.value === '150'")  # one movement is one step
    page.until(SETTLED)
    assert loads(page) == before


def test_arrow_keys_move_a_mass(page):
    page.run("document.querySelector('[data-handle=\"mass 1 z\"]').focus()")
    page.key("ArrowRight", "ArrowRight", "ArrowDown")
    page.until(f"{field('payloads.0.at.2')}.value === '149'")
    assert value(page, "payloads.0.at.0") == "82"
    assert page.run("document.activeElement.dataset.handle") == "mass 1 z"
    assert "x 82, z 149 mm" in page.run("document.activeElement.getAttribute('aria-label')")
    page.until(SETTLED)


def test_a_wrong_value_is_named_beside_its_field_and_the_picture_stays(page):
    before = page.run("document.querySelectorAll('.views .handle').length")
    type_into(page, "cases.1.speed", "fast")
    page.until(f"{field('cases.1.speed')}.getAttribute('aria-invalid') === 'true'")
    place = page.run(f"document.getElementById({field('cases.1.speed')}.getAttribute('aria-describedby')).textContent")
    assert "'fast'" in place and "a speed > 0" in place
    assert page.run("document.querySelectorAll('.views .handle').length") == before
    type_into(page, "cases.1.speed", "1.5 m/s")
    page.until(SETTLED)
    assert page.run(f"{field('cases.1.speed')}.getAttribute('aria-invalid')") is None


def test_a_carriage_that_tips_is_named_and_can_be_mended(page):
    press(page, "Add a payload")
    page.until(f"{field('payloads.1.value')} !== null")
    area = "document.querySelector('.carriage textarea')"
    page.run(f"""{area}.value = {area}.value.replace(/preload:[^]*?cases:/, 'cases:');
        {area}.focus(); {area}.dispatchEvent(new Event('input'))""")
    page.until(f"{STAGE} === 'refused'")
    assert "the carriage: it" in page.run("document.querySelector('#carriage-said').textContent")
    assert page.run("document.querySelectorAll('.views .handle').length") == 2 * (4 + 3)
    page.run(f"{area}.value = {json.dumps(EXAMPLE)}; {area}.dispatchEvent(new Event('input'))")
    page.until(SETTLED)
    assert page.run("document.querySelectorAll('.views .handle').length") == 2 * (4 + 2)


def test_a_carriage_is_saved_and_its_address_repeats_it(page, browser, live):
    type_into(page, "mass.value", "44 kg")
    page.until(f"{STAGE} === 'loads' || {STAGE} === 'complete'")
    page.run("document.querySelector('[aria-label=\"Name of the file\"]').value = 'saved.yaml'")
    press(page, "Save")
    page.until("location.hash.includes('carriage=saved.yaml')")
    assert parse_mapping((live.folder / "saved.yaml").read_text(), "file")["mass"]["value"] == "44 kg"
    with closing(Page(browser, live.address + "#tab=carriage&carriage=saved.yaml", width=1280, height=800)) as again:
        again.until(SETTLED)
        assert value(again, "mass.value") == "44 kg"
        again.run("document.querySelector('[aria-label=\"Write the spectrum of roller RL\"]').click()")
        again.until("document.querySelector('.files [role=status]').textContent.includes('saved-RL.yaml')")
    assert len(load_spectrum(live.folder / "saved-RL.yaml").blocks) == 3


def test_the_roller_is_not_changed_by_the_carriage(page):
    case = page.run("JSON.stringify(trackroller.state.values)")
    type_into(page, "mass.value", "41 kg")
    page.until(SETTLED)
    page.run("document.querySelector('#tab-carriage').focus()")
    page.key("ArrowRight")
    assert page.run("trackroller.state.tab") == "requirement"
    page.key("ArrowRight")
    assert page.run("trackroller.state.tab") == "roller"
    assert page.run("JSON.stringify(trackroller.state.values)") == case


def test_print_shows_picture_and_tables_only(page):
    page.media("print")
    shown = "getComputedStyle(document.querySelector('.carriage .{}')).display !== 'none'"
    assert [page.run(shown.format(part)) for part in ("views", "lives", "set", "file", "files")] == [
        *(True, True),
        *(False, False, False),
    ]
    page.media()
