"""Load limits of a user's own, and print what they declare: `python -m trackroller.damage.own FILE ...`."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

from trackroller.damage.limit import Limit, declarations


def load(path: Path) -> Limit:
    """Return the limit of a file.

    Raises
    ------
    ValueError
        If the file declares no `LIMIT` with the name of the file.
    """
    spec = importlib.util.spec_from_file_location(f"own_limit_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    limit = getattr(module, "LIMIT", None)
    if not isinstance(limit, Limit) or limit.name != path.stem:
        raise ValueError(f"{path.name} must declare LIMIT = Limit(name='{path.stem}', ...)")
    return limit


if __name__ == "__main__":
    print(declarations([load(Path(word)) for word in sys.argv[1:]], {}))
