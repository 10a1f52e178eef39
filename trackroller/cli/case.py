"""Commands about one case."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.roller.point_files import files_beside
from trackroller.errors import InputError, unknown_name
from trackroller.materials.yaml_file import parse_yaml, read_mapping
from trackroller.parameters import OPTIONS, REGIMES
from trackroller.roller.case import FIELDS, Case
from trackroller.study.files import WorkError, write_whole

if TYPE_CHECKING:
    import xarray as xr


def settings_of(words: list[str]) -> dict[str, Any]:
    """Mapping from key=value words; values are read as YAML."""
    found: dict[str, Any] = {}
    for word in words:
        key, sign, value = word.partition("=")
        if not sign or not key:
            raise InputError("--set", word, "key=value", "For example --set friction_coefficient=0.1")
        if len(word.splitlines()) > 1:
            raise InputError("--set", word, "one key=value on one line", "Give --set once for each key.")
        found[key.strip()] = parse_yaml(value, f"--set {key}")
    return found


def case_of(path: Path | None, words: list[str]) -> tuple[Case, dict[str, Any]]:
    """Case and options from a case file and --set words."""
    values = (read_mapping(path, "case file") if path is not None else {}) | settings_of(words)
    for key in values:
        if key not in (*FIELDS, *OPTIONS):
            raise unknown_name("case field", key, (*FIELDS, *OPTIONS))
    options = {key: values.pop(key) for key in OPTIONS if key in values}
    for key in options:
        if OPTIONS[key].kind == "words" and isinstance(options[key], str):
            options[key] = [part.strip() for part in options[key].split(",")]
    with files_beside(path):
        return Case.from_dict(values), options


def solve_case(path: Path | None, words: list[str], **more: Any) -> xr.Dataset:
    """Solve the case of a file and --set words."""
    from trackroller.roller.solver import solve

    case, options = case_of(path, words)
    return solve(case, **(options | more))


def writable(out: Path) -> Path:
    """Return the file to write for the path that a user gave.

    The target of a symbolic link is written, and the link stays.

    Raises
    ------
    InputError
        If the folder is missing, or `out` is there and is not a regular file.
    """
    target = Path(os.path.realpath(out))
    if target.exists() and not target.is_file():
        raise InputError("--out", str(out), "the path of a regular file", "Give the name of a file to write.")
    if not target.parent.is_dir():
        raise InputError("--out", str(out), "a file in a folder that exists", f"Create the folder {target.parent}.")
    return target


def write_result(dataset: xr.Dataset, target: Path) -> None:
    """Write a result as netCDF, whole or not at all; `target` comes from `writable`."""
    write_whole(target, lambda beside: dataset.to_netcdf(beside, engine="netcdf4"))


def _json(value: Any) -> Any:
    if isinstance(value, list):
        return [_json(v) for v in value]
    if isinstance(value, float) and not np.isfinite(value):
        return None if np.isnan(value) else str(value)
    return value


def print_json(dataset: xr.Dataset) -> None:
    """Print a result as JSON: values, dims and units by name; NaN is null, infinity a text."""
    told = {
        str(name): {
            "dims": list(variable.dims),
            "units": variable.attrs.get("units", "1"),
            "value": _json(variable.values.tolist()),
        }
        for name, variable in dataset.variables.items()
    }
    told["regime"]["meaning"] = np.array(REGIMES)[dataset["regime"].values].tolist()
    print(json.dumps(told))


def as_text(dataset: xr.Dataset) -> None:
    """Print a result as a table: contacts and bodies side by side; quantities without a value are named below."""
    from rich.console import Console
    from rich.table import Table

    columns = [(), (1,), (2,), (1, "roller"), (1, "guide"), (2, "roller"), (2, "guide")]
    regime = REGIMES[int(dataset["regime"])]
    converged = "converged" if int(dataset["converged"]) else "NOT converged"
    console = Console(width=None if Console().is_terminal else 140)
    console.print(f"regime: {regime}, {converged}")
    if "reason" in dataset:
        console.print(f"reason: {dataset['reason'].item()}", highlight=False, markup=False)
    undefined = []
    for dims in ((), ("contact",), ("contact", "body")):
        names = [
            n for n, v in dataset.data_vars.items() if v.dims == dims and n not in ("regime", "converged", "reason")
        ]
        blank = [n for n in names if np.isnan(dataset[n].values.astype(float)).all()]
        undefined += [str(n) for n in blank]
        if len(names) == len(blank):
            continue
        table = Table("quantity", "unit", title=", ".join(dims) or None, title_justify="left")
        heads = [c for c in columns if len(c) == len(dims)]
        for head in heads:
            table.add_column(" ".join(str(h) for h in head) if dims else "value", justify="right")
        for name in names:
            if name not in blank:
                values = np.atleast_1d(dataset[name].values.ravel())
                table.add_row(str(name), str(dataset[name].attrs.get("units", "")), *[f"{v:.6g}" for v in values])
        console.print(table)
    if undefined:
        console.print(f"undefined here: {', '.join(undefined)}")
    fields = [str(n) for n, v in dataset.data_vars.items() if v.ndim > 2]
    if fields:
        console.print(f"fields (write them with -o): {', '.join(fields)}")


def is_failed(dataset: xr.Dataset) -> bool:
    """Has the one case of a result no solution?"""
    return REGIMES[int(dataset["regime"])] == "failed"


def plot_target(target: str, words: list[str], out: Path | None, results: Path) -> None:
    """Draw a case file's case, or a study's figures."""
    path = Path(target)
    if path.suffix in (".yaml", ".yml") and not is_study(path):
        from trackroller.report.figures.contact import plot_case

        dataset = solve_case(path, words, outputs=("forces", "contact", "peak_stress", "tractions", "subsurface"))
        if is_failed(dataset):
            raise WorkError(f"{path} has no solution to draw: {dataset['reason'].item()}")
        folder = out or Path(f"{path.stem}-figures")
        drawn = plot_case(dataset, folder)
    else:
        from trackroller.report.figures.study import draw_all
        from trackroller.study.plan import study_folder
        from trackroller.study.status import find_study

        place = study_folder(find_study(target, results).name, results)
        if not place.gathered.is_file():
            raise InputError("study", target, f"{place.gathered} is not there yet", "Run the study first.")
        folder = out or place.root / "figures"
        drawn = draw_all(place.gathered, folder)
    print(f"{len(drawn)} figures in {folder}")


def is_study(path: Path) -> bool:
    """A file with factors, a name or a design is a study's, any other a case's."""
    return bool({"factors", "name", "design"} & set(read_mapping(path, "case file")))
