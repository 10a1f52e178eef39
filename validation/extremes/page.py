"""The numbers of the page on the ends of the parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Record = dict[str, Any]


def facts(data: Mapping[str, Any]) -> Record:
    """Return what the template `extremes.md` shows.

    Parameters
    ----------
    data : mapping
        With the record of `validation.extremes.run` under `extremes`.

    Returns
    -------
    dict
        `held` and `claims`, numbers of claims; `scenes`, their number; `settings` in words; `broken` and `random`, rows
        of tables.
    """
    record = data["extremes"]
    findings = [(row, f) for row in record["scenes"] for f in row["findings"]]
    return {
        "held": sum(f["holds"] for _, f in findings),
        "claims": len(findings),
        "scenes": len({row["scene"] for row in record["scenes"]}),
        "settings": ", ".join(f"`{model}` at `{accuracy}`" for model, accuracy in record["accuracies"].items()),
        "broken": [_broken(row, f) for row, f in findings if not f["holds"]],
        "random": [_random(row) for row in record["random"]],
    }


def _broken(row: Record, f: Record) -> tuple[str, ...]:
    where = f"{row['quantity']} = {float(f['where']):g}"
    return row["scene"], row["model"], f["check"], f"{float(f['deviation']):.2g}", f"{f['tolerance']:.2g}", where


def _random(r: Record) -> tuple[Any, ...]:
    regimes = ", ".join(f"{n} {name}" for name, n in r["regimes"].items())
    counts = (r[name] for name in ("undefined", "warnings", "failed_small_patch", "other_regime"))
    return r["model"], r["count"], regimes, *counts, f"{r['scaling']:.1e}"
