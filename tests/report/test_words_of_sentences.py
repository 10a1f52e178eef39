"""The words of sentences: every kind has a block, every block is a kind, and a missing number is an error."""

import re
from pathlib import Path

import jinja2
import pytest

from trackroller.report.words.sentence import phrase, say

REPORT = Path(__file__).parents[2] / "trackroller" / "report"
CODE = "".join(path.read_text(encoding="utf-8") for path in sorted(REPORT.rglob("*.py")))
KINDS = ("build", "a_or_b", "none", "measure", "give", "cannot_tell", "lasts")
BLOCKS = {
    (path.name.partition(".")[0], kind)
    for path in sorted((REPORT / "templates" / "sentences").glob("*.j2"))
    for kind in re.findall(r"{% block (\w+) %}", path.read_text(encoding="utf-8"))
}


def test_words_stand_in_one_line_with_the_numbers_as_claims():
    said = say("cases", "stopped", count=3, of=12345)
    assert said.text == "3 of 12,345 cases met the condition of `stop_if`: they have no stress and no life."
    assert said.values == {"count": 3, "of": 12345} and said.kind == "stopped"


def test_a_number_that_is_missing_is_an_error():
    with pytest.raises(jinja2.UndefinedError, match="'what' is undefined"):
        phrase("indices", "interaction", names=["speed"])
