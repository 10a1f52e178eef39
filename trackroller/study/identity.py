"""The fingerprint of a case: one name for all that decides its numbers.

A fingerprint is the SHA-256 (first 128 bits, as hexadecimal digits) of

- the digest of the solver's source and data files (`trackroller.study.sources.solver_digest`),
- the options of `solve` where they matter to the case (`trackroller.parameters.OPTIONS` says where),
- the numeric parameters with the friction coefficient resolved, the friction law and the drawn profiles,
- the values, not the names, of both materials.

Two cases with the same fingerprint have the same results. A case that is in the store is therefore never solved again,
whatever study, chunk or order it came from. The versions of NumPy and numba are recorded with a study
(`trackroller.study.provenance`); they do not count, because they change the last digits only.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from trackroller.parameters import MAPPING_FIELDS, OPTIONS, PARAMETERS
from trackroller.roller.case import CaseTable, MaterialArrays
from trackroller.study.sources import solver_digest

_MATERIAL_VALUES = tuple(field.name for field in fields(MaterialArrays) if field.name != "name")


def _prefix(options: Mapping[str, Any]) -> bytes:
    """Return the options that matter to the contact model and the digest of the solver, as canonical bytes."""
    given = {option.name: options.get(option.name, option.default) for option in OPTIONS.values()}
    told = {
        option.name: sorted(value) if isinstance(value := given[option.name], (list, tuple)) else value
        for option in OPTIONS.values()
        if option.identity and option.applies(given["contact_model"])
    }
    return json.dumps(told | {"code": solver_digest()}, sort_keys=True).encode()


def fingerprints(table: CaseTable, options: list[dict[str, Any]] | dict[str, Any]) -> np.ndarray:
    """Return the fingerprint of each case.

    Parameters
    ----------
    table : CaseTable
        n cases.
    options : dict or list of dict
        Keyword arguments of `solve`: one mapping for all cases, or one for each case.

    Returns
    -------
    numpy.ndarray
        Texts of 32 hexadecimal digits, dtype S32, shape (n,).
    """
    columns = [getattr(table, name) for name in PARAMETERS]
    columns += [getattr(body, value) for body in (table.roller, table.guide) for value in _MATERIAL_VALUES]
    rows = np.ascontiguousarray(np.stack([np.asarray(c, dtype="<f8") for c in columns], axis=1))
    rows += 0.0  # -0.0 becomes 0.0
    rows[np.isnan(rows)] = np.nan  # every NaN gets the same bits
    if isinstance(options, Mapping):
        heads = [hashlib.sha256(_prefix(options))] * len(rows)
    else:
        known = {number: hashlib.sha256(_prefix(o)) for number, o in {id(o): o for o in options}.items()}
        heads = [known[id(o)] for o in options]
    texts = [getattr(table, name) for name in MAPPING_FIELDS]
    given = any(np.any(column != "") for column in texts)
    data, width = rows.reshape(-1).view(np.uint8).data, rows.itemsize * rows.shape[1]
    found = bytearray()
    for i, head in enumerate(heads):
        digest = head.copy()
        digest.update(data[i * width : (i + 1) * width])
        if given:
            digest.update(json.dumps([column[i] for column in texts]).encode())
        found += digest.digest()[:16]
    return np.frombuffer(found.hex().encode(), dtype="S32")


def chunk_name(cases: np.ndarray) -> str:
    """Return the name of a chunk, a hash of its cases' fingerprints (dtype S32, shape (n,))."""
    return hashlib.sha256(np.ascontiguousarray(cases).tobytes()).hexdigest()[:16]
