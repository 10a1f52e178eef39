"""What solving costs: cases a second and bytes a case, for `plan` and for the size of chunks."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import TYPE_CHECKING, Any

from trackroller.parameters import OPTIONS
from trackroller.study.design.entries import OPTION_FACTORS

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

# Seconds of one core a case at preview, standard and reference; orders of magnitude. The processor time of one process
# was measured on `random_designs` of `validation/benchmarks/samples.py`: 100 designs, 20 to 100 of them at reference, 2
# to 8 of them on grids. It was divided by that of a complete case in sliding at standard, measured beside it, and
# multiplied by the 1.9 ms that this case takes on a quiet 2-core machine. Ordinary designs take 60 to 90 % of these
# times.
_LEVELS = ("preview", "standard", "reference")
_FORCES = {
    "sliding": (8e-4, 8e-4, 8e-4),
    "fastsim": (2.6e-3, 0.013, 0.045),
    "kalker": (5e-4, 3e-3, 0.016),  # at preview, kalker_table computes the forces
    "kalker_table": (4e-4, 4e-4, 1e-3),
    "halfspace": (0.2, 0.4, 0.7),  # patches solved on a grid by kalker; other models take less
}
_PEAKS = {
    "sliding": (6e-4, 1.1e-3, 3.8e-3),
    "fastsim": (1.1e-3, 1e-3, 7.5e-3),
    "kalker": (1.5e-3, 3.3e-3, 5e-3),
    "kalker_table": (1.2e-3, 4e-3, 0.024),
    "halfspace": (0.03, 0.2, 2.8),
}
_TRACTIONS, _SUBSURFACE = 1e-3, 0.1
_BYTES = {
    "forces": 200,
    "contact": 120,
    "friction_work": 40,
    "peak_stress": 160,
    "life": 90,
    "tractions": 300_000,
    "subsurface": 1_500_000,
}


def rate(options: Mapping[str, Any]) -> float:
    """Return the expected cases a second on one core for keyword arguments of `solve`."""
    accuracy = options.get("accuracy", "standard")
    if accuracy in _LEVELS:
        level = _LEVELS.index(accuracy)
    else:
        level = 1 if accuracy >= 1e-3 else 2
    groups = set(options.get("outputs", ("forces",)))
    model = options.get("contact_model", OPTIONS["contact_model"].default)
    model = "halfspace" if options.get("normal") == "halfspace" else model
    seconds = _FORCES[model][level]
    if groups & {"peak_stress", "life", "subsurface"}:  # one search serves all
        seconds += _PEAKS[model][level]
    seconds += _TRACTIONS * ("tractions" in groups) + _SUBSURFACE * ("subsurface" in groups)
    return 1.0 / seconds


def study_rate(study: Study) -> float:
    """Return the expected cases a second of a study, in which contact model and normal problem may be factors."""
    varied = {name: spec["values"] for name, spec in study.factors.items() if name in OPTION_FACTORS}
    several = [rate(study.options | dict(zip(varied, values, strict=True))) for values in product(*varied.values())]
    return len(several) / sum(1.0 / each for each in several)


def bytes_a_case(outputs: tuple[str, ...]) -> int:
    """Return the expected size of a case on the disk, chunk and gathered set together."""
    return 2 * (60 + sum(_BYTES[group] for group in set(outputs)))


def duration(seconds: float) -> str:
    """Return a time in words: '45 s', '3 min 20 s', '2 h 5 min'."""
    whole = int(seconds + 0.5)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
