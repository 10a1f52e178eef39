"""The truth test of sentences on an analysis: random indices, Pareto sets and design points, recomputed."""

from __future__ import annotations

import re

import numpy as np
import pytest
import xarray as xr
from synthetic_results import results_of
from told import effect_of, of_analysis

from trackroller.report.numbers import level_text
from trackroller.report.words.pareto import pareto_sentence
from trackroller.report.words.samples import samples
from trackroller.report.words.targets import robust_tables
from trackroller.results.pareto import pareto_mask
from trackroller.results.sensitivity import analyse
from trackroller.study.file.load import parse_study

NAMES = ("friction", "groove radius", "axial force", "travel speed", "contact angle")
INDICES = {"saltelli": "ST", "grid": "main_share", "lhs": "first", "morris": "mu_star"}


def analysis(rng, method):
    """Return a made-up analysis of two outputs with intervals (none on a grid)."""
    count = int(rng.integers(1, len(NAMES) + 1))
    index, shape = INDICES[method], (2, count)
    value = rng.dirichlet(np.full(count, 0.4), 2) * rng.choice([1.0, 0.6])
    value = value * (30 if method == "morris" else 1)
    value[rng.random(shape) < 0.05] = np.nan
    half = np.abs(rng.normal(0, 0.03, shape)) * (30 if method == "morris" else 1)
    dims = ("output", "factor")
    ds = xr.Dataset({index: (dims, value)})
    if method != "grid":
        ds[f"{index}_low"], ds[f"{index}_high"] = (dims, value - half), (dims, value + 1.4 * half)
    if method == "saltelli":
        ds["S1"] = (dims, value * rng.uniform(0, 1, shape))
        ds["S1_low"], ds["S1_high"] = (dims, ds["S1"].values - half), (dims, ds["S1"].values + half)
        table = np.triu(rng.normal(0.02, 0.05, (2, count, count)), 1) + np.tril(np.full((count, count), np.nan))
        pair = ("output", "factor", "factor_2")
        ds["S2"], ds["S2_low"], ds["S2_high"] = (pair, table), (pair, table - 0.03), (pair, table + 0.03)
    if method == "morris":
        ds["sigma"] = (dims, value * rng.uniform(0, 2, shape))
    ds["take_times"] = ("output", rng.choice([1.0, 1.0, 4.0, 8.0, np.nan], 2))
    ds["half_width"] = 0.05 * np.sqrt(ds["take_times"]) * rng.uniform(0.75, 1.0, 2)
    ds["note"] = ("output", np.array(["all rows used"] * 2, dtype=object))
    ds = ds.assign_coords(
        factor=np.array([n.replace(" ", "_") for n in NAMES[:count]], dtype=object),
        factor_name=("factor", np.array(NAMES[:count], dtype=object)),
        output=np.array(["roller_life_hours", "friction_power"], dtype=object),
        output_name=("output", np.array(["life of the roller", "friction power"], dtype=object)),
        output_units=("output", np.array(["h", "W"], dtype=object)),
        scale=("output", np.array(["log10", "natural"], dtype=object)),
        sample_size=[64, 128],
    )
    ds.attrs["method"] = method
    return ds


def agrees(text, value, low, high, unit):
    """Return whether '61 ± 3 %' is the value and half its 95 % interval, or '99 % (90 to 100 %)' both ends of it."""
    found = re.match(r"(−?[\d.,]+)(?: ± ([\d.]+))?", text)
    told = float(found[1].replace(",", "").replace("−", "-"))
    digits = len(found[1].partition(".")[2])
    assert told == pytest.approx(unit * max(value, 0), abs=0.51 * 10.0**-digits, rel=0.006)
    lopsided = re.match(r"[\d.,]+ % \(([\d.,]+) to ([\d.,]+) %\)", text)
    if lopsided:  # an end near the value: both ends are told
        assert min(value - low, high - value) < 0.16 * (high - low)
        for text, end in zip(lopsided.groups(), (low, high), strict=True):
            assert float(text.replace(",", "")) == pytest.approx(unit * max(end, 0), abs=0.51, rel=0.006)
    elif np.isfinite(high - low):
        half = unit * (high - low) / 2
        assert float(found[2]) == pytest.approx(
            half, abs=0.51 * 10.0 ** -len(found[2].partition(".")[2]), rel=0.06
        ) or (found[2] == "1" and half < 1)
    else:
        assert found[2] is None


