"""Audit of what a report says on solved random studies, recomputed with pandas from the raw rows.

Nothing here uses analysis or sentences of the program: rows come from the data set, claims from the text.
"""

from __future__ import annotations

import itertools
import json
import os
import re

import numpy as np
import pandas as pd
import pytest
from verdict_by_hand import check_verdict

import trackroller as tr
from trackroller.report.pages.study import contents

STUDIES = int(os.environ.get("TRACKROLLER_AUDITS", "8"))
NUMBER = r"(−?[\d,]+(?:\.\d+)?(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?)"
PLAIN = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
OUTSIDE = ("half_space", "yield", "static", "conformal", "steep_friction")
STEEL, HARD, ALU = "1.7225-normalised", "1.7225-quenched-tempered", "EN AW-7075"
CHOICES = {
    "roller_profile_radius": [-6.3, -6.6, -7.5, -9.0],
    "contact_angle": [25.0, 32.0, 40.0],
    "material_pair": [[HARD, STEEL], [STEEL, "PA6"], ["POM", STEEL], [ALU, HARD], ["PA6", "POM"]],
    "axis_distance": [20.0, 24.0],
}
CONDITIONS = {
    "friction_coefficient": [0.02, 0.1, 0.2, 0.35],
    "motor_force": [-25.0, -5.0, 0.0, 12.0],
    "axial_force": [-20.0, 0.0, 15.0, 45.0],
    "radial_force": [-20.0, -90.0, -200.0],
    "guide_curve_radius": [220.0, -150.0, float("inf")],
}


def random_file(seed):
    """Return a random study file: a grid, or now and then an inner/outer array design."""
    rng = np.random.default_rng([7, seed])

    def take(table, low, high):
        return {
            str(n): sorted(rng.choice(len(table[n]), rng.integers(2, min(4, len(table[n]) + 1)), replace=False))
            for n in rng.permutation(list(table))[: rng.integers(low, high)]
        }

    picked = {**take(CHOICES, 1, 3), **take(CONDITIONS, 0 if seed % 9 == 4 else 1, 3)}
    every = CHOICES | CONDITIONS
    factors = {n: {"values": [every[n][i] for i in places]} for n, places in picked.items()}
    told = {"name": f"audit-{seed}", "contact_model": "sliding", "accuracy": "preview", "factors": factors, "base": {}}
    if rng.random() < 0.6:
        told["base"]["guide_overrollings_per_hour"] = float(rng.choice([60, 600, 2e5]))
    told["life_rule"] = str(rng.choice(["elementary", "haibach", "unlimited"]))
    if seed % 5 == 3:
        told |= {"design": "inner_outer", "samples": 32, "seed": int(seed)}
        factors |= {"friction_coefficient": {"uniform": [0.05, 0.3]}, "axial_force": {"uniform": [0.0, 60.0]}}
        for name in ("motor_force", "radial_force", "guide_curve_radius"):
            factors.pop(name, None)
    if rng.random() < 0.4:
        told["constraints"] = [f"max_pressure < {rng.choice([80, 300, 900, 1400])}"]
    if rng.random() < 0.7:
        told["analysis"] = {"target": {"pair_life_hours": {"min": float(rng.choice([5, 100, 5000]))}}}
    return told


