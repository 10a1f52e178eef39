"""Each remedy that a message on a table or workbook names is tried: the table is then read."""

from __future__ import annotations

import openpyxl
import pytest
from openpyxl.styles import Font

import trackroller as tr
from trackroller.study.design.read_table import table
from trackroller.tables import xlsx

HEADS = ["radial_force", "part"]


def read(path):
    return {name: values.tolist() for name, values in table(path).items()}


@pytest.mark.parametrize(
    ("wrong", "remedy", "mended"),
    [
        ("radial_force;part\n-1.200;a\n", "Write -1200 or -1.2000", "radial_force;part\n-1200;a\n"),
        ("radial_force;part\n-1.200;a\n", "Write -1200 or -1.2000", "radial_force;part\n-1.2000;a\n"),
        ("radial_force\n-1.200\n-1.300\n", "such as -1.2000 decides for the whole", "radial_force\n-1.2000\n-1.300\n"),
        ("radial_force;part\n-2;a\npause\n-3;b\n", "or remove the line", "radial_force;part\n-2;a\n-3;b\n"),
        ("radial_force\n-200,5\n", "Write decimal points", "radial_force\n-200.5\n"),
        ("radial_force,part\n-200,5,a\n", "separate the columns by semicolons", "radial_force;part\n-200,5;a\n"),
        (",radial_force\n0,-200\n1,-300\n", "Leave the index out", "radial_force\n-200\n-300\n"),
        ("radial_force;;part\n-200;7;a\n", "Name it", "radial_force;lot;part\n-200;7;a\n"),
        (
            "radial_force;part\n-0.2 kN;a\n-0.3;b\n",
            "Write the unit behind -0.3",
            "radial_force;part\n-0.2 kN;a\n-0.3 kN;b\n",
        ),
        (
            "radial_force;part\n-0.2 kN;a\n-0.3;b\n",
            "or at the head of the column",
            "radial_force [kN];part\n-0.2;a\n-0.3;b\n",
        ),
        ("radial_force,kN\n-2,5\n", r"Write radial_force \[kN\]", "radial_force [kN]\n-2.5\n"),
        ("radial_force_kN\n-2.5\n", r"Write radial_force \[kN\]", "radial_force [kN]\n-2.5\n"),
        ("Radial_Force <N>\n-2.5\n", r"Write radial_force \[N\]", "radial_force [N]\n-2.5\n"),
        ("radial_force\n-2.5\n# -3\n", "Remove the line if it does not", "radial_force\n-2.5\n"),
        ("radial_force,kN\n-2,5\n", "or rename it", "radial_force,lot\n-2,5\n"),
        ("Loads;\nradial_force;part\n-200;a\n", "Remove the lines above", "radial_force;part\n-200;a\n"),
        ("radial_force part\n-200 a\n", "No: one column", "radial_force;part\n-200;a\n"),
        ("radial_force axial_force\n-200 9\n", "Separate the columns", "radial_force|axial_force\n-200|9\n"),
        ("radial_force;part\n-200;a\nSum;b\n", "radial_force = 'Sum'", "radial_force;part\n-200;a\n"),
        ("part;radial_force\na;-200\nTotal;-200\n", "Remove the line", "part;radial_force\na;-200\n"),
        ("part;radial_force\na;-200\nTotal;-200\n", "rename it", "part;radial_force\na;-200\nway;-200\n"),
        ("radial_force;part\n-200;a\n;b\n", "Fill the cell", "radial_force;part\n-200;a\n-300;b\n"),
        ("radial_force;part\n-200;a\n;b\n", "or remove the line", "radial_force;part\n-200;a\n"),
        ("radial_force;part\n-200;a\n#-300;b\n", "Remove the line if it does not", "radial_force;part\n-200;a\n"),
        ("radial_force;part\n-200;a\n#-300;b\n", "and '#' if it does", "radial_force;part\n-200;a\n-300;b\n"),
        ("# in kN\nradial_force;part\n-2;a\n", r"Write radial_force \[kN\]", "radial_force [kN];part\n-2;a\n"),
        ("# in kN\nradial_force;part\n-2;a\n", "or remove this line", "radial_force;part\n-2;a\n"),
        ("radial_force;part\n=2*3;a\n", "Write its value", "radial_force;part\n-6;a\n"),
        ('radial_force;part\n-2;"a\n', "Close the quotation marks", 'radial_force;part\n-2;"a"\n'),
        ("sep=tab\nradial_force\tpart\n-2\ta\n", "remove this line", "radial_force\tpart\n-2\ta\n"),
        ("mu;friction_coefficient\n0.1;0.2\n", "Rename or remove a column", "friction_coefficient\n0.2\n"),
        ("radial_force;a/b\n-2;a\n", "Rename it", "radial_force;a or b\n-2;a\n"),
        ("F_rad;part\n-2;a\n", "similar meaning: radial_force", "radial_force;part\n-2;a\n"),
    ],
)
def test_a_remedy_for_a_csv_file_is_tried(tmp_path, wrong, remedy, mended):
    path = tmp_path / "t.csv"
    path.write_text(wrong)
    if not remedy.startswith("No:"):
        with pytest.raises(tr.InputError, match=remedy):
            read(path)
    path.write_text(mended)
    assert read(path)


