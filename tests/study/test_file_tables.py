"""Spreadsheets and patterns of names, joined to files."""

import pytest
from tests.workbooks import MAIN, workbook

from fingerpad.exceptions import ManifestError
from fingerpad.study.imports.identify import join_files, parse_file_table, read_file_table
from fingerpad.study.imports.names import FileValues, match_file_names, read_value

SHEET = f"""<?xml version="1.0"?><worksheet {MAIN}><sheetData>
<row r="1"><c r="A1" t="s"><v>0</v></c><c r="B1" t="s"><v>1</v></c>
<c r="D1" t="inlineStr"><is><t>theta (deg)</t></is></c></row>
<row r="3"><c r="A3" t="s"><v>2</v></c><c r="B3"><v>0.10000000000000001</v></c>
<c r="D3"><f>15*2</f><v>30</v></c></row>
</sheetData></worksheet>"""
SHARED = (
    "<si><t>File</t></si><si><t>Load N</t></si>"
    "<si><r><t>IMG_</t></r><r><t>1.png</t></r><rPh><t>x</t></rPh></si>"
)


def test_workbook(tmp_path) -> None:
    path = tmp_path / "a.xlsx"
    path.write_bytes(workbook(SHEET, SHARED))
    (row,) = read_file_table(path).rows
    assert (row.file, row.values) == ("IMG_1.png", {"load_N": 0.1, "wedge_angle_deg": 30.0})


def test_hostile_workbooks(tmp_path) -> None:
    entities = '<!DOCTYPE a [<!ENTITY b "bbbb">]>' + SHEET.replace('<?xml version="1.0"?>', "")
    bad = {
        "entities": workbook(entities, SHARED),
        "wide characters": workbook(SHEET.encode("utf-16").decode("latin-1"), SHARED),
        "no zip": b"PK\3\4 nothing",
        "cut": workbook(SHEET, SHARED)[:500],
        "a text beyond the last": workbook(SHEET, "<si><t>File</t></si>"),
        "no sheet": workbook(SHEET, SHARED, **{"xl/workbook.xml": f"<workbook {MAIN}/>".encode()}),
    }
    for what, content in bad.items():
        path = tmp_path / f"{what}.xlsx"
        path.write_bytes(content)
        with pytest.raises(ManifestError) as caught:
            read_file_table(path)
        assert what in str(caught.value)


@pytest.mark.parametrize(
    ("header", "cell", "values"),
    [
        ("Load (mN)", "500", {"load_N": 0.5}),
        ("load_N", "1,5", {"load_N": 1.5}),
        ("Normal force [N]", "2", {"load_N": 2.0}),
        ("W / N", "2", {"load_N": 2.0}),
        ("weight, g", "100", {"load_N": 0.980665}),
        ("load", "250 mN", {"load_N": 0.25}),
        ("load_N_std", "0.1", {}),
        ("Theta", "45", {"wedge_angle_deg": 45.0}),
        ("Wedge angle (deg)", "22.5", {"wedge_angle_deg": 22.5}),
        ("wedge_angle_deg", "30°", {"wedge_angle_deg": 30.0}),
        ("mm/px", "0,05", {"mm_per_px": 0.05}),
        ("scale (px/mm)", "20", {"mm_per_px": 0.05}),
        ("um per px", "50", {"mm_per_px": 0.05}),
        ("PPI", "500", {"ppi": 500.0}),
        ("scale", "reader", {"scale": "reader"}),
        ("Subject", "S 07", {"person": "S_07"}),
        ("Participant ID", "7", {"person": "7"}),
        ("digit", "right ring", {"finger": "right_ring"}),
        ("Face", "Palmar view", {"face": "palmar"}),
        ("kind", "contact image", {"role": "observation"}),
        ("type", "ulnar photo", {"role": "photograph", "face": "ulnar"}),
        ("Type", "coin", {"role": ""}),
        ("visit", "2", {"session": "2"}),
        ("temperature", "20", {}),
    ],
)
def test_headers_and_cells(header: str, cell: str, values: FileValues) -> None:
    table = parse_file_table(f"Filename\t{header}\na.png\t{cell}")
    assert table.rows[0].values == values
    assert (table.columns[1].meaning is None) == (not values)
    assert not table.rows[0].problems