@pytest.mark.parametrize("method", INDICES)
def test_every_sentence_on_indices_is_true(method):
    rng = np.random.default_rng(list(INDICES).index(method))
    kinds = set()
    for _ in range(40):
        sens = analysis(rng, method)
        for output in map(str, sens["output"].values):
            kinds |= check_indices(sens, output, INDICES[method])
        check_samples(sens, samples(sens, 500))
    assert "index" in kinds


def check_samples(sens, said):
    """Check the verdict on the samples by the widest interval, and the number to write by its square-root law."""
    times, half = sens["take_times"].values, sens["half_width"].values
    if sens.attrs["method"] == "grid" or np.isnan(times).all():
        assert said is None
        return
    more = np.nanmax(times)
    widest = np.nanmax(half[times == more])
    told = [float(t) / 100 for t in re.findall(r"± ([\d.]+) %", said.text)]
    assert told[0] == pytest.approx(widest, rel=0.06)
    assert said.text.startswith("Enough" if more <= 1 else "Not enough")
    if more > 1:
        asked = sens.attrs.get("samples", 500)
        assert f"`samples: {int(asked * more)}`" in said.text
        assert told[1] == pytest.approx(widest / np.sqrt(more), rel=0.06)


def check_indices(sens, output, index):
    part = sens.sel(output=output)
    value = part[index].values
    low, high = (
        part[f"{index}{e}"].values if f"{index}{e}" in part else np.full_like(value, np.nan) for e in ("_low", "_high")
    )
    said, kinds = of_analysis(sens, "index", output), set()
    if said is None:
        assert np.isnan(value).all()
        return kinds
    kinds.add(said.kind)
    assert len(re.findall(r"index", said.text)) == (0 if index == "mu_star" else 1)  # one index a sentence
    names = part["factor_name"].values
    first = int(np.nanargmax(value))
    if index == "mu_star":
        assert f"Over its whole range {names[first]} changes" in said.text
        agrees(said.text.split("most, by ")[1], value[first], low[first], high[first], 1.0)
        for i, name in enumerate(names):
            if i != first and f"{name} by " in said.text.split(";")[0]:
                agrees(said.text.split(f"{name} by ")[1], value[i], low[i], high[i], 1.0)
        return kinds
    assert said.text.lower().startswith(names[first])
    agrees(re.split("accounts for |explains ", said.text)[1], value[first], low[first], high[first], 100.0)
    more, _, small = said.text.split("index", 1)[1].partition("; ")
    unsure, small = small.rpartition("; ")[::2] if "known from 0" in small and "less than" in small else ("", small)
    unsure, small = (small, "") if small.startswith("not known from 0") else (unsure, small)
    for i, name in enumerate(names):
        if i != first and name in more:
            agrees(more.split(f"{name} ")[1], value[i], low[i], high[i], 100.0)
        if name in unsure:  # the interval holds 0
            assert low[i] < 0.005 and f"{name} (0 to {100 * high[i]:.0f} %)" in unsure
        if i != first and name in small:
            assert (high[i] if np.isfinite(high[i]) else value[i]) < 0.02
    kinds.add(check_interaction(sens, output))
    return kinds


def check_interaction(sens, output):
    said = of_analysis(sens, "interaction", output)
    if "S2" not in sens or np.isnan(sens["S2"].sel(output=output)).all():
        assert said is None
        return ""
    table, low = sens["S2"].sel(output=output).values, sens["S2_low"].sel(output=output).values
    i, j = np.unravel_index(np.nanargmax(np.abs(table)), table.shape)
    found = low[i, j] > 0 and table[i, j] >= 0.05
    assert (said is not None) == found
    if found:
        names = sens["factor_name"].values
        assert f"{names[i]} with {names[j]}" in said.text
        agrees(said.text.split("makes ")[1], table[i, j], low[i, j], 2 * table[i, j] - low[i, j], 100.0)
    return said.kind if found else ""


@pytest.mark.slow
@pytest.mark.parametrize("method", ["saltelli", "grid", "lhs"])
def test_every_sentence_on_groups_and_levels_is_true(method):
    """The groups stand in the order of their indices, each level has its largest factor, each ± is half an interval."""
    rng = np.random.default_rng(len(method))
    found = 0
    for _ in range(60):
        sens = with_parts(rng, analysis(rng, method))
        for output in map(str, sens["output"].values):
            said = {k: s for k in ("groups", "levels") if (s := of_analysis(sens, k, output)) is not None}
            found += len(said)
            check_groups(sens.sel(output=output), said.get("groups"))
            check_levels(sens.sel(output=output), said.get("levels"))
    assert found > 60


