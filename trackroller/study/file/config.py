"""Read and check a study file, so that errors are found before any case is solved."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, create_model, field_validator

from trackroller.errors import InputError, unknown_name
from trackroller.files import files_beside, find_beside, parse_mapping, read_text, write_yaml
from trackroller.materials import MaterialDatabase, load_database
from trackroller.parameters import OPTIONS
from trackroller.roller.stop import parse_condition
from trackroller.study.design import build
from trackroller.study.design.correlation import check_entries
from trackroller.study.design.entries import OPTION_FACTORS, base_value, choice, factor
from trackroller.study.design.factors import Factor, parse
from trackroller.study.design.sampling import METHODS, current_name
from trackroller.study.file.checks import cross_check
from trackroller.study.file.goals import Analysis, comparisons, directions

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.study.design.sampling import SampledDesign

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


def check_name(name: Any) -> str:
    """Return a name that is valid for a folder inside the results folder; refuse any other name."""
    name = str(name) if isinstance(name, (int, float)) else name
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
Goals = Annotated[dict[str, str], BeforeValidator(directions)]
Comparisons = Annotated[tuple[str, ...], BeforeValidator(comparisons)]


class _Design(BaseModel):
    """Keys of a study file that state its name, its cases and its design."""

    model_config = ConfigDict(extra="forbid", frozen=True, title="trackroller study", ser_json_inf_nan="constants")

    name: Name = Field(description="names the results folder; letters, digits, '.', '_', '-'")
    description: str = Field("", description="one sentence at the head of the report")
    base: dict[str, Any] = Field({}, description="values of all cases; other parameters take their defaults")
    factors: dict[str, dict[str, Any]] = Field({}, description="what varies: a list or a distribution for each factor")
    design: str = Field("grid", description="how the factors are combined")
    samples: int = Field(1024, ge=1, le=10_000_000, description="number of rows, trajectories or base samples")
    seed: int = Field(1, ge=0, le=2**32 - 2, description="the same seed gives the same design")
    table: str | None = Field(None, description="for design table: CSV file of cases beside the study file")
    second_order: bool | None = Field(None, description="saltelli: also the second-order indices")
    exchange: Literal["factors", "groups"] | None = Field(
        None, description="saltelli: columns are exchanged by factor (default) or by group of analysis.groups"
    )
    levels: int | None = Field(None, description="morris: number of levels")
    inner: Literal["lhs", "sobol"] | None = Field(None, description="inner_outer: how the inner array is sampled")
    rank_correlations: Correlations = Field(
        (), description="lhs, sobol, inner_outer: [factor, factor, Spearman rank correlation] each"
    )
    grown_from: tuple[int, ...] | None = Field(None, description="lhs, inner_outer: earlier numbers of samples")

    @field_validator("design")
    @classmethod
    def _design(cls, value: str) -> str:
        return choice(current_name(value, warn=True), "design", METHODS)


_TYPES: dict[str, Any] = {
    "words": tuple[str, ...],
    "number": float,
    "accuracy": str | float,
    "condition": str | None,
    "switch": bool,
}
IN_STUDY = tuple(option for option in OPTIONS.values() if "study" in option.files)
_WithOptions = create_model(
    "_WithOptions",
    __base__=_Design,
    **{  # type: ignore[call-overload]
        option.name: (
            str | tuple[str, ...] if option.factor else _TYPES.get(option.kind, str),
            Field(option.default, description=option.meaning),
        )
        for option in IN_STUDY
    },
)


class StudyFile(_WithOptions):  # type: ignore[misc, valid-type]
    """Content of a study file; see the descriptions of its fields. The options are those of `OPTIONS`."""

    analysis: Analysis = Field(
        default_factory=lambda: Analysis.model_validate({}), description="what is analysed, and how"
    )
    pareto: Goals = Field({}, description="goals of the Pareto set: outputs or factors, each max or min")
    constraints: Comparisons = Field((), description="comparisons that an allowed design must meet")
    chunk_size: int | None = Field(None, ge=1, le=1_000_000, description="cases in each job; chosen if not given")

    @field_validator(*(option.name for option in IN_STUDY), mode="before")
    @classmethod
    def _option(cls, value: Any, info: Any) -> Any:
        option = OPTIONS[info.field_name]
        if isinstance(value, (list, tuple)) and (option.factor or option.required):
            if not value or any(value.count(word) > 1 for word in value):
                raise InputError(option.name, list(value), "a list without repetition that is not empty")
            if option.factor:
                words = tuple(option.check(word) for word in value)
                return words[0] if len(words) == 1 else words
        checked = option.check(value)
        if option.kind == "condition" and checked is not None:
            parse_condition(checked)
        return checked

    @field_validator("samples", "seed", "chunk_size", "levels", "grown_from", mode="before")
    @classmethod
    def _whole(cls, value: Any, info: Any) -> Any:
        for one in value if isinstance(value, (list, tuple)) else (value,):
            if isinstance(one, (bool, str)):
                raise InputError(info.field_name, value, "a whole number", "Write digits without quotes.")
        return value

    @field_validator("base", mode="before")
    @classmethod
    def _base(cls, value: Any) -> Any:
        if not isinstance(value, Mapping):
            raise InputError("base", value, "a mapping of parameters to values")
        return {key: base_value(key, entry) for key, entry in value.items()}

    @field_validator("factors", mode="before")
    @classmethod
    def _factors(cls, value: Any) -> Any:
        if not isinstance(value, Mapping):
            raise InputError("factors", value, "a mapping of factors to their values")
        return {key: factor(key, spec, value) for key, spec in value.items()}


def _translate(error: ValidationError) -> InputError:
    """Return the first error of pydantic as an `InputError` with a remedy."""
    # A misspelt key often causes the other errors, so it is reported first.
    found = sorted(error.errors(), key=lambda e: e["type"] != "extra_forbidden")
    detail = found[0]
    context = detail.get("ctx", {}).get("error")
    if isinstance(context, InputError):
        return context
    where = ".".join(str(part) for part in detail["loc"]) or "study"
    if detail["type"] == "extra_forbidden":
        options = Analysis.model_fields if detail["loc"][0] == "analysis" and len(detail["loc"]) > 1 else None
        return unknown_name("study key", where.removeprefix("analysis."), options or StudyFile.model_fields)
    if detail["type"] == "missing":
        return InputError(where, None, "every study needs this key", f"Add a line '{where}: ...'.")
    return InputError(where, detail.get("input"), detail["msg"])


@dataclass(frozen=True)
class Study:
    """A checked study: its configuration, the path of its file, and its materials."""

    config: StudyFile
    path: Path | None = None
    database: Any = field(default=None, compare=False, repr=False)

    @property
    def name(self) -> str:
        """Return the name of the study and of its results folder."""
        return self.config.name

    @cached_property
    def factors(self) -> dict[str, dict[str, Any]]:
        """Return all factors, including lists of contact models or spin models."""
        extra = {
            name: {"values": list(value)}
            for name in OPTION_FACTORS
            if not isinstance(value := getattr(self.config, name), str)
        }
        return {**self.config.factors, **extra}

    @cached_property
    def parsed(self) -> dict[str, Factor]:
        """Return all factors as `Factor`."""
        return {name: parse(name, spec) for name, spec in self.factors.items()}

    @cached_property
    def materials(self) -> MaterialDatabase:
        """Return the material database: the built-in one, changed and extended by the user's file."""
        return load_database() if self.database is None else self.database

    @property
    def options(self) -> dict[str, Any]:
        """Return the keyword arguments of `solve` that are not factors."""
        return {o.name: getattr(self.config, o.name) for o in IN_STUDY if o.name not in self.factors}

    def merged(self, whole_paths: bool = False, table: str | None = None) -> str:
        """Return the study as YAML with every default written out.

        Parameters
        ----------
        whole_paths : bool
            Write the path of the table of cases from the root on.
        table : str, optional
            Write this path of the table instead.
        """
        if table is None and whole_paths and self.config.table is not None:
            table = str(Path(build.table_path(self)).resolve())
        return self._text if table is None else write_yaml(self._data | {"table": table})

    @property
    def _data(self) -> dict[str, Any]:
        return self.config.model_dump(mode="json", exclude_none=True)

    @cached_property
    def _text(self) -> str:
        return write_yaml(self._data)  # kept: planning, solving and gathering ask for it several times

    @cached_property
    def drawn(self) -> SampledDesign:
        """Return the drawn design; it is kept, because reading a CSV of a million cases takes seconds."""
        return build.draw(self)

    def design(self) -> xr.Dataset:
        """Return the cases of the study.

        Returns
        -------
        xarray.Dataset
            Dimension `case`, one variable a parameter, materials by name.
        """
        return build.build(self)


