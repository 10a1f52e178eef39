"""The extremes in words and tables, as a page of the documentation (Markdown) and as one HTML file."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from validation.pages import Block, page_html

Record = dict[str, Any]
NOTES = (
    "A case without a solution is a row with `regime` failed or lift_off and NaN, never an exception or a warning.",
    "With friction a contact lifts at an axial force below |F_rad| tan(alpha); beyond self-locking, "
    "mu f = tan(alpha), the solution that grows out of the frictionless wedge has shed a contact: `lift_off`.",
    "A contact counts as lifted off when it carries no more than 1e-8 of |F_rad| + |F_ax|, in every regime and contact "
    "model; the regime flips there once. Within 3e-8 of the exact border it is therefore lift_off (alpha = 30 deg).",
    "No axial force beyond self-locking: the even balance is a solution, but an unstable one, for the lateral friction "
    "turns with the load; the slightest axial force sheds a contact, to its own side. Both are told as they are "
    "(rolling, lift_off), and both carry the bit `jamming`: it marks rolling rows with |F_T| >= F_N tan(alpha) and "
    "lifted rows where this would hold without axial force.",
    "Braking ends in full slip without a jump (r_Delta0 -> inf). Driving ends where the roller spins on the spot "
    "(r_Delta0 = -r_A); there the drilling still adds to the torque, and full slip, defined without it, begins with a "
    "jump. Measured at a/r_A = 0.02 (0.1): limit over mu sum F_N 1 + 4e-6 (8e-5), transmitted force 4e-6 (9e-5), peak "
    "stress 3e-8 (3e-7), spin moment 6e-4 (3e-3) of mu F_N a; normal and lateral forces do not jump.",
    "Where the spin pole enters the patch the lateral force of `sliding` grows as the square root of the way in (its "
    "pole runs along the ellipse), and the normal forces with it. Driven, the torque therefore folds there: within "
    "4e-6 of one motor force stand two slips, about 1e-5 apart, and the slip jumps so far. `kalker` and "
    "`fastsim` showed no fold.",
    "Patches a hundred times larger than the rolling radius (bit `half_space`): the drilling torque outweighs the "
    "transmitted force, whose digits a small imbalance no longer tells. There `residual` is no less than the "
    "uncertainty of the transmitted force over mu sum F_N, and `converged` says no above 1e-10: 5 % of the rolling "
    "random extremes. In other units the force changed by no more than 7e-8 of mu sum F_N in 6000 random extremes, and "
    "where by more than 1e-9, by no more than a few times what the residual said.",
    "Where a patch reaches beyond the equator of the guide contour the slip is constant there (an assumption), the "
    "torque jumps, and a balance inside the jump has no solution: failed.",
    "A life beyond the largest number of a computer is inf; the S-N curve has no end.",
    "`fastsim` ends at an ellipticity of 50, `kalker` where its elements get too slender (about 1000): failed beyond.",
    "Very slender patches with the spin pole inside (a/b above 50): the search may miss a ridge of up to 5 % of the "
    "peak; the estimate owns it, `reference` finds it.",
)
KERNEL_WORDS = (
    "*In single precision*: the worst error of the closed formula behind the kernel evaluated with 32-bit numbers at "
    "the same places. 1 means that no digit is left: these formulas cannot be had in single precision, and in double "
    "keep what the columns before say (the axis ratio and the stresses by formulas without their cancellation)."
)
RANDOM_WORDS = (
    "Log-uniform over all parameters at once (loads 1 mN to 1 MN, moduli 1 kPa to 300 GPa, contours 1 µm to 10 m, "
    "contact angles 0.01 to 89.99 deg, mu 1e-12 to 2), most of them far from anything that can be built. *failed, "
    "small patch*: without solution though the patch is small against all radii."
)


def blocks(record: Record, figures: Sequence[dict[str, str]]) -> list[Block]:
    """Return the page as headings, paragraphs, tables and figures."""
    scenes, broken = _scenes(record), _broken(record)
    claims = [f["holds"] for row in record["scenes"] for f in row["findings"]]
    return [
        ("h1", "At the ends of the parameters"),
        (
            "p",
            f"{sum(claims)} of {len(claims)} claims on {len(scenes)} edge scenes hold. A scene is a series of cases "
            "that runs to an end of the parameters; the claims are: finite or flagged, solved, small residual, the "
            "same in other units, the same in a mirror, well conditioned, monotone where physics says so, continuous "
            "across borders of regimes and towards limits, and peaks within the estimated error. "
            "`snakemake -s validation/Snakefile --cores all extremes` makes this page.",
        ),
        *[("figure", f) for f in figures],
        ("h2", "Claims not met"),
        ("table", (("scene", "model", "check", "deviation", "tolerated", "where"), broken))
        if broken
        else ("p", "None."),
        ("h2", "The scenes"),
        ("table", (("scene", "what", "from, to", "models"), scenes)),
        ("h2", "Kernels against many digits"),
        ("p", KERNEL_WORDS),
        (
            "table",
            (
                ("kernel", "from", "to", "against", "worst relative error", "tolerated", "in single precision"),
                [_kernel(k) for k in record["kernels"]],
            ),
        ),
        ("h2", "Random extremes"),
        ("p", RANDOM_WORDS),
        (
            "table",
            (
                (
                    "model",
                    "cases",
                    "regimes",
                    "undefined numbers",
                    "warnings",
                    "failed, small patch",
                    "other regime in other units",
                    "change of normal forces in other units",
                ),
                [_random(r) for r in record["random"]],
            ),
        ),
        ("h2", "To know"),
        ("list", NOTES),
    ]


def _broken(record: Record) -> list[tuple[str, ...]]:
    """Return the claims that do not hold."""
    return [
        (
            row["scene"],
            row["model"],
            f["check"],
            f"{float(f['deviation']):.2g}",
            f"{f['tolerance']:.2g}",
            f"{row['quantity']} = {float(f['where']):g}",
        )
        for row in record["scenes"]
        for f in row["findings"]
        if not f["holds"]
    ]


def _scenes(record: Record) -> list[tuple[str, ...]]:
    """Return each scene once, with the models that run it."""
    runs: dict[str, list[Record]] = {}
    for row in record["scenes"]:
        runs.setdefault(row["scene"], []).append(row)
    found: list[tuple[str, ...]] = []
    for name, rows in runs.items():
        row, models = rows[0], ", ".join(r["model"] for r in rows)
        first, last = float(row["values"][0]), float(row["values"][-1])
        unit = row["unit"] if row["unit"] != "1" else ""
        found.append((name, row["title"], f"{row['quantity']} = {first:g} ... {last:g} {unit}".strip(), models))
    return found


def _kernel(k: dict[str, Any]) -> tuple[str, ...]:
    low = "" if k["single"] is None else f"{k['single']:.0e}"
    return (
        k["name"],
        f"{k['quantity']} = {k['values'][0]:g}",
        f"{k['values'][-1]:g}",
        k["against"],
        f"{max(k['errors']):.1e}",
        f"{k['tolerance']:g}",
        low,
    )


def _random(r: dict[str, Any]) -> tuple[Any, ...]:
    regimes = ", ".join(f"{n} {name}" for name, n in r["regimes"].items())
    return (
        r["model"],
        r["count"],
        regimes,
        r["undefined"],
        r["warnings"],
        r["failed_small_patch"],
        r["other_regime"],
        f"{r['scaling']:.1e}",
    )


def html(record: Record, figures: Sequence[dict[str, str]], folder: Path) -> str:
    """Return one HTML file that holds its figures and can be sent by mail."""
    return page_html(blocks(record, figures), folder, "Track rollers: at the ends of the parameters")


def read(path: Path, figures: bool = True) -> tuple[Record, list[dict[str, str]]]:
    """Record and captions in a folder of results."""
    record = json.loads((path / "extremes.json").read_text(encoding="utf-8"))
    infos = json.loads((path / "figures" / "index.json").read_text(encoding="utf-8")) if figures else []
    return record, infos
