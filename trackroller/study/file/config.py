"""The keys of a study file, each checked by itself."""

from __future__ import annotations

import re
from functools import partial
from typing import Annotated, Any

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    WithJsonSchema,
    create_model,
    field_validator,
)

from trackroller.carriage.file import carriage_of, written_out
from trackroller.errors import InputError, collected
from trackroller.methods import METHODS, Method
from trackroller.methods.method import study_keys
from trackroller.parameters import OPTIONS
from trackroller.roller.duty import checked_duty
from trackroller.roller.requirement import Requirement, checked_requirement, written
from trackroller.roller.stop import parse_condition
from trackroller.study.design.entries import factor
from trackroller.study.design.field_values import base_value, choice
from trackroller.study.design.roles import check_words
from trackroller.study.file.correlations import check_entries
from trackroller.study.file.goals import Analysis, comparisons, directions, own_expressions
from trackroller.study.file.questions import QUESTIONS
from trackroller.study.file.search import Budget
from trackroller.study.file.until import Until

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")
DEVICE = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)


def check_name(name: Any) -> str:
    """Return a name that is valid for a folder inside the results folder; refuse any other name."""
    if isinstance(name, (int, float)) and not isinstance(name, bool):
        name = str(name)
    if isinstance(name, str) and DEVICE.fullmatch(name):
        raise InputError(
            "name", name, "the name of a folder", "Add a word to it.", "is a device of Windows"
        )
    if not isinstance(name, str) or not NAME.fullmatch(name) or ".." in name or name.endswith("."):
        raise InputError(
            "name",
            name,
            "letters, digits, '.', '_' and '-', at most 64, a letter or digit first",
            "It names the results folder: no path parts.",
        )
    return name


Name = Annotated[str, BeforeValidator(check_name)]
Correlations = Annotated[tuple[tuple[str, str, float], ...], BeforeValidator(check_entries)]
Roles = Annotated[dict[str, str], BeforeValidator(check_words)]
Goals = Annotated[dict[str, str], BeforeValidator(partial(directions, least=1))]
DUTY_MEANING = (
    "hours_per_day and days_per_year of travel: lives in years beside hours; or "
    "strokes_per_day, stroke [m] (one way), "
    "days_per_year and rollers_on_rail, which give hours and guide_overrollings_per_hour by "
    "the velocity"
)
Duty = Annotated[dict[str, float] | None, BeforeValidator(checked_duty)]
Comparisons = Annotated[tuple[str, ...], AfterValidator(comparisons)]
_ENDS: dict[str, Any] = {
    "type": "object",
    "properties": {
        "min": {"type": ["number", "string"]},
        "max": {"type": ["number", "string"]},
        "probability": {"type": ["number", "string"]},
    },
    "additionalProperties": False,
}
Requirements = Annotated[
    dict[str, Requirement],
    PlainSerializer(written),
    WithJsonSchema(
        {
            "type": "object",
            "additionalProperties": {"anyOf": [_ENDS, {"type": ["number", "string"]}]},
        }
    ),
]


