"""Shelves: factors whose levels are rows of a table. Each row is a case that `solve` gives bit for bit."""

from __future__ import annotations

import numpy as np
import pytest
from typer.testing import CliRunner

import trackroller as tr
from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.study.file.load import load_study, parse_study
from trackroller.yaml_file import write_yaml

HEAD = "name;axis_distance [mm];roller_profile_radius [mm];roller_material;mass [kg];price [EUR];order number"
ROWS = (
    "small;20;-6.5;1.7225-normalised;0.12;12.50;A-1",
    "mid;21.75;-7;1.7225-normalised;0.2;;A-2",
    "large;25;-8;1.7225-quenched-tempered;0.31;17;A-3",
)
QUICK = {
    "accuracy": "preview",
    "contact_model": "sliding",
    "outputs": ["forces", "contact", "life", "shakedown", "limits"],
}
USE = {"radial_force": -200, "motor_force": 0, "guide_overrollings_per_hour": 100}
BEARING = "rows;row_distance;kind;dynamic_rating;static_rating;e;X;Y;X0;Y0"
FACTORS = {"roller": {"file": "rollers.csv"}, "friction_coefficient": {"values": [0.1, 0.2]}}


def study(folder, monkeypatch, rows=ROWS, head=HEAD, name="rollers.csv", **keys):
    """Return the study of a shelf that is written to a file."""
    monkeypatch.chdir(folder)
    (folder / name).write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return parse_study({"name": "shelf", "base": USE, "factors": FACTORS} | QUICK | keys)


def same(one, other):
    """Return whether all results of two data sets of a case are equal bit for bit."""
    for name in one.data_vars:
        first, second = (np.asarray(ds[name].values).squeeze() for ds in (one, other))
        if first.dtype.kind == "f":
            equal = np.array_equal(first, second, equal_nan=True)
        else:
            equal = np.array_equal(first, second)
        if not equal:
            return False
    return True


def test_each_row_equals_a_single_sheet(tmp_path, monkeypatch):
    results = tr.run(study(tmp_path, monkeypatch), results=tmp_path / "out", progress=False)
    for row in ROWS:
        name, axis, groove, material, *_ = row.split(";")
        case = tr.Case(
            axis_distance=float(axis),
            roller_profile_radius=float(groove),
            roller_material=material,
            friction_coefficient=0.2,
            **USE,
        )
        assert same(tr.solve(case, **QUICK), results.data.sel(roller=name, friction_coefficient=0.2))
    table = results.to_table()
    assert table["mass"].tolist() == [0.12, 0.12, 0.2, 0.2, 0.31, 0.31]
    assert table["price"].tolist()[:2] == [12.5, 12.5] and np.isnan(table["price"][2])
    assert table["order_number"].tolist() == ["A-1", "A-1", "A-2", "A-2", "A-3", "A-3"]
    assert results.data["price"].attrs["units"] == "EUR" and results.roles["roller"] == "choice"
    front = results.pareto({"price": "min", "pair_life_hours": "max"})
    assert set(front["roller"].values) == {"small", "large"}  # the one without a price is left out


def test_the_order_of_rows_changes_no_value(tmp_path, monkeypatch):
    one = study(tmp_path, monkeypatch).design()
    other = study(tmp_path, monkeypatch, ROWS[::-1]).design()
    for name in ("small", "mid", "large"):
        first, second = (ds.isel(case=ds["roller"].values == name) for ds in (one, other))
        for column in ("axis_distance", "roller_material", "mass", "price", "order_number"):
            assert str(first[column].values.tolist()) == str(second[column].values.tolist())


@pytest.mark.parametrize("method", ["grid", "lhs", "inner_outer"])
def test_a_stored_study_needs_no_file(method, tmp_path, monkeypatch):
    friction = {"uniform": [0.1, 0.2]} if method != "grid" else {"values": [0.1, 0.2]}
    keys = {"factors": FACTORS | {"friction_coefficient": friction}, "method": method, "samples": 4}
    first = study(tmp_path, monkeypatch, **keys)
    (tmp_path / "rollers.csv").unlink()
    (tmp_path / "again.yaml").write_text(first.merged(), encoding="utf-8")
    again = load_study(tmp_path / "again.yaml")
    assert again.merged() == first.merged()
    assert again.design().drop_attrs().identical(first.design().drop_attrs())


