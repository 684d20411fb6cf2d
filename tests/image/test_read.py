"""Reading pictures: every format and depth, and every way a file can be bad."""

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image

from fingerpad.exceptions import ImageError
from fingerpad.image import read_image

GREY = (np.add.outer(np.arange(40), 3 * np.arange(60)) % 256).astype(np.uint8)


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.bmp", "a.pgm"])
def test_lossless_grey_round_trip(tmp_path, name):
    Image.fromarray(GREY).save(tmp_path / name)
    picture = read_image(tmp_path / name)
    assert picture.pixels.dtype == np.uint8
    np.testing.assert_array_equal(picture.pixels, GREY)


def test_jpeg_is_close(tmp_path):
    smooth = np.tile(np.linspace(0, 255, 64).astype(np.uint8), (64, 1))
    Image.fromarray(smooth).save(tmp_path / "a.jpg", quality=95)
    assert np.abs(read_image(tmp_path / "a.jpg").pixels.astype(int) - smooth).max() < 8


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.pgm"])
def test_sixteen_bits_are_kept(tmp_path, name):
    deep = GREY.astype(np.uint16) * 257
    Image.fromarray(deep).save(tmp_path / name)
    picture = read_image(str(tmp_path / name))
    assert picture.pixels.dtype == np.uint16
    np.testing.assert_array_equal(picture.pixels, deep)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_float_tiff(tmp_path, dtype):
    tifffile.imwrite(tmp_path / "a.tif", GREY.astype(dtype) / 7)
    np.testing.assert_allclose(read_image(tmp_path / "a.tif").pixels, GREY / 7, rtol=1e-6)


def write_deep(path, colour):
    """Write 16-bit RGB or RGBA in the way that the name asks for."""
    if path.name == "planar.tif":
        tifffile.imwrite(path, np.moveaxis(colour, 2, 0), photometric="rgb", planarconfig="separate")
    elif path.name == "plain.tif":
        tifffile.imwrite(path, colour, photometric="rgb", extrasamples=["unassalpha"] * (colour.shape[2] - 3))
    else:  # OpenCV writes TIFF compressed with LZW
        assert cv2.imwrite(str(path), colour[..., [2, 1, 0, 3][: colour.shape[2]]])


@pytest.mark.parametrize("name", ["a.png", "plain.tif", "planar.tif", "lzw.tif", "a.ppm"])
def test_sixteen_bit_colour_keeps_its_depth(tmp_path, name):
    colour = np.random.default_rng(0).integers(0, 65536, (20, 30, 3)).astype(np.uint16)
    write_deep(tmp_path / name, colour)
    pixels = read_image(tmp_path / name).pixels
    assert pixels.dtype == np.uint16
    np.testing.assert_allclose(pixels, colour @ [0.299, 0.587, 0.114], atol=0.51)


@pytest.mark.parametrize("name", ["a.png", "plain.tif"])
def test_deep_transparency_lies_on_white(tmp_path, name):
    colour = np.zeros((20, 20, 4), np.uint16)
    colour[:10, :, 3] = 65535
    write_deep(tmp_path / name, colour)
    pixels = read_image(tmp_path / name).pixels
    assert (pixels[:10] == 0).all()
    assert (pixels[10:] == 65535).all()


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("depth", [8, 16])
def test_every_orientation_of_a_colour_tiff_is_obeyed(tmp_path, orientation, depth):
    dtype = np.uint8 if depth == 8 else np.uint16
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


def test_float_colour_tiff(tmp_path):
    colour = np.repeat(GREY.astype(np.float32)[..., None] / 255, 3, axis=2)
    tifffile.imwrite(tmp_path / "a.tif", colour, photometric="rgb")
    np.testing.assert_allclose(read_image(tmp_path / "a.tif").pixels, GREY / 255, atol=1e-5)


def test_green_is_brighter_than_blue(tmp_path):
    colour = np.zeros((20, 20, 3), np.uint8)
    colour[:10, :, 1], colour[10:, :, 2] = 255, 255
    Image.fromarray(colour).save(tmp_path / "a.png")
    pixels = read_image(tmp_path / "a.png").pixels
    assert pixels.ndim == 2
    assert pixels[0, 0] > pixels[-1, 0] > 0