def rows_of(ds, told):
    """Return the raw rows as one table, with what makes a case valid and which lives lie beyond the data."""
    dims = [d for d in ds["regime"].dims]
    flat = lambda v: v.broadcast_like(ds["regime"]).transpose(*dims).values.ravel()  # noqa: E731
    names = [n for n in told["factors"]]
    frame = pd.DataFrame({n: flat(ds[n]) for n in names})
    for n in ("regime", "converged", "validity", "first_to_fail", "motor_force", "friction_coefficient"):
        frame[n] = flat(ds[n]) if n in ds.variables else float(told["base"].get(n, np.nan))
    for n in ("radial_force", "contact_angle"):
        frame[n] = flat(ds[n])
    for n in ("roller", "guide", "pair"):
        frame[n] = flat(ds[f"{n}_life_hours"])
    load = ds["normal_force"]
    frame["lift"] = flat(load.min("contact") / load.max("contact"))
    frame["pressure"] = flat(ds["max_pressure"].max("contact"))
    bits = ds["validity"].attrs["flag_meanings"].split()
    outside = sum(1 << bits.index(flag) for flag in OUTSIDE if flag in bits)
    frame["rolls"] = (frame["regime"] == 0) & (frame["converged"] == 1)
    frame["inside"] = frame["rolls"] & ((frame["validity"].astype(int) & outside) == 0)
    frame["valid"] = frame["inside"]
    materials = json.loads(ds.attrs["materials"])
    for body in ("roller", "guide"):
        knee = np.array([materials[m]["cycles_at_fatigue_limit"] for m in flat(ds[f"{body}_material"]).astype(str)])
        cycles = flat(ds["life_cycles"].sel(body=body).min("contact"))
        frame[f"{body}_beyond"] = (cycles > np.minimum(knee, 1e8)) | np.isposinf(frame[body])
    frame["pair_beyond"] = np.where(frame["first_to_fail"] == 1, frame["guide_beyond"], frame["roller_beyond"])
    with np.errstate(divide="ignore", invalid="ignore"):
        hold = frame["friction_coefficient"] * frame["radial_force"].abs() / np.cos(np.deg2rad(frame["contact_angle"]))
        frame["slip"] = 1 - frame["motor_force"].abs() / hold
    return frame


def value(text):
    mantissa, _, power = text.replace(",", "").replace("−", "-").partition("·10")
    return float(mantissa) * (10.0 ** int(power.translate(PLAIN)) if power else 1.0)


def level(name, given):
    """Write a level as the page does, from the conventions of the documentation."""
    if name == "material_pair":
        a, b = str(given).split(" / ")
        return f"{a} on itself" if a == b else f"{a} on {b}"
    text = f"{given:.4g}".replace("-", "−")
    if name == "motor_force":
        return "free rolling" if given == 0 else f"{'driven' if given < 0 else 'braked'} {text} N"
    if name == "guide_curve_radius":
        side = "outer" if given > 0 else "inner"
        return "straight track" if np.isinf(given) else f"{side} curve {abs(given):.4g} mm"
    unit = {"contact_angle": "°", "friction_coefficient": ""}.get(name, " N" if "force" in name else " mm")
    return f"{name.replace('_', ' ')} {text}{unit}"


