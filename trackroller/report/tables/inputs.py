"""Tables of a study's inputs for the report: factors, values that are the same in all cases,
materials, record.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from trackroller.materials import Material
from trackroller.materials.properties import ALTERNATIVES, PROPERTIES, REQUIRED
from trackroller.methods.factor import ROWS
from trackroller.parameters import (
    MAPPING_FIELDS,
    MATERIAL_FIELDS,
    MECHANICAL_MAPPINGS,
    OF_LIMITS,
    PARAMETERS,
)
from trackroller.parameters.carriage_fields import parameter_of
from trackroller.parameters.example import is_absent
from trackroller.report.numbers import (
    capital,
    level_text,
    long_name,
    near,
    number,
    plain,
    rounded,
    row_unit,
    unit_text,
)
from trackroller.report.tables.table import Table
from trackroller.roller.stored_inputs import friction_records, is_default
from trackroller.study.design.levels import NAMED, entries

if TYPE_CHECKING:
    from trackroller.results.results import Results

SHOWN = (  # values of a material on a sheet
    *("youngs_modulus", "poisson_ratio", "tensile_strength", "fatigue_limit"),
    *(
        "cycles_at_tensile_strength",
        "cycles_at_fatigue_limit",
        "scatter_in_cycles",
        "scatter_in_stress",
    ),
    *("yield_strength", "hardness", "wear_coefficient"),
)


@dataclass(frozen=True)
class Row:
    """A quantity in words with its value, its unit, and whether it is the default of an input or of
    the database.
    """

    words: str
    value: str
    unit: str = ""
    default: bool = False
    database: bool = False

    @property
    def origin(self) -> str:
        """Return where the value comes from, in a word."""
        if self.database:
            return "database"
        if self.default:
            return "example"
        return "given"


def input_rows(
    inputs: Mapping[str, Any],
    not_given: Collection[str] | None = None,
    database: Collection[str] = (),
) -> list[Row]:
    """Return the inputs that stand on a sheet: mappings, the guide and fields of limits only if
    they are given.

    A drawn profile of the roller takes the place of the example's radius.

    With `not_given`, the values of these names are marked as defaults, otherwise those that equal
    their default. Values of the names in `database` are those of the database.
    """
    rows = []
    for name, value in inputs.items():
        drawn = (
            name == "roller_profile_radius"
            and inputs.get("roller_profile")
            and is_default(name, value)
        )
        optional = name in (*MAPPING_FIELDS, "guide_overrollings_per_hour") and value is None
        unused = name in OF_LIMITS and is_default(name, value)
        if not (drawn or optional or unused or is_absent(name, value)):
            row = input_row(name, value)
            if not_given is not None:
                row = replace(
                    row, default=name in not_given or name in database, database=name in database
                )
            rows.append(row)
    return rows


def input_row(name: str, value: Any) -> Row:
    """Return an input with its unit; mark the default."""
    if name in PARAMETERS:
        parameter = PARAMETERS[name]
        if value is None:
            shown = "not given"
        elif isinstance(value, (int, float)):
            shown = number(value)
        else:
            shown = str(value)
        words = f"{parameter.long_name} {parameter.symbol}"
        return Row(words, shown, row_unit(parameter.unit), is_default(name, value))
    if name in MAPPING_FIELDS and name not in MECHANICAL_MAPPINGS:
        mapping = value
        if isinstance(value, str):
            mapping = json.loads(value)
        shown = entries(mapping)
    elif name in MAPPING_FIELDS:
        if isinstance(value, str):
            text = value
        else:
            text = json.dumps(value, sort_keys=True)
        shown = level_text(name, text)
    elif isinstance(value, Mapping):
        shown = str(value.get("name", "inline"))
    else:
        shown = str(value)
    return Row(plain(name), shown, "", is_default(name, value))


def material_rows(material: Material) -> list[Row]:
    """Return the values of a material."""
    rows = [Row("name", material.name)]
    for one in map({**PROPERTIES, **ALTERNATIVES}.__getitem__, SHOWN):
        value = getattr(material, one.name)
        # a symbol that the words or the unit hold already is not repeated
        if one.symbol in f"{one.label} {one.unit}":
            words = one.label
        else:
            words = f"{one.label} {one.symbol}"
        row = Row(words, "not given")
        if value is not None:
            row = Row(words, number(value), row_unit(one.unit))
        rows.append(row)
    rows.append(Row("exponent k of the S-N curve", rounded(material.woehler_exponent)))
    if material.second_exponent is not None:
        rows.append(
            Row(f"{PROPERTIES['second_exponent'].label} k_2", rounded(material.second_exponent))
        )
    if material.sn_points:
        shown = "; ".join(
            f"{rounded(stress)} MPa at {rounded(cycles)}" for stress, cycles in material.sn_points
        )
        rows.append(Row("S-N curve by points", shown))
    return rows


def factor_table(results: Results) -> Table | None:
    """List factors and derived parameters: symbol, unit, values as found and as set, number of
    levels.
    """
    specs = {name: _spec(spec) for name, spec in results.config.factors.items()}
    follows = [
        n
        for n, spec in specs.items()
        if n not in results.factors and spec.startswith("=") and n in results.table
    ]
    rows = []
    for name in (*results.factors, *follows):
        levels = results.levels(name)
        parameter = parameter_of(name)
        if results.numeric(name) and (name in follows or not results.grid) and len(levels) > 12:
            values = " … ".join(near(v, levels[-1] - levels[0]) for v in (levels[0], levels[-1]))
        else:
            values = ", ".join(level_text(name, v, unit=name in NAMED) for v in levels)
        if parameter:
            symbol = parameter.symbol
            unit = unit_text(parameter.unit)
        else:
            symbol = ""
            unit = ""
        rows.append(
            [
                f"{capital(long_name(name))} {symbol}",
                unit,
                values,
                specs.get(name) or "listed values",
                len(levels),
            ]
        )
    if rows:
        return Table("factors", "Factors", ["Factor", "Unit", "Values", "Set as", "Number"], rows)
    return None


def _spec(spec: Any) -> str:
    """Return a factor of the study file in words: 'uniform 0.1, 0.3'."""
    if "weights" in spec:
        return f"drawn with weights {', '.join(f'{v:g}' for v in spec['weights'])}"
    kind, value = next(iter(spec.items()))
    if kind == "expression":
        return f"= {value}"
    if kind == ROWS:
        return (
            "rows of a table with "
            f"{', '.join(long_name(column) for column in value[0] if column != 'name')}"
        )
    if kind == "values":
        return ""
    return f"{kind} {', '.join(f'{v:g}' for v in value)}"


def correlation_row(results: Results) -> list[Row]:
    """Return the rank correlations of the study file as one row, if there are any."""
    texts = [
        f"{long_name(one)} with {long_name(other)} {number(rho)}"
        for one, other, rho in results.config.rank_correlations
    ]
    if texts:
        return [Row("Rank correlations", "; ".join(texts))]
    return []


def base_rows(results: Results) -> list[Row]:
    """List the inputs that are the same in all cases."""
    names = [*PARAMETERS, *MATERIAL_FIELDS, *MAPPING_FIELDS]
    if "material_pair" in results.factors:
        names = [*PARAMETERS, *MAPPING_FIELDS]
    given = {
        name: results.base.get(name)
        for name in names
        if name not in (*results.factors, *results.table)
    }
    radius = "roller_profile_radius"
    if is_default(radius, given.get(radius)) and (
        "roller_profile" in results.factors or given.get("roller_profile")
    ):
        given.pop(radius)  # a drawn profile takes the place of the example's radius
    rows = [
        input_row(name, value)
        for name, value in given.items()
        if value not in (None, "") and value == value
    ]
    return [replace(row, words=capital(row.words)) for row in rows]


def materials_table(attrs: Mapping[str, Any]) -> Table | None:
    """List the values of the materials used."""
    heads = [
        "Name",
        *(f"{PROPERTIES[n].symbol} [{unit_text(PROPERTIES[n].unit)}]" for n in REQUIRED),
        "Source",
    ]
    rows = [
        [
            name,
            *(float(values[n]) if n in values else "–" for n in REQUIRED),
            material_source(values),
        ]
        for name, values in stored_materials(attrs).items()
    ]
    if rows:
        return Table("materials", "Materials", heads, rows)
    return None


def stored_materials(attrs: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the values of the materials that a result stores, by name; {} for a result of another
    program.
    """
    try:
        stored = json.loads(str(attrs.get("materials", "{}")))
    except ValueError:
        return {}
    if isinstance(stored, dict):
        return {n: v for n, v in stored.items() if isinstance(v, dict)}
    return {}


