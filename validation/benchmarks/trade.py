"""Measure cost against tolerance of every contact model and quantity, and where in the space of designs it is high.

    python -m validation.benchmarks.trade [--cases N] [--seed S] [--repeats R]

The yardstick is a complete case (forces, contact, four peaks, life) in full sliding at accuracy `standard` on the same
random rollers; every cost is a processor time over it, from one run in which the settings take turns. Errors are those
of discretisation, the worst of both contacts and bodies, against finer settings of the same model: `kalker` and
`kalker_table` against the smallest tolerances of `kalker`. `python -m validation.adopt benchmarks` takes the costs over
into the package, where `plan` uses them.
"""

from __future__ import annotations

import os
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

os.environ["NUMBA_NUM_THREADS"] = "1"

import numpy as np

import trackroller as tr
from trackroller.errors import InputError
from trackroller.parameters import ACCURACIES
from trackroller.parameters.contact_models import DECLARED
from trackroller.report.figures import style
from trackroller.roller.accuracy import PRESETS, accuracy_settings
from trackroller.roller.dataset import validity_bit
from validation.benchmarks import falling_friction
from validation.benchmarks.command import run
from validation.benchmarks.samples import geometry_study, load_study, random_designs
from validation.tradeoff.errors import percentiles, relative_errors
from validation.tradeoff.measure import reference_solution
from validation.tradeoff.sample import SINGULAR

MODELS = ("sliding", "kalker_table", "kalker")
TOLERANCES = (0.1, 0.03, 0.01, 0.003)
FORCES, COMPLETE = ("forces", "contact"), ("forces", "contact", "friction_work", "peak_stress", "life")
TRUTH = replace(PRESETS["reference"], elements=120, grid_elements=120)
QUANTITIES = ("normal_force", "friction_force", "spin_moment", "friction_energy", "peak_stress", "life")
SAMPLES = {
    "loads, frictions and materials vary": load_study,
    "curvatures vary": geometry_study,
    "everything varies": random_designs,
}
STUDIES = ("preview", 0.03, 0.01, "standard")  # of the ordinary samples and of the parts of the space


def rolling(cases: list[tr.Case]) -> list[tr.Case]:
    """Return the designs that roll on both contacts and whose peak is finite in full sliding."""
    ds = tr.solve(cases, outputs=FORCES, contact_model="sliding")
    exact = tr.solve(cases, outputs="forces", contact_model="kalker_table")
    usable = (ds.regime.values == 0) & (exact.regime.values == 0) & (ds.validity.values & SINGULAR == 0)
    return [case for case, good in zip(cases, usable, strict=True) if good]


def settings() -> list[tuple[str, Any]]:
    """Return the contact models with the accuracies that they serve."""
    found = []
    for model in MODELS:
        for accuracy in (*ACCURACIES, *TOLERANCES):
            try:
                accuracy_settings(accuracy, model, COMPLETE)
            except InputError:
                continue
            found.append((model, accuracy))
    return found


def seconds(cases: list[tr.Case], repeats: int, asked: list[tuple[str, Any]], outputs: tuple[str, ...]) -> list[float]:
    """Return the processor time of a case [s] by setting, the least of `repeats`; the settings take turns."""
    spent = np.empty((repeats, len(asked)))
    for model, accuracy in asked:
        tr.solve(cases[:2], outputs=outputs, contact_model=model, accuracy=accuracy)  # compiled and loaded
    for turn in spent:
        for k, (model, accuracy) in enumerate(asked):
            start = time.process_time()
            tr.solve(cases, outputs=outputs, contact_model=model, accuracy=accuracy)
            turn[k] = time.process_time() - start
    return list(spent.min(axis=0) / max(len(cases), 1))


def _truth(cases: list[tr.Case], model: str) -> Any:
    """Return the best solution of a model; that of kalker resolves adhesion areas that are smaller than an element."""
    if model == "sliding":
        return reference_solution(cases, model, COMPLETE)[0]
    asked = {"forces": 1e-3, "peak": 3e-3} if model == "kalker" else TRUTH
    best = tr.solve(cases, outputs=COMPLETE, contact_model=model, accuracy=asked)
    return best.assign(friction=("case", [case.friction_coefficient for case in cases]))


def errors(cases: list[tr.Case], asked: list[tuple[str, Any]]) -> list[dict[str, Any]]:
    """Return by setting the median, 95th and 99th percentile of the error of each quantity, and the flagged share."""
    truth: dict[str, Any] = {}
    found = []
    for model, accuracy in asked:
        exact = "kalker" if model == "kalker_table" else model
        if exact not in truth:
            truth[exact] = _truth(cases, exact)
        ds = tr.solve(cases, outputs=COMPLETE, contact_model=model, accuracy=accuracy)
        off = relative_errors(ds, truth[exact])
        missed = ds.validity.values & validity_bit("tolerance_missed") != 0
        by_quantity = {name: percentiles(off[name][~missed]).tolist() for name in QUANTITIES}
        found.append({"errors": by_quantity, "missed": float(np.mean(missed))})
    return found