def test_a_changed_file_is_noticed_and_only_its_rows_are_solved(tmp_path, monkeypatch):
    tr.run(study(tmp_path, monkeypatch), results=tmp_path / "out", progress=False)
    changed = (ROWS[0].replace("12.50", "11"), ROWS[1], ROWS[2].replace("-8", "-9"))
    again = tr.run(study(tmp_path, monkeypatch, changed), results=tmp_path / "out", progress=False)
    assert again.data["price"].values[0] == 11.0
    kept = [path.name for path in (tmp_path / "out" / "shelf" / "inputs" / "given").iterdir()]
    assert len(kept) == 1 and kept[0].endswith("-rollers.csv")


def test_a_study_of_a_shelf_goes_on_and_is_repeated_from_its_folder(tmp_path, monkeypatch):
    keys = {"name": "shelf", "base": USE, "factors": FACTORS} | QUICK
    study(tmp_path, monkeypatch)
    (tmp_path / "study.yaml").write_text(write_yaml(keys), encoding="utf-8")
    assert command("run", "study.yaml", "-q").exit_code == 0
    (tmp_path / "rollers.csv").write_text("\n".join([HEAD, *ROWS]).replace("12.50", "11") + "\n", encoding="utf-8")
    assert "nothing is left to solve" in command("run", "study.yaml", "-q").output  # a price changes no case
    (tmp_path / "rollers.csv").unlink()
    assert command("verify", "results/shelf").exit_code == 0
    again = command("rerun", "results/shelf", "--results", "again")
    assert again.exit_code == 0 and "equal in every number" in " ".join(again.output.split())
    assert tr.open_study("again/shelf").data["price"].values[0] == 11.0


def command(*words):
    """Return what the command line does."""
    return CliRunner().invoke(app, list(words))


def test_an_empty_cell_takes_the_value_of_base(tmp_path, monkeypatch):
    rows = (ROWS[0], ROWS[1].replace("21.75", ""))
    with pytest.raises(InputError, match=r"rollers\.csv, line 3: axis_distance .*is missing.*write base: "):
        study(tmp_path, monkeypatch, rows)
    found = study(tmp_path, monkeypatch, rows, base=USE | {"axis_distance": 22})  # the remedy
    assert found.design()["axis_distance"].values.tolist() == [20.0, 20.0, 22.0, 22.0]
    assert "axis_distance" not in found.config.base


def test_radii_of_a_row_give_its_axis_distance(tmp_path, monkeypatch):
    head = "name;outer_radius;groove_depth;roller_profile_radius"
    found = study(tmp_path, monkeypatch, ("a;20;3;-7", "b;25;3;-8"), head).design()
    for i, (outer, groove) in enumerate([(20, -7), (25, -8)]):
        case = {"outer_radius": outer, "groove_depth": 3, "roller_profile_radius": groove}
        alone = tr.solve(case, accuracy="preview", contact_model="sliding", outputs=["forces"])
        assert found["axis_distance"].values[2 * i] == alone["axis_distance"].item()


def test_bearings_are_rows_too(tmp_path, monkeypatch):
    head = f"name;{BEARING};outer_diameter [mm];price"
    rows = ("one;2;8;ball;3000;1500;0.3;0.56;1.5;0.6;0.5;19;2.5", "two;2;8;ball;4000;2000;0.3;0.56;1.5;0.6;0.5;22;3")
    keys = {"factors": {"bearing": {"file": "bearings.csv"}}, "outputs": ["forces", "limits", "bearing"]}
    results = tr.run(
        study(tmp_path, monkeypatch, rows, head, "bearings.csv", **keys), results=tmp_path / "out", progress=False
    )
    life = results.data["bearing_life_hours"].values
    assert life[1] / life[0] == pytest.approx((4 / 3) ** 3)  # ISO 281
    assert results.table["price"].tolist() == [2.5, 3.0]
    assert results.table["bearing_outer_diameter"].tolist() == [19.0, 22.0]
    with pytest.raises(InputError, match=r"bearings\.csv, line 3: bearing_outer_diameter .*rolling diameter .*33\.1"):
        study(tmp_path, monkeypatch, (rows[0], rows[1].replace(";22;", ";34;")), head, "bearings.csv", **keys)


