"""The CSV files of users: their cells, and the line that a message names."""

import pytest

import trackroller as tr
from trackroller.errors import Collector
from trackroller.study.design.read_table import table
from trackroller.study.file.user_columns import read_table


def test_cells_stand_by_the_number_of_their_line(tmp_path):
    """Empty lines, lines of empty cells, and a cell over two lines count as an editor counts them."""
    (tmp_path / "t.csv").write_text('\n a , b\n\n 1 , 2\n,\n"3\n3",4\n')
    table = read_table(tmp_path / "t.csv", "table", "case", Collector())
    assert table.names == ["a", "b"] and table.head == 2 and table.lines == {4: ["1", "2"], 7: ["3\n3", "4"]}


@pytest.mark.parametrize(
    ("text", "line", "why"),
    [
        ("a,b\n\n\n1,2\n\n3\n", 6, "2 cells, one for each name; there are 1"),
        ("axial_force,velocity\n\n10,20\n\n30,\n", 5, "the cell is empty"),
    ],
)
def test_a_message_names_the_line_of_the_file(text, line, why, tmp_path):
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(tr.InputError, match=f"t.csv, line {line}: .*{why}"):
        table(tmp_path / "t.csv")


TEXT = "axial_force [N];friction_coefficient;Größe µ\r\n10,5;0,12;groß\r\n-20;0,3;klein\r\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_table_of_excel_is_read_in_each_unicode_encoding(encoding, tmp_path):
    (tmp_path / "t.csv").write_bytes(TEXT.encode(encoding))
    columns = table(tmp_path / "t.csv")
    assert columns["axial_force"].tolist() == [10.5, -20.0]
    assert columns["friction_coefficient"].tolist() == [0.12, 0.3]
    assert columns["Größe_µ"].tolist() == ["groß", "klein"]


@pytest.mark.parametrize("encoding", ["cp1252", "utf-16-le", "utf-32"])
def test_a_table_in_another_encoding_is_refused_by_name(encoding, tmp_path):
    (tmp_path / "t.csv").write_bytes(TEXT.encode(encoding))
    with pytest.raises(tr.InputError, match=r"t\.csv.*UTF-8"):
        table(tmp_path / "t.csv")