def parts_of_space(cases: list[tr.Case]) -> dict[str, list[list[int]]]:
    """Return the designs with low, medium and high values of properties that may make accuracy expensive."""
    ds = tr.solve(cases, outputs=FORCES, contact_model="kalker_table")
    ratio = (ds.semi_axis_rolling / ds.semi_axis_lateral).max("contact").values
    share = (ds.normal_force.min("contact") / ds.normal_force.sum("contact")).values
    values = {
        "friction": [case.friction_coefficient for case in cases],
        "contact angle": [case.contact_angle for case in cases],
        "load of the lighter contact": share,
        "slenderness of the patch": np.maximum(ratio, 1.0 / ratio),
        "adhesion area": ds.stick_area_fraction.max("contact").values,
    }
    return {name: [part.tolist() for part in np.array_split(np.argsort(value), 3)] for name, value in values.items()}


def falling(designs: list[tr.Case], seed: int, repeats: int) -> list[dict[str, Any]]:
    """Return the cost of each preset under random laws of falling friction, over the yardstick on the designs.

    Some of the rollers slip. A roller that nearly slips takes ten times longer than one that rolls.
    """
    cases, yardstick = falling_friction.sample(len(designs), seed), ("sliding", "standard")
    asked = [one for one in settings() if DECLARED[one[0]].friction_laws and one[1] in ACCURACIES]
    one = min(seconds(designs, repeats, [yardstick], COMPLETE))
    spent = (seconds(cases, repeats, asked, outputs) for outputs in (COMPLETE, FORCES))
    return [
        {"model": model, "accuracy": accuracy, "complete": whole / one, "forces": part / one}
        for (model, accuracy), whole, part in zip(asked, *spent, strict=True)
    ]


def measure(cases: int = 90, seed: int = 3, repeats: int = 2) -> dict[str, Any]:
    """Return cost and errors of every setting, costs by sample, and costs of parts of the space of designs."""
    designs = rolling(random_designs(2 * cases, seed))[:cases]
    asked, yardstick = settings(), ("sliding", "standard")
    complete = seconds(designs, repeats, asked, COMPLETE)
    forces = seconds(designs, repeats, asked, FORCES)
    one = complete[asked.index(yardstick)]
    rows = [
        {"model": model, "accuracy": accuracy, "complete": whole / one, "forces": part / one, **off}
        for (model, accuracy), whole, part, off in zip(asked, complete, forces, errors(designs, asked), strict=True)
    ]
    few = [yardstick, *(("kalker", accuracy) for accuracy in STUDIES)]

    def over(own: list[tr.Case]) -> dict[str, float]:
        first, *rest = seconds(own, repeats, few, COMPLETE)
        return {str(accuracy): spent / first for (_, accuracy), spent in zip(few[1:], rest, strict=True)}

    by_sample = {name: over(rolling(make(cases, seed))) for name, make in SAMPLES.items()}
    by_part = {
        name: [over([designs[i] for i in part]) if part else {} for part in parts]
        for name, parts in parts_of_space(designs).items()
    }
    costs = {"rows": rows, "falling": falling(designs[: cases // 2], seed, repeats)}
    return {"designs": len(designs), **costs, "by_sample": by_sample, "by_part": by_part}


def draw(measured: dict[str, Any], folder: Path) -> None:
    """Draw the cost over the error that 99 % keep, and the cost in parts of the space of designs, `trade.png`."""
    with style.look():
        figure = style.new_figure(90, 2 * style.COLUMN_MM)
        panels = figure.subplots(1, 3, width_ratios=(1, 1, 1.3))
        for axes, (quantity, words) in zip(
            panels, (("friction_force", "friction force"), ("peak_stress", "peak stress")), strict=False
        ):
            for model, colour, marker in zip(MODELS, style.palette(len(MODELS)), style.MARKERS, strict=False):
                for presets, line in ((True, ":"), (False, "-")):
                    own = [
                        row
                        for row in measured["rows"]
                        if row["model"] == model and (row["accuracy"] in ACCURACIES) == presets
                    ]
                    axes.plot(
                        [row["complete"] for row in own],
                        [max(row["errors"][quantity][2], 1e-9) for row in own],
                        marker=marker,
                        color=colour,
                        linestyle=line,
                        markerfacecolor="none" if presets else colour,
                        label=None if presets else model,
                    )
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.set_xlabel("cost of a complete case")
            axes.set_ylabel(f"error of the {words} that 99 % keep")
        panels[0].legend(frameon=False, fontsize=6)
        places = []
        for k, (name, parts) in enumerate(measured["by_part"].items()):
            places.append(name)
            for part, word, colour in zip(parts, ("low", "medium", "high"), style.palette(3), strict=True):
                if "0.01" in part:
                    panels[2].plot(
                        part["0.01"], k, marker="o", linestyle="none", color=colour, label=word if k == 0 else None
                    )
        panels[2].set_yticks(range(len(places)), places)
        panels[2].invert_yaxis()
        panels[2].set_xlabel("cost of kalker, accuracy: 0.01")
        panels[2].legend(frameon=False, fontsize=6)
        style.head(figure, "What accuracy costs", "over a complete case of sliding at standard; filled: tolerances")
        style.save(figure, folder, "trade")
        (folder / "trade.svg").unlink()  # the page shows the PNG


if __name__ == "__main__":
    run(measure, __doc__)