def test_transparency_lies_on_white(tmp_path):
    colour = np.zeros((20, 20, 4), np.uint8)
    colour[:10, :, 3] = 255
    Image.fromarray(colour).save(tmp_path / "a.png")
    pixels = read_image(tmp_path / "a.png").pixels
    assert (pixels[:10] == 0).all()
    assert (pixels[10:] == 255).all()


def test_camera_rotation_is_obeyed(tmp_path):
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.fromarray(GREY).save(tmp_path / "a.jpg", exif=exif)
    assert read_image(tmp_path / "a.jpg").pixels.shape == GREY.shape[::-1]


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.bmp", "a.jpg"])
def test_resolution_comes_from_the_file(tmp_path, name):
    Image.fromarray(GREY).save(tmp_path / name, dpi=(500, 500))
    assert read_image(tmp_path / name).dots_per_inch == pytest.approx(500, abs=0.01)


@pytest.mark.parametrize("dpi", [None, (500, 250), (0, 0), (1, 1)])
def test_no_honest_resolution_is_none(tmp_path, dpi):
    Image.fromarray(GREY).save(tmp_path / "a.png", **({"dpi": dpi} if dpi else {}))
    assert read_image(tmp_path / "a.png").dots_per_inch is None


@pytest.mark.parametrize(
    ("unit", "per_unit", "expected"),
    [
        ("mm", 500 / 25.4, 500),
        (r"\u00B5m", 500 / 25400, 500),
        ("cm", 200, 508),
        ("inch", 500, 500),
        ("pixel", 1, None),
    ],
)
def test_the_scale_that_imagej_writes(tmp_path, unit, per_unit, expected):
    resolution = (round(per_unit * 1e6), 1_000_000)
    tifffile.imwrite(
        tmp_path / "a.tif",
        GREY,
        description=f"ImageJ=1.53t\nunit={unit}\n",
        metadata=None,
        resolution=(resolution, resolution),
        resolutionunit="NONE",
    )
    found = read_image(tmp_path / "a.tif").dots_per_inch
    assert found is expected if expected is None else found == pytest.approx(expected, rel=1e-4)


def test_centimetres_of_a_tiff_that_pillow_cannot_decode(tmp_path):
    values = GREY.astype(np.float64)
    tifffile.imwrite(tmp_path / "a.tif", values, resolution=(200, 200), resolutionunit="CENTIMETER")
    assert read_image(tmp_path / "a.tif").dots_per_inch == pytest.approx(508)


def test_a_reduced_copy_beside_the_picture_does_not_count(tmp_path):
    with tifffile.TiffWriter(tmp_path / "a.tif") as tiff:
        tiff.write(GREY, photometric="minisblack")
        tiff.write(GREY[::4, ::4], photometric="minisblack", subfiletype=1)
    np.testing.assert_array_equal(read_image(tmp_path / "a.tif").pixels, GREY)


def test_an_animation_is_refused(tmp_path):
    first, second = Image.fromarray(GREY), Image.fromarray(GREY[::-1].copy())
    first.save(tmp_path / "a.png", save_all=True, append_images=[second])
    with pytest.raises(ImageError, match=r"2 pictures: .* as a sequence"):
        read_image(tmp_path / "a.png")


@pytest.mark.parametrize("shape", [(1, 1), (1, 40)])
def test_tiny_and_black_pictures_are_pictures(tmp_path, shape):
    Image.fromarray(np.zeros(shape, np.uint8)).save(tmp_path / "a.png")
    assert read_image(tmp_path / "a.png").pixels.shape == shape


def make_folder(path):
    path.mkdir()


def make_text(path):
    path.write_text("x_mm,y_mm\n1,2\n")


def make_truncated(path):
    noise = np.random.default_rng(0).integers(0, 256, (200, 200)).astype(np.uint8)
    Image.fromarray(noise).save(path.with_suffix(".full.png"))
    path.write_bytes(path.with_suffix(".full.png").read_bytes()[:9000])


