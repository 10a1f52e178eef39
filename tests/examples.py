"""How many inputs the property tests generate: CI and `make test-long` ask for more than `make test`."""

from __future__ import annotations

import os

EXAMPLES = int(os.environ.get("TRACKROLLER_EXAMPLES", "300"))
