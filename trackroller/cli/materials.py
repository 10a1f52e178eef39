"""Commands that show and extend the material database."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.table import Table

from trackroller.cli.case import settings_of
from trackroller.materials import add_material, load_database
from trackroller.materials.tables import friction_rows, material_details, material_rows


def _table(rows: list[dict[str, str]]) -> None:
    table = Table(*(rows[0] if rows else ()))
    for row in rows:
        table.add_row(*(str(row.get(head, "")) for head in rows[0]))
    console = Console()
    (console if console.is_terminal else Console(width=220)).print(table)


def print_list() -> None:
    """Print the names and values of all materials."""
    _table(material_rows(load_database()))


def print_material(name: str) -> None:
    """Print every value of one material."""
    _table(material_details(load_database(), name))


def print_friction() -> None:
    """Print the friction coefficients by pair."""
    _table(friction_rows(load_database()))


def add(name: str, settings: list[str], file: Path, replace: bool) -> None:
    """Write a material into the user's file."""
    material = add_material(file, name, replace=replace, **settings_of(settings))
    print(f"material '{material.name}' is in {file}")