def parse_study(
    data: Mapping[str, Any], path: Path | None = None, database: Any = None, planned: bool = False
) -> Study:
    """Return the study of a mapping with the keys of a study file; raise `InputError` if an entry is wrong."""
    try:
        config = StudyFile.model_validate(dict(data))
    except ValidationError as error:
        raise _translate(error) from None
    study = Study(config, path, database)
    cross_check(study)
    if not planned:
        build.check_geometry(study)
    return study


def load_study(path: str | Path, database: Any = None, planned: bool = False) -> Study:
    """Read and check a study file.

    Parameters
    ----------
    path : str or pathlib.Path
        The YAML file.
    database : MaterialDatabase, optional
        Materials. Default: the built-in database, changed and extended by the user's own file.
    planned : bool
        The geometry of every case is checked already; a job of a cluster need not draw the whole design for it.

    Returns
    -------
    Study
        The checked study.

    Raises
    ------
    InputError
        If the file is missing or is not YAML, a key or name is unknown, a value is out of bounds, or the geometry
        contradicts itself. The error names field, value, what is allowed and the nearest known name.

    Examples
    --------
    >>> text = "{name: fit, factors: {roller_profile_radius: {values: [-6.5, -8]}}, contact_model: kalker}"
    >>> characters = Path("study.yaml").write_text(text)
    >>> load_study("study.yaml").design().sizes["case"]
    2
    """
    path = Path(path)
    with files_beside(path):
        data = parse_mapping(read_text(path, "study file"), "study file")
        if data.get("table") is not None:
            find_beside(data["table"], "table")
        return parse_study(data, path, database, planned)