def make_nan(path):
    values = GREY.astype(np.float32)
    values[3, 4] = np.nan
    tifffile.imwrite(path, values)


def make_header_only(path):
    path.write_bytes(b"\x89PNG\r\n\x1a\n")


def make_stack(path):
    tifffile.imwrite(path, np.stack([GREY, GREY]), photometric="minisblack")


def make_bomb(path):
    # A header that promises 2·10¹⁰ pixels, with nothing behind it.
    path.write_bytes(b"P5\n200000 100000\n255\n")


def make_short_tiff(path):
    tifffile.imwrite(path, GREY.astype(np.float64))
    path.write_bytes(path.read_bytes()[:300])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda path: None, "no such file"),
        (make_folder, "folder"),
        (lambda path: path.write_bytes(b""), "empty"),
        (make_text, "not a picture"),
        (make_truncated, "cut short"),
        (make_header_only, "not a picture|cut short"),
        (make_nan, "NaN"),
        (make_stack, "2 pictures"),
        (make_bomb, "too many pixels|more than the limit"),
        (make_short_tiff, "not a picture|cut short"),
    ],
)
def test_bad_files_are_named(tmp_path, make, words):
    path = tmp_path / "print.tif"
    make(path)
    with pytest.raises(ImageError, match=words) as caught:
        read_image(path)
    assert str(path) in str(caught.value)


def test_deep_colour_is_limited_too(tmp_path):
    write_deep(tmp_path / "a.png", np.zeros((20, 30, 3), np.uint16))
    assert read_image(tmp_path / "a.png", pixel_limit=600).pixels.shape == (20, 30)
    with pytest.raises(ImageError, match="30 × 20 pixels are more than the limit of 599"):
        read_image(tmp_path / "a.png", pixel_limit=599)


def test_a_deep_png_cut_short_is_named(tmp_path):
    noise = np.random.default_rng(0).integers(0, 65536, (60, 60, 3)).astype(np.uint16)
    write_deep(tmp_path / "whole.png", noise)
    (tmp_path / "a.png").write_bytes((tmp_path / "whole.png").read_bytes()[:9000])
    with pytest.raises(ImageError, match="cut short"):
        read_image(tmp_path / "a.png")


def test_size_is_checked_before_decoding(tmp_path):
    # The pixels behind the header are missing: only a check of the header can tell of the size.
    path = tmp_path / "large.pgm"
    path.write_bytes(b"P5\n3000 2000\n255\n")
    with pytest.raises(ImageError, match="3000 × 2000"):
        read_image(path, pixel_limit=1_000_000)


@pytest.mark.parametrize("cut", range(1, 400, 13))
def test_no_cut_png_leaks_another_error(tmp_path, cut):
    whole = tmp_path / "whole.png"
    noise = np.random.default_rng(1).integers(0, 256, (20, 30)).astype(np.uint8)
    Image.fromarray(noise).save(whole, dpi=(500, 500))
    path = tmp_path / "cut.png"
    path.write_bytes(whole.read_bytes()[:cut])
    with pytest.raises(ImageError):
        read_image(path)


@pytest.mark.parametrize(
    ("dtype", "gain", "offset"), [(np.uint32, 100_000, 0), (np.int32, 1000, 0), (np.int16, 1, -100)]
)
def test_wide_and_signed_levels_keep_their_differences(tmp_path, dtype, gain, offset):
    levels = np.arange(64, dtype=np.int64).reshape(8, 8)
    tifffile.imwrite(tmp_path / "wide.tif", (gain * levels + offset).astype(dtype), photometric="minisblack")
    pixels = read_image(tmp_path / "wide.tif").pixels.astype(float)
    np.testing.assert_allclose(pixels - pixels[0, 0], gain * levels, rtol=1e-6)


def test_pages_of_doubles_are_several_pictures_too(tmp_path):
    tifffile.imwrite(tmp_path / "stack.tif", np.zeros((3, 40, 40)), photometric="minisblack")
    with pytest.raises(ImageError, match="holds 3 pictures"):
        read_image(tmp_path / "stack.tif")
