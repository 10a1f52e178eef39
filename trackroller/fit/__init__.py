"""Values of materials from tests: S-N lines of coupons and rollers, wear and friction, how sure,
and the next test.
"""

from collections.abc import Callable
from typing import Any

# methods of `MaterialFit`; trackroller/__init__ adds what shows it
SHOWN: dict[str, Callable[..., Any]] = {}
