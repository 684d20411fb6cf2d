"""Reading pictures: every format and depth, and every way a file can be bad."""

import io
import os
import re
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image

from fingerpad.exceptions import ImageError
from fingerpad.image import open_frames, read_image

GREY = (np.add.outer(np.arange(40), 3 * np.arange(60)) % 256).astype(np.uint8)


def write_deep(path, colour):
    """Write 16-bit RGB or RGBA in the way that the name asks for."""
    if path.name == "planar.tif":
        tifffile.imwrite(path, np.moveaxis(colour, 2, 0), photometric="rgb", planarconfig="separate")
    elif path.name == "plain.tif":
        tifffile.imwrite(path, colour, photometric="rgb", extrasamples=["unassalpha"] * (colour.shape[2] - 3))
    else:  # OpenCV writes TIFF compressed with LZW
        assert cv2.imwrite(str(path), colour[..., [2, 1, 0, 3][: colour.shape[2]]])


@pytest.mark.parametrize("name", ["a.png", "plain.tif", "planar.tif", "lzw.tif", "a.ppm"])
def test_sixteen_bit_colour(tmp_path, name):
    colour = np.random.default_rng(0).integers(0, 65536, (20, 30, 3)).astype(np.uint16)
    write_deep(tmp_path / name, colour)
    pixels = read_image(tmp_path / name).pixels
    assert pixels.dtype == np.uint16
    np.testing.assert_allclose(pixels, colour @ [0.299, 0.587, 0.114], atol=0.51)


@pytest.mark.parametrize("orientation", range(1, 9))
def test_colour_tiff_orientations(tmp_path, orientation):
    dtype = (np.uint8, np.uint16)[orientation % 2]
    colour = np.repeat(np.arange(6, dtype=dtype).reshape(2, 3, 1) * 40, 3, axis=2)
    tag = [(274, "H", 1, orientation, True)]
    tifffile.imwrite(tmp_path / "a.tif", colour, photometric="rgb", extratags=tag)
    turned = {
        1: [[0, 40, 80], [120, 160, 200]],
        2: [[80, 40, 0], [200, 160, 120]],
        3: [[200, 160, 120], [80, 40, 0]],
        4: [[120, 160, 200], [0, 40, 80]],
        5: [[0, 120], [40, 160], [80, 200]],
        6: [[120, 0], [160, 40], [200, 80]],
        7: [[200, 80], [160, 40], [120, 0]],
        8: [[80, 200], [40, 160], [0, 120]],
    }
    np.testing.assert_allclose(read_image(tmp_path / "a.tif").pixels, turned[orientation], atol=1)


@pytest.mark.parametrize(("name", "dtype"), [("a.png", "u1"), ("a.png", "u2"), ("plain.tif", "u2")])
def test_transparency_on_white(tmp_path, name, dtype):
    top = np.iinfo(dtype).max
    colour = np.zeros((20, 20, 4), dtype)
    colour[:10, :, 3] = top
    write_deep(tmp_path / name, colour)
    pixels = read_image(tmp_path / name).pixels
    assert (pixels[:10] == 0).all()
    assert (pixels[10:] == top).all()


@pytest.mark.parametrize("name", ["a.jpg", "a.png"])
def test_camera_rotation(tmp_path, name):
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.fromarray(GREY).save(tmp_path / name, exif=exif)
    turned = np.rot90(GREY, -1)
    np.testing.assert_allclose(read_image(tmp_path / name).pixels, turned, atol=20)


@pytest.mark.parametrize(
    ("name", "dpi", "expected"),
    [
        *((name, (500, 500), 500) for name in ("a.png", "a.tif", "a.bmp", "a.jpg")),
        *(("a.png", dpi, None) for dpi in (None, (0, 0), (1, 1))),
    ],
)
def test_resolution_from_file(tmp_path, name, dpi, expected):
    Image.fromarray(GREY).save(tmp_path / name, **({"dpi": dpi} if dpi else {}))
    found = read_image(tmp_path / name).dots_per_inch
    assert found == (expected and pytest.approx(expected, abs=0.01))


