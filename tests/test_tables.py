"""Tables of every kind: the same numbers from each, and clear words for what is none."""

import io
import re
import struct
import zipfile
import zlib
from contextlib import suppress
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat
from tests.workbooks import MAIN, sheet_xml, workbook

from fingerpad import _tables
from fingerpad._tables import TABLE_SUFFIXES, parse_table, read_table
from fingerpad.exceptions import LoadingError
from fingerpad.image.sequence.force import read_force_signal
from fingerpad.loading import read_loading_curve

TEXTS = {".md", ".py", ".toml", ".js"}
HEADER = ("time_s", "force_N", "displacement_mm")
NUMBERS = st.floats(-1e9, 1e9).map(float)


def mat(**variables: object) -> bytes:
    target = io.BytesIO()
    savemat(target, variables, oned_as="column", do_compression=True)
    return target.getvalue()


def tdms(channels: dict[str, tuple[list[float], dict[str, object]]], group: str = "press") -> bytes:
    target = io.BytesIO()
    with TdmsWriter(target) as writer:
        for name, (values, properties) in channels.items():
            writer.write_segment([ChannelObject(group, name, np.array(values), properties)])
    return target.getvalue()


def written(rows: list[list[float]]) -> dict[str, bytes]:
    """Return a table in every kind of file that holds it."""
    texts = [HEADER, *([repr(value) for value in row] for row in rows)]
    found = {}
    for name, mark, decimal, encoding in (
        ("comma.csv", ",", ".", "utf-8"),
        ("semicolon.csv", ";", ".", "utf-8-sig"),
        ("tab.tsv", "\t", ".", "cp1252"),
        ("semicolon_comma.csv", ";", ",", "utf-8"),
        ("tab_comma.csv", "\t", ",", "utf-8"),
    ):
        lines = (mark.join(cell.replace(".", decimal) for cell in row) for row in texts)
        found[name] = "\r\n".join(lines).encode(encoding)
    values = np.array(rows)
    columns = dict(zip(HEADER, values.T, strict=True))
    found["table.xlsx"] = workbook(sheet_xml([HEADER, *rows]))
    found["texts.xlsx"] = workbook(sheet_xml([row if k else HEADER for k, row in enumerate(texts)]))
    found["vectors.mat"] = mat(**columns)
    found["structure.mat"] = mat(press=columns, sample_rate_Hz=1000.0, subject="S01")
    found["channels.tdms"] = tdms({name: (column, {}) for name, column in columns.items()})
    return found


@examples(derandomize=True, max_examples=60, database=None, deadline=None)
@given(st.lists(st.lists(NUMBERS, min_size=3, max_size=3), min_size=2, max_size=5))
def test_the_same_table_gives_the_same_numbers(rows: list[list[float]]) -> None:
    for name, content in written(rows).items():
        table = parse_table(content, name, LoadingError)
        assert tuple(table.header) == HEADER, name
        columns = [[float(cell) for cell in column] for column in table.texts([0, 1, 2])]
        assert np.array_equal(columns, np.transpose(rows)), name


def test_curves_and_forces_are_read_from_any_of_them(tmp_path: Path) -> None:
    rows = [[0.0, 0.001, 0.0], [0.1, 0.25, 0.3], [0.2, 1.5, 1.25]]
    for name, content in written(rows).items():
        (tmp_path / name).write_bytes(content)
        curve, force = read_loading_curve(tmp_path / name), read_force_signal(tmp_path / name)
        assert np.array_equal([curve.load, curve.indentation], np.transpose(rows)[1:]), name
        assert np.array_equal([force.time, force.load, force.displacement], np.transpose(rows)), name
        assert read_table(tmp_path / name, LoadingError, head_only=True).header == list(HEADER)


def test_texts_that_list_kinds_of_tables_name_all() -> None:
    root = Path(__file__).parents[1]
    kinds = {suffix[1:].upper() for suffix in TABLE_SUFFIXES - {".tsv"}}
    paths = [path for part in ("src/fingerpad", "docs") for path in (root / part).rglob("*.*")]
    texts = {
        path: " ".join(path.read_text(encoding="utf-8").split()) for path in paths if path.suffix in TEXTS
    }
    lists = [
        (path, text[at.start() - 20 : at.end() + 90])
        for path, text in texts.items()
        for at in re.finditer("XLSX, MAT", text)
    ]
    assert len(lists) >= 10
    assert [(path.name, listed) for path, listed in lists if not all(kind in listed for kind in kinds)] == []


