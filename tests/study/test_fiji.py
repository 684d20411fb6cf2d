"""Ellipses of known truth, as Fiji's table and ROIs have them, and what the command makes of them."""

import json
import math
import struct
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from roifile import ROI_OPTIONS, ROI_SUBTYPE, ROI_TYPE, ImagejRoi
from skimage.measure import find_contours, regionprops
from tests import command
from tests.studies import finger, write_study
from tests.workbooks import zipped

from fingerpad.exceptions import CalibrationError, FingerpadError, ImageError, ManifestError
from fingerpad.image import ellipse_of_polygon
from fingerpad.study.imports.ellipses import (
    FIELDS,
    ManualObservation,
    MeasuredEllipse,
    manual_observations,
    write_observations,
)
from fingerpad.study.imports.fiji import read_results_table, read_rois
from fingerpad.study.manifest.sheet import Sheet
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.table import record_at

SEMI_MAJOR, SEMI_MINOR = 146.0, 98.0  # px; 7.4 and 5.0 mm at 500 ppi
PX_MM = 25.4 / 500


def ellipse_mask(tilt_deg: float) -> np.ndarray:
    """Return an ellipse whose long axis is `tilt_deg` counter-clockwise from straight up."""
    rows, columns = np.mgrid[:400, :400] - 199.5
    up, left = -rows, -columns
    tilt = math.radians(tilt_deg)
    along = up * math.cos(tilt) + left * math.sin(tilt)
    across = -up * math.sin(tilt) + left * math.cos(tilt)
    return (along / SEMI_MAJOR) ** 2 + (across / SEMI_MINOR) ** 2 <= 1


def fiji_row(mask: np.ndarray, per_px: float = 1.0) -> dict[str, float]:
    """Return what ImageJ's EllipseFitter gives: moments' axes scaled to the area; angle from level."""
    (region,) = regionprops(mask.astype(int))
    ratio = math.sqrt(region.area / (math.pi / 4 * region.axis_major_length * region.axis_minor_length))
    return {
        "Area": region.area * per_px**2,
        "Major": region.axis_major_length * ratio * per_px,
        "Minor": region.axis_minor_length * ratio * per_px,
        "Angle": (math.degrees(region.orientation) + 90) % 180,  # skimage's is from the row axis, as ours
    }


def as_table(rows: list[dict[str, object]], separator: str = ",", decimal: str = ".") -> str:
    lines = [separator.join([" ", *rows[0]])]
    for number, row in enumerate(rows, start=1):
        cells = (
            f"{value:.3f}".replace(".", decimal) if isinstance(value, float) else str(value)
            for value in row.values()
        )
        lines.append(separator.join([str(number), *cells]))
    return "\n".join(lines) + "\n"


def table(folder: Path, text: str, name: str = "Results.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("tilt", [-80.0, 20.0, 90.0])
def test_a_table_in_px_gives_the_ellipse_that_was_drawn(tmp_path, tilt):
    row = {"Label": "print.tif", **fiji_row(ellipse_mask(tilt)), "Slice": 1}
    (found,) = read_results_table(table(tmp_path, as_table([row])))
    assert_allclose([found.semi_major, found.semi_minor], [SEMI_MAJOR, SEMI_MINOR], rtol=2e-3)
    assert abs((found.orientation_deg - tilt + 90) % 180 - 90) < 0.2
    assert found.doubts == ()


@pytest.mark.parametrize(("separator", "decimal"), [(",", "."), ("\t", ","), (";", ",")])
def test_any_separator_and_decimal_reads_the_same(tmp_path, separator, decimal):
    row = {"Label": "a", **fiji_row(ellipse_mask(10), PX_MM)}
    for encoding in ("utf-8", "utf-8-sig", "cp1252"):
        path = tmp_path / f"Results_{encoding}.xls"
        path.write_text(as_table([{**row, "Mean µ": 1.0}], separator, decimal), encoding=encoding)
        (found,) = read_results_table(path)
        assert_allclose([2 * found.semi_major, 2 * found.semi_minor], [row["Major"], row["Minor"]], atol=1e-3)


def test_rows_of_summarize_are_left_out(tmp_path):
    rows = [{"Label": f"p{n}", "Major": 14.0 + n, "Minor": 10.0} for n in range(3)]
    ends = [{"Label": name, "Major": 0.5, "Minor": 1.0} for name in ("Mean", "SD", "Min", "Max")]
    found = read_results_table(table(tmp_path, as_table(rows + ends)))
    assert [ellipse.label for ellipse in found] == ["p0", "p1", "p2"]
    assert {ellipse.orientation_deg for ellipse in found} == {None}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "no column Major and Minor; found none"),
        (" ,Label,Area\n1,a,3\n", "no column Major and Minor; found Label, Area.*Set Measurements > Fit"),
        (" ,Major,Minor\n1,NaN,3\n", "line 2: column Major: expected a number, found 'NaN'"),
        (" ,Major,Minor\n1,0,0\n", "a line or a point has none"),
        (" ,Major,Minor\n1,9,12\n", "Major 9 and Minor 12 are no full axes"),
        (" ,Major,Minor\n1,14,8,10,0\n", "line 2 has 5 cells under 3 headers: decimal commas need"),
        (" ,Area,Major,Minor\n1,116.24,7.4,5.0\n", "these are semi-axes; Fiji writes full axes"),
        ("PK\x03\x04 \x00", "is no XLSX workbook, or a damaged one: save it as CSV"),
    ],
)
def test_tables_that_are_none_are_refused(tmp_path, content, message):
    with pytest.raises(ManifestError, match=message):
        read_results_table(table(tmp_path, content))