class Audit:
    """One solved random study and its page."""

    def __init__(self, seed):
        self.told = random_file(seed)
        self.limit = float(self.told["constraints"][0].split()[-1]) if "constraints" in self.told else np.inf
        solved = tr.run(self.told, progress=False)
        self.frame = rows_of(solved.data, self.told)
        self.frame["valid"] &= self.frame["pressure"] < self.limit
        self.page, self.solved = contents(solved), solved
        self.short = dict(self.page["summary"])
        names = list(self.told["factors"])
        inner = {"friction_coefficient", "axial_force"} if self.told.get("design") == "inner_outer" else set(CONDITIONS)
        self.conditions = [n for n in names if n in inner and self.frame[n].nunique() > 1]
        self.choices = [n for n in names if n not in inner and self.frame[n].nunique() > 1]
        known = np.isfinite(self.frame["guide"]).any() or np.isposinf(self.frame["guide"]).any()
        self.life = "pair" if known else "roller"

    def said(self, head):
        return {s.kind: s.text for s in self.short.get(head, [])}

    def designs(self):
        """Yield each design in words with its rows."""
        groups = self.frame.groupby(self.choices, sort=False) if self.choices else [((), self.frame)]
        for key, rows in groups:
            key = key if isinstance(key, tuple) else (key,)
            words = sorted(zip(self.choices, key, strict=True), key=lambda pair: pair[0] != "material_pair")
            yield ", ".join(level(*pair) for pair in words), rows

    def check_cases(self):
        text, frame = self.said("Where it ends")["valid"], self.frame
        assert text.startswith(f"{frame['rolls'].sum():,} of {len(frame):,} cases roll")
        for code, words in ((1, "full slip"), (2, "lift-off")):
            if lost := int((frame["regime"] == code).sum()):
                assert f"{lost:,} {words}" in text
        if 0 < frame["inside"].sum() < frame["rolls"].sum():
            assert re.search(rf"; {frame['inside'].sum():,} of them lies? inside the model", text)
        if "constraints" in self.told and frame["inside"].any():
            assert f"{frame['valid'].sum() or 'None'} of the {frame['inside'].sum()} meet" in text
        limits = self.said("Where it ends")
        silent = "motor_force" not in {**self.told.get("base", {}), **self.told["factors"]}
        assert ("silent_drive" in limits) == (silent and (frame["regime"] == 1).any())
        for kind in ("silent_drive", "valid"):
            limits.pop(kind, None)
        beyond = int((frame["inside"] & self.limits()[0]).sum())
        for kind_text in limits.values():
            if "beyond its limit" in kind_text:
                assert 0 < int(kind_text.partition(" occurs in ")[2].split(" ")[0].replace(",", "")) <= beyond
                continue
            code = 1 if kind_text.startswith("Full slip") else 2 if kind_text.startswith("Lift-off") else 3
            hit = int((frame["regime"] == code).sum())
            whole = hit == len(frame)
            assert f"occurs in {'all ' if whole else f'{hit:,} of '}{len(frame):,} cases" in kind_text

    def limits(self):
        """Return in which rows a limit is exceeded, and in which one may be exceeded by a placeholder's range."""
        ds = self.solved.data
        if "limit_state" not in ds:
            return np.zeros((2, len(self.frame)), dtype=bool)
        words = ds["limit_state"].attrs["flag_meanings"].split()
        state = ds["limit_state"].where(~ds["limit"].isin(["rating", "catalogue"]), 0)
        state = state.max(["limit", "body"]).transpose(*self.solved.dims).values.ravel()
        return state == words.index("exceeded"), state == words.index("open")

    def check_best(self):
        """Recompute the verdict; a target on the life of the pair is judged in all conditions."""
        found, frame = self.solved.verdict, self.frame
        text = " ".join(sentence.text for sentence in self.short["Verdict"])
        assert len(text.split()) <= 120, text
        given = "guide_overrollings_per_hour" in self.told["base"]
        assert ("guide" in found.not_checked) == (not given)
        exceeded, uncertain = self.limits()
        if "analysis" not in self.told:
            check_verdict(
                found, frame.assign(valid=frame["valid"] & ~exceeded), self.choices, self.conditions, self.life
            )
            return
        sure = frame["valid"] & ~exceeded & ~uncertain
        least = self.told["analysis"]["target"]["pair_life_hours"]["min"]
        met = {words: (sure & (frame[self.life] >= least))[rows.index] for words, rows in self.designs()}
        if found.candidates and not found.sampled and found.kind != "give":
            every = {words for words, hits in met.items() if hits.all()}
            assert (found.kind in ("build", "a_or_b", "lasts")) == bool(every)
            named = {", ".join(level(*pair) for pair in self.in_words(one.choices)) for one in found.best}
            assert not every or named <= every
            for one in found.candidates:
                words = ", ".join(level(*pair) for pair in self.in_words(one.choices))
                safe = one.low >= least * (1 + one.error)  # otherwise the error of the solution leaves the target open
                assert one.met == met[words].sum() and (one.status == "met") == (met[words].all() and safe)
        hit = frame["valid"] & (frame["pair"] >= least)
        for table in self.page["tables"]["decide"]:
            if table.name == "targets" and self.told.get("design") != "inner_outer":
                told = value(table.rows[0][-1].removesuffix(" %"))
                assert told == pytest.approx(100 * hit.mean(), abs=0.51), (table.rows[0], hit.mean())

    def in_words(self, choices):
        """Return the choices of a candidate in the order of its words."""
        return sorted(choices.items(), key=lambda pair: pair[0] != "material_pair")

    def check_tables(self):
        """Counts of regimes and flags, and the numbers of the table of the best designs."""
        frame, tables = self.frame, {t.name: t for t in [*self.page["tables"]["decide"], *self.page["tables"]["more"]]}
        held = frame["valid"] & ~self.limits()[0]
        for name, count, *_ in tables["regimes"].rows:
            code = ("rolling", "full slip", "lift-off", "failed").index(name)
            assert count == (frame["regime"] == code).sum()
        if "candidates" not in tables:
            return
        rows_of_words, listed = dict(self.designs()), self.solved.best(5)
        kept = [row for _, row in listed.iterrows() if row["valid"]]
        names = [self.in_words({name: row[name] for name in self.choices}) for row in kept]
        ranked = [rows_of_words[", ".join(level(*pair) for pair in own)] for own in names]
        for row in tables["candidates"].rows:
            if row[0] == "Holds in":
                assert list(row[1:]) == [f"{held[rows.index].sum()} of {len(rows)}" for rows in ranked]
            if row[0].startswith(f"Life of the {self.life}") and ", worst condition" in row[0]:
                for cell, rows in zip(row[1:], ranked, strict=True):
                    assert float(cell) == pytest.approx(rows.loc[held[rows.index], self.life].min())

    def check_rows_of_indices(self):
        """Each row is left out for one reason, and an index that uses every row says so alone."""
        frame, tables = self.frame, {t.name: t for t in self.page["tables"]["more"]}
        missed = int((frame["rolls"] & ~(frame["pressure"] < self.limit)).sum())
        for table in (t for t in tables.values() if t.heads[-1] == "Computed from"):
            counted = re.search(rf"{NUMBER} further rows miss a constraint", table.note)
            assert (value(counted[1]) if counted else 0) == missed
            for row in (r for r in table.rows if "no index can be given" not in r[-1]):
                counted = re.search(rf"{NUMBER} of {NUMBER} \w+ used", row[-1])
                assert counted, row
                used, of = map(value, counted.groups())
                lost = {
                    why: value(n) for n, why in re.findall(rf"{NUMBER} (full slip|lift-off|outside the c)", row[-1])
                }
                if "ccurrence" in row[0]:
                    assert used == of == len(frame) and not lost
                    continue
                expected = {"full slip": (frame["regime"] == 1).sum(), "lift-off": (frame["regime"] == 2).sum()}
                expected |= {"outside the c": missed}
                assert lost == {why: n for why, n in expected.items() if n}, row[-1]
                more = re.findall(rf"{NUMBER} (?:unlimited|undefined|not positive|at the same levels)", row[-1])
                assert used + sum(lost.values()) + sum(map(value, more)) == of, row[-1]
                assert ("left out" in row[-1]) == (used < of)

    def check_lives_are_marked(self):
        """A number of hours in a sentence is a life inside the data, or says that it is not."""
        frame = self.frame[self.frame["rolls"]]
        beyond, within = [], []
        for name in ("roller", "guide", "pair"):
            mask = frame[f"{name}_beyond"].astype(bool)
            beyond += frame.loc[mask, name].tolist()
            within += frame.loc[~mask, name].tolist()
        for head, said in self.page["summary"]:
            for one in said:
                for found in re.finditer(rf"{NUMBER} h\b(?! \(beyond)", one.text):
                    number, before = value(found[1]), one.text[: found.start()]
                    if before.endswith(("target of ", "target ", "at least ")):
                        continue
                    near = lambda lives, n=number: any(abs(v - n) <= 6e-3 * v for v in lives)  # noqa: E731
                    assert near(within) or not near(beyond), (head, one.text, found[0])
                assert "unlimited" not in one.text

    def everything(self):
        for name in ("cases", "best", "tables", "rows_of_indices", "lives_are_marked"):
            getattr(self, f"check_{name}")()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(STUDIES))
def test_every_claim_on_a_solved_random_study(seed):
    Audit(seed).everything()


def test_the_random_studies_hold_what_they_must():
    """Polymers, both designs of experiments, constraints, targets, and guides with and without hours."""
    files = [random_file(seed) for seed in range(40)]
    pairs = list(itertools.chain(*(f["factors"].get("material_pair", {}).get("values", []) for f in files)))
    assert any("PA6" in pair for pair in pairs) and any("POM" in pair for pair in pairs)
    for key in ("constraints", "analysis", "design"):
        assert 0 < sum(key in f for f in files) < len(files)
    assert 0 < sum("guide_overrollings_per_hour" in f["base"] for f in files) < len(files)