class _Design(BaseModel):
    """Keys of a study file that state its name, its cases and its design."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, title="trackroller study", ser_json_inf_nan="constants"
    )

    name: Name = Field(description="names the results folder; letters, digits, '.', '_', '-'")
    description: str = Field("", description="one sentence at the head of the report")
    base: dict[str, Any] = Field({}, description="values of all cases")
    carriage: dict[str, Any] | None = Field(
        None,
        description="carriage file whose rollers are solved under its loads; its fields are "
        "factors, too",
    )
    factors: dict[str, dict[str, Any]] = Field(
        {}, description="what varies: a list or a distribution for each factor"
    )
    method_name: str = Field(
        "grid",
        alias="method",
        description="how the factors are combined; `design` is its other name",
    )
    samples: int = Field(
        1024, ge=1, le=10_000_000, description="number of rows, trajectories or base samples"
    )
    seed: int = Field(1, ge=0, le=2**32 - 2, description="the same seed gives the same design")
    table: str | None = Field(
        None,
        description="for method table: CSV file or workbook (.xlsx) of cases beside the study file",
    )
    rank_correlations: Correlations = Field(
        (), description="lhs, sobol, inner_outer: [factor, factor, Spearman rank correlation] each"
    )

    @field_validator("method_name")
    @classmethod
    def _method_name(cls, value: str) -> str:
        return choice(value, "method", METHODS)


_TYPES: dict[str, Any] = {
    "words": tuple[str, ...],
    "number": float,
    "accuracy": str | float | dict[str, float],
    "condition": str | None,
    "switch": bool,
}
# keys with a whole number
WHOLE = tuple(name for name, (key, _) in study_keys().items() if key.kind is int)
IN_STUDY = tuple(option for option in OPTIONS.values() if "study" in option.files)
_WithKeys = create_model(
    "_WithKeys",
    __base__=_Design,
    **{  # type: ignore[call-overload]
        name: (key.kind | None, Field(None, description=f"{method}: {key.meaning}"))
        for name, (key, method) in study_keys().items()
    },
)
_TYPES_OF_OPTIONS: dict[str, Any] = {
    option.name: _TYPES.get(option.kind, str) for option in IN_STUDY
}
_TYPES_OF_OPTIONS |= {option.name: str | tuple[str, ...] for option in IN_STUDY if option.factor}
_WithOptions = create_model(
    "_WithOptions",
    __base__=_WithKeys,
    **{  # type: ignore[call-overload]
        option.name: (
            _TYPES_OF_OPTIONS[option.name],
            Field(option.default, description=option.meaning),
        )
        for option in IN_STUDY
    },
)


class StudyFile(_WithOptions):  # type: ignore[misc, valid-type]
    """Content of a study file; its fields have descriptions, and `OPTIONS` the options."""

    analysis: Analysis = Field(
        default_factory=lambda: Analysis.model_validate({}), description="what is analysed, and how"
    )
    duty: Duty = Field(None, description=DUTY_MEANING)
    requirement: Requirements = Field(
        {},
        description="what is wanted of outputs: min, max, and probability, the share of the "
        "conditions that have to "
        "meet it; `analysis.target` is its other name",
    )
    own: Annotated[dict[str, str], BeforeValidator(own_expressions)] = Field(
        {}, description="outputs of the study's own: name and expression of results and inputs"
    )
    question: str | None = Field(
        None, description="what the study asks; follows from its keys if it is left out"
    )
    roles: Roles = Field(
        {}, description="who sets a factor: choice (the designer) or condition (the use)"
    )
    goals: Annotated[dict[str, str], BeforeValidator(partial(directions, key="goals", least=1))] = (
        Field(
            {},
            description="optimise: results or choices, each max or min; worst (default), mean, "
            "b10, probability of one",
        )
    )
    budget: Budget = Field(
        default_factory=lambda: Budget.model_validate({}),
        description="optimise: how long the search goes on",
    )
    until: Until | None = Field(
        None,
        description="the sample grows by doublings until intervals are narrow, or cases or hours "
        "are spent",
    )
    pareto: Goals = Field(
        {}, description="goals of the Pareto set: outputs or factors, each max or min"
    )
    constraints: Comparisons = Field((), description="comparisons that an allowed design must meet")
    chunk_size: int | None = Field(
        None, ge=1, le=1_000_000, description="cases in each job; chosen if not given"
    )

    @property
    def method(self) -> Method:
        """Return the design of experiments."""
        return METHODS[self.method_name]

    @field_validator(*(option.name for option in IN_STUDY), mode="before")
    @classmethod
    def _option(cls, value: Any, info: Any) -> Any:
        option = OPTIONS[info.field_name]
        if isinstance(value, (list, tuple)) and (option.factor or option.required):
            if not value or any(value.count(word) > 1 for word in value):
                raise InputError(
                    option.name, list(value), "a list without repetition that is not empty"
                )
            if option.factor:
                words = tuple(option.check(word) for word in value)
                return words[0] if len(words) == 1 else words
        checked = option.check(value)
        if option.kind == "condition" and checked is not None:
            parse_condition(checked)
        return checked

    @field_validator("samples", "seed", "chunk_size", *WHOLE, mode="before")
    @classmethod
    def _whole(cls, value: Any, info: Any) -> Any:
        for one in value if isinstance(value, (list, tuple)) else (value,):
            if isinstance(one, (bool, str, bytes, np.bool_)):
                raise InputError(
                    info.field_name, value, "a whole number", "Write digits without quotes."
                )
        return value

    @field_validator("requirement", mode="before")
    @classmethod
    def _requirement(cls, value: Any, info: Any) -> Any:
        if "duty" not in info.data:  # it is wrong itself
            return {}
        carriage = info.data.get("carriage") or {}
        on_carriage = None
        if carriage.get("duty") is not None:
            on_carriage = carriage_of(carriage).duty
        return checked_requirement(value, info.data["duty"] or on_carriage)

    @field_validator("question")
    @classmethod
    def _question(cls, value: str | None) -> str | None:
        if value is None:
            return None
        return choice(value, "question", QUESTIONS)

    @field_validator("carriage", mode="before")
    @classmethod
    def _carriage(cls, value: Any) -> Any:
        return None if value is None else written_out(value)

    @field_validator("base", mode="before")
    @classmethod
    def _base(cls, value: Any) -> Any:
        return collected(value, lambda key, entry: base_value(key, entry, "base"))

    @field_validator("factors", mode="before")
    @classmethod
    def _factors(cls, value: Any, info: Any) -> Any:
        on_carriage = info.data.get("carriage") is not None
        return collected(value, lambda key, spec: factor(key, spec, value, on_carriage))