def test_an_area_that_is_not_the_ellipse_s_is_doubted(tmp_path):
    (found,) = read_results_table(table(tmp_path, " ,Area,Major,Minor\n1,80,14.8,10\n"))
    assert "Area is 0.69 of the ellipse's" in found.doubts[0]


# ROIs


def oval(left: float, top: float, width: float, height: float, *, subpixel: bool = False) -> bytes:
    roi = ImagejRoi()
    roi.roitype, roi.name = ROI_TYPE.OVAL, "drawn"
    roi.left, roi.top, roi.right, roi.bottom = map(round, (left, top, left + width, top + height))
    if subpixel:
        roi.version, roi.options = 227, ROI_OPTIONS.SUB_PIXEL_RESOLUTION
        roi.xd, roi.yd, roi.widthd, roi.heightd = left, top, width, height
    return roi.tobytes()


def tilted(tilt_deg: float, ratio: float = SEMI_MINOR / SEMI_MAJOR) -> bytes:
    """Return an ellipse as ImageJ's EllipseRoi writes it: ends of the major axis and a float at byte 52."""
    tilt = math.radians(tilt_deg)
    half = SEMI_MAJOR * np.array([math.sin(tilt), math.cos(tilt)])  # (left, up)
    content = bytearray(ImagejRoi(roitype=ROI_TYPE.FREEHAND, subtype=ROI_SUBTYPE.ELLIPSE).tobytes())
    content[4:6] = struct.pack(">h", 227)
    content[18:34] = struct.pack(">ffff", 200 - half[0], 200 - half[1], 200 + half[0], 200 + half[1])
    content[48:50] = struct.pack(">h", int(ROI_SUBTYPE.ELLIPSE))
    content[52:56] = struct.pack(">f", ratio)
    return bytes(content)


def traced(tilt_deg: float) -> bytes:
    (contour,) = find_contours(ellipse_mask(tilt_deg).astype(float), 0.5)
    return ImagejRoi.frompoints((contour[:, ::-1] + 0.5).astype(np.float32), name="by hand").tobytes()


def roi_file(folder: Path, content: bytes, name: str = "a.roi") -> Path:
    (folder / name).write_bytes(content)
    return folder / name


@pytest.mark.parametrize("make", [tilted, traced])
@pytest.mark.parametrize("tilt", [-80.0, 20.0, 90.0])
def test_tilted_and_traced_rois_give_the_ellipse_that_was_drawn(tmp_path, make, tilt):
    (found,) = read_rois(roi_file(tmp_path, make(tilt)))
    assert_allclose([found.semi_major, found.semi_minor], [SEMI_MAJOR, SEMI_MINOR], rtol=4e-3)
    assert abs((found.orientation_deg - tilt + 90) % 180 - 90) < 0.2