@pytest.mark.parametrize(
    ("tiff_unit", "unit", "per_unit", "expected"),
    [
        ("CENTIMETER", "", 200, 508),
        ("NONE", "mm", 500 / 25.4, 500),
        ("NONE", r"\u00B5m", 500 / 25400, 500),
        ("NONE", "cm", 200, 508),
        ("NONE", "inch", 500, 500),
        ("NONE", "pixel", 1, None),
    ],
)
def test_resolution_from_tags_or_words_of_imagej(tmp_path, tiff_unit, unit, per_unit, expected):
    resolution = (round(per_unit * 1e6), 1_000_000)
    tifffile.imwrite(
        tmp_path / "a.tif",
        GREY,
        description=f"ImageJ=1.53t\nunit={unit}\n" if unit else None,
        metadata=None,
        resolution=(resolution, resolution),
        resolutionunit=tiff_unit,
    )
    found = read_image(tmp_path / "a.tif").dots_per_inch
    assert found == (expected and pytest.approx(expected, rel=1e-4))


def write_oblong_pixels(path, unit=True):
    """Write a picture whose file states 500 by 400, per inch or as the shape of a pixel alone."""
    if path.suffix == ".tif":
        tifffile.imwrite(path, GREY, resolution=(500, 400), resolutionunit="INCH" if unit else "NONE")
        return
    Image.fromarray(GREY).save(path, dpi=(500, 400))
    if not unit:  # one byte: of PNG behind pHYs and both numbers, of JPEG behind JFIF and the version
        data = bytearray(path.read_bytes())
        png = path.suffix == ".png"
        at = data.index(b"pHYs") + 12 if png else data.index(b"JFIF") + 7
        data[at] = 0
        if png:
            chunk = data.index(b"pHYs")
            data[at + 1 : at + 5] = zlib.crc32(data[chunk : at + 1]).to_bytes(4, "big")
        path.write_bytes(data)


@pytest.mark.parametrize("unit", [True, False])
@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.jpg"])
def test_pixels_that_are_not_square_are_refused(tmp_path, name, unit):
    write_oblong_pixels(tmp_path / name, unit)
    with pytest.raises(ImageError, match=rf"{name}.* across and .* down: its pixels are not square") as error:
        read_image(tmp_path / name)
    across, down = map(float, re.findall(r"resolution of (\S+) across and (\S+) down", str(error.value))[0])
    assert across / down == pytest.approx(1.25, abs=1e-4)
    assert "resample it to square pixels" in str(error.value)


def test_frames_of_pixels_that_are_not_square_are_refused(tmp_path):
    tifffile.imwrite(tmp_path / "press.tif", np.stack([GREY, GREY]), photometric="minisblack")
    assert all(frame.reason is None for frame in open_frames(tmp_path / "press.tif"))
    with tifffile.TiffWriter(tmp_path / "press.tif") as file:
        for _ in range(2):
            file.write(GREY, resolution=(500, 400), resolutionunit="INCH", contiguous=False)
    stated = "states a resolution of 500 across and 400 down: its pixels are not square"
    for frame in open_frames(tmp_path / "press.tif"):
        assert frame.reason.startswith(f"{tmp_path / 'press.tif'}: page {frame.index}: {stated}")


def test_animation_refused(tmp_path):
    first, second = Image.fromarray(GREY), Image.fromarray(GREY[::-1].copy())
    first.save(tmp_path / "a.png", save_all=True, append_images=[second])
    with pytest.raises(ImageError, match=r"2 pictures: .* as a sequence"):
        read_image(tmp_path / "a.png")


def make_truncated(path):
    noise = np.random.default_rng(0).integers(0, 256, (200, 200)).astype(np.uint8)
    Image.fromarray(noise).save(path.with_suffix(".full.png"))
    path.write_bytes(path.with_suffix(".full.png").read_bytes()[:9000])


