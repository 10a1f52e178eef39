"""The truth test: thousands of sentences on random studies, each claim recomputed from the raw rows."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd
import pytest
import yaml
from random_studies import FLAGS
from scipy.stats import rankdata

STUDIES = 150
OUTSIDE = ("half_space", "yield", "static", "conformal", "steep_friction")
NUMBER = r"(−?[\d,]+(?:\.\d+)?(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?)"
PLAIN = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


class Raw:
    """The rows of a study as plain arrays, read without the code under test."""

    def __init__(self, ds):
        inner = {"contact", "body"}
        dims = [d for d in ds["peak_stress"].dims if d not in inner]
        stacked = ds.stack(row=dims) if dims != ["case"] else ds.rename(case="row")
        self.n = stacked.sizes["row"]
        self.get = lambda name: stacked[name].transpose("row", ...).values if name in stacked else None
        given = [n for n in dims if n != "case"] or [
            n for n, v in ds.coords.items() if v.dims == ("case",) and n != "case"
        ]
        self.columns = {n: stacked[n].values for n in given}
        self.factors = {n: v for n, v in self.columns.items() if len(set(v.tolist())) > 1}
        regime, done = self.get("regime"), self.get("converged")
        self.regime = np.zeros(self.n) if regime is None else regime
        self.rolling = (self.regime == 0) & (True if done is None else done == 1)
        bits = self.get("validity")
        self.flags = {f: np.zeros(self.n, bool) if bits is None else (bits >> i) % 2 == 1 for i, f in enumerate(FLAGS)}
        outside = np.any([self.flags[f] for f in OUTSIDE if f in self.flags], axis=0)
        self.inside = self.rolling & ~outside
        self.limits = yaml.safe_load(ds.attrs["study"]).get("constraints")
        self.valid = self.inside & np.all([self.meets(*text.split(" ", 2)) for text in self.limits or []], axis=0)

    def meets(self, name, how, limit):
        """Return the rows that meet 'name how limit', (n,); an undefined value does not meet it."""
        if name == "regime":
            return self.regime != ("rolling", "full_slip", "lift_off", "failed").index(limit)
        limit = limit.strip("'") if name == "material_pair" else float(limit)
        own = self.column(name) if name == "peak_stress_roller" else self.columns[name]
        met = {"<": own < limit, ">=": own >= limit} if how != "!=" else {"!=": own != limit}
        return met[how]

    def categories(self):
        """Return the factors of a few levels without an order."""
        names = ("material_pair", "motor_force", "guide_curve_radius")
        return {n: v for n, v in self.factors.items() if n in names}

    def column(self, name):
        """Return the life, or the peak stress of a body in its worse contact, (n,)."""
        if name == "roller_life_hours":
            return self.get(name)
        return self.get("peak_stress")[:, :, ("roller", "guide").index(name.removeprefix("peak_stress_"))].max(axis=1)


def value(text):
    """Return a number of a sentence as a float."""
    mantissa, _, power = text.replace(",", "").replace("−", "-").partition("·10")
    return float(mantissa) * (10.0 ** int(power.translate(PLAIN)) if power else 1.0)


def close(text, exact, figures=3):
    """Return whether a written number agrees with the exact one to its figures."""
    return value(text) == pytest.approx(exact, rel=0.51 * 10.0 ** (1 - figures), abs=1e-12)


def first(pattern, text):
    """Return the groups of a pattern that must be in the text."""
    found = re.search(pattern, text)
    assert found, (pattern, text)
    return found.groups()


def check_valid(raw, said):
    rolls, total = first(rf"^{NUMBER} of {NUMBER} cases roll", said.text)
    assert (value(rolls), value(total)) == (raw.rolling.sum(), raw.n)
    if raw.rolling.any() and "no validity flags" not in said.text:
        count = first(rf"; {NUMBER.replace('(', '(all|none|', 1)} of them lies? inside", said.text)[0]
        assert {"all": raw.rolling.sum(), "none": 0}.get(count, count) in (raw.inside.sum(), f"{raw.inside.sum():,}")
    if raw.limits and raw.inside.any():
        meet, of = first(rf"{NUMBER.replace('(', '(None|', 1)} of the {NUMBER} meet `{raw.limits[0]}`", said.text)
        assert (0 if meet == "None" else value(meet), value(of)) == (raw.valid.sum(), raw.inside.sum())
    if "Statements on life" in said.text:
        assert value(first(rf"stress use the {NUMBER} unless", said.text)[0]) == raw.valid.sum() < raw.rolling.sum()
    elif raw.valid.any():
        assert raw.valid.sum() == raw.rolling.sum()
    lost = {"full slip": 1, "lift-off": 2, "failed": 3}
    for words, code in lost.items():
        if cases := int((raw.regime == code).sum()):
            assert f"{cases:,} {words}" in said.text


def inside(raw, name, levels):
    """Return the rows that meet a condition of a sentence, (n,)."""
    own = raw.columns[name]
    if isinstance(levels, tuple):
        return (own >= levels[0]) & (own <= levels[1])
    return np.array([v in levels for v in own.tolist()])


def check_occurrence(raw, said, hit, among):
    hit = hit & among
    if said is None:
        assert not hit.any()
        return
    assert said.values["count"] == hit.sum() and said.values["of"] == among.sum()
    if said.kind == "everywhere":
        assert hit.sum() == among.sum()
        return
    counts = first(rf"occurs in {NUMBER} of {NUMBER} cases", said.text)
    assert [value(c) for c in counts] == [hit.sum(), among.sum()]
    if said.kind == "cases":
        assert hit.sum() < 20 and "(" not in said.text
        return
    if said.kind == "crossed":
        covered = np.zeros(raw.n, bool)
        told = re.findall(r"in (?:(the one)|all ([\d,]+)|([\d,]+) of ([\d,]+)) at", said.text)
        assert len(told) == len(said.values["products"]) <= 3
        for one, (single, every, some, of) in zip(said.values["products"], told, strict=True):
            here = among & np.all([inside(raw, name, list(levels)) for name, levels in one.levels.items()], axis=0)
            counts = (1, 1) if single else (value(every),) * 2 if every else (value(some), value(of))
            assert counts == ((hit & here).sum(), here.sum()) and len(one.levels) == 2 and not (covered & here).any()
            covered |= here
        assert not (hit & ~covered).any() and 2 * hit.sum() >= covered.sum()
        return
    assert hit.sum() >= 20 or (said.kind == "only" and said.values["inside"] == hit.sum())
    told = float(first(r"\(([\d.]+) %\)", said.text)[0])
    assert told == pytest.approx(100 * hit.sum() / among.sum(), abs=0.51) and 0 < told < 100
    if said.kind == "only":
        met = among.copy()
        for name, levels in said.values["conditions"]:
            here = inside(raw, name, levels)
            assert not (hit & ~here).any() and (among & ~here).any()
            met &= here
        names = [name for name, _ in said.values["conditions"]]
        if met.sum() != hit.sum() and len(names) > 1:  # no combination of these levels has none or all
            shares = pd.DataFrame({n: raw.columns[n] for n in names}).assign(hit=hit)[met].groupby(names)["hit"].mean()
            assert (shares > 0).all() and (shares < 1).all()
        assert ("in all cases there" in said.text) == (met.sum() == hit.sum())
        if met.sum() != hit.sum():
            assert value(first(rf"of the {NUMBER} cases there", said.text)[0]) == met.sum()
    elif said.kind == "frequent":
        name, most, least = (said.values[k] for k in ("factor", "most", "least"))
        own = raw.columns[name]
        shares = {}
        for level in set(own.tolist()):
            here = among & (own == level)
            if here.sum() >= 20:
                shares[level] = (hit[here].mean(), int(hit[here].sum()), int(here.sum()))
        assert shares[most[0]][1:] == tuple(most[1:]) and shares[least[0]][1:] == tuple(least[1:])
        assert shares[most[0]][0] == max(s[0] for s in shares.values())
        assert shares[least[0]][0] == min(s[0] for s in shares.values())
        for values in (v for n, v in raw.categories().items() if n != name):
            for level in set(values.tolist()):
                a, b = (among & (values == level) & (own == end[0]) for end in (most, least))
                assert not a.any() or not b.any() or hit[a].mean() >= hit[b].mean()


def ratios(raw, column, factor, low, high, rows):
    """Return the ratios of the output at two levels, over designs that agree in all other factors."""
    values, seen = raw.column(column), {}
    others = [f for f in raw.factors if f != factor]
    for i in np.flatnonzero(rows & (values > 0)):
        seen[(raw.columns[factor][i], *(raw.columns[f][i] for f in others))] = values[i]
    found = []
    for key, start in seen.items():
        end = seen.get((high, *key[1:]))
        if key[0] == low and end is not None and not (np.isinf(start) and np.isinf(end)):
            found.append(np.log10(end) - np.log10(start))
    return np.array(found)


def in_categories(raw, factor, rows):
    """Return the rows of each level of each category besides a factor."""
    for name, values in raw.categories().items():
        if name != factor:
            yield from (rows & (values == level) for level in dict.fromkeys(values.tolist()))


def check_pairs(raw, said):
    v = said.values | vars(said.values["effect"])
    steps = ratios(raw, v["column"], v["factor"], v["low"], v["high"], raw.valid)
    up, down = int((steps > 0).sum()), int((steps < 0).sum())
    assert len(steps) == v["size"] >= 3
    assert value(first(rf"{NUMBER} pairs of valid cases", said.text)[0]) == len(steps)
    middle = float(np.median(steps))
    parts = [
        ratios(raw, v["column"], v["factor"], v["low"], v["high"], rows)
        for rows in in_categories(raw, v["factor"], raw.valid)
    ]
    parts = [float(np.median(p)) for p in parts if len(p) >= 3 and np.isfinite(np.median(p))]
    if said.kind == "pairs":
        rises = re.search(r" (lengthens|raises) ", said.text) is not None
        assert rises == (middle > 0) and (up if rises else down) >= 0.9 * (up + down)
        fold = first(rf"{NUMBER}-fold", said.text)[0]
        assert close(fold, 10 ** abs(middle), 3 if 10 ** abs(middle) < 9.99 else 2)
        assert all(p * middle >= 0 for p in parts), "a category turns the effect"
        same = up if rises else down
        assert (" in all pairs" in said.text) == (same == len(steps))
    else:
        rises, falls = first(rf"rises in {NUMBER} and falls in {NUMBER}", said.text)
        assert (value(rises), value(falls)) == (up, down)
        assert max(up, down) < 0.9 * len(steps) or any(p * middle < 0 for p in parts)
        told = re.findall(rf"{NUMBER}-fold (longer|higher|shorter|lower)", said.text)
        for fold, way in told:
            exact = [10 ** abs(p) for p in parts if (p > 0) == (way in ("longer", "higher"))]
            assert any(close(fold, e, 3 if e < 9.99 else 2) for e in exact)


def check_fitted(raw, said):
    """Check a fitted effect by least squares with other columns: each factor, its square, and its level."""
    effect = said.values["effect"]
    y = raw.column(said.values["column"])
    good = raw.valid & np.isfinite(y) & (y > 0)
    columns = [np.ones(good.sum())]
    for name, values in raw.columns.items():
        own = values[good]
        if name in raw.categories():
            columns += [(own == level).astype(float) for level in dict.fromkeys(own.tolist())][1:]
        else:
            x = rankdata(own) / len(own)
            columns += [x, x**2] if np.ptp(x) else []
    matrix = np.stack(columns, axis=1)
    rest = np.log10(y[good]) - matrix @ np.linalg.lstsq(matrix, np.log10(y[good]), rcond=None)[0]
    assert rest.var() < 0.3 * np.log10(y[good]).var()  # a plain fit tells most of it, too
    assert said.values["size"] == good.sum() and not effect.interval[0] <= 1 <= effect.interval[1]


USE = ("friction_coefficient", "axial_force", "velocity", "motor_force", "guide_curve_radius")