def test_names_of_columns_are_goals_and_constraints(tmp_path, monkeypatch):
    keys = {"pareto": {"price": "min", "pair_life_hours": "max"}, "constraints": ["mass < 0.3"]}
    found = study(tmp_path, monkeypatch, requirement={"mass": {"max": 0.25}}, own={"both": "price + 2"}, **keys)
    results = tr.run(found, results=tmp_path / "out", progress=False)
    assert results.allowed.tolist() == [True, True, True, True, False, False]
    assert results.meets("mass").tolist() == [True, True, True, True, False, False]
    assert results.table["both"].tolist()[0] == 14.5
    with pytest.raises(InputError, match="order_number"):
        study(tmp_path, monkeypatch, pareto={"order_number": "min", "pair_life_hours": "max"})


CATALOGUE = "name;catalogue_radial_force [N];catalogue_axial_force [N];catalogue_basic_life [km];catalogue_law"


@pytest.mark.parametrize(
    ("rows", "head", "message"),
    [
        ((ROWS[0], ROWS[0]), HEAD, r"line 3: name .*stands in line 2 too.*different name"),
        ((ROWS[0], ROWS[1].replace(";;", ";10 USD;")), HEAD, r"line 3: price .*USD"),
        (("a;3 kg", "b;200 g"), "name;mass", r"line 3: mass .*200 g.*a number in kg"),
        (("a;3 kg", "b;4"), "name;mass", r"line 3: mass .*a number in kg"),
        (("a;20 mm", "b;21"), "name;axis_distance", r"line 3: axis_distance .*its unit"),
        ((ROWS[0], ROWS[2].replace("-8", "-5")), HEAD, r"line 3: roller_profile_radius .*interlock"),
        ((ROWS[0], ROWS[2].replace(";25", ";4")), HEAD, r"line 3: axis_distance .*rolling radius"),
        ((ROWS[0], ROWS[2].replace("1.7225-q", "1.7225-x")), HEAD, r"line 3: roller_material .*is not known"),
        (("a;-200",), "name;radial_force", r"line 2: radial_force .*catalogue_radial_force"),
        (("a;-7",), "name;roller_profil_radius", r"line 1: column .*Did you mean 'roller_profile_radius'"),
        (("a;5",), "title;axis_distance", r"line 1: shelf .*has no names"),
        (("a;5;6",), "name;lot size;lot_size", r"line 1: column = 'lot_size'.*one column for lot_size.*lot_size_2"),
        (
            ("a;700;200;40;dry", "b;200;700;40;dry", "c;900;300;40;dry"),
            CATALOGUE,
            r"line 3: catalogue_axial_force .*is larger than the permissible radial force.*Exchange the two cells",
        ),
        (("a;700;200;40;wet",), CATALOGUE, r"line 2: catalogue\.law .*wet"),
    ],
)
def test_wrong_cells_are_named_by_row_and_column(rows, head, message, tmp_path, monkeypatch):
    with pytest.raises(InputError, match=rf"rollers\.csv, {message}"):
        study(tmp_path, monkeypatch, rows, head)


