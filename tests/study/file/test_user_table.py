"""Tables are read as a person reads them, or refused with file, line, column, cell and remedy."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr

import trackroller as tr
from trackroller.errors import InputError
from trackroller.study.design.read_table import table
from trackroller.study.spectrum.file import load_spectrum

HEAD = "radial_force;axial_force\n-100;10\n"
SHIFT = "name;distance;radial_force;axial_force\nfull;9000;-60;10\nempty;4000;-80;10\n"


def cases(text, folder, used=()):
    """Return the columns of a table of cases."""
    (folder / "t.csv").write_bytes(text if isinstance(text, bytes) else text.encode())
    return {name: values.tolist() for name, values in table(folder / "t.csv", used).items()}


def blocks(text, folder):
    """Return name, distance and loads of the blocks of a table."""
    (folder / "b.csv").write_text(text)
    (folder / "s.yaml").write_text("blocks: b.csv\n")
    found = load_spectrum(folder / "s.yaml").blocks
    return [(b.name, b.distance, float(b.case.radial_force), float(b.case.axial_force)) for b in found]


@pytest.mark.parametrize(
    "total",
    [
        *("Sum;13000;;", "Summe:;13000;-140;20", "Grand total;13000;-140;20", "Σ;13000;;", "mean;6500;-70;10"),
        "Gesamt;13000;-80;10",
    ],
)
def test_a_line_that_sums_up_is_no_block(total, tmp_path):
    with pytest.raises(tr.InputError, match=r"b\.csv, line 4: .*this line sums up the lines above.*Remove the line"):
        blocks(f"{SHIFT}{total}\n", tmp_path)
    assert len(blocks(SHIFT, tmp_path)) == 2  # the remedy


def test_a_last_line_that_adds_up_needs_no_name(tmp_path):
    """Three addends tell it; the remedies are to remove the line, or to put a block further up."""
    head, *lines = SHIFT.splitlines()
    lines.append("half;5000;-50;5")
    total = ";18000;-190;25"
    with pytest.raises(tr.InputError, match=r"b\.csv, line 5: .*this line sums up.*put it further up"):
        blocks("\n".join([head, *lines, total]) + "\n", tmp_path)
    assert len(blocks("\n".join([head, total, *lines]) + "\n", tmp_path)) == 4


def test_a_name_that_is_a_quantity_is_no_statistic(tmp_path):
    text = "name;distance;radial_force;axial_force\n5 min;1000;-60;10\n10 min;3000;-80;20\n15 min;2000;-70;15\n"
    assert [block[0] for block in blocks(text, tmp_path)] == ["5 min", "10 min", "15 min"]


def test_totals_above_the_blocks_are_refused(tmp_path):
    head, *lines = SHIFT.splitlines()
    with pytest.raises(tr.InputError, match=r"b\.csv, line 2: .*this line sums up .*rename it"):
        blocks("\n".join([head, "Total;13000;-80;10", *lines]) + "\n", tmp_path)
    assert len(blocks("\n".join([head, "Way;7000;-300;20", *lines]) + "\n", tmp_path)) == 3


@pytest.mark.parametrize("label", ["max", "sum-free", "summer", "totally full", "Gesamtlast", "max load"])
def test_a_block_may_have_a_name_like_a_statistic(label, tmp_path):
    assert len(blocks(f"{SHIFT}{label};70;-500;90\n", tmp_path)) == 3


@pytest.mark.parametrize(
    ("line", "column"), [("peak;;-60;10", "distance"), ("peak;40;;10", "radial_force"), ("peak;40;-60;", "axial_force")]
)
def test_an_empty_cell_is_never_the_load_of_the_example(line, column, tmp_path):
    with pytest.raises(tr.InputError, match=f"line 4: {column} = ''.*the cell is empty. Fill the cell"):
        blocks(f"{SHIFT}{line}\n", tmp_path)


def test_a_column_without_values_is_named_once(tmp_path):
    with pytest.raises(tr.InputError, match=r"line 1: axial_force .*all cells are empty") as caught:
        blocks("name;distance;radial_force;axial_force\na;1;-60;\nb;2;-60;\n", tmp_path)
    assert len(caught.value.errors) == 1


def test_thousands_beside_decimal_commas(tmp_path):
    text = "name;distance;radial_force;axial_force\nfull;9.000;-60;10,5\npeak;40,5;-1.200;30\n"
    assert blocks(text, tmp_path) == [("full", 9000.0, -60.0, 10.5), ("peak", 40.5, -1200.0, 30.0)]


@pytest.mark.parametrize("sign", ";,\t|")
def test_thousands_that_nothing_tells_from_decimals_are_refused(sign, tmp_path):
    text = "radial_force;axial_force;load no.\n-1.200;30;1.10\n".replace(";", sign)
    with pytest.raises(tr.InputError, match=r"line 2: radial_force = '-1.200'.*Write -1200 or -1.2000"):
        cases(text, tmp_path)


@pytest.mark.parametrize(
    ("text", "loads"),
    [
        ("radial_force (kN);axial_force / kN\n-2;0,5\n", (-2000, 500)),
        ("radial_force;axial_force, kN\n-2 kN;500 N\n", (-2000, 500)),
        ("radial_force;axial_force\nkN;N\n-2;500\n", (-2000, 500)),
        ("radial_force;axial_force\n[kN];(N)\n-2;500\n", (-2000, 500)),
        ("radial_force;axial_force\n-0,2 kN;\u2212500\n", (-200, -500)),
        ("sep=;\nradial_force;axial_force\n-2;5\n", (-2, 5)),
        ("radial_force;axial_force;\n-2;5;\n", (-2, 5)),
        ("radial_force;axial_force;;\n-2;5\n", (-2, 5)),
        ("radial_force;axial_force\n-2;5;;\n", (-2, 5)),
        ("radial_force\taxial_force\r-2\t5\r", (-2, 5)),
        ("|radial_force|axial_force|\n|-2|5|\n", (-2, 5)),
        ("# of 2026, by hand\n\nradial_force;axial_force\n# Monday\n-2;5\n\n", (-2, 5)),
        ("# radial_force,axial_force\n-2,5\n", (-2, 5)),
        ("radial_force;axial_force\n-1e3;1,5E3\n", (-1000, 1500)),
    ],
)
def test_what_a_person_reads_without_doubt_is_read(text, loads, tmp_path):
    read = cases(text, tmp_path)
    assert read == {"radial_force": [loads[0]], "axial_force": [loads[1]]}


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("-200;30;5", "line 3: .*2 cells, one for each name; there are 3"),
        ("-200", "line 3: .*2 cells, one for each name; there are 1"),
        ("#4;30;", "line 3: .*begins with '#', but has cells as a line that counts. Remove"),
        ("#-200;30", "line 3: .*begins with '#', .*. Remove the line if it does not count"),
        ("#N/A;30", "line 3: radial_force = '#N/A'"),
        ("Total;30", "line 3: .*sums up the lines above"),
        ("nan;30", "line 3: radial_force = 'nan'"),
        ("-;30", "line 3: radial_force = '-'"),
        ("(200);30", r"line 3: radial_force = '\(200\)'"),
        ("=A2*2;30", "line 3: radial_force = '=A2.*this is a formula"),
        ('"-200;30', "line 3: .*Close the quotation marks"),
        ('"-200;30\n-300;40";5', "line 4: radial_force .*goes over several lines"),
    ],
)
def test_what_a_person_would_ask_about_is_refused(line, why, tmp_path):
    with pytest.raises(tr.InputError, match=rf"(?s)t\.csv, {why}"):
        cases(f"{HEAD}{line}\n", tmp_path)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (",radial_force\n0,-200\n1,-300\n", r"line 1: .*column 1, which has no name. .*Leave the index out"),
        ("Unnamed: 0,radial_force\n0,-200\n", "Leave the index out"),
        ("radial_force;;part\n-200;7;a\n", "column 2, which has no name. Allowed: a name for each column. Name it"),
        ("radial_force;axial_force\n-0.2 kN;3\n-0.3;3\n", "line 3: radial_force = '-0.3'.* with its unit"),
        ("radial_force;mu\n-2;1\n-3;2\n-1;3\n-6;6\n", "line 5: .*this line sums up the lines above"),
        ("radial_force;radial_force\n-200;-300\n", "a different name for each column"),
        ("mu;friction_coefficient\n0.1;0.2\n", "a different name for each column"),
        ("Load cases;\nradial_force;part\n-200;a\n", "stand in line 2. Remove the lines above"),
        ("radial_force axial_force\n-200 30\n", "Separate the columns"),
        ("radial_force\n-200,5\n", "line 2: .*Write decimal points"),
        ("radial_force [kg];part\n-2;a\n", "line 1: radial_force = 'kg'"),
        ("radial_force [-];part\n-2;a\n", "line 1: radial_force = '-'"),
        ("radial_force;axial_force\nN;kg\n-2;3\n", "line 2: axial_force = 'kg'"),
        ("radial_force [kN];axial_force\nN;N\n-2;3\n", "line 2: radial_force = 'N'.*the unit at the head"),
        ("radial_force;axial_force\nN;N\n", "at least one case below the units"),
        ("<table><tr><td>radial_force</td></tr></table>", "a page of HTML"),
        (b"PK\x03\x04", "Give a workbook the ending .xlsx"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "the old format .xls.*Save the table as .xlsx"),
        (b"radial_force;part\n-2;a\x00\n", "zero bytes"),
        ("Länge;radial_force\n1;-200\n".encode("cp1252"), r"t\.csv, line 1: .*UTF-8"),
    ],
)
def test_a_table_that_a_person_would_not_take_is_refused_with_a_remedy(text, why, tmp_path):
    with pytest.raises(tr.InputError, match=why):
        cases(text, tmp_path)


@pytest.mark.parametrize("ending", [".xls", ".ods", ".xlsb"])
def test_other_formats_are_refused_by_their_ending(ending, tmp_path):
    (tmp_path / f"t{ending}").write_text("radial_force\n-200\n")
    with pytest.raises(tr.InputError, match=r"Save the table as \.xlsx or as CSV"):
        table(tmp_path / f"t{ending}")


def test_a_unit_at_the_head_of_a_further_column_is_kept_or_refused(tmp_path):
    text = "load [kN];radial_force\n2;-100\n3;-200\n"
    assert cases(text, tmp_path)["load_[kN]"] == [2.0, 3.0]
    with pytest.raises(tr.InputError, match=r"line 1: column = 'load \[kN\]'.*an expression uses load"):
        cases(text, tmp_path, used=["load"])
    with pytest.raises(tr.InputError, match=r"line 2: load = '2 kN'.*a plain number"):
        cases("load;radial_force\n2 kN;-100\n3;-200\n", tmp_path, used=["load"])
    with pytest.raises(tr.InputError, match=r"line 2: load = 'kN'.*no unit"):
        cases("load;radial_force\nkN;N\n3;-200\n", tmp_path, used=["load"])
    assert cases("load;radial_force\n1.200;-100,5\n", tmp_path, used=["load"])["load"] == [1200.0]


@pytest.mark.parametrize(
    "head",
    [
        "Load/No.",
        '"load\ncase"',
        "%",
        "#1",
        "-x",
        "x" * 201,
        "normal_force_1",
        "peak_stress_roller",
        "peak_stress",
        "case",
    ],
)
def test_heads_that_cannot_name_a_result_are_refused_when_the_table_is_read(head, tmp_path):
    with pytest.raises(tr.InputError, match=r"t\.csv, line \d: table column = .*Rename it"):
        cases(f"radial_force;{head}\n-200;a\n", tmp_path)


def test_a_head_is_the_same_name_however_its_letters_are_composed(tmp_path):
    assert list(cases("radial_force;Gro\u0308ße\n-200;a\n", tmp_path)) == ["radial_force", "Größe"]


def test_labels_stay_as_they_are(tmp_path):
    read = cases("radial_force,part,order,size\n-200,00123,3E5,1.5\n-210,00124,1E2,2\n", tmp_path)
    assert read["part"] == ["00123", "00124"] and read["order"] == ["3E5", "1E2"] and read["size"] == [1.5, 2.0]
    words = ["NA", "nan", "None", "null", "-", "TRUE"]
    lines = "".join(f"{word};{-30 - i}\n" for i, word in enumerate(words))
    assert cases(f"id;radial_force\n{lines}", tmp_path)["id"] == words
    assert cases("id;radial_force\n#1;-30\n#2;-40\n", tmp_path)["id"] == ["#1", "#2"]


def test_a_link_that_leads_out_of_the_folder_is_named(tmp_path):
    (tmp_path / "inside").mkdir()
    (tmp_path / "t.csv").write_text("radial_force\n-200\n")
    (tmp_path / "inside" / "t.csv").symlink_to(tmp_path / "t.csv")
    (tmp_path / "inside" / "s.yaml").write_text("name: x\ndesign: table\ntable: t.csv\n")
    with pytest.raises(tr.InputError, match=r"a link that leads out of the folder.*Copy the file"):
        tr.load_study(tmp_path / "inside" / "s.yaml")


def test_columns_that_no_block_has_are_named_once_by_their_head(tmp_path):
    with pytest.raises(tr.InputError, match=r"b\.csv, line 1: blocks.roller_material.*`base`") as caught:
        blocks("name;distance;roller_material;foo\na;1;PA6;1\nb;2;PA6;2\n", tmp_path)
    assert len(caught.value.errors) == 2


def test_a_table_of_too_many_columns_is_refused(tmp_path):
    with pytest.raises(tr.InputError, match="at most 1,000 columns"):
        cases(";".join(f"c{i}" for i in range(16_384)) + "\n" + ";".join("1" * 16_384) + "\n", tmp_path)


@pytest.mark.parametrize(
    "head", ["Radial_Force", "F_rad", "radial_force (measured) [kN]", "F_r", "axial load", "speed", "v", "Kraft [kN]"]
)
def test_numbers_under_a_head_that_speaks_of_a_parameter_are_not_left_out(head, tmp_path):
    """The case would have the paper's load otherwise, without a word."""
    with pytest.raises(tr.InputError, match=r"line 1: table column = .* that nothing would use"):
        cases(f"{head};contact_angle\n-3;30\n-5;20\n", tmp_path)


