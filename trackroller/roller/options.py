"""What a solution may be asked for, checked."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from trackroller.errors import InputError, unknown_name
from trackroller.parameters import (
    CONTACT_MODELS,
    DEFAULT_OUTPUTS,
    HERTZ,
    LIFE_RULES,
    NORMAL,
    OUTPUT_GROUPS,
    SLIP_TERMS,
    SPIN_MODELS,
    STRESS_BODIES,
)
from trackroller.roller.accuracy import Accuracy, accuracy_settings
from trackroller.roller.stop import parse_condition


@dataclass(frozen=True)
class Options:
    """Checked options of a solution; see `solve`."""

    outputs: tuple[str, ...] = DEFAULT_OUTPUTS
    contact_model: str = "sliding"
    spin_model: str = "skewed"
    accuracy: str | float | Accuracy = "standard"
    hertz: str = "exact"
    stress_bodies: str = "both"
    life_rule: str = "elementary"
    normal: str = "hertz"
    contact_tolerance: float = 0.05
    stop_if: str | None = None
    shortcuts: bool = True
    slip_terms: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        outputs = (self.outputs,) if isinstance(self.outputs, str) else tuple(self.outputs)
        object.__setattr__(self, "outputs", tuple(dict.fromkeys(outputs)))
        for name in self.outputs:
            if name not in OUTPUT_GROUPS:
                raise unknown_name("outputs", str(name), OUTPUT_GROUPS)
        if not self.outputs:
            raise InputError("outputs", outputs, "at least one of " + ", ".join(OUTPUT_GROUPS))
        for field, options in (
            ("contact_model", CONTACT_MODELS),
            ("spin_model", SPIN_MODELS),
            ("hertz", HERTZ),
            ("stress_bodies", STRESS_BODIES),
            ("life_rule", LIFE_RULES),
            ("normal", NORMAL),
        ):
            if getattr(self, field) not in options:
                raise unknown_name(field, str(getattr(self, field)), options)
        check_hertz(self.hertz, self.normal)
        self._check_slip()
        accuracy_settings(self.accuracy, self.contact_model, self.outputs)
        tolerance = self.contact_tolerance
        if isinstance(tolerance, bool) or not isinstance(tolerance, (int, float)) or not 0 < tolerance < 1:
            raise InputError("contact_tolerance", tolerance, "a relative tolerance in (0, 1), for contact_model auto")
        if not isinstance(self.shortcuts, bool):
            raise InputError("shortcuts", self.shortcuts, "true or false")
        if self.stop_if is not None:
            parse_condition(self.stop_if)

    def _check_slip(self) -> None:
        given = self.slip_terms
        if not isinstance(given, (str, list, tuple, set, frozenset)):
            raise InputError("slip_terms", given, "a list of " + ", ".join(SLIP_TERMS) + ", which may be empty")
        terms = (given,) if isinstance(given, str) else tuple(given)
        for name in terms:
            if name not in SLIP_TERMS:
                raise unknown_name("slip_terms", str(name), SLIP_TERMS)
        check_slip_terms(terms, self.contact_model)
        object.__setattr__(self, "slip_terms", tuple(name for name in SLIP_TERMS if name in terms))

    @property
    def settings(self) -> Accuracy:
        """What the accuracy means for each stage."""
        return accuracy_settings(self.accuracy, self.contact_model, self.outputs)


def check_hertz(hertz: str, normal: str) -> None:
    """`InputError` for a way to Hertz's ellipse where there is none."""
    if normal == "halfspace" and hertz != "exact":
        raise InputError(
            "hertz",
            hertz,
            "exact with normal: halfspace, which solves patch and pressure itself",
            "Leave hertz out, or take normal: hertz (with circles).",
        )


def check_slip_terms(terms: Collection[str], contact_model: str) -> None:
    """`InputError` for terms of the slip that a contact model cannot have."""
    if "curve" in terms and contact_model == "sliding":
        raise InputError(
            "slip_terms",
            list(terms),
            "'curve' for fastsim, kalker and auto only",
            "Take contact_model: kalker, or leave 'curve' out: where everything slides it would leave all "
            "forces as they are and only lengthen slip and friction work.",
        )