@pytest.mark.parametrize(
    ("header", "cell"),
    [
        ("load", "heavy"),
        ("load", "-1"),
        ("wedge", "100"),
        ("load", "5 kg"),
        ("scale", "500"),
        ("face", "nose"),
    ],
)
def test_a_cell_that_cannot_be_read_is_named(header: str, cell: str) -> None:
    row = parse_file_table(f"file,{header},session\na,{cell},1").rows[0]
    assert row.values == {"session": "1"}
    assert len(row.problems) == 1
    assert repr(cell) in row.problems[0]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("load,finger\n1,LI", "no column names the files"),
        ("file,load,force\na,1,1", "both state the load"),
        ("file,load\n", "at least one row"),
    ],
)
def test_tables_that_cannot_be_joined(text: str, words: str) -> None:
    with pytest.raises(ManifestError, match=words):
        parse_file_table(text)


def test_hand_and_digit_in_two_columns() -> None:
    table = parse_file_table("hand;digit;image\nL;index;1\nright;Thumb;2")
    assert [row.values["finger"] for row in table.rows] == ["left_index", "right_thumb"]


def test_join_lists_what_is_unmatched_and_what_is_named_twice() -> None:
    files = ["uploads/a-1.png", "uploads/b.png", "uploads/b.tif", "uploads/c_0.5N.png", "uploads/d.png"]
    table = parse_file_table(
        "file,load\nA (1).PNG,1\nb,2\nb.tif,3\nc_0.5N,4\nd,5\nD.png,6\nnowhere.png,7\n,8"
    )
    found = join_files(table, files)
    loads = {file: values["load_N"] for file, values in found.values.items()}
    assert loads == {"uploads/a-1.png": 1, "uploads/b.tif": 3, "uploads/c_0.5N.png": 4}
    assert [row.line for row in found.rows_without_file] == [3, 6, 7, 8, 9]  # b is two files, d two rows
    assert found.files_without_row == ["uploads/b.png", "uploads/d.png"]


def test_pattern() -> None:
    found = match_file_names(
        "S{person}_{finger}_{wedge}deg_{load}mN*",
        [
            "S01_left_index_45deg_500mN.png",
            "x/s2_right-thumb_0deg_1,5mN_b.tif",
            "S1_LI_100deg_5mN.png",
            "IMG_1.png",
        ],
    )
    assert [one.problem == "" for one in found] == [True, True, False, False]
    assert found[0].values == {"person": "01", "finger": "left_index", "wedge_angle_deg": 45.0, "load_N": 0.5}
    assert found[1].values["finger"] == "right_thumb"
    assert found[1].values["load_N"] == 0.0015
    assert "100" in found[2].problem


@pytest.mark.parametrize(
    "pattern",
    [
        "IMG",
        "{load}_{load}",
        "{mood}",
        "{person}{finger}",
        "*_*_*_*_{load}",
        "{load}{}",
        "{roll}",
        "*{load}",
        "{load}" + "x" * 300,
    ],
)
def test_patterns_refused(pattern: str) -> None:
    with pytest.raises(ManifestError):
        match_file_names(pattern, ["a.png"])


def test_every_field_of_a_pattern_is_read() -> None:
    values = FileValues()
    for field, text in [("person", "1"), ("finger", "LI"), ("face", "ulnar"), ("wedge", "30"), ("load", "2")]:
        read_value(values, field, text)
    one = match_file_names("{person}-{finger}-{face}-{wedge}-{load}", ["1-LI-ulnar-30-2.png"])[0]
    assert one.values == values