def test_ovals_are_upright_or_lying(tmp_path):
    (lying,) = read_rois(roi_file(tmp_path, oval(10, 20, 292, 196)))
    assert (lying.label, lying.semi_major, lying.semi_minor) == ("drawn", 146, 98)
    assert lying.orientation_deg == 90
    (upright,) = read_rois(roi_file(tmp_path, oval(10.25, 20.5, 196.5, 292.25, subpixel=True)))
    assert (upright.semi_major, upright.semi_minor, upright.orientation_deg) == (146.125, 98.25, 0)


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        ("abc", "must be numeric, found 'abc'"),
        ([(0, 0), (1, 1)], "three corners or more"),
        ([(0, 0), (1, np.nan), (2, 2)], "all finite"),
        ([(0, 0), (1, 1), (2, 2)], "encloses no area"),
        ([(0, 0), (10, 10), (10, 0), (0, 9)], "crosses itself"),
    ],
)
def test_outlines_that_are_none_are_refused(corners, message):
    with pytest.raises(ImageError, match=message):
        ellipse_of_polygon(corners)


def roi_set(folder: Path, members: dict[str, bytes]) -> Path:
    path = folder / "RoiSet.zip"
    path.write_bytes(zipped(members))
    return path


def test_a_set_of_rois_is_read_in_order(tmp_path):
    path = roi_set(tmp_path, {"b.roi": tilted(0), "a.roi": tilted(90), "c.roi": oval(0, 0, 8, 6)})
    found = read_rois(path)
    assert [ellipse.label for ellipse in found] == ["b", "a", "drawn"]
    assert [ellipse.source for ellipse in found] == [f"RoiSet.zip, {name}.roi" for name in "bac"]


@pytest.mark.parametrize(
    ("members", "message"),
    [
        ({"..\\evil.roi": b""}, "with a folder in its name"),
        ({"notes.txt": b""}, "'notes.txt', which is no ROI"),
        ({"a.roi": b"Iout"}, "RoiSet.zip, a.roi: is no ROI of ImageJ"),
        ({"a.roi": b"\0" * 17_000_000}, "would be 17000000 bytes"),
        ({"a.roi": oval(5, 5, 0, 7)}, "an oval of 0 × 7 px has no area"),
        ({"a.roi": tilted(0, ratio=float("nan"))}, "axis ratio nan"),
        ({"a.roi": ImagejRoi(roitype=ROI_TYPE.RECT, right=9, bottom=9).tobytes()}, "is a rect, not an oval"),
        ({}, "holds no ROIs"),
    ],
)
def test_sets_that_are_none_are_refused(tmp_path, members, message):
    with pytest.raises(ImageError, match=message):
        read_rois(roi_set(tmp_path, members))
    assert [path.name for path in tmp_path.iterdir()] == ["RoiSet.zip"]  # nothing is unpacked


def test_broken_zips_and_lost_files_are_refused(tmp_path):
    with pytest.raises(ImageError, match="cannot be read as a zip of ROIs"):
        read_rois(roi_file(tmp_path, b"no zip", "RoiSet.zip"))
    whole = roi_set(tmp_path, {"a.roi": tilted(0) * 50}).read_bytes()
    with pytest.raises(ImageError):
        read_rois(roi_file(tmp_path, whole[:60] + b"\xff" * 20 + whole[80:], "torn.zip"))
    for name in ("lost.zip", "lost.roi"):
        with pytest.raises(ImageError, match="cannot be read"):
            read_rois(tmp_path / name)


def test_any_torn_roi_is_refused_or_read_but_never_a_traceback(tmp_path):
    random, outcomes = np.random.default_rng(7), set()
    for whole in (tilted(20), traced(20), oval(0, 0, 8, 6)):
        for _ in range(50):
            torn = bytearray(whole[: random.integers(1, len(whole) + 1)])
            torn[random.integers(0, len(torn))] = random.integers(0, 256)
            path = roi_file(tmp_path, bytes(torn))
            try:
                (found,) = read_rois(path)
            except ImageError as error:  # anything else is a fault
                outcomes.add("refused" if path.name in str(error) else str(error))
            else:
                assert np.isfinite([found.semi_major, found.semi_minor]).all()
                assert found.semi_major >= found.semi_minor > 0
                outcomes.add("read")
    assert outcomes == {"refused", "read"}


# From the command line


cli, printed = (partial(one, "import", "fiji") for one in (command.run, command.printed))


def study_of(folder: Path) -> Path:
    """Write a study of one finger, whose observations stand in the CSV that the command writes."""
    return write_study(folder, finger("index"), observations_csv="observations.csv")


