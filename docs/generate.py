"""Write docs/parameters.md, the pages of docs/validation, the table of the README, and the nouns of CONTRIBUTING.

`python docs/generate.py` writes; with `--check` it only compares and ends with 1 if a page is not up to date.
"""

from __future__ import annotations

import inspect
import math
import pkgutil
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # docs/validation must not stand for the package

from trackroller import parameters as p
from trackroller.materials import builtin_database
from trackroller.materials.properties import ALTERNATIVES, PROPERTIES
from trackroller.parameters.accuracy import PRESETS
from trackroller.parameters.carriage_fields import OF_LOAD_CASE, OF_ROLLER, OF_WHOLE
from trackroller.parameters.validity import VALIDITY
from trackroller.roller.dataset import COMMENTS, VARIABLES
from validation.pages import TEMPLATES
from validation.pages import render as render_written

FOLDER = Path(__file__).parent
NOUNS = {  # what a stranger must know: the word, and the class whose docstring explains it
    "parameter": "numerics.parameter.Parameter",
    "option": "parameters.options.Option",
    "output": "numerics.variable.Variable",
    "part": "roller.output_names.Part",
    "material": "materials.material.Material",
    "contact model": "contact.protocol.ContactModel",
    "limit": "damage.limit.Limit",
    "method": "methods.method.Method",
    "case": "roller.case.Case",
    "study": "study.file.study.Study",
    "factor": "methods.factor.Factor",
    "design": "methods.method.Design",
    "ledger": "study.store.ledger.Ledger",
    "spectrum": "study.spectrum.file.Spectrum",
    "carriage": "carriage.file.Carriage",
    "fit": "fit.material_fit.MaterialFit",
    "results": "results.results.Results",
    "candidates": "results.candidates.Candidates",
    "answer": "results.answer.Answer",
}
WAY = (  # of a study: what makes the next thing of the one before, and the file that it writes
    ("study.file.load.load_study", ""),
    ("study.file.study.Study.drawn", ""),
    ("study.store.ledger.working_ledger", ""),
    ("study.solve_chunk.solve_chunk", "chunks/*.nc"),
    ("study.store.gather.gather", "study.nc"),
    ("results.stored_study.open_study", ""),
    ("report.build.build_report", "report.html"),
)
USES = {"preview": "a first look", "standard": "studies", "reference": "to check `standard`; single cases"}
HEAD = """# Parameters, options and results

*Made by `python docs/generate.py` from `trackroller/parameters/` and `trackroller/roller/dataset.py`; do not edit.
The [theory](theory.md) derives the quantities.*
"""


_VALUES = (*PROPERTIES.values(), *ALTERNATIVES.values())


def _row(*cells: object) -> str:
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


def _table(heads: tuple[str, ...], rows: list[tuple[object, ...]]) -> list[str]:
    return [_row(*heads), _row(*("---" for _ in heads)), *(_row(*row) for row in rows), ""]


def _range(parameter: p.Parameter) -> str:
    parts = []
    if math.isfinite(parameter.lower):
        parts.append(f"{'>' if parameter.open_lower else '>='} {parameter.lower:g}")
    if math.isfinite(parameter.upper):
        parts.append(f"{'<' if parameter.open_upper else '<='} {parameter.upper:g}")
    if parameter.nonzero:
        parts.append("not 0")
    parts.append("inf allowed" if parameter.allow_infinite else "finite")
    if parameter.allow_missing:
        parts.append("may be left out")
    return ", ".join(parts)


def _option(option: p.Option) -> tuple[str, str, str, str]:
    """Return the row of an option: values with meanings, default, and the contact models that use it."""
    values = "; ".join(f"`{word}`: {meaning}" for word, meaning in option.values.items())
    number = "a number in ({:g}, {:g})".format(*option.bounds)
    other = {"accuracy": number, "number": number, "condition": "a condition", "switch": "true, false"}
    default = ", ".join(option.default) if isinstance(option.default, tuple) else str(option.default)
    models = f"; for {', '.join(f'`{model}`' for model in option.models)} only" if option.models else ""
    told = [part for part in (values, other.get(option.kind, "")) if part]
    return (
        f"`{option.name}`",
        "; or ".join(told),
        default if default not in ("", "None") else "none",
        option.meaning + models,
    )


