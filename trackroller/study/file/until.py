"""Check the key `until` of a study file, with which a sample grows by itself until its intervals
are narrow.

until: {half_width: 0.03, of: [roller_life_hours], at_most: 200000, hours: 8}
"""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field, field_validator

from trackroller.errors import InputError, listing
from trackroller.methods import METHODS, those_with
from trackroller.parameters import REGIMES
from trackroller.roller.output_names import is_life
from trackroller.study.file.goals import names_of_outputs, statistic, unknown_result


class Until(BaseModel):
    """The key `until` of a study file; each field has a description."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    half_width: float = Field(
        gt=0,
        lt=10,
        description="half width of the 95 % intervals: of shares of variance (saltelli, sobol), "
        "of mu* over the "
        "output's range (morris), of log10 B10 or a probability (inner_outer)",
    )
    of: tuple[str, ...] = Field(
        description="outputs; in inner_outer lives, b10(..) of a life or probability(..) of a "
        "requirement"
    )
    at_most: int = Field(200_000, ge=1, le=10_000_000, description="largest number of cases")
    hours: float | None = Field(
        None, gt=0, description="time of solving on one core, all runs together"
    )
    replicates: int = Field(
        16, ge=8, le=64, description="independent samples, whose scatter gives the intervals"
    )

    @field_validator("of", mode="before")
    @classmethod
    def _of(cls, value: Any) -> Any:
        listed = [value] if isinstance(value, str) else value
        if (
            isinstance(listed, (list, tuple))
            and listed
            and all(isinstance(name, str) for name in listed)
        ):
            return tuple(dict.fromkeys(name.replace(" ", "") for name in listed))
        raise InputError(
            "until.of",
            value,
            "a list of at least one output",
            "For example of: [roller_life_hours].",
        )


def check_until(config: Any) -> None:
    """Check that the design of a study can grow, and that the outputs of `until` have a headline
    quantity.
    """
    until = config.until
    if until is None:
        return
    for key, method in (("method", config.method_name), ("inner", config.inner)):
        if method is not None and not METHODS[method].grows:
            allowed = (
                f"with until: {listing(those_with('grows'), 'or')}, which grow by more samples"
            )
            if key != "method":
                allowed = "with until: sobol, whose rows stay as the sample grows"
            remedy = "Choose one of them"
            if METHODS[method].weighs:
                remedy = f"Write {key}: sobol"
            raise InputError(key, method, allowed, f"{remedy}, or remove until.")
    if "groups" in config.method.takes and config.analysis.groups:
        groups = list(config.analysis.groups)
        raise InputError(
            "analysis.groups",
            groups,
            "with until: indices of single factors",
            "Remove groups or until.",
        )
    _check_samples(config.samples, until.replicates)
    for name in until.of:
        _check_of(config, name, names_of_outputs(config))


def _check_samples(samples: int, replicates: int) -> None:
    """Check that each replicate has a power of two of samples."""
    size, remainder = divmod(samples, replicates)
    is_power_of_two = size > 0 and size & (size - 1) == 0
    if is_power_of_two and not remainder:
        return
    exponent = max(0, round(samples / replicates) - 1).bit_length()  # the next power of two
    allowed = f"with until: the {replicates} replicates times a power of two, at the first look"
    remedy = f"Write samples: {replicates * 2**exponent}, or remove the key."
    raise InputError("samples", samples, allowed, remedy)


def _check_of(config: Any, name: str, known: list[str]) -> None:
    """Check one entry of `until.of`."""
    points = config.method.points
    kind, output = "", name
    if points:
        kind, output = statistic(name)
    if kind == "probability" and output in (*config.requirement, *REGIMES):
        return
    if kind == "probability":
        remedy = f"Add it to requirement, such as {{{output}: {{min: 500}}}}."
        raise InputError(
            "until.of", name, "the probability of a requirement or of a regime", remedy
        )
    if "(" in output and not points:
        allowed = f"with method {config.method_name}: results, whose indices count"
        raise InputError(
            "until.of", name, allowed, "Statistics such as b10(..) need method: inner_outer."
        )
    if output not in known:
        raise unknown_result("until.of", output, known, config.outputs)
    if points and (kind not in ("", "b10") or not is_life(output)):
        allowed = (
            "with inner_outer: a life, whose log10 B10 counts, or probability(..) of a "
            "requirement or of a regime"
        )
        raise InputError(
            "until.of", name, allowed, f"For example probability({output}) with requirement."
        )


def check_first_look(study: Any) -> None:
    """Refuse a number of cases that the first look exceeds already."""
    until = study.config.until
    if until is None:
        return
    cases = study.drawn.size
    if cases > until.at_most:
        remedy = f"Write at_most: {4 * cases}, for example, or fewer samples."
        raise InputError(
            "until.at_most", until.at_most, f"at least the {cases} cases of the first look", remedy
        )