def make_nan(path):
    values = GREY.astype(np.float32)
    values[3, 4] = np.nan
    tifffile.imwrite(path, values)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda path: None, "no such file"),
        (Path.mkdir, "folder"),
        (lambda path: path.write_bytes(b""), "empty"),
        (lambda path: path.write_text("x_mm,y_mm\n1,2\n"), "not a picture"),
        (make_truncated, "cut short"),
        (make_nan, "NaN"),
        (lambda path: tifffile.imwrite(path, [GREY, GREY], photometric="minisblack"), "2 pictures"),
        # A header that promises 2·10¹⁰ pixels, with nothing behind it.
        (
            lambda path: path.write_bytes(b"P5\n200000 100000\n255\n"),
            "raise memory_limit|far too many pixels",
        ),
    ],
)
def test_invalid_files(tmp_path, make, words):
    path = tmp_path / "print.tif"
    make(path)
    with pytest.raises(ImageError, match=words) as caught:
        read_image(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("name", "dtype", "channels", "needed"),
    [
        ("a.png", np.uint8, 1, 26),
        ("a.jpg", np.uint8, 3, 30),
        ("a.png", np.uint16, 3, 36),
        ("plain.tif", np.uint16, 3, 36),
        ("plain.tif", np.float32, 3, 48),
    ],
)
def test_memory_limit(tmp_path, name, dtype, channels, needed):
    path = tmp_path / name
    colour = np.ones((20, 30, 3), dtype)
    if name == "plain.tif":
        tifffile.imwrite(path, colour, photometric="rgb")
    else:
        assert cv2.imwrite(str(path), colour if channels == 3 else colour[..., 0])
    assert read_image(path, memory_limit=600 * needed).pixels.shape == (20, 30)
    with pytest.raises(ImageError, match="30 × 20 pixels .* raise memory_limit") as caught:
        read_image(path, memory_limit=600 * needed - 1)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("tags", [{"TileWidth": 2**20, "TileLength": 2**20}, {"ImageWidth": 2**30}])
def test_memory_limit_of_large_tiles(tmp_path, tags):
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, GREY, tile=(16, 16), photometric="minisblack")
    with tifffile.TiffFile(path, mode="r+b") as tiff:
        for name, value in tags.items():
            tiff.pages[0].tags[name].overwrite(value, dtype="I")
    with pytest.raises(ImageError, match="raise memory_limit"):
        read_image(path)


def encoded(form, **options):
    file = io.BytesIO()
    Image.fromarray(GREY).save(file, form, **options)
    return file.getvalue()


@pytest.mark.parametrize(
    ("code", "name", "content"),
    [
        (34712, "JPEG2000", lambda: encoded("JPEG2000", no_jp2=True)),
        (50002, "JPEGXL", lambda: b"\xff\x0a" + bytes(200)),
        (50001, "WEBP", lambda: encoded("WEBP")),
        (50000, "ZSTD", lambda: bytes(300)),
        (12345, "number 12345", lambda: bytes(300)),
    ],
)
def test_unsupported_compression_refused(tmp_path, code, name, content):
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, np.frombuffer(content(), np.uint8)[None], photometric="minisblack", metadata=None)
    with tifffile.TiffFile(path, mode="r+b") as tiff:
        tags = tiff.pages[0].tags
        tags["Compression"].overwrite(code)
        tags["ImageWidth"].overwrite(60)
        tags["ImageLength"].overwrite(40)
        tags["RowsPerStrip"].overwrite(40)
    with pytest.raises(ImageError, match=f"compression {name}.* convert the picture to PNG") as caught:
        read_image(path)
    assert str(path) in str(caught.value)
    (frame,) = open_frames(path)
    assert frame.pixels is None
    assert name in frame.reason


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"photometric": "cielab", "shape": (40, 60, 3), "dtype": "u1"}, "colour space CIELAB"),
        ({"photometric": "separated", "shape": (40, 60, 4), "dtype": "u2"}, "4 × 16 bits in TIFF"),
        ({"photometric": "minisblack", "shape": (40, 60), "dtype": "c8"}, "64 bits in format 6"),
    ],
)
def test_unsupported_tiffs_refused(tmp_path, options, words):
    tifffile.imwrite(tmp_path / "a.tif", **options)
    with pytest.raises(ImageError, match=words):
        read_image(tmp_path / "a.tif")


def test_pipe_refused_without_waiting(tmp_path):
    for name in ("a.png", "a.tif", "a.avi"):
        os.mkfifo(tmp_path / name)
        for read in (read_image, open_frames):
            with pytest.raises(ImageError, match="is a pipe or a device|is one picture"):
                read(tmp_path / name)


@pytest.mark.parametrize("name", ["a" * 300 + ".png", "nul\0.png", "a.png/b.png"])
def test_invalid_file_names(tmp_path, name):
    (tmp_path / "a.png").write_bytes(b"x")
    for read in (read_image, open_frames):
        with pytest.raises(ImageError, match="cannot be opened|no such file"):
            read(tmp_path / name)
