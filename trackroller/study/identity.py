"""What a case is: a fingerprint of all that decides its numbers.

A fingerprint is the SHA-256 (first 128 bits, as hex) of: `RESULTS_VERSION`, the options of the solver
(outputs, contact model, spin model where it matters, accuracy, hertz, stress_bodies, life_rule, normal,
stop_if, slip_terms where they matter), the numeric parameters of the case with the friction coefficient resolved,
friction law and profiles, and the *values* (not the names) of both materials. Two cases with the same fingerprint have
the same results, so a case that is in the store is never solved again, whatever study, chunk or order it came from.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.parameters import MAPPING_FIELDS, PARAMETERS

RESULTS_VERSION = 13  # raise it with every change of the solver that changes numbers: all cases are solved anew

_MATERIAL_VALUES = (
    "youngs_modulus",
    "poisson_ratio",
    "tensile_strength",
    "fatigue_limit",
    "cycles_at_tensile_strength",
    "cycles_at_fatigue_limit",
)
_PHYSICS = (
    "solver.py",
    "stages",
    "equilibrium",
    "geometry.py",
    "fatigue.py",
    "accuracy.py",
    "contact",
    "contact_choice.py",
    "contact_choice_probe.py",
    "halfspace",
    "quadrature.py",
)


def _prefix(options: Mapping[str, Any]) -> bytes:
    """The options as canonical bytes; the order of the output groups does not matter."""
    told = {k: sorted(v) if isinstance(v, (list, tuple)) else v for k, v in options.items()}
    if told.get("contact_model") not in ("sliding", "auto"):
        told.pop("spin_model", None)
    if told.get("contact_model") != "auto":
        told.pop("contact_tolerance", None)
    told.pop("shortcuts", None)
    if not told.get("slip_terms") or told.get("contact_model") == "sliding":  # which has the profile's slip anyway
        told.pop("slip_terms", None)
    told["results_version"] = RESULTS_VERSION
    return json.dumps(told, sort_keys=True).encode()


def fingerprints(table: Any, options: list[dict[str, Any]] | dict[str, Any]) -> np.ndarray:
    """Fingerprint of each case.

    Parameters
    ----------
    table : `trackroller.roller.case.CaseTable` of n cases
    options : keyword arguments of `solve`, one mapping for all cases or one a case

    Returns
    -------
    numpy.ndarray of dtype S32, shape (n,)
    """
    columns = [getattr(table, name) for name in PARAMETERS]
    columns += [getattr(body, value) for body in (table.roller, table.guide) for value in _MATERIAL_VALUES]
    rows = np.ascontiguousarray(np.stack([np.asarray(c, dtype="<f8") for c in columns], axis=1))
    rows += 0.0  # -0.0 is 0.0
    rows[np.isnan(rows)] = np.nan  # one NaN
    if isinstance(options, Mapping):
        head = hashlib.sha256(_prefix(options))
        heads = [head] * len(rows)
    else:
        known: dict[int, Any] = {}
        heads = [known.setdefault(id(o), hashlib.sha256(_prefix(o))) for o in options]
    texts = [getattr(table, name) for name in MAPPING_FIELDS]
    told = [column for column in texts if np.any(column != "")]
    out = np.empty(len(rows), dtype="S32")
    for i, row in enumerate(rows):
        digest = heads[i].copy()
        digest.update(row.tobytes())
        if told:
            digest.update(json.dumps([column[i] for column in texts]).encode())
        out[i] = digest.hexdigest()[:32]
    return out


def chunk_name(cases: np.ndarray) -> str:
    """Content-hash name of a chunk, from the fingerprints of its cases."""
    return hashlib.sha256(np.ascontiguousarray(cases).tobytes()).hexdigest()[:16]


def physics_code() -> str:
    """Hash of the solver's sources: tells a reader that code has changed though `RESULTS_VERSION` has not."""
    root = Path(__file__).parent.parent
    digest = hashlib.sha256()
    for entry in _PHYSICS:
        path = root / entry
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            if file.is_file():
                digest.update(file.name.encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()[:16]
