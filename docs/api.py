"""Makes docs/reference.md, the Python interface from signatures and docstrings: `python docs/api.py [--check]`."""

from __future__ import annotations

import importlib
import inspect
import sys
from pathlib import Path

PAGE = Path(__file__).parent / "reference.md"
HEAD = """<!-- made by docs/api.py from signatures and docstrings; do not edit -->
# Python interface

Names, units and bounds of a case, options and results stand in [parameters.md](parameters.md). What is marked with
`tr.` is at the top of the package (`import trackroller as tr`). Physics functions take arrays along a leading axis of
cases or patches.
"""
PARTS: tuple[tuple[str, tuple[tuple[str, tuple[str, ...]], ...]], ...] = (
    (
        "Cases and solutions",
        (
            ("trackroller", ("Case", "solve", "InputError")),
            ("trackroller.roller.stop", ("parse_condition",)),
            ("trackroller.study.explain", ("explain",)),
        ),
    ),
    (
        "Studies",
        (
            ("trackroller", ("load_study",)),
            ("trackroller.study.config", ("Study.design", "Study.options")),
            ("trackroller.study.run", ("run_study",)),
            ("trackroller.study.gather", ("gather",)),
            ("trackroller.study.repeat", ("repeat_case",)),
        ),
    ),
    (
        "Analyses",
        (
            ("trackroller.analysis.sensitivity", ("analyse", "analyse_dataset")),
            ("trackroller.analysis.robustness", ("robustness",)),
            ("trackroller.analysis.pareto", ("pareto",)),
            ("trackroller.study.spectrum.solve", ("load_spectrum", "solve_spectrum")),
        ),
    ),
    ("Materials", (("trackroller", ("load_database",)), ("trackroller.materials", ("add_material",)))),
    (
        "Fatigue",
        (
            (
                "trackroller.damage.fatigue",
                (
                    "life_cycles",
                    "allowable_stress",
                    "woehler_exponent",
                    "line_at_probability",
                    "roller_hours",
                    "guide_hours",
                    "damage_sum",
                ),
            ),
        ),
    ),
    (
        "Stresses below any tractions",
        (("trackroller", ("stress_from_tractions", "stress_on_grid", "von_mises", "principal_stresses", "max_shear")),),
    ),
    (
        "Contact",
        (
            ("trackroller.contact.hertz", ("shape", "contact_modulus")),
            ("trackroller.contact.normal", ("solve_normal",)),
            ("trackroller.contact.kalker", ("solve_patch",)),
            ("trackroller.contact.fastsim", ("solve_patch",)),
            ("trackroller.contact.linear", ("creepage_coefficients",)),
            ("trackroller.contact.friction_laws", ("law_of",)),
            ("trackroller.contact.profiles", ("canonical",)),
        ),
    ),
    (
        "Figures and report",
        (
            ("trackroller.report.figures.contact", ("plot_case",)),
            ("trackroller.report.figures.study", ("draw_all",)),
            ("trackroller.report.page", ("write_report",)),
        ),
    ),
)


def entry(module: str, name: str) -> str:
    """Heading, signature and docstring of a public name."""
    thing = importlib.import_module(module)
    for part in name.split("."):
        thing = getattr(thing, part)
    shown = f"tr.{name}" if module == "trackroller" else f"{module}.{name}"
    plain = thing.fget if isinstance(thing, property) else thing
    text = inspect.cleandoc(plain.__doc__ or "")
    signature = "" if isinstance(thing, property) else _signature(thing)
    return f"### `{shown}`\n\n```text\n{name.rpartition('.')[2]}{signature}\n\n{text}\n```\n"


def _signature(thing: object) -> str:
    told = inspect.signature(thing)  # type: ignore[arg-type]
    words, starred = [], False
    for parameter in told.parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and not starred:
            words.append("*")
        starred |= parameter.kind in (parameter.KEYWORD_ONLY, parameter.VAR_POSITIONAL)
        word = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "") + parameter.name
        if parameter.annotation is not parameter.empty:
            word += f": {parameter.annotation}"
        if parameter.default is not parameter.empty:
            default = repr(parameter.default)
            word += " = " + ("..." if len(default) > 50 or default.startswith("<") else default)
        words.append(word)
    end = "" if told.return_annotation is told.empty else f" -> {told.return_annotation}"
    line = f"({', '.join(words)}){end}"
    return line if len(line) <= 100 else "(\n    " + ",\n    ".join(words) + f"\n){end}"


def render() -> str:
    """The whole page."""
    lines = [HEAD]
    for title, modules in PARTS:
        lines.append(f"## {title}\n")
        lines += [entry(module, name) for module, names in modules for name in names]
    return "\n".join(lines).rstrip() + "\n"


if __name__ == "__main__":
    if "--check" in sys.argv[1:]:
        raise SystemExit(PAGE.read_text(encoding="utf-8") != render())
    PAGE.write_text(render(), encoding="utf-8")