def with_parts(rng, sens):
    """Add indices of two to four groups and of the factors within two or three levels."""
    groups, levels, exact = int(rng.integers(2, 5)), int(rng.integers(2, 4)), sens.attrs["method"] == "grid"
    for name, dims in (("group_ST", ("output", "group")), ("conditional_S1", ("output", "level", "factor"))):
        shape = (2, groups) if len(dims) == 2 else (2, levels, sens.sizes["factor"])
        value, half = rng.uniform(-0.02, 1, shape), np.abs(rng.normal(0, 0.04, shape))
        value[rng.random(shape) < 0.1] = np.nan
        sens[name] = (dims, value)
        if not exact:
            sens[f"{name}_low"], sens[f"{name}_high"] = (dims, value - half), (dims, value + 0.7 * half)
    sens["conditional_rows"] = (("output", "level"), rng.integers(1, 900, (2, levels)))
    names = np.array(["load", "geometry", "drive", "surface"][:groups], dtype=object)
    kinds = np.array(["PA6 / steel", "POM / POM", "steel / steel"][:levels], dtype=object)
    return sens.assign_coords(
        group=names, group_name=("group", names), level=("level", kinds, {"factor": "material_pair"})
    )


def bounds_of(part, name):
    return [float(part[f"{name}{e}"]) if f"{name}{e}" in part else np.nan for e in ("_low", "_high")]


def check_groups(part, said):
    value = part["group_ST"].values
    assert (said is None) == bool(np.isnan(value).any())
    if said is None:
        return
    told = said.text.removeprefix("By groups, ").replace("accounts for ", "")
    order = np.argsort(-value)
    places = [told.index(str(part["group"].values[i])) for i in order]
    assert places == sorted(places) and said.text.count("index") == 1
    for i in order:
        one = part.isel(group=int(i))
        agrees(told.split(f"{one['group'].item()} ")[1], value[i], *bounds_of(one, "group_ST"), 100.0)


def check_levels(part, said):
    value = part["conditional_S1"].values
    assert (said is None) == bool(np.isnan(value).all())
    if said is None:
        return
    assert said.text.startswith("By material pair, the largest first-order index")
    clauses = said.text[:-1].split("is: ")[1].split("; ")
    known = [i for i in range(len(value)) if np.isfinite(value[i]).any()]
    assert len(clauses) == len(known)
    for clause, i in zip(clauses, known, strict=True):
        best = int(np.nanargmax(value[i]))
        name = str(part["factor_name"].values[best])
        assert clause.startswith(f"{name} ") and clause.endswith(
            f"with {level_text('material_pair', part['level'].values[i])}"
        )
        one = part.isel(level=i, factor=best)
        agrees(clause.removeprefix(f"{name} "), value[i, best], *bounds_of(one, "conditional_S1"), 100.0)


def test_every_sentence_on_a_pareto_set_is_true():
    rng = np.random.default_rng(3)
    for _ in range(60):
        n = int(rng.integers(1, 60))
        life, power = np.round(rng.lognormal(5, 1, n), 1), np.round(rng.lognormal(1, 1, n), 1)
        best = pareto_mask(np.stack([life, power], 1), ("max", "min"))
        attrs = {"objectives": "life max, power min", "model": ""}
        front = xr.Dataset(
            {
                "life": ("row", life, {"units": "h", "long_name": "life"}),
                "power": ("row", power, {"units": "W", "long_name": "power"}),
                "optimal": ("row", best.astype(np.int8)),
            },
            coords={"row": np.arange(n)},
            attrs=attrs,
        )
        text = pareto_sentence(front).text
        tuples = [float(v.replace(",", "")) for v in re.findall(r"([\d,]+(?:\.\d+)?) (?:h|W)\b", text)]
        if best.sum() == 1:
            assert text.startswith("One design")
            continue
        assert text.startswith(f"{best.sum()} designs are Pareto-optimal")
        ends = (int(np.argmax(np.where(best, life, -1))), int(np.argmin(np.where(best, power, np.inf))))
        exact = [v for i in ends for v in (life[i], power[i])]
        assert tuples[:4] == pytest.approx(exact, rel=0.006)