def test_from_fiji_to_results(tmp_path):
    labels = ("index_30deg_2N.tif", "index_45deg_0p5N.tif")
    rows = [{"Label": label, **fiji_row(ellipse_mask(10))} for label in labels]
    results = table(tmp_path, as_table(rows))
    study = study_of(tmp_path)
    out = tmp_path / "observations.csv"
    pattern = "{finger}_{wedge}deg_{load}N"
    code, said, error = cli(results, "--ppi", 500, "--std-mm", 0.1, "--label-pattern", pattern, "--out", out)
    assert (code, error) == (0, "")
    assert 'observations_csv = "observations.csv"' in said
    assert "Fill in" not in said
    written = run_study(study, tmp_path / "out").rows
    assert written["measured_by"].tolist() == ["manual", "manual"]
    assert written["load_N"].tolist() == [2.0, 0.5]
    assert written["semi_major_mm"].tolist() == pytest.approx([SEMI_MAJOR * PX_MM] * 2, rel=2e-3)
    assert written["long_axis"].tolist() == ["along"] * 2
    assert written["semi_major_mm_std"].tolist() == [0.1] * 2


def test_what_is_not_known_is_left_to_a_person(tmp_path):
    results = table(tmp_path, as_table([{"Label": "b.tif", "Major": 14.8, "Minor": 10.0}]))
    study, out = study_of(tmp_path), tmp_path / "observations.csv"
    words = (results, "--unit", "mm", "--std-mm", 0.1, "--finger", "index", "--out", out)
    said = printed(*words)
    assert "Fill in wedge_angle_deg, load_N for 1 of them: b\n" in said
    with pytest.raises(ManifestError, match="observations.csv, line 2: wedge_angle_deg: required"):
        run_study(study, tmp_path / "out")
    filled = out.read_text(encoding="utf-8").replace("b,index,,,", "b,index,30,2,")
    out.write_text(filled, encoding="utf-8")
    code, _, error = cli(*words)
    assert (code, "is there already" in error) == (2, True)
    assert out.read_text(encoding="utf-8") == filled
    assert record_at(run_study(study, tmp_path / "out").rows)["load_N"] == 2


def test_units_are_asked_for_and_agree(tmp_path):
    sizes = {"px.csv": 1, "um.csv": 50}
    in_px, in_um = (
        table(tmp_path, as_table([{"Label": "a", "Major": 296.0 * size, "Minor": 200.0 * size}]), name)
        for name, size in sizes.items()
    )
    rois, bad = roi_set(tmp_path, {"a.roi": tilted(0)}), tmp_path / "bad.csv"
    common = ("--std-mm", 0.1, "--json", "--out")
    for number, arguments in enumerate([(in_px, "--mm-per-px", 0.05), (in_um, "--unit", "um")]):
        said = printed(*arguments, *common, tmp_path / f"{number}.csv")
        assert json.loads(said)[0]["semi_major_mm"] == pytest.approx(7.4)
    for arguments, message in [
        ((in_px,), "Fiji's files name no unit: for lengths in px give either --ppi"),
        ((in_px, "--unit", "mm"), "the scale (Fiji measures in px until a scale is set)"),
        ((in_um, "--unit", "ell"), "--unit takes mm, um, µm, cm, inch, found 'ell'"),
        ((in_um, "--unit", "um", "--ppi", 500), "found a scale beside it"),
        ((rois, "--unit", "mm"), "RoiSet.zip, which is in px"),
        ((in_px, in_px, "--ppi", 500), "px.csv: is named twice"),
        ((tmp_path / "lost.csv", "--unit", "mm"), "lost.csv: no such file"),
    ]:
        code, _, error = cli(*arguments, *common, bad)
        assert (code, error.count("\n")) == (2, 1)
        assert message in error
    assert cli(in_px, "--ppi", 500)[0] == 2  # no uncertainty
    assert not bad.exists()


# Ellipses that any program measured become observations of a study


def ellipse(label: str = "a", semi_major: float = 7.4, semi_minor: float = 5.0, **more: object):
    given = {"source": "t, line 2", "orientation_deg": 0.0, **more}
    return MeasuredEllipse(label=label, semi_major=semi_major, semi_minor=semi_minor, **given)


def observations(*ellipses: MeasuredEllipse, **given: object) -> list[ManualObservation]:
    return manual_observations(ellipses, **{"mm_per_unit": 1, "semi_axis_mm_std": 0.1, **given})


