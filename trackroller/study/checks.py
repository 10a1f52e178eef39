"""Check that the keys of a study file fit together."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from trackroller.errors import InputError
from trackroller.parameters import MATERIAL_FIELDS
from trackroller.roller.options import check_pairs, check_spin_model
from trackroller.study.design import build
from trackroller.study.design.draws import check_listed
from trackroller.study.design.entries import OPTION_FACTORS, check_own_name
from trackroller.study.goals import check
from trackroller.study.parts import check_parts

if TYPE_CHECKING:
    from trackroller.study.config import Study


def _check_options(study: Study) -> None:
    """Refuse options that exclude each other, in any combination of the levels that are factors."""

    def levels(name: str) -> list[str]:
        return study.factors.get(name, {}).get("values", [getattr(study.config, name)])

    for model, normal in itertools.product(levels("contact_model"), levels("normal")):
        check_pairs(study.config.hertz, normal, study.config.slip_terms, model)
    check_spin_model(levels("spin_model"), levels("contact_model"))


def cross_check(study: Study) -> None:
    """Check what the keys of a study file say together.

    Parameters
    ----------
    study : the study

    Raises
    ------
    InputError : keys contradict each other, or the design, the materials or the geometry cannot be what they say
    """
    config = study.config
    for name in OPTION_FACTORS:
        if name in config.factors and not isinstance(getattr(config, name), str):
            raise InputError(name, getattr(config, name), f"{name} stands among the factors too", "Keep one.")
    both = {*study.factors, *config.base} & {"material_pair"}
    single = {*study.factors, *config.base} & set(MATERIAL_FIELDS)
    if both and single:
        raise InputError("material_pair", sorted(single), "give the pair or the single materials, not both")
    if doubled := set(config.base) & set(study.factors):
        name = min(doubled)
        raise InputError(f"base.{name}", config.base[name], f"{name} is a factor too", "Remove one of them.")
    if (config.design == "table") != (config.table is not None):
        raise InputError("table", config.table, "design: table and the path of a CSV belong together")
    if config.design == "grid":
        check_listed(study.parsed)
    for name in study.factors:
        check_own_name(name, f"factors.{name}")
    check(config, study.factors)
    check_parts(study)
    _check_options(study)
    build.check_correlations(study)
    build.check_materials(study)
