"""The results of a study, and what follows from them: candidates, sensitivity indices, robustness,
Pareto sets.
"""

from collections.abc import Callable
from typing import Any

# methods of `Results`; trackroller/__init__ adds what shows it
SHOWN: dict[str, Callable[..., Any]] = {}
