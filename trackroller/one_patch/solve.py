"""Solve one contact by itself by the exact theory, and label the result."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from trackroller.contact.friction_laws import FrictionLaw, steepness
from trackroller.contact.hertz import contact_modulus, shape
from trackroller.contact.kalker import Creepage, KalkerSettings, discs, solve_patch, to_tractions
from trackroller.contact.kalker.kalker_model import LEAST_UNDER_LAW
from trackroller.contact.kalker.problem import PatchSolution
from trackroller.contact.quantities import Elastic, Ellipse, SurfaceTractions
from trackroller.numerics.variable import Variable
from trackroller.one_patch.inputs import SEMI_AXES, PatchInputs, checked_patch
from trackroller.parameters.accuracy import PRESETS
from trackroller.parameters.patch_fields import PATCH_FIELDS
from trackroller.parameters.validity import VALIDITY
from trackroller.roller.dataset import VARIABLES, file_attributes
from trackroller.roller.stages.mechanics import MM_PER_S

# largest residual of the friction law over mu p_max, as in the balance of a roller
TOLERANCE = 1e-8
CONVENTIONS = (
    "x lateral, y in the rolling direction; forces and tractions act on body 1; creepage is the "
    "velocity of body 1 less that of body 2, over the travel speed, so that the force has the sign "
    "opposite to the creepage; the spin moment is about the contact normal, which points into "
    "body 1"
)
_OWN = {
    "friction_force_share": Variable(
        "friction_force_share",
        "forces",
        (),
        "1",
        "|F|/(mu F_N)",
        "friction force over its bound mu F_N at rest",
    ),
}
RESULTS = (
    *(
        "lateral_force",
        "driving_force",
        "spin_moment",
        "friction_force_share",
        "force_error_estimate",
    ),
    *("max_pressure", "semi_axis_lateral", "semi_axis_rolling", "stick_area_fraction"),
    *("friction_power", "friction_energy_per_distance", "residual"),
)
FLAGS = {
    "converged": "the residual of the friction law is within its limit",
    "steep_friction": VALIDITY["steep_friction"].words,
}
FIELDS = ("pressure", "shear_lateral", "shear_rolling", "slip_lateral", "slip_rolling")


def patch(  # noqa: PLR0913 - one argument for each field
    normal_force: Any,
    *,
    materials: Any,
    friction_coefficient: Any = None,
    curvature_rolling: Any = None,
    curvature_lateral: Any = None,
    semi_axes: Any = None,
    width: Any = None,
    longitudinal_creepage: Any = 0.0,
    lateral_creepage: Any = 0.0,
    spin: Any = 0.0,
    layer_flexibility: Any = 0.0,
    friction_law: Mapping[str, Any] | FrictionLaw | None = None,
    velocity: Any = 60.0,
    accuracy: str = "standard",
    name: str = "patch",
) -> xr.Dataset:
    """Solve one contact by the exact theory of rolling with friction: two bodies, given load and
    creepages.

    A number may be a list or an array of n values, one a case; single numbers hold in every case.
    Texts with units, such as '2 kN' and '0.1 %', are taken too.

    Parameters
    ----------
    normal_force : float or array_like, shape (n,)
        F_N [N].
    materials : str, mapping or pair of these
        Material of both bodies, or of body 1 and body 2: a name of the database, or a mapping, of
        which `youngs_modulus` [MPa] and `poisson_ratio` are enough.
    friction_coefficient : float or array_like, shape (n,), optional
        Friction coefficient mu [1], at rest. A friction law of kind table brings its own.
    curvature_rolling, curvature_lateral : float or array_like, shape (n,), optional
        Relative curvatures [1/mm]: the sum of 1/radius of both bodies in the rolling plane and
        across it. A lateral curvature of 0 stands for two discs.
    semi_axes : pair of float or array_like, optional
        Semi-axes (a, b) of the ellipse [mm] in place of curvatures; a lies across the rolling
        direction.
    width : float or array_like, shape (n,), optional
        Width of two discs [mm].
    longitudinal_creepage, lateral_creepage : float or array_like, shape (n,)
        Creepages xi and eta of body 1 against body 2 [1], from -1 to 1.
    spin : float or array_like, shape (n,)
        Spin creepage phi [1/mm]; 0 for discs.
    layer_flexibility : float or array_like, shape (n,)
        Thickness over shear modulus of a film between the bodies [mm^3/N]; 0 is no film.
    friction_law : mapping or FrictionLaw, optional
        Friction as a function of the slip speed, as in a case.
    velocity : float or array_like, shape (n,)
        Travel speed [m/min], for the friction power and friction laws.
    accuracy : str
        'preview', 'standard' or 'reference'.
    name : str
        Name of the contact, for its page.

    Returns
    -------
    xarray.Dataset
        Along `case`, if a value was a list: `lateral_force`, `driving_force` [N], `spin_moment` [N
        mm], `friction_force_share`, `force_error_estimate` (over mu F_N), `stick_area_fraction`,
        `friction_power` [W], `max_pressure` [MPa], semi-axes [mm], `converged` and `residual`; the
        fields `pressure`, `shear_lateral`, `shear_rolling`, `slip_lateral`, `slip_rolling` over `y`
        and `x` with their places `patch_x` and `patch_y` [mm]; and the inputs. Discs have one
        column of elements.

    Raises
    ------
    InputError
        If a value is wrong; the error names it, what is allowed and what to do.

    Notes
    -----
    Valid for half-spaces, steady rolling and dry friction, and discs much wider than their contact.
    The friction power is the work of forces and spin moment on the creepages, and that of the
    pressures on unlike bodies. Elastic bodies have one solution for a patch; a roller in its
    balance has `trackroller.solve`.

    References
    ----------
    Kalker, J. J. (1990). Three-Dimensional Elastic Bodies in Rolling Contact. Kluwer.

    Examples
    --------
    >>> import trackroller as tr
    >>> steel = {"youngs_modulus": 210e3, "poisson_ratio": 0.28}
    >>> ds = tr.patch(1000, semi_axes=(0.6, 0.4), materials=steel, friction_coefficient=0.3,
    ...               longitudinal_creepage=[0, "0.1 %", "5 %"], accuracy="preview")
    >>> ds["friction_force_share"].round(2).values.tolist()
    [0.0, 0.23, 1.0]
    """
    given = dict(locals())
    return solved_patch(checked_patch(given))


def solved_patch(inputs: PatchInputs) -> xr.Dataset:
    """Return the labelled result of checked inputs, see `patch`."""
    if inputs.is_discs:
        solution, surface, contact = _solve_discs(inputs)
    else:
        solution, surface, contact = _solve_ellipses(inputs)
    flags = {"converged": solution.converged, "steep_friction": _is_steep(inputs, contact, surface)}
    return _labelled(inputs, contact | _results(inputs, solution), surface, flags)


def _elastic(inputs: PatchInputs) -> Elastic:
    """Return the combined constants of both bodies in every case."""
    constants = (np.full(inputs.size, value) for value in inputs.elastic_constants)
    elastic = Elastic.of_pair(*constants)
    return replace(elastic, layer_flexibility=inputs.columns["layer_flexibility"])


def _modulus(inputs: PatchInputs) -> np.ndarray:
    return np.full(inputs.size, contact_modulus(*inputs.elastic_constants))


def _creepage(inputs: PatchInputs) -> Creepage:
    own = inputs.columns
    return Creepage(own["longitudinal_creepage"], own["lateral_creepage"], own["spin"])


def _ellipses(inputs: PatchInputs) -> Ellipse:
    """Return the ellipses of given semi-axes, or by Hertz's theory from the curvatures."""
    own = inputs.columns
    if SEMI_AXES[0] in own:
        a, b = (own[name] for name in SEMI_AXES)
        return Ellipse(a, b, 1.5 * own["normal_force"] / (np.pi * a * b))
    curved = own["curvature_lateral"], own["curvature_rolling"]
    return shape(*curved, _modulus(inputs)).at(own["normal_force"])


