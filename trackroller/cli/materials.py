"""Commands on the material and friction database."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from trackroller.cli.usage import print_doubts

materials = typer.Typer(no_args_is_help=True, help="The material and friction database.")


@materials.command("list")
def materials_list(
    search: Annotated[str, typer.Argument(help="words of a name or description, such as 42CrMo4")] = "",
) -> None:
    """Print the names and values of all materials, or of those that a word describes."""
    from trackroller.materials.tables import material_rows

    _print_rows(material_rows, search)


@materials.command("show")
def materials_show(name: Annotated[str, typer.Argument(show_default=False)]) -> None:
    """Print every value of a material with its unit and source, and whether it is a placeholder."""
    from trackroller.materials.tables import material_details

    _print_rows(material_details, name)


@materials.command("friction")
def materials_friction() -> None:
    """Print the friction and wear coefficients of each pair of materials."""
    from trackroller.materials.tables import friction_rows

    _print_rows(friction_rows)


def _print_rows(rows_of: Callable[..., list[dict[str, str]]], *names: str) -> None:
    from trackroller.materials import load_database
    from trackroller.report.terminal import print_table

    rows = rows_of(load_database(), *names)
    heads: list[str] = []
    if rows:
        heads = list(rows[0])
    print_table(heads, [[row.get(head, "") for head in heads] for row in rows])


def _points_of(path: Path) -> dict[str, Any]:
    """Return the points of an S-N curve in a table with the columns amplitude and cycles, and their source."""
    from trackroller.errors import InputError
    from trackroller.fit.table import LEAST, from_file

    table, head = from_file(path, field="sn_points", row="point")
    names = ("amplitude", "cycles")
    if set(table.rows[0]) != set(names):
        remedy = "Name the columns so, the amplitude with its unit in brackets, and remove other columns."
        given = ", ".join(table.rows[0])
        allowed = "the columns amplitude [MPa] and cycles"
        raise InputError("sn_points", given, allowed, remedy).at(path, head)
    points = [[table.number(row, name, LEAST) for name in names] for row in table]
    return {"value": points, "source": f"{path.name}, SHA-256 {table.digest}"}


@materials.command("add")
def materials_add(
    name: Annotated[str, typer.Argument(show_default=False)],
    settings: Annotated[list[str], typer.Option("--set", help="field=value, e.g. youngs_modulus=210000")],
    file: Annotated[Path, typer.Option(help="your materials file")] = Path("config/materials.yaml"),
    replace: Annotated[bool, typer.Option("--replace", help="change a material that the file has already")] = False,
) -> None:
    """Write a material into your own file; comments in the file stay. sn_points takes the name of a table, too."""
    from trackroller.cli.case import settings_of
    from trackroller.damage.own import check_fields
    from trackroller.materials import add_material
    from trackroller.materials.edit import FIELDS
    from trackroller.roller.doubts import doubts

    values = settings_of(settings)
    check_fields(f"material '{name}': field", values, FIELDS)
    if isinstance(values.get("sn_points"), str):
        values["sn_points"] = _points_of(Path(values["sn_points"]))
    material = add_material(file, name, replace=replace, **values)
    print(f"material '{material.name}' is in {file}")
    print_doubts(doubts({}, [material]))
