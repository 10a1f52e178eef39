"""Rows of text that list the material database on a screen."""

from __future__ import annotations

from math import nan

from trackroller.errors import InputError
from trackroller.materials.database import MaterialDatabase
from trackroller.materials.energy_wear import FIELD as ENERGY_WEAR
from trackroller.materials.energy_wear import LISTS
from trackroller.materials.properties import PROPERTIES, REQUIRED, Value


def material_rows(database: MaterialDatabase, search: str = "") -> list[dict[str, str]]:
    """Return one row for each material: name, family, values, number of placeholders, origin,
    description.

    With `search`, only the materials whose name, family or description holds its words.
    """
    rows = []
    if search:
        names = database.search(search)
    else:
        names = database.names()
    if not names:
        remedy = "`trackroller materials list` shows all materials."
        raise InputError(
            "material", search, "words of the name or the description of a material", remedy
        )
    for material in map(database.material, names):
        row = {"name": material.name, "family": material.family or "-"}
        for name in REQUIRED:
            prop = PROPERTIES[name]
            if prop.unit == "-":
                heading = prop.symbol
            else:
                heading = f"{prop.symbol} [{prop.unit}]"
            row[heading] = f"{getattr(material, name):g}"
        row["placeholders"] = str(len(material.placeholders) + len(material.guesses_of_limits))
        row["origin"] = (
            ", ".join(dict.fromkeys(r.origin for r in material.records.values())) or "inline"
        )
        row["description"] = material.description
        rows.append(row)
    return rows


def material_details(database: MaterialDatabase, name: str) -> list[dict[str, str]]:
    """Return one row for each value of a material: field, symbol, value, unit, source, mark, note,
    origin.
    """
    material = database.material(name)
    rows = []
    for prop in PROPERTIES.values():
        value = getattr(material, prop.name)
        if value is None:
            continue
        record = material.records.get(prop.name, Value(value, prop.unit, "not given"))
        rows.append(_row(prop.name, prop.symbol, record))
    of_limit = "R_m times sigma_D/R_m"
    of_exponent = "ln(N_k/N_Rm) / ln(R_m/sigma_D)"
    if material.sn_points:
        of_limit = "the last point of sn_points"
        of_exponent = "of the last two points of sn_points"
        ratio = material.records.get("fatigue_strength_ratio", Value(nan, "-", "not given"))
        record = Value(nan, "MPa, -", ratio.source, ratio.placeholder)
        shown = "; ".join(f"{stress:g}, {cycles:g}" for stress, cycles in material.sn_points)
        rows.append(_row("sn_points", "sigma_a, N", record) | {"value": shown})
    limit = Value(material.fatigue_limit, "MPa", of_limit, origin="derived")
    exponent = Value(material.woehler_exponent, "-", of_exponent, origin="derived")
    table = material.temperature_dependence
    if table is not None:
        over = ", ".join(f"{value:g}" for value in table.temperature)
        for key, column in table.columns.items():
            record = Value(
                column[0], PROPERTIES[key].unit, table.source, table.placeholder, f"at {over} degC"
            )
            row = _row(f"{key} over temperature", f"{PROPERTIES[key].symbol}(theta)", record)
            rows.append(row | {"value": ", ".join(f"{value:g}" for value in column)})
    law = material.energy_wear
    if law is not None:
        over = ", ".join(f"{value:g}" for value in law.work_rate)
        note = f"at {over} N/mm2"
        if law.note:
            note += f"; {law.note}"
        record = Value(law.loss[0], LISTS["loss"].unit, law.source, law.placeholder, note)
        row = _row(ENERGY_WEAR, "", record)
        rows.append(row | {"value": ", ".join(f"{value:g}" for value in law.loss)})
    return [*rows, _row("fatigue_limit", "sigma_D", limit), _row("woehler_exponent", "k", exponent)]


def friction_rows(database: MaterialDatabase) -> list[dict[str, str]]:
    """Return one row for each pair and level of the friction table, and for each pair and body of
    the wear table.
    """
    rows = []
    for pair, levels in database.friction_table.items():
        if len(pair) == 2:
            names = sorted(pair)
        else:
            names = [*pair, *pair]
        for level, record in levels.items():
            head = {"pair": " - ".join(names), "level": level}
            rows.append(head | _row("friction_coefficient", "mu", record))
    symbol = PROPERTIES["wear_coefficient"].symbol
    for (body, partner), classes in database.wear_table.items():
        for hardness, record in classes.items():
            level = f"wear of {body}"
            if hardness is not None:
                level += " of {:g} to {:g} HB".format(*hardness)
            head = {"pair": f"{body} on {partner}", "level": level}
            rows.append(head | _row("wear_coefficient", symbol, record))
    return rows


def _row(name: str, symbol: str, record: Value) -> dict[str, str]:
    return {
        "field": name,
        "symbol": symbol,
        "value": f"{record.value:g}",
        "unit": record.unit,
        "source": record.source,
        "placeholder": "placeholder" if record.placeholder else "",
        "note": record.note
        or ("" if record.range is None else "expected from {:g} to {:g}".format(*record.range)),
        "origin": record.origin,
    }
