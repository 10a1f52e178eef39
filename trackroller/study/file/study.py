"""A checked study: what its file says, and what follows from it."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.carriage.file import Carriage, carriage_of
from trackroller.files import Reads
from trackroller.materials import MaterialDatabase, load_database
from trackroller.methods.factor import Factor, parse
from trackroller.parameters import BODIES, LIMITS, MATERIAL_FIELDS, OPTIONS
from trackroller.roller.doubts import doubts
from trackroller.roller.stored_inputs import NOT_GIVEN
from trackroller.study.design import build, carriage_cases
from trackroller.study.design.factor_names import OPTION_FACTORS
from trackroller.study.design.shelf_rows import columns_of_shelves
from trackroller.study.file.config import IN_STUDY, StudyFile
from trackroller.yaml_file import write_yaml

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.methods import Design


@dataclass(frozen=True)
class Study:
    """What a study file says, checked.

    Parameters
    ----------
    config : what the study file says
    path : path of the study file
    database : its materials, None for those of the program and of the user
    inputs : the files that were read for it
    not_given : parameters that the study file does not name; `config.base` holds the values used
        for them, which are those of the paper's example
    grown : number of samples to which the key `until` has grown the sample, one for each design
        point of an inner/outer design; empty at the first look
    """

    config: StudyFile
    path: Path | None = None
    database: Any = field(default=None, compare=False, repr=False)
    inputs: Reads = field(default_factory=dict, compare=False, repr=False)
    not_given: tuple[str, ...] = field(default=(), compare=False)
    grown: tuple[int, ...] = ()

    @property
    def name(self) -> str:
        """Return the name of the study and of its results folder."""
        return str(self.config.name)

    @cached_property
    def factors(self) -> dict[str, dict[str, Any]]:
        """Return all factors, including lists of contact models or spin models."""
        extra = {
            name: {"values": list(value)}
            for name in OPTION_FACTORS
            if not isinstance(value := getattr(self.config, name), str)
        }
        return {**self.config.factors, **extra}

    @property
    def samples(self) -> int:
        """Return the number of samples, at the design point with most of them: as stated, or as
        grown by `until`.
        """
        return max(self.grown, default=int(self.config.samples))

    @property
    def friction_laws(self) -> list[Any]:
        """Return the friction laws of the study file as it states them; None and "" stand for
        constant friction.
        """
        return list(
            self.factors.get("friction_law", {}).get(
                "values", [self.config.base.get("friction_law")]
            )
        )

    @cached_property
    def parsed(self) -> dict[str, Factor]:
        """Return all factors as `Factor`."""
        return {name: parse(name, spec) for name, spec in self.factors.items()}

    @cached_property
    def columns_of_shelves(self) -> dict[str, Factor]:
        """Return the columns of the shelves of the study, each as a list of values."""
        return columns_of_shelves(self.parsed)

    @cached_property
    def carriage(self) -> Carriage | None:
        """Return the carriage whose rollers are solved, None for a study of one roller."""
        if self.config.carriage is None:
            return None
        return carriage_of(self.config.carriage)

    @cached_property
    def materials(self) -> MaterialDatabase:
        """Return the material database: the built-in one, changed and extended by the user's
        file.
        """
        if self.database is None:
            return load_database()
        database: MaterialDatabase = self.database
        return database

    @property
    def decides(self) -> bool:
        """Return whether results decide which cases follow; with a table of its designs a search is
        at its end.
        """
        return self.config.until is not None or (
            self.config.method.proposes and self.config.table is None
        )

    @property
    def table_path(self) -> Path:
        """Return the path of the CSV of cases; a relative path starts from the folder of the study
        file.
        """
        table = Path(str(self.config.table))
        if self.path is None:
            return table
        return self.path.parent / table

    @property
    def options(self) -> dict[str, Any]:
        """Return the keyword arguments of `solve` that are not factors."""
        given = {
            o.name: getattr(self.config, o.name) for o in IN_STUDY if o.name not in self.factors
        }
        return given | {"at_most": self._at_most}

    @cached_property
    def _at_most(self) -> tuple[str, ...]:
        """Return the limits whose utilisation may be told by a bound.

        A limit whose group is among the outputs has its numbers, and so has one whose utilisation
        the study file names, as a goal or constraint. The tables of a carriage take numbers.
        """
        if self.carriage is not None:
            return ()
        return tuple(
            name
            for name in OPTIONS["at_most"].values
            if LIMITS[name].group not in self.config.outputs
            and not any(f"utilisation_{body}_{name}" in self._text for body in BODIES)
        )

    def merged(self, table: str | None = None) -> str:
        """Return the study as YAML with every default written out.

        Parameters
        ----------
        table : str, optional
            Write this path of the table of cases instead of that in the study file.
        """
        if table is None:
            return self._text
        return write_yaml(self.as_dict() | {"table": table})

    def as_dict(self) -> dict[str, Any]:
        """Return what the study file says, every default included, as values of YAML."""
        return dict(self.config.model_dump(mode="json", exclude_none=True, by_alias=True))

    @cached_property
    def _text(self) -> str:
        # kept: planning, solving and gathering ask for it several times
        return write_yaml(self.as_dict())

    @cached_property
    def drawn(self) -> Design:
        """Return the drawn design; it is kept, because reading a CSV of a million cases takes
        seconds.
        """
        return build.draw(self.config, self.factors, self.table_path, self.grown)

    def doubts(self) -> list[str]:
        """Return a sentence for each value that is unusual, see `trackroller.roller.doubts`."""
        values = {**self.config.base, **self.drawn.columns}
        pair = np.ravel(np.array(values.get("material_pair", ()), dtype=object)).tolist()
        names: list[str] = []
        for entry in pair:
            if isinstance(entry, tuple):
                names += entry
            else:
                names += str(entry).split(" / ")
        names += [
            name
            for field in MATERIAL_FIELDS
            for name in set(np.ravel(values.get(field, ())).tolist())
        ]
        return doubts(values, map(self.materials.material, dict.fromkeys(names)))

    def design(self) -> xr.Dataset:
        """Return the cases of the study.

        Returns
        -------
        xarray.Dataset
            Dimension `case`, one variable a parameter, materials by name. The attributes hold the
            study file and the options that `solve` takes for these cases. A study of a carriage has
            a case for each loaded roller in each load case, see
            `trackroller.study.design.carriage_cases`.
        """
        attrs = {
            "study": self.merged(),
            "options": json.dumps(self.options),
            NOT_GIVEN: json.dumps(self.not_given),
        }
        if self.carriage is not None:
            cases = carriage_cases.expanded(self.config, self.drawn, self.materials, self.carriage)
        else:
            cases = build.build(self.config, self.drawn, self.materials)
        return cases.assign_attrs(attrs)
