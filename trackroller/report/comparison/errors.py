"""How far the cheaper contact models are off: one relative error a quantity, model and design."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr

GOOD = 0.05  # what counts as good enough


@dataclass(frozen=True)
class Quantity:
    """A compared quantity: how its error is measured, its names, and the results it needs."""

    name: str
    words: str
    label: str
    error: Callable[[xr.Dataset, xr.Dataset], xr.DataArray]
    needs: tuple[str, ...]


def _largest(value: xr.DataArray) -> xr.DataArray:
    return value.max([d for d in ("contact", "body") if d in value.dims])


def _apart(value: xr.DataArray, ref: xr.DataArray) -> xr.DataArray:
    """Return the relative difference; 0 where both values are unlimited."""
    return abs(value / ref - 1.0).where(value != ref, 0.0 * (ref == ref)).where(ref.notnull() & value.notnull())


def _relative(name: str) -> Callable[[xr.Dataset, xr.Dataset], xr.DataArray]:
    return lambda ds, ref: _largest(_apart(ds[name], ref[name]))


def _of_capacity(ds: xr.Dataset, ref: xr.Dataset) -> xr.DataArray:
    capacity = ref["friction_coefficient"] * ref["normal_force"]
    arm = np.sqrt(ref["semi_axis_lateral"] * ref["semi_axis_rolling"])
    sizes = [
        abs(ds[n] - ref[n]) / s
        for n, s in (("lateral_force", capacity), ("driving_force", capacity), ("spin_moment", capacity * arm))
    ]
    worst = sizes[0]
    for size in sizes[1:]:
        worst = worst.where(worst > size, size)
    return _largest(worst)


def _work(name: str) -> Callable[[xr.Dataset, xr.Dataset], xr.DataArray]:
    right = "friction_energy_per_distance"
    return lambda ds, ref: abs(ds[name].sum("contact", skipna=False) / ref[right].sum("contact", skipna=False) - 1.0)


def _stick(ds: xr.Dataset, ref: xr.Dataset) -> xr.DataArray:
    return _largest(abs(ds["stick_area_fraction"] - ref["stick_area_fraction"]))


FORCES = ("normal_force", "lateral_force", "driving_force", "spin_moment", "semi_axis_lateral", "semi_axis_rolling")
ENERGY = "friction_energy_per_distance"
QUANTITIES = (
    Quantity("normal_force", "normal forces", "Normal force", _relative("normal_force"), ("normal_force",)),
    Quantity(
        "friction_force",
        "friction forces and spin moment (over mu F_N)",
        r"Friction over $\mu F_\mathrm{N}$",
        _of_capacity,
        FORCES,
    ),
    Quantity("friction_energy", "friction energy (local product)", "Friction energy", _work(ENERGY), (ENERGY,)),
    Quantity(
        "friction_energy_balance",
        "friction energy from the resultants",
        "Friction energy,\nresultants:",
        _work("friction_energy_balance"),
        (ENERGY, "friction_energy_balance"),
    ),
    Quantity("peak_stress", "peak stress", "Peak stress", _relative("peak_stress"), ("peak_stress",)),
    Quantity("life", "life", "Life", _relative("life"), ("life",)),
    Quantity("stick", "adhesion area (share of the patch)", "Stick", _stick, ("stick_area_fraction",)),
)


def errors(paired: xr.Dataset) -> xr.Dataset:
    """Return the error of each cheaper model against the reference where both roll.

    `paired`: dataset of `trackroller.report.comparison.pairs`. Errors are relative; those of friction forces are over
    mu F_N and that of the spin moment over mu F_N sqrt(a b), that of stick is a difference of shares. The larger error
    of both contacts and bodies counts.
    """
    reference = str(paired.attrs["reference"])
    ref, parts = paired.sel(contact_model=reference), []
    for model in (str(m) for m in paired["contact_model"].values if m != reference):
        one = paired.sel(contact_model=model)
        rolls = (one["regime"] == 0) & (ref["regime"] == 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = {q.name: q.error(one, ref).where(rolls) for q in QUANTITIES if all(n in paired for n in q.needs)}
        parts.append(xr.Dataset(found).drop_vars("contact_model", errors="ignore").assign_coords(contact_model=model))
    out = xr.concat(parts, "contact_model", coords="minimal", compat="override").transpose("contact_model", "design")
    for q in QUANTITIES:
        if q.name in out:
            out[q.name].attrs = {"long_name": f"error of the {q.words}", "units": "1"}
    out.attrs = dict(paired.attrs)
    return out


def measured(found: xr.Dataset) -> list[Quantity]:
    """Return the quantities for which the errors `found` hold a number."""
    return [q for q in QUANTITIES if q.name in found and bool(found[q.name].notnull().any())]
