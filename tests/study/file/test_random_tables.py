"""Random tables are read as a person reads them or refused, never read wrong."""

import pytest
import random_tables
from examples import EXAMPLES

from trackroller.errors import InputError
from trackroller.study.design.read_table import table
from trackroller.study.spectrum.file import load_spectrum

PARTS = 4  # so that two processes share them
KINDS = {"csv": random_tables.random_csv, "xlsx": random_tables.random_workbook}


def share(kind: str) -> int:
    """Return how many tables of a kind a part writes: together 2,000 in CI, and a third of them are workbooks."""
    return 2 * EXAMPLES // PARTS * (2 if kind == "csv" else 1) // 3


def same(read, true) -> bool:
    """Return whether a cell was read as the person reads it; a label may be a number that is written as the label."""
    if isinstance(true, str):
        return str(read) == true or (isinstance(read, float) and f"{read:g}" == true)
    return isinstance(read, float) and read == pytest.approx(true, rel=1e-9)


def check(read: dict[str, list], made: random_tables.RandomTable, seed: int) -> None:
    text = f"seed {seed}, {made.path.name}, {made.quirks}\n{read}\n{made.values}"
    assert made.values, f"read, but nobody can know the values: {text}"
    for name, true in made.values.items():
        key = name.replace(" ", "_")
        with_unit = next((n for n in read if n.startswith(f"{key}_")), "")
        found = read.get(key, read.get(with_unit, []))
        assert len(found) == len(true) and all(map(same, found, true)), f"{name} is read wrong: {text}"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("part", [0, *(pytest.param(part, marks=pytest.mark.slow) for part in range(1, PARTS))])
def test_a_random_table_of_cases_is_read_right_or_refused(kind, part, tmp_path):
    accepted = 0
    for seed in range(part, PARTS * share(kind), PARTS):
        made = KINDS[kind](seed, tmp_path)
        try:
            columns = table(made.path)
        except InputError as error:
            assert made.path.name in str(error), f"seed {seed}: the message does not name the file: {error}"
            continue
        check({name: values.tolist() for name, values in columns.items()}, made, seed)
        accepted += 1
    assert accepted > 0.2 * share(kind), "most tables are refused, so that the test shows little"


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("part", range(PARTS))
def test_a_random_table_of_blocks_is_read_right_or_refused(kind, part, tmp_path):
    accepted = 0
    for seed in range(part, PARTS * share(kind), PARTS):
        made = KINDS[kind](seed, tmp_path, blocks=True)
        (tmp_path / "s.yaml").write_text(f"blocks: {made.path.name}\n")
        try:
            blocks = load_spectrum(tmp_path / "s.yaml").blocks
        except InputError:
            continue
        read = {
            name: [getattr(block if name in ("name", "distance") else block.case, name) for block in blocks]
            for name in made.values
        }
        check(
            {name: [v if isinstance(v, str) else float(v) for v in values] for name, values in read.items()}, made, seed
        )
        accepted += 1
    assert accepted > 0.2 * share(kind), "most tables are refused, so that the test shows little"
