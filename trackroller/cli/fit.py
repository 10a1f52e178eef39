"""Commands that fit values of materials to tests."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from trackroller.errors import escaped

if TYPE_CHECKING:
    from trackroller.fit.material_fit import MaterialFit

fit = typer.Typer(no_args_is_help=True, help="Values of materials from tests, and the next test.")

Table = Annotated[Path, typer.Argument(help="tests (CSV or .xlsx)", show_default=False)]
As = Annotated[
    str, typer.Option("--as", help="name of the material that is made", show_default=False)
]
Like = Annotated[
    str | None,
    typer.Option(help="material whose other values, such as E and R_m, the new one takes"),
]
Priors = Annotated[
    list[str] | None, typer.Option("--prior", help="slope=8,2: mean and deviation; others are flat")
]
File = Annotated[Path, typer.Option("--file", help="your materials file")]
Replace = Annotated[
    bool, typer.Option("--replace", help="change a material that the file has already")
]
Page = Annotated[
    Path | None, typer.Option("--report", help="page of the fit; fit-NAME.html if not given")
]
OWN = Path("config/materials.yaml")


@fit.command("sn")
def fit_sn(  # noqa: PLR0913 - one argument for each option of the command
    table: Table,
    name: As,
    load_type: Annotated[
        str, typer.Option(help="rotating bending, bending, axial, torsion or rolling contact")
    ],
    stress_ratio: Annotated[
        float, typer.Option(help="smallest over largest stress of a cycle, -1 for full reversal")
    ],
    group: Annotated[
        str | None, typer.Option(help="the group to fit, of several in the column `group`")
    ] = None,
    slope: Annotated[float | None, typer.Option(help="slope k that is held")] = None,
    scatter: Annotated[float | None, typer.Option(help="scatter T_N that is held")] = None,
    like: Like = None,
    prior: Priors = None,
    file: File = OWN,
    replace: Replace = False,
    report: Page = None,
) -> None:
    """Fit an S-N line to coupons (columns amplitude, cycles, failed), and write the material and a
    page.
    """
    from trackroller.fit import coupons

    fit = coupons.fit_sn(
        table, name=name, load_type=load_type, stress_ratio=stress_ratio, group=group, slope=slope,
        scatter_in_cycles=scatter, like=like, prior=_priors(prior),
    )  # fmt: skip
    _finish(fit, file, replace, report)


def _finish(fit: MaterialFit, file: Path, replace: bool, page: Path | None) -> None:
    """Print what was fitted, and write material, posterior and page."""
    from trackroller.cli.case import writable_page
    from trackroller.files import all_or_none
    from trackroller.materials.file import slug
    from trackroller.report.pages.fit import sentences, write_fit

    target = writable_page(page or Path(f"fit-{slug(fit.name)}.html"))
    for text in [*sentences(fit), *fit.notes, *fit.not_given]:
        print(text)
    written = bool(set(fit.material) - {"name", "like"}) and not fit.unidentified
    with all_or_none(target):
        write_fit(fit, target)
        if written:
            fit.write(file, replace=replace)
            print(escaped(f"material '{fit.name}' is in {file}"))
    print(escaped(f"page: {target}"))


def _priors(words: list[str] | None) -> dict[str, Any]:
    from trackroller.fit.coupons import of_words

    return of_words(words or (), "--prior")


@fit.command("bench")
def fit_bench(  # noqa: PLR0913 - one argument for each option of the command
    table: Table,
    values: Annotated[str, typer.Option("--fit", help="what is fitted, separated by commas")] = (
        "fatigue_strength,slope,scatter"
    ),
    name: Annotated[str, typer.Option("--as", help="name of the material that is made")] = "",
    body: Annotated[
        str | None, typer.Option(help="roller or guide; the body that failed if not given")
    ] = None,
    slope: Annotated[float | None, typer.Option(help="slope k that is held")] = None,
    scatter: Annotated[float | None, typer.Option(help="scatter T_N that is held")] = None,
    like: Like = None,
    prior: Priors = None,
    file: File = OWN,
    replace: Replace = False,
    report: Page = None,
) -> None:
    """Fit values of a material to rollers on a bench, and write the material and a page.

    The values are fatigue_strength, slope, scatter, wear_coefficient and friction_coefficient;
    rolling_pressure, rolling_exponent and scatter are those of a line of pressure.
    """
    from trackroller.fit import bench

    fit = bench.fit_bench(
        table,
        values,
        name=name,
        body=body,
        slope=slope,
        scatter_in_cycles=scatter,
        like=like,
        prior=_priors(prior),
    )
    _finish(fit, file, replace, report)


@fit.command("wear")
def fit_wear(
    table: Table,
    base: Annotated[
        Path | None, typer.Option(help="case file of the roller; without it the paper's example")
    ] = None,
    body: Annotated[str, typer.Option(help="the body that wears: roller or guide")] = "roller",
    name: Annotated[str, typer.Option("--as", help="name of the material that is made")] = "",
    like: Like = None,
    file: File = OWN,
    replace: Replace = False,
    report: Page = None,
) -> None:
    """Fit a wear coefficient to depths of one groove over its travel, by the followed profile;
    takes minutes.
    """
    from trackroller.fit.depths import fit_wear as fitted
    from trackroller.yaml_file import read_mapping

    if base is None:
        values = {}
    else:
        values = read_mapping(base, "case file")
    _finish(fitted(table, values, body=body, name=name, like=like), file, replace, report)


@fit.command("catalogue")
def fit_catalogue(
    table: Annotated[
        Path,
        typer.Argument(help="permissible loads and lives (CSV or .xlsx)", show_default=False),
    ],
    offset: Annotated[
        float | None, typer.Option(help="offset c that is held; fitted if not given")
    ] = None,
    report: Annotated[Path | None, typer.Option("--report", help="page of the rule")] = None,
) -> None:
    """Find exponent and offset of the rule BL/(c + (1 - c) LF)^p behind a maker's lives of one
    series.
    """
    from trackroller.cli.case import writable_page
    from trackroller.fit.catalogue import fit_catalogue as fitted
    from trackroller.report.pages.life_rule import entry_note, entry_text, sentences, write_rule

    page = None if report is None else writable_page(report)
    fit = fitted(table, offset=offset)
    for text in [*fit.notes, *sentences(fit), entry_note(fit)]:
        print(text)
    print(entry_text(fit.catalogue))
    if page is not None:
        write_rule(fit, page)
        print(escaped(f"page: {page}"))


@fit.command("example")
def fit_example(
    folder: Annotated[
        Path, typer.Argument(help="folder for the files", show_default=False)
    ] = Path(),
) -> None:
    """Write example tests, which are synthetic, with their case files; the tutorial takes them."""
    from trackroller.errors import listing
    from trackroller.fit.examples import write_examples

    written = write_examples(folder)
    print(f"wrote {listing([path.name for path in written])}")
    print("Next: trackroller fit bench bench-synthetic.csv --as 'rig steel'")


@fit.command("next")
def fit_next(  # noqa: PLR0913 - one argument for each option of the command
    table: Table,
    candidates: Annotated[Path, typer.Option(help="study file whose rows could be tested")],
    design: Annotated[
        Path, typer.Option("--for", help="case file of the design whose B10 matters")
    ],
    tests: Annotated[int, typer.Option(help="how many tests are planned")] = 3,
    values: Annotated[str, typer.Option("--fit", help="what is fitted, separated by commas")] = (
        "fatigue_strength,slope,scatter"
    ),
    until: Annotated[
        float | None,
        typer.Option(
            help="factor between the ends of B10 that is wanted: how many more tests, and hours "
            "(some 20 s)"
        ),
    ] = None,
    longest: Annotated[
        float | None, typer.Option(help="travel after which a test stops [km]")
    ] = None,
    body: Annotated[
        str | None, typer.Option(help="roller or guide; the body that failed if not given")
    ] = None,
    slope: Annotated[float | None, typer.Option(help="slope k that is held")] = None,
    scatter: Annotated[float | None, typer.Option(help="scatter T_N that is held")] = None,
) -> None:
    """Say which tests narrow B10 of a design most, how long they take, and with --until how many
    more are needed.
    """
    import math

    from trackroller.fit.bench import fit_bench as fitted
    from trackroller.fit.next_tests import check_factor, next_tests, tests_until
    from trackroller.report.pages.fit import next_rows, next_sentences, until_sentences
    from trackroller.report.terminal import print_table
    from trackroller.study.file.load import load_study
    from trackroller.yaml_file import read_mapping

    if until is not None:
        check_factor(until)
    fit = fitted(table, values, body=body, slope=slope, scatter_in_cycles=scatter)
    study = load_study(candidates)
    case = read_mapping(design, "case file")
    if longest is None:
        longest = math.inf
    plan = next_tests(fit, study.design(), case, tests, longest=longest)
    heads, rows = next_rows(plan)
    print_table(heads, rows)
    sentences = next_sentences(plan)
    if until is not None:
        sentences += until_sentences(tests_until(fit, plan, until), until)
    for text in sentences:
        print(text)
