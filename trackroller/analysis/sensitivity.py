"""From a solved study to its sensitivities, labelled and with what was done said.

The design's method decides the analysis: shares of variance on a grid, elementary effects for Morris, Sobol
indices for Saltelli samples, effects for response-surface designs, measures from given data for every
independent sample, distributions of life for nested studies (`robustness`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from trackroller.analysis import convergence, indices
from trackroller.analysis.givendata import MEASURES, firsts, given_data
from trackroller.analysis.labels import RELIABLE, Fields, correlated, labelled, note, treatment
from trackroller.analysis.pairs import pairs
from trackroller.analysis.restore import design_of
from trackroller.analysis.sobol import sobol
from trackroller.errors import InputError
from trackroller.study.design.sampling import SampledDesign
from trackroller.study.outputs import case_dims, outputs, read_study, regimes, settings

NEEDS = {
    "grid": "a full grid, every level weighing the same",
    "saltelli": "whole blocks of the Saltelli design and independent factors",
    "morris": "pairs of neighbouring rows of a trajectory",
    "central_composite": "rows enough for the fitted polynomial",
    "box_behnken": "rows enough for the fitted polynomial",
    "plackett_burman": "rows enough for the fitted main effects",
    "lhs": "independent factors; any usable rows",
    "sobol": "independent factors; any usable rows",
    "table": "independent factors (correlated columns share their influence); any usable rows",
}


@dataclass(frozen=True)
class Settings:
    """How an analysis is done: `seed` and number of bootstrap resamples, given-data measures wanted."""

    seed: int = 0
    resamples: int = 300
    measures: tuple[str, ...] = tuple(MEASURES)


def _ordered(design: SampledDesign) -> np.ndarray:
    return np.array([f.ordered for f in design.factors.values()], dtype=bool)


def _listed(design: SampledDesign) -> np.ndarray:
    """Factors that enter as list indices, not as quantiles or codes."""
    values = [f.discrete for f in design.factors.values()]
    return np.array(values, dtype=bool) & (design.method != "plackett_burman")


def _saltelli(y: np.ndarray, design: SampledDesign, how: Settings) -> tuple[Fields, int, int, np.ndarray]:
    count, second = len(design.factors), bool(design.meta["second_order"])
    step = 2 * count + 2 if second else count + 2
    seed = how.seed
    out = sobol(y, count, second, seed, how.resamples)
    at = convergence.sizes(int(design.meta["base_samples"]))
    mixed = np.r_[0 : count + 1, step - 1]  # the course needs no second order
    lean = y.reshape(-1, step)[:, mixed]
    out |= convergence.course(lambda n: sobol(lean[:n].ravel(), count, False, seed, how.resamples), at, ("S1", "ST"))
    # rows of A and B only: their mixtures repeat coordinates and would feign more rows than there are
    row = np.arange(len(y)) % step
    own = np.where((row == 0) | (row == step - 1), y, np.nan)
    out |= given_data(own, design.places, _ordered(design), seed, how.measures, how.resamples)
    used, total = int(out.pop("blocks_used")), int(out.pop("blocks"))
    return out, used, total, at


def _morris(y: np.ndarray, design: SampledDesign, how: Settings) -> tuple[Fields, int, int, np.ndarray]:
    step, listed = len(design.factors) + 1, _listed(design)
    seed = how.seed
    out = indices.morris(y, design.unit, listed, seed, how.resamples)
    at = convergence.sizes(int(design.meta["trajectories"]), smallest=4)
    out |= convergence.course(
        lambda n: indices.morris(y[: n * step], design.unit[: n * step], listed, seed, how.resamples), at, ("mu_star",)
    )
    return out, int(out["effects_used"].sum()), int(design.meta["trajectories"]) * (step - 1), at


def _grid(y: np.ndarray, design: SampledDesign, how: Settings) -> tuple[Fields, int, int, np.ndarray]:
    out = indices.grid_shares(y.reshape(design.meta["shape"]))
    out |= given_data(y, design.unit, _ordered(design), how.seed, how.measures, how.resamples)
    return out, int(out.pop("cells_used")), int(out.pop("cells")), np.zeros(0, dtype=int)


def _coded(y: np.ndarray, design: SampledDesign, how: Settings) -> tuple[Fields, int, int, np.ndarray]:
    out = indices.effects(y, design.unit, _listed(design), design.method != "plackett_burman")
    return out, int(out.pop("rows_used")), len(y), np.zeros(0, dtype=int)


def _given(y: np.ndarray, design: SampledDesign, how: Settings) -> tuple[Fields, int, int, np.ndarray]:
    ordered = _ordered(design)
    places = design.places
    measures = tuple(dict.fromkeys(("first", *how.measures)))  # the one that ranks the factors
    out = given_data(y, places, ordered, how.seed, measures, how.resamples)
    if len(design.factors) > 1 and not correlated(design):
        out |= pairs(y, places, ordered, how.seed)
    at = convergence.sizes(len(y), smallest=64)

    def part(n: int) -> Fields:  # every so many rows: the first rows of a table may be sorted
        every = max(1, len(y) // n)
        return firsts(y[::every], places[::every], ordered, how.seed)

    out |= convergence.course(part, at, ("first",))
    return out, int(out.pop("rows_used")), len(y), at


_METHODS: dict[str, Callable[[np.ndarray, SampledDesign, Settings], tuple[Fields, int, int, np.ndarray]]] = {
    "saltelli": _saltelli,
    "morris": _morris,
    "grid": _grid,
    **dict.fromkeys(("lhs", "sobol", "table"), _given),
    **dict.fromkeys(("central_composite", "box_behnken", "plackett_burman"), _coded),
}
_UNIT = {"saltelli": "blocks", "morris": "elementary effects", "grid": "cells"}


def analyse_dataset(
    ds: xr.Dataset,
    names: Iterable[str] | None = None,
    keep: Iterable[str] | None = None,
    natural: Iterable[str] = (),
    seed: int = 0,
    scale: str | Mapping[str, str] = "",
) -> xr.Dataset:
    """Sensitivities of every output of a study.

    Parameters
    ----------
    ds : gathered study: dimension `case` or one dimension a factor; attribute `study` with the study file
    names, keep, natural, scale : see `trackroller.study.outputs.outputs`; the key `analysis` of the study file fills
        in what is not given
    seed : of the bootstrap

    Returns
    -------
    Dataset with dimensions output, factor, factor_2, sample_size. By method: S1, ST, S2 (saltelli), mu,
    mu_star, sigma (morris), main_share, interaction_share, higher_share (grid), effect, curvature,
    interaction (response surfaces), first, delta, pawn, prcc (given data; in a random sample also interaction_share,
    approximate, by a polynomial that predicts `fit_share` of the variance), with _low and _high and the course with
    sample size. For each output: used_share, reliable, take_times, and `note`, which says what was left out
    and why.
    A nested study gives what `trackroller.analysis.robustness.robustness` returns.
    """
    study = read_study(ds)
    design = design_of(ds, study)
    told = settings(study)
    names = told.get("outputs") if names is None else names
    keep = tuple(told.get("keep", ("rolling",)) if keep is None else keep)
    how = Settings(seed, int(told.get("resamples", 300)), tuple(told.get("measures", MEASURES)))
    if design.method == "nested":
        from trackroller.analysis.robustness import material_deviations, robustness

        return robustness(ds, design, names, material_deviations(ds, told.get("material_scatter", False)))
    columns = outputs(ds, design.factors, names, keep, natural, scale=scale or told.get("scale", ""))
    if not columns or not design.factors:
        raise InputError("study", list(ds.data_vars), "at least one output and one factor that varies")
    results, notes, used_share, at = [], [], [], np.zeros(0, dtype=int)
    for column in columns:
        out, used, total, at = _METHODS[design.method](column.values, design, how)
        out.pop("rows_used", None)
        results.append(out)
        used_share.append(used / max(1, total))
        notes.append(note(column, used, total, _UNIT.get(design.method, "rows")))
    result = labelled(design, columns, results, at)
    result["used_share"] = ("output", np.array(used_share))
    result["reliable"] = ("output", np.array([s >= RELIABLE for s in used_share], dtype=np.int8))
    result["note"] = ("output", np.array(notes, dtype=object))
    result["take_times"] = ("output", np.array([_times(r, design.method) for r in results]))
    dims = case_dims(ds, design.factors)
    result.attrs = {
        "method": design.method,
        "needs": NEEDS[design.method],
        "rows": design.size,
        "kept_regimes": ", ".join(keep),
        "bootstrap_seed": seed,
        "resamples": how.resamples,
        "interval": "95 %",
        "treatment": treatment(regimes(ds, dims), keep) + correlated(design),
        "study": ds.attrs.get("study", ""),
    }
    return result


def _times(out: Fields, method: str) -> float:
    name = {"saltelli": "ST", "morris": "mu_star"}.get(method, "first")
    if name not in out or method == "grid":
        return float("nan")
    target = convergence.HALF_WIDTH
    if method == "morris":
        largest = np.nanmax(out["mu_star"], initial=0.0)
        target = convergence.HALF_WIDTH_MORRIS * float(largest)
    pairs = [(out[f"{n}_low"], out[f"{n}_high"]) for n in (name, "S1") if f"{n}_low" in out]
    return max(convergence.take_times(low, high, target) for low, high in pairs)


def analyse(
    study_nc: str | Path,
    out_nc: str | Path,
    names: Iterable[str] | None = None,
    keep: Iterable[str] | None = None,
    natural: Iterable[str] = (),
) -> xr.Dataset:
    """Analyse a gathered study file and write the labelled result beside it.

    Parameters
    ----------
    study_nc : gathered study
    out_nc : netCDF file to write, whole or not at all
    names, keep, natural : see `analyse_dataset`

    Returns
    -------
    The dataset that was written, see `analyse_dataset`.
    """
    from trackroller.study.files import write_whole

    with xr.open_dataset(study_nc, cache=False) as opened:  # variables one by one: a study may be large
        result = analyse_dataset(opened, names, keep, natural)
    write_whole(Path(out_nc), lambda part: result.to_netcdf(part))
    return result