@pytest.mark.parametrize("head", ["roller_id", "share [%]", "lot size", "width [mm]", "note"])
def test_other_columns_of_numbers_are_kept(head, tmp_path):
    assert next(iter(cases(f"{head};contact_angle\n3;30\n5;20\n", tmp_path))).startswith(
        head.partition(" [")[0].replace(" ", "_")
    )


@pytest.mark.parametrize(
    ("remark", "unit"),
    [
        ("# forces in kN", "kN"),
        ("# all loads [kN]", "kN"),
        ("# Kräfte: kN, Wege: m", "kN"),
        ("# units = lbf", "lbf"),
        ("#kN;m/min", "kN"),
        ("# radial_force in N, velocity in m/s", "m/s"),
    ],
)
def test_a_unit_in_a_comment_is_never_left_out(remark, unit, tmp_path):
    table_ = "radial_force;velocity\n-2;60\n-3;70\n"
    for text in (f"{remark}\n{table_}", table_.replace("\n", f"\n{remark}\n", 1)):
        with pytest.raises(
            tr.InputError, match=rf"t\.csv, line [12]: .* names the unit {unit}, .*Write \w+ \[{unit}\]"
        ):
            cases(text, tmp_path)


@pytest.mark.parametrize(
    "remark",
    [
        "# measured on Monday in situ (rig A), 2 m away",
        "# am Prüfstand um 10 Uhr in Halle 3 gemessen",
        "# radial_force in N, velocity [m/min]",
        "# rated for 5 kN at 1 m/s",
        "# all in SI units, 2026/27, W/O lubricant",
    ],
)
def test_a_comment_that_changes_no_unit_is_left_out(remark, tmp_path):
    text = f"{remark}\nradial_force;velocity\n-2;60\n"
    assert cases(text, tmp_path) == {"radial_force": [-2.0], "velocity": [60.0]}
    stated = "# forces in kN\nradial_force [kN];axial_force\n-2;0,5 kN\n"
    assert cases(stated, tmp_path) == {"radial_force": [-2000.0], "axial_force": [500.0]}


