"""Workbooks of Excel are read as tables of cases and of blocks."""

from __future__ import annotations

import datetime
import io
import sys
import tracemalloc
import zipfile

import numpy as np
import pandas as pd
import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.errors import Collector
from trackroller.report import workbook
from trackroller.report.workbook import write_cases, write_results
from trackroller.study.design.read_table import table
from trackroller.study.file.user_columns import column_names, read_table
from trackroller.study.spectrum.file import load_spectrum

openpyxl = pytest.importorskip("openpyxl")
STUDY = "name: x\ndesign: table\ntable: cases.xlsx\noutputs: [forces]\n"


def save(path, **sheets):
    """Write a workbook with a list of rows for each sheet."""
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(path)


def test_a_design_is_read_from_a_workbook(tmp_path):
    """Numbers, texts with units, decimal commas of texts and empty rows are those of a CSV."""
    rows = [["radial_force [kN]", "mu", "roller_material", None], [], [-0.2, "0,15", "PA6"], ["-300 N", 0.25, "POM"]]
    save(tmp_path / "cases.xlsx", Tabelle1=rows)
    (tmp_path / "s.yaml").write_text(STUDY)
    design = tr.load_study(tmp_path / "s.yaml").design()
    assert design.radial_force.values.tolist() == [-200.0, -300.0]
    assert design.friction_coefficient.values.tolist() == [0.15, 0.25]
    assert design.roller_material.values.tolist() == ["PA6", "POM"]
    assert column_names(tmp_path / "cases.xlsx", "table") == ["radial_force", "friction_coefficient", "roller_material"]


def test_blocks_are_read_from_a_workbook(tmp_path):
    save(tmp_path / "b.xlsx", notes=[["of 2026"]], blocks=[["name", "distance [km]", None], ["a", 1.5, None]])
    (tmp_path / "s.yaml").write_text("blocks: b.xlsx\n")
    (block,) = load_spectrum(tmp_path / "s.yaml").blocks
    assert block.distance == 1500.0 and block.case.velocity == 60.0


def test_cases_that_the_program_wrote_are_read_again(tmp_path):
    table = pd.DataFrame({"axial_force": [0.1, 1e-3], "roller_material": ["PA6", "POM"]})
    write_cases(table, tmp_path / "out.xlsx")
    read = read_table(tmp_path / "out.xlsx", "table", "case", Collector())
    assert read.names == [*table.columns] and read.head == 1
    assert [[float(a.removesuffix(" N")), b] for a, b in read.lines.values()] == table.to_numpy().tolist()


@pytest.mark.parametrize("columns", [{"friction_coefficient": [0.1, 0.2]}, {"roller_material": ["PA6", "POM"]}])
def test_pure_numbers_and_names_have_a_line_of_units_too(columns, tmp_path):
    write_cases(pd.DataFrame(columns), tmp_path / "out.xlsx")
    read = read_table(tmp_path / "out.xlsx", "table", "case", Collector())
    assert [line[0] for line in read.lines.values()] == [str(value) for value in next(iter(columns.values()))]


def test_a_workbook_of_a_study_has_units_words_and_limits_and_its_inputs_are_a_table_again(tmp_path):
    """The inputs are those of a new study; numbers of flags are words, and every computed limit stands there."""
    factors = {"axial_force": {"values": [0, 300]}, "radial_force": {"values": [-200, -150]}}
    study = {"name": "once", "factors": factors, "contact_model": "sliding", "accuracy": "preview"}
    results = tr.run(tr.load_study(study), results=tmp_path)
    path = write_results(results, tmp_path / "cases.xlsx")
    sheet = openpyxl.load_workbook(path)["cases"]
    names, units, *rows = ([cell for cell in row] for row in sheet.values)
    assert sheet.freeze_panes == "A3" and sheet.auto_filter.ref == f"A2:{sheet.cell(2, len(names)).column_letter}6"
    unit = dict(zip(names, units, strict=True))
    assert [unit[n] for n in ("axial_force", "peak_stress_roller", "roller_life_hours")] == ["N", "MPa", "h"]
    first, last = (dict(zip(names, row, strict=True)) for row in (rows[0], rows[-1]))
    assert (first["regime"], last["regime"], first["converged"]) == ("rolling", "lift-off", "yes")
    assert first["limit_state_roller_static"] == "kept" and first["limiting_mechanism_roller"] == "fatigue"
    used = results.data.utilisation.sel(axial_force=0, radial_force=-200, body="roller", limit="static")
    assert first["utilisation_roller_static"] == float(used)
    inputs = path.with_name("inputs.xlsx")
    names = ["axial_force", "radial_force"]
    again = read_table(write_cases(results.to_table()[names], inputs), "table", "case", Collector())
    assert again.names == names and len(again.lines) == 4
    (tmp_path / "s.yaml").write_text(STUDY.replace("cases.xlsx", inputs.name))
    design = tr.load_study(tmp_path / "s.yaml").design()
    assert design.axial_force.values.tolist() == [0, 0, 300, 300]
    assert design.radial_force.values.tolist() == [-200, -150, -200, -150]


