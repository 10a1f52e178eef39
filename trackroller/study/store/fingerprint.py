"""The fingerprint of a case: one name for all that decides its numbers.

A fingerprint is the SHA-256 (first 128 bits, as hexadecimal digits) of

- the digest of the solver's source and data files
  (`trackroller.study.store.program_digest.solver_digest`),
- the source of a contact model from outside,
- the options of `solve` where they matter to the case (`trackroller.parameters.OPTIONS` says
  where),
- the numeric parameters with the friction coefficient resolved, the friction law and the drawn
  profiles,
- the values, not the names, of both materials.

Two cases with the same fingerprint have the same results. A case that is in the store is therefore
never solved again, whatever study, chunk or order it came from. The versions of NumPy and numba are
recorded with a study (`trackroller.study.store.provenance`); they do not count, because they change
the last digits only.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError
from trackroller.materials import MaterialDatabase
from trackroller.parameters import MAPPING_FIELDS, OPTIONS, PARAMETERS
from trackroller.parameters.contact_models import DECLARED
from trackroller.roller.case import CaseTable, MaterialArrays, to_table
from trackroller.roller.case_table import TEXTS
from trackroller.roller.options import options_of_cases
from trackroller.study.design.carriage_cases import ROW
from trackroller.study.store.program_digest import solver_digest

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

# cases whose table is in memory at once; the table of millions of cases would take gigabytes
BLOCK = 100_000
_MATERIAL_VALUES = tuple(field.name for field in fields(MaterialArrays) if field.name not in TEXTS)


def _prefix(options: Mapping[str, Any]) -> bytes:
    """Return the options that matter to the contact model and the digest of the solver, as
    canonical bytes.
    """
    model = options.get("contact_model", OPTIONS["contact_model"].default)
    values: dict[str, Any] = {"code": solver_digest()}
    for option in OPTIONS.values():
        if not option.identity or not option.applies(model):
            continue
        value = options.get(option.name, option.default)
        if isinstance(value, (list, tuple)):
            value = sorted(value)
        values[option.name] = value
    if DECLARED[model].source:
        values["model"] = DECLARED[model].source
    return json.dumps(values, sort_keys=True).encode()


def fingerprints(
    table: CaseTable, *options: Mapping[str, Any], group: np.ndarray | None = None
) -> np.ndarray:
    """Return the fingerprint of each case.

    Parameters
    ----------
    table : CaseTable
        n cases.
    *options : dict
        Keyword arguments of `solve`.
    group : numpy.ndarray of int, shape (n,), optional
        Index of each case's options; by default all cases have the first.

    Returns
    -------
    numpy.ndarray
        Texts of 32 hexadecimal digits, dtype S32, shape (n,).
    """
    columns = [getattr(table, name) for name in PARAMETERS]
    columns += [
        getattr(body, value) for body in (table.roller, table.guide) for value in _MATERIAL_VALUES
    ]
    rows = np.ascontiguousarray(np.stack([np.asarray(c, dtype="<f8") for c in columns], axis=1))
    rows += 0.0  # -0.0 becomes 0.0
    rows[np.isnan(rows)] = np.nan  # every NaN gets the same bits
    heads = [hashlib.sha256(_prefix(settings)) for settings in options]
    if group is None:
        group = np.zeros(len(rows), dtype=int)
    texts = [getattr(table, name) for name in MAPPING_FIELDS]
    texts += [
        text
        for body in (table.roller, table.guide)
        for text in (body.temperature_dependence, body.sn_points, body.energy_wear)
    ]
    has_texts = any(np.any(column != "") for column in texts)
    data = rows.reshape(-1).view(np.uint8).data
    width = rows.itemsize * rows.shape[1]
    digests = bytearray()
    for i, number in enumerate(group.tolist()):
        digest = heads[number].copy()
        digest.update(data[i * width : (i + 1) * width])
        if has_texts:
            digest.update(json.dumps([column[i] for column in texts]).encode())
        digests += digest.digest()[:16]
    return np.frombuffer(digests.hex().encode(), dtype="S32")


def chunk_name(cases: np.ndarray) -> str:
    """Return the name of a chunk, a hash of its cases' fingerprints (dtype S32, shape (n,))."""
    return hashlib.sha256(np.ascontiguousarray(cases).tobytes()).hexdigest()[:16]


def solver_and_materials(database: MaterialDatabase) -> str:
    """Return a digest of the solver and of every value in a database: the two that a planned case
    does not state.
    """
    friction = sorted((sorted(pair), levels) for pair, levels in database.friction_table.items())
    stated = repr(
        (
            solver_digest(),
            sorted(database.materials.items()),
            friction,
            sorted(database.wear_table.items()),
        )
    )
    return hashlib.sha256(stated.encode()).hexdigest()


@dataclass(frozen=True)
class StudyCases:
    """The cases of a study, which are built and identified when they are first needed, and only
    once.
    """

    study: Study

    @cached_property
    def design(self) -> xr.Dataset:
        """Return the cases as the solver takes them."""
        return self.study.design()

    @property
    def rows(self) -> np.ndarray:
        """Return the row of the study's design of each case, shape (n,)."""
        design = self.design
        if ROW in design.coords:
            return np.asarray(design[ROW].values)
        return np.arange(design.sizes["case"])

    @cached_property
    def options(self) -> tuple[list[dict[str, Any]], np.ndarray]:
        """Return the different options of `solve`, and the index of each case's options."""
        return options_of_cases(self.design, {})

    @cached_property
    def fingerprints(self) -> np.ndarray:
        """Return the fingerprint of each case, dtype S32, shape (n,); raise `InputError` if a case
        is not valid.
        """
        options, group = self.options
        database = self.study.materials
        cases = self.design.drop_vars(list(self.design.coords))
        out = np.empty(len(group), dtype="S32")
        for start in range(0, len(out), BLOCK):
            block = slice(start, start + BLOCK)
            try:
                table = to_table(cases.isel(case=block), database)
            except InputError:
                # names the case by its number in the design, not in the block
                to_table(cases, database)
                raise
            out[block] = fingerprints(table, *options, group=group[block])
        return out