def _materials() -> list[tuple[object, ...]]:
    """Return a row for each material of the built-in database."""
    return [
        (
            f"`{m.name}`",
            f"{m.tensile_strength:g}",
            f"{m.fatigue_limit:g}",
            len(m.placeholders) + len(m.guesses_of_limits),
            m.description,
        )
        for m in map(builtin_database().material, builtin_database())
    ]


def render() -> str:
    """Return the text of docs/parameters.md."""
    lines = [HEAD, "## Parameters of a case\n"]
    lines += _table(
        ("name", "symbol", "unit", "default", "allowed", "role", "meaning"),
        [
            (
                f"`{v.name}`",
                v.symbol,
                v.unit,
                "not given" if math.isnan(v.default) else f"{v.default:g}",
                _range(v),
                v.role,
                v.meaning,
            )
            for v in p.PARAMETERS.values()
        ],
    )
    lines += [
        "`roller_material` and `guide_material` take a name of the material database, or a mapping of material values;",
        "the default is `1.7225-normalised`. Both relative curvatures must be positive, else the input is refused.\n",
        *_table(("name", "meaning"), [(f"`{name}`", told) for name, told in p.MAPPING_FIELDS.items()]),
        "### Fields of a carriage\n",
        "Factors of a study with the key `carriage`. A field of all load cases also takes the name of one,",
        "`carriage_speed_in_curve`; a coordinate names its roller, `carriage_x_of_FL`.\n",
        *_table(
            ("name", "unit", "role", "meaning"),
            [
                (f"`{v.name}{of}`{more}", v.unit, v.role, v.meaning)
                for fields, of, more in (
                    (OF_WHOLE, "", ""),
                    (OF_LOAD_CASE, "", ", `_in_CASE`"),
                    (OF_ROLLER, "_of_ROLLER", ""),
                )
                for v in fields.values()
            ],
        ),
        "### Materials of the database\n",
        "`trackroller materials show NAME` lists every value with its source and mark.\n",
        *_table(("name", "R_m [MPa]", "sigma_D [MPa]", "guesses", "description"), _materials()),
        "### Values of a material\n",
        "`sn_points`, `temperature_dependence`, `family`, `description` and `like` stand beside these numbers.\n",
        *_table(
            ("name", "symbol", "unit", "meaning"),
            [(f"`{v.name}`", v.symbol or "-", v.unit, v.long_name) for v in _VALUES],
        ),
        "## Options\n",
    ]
    lines += _table(("name", "values", "default", "meaning"), [_option(option) for option in p.OPTIONS.values()])
    lines.append("## Results\n")
    for group in dict.fromkeys(v.group for v in VARIABLES.values()):
        always = ", always there or with the peak" if group == "status" else ""
        lines.append(f"### {group}{always}\n")
        lines += _table(
            ("name", "dimensions behind `case`", "unit", "symbol", "meaning"),
            [
                (f"`{v.name}`", ", ".join(v.dims) or "-", v.units, v.symbol or "-", v.long_name)
                for v in VARIABLES.values()
                if v.group == group
            ],
        )
    lines += ["### regime\n", "`regime` is an integer; each row has one.\n"]
    lines += _table(("value", "regime"), [(i, name) for i, name in enumerate(p.REGIMES)])
    lines += [
        "### first_to_fail, contact_model_used, accuracy_used, stopped\n",
        "`first_to_fail` (with `life`) is the body that fails first in hours: "
        + ", ".join(f"{i} {name}" for i, name in enumerate(p.FIRST_TO_FAIL))
        + f". {COMMENTS['first_to_fail'].capitalize()}. `pair_life_hours`: {COMMENTS['pair_life_hours']}.\n",
        "`contact_model_used` is the model that solved the case. The table serves `kalker` at accuracy",
        "`preview`. Outside its range `kalker` serves `kalker_table`: "
        + ", ".join(f"{i} {name}" for i, name in enumerate(p.CONTACT_MODELS))
        + ".",
        "`accuracy_used` (if `accuracy` is a tolerance) is the rung whose result the case has: "
        + ", ".join(f"{i} {name}" for i, name in enumerate(PRESETS))
        + ".",
        "`stopped` (with `stop_if`): 1 where the condition holds.\n",
    ]
    lines += ["### validity\n", "`validity` is a sum of bits; 0 means that no warning applies.\n"]
    bits = [(1 << i, f"`{name}`", flag.criterion) for i, (name, flag) in enumerate(VALIDITY.items())]
    lines += _table(("bit", "name", "meaning"), bits)
    return "\n".join(lines).rstrip() + "\n"


