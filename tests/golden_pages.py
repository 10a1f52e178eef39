"""The pages whose words `tests/report/pages/` keeps, and the command that writes them anew.

    python tests/golden_pages.py              write all pages anew
    python tests/golden_pages.py search sheet write these pages anew

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
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import yaml
from synthetic_results import PAIRS, grid_study, results_of

import trackroller as tr
from trackroller.carriage.example import EXAMPLE
from trackroller.cli.case import groups_of
from trackroller.report.pages.carriage import write_carriage
from trackroller.report.pages.sheet import render
from trackroller.report.pages.spectrum import write_spectrum
from trackroller.report.pages.study import contents, page_text
from trackroller.results.sensitivity import analyse
from trackroller.study.spectrum.file import Spectrum
from trackroller.study.spectrum.solve import solve_spectrum
from trackroller.yaml_file import parse_mapping

FOLDER = Path(__file__).parent / "report" / "pages"
CLOSE = 0.01  # numbers may differ by this share: other tests hold them
ZERO = 1e-12  # numbers below it are rounding
NUMBER = re.compile(r"[−+-]?\d[\d,]*(?:\.\d+)?(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+|e[+-]?\d+)?")
PLAIN = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-", ",")
QUICK = {"contact_model": "sliding", "accuracy": "preview"}
STEEL, HARD = "1.7225-normalised", "1.7225-quenched-tempered"
LIVES = ["forces", "contact", "friction_work", "peak_stress", "life"]


# the pages


def _report(study: dict[str, Any], table: str = "") -> str:
    """Solve a study and return its report, without figures."""
    with tempfile.TemporaryDirectory() as place, contextlib.chdir(place):
        if table:
            Path("cases.csv").write_text(table, encoding="utf-8")
            study = study | {"design": "table", "table": "cases.csv"}
        results = tr.run(QUICK | study, progress=False)
        return page_text(results, contents(results), Path(place))


def wear() -> str:
    """Return the report of a grid with materials that wear, and a range of their coefficients."""
    base = {"axial_force": 5, "motor_force": 0, "guide_curve_radius": "inf", "guide_overrollings_per_hour": 60}
    factors = {
        "material_pair": {"values": [[HARD, HARD], ["POM", HARD], ["PA6", HARD]]},
        "roller_profile_radius": {"values": [-6.2, -7]},
        "friction_coefficient": {"values": [0.1, 0.2]},
        "radial_force": {"values": [-30, -60]},
    }
    outputs = [*LIVES, "limits"]
    return _report(
        {"name": "wear", "base": base | {"permissible_wear_depth": 0.05}, "factors": factors, "outputs": outputs}
    )


def draws() -> str:
    """Return the report of designs under random conditions, with a target."""
    factors = {
        "roller_profile_radius": {"values": [-6.4, -7, -8]},
        "friction_coefficient": {"truncnormal": [0.19, 0.04, 0.08, 0.32]},
        "axial_force": {"uniform": [0, 20]},
    }
    target = {"target": {"roller_life_hours": {"min": 5}}}
    study = {"name": "draws", "base": {"motor_force": 0}, "factors": factors, "design": "inner_outer", "samples": 64}
    return _report(study | {"analysis": target, "outputs": LIVES})


def loads() -> str:
    """Return the report of a table of measured loads with a row each, and a target that no design reaches."""
    rows = "roller_profile_radius,radial_force,axial_force\n"
    rows += "".join(f"{r},{load}\n" for r in (-6.4, -7) for load in ("-90,6", "-180,12", "-240,20"))
    base = {"motor_force": 0, "friction_coefficient": 0.15, "guide_overrollings_per_hour": 120}
    return _report({"name": "loads", "base": base, "analysis": {"target": {"min": 5000}}}, rows)


def proposals() -> str:
    """Return the report of a table whose two designs share one load only, too few to compare them."""
    rows = (
        "roller_profile_radius,radial_force,axial_force\n-6.4,-90,6\n-6.4,-180,12\n-7,-90,6\n-6.6,-90,6\n-6.6,-180,12\n"
    )
    return _report({"name": "proposals", "base": {"motor_force": 0}}, rows)


def indices() -> str:
    """Return the report of a study that compares no designs: sampled indices of three loads."""
    factors = {
        "friction_coefficient": {"uniform": [0.1, 0.3]},
        "axial_force": {"uniform": [0, 30]},
        "radial_force": {"uniform": [-250, -150]},
    }
    study = {"name": "indices", "base": {"motor_force": 0}, "factors": factors, "design": "saltelli", "samples": 16}
    return _report(study | {"outputs": LIVES})


def search() -> str:
    """Return the report of a search for designs of long life and little friction."""
    factors = {
        "roller_profile_radius": {"values": [-6.4, -6.6, -7, -7.5, -8, -9]},
        "contact_angle": {"values": [25, 30, 35, 40]},
        "friction_coefficient": {"values": [0.1, 0.2]},
    }
    base = {"motor_force": -5, "guide_curve_radius": "inf", "guide_overrollings_per_hour": 600}
    study = {"name": "search", "base": base, "factors": factors, "design": "optimise", "outputs": LIVES}
    goals = {"pair_life_hours": "max", "mean(friction_power)": "min"}
    return _report(study | {"goals": goals, "budget": {"designs": 16, "population": 4}})


def tie() -> str:
    """Return the report of two designs whose lives lie within the error of the solution."""
    factors = {"contact_angle": {"values": [38, 38.2]}, "friction_coefficient": {"values": [0.1, 0.2]}}
    return _report({"name": "tie", "base": {"motor_force": 0}, "factors": factors, "outputs": LIVES})


def regimes() -> str:
    """Return the report of made-up results with slip, lift-off, flags and a constraint."""
    factors = {"friction_coefficient": [0.02, 0.2, 0.3], "roller_profile_radius": [-8.0, -7.0, -6.4]}
    factors |= {"material_pair": list(PAIRS), "motor_force": [-30.0, 0.0], "axial_force": [0.0, 30.0, 130.0]}
    ds = grid_study(factors)
    told = {
        "constraints": ["material_pair != 'POM / POM'"],
        "goals": {"roller_life_hours": "max", "peak_stress": "min"},
    }
    ds.attrs["study"] = yaml.safe_dump(yaml.safe_load(ds.attrs["study"]) | told, sort_keys=False)
    results = results_of(ds)
    results = results_of(ds, analyse(results))
    with tempfile.TemporaryDirectory() as place:
        return page_text(results, contents(results), Path(place))


def models() -> str:
    """Return the report of a study that compares the contact models, free and driven."""
    factors = {"friction_coefficient": {"values": [0.04, 0.3]}, "motor_force": {"values": [0, -10]}}
    compared = {"contact_model": ["sliding", "kalker_table"], "outputs": LIVES}
    return _report({"name": "models", "factors": factors} | compared)


def grown() -> str:
    """Return the report of a sample that doubles until its intervals are narrow."""
    factors = {"axial_force": {"uniform": [20, 50]}, "friction_coefficient": {"uniform": [0.1, 0.3]}}
    study = {"name": "grown", "base": {"motor_force": 0}, "factors": factors, "design": "sobol", "outputs": ["forces"]}
    return _report(study | {"until": {"half_width": 0.04, "of": ["normal_force_1"], "at_most": 4096}})


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


REPORTS = (wear, draws, loads, proposals, indices, search, tie, regimes, models, grown)
PAGES: dict[str, Callable[[], str]] = {page.__name__: page for page in (*REPORTS, sheet, limits, spectrum, carriage)}


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
