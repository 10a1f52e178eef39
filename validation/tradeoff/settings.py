"""List the measured settings of each stage and contact model, from too coarse to finer than needed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.roller.accuracy import Accuracy

FORCES = ("forces", "contact", "friction_work")
PEAKS = ("forces", "contact", "peak_stress", "life")
ALL = ("forces", "contact", "friction_work", "peak_stress", "life")

# nodes of the second pass by nodes of the first; scan, climb, polish, summit of the peak search
FORCE_NODES = (4, 6, 8, 10, 12, 16, 20, 24, 32)
QUADRATURES = {
    "a": (6, 6, 8, 16),
    "b": (6, 8, 12, 24),
    "c": (8, 12, 16, 32),
    "d": (12, 16, 24, 48),
    "e": (16, 24, 32, 64),
}
EFFORTS = {1: (3, 1), 2: (5, 3), 3: (8, 6), 4: (12, 8), 5: (16, 12), 6: (24, 16)}
# quadrature, effort and smallest step of the searches measured
SEARCHES = (
    ("a", 1, 0.05),
    ("a", 2, 0.05),
    ("a", 3, 0.015),
    ("b", 1, 0.05),
    ("b", 2, 0.015),
    ("b", 3, 0.015),
    ("b", 4, 0.015),
    ("c", 2, 0.015),
    ("c", 3, 0.015),
    ("c", 3, 0.005),
    ("c", 4, 0.005),
    ("c", 5, 0.002),
    ("d", 3, 0.005),
    ("d", 4, 0.002),
    ("d", 5, 0.001),
    ("d", 6, 0.001),
    ("e", 5, 0.0005),
)
ELEMENTS = {"kalker": (8, 12, 16, 20, 28, 40, 56)}
REFERENCE_ELEMENTS = {"kalker": 80}
FINE = PeakSettings(12, 16, 24, 48, 16, 12, 0.001, 0.0)
# No search exceeds the true peak, so the largest result of several fine searches is the best known value.
REFERENCE_SEARCHES = (
    PeakSettings(24, 32, 48, 96, 32, 24, 3e-4, 0.0),
    PeakSettings(16, 24, 32, 96, 24, 20, 5e-4, 0.0),
    PeakSettings(12, 16, 24, 96, 32, 24, 1e-3, 0.0),
)


@dataclass(frozen=True)
class Setting:
    """One point of the trade-off.

    `points` is the number per length that an order of convergence counts by (NaN: none), `ladder` the settings that
    `accuracy` takes from here (empty: it does not choose among these).
    """

    stage: str
    model: str
    method: str
    label: str
    points: float
    accuracy: Accuracy | None = None
    options: dict[str, Any] = field(default_factory=dict)
    outputs: tuple[str, ...] = FORCES
    ladder: dict[str, Any] = field(default_factory=dict)


def accuracy_of(nodes: int = 24, coarse: int = 6, peak: PeakSettings = FINE, elements: int = 40) -> Accuracy:
    """Return an accuracy made of parts, for measuring."""
    return Accuracy("measured", 0.0, nodes, coarse, peak, 41, 61, elements)


def floor_of(step: float) -> float:
    """Return the floor of the error estimate: the smallest step of a search limits the error that it can see."""
    return 2e-3 if step > 0.02 else 0.02 * step


def searches() -> list[Setting]:
    """Return the searches for the peak in full sliding."""
    found = []
    for quadrature, effort, step in SEARCHES:
        orders = QUADRATURES[quadrature]
        peak = PeakSettings(*orders, *EFFORTS[effort], step, floor_of(step))
        found.append(
            Setting(
                "peak",
                "sliding",
                "search",
                f"{quadrature}{effort}",
                orders[2],
                accuracy_of(peak=peak),
                outputs=PEAKS,
                ladder={"peak": list(vars(peak).values())},
            )
        )
    return found


def quadratures() -> list[Setting]:
    """Return the quadrature of the slip integrals in the equilibrium of full sliding."""
    return [
        Setting(
            "equilibrium",
            "sliding",
            "quadrature",
            str(n),
            n,
            accuracy_of(n, min(n, 6)),
            ladder={"force_nodes": n, "coarse_nodes": min(n, 6)},
        )
        for n in FORCE_NODES
    ]


def ellipses() -> list[Setting]:
    """Return exact Hertz ellipses and ellipses of the published table, with the quantities that follow from them."""
    return [
        Setting("ellipse", "sliding", method, method, float("nan"), accuracy_of(), {"hertz": method}, ALL)
        for method in ("exact", "published")
    ]


def elements(model: str) -> list[Setting]:
    """Return the numbers of elements across the patch of a rolling contact model."""
    return [
        Setting("elements", model, "elements", str(n), n, accuracy_of(elements=n), outputs=ALL, ladder={"elements": n})
        for n in ELEMENTS[model]
    ]


def references(model: str) -> list[Accuracy]:
    """Return settings of the converged reference; of several, each row takes the largest peak."""
    if model == "sliding":
        return [accuracy_of(48, 8, peak) for peak in REFERENCE_SEARCHES]
    return [accuracy_of(48, 8, REFERENCE_SEARCHES[1], REFERENCE_ELEMENTS[model])]