def test_a_file_in_another_encoding_is_saved_as_utf_8(tmp_path):
    path = tmp_path / "t.csv"
    path.write_bytes("radial_force;Größe\n-2;a\n".encode("cp1252"))
    with pytest.raises(tr.InputError, match="Save the file as UTF-8"):
        read(path)
    path.write_bytes("radial_force;Größe\n-2;a\n".encode())
    assert read(path)["Größe"] == ["a"]


def hide(sheet, hidden=True):
    sheet.row_dimensions[3].hidden = hidden


def hide_column(sheet, hidden=True):
    sheet.column_dimensions["B"].hidden = hidden


def delete_row(sheet):
    sheet.delete_rows(3)
    sheet.row_dimensions[3].hidden = False


def merge(sheet):
    sheet.merge_cells("B2:B3")


def split(sheet):
    sheet.unmerge_cells("B2:B3")
    sheet["B3"] = "b"


def strike(sheet, struck=True):
    sheet["A3"].font = Font(strike=struck)


def write_formula(sheet):
    sheet["A3"] = "=-2*150"


def write_value(sheet):
    sheet["A3"] = -300


def form(code):
    def change(sheet):
        sheet["A3"].number_format = code

    return change


def add_sheet(sheet):
    sheet.parent.create_sheet("more").append([1])


def name_sheet(sheet):
    sheet.title = "cases"


@pytest.mark.parametrize(
    ("spoil", "remedy", "mend"),
    [
        (hide, "Show what counts", lambda sheet: hide(sheet, False)),
        (hide, "delete what does not", delete_row),
        (hide_column, "Show what counts", lambda sheet: hide_column(sheet, False)),
        (merge, "Split the cells and fill each of them", split),
        (strike, "give the rest another font", lambda sheet: strike(sheet, False)),
        (write_formula, "Open the workbook in Excel or LibreOffice and save it", write_value),
        (form("0.0,"), "Give the cell the format General", form("General")),
        (form("yyyy-mm-dd"), "Give the cell the format of a number", form("0.00")),
        (add_sheet, "Name the sheet that is meant 'cases'", name_sheet),
    ],
)
def test_a_remedy_for_a_workbook_is_tried(tmp_path, spoil, remedy, mend):
    book = openpyxl.Workbook()
    for row in (HEADS, [-200, "a"], [-300, "b"]):
        book.active.append(row)
    sheet = book.active
    spoil(sheet)
    book.save(tmp_path / "t.xlsx")
    with pytest.raises(tr.InputError, match=remedy):
        read(tmp_path / "t.xlsx")
    mend(sheet)
    book.save(tmp_path / "t.xlsx")
    assert read(tmp_path / "t.xlsx")["radial_force"][0] == -200.0


def test_a_large_workbook_is_refused_and_its_sheet_is_read_as_csv(tmp_path, monkeypatch):
    monkeypatch.setattr(xlsx, "MAX_CELLS", 1_000)
    rows = [HEADS, *([-200 - i, "a"] for i in range(500))]
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    book.save(tmp_path / "t.xlsx")
    with pytest.raises(
        tr.InputError, match=r"line 501: .*at most 1,000 columns and 1,000 cells.*save the sheet as CSV"
    ):
        read(tmp_path / "t.xlsx")
    (tmp_path / "t.csv").write_text("\n".join(",".join(map(str, row)) for row in rows) + "\n")
    assert len(read(tmp_path / "t.csv")["part"]) == 500