def test_several_mistakes_are_named_together(tmp_path, monkeypatch):
    rows = (ROWS[0], ROWS[0].replace("small", "b").replace("-6.5", "soft"), ROWS[2].replace("1.7225-q", "1.7225-x"))
    with pytest.raises(InputError) as caught:
        study(tmp_path, monkeypatch, rows)
    assert [(one.field, one.line) for one in caught.value.errors] == [
        ("roller_profile_radius", 3),
        ("roller_material", 4),
    ]


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"base": USE | {"axis_distance": 20}}, r"factors\.roller\.axis_distance .*stands in base too"),
        (
            {"factors": FACTORS | {"axis_distance": {"values": [20, 21]}}},
            r"factors\.roller\.axis_distance .*stands beside a factor",
        ),
        (
            {"factors": FACTORS | {"guide": {"rows": [{"name": "g", "price": 3}]}}},
            r"factors\.guide\.price .*Rename one of them, such as guide_price",
        ),
        ({"factors": {"roller": {"values": ["a"]}}}, r"factors\.roller .*rollers\.csv"),
        ({"factors": {"velocity": {"rows": [{"name": "a"}]}}}, r"factors\.velocity .*rows of roller, bearing or guide"),
        ({"factors": {"roller": {"file": "none.csv"}}}, r"factors\.roller\.file .*is not there"),
    ],
)
def test_a_parameter_has_one_description(keys, message, tmp_path, monkeypatch):
    with pytest.raises(InputError, match=message):
        study(tmp_path, monkeypatch, **keys)


def test_two_shelves_are_crossed(tmp_path, monkeypatch):
    guides = [{"name": "thin", "guide_profile_radius": 5}, {"name": "thick", "guide_profile_radius": 6}]
    found = study(tmp_path, monkeypatch, factors=FACTORS | {"guide": {"rows": guides}}).design()
    assert found.sizes["case"] == 12 and set(found["guide"].values) == {"thin", "thick"}
    thin = found["guide"].values == "thin"
    assert set(found["guide_profile_radius"].values[thin]) == {5.0}


def test_the_cheapest_row_that_is_enough_leads_and_its_columns_stand_on_the_page(tmp_path, monkeypatch):
    """By hand: all three rows last 6 h; of the two with a price the small one is cheaper, and mid has none."""
    keys = {"requirement": {"pair_life_hours": {"min": 6}}, "pareto": {"price": "min"}}
    keys["not_checked"] = ["pressure_line"]  # equal lives by one line
    head = HEAD.replace("order number", "number")  # a name that the table of candidates has, too
    results = tr.run(study(tmp_path, monkeypatch, head=head, **keys), results=tmp_path / "out", progress=False)
    answer = results.answer
    assert answer.table["roller"].tolist()[:2] == ["small", "mid"] and answer.kind == "build"
    assert answer.table["price"].tolist()[0] == 12.5 and answer.table["own_number"].tolist()[0] == "A-1"
    units = {column.name: column.units for column in answer.columns}
    assert units["price"] == "EUR" and units["mass"] == "kg"
    assert results.pareto() is not None and "price" not in results.pareto().attrs["objectives"]
    page = tmp_path / "page.html"
    tr.report(results, page)
    assert "12.5" in page.read_text(encoding="utf-8") and "A-3" in page.read_text(encoding="utf-8")
    with pytest.raises(InputError, match=r"pareto .*one beside a requirement"):
        study(tmp_path, monkeypatch, pareto={"price": "min"})


def test_a_search_takes_a_shelf(tmp_path, monkeypatch):
    """The least price of all rows, by hand 12.5; a search that minimises it finds its row."""
    keys = {"factors": {"roller": {"file": "rollers.csv"}}, "method": "optimise", "goals": {"price": "min"}}
    rows = tuple(row.replace(";;", ";15;") for row in ROWS)
    found = study(tmp_path, monkeypatch, rows, budget={"designs": 12, "population": 4}, **keys)
    results = tr.run(found, results=tmp_path / "out", progress=False)
    assert results.answer.table["roller"].tolist()[0] == "small"


TABLE = "roller,radial_force,axial_force\nlarge,-300,20\nsmall,-200,0\nlarge,-150,10\n"


def of_table(folder, monkeypatch, text=TABLE, **keys):
    """Return the study of a table whose column `roller` names rows of the shelf."""
    (folder / "cases.csv").write_text(text, encoding="utf-8")
    use = {"motor_force": 0, "friction_coefficient": 0.2, "guide_overrollings_per_hour": 100}
    keys = {"base": use, "factors": {"roller": {"file": "rollers.csv"}}} | keys
    return study(folder, monkeypatch, method="table", table="cases.csv", **keys)


