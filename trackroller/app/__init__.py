"""The live page: one roller to play with, studies that start from it, and the server of both on this machine.

The module itself can be called: `tr.app(case)` shows the page in a notebook, see `trackroller.app.start.frame`.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from trackroller.app.start import Frame


class _CallableModule(ModuleType):
    def __call__(self, case: Any = None, folder: Path | str = ".", height: int = 820) -> Frame:
        from trackroller.app.start import frame  # the command line starts faster without it

        return frame(case, folder, height)


sys.modules[__name__].__class__ = _CallableModule