def presets() -> str:
    """Return the table of the rungs of accuracy."""
    heads = (
        "rung",
        "error of the peak in full sliding",
        "Gauss points per smooth piece of the slip integrals",
        "quadrature of scan / climb / polish / summit",
        "floor of the error estimate",
        "elements across a patch (`kalker`)",
        "use",
    )
    rows: list[tuple[object, ...]] = []
    for name, v in PRESETS.items():
        orders = f"{v.peak.scan} / {v.peak.climb} / {v.peak.polish} / {v.peak.summit}"
        rows.append(
            (f"`{name}`", f"{v.peak_error:g}", v.force_nodes, orders, f"{v.peak.floor:g}", v.elements, USES[name])
        )
    return "\n".join(_table(heads, rows))


def nouns() -> str:
    """Return the table of nouns and the way of a study to its report, from docstrings and annotations."""
    rows = []
    for noun, place in NOUNS.items():
        said = inspect.getdoc(pkgutil.resolve_name(f"trackroller.{place}")) or ""
        sentence = said.partition("\n\n")[0].replace("\n", " ")
        rows.append((noun, sentence, f"`{place.rpartition('.')[2]}` in `{_file(place)}`"))
    lines = ["study.yaml"]
    for place, written in WAY:
        made = pkgutil.resolve_name(f"trackroller.{place}")
        kind = inspect.signature(getattr(made, "func", made)).return_annotation
        thing = written or re.sub(r"^Iterator\[(.*)\]$", r"\1", str(kind))
        lines += [f"  |  {place.rpartition('.')[2]:<14} {_file(place)}", thing]
    return "\n".join([*_table(("noun", "what it is", "where"), rows), "```", *lines, "```", ""])


def _file(place: str) -> str:
    """Return the file of a name such as 'study.file.study.Study.drawn'."""
    parts = place.split(".")
    while not (FOLDER.parent / "trackroller" / "/".join(parts)).with_suffix(".py").is_file():
        parts.pop()
    return "/".join(parts) + ".py"


def pages() -> dict[Path, str]:
    """Return the path and the text of each page that this program writes."""
    place = FOLDER / "validation"
    names = sorted(path.name for path in TEMPLATES.glob("*.md") if path.name != "readme.md")
    written = {place / name: render_written(name, presets=presets()) for name in names}
    readme = FOLDER.parent / "README.md"
    before, _, rest = readme.read_text(encoding="utf-8").partition(START)
    table = render_written("readme.md").partition("\n")[2]  # without the remark on its first line
    written[readme] = f"{before}{START}{table}{END}{rest.partition(END)[2]}"
    contributing = FOLDER.parent / "CONTRIBUTING.md"
    before, _, rest = contributing.read_text(encoding="utf-8").partition(WORDS)
    written[contributing] = f"{before}{WORDS}{nouns()}{END}{rest.partition(END)[2]}"
    return {FOLDER / "parameters.md": render(), **written}


START, END = "<!-- measured -->\n", "<!-- end -->\n"  # of the table in the README
WORDS = "<!-- nouns -->\n"  # of the nouns in CONTRIBUTING


def main(check: bool) -> int:
    """Write the pages, or print which pages are not up to date."""
    stale = [page for page, text in pages().items() if not page.is_file() or page.read_text(encoding="utf-8") != text]
    for page in stale:
        if check:
            print(f"{page} is not up to date", file=sys.stderr)
        else:
            page.write_text(pages()[page], encoding="utf-8")
    return 1 if check and stale else 0


if __name__ == "__main__":
    raise SystemExit(main("--check" in sys.argv[1:]))
