"""Error against cost of every stage and contact model: measured in parts side by side, gathered to one file."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import yaml

from trackroller.errors import InputError, unknown_name
from trackroller.files import write_whole
from trackroller.parameters import PARAMETERS
from trackroller.roller.case import Case
from trackroller.study.store.provenance import git_commit, versions
from validation.tradeoff import settings
from validation.tradeoff.measure import measure
from validation.tradeoff.paper import paper_table
from validation.tradeoff.sample import SEED, sample
from validation.tradeoff.stages import measure_stages

MODELS = ("sliding", "kalker")
BLOCKS = {"sliding": 128, "kalker": 16}  # designs that all settings solve in turn


@dataclass(frozen=True)
class Sizes:
    """Designs a contact model is measured on, and in how many parts; `stages` designs for the single stages."""

    designs: dict[str, int]
    parts: dict[str, int]
    stages: int
    seed: int = SEED

    def names(self) -> list[str]:
        """Return the names of all parts, the longest work first."""
        return [f"{model}-{k}" for model in reversed(MODELS) for k in range(self.parts[model])] + ["stages-0"]

    def rows(self, name: str) -> tuple[str, slice]:
        """Return model (or `stages`) and designs of a part."""
        model, _, number = name.partition("-")
        if model == "stages":
            return model, slice(0, self.stages)
        count, parts, k = self.designs[model], self.parts[model], int(number)
        return model, slice(count * k // parts, count * (k + 1) // parts)


def load_sizes(path: Path | str) -> Sizes:
    """Return the sizes under `tradeoff` in a YAML file such as validation/config/sizes.yaml; refuse anything else."""
    with Path(path).open(encoding="utf-8") as file:
        content = yaml.safe_load(file)
    given = content.get("tradeoff") if isinstance(content, dict) else None
    if not isinstance(given, dict):
        raise InputError(f"tradeoff in {path}", given, "a mapping with " + ", ".join((*MODELS, "stages", "seed")))
    designs, parts = {}, {}
    for key in given:
        if key not in (*MODELS, "stages", "seed"):
            raise unknown_name("key", str(key), (*MODELS, "stages", "seed"))
    for model in MODELS:
        entry = given.get(model)
        if not isinstance(entry, dict) or set(entry) != {"designs", "parts"} or min(entry.values()) < 1:
            raise InputError(model, entry, "{designs: a number, parts: a number}, both at least 1")
        designs[model], parts[model] = int(entry["designs"]), min(int(entry["parts"]), int(entry["designs"]))
    return Sizes(designs, parts, int(given.get("stages", 24)), int(given.get("seed", SEED)))


def settings_of(model: str) -> list[settings.Setting]:
    """Return all settings that are measured with complete solutions of one contact model."""
    if model == "sliding":
        return [*settings.quadratures(), *settings.searches(), *settings.ellipses()]
    return settings.elements(model)


def measure_part(name: str, sizes: Sizes) -> xr.Dataset:
    """Measure one part."""
    model, rows = sizes.rows(name)
    cases = sample(rows.stop, sizes.seed)[rows]
    ds = measure_stages(cases) if model == "stages" else measure(settings_of(model), cases, model, BLOCKS[model])
    ds.attrs.update(part=name, designs=len(cases), first=rows.start)
    return ds


def write_part(name: str, sizes_path: str, out: str) -> None:
    """Measure one part and write it."""
    ds = measure_part(name, load_sizes(sizes_path))
    write_whole(Path(out), lambda beside: ds.to_netcdf(beside))


def gather(parts: Sequence[xr.Dataset], cases: Sequence[Case] = ()) -> xr.Dataset:
    """Join all parts: settings one after the other, designs along one dimension, costs as means over the designs."""
    by_model: dict[str, list[xr.Dataset]] = {}
    for ds in parts:
        by_model.setdefault(str(ds.attrs["part"]).rpartition("-")[0], []).append(ds)
    width = max(int(ds.attrs["first"]) + ds.sizes["design"] for ds in parts)
    joined = [_joined(sorted(group, key=lambda ds: int(ds.attrs["first"])), width) for group in by_model.values()]
    out = xr.concat(joined, "setting", combine_attrs="drop", coords="minimal", compat="override", join="outer")
    for model, group in by_model.items():
        out.attrs[f"designs_{model}"] = sum(int(ds.attrs["designs"]) for ds in group)
        if "reference_cost" in group[0].attrs:
            out.attrs[f"reference_cost_{model}"] = _mean(group, lambda ds: float(ds.attrs["reference_cost"]))
    for name, parameter in PARAMETERS.items() if cases else ():
        if not parameter.allow_missing or name == "friction_coefficient":
            values = np.array([float(getattr(c, name)) for c in cases[:width]])
            out[f"design_{name}"] = ("design", values, {"units": parameter.units, "long_name": parameter.long_name})
    return out


def _joined(group: Sequence[xr.Dataset], width: int) -> xr.Dataset:
    errors = np.full((group[0].sizes["setting"], group[0].sizes["quantity"], width), np.nan, np.float32)
    for ds in group:
        first = int(ds.attrs["first"])
        errors[:, :, first : first + ds.sizes["design"]] = ds["error"].values
    out = group[0].drop_vars(("error", "design")).assign_coords(design=np.arange(width))
    for name in ("stage", "model", "method", "label", "ladder"):  # of any length, or joining would cut them
        out[name] = ("setting", out[name].values.astype(object))
    out["error"] = (("setting", "quantity", "design"), errors, dict(group[0]["error"].attrs))
    out["cost"] = ("setting", _mean(group, lambda ds: ds["cost"].values), dict(group[0]["cost"].attrs))
    return out


def _mean(group: Sequence[xr.Dataset], value: Callable[[xr.Dataset], Any]) -> Any:
    total = sum(int(ds.attrs["designs"]) for ds in group)
    return sum(value(ds) * int(ds.attrs["designs"]) for ds in group) / total


def write_gathered(parts: Sequence[str], sizes_path: str, out: str) -> None:
    """Gather the parts, and add the designs and the versions with which the measurement can be repeated."""

    sizes = load_sizes(sizes_path)
    sets = [xr.load_dataset(path) for path in parts]
    ds = gather(sets, sample(max(*sizes.designs.values(), sizes.stages), sizes.seed))
    ds.attrs.update(
        title="Error against cost of stages and contact models",
        Conventions="CF-1.11",
        seed=sizes.seed,
        paper_table=json.dumps(paper_table()),
        versions=json.dumps(versions()),
        git_commit=git_commit(),
    )
    encoding = {"error": {"zlib": True, "complevel": 4}}
    write_whole(Path(out), lambda beside: ds.to_netcdf(beside, encoding=encoding))