@pytest.mark.slow
def test_every_row_on_design_points_is_true():
    rng = np.random.default_rng(4)
    for _ in range(60):
        points, inner = int(rng.integers(1, 6)), 40
        b10 = rng.lognormal(5, 1, points)
        shares = rng.dirichlet([3, 0.2, 0.2, 0.1], points).T
        shares = np.round(shares * inner) / inner
        shares[0] = 1 - shares[1:].sum(axis=0)
        safe = np.where(shares[1:].sum(axis=0) >= 0.1, 0.0, 0.8 * b10)
        beyond = np.where(rng.random(points) < 0.5, np.nan, b10 * rng.choice([0.5, 2.0], points))
        dims = ("output", "point")
        table = xr.Dataset(
            {
                "b10": (dims, b10[None]),
                "b10_low": (dims, 0.9 * b10[None]),
                "b10_high": (dims, 1.1 * b10[None]),
                "b10_safe": (dims, safe[None]),
                "mean": (dims, b10[None]),
                "probability": (("regime", "point"), shares),
                "probability_low": (("regime", "point"), np.maximum(shares - 0.1, 0.0)),
                "probability_high": (("regime", "point"), np.minimum(shares + 0.1, 1.0)),
                "percentile_value": ((*dims, "percentile"), np.repeat(b10[None, :, None], 4, axis=2)),
                "beyond_data": (dims, beyond[None]),
            },
            coords={
                "percentile": [5.0, 10.0, 50.0, 95.0],
                "output": np.array(["roller_life_hours"], dtype=object),
                "output_name": ("output", np.array(["life of the roller"], dtype=object)),
                "output_units": ("output", np.array(["h"], dtype=object)),
                "regime": np.array(["rolling", "full_slip", "lift_off", "failed"], dtype=object),
                "velocity": ("point", 10.0 + np.arange(points)),
            },
            attrs={"outer_factors": "velocity"},
        )
        told = robust_tables(table, None)[0]
        best = int(re.search(r"speed (\d+) m/min", told.rows[0][0])[1]) - 10
        assert safe[best] == safe.max() and b10[best] == b10[safe == safe.max()].max()
        assert len(told.rows) == points
        for row in told.rows:
            point = int(re.search(r"speed (\d+) m/min", row[0])[1]) - 10
            assert (float(row[1]), float(row[3])) == (b10[point], safe[point])
            assert row[1].beyond == bool(b10[point] >= beyond[point])
            for head, text in zip(told.heads[4:], row[4:], strict=True):
                regime = ("Full slip", "Lift-off", "Failed").index(head.removesuffix(" (95 % interval)")) + 1
                assert float(text.split(" %")[0]) == pytest.approx(100 * shares[regime, point], abs=0.51)


def test_sentences_name_the_factors_that_are_correlated_in_the_rows():
    """A study with a rank correlation: the sentences on its classes and on its indices name the right factors."""
    study = parse_study(
        {
            "name": "tied",
            "design": "lhs",
            "samples": 300,
            "factors": {
                "axial_force": {"uniform": [0, 20]},
                "radial_force": {"uniform": [-300, -100]},
                "velocity": {"uniform": [10, 90]},
            },
            "rank_correlations": [["axial_force", "radial_force", -0.7]],
            "analysis": {"outputs": ["roller_life_hours"]},
            "outputs": ["life"],
        }
    )
    ds = study.design()
    ds["roller_life_hours"] = ("case", 1e5 / -ds["radial_force"].values, {"units": "h"})
    ds.attrs["study"] = study.merged()
    results = results_of(ds)
    # what the radial force makes is no effect of the axial force that goes with it
    assert effect_of(results, "roller_life_hours", "axial_force", np.ones(300, bool)) is None
    said = effect_of(results, "roller_life_hours", "radial_force", np.ones(300, bool)).values["effect"]
    assert said.ratio == pytest.approx(said.low / said.high, rel=0.02)
    sens = analyse(results_of(ds))
    assert sens["correlated"].values.tolist() == [1, 1, 0]
    said = of_analysis(sens, "index", "roller_life_hours").values
    assert said["first"].factor == "radial_force" and said["correlated"] == ["axial force", "radial force"]
    assert "rank correlation -0.70" in sens.attrs["treatment"] and "interaction_share" not in sens
