"""Who sets each factor of a study: the designer (`choice`) or the use of the roller (`condition`).

A candidate is one combination of choices. It is judged over all its conditions.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from trackroller.errors import InputError, collected, unknown_name
from trackroller.methods import METHODS
from trackroller.methods.factor import UNBOUNDED, Factor
from trackroller.parameters import ROLE_OF, ROLES, expressions
from trackroller.study.design.factor_names import OPTION_FACTORS
from trackroller.study.design.field_values import choice

BELLS = (*UNBOUNDED, "truncnormal", "triangular")


def check_words(value: Any) -> Any:
    """Check the key `roles` of a study file: factors, each with `choice` or `condition`."""
    return collected(value, lambda name, role: choice(role, f"roles.{name}", ROLES))


def check_roles(given: Mapping[str, str], factors: Mapping[str, Any], design: str) -> None:
    """Check that the key `roles` names factors, and agrees with the arrays of an inner/outer
    design.

    Parameters
    ----------
    given : factor -> `choice` or `condition`
    factors : factors of the study by name, as `Factor` or as columns of a table
    design : the design of the study

    Raises
    ------
    InputError : a name is no factor, or an inner/outer design has the factor in the other array
    """
    for name, role in given.items():
        where = f"roles.{name}"
        if name in OPTION_FACTORS:
            remedy = "Remove the line: designs are compared with one model."
            wrong = "is the role of an option of the calculation"
            raise InputError(where, role, "a factor of the roller or of its use", remedy, wrong)
        if name not in factors:
            raise unknown_name(where, name, [n for n in factors if n not in OPTION_FACTORS])
        factor = factors[name]
        if (
            not METHODS[design].points
            or factor.kind == "expression"
            or (role == "condition") == factor.scatter
        ):
            continue
        if factor.scatter:
            allowed = "condition: the factor scatters in the inner array"
            raise InputError(
                where, role, allowed, "Give it as a list of values, or remove the line."
            )
        allowed = f"choice: the lists of {design} are design points"
        raise InputError(
            where, role, allowed, f"Write scatter: true beside the list of factors.{name}."
        )


def scattered(factors: Mapping[str, Factor], given: Mapping[str, str]) -> tuple[str, ...]:
    """Return the factors of a search for candidates that vary as conditions; the others are its
    choices.

    Factors with a bell-shaped distribution are among them whatever role is given: nobody chooses
    such a value.
    """
    roles = roles_of(factors, factors, given)
    return tuple(
        n
        for n, f in factors.items()
        if f.varies and (f.kind in BELLS or roles.get(n) == "condition")
    )


def roles_of(
    names: Iterable[str], factors: Mapping[str, Factor], given: Mapping[str, str], design: str = ""
) -> dict[str, str]:
    """Return the role of each factor.

    Parameters
    ----------
    names : the wanted factors; options of the calculation have no role and are left out
    factors : all factors of the study, whose expressions may use others; empty for a table
    given : the key `roles` of the study file, which overrides the roles of the program
    design : the design of the study; in `inner_outer` the inner array holds the conditions

    Returns
    -------
    Name -> `choice` or `condition`. A bell-shaped distribution states scatter: a condition. A
    factor of the study's own, such as a ratio, has the role of the parameter that is computed from
    it, and is a choice if several are and one of them is a choice.
    """
    fed: dict[str, list[str]] = {}
    for other, factor in factors.items():
        for source in expressions.names(factor.text, f"factors.{other}") if factor.text else ():
            fed.setdefault(source, []).append(other)

    def role(name: str) -> str:
        if name in given:
            return given[name]
        known = factors.get(name)
        if design and METHODS[design].points and known is not None and known.kind != "expression":
            return "condition" if known.scatter else "choice"
        if known is not None and known.kind in BELLS:
            return "condition"
        if name in ROLE_OF:
            return ROLE_OF[name]
        if name in fed and all(role(other) == "condition" for other in fed[name]):
            return "condition"
        return "choice"

    return {name: role(name) for name in names if name not in OPTION_FACTORS}