def test_a_second_table_beside_the_first_is_refused(tmp_path):
    text = "radial_force;axial_force;;velocity;part\n-100;10;;60;x\n-200;20;;70;y\n"
    with pytest.raises(
        tr.InputError, match=r"line 1: table = 'velocity, part' stand beside the empty column 3.*Remove"
    ):
        cases(text, tmp_path)
    edges = ";radial_force;axial_force;;\n;-100;10;;\n"
    assert cases(edges, tmp_path) == {"radial_force": [-100.0], "axial_force": [10.0]}


@pytest.mark.parametrize(("first", "last"), [("sep=\t\n", ""), ('"sep=\t"\n', ""), ("", "\x1a"), ("", "\x1a\r\n")])
def test_lines_that_a_program_adds_are_no_cases(first, last, tmp_path):
    text = f"{first}radial_force\tvelocity\r\n-100\t60\r\n{last}"
    assert cases(text, tmp_path) == {"radial_force": [-100.0], "velocity": [60.0]}


def test_a_separator_that_is_no_character_is_refused(tmp_path):
    with pytest.raises(tr.InputError, match=r"line 1: table = 'sep=tab'.*such as sep=;"):
        cases("sep=tab\nradial_force\tvelocity\n-100\t60\n", tmp_path)


def test_a_line_below_the_units_is_named_before_the_table_counts_as_empty(tmp_path):
    with pytest.raises(tr.InputError, match=r"line 3: table = '43, 2'.*Write decimal points"):
        cases("velocity\nm/min\n43,2\n", tmp_path)


