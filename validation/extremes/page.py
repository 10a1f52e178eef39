"""The extremes in words and tables, as a page of the documentation (Markdown) and as one HTML file."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from validation.pages import Block, page_html

Record = dict[str, Any]
NOTES = (
    "A case without a solution is a row with `regime` failed or lift_off and NaN. It never raises an exception or a "
    "warning.",
    "With friction a contact lifts at an axial force below |F_rad| tan(α). Beyond self-locking (μ f = tan(α)) the "
    "solution that continues the frictionless one has lost a contact: `lift_off`.",
    "A contact counts as lifted off when it carries at most 1e-8 of |F_rad| + |F_ax|, in every regime and contact "
    "model. The regime changes there once.",
    "Beyond self-locking without axial force, equal normal forces are a solution, but an unstable one: the smallest "
    "axial force lifts a contact. Both results are shown as they are (rolling, lift_off), and both carry the bit "
    "`jamming`. The bit marks rolling rows with |F_T| >= F_N tan(α), and lifted rows that would be such rows without "
    "axial force.",
    "Braking ends in full slip without a jump (r_Δ0 → ∞); `kalker` says full slip from 2e-6 of the complete friction "
    "before this end, where its table ends. Driving ends where the roller spins on the spot "
    "(r_Δ0 = -r_A). There the spin moments still add to the torque, but full slip is defined without them. Therefore "
    "full slip begins with a small jump of spin moment, transmitted force and peak stress; normal and lateral forces "
    "do not jump.",
    "In `sliding` the lateral force grows as the square root of the distance by which the spin pole has entered the "
    "patch. In a driven roller two slips then belong to one motor force within a very narrow range, and the slip jumps "
    "there. `kalker` and `fastsim` showed no such fold.",
    "In patches that are a hundred times larger than the rolling radius (bit `half_space`) the spin moments are much "
    "larger than the transmitted force. There `residual` is at least the uncertainty of the transmitted force over "
    "μ ΣF_N, and `converged` is 0 above the limit of the model (attribute `converged_up_to`).",
    "Where a patch reaches beyond the equator of the guide contour, the slip is assumed constant. The torque jumps "
    "there, and a case whose balance lies inside the jump fails.",
    "A life beyond the largest floating-point number is inf, because the S-N curve has no end.",
    "`fastsim` fails beyond an axis ratio of 50, `kalker` where its elements get too slender (about 1000).",
    "In `sliding` with very slender patches and the spin pole inside (a/b above 50) the search at `standard` may miss "
    "a ridge of the peak. `error_estimate` includes this error, and `reference` finds the ridge.",
)
KERNEL_WORDS = (
    "*In single precision* is the worst error of the closed formula behind the kernel, evaluated with 32-bit numbers "
    "at the same places. A value of 1 means that no digit is correct."
)
RANDOM_WORDS = (
    "All parameters are drawn at once from log-uniform distributions: loads 1 mN to 1 MN, Young's moduli 1 kPa to "
    "300 GPa, contours 1 µm to 10 m, contact angles 0.01 to 89.99°, friction 1e-12 to 2. Most of these rollers cannot "
    "be built. *failed, small patch* counts cases without solution whose patch is small against all radii."
)


def blocks(record: Record, figures: Sequence[dict[str, str]]) -> list[Block]:
    """Return the page as headings, paragraphs, tables and figures."""
    scenes, broken = _scenes(record), _broken(record)
    settings = ", ".join(f"`{model}` at `{accuracy}`" for model, accuracy in record["accuracies"].items())
    claims = [f["holds"] for row in record["scenes"] for f in row["findings"]]
    return [
        ("h1", "At the ends of the parameters"),
        (
            "p",
            f"{sum(claims)} of {len(claims)} claims on {len(scenes)} edge scenes hold. A scene is a series of cases "
            "that runs to an end of the parameters. The claims are: results are finite or flagged, the case is "
            "solved, the residual is small, other units and a mirrored roller give the same result, the problem is "
            "well conditioned, results are monotone where physics demands it, they are continuous across borders of "
            "regimes and towards limits, and peaks lie within the estimated error. "
            f"Settings: {settings}. "
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
        ("h2", "Behaviour at the ends"),
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
