"""Check the keys of a study file that state how results are analysed and which designs are best.

    analysis:
      outputs: [roller_life_hours, friction_power, peak_stress_guide_1]
      scale: {friction_power: log10}
      groups: {load: [radial_force, axial_force]}
    pareto: {roller_life_hours: max, friction_power: min, axis_distance: min}
    constraints:
      - regime != full_slip
      - max_pressure < 1500

These keys are not part of the identity of a case, so changing them solves no case again.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator

from trackroller.damage import checked_limits
from trackroller.errors import Collector, InputError, collected, listing, raise_all, unknown_name
from trackroller.methods.factor import Factor
from trackroller.numerics.units import without_units
from trackroller.parameters import MATERIAL_FIELDS, PARAMETERS, REGIMES, expressions
from trackroller.roller.dataset import VARIABLES
from trackroller.roller.output_names import PARTS, Part, body_of, is_life, parts_of, unit_of
from trackroller.roller.requirement import DEFAULT, KEY
from trackroller.study.design.factor_names import FACTOR_NAMES, check_own_name
from trackroller.study.design.field_values import choice

SCALES = ("natural", "log10")
DIRECTIONS = ("max", "min")
FIRST_LIMIT = "pair_life_to_first_limit_hours"
# of the design points of inner_outer
STATISTICS = ("b10", "b10_safe", "mean", "standard_deviation", "probability")
STATISTICS_OF = {  # by the key of a study file
    "pareto": STATISTICS,
    "goals": ("mean", "worst", "b10", "probability"),
    "until.of": ("b10", "probability"),
}


def without_spaces(value: Any) -> Any:
    """Return a mapping from outputs with their names as they are stored; the type of the field
    refuses other values.
    """
    if isinstance(value, Mapping):
        return {str(name).replace(" ", ""): own for name, own in value.items()}
    return value


class Analysis(BaseModel):
    """The key `analysis` of a study file; each field has a description."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    outputs: tuple[str, ...] | None = Field(
        None, description="results to analyse; default: the usual ones"
    )
    scale: str | dict[str, str] = Field(
        {}, description="natural or log10, for all or by output; default log10 for lives"
    )
    keep: tuple[str, ...] = Field(
        ("rolling",), description="regimes whose cases are used; others are counted"
    )
    groups: dict[str, tuple[str, ...]] = Field(
        {},
        description="grid, saltelli: groups of factors whose first-order and total indices are "
        "wanted, by name",
    )
    conditional_on: str | None = Field(
        None,
        description="factor with a list of values: indices of the others within each of its levels",
    )
    material_scatter: bool | Literal["fitted"] | float = Field(
        False,
        description="inner_outer: the material's own scatter in B10; true: from the database; or "
        "T_N; fitted, with any "
        "sample: the scatter and the band of targets by the tests of the material",
    )

    @field_validator("scale")
    @classmethod
    def _scale(cls, value: str | dict[str, str]) -> str | dict[str, str]:
        for name, scale in {"": value}.items() if isinstance(value, str) else value.items():
            choice(scale, f"analysis.scale.{name}".rstrip("."), SCALES)
        return value

    @field_validator("keep")
    @classmethod
    def _keep(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        for name in value:
            choice(name, "analysis.keep", REGIMES[:3])
        if "rolling" not in value:
            raise InputError(
                "analysis.keep", list(value), "rolling and, if wanted, full_slip and lift_off"
            )
        return tuple(dict.fromkeys(value))

    @field_validator("outputs")
    @classmethod
    def _outputs(cls, value: tuple[str, ...] | None) -> tuple[str, ...] | None:
        if value is not None and not value:
            raise InputError(
                "analysis.outputs",
                [],
                "at least one output",
                "Remove the key for the usual outputs.",
            )
        if value is None:
            return None
        return tuple(dict.fromkeys(value))

    @field_validator("material_scatter", mode="before")
    @classmethod
    def _material_scatter(cls, value: Any) -> Any:
        good = isinstance(value, bool) or (
            isinstance(value, (int, float)) and 1 <= value < float("inf")
        )
        if not good and value != "fitted":
            allowed = "true, false, fitted, or the scatter range T_N = N_90/N_10 >= 1"
            raise InputError("analysis.material_scatter", value, allowed)
        return value


def directions(value: Any, key: str = "pareto", least: int = 2) -> Any:
    """Check the key `pareto` or `goals`: at least so many outputs or factors, each with `max` or
    `min`.

    A single goal under `pareto` ranks what meets the requirement of the study.
    """
    if isinstance(value, Mapping) and 0 < len(value) < least:
        allowed = "two or more outputs or factors, each with max or min; one beside a requirement"
        raise InputError(
            key, value, allowed, "For example {pair_life_hours: max, friction_power: min}."
        )
    return collected(
        without_spaces(value), lambda name, way: choice(way, f"{key}.{name}", DIRECTIONS)
    )


def to_first_limit(config: Any) -> dict[str, Any]:
    """Return goals and constraints on the life of the pair, which count it to its first limit, as
    targets do.

    A study without the limits, or one that names the life to the first limit beside the life by
    fatigue, means what it writes.
    """
    keys: dict[str, Any] = {key: getattr(config, key) for key in ("goals", "pareto", "constraints")}
    if not {"life", "limits"} <= set(config.outputs) or FIRST_LIMIT in str(keys):
        return {}

    def first(text: str) -> str:
        # a target is counted so already
        return re.sub(rf"(?<!probability\()\b{DEFAULT}\b", FIRST_LIMIT, text)

    named = {
        key: {first(name): way for name, way in keys[key].items()} for key in ("goals", "pareto")
    }
    return named | {"constraints": tuple(map(first, config.constraints))}


def comparisons(texts: Sequence[str]) -> tuple[str, ...]:
    """Check the comparisons of the key `constraints`, and return them without units."""
    plain = tuple(without_units(text, unit_of, "constraints") for text in texts)
    for text in plain:
        names_in(text)
    return plain


def names_in(constraint: str) -> set[str]:
    """Return the names of outputs and factors in a constraint; names of regimes are values, not
    names.
    """
    return expressions.names(constraint, "constraints") - set(REGIMES)


def output_names(groups: Iterable[str]) -> list[str]:
    """Return the names that `analysis.outputs`, `pareto` and `constraints` may use: results with
    one number a case.
    """
    groups = set(groups)
    limits = checked_limits(groups)
    return [p.name for v in VARIABLES.values() if v.group in groups for p in parts_of(v, limits)]


def names_of_outputs(config: Any) -> list[str]:
    """Return the names of the results of a study with one number a case, and of its own outputs."""
    return [*output_names(config.outputs), *config.own]


def own_expressions(value: Any) -> Any:
    """Check the names and the texts of the key `own`, each by itself."""
    return collected(value, _own_expression)


def _own_expression(name: Any, text: Any) -> str:
    """Return the expression of an output of the study's own."""
    where = f"own.{name}"
    if not isinstance(name, str) or not name.isidentifier() or name in FACTOR_NAMES:
        allowed = "a name of letters, digits and '_' that is no parameter"
        raise InputError("own", name, allowed, "Rename it.")
    check_own_name(name, where)
    expressions.names(text, where)
    return str(text)


def check_own(config: Any, factors: Mapping[str, Factor]) -> None:
    """Check that the expressions of the key `own` use results and inputs of the study, and clash
    with no factor.
    """
    results = output_names(config.outputs)
    allowed_names = [*results, *factors, *PARAMETERS, *MATERIAL_FIELDS, "material_pair", "regime"]
    texts = {*MATERIAL_FIELDS, "material_pair", "regime"}
    texts |= {name for name, factor in factors.items() if not factor.numeric}
    dummy: dict[str, Any] = dict.fromkeys(allowed_names, np.ones(2)) | dict.fromkeys(texts, "")
    wrong = Collector()
    for name, text in config.own.items():
        where = f"own.{name}"
        with wrong.part():
            if name in factors:
                raise InputError(
                    "own",
                    name,
                    "a name that is no factor",
                    "Rename it.",
                    "stands among the factors too",
                )
            for used in sorted(expressions.names(text, where) - set(REGIMES)):
                if used not in allowed_names:
                    raise unknown_result(where, used, allowed_names, config.outputs)
            expressions.evaluate(text, dummy | {regime: regime for regime in REGIMES}, where)
    wrong.check()


def check_scatter(config: Any, materials: Mapping[str, Iterable[Any]]) -> None:
    """Check that the materials of each body whose life is asked for have a scatter, if the analysis
    counts on it.

    Parameters
    ----------
    config : the study file
    materials : materials that occur, by body

    Raises
    ------
    InputError : a design in which the scatter has no use, or a material without scatter
    """
    scatter = config.analysis.material_scatter
    if scatter is False:
        return
    if scatter == "fitted":  # the analysis finds the fits
        if config.method.weighted and not config.method.whole:
            return
        remedy = "Remove the key: the verdict has the range by the tests in any design."
        allowed = "method: inner_outer, or a random sample such as method: sobol"
        raise InputError("analysis.material_scatter", scatter, allowed, remedy)
    if not config.method.points:
        remedy = "Remove the key: only inner_outer has a B10 life."
        raise InputError("analysis.material_scatter", scatter, "method: inner_outer", remedy)
    outputs = config.analysis.outputs or [
        f"life_cycles_{body}" for body in materials if "life" in config.outputs
    ]
    for body, used in materials.items():
        bare = [m.name for m in used if m.scatter_in_cycles is None and m.scatter_in_stress is None]
        if (
            scatter is True
            and bare
            and any(is_life(name) and body_of(name) == body for name in outputs)
        ):
            raise InputError(
                "analysis.material_scatter",
                True,
                f"materials with scatter; the database has none for {', '.join(bare)} ({body})",
                "Give scatter_in_cycles with the materials, or T_N itself: material_scatter: 4. "
                "Or name only the "
                "lives of the other body under analysis.outputs.",
            )


def check(
    config: Any,
    factors: Mapping[str, Factor],
    columns: Mapping[str, np.ndarray] = MappingProxyType({}),
) -> None:
    """Check that the names in `analysis`, `pareto` and `constraints` exist; `InputError` gives the
    nearest one.

    `columns` are those of the table of cases, of which a constraint may name any.
    """
    check_own(config, factors)
    known = names_of_outputs(config)
    check_analysed(
        config, [name for name, factor in factors.items() if factor.discrete and factor.numeric]
    )
    if not config.method.weighted and any(own.in_shares for own in config.requirement.values()):
        remedy = "Remove probability, or use inner_outer, lhs, sobol or saltelli."
        raise InputError(
            "requirement",
            config.method_name,
            "for probability: a design whose rows have known weights",
            remedy,
        )
    free = [*known, *factors, *PARAMETERS]
    _check_statistics(config, factors, known)
    if len(config.pareto) == 1 and not config.requirement:
        directions(config.pareto)
    for name in config.pareto if not config.method.points else ():
        if name not in free:
            raise unknown_result("pareto", name, free, config.outputs)
        if name in factors and not factors[name].numeric:
            raise InputError(
                "pareto", name, "a result or factor with one number a case", "Names have no order."
            )
    _check_constraints(config, factors, columns, free)


def check_analysed(config: Any, goods: Iterable[str] = ()) -> None:
    """Check that the outputs under `analysis` and `requirement` are results of the study; raise all
    errors together.

    A requirement may name a column of a shelf, too, which `goods` lists.
    """
    known = names_of_outputs(config)
    of_results = [name for name in config.requirement if name not in goods]
    scale = config.analysis.scale
    outputs = [*(config.analysis.outputs or ())]
    if isinstance(scale, dict):
        outputs += scale
    raise_all(
        unknown_result(where, name, known, config.outputs)
        for where, names in (("analysis.outputs", outputs), (KEY, of_results))
        for name in names
        if name.replace(" ", "") not in known
    )


def _check_statistics(config: Any, factors: Mapping[str, Factor], known: list[str]) -> None:
    """Check that `pareto` names statistics of design points in an inner/outer design, and in no
    other design.
    """
    chosen = [
        name
        for name, factor in factors.items()
        if factor.discrete and factor.numeric and not factor.scatter
    ]
    for name in config.pareto:
        kind, output = statistic(name)
        if not config.method.points and kind:
            remedy = "Name the result itself, or use method: inner_outer."
            raise InputError(
                "pareto", name, "a result or factor; statistics need design points", remedy
            )
        if not config.method.points or name in chosen:
            continue
        if not kind:
            allowed = (
                f"{', '.join(STATISTICS)} of a result, or a numeric factor with a list: it "
                "compares design points"
            )
            raise InputError(
                "pareto",
                name,
                allowed,
                "For example b10(roller_life_hours) or mean(friction_power).",
            )
        check_statistic(config, ("pareto", name), kind, output, known)


def check_statistic(
    config: Any, entry: tuple[str, str], kind: str, output: str, known: Iterable[str]
) -> None:
    """Check the statistic `kind` of an output, which stands in an entry of `pareto` or `goals`: key
    and name.
    """
    if kind == "probability" and output not in (*config.requirement, *REGIMES):
        remedy = f"Add it to requirement, such as {{{DEFAULT}: {{min: 500}}}}."
        raise InputError(*entry, "the probability of a requirement or of a regime", remedy)
    if kind != "probability" and output not in known:
        raise unknown_result(entry[0], output, known, config.outputs)
    if kind in ("b10", "b10_safe") and not is_life(output):
        raise InputError(*entry, "b10 of a life", f"Use mean({output}).")


def statistic(name: str, kinds: tuple[str, ...] = STATISTICS) -> tuple[str, str]:
    """Split 'b10(roller_life_hours)' into the statistic and its output; ('', name) for a plain
    name.
    """
    kind, bracket, output = name.replace(" ", "").partition("(")
    if bracket and kind in kinds and output.endswith(")"):
        return kind, output[:-1]
    return "", name


def _check_constraints(
    config: Any, factors: Mapping[str, Factor], columns: Mapping[str, np.ndarray], free: list[str]
) -> None:
    free = list(dict.fromkeys([*free, *(name for name in columns if name not in MATERIAL_FIELDS)]))
    words = [*free, *MATERIAL_FIELDS, "material_pair", "regime"]
    for text in config.constraints:
        for name in names_in(text):
            if name not in words:
                raise unknown_result("constraints", name, [*words, *REGIMES], config.outputs)
        dummy: dict[str, Any] = dict.fromkeys(free, np.ones(2)) | {
            name: "" for name in words[len(free) :]
        }
        dummy |= {name: "" for name, factor in factors.items() if not factor.numeric} | {
            name: name for name in REGIMES
        }
        dummy |= {name: "" for name, values in columns.items() if values.dtype.kind not in "fiu"}
        expressions.condition(text, dummy)


def unknown_result(
    where: str, name: str, known: Iterable[str], groups: Iterable[str]
) -> InputError:
    """Return the error for a name that is no result of these groups; it gives the nearest one."""
    kinds = STATISTICS_OF.get(where)
    if kinds and "(" in name:
        allowed = f"a result, or {listing(kinds, 'or')} of one"
        return InputError(
            where, name, allowed, f"For example {kinds[0]}({name.partition('(')[2].rstrip(') ')})."
        )
    variable = VARIABLES.get(name)
    if name in PARTS:
        variable = PARTS[name].variable
    if variable is not None and variable.group not in set(groups):
        if variable.group == "status":
            return InputError(where, name, "a result or a factor")
        allowed = f"results of the study's outputs; its group {variable.group} is not among them"
        return InputError(where, name, allowed, f"Add {variable.group} to outputs.")
    parts: list[Part] = []
    if variable is not None:
        parts = list(parts_of(variable))
    if parts:
        return InputError(where, name, "one number a case", f"Choose one, such as {parts[0].name}.")
    return unknown_name(where, name, known)
