"""Reading loading curves, and what is said of files that cannot be read."""

import pickle
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fingerpad._columns import ColumnsError
from fingerpad.exceptions import LoadingError
from fingerpad.loading import read_loading_curve
from fingerpad.loading.curve import unread_curve_columns


def write(folder: Path, text: str) -> Path:
    path = folder / "curve.csv"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("header", "rows"),
    [
        ("gross_area_cm2,time_s,force_mN,displacement_um", "0.05,0,100,20\n0.6,1,2000,1500"),
        ("time_s\tforce_N\tdisplacement_mm\tarea_mm2", "0\t0,1\t0,02\t5\n1\t2\t1,5\t60"),
        ("Time (s),Force (mN),Disp [um],Area (mm^2)", "0,100,20,5\n1,2000,1500,60"),
        ("Time / ms,Load / mN,Displacement / μm,Contact area / mm²", "0,100,20,5\n1000,2000,1500,60"),
        ("Time/s;Force/N;Disp/µm;Area/cm2", "0;0,1;20;0,05\n1;2;1500;0,6"),
        ("t_s,load_mN,indentation_um,contact_area_mm2", "0,100,20,5\n1,2000,1500,60"),
        ("Time (sec),Normal force (mN),Displ (µm),area mm2", "0,100,20,5\n1,2000,1500,60"),
        ("Prüfzeit (s);Standardkraft (N);Weg (mm);Fläche (mm²)", "0;0,1;0,02;5\n1;2;1,5;60"),
        ("Temps [s];Charge [N];Déplacement [mm];Aire [mm²]", "0;0,1;0,02;5\n1;2;1,5;60"),
        ("Time\tForce\tDisplacement\tArea\n[s]\t[N]\t[mm]\t[mm²]", "0\t0,1\t0,02\t5\n1\t2\t1,5\t60"),
        (
            "Time,Compressive extension,Compressive load,Area\n(s),(mm),(N),(mm2)",
            '"0","0.02","0.1","5"\n"1","1.5","2","60"',
        ),
        ("time in s,load in mN,disp in mm,area in cm2,Force (V)", "0,100,0.02,0.05,7\n1,2000,1.5,0.6,8"),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252"])
def test_headers_as_instruments_write_them(tmp_path: Path, header: str, rows: str, encoding: str) -> None:
    path = tmp_path / "curve.csv"
    if encoding == "cp1252":
        header = header.replace("μ", "µ")  # a Greek letter is not in that code
    path.write_text(f"{header}\n{rows}\n", encoding=encoding)
    curve = read_loading_curve(path)
    assert_allclose(curve.load, [0.1, 2.0])
    assert_allclose(curve.indentation, [0.02, 1.5])
    assert curve.area is not None
    assert curve.time is not None
    assert_allclose(curve.area, [5.0, 60.0])
    assert_allclose(curve.time, [0.0, 1.0])


def test_areas_of_some_rows(tmp_path: Path) -> None:
    path = write(tmp_path, "force_N;displacement_mm;area_cm2\n1,5;2;0,5\n2;3;\n3;4;NaN\n")
    assert_array_equal(read_loading_curve(path).area, [50, np.nan, np.nan])


def test_of_two_columns_that_may_be_the_force_none_is_chosen(tmp_path: Path) -> None:
    path = write(tmp_path, "Force (N),Load (mN),displacement_mm\n1,2,3\n")
    with pytest.raises(ColumnsError, match=r"Force \(N\) and Load \(mN\) may each be the force") as caught:
        read_loading_curve(path)
    assert caught.value.proposed == {"force": ["Force (N):N", "Load (mN):mN"]}
    assert str(caught.value).endswith('columns={"force": "Force (N):N"} or columns={"force": "Load (mN):mN"}')
    assert read_loading_curve(path, {"force": "Load (mN):mN"}).load[0] == 2e-3
    with pytest.raises(LoadingError, match="2 columns are called force_N: rename one"):
        read_loading_curve(write(tmp_path, "force_N,force_N,displacement_mm\n1,2,3\n"))


def test_a_column_that_is_no_force_is_none(tmp_path: Path) -> None:
    path = write(tmp_path, "load cell,load_cell,force_N,disp_V,displacement_mm\n7,8,1,9,2\n")
    assert (read_loading_curve(path).load[0], read_loading_curve(path).indentation[0]) == (1, 2)


@pytest.mark.parametrize(
    ("header", "proposed"),
    [
        ("Fz (mN),Hub (um)", {"force": ["Fz (mN):mN"], "displacement": ["Hub (um):um"]}),
        ("F1 in mN,Hub in µm", {"force": ["F1 in mN:mN"], "displacement": ["Hub in µm:um"]}),
        ("force,displacement_mm", {"force": ["force:UNIT"]}),
        ("a,b", {"force": ["HEADER:UNIT"], "displacement": ["HEADER:UNIT"]}),
        ("Fx (N),Fz (N),displacement_mm", {"force": ["Fx (N):N", "Fz (N):N"]}),
    ],
)
def test_a_refusal_proposes_columns(tmp_path: Path, header: str, proposed: dict[str, list[str]]) -> None:
    path = write(tmp_path, f"{header}\n{','.join('1' * (header.count(',') + 1))}\n")
    with pytest.raises(ColumnsError) as caught:
        read_loading_curve(path)
    assert caught.value.proposed == proposed
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    columns = {name: choices[0] for name, choices in proposed.items()}
    if not any(column.endswith("UNIT") for column in columns.values()):
        assert read_loading_curve(path, columns).load[0] in {1, 1e-3}


def test_what_is_proposed_keeps_what_is_given(tmp_path: Path) -> None:
    path = write(tmp_path, "stage,Fz (mN)\n1,2\n")
    with pytest.raises(ColumnsError, match=r'columns={"displacement": "stage:mm", "force": "Fz \(mN\):mN"}'):
        read_loading_curve(path, {"displacement": "stage:mm"})


@pytest.mark.parametrize(
    ("header", "unread"),
    [
        ("force_N,displacement_mm,aera_mm2", {"area": ["aera_mm2:mm2"]}),
        ("force_N,displacement_mm,Contact (cm2)", {"area": ["Contact (cm2):cm2"]}),
        ("force_N,displacement_mm,area", {"area": ["area:UNIT"]}),
        ("force_N,displacement_mm,A1 (mm²),A2 (mm²)", {"area": ["A1 (mm²):mm2", "A2 (mm²):mm2"]}),
        ("force_N,displacement_mm,temperature_C", {}),
        ("force_N,displacement_mm,area_mm2,aera_mm2", {}),
    ],
)
def test_columns_that_look_like_what_is_missing(
    tmp_path: Path, header: str, unread: dict[str, list[str]]
) -> None:
    path = write(tmp_path, f"{header}\n{','.join('1' * (header.count(',') + 1))}\n")
    assert unread_curve_columns(path) == unread


@pytest.mark.parametrize(
    ("header", "unit"),
    [("Force (mN)", "N"), ("Fz / mN", "N"), ("force_mN", "N"), ("Normal load [N]", "gf"), ("Load mN", "N")],
)
def test_a_unit_that_contradicts_the_header_is_refused(tmp_path: Path, header: str, unit: str) -> None:
    path = write(tmp_path, f"{header},displacement_mm\n1,2\n")
    own = "N" if header.endswith("[N]") else "mN"
    with pytest.raises(ColumnsError) as caught:
        read_loading_curve(path, {"force": f"{header}:{unit}"})
    message = str(caught.value)
    assert f"column '{header}' says {own}, and its unit is given as {unit}: rename columns" in message
    assert message.endswith(f'columns={{"force": "{header}:{own}"}}')
    ((proposed,),) = caught.value.proposed.values()
    assert read_loading_curve(path, {"force": proposed}).load[0] == (1 if own == "N" else 1e-3)


def test_grams_of_a_force_are_grams_force(tmp_path: Path) -> None:
    curve = read_loading_curve(write(tmp_path, "Load (g),displacement_mm\n0,0\n100,2\n"))
    assert curve.load[-1] == pytest.approx(0.980665)


def test_a_unit_is_given_where_the_header_states_none_or_the_same(tmp_path: Path) -> None:
    path = write(tmp_path, "\ufeffKanal_N,disp (µm)\n1,2\n")  # N may number the channel
    assert read_loading_curve(path, {"force": "Kanal_N:mN", "displacement": "disp (µm):um"}).load[0] == 1e-3


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"force": "Fz:N"}, "no column 'Fz' for force"),
        ({"force": "force_N:stone"}, "has unit 'stone'"),
        ({"load": "force_N:N"}, "no quantity 'load'; there are force, displacement, area, time"),
    ],
)
def test_columns_that_are_none_are_refused(tmp_path: Path, columns: dict[str, str], message: str) -> None:
    path = write(tmp_path, "force_N,displacement_mm\n1,2\n")
    with pytest.raises(LoadingError, match=message):
        read_loading_curve(path, columns)
    with pytest.raises(LoadingError, match=r"none\.csv: no such file: check the path"):
        read_loading_curve(tmp_path / "none.csv", columns)


