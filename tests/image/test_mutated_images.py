"""Damaged copies of every format: read or refused by name, never a traceback."""

import random
import struct
import zlib
from contextlib import suppress
from functools import partial
from itertools import islice

import numpy as np
import pytest
from PIL import Image
from tests.image.test_frames import write as write_frames
from tests.image.test_tiff import by_opencv, by_pillow, planes, written

from fingerpad.exceptions import FingerpadError
from fingerpad.image import (
    Scale,
    measure_contact_image,
    measure_photograph,
    measure_sequence,
    open_frames,
    read_image,
)
from fingerpad.simulate import render_contact_image, render_finger

SCALE = Scale(0.1)
ODD_NUMBERS = (0, 1, 2, 3, 7, 255, 256, 32767, 65535, 10**5, 10**7, 2**31 - 1, 2**31, 2**32 - 1)
SEQUENCES = ("stack.tif", "video.avi", "video.mp4")
NAMES = (
    *("a.png", "a.jpg", "a.bmp", "a.pgm", "lzw.tif", "deep.png", "face.jpg"),
    *("jpeg.tif", "fax.tif", "palette.png", "tiled.tif", "planes.tif", *SEQUENCES),
)


@pytest.fixture(scope="module")
def originals(tmp_path_factory):
    """Return whole files by name: every format, and every kind of TIFF."""
    grey = render_contact_image(semi_major=6.0, semi_minor=5.0, ppi=254.0, seed=1).pixels
    face = render_finger("palmar", semi_axes=(8.0, 9.0), mm_per_px=0.1, seed=1).pixels
    writers = dict.fromkeys(NAMES, by_opencv(grey)) | {
        "deep.png": by_opencv(grey.astype(np.uint16) * 257),
        "face.jpg": by_opencv(face[..., ::-1]),
        "jpeg.tif": by_pillow(Image.fromarray(face), compression="jpeg"),
        "fax.tif": by_pillow(Image.fromarray(grey > 128), compression="group4"),
        "palette.png": Image.fromarray(face).convert("P").save,
        "tiled.tif": written(grey, tile=(64, 64), compression="zlib"),
        "planes.tif": planes(face),
        "stack.tif": written(np.stack([grey] * 4), compression="zlib"),
        **dict.fromkeys(("video.avi", "video.mp4"), partial(write_frames, pictures=[grey] * 5)),
    }
    folder = tmp_path_factory.mktemp("whole")
    for name, write in writers.items():
        write(folder / name)
    return {name: (folder / name).read_bytes() for name in NAMES}


def mutated(content, rng):
    """Return a copy with bytes changed, cut, doubled or put in, mostly near its start, where headers are."""
    data = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 4, 16))):
        place = rng.randrange(min(len(data), 400) if rng.random() < 0.6 else len(data))
        order = rng.choice("<>") + rng.choice("HI")
        size = struct.calcsize(order)
        taken_out, put_in = rng.choice(
            [
                (1, rng.randbytes(1)),
                (1, bytes([data[place] ^ 1 << rng.randrange(8)])),
                (size, struct.pack(order, rng.choice(ODD_NUMBERS) % 256**size)),
                (rng.choice((1, 4, 100, 10_000)), b""),
                (0, data[place : place + rng.choice((1, 12, 200))]),
                (0, rng.randbytes(rng.choice((1, 4, 64)))),
                (len(data), b""),
            ]
        )
        data[place : place + taken_out] = put_in
        if not data:
            break
    return bytes(data)


def outcomes(path, *, as_photograph=False):
    """Read a file by every reader and measure what can be read; return "read" or "refused" for each.

    A photograph takes a hundred times as long as a contact image, and is measured if asked for. Errors that
    are not fingerpad's own come through.
    """
    steps = [
        (lambda: read_image(path).pixels, lambda pixels: measure_contact_image(pixels, SCALE)),
        (lambda: list(islice(open_frames(path), 6)), lambda frames: list(measure_sequence(frames, SCALE))),
    ]
    if as_photograph:
        colours = lambda: read_image(path, colour=True).pixels  # noqa: E731
        steps.append((colours, lambda pixels: measure_photograph(pixels, "palmar", SCALE)))
    found = []
    for read, measure in steps:
        try:
            seen = read()
        except FingerpadError as error:
            assert path.name in str(error)  # noqa: PT017
            found.append("refused")
            continue
        found.append("read")
        with suppress(FingerpadError):  # of a picture that may show no finger
            measure(seen)
    return found


@pytest.mark.parametrize("name", NAMES)
def test_intact_files_are_read(tmp_path, originals, name):
    (tmp_path / name).write_bytes(originals[name])
    of_frames = name in SEQUENCES
    frames = "read" if of_frames or name.endswith(".tif") else "refused"
    assert outcomes(tmp_path / name) == ["refused" if of_frames else "read", frames]


@pytest.mark.parametrize("name", NAMES)
def test_damaged_files_read_or_refused(tmp_path, originals, name):
    rng = random.Random(zlib.crc32(name.encode()))
    for number in range(10):
        (tmp_path / name).write_bytes(mutated(originals[name], rng))
        outcomes(tmp_path / name, as_photograph=number == 0)
