"""The page of an answer: every number of its table, what is said once, widths, and labels that do not collide."""

from __future__ import annotations

import base64
import csv
import dataclasses
import io
import re

import made_answers
import numpy as np
import pytest
from browser import CHROMIUM, Browser
from golden_pages import visible

from trackroller.report.pages.blocks import empty_proof, screen_of
from trackroller.report.pages.study import page_text
from trackroller.report.pictures.axis import Axis, tick_text
from trackroller.report.pictures.bars import Bars
from trackroller.report.pictures.distribution import draw_distribution
from trackroller.report.pictures.frame import cut_apart
from trackroller.report.pictures.marks import spread_labels, width_of
from trackroller.report.tables.rows import FIRST_ROWS, MOST_SHOWN, rows_of, text_of


def page_of(name):
    return page_text(made_answers.ALL[name](), empty_proof(), None)


@pytest.mark.parametrize("name", made_answers.ALL)
def test_a_page_asks_for_nothing_and_has_no_undefined_number(name):
    page = page_of(name)
    assert "default-src 'none'" in page and " style=" not in page
    assert not re.search(r"https?://(?!www.w3.org)", page)
    lines = visible(page)
    assert not [line for line in lines if re.search(r"\bnan\b|\bNone\b(?! \w)", line) and line != "None."]


@pytest.mark.parametrize("name", made_answers.ALL)
def test_every_column_stands_in_the_table_below_it_or_in_the_proof(name):
    answer = made_answers.ALL[name]()
    screen = screen_of(answer)
    shown = {head.name for head in screen["table"].rows.heads}
    others = {head.name for head in screen["others"].heads} if screen["others"] else set()
    drawn = {"best"}
    assert {column.name for column in answer.columns} == shown | others | set(answer.shared) | drawn & {
        column.name for column in answer.columns
    }


def test_cells_say_the_numbers_of_the_record():
    answer = made_answers.decide()
    row = answer.table.iloc[2].to_dict()
    texts = {column.name: text_of(answer, column, row) for column in answer.columns}
    assert texts["low"] == "71,300 to 214,000" and texts["error"] == "5" and texts["holds"] == "12"
    assert texts["ratio"] == "0.303 to 0.336" and texts["axis_distance"] == "18"


def test_difficult_numbers_stay_apart():
    answer = made_answers.long_names()
    column = next(one for one in answer.columns if one.name == "low")
    texts = [text_of(answer, column, row) for row in answer.table.to_dict("records")]
    assert texts == ["∞", "0 to ∞", "6 to 730,000", "0.038", "0"]


def test_what_all_rows_share_is_said_once():
    page = visible(page_of("build"))
    said = [line for line in page if "radial force 150 N, velocity 120 m/min" in line]
    assert len(said) == 1 and said[0].startswith("All rows: worst condition radial force 150 N")


def test_a_long_table_is_folded_and_a_very_long_one_counted():
    lines = visible(page_of("thousands"))
    assert f"{MOST_SHOWN - FIRST_ROWS} more rows" in lines
    assert any(line.startswith("2,800 more rows stand in the file") for line in lines)
    assert "more rows" not in " ".join(visible(page_of("build")))


def test_the_file_of_the_table_has_numbers_with_all_digits():
    answer = made_answers.decide()
    link = screen_of(answer)["download"]
    rows = list(csv.DictReader(io.StringIO(base64.b64decode(link.partition(",")[2]).decode())))
    assert [float(row["low"]) for row in rows] == answer.table["low"].tolist()


def test_bars_stand_on_one_axis_in_the_order_of_their_numbers():
    answer = made_answers.decide()
    bars = Bars.of(answer)
    places = [bars.axis.place(value) for value in answer.table["low"]]
    assert places == sorted(places, reverse=True) and 0 < min(places) and max(places) < 100
    ratio = [bars.axis.place(10.0 * value) - bars.axis.place(value) for value in (1e3, 1e4)]
    assert ratio[0] == pytest.approx(ratio[1])


def test_a_required_life_of_the_pair_is_drawn_beside_the_life_to_the_first_limit():
    own = made_answers.required(20_000.0)
    of_pair = dataclasses.replace(own, output="pair_life_hours", words="life of the pair")
    bars = [Bars.of(made_answers.decide(required=(one,))) for one in (own, of_pair)]
    assert bars[0].bounds == bars[1].bounds == ((20_000.0, "required 20,000"),)
    stress = made_answers.stresses().required[0]
    assert Bars.of(made_answers.decide(required=(stress,))).bounds == ()


@pytest.mark.parametrize(
    "ends", [(1e-5, 1e9), (403.0, 463.0), (0.05, 0.3), (-250.0, -150.0), (3e5, 9e5), (1.0, 1.0), (0.0, 0.0)]
)
@pytest.mark.parametrize("length", [120.0, 190.0, 280.0])
def test_ticks_are_round_inside_the_axis_and_do_not_collide(ends, length):
    axis = Axis.of(ends)
    ticks = axis.ticks(length)
    places = [axis.place(value) * length / 100 for value, _ in ticks]
    for (left, (_, one)), (right, (_, other)) in zip(
        list(zip(places, ticks, strict=True)), list(zip(places, ticks, strict=True))[1:], strict=False
    ):
        assert right - left > (width_of(one) + width_of(other)) / 2
    for value, text in ticks:
        assert axis.low <= value <= axis.high
        assert text == tick_text(value)


