"""Pages with measured numbers take them from data files, and benchmarks share one command line."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from validation.benchmarks import TIMED, command, programs
from validation.pages import TEMPLATES, measured, percent, pictures, ratio, render, table

ROOT = Path(__file__).parents[2]
PAGES = sorted(path.name for path in TEMPLATES.glob("*.md") if path.name != "readme.md")
# limits and levels that a definition sets, not measured results
GIVEN = ("within 5 %", "exceeds 10 %", "axial force of 15 %", "to about 1 %", "90 %", "95 %", "99 %")
# pages whose tables name numbers of the publication and of its program as they are printed
QUOTED = ("paper.md", "tradeoff.md", "extremes.md")


def literal(template: str) -> str:
    """Return what a template states itself: no Jinja, no code, no links."""
    return re.sub(r"\{%.*?%\}|\{\{.*?\}\}|^```.*?^```|`[^`]*`|\]\([^)]*\)", "", template, flags=re.S | re.M)


def test_percent_and_ratio_are_rounded_to_two_figures():
    assert percent(0.000324) == "0.032 %" and percent(1.0) == "100 %" and percent(0.9975, 4) == "99.75 %"
    assert ratio(6.34) == "6.3" and ratio(11_940) == "12,000"


@pytest.mark.parametrize("name", sorted({*PAGES, "readme.md"} - {*QUOTED}))
def test_a_template_states_no_measured_share_or_speed_itself(name):
    text = literal((TEMPLATES / name).read_text(encoding="utf-8")).replace("\n", " ")
    for allowed in GIVEN:
        text = text.replace(allowed, "")
    assert not re.findall(r"\d[\d.,]* ?(?:%|ms\b|s\b|MB\b|GB\b|times\b)", text)


@pytest.mark.parametrize("name", PAGES)
def test_a_page_is_what_its_template_and_the_data_give(name):
    more = {"presets": "| preset |\n"} if name == "accuracy.md" else {}
    written = render(name, **more)
    kept = (ROOT / "docs" / "validation" / name).read_text(encoding="utf-8")
    if more:
        before, after = written.split(more["presets"])
        assert kept.startswith(before) and kept.endswith(after), "run: python docs/generate.py"
    else:
        assert kept == written, "run: python docs/generate.py"


def test_tables_and_pictures_are_markdown():
    assert table(("a", "b"), [(1, "x|y")]) == "| a | b |\n| --- | --- |\n| 1 | x\\|y |"
    index = [{"name": name, "caption": "What.", "sentence": "Found."} for name in ("one_a", "two_b")]
    assert pictures(index, "one") == "![What.](../figures/one_a.png)\n\n*Found.*"


def test_every_figure_that_a_page_shows_is_there():
    for name in PAGES:
        text = (ROOT / "docs" / "validation" / name).read_text(encoding="utf-8")
        for figure in re.findall(r"\]\(\.\./(figures/[^)]*)\)", text):
            assert (ROOT / "docs" / figure).is_file(), (name, figure)


def test_the_readme_holds_the_measured_table():
    table = render("readme.md").partition("\n")[2]
    assert table in (ROOT / "README.md").read_text(encoding="utf-8"), "run: python docs/generate.py"


def test_a_changed_number_changes_the_page(monkeypatch):
    """The page follows its data: another measured value stands in the text."""
    data = measured()
    data["kalker_errors"] = data["kalker_errors"] | {"exceeded": 0.123}
    monkeypatch.setattr("validation.pages.measured", lambda: data)
    assert "`force_error_estimate` is exceeded in 12 % of" in render("accuracy.md", presets="")


def test_every_program_has_one_line_and_stands_on_the_index_page():
    found = programs()
    assert set(TIMED) <= set(found) and all(found.values())
    index = (ROOT / "docs" / "validation" / "index.md").read_text(encoding="utf-8")
    assert all(f"| `{name}` | {line} |" in index for name, line in found.items())


def test_options_of_a_benchmark_follow_from_its_function(tmp_path, capsys):
    def measure(cases: int = 3, model: str = "sliding", tolerances: tuple[float, ...] = (0.1,), slow: bool = False):
        return {"sum": cases * sum(tolerances), "limit": float("inf"), "model": model if slow else "none"}

    file = tmp_path / "found.json"
    command.run(measure, "Measure.", ["--cases", "4", "--tolerances", "0.5", "1", "--slow", "--output", str(file)])
    told = json.loads(capsys.readouterr().out)
    assert told == json.loads(file.read_text(encoding="utf-8"))
    assert told["options"] == {"cases": 4, "model": "sliding", "tolerances": [0.5, 1.0], "slow": True}
    assert (told["sum"], told["limit"], told["model"]) == (6.0, "inf", "sliding")
    with pytest.raises(SystemExit) as refused:
        command.run(measure, "Measure.", ["--cases", "0"])
    assert refused.value.code == 2 and "--cases 0 is not allowed" in capsys.readouterr().err
