"""The trade-off in words and tables, as a page of the documentation (Markdown) and as one HTML file."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from trackroller.contact.kalker import correction
from trackroller.errors import InputError
from trackroller.files import write_whole
from trackroller.roller.accuracy import (
    ELEMENTS,
    GRID_ELEMENTS,
    PROMISES,
    accuracy_settings,
    preset_rungs,
    read_ladders,
    rounded_up,
)
from trackroller.roller.stages import ellipse_stresses
from validation.pages import Block, page_html
from validation.tradeoff.errors import QUANTITIES
from validation.tradeoff.figures import draw_all
from validation.tradeoff.summary import summary, yardstick

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
            "This page shows the error of each stage and of each contact model, and its processor time, for many "
            "settings of the discretisation. An error is taken against a converged solution of the same contact model. "
            "`snakemake -s validation/Snakefile --cores all tradeoff` measures again. "
            "`python -m validation.adopt.tradeoff` takes the result over into this page and into the list of settings "
            "(`accuracy.json`) that `accuracy` chooses from.",
        ),
        (
            "p",
            "All times are ratios of processor times from one measurement. The yardstick is a complete case (forces, "
            "contact, peaks, life) of `sliding` with the peak search of `standard`.",
        ),
        (
            "p",
            f"The sample is a scrambled Sobol sequence (seed {sample['seed']}) of designs that roll or slide on both "
            f"contacts: {counts}. Its ranges are wider than those of built rollers: loads over three decades, contact "
            "angles from 10 to 80°, friction from 0 to 1, narrow to flat grooves and convex rollers, straight, outer "
            "and inner curves, driven, free and braked rollers, Young's modulus 2 to 250 GPa, Poisson's ratio 0 to "
            "0.5. Designs with the validity bits `conformal` and `split_pole` are left out: there the stress of "
            "`sliding` is logarithmically infinite, so no error can be stated.",
        ),
        (
            "p",
            "The error of a design is the largest over both contacts and both bodies. The reference has far finer "
            "settings. Its peak is the highest of several searches, because a search can only find too little. Errors "
            "of one contact model against another stand in [contact-models.md](contact-models.md).",
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
            "The tables hold the settings that no other setting beats in both time and error. 99 % of all cases lie "
            "below *bound* with 95 % confidence (order statistic). A sample of less than 299 designs does not "
            "support this statement: there *bound* is 1.5 times the 95th percentile. A search for the peak is given "
            "as `scan climb polish summit seeds finalists step floor`.",
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
            "An order is the slope of the median error over the number of points in logarithms, by least squares. "
            "Orders above about 4 mean convergence faster than any power. Points at the rounding error are left out.",
        ),
        ("h2", "Single stages"),
        _stage_table(summary),
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
        "`accuracy=1e-3` takes the cheapest setting whose bound keeps the tolerance for all requested quantities: F_N, "
        "friction work and peak stress relative to themselves, F_T and F_A relative to μ F_N, M_R relative to "
        "μ F_N √(ab). A tolerance that no setting keeps is refused, and the message states the smallest possible one. "
        "`python -m validation.benchmarks.tolerance` checks the tolerances on a new sample of `sliding`."
    )
    return [("p", words), ("table", (("tolerance", "`sliding`", "`fastsim`", "`kalker`"), rows))]


def _reached(refusal: InputError) -> str:
    hit = re.search(r"reaches here is ([\d.e-]+)", str(refusal))
    return f"reaches {hit[1]}" if hit else "out of reach"


def _preset_blocks(summary: dict[str, Any]) -> list[Block]:
    measured, rows, one = read_ladders(summary["ladders"]), [], yardstick(summary["ladders"])
    for name in summary["presets"]:
        forces, peak = preset_rungs(name, measured)
        pairs = {"sliding": (peak, forces)}
        for model in ("fastsim", "kalker"):
            own = [r for r in measured[model] if r.settings == summary["presets"][name][model]]
            pairs |= {model: (own[0], own[0])} if own else {}
        for model, (whole, part) in pairs.items():
            p, f, n = whole.errors["peak_stress"], part.errors["friction_force"], whole.errors["life"]
            rows.append(
                (
                    f"`{name}`",
                    f"`{model}`",
                    f"{whole.cost / one:.2g}",
                    *map(_error, (p.median, p.p95, p.p99, f.median, f.p99, n.p99)),
                )
            )
    promises = ". ".join(
        f"`{name}` allows {peak:g} of the peak and {force:g} of the forces, with {ELEMENTS[name]} elements in `kalker` "
        f"and {GRID_ELEMENTS[name]} in `fastsim`"
        for name, (peak, force) in PROMISES.items()
    )
    limits = ", ".join(
        f"at `{name}` {100 * ellipse_stresses.refined_above(ELEMENTS[name]):.2g} % of the peak or "
        f"{100 * correction.refined_above(ELEMENTS[name]):.2g} % of mu F_N in the friction force"
        for name in ("standard", "reference")
    )
    promises += (
        f". `kalker` solves a patch again on twice the elements where the estimated error exceeds a limit: {limits}"
    )
    heads = (
        "preset",
        "model",
        "time over yardstick",
        "peak: median",
        "95 %",
        "99 %",
        "friction force: median",
        "99 %",
        "life: 99 %",
    )
    words = (
        "In `sliding` a preset takes the cheapest setting that keeps a tolerance in 99 % of the measured designs, or "
        f"the finest setting if none does. {promises}. Measured on complete cases, where these elements were measured:"
    )
    return [("p", words), ("table", (heads, rows))]


def _ladder_blocks(ladders: dict[str, list[Record]]) -> list[Block]:
    out: list[Block] = []
    one = yardstick(ladders)
    for name, rungs in ladders.items():
        quantities = list(rungs[0]["errors"]) if rungs else []
        quantities = [q for q in quantities if q not in ("semi_axes", "max_pressure")]
        heads = ("setting", "time over yardstick", *(f"{QUANTITIES[q][1]}: median, bound" for q in quantities))
        rows = [
            (
                " ".join(str(v) for v in _flat(rung["settings"].values())),
                f"{rung['cost'] / one:.2g}",
                *(f"{_error(rung['errors'][q][0])}, {_error(rung['errors'][q][3])}" for q in quantities),
            )
            for rung in rungs
        ]
        out += [("h3", LADDER_NAMES[name].replace("`", "").capitalize()), ("table", (heads, rows))]
    return out


def _flat(values: Iterable[Any]) -> list[Any]:
    return [v for value in values for v in (value if isinstance(value, list) else [value])]


def _stage_table(summary: Record) -> Block:
    rows, one = [], yardstick(summary["ladders"])
    for r in summary["settings"]:
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
                        f"{r['cost'] / one:.2g}",
                    )
                )
    heads = ("stage", "method", "points", "quantity", "median", "95 %", "99 %", "no answer", "time over yardstick")
    return "table", (heads, rows)


def _life_words(life: dict[str, float]) -> str:
    words = (
        "A relative error e of the peak is an error of k e in life, with the exponent k of the S-N curve "
        "(`life_error_estimate` states it for each case). "
    )
    if life:
        words += (
            f"The measured ratio of both errors is {life['median']:g} in the median; 90 % of the designs lie between "
            f"{life['low']:g} and {life['high']:g}. The exponent k is 9.0 for the metals and 5.2 for PA6."
        )
    return words


def _paper_blocks(rows: list[Record]) -> list[Block]:
    def value(v: float | None) -> str:
        return "-" if v is None else f"{v:.1f}"

    one = next(r["seconds"] for r in rows if r["what"] == "`standard`")

    table = [
        (
            r["what"],
            r["discretisation"],
            _duration(r, one),
            value(r["inner"]),
            value(r["peak"]),
        )
        for r in rows
    ]
    words = (
        "The paper's case with `sliding` (μ = 0.3, free rolling, curve radius 220 mm), contact 1, roller. The search "
        "of the paper begins below the surface and finds the inner maximum. The true maximum lies on the surface. "
        "Times are processor times of a complete case over that of the row `standard`, from one run; for the search "
        "of the paper with our kernels, of one peak. The paper's times were not measured here: they are the printed "
        "ones, of its own machine."
    )
    heads = ("setting", "points", "time over `standard`", "below the surface [MPa]", "with the surface [MPa]")
    return [("p", words), ("table", (heads, table))]


def _duration(row: Record, one: float) -> str:
    """Return the time of a row over the yardstick; the paper's own times stay as they are printed."""
    if row["seconds"] is None:
        return "-"
    if row["what"].startswith("paper"):
        return f"printed: {row['seconds'] / 60:.0f} min"
    return f"{row['seconds'] / one:.2g}"


def _error(value: float | None) -> str:
    if value is None:
        return "no answer"
    return "< 1e-15" if value < 1e-15 else f"{rounded_up(value):.1e}"


def write_results(tradeoff_nc: str, summary_json: str, figures: str, page: str) -> None:
    """Write summary, figures and report from the gathered measurement."""

    ds = xr.load_dataset(tradeoff_nc)
    found = summary(ds)
    text = json.dumps(found, indent=1, ensure_ascii=False) + "\n"
    write_whole(Path(summary_json), lambda beside: beside.write_text(text, encoding="utf-8"))
    infos = [vars(info) for info in draw_all(found, ds, Path(figures))]
    whole = page_html(blocks(found, infos), Path(figures), "What accuracy costs")
    write_whole(Path(page), lambda beside: beside.write_text(whole, encoding="utf-8"))
