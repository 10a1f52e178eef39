"""Limits of roller and guide, one file each behind the protocol of `limit`, and the damage sum of a spectrum."""

from __future__ import annotations

from trackroller.damage import fatigue
from trackroller.damage.limit import Limit

_FILES = (fatigue,)
LIMITS: dict[str, Limit] = {file.LIMIT.name: file.LIMIT for file in _FILES}
