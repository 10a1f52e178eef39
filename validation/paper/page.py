"""The page on the published example: each table and figure of the paper beside ours, and where its numbers hold."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from trackroller.files import write_whole
from trackroller.parameters import PARAMETERS
from validation.pages import Block, page_html
from validation.paper.compute import reference, results
from validation.paper.figures import draw_all

EXPONENT = 8.966  # k = ln(N_k/N_Rm)/ln(R_m/sigma_D) of 1.7225: N is proportional to stress^-k
ROWS = (
    ("normal_force", "F_N [N]", 2),
    ("lateral_force", "F_T [N]", 2),
    ("driving_force", "F_A [N]", 2),
    ("spin_moment", "M_R [N mm]", 3),
    ("max_pressure", "p_max [MPa]", 1),
    ("rolling_radius_shift", "r_Delta0 [mm]", 5),
)


def _pair(value: Any, digits: int) -> str:
    values = value if isinstance(value, list) else [value]
    return " / ".join(f"{v:.{digits}f}" for v in values)


def life_factor(high: float, low: float) -> float:
    """Return the life at the stress `low` over the life at the stress `high`."""
    return (high / low) ** EXPONENT


def _longer(high: float, low: float) -> str:
    factor = life_factor(high, low)
    return f"{factor:.2f} times shorter" if factor > 1 else f"{1 / factor:.2f} times longer"


def blocks(found: dict[str, Any], figures: Sequence[dict[str, str]]) -> list[Block]:
    """Return the page from `paper.results` and the figures drawn."""
    by_number: dict[str, list[dict[str, str]]] = {}
    for f in figures:
        by_number.setdefault(f["name"].split("_")[1], []).append(f)

    def pictures(number: str) -> list[Block]:
        return [("figure", f) for f in by_number.get(number, [])]

    return [
        ("h1", "The published example, computed anew"),
        (
            "p",
            "Wenzel, Bienefeld, Kretschmer and Kirchner published the model and a program for it (*Applied "
            "Mechanics* 2022, 3, 692-704, CC BY 4.0). This page computes every table and figure of that paper that a "
            "computation can give, and shows it beside the numbers of the paper, of its program and of CONTACT. "
            "`snakemake -s validation/Snakefile --cores all paper` makes this page.",
        ),
        (
            "p",
            "The published model is `contact_model: sliding`; with `hertz: published`, `stress_bodies: published` it "
            "also repeats the published table of ellipses and the published single body (columns *`sliding`, its "
            "options*). The default of this software is `kalker`. Each column and picture names its model.",
        ),
        ("h2", "Where the published numbers hold, and where they do not"),
        *verdict(found),
        ("h2", "Table 1: the case"),
        _case_table(),
        (
            "p",
            "Scenes: nearly frictionless and free (μ = 0.0001), free with μ = 0.3, driven with 30 N and μ = 0.3. The "
            "text of section 4 prints F_Motor = 30 N, its figures -30 N; negative drives.",
        ),
        *_force_tables(found),
        ("h2", "Table 2: discretisation, duration, accuracy"),
        *_table_2(found),
        ("h2", "Figure 6: overview of the driven case"),
        *pictures("6"),
        ("h2", "Figure 7: without and with friction, free rolling"),
        *pictures("7"),
        ("h2", "Figure 8: forces and stresses against CONTACT"),
        *pictures("8"),
        ("h2", "Figure 9: tractions of contact 1"),
        *pictures("9"),
        ("h2", "Figure 10: shear and friction energy"),
        *pictures("10"),
        ("h2", "Figure 11: equivalent stress of contact 1"),
        *pictures("11"),
    ]


def verdict(found: dict[str, Any]) -> list[Block]:
    """Return a table and a paragraph on which published numbers hold and what the others mean for life."""
    known, ours = reference(), found["ours"]
    free, driven = known["published_program"]["free"]["published"], ours["driven"]
    peaks = [max(c) for c in ours["free"]["sliding"]["peak_stress"]]
    factors = [life_factor(p, q) for p, q in zip(peaks, free["peak_stress"], strict=True)]
    contact = known["contact"]["driven"]
    off = [100 * (s / c - 1) for s, c in zip(driven["sliding"]["lateral_force"], contact["lateral_force"], strict=True)]
    swapped, mine = known["limits"]["axes swapped"]["published"], found["limits"]["axes swapped"]
    heavy, own = known["limits"]["axes swapped, heavier"]["published"], found["limits"]["axes swapped, heavier"]
    spin = [100 * (p / q - 1) for p, q in zip(swapped["spin_moment"], mine["spin_moment"], strict=True)]
    heavier = max(max(own["peak_stress"])) / max(heavy["peak_stress"])
    local = sum(driven["sliding"]["friction_energy_per_distance"])
    balance = sum(driven["sliding"]["friction_energy_balance"])
    exact = sum(driven["kalker"]["friction_energy_per_distance"])
    rows = [
        ("Forces of the equations of `sliding`", "hold to 0.1 %", "only quadrature and Hertz table differ", "none"),
        (
            "Stress below the surface",
            "holds to 0.3 %",
            f"`sliding` gives {_pair(found['inner']['free'], 1)} MPa at the printed places, the paper prints "
            f"{_pair(free['peak_stress'], 1)} MPa",
            _longer(found["inner"]["free"][0], free["peak_stress"][0]),
        ),
        (
            "Peak stress with friction",
            "does not hold",
            f"the maxima of `sliding` lie on the surface: {_pair(peaks, 1)} MPa against "
            f"{_pair(free['peak_stress'], 1)} MPa (free); the published search begins 1.5 grid steps below the surface",
            f"{_pair(factors, 2)} times shorter",
        ),
        (
            "Table of Hertz coefficients",
            "holds for round patches only",
            "linear interpolation makes p_max 0.2 % low at cos τ 0.4, 2.7 % at 0.85, 11 % at 0.97, 19 % at 0.998",
            f"{life_factor(1.027, 1):.2f} / {life_factor(1.11, 1):.1f} / {life_factor(1.19, 1):.1f} times shorter",
        ),
        (
            "Nearly circular patches",
            "stops",
            "the published table begins at cos τ = 0.1; a design with 0.023 has "
            f"a = {found['limits']['nearly circular']['semi_axis_lateral'][0]:.4f} mm, "
            f"b = {found['limits']['nearly circular']['semi_axis_rolling'][0]:.4f} mm",
            "-",
        ),
        (
            "Grooves wider than the rolling curvature (k_x > k_y)",
            "does not hold",
            f"the published ellipse is turned by 90°: spin moments are {_pair(spin, 0)} % too large in one random "
            f"design, the peak of another is {100 * (heavier - 1):.0f} % too low (both against `sliding`)",
            f"{life_factor(heavier, 1):.1f} times shorter",
        ),
        (
            "Lateral forces and moments of `sliding`",
            "hold for large spin and little drive only",
            f"F_T {_pair(off, 0)} % off CONTACT in the driven case; see [contact-models.md](contact-models.md)",
            _longer(*(max(map(max, driven[model]["peak_stress"])) for model in ("kalker", "sliding"))),
        ),
        (
            "Friction energy of `sliding`",
            "does not hold",
            f"the product of shear and slip is {local:.3f} J/m, but the forces put in only {balance:.3f} J/m; `kalker` "
            f"gives {exact:.3f} J/m and CONTACT {sum(contact['friction_power_per_speed']):.3f} J/m, both balanced",
            "wear, not fatigue",
        ),
        (
            "Life of the guide in hours",
            "does not hold",
            "the published life divides by the length of the curve: it is infinite on a straight guide and negative "
            "in an inner curve; here overrollings per hour are an input",
            "-",
        ),
        ("μ = 0, full slip, lift-off", "stops", "here such a case is a row with its regime", "-"),
    ]
    return [
        ("table", (("published", "verdict", "size", "effect on life"), rows)),
        (
            "p",
            f"The life of 1.7225 is proportional to the stress to the power -{EXPONENT:.2f}. *Effect on life* compares "
            "the life of the contact with the life that the published number gives.",
        ),
    ]


def _case_table() -> Block:
    rows = [(f"`{p.name}`", p.symbol, f"{p.default:g}", p.unit) for p in PARAMETERS.values() if p.default == p.default]
    return "table", (("name", "symbol", "value", "unit"), rows)


def _force_tables(found: dict[str, Any]) -> list[Block]:
    known, out = reference(), []
    for scene, told in (("frictionless", "Free, μ = 0.0001"), ("free", "Free, μ = 0.3"), ("driven", "Driven, μ = 0.3")):
        printed = known["published_program"][scene]["published"]
        contact = known["contact"].get(scene)
        heads = (
            "contact 1 / 2",
            "published program",
            "`sliding`, its options",
            "`sliding`",
            "`kalker`",
            "CONTACT",
        )
        rows = []
        for name, label, digits in ROWS:
            rows.append(
                (
                    label,
                    _pair(printed[name], digits),
                    _pair(found["as_published"][scene][name], digits),
                    *(_pair(found["ours"][scene][m][name], digits) for m in ("sliding", "kalker")),
                    _pair(contact[name], digits) if contact else "-",
                )
            )
        peak = "peak_stress"
        top = lambda v: [max(c) for c in v]  # noqa: E731
        rows.append(
            (
                "σ_DEH,max [MPa]",
                _pair(printed[peak], 1),
                _pair(top(found["as_published"][scene][peak]), 1),
                *(_pair(top(found["ours"][scene][m][peak]), 1) for m in ("sliding", "kalker")),
                _pair(top(contact[peak]), 1) if contact else "-",
            )
        )
        life = [min(c) for c in found["ours"][scene]["sliding"]["life_cycles"]]
        exact = [min(c) for c in found["ours"][scene]["kalker"]["life_cycles"]]
        rows.append(
            (
                "overrollings to failure",
                f"{printed['roller_life_cycles']:.3g} (worse contact)",
                "-",
                " / ".join(f"{v:.3g}" for v in life),
                " / ".join(f"{v:.3g}" for v in exact),
                "-",
            )
        )
        out += [("h3", told), ("table", (heads, rows))]
    out.append(
        (
            "p",
            "*Its options* are `hertz: published` and `stress_bodies: published`. CONTACT is the open-source release "
            "2025; its numbers were not computed here. They come from 60x60 and 40x40 elements, extrapolated; its "
            "peaks on the surface are exact to about 1 %. A peak is the larger one of both bodies.",
        )
    )
    return out


def _table_2(found: dict[str, Any]) -> list[Block]:
    known, one = reference()["table_2"], found["accuracy"]["standard"]["seconds"]
    rows = [
        (
            f"paper, {name}",
            f"{entry['surface_points']} points",
            f"printed: {entry['minutes']:g} min",
            f"{entry['peak_stress']:.1f} (below the surface)",
        )
        for name, entry in known.items()
    ]
    rows += [
        (
            f"`sliding`, `{name}`",
            "see [accuracy.md](accuracy.md)",
            f"{entry['seconds'] / one:.2g} times `standard`",
            f"{max(entry['peak_stress'][0]):.1f} (on the surface)",
        )
        for name, entry in found["accuracy"].items()
    ]
    rows.append(
        ("`sliding`, at the published place", "48 plane waves and rays", "-", f"{found['inner']['free'][0]:.1f}")
    )
    return [
        ("table", (("setting", "discretisation", "time", "σ_DEH,max of contact 1 [MPa]"), rows)),
        (
            "p",
            "Free rolling, μ = 0.3. Our times are processor times of a complete case (both contacts and bodies, with "
            "life) over that of `sliding` at `standard`, from one run. The printed durations hold for the authors' "
            "machine and were not measured here. More in [tradeoff.md](tradeoff.md).",
        ),
    ]


def write_results(folder: Path) -> None:
    """Write `paper.json`, `figures/` and `paper.html` into `folder`, each whole or not at all."""

    found = results()
    text = json.dumps(found, indent=1) + "\n"
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / "paper.json", lambda beside: beside.write_text(text, encoding="utf-8"))
    infos = [vars(info) for info in draw_all(folder / "figures")]
    page = page_html(blocks(found, infos), folder / "figures", "The published example, computed anew")
    write_whole(folder / "paper.html", lambda beside: beside.write_text(page, encoding="utf-8"))
