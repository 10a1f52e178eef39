"""Limits of roller and guide, one file each behind the protocol of `limit`, and the damage sum of a spectrum."""

from __future__ import annotations

from collections.abc import Collection

from trackroller.damage import bearing, catalogue, fatigue, rating, static, verdict
from trackroller.damage.limit import Limit, declarations

_FILES = (static, fatigue, rating, bearing, catalogue)
LIMITS: dict[str, Limit] = {file.LIMIT.name: file.LIMIT for file in _FILES}


def asked(outputs: Collection[str]) -> tuple[Limit, ...]:
    """Return the limits that groups of outputs ask for; the group `limits` without another one asks for all."""
    named = tuple(limit for limit in LIMITS.values() if limit.group in outputs)
    return tuple(LIMITS.values()) if verdict.GROUP in outputs and not named else named


def declared() -> str:
    """Return what the limits declare to `parameters`, as JSON."""
    return declarations(LIMITS.values(), {verdict.GROUP: verdict.MEANING})
