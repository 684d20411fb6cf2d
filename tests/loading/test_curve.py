"""Reading loading curves, and what is said of files that cannot be read."""

from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from fingerpad.exceptions import LoadingError
from fingerpad.loading import LoadingCurve, read_loading_curve


def write(folder: Path, text: str) -> Path:
    path = folder / "curve.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_units_from_header(tmp_path: Path) -> None:
    path = write(tmp_path, "area_cm2,time_s,force_mN,displacement_um\n0.5,0,100,20\n1,1,2000,1500\n")
    curve = read_loading_curve(path)
    assert_allclose(curve.load, [0.1, 2.0])
    assert_allclose(curve.indentation, [0.02, 1.5])
    assert_allclose(curve.area, [50.0, 100.0])


def test_area_optional(tmp_path: Path) -> None:
    assert read_loading_curve(write(tmp_path, "force_N,displacement_mm\n1,2\n")).area is None


def test_noise_may_make_areas_negative() -> None:
    area = [-0.4, 0.3, 5.0]
    assert LoadingCurve(load=[0, 0, 1], indentation=[0, 1, 2], area=area).area.tolist() == area


def test_columns_can_be_named(tmp_path: Path) -> None:
    path = write(tmp_path, "\ufeffFz,stage position\n500,3\n")
    curve = read_loading_curve(path, {"force": "Fz:mN", "displacement": "stage position:mm"})
    assert_allclose([curve.load[0], curve.indentation[0]], [0.5, 3.0])


def test_a_column_of_no_such_quantity_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, "force_N,Fz_N,displacement_mm\n1,10,3\n")
    with pytest.raises(LoadingError, match="no quantity 'load'; there are force, displacement, area, time"):
        read_loading_curve(path, {"load": "Fz_N:N"})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no data"),
        ("force_N,displacement_mm\n", "holds no data"),
        ("force_N,area_mm2\n1,2\n", "no column displacement_mm; found force_N, area_mm2"),
        ("load,displacement_mm\n1,2\n", "no column force_N; found load, displacement_mm"),
        ("force_lb,displacement_mm\n1,2\n", "column 'force_lb' has unit 'lb'; force is read in N, mN"),
        ("force_N,displacement_kPa\n1,2\n", "column 'displacement_kPa' has unit 'kPa'"),
        ("force_N,displacement_mm\n1,2\nx,3\n", "line 3, column 'force_N': 'x' is not a finite number"),
        ("force_N,displacement_mm\n1,nan\n", "line 2, column 'displacement_mm': 'nan' is not a finite"),
        ("force_N,displacement_mm\n1,2\n\n5\n", "line 4, column 'displacement_mm': '' is not a finite"),
    ],
)
def test_error_messages(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(LoadingError, match=message) as caught:
        read_loading_curve(write(tmp_path, text))
    assert "curve.csv" in str(caught.value)


def test_unreadable_files(tmp_path: Path) -> None:
    with pytest.raises(LoadingError, match=r"none\.csv: no such file: check the path"):
        read_loading_curve(tmp_path / "none.csv")
    (tmp_path / "curve.csv").write_bytes(b"\xff\xfe\x00force")
    with pytest.raises(LoadingError, match="cannot be read as CSV"):
        read_loading_curve(tmp_path / "curve.csv")
    path = write(tmp_path, "force_N,displacement_mm\n1,2\n")
    with pytest.raises(LoadingError, match="no column 'Fz' for force"):
        read_loading_curve(path, {"force": "Fz:N"})
    with pytest.raises(LoadingError, match="has unit 'stone'"):
        read_loading_curve(path, {"force": "force_N:stone"})
