"""Print what a comparison found."""

from __future__ import annotations

from collections import defaultdict

from validation.same_numbers.compare import Difference, Verdict

MOST = 40  # lines of one kind that are printed


def report(verdicts: list[Verdict], tolerance: float) -> str:
    """Return the report of a comparison as text.

    Parameters
    ----------
    verdicts : list of Verdict
        From `compare`.
    tolerance : float
        The tolerance that was applied.

    Returns
    -------
    str
        Differences by variable and group, problems, remarks, and one line a verdict at the end.
    """
    lines: list[str] = []
    for verdict in verdicts:
        lines += _details(verdict)
    lines.append(f"Tolerance {tolerance:g}, relative to the largest value in the same case.")
    return "\n".join([*lines, *(_summary(verdict) for verdict in verdicts)])


def _details(verdict: Verdict) -> list[str]:
    lines = []
    if verdict.differences:
        lines += [f"{verdict.name}: values that differ", *_table(verdict.differences)]
    for title, told in (("problems", verdict.problems), ("remarks (allowed)", verdict.remarks)):
        if told:
            shortened = [line if len(line) < 240 else line[:237] + "..." for line in told[:MOST]]
            rest = [f"  ... and {len(told) - MOST} more"] if len(told) > MOST else []
            lines += [f"{verdict.name}: {title}", *(f"  {line}" for line in shortened), *rest]
    return lines


def _table(differences: list[Difference]) -> list[str]:
    """Return one line for each variable and below it the groups in which it differs, the largest difference first."""
    by_name: dict[str, list[Difference]] = defaultdict(list)
    for difference in differences:
        by_name[difference.key.rpartition("/")[2]].append(difference)
    lines = [f"  {'variable':32s} {'differ':>9s} {'of':>9s} {'relative':>9s} {'in case':>9s}"]
    for name, several in sorted(by_name.items(), key=lambda item: -max(d.scaled for d in item[1])):
        lines.append(_line(f"  {name:32s}", several))
        for one in sorted(several, key=lambda d: -d.scaled)[:6]:
            group = one.key.rpartition("/")[0].partition("/")[2]
            lines.append(_line(f"    {group:30s}", [one]))
        if len(several) > 6:
            lines.append(f"    ... and {len(several) - 6} more groups")
    return lines


def _line(head: str, several: list[Difference]) -> str:
    differ, total = sum(d.differ for d in several), sum(d.total for d in several)
    relative, scaled = max(d.relative for d in several), max(d.scaled for d in several)
    mark = "  BEYOND" if any(d.beyond for d in several) else ""
    return f"{head} {differ:9d} {total:9d} {relative:9.1e} {scaled:9.1e}{mark}"


def _summary(verdict: Verdict) -> str:
    if not verdict.arrays and not verdict.problems:
        return f"{verdict.name:11s} not recorded"
    state = "same" if verdict.passed else "DIFFERENT"
    differ = sum(difference.differ for difference in verdict.differences)
    largest = max((difference.scaled for difference in verdict.differences), default=0.0)
    return (
        f"{verdict.name:11s} {state:10s} {verdict.arrays} arrays, {differ} of {verdict.values} values differ, "
        f"largest {largest:.1e}; {len(verdict.problems)} problems, {len(verdict.remarks)} remarks"
    )
