"""The extremes in words and tables: a page of the documentation (Markdown) and one HTML file with its figures."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

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
    "A life beyond the largest number of a computer is inf; the Woehler line has no end.",
    "`fastsim` ends at an ellipticity of 50, `kalker` where its elements get too slender (about 1000): failed beyond.",
    "Very slender patches with the spin pole inside (a/b above 50): the search may miss a ridge of up to 5 % of the "
    "peak; the estimate owns it, `reference` finds it.",
)  # fmt: skip
KERNEL_WORDS = (
    "*In single precision*: the worst error of the closed formula behind the kernel evaluated with 32-bit numbers at "
    "the same places. 1 means that no digit is left: these formulas cannot be had in single precision, and in double "
    "keep what the columns before say (the axis ratio and the stresses by formulas without their cancellation)."
)


def _rows(record: Record) -> list[dict[str, Any]]:
    broken = []
    for row in record["scenes"]:
        for f in row["findings"]:
            if not f["holds"]:
                broken.append({"scene": row["scene"], "model": row["model"], "check": f["check"],
                               "deviation": f"{float(f['deviation']):.2g}", "tolerance": f"{f['tolerance']:.2g}",
                               "where": f"{row['quantity']} = {float(f['where']):g}"})  # fmt: skip
    return broken


def content(record: Record, figures: list[dict[str, str]]) -> dict[str, Any]:
    """What both pages show."""
    claims = [f for row in record["scenes"] for f in row["findings"]]
    scenes: dict[str, Any] = {}
    for row in record["scenes"]:
        first, last = float(row["values"][0]), float(row["values"][-1])
        unit = row["unit"] if row["unit"] != "1" else ""
        new = {"name": row["scene"], "title": row["title"], "models": [],
               "range": f"{row['quantity']} = {first:g} ... {last:g} {unit}".strip()}  # fmt: skip
        scene = scenes.setdefault(row["scene"], new)
        scene["models"].append(row["model"])
    kernels = [k | {"low": "" if k["single"] is None else f"{k['single']:.0e}",
                    "worst": f"{max(k['errors']):.1e}", "from": f"{k['values'][0]:g}", "to": f"{k['values'][-1]:g}"}
               for k in record["kernels"]]  # fmt: skip
    random = [r | {"regimes": ", ".join(f"{n} {name}" for name, n in r["regimes"].items()),
                   "scaling": f"{r['scaling']:.1e}"} for r in record["random"]]  # fmt: skip
    return {"claims": len(claims), "held": sum(f["holds"] for f in claims), "broken": _rows(record),
            "scenes": list(scenes.values()), "kernels": kernels, "random": random, "figures": figures,
            "notes": NOTES}  # fmt: skip


def _table(heads: tuple[str, ...], rows: list[tuple[Any, ...]]) -> list[str]:
    line = lambda cells: "| " + " | ".join(str(c).replace("|", "\\|") for c in cells) + " |"  # noqa: E731
    return [line(heads), line(["---"] * len(heads)), *(line(r) for r in rows), ""]


def markdown(record: Record, figures: list[dict[str, str]], folder: str = "figures") -> str:
    """The page of the documentation."""
    c = content(record, figures)
    lines = ["# At the ends of the parameters", "",
             "*Made by `python docs/adopt_extremes.py` from what `snakemake --cores all extremes` found; do not edit.*",
             "", f"{c['held']} of {c['claims']} claims on {len(c['scenes'])} edge scenes hold. A scene is a series of "
             "cases that runs to an end of the parameters; the claims are: finite or flagged, solved, small residual, "
             "the same in other units, the same in a mirror, well conditioned, monotone where physics says so, "
             "continuous across borders of regimes and towards limits, and peaks within the estimated error.",
             ""]  # fmt: skip
    for figure in c["figures"]:
        lines += [f"![{figure['caption']}]({folder}/{figure['name']}.png)", "", f"*{figure['sentence']}*", ""]
    lines += ["## Claims not met", ""]
    lines += _table(("scene", "model", "check", "deviation", "tolerated", "where"),
                    [tuple(b.values()) for b in _ordered(c["broken"])]) if c["broken"] else ["None.", ""]  # fmt: skip
    lines += ["## The scenes", ""]
    lines += _table(("scene", "what", "from, to", "models"),
                    [(s["name"], s["title"], s["range"], ", ".join(s["models"])) for s in c["scenes"]])  # fmt: skip
    lines += ["## Kernels against many digits", ""]
    lines += [KERNEL_WORDS, ""]
    lines += _table(("kernel", "from", "to", "against", "worst relative error", "tolerated", "in single precision"),
                    [(k["name"], f"{k['quantity']} = {k['from']}", k["to"], k["against"], k["worst"],
                      f"{k['tolerance']:g}", k["low"]) for k in c["kernels"]])  # fmt: skip
    lines += ["## Random extremes", "",
              "Log-uniform over all parameters at once (loads 1 mN to 1 MN, moduli 1 kPa to 300 GPa, contours 1 µm to "
              "10 m, contact angles 0.01 to 89.99 deg, mu 1e-12 to 2), most of them far from anything that can be "
              "built. *failed, small patch*: without solution though the patch is small against all radii.",
              ""]  # fmt: skip
    lines += _table(("model", "cases", "regimes", "undefined numbers", "warnings", "failed, small patch",
                     "other regime in other units", "change of normal forces in other units"),
                    [(r["model"], r["count"], r["regimes"], r["undefined"], r["warnings"], r["failed_small_patch"],
                      r["other_regime"], r["scaling"]) for r in c["random"]])  # fmt: skip
    lines += ["## To know", "", *(f"- {note}" for note in NOTES), ""]
    return "\n".join(lines)


def _ordered(broken: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [{k: b[k] for k in ("scene", "model", "check", "deviation", "tolerance", "where")} for b in broken]


def html(record: Record, figures: list[dict[str, str]], folder: Path) -> str:
    """One file with its figures inside, that can be sent by mail."""
    from jinja2 import Environment, PackageLoader, select_autoescape

    def image(name: str) -> str:
        return "data:image/png;base64," + base64.b64encode((folder / f"{name}.png").read_bytes()).decode()

    shown = [f | {"image": image(f["name"])} for f in figures]
    environment = Environment(loader=PackageLoader("trackroller"), autoescape=select_autoescape(["html", "j2"]))
    return environment.get_template("extremes.html.j2").render(**content(record, shown))


def read(path: Path, figures: bool = True) -> tuple[Record, list[dict[str, str]]]:
    """Record and captions in a folder of results."""
    record = json.loads((path / "extremes.json").read_text(encoding="utf-8"))
    infos = json.loads((path / "figures" / "index.json").read_text(encoding="utf-8")) if figures else []
    return record, infos
