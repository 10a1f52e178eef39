"""Points from files: where they are looked for, and how names, units and numbers may be written."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.files import files_beside
from trackroller.roller.point_files import read_points

ROWS = [[0.25 * k, (36.0 - (0.25 * k) ** 2) ** 0.5] for k in range(-18, 19)]


def written(separator: str, comma: bool) -> str:
    lines = [separator.join(f"{v:.5f}".replace(".", "," if comma else ".") for v in row) for row in ROWS]
    return "\n".join([separator.join(["x", "z"]), *lines])


def lines_of(form: str, head: str = "", units: tuple[float, float] = (1.0, 1.0), comma: bool = False) -> str:
    """Return a file of `ROWS`, each line formatted with its count k, x and z in units of so many mm."""
    lines = [head] if head else []
    for k, (x, z) in enumerate(ROWS):
        line = form.format(k=k, x=f"{x / units[0]:.8f}", z=f"{z / units[1]:.8f}")
        lines.append(line.replace(".", ",") if comma else line)
    return "\n".join(lines)


@pytest.fixture
def read(tmp_path, monkeypatch):
    """Return a function that reads the points of a text, in the order of x."""
    monkeypatch.chdir(tmp_path)

    def points(content: str | bytes) -> list[list[float]]:
        content = content.encode() if isinstance(content, str) else content
        (tmp_path / "c.csv").write_bytes(content)
        return sorted(read_points("c.csv", "guide_profile.file").rows)

    return points


def is_right(rows: list[list[float]]) -> bool:
    return np.shape(rows) == np.shape(ROWS) and bool(np.abs(np.array(rows) - ROWS).max() < 2e-5)


@pytest.mark.parametrize(
    ("separator", "comma"),
    [
        (";", True),
        ("; ", True),
        ("\t", True),
        ("   ", True),
        (";", False),
        (",", False),
        (", ", False),
        ("\t", False),
    ],
)
def test_decimal_commas_are_read_where_they_are_unambiguous(read, separator, comma):
    assert is_right(read(written(separator, comma)))


IN, UM = 25.4, 1e-3


@pytest.mark.parametrize(
    ("head", "form", "units"),
    [
        ("x (in);z (in)", "{x};{z}", (IN, IN)),
        ("x(um),z(mm)", "{x},{z}", (UM, 1.0)),
        ("x/mm\tz/µm", "{x}\t{z}", (1.0, UM)),
        ("x / cm ; z / in", "{x};{z}", (10.0, IN)),
        ("x, in;z, in", "{x};{z}", (IN, IN)),
        ("x [mm]   z [um]", "{x}   {z}", (1.0, UM)),
        ("x [dm];z [yd]", "{x};{z}", (100.0, 914.4)),
        ("x;z\nmm;um", "{x};{z}", (1.0, UM)),
        ("x z\nmm um", "{x} {z}", (1.0, UM)),
        ("# x [mm] z [um]", "{x} {z}", (1.0, UM)),
        ("X [mm];Z [mm]", "{x};{z}", (1.0, 1.0)),
        ("# lengths in mm, tip 2 um", "{x},{z}", (1.0, 1.0)),
        ("no,x,z", "{k},{x},{z}", (1.0, 1.0)),
        ("x;y;z", "{x};7.5;{z}", (1.0, 1.0)),
        ("x;y;z", "7.5;{x};{z}", (1.0, 1.0)),
        ("x y z", "{x} {z} 0", (1.0, 1.0)),
        ("z;x", "{z};{x}", (1.0, 1.0)),
        ("x;z;quality", "{x};{z};ok", (1.0, 1.0)),
        ("sep=;\nx;z", "{x};{z}", (1.0, 1.0)),
        ("x;z;", "{x};{z};", (1.0, 1.0)),
        ('"x","z"', '"{x}","{z}"', (1.0, 1.0)),
    ],
)
def test_heads_are_read_as_a_person_reads_them(read, head, form, units):
    assert is_right(read(lines_of(form, head, units)))


NO_NAMES = r"line 1.*neither a point nor the names of the columns.*such as x \[mm\]; z \[mm\].*'#'"
LENGTHS = r"cells?, one for each name; there (is|are)"


@pytest.mark.parametrize(
    ("head", "form", "words"),
    [
        ("", "{x} 0 {z}", rf"line 1.*2 {LENGTHS} 3"),
        ("", "{k} {x} {z}", rf"line 1.*2 {LENGTHS} 3"),
        ("x;z", "{x};{z};1", rf"line 2.*2 {LENGTHS} 3"),
        ("x;y;z", "{x};{z}", rf"line 2.*3 {LENGTHS} 2"),
        ("x, in, z, inch", "{x},{z}", rf"line 2.*4 {LENGTHS} 2"),
        ("x, mm, z, um", "{x},0,{z},0", r"line 1: column = 'mm' is a unit in a cell of its own.*Write x \[mm\]"),
        ("x mm   z um", "{x}   {z}", rf"line 2.*4 {LENGTHS} 2"),
        ("x in mm  z in um", "{x} {z}", rf"line 2.*6 {LENGTHS} 2"),
        ("% x z", "{x} {z}", rf"line 2.*3 {LENGTHS} 2"),
        ("x;y;z", "{x};{k};{z}", r"line 1.*the position across the profile and the height"),
        ("x;10*z", "{x};{z}", r"line 1.*the position across the profile and the height"),
        ("x;-z", "{x};{z}", r"line 1.*the position across the profile and the height"),
        ("x;z*10 [mm]", "{x};{z}", r"line 1.*the position across the profile and the height"),
        ("x [mm];z [mm] (10:1)", "{x};{z}", r"line 1.*the position across the profile and the height"),
        ("no;z", "{k};{z}", r"the position across the profile"),
        ("x;depth", "{x};{z}", r"the position across the profile"),
        ("x (kg);z (kg)", "{x};{z}", r"line 1: x = 'kg'"),
        ("x (furlong);z (smoot)", "{x};{z}", r"line 1: z = 'smoot'"),
        ("X [MM];Z [MM]", "{x};{z}", r"line 1: x = 'MM'"),
        ("x;z(x)", "{x};{z}", r"line 1: z = 'x'"),
        ("x;z (x10)", "{x};{z}", r"line 1: z = 'x10'"),
        ("x;z (um)", "{x};{z}", r"one column only, 'um'"),
        ("# units: um", "{x} {z}", r"line 1.*names the unit um.*Write x \[um\]"),
        ("# all values in inch", "{x} {z}", r"line 1.*names the unit inch"),
        ("# Profile of a rail (in)", "{x} {z}", r"line 1.*names the unit in,"),
        ("all values in inch", "{x} {z}", NO_NAMES),
        ("Profile 7", "{x};{z}", NO_NAMES),
        ("x_um,z_mm", "{x},{z}", r"line 1: column = 'x_um'.*Write x \[um\]"),
        ("xum;zmm", "{x};{z}", r"line 1: column = 'xum'.*Write x \[um\]"),
        ("mm;um", "{x};{z}", NO_NAMES),
        ("Position [mm]\tHöhe [µm]", "{x}\t{z}", NO_NAMES),
        ("Scale 1:2\n1;2", "{x};{z}", NO_NAMES),
        (",x,z", "{k},{x},{z}", r"line 1.*Leave the index out"),
        ("Date: 2024-05-01\nx;z", "{x};{z}", NO_NAMES),
        ("Date;\nx;z", "{x};{z}", r"line 1.*which stand in line 2. Remove the lines above it, or put '#'"),
        ("37", "{x} {z}", rf"line 1.*2 {LENGTHS} 1"),
        ("\n".join(f"Key{k}=1" for k in range(6)), "{x}\t{z}\t0.1\t0.2", NO_NAMES),
        ("x,z", "{x}", rf"line 2.*2 {LENGTHS} 1"),
    ],
)
def test_what_a_person_would_ask_about_is_refused_with_its_line(read, head, form, words):
    with pytest.raises(tr.InputError, match=words):
        read(lines_of(form, head))


@pytest.mark.parametrize(
    ("wrong", "remedy", "mended"),
    [
        ("Profile 7\n1;2\n3;4", "otherwise remove such lines", "1;2\n3;4"),
        ("Profile 7\n1;2\n3;4", "or put '#' before them", "# Profile 7\n1;2\n3;4"),
        ("no 5;\nx;z\n1;2\n3;4", "Remove the lines above it", "x;z\n1;2\n3;4"),
        ("x;10*z\n1;20\n3;40", "Name them x and z", "x;z\n1;2\n3;4"),
        ("x;y;z\n1;5;2\n3;9;4", "of x, y and z one has to be constant", "x;y;z\n1;5;2\n3;5;4"),
        ("x;z [um]\n1;2000\n3;4000", r"such as x \[um\]; z \[um\]", "x [mm];z [um]\n1;2000\n3;4000"),
        ("# Scale 1:2\n1;4\n3;8", "Multiply the numbers, or remove this line", "1;2\n3;4"),
        ("# in um\n1000;2000\n3000;4000", r"Write x \[um\]", "# in um\nx [um];z [um]\n1000;2000\n3000;4000"),
        ("1;2\n2;***\n3;4", "Leave out the lines of lost points", "1;2\n3;4"),
        ("1;2\n2;\n3;4", "or remove the line", "1;2\n3;4"),
        ("1,2\n3,4", "Separate the columns by semicolons", "1;2\n3;4"),
        ("1,2\n3,4", "or write the names", "x,z\n1,2\n3,4"),
        ("1;2 mm\n3;4", "Write the unit behind 4", "1;2 mm\n3;4 mm"),
        ("x_um;z_um\n1000;2000\n3000;4000", r"Write x \[um\]", "x [um];z [um]\n1000;2000\n3000;4000"),
        (
            "pos [um];h [um]\n1000;2000\n3000;4000",
            "write x and z with their units",
            "x [um];z [um]\n1000;2000\n3000;4000",
        ),
        ("x um;z um\n1000;2000\n3000;4000", r"Write x \[um\]", "x [um];z [um]\n1000;2000\n3000;4000"),
    ],
)
def test_a_remedy_for_a_file_of_points_is_tried(read, wrong, remedy, mended):
    with pytest.raises(tr.InputError, match=remedy):
        read(wrong)
    assert read(mended) == [[1.0, 2.0], [3.0, 4.0]]


@pytest.mark.parametrize("head", ["x,z", ""])
def test_decimal_commas_between_commas_are_refused(read, head):
    for form in ("{x},{z}", "{x}, {z}"):
        with pytest.raises(tr.InputError, match=r"2 cells, one for each name; there are 4.*semicolons"):
            read(lines_of(form, head, comma=True))
    with pytest.raises(tr.InputError, match=r"line 2: .*2 cells.*semicolons"):
        read("x,z\n-4,4,472\n-3,5,196\n-2,5,657\n-1,5,916\n0,6\n1,5,916\n")


def test_commas_without_names_and_points_are_refused_with_both_remedies(read):
    numbers = "-4,472\n-3,196\n-2,657\n"
    with pytest.raises(tr.InputError, match=r"line 1: .*semicolons, or write the names"):
        read(numbers)
    assert read(numbers.replace(",", ";"))[0] == [-4.0, 472.0]
    assert read(f"x,z\n{numbers}")[0] == [-4.0, 472.0]


@pytest.mark.parametrize("mark", ["", "NaN", "*****", "-", "---", "#N/A", "bad", "inf"])
def test_lost_points_are_named_by_line(read, mark):
    lines = lines_of("{x};{z}", "x;z").splitlines()
    for number in (2, 20, len(lines)):
        lost = [*lines[: number - 1], f"{lines[number - 1].split(';')[0]};{mark}", *lines[number:]]
        words = "the cell is empty. Fill the cell, or remove" if mark == "" else "not measured. .*Leave out"
        with pytest.raises(tr.InputError, match=rf"line {number}: .*{words}"):
            read("\n".join(lost))
    assert len(read("\n".join([*lines[:19], *lines[20:]]))) == len(ROWS) - 1


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_encodings_and_ends_of_lines(read, encoding, end):
    text = lines_of("{x}\t{z}", "x [mm]\tz [µm]", (1.0, UM)).replace("\n", end)
    assert is_right(read(text.encode(encoding)))
    assert is_right(read(lines_of("{x}\t{z}").replace("\n", end).encode(encoding)))


@pytest.mark.parametrize("minus", ["\u2212", "\u2013"])
def test_other_signs_of_spreadsheets(read, minus):
    assert is_right(read(lines_of("{x};{z}", "x;z").replace("-", minus)))
    assert is_right(read(lines_of("{x}D+00 {z}D+00")))
    assert is_right(read(lines_of("{x};\u00a0{z}", "x;z")))


def test_workbooks_and_pictures_are_refused(read, tmp_path):
    with zipfile.ZipFile(tmp_path / "book.xlsx", "w") as book:
        book.writestr("xl/workbook.xml", "<a/>")
    for content, words in (
        ((tmp_path / "book.xlsx").read_bytes(), "is a workbook.*Save the sheet"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(200), "an old workbook"),
        (b"%PDF-1.7\n\x00\x01\x02", "zero bytes"),
        (b"%PDF-1.7\n\x03\x01\x02", "bytes that are no text"),
        (b"", "at least one point"),
    ):
        with pytest.raises(tr.InputError, match=words):
            read(content)


def simpack(settings: str = "units.len.f = 1000.", points: str = "", weight: str = "") -> str:
    rows = points or "\n".join(f"  {y:.6f}  {z:.6f} {weight}" for y, z in reversed(ROWS))
    return (
        "! *** wheel ***\nheader.begin\n  version = 1  ! flag\n  type = 1\nheader.end\nspline.begin\n"
        "  approx.smooth = +0.0E+00 ! smoothing\n  comment = 'units: in'\n  bound.y.min = 1.0\n  bound.y.max = 0.0\n"
        f"  inversion = 1\n{settings}\n  point.begin\n  ! y value   z value\n{rows}\n  point.end\nspline.end\n"
    )


@pytest.mark.parametrize(
    ("settings", "factor", "moved"),
    [
        ("units.len.f = 1000.", (1, 1), (0, 0)),
        ("units.len.f = 1\n units.len = 'm'", (1e3, 1e3), (0, 0)),
        ("units.len.f = 1000\n shift.y = 0.5\n shift.z = -2", (1, 1), (0.5, -2)),
        ("units.len.f = 1000\n mirror.z = 1\n shift.y = -2", (1, -1), (-2, 0)),
        ("units.len.f = 1000\n mirror.y = 1\n shift.z = 1", (-1, 1), (0, 1)),
        ("units.len.f = 1000\n point.dist.min = 1e-4", (1, 1), (0, 0)),
    ],
)
def test_profiles_of_simpack_are_read_as_their_settings_say(read, settings, factor, moved):
    expected = (np.array(ROWS) + moved) * factor
    np.testing.assert_allclose(read(simpack(settings)), sorted(expected.tolist()), atol=2e-3)
    assert is_right(read(simpack(weight="1.0")))


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ("units.len.f = 1000\n approx.smooth = 1e-3", "Give `smooth`"),
        ("units.len.f = 1000\n rotate = 0.02", "Turn the points"),
        ("units.len.f = 1000\n point.dist.min = 0.5", "leaves out no point"),
        ("units.len.f = 1000\n bound.y.min = -2\n bound.y.max = 2", "bounds"),
        ("units.len.f = 1000\n mirror.z = 2", "0 or 1"),
        ("units.len.f = 1000\n mirror.z = 1\n shift.z = -2", "0 beside a shift"),
        ("units.len.f = 1000\n stretch.y = 2", "is no known setting"),
        ("units.len = 'mm'", "units.len.f"),
    ],
)
def test_settings_of_simpack_that_change_the_shape_are_refused(read, settings, words):
    with pytest.raises(tr.InputError, match=words):
        read(simpack(settings))
    for broken in (simpack().replace("point.end", ""), simpack(points="1 2\n3\n"), simpack().replace("header.end", "")):
        with pytest.raises(tr.InputError, match=r"c\.csv, line"):
            read(broken)


CASES = {  # a file and the largest pressures of both contacts [MPa]
    "inch": ("guide_profile", "contact", "x (in);z (in)\n", (647.0, 823.0)),
    "xyz": ("roller_profile", "contact", "x;y;z\n", (649.0, 825.0)),
    "index": ("guide_profile", "section", "no,x,z\n", (647.0, 823.0)),
    "prw": ("guide_profile", "section", "", (647.0, 823.0)),
    "smoothed": ("guide_profile", "section", "x;z\n", (647.0, 823.0)),
}


@pytest.mark.parametrize("name", CASES)
def test_files_give_the_pressure_of_the_true_profile(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    body, frame, head, expected = CASES[name]
    x = np.round(np.arange(-30, 31) * 0.05, 2) if frame == "contact" else np.round(np.arange(-90, 91) * 0.05, 2)
    z = np.sqrt((36.0 if body == "guide_profile" else 49.0) - x * x)
    noise = np.random.default_rng(5).normal(0.0, 1e-4, x.size) if name == "smoothed" else 0.0
    rows = zip(x.tolist(), (z + noise).tolist(), strict=True)
    text = {
        "inch": lambda: head + "".join(f"{a / IN:.9f};{b / IN:.9f}\n" for a, b in rows),
        "xyz": lambda: head + "".join(f"{a};0.0;{b:.7f}\n" for a, b in rows),
        "index": lambda: head + "".join(f"{k},{a},{b:.7f}\n" for k, (a, b) in enumerate(rows)),
        "prw": lambda: simpack(points="\n".join(f"{a} {b:.7f}" for a, b in rows)),
        "smoothed": lambda: head + "".join(f"{a};{b:.7f}\n" for a, b in rows),
    }[name]()
    (tmp_path / "c.csv").write_text(text, encoding="utf-8")
    profile = {"file": "c.csv", "frame": frame} | ({"smooth": 1e-4} if name == "smoothed" else {})
    case = tr.Case(**{body: profile}, friction_coefficient=0.2, motor_force=0)
    ds = tr.solve(case, "contact", normal="halfspace", accuracy="preview", contact_model="sliding")
    np.testing.assert_allclose(ds.max_pressure, expected, rtol=0.05 if name == "smoothed" else 5e-3)


def test_words_are_refused_with_the_line(read):
    with pytest.raises(tr.InputError, match=r"line 39.*one 1,0; 2.0' is a point that was not measured"):
        read(written(";", True) + "\none 1,0;2,0\n")


THOUSANDS = [(x, round(-x * x / 12000)) for x in range(-4500, 4501, 250)]  # in micrometres


@pytest.mark.parametrize("sign", [",", ".", "'", "\u202f"])
def test_thousands_are_read_where_the_numbers_tell(read, sign):
    """Thousands and decimals cannot be told apart in a single cell; decimals of another sign tell them."""
    head = "x [um];z [um]\n"
    rows = "\n".join(f"{x:,};{z:,}" for x, z in THOUSANDS).replace(",", sign)
    decimal = "," if sign == "." else "."
    with_decimals = rows.replace(";", f"{decimal}5;")
    assert read(head + with_decimals)[0] == [-4.5005, -1.688]
    if sign in ",.":
        with pytest.raises(tr.InputError, match=rf"line 2: x = '-4{sign}500'.*Write -4500 or -4{sign}5000"):
            read(head + rows)
        rows = "\n".join(f"{x};{z}" for x, z in THOUSANDS)
    assert read(head + rows) == [[x / 1000, z / 1000] for x, z in THOUSANDS]


@pytest.mark.parametrize("mark", ".,")
def test_three_decimals_are_read_where_the_numbers_tell(read, mark):
    rows = [(x, round((36.0 - x * x) ** 0.5, 3)) for x in range(-4, 5)]
    padded = "\n".join(f"{x};{z:.3f}" for x, z in rows).replace(".", mark)  # each height may be some thousands
    assert read(f"x;z\n{padded}") == [[x, z] for x, z in rows]
    assert read("x;z\n" + "\n".join(f"{x};{z:g}" for x, z in rows).replace(".", mark)) == [[x, z] for x, z in rows]


def test_a_number_that_stays_ambiguous_is_refused(read):
    with pytest.raises(tr.InputError, match=r"line 2.*1\.500 or 1500.*Write"):
        read("x [um];z [um]\n" + "\n".join(f"{k}.500;{k * k}.250" for k in range(1, 9)))


def test_two_decimal_signs_are_refused(read):
    with pytest.raises(tr.InputError, match=r"line 1: x = '1\.500'.*1\.500 or 1500"):
        read("1.500;2,250\n2.500;3,250")
    with pytest.raises(tr.InputError, match=r"line 12: x = '-2,0'.*one decimal sign in the file; -4.50000000"):
        read(lines_of("{x};{z}", "x;z").replace("-2.00000000;5.65685425", "-2,0;5,6569"))


@pytest.mark.parametrize(
    ("form", "units"),
    [
        ("{x} mm;{z} mm", (1, 1)),
        ("{x} in;{z} um", (25.4, 1e-3)),
        ("{x}mm\t{z}µm", (1, 1e-3)),
        ("{x} nm|{z} cm", (1e-6, 10)),
    ],
)
def test_units_behind_each_number_are_read(read, form, units):
    assert is_right(read(lines_of(form, "", units)))
    mark = next(mark for mark in ";\t|" if mark in form)
    assert is_right(read(lines_of(form, f"x{mark}z", units)))
    bare = lines_of("{x} mm;{z} mm").replace("5.91607978 mm", "5.91607978", 1)
    with pytest.raises(tr.InputError, match=r"line 15: z = '5.91607978'.*Write the unit behind 5.91607978"):
        read(bare)
    with pytest.raises(tr.InputError, match="kg"):
        read(lines_of("{x} kg;{z} kg"))


@pytest.mark.parametrize("remark", ["# note", "#5", "# tip 2 um, 5 N"])
def test_remarks_are_left_out(read, remark):
    lines = lines_of("{x};{z}", "x;z").splitlines()
    for place in (0, 1, 9, len(lines)):
        assert is_right(read("\n".join([*lines[:place], remark, "", *lines[place:], "", ""])))


@pytest.mark.parametrize("remark", ["# 5;6", "% 5 6", "! note", "// note", "; measured on Monday", "*** profile ***"])
def test_other_remarks_are_refused_by_line(read, remark):
    lines = lines_of("{x};{z}", "x;z").splitlines()
    with pytest.raises(tr.InputError, match="line 10: "):
        read("\n".join([*lines[:9], remark, *lines[9:]]))


@pytest.mark.parametrize("line", [";NaN", "*****;***", ";", "-1;", "x;z", "Sum;12", "End"])
def test_lines_that_hide_a_point_are_no_remarks(read, line):
    lines = lines_of("{x};{z}", "x;z").splitlines()
    text = "\n".join([*lines[:9], line, *lines[9:]])
    if line == ";":  # an empty row of a spreadsheet
        assert is_right(read(text))
    else:
        with pytest.raises(tr.InputError, match="line 10"):
            read(text)


@pytest.mark.parametrize("line", ["# Scale: 0.001", "# scale z: 0,001", "# z-Faktor = 1000", "# scale factor 2,5"])
def test_a_scale_is_not_left_out(read, line):
    with pytest.raises(tr.InputError, match=r"line 1.*states a scale of .*which is not applied"):
        read(f"{line}\n" + lines_of("{x};{z}", "x;z"))
    assert is_right(read("# Scale: 1.0\n" + lines_of("{x};{z}", "x;z")))


@pytest.mark.long
def test_files_lie_beside_the_case_or_below_the_working_directory(tmp_path):
    folder = tmp_path / "prof"
    folder.mkdir()
    (folder / "c.csv").write_text(written(";", True), encoding="utf-8")
    case = "guide_profile: {file: c.csv, frame: section}\nnormal: halfspace\naccuracy: preview\noutputs: [forces]\n"
    case += "contact_model: sliding\n"
    (folder / "c.yaml").write_text(case)
    (folder / "study.yaml").write_text(f"name: s\nbase: {{{case.splitlines()[0]}}}\nnormal: halfspace\n")
    trackroller("solve", "prof/c.yaml", cwd=tmp_path)
    trackroller("plan", "prof/study.yaml", cwd=tmp_path)
    (tmp_path / "c.yaml").write_text(case.replace("c.csv", "prof/c.csv"))
    trackroller("solve", "c.yaml", cwd=tmp_path)


def test_a_missing_file_is_told_where_to_put(tmp_path, monkeypatch):
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    monkeypatch.chdir(here)
    with files_beside(there / "case.yaml"), pytest.raises(tr.InputError) as told:
        read_points("c.csv", "guide_profile.file")
    assert f"below {there} or below {here}" in str(told.value)
    with pytest.raises(tr.InputError, match=r"without '..'"):
        read_points("../there/c.csv", "guide_profile.file")
    (tmp_path / "outside.csv").write_text(written(",", False))
    (there / "link.csv").symlink_to(tmp_path / "outside.csv")
    with files_beside(there / "case.yaml"), pytest.raises(tr.InputError, match="a file below"):
        read_points("link.csv", "guide_profile.file")


@pytest.mark.parametrize("mark", ["1.#QNAN", "-1.#IND", "1.#INF00", "1,#QNAN"])
def test_marks_of_lost_points_are_no_remarks(mark, read):
    """'#' begins a remark, and the 1 before it is no height."""
    lines = lines_of("{x};{z}").split("\n")
    lines[10] = f"-2;{mark}"
    with pytest.raises(tr.InputError, match=r"c\.csv, line 11: .*is a point that was not measured"):
        read("\n".join(lines))


@pytest.mark.parametrize(
    ("head", "scale"),
    [
        ("# Scale 1:2\nx;z", "1:2"),
        ("# Massstab 10:1\nx;z", "10:1"),
        ("# Überhöhung 10\nx;z", "10"),
        ("# vertical exaggeration: 100x\nx;z", "100"),
        ("# height magnified 10 times\nx;z", "10"),
        ("# 10-fold\nx;z", "10"),
        ("# V=1000\nx;z", "1000"),
        ("# Vv: 2000x, Vh = 20x\nx;z", "2000"),
        ("# Lt=4.8 mm V = 500:1\nx;z", "500"),
    ],
)
def test_a_scale_that_a_comment_states_is_a_question(head, scale, read):
    with pytest.raises(tr.InputError, match=rf"line 1: .*states a scale of {scale}, which is not applied.*Multiply"):
        read(lines_of("{x};{z}", head))


@pytest.mark.parametrize(
    "head",
    [
        "# scale 1:1\nx;z",
        "# Maßstab: 1\nx;z",
        "# measured 3 times on 2026-03-01 01:10\nx;z",
        "# V=1, v=500\nx;z",
        "# V=50 mm/s\nx;z",
        "# Software V: 2.1\nx;z",
    ],
)
def test_a_comment_without_a_scale_is_left_out(head, read):
    assert is_right(read(lines_of("{x};{z}", head)))


@pytest.mark.parametrize(("units", "z"), [(",mm,um", 1e-3), (";mm;mm", 1.0), ("-\tmm\tµm", 1e-3), (",[mm],[um]", 1e-3)])
def test_a_line_of_units_may_leave_out_the_count(units, z, read):
    mark = next(mark for mark in ",;\t" if mark in units)
    head = mark.join(["No.", "X", "Z"]) + f"\n{units}"
    assert is_right(read(lines_of(mark.join(["{k}", "{x}", "{z}"]), head, (1.0, z))))
