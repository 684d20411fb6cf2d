"""Every kind of TIFF that is read, each against the levels it was written from, exactly."""

import io
import resource
import zlib

import cv2
import imagecodecs
import numpy as np
import pytest
import tifffile
from PIL import Image

from fingerpad.exceptions import ImageError
from fingerpad.image import MEMORY_LIMIT, open_frames, read_image
from fingerpad.image.read import read_levels

ROWS, COLUMNS = 37, 61  # neither a multiple of a tile nor of a byte
RNG = np.random.default_rng(7)


def random_levels(dtype, channels=None):
    shape = (ROWS, COLUMNS) if channels is None else (ROWS, COLUMNS, channels)
    if np.dtype(dtype).kind == "f":
        return RNG.random(shape).astype(dtype)
    return RNG.integers(0, np.iinfo(dtype).max, shape, dtype, endpoint=True)


BITS = RNG.random((ROWS, COLUMNS)) < 0.5
GREY8, GREY16, GREY32, FLOATS = (random_levels(dtype) for dtype in ("u1", "u2", "u4", "f4"))
RGB8, RGB16, RGB32 = (random_levels(dtype, 3) for dtype in ("u1", "u2", "f4"))
RGBA8 = random_levels("u1", 4)
CMYK8 = random_levels("u1", 4)
YCBCR8 = random_levels("u1", 3)
SMOOTH = np.add.outer(np.arange(ROWS), 2 * np.arange(COLUMNS)).astype(np.uint8)


def written(array, **options):
    """Return a writer by tifffile."""
    return lambda path: tifffile.imwrite(path, array, **{"photometric": "minisblack", **options})


def colour(array, **options):
    """Return a writer of colour."""
    return written(array, photometric="rgb", **options)


def planes(array, **options):
    return colour(np.moveaxis(array, 2, 0), planarconfig="separate", **options)


def by_pillow(image, **options):
    return lambda path: image.save(path, "TIFF", **options)


def by_opencv(array, *options):
    return lambda path: cv2.imwrite(str(path), array, list(options))


def with_tags(write, **tags):
    """Return a writer that writes over some tags afterwards."""

    def overwritten(path):
        write(path)
        with tifffile.TiffFile(path, mode="r+b") as tiff:
            for name, value in tags.items():
                tiff.pages[0].tags[name].overwrite(value)

    return overwritten


def whole_strips(array, **options):
    """Return a writer whose last strip is as long as the others, with rows below the picture."""
    taller = np.pad(array, ((0, -ROWS % 7), *((0, 0),) * (array.ndim - 1)), mode="edge")
    assert len(taller) > ROWS
    return with_tags(written(taller, rowsperstrip=7, **options), ImageLength=ROWS)


