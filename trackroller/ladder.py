"""The contact models compared on one study: figures, words and a report (`snakemake contact_models`)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.plots.style import FigureInfo

FRICTIONS_SHOWN = (0.05, 0.15, 0.5)  # of the pictures of the patch
GOOD = 0.05  # what counts as good enough
REFERENCE = "kalker"
NAMES = {"sliding": "The sliding model", "fastsim": "FASTSIM"}


@dataclass(frozen=True)
class Quantity:
    """Something compared: how its error is measured, and its name in a sentence."""

    name: str
    words: str
    error: Callable[[xr.Dataset, xr.Dataset], xr.DataArray]


def _largest(value: xr.DataArray) -> xr.DataArray:
    return value.max([d for d in ("contact", "body") if d in value.dims])


def _relative(name: str) -> Callable[[xr.Dataset, xr.Dataset], xr.DataArray]:
    return lambda ds, ref: _largest(abs(ds[name] / ref[name] - 1.0))


def _of_capacity(ds: xr.Dataset, ref: xr.Dataset) -> xr.DataArray:
    capacity = ref["friction_coefficient"] * ref["normal_force"]
    arm = np.sqrt(ref["semi_axis_lateral"] * ref["semi_axis_rolling"])
    sizes = [abs(ds[n] - ref[n]) / s for n, s in (("lateral_force", capacity), ("driving_force", capacity),
                                                     ("spin_moment", capacity * arm))]  # fmt: skip
    worst = sizes[0]
    for size in sizes[1:]:
        worst = worst.where(worst > size, size)
    return _largest(worst)


def _work(name: str) -> Callable[[xr.Dataset, xr.Dataset], xr.DataArray]:
    right = "friction_energy_per_distance"
    return lambda ds, ref: abs(ds[name].sum("contact", skipna=False) / ref[right].sum("contact", skipna=False) - 1.0)


QUANTITIES = (
    Quantity("normal_force", "normal forces", _relative("normal_force")),
    Quantity("friction_force", "friction forces and spin moment (over what friction can carry)", _of_capacity),
    Quantity("friction_energy", "friction energy (local product)", _work("friction_energy_per_distance")),
    Quantity("friction_energy_balance", "friction energy from the resultants", _work("friction_energy_balance")),
    Quantity("peak_stress", "peak stress", _relative("peak_stress")),
    Quantity("life", "life of the roller", _relative("roller_life_hours")),
)


def errors(ds: xr.Dataset) -> xr.Dataset:
    """Error of each cheaper model against the exact theory where all models roll; dimensions of the study's grid.

    `ds`: gathered study with the dimension `contact_model`. Relative errors; friction forces over mu F_N, the spin
    moment over mu F_N sqrt(a b); the larger of both contacts and bodies.
    """
    import xarray as xr

    models = [str(m) for m in ds["contact_model"].values]
    rolls = (ds["regime"] == 0).all("contact_model")
    ref = ds.sel(contact_model=REFERENCE)
    parts = []
    for model in (m for m in models if m != REFERENCE):
        one = ds.sel(contact_model=model)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = {q.name: q.error(one, ref).where(rolls) for q in QUANTITIES}
        parts.append(xr.Dataset(found).drop_vars("contact_model", errors="ignore").assign_coords(contact_model=model))
    out = xr.concat(parts, "contact_model")
    for q in QUANTITIES:
        out[q.name].attrs = {"long_name": f"error of the {q.words}", "units": "1"}
    return out


def sentences(ds: xr.Dataset, tolerance: float = GOOD) -> list[str]:
    """Where each cheaper model is good enough over friction and drive, in words computed from the data."""
    found = errors(ds)
    said = [_sentence(found.sel(contact_model=model, motor_force=drive), str(model), float(drive), tolerance)
            for model in found["contact_model"].values for drive in found["motor_force"].values]  # fmt: skip
    return [f"Errors are taken against the exact theory (kalker) where all models roll; good enough means within "
            f"{_percent(tolerance)}.", *(s for s in said if s)]  # fmt: skip


def _percent(value: float) -> str:
    from trackroller.plots.style import rounded

    return f"{rounded(100 * value, 2)} %"


def _sentence(one: xr.Dataset, model: str, drive: float, tolerance: float) -> str:
    from trackroller.plots.style import number

    way = "free rolling" if drive == 0 else f"{'driven' if drive < 0 else 'braked'} by {number(abs(drive))} N"
    clauses: dict[str, list[str]] = {"good": [], "bad": []}
    for q in QUANTITIES:
        e = one[q.name].values
        rolls = np.isfinite(e)
        if not rolls.any():
            return f"{NAMES[model]}, {way}: nothing to compare, for no case rolls."
        mu, e = one["friction_coefficient"].values[rolls], e[rolls]
        span = f"{_percent(float(e.min()))} to {_percent(float(e.max()))}"
        keeps = e <= tolerance
        where = _where(mu, keeps)
        clauses["good" if keeps.any() else "bad"].append(f"{q.words} {where} ({span})".replace("  ", " "))
    good = f"good enough for {', '.join(clauses['good'])}" if clauses["good"] else ""
    bad = f"not good enough for {', '.join(clauses['bad'])}" if clauses["bad"] else ""
    return f"{NAMES[model]}, {way}: {'; '.join(c for c in (good, bad) if c)}."


def _where(mu: np.ndarray, keeps: np.ndarray) -> str:
    """The frictions at which `keeps` holds, in words."""
    from trackroller.plots.style import rounded

    if not keeps.any():
        return ""
    if keeps.all():
        return "at every friction"
    turns = np.diff(keeps.astype(int))
    if keeps[0] and not np.any(turns > 0):
        return f"up to a friction of {rounded(float(mu[keeps][-1]), 2)}"
    if keeps[-1] and not np.any(turns < 0):
        return f"from a friction of {rounded(float(mu[keeps][0]), 2)} on"
    return f"at {int(keeps.sum())} of {keeps.size} frictions"


def patch_fields(case: Any, frictions: tuple[float, ...] = FRICTIONS_SHOWN) -> xr.Dataset:
    """Tractions, slip and stick over both patches of a freely rolling `case` by model; contact_model x friction."""
    import dataclasses

    import xarray as xr

    from trackroller.plots.ladder import LOOKS
    from trackroller.solver import solve

    cases = [dataclasses.replace(case, motor_force=0.0, friction_coefficient=mu) for mu in frictions]
    parts = []
    for model in LOOKS:
        ds = solve(cases, outputs=("forces", "contact", "tractions"), contact_model=model)
        parts.append(ds.rename(case="friction_coefficient").assign_coords(
            friction_coefficient=list(frictions), contact_model=model))  # fmt: skip
    # full sliding is drawn on its own number of points
    points = {n: max(p.sizes[n] for p in parts) for n in ("x", "y")}
    parts = [_resampled(p, points) for p in parts]
    return xr.concat(parts, "contact_model", combine_attrs="drop_conflicts")


def _resampled(ds: xr.Dataset, points: dict[str, int]) -> xr.Dataset:
    """Fields at the nearest of their own points on a grid of `points` positions."""
    pick = {n: np.minimum((np.arange(m) * ds.sizes[n]) // m, ds.sizes[n] - 1) for n, m in points.items()}
    return ds.isel(pick).drop_vars([n for n in ("x", "y") if n in ds.coords])


def compare(study_file: Path, out: Path) -> None:
    """Solve the study of all contact models, draw it, say it in words and write the report into the folder `out`."""
    import xarray as xr

    from trackroller.case import Case
    from trackroller.plots.style import write_index
    from trackroller.report import write_report
    from trackroller.study.config import load_study
    from trackroller.study.run import run_study

    plan = run_study(load_study(study_file), out.parent)
    if plan.folder.root != out:
        raise ValueError(f"the study must be named {out.name}")
    with xr.open_dataset(plan.folder.gathered) as opened:
        ds = opened.load()
    base = {k: v for k, v in load_study(study_file).config.base.items() if k not in ds.dims}
    figures = out / "figures"
    write_index(draw_all(ds, patch_fields(Case.from_dict(base)), figures), figures)
    words = [*sentences(ds), *map_sentences()]
    for folder in (out, figures):
        (folder / "words.txt").write_text("\n".join(words) + "\n", encoding="utf-8")
    write_report(plan.folder.gathered, figures, out / "report.html")


def map_sentences() -> list[str]:
    """What the random designs behind `contact_model="auto"` say."""
    from trackroller import contact_choice as choice

    m = choice.stored()
    said = [f"Of {int(m['checked'])} random designs, auto takes"]
    parts = []
    for tolerance, shares in zip(m["tolerances"], m["shares"], strict=True):
        parts.append(f"for {_percent(float(tolerance))} sliding in {_percent(shares[0])}, FASTSIM in "
                     f"{_percent(shares[1])} and the exact theory in {_percent(shares[2])}")  # fmt: skip
    return [f"{said[0]} {'; '.join(parts)}; within the tolerance were at least {_percent(float(np.min(m['met'])))}."]


def draw_all(ds: xr.Dataset, fields: xr.Dataset, out: Path) -> list[FigureInfo]:
    """All figures as SVG and PNG in the folder `out`; captions for the report."""
    from trackroller.plots import style

    infos = []
    with style.look():
        for draw, name, caption, sentence in _figures(ds, fields):
            style.save(draw(), out, name)
            infos.append(style.FigureInfo(name, caption, sentence))
    return infos


def _figures(ds: xr.Dataset, fields: xr.Dataset) -> list[tuple[Callable[[], Any], str, str, str]]:
    """What draws each figure, its name, caption and sentence."""
    from trackroller.plots import ladder, ladder_map

    found = errors(ds)
    worst = found["normal_force"].sel(contact_model="sliding")
    return [
        (lambda: ladder.error(found, GOOD), "error", "Error of the cheaper models against the exact theory.",
         f"The normal forces of the sliding model are off by up to {_percent(float(worst.max()))}."),
        (lambda: ladder.forces(ds), "forces", "Normal and lateral force and spin moment by model.", ""),
        (lambda: ladder.energy(ds), "energy", "Friction energy of both contacts per distance. The local product is the "
         "published one; from the resultants is the work that drive and tilting forces put in.", ""),
        (lambda: ladder.patches(fields), "patches", "Friction, stick and dissipation across contact 1.", ""),
        (lambda: ladder.stick(ds), "stick", "Share of the patch that sticks.", ""),
        (lambda: ladder.peak_and_life(ds), "peak_and_life", "Peak von Mises stress and life of the roller.", ""),
        (ladder_map.choice_map, "map", "Cheapest contact model within a tolerance.", ""),
    ]  # fmt: skip