def test_a_table_of_cases_names_rows_of_a_shelf(tmp_path, monkeypatch):
    results = tr.run(of_table(tmp_path, monkeypatch), results=tmp_path / "out", progress=False)
    kept = tr.open_study(tmp_path / "out" / "shelf")
    rows = {row.split(";")[0]: row.split(";") for row in ROWS}
    for place, line in enumerate(TABLE.splitlines()[1:]):
        name, radial, axial = line.split(",")
        _, axis, groove, material, _, price, order = rows[name]
        case = {"axis_distance": axis, "roller_profile_radius": groove, "roller_material": material}
        case |= {"radial_force": radial, "axial_force": axial, "motor_force": 0, "friction_coefficient": 0.2}
        alone = tr.solve(case | {"guide_overrollings_per_hour": 100}, **QUICK)
        assert same(alone, results.data.isel(case=place))
        own = kept.table.iloc[place]
        assert (own["roller"], own["price"], own["order_number"]) == (name, float(price), order)
    assert results.goods == kept.goods == ("mass", "price", "order_number")


def test_names_of_rows_may_be_figures(tmp_path, monkeypatch):
    rows = [row.replace("small", "00608").replace("large", "608") for row in ROWS]
    text = TABLE.replace("small", "00608").replace("large", "608")
    drawn = of_table(tmp_path, monkeypatch, text, rows=rows).drawn
    assert drawn.columns["roller"].tolist() == ["608", "00608", "608"]
    assert drawn.columns["axis_distance"].tolist() == [25.0, 20.0, 25.0]


@pytest.mark.parametrize(
    ("text", "more", "message"),
    [
        (TABLE.replace("small", "smal"), {}, r"cases.csv, line 3: roller = 'smal' is not known.*'small'"),
        (
            TABLE.replace("axial_force", "axis_distance").replace(",0\n", ",9\n"),
            {},
            "column axis_distance is in factors.roller too",
        ),
        (TABLE.replace("roller,", "own,"), {}, "Add a column roller to the table"),
        (TABLE, {"radial_force": {"values": [-1, -2]}}, "Remove it, or the column radial_force of the table"),
        (TABLE, {"velocity": {"values": [10, 20]}}, "Only expressions and shelves may stand beside a table"),
    ],
)
def test_what_stands_beside_a_table_in_vain_is_refused(text, more, message, tmp_path, monkeypatch):
    factors = {"roller": {"file": "rollers.csv"}} | more
    with pytest.raises(InputError, match=message):
        of_table(tmp_path, monkeypatch, text, factors=factors)
    if "smal," in text:  # as the message says
        assert of_table(tmp_path, monkeypatch, TABLE, factors=factors).drawn.size == 3


@pytest.mark.parametrize("cell", ["small", "A-1"])
def test_a_line_end_in_a_text_of_a_row_is_refused(cell, tmp_path, monkeypatch):
    rows = [row.replace(cell, f'"{cell}\n2"') for row in ROWS]
    with pytest.raises(InputError, match=r"rollers.csv, line 3: .* holds a control character"):
        study(tmp_path, monkeypatch, rows)
    assert study(tmp_path, monkeypatch, [row.replace("\n", "") for row in rows]).parsed  # as the message says


def test_a_lost_sign_of_a_groove_is_refused_beside_others(tmp_path, monkeypatch):
    rows = [f"R{i};{20 + i};-{6.5 + 0.1 * i:g};1.7225-normalised;0.1;9;A" for i in range(6)]
    wrong = [rows[0], rows[1].replace("-6.6", "6.6"), *rows[2:]]
    with pytest.raises(InputError, match=r"rollers.csv, line 3: roller_profile_radius = '6.6 mm' .*Write -6.6 for a"):
        study(tmp_path, monkeypatch, wrong)
    assert study(tmp_path, monkeypatch, rows).drawn.size  # as the message says
    alone = [row.replace(";-", ";") for row in rows[:1]]
    assert study(tmp_path, monkeypatch, [*alone, alone[0].replace("R0", "S")]).drawn.size


def test_a_price_in_another_currency_is_refused_by_its_cell(tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"line 2: price = '12.50 USD' .*a number in EUR"):
        study(tmp_path, monkeypatch, (ROWS[0].replace("12.50", "12.50 USD"), *ROWS[1:]))
