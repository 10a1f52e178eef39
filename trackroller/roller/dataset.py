"""Label results as xarray data sets with units, and declare every result variable once
(`VARIABLES`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller import __version__
from trackroller.damage import first_limit, with_limits
from trackroller.damage.limit import variables
from trackroller.numerics.variable import ESTIMATE, LARGEST, SUM
from trackroller.parameters import CONTACT_MODELS, FIRST_TO_FAIL, LIMITS, REGIMES
from trackroller.parameters.accuracy import RUNGS
from trackroller.parameters.validity import VALIDITY

if TYPE_CHECKING:
    import xarray as xr


def file_attributes(title: str, action: str) -> dict[str, str]:
    """Return the global attributes that every netCDF file has, for its title and what the program
    did.

    The history has no time, so that equal results are equal files.
    """
    return {
        "Conventions": "CF-1.11",
        "title": title,
        "history": f"{action} by trackroller {__version__}",
        "source": f"trackroller {__version__}",
    }


# attribute: what limits lack, and the placeholders that they rest on, a sentence a line
NOTES = "limits_notes"
_ODD = {"odd": True}  # the value changes its sign in the mirror image of a roller
_SHOWN = {"shown": True}  # the value stands on the sheet, in the table of cases and in the explorer
_C = ("contact",)
_CB = ("contact", "body")
_PATCH = ("contact", "y", "x")
_XZ = ("contact", "body", "section_z", "section_x")
_YZ = ("contact", "body", "section_z", "section_y")

_GROUPS = {
    "forces": (
        ("normal_force", _C, "N", "F_N", "normal force", _SHOWN),
        ("lateral_force", _C, "N", "F_T", "lateral friction force on the roller", _SHOWN | _ODD),
        ("driving_force", _C, "N", "F_A", "longitudinal friction force on the roller", _SHOWN),
        ("spin_moment", _C, "N mm", "M_R", "spin moment about the contact normal", _SHOWN | _ODD),
        (
            "force_error_estimate",
            _C,
            "1",
            "delta(F)/(mu F_N)",
            "estimated error of F_T and F_A over mu F_N",
            ESTIMATE,
        ),
        (
            "normal_force_error_estimate",
            _C,
            "1",
            "delta(F_N)/F_N",
            "estimated relative error of F_N",
            ESTIMATE,
        ),
        (
            "error_over_tolerance",
            (),
            "1",
            "",
            "largest estimated error over its tolerance, if accuracy is a tolerance",
            ESTIMATE,
        ),
        (
            "slip",
            (),
            "1",
            "xi",
            "longitudinal creepage, > 0 braking",
            _SHOWN | {"label": "longitudinal creepage"},
        ),
        ("rolling_radius_shift", (), "mm", "r_Delta0", "deviation of the rolling radius", _SHOWN),
        (
            "transmitted_force",
            (),
            "N",
            "F_A1 + F_A2",
            "force transmitted to the roller along the track",
            _SHOWN,
        ),
        (
            "drive_torque",
            (),
            "N mm",
            "M_xR",
            "drive torque about the roller's axis, > 0 driving, eq. (10)",
            _SHOWN,
        ),
        (
            "drilling_torque",
            (),
            "N mm",
            "(M_R1 - M_R2) sin(alpha)",
            "drilling torque, the share of the spin moments in the drive torque",
            _SHOWN | {"label": "drilling torque"},
        ),
        (
            "tilting_moment",
            (),
            "N mm",
            "M_yR",
            "tilting moment about the rolling direction, eq. (11)",
            _SHOWN | _ODD,
        ),
        (
            "yaw_moment",
            (),
            "N mm",
            "M_zR",
            "yaw moment about the radial direction, eq. (12)",
            _SHOWN | _ODD,
        ),
    ),
    "contact": (
        ("max_pressure", _C, "MPa", "p_max", "largest contact pressure", _SHOWN | LARGEST),
        ("max_shear", _C, "MPa", "tau_max", "largest surface shear traction", _SHOWN | LARGEST),
        ("semi_axis_lateral", _C, "mm", "a", "lateral semi-axis, or half width of a patch", _SHOWN),
        (
            "semi_axis_rolling",
            _C,
            "mm",
            "b",
            "semi-axis in the rolling direction, or half length",
            _SHOWN,
        ),
        ("patch_area", _C, "mm2", "A", "area of the contact patch"),
        (
            "conformity",
            _C,
            "1",
            "a/R",
            "lateral semi-axis over the smaller lateral radius of both bodies",
            LARGEST,
        ),
        (
            "pressure_model_error",
            _C,
            "1",
            "",
            "relative error of Hertz's largest pressure in a close fit",
            ESTIMATE,
        ),
        (
            "semi_axis_model_error",
            _C,
            "1",
            "",
            "relative error of Hertz's lateral semi-axis in a close fit",
            ESTIMATE,
        ),
        (
            "semi_axis_rolling_model_error",
            _C,
            "1",
            "",
            "relative error of Hertz's semi-axis in the rolling direction in a close fit",
            ESTIMATE,
        ),
        (
            "pressure_centre",
            _C,
            "mm",
            "x_p",
            "lateral position of the resultant of the pressure",
            _ODD,
        ),
        ("spin_pole_lateral", _C, "mm", "x_spin", "lateral position of the spin pole", _ODD),
        (
            "spin_pole_rolling",
            _C,
            "mm",
            "y_spin",
            "position of the spin pole in the rolling direction",
        ),
        (
            "stick_area_fraction",
            _C,
            "1",
            "A_stick/A",
            "adhesion (stick) area over the area of the patch",
            _SHOWN,
        ),
    ),
    "friction_work": (
        (
            "friction_power",
            _C,
            "W",
            "P_f",
            "friction power at the travel speed",
            _SHOWN | SUM | {"label": "friction power"},
        ),
        (
            "friction_energy_per_distance",
            _C,
            "J m-1",
            "W_f",
            "friction energy per distance",
            _SHOWN | SUM,
        ),
        (
            "rolling_resistance",
            (),
            "N",
            "F_r",
            "force along the track that the losses in both contacts take",
        ),
        (
            "friction_energy_balance",
            _C,
            "J m-1",
            "-(xi F_A + phi M_R)",
            "friction energy per distance that the forces and moments imply",
            SUM,
        ),
        (
            "friction_energy_error_estimate",
            _C,
            "1",
            "delta(W_f)/W_f",
            "estimated relative error of the friction energy from discretisation",
            ESTIMATE,
        ),
        (
            "friction_power_model_error",
            _C,
            "1",
            "",
            "relative error of the friction power of Hertz's patch in a close fit",
            ESTIMATE,
        ),
        (
            "energy_residual",
            (),
            "1",
            "",
            "relative difference of friction energy and work of the drive",
        ),
    ),
    "peak_stress": (
        (
            "peak_stress",
            _CB,
            "MPa",
            "sigma_DEH,max",
            "largest von Mises stress of the body",
            LARGEST | {"label": "peak stress"},
        ),
        (
            "peak_stress_model_error",
            _C,
            "1",
            "",
            "relative error of peak stresses below Hertz's pressure in a close fit",
            ESTIMATE,
        ),
        ("peak_x", _CB, "mm", "x_C", "lateral position of the peak stress", _ODD),
        ("peak_y", _CB, "mm", "y_C", "position of the peak stress in the rolling direction"),
        ("peak_z", _CB, "mm", "z_C", "depth of the peak stress"),
    ),
    "tractions": (
        ("patch_x", ("contact", "x"), "mm", "x_C", "lateral position in the patch", _ODD),
        (
            "patch_y",
            ("contact", "y"),
            "mm",
            "y_C",
            "position in the patch in the rolling direction",
        ),
        ("pressure", _PATCH, "MPa", "p", "contact pressure"),
        ("shear_lateral", _PATCH, "MPa", "tau_x", "lateral shear on the roller", _ODD),
        ("shear_rolling", _PATCH, "MPa", "tau_y", "shear on the roller in the rolling direction"),
        (
            "slip_lateral",
            _PATCH,
            "1",
            "v_x/v",
            "lateral creepage at a point: slip speed over travel speed",
            _ODD,
        ),
        ("slip_rolling", _PATCH, "1", "v_y/v", "creepage at a point in the rolling direction"),
        (
            "friction_energy_density",
            _PATCH,
            "J m-1 mm-2",
            "|tau||v|/v",
            "friction energy per area and distance travelled",
        ),
    ),
    "subsurface": (
        ("xz_x", ("contact", "body", "section_x"), "mm", "x_C", "x in the lateral section", _ODD),
        ("xz_z", ("contact", "body", "section_z"), "mm", "z_C", "depth in the lateral section"),
        ("yz_y", ("contact", "body", "section_y"), "mm", "y_C", "y in the rolling section"),
        ("yz_z", ("contact", "body", "section_z"), "mm", "z_C", "depth in the rolling section"),
        ("von_mises_xz", _XZ, "MPa", "sigma_DEH", "von Mises stress, lateral section at the peak"),
        ("von_mises_yz", _YZ, "MPa", "sigma_DEH", "von Mises stress, rolling section at the peak"),
        ("stress_xz", ("component", *_XZ), "MPa", "sigma_ij", "stresses in the lateral section"),
        ("stress_yz", ("component", *_YZ), "MPa", "sigma_ij", "stresses in the rolling section"),
    ),
    "status": (
        ("residual", (), "1", "", "largest imbalance of forces and torque over the load"),
        ("error_estimate", _CB, "1", "", "estimated relative error of the peak stress", ESTIMATE),
    ),
}

VARIABLES = with_limits(
    {v.name: v for group, rows in _GROUPS.items() for v in variables(group, *rows)},
    (
        v
        for rows in (*(limit.results for limit in LIMITS.values()), first_limit.RESULTS)
        for v in rows
    ),
    "a result",
)


def shown(*dims: str) -> tuple[str, ...]:
    """Return the results that the sheet, the table of cases and the explorer show, of these
    dimensions after `case`.
    """
    return tuple(name for name, v in VARIABLES.items() if v.shown and v.dims == dims)


def validity_bit(name: str) -> int:
    """Return the flag of `validity` (a power of two) that a name of `VALIDITY` stands for."""
    return 1 << list(VALIDITY).index(name)


def solved_by(ds: xr.Dataset) -> np.ndarray:
    """Return the name of the contact model that solved each case, object array in the shape of
    `contact_model_used`.

    The numbers have the meanings that the data set states, because a model of a user takes the next
    free number.
    """
    used = ds.variables["contact_model_used"]
    names = np.array(str(used.attrs["flag_meanings"]).split(), dtype=object)
    return np.asarray(names[used.values], dtype=object)


COMMENTS = {
    "pair_life_hours": "shorter life of roller and guide; the life of the roller where "
    "guide_overrollings_per_hour is "
    "not given and the guide's hours are unknown (first_to_fail is unknown there)",
    "first_to_fail": "none: both lives are unlimited; unknown: the life of the roller or of the "
    "guide is not known",
}

FLAGS: dict[str, tuple[str, Sequence[str]]] = {
    "regime": ("regime of the case", REGIMES),
    "converged": (
        "the residual is within its limit (attribute converged_up_to of residual)",
        ("no", "yes"),
    ),
    "contact_model_used": ("contact model that solved the case", CONTACT_MODELS),
    "accuracy_used": ("accuracy whose result the case has, if a tolerance was asked for", RUNGS),
    "first_to_fail": ("body that fails first, in hours", FIRST_TO_FAIL),
    "limiting_mechanism": ("limit of the body that is reached first", (*LIMITS, "unknown")),
    "limit_state": (
        "whether a limit is kept; open: exceeded at one end of a range of placeholders",
        first_limit.STATES,
    ),
    "stopped": ("the condition of stop_if holds: no peak stress is searched for", ("no", "yes")),
}


def _attributes(name: str) -> dict[str, Any]:
    """Return the attributes of a result variable or a flag."""
    comment = {}
    if name in COMMENTS:
        comment = {"comment": COMMENTS[name]}
    if name in VARIABLES:
        v = VARIABLES[name]
        return (
            {"units": v.units, "long_name": v.long_name}
            | ({"symbol": v.symbol} if v.symbol else {})
            | comment
        )
    if name in FLAGS:
        meaning, words = FLAGS[name]
        attrs = {
            "long_name": meaning,
            "units": "1",
            "flag_values": np.arange(len(words), dtype=np.int8),
        }
        return attrs | comment | {"flag_meanings": " ".join(words)}
    return {
        "long_name": "validity flags: where an assumption of the model does not hold"
        + (" for a body" if name == "validity_body" else ""),
        "units": "1",
        "flag_masks": np.array([1 << i for i in range(len(VALIDITY))], dtype=np.int32),
        "flag_meanings": " ".join(VALIDITY),
        "comment": "; ".join(f"{name}: {flag.criterion}" for name, flag in VALIDITY.items()),
    }


@cache
def _sides() -> xr.Coordinates:
    """Return the coordinates `contact` and `body` with their indexes."""
    import xarray as xr  # heavy, and modules that only read `VARIABLES` do not need it

    return xr.Dataset(
        coords={
            "contact": (
                "contact",
                np.array([1, 2], dtype=np.int32),
                {"long_name": "contact, 1 at +x_R, 2 at -x_R", "units": "1"},
            ),
            "body": ("body", np.array(["roller", "guide"]), {"long_name": "body"}),
        }
    ).coords


def build(
    values: Mapping[str, np.ndarray],
    flags: Mapping[str, np.ndarray],
    attrs: Mapping[str, Any],
    single: bool,
) -> xr.Dataset:
    """Return a labelled data set.

    Parameters
    ----------
    values : mapping of str to numpy.ndarray
        Arrays by their names in `VARIABLES`; the first axis is the case.
    flags : mapping of str to numpy.ndarray
        Arrays of integers, shape (n,), by their names in `FLAGS`, and the flags of
        `VALIDITY` as `validity`, shape (n,), and `validity_body`, shape (n, 2).
    attrs : mapping
        Global attributes.
    single : bool
        Whether to drop the dimension `case`.

    Returns
    -------
    xarray.Dataset
        With the coordinates `contact` and `body`.
    """
    data = dict(values)
    for name, array in flags.items():
        if name in FLAGS:
            data[name] = array.astype(np.int8)
        else:
            data[name] = array.astype(np.int32)
    if not single:
        return _labelled(data, attrs)
    # xarray aligns and merges all variables anew for each data set, which takes longer than a
    # simple solution. A result with the same variables and shapes is therefore copied with the new
    # numbers.
    one = {name: array[0] for name, array in data.items()}
    key = (
        tuple((name, values.shape, values.dtype) for name, values in one.items()),
        str(attrs.get("limits")),
    )
    if key not in _LIKE:
        if len(_LIKE) >= MOST_LIKE:
            _LIKE.clear()
        _LIKE[key] = _labelled(data, attrs).isel(case=0).copy(deep=True)
    ds = _LIKE[key].copy(data=one)
    ds.attrs = dict(attrs)  # `assign_attrs` would copy all variables once more
    return ds


_LIKE: dict[Any, xr.Dataset] = {}  # one result of each kind of call for a single case
MOST_LIKE = 32  # kinds of calls that are kept


def _labelled(data: Mapping[str, np.ndarray], attrs: Mapping[str, Any]) -> xr.Dataset:
    """Return the data set of several cases, see `build`."""
    import xarray as xr  # heavy, and modules that only read `VARIABLES` do not need it

    variables = {}
    for name, array in data.items():
        if name in VARIABLES:
            dims = VARIABLES[name].dims
        else:
            dims = ("limit", "body")[3 - array.ndim :]
        variables[name] = xr.Variable(("case", *dims), array, _attributes(name))
    ds = xr.Dataset(variables, coords=_sides().copy(), attrs=dict(attrs))
    further: dict[str, Any] = {}
    if "utilisation" in data:
        further["limit"] = ("limit", np.array(str(attrs["limits"]).split()), {"long_name": "limit"})
    if any("component" in variable.dims for variable in variables.values()):
        components = np.array(["xx", "yy", "zz", "xy", "yz", "zx"])
        further["component"] = ("component", components, {"long_name": "stress component"})
    if not further:
        return ds
    return ds.assign_coords(further)


def united(parts: Sequence[Mapping[str, Any]], context: Any = None) -> dict[str, Any]:
    """Return the attributes of the first of several results, with the notes on limits of all of
    them.
    """
    notes = [line for part in parts for line in str(part.get(NOTES, "")).split("\n") if line]
    own = dict(next(iter(parts), {}))
    return own | {NOTES: "\n".join(sorted(set(notes)))} if notes else own  # in no order of files


def joined(blocks: Iterable[xr.Dataset]) -> xr.Dataset:
    """Join results of different cases along `case`; what a part lacks is missing there.

    A missing result is NaN, or 0 if it is a whole number; NaN also fills the ends of shorter grids.
    """
    blocks = sorted(blocks, key=lambda block: -len(block.variables))
    whole = {
        name: 0
        for block in blocks
        for name, values in block.variables.items()
        if values.dtype.kind in "iu"
    }
    dims = {dim for block in blocks for dim in block.dims} - {"case"}
    sizes = {dim: max(block.sizes.get(dim, 0) for block in blocks) for dim in dims}
    for i, block in enumerate(blocks):
        short = {
            dim: (0, n - block.sizes[dim])
            for dim, n in sizes.items()
            if block.sizes.get(dim, n) < n
        }
        if short:
            blocks[i] = block.pad(short)
    import xarray as xr  # heavy, and modules that only read `VARIABLES` do not need it

    return xr.concat(
        blocks,
        "case",
        data_vars="all",
        coords="minimal",
        compat="override",
        join="override",
        combine_attrs=united,
        fill_value=whole,
    )
