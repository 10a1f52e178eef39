"""The sentence on a sample that grew until its intervals were narrow, and the table of its looks."""

from __future__ import annotations

from trackroller.analysis.looks import looks_of
from trackroller.analysis.table import StudyView
from trackroller.report.numbers import capital, plain, rounded
from trackroller.report.tables.table import Table
from trackroller.report.words.sentence import Sentence, say
from trackroller.report.words.targets import samples_of_points
from trackroller.study.file.goals import statistic
from trackroller.study.outputs import DEFAULTS

HEADLINE_WORDS = {  # by design, the quantities whose intervals count
    "sobol": "first-order indices",
    "lhs": "first-order indices",
    "saltelli": "first-order and total indices",
    "morris": "effects mu*, as shares of the output's range,",
    "inner_outer": "log10 B10 or a probability at each design point",
}


def quantity_words(name: str, design: str) -> str:
    """Name an entry of `until.of` in words."""
    kind, output = statistic(name) if design == "inner_outer" else ("", name)
    words = DEFAULTS[output][4] if output in DEFAULTS else plain(output)
    if design == "inner_outer":
        return f"probability of {words}" if kind == "probability" else f"log10 B10 of the {words}"
    return words


def grown(view: StudyView) -> Sentence | None:
    """Say what a growing sample was to reach, why it stopped, and what it reached; None for other studies."""
    growth = looks_of(view.solved)
    if growth is None:
        return None
    last, design = growth["looks"][-1], view.solved.design.method
    widths = [(quantity_words(n, design), width, last["at"][n]) for n, width in last["half_width"].items()]
    sens = view.analysis
    points = samples_of_points(sens) if sens is not None and "point_samples" in sens else ""
    facts = {name: growth[name] for name in ("half_width", "stopped", "replicates")}
    values = {"what": HEADLINE_WORDS[design], "cases": last["cases"], "widths": widths, "points": points}
    return say("growth", "grown", **values, **facts)


def looks_table(view: StudyView) -> Table | None:
    """List the widest interval of each output at each look; None for a study without the key `until`."""
    growth = looks_of(view.solved)
    if growth is None:
        return None
    rows = []
    for one in growth["looks"]:
        row = {"Cases": one["cases"]}
        for name, width in one["half_width"].items():
            text = "–" if width is None else f"± {rounded(width, 2)} ({one['at'][name]})"
            row[capital(quantity_words(name, view.solved.design.method))] = text
        rows.append(row)
    note = f"Widest 95 % interval at each look and where; wanted: ± {growth['half_width']:g}."
    return Table.of("looks", "Intervals as the sample grew", rows, f"{note} Stopped: {growth['stopped']}.")