def test_a_long_workbook_is_written_block_by_block_and_packed(tmp_path, monkeypatch):
    """The file is the same, and only a block of it is in memory: 20,000 lines are 3.8 MB of XML."""
    count = 20_000
    numbers = np.random.default_rng(1).random((count, 5))
    table = pd.DataFrame(numbers, columns=[f"x{i}" for i in range(5)]).assign(regime=np.arange(count) % 3)
    whole = write_cases(table, tmp_path / "whole.xlsx").read_bytes()
    monkeypatch.setattr(workbook, "BLOCK", 300)
    tracemalloc.start()
    path = write_cases(table, tmp_path / "blocks.xlsx")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert path.read_bytes() == whole
    with zipfile.ZipFile(path) as book:
        sheet = book.getinfo("xl/worksheets/sheet1.xml")
        assert book.read(sheet).count(b"<row>") == count + 2
    assert sheet.compress_size < 0.5 * sheet.file_size and sheet.file_size > 3e6
    assert peak < 0.5 * sheet.file_size
    last = pd.read_excel(path, skiprows=[1]).iloc[-1]
    assert (last[:5] == numbers[-1]).all() and last["regime"] == "full slip"


def test_a_workbook_that_no_spreadsheet_opens_is_refused_and_csv_takes_it(tmp_path, monkeypatch):
    table = pd.DataFrame({"axial_force": [0.1, 0.2, 0.3], "regime": [0, 0, 2]})
    for name, bound, told in (
        ("MOST_ROWS", 2, "at most 2 cases in a workbook"),
        ("MOST_CELLS", 5, "3 cases of 2 columns.*at most 5 cells in a workbook"),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(workbook, name, bound)
            with pytest.raises(tr.InputError, match=rf"{told}.*Write them as \.csv"):
                write_cases(table, tmp_path / "cases.xlsx")
            assert not list(tmp_path.glob("*.xlsx"))
            assert len(pd.read_csv(write_cases(table, tmp_path / "cases.csv"))) == 3


def test_errors_name_the_row_of_the_sheet(tmp_path):
    save(tmp_path / "cases.xlsx", a=[["axial_force"], [3], [], ["x"], [None, 4]])
    (tmp_path / "s.yaml").write_text(STUDY)
    told = trackroller("plan", "s.yaml", cwd=tmp_path, code=2).stderr.splitlines()
    assert [line.partition(" is not")[0] for line in told] == [
        "trackroller: cases.xlsx, line 4: axial_force = 'x'",
        "trackroller: cases.xlsx, line 5: table = ', 4'",
    ]


@pytest.mark.parametrize(
    ("sheets", "named"),
    [
        ({"a": [["mu"], [1]], "b": [["mu"], [1]]}, "a, b.*Name the sheet that is meant 'cases'"),
        ({"a": [["mu"], [datetime.date(2026, 2, 1)]]}, "line 2: .*the sheet holds a date"),
        ({"a": [["mu"]]}, "at least one case"),
    ],
)
def test_a_workbook_that_is_not_clear_is_refused(sheets, named, tmp_path):
    save(tmp_path / "cases.xlsx", **sheets)
    (tmp_path / "s.yaml").write_text(STUDY)
    with pytest.raises(tr.InputError, match=named):
        tr.load_study(tmp_path / "s.yaml")


def test_a_file_that_is_no_workbook_is_refused(tmp_path):
    (tmp_path / "s.yaml").write_text(STUDY)
    for content in (b"mu\n0.1\n", b"PK\x03\x04"):
        (tmp_path / "cases.xlsx").write_bytes(content)
        with pytest.raises(tr.InputError, match="a readable workbook"):
            tr.load_study(tmp_path / "s.yaml")
    with zipfile.ZipFile(tmp_path / "cases.xlsx", "w") as file:
        file.writestr("a.txt", "b")
    with pytest.raises(tr.InputError, match="a readable workbook"):
        tr.load_study(tmp_path / "s.yaml")


def test_without_openpyxl_the_message_says_what_to_install(tmp_path, monkeypatch):
    save(tmp_path / "cases.xlsx", a=[["mu"], [0.1]])
    (tmp_path / "s.yaml").write_text(STUDY)
    for name in ("openpyxl", "openpyxl.reader.excel"):
        monkeypatch.setitem(sys.modules, name, None)
    told = trackroller("plan", "s.yaml", cwd=tmp_path, code=2).stderr
    assert "Install it with `pip install openpyxl`, or save the table as CSV." in told


def read(rows, folder, change=lambda sheet: None, patch=lambda name, content: content):
    """Return the columns of the sheet of a workbook whose sheet and parts were changed."""
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    change(book.active)
    stream = io.BytesIO()
    book.save(stream)
    with zipfile.ZipFile(stream) as old, zipfile.ZipFile(folder / "t.xlsx", "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            new.writestr(name, patch(name, old.read(name)))
    return {name: values.tolist() for name, values in table(folder / "t.xlsx").items()}


ROWS = [["radial_force", "part"], [-200, "a"], [-300, "b"]]


def formula(value, computed_on_load=True):
    """Return a patch that stores a value for each formula."""

    def patch(name, content):
        if name.endswith("sheet1.xml"):
            return content.replace(b"<v></v>", value).replace(b"<v />", value)
        return content if computed_on_load else content.replace(b' fullCalcOnLoad="1"', b"")

    return patch


def test_formulas_without_values_are_refused(tmp_path):
    """Without a value, or with the 0 that XlsxWriter stores for all of them."""
    rows = [["radial_force", "axial_force"], [-200, 0], ["=-1*300", "=2*10"]]
    for value in (b"", b"<v/>", b"<v>0</v>"):
        with pytest.raises(tr.InputError, match=r"line 3: radial_force = '=-1.*Open the workbook in Excel"):
            read(rows, tmp_path, patch=formula(value))
    assert read(rows, tmp_path, patch=formula(b"<v>-7</v>"))["radial_force"] == [-200.0, -7.0]
    rows = [["radial_force", "axial_force"], [-200, "=1-1"]]
    assert read(rows, tmp_path, patch=formula(b"<v>0</v>", False))["axial_force"] == [0.0]


@pytest.mark.parametrize(
    "text",
    [
        "=SUM(A2:A3)",
        "=sum(A2,$A$3)",
        "=A2+A3",
        "=SUBTOTAL(9,A2:A3)",
        "=SUBTOTAL(109,Table1[radial_force])",
        "=SUM(A:A)",
        "=AVERAGE(A2,A3)",
        "=ROUND(SUM(A2:A3)/2,0)",
        '=IF(A2<0,A2+A3,"A4")',
        '=SUMIF(B2:B3,"a",A2:A3)',
        "=SUMPRODUCT(A2:A3,B2:B3)/SUM(B2:B3)",
        "=SUM(Sheet!A2:A3)",
        "=MIN('Sheet'!$A$2:$A$3)",
        "=A3+A$2",
    ],
)
def test_a_formula_that_sums_up_its_column_is_no_case(text, tmp_path):
    rows = [["radial_force", "part"], [-100, "a"], [-150, "b"], [text, "c"]]
    with pytest.raises(tr.InputError, match=r"line 4: radial_force = .=.*sums up the lines above"):
        read(rows, tmp_path, patch=formula(b"<v>-250</v>"))


@pytest.mark.parametrize(
    "column",
    [
        ["=2*A2", "=2*A3"],  # levels that double
        [-200, "=A3-50"],
        [-200, "=SUM(B2:B3)"],
    ],
)
def test_a_formula_of_a_case_keeps_its_value(column, tmp_path):
    rows = [["radial_force", "part"], [-100, 1], *([text, 2] for text in column)]
    loads = [-100.0, *(-250.0 if isinstance(one, str) else float(one) for one in column)]
    assert read(rows, tmp_path, patch=formula(b"<v>-250</v>"))["radial_force"] == loads


def test_rows_that_are_struck_through_are_refused(tmp_path):
    def strike(sheet):
        for place in ("A3", "C2"):  # C2 is empty
            sheet[place].font = openpyxl.styles.Font(strike=True)

    with pytest.raises(tr.InputError, match=r"line 3: table = 'row 3'.*not struck through.*Delete what does not count"):
        read(ROWS, tmp_path, change=strike)


def test_whole_numbers_keep_all_their_figures(tmp_path):
    """A label of 20 figures is no float; one of 14 figures is."""
    rows = [["radial_force", "serial", "part"], [-200, "=1", 12345678901234]]
    read_ = read(rows, tmp_path, patch=formula(b"<v>12345678901234567890</v>"))
    assert read_["serial"] == ["12345678901234567890"] and read_["part"] == [12345678901234.0]


def test_what_a_sheet_hides_or_merges_is_refused(tmp_path):
    def hide_row(sheet):
        sheet.row_dimensions[3].hidden = True

    def hide_column(sheet):
        sheet.column_dimensions["B"].hidden = True

    def hide_nothing_that_counts(sheet):
        sheet.row_dimensions[9].hidden = sheet.column_dimensions["Z"].hidden = True

    for change, why in [
        (hide_row, "line 3: table = 'row 3'.*hidden and filtered rows.*clear the filter"),
        (hide_column, "table = 'column B'.*hidden columns"),
        (lambda sheet: sheet.merge_cells("B2:B3"), "line 2: table = 'cells B2:B3'.*Split the cells"),
    ]:
        with pytest.raises(tr.InputError, match=why):
            read(ROWS, tmp_path, change)
    assert len(read(ROWS, tmp_path, hide_nothing_that_counts)["part"]) == 2


def test_the_sheet_that_a_person_sees_is_read(tmp_path):
    def hidden(title):
        def change(sheet):
            other = sheet.parent.create_sheet(title)
            other.append(["radial_force"])
            other.sheet_state = "hidden"

        return change

    for change in (hidden("old"), lambda sheet: sheet.parent.create_sheet("Tabelle2")):
        assert read(ROWS, tmp_path, change)["radial_force"] == [-200.0, -300.0]
    with pytest.raises(tr.InputError, match=r"sheet 'cases'.*this one is hidden"):
        read(ROWS, tmp_path, hidden("cases"))
    with pytest.raises(tr.InputError, match=r"sheets Sheet, x of .*one visible sheet"):
        read(ROWS, tmp_path, lambda sheet: sheet.parent.create_sheet("x").append([1]))


@pytest.mark.parametrize(
    ("value", "code", "shown"),
    [
        (-1.125, "General", -1.125),
        (-0.2, '0.0" kN"', -200.0),
        (-0.2, '0.0\\ "kN"', -200.0),
        (-200, "#,##0.00;[Red]-#,##0.00", -200.0),
        (-1200, "0.0,", "the format of this cell hides it"),
        (-200, "0;0", "the format of this cell hides it"),
        (-200, ";;;", "the format of this cell hides it"),
        (-0.3, "0%", "radial_force = '%'"),
        (-200, '#,##0.00\\ "€"', "radial_force = '-200 €'"),
        (-200, "yyyy-mm-dd", "the sheet holds a date"),
        (True, "General", "radial_force = 'TRUE'"),
        ("#DIV/0!", "General", "the formula of this cell has an error"),
        ("-1.200", "@", "Write -1200 or -1.2000"),
        ("\u22120,2 kN", "@", -200.0),
    ],
)
def test_a_number_is_what_the_format_of_its_cell_shows(value, code, shown, tmp_path):
    def change(sheet):
        sheet["A2"].number_format = code

    rows = [["radial_force", "part"], [value, "a"]]
    if isinstance(shown, float):
        assert read(rows, tmp_path, change)["radial_force"] == [shown]
        return
    with pytest.raises(tr.InputError, match=rf"t\.xlsx, line 2: .*{shown}"):
        read(rows, tmp_path, change)


@pytest.mark.parametrize(
    ("value", "code", "shown"),
    [
        (123, "00000", "00123"),
        (7, '"P-"000', "P-007"),
        (0.5, "0%", "50 %"),
        (3e5, "0E+0", 3e5),
        ("00123", "General", "00123"),
        (7, "General", 7.0),
    ],
)
def test_a_label_is_what_the_format_of_its_cell_shows(value, code, shown, tmp_path):
    def change(sheet):
        sheet["B2"].number_format = code

    assert read([["radial_force", "part"], [-200, value]], tmp_path, change)["part"] == [shown]


SHEET = (
    '<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>{}</sheetData></worksheet>'
)
ROW = "<row>" + "<c><v>1</v></c>" * 10 + "</row>"


@pytest.mark.parametrize(
    ("letters", "why"), [(200_000, r"line 2: part = 'x{40}\.\.\..*32,767 char"), (30_000, "50 million char")]
)
def test_cells_that_share_a_long_text_take_little_memory(letters, why, tmp_path):
    """A workbook holds each text once; a copy for each cell would take gigabytes."""
    rows = [["radial_force", "part"], *([-200 - i, "long"] for i in range(2_000))]
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    book.save(tmp_path / "own.xlsx")
    sheet, kind = (
        "http://schemas.openxmlformats.org/spreadsheetml/2006/main",
        b"application/vnd.openxmlformats-officedocument",
    )
    links, shared = b"http://schemas.openxmlformats.org/officeDocument/2006/relationships", "xl/sharedStrings.xml"
    added = {  # openpyxl itself writes the text into each cell
        "[Content_Types].xml": b'<Override PartName="/%s" ContentType="%s.spreadsheetml.sharedStrings+xml"/></Types>'
        % (shared.encode(), kind),
        "xl/_rels/workbook.xml.rels": b'<Relationship Id="s" Type="%s/sharedStrings" Target="/%s"/></Relationships>'
        % (links, shared.encode()),
    }
    with zipfile.ZipFile(tmp_path / "own.xlsx") as old, zipfile.ZipFile(tmp_path / "t.xlsx", "w") as new:
        for name in old.namelist():
            content = old.read(name).replace(b't="inlineStr"><is><t>long</t></is>', b't="s"><v>0</v>')
            more = added.get(name, b"")
            new.writestr(name, content.replace(more[more.rfind(b"</") :], more) if more else content)
        text = f'<sst xmlns="{sheet}"><si><t xml:space="preserve">{"x" * letters} </t></si></sst>'
        new.writestr(shared, text)
    with pytest.raises(tr.InputError, match=why):
        table(tmp_path / "t.xlsx")


@pytest.mark.parametrize(
    ("part", "content", "why"),
    [
        ("sheet1.xml", (ROW, 400_000), "unpacks to at most 25 MB"),
        pytest.param("sheet1.xml", (ROW, 60_000), "500,000 cells", marks=pytest.mark.slow),
        ("sheet1.xml", ('<row><c r="XFD1"><v>1</v></c></row>', 1), "1,000 columns"),
        ("sheet1.xml", ('<row r="99999999"><c><v>1</v></c></row>', 1), "500,000 cells"),
    ],
)
def test_a_workbook_is_limited_as_it_is_unpacked(part, content, why, tmp_path):
    """A zip of 300 kB may hold gigabytes."""
    piece, times = content
    text = SHEET.format(piece * times)
    with pytest.raises(tr.InputError, match=why):
        read(ROWS, tmp_path, patch=lambda name, old: text if name.endswith(part) else old)
