"""The trade-off in words and tables, as a page of the documentation (Markdown) and as one HTML file."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from trackroller.errors import InputError
from trackroller.roller.accuracy import PROMISES, accuracy_settings, preset_rungs, read_ladders, rounded_up
from trackroller.study.files import write_whole
from validation.pages import Block, page_html
from validation.tradeoff.errors import QUANTITIES
from validation.tradeoff.figures import draw_all
from validation.tradeoff.summary import summary

Record = dict[str, Any]
LADDER_NAMES = {
    "forces": "quadrature of the forces (full sliding)",
    "peak": "search of the peak stress",
    "fastsim": "elements of `fastsim`",
    "kalker": "elements of `kalker`",
}
TOLERANCES = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5)


def blocks(summary: dict[str, Any], figures: Sequence[dict[str, str]]) -> list[Block]:
    """Return the page as headings, paragraphs, tables and figures."""
    sample = summary["sample"]
    counts = ", ".join(
        f"{sample[f'designs_{m}']:,} for `{m}`" for m in ("sliding", "fastsim", "kalker") if f"designs_{m}" in sample
    )
    return [
        ("h1", "What accuracy costs, measured"),
        (
            "p",
            "Error of every stage and contact model against a converged reference, and CPU time a case, over "
            "discretisation and method. `snakemake -s validation/Snakefile --cores all tradeoff` measures again; "
            "`python -m validation.adopt.tradeoff` takes the result over into this page and into the ladders that "
            "`accuracy` chooses from.",
        ),
        (
            "p",
            f"Sample: a scrambled Sobol sequence (seed {sample['seed']}) of designs that roll or slide on both "
            f"contacts: {counts}. It is wider than what anybody builds: loads over three decades, contact angles "
            "from 10 to 80 deg, friction from 0 to 1, narrow to flat grooves and convex rollers, straight, outer and "
            "inner curves, driven, free and braked, stiffness 2 to 250 GPa, Poisson's ratio 0 to 0.5. Left out are "
            "patches that reach the middle of the guide or have their spin pole apart from where the slip vanishes "
            "(bits `conformal` and `split_pole`): there the stress of the sliding model is itself infinite, as a "
            "logarithm, and no setting has an error.",
        ),
        (
            "p",
            "Errors are the largest over both contacts and bodies of a design. The reference is the same model with "
            "far finer settings (of several searches for the peak the highest counts: a search only finds too "
            "little). The error of a *model* against another is a different matter, see [accuracy.md](accuracy.md).",
        ),
        ("h2", "What a tolerance buys"),
        *_tolerance_blocks(),
        ("h2", "Presets"),
        *_preset_blocks(summary),
        ("h2", "Error against cost"),
        *[("figure", f) for f in figures if "convergence" not in f["name"]],
        ("h2", "The ladders"),
        (
            "p",
            "Settings that no other beats in cost and in the error that 99 % of the designs keep. *bound*: with 95 % "
            "confidence 99 % of all cases lie below (order statistic); a sample below 299 designs, as that of "
            "`kalker`, only allows a promise for about 95 % (half as much again as its 95th percentile). Peaks: "
            "`scan climb polish summit seeds finalists step floor`.",
        ),
        *_ladder_blocks(summary["ladders"]),
        ("h2", "Order of convergence"),
        *[("figure", f) for f in figures if "convergence" in f["name"]],
        (
            "table",
            (
                ("stage", "model", "method", "quantity", "from", "to", "order", "R²", "coarsest", "finest"),
                [
                    (
                        o["stage"],
                        o["model"],
                        o["method"],
                        QUANTITIES[o["quantity"]][1],
                        f"{o['from']:g}",
                        f"{o['to']:g}",
                        f"{o['order']:.1f}",
                        f"{o['fit']:.2f}",
                        _error(o["coarsest"]),
                        _error(o["finest"]),
                    )
                    for o in summary["orders"]
                ],
            ),
        ),
        (
            "p",
            "Orders are slopes of the median error by least squares; above about 4 the convergence is faster than "
            "any power and the number only tells that. Points where the error is down to rounding are left out.",
        ),
        ("h2", "Single stages"),
        _stage_table(summary["settings"]),
        ("h2", "Life"),
        ("p", _life_words(summary["life"])),
        ("h2", "The paper's table 2"),
        *_paper_blocks(summary["paper_table"]),
    ]


def _tolerance_blocks() -> list[Block]:
    rows = []
    for tolerance in TOLERANCES:
        cells = []
        for model in ("sliding", "fastsim", "kalker"):
            try:
                s = accuracy_settings(tolerance, model)
            except InputError as refusal:
                cells.append("refused: " + _reached(refusal))
                continue
            p = s.peak
            search = f"{p.scan}/{p.climb}/{p.polish}/{p.summit}, {p.seeds} seeds"
            cells.append(
                f"{s.force_nodes} nodes, {search}" if model == "sliding" else f"{s.elements} elements, {search}"
            )
        rows.append((f"{tolerance:g}", *cells))
    words = (
        "`accuracy=1e-3` takes the cheapest setting whose bound keeps the tolerance for everything asked for: F_N "
        "relative to itself, F_T and F_A to mu F_N, M_R to mu F_N sqrt(ab), friction work and peak stress to "
        "themselves. What no setting reaches is refused with the value that can be reached. "
        "`python -m validation.benchmarks.tolerance` checks it on a fresh sample."
    )
    return [("p", words), ("table", (("tolerance", "`sliding`", "`fastsim`", "`kalker`"), rows))]


def _reached(refusal: InputError) -> str:
    hit = re.search(r"reaches here is ([\d.e-]+)", str(refusal))
    return f"reaches {hit[1]}" if hit else "out of reach"


def _preset_blocks(summary: dict[str, Any]) -> list[Block]:
    measured, rows = read_ladders(summary["ladders"]), []
    for name in summary["presets"]:
        forces, peak, rolling = preset_rungs(name, measured)
        pairs = {"sliding": (peak, forces)}
        for model in ("fastsim", "kalker"):
            own = [r for r in measured[model] if rolling and r.settings == rolling.settings]
            pairs |= {model: (own[0], own[0])} if own else {}
        for model, (whole, part) in pairs.items():
            p, f, n = whole.errors["peak_stress"], part.errors["friction_force"], whole.errors["life"]
            rows.append(
                (
                    f"`{name}`",
                    f"`{model}`",
                    f"{1e3 * whole.cost:.3g}",
                    *map(_error, (p.median, p.p95, p.p99, f.median, f.p99, n.p99)),
                )
            )
    promises = "; ".join(
        f"`{name}` {peak:g} of the peak and {force:g} of the forces in full sliding, "
        + (f"{rolling:g} of them with elements" if rolling else "twice the elements of `standard`")
        for name, (peak, force, rolling) in PROMISES.items()
    )
    heads = (
        "preset",
        "model",
        "ms a case",
        "peak: median",
        "95 %",
        "99 %",
        "friction force: median",
        "99 %",
        "life: 99 %",
    )
    words = (
        "A preset is a promise, kept in 99 % of the designs measured (95 % with elements) by the cheapest rung of "
        f"each ladder, or the finest where none keeps it: {promises}. Measured, CPU time of complete "
        "cases:"
    )
    return [("p", words), ("table", (heads, rows))]


def _ladder_blocks(ladders: dict[str, list[Record]]) -> list[Block]:
    out: list[Block] = []
    for name, rungs in ladders.items():
        quantities = list(rungs[0]["errors"]) if rungs else []
        quantities = [q for q in quantities if q not in ("semi_axes", "max_pressure")]
        heads = ("setting", "ms a case", *(f"{QUANTITIES[q][1]}: median, bound" for q in quantities))
        rows = [
            (
                " ".join(str(v) for v in _flat(rung["settings"].values())),
                f"{1e3 * rung['cost']:.3g}",
                *(f"{_error(rung['errors'][q][0])}, {_error(rung['errors'][q][3])}" for q in quantities),
            )
            for rung in rungs
        ]
        out += [("h3", LADDER_NAMES[name].replace("`", "").capitalize()), ("table", (heads, rows))]
    return out


def _flat(values: Iterable[Any]) -> list[Any]:
    return [v for value in values for v in (value if isinstance(value, list) else [value])]


def _stage_table(records: list[Record]) -> Block:
    rows = []
    for r in records:
        if r["stage"] in ("ellipse alone", "ellipse", "tractions", "stress") or r["method"].startswith("grid"):
            for q, e in r["errors"].items():
                other = f"{100 * r['other'] / r['designs']:.0f} %" if r["other"] else "-"
                rows.append(
                    (
                        r["stage"],
                        r["method"],
                        r["label"],
                        QUANTITIES[q][1],
                        _error(e[0]),
                        _error(e[1]),
                        _error(e[2]),
                        other,
                        f"{1e3 * r['cost']:.2g}",
                    )
                )
    heads = ("stage", "method", "points", "quantity", "median", "95 %", "99 %", "no answer", "ms")
    return "table", (heads, rows)


def _life_words(life: dict[str, float]) -> str:
    words = (
        "A relative error e of the peak is an error of k e in life, with the exponent k of the S-N curve "
        "(`life_error_estimate` states it for each case). "
    )
    if life:
        words += (
            f"Measured ratio of the two errors: median {life['median']:g}, 90 % of the designs between "
            f"{life['low']:g} and {life['high']:g}; k is 9.0 for the metals and 5.2 for PA6."
        )
    return words


def _paper_blocks(rows: list[Record]) -> list[Block]:
    def value(v: float | None) -> str:
        return "-" if v is None else f"{v:.1f}"

    table = [
        (
            r["what"],
            r["discretisation"],
            "-" if r["seconds"] is None else f"{r['seconds']:.3g}",
            value(r["inner"]),
            value(r["peak"]),
        )
        for r in rows
    ]
    words = (
        "The paper's case (mu = 0.3, free rolling, curve radius 220 mm), contact 1, roller. The printed search "
        "begins below the surface and so finds the inner maximum; the true one lies on the surface. The paper's "
        "times are wall clock on its own machine, ours CPU time of a whole case (both contacts and bodies), for "
        "its search with our kernels of one peak only."
    )
    heads = ("setting", "points", "time [s]", "below the surface [MPa]", "with the surface [MPa]")
    return [("p", words), ("table", (heads, table))]


def _error(value: float | None) -> str:
    if value is None:
        return "no answer"
    return "< 1e-15" if value < 1e-15 else f"{rounded_up(value):.1e}"


def write_results(tradeoff_nc: str, summary_json: str, figures: str, page: str) -> None:
    """Summary, figures and report from the gathered measurement."""

    ds = xr.load_dataset(tradeoff_nc)
    found = summary(ds)
    text = json.dumps(found, indent=1, ensure_ascii=False) + "\n"
    write_whole(Path(summary_json), lambda beside: beside.write_text(text, encoding="utf-8"))
    infos = [vars(info) for info in draw_all(found, ds, Path(figures))]
    whole = page_html(blocks(found, infos), Path(figures), "What accuracy costs")
    write_whole(Path(page), lambda beside: beside.write_text(whole, encoding="utf-8"))
