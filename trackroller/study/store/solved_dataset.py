"""Label the results of a study: a grid gets a dimension for each factor, a sample the dimension
`case`.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.materials.database import FRICTION
from trackroller.methods import Design
from trackroller.methods.factor import Factor, readable
from trackroller.numerics.numbers import all_equal
from trackroller.parameters import FRICTION_LEVELS, MATERIAL_FIELDS
from trackroller.roller.stored_inputs import MATERIALS, materials_of_design
from trackroller.study.design.carriage_cases import of_worst_rollers
from trackroller.study.design.stored import FACTOR, META, PLACE
from trackroller.study.outputs import OF_UNITS, OF_WORD, is_constant_field
from trackroller.study.store import provenance

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

Variables = dict[Hashable, tuple[tuple[Hashable, ...], np.ndarray, dict[str, Any], dict[str, Any]]]


def labelled(study: Study, plan: Design, cases: xr.Dataset, solved: xr.Dataset) -> xr.Dataset:
    """Return the data set of a solved study.

    Parameters
    ----------
    study : Study
        The study.
    plan : Design
        Its design.
    cases : xarray.Dataset
        Its n cases, as `Study.design` returns them; for a study of a carriage those of all its
        rollers.
    solved : xarray.Dataset
        Their results, each with `case` as its first dimension, with the coordinates of the other
        dimensions and the attributes of the solver.

    Returns
    -------
    xarray.Dataset
        Results with factors, parameters that vary and the places of the design as coordinates. The
        attributes hold the parameters that all cases share, what is needed to repeat the study, and
        the study file itself.
    """
    if study.carriage is not None:
        cases, solved = of_worst_rollers(study.config, plan, study.materials, cases, solved)
    grid = plan.factors if plan.method.crossed else {}
    if grid:
        shape = plan.meta["shape"]
    else:
        shape = (cases.sizes["case"],)
    sizes = dict(zip(grid or ("case",), shape, strict=True))
    unstacked = {
        name: _variable((*sizes, *v.dims[1:]), v.values.reshape(*shape, *v.shape[1:]), v.attrs)
        for name, v in solved.data_vars.items()
    }
    coords = _labels(cases, sizes, grid)
    for name, v in solved.coords.items():
        if "case" not in v.dims:
            coords.setdefault(name, _variable(v.dims, v.values, v.attrs, coordinate=True))
    shared = {name: label for name, label in coords.items() if _is_shared(name, label[0])}
    coords = {name: label for name, label in coords.items() if name not in shared}
    attrs = _attributes(study, cases, solved.attrs) | _constants(shared)
    return xr.Dataset(unstacked, coords, attrs)


def _is_shared(name: Hashable, dims: tuple[Hashable, ...]) -> bool:
    """Return whether a label is an input that all cases share."""
    return not dims and is_constant_field(str(name))


def _constants(shared: Variables) -> dict[str, float | str]:
    """Return the inputs that all cases share as attributes, each number with its unit beside it.

    A number that no case gives is NaN.
    """
    attrs: dict[str, float | str] = {}
    for name, (_, values, words, _) in shared.items():
        attrs[str(name)] = values.item()
        if "units" in words:
            attrs[f"{name}{OF_UNITS}"] = words["units"]
    return attrs


def _attributes(study: Study, design: xr.Dataset, attrs: Mapping[str, Any]) -> dict[str, Any]:
    """Return the global attributes: what the solver wrote, and what is needed to repeat the
    study.
    """
    of_study = {*study.factors, "seconds", "date_solved"}  # earlier versions dated their chunks
    of_solver = {
        k: v for k, v in attrs.items() if isinstance(v, (str, int, float)) and k not in of_study
    }
    # what `solve` recorded of its materials holds, whatever the database says by now
    if MATERIALS in attrs:
        materials = attrs[MATERIALS]
    else:
        materials = materials_of_design(design, study.materials)
    of_design = {k: design.attrs[k] for k in (META, FRICTION) if k in design.attrs}
    return of_solver | of_design | provenance.attributes(study) | {MATERIALS: materials}


def _labels(design: xr.Dataset, sizes: dict[str, int], grid: dict[str, Factor]) -> Variables:
    """Return the axes of a grid, the number of each case, and every parameter over the axes that it
    depends on.
    """
    labels: Variables = {}

    def add(name: str, dims: tuple[str, ...], values: np.ndarray) -> None:
        attrs = {"long_name": name.replace("_", " ")}
        column = design.get(name.removesuffix(OF_WORD))
        if column is not None:
            attrs = column.attrs
        labels.setdefault(name, _variable(dims, values, attrs, coordinate=True))

    for name, dim, values in _axes(grid, sizes):
        add(name, (dim,), values)
    number = design["case"].values
    words = {"long_name": "case number, for `trackroller repeat`", "units": "1"}
    labels["case"] = _variable(
        tuple(sizes), number.reshape(*sizes.values()), words, coordinate=True
    )
    columns = {
        str(name): v.values
        for name, v in design.variables.items()
        if v.dims == ("case",) and name != "case"
    }
    for name, values in columns.items():
        if name in grid and set(grid[name].levels) & {*FRICTION_LEVELS, None}:
            name = f"{name}{OF_WORD}"
        add(name, *_varying(values.reshape(*sizes.values()), list(sizes)))
    for name in (PLACE, FACTOR):
        if name in design.variables:
            coordinate = design[name]
            labels[name] = _variable(
                coordinate.dims, coordinate.values, coordinate.attrs, coordinate=True
            )
    return labels


def _axes(grid: dict[str, Factor], sizes: dict[str, int]) -> Iterator[tuple[str, str, np.ndarray]]:
    """Yield name, dimension and values of each axis of a grid; one of pairs of materials has both
    bodies' names.
    """
    for dim, factor in grid.items():
        yield dim, dim, readable(factor.take(np.arange(sizes[dim])))
        if dim == "material_pair":
            for i, name in enumerate(MATERIAL_FIELDS):
                yield name, dim, np.array([pair[i] for pair in factor.levels], dtype=object)


def _varying(values: np.ndarray, dims: list[str]) -> tuple[tuple[str, ...], np.ndarray]:
    """Return the dimensions that values depend on, and the values over these dimensions."""
    for dim in tuple(dims):
        axis = dims.index(dim)
        if all_equal(np.moveaxis(values, axis, 0)):
            values = values.take([0], axis=axis).squeeze(axis)
            dims.remove(dim)
    return tuple(dims), values


def _variable(
    dims: tuple[Hashable, ...], values: np.ndarray, attrs: dict[str, Any], coordinate: bool = False
) -> tuple[tuple[Hashable, ...], np.ndarray, dict[str, Any], dict[str, Any]]:
    """Return dimensions, values, attributes and encoding of a variable of the file; only results
    have a fill value.
    """
    encoding: dict[str, Any] = {"coordinates": None}  # one attribute of the file lists all of them
    encoding["_FillValue"] = None
    if values.dtype.kind == "f" and not coordinate:
        encoding["_FillValue"] = np.nan
    if dims and values.dtype.kind not in "OSU":
        encoding |= {"zlib": True, "complevel": 4, "shuffle": True}
    flags = ("flag_values", "flag_masks")  # these take the type of their variable
    typed = {key: np.asarray(attrs[key], values.dtype) for key in flags if key in attrs}
    return tuple(dims), values, {**attrs, **typed}, encoding
