"""Check that the keys of a study file fit together."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.damage import check_used
from trackroller.errors import Collector, InputError, listing, raise_all, unknown_name
from trackroller.methods import those_with
from trackroller.methods.correlation import copula
from trackroller.methods.factor import ROWS, UNBOUNDED
from trackroller.numerics.numbers import number_or_nan
from trackroller.parameters import BODIES, MATERIAL_FIELDS, PARAMETERS
from trackroller.roller.fields import FIELDS, other_than_default
from trackroller.roller.geometry import contact_geometry, geometry_problem, geometry_problems
from trackroller.roller.options import (
    check_accuracy,
    check_not_checked,
    check_pairs,
    check_spin_model,
    check_surface,
)
from trackroller.study.design.build import MAX_CASES
from trackroller.study.design.carriage_cases import ROW
from trackroller.study.design.factor_names import (
    BEARING_DIAMETER,
    CASE_FIELDS,
    GEOMETRY,
    OPTION_FACTORS,
    SHELVES,
    SIZES,
    check_own_name,
)
from trackroller.study.design.levels import in_words
from trackroller.study.design.read_table import read_cases, table_lines
from trackroller.study.design.roles import check_roles
from trackroller.study.design.shelf_rows import field_of_row
from trackroller.study.file.correlations import check_design
from trackroller.study.file.goals import check, check_scatter
from trackroller.study.file.search import check_search
from trackroller.study.file.study import Study
from trackroller.study.file.until import check_first_look, check_until
from trackroller.study.file.user_columns import column_names

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import Material, MaterialDatabase
    from trackroller.methods.factor import Factor


MOST_LEVELS = 12
FILM = "layer_flexibility"


def _check_options(study: Study) -> None:
    """Refuse options that exclude each other, in any combination of the levels that are factors."""

    config = study.config

    def levels(name: str) -> list[str]:
        return list(study.factors.get(name, {}).get("values", [getattr(study.config, name)]))

    for model, normal in itertools.product(levels("contact_model"), levels("normal")):
        check_pairs(study.config.hertz, normal, study.config.slip_terms, model)
    check_spin_model(levels("spin_model"), levels("contact_model"))
    check_not_checked(config.outputs, config.not_checked)
    given = {
        name: study.factors.get(name, study.config.base.get(name))
        for name in ("travel", "guide_profile", "roller_profile")
    }
    shaped = [name for name, value in given.items() if value and number_or_nan(value, "km") != 0.0]
    if shaped and "hertz" in levels("normal"):
        allowed = f"halfspace, because {' and '.join(shaped)} may leave no circle"
        raise InputError("normal", "hertz", allowed, "Write normal: halfspace.")
    given = {
        name: value
        for name, value in config.base.items()
        if name in FIELDS and name not in study.not_given
    }
    for where, values in (("base.", given), ("factors.", study.factors)):
        check_used(other_than_default(values), config.outputs, config.not_checked, where)
    check_used({"duty": config.duty}, config.outputs, config.not_checked)
    for model in levels("contact_model"):
        check_accuracy(study.config.accuracy, model, study.config.outputs)


def _check_surfaces(study: Study) -> None:
    """Refuse friction laws and films of a study that one of its contact models does not serve.

    Films of expressions, tables and shelves are checked on the whole design, see `check_geometry`.
    """
    where = "base"
    if "friction_law" in study.factors:
        where = "factors"
    for model, law in itertools.product(_contact_models(study), study.friction_laws):
        with _named(f"{where}.friction_law"):
            check_surface(model, law, 0.0)
    factor = study.parsed.get(FILM)
    films: Sequence[Any] = [study.config.base.get(FILM, 0.0)]
    where = "base"
    if factor is not None:
        films = factor.levels if factor.discrete else [max(factor.numbers, default=0.0)]
        where = "factors"
    for model, film in itertools.product(_contact_models(study), films):
        with _named(f"{where}.{FILM}"):
            check_surface(model, None, number_or_nan(film, PARAMETERS[FILM].unit))


def _contact_models(study: Study) -> list[str]:
    """Return the contact models of a study, those of the levels of a factor too."""
    return list(study.factors.get("contact_model", {}).get("values", [study.config.contact_model]))


@contextmanager
def _named(field: str) -> Iterator[None]:
    """Name the place of a value in the study file in the error of a block."""
    try:
        yield
    except InputError as error:
        raise error.named(field) from None


def _check_films(study: Study, design: xr.Dataset) -> None:
    """Refuse a film in a row of a design that a contact model of the study does not serve."""
    if FILM not in design:
        return
    films = design[FILM].values
    for row in np.flatnonzero(films > 0.0)[:1].tolist():
        for model in _contact_models(study):
            try:
                check_surface(model, None, float(films[row]))
            except InputError as error:
                if study.config.method.observed:
                    raise error.at(study.table_path, table_lines(study.table_path)[row]) from None
                raise error.named(f"factors.{FILM}") from None


def cross_check(study: Study) -> None:
    """Check what the keys of a study file say together.

    Parameters
    ----------
    study : the study

    Raises
    ------
    InputError : keys contradict each other, or the design, the materials or the geometry cannot be
        what they say
    """
    _check_options_stand_once(study)
    _check_shelves(study)
    _check_values_stand_once(study)
    _check_table(study.config)
    study.config.method.check(study.parsed)
    _check_one_model(study)
    for name in study.factors:
        check_own_name(name, f"factors.{name}")
    wrong = Collector()
    for check_keys in (
        _check_goals,
        _check_roles,
        _check_parts,
        _check_options,
        _check_surfaces,
        _check_correlations,
        _check_materials,
    ):
        with wrong.part():
            check_keys(study)
    wrong.check()
    check_first_look(study)


def _check_options_stand_once(study: Study) -> None:
    """Refuse an option that stands as a key and among the factors."""
    for name in OPTION_FACTORS:
        value = getattr(study.config, name)
        if name in study.config.factors and not isinstance(value, str):
            raise InputError(name, value, "", "Keep one.", wrong="stands among the factors too")


def _check_values_stand_once(study: Study) -> None:
    """Refuse materials as a pair and one by one, and a value of `base` beside its factor."""
    base = study.config.base
    both = {*study.factors, *base} & {"material_pair"}
    single = {*study.factors, *base, *study.columns_of_shelves} & set(MATERIAL_FIELDS)
    if both and single:
        raise InputError(
            "material_pair", sorted(single), "the pair or the single materials, not both"
        )
    doubled = set(base) & set(study.factors)
    if doubled:
        name = min(doubled)
        beside = f"stands beside a factor {name}"
        raise InputError(f"base.{name}", base[name], "", "Remove one of them.", wrong=beside)


def _check_table(config: Any) -> None:
    """Refuse a table without the method that reads it, and this method without a table."""
    if config.method.proposes or config.method.observed == (config.table is not None):
        return
    allowed = "method: table and the path of a CSV or Excel file together"
    remedy = "Write 'table: cases.csv' too, with your file."
    if config.table:
        remedy = "Write 'method: table' too."
    raise InputError("table", config.table, allowed, remedy)


def _check_one_model(study: Study) -> None:
    """Refuse a search over several contact models."""
    several = [name for name in OPTION_FACTORS if name in study.factors]
    if study.config.method.proposes and several:
        models = study.factors[several[0]]["values"]
        raise InputError(several[0], models, "one model: a search compares designs")


def _check_goals(study: Study) -> None:
    """Check goals, constraints, budget and stopping rule of a study.

    A constraint may name a further column of the table, whose cells say whether it holds numbers.
    """
    config = study.config
    columns: Mapping[str, np.ndarray] = {}
    if config.method.observed and config.constraints:
        columns = study.drawn.columns
    named = study.parsed | study.columns_of_shelves
    check(config, named, columns)
    check_search(config, named)
    check_until(config)


def _check_shelves(study: Study) -> None:
    """Refuse a column of a shelf whose values `base`, a factor or another shelf gives, too."""
    wrong = Collector()
    shelf_of: dict[str, str] = {}
    for shelf, factor in study.parsed.items():
        for name in factor.beside:
            where = f"factors.{shelf}.{name}"
            remedy = "Remove one of them."
            if name in shelf_of:
                if name not in (*CASE_FIELDS, *SIZES):
                    remedy = f"Rename one of them, such as {shelf}_{name}."
                beside = f"is a column of factors.{shelf_of[name]} too"
                wrong.errors.append(
                    InputError(where, None, "one column of this name", remedy, beside)
                )
            elif name in study.factors:
                beside = f"stands beside a factor {name}"
                wrong.errors.append(InputError(where, None, "one description", remedy, beside))
            elif name in study.config.base:
                beside = (
                    f"has a value in each row, and stands in base too: {study.config.base[name]}"
                )
                wrong.errors.append(
                    InputError(where, None, "one description", f"Remove base.{name}.", beside)
                )
            elif name in study.config.own:
                beside = "is an output under own, too"
                wrong.errors.append(
                    InputError(where, None, "one description", "Rename one of them.", beside)
                )
            shelf_of.setdefault(name, shelf)
    wrong.check()


def _check_roles(study: Study) -> None:
    config = study.config
    factors: Mapping[str, Any] = study.parsed
    if config.roles and config.method.observed:
        factors = study.drawn.columns
    if config.roles:
        check_roles(config.roles, factors, config.method_name)


def _check_parts(study: Study) -> None:
    """Check `analysis.groups` and `analysis.conditional_on` of a study."""
    config = study.config
    groups = config.analysis.groups
    category = config.analysis.conditional_on
    if not groups and category is None:
        return
    if config.method.observed:
        free = study.drawn.factors
    else:
        free = {n: f for n, f in study.parsed.items() if f.varies}
    if groups:
        _check_groups(config, groups, free, study.factors)
    if category is not None:
        _check_category(config, category, free)


def _check_groups(
    config: Any,
    groups: Mapping[str, tuple[str, ...]],
    free: Mapping[str, Factor],
    specs: Mapping[str, Any],
) -> None:
    names = list(free)
    grouped = set()
    if not config.method.grouped:
        allowed = f"method {listing(those_with('grouped'), 'or')}, not {config.method_name}"
        raise InputError("analysis.groups", list(groups), allowed, "Take method: saltelli.")
    for group, members in groups.items():
        where = f"analysis.groups.{group}"
        if group in specs:
            raise InputError(where, list(members), "a name that is no factor", "Rename the group.")
        if not members:
            raise InputError(where, [], "at least one factor")
        for name in members:
            if name not in free:
                if name in specs:
                    raise InputError(
                        where, name, "factors that vary and are not computed by an expression"
                    )
                raise unknown_name(where, name, names)
            if name in grouped:
                raise InputError(
                    where, name, "each factor in one group", "Remove it from one of the groups."
                )
            grouped.add(name)


def _check_category(config: Any, name: str, free: Mapping[str, Factor]) -> None:
    where = "analysis.conditional_on"
    by_group = "groups" in config.method.takes and bool(config.analysis.groups)
    if not config.method.conditional or by_group:
        if by_group:
            own = f"{config.method_name} with analysis.groups"
        else:
            own = config.method_name
        raise InputError(
            where, name, f"design {listing(those_with('conditional'), 'or')}, not {own}"
        )
    if name not in free:
        raise unknown_name(where, name, [n for n, f in free.items() if f.discrete])
    if not free[name].discrete or len(free[name].levels) > MOST_LEVELS:
        raise InputError(where, name, f"a factor with a list of at most {MOST_LEVELS} values")
    if len(free) < 2:
        raise InputError(where, name, "a study with further factors")


def _check_correlations(study: Study) -> None:
    """Refuse rank correlations that the design or the factors cannot have, before anything is
    drawn.
    """
    config = study.config
    check_design(config.rank_correlations, config.method_name)
    random = {n: f for n, f in study.parsed.items() if f.kind != "expression"}
    copula(config.rank_correlations, {n: f for n, f in random.items() if config.method.random(f)})


def _check_materials(study: Study) -> None:
    """Check that the database has every material of a study, with the scatter that its analysis
    needs.

    Parameters
    ----------
    study : the study

    Raises
    ------
    InputError : an unknown material, or a material without scatter
    """
    materials = named_materials(study.config.base, study.factors, study.materials)
    check_scatter(study.config, {body: own.values() for body, own in materials.items()})


def named_materials(
    base: Mapping[str, Any], factors: Mapping[str, Any], database: MaterialDatabase
) -> dict[str, dict[str, Material]]:
    """Return the materials of each body by name; raise the errors of all names that the database
    lacks together.
    """
    wrong = Collector()
    named: dict[str, dict[str, Material]] = {body: {} for body in BODIES}
    for where, body, name in _names_of_materials(base, factors):
        with wrong.part():
            named[body][name] = database.material(name, where)
    wrong.check()
    return named


def _names_of_materials(
    base: Mapping[str, Any], factors: Mapping[str, Any]
) -> Iterator[tuple[str, str, str]]:
    """Yield each name of a material with the key of the study file and the body.

    Entries of another form are left out: they are refused elsewhere.
    """
    roller, guide = MATERIAL_FIELDS
    for shelf in (name for name in SHELVES if isinstance(factors.get(name), Mapping)):
        for row in factors[shelf].get(ROWS) or ():
            for body, field in zip(BODIES, MATERIAL_FIELDS, strict=True):
                if isinstance(row, Mapping) and isinstance(row.get(field), str):
                    yield f"{field_of_row(shelf, str(row.get('name')))}.{field}", body, row[field]
    for field, bodies in ((roller, BODIES[:1]), (guide, BODIES[1:]), ("material_pair", BODIES)):
        spec = factors.get(field)
        listed = None
        if isinstance(spec, Mapping):
            listed = spec.get("values")
        entries = [(f"base.{field}", base.get(field))]
        if isinstance(listed, (list, tuple)):
            entries += [(f"factors.{field}.values", one) for one in listed]
        for where, entry in entries:
            names: Sequence[Any] = (entry,)
            if isinstance(entry, (list, tuple)):
                names = entry
            yield from (
                (where, body, name)
                for body, name in zip(bodies, names, strict=False)
                if isinstance(name, str)
            )


def check_cells(study: Study) -> None:
    """Check the names and cells of a table of cases; raise the errors of all its lines together."""
    wrong = Collector()
    known = (*MATERIAL_FIELDS, "material_pair")
    with wrong.part():
        _ = study.drawn  # names and numbers
    if set(known) & set(column_names(study.table_path, "table")):
        table = read_cases(study.table_path, Collector())
        for name in (name for name in table.names if name in known):
            cells = {line: row[table.names.index(name)] for line, row in table.lines.items()}
            # its first line
            for cell, line in {cell: line for line, cell in reversed(cells.items())}.items():
                for material in _materials_in(cell, name):
                    try:
                        study.materials.material(material, name)
                    except InputError as error:
                        wrong.errors.append(error.at(study.table_path, line))
    wrong.check()


def _materials_in(cell: str, name: str) -> list[str]:
    """Return the names of materials in a cell, those of both bodies in the column
    `material_pair`.
    """
    names = [cell]
    if name == "material_pair":
        names = cell.split("/")
    return [name.strip() for name in names if name.strip()]


def check_geometry(study: Study) -> None:
    """Check that no combination of the geometry's levels or ends of ranges conforms or interlocks.

    Parameters
    ----------
    study : the study

    Raises
    ------
    InputError : a combination for which roller and guide cannot touch in two points

    Notes
    -----
    Relative curvatures are monotonic in each of the quantities, so the ends of a range decide.
    Expressions, tables and the rollers of a carriage are checked on the whole design before
    anything is solved.
    """
    config = study.config
    needs_rows = config.method.observed or any(
        factor.kind in ("expression", ROWS) for factor in study.parsed.values()
    )
    if needs_rows or config.carriage is not None:
        design = study.design()
        _check_films(study, design)
        problems = list(geometry_problems({name: design[name].values for name in GEOMETRY}))
        _check_rows(study, design, problems)
        if problems and config.method.observed:
            lines = table_lines(study.table_path)
            raise_all(problem.at(study.table_path, lines[row]) for row, problem in problems)
        problem = problems[0][1] if problems else None
    else:
        levels = [_ends(study, name) for name in GEOMETRY]
        if math.prod(map(len, levels)) > MAX_CASES:
            raise InputError("method", "grid of the geometry", f"at most {MAX_CASES} cases")
        rows = np.array(list(itertools.product(*levels)), dtype=float)
        problem = geometry_problem({name: rows[:, i] for i, name in enumerate(GEOMETRY)})
    if problem is not None:
        where = "base"
        if problem.field in study.factors:
            where = "factors"
        raise problem.named(f"{where}.{problem.field}")


def _check_rows(study: Study, design: xr.Dataset, problems: list[tuple[int, InputError]]) -> None:
    """Refuse rows of shelves that do not fit the rail, and bearings that are larger than their
    roller.

    Parameters
    ----------
    study : the study
    design : its cases
    problems : numbers of the cases whose geometry contradicts itself, each with the error
    """
    shelves = {
        name: factor
        for name, factor in study.parsed.items()
        if factor.beside and name in study.drawn.columns
    }
    rows = np.arange(design.sizes["case"])
    if ROW in design.coords:
        rows = design[ROW].values
    errors = []
    for case, problem in problems:
        given = [problem.field, *GEOMETRY]
        of_shelf = (
            (shelf, name)
            for name in given
            for shelf, factor in shelves.items()
            if name in factor.beside
        )
        shelf, name = next(of_shelf, ("", ""))
        if not shelf:
            continue
        value = float(design[name].values[case])
        level = in_words(shelf, study.drawn.columns[shelf][rows[case]])
        errors.append(
            InputError(
                f"{field_of_row(shelf, level)}.{name}", value, problem.allowed, problem.remedy
            )
        )
    errors += _large_bearings(study, design, rows)
    raise_all(errors)


def _large_bearings(study: Study, design: xr.Dataset, rows: np.ndarray) -> list[InputError]:
    """Return an error for each bearing of a shelf that reaches the contact of its roller with the
    rail.
    """
    if BEARING_DIAMETER not in study.drawn.columns:
        return []
    shelf = next(name for name, factor in study.parsed.items() if BEARING_DIAMETER in factor.beside)
    diameter = study.drawn.columns[BEARING_DIAMETER][rows]
    radius = contact_geometry({name: design[name].values for name in GEOMETRY}).rolling_radius
    errors = []
    for case in np.flatnonzero(diameter >= 2 * radius).tolist():
        level = in_words(shelf, study.drawn.columns[shelf][rows[case]])
        where = f"{field_of_row(shelf, level)}.{BEARING_DIAMETER}"
        allowed = f"less than the rolling diameter of its roller, {2 * radius[case]:.5g} mm"
        errors.append(
            InputError(
                where, diameter[case], allowed, "Take a smaller bearing, or correct the row."
            )
        )
    return errors


def _ends(study: Study, name: str) -> list[float]:
    factor = study.parsed.get(name)
    if factor is None:
        return [study.config.base[name]]
    if factor.discrete:
        return [float(level) for level in factor.levels]
    if factor.kind in UNBOUNDED:
        return [factor.numbers[0]]
    low, high = factor.numbers[0], factor.numbers[-1]
    if factor.kind == "truncnormal":
        low, high = factor.numbers[-2:]
    if low < 0 < high and PARAMETERS[name].nonzero:
        raise InputError(
            f"factors.{name}", [low, high], PARAMETERS[name].allowed(), wrong="holds 0"
        )
    return [low, high]