def _solve_ellipses(
    inputs: PatchInputs,
) -> tuple[PatchSolution, SurfaceTractions, dict[str, np.ndarray]]:
    """Return solution, fields, and sizes and pressures by their names."""
    own = inputs.columns
    ellipse = _ellipses(inputs)
    elements = PRESETS[inputs.accuracy].elements
    if not inputs.law.is_constant:
        elements = max(elements, LEAST_UNDER_LAW)
    settings = KalkerSettings(elements, tolerance=TOLERANCE, law=inputs.law)
    friction = own["friction_coefficient"]
    travel = own["velocity"] * MM_PER_S
    solution = solve_patch(
        ellipse, _creepage(inputs), friction, _elastic(inputs), settings, travel_speed=travel
    )
    contact = {
        "semi_axis_lateral": ellipse.semi_axis_lateral,
        "semi_axis_rolling": ellipse.semi_axis_rolling,
        "max_pressure": ellipse.max_pressure,
    }
    return solution, to_tractions(ellipse, friction, solution), contact


def _solve_discs(
    inputs: PatchInputs,
) -> tuple[PatchSolution, SurfaceTractions, dict[str, np.ndarray]]:
    """Return solution, fields, and sizes and pressures by their names, of two discs."""
    own = inputs.columns
    line = discs.LineContact.of_load(
        own["normal_force"], own["width"], own["curvature_rolling"], _modulus(inputs)
    )
    friction = own["friction_coefficient"]
    travel = own["velocity"] * MM_PER_S
    settings = KalkerSettings(tolerance=TOLERANCE, law=inputs.law)
    elements = discs.ELEMENTS[inputs.accuracy]
    solution = discs.solve_discs(
        line, _creepage(inputs), friction, _elastic(inputs), elements, settings, travel
    )
    contact = {
        "semi_axis_lateral": 0.5 * line.width,
        "semi_axis_rolling": line.half_length,
        "max_pressure": line.max_pressure,
    }
    return solution, discs.to_tractions(line, friction, solution), contact


