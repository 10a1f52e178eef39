"""The contact patches of one case, by Hertz's ellipse or by the loaded elements of a solved
pressure; and its name.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from contourpy import contour_generator
from matplotlib.path import Path

from trackroller.parameters import MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS, REGIME_LABELS
from trackroller.report.numbers import capital, level_text, listing, long_name, rounded, setting
from trackroller.roller.dataset import solved_by
from trackroller.roller.stored_inputs import CASE, inputs_of, is_default

# share of the largest pressure; smaller values are residuals of the solution, not loads
SLIGHT = 1e-3


class DrawnPatch:
    """One contact: x (nx), y (ny) [mm], fields (ny, nx), and where it carries pressure."""

    def __init__(self, ds: xr.Dataset, contact: int) -> None:
        self.contact = contact
        self.ds = ds.sel(contact=contact)
        self.x, self.y = self.ds["patch_x"].values, self.ds["patch_y"].values
        self.solved = ds.attrs.get("normal") == "halfspace" and "pressure" in self.ds
        self.a = float(self.ds.get("semi_axis_lateral", np.max(np.abs(self.x))))
        self.b = float(self.ds.get("semi_axis_rolling", np.max(np.abs(self.y))))

    @property
    def there(self) -> bool:
        """Return whether the contact exists."""
        return bool(
            np.isfinite(self.x).all() and np.isfinite(self.y).all() and np.isfinite(self.a * self.b)
        )

    def field(self, name: str) -> np.ndarray:
        """Return a field with 0 where it is not defined."""
        return np.nan_to_num(self.ds[name].values)

    @property
    def inside(self) -> np.ndarray:
        """Return which points or elements of the grid carry pressure."""
        if self.solved:
            return _bears(self.ds)
        return (self.x[None, :] / self.a) ** 2 + (self.y[:, None] / self.b) ** 2 < 1.0

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Return the ends of the patch: left, right, rear, front [mm]."""
        if not self.solved:
            return -self.a, self.a, -self.b, self.b
        across, along = _strips(self.ds, "x"), _strips(self.ds, "y")
        return across[0][0], across[-1][1], along[0][0], along[-1][1]

    def summed(self, values: np.ndarray) -> np.ndarray:
        """Integrate a field over y, or a profile over x.

        Values of elements are summed; between points of a grid the trapezoidal rule holds.
        """
        if values.ndim == 2:
            places = self.y
        else:
            places = self.x
        if self.solved:
            return values.sum(axis=0) * (places[1] - places[0])
        return np.trapezoid(values, places, axis=0)

    def framed(self, field: np.ndarray, rim: float | None = None) -> tuple[np.ndarray, ...]:
        """Return x, y and a field with one more row and column of elements on each side.

        The new elements have the value `rim`, or that of their neighbour.
        """
        wide = [
            np.concatenate([[2 * v[0] - v[1]], v, [2 * v[-1] - v[-2]]]) for v in (self.x, self.y)
        ]
        if rim is None:
            return *wide, np.pad(field, 1, mode="edge")
        return *wide, np.pad(field, 1, constant_values=rim)

    @property
    def spin_pole(self) -> tuple[float, float] | None:
        """Return the place of the spin pole of full sliding [mm]; other contact models have no spin
        pole.
        """
        if "spin_pole_lateral" not in self.ds or solved_by(self.ds).item() != "sliding":
            return None
        return float(self.ds["spin_pole_lateral"]), float(self.ds.get("spin_pole_rolling", 0.0))


def patches_of(ds: xr.Dataset, *names: str) -> list[DrawnPatch]:
    """Return the contacts that exist, or none if a field of `names` is missing."""
    if not all(n in ds for n in ("patch_x", "patch_y", *names)):
        return []
    return [p for p in (DrawnPatch(ds, int(c)) for c in ds["contact"].values) if p.there]


def _bears(part: xr.Dataset) -> np.ndarray:
    """Return the loaded elements (ny, nx) of one contact whose pressure was solved on a grid."""
    pressure = np.nan_to_num(part["pressure"].values)
    return pressure > SLIGHT * pressure.max()


def _strips(part: xr.Dataset, axis: str) -> list[tuple[float, float]]:
    """Return the first and last edge [mm] of each run of loaded elements along 'x' or 'y'."""
    other_axis = 1
    if axis == "x":
        other_axis = 0
    centres = part[f"patch_{axis}"].values
    loaded = np.any(_bears(part), axis=other_axis)
    half = 0.5 * (centres[1] - centres[0])
    steps = np.diff(np.concatenate([[0], loaded.astype(int), [0]]))
    starts, ends = np.flatnonzero(steps == 1), np.flatnonzero(steps == -1) - 1
    return [
        (float(centres[i] - half), float(centres[k] + half))
        for i, k in zip(starts, ends, strict=True)
    ]


def widths(part: xr.Dataset, axis: str) -> list[tuple[float, float]]:
    """Return the strips [mm] along 'x' or 'y' in which the contact `part` carries pressure.

    The list is empty if the strips are not known.
    """
    semi = {"x": "semi_axis_lateral", "y": "semi_axis_rolling"}[axis]
    if part.attrs.get("normal") == "halfspace" and "pressure" in part:
        return _strips(part, axis)
    if semi not in part:
        return []
    middle = 0.0
    # the section is drawn about the middle of the patch
    if part.attrs.get("normal") == "halfspace" and axis == "x":
        middle = float(np.mean(part["xz_x"].values))
    return [(middle - float(part[semi]), middle + float(part[semi]))]


def outline(patch: DrawnPatch) -> Path:
    """Return the edge of a patch: an ellipse, or the closed lines around its loaded elements."""
    if not patch.solved:
        circle = Path.unit_circle()
        return Path(np.asarray(circle.vertices) * np.array([patch.a, patch.b]), circle.codes)
    x, y, loaded = patch.framed(patch.inside.astype(float), 0.0)
    rings = contour_generator(x, y, loaded).lines(0.5)
    return Path.make_compound_path(*[Path(np.asarray(ring), closed=True) for ring in rings])


def case_name(ds: xr.Dataset) -> str:
    """Name a case by the inputs that differ from their defaults."""
    if CASE not in ds.attrs:
        return "one case"
    given = {name: value for name, value in inputs_of(ds).items() if not is_default(name, value)}
    texts = [
        setting(n, v)
        for n, v in given.items()
        if n in PARAMETERS and isinstance(v, float) and v == v
    ]
    pair = [str(inputs_of(ds)[name]) for name in MATERIAL_FIELDS]
    if set(given) & set(MATERIAL_FIELDS):
        texts += [level_text("material_pair", " / ".join(pair))]
    texts += [long_name(name) for name in given if name in MAPPING_FIELDS]
    if texts:
        return listing(texts)
    return "default case"


def case_text(ds: xr.Dataset, to_scale: bool) -> str:
    """Return case, regime and normal forces for a caption, as far as the data set holds them."""
    regime = 0
    if "regime" in ds:
        regime = int(ds["regime"])
    if "normal_force" in ds:
        forces = ds["normal_force"].values
    else:
        forces = np.array([])
    text = f"{capital(case_name(ds))}. Regime: {REGIME_LABELS[regime]}"
    loads = [
        f"{rounded(float(f), 4)} N in contact {i + 1}"
        for i, f in enumerate(forces)
        if np.isfinite(f)
    ]
    if loads:
        text += f"; normal force {' and '.join(loads)}."
    else:
        text += "."
    if to_scale:
        return text
    return f"{text} Axes not to one scale."