def material_source(values: Mapping[str, Any]) -> str:
    """Return where the values of a material come from, and which of them are guesses."""
    source = "; ".join(dict.fromkeys(values.get("sources", {}).values())) or "not given"
    guesses = values.get("guesses", ())
    if not guesses:
        return f"{source}."
    return f"{source}. Guesses without a source: {', '.join(map(plain, guesses))}. Measure them."


def friction_table(attrs: Mapping[str, Any]) -> Table | None:
    """List the friction coefficients that a result took from the database; None if it took none."""
    rows = [
        [
            level_text("material_pair", one["material_pair"]),
            one["level"],
            float(one["value"]),
            friction_source(one),
        ]
        for one in friction_records(attrs)
    ]
    heads = ["Pair", "Level", "Friction coefficient μ", "Source"]
    if rows:
        return Table("friction", "Friction from the database", heads, rows)
    return None


def friction_source(record: Mapping[str, Any]) -> str:
    """Return where a friction coefficient of the database comes from, its note, and whether it is a
    placeholder.
    """
    source = str(record["source"])
    if record["placeholder"]:
        source += " (placeholder)"
    if record.get("note"):
        source += f"; {record['note']}"
    return source


def record_rows(attrs: Mapping[str, Any], skip: set[str]) -> list[Row]:
    """List the global attributes that are needed to repeat the result; mappings are taken apart."""
    rows = []
    for key, value in attrs.items():
        text = str(value)
        if text.startswith("{"):
            try:
                text = ", ".join(f"{k} {v}" for k, v in json.loads(text).items())
            except (ValueError, AttributeError):
                pass
        if text and key not in skip:
            rows += [Row(capital(plain(str(key))), text)]
    return rows
