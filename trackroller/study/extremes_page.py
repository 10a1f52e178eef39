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
    "Braking ends in full slip without a jump. Driving ends where the roller spins on the spot (r_Delta0 = -r_A); "
    "there the lateral force still is of the order of patch over rolling radius, and drops to 0 in full slip.",
    "Patches larger than the rolling radius (bit `half_space`) make the slip ill-conditioned: below r_A/a = 1e-4 the "
    "transmitted force of a solution has few right digits, though its residual is small.",
    "Where a patch reaches beyond the equator of the guide contour the slip is constant there (an assumption), the "
    "torque jumps, and a balance inside the jump has no solution: failed.",
    "A life beyond the largest number of a computer is inf; the Woehler line has no end.",
    "`fastsim` ends at an ellipticity of 50, `kalker` where its elements get too slender (about 1000): failed beyond.",
    "Very slender patches with the spin pole inside (a/b above 50): the search may miss a ridge of up to 5 % of the "
    "peak; the estimate owns it, `reference` finds it.",
)  # fmt: skip


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
    kernels = [k | {"worst": f"{max(k['errors']):.1e}", "from": f"{k['values'][0]:g}", "to": f"{k['values'][-1]:g}"}
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
    lines += ["## Kernels against 50 digits", ""]
    lines += _table(("kernel", "from", "to", "worst relative error", "tolerated"),
                    [(k["name"], f"{k['quantity']} = {k['from']}", k["to"], k["worst"], f"{k['tolerance']:g}")
                     for k in c["kernels"]])  # fmt: skip
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
