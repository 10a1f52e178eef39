"""The numbers of the page on the published example: the paper's tables beside ours, and where its numbers hold."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from trackroller.parameters import PARAMETERS
from validation.paper.compute import MODELS, reference

EXPONENT = 8.966  # k = ln(N_k/N_Rm)/ln(R_m/sigma_D) of 1.7225: N is proportional to stress^-k
TITLES = {"frictionless": "Free, μ = 0.0001", "free": "Free, μ = 0.3", "driven": "Driven, μ = 0.3"}
ROWS = (
    ("normal_force", "F_N [N]", 2),
    ("lateral_force", "F_T [N]", 2),
    ("driving_force", "F_A [N]", 2),
    ("spin_moment", "M_R [N mm]", 3),
    ("max_pressure", "p_max [MPa]", 1),
    ("rolling_radius_shift", "r_Delta0 [mm]", 5),
    ("peak_stress", "σ_DEH,max [MPa]", 1),
)


def life_factor(high: float, low: float) -> float:
    """Return the life at the stress `low` over the life at the stress `high`."""
    return (high / low) ** EXPONENT


def shorter(high: float, low: float) -> str:
    """Return in words how much shorter or longer the life at the stress `high` is than at the stress `low`."""
    factor = life_factor(high, low)
    return f"{factor:.2f} times shorter" if factor > 1 else f"{1 / factor:.2f} times longer"


def _worst(values: Any) -> list[float]:
    """Return the larger value of both bodies by contact."""
    return [max(v) if isinstance(v, list) else v for v in values]


def _over(ours: list[float], theirs: list[float]) -> list[float]:
    return [100 * (p / q - 1) for p, q in zip(ours, theirs, strict=True)]


def facts(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the template `paper.md` shows.

    Parameters
    ----------
    data : mapping
        With `validation.paper.compute.results` under `paper`, and under `tradeoff` the summary of the trade-off, whose
        table 2 is shown here.

    Returns
    -------
    dict
        Rows of tables, numbers of both contacts, and functions.
    """
    found, known = data["paper"], reference()
    ours, free = found["ours"], known["free"]["published"]
    driven, contact = ours["driven"], known["driven"]["contact"]
    swapped, heavy = known["axes swapped"]["published"], known["axes swapped, heavier"]["published"]
    own = found["limits"]
    peaks = _worst(ours["free"]["sliding"]["peak_stress"])
    energy = {f"{model}": sum(driven[model]["friction_energy_per_distance"]) for model in MODELS}
    return {
        "life_factor": life_factor,
        "shorter": shorter,
        "exponent": EXPONENT,
        "inner": found["inner"]["free"],
        "printed": free["peak_stress"],
        "peaks": peaks,
        "factors": [life_factor(p, q) for p, q in zip(peaks, free["peak_stress"], strict=True)],
        "circular": own["nearly circular"],
        "spin": _over(swapped["spin_moment"], own["axes swapped"]["spin_moment"]),
        "heavier": max(_worst(own["axes swapped, heavier"]["peak_stress"])) / max(heavy["peak_stress"]),
        "lateral": _over(driven["sliding"]["lateral_force"], contact["lateral_force"]),
        "driven_peaks": {model: max(_worst(driven[model]["peak_stress"])) for model in MODELS},
        "energy": {
            "local": energy["sliding"],
            "balance": sum(driven["sliding"]["friction_energy_balance"]),
            "kalker": energy["kalker"],
            "contact": sum(contact["friction_power_per_speed"]),
        },
        "case": [
            (f"`{p.name}`", p.symbol, f"{p.default:g}", p.unit) for p in PARAMETERS.values() if p.default == p.default
        ],
        "forces": {title: _scene(found, scene) for scene, title in TITLES.items()},
        "table_2": _table_2(found["table_2"]),
    }


def _scene(found: dict[str, Any], scene: str) -> list[tuple[str, ...]]:
    """Return the rows of one scene: the published program, our models and CONTACT."""
    known, ours = reference()[scene], [found["ours"][scene][model] for model in MODELS]
    columns = (known["published"], found["as_published"][scene], *ours, known.get("contact"))
    rows = [
        (label, *("-" if column is None else _text(column[name], digits) for column in columns))
        for name, label, digits in ROWS
    ]
    lives = (" / ".join(f"{min(v):.3g}" for v in one["life_cycles"]) for one in ours)
    printed = f"{known['published']['roller_life_cycles']:.3g} (worse contact)"
    return [*rows, ("overrollings to failure", printed, "-", *lives, "-")]


def _text(values: Any, digits: int) -> str:
    return " / ".join(f"{v:.{digits}f}" for v in _worst(values if isinstance(values, list) else [values]))


def _table_2(rows: list[dict[str, Any]]) -> list[tuple[str, ...]]:
    """Return the rows of the paper's table 2, printed and from this software."""
    one = next(r["seconds"] for r in rows if r["what"] == "`standard`")

    def time(row: dict[str, Any]) -> str:
        if row["seconds"] is None:
            return "-"
        printed = row["what"].startswith("paper")
        return f"printed: {row['seconds'] / 60:.0f} min" if printed else f"{row['seconds'] / one:.2g}"

    return [
        (
            r["what"],
            r["discretisation"].replace("see above", "see [accuracy.md](accuracy.md)"),
            time(r),
            *("-" if r[name] is None else f"{r[name]:.1f}" for name in ("inner", "peak")),
        )
        for r in rows
    ]
