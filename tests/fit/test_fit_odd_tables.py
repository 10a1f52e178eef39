"""A hundred odd tables: each gives the fit of what it means to a person, or is refused in a sentence."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

import trackroller as tr
from trackroller.errors import InputError

UNDER = {"load_type": "axial", "stress_ratio": -1}
STRESS = [460, 460, 430, 430, 400, 400, 370, 350, 370, 350, 330, 330]
CYCLES = [61000, 98000, 120000, 75000, 210000, 310000, 420000, 900000, *[10000000] * 4]
FAILED = [True] * 8 + [False] * 4
HEADS = {
    "amplitude": [
        "amplitude", "amplitude [MPa]", "Amplitude (MPa)", "stress_amplitude_MPa", "load", "S [MPa]", "sigma_a [N/mm2]",
        "STRESS AMPLITUDE [MPa]", "stress", "Spannungsamplitude / MPa",
    ],
    "cycles": ["cycles", "N", "Nf", "cycles_to_failure", "Cycles [-]", "Lastspiele", "number of cycles"],
    "failed": ["failed", "fracture", "Failure", "broken", "Bruch", "is_failed"],
    "censored": ["censored", "runout", "run_out", "Run-out", "suspended", "is_runout", "Durchläufer"],
}  # fmt: skip
CODES = [
    ("yes", "no"), ("1", "0"), ("TRUE", "FALSE"), ("true", "false"), ("Y", "N"), ("x", ""), ("ja", "nein"),
    ("1.0", "0.0"), ("wahr", "falsch"), ("X", "-"), ("T", "F"), ("on", "off"), ("2", "1"), ("-1", "0"),
    ("failed", "run-out"),
]  # fmt: skip
BAD_NUMBERS = [
    "NaN", "nan", "inf", "-inf", "1e300", "1e-300", "0", "-460", "None", "null", "N/A", "#N/A", "#DIV/0!", "abc", "--",
    "1e400", "9" * 400, "9" * 30, "0x1F", "1_000", "٤٦٠", "12:30", "2026-11-29", "1/0", "460 kg", "yes", "5 %", "1,2,3",
]  # fmt: skip


def meaning(seed):
    """Return heads, cells by column, and what the table means: None for a table that means nothing."""
    rng = random.Random(seed)
    stress, cycles, failed = list(STRESS), list(CYCLES), list(FAILED)
    kind = rng.choice(["whole"] * 4 + ["few", "one row", "run-outs", "one stress", "failures"])
    if kind == "few":
        rows = rng.sample(range(12), rng.randrange(1, 8))
    elif kind == "one row":
        rows = [rng.randrange(12)]
    elif kind == "run-outs":
        rows = range(8, 12)
    elif kind == "failures":
        rows = range(8)
    else:
        rows = range(12)
    stress, cycles, failed = ([own[row] for row in rows] for own in (stress, cycles, failed))
    if kind == "one stress":
        stress = [400] * len(stress)
    column = rng.choice(["failed", "censored"])
    yes, no = rng.choice(CODES)
    if (yes, no) == ("failed", "run-out") and column == "censored":
        yes, no = no, yes
    codes = [yes if one == (column == "failed") else no for one in failed]
    cells = {"amplitude": list(map(str, stress)), "cycles": list(map(str, cycles)), column: codes}
    known = {"amplitude": stress, "cycles": cycles, "failed": failed}
    for _ in range(rng.choice([0, 0, 1, 2])):
        known = change(rng, cells, known)
    heads = {name: rng.choice(HEADS[name]) for name in cells if name in HEADS}
    heads |= {name: name for name in cells if name not in heads}
    return rng, heads, cells, known


def change(rng, cells, known):  # noqa: C901 - one branch for each odd way
    """Change cells in one odd way; return what the table means now, None if it means nothing."""
    kind = rng.choice(["bad", "empty", "blank", "unit", "names", "notation", "codes", "twice", "constant"])
    name, row = rng.choice(["amplitude", "cycles"]), rng.randrange(len(cells["cycles"]))
    column = next(one for one in ("failed", "censored") if one in cells)
    if kind == "bad":
        cells[name][row] = rng.choice(BAD_NUMBERS)
        return None
    if kind == "empty":
        cells[name][row] = ""
        return None
    if kind == "blank":
        cells[name][row] = f"  {cells[name][row]}\u00a0"
    elif kind == "unit":
        cells["amplitude"] = [f"{cell} MPa" for cell in cells["amplitude"]]
    elif kind == "names":
        cells[rng.choice(["test", "specimen", "sample_id"])] = [f"P{i}" for i in range(len(cells["cycles"]))]
    elif kind == "notation" and known is not None:
        way = rng.choice(["{:.0f}.0", "{:.6e}", "{:.6E}", "+{:.0f}", "{:,.0f}", "{:.3f}"])
        cells["cycles"] = [way.format(number) for number in known["cycles"]]
    elif kind == "codes":
        cells[column][row] = rng.choice(["maybe", "?", "3", "0.5", "yes no", "NaN", "True story"])
        return None
    elif kind == "twice":
        for own in cells.values():
            own.append(own[row])
        named = any(own in cells for own in ("test", "specimen", "sample_id"))
        if known is None or named or known["failed"][row]:
            return None  # the same failure twice; two run-outs at one amplitude are usual
        return {own: [*values, values[row]] for own, values in known.items()}
    elif kind == "constant":
        cells["note"] = ["ok"] * len(cells["cycles"])
    return known


def written(rng, heads, cells, path):
    """Write the table as some program would."""
    sep = rng.choice([",", ";", "\t", ";", ","])
    names = list(cells)
    rng.shuffle(names)
    rows = [[heads[name] for name in names], *map(list, zip(*(cells[name] for name in names), strict=True))]
    if rng.random() < 0.2:
        rows = [[f"{cell} " for cell in row] for row in rows]
    lines = [sep.join(f'"{cell}"' if sep in cell else cell for cell in row) for row in rows]
    if rng.random() < 0.2:
        lines.insert(rng.randrange(1, len(lines) + 1), rng.choice(["", "# a comment", sep * (len(names) - 1)]))
    text = rng.choice(["\n", "\r\n"]).join(lines) + "\n"
    path.write_bytes(text.encode(rng.choice(["utf-8", "utf-8-sig", "utf-8"])))
    return text


def fitted(table):
    """Return the values of a fit, or the sentence that refuses it."""
    try:
        line = tr.fit_sn(table, **UNDER).groups[0].line
    except InputError as error:
        assert any(word in str(error) for word in ("Allowed: ", "Needed: ", " is not known")), error
        return str(error)
    return line.free, line.estimate


def check(seed, path):
    rng, heads, cells, known = meaning(seed)
    text = written(rng, heads, cells, path)
    found = fitted(path)
    if isinstance(found, str):
        assert path.name in found or "tests = " in found or "scatter" in found, (text, found)
        return found
    assert known is not None, (text, found)
    expected = fitted(known)
    assert not isinstance(expected, str), (text, expected)
    assert found[0] == expected[0], text
    assert np.allclose(found[1], expected[1], rtol=1e-9), text
    assert math.isfinite(float(np.sum(found[1])))
    return "fit"


@pytest.mark.parametrize("seed", range(100))
def test_an_odd_table_is_read_as_a_person_reads_it_or_refused(tmp_path, seed):
    check(seed, tmp_path / "odd.csv")