def test_columns_of_a_matrix_are_named_by_their_number(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    path.write_bytes(mat(data=np.array([[1.0, 20.0], [2.0, 30.0]])))
    with pytest.raises(LoadingError, match="no column force_N or displacement_mm; found data column 1, data"):
        read_loading_curve(path)
    curve = read_loading_curve(path, {"force": "data column 1:mN", "displacement": "data column 2:um"})
    assert curve.load.tolist() == [0.001, 0.002]
    assert curve.indentation.tolist() == pytest.approx([0.02, 0.03])


@pytest.mark.parametrize(
    ("style", "found"), [(1, "2023-03-15"), (2, "2023-03-15 06:00:00"), (3, "45000 days,.*")]
)
def test_dates_and_times_do_not_become_numbers(tmp_path: Path, style: int, found: str) -> None:
    path = tmp_path / "a.xlsx"
    path.write_bytes(workbook(sheet_xml([HEADER[1:], [45000 + 0.25 * (style > 1), 1.5]], style)))
    with pytest.raises(LoadingError, match=f"row 2, column 'force_N': '{found}' .* a date or a time in the"):
        read_loading_curve(path)


@pytest.mark.parametrize(
    ("text", "separator", "header"),
    [
        ("force, N;disp, mm\n1;2\n", ";", ["force, N", "disp, mm"]),
        ("force_N;displacement_mm\n0,5;1,5\n", ";", ["force_N", "displacement_mm"]),
        ("a,b\n1,2\n", ",", ["a", "b"]),
        ("a,b;c\n1,2\n3,4\n", ",", ["a", "b;c"]),
        ('"a;b",c\n"1;2",3\n', ",", ["a;b", "c"]),
        ("\n\ufeffa\tb, c\n1\t2\n", "\t", ["\ufeffa", "b, c"]),
        ("a\n1\n", ",", ["a"]),
        ("", ",", []),
    ],
)
def test_separators(text: str, separator: str, header: list[str]) -> None:
    table = parse_table(text, "a.csv", LoadingError)
    assert (table.separator, table.header) == (separator, header)


@pytest.mark.parametrize(
    ("cells", "commas"),
    [
        (["0,5", "1"], True),
        (["0,5", "24.12.2026", "a.b"], True),
        (["0,5", "1.5"], False),
        (["1,234,567"], False),
        (["1.234,5"], False),
        (["left, right"], False),
        (["1", "2"], False),
    ],
)
def test_decimal_commas(cells: list[str], commas: bool) -> None:
    table = parse_table("\n".join(["a;b", *(f"{cell};x" for cell in cells)]), "a.csv", LoadingError)
    assert (table.texts([0]) != [cells]) == commas


def far(last: str) -> bytes:
    """Return a small workbook with a cell far away."""
    cells = f'<row r="1"><c r="A1"><v>1</v></c></row><row r="{last[3:]}"><c r="{last}"><v>2</v></c></row>'
    return workbook(f"<worksheet {MAIN}><sheetData>{cells}</sheetData></worksheet>")


def with_wrong_size(content: bytes, size: int) -> bytes:
    """Return a ZIP that says its sheet is of another size."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        real = archive.getinfo("xl/worksheets/sheet1.xml").file_size
    return content.replace(struct.pack("<I", real), struct.pack("<I", size))


def xlsx_bomb() -> bytes:
    return workbook(sheet_xml([HEADER, [0.0, 0.0, 0.0]]) + " " * 120_000_000)


def mat_bomb() -> bytes:
    packed = zlib.compress(struct.pack("<II", 14, 120_000_000) + bytes(120_000_000))
    return mat(a=[1, 2])[:128] + struct.pack("<II", 15, len(packed)) + packed


NO_MAT = "is no MAT file of version 7 or below"
MANY_TEXTS = sheet_xml([["a"] * 2000]).replace('"inlineStr"><is><t>a</t></is>', '"s"><v>0</v>')
MATLAB_7_3 = b"MATLAB 7.3 MAT-file, Platform".ljust(124) + b"\0\2IM" + bytes(384)
HDF5 = b"\x89HDF\r\n\x1a\n"
ENTITIES = '<!DOCTYPE a [<!ENTITY b "bb">]>' + sheet_xml([HEADER]).partition("?>")[2]
BAD = {
    "bomb.xlsx": (xlsx_bomb, "larger than 100 MB when unpacked: keep only the table"),
    "said_small.xlsx": (lambda: with_wrong_size(xlsx_bomb(), 500), "is no XLSX workbook, or a damaged"),
    "far.xlsx": (lambda: far("XFD1048576"), "has a sheet of 1048576 x 16384 cells"),
    "long_text.xlsx": (
        lambda: workbook(MANY_TEXTS, f"<si><t>{'x' * 1_000_000}</t></si>"),
        "repeats a text of 1000",
    ),
    "parts.xlsx": (
        lambda: workbook(sheet_xml([HEADER]), **{f"xl/x{k}.xml": b"" for k in range(1001)}),
        "has 1008 parts",
    ),
    "entities.xlsx": (lambda: workbook(ENTITIES), "is no XLSX workbook"),
    "cut.xlsx": (lambda: workbook(sheet_xml([HEADER]))[:500], "is no XLSX workbook, or a damaged one"),
    "empty.xlsx": (lambda: workbook(f"<worksheet {MAIN}><sheetData/></worksheet>"), "holds no data"),
    "old.xls": (lambda: b"\xd0\xcf\x11\xe0" + bytes(600), "is an old Excel workbook: save it as XLSX or CSV"),
    "bomb.mat": (mat_bomb, "larger than 100 MB when unpacked: keep only the table"),
    "new.mat": (
        lambda: MATLAB_7_3 + HDF5,
        r"is HDF5, as MATLAB's .* again with save\('curve.mat', ..., '-v7'",
    ),
    "hdf.csv": (lambda: HDF5 + bytes(600), "is HDF5"),
    "none.mat": (lambda: b"", f"{NO_MAT}, or a damaged one"),
    "text.mat": (lambda: b"time_s,force_N\n1,2\n" * 30, NO_MAT),
    "cut.mat": (lambda: mat(force_N=np.arange(900.0))[:400], NO_MAT),
    "words.mat": (lambda: mat(name="S01", rate=5.0, image=np.zeros((99, 99))), "no vectors .*table2struct"),
    "nan.mat": (lambda: mat(force_N=[1, np.nan], displacement_mm=[1, 2]), "row 2, column 'force_N': 'nan'"),
    "zeros.csv": (lambda: b"a\0b", "cannot be read as CSV .holds zero bytes"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_files_are_refused(tmp_path: Path, name: str) -> None:
    make, message = BAD[name]
    (tmp_path / name).write_bytes(make())
    with pytest.raises(LoadingError, match=f"{name}: .*{message}"):
        read_loading_curve(tmp_path / name)


def test_torn_files_are_refused_or_read_but_never_a_traceback(tmp_path: Path) -> None:
    random, outcomes = np.random.default_rng(5), set()
    for name, content in written([[0.0, 0.5, 1.0], [1.0, 2.5, 3.0]]).items():
        for _ in range(40):
            torn = bytearray(content[: random.integers(1, len(content) + 1)])
            torn[random.integers(0, len(torn))] = random.integers(0, 256)
            (tmp_path / name).write_bytes(torn)
            try:
                read_loading_curve(tmp_path / name)
            except LoadingError as error:  # anything else is a fault
                outcomes.add("refused" if name in str(error) else str(error))
            else:
                outcomes.add("read")
    assert outcomes == {"refused", "read"}


def test_channels_of_a_tdms_file_have_their_units_and_their_time(tmp_path: Path) -> None:
    rate = {"wf_increment": 0.5, "wf_start_offset": 0.25}
    channels = {
        "Force": ([100.0, 200.0, 300.0], {"unit_string": "mN", **rate}),
        "Displacement": ([1.0, 2.0, 3.0], {"unit_string": "um", **rate}),
        "Operator": (["a", "b", "c"], {}),
    }
    (tmp_path / "a.tdms").write_bytes(tdms(channels))
    curve = read_loading_curve(tmp_path / "a.tdms")
    assert curve.time is not None
    found, expected = [curve.time, curve.load, curve.indentation], [[0.25, 0.75, 1.25], [0.1, 0.2, 0.3]]
    assert np.allclose(found, [*expected, [0.001, 0.002, 0.003]])


def test_a_damaged_tdms_file_is_refused_in_words() -> None:
    content = tdms({name: (np.arange(50.0).tolist(), {"unit_string": "N"}) for name in HEADER})
    rng = np.random.default_rng(3)
    for _ in range(200):
        torn = bytearray(content)
        torn[int(rng.integers(4, 150))] ^= 1 << int(rng.integers(8))
        with suppress(LoadingError):  # anything else is a fault
            list(parse_table(bytes(torn), "a.tdms", LoadingError).rows)
    with pytest.raises(LoadingError, match=r"a.tdms: holds no channels of numbers"):
        parse_table(tdms({"Operator": (["a", "b"], {})}), "a.tdms", LoadingError)
    with (
        patch.object(_tables, "_MOST_CELLS", 100),
        pytest.raises(LoadingError, match=r"a.tdms: says that it holds 150 values: keep only"),
    ):
        parse_table(content, "a.tdms", LoadingError)


@pytest.mark.parametrize(
    ("name", "content", "package"),
    [("a.tdms", b"TDSm", "npTDMS"), ("a.xlsx", workbook(sheet_xml([HEADER])), "python-calamine")],
)
def test_a_file_without_its_reader_says_what_to_install(name: str, content: bytes, package: str) -> None:
    words = rf"{name}: reading {name[2:].upper()} needs {package}: pip install 'fingerpad"
    with (
        patch.dict("sys.modules", {"nptdms": None, "python_calamine": None}),
        pytest.raises(LoadingError, match=words),
    ):
        parse_table(content, name, LoadingError)


def test_the_only_sheet_with_the_columns_is_read_and_a_sheet_without_is_named(tmp_path: Path) -> None:
    notes, data = sheet_xml([["operator", "Ann"]]), sheet_xml([HEADER, [0.0, 1.0, 2.0]])
    path = tmp_path / "press.xlsx"

    def write(first: str, second: str) -> None:
        path.write_bytes(workbook(first, **{"xl/worksheets/sheet2.xml": second.encode()}))

    for sheets in ((notes, data), (data, notes), (data, data)):
        write(*sheets)
        assert read_loading_curve(path).load.tolist() == [1.0]
    write(sheet_xml([["operator", "day"], ["Ann", "Monday"]]), notes)
    with pytest.raises(LoadingError, match="sheet 'A'"):
        read_loading_curve(path)
