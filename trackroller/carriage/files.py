"""Files that follow from a solved carriage: the load spectrum of a roller, and a study of the worst loads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from trackroller.carriage.file import Carriage
from trackroller.carriage.solve import cases_of
from trackroller.errors import InputError, check_names
from trackroller.materials import load_database
from trackroller.parameters import OPTIONS
from trackroller.roller.doubts import doubts
from trackroller.roller.settings import LOADS, parts_for_spectrum


def doubts_of_carriage(whole: Carriage, ds: xr.Dataset) -> list[str]:
    """Return a sentence for each unusual value of the rollers under their loads, see `trackroller.roller.doubts`.

    The ratings of a maker's catalogue are compared with the smallest load that presses their roller.
    """
    sentences: list[str] = []
    cases = cases_of(whole, ds)
    for j, roller in enumerate(whole.rollers):
        own = [case.as_dict() for (_, k), case in cases.items() if k == j]
        if own and roller.case is not None:
            loads = {name: [case[name] for case in own] for name in LOADS}
            used = (roller.case.roller_material, roller.case.guide_material)
            found = doubts(own[0] | loads, map(load_database().material, used))
            sentences += [f"rollers.{roller.name}.roller: {text}" for text in found]
        if roller.catalogue is not None:
            rated = {"radial": roller.catalogue.radial_force, "axial": roller.catalogue.axial_force}
            found = doubts({"radial_force": ds["radial_force"].values[:, j], "catalogue": rated})
            names = [text.replace("radial =", "radial_force =").replace("axial =", "axial_force =") for text in found]
            sentences += [f"rollers.{roller.name}.{text}" for text in names if text.startswith("catalogue")]
    seen = dict[str, str]()  # rollers of the same file say the same
    for text in sentences:
        seen.setdefault(text.partition(": ")[2] or text, text)
    return list(seen.values())


def spectrum_of(whole: Carriage, ds: xr.Dataset, name: str) -> dict[str, Any]:
    """Return the load spectrum of a roller, as the keys of a spectrum file.

    Parameters
    ----------
    whole : Carriage
        The carriage.
    ds : xarray.Dataset
        Its solution by `trackroller.carriage`.
    name : str
        The roller.

    Returns
    -------
    dict
        One block for each load case in which the roller carries load. The description states the share of the travel
        without load, because a roller without radial force is no case.

    Raises
    ------
    InputError
        If there is no such roller, if its file is not given, or if it carries no load in any case.
    """
    check_names("--spectrum", [name], [roller.name for roller in whole.rollers])
    j = [roller.name for roller in whole.rollers].index(name)
    roller = whole.rollers[j]
    if roller.case is None:
        raise InputError(f"rollers.{name}.roller", None, "the file of the roller", "Add roller: FILE.")
    cases = {i: case for (i, own), case in cases_of(whole, ds).items() if own == j}
    if not cases:
        raise InputError("--spectrum", name, "a roller that carries load in a load case", "Name another roller.")
    blocks = [
        {
            "name": whole.cases[i].name,
            "distance": _short(whole.cases[i].share * whole.distance),
            "velocity": _short(case.velocity),
            **{load: _short(getattr(case, load)) for load in LOADS},
        }
        for i, case in cases.items()
    ]
    lifted = [case for i, case in enumerate(whole.cases) if i not in cases]
    share = sum(case.share for case in lifted)
    text = f"Roller {name} of {whole.name}, {whole.distance:g} m of travel per shift."
    if lifted:
        named = ", ".join(case.name for case in lifted)
        text += f" No block holds {100 * share:.4g} % of the travel, in which the roller is lifted: {named}."
    base, options = parts_for_spectrum(roller.given)
    head = {"name": f"{whole.name}-{name}", "description": text, "base": base, "blocks": blocks}
    duty = whole.duty if whole.duty is not None else roller.given.get("duty")
    return head | ({"duty": dict(duty)} if isinstance(duty, Mapping) else {}) | options


def study_of(whole: Carriage, ds: xr.Dataset) -> dict[str, Any]:
    """Return a study of the worst roller under its worst loads, as the keys of a study file.

    Its one factor is the profile radius of the groove, from a close to a wide one, because a study needs a factor; the
    user puts the choices that are free in its place.
    """
    worst = ds.attrs.get("worst_roller", "")
    if not worst:
        raise InputError("rollers", None, "a roller whose life is known", "Add roller: FILE to every roller.")
    j = [roller.name for roller in whole.rollers].index(worst)
    i = int(np.nanargmin(ds["case_life_hours"].values[:, j]))
    case, roller = cases_of(whole, ds)[i, j], whole.rollers[j]
    loads = {"velocity": _short(case.velocity), **{load: _short(getattr(case, load)) for load in LOADS}}
    free = "roller_profile_radius"
    base = {key: value for key, value in parts_for_spectrum(roller.given)[0].items() if key != free} | loads
    groove = float(getattr(case, free))
    closest = float(case.guide_profile_radius) * 1.05
    grooves = sorted({_short(groove), _short(-closest), _short(-1.5 * closest)}) if groove < 0 else [groove, 2 * groove]
    options = {
        key: value for key, value in roller.options.items() if "study" in OPTIONS[key].files and key != "outputs"
    }
    return {
        "name": f"{whole.name}-{worst}".lower().replace(" ", "-"),
        "description": f"Roller {worst} of {whole.name} under its worst loads, in load case {whole.cases[i].name}.",
        "base": base,
        "factors": {free: {"values": grooves}},
        **options,
    }


def _short(value: Any) -> float:
    """Return a number with 10 digits, as a person can read it."""
    return float(f"{float(value):.10g}")
