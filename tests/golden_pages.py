"""The pages whose words `tests/report/pages/` keeps, and the command that writes them anew.

    python tests/golden_pages.py              write all pages anew
    python tests/golden_pages.py front sheet  write these pages anew

A golden page is the text of a page as a reader sees it: a sentence a line, further sentences of a block indented, a row
of a table a line. Read the diff of git before you commit it: it shows what a change of words or of a decision means to
a reader.
"""

from __future__ import annotations

import contextlib
import difflib
import io
import math
import re
import sys
import tempfile
import warnings
from collections.abc import Callable
from html import escape
from html.parser import HTMLParser
from pathlib import Path

import trackroller as tr
from trackroller.carriage.example import EXAMPLE
from trackroller.cli.case import groups_of
from trackroller.report.headlines import headline_of, warning_line
from trackroller.report.pages.blocks import empty_proof
from trackroller.report.pages.carriage import write_carriage
from trackroller.report.pages.sheet import render
from trackroller.report.pages.spectrum import write_spectrum
from trackroller.report.pages.study import page_text
from trackroller.results.answer import WARNINGS, Caution
from trackroller.study.spectrum.file import Spectrum
from trackroller.study.spectrum.solve import solve_spectrum
from trackroller.yaml_file import parse_mapping

sys.path.insert(0, str(Path(__file__).parent / "report"))  # as pytest does

import made_answers

FOLDER = Path(__file__).parent / "report" / "pages"
CLOSE = 0.01  # numbers may differ by this share: other tests hold them
ZERO = 1e-12  # numbers below it are rounding
NUMBER = re.compile(r"[−+-]?\d[\d,]*(?:\.\d+)?(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+|e[+-]?\d+)?")
PLAIN = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-", ",")
QUICK = {"contact_model": "sliding", "accuracy": "preview"}
LIVES = ["forces", "contact", "friction_work", "peak_stress", "life"]


# the pages


def headlines() -> str:
    """Return the headlines and the warnings of made answers, one for each question and kind."""
    lines = []
    for name, make in made_answers.ALL.items():
        answer = make()
        lines.append(f"<h3>{name}: {escape(answer.question)}</h3><p>{escape(headline_of(answer).text)}</p>")
    for code, meaning in WARNINGS.items():
        lines.append(f"<h3>{escape(meaning)}</h3><p>{escape(warning_line(Caution(code, 3, 12, 'friction 0.05')))}</p>")
    return "".join(lines)


def decide() -> str:
    """Return the page of a decision of five candidates with long names and lives without an end."""
    return page_text(made_answers.long_names(), empty_proof(), None)


def matters() -> str:
    """Return the page of an answer on what matters."""
    return page_text(made_answers.what_matters(), empty_proof(), None)


def front() -> str:
    """Return the page of a search with two goals."""
    return page_text(made_answers.best(), empty_proof(), None)


def sheet() -> str:
    """Return the sheet of a roller whose material scatters and wears."""
    plastic = {"like": "PA6", "name": "PA6 with scatter", "scatter_in_cycles": 4.0}
    load = {"radial_force": -20, "axial_force": 3, "motor_force": 0, "guide_overrollings_per_hour": 120}
    case = tr.Case(roller_material=plastic, **load, permissible_wear_depth=0.1)
    return render(tr.solve(case, [*LIVES, "limits", "wear"], **QUICK), "roller")


def limits() -> str:
    """Return the sheet of a roller with all limits, of which heat and bearing lack a value."""
    loads = {"radial_force": -30, "axial_force": 3, "motor_force": 0, "guide_overrollings_per_hour": 100}
    case = tr.Case(**loads, cooled_area=500, guide_material="PA6", friction_coefficient=None)
    return render(tr.solve(case, [*LIVES, *groups_of("all")], **QUICK), "R 1")


def spectrum() -> str:
    """Return the page of a shift with a jerk."""
    base = {"friction_coefficient": 0.2, "motor_force": 0, "guide_overrollings_per_hour": 120}
    blocks = [
        {"name": "loaded", "distance": 9000, "radial_force": -60, "axial_force": 10},
        {"name": "empty return", "distance": 9000, "radial_force": -25, "axial_force": 0},
        {"name": "jerk", "distance": 40, "radial_force": -200, "axial_force": 30, "velocity": 20},
    ]
    solved = solve_spectrum(Spectrum.from_dict(QUICK | {"name": "sorter", "base": base, "blocks": blocks}))
    return _written(lambda path: write_spectrum(solved, path, "sorter.yaml"))


def carriage() -> str:
    """Return the page of a shuttle on four rollers."""
    values = parse_mapping(EXAMPLE, "the example")
    for roller in values["rollers"].values():
        roller["roller"] = roller["roller"] | QUICK
    return _written(lambda path: write_carriage(tr.carriage(values), path, "shuttle.yaml"))


def _written(write: Callable[[Path], object]) -> str:
    with tempfile.TemporaryDirectory() as place:
        page = Path(place) / "page.html"
        write(page)
        return page.read_text(encoding="utf-8")


ANSWERS = (headlines, decide, matters, front)
PAGES: dict[str, Callable[[], str]] = {page.__name__: page for page in (*ANSWERS, sheet, limits, spectrum, carriage)}