def packed(levels, bits):
    """Return grey levels of a few bits, packed into whole bytes row by row."""
    padded = np.pad(levels, ((0, 0), (0, -COLUMNS % (8 // bits)))).reshape(ROWS, -1, 8 // bits)
    return (padded << np.arange(8 - bits, -1, -bits, dtype=np.uint8)).sum(axis=2, dtype=np.uint8)


def few_bits(bits, **options):
    write = written(packed(GREY8 >> (8 - bits), bits), metadata=None, **options)
    return with_tags(write, BitsPerSample=bits, ImageWidth=COLUMNS)


def on_white(colours, share, top):
    """Return levels blended with white, rounded as the reader rounds."""
    share = share.astype(np.float32)[..., None] / np.float32(top)
    return np.rint(share * colours.astype(np.float32) + (1 - share) * np.float32(top)).astype(colours.dtype)


def palette(path):
    table = np.random.default_rng(3).integers(0, 256, (3, 256), np.uint16) * 257
    tifffile.imwrite(path, GREY8, photometric="palette", colormap=table)


def reduced_copy(path):
    with tifffile.TiffWriter(path) as tiff:
        tiff.write(GREY8, photometric="minisblack")
        tiff.write(GREY8[::4, ::4], photometric="minisblack", subfiletype=1)


PALETTE = np.random.default_rng(3).integers(0, 256, (3, 256), np.uint16).astype(np.uint8).T
LZW = cv2.IMWRITE_TIFF_COMPRESSION_LZW
COMPRESSION, PREDICTOR = cv2.IMWRITE_TIFF_COMPRESSION, cv2.IMWRITE_TIFF_PREDICTOR
TILES = {"tile": (16, 32)}

# name: a writer, and the levels as they should be read
VARIANTS = {
    "1 bit": (by_pillow(Image.fromarray(BITS)), np.uint8(255) * BITS),
    "1 bit CCITT RLE": (by_pillow(Image.fromarray(BITS), compression="tiff_ccitt"), np.uint8(255) * BITS),
    "1 bit fax group 3": (by_pillow(Image.fromarray(BITS), compression="group3"), np.uint8(255) * BITS),
    "1 bit fax group 4": (by_pillow(Image.fromarray(BITS), compression="group4"), np.uint8(255) * BITS),
    "1 bit min-is-white": (
        with_tags(by_pillow(Image.fromarray(BITS)), PhotometricInterpretation=0),
        np.uint8(255) * ~BITS,
    ),
    "2 bits": (few_bits(2), GREY8 // 64 * np.uint8(85)),
    "4 bits": (few_bits(4), GREY8 // 16 * np.uint8(17)),
    "8 bits": (written(GREY8), GREY8),
    "8 bits Deflate whole strips": (whole_strips(GREY8, compression="zlib"), GREY8),
    "8 bits LZW whole strips": (whole_strips(GREY8, compression="lzw"), GREY8),
    "8 bits Deflate predictor": (written(GREY8, compression="zlib", predictor=True), GREY8),
    "8 bits min-is-white": (written(GREY8, photometric="miniswhite"), 255 - GREY8),
    "8 bits reduced copy": (reduced_copy, GREY8),
    "8 bits alpha": (
        written(RGBA8[..., :2], planarconfig="contig", extrasamples=["unassalpha"]),
        on_white(RGBA8[..., :1], RGBA8[..., 1], 255)[..., 0],
    ),
    "8 bits unnamed second sample": (
        written(RGBA8[..., :2], planarconfig="contig", extrasamples=["unspecified"]),
        RGBA8[..., 0],
    ),
    "16 bits": (written(GREY16), GREY16),
    "16 bits min-is-white": (written(GREY16, photometric="miniswhite"), 65535 - GREY16),
    "16 bits Deflate predictor big-endian tiles": (
        written(GREY16, compression="zlib", predictor=True, byteorder=">", **TILES),
        GREY16,
    ),
    "16 bits signed": (written(GREY16.view(np.int16)), GREY16.view(np.int16).astype(np.float32)),
    "16 bits float": (written(FLOATS.astype("f2")), FLOATS.astype("f2").astype(np.float32)),
    "32 bits": (written(GREY32), GREY32.astype(np.float32)),
    "64 bits": (written(GREY32.astype("u8")), GREY32.astype(np.float32)),
    "32 bits min-is-white": (
        written(GREY32, photometric="miniswhite"),
        (np.uint32(2**32 - 1) - GREY32).astype(np.float32),
    ),
    "32 bits float": (written(FLOATS), FLOATS),
    "32 bits float predictor of whole numbers": (by_opencv(FLOATS, COMPRESSION, LZW, PREDICTOR, 2), FLOATS),
    "32 bits float predictor of floats big-endian": (
        written(FLOATS, compression="zlib", predictor=True, byteorder=">"),
        FLOATS,
    ),
    "palette": (palette, PALETTE[GREY8]),
    "colour": (colour(RGB8), RGB8),
    "colour planes": (planes(RGB8), RGB8),
    "colour 16 bits planes big-endian predictor": (
        planes(RGB16, byteorder=">", compression="zlib", predictor=True),
        RGB16,
    ),
    "colour float": (colour(RGB32), RGB32),
    "colour alpha": (
        colour(RGBA8, extrasamples=["unassalpha"]),
        on_white(RGBA8[..., :3], RGBA8[..., 3], 255),
    ),
    "CMYK": (
        by_pillow(Image.fromarray(CMYK8, "CMYK")),
        np.asarray(Image.fromarray(CMYK8, "CMYK").convert("RGB")),
    ),
    "YCbCr": (
        by_pillow(Image.fromarray(YCBCR8, "YCbCr")),
        np.asarray(Image.fromarray(YCBCR8, "YCbCr").convert("RGB")),
    ),
}


@pytest.mark.parametrize("name", VARIANTS)
def test_every_variant_exactly(tmp_path, name):
    write, expected = VARIANTS[name]
    path = tmp_path / "a.tif"
    write(path)
    levels = read_levels(path, MEMORY_LIMIT)[0]
    assert levels.dtype == expected.dtype
    np.testing.assert_array_equal(levels, expected)
    if name != "8 bits reduced copy":
        (frame,) = open_frames(path)
        np.testing.assert_array_equal(frame.pixels, read_image(path).pixels)


@pytest.mark.parametrize("levels", [GREY16.view(np.int16), FLOATS], ids=["signed", "float"])
def test_the_least_as_white_is_refused_where_it_may_be_any(tmp_path, levels):
    written(levels, photometric="miniswhite")(tmp_path / "a.tif")
    with pytest.raises(ImageError, match="least as white"):
        read_image(tmp_path / "a.tif")


@pytest.mark.parametrize("channels", [1, 3])
def test_premultiplied_alpha_on_white(tmp_path, channels):
    share = np.repeat([255, 128], [20, COLUMNS - 20]).astype(np.uint8)[None, :, None] * np.ones(
        (ROWS, 1, 1), np.uint8
    )
    seen = RGB8[..., :channels]
    stored = np.rint(seen * (share / 255)).astype(np.uint8)
    photometric = "rgb" if channels == 3 else "minisblack"
    options = {"photometric": photometric, "planarconfig": "contig", "extrasamples": ["assocalpha"]}
    written(np.concatenate([stored, share], axis=2), **options)(tmp_path / "a.tif")
    expected = on_white(seen, share[..., 0], 255)
    levels = read_levels(tmp_path / "a.tif", MEMORY_LIMIT)[0]
    assert np.abs(levels.astype(int) - (expected if channels == 3 else expected[..., 0])).max() <= 2


@pytest.mark.parametrize("mode", ["L", "RGB", "YCbCr", "CMYK"])
def test_jpeg_nearly(tmp_path, mode):
    grey = np.dstack([SMOOTH] * 3)
    Image.fromarray(grey).convert(mode).save(tmp_path / "a.tif", compression="jpeg", quality=98)
    levels = read_levels(tmp_path / "a.tif", MEMORY_LIMIT)[0]
    assert np.abs(levels.astype(int) - (SMOOTH if mode == "L" else grey)).max() <= 3


@pytest.mark.parametrize(
    ("compression", "left"), [(None, 0), ("zlib", 0), ("zlib", 1 / 3), ("packbits", 1 / 3)]
)
def test_a_missing_or_cut_strip_is_refused_where_others_are_whole(tmp_path, compression, left):
    whole_strips(GREY8, compression=compression)(tmp_path / "a.tif")
    with tifffile.TiffFile(tmp_path / "a.tif", mode="r+b") as tiff:
        counts = tiff.pages[0].tags["StripByteCounts"]
        counts.overwrite([*counts.value[:-1], int(left * counts.value[-1])])
    with pytest.raises(ImageError, match=r"a\.tif.*cut short"):
        read_image(tmp_path / "a.tif")


ENCODERS = {
    "lzw": imagecodecs.lzw_encode,
    "zlib": zlib.compress,
    "deflate": zlib.compress,
    "packbits": imagecodecs.packbits_encode,
}


def write_strips(path, array, compression, change, **options):
    """Write strips of 5 rows, after a change of what the last one of 2 rows holds."""
    parts = [array[top : top + 5].tobytes() for top in range(0, ROWS, 5)]
    strips = map(ENCODERS[compression], [*parts[:-1], change(parts[-1])])
    options |= {"photometric": "rgb" if array.ndim == 3 else "minisblack", "rowsperstrip": 5}
    tifffile.imwrite(path, strips, shape=array.shape, dtype=array.dtype, compression=compression, **options)


@pytest.mark.parametrize("array", [GREY8 // 128, RGB16], ids=["runs", "colour"])
@pytest.mark.parametrize("compression", ENCODERS)
def test_last_strip_padded_by_a_byte(tmp_path, compression, array):
    write_strips(tmp_path / "a.tif", array, compression, lambda data: data + b"\7")
    np.testing.assert_array_equal(read_levels(tmp_path / "a.tif", MEMORY_LIMIT)[0], array)


def test_a_picture_lower_than_its_padded_strip(tmp_path):
    part = zlib.compress(SMOOTH[:3].tobytes() + bytes(61 * COLUMNS))
    options = {"shape": (3, COLUMNS), "dtype": "u1", "compression": "zlib", "photometric": "minisblack"}
    tifffile.imwrite(tmp_path / "a.tif", iter([part]), rowsperstrip=3, **options)
    with_tags(lambda path: None, RowsPerStrip=64)(tmp_path / "a.tif")
    np.testing.assert_array_equal(read_image(tmp_path / "a.tif").pixels, SMOOTH[:3])


@pytest.mark.parametrize(
    ("compression", "change"),
    [
        *((name, lambda data: data[:-1]) for name in ENCODERS),
        *((name, lambda data: data * 9) for name in ("zlib", "deflate", "packbits")),
    ],
)
def test_a_last_strip_of_too_little_or_far_too_much_is_refused(tmp_path, compression, change):
    write_strips(tmp_path / "a.tif", GREY8, compression, change)
    with pytest.raises(ImageError, match="cut short or damaged"):
        read_image(tmp_path / "a.tif")


def jpeg_of(shape):
    file = io.BytesIO()
    Image.fromarray(np.zeros(shape, np.uint8)).save(file, "JPEG")
    return file.getvalue()


@pytest.mark.parametrize(
    ("compression", "stream"),
    [("zlib", lambda: zlib.compress(bytes(81_000_000), 9)), ("jpeg", lambda: jpeg_of((9000, 9000)))],
)
def test_a_stream_larger_than_its_tags_is_refused_before_it_fills_the_memory(tmp_path, compression, stream):
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, iter([stream()]), shape=(40, 60), dtype="u1", compression=compression)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(ImageError, match="cannot be decoded"):
        read_image(path)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 40_000  # kB, of 81 MB
