"""Designs that were solved with several contact models, and the errors of the cheaper models."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.parameters import EXACTNESS
from trackroller.results.case_columns import CONTACT_RESULTS, codes, input_columns
from trackroller.results.solved_cases import SolvedCases
from trackroller.study.outputs import flat

MODEL = "contact_model"
RESULTS = ("regime", *CONTACT_RESULTS, "friction_energy_balance", "peak_stress")
GOOD = 0.05  # error of a design below which its model is good enough [1]
FORCES = (
    "normal_force",
    "lateral_force",
    "driving_force",
    "spin_moment",
    "semi_axis_lateral",
    "semi_axis_rolling",
)
ENERGY = "friction_energy_per_distance"


def pairs(results: SolvedCases) -> xr.Dataset | None:
    """Return the designs of a study by contact model; None if the study has only one model.

    Parameters
    ----------
    results : a solved study

    Returns
    -------
    Dataset over `contact_model` (the cheapest first, the reference last) and `design`. Cases whose
    inputs agree except for the model are one design. The data set holds the designs that the
    reference and at least one other model solved. Variables: the results that are compared, NaN
    (regime -1) where a design lacks a model, with `life`, the life that the study shows.
    Coordinates: the inputs that vary, and the friction coefficient as a number. Attributes:
    `reference`, `left` (number of cases without a partner), `factors` (the other factors), and
    `same`: the cheaper models whose cases the reference solved in the same way, as `kalker` does by
    its table at accuracy preview.
    """
    ds = results.data
    if MODEL not in ds.variables or "regime" not in ds:
        return None
    dims = results.dims
    table = pd.DataFrame(input_columns(ds, dims))
    models = [m for m in EXACTNESS[::-1] if m in set(table.get(MODEL, ()))]
    if len(models) < 2:
        return None
    rows = _matched(table, models)
    data: dict[str, Any] = {}
    for name in (n for n in RESULTS if n in ds):
        values = flat(ds, name, tuple(dims)).astype(float)[rows]
        values[rows < 0] = np.nan
        if name == "regime":
            values[rows < 0] = -1.0
        data[name] = ((MODEL, "design", *(d for d in ds[name].dims if d not in dims)), values)
    if results.life is not None:
        data["life"] = (
            (MODEL, "design"),
            np.where(rows < 0, np.nan, results.column(results.life[0])[rows]),
        )
    inputs = table.drop(columns=MODEL).iloc[rows[-1]]
    # a word has its number beside
    given = inputs.get("friction_coefficient_value", inputs.get("friction_coefficient"))
    if given is None:
        inputs["friction_coefficient"] = results.base["friction_coefficient"]
    else:
        inputs["friction_coefficient"] = pd.to_numeric(given)
    coords = {str(name): ("design", inputs[name].to_numpy()) for name in inputs}
    coords |= {name: (name, ds[name].values) for name in ("contact", "body") if name in ds}
    attrs = {"reference": models[-1], "left": int(len(table) - (rows >= 0).sum())}
    attrs |= {
        "factors": tuple(f for f in results.factors if f != MODEL),
        "same": _same(results, rows, models),
    }
    return xr.Dataset(data, coords | {MODEL: models}, attrs)


def _same(results: SolvedCases, rows: np.ndarray, models: list[str]) -> tuple[str, ...]:
    """Return the cheaper models that solved each of their cases as the reference did."""
    if "contact_model_used" not in results.data:
        return ()
    used = flat(results.data, "contact_model_used", results.dims)[rows]
    alike = [((used[i] == used[-1]) | (rows[i] < 0)).all() for i in range(len(models) - 1)]
    return tuple(
        model for model, equal in zip(models[:-1], alike, strict=True) if equal and rows.size
    )


def designs(paired: xr.Dataset) -> pd.DataFrame:
    """Return the designs of a comparison as a table: one row a design, one column a factor but the
    contact model.
    """
    return pd.DataFrame({name: paired[name].values for name in paired.attrs["factors"]})


def _matched(table: pd.DataFrame, models: list[str]) -> np.ndarray:
    """Return the row of each model and design, shape (models, designs), -1 where the design lacks
    it.

    The designs stand in the order of their rows.
    """
    varied = [n for n in table if n != MODEL and table[n].nunique(dropna=False) > 1]
    numbers = pd.Series(np.arange(len(table)), table.index)
    first = numbers.groupby([table[MODEL], codes(table, varied)]).first()  # equal cases count once
    rows = first.unstack(fill_value=-1).reindex(models).to_numpy()
    rows = rows[:, (rows[-1] >= 0) & (rows[:-1] >= 0).any(axis=0)]
    return rows[:, np.argsort(rows[-1], kind="stable")]


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
    return (
        abs(value / ref - 1.0)
        .where(value != ref, 0.0 * (ref == ref))
        .where(ref.notnull() & value.notnull())
    )


def _relative(name: str) -> Callable[[xr.Dataset, xr.Dataset], xr.DataArray]:
    return lambda ds, ref: _largest(_apart(ds[name], ref[name]))


def _of_capacity(ds: xr.Dataset, ref: xr.Dataset) -> xr.DataArray:
    capacity = ref["friction_coefficient"] * ref["normal_force"]
    arm = np.sqrt(ref["semi_axis_lateral"] * ref["semi_axis_rolling"])
    sizes = [
        abs(ds[n] - ref[n]) / s
        for n, s in (
            ("lateral_force", capacity),
            ("driving_force", capacity),
            ("spin_moment", capacity * arm),
        )
    ]
    return _largest(xr.concat(sizes, "force").max("force"))


def _work(name: str) -> Callable[[xr.Dataset, xr.Dataset], xr.DataArray]:
    return lambda ds, ref: abs(
        ds[name].sum("contact", skipna=False) / ref[ENERGY].sum("contact", skipna=False) - 1.0
    )


def _stick(ds: xr.Dataset, ref: xr.Dataset) -> xr.DataArray:
    """Return the difference of the shares; NaN for full sliding, which has no adhesion area by
    assumption.
    """
    known = str(ds["contact_model"].item()) != "sliding"
    return _largest(abs(ds["stick_area_fraction"] - ref["stick_area_fraction"])).where(known)


QUANTITIES = (
    Quantity(
        "normal_force",
        "normal forces",
        "Normal force",
        _relative("normal_force"),
        ("normal_force",),
    ),
    Quantity(
        "friction_force",
        "friction forces and spin moment (over mu F_N)",
        r"Friction over $\mu F_\mathrm{N}$",
        _of_capacity,
        FORCES,
    ),
    Quantity(
        "friction_energy",
        "friction energy (local product)",
        "Friction energy",
        _work(ENERGY),
        (ENERGY,),
    ),
    Quantity(
        "friction_energy_balance",
        "friction energy from the resultants",
        "Friction energy,\nresultants:",
        _work("friction_energy_balance"),
        (ENERGY, "friction_energy_balance"),
    ),
    Quantity(
        "peak_stress", "peak stress", "Peak stress", _relative("peak_stress"), ("peak_stress",)
    ),
    Quantity("life", "life", "Life", _relative("life"), ("life",)),
    Quantity(
        "stick", "adhesion area (share of the patch)", "Stick", _stick, ("stick_area_fraction",)
    ),
)


def errors(paired: xr.Dataset) -> xr.Dataset:
    """Return the error of each cheaper model against the reference where both roll.

    `paired`: dataset of `trackroller.results.model_errors`. Errors are relative; those of
    friction forces are over mu F_N and that of the spin moment over mu F_N sqrt(a b), that of stick
    is a difference of shares. The larger error of both contacts and bodies counts.
    """
    reference = str(paired.attrs["reference"])
    ref = paired.sel(contact_model=reference)
    parts = []
    for model in (str(m) for m in paired["contact_model"].values if m != reference):
        one = paired.sel(contact_model=model)
        rolls = (one["regime"] == 0) & (ref["regime"] == 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            by_name = {
                q.name: q.error(one, ref).where(rolls)
                for q in QUANTITIES
                if all(n in paired for n in q.needs)
            }
        parts.append(
            xr.Dataset(by_name)
            .drop_vars("contact_model", errors="ignore")
            .assign_coords(contact_model=model)
        )
    out = xr.concat(parts, "contact_model", coords="minimal", compat="override").transpose(
        "contact_model", "design"
    )
    for q in QUANTITIES:
        if q.name in out:
            out[q.name].attrs = {"long_name": f"error of the {q.words}", "units": "1"}
    out.attrs = dict(paired.attrs)
    return out


def measured(compared: xr.Dataset) -> list[Quantity]:
    """Return the quantities for which the errors `compared` hold a number."""
    return [q for q in QUANTITIES if q.name in compared and bool(compared[q.name].notnull().any())]


def known(error: xr.DataArray) -> np.ndarray:
    """Return the errors of the cases that have one, shape (k,)."""
    return np.asarray(error.values[~np.isnan(error.values)])


def compared(one: xr.Dataset) -> int:
    """Return the number of cases for which the errors of one model are known."""
    return max((int(one[q.name].notnull().sum()) for q in measured(one)), default=0)


def spread(error: np.ndarray) -> tuple[float, float, float]:
    """Return the median, the 90th percentile and the largest error; each is the error of one
    case.
    """
    return tuple(float(np.percentile(error, p, method="nearest")) for p in (50, 90, 100))  # type: ignore[return-value]