def test_a_separator_behind_the_only_name_counts(tmp_path):
    assert cases('velocity\t\n"43,2"\t\n7,5\t\n', tmp_path) == {"velocity": [43.2, 7.5]}


@pytest.mark.parametrize(
    ("cells", "constraint", "allowed"),
    [
        ("abc", "load_case != 'b'", [True, False, True]),
        ("124", "load_case < 3", [True, True, False]),
        ("124", "load_case < 3 and axial_force > 0", [False, True, False]),
    ],
)
def test_a_constraint_names_a_further_column(tmp_path, monkeypatch, cells, constraint, allowed):
    """Texts are compared with texts, numbers with numbers; the column needs no expression that uses it."""
    monkeypatch.chdir(tmp_path)
    rows = [f"{cell},{force}" for cell, force in zip(cells, (0, 10, 20), strict=True)]
    Path("t.csv").write_text("\n".join(["load_case,axial_force", *rows]) + "\n")
    keys = {"name": "x", "method": "table", "table": "t.csv", "outputs": ["forces"], "contact_model": "sliding"}
    study = {**keys, "accuracy": "preview", "constraints": [constraint]}
    assert tr.run(tr.load_study(study)).allowed.tolist() == allowed
    text = "'1'" if cells == "124" else "1"
    with pytest.raises(tr.InputError, match="ordering a text, or comparing it with a number"):
        tr.load_study(study | {"constraints": [f"load_case < {text}"]})