# what a reader sees of a page

BLOCKS = {"p", "li", "h1", "h2", "h3", "h4", "tr", "dt", "dd", "figcaption", "caption", "div", "section", "table", "ul"}
BLOCKS |= {
    "header",
    "main",
    "details",
    "summary",
    "nav",
    "dl",
    "figure",
    "body",
    "title",
    "label",
    "button",
    "br",
    "tbody",
}
BLOCKS |= {"thead", "footer", "ol", "aside", "form", "fieldset", "legend", "option", "select"}
UNSEEN = {"script", "style", "svg", "template", "pre", "title", "nav"}  # `pre` repeats the input, `nav` the heads
VOID = {"meta", "link", "br", "img", "input", "hr", "col", "wbr"}


class _Text(HTMLParser):
    """Collects the blocks of text of a page; cells of a row stand in one block."""

    def __init__(self) -> None:
        super().__init__()
        self.blocks: list[str] = [""]
        self.unseen: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if self.unseen or tag in UNSEEN or ("class", "small") in attrs:  # small: versions, digests and dates
            self.unseen += [tag] * (tag not in VOID)
        elif tag in ("td", "th") and self.blocks[-1]:
            self.blocks[-1] += " | "
        elif tag in BLOCKS:
            self.blocks.append("")

    def handle_endtag(self, tag: str) -> None:
        if self.unseen:
            self.unseen.pop()
        elif tag in BLOCKS:
            self.blocks.append("")

    def handle_data(self, data: str) -> None:
        if not self.unseen:
            self.blocks[-1] += re.sub(r"\s+", " ", data) if self.blocks[-1] else re.sub(r"\s+", " ", data).lstrip()


def visible(page: str) -> list[str]:
    """Return the lines that a reader sees of a page in HTML; versions, digests and dates are masked."""
    parser = _Text()
    parser.feed(page)
    lines = []
    for block in parser.blocks:
        text = re.sub(r"\b\d{4}-\d{2}-\d{2}(?:[T ][\d:.+]+)?\b", "DATE", block.strip())
        text = re.sub(r"\b\d+\.\d+\.\d+(?:\.?\w+)*\b", "VERSION", text)
        text = re.sub(r"\b(?=[0-9a-f]*[a-f])(?=[0-9a-f]*\d)[0-9a-f]{7,}\b", "DIGEST", text)
        for i, sentence in enumerate(re.split(r"(?<=[.!?]) (?=[A-Z`])", text)):
            lines += [("  " if i else "") + sentence] if sentence else []
    return lines


def apart(line: str) -> tuple[str, list[tuple[float, float]]]:
    """Return the words of a line, with a sign in the place of each number, and each number with its last place.

    The last place of a count is 0: a count does not depend on rounding.
    """
    numbers = []
    for found in NUMBER.findall(line):
        text = found.translate(PLAIN)
        mantissa, _, power = text.partition("·10")
        scale = 10.0 ** int(power or 0)
        decimals = len(mantissa.partition(".")[2])
        numbers.append((float(mantissa) * scale, scale * 10.0**-decimals if decimals or power else 0.0))
    return NUMBER.sub("#", line), numbers


def same(line: str, other: str) -> bool:
    """Whether two lines have equal words, and numbers that differ by at most `CLOSE` or a unit of the last place."""
    (words, numbers), (others, found) = apart(line), apart(other)
    return words == others and all(
        math.isclose(a, b, rel_tol=CLOSE, abs_tol=max(1.001 * min(one, two), ZERO))
        for (a, one), (b, two) in zip(numbers, found, strict=True)
    )


def difference(name: str, golden: list[str], now: list[str]) -> str:
    """Return a unified diff of a golden page and the page of today; '' where they say the same."""
    kept = difflib.SequenceMatcher(None, [apart(line)[0] for line in golden], [apart(line)[0] for line in now], False)
    shown = list(now)
    for start, there, size in kept.get_matching_blocks():  # a line that says the same must not stand in the diff
        for i in range(size):
            if same(golden[start + i], now[there + i]):
                shown[there + i] = golden[start + i]
    return "\n".join(difflib.unified_diff(golden, shown, f"tests/report/pages/{name}.txt", "today", lineterm="", n=1))


def made(name: str) -> list[str]:
    """Return the lines of a page of today."""
    with warnings.catch_warnings(), contextlib.redirect_stderr(io.StringIO()):
        warnings.simplefilter("ignore")
        return visible(PAGES[name]())


def main(wanted: list[str]) -> None:
    """Write pages anew, all of them if none is named."""
    if unknown := set(wanted) - set(PAGES):
        sys.exit(f"{', '.join(sorted(unknown))}: no such page; choose from {', '.join(PAGES)}")
    FOLDER.mkdir(exist_ok=True)
    for name in wanted or PAGES:
        file = FOLDER / f"{name}.txt"
        now, before = made(name), file.read_text(encoding="utf-8").splitlines() if file.is_file() else []
        if difference(name, before, now):  # a page that says the same is kept, with its numbers
            file.write_text("\n".join(now) + "\n", encoding="utf-8")
            print(f"{name}: {len(now)} lines written")


if __name__ == "__main__":
    main(sys.argv[1:])