TWO_WAYS = "decimal commas need semicolons or tabs between cells"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no data"),
        ("force_N,area_mm2\n1,2\n", "no column displacement_mm; found force_N, area_mm2"),
        ("force_N,displacement_mm\n1,2\nx,3\n", "line 3, column 'force_N': 'x' is not a finite number"),
        ("force_N,displacement_mm,area_mm2\n1,2,\n2,3,\n", "'area_mm2' is empty: leave the column out"),
        (
            "Instrument\nOperator: me\nforce_N,displacement_mm\n1,2\n",
            "line 3 has 2 cells under 1 headers: if line 3 is the header, delete the lines above it",
        ),
        ("force_N,displacement_mm\n1,2\n,3\n", "'' is not a finite number: fill it in, or leave out the row"),
        ("Load (lbf),displacement_mm\n1,2\n", r"'Load \(lbf\)' has unit 'lbf'; force is read in N, mN"),
        ("force_N,displacement_mm\n0,25,1,5\n", f"line 2.*{TWO_WAYS}"),
        ('force_N,displacement_mm\n"0,25","1,5"\n', f"line 2.*{TWO_WAYS}"),
        ("force_N;displacement_mm\n1.5;1\n1,234;2\n", f"line 3.*{TWO_WAYS}"),
        ("force_N;displacement_mm\n1,5;1.234\n", f"line 2.*{TWO_WAYS}"),  # thousands, or decimals elsewhere
        ("force_N,displacement_mm\n1,2\n\n5\n", "line 4, column 'displacement_mm': '' is not a finite"),
    ],
)
def test_error_messages(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(LoadingError, match=message) as caught:
        read_loading_curve(write(tmp_path, text))
    assert "curve.csv" in str(caught.value)