def _is_steep(
    inputs: PatchInputs, contact: Mapping[str, np.ndarray], surface: SurfaceTractions
) -> np.ndarray:
    """Return where friction falls faster with the slip speed than the surfaces follow, (n,)."""
    own = inputs.columns
    elastic = _elastic(inputs)
    bound = own["friction_coefficient"] * contact["max_pressure"]
    element = 2.0 * contact["semi_axis_rolling"] / surface.y.shape[1]
    travel = own["velocity"] * MM_PER_S
    return steepness(inputs.law, bound, travel, elastic.shear_modulus, elastic.film, element) > 1.0


def _results(inputs: PatchInputs, solution: PatchSolution) -> dict[str, np.ndarray]:
    """Return forces, works and adhesion by their names, each (n,)."""
    own = inputs.columns
    force = solution.resultants
    bound = own["friction_coefficient"] * own["normal_force"]
    work = -(
        own["longitudinal_creepage"] * force.driving_force
        + own["lateral_creepage"] * force.lateral_force
        + own["spin"] * force.spin_moment
    )
    dissipated = work + solution.pressure_work
    with np.errstate(divide="ignore", invalid="ignore"):
        used = np.hypot(force.lateral_force, force.driving_force) / bound
        error = np.maximum(solution.force_error / bound, TOLERANCE)
    return {
        "lateral_force": force.lateral_force,
        "driving_force": force.driving_force,
        "spin_moment": force.spin_moment,
        "friction_force_share": used,
        "force_error_estimate": error,
        "stick_area_fraction": solution.stick_fraction,
        "friction_energy_per_distance": dissipated,  # N, which is J/m
        "friction_power": dissipated * own["velocity"] / 60.0,
        "residual": solution.residual,
    }


def _labelled(
    inputs: PatchInputs,
    values: Mapping[str, np.ndarray],
    surface: SurfaceTractions,
    flags: Mapping[str, np.ndarray],
) -> xr.Dataset:
    """Return results and inputs as a data set; without the dimension `case` if no value was a
    list.
    """
    variables: dict[str, Any] = {}
    for name, column in inputs.columns.items():
        declared = PATCH_FIELDS[name]
        attrs = {
            "units": declared.units,
            "symbol": declared.symbol,
            "long_name": declared.long_name,
        }
        variables[name] = ("case", column, attrs | {"comment": declared.meaning})
    for name in RESULTS:
        variables[name] = ("case", values[name], _attributes(name))
    for name, words in FLAGS.items():
        variables[name] = ("case", flags[name].astype(np.int8), {"long_name": words, "units": "1"})
    variables["patch_x"] = (("case", "x"), surface.x, _attributes("patch_x"))
    variables["patch_y"] = (("case", "y"), surface.y, _attributes("patch_y"))
    for name in FIELDS:
        variables[name] = (("case", "y", "x"), getattr(surface, name), _attributes(name))
    variables["stick"] = (
        ("case", "y", "x"),
        surface.stick.astype(np.int8),
        {"long_name": "adhesion", "units": "1"},
    )
    first, second = inputs.bodies
    attrs = file_attributes(f"contact patch {inputs.name}", "patch solved") | {
        "patch": inputs.name,
        "description": inputs.description,
        "materials": json.dumps([vars(first), vars(second)]),
        "friction_law": json.dumps(inputs.law.as_dict()),
        "accuracy": inputs.accuracy,
        "kind": "discs" if inputs.is_discs else "ellipse",
        "conventions": CONVENTIONS,
    }
    ds = xr.Dataset(variables, attrs=attrs)
    return ds.isel(case=0) if inputs.single else ds


def _attributes(name: str) -> dict[str, str]:
    """Return unit, symbol and name of a result."""
    own = _OWN.get(name) or VARIABLES[name]
    return {"units": own.units, "symbol": own.symbol, "long_name": own.long_name}
