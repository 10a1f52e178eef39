"""What solving costs: cases a second and bytes a case, for `plan` and for the size of chunks."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

# Cases a second on one core, measured on a 2-core machine at `standard` accuracy; orders of magnitude.
_RATES = {"forces": 800.0, "contact": 20000.0, "friction_work": 4000.0, "peak_stress": 75.0, "life": 75.0,
          "tractions": 100.0, "subsurface": 4.0}  # fmt: skip
_MODELS = {"sliding": 1.0, "fastsim": 20.0, "kalker": 400.0, "auto": 40.0}  # times the cost of the forces
# seconds more where patches are solved on a grid
_SOLVED_PATCHES = {"forces": 0.15, "peak_stress": 0.35, "life": 0.35, "subsurface": 3.0}
_ACCURACY = {"preview": 0.5, "standard": 1.0, "reference": 6.0}
_BYTES = {"forces": 200, "contact": 120, "friction_work": 40, "peak_stress": 160, "life": 90,
          "tractions": 300_000, "subsurface": 1_500_000}  # fmt: skip


def rate(options: Mapping[str, Any]) -> float:
    """Expected cases a second on one core for keyword arguments of `solve`."""
    accuracy = options.get("accuracy", "standard")
    factor = _ACCURACY.get(accuracy, 1.0) if isinstance(accuracy, str) else (1.0 if accuracy >= 1e-3 else 6.0)
    groups = set(options.get("outputs", ("forces",))) | {"forces"}
    if "life" in groups:
        groups.discard("peak_stress")  # one search serves both
    seconds = sum(1.0 / _RATES[g] * (factor if g != "contact" else 1.0) for g in groups)
    seconds += (_MODELS[options.get("contact_model", "sliding")] - 1.0) / _RATES["forces"]
    if options.get("normal") == "halfspace":
        seconds += factor * sum(_SOLVED_PATCHES.get(g, 0.0) for g in groups)
    return 1.0 / seconds


def bytes_a_case(outputs: tuple[str, ...]) -> int:
    """Expected size of a case on the disk, chunk and gathered set together."""
    return 2 * (60 + sum(_BYTES[group] for group in set(outputs)))


def measured_rate(folder: Path) -> float | None:
    """Cases a second of one process, from the files already solved; None without any."""
    import netCDF4

    cases, seconds = 0, 0.0
    for path in sorted(folder.glob("*.nc"))[:20]:
        try:
            with netCDF4.Dataset(path) as file:
                if (spent := float(file.seconds)) > 0:
                    cases += len(file.dimensions["case"])
                    seconds += spent
        except (OSError, AttributeError, KeyError):
            continue
    return cases / seconds if seconds > 0 else None


def duration(seconds: float) -> str:
    """A time in words: '45 s', '3 min 20 s', '2 h 5 min'."""
    whole = int(seconds + 0.5)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def size(number: float) -> str:
    """Bytes in words."""
    for unit in ("B", "kB", "MB", "GB"):
        if number < 1000:
            return f"{number:.0f} {unit}"
        number /= 1000
    return f"{number:.1f} TB"
