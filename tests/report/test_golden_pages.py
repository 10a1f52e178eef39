"""Pages say what their golden text says, word by word; numbers may differ by 1 %."""

from __future__ import annotations

import pytest
from golden_pages import FOLDER, PAGES, difference, made, same, visible


@pytest.mark.parametrize("name", PAGES)
def test_a_page_says_what_its_golden_text_says(name):
    golden = (FOLDER / f"{name}.txt").read_text(encoding="utf-8").splitlines()
    changed = difference(name, golden, made(name))
    assert not changed, f"{changed}\n\nIf this is what the page should say: python tests/golden_pages.py {name}"


def test_each_golden_text_has_a_page():
    assert {file.stem for file in FOLDER.iterdir()} == set(PAGES)


@pytest.mark.parametrize(
    ("line", "other", "equal"),
    [
        ("lasts 1000 h", "lasts 1001 h", True),
        ("lasts 1000 h", "lasts 1020 h", False),
        ("lasts 1000 h", "lasted 1000 h", False),
        ("after 2.47·10⁸ h", "after 2.46·10⁸ h", True),
        ("after 2.47·10⁸ h", "after 2.47·10⁷ h", False),
        ("−30 N", "30 N", False),
        ("12,500 h", "12,510 h", True),
        ("1.3 years", "1.4 years", True),  # rounding may fall to either side
        ("in 3 of 4 conditions", "in 2 of 4 conditions", False),
        ("residual 3·10⁻¹⁶", "residual 9.2·10⁻¹⁶", True),
        ("residual 3·10⁻⁶", "residual 9·10⁻⁶", False),
    ],
)
def test_words_are_equal_and_numbers_close(line, other, equal):
    assert same(line, other) == equal
    diff = difference("page", ["first", line, "last"], ["first", other, "last"])
    assert bool(diff) != equal and ("-" + line in diff and "+" + other in diff) != equal


def test_a_diff_shows_what_differs_alone():
    golden = ["Build A.", "  It lasts 100 h.", "Decide", "A | 100"]
    diff = difference("page", golden, ["Build B.", "  It lasts 100.4 h.", "Decide", "Why", "A | 100.1"])
    assert [line for line in diff.splitlines() if line[0] in "+-"][2:] == ["-Build A.", "+Build B.", "+Why"]


def test_a_page_is_read_as_a_reader_sees_it():
    page = """<html><head><title>T</title><style>p {}</style></head><body><h1>Page &amp; more</h1>
    <p>One <b>bold</b> word.
    Two, of 2026-01-02T03:04:05+00:00.</p><table><tr><th>a</th><td>1</td><td></td></tr></table>
    <svg><text>no</text></svg><script>if (a < b) {}</script>
    <dl class="small"><dt>numpy</dt><dd>2.1.0</dd></dl><p>version 2.1.0, abcdef0</p></body>"""
    seen = ["Page & more", "One bold word.", "  Two, of DATE.", "a | 1 |", "version VERSION, DIGEST"]
    assert visible(page) == seen
