"""The page of a rule that was fitted to a maker's catalogue: its values, how well known laws hold,
and our exponents beside it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from trackroller.damage.catalogue import OFFSETS, POWERS
from trackroller.fit.catalogue import CatalogueFit
from trackroller.report import html
from trackroller.report.numbers import rounded
from trackroller.report.pages.fit import table_of_tests
from trackroller.report.pages.record import pictures, versions_text
from trackroller.report.tables.table import Table, cell

# exponents of our lives on the load, of a steel roller that rolls freely; measured on the page
# "Against measurements", whose test holds them
OURS = {"wear": 1.28, "fatigue": 2.99}
LOOSE = 0.1  # width of the interval of an offset above which the page says so


def sentences(fit: CatalogueFit) -> list[str]:
    """Return statements on a rule: its values, and how well it and the known laws hold."""
    values = f"exponent {cell(fit.exponent)}{_range(fit, 'exponent')}, offset {cell(fit.offset)}"
    if fit.fits_offset:
        values += _range(fit, "offset")
    else:
        values += " (held)"
    nearest = min(fit.laws, key=lambda law: fit.laws[law])
    least, most = fit.load_factor.min(), fit.load_factor.max()
    values += f", basic life {cell(fit.basic_life)} km"
    if " (" in _range(fit, "exponent"):
        values += "; 90 % intervals in brackets"
    statements = [
        f"{len(fit.life)} lives give {values}.",
        f"The lives deviate from this rule by up to {_percent(fit.deviation)}, and from the "
        f"nearest law, '{nearest}', by up to {_percent(fit.laws[nearest])}.",
        f"Load factors of {rounded(least)} to {rounded(most)} were given; beyond them the rule is "
        "extrapolated.",
    ]
    low, high = fit.interval("offset")
    if high - low > LOOSE:
        statements.append(
            f"The loads hardly tell the offset, which may be {rounded(low, 2)} to "
            f"{rounded(high, 2)}: add smaller loads, or hold it by --offset (offset=)."
        )
    statements.append(
        f"Our life by wear falls with the load to the power {OURS['wear']:g}, and by fatigue to "
        f"the power {OURS['fatigue']:g} (a steel roller that rolls freely)."
    )
    return statements


def entry_text(catalogue: Mapping[str, float]) -> str:
    """Return the entry of a case that a rule gives, in YAML."""
    values = ", ".join(f"{name}: {value:g}" for name, value in catalogue.items())
    return f"catalogue: {{{values}}}"


def entry_note(fit: CatalogueFit) -> str:
    """Return the sentence on what the entry of a case lacks."""
    lacking = "axial_force" if "radial_force" in fit.catalogue else "radial_force and axial_force"
    return f"For a case, add {lacking} [N] of the catalogue to this entry:"


def rule_table(fit: CatalogueFit) -> Table:
    """List the rule, the known laws and our lives: exponent, offset, and largest deviation."""
    rows = [["the fitted rule", cell(fit.exponent), cell(fit.offset), _percent(fit.deviation)]]
    for law, deviation in fit.laws.items():
        rows.append([f"law: {law}", cell(POWERS[law]), cell(OFFSETS[law]), _percent(deviation)])
    for limit, exponent in OURS.items():
        rows.append([f"our life by {limit}, rolling freely", cell(exponent), "–", "–"])
    heads = ["Rule", "Exponent", "Offset", "Largest deviation of a life"]
    return Table("life_rules", "Rules", heads, rows)


def write_rule(fit: CatalogueFit, path: Path | str) -> Path:
    """Write the page of a rule as one HTML file that stands alone, or as PDF by the name of the
    file.

    Parameters
    ----------
    fit : CatalogueFit
        What `trackroller.fit_catalogue` returned.
    path : Path or str
        The file to write.

    Returns
    -------
    Path
        The file.
    """
    from trackroller.report.figures.life_rule import life_over_load  # heavy: matplotlib

    digest = f", sha256 {fit.tests.digest[:16]}" if fit.tests.digest else ""
    content = {
        "name": fit.tests.name,
        "statements": [*sentences(fit), *fit.notes],
        "figures": list(pictures(partial(life_over_load, fit)).values()),
        "rules": rule_table(fit),
        "note": entry_note(fit),
        "entry": entry_text(fit.catalogue),
        "tests": table_of_tests(fit),
        "source": f"{len(fit.life)} rows of {fit.tests.name}{digest}",
        "versions": versions_text(),
    }
    return html.write_page(Path(path), html.render("life_rule.html.j2", content))


def _range(fit: CatalogueFit, name: str) -> str:
    """Return the interval of a value in brackets; '' if there is none."""
    low, high = fit.interval(name)
    if math.isnan(low):
        return ""
    return f" ({cell(low)} to {cell(high)})"


def _percent(share: float) -> str:
    return f"{rounded(100.0 * share, 2)} %"