def test_an_axis_holds_infinite_and_undefined_values_at_its_ends():
    axis = Axis.of([1.0, 1e4, np.inf, np.nan])
    assert axis.place(np.inf) == 100 and axis.place(0.0) == 0 and np.isnan(axis.place(np.nan))


def test_labels_move_apart_and_keep_their_order():
    placed = spread_labels([50.0, 52.0, 51.0, 10.0], 15.0, 0.0, 100.0)
    assert placed[3] == 10.0 and placed[0] < placed[2] < placed[1]
    assert np.diff(sorted(placed)).min() >= 15.0 and max(placed) <= 100


def test_a_table_of_a_wide_answer_leaves_columns_to_the_proof():
    lines = " ".join(visible(page_of("long")))
    assert "More columns of the table" in lines and "Worst condition" in lines
    assert "Ends by" not in [head.title for head in rows_of(made_answers.long_names()).heads]  # said once


COLLISIONS = """(() => {
  const open = [...document.querySelectorAll('details')].filter((one) => !one.open).map((one) => one);
  const found = [];
  for (const svg of document.querySelectorAll('.frame > svg, th.b > svg')) {
    const texts = [...svg.querySelectorAll('text')].filter((one) => one.textContent.trim());
    const boxes = texts.map((one) => one.getBoundingClientRect()).filter((box) => box.width);
    for (let i = 0; i < boxes.length; i++) for (let j = i + 1; j < boxes.length; j++) {
      const [a, b] = [boxes[i], boxes[j]];
      const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (across > 1 && down > 3) found.push(texts[i].textContent + ' / ' + texts[j].textContent);
    }
  }
  return found;
})()"""


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
@pytest.mark.parametrize("width", [400, 1200])
def test_labels_do_not_collide_and_pages_fit_their_width(tmp_path, width):
    browser = Browser()
    try:
        for name in made_answers.ALL:
            path = tmp_path / f"{name}.html"
            path.write_text(page_of(name), encoding="utf-8")
            page = browser.open(path, width=width, height=900)
            assert page.run("document.scrollingElement.scrollWidth") <= width, name
            assert page.run(COLLISIONS) == [], name
            assert page.complaints == [] and page.requests[1:] == [], name
            page.close()
    finally:
        browser.close()


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
@pytest.mark.parametrize("name", ["build", "matters", "models", "front", "shares"])
def test_the_first_screen_holds_headline_table_picture_and_warnings(tmp_path, name):
    browser = Browser()
    try:
        path = tmp_path / "page.html"
        path.write_text(page_of(name), encoding="utf-8")
        page = browser.open(path, width=1200, height=900)
        assert page.run("document.querySelector('.two').getBoundingClientRect().bottom") <= 900
        page.close()
    finally:
        browser.close()


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["quenched steel", "POM"], ["quench…", "POM"]),
        (["1.7225-quenched", "1.7225-normalised", "POM"], ["…quenc…", "…norma…", "POM"]),
        (["groove 6.41", "groove 6.48"], ["…6.41", "…6.48"]),
        (["abcdefghijk1", "abcdefghijk2", "abcdefghixy1"], ["…jk1", "…jk2", "…xy1"]),
        (["abcdefghijk", "abcdefghijkmn", "abcdefghijk"], ["…", "…mn", "…"]),
    ],
)
def test_names_that_differ_are_cut_to_different_texts(names, expected):
    width = width_of("1234567")
    texts = cut_apart(names, width)
    assert texts == expected
    assert max(map(width_of, texts)) <= width
    assert len(set(texts)) == len(set(names))


def test_names_in_no_room_are_cut_all_the_same():
    assert len(cut_apart(["alpha one", "alpha two"], 1.0)) == 2


def test_a_distribution_shows_the_band_between_the_low_and_the_high_ends():
    """At the required value the band spans the shares that the low and the high ends reach."""
    low = np.array([1e3, 2e3, 4e3, 8e3])
    high = 100 * low
    answer = dataclasses.replace(made_answers.how_sure(), required=())
    data = {"values": [np.sqrt(low * high)], "low": [low], "high": [high]}
    picture = draw_distribution(answer, data)
    axis = Axis.of([*low, *high])
    corners = re.search(r'<polygon class="f cm" points="([^"]*)"', picture.drawn).group(1).split()
    for ends in (low, high):
        for place, value in enumerate(ends):
            assert f"{axis.place(value):.1f},{100 * place / 4:.1f}" in corners
    assert "band: its low to its high end" in picture.caption
    alike = draw_distribution(answer, data | {"high": [low]})
    assert "polygon" not in alike.drawn and "band" not in alike.caption
