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
    ("1.0", "0.0"), ("wahr", "falsch"), ("X", "-"), ("T", "F"), ("on", "off"), ("2", "0"), ("-1", "0"),
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
    elif kind == "names" and known is not None:
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


RIG = {"motor_force": 0, "friction_coefficient": 0.1, "axial_force": 20, "contact_model": "sliding"}
ROLLERS = {
    "radial_force": [-120, -120, -150, -150, -180, -180, -210, -210, -130, -165],
    "travel_from": [130, 200, 100, 50, 41.5, 25, 43.4, 31.7, 90, 23.7],
    "travel_to": [130, None, 150, 75, 41.5, 50, 43.4, 31.7, 90, 23.7],
    "end": ["fatigue roller", "none", *["fatigue roller"] * 6, "bearing", "fatigue roller"],
}
BENCH_HEADS = {
    "radial_force": ["radial_force", "radial_force [N]", "radial_force (N)"],
    "travel_from": ["travel_from", "travel_from [km]", "travel_from / km"],
    "travel_to": ["travel_to", "travel_to [km]"],
    "end": ["end"],
}
BAD_ENDS = [
    "", "fatigue", "wear roller", "wear roller inf mm", "wear roller 0 mm", "wear roller -1 mm", "wear roller 5", "?",
    "fatigue roller guide", "broken roller", "wear roller 1e300 mm", "wear roller 2 kg", "fatigue both", "1",
]  # fmt: skip
SAME_ENDS = {"none": ["NONE", "run-out", "Runout", "suspended", "run out"], "fatigue roller": ["Fatigue  Roller"]}
WHOLE = ["bearing", "other", "wear guide 0.05 mm", "wear roller 50 um", "fatigue guide", "shakedown roller"]


def bench_meaning(seed):
    """Return heads, cells by column, and what a table of rollers means: None for a table that means nothing."""
    rng = random.Random(seed)
    size = rng.choice([10] * 6 + [1, 2, 4, 7])
    rows = sorted(rng.sample(range(10), size))
    known = {name: [values[row] for row in rows] for name, values in ROLLERS.items()}
    cells = {name: ["" if value is None else str(value) for value in values] for name, values in known.items()}
    for _ in range(rng.choice([0, 1, 1, 2])):
        known = change_rollers(rng, cells, known)
    heads = {name: rng.choice(BENCH_HEADS.get(name, [name])) for name in cells}
    return rng, heads, cells, known


def change_rollers(rng, cells, known):  # noqa: C901 - one branch for each odd way
    """Change cells in one odd way; return what the table means now, None if it means nothing."""
    kind = rng.choice(
        ["bad", "empty", "end", "words", "whole", "names", "contact", "wrong contact", "twice", "swapped"]
    )
    row = rng.randrange(len(cells["end"]))
    name = rng.choice(["radial_force", "travel_from", "travel_to"])
    if kind == "bad":
        bad = [one for one in BAD_NUMBERS if one not in ("0", "-460", "1e-300") or name == "travel_to"]
        cells[name][row] = rng.choice(bad)
        return None
    if kind == "empty":
        name = rng.choice(["radial_force", "travel_from", "end"])
        cells[name][row] = ""
        return None
    if kind == "end":
        cells["end"][row] = rng.choice(BAD_ENDS)
        return None
    if kind == "words":
        cells["end"] = [rng.choice(SAME_ENDS.get(end, [end])) for end in cells["end"]]
    elif kind == "whole" and cells["travel_to"][row] and known is not None:
        end = rng.choice(WHOLE)
        if end == "fatigue guide" and "fatigue roller" in cells["end"][:row] + cells["end"][row + 1 :]:
            end = "other"  # two bodies that failed are refused
        cells["end"][row] = end
        known = known | {"end": [*known["end"][:row], end, *known["end"][row + 1 :]]}
    elif kind == "names" and known is not None:
        cells["test"] = [f"P{i}" for i in range(len(cells["end"]))]
    elif kind == "contact" and known is not None:
        own = [rng.choice([1, 2, ""]) for _ in cells["end"]]
        cells["contact"] = list(map(str, own))
        known = known | {"contact": [one or None for one in own]}
    elif kind == "wrong contact":
        cells["contact"] = ["1"] * len(cells["end"])
        cells["contact"][row] = rng.choice(["3", "0", "1.5", "left", "inf", "nan", "-1"])
        return None
    elif kind == "twice":
        for own in cells.values():
            own.append(own[row])
        if known is None or "test" in cells or cells["end"][row] not in ("none", *SAME_ENDS["none"]):
            return None
        return {own: [*values, values[row]] for own, values in known.items()}
    elif kind == "swapped":
        cells["travel_to"][row] = "0.001"
        return None
    return known


def bench_fitted(table):
    """Return the values of a fit of rollers, or the sentence that refuses it."""
    try:
        line = tr.fit_bench(table, base=RIG).groups[0].line
    except InputError as error:
        assert any(word in str(error) for word in ("Allowed: ", "Needed: ", " is not known", " stands in row ")), error
        return str(error)
    return line.size, line.estimate


def check_bench(seed, path):
    rng, heads, cells, known = bench_meaning(seed)
    text = written(rng, heads, cells, path)
    found = bench_fitted(path)
    if isinstance(found, str):
        assert path.name in found, (text, found)
        assert known is None or isinstance(bench_fitted(known), str), (text, found)
        return found
    assert known is not None, (text, found)
    expected = bench_fitted(known)
    assert not isinstance(expected, str), (text, expected)
    assert found[0] == expected[0] == len(known["end"]), text
    assert np.allclose(found[1], expected[1], rtol=1e-9), text
    return "fit"


@pytest.mark.parametrize("seed", range(100))
def test_an_odd_table_of_rollers_is_read_as_a_person_reads_it_or_refused(tmp_path, seed):
    check_bench(seed, tmp_path / "odd.csv")