def test_a_column_with_a_blank_in_its_name_is_a_coordinate_of_the_results(tmp_path, recwarn):
    (tmp_path / "cases.csv").write_text(
        "load case,width [mm],axial_force,friction_coefficient\nstart,1,0,0.1\nstop,2,20,0.2\n"
    )
    (tmp_path / "study.yaml").write_text(
        "name: blanks\ntable: cases.csv\ndesign: table\ncontact_model: sliding\naccuracy: preview\noutputs: [forces]\n"
    )
    results = tr.run(tmp_path / "study.yaml", results=tmp_path / "results", progress=False)
    with xr.open_dataset(tmp_path / "results" / "blanks" / "study.nc") as stored:
        assert {"load_case", "width_[mm]"} <= set(stored.coords)
    assert results.labels == ("load_case", "width_[mm]")
    assert results.table["load_case"].tolist() == ["start", "stop"]
    assert not [w for w in recwarn if "space in its name" in str(w.message)]


def test_two_columns_that_differ_by_a_blank_are_refused(tmp_path):
    path = tmp_path / "cases.csv"
    path.write_text("load case,load_case,axial_force\nstart,a,0\nstop,b,20\n")
    with pytest.raises(InputError, match=r"line 1: .*one column for load_case") as refused:
        table(path)
    path.write_text(path.read_text().replace("load_case", "load_case_2"))  # what the message advises
    assert "load_case_2" in str(refused.value)
    assert list(table(path)) == ["load_case", "load_case_2", "axial_force"]
