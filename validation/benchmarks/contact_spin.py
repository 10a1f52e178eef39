"""Where full sliding will do: its error against the exact theory over friction, drive, contact angle and size.

    python -m validation.benchmarks.contact_spin [--accuracy standard]   tables of docs/validation/contact-models.md

540 rollers on a straight guide: friction 0.02 to 0.5, contact angle 12 to 75 deg, axis distance 15 to 1000 mm, pressed
by 200 N, free, with 30 N of axial force, and driven by 6 N. Spin is phi rho (`report.comparison.pairs.spin`).
"""

from __future__ import annotations

import argparse
import itertools

import numpy as np
import xarray as xr

import trackroller as tr
from trackroller.report import comparison as ladder

FRICTIONS = (0.02, 0.05, 0.1, 0.2, 0.3, 0.5)
ANGLES = (12.0, 20.0, 30.0, 45.0, 60.0, 75.0)
DISTANCES = (15.0, 21.75, 60.0, 200.0, 1000.0)
LOADS = {"free": (0.0, 0.0), "free, 30 N axial": (30.0, 0.0), "driven by 6 N": (0.0, -6.0)}
LEANS = (0.0, 0.05, 0.1, 0.2, 0.5, 2.0)
OUTPUTS = ("forces", "contact", "friction_work", "peak_stress")
SPINS = (0.0, 0.2, 0.5, 10.0)


def solved(accuracy: str) -> xr.Dataset:
    """Solve all rollers with both models and gather them as a study does."""
    rows = list(itertools.product(FRICTIONS, ANGLES, DISTANCES, LOADS))
    inputs = {
        "friction_coefficient": [r[0] for r in rows],
        "contact_angle": [r[1] for r in rows],
        "axis_distance": [r[2] for r in rows],
        "axial_force": [LOADS[r[3]][0] for r in rows],
        "motor_force": [LOADS[r[3]][1] for r in rows],
    }
    cases = [
        tr.Case(radial_force=-200.0, guide_curve_radius=np.inf, **dict(zip(inputs, v, strict=True)))
        for v in zip(*inputs.values(), strict=True)
    ]
    parts = []
    for model in ("sliding", "kalker"):
        ds = tr.solve(cases, outputs=OUTPUTS, contact_model=model, accuracy=accuracy)
        labels: dict = {name: ("case", values) for name, values in inputs.items()}
        labels |= {"contact_model": ("case", [model] * len(rows)), "guide_curve_radius": np.inf}
        parts.append(ds.assign_coords(labels))
    return xr.concat(parts, "case", combine_attrs="drop_conflicts")


def cell(e: np.ndarray) -> str:
    """Share within 5 %, median and largest error."""
    e = e[~np.isnan(e)]
    if not e.size:
        return "-"
    return f"{100 * np.mean(e <= ladder.GOOD):.0f} % ({100 * np.median(e):.1f}, {100 * e.max():.0f})"


def table(title: str, heads: list[str], rows: list[tuple[str, list[str]]]) -> None:
    """Return a Markdown table."""
    print(f"\n{title}\n\n|  | {' | '.join(heads)} |\n|{'---|' * (len(heads) + 1)}")
    for name, cells in rows:
        print(f"| {name} | {' | '.join(cells)} |")


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--accuracy", default="standard")
    paired = ladder.pairs(solved(parser.parse_args().accuracy))
    found = ladder.errors(paired).sel(contact_model="sliding")
    mu, lean, spin = (paired[n].values for n in ("friction_coefficient", "lean", "spin"))
    pressed = {
        name: (paired["axial_force"] == a).values & (paired["motor_force"] == d).values
        for name, (a, d) in LOADS.items()
    }
    rows = [(str(name), [cell(e.values)]) for name, e in found.data_vars.items()]
    table("all rollers: within 5 % (median, largest error in %)", ["sliding"], rows)
    heads = [f"{a:g} to {b:g}" for a, b in itertools.pairwise(LEANS)]
    for quantity in ("normal_force", "peak_stress"):
        e = found[quantity].values
        rows = [
            (name, [cell(e[own & (lean >= a) & (lean < b)]) for a, b in itertools.pairwise(LEANS)])
            for name, own in pressed.items()
        ]
        table(f"{quantity} by mu tan(alpha): within 5 % (median, largest error in %)", heads, rows)
        rows = [
            (
                f"{m:g}",
                [
                    cell(e[(mu == m) & (spin >= a) & (spin < b) & (paired["contact_angle"].values <= 60)])
                    for a, b in itertools.pairwise(SPINS)
                ],
            )
            for m in FRICTIONS
        ]
        table(
            f"{quantity} by friction and spin phi rho, alpha to 60 deg",
            [f"{a:g} to {b:g}" for a, b in itertools.pairwise(SPINS)],
            rows,
        )


if __name__ == "__main__":
    main()