@pytest.mark.parametrize(
    ("pattern", "label", "reported"),
    [
        ("{finger}_{wedge}deg*", "left_ring_4.5deg_x", {"finger": "left_ring", "wedge_angle_deg": 4.5}),
        ("{person}_{finger}_{load}mN", "S1_LI_500mN.TIF:0012", {"finger": "S1_left_index", "load_N": 0.5}),
        ("*_{load}N", "stack.x_0p25N", {"load_N": 0.25}),
        ("{load}N*roll{roll}", "1,5N_xx_roll-10", {"load_N": 1.5, "roll_angle_deg": -10}),
        ("{load} N (a+b)", "2 N (a+b)", {"load_N": 2}),
    ],
)
def test_labels_tell_what_the_pattern_says(pattern, label, reported):
    found = observations(ellipse(label), ellipse("other"), pattern=pattern)
    stated = {"include": {*FIELDS}, "exclude_none": True}
    assert [row.model_dump(**stated) for row in found] == [reported, {}]
    (row,) = observations(ellipse("S7"), pattern="{person}", known={"finger": "index"})
    assert row.model_dump(**stated) == {"finger": "S7_index"}


@pytest.mark.parametrize(
    ("orientation", "finger_axis", "long_axis"),
    [
        (0, 0, "along"), (90, 0, "across"), (-80, 0, "across"), (80, 90, "along"), (-80, 90, "along"),
        (10, 90, "across"), (None, 0, None),
    ],
)  # fmt: skip
def test_the_long_axis_is_told_from_the_finger(orientation, finger_axis, long_axis):
    (row,) = observations(ellipse(orientation_deg=orientation), finger_axis_deg=finger_axis)
    assert row.long_axis == long_axis


def test_an_uncertain_scale_stands_beside_the_axes():
    given = {"mm_per_unit": 0.05, "semi_axis_mm_std": 0.3}
    (row,) = observations(ellipse("a", 100, 100), relative_scale_std=0.08, **given)
    assert (row.semi_major_mm, row.ellipse_mm_std) == pytest.approx((5.0, 0.3))
    assert (row.mm_per_px, row.scale_relative_std) == (0.05, 0.08)
    (exact,) = observations(ellipse("a", 100, 100), **given)
    assert (exact.mm_per_px, exact.scale_relative_std) == (None, None)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"pattern": "{face}"}, "{face} is unknown: a pattern holds {person}, {finger}, {wedge}, {roll}"),
        ({"pattern": "{load}_{load}"}, "{load} stands twice"),
        ({"pattern": "{finger}_{load}N"}, "fits no label, such as '2N'.* only hand and digit"),
        ({"pattern": "{load}N", "known": {"load_N": 2}}, "load_N is given for all"),
        ({"semi_axis_mm_std": 0}, "must be positive, found 0 mm"),
        ({"finger_axis_deg": math.nan}, "finger_axis_deg must be a finite number"),
        ({"known": {"load_N": -1}}, "line 2: load_N: expected greater than 0, found -1"),
        (
            {"mm_per_unit": 25.4, "unit_hint": "it measures in px"},
            r"line 2: a semi-major axis of 188 mm is none .* scale \(it measures in px\)$",
        ),
    ],
)
def test_what_cannot_be_meant_is_refused(changed, message):
    error = CalibrationError if "mm_per_unit" in changed else ManifestError
    with pytest.raises(error, match=message):
        observations(ellipse("2N"), **changed)


def test_names_are_such_as_a_manifest_takes_and_never_the_same(tmp_path):
    labels = ["a b/c.tif:0001-0203", "A B C.TIF:0001-0203", "", "../.."]
    labels += ["ж" * 90, "ж" * 80, "a.tif", "a", "a_2"]
    known = {"finger": "index", "wedge_angle_deg": 30.0, "load_N": 2.0}
    write_observations(tmp_path / "o.csv", observations(*map(ellipse, labels), known=known))
    rows = Sheet("o.csv", (tmp_path / "o.csv").read_bytes()).tables()
    names = [content["name"] for _, content, _ in rows]
    assert names[:2] == ["a_b_c_0001-0203", "A_B_C_0001-0203_2"]
    assert len({name.casefold() for name in names}) == len(labels)
    with pytest.raises(FingerpadError, match="o.csv: cannot be written"):
        write_observations(tmp_path / "nowhere" / "o.csv", [])
