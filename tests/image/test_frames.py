"""Frames of folders, TIFF stacks and videos: order, damage, and memory that does not grow with length."""

import math
import tracemalloc
from pathlib import Path

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image

from fingerpad.exceptions import ImageError
from fingerpad.image import FrameRate, FrameResult, frame_clock, open_frames, sequence_summary
from fingerpad.image.sequence.force import FrameStamps


def grey(level, depth=np.uint8):
    return np.full((48, 64), level, depth)


TWELVE = [grey(10 * index) for index in range(12)]


def write(path, pictures=TWELVE, rate=100.0):
    """Write pictures, grey or in colour, as a folder, a stack or a video."""
    coloured = pictures[0].ndim == 3
    if not path.suffix:
        path.mkdir()
        for index, picture in enumerate(pictures):
            Image.fromarray(picture).save(path / f"frame{index}.png")
        (path / "notes.txt").write_text("not a picture")
    elif path.suffix == ".tif":
        tifffile.imwrite(path, np.stack(pictures), photometric="rgb" if coloured else "minisblack")
    else:
        codec = cv2.VideoWriter_fourcc(*("mp4v" if path.suffix == ".mp4" else "MJPG"))
        writer = cv2.VideoWriter(str(path), codec, rate, pictures[0].shape[1::-1])
        assert writer.isOpened()
        for picture in pictures:
            writer.write(cv2.cvtColor(picture, cv2.COLOR_RGB2BGR if coloured else cv2.COLOR_GRAY2BGR))
        writer.release()
    return path


@pytest.mark.parametrize("name", ["frames", "stack.tif", "video.avi"])
def test_colours_are_kept_where_they_are_wanted_and_there(tmp_path, name):
    path = write(tmp_path / name, [np.full((48, 64, 3), level, np.uint8) for level in ([200, 120, 40], 90)])
    coloured, plain = open_frames(path, colour=True)
    assert coloured.pixels.mean(axis=(0, 1)) == pytest.approx([200, 120, 40], abs=3)
    assert plain.pixels.shape == (48, 64)  # as of a camera that sees no colours
    assert {frame.pixels.ndim for frame in open_frames(path)} == {2}


def levels(frames):
    return [None if frame.pixels is None else round(float(frame.pixels.mean())) for frame in frames]


@pytest.mark.parametrize(
    ("name", "step", "depth", "off"),
    [
        ("frames", 10, np.uint8, 0),
        ("stack.tif", 2500, np.uint16, 0),  # as deep as a 16-bit camera's
        ("video.avi", 20, np.uint8, 6),
        ("video.mp4", 20, np.uint8, 6),
    ],
)
def test_frames_come_in_order_again_and_alone(tmp_path, name, step, depth, off):
    frames = open_frames(write(tmp_path / name, [grey(step * index, depth) for index in range(12)]))
    assert len(frames) == 12
    for _ in range(2):
        np.testing.assert_allclose(levels(frames), step * np.arange(12), atol=off)
    for place, frame in enumerate(list(frames)):
        alone = frames.at(place)
        assert frame.index == alone.index == place
        assert frame.pixels.dtype == depth
        np.testing.assert_array_equal(alone.pixels, frame.pixels)
    for index in (-1, 12, 10**9):
        with pytest.raises(ImageError, match="there are 12"):
            frames.at(index)
    assert (frames.kind == "video") == name.startswith("video")
    assert frames.frames_per_second == (pytest.approx(100) if frames.kind == "video" else None)


def test_video_of_pixels_that_are_not_square_is_refused(tmp_path):
    path = write(tmp_path / "video.mp4")
    data = bytearray(path.read_bytes())
    at = data.index(b"\0\0\1\x20") + 4  # the video object layer of MPEG-4
    bits = f"{int.from_bytes(data[at : at + 4], 'big'):032b}"
    place = 10 + (7 if bits[9] == "1" else 0)
    assert bits[place : place + 4] == "0001"  # 1 : 1
    sixteen_to_eleven = bits[:place] + "0100" + bits[place + 4 :]
    data[at : at + 4] = int(sixteen_to_eleven, 2).to_bytes(4, "big")
    path.write_bytes(data)
    with pytest.raises(ImageError, match=r"video.mp4: states pixels of 16 : 11, .* they are not square"):
        open_frames(path)


def test_pictures_named_unlike_the_others_are_noted(tmp_path):
    folder = write(tmp_path / "frames")
    assert open_frames(folder).odd_names is None
    Image.fromarray(grey(0)).save(folder / "background.png")
    assert open_frames(folder).odd_names.startswith(
        "background.png among the frames, named unlike the others"
    )
    for index in range(5):
        Image.fromarray(grey(index)).save(folder / f"second_press{index}.png")
    assert open_frames(folder).odd_names is None  # with so many nothing is usual
    assert open_frames(write(tmp_path / "stack.tif")).odd_names is None


def test_truncated_video(tmp_path):
    data = write(tmp_path / "whole.avi", [grey(4 * index) for index in range(60)]).read_bytes()
    (tmp_path / "video.avi").write_bytes(data[: len(data) * 2 // 3])
    frames = list(open_frames(tmp_path / "video.avi"))
    read = [frame for frame in frames if frame.pixels is not None]
    assert 20 < len(read) < 60
    assert all("the video ends after" in frame.reason for frame in frames[len(read) :])


def test_damaged_page_fails_alone(tmp_path):
    path = tmp_path / "stack.tif"
    noise = np.random.default_rng(0).integers(0, 256, (9, 40, 50)).astype(np.uint8)
    tifffile.imwrite(path, noise, photometric="minisblack", compression="zlib")
    with tifffile.TiffFile(path) as tiff:
        offset = tiff.pages[4].dataoffsets[0]
    data = bytearray(path.read_bytes())
    data[offset : offset + 60] = b"\xff" * 60
    path.write_bytes(data)
    frames = list(open_frames(path))
    assert [frame.index for frame in frames if frame.pixels is None] == [4]
    assert "page 4" in frames[4].reason
    np.testing.assert_array_equal(frames[8].pixels, noise[8])


def test_damaged_picture_or_size_fails_alone(tmp_path):
    folder = write(tmp_path / "frames", TWELVE[:6])
    (folder / "frame2.png").write_bytes((folder / "frame2.png").read_bytes()[:40])
    Image.fromarray(np.zeros((48, 65), np.uint8)).save(folder / "frame4.png")
    frames = list(open_frames(folder))
    assert levels(frames) == [0, 10, None, 30, None, 50]
    assert "frame2.png" in frames[2].reason
    assert "65 × 48" in frames[4].reason
    assert "64 × 48" in frames[4].reason


def test_nan_and_large_pages_fail_alone(tmp_path):
    stack = np.ones((3, 20, 20), np.float32)
    stack[1, 2, 3] = np.nan
    tifffile.imwrite(tmp_path / "stack.tif", stack, photometric="minisblack")
    assert levels(open_frames(tmp_path / "stack.tif")) == [1, None, 1]
    refused = list(open_frames(tmp_path / "stack.tif", memory_limit=10_000))
    assert all(frame.pixels is None and "raise memory_limit" in frame.reason for frame in refused)


@pytest.mark.parametrize(
    ("name", "make", "words"),
    [
        ("none.avi", lambda path: None, "no such file or folder"),
        ("frames", Path.mkdir, "holds no picture"),
        ("video.avi", lambda path: path.write_text("hello"), "cannot be opened as a video"),
        ("stack.tif", lambda path: path.write_text("hello"), "not a TIFF file"),
        ("frame.png", Path.touch, "is one picture"),
    ],
)
def test_not_a_sequence(tmp_path, name, make, words):
    make(tmp_path / name)
    with pytest.raises(ImageError, match=words) as caught:
        open_frames(tmp_path / name)
    assert name in str(caught.value)


def test_memory_independent_of_length(tmp_path):
    peaks = []
    for count in (100, 1100):
        path = tmp_path / f"{count}.tif"
        tifffile.imwrite(path, np.zeros((count, 48, 64), np.uint8), photometric="minisblack")
        frames = open_frames(path)
        tracemalloc.start()
        assert sum(frame.pixels is not None for frame in frames) == count
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    # 1,000 more frames of 3 kB are 3 MB; a page's place in the file may be remembered.
    assert peaks[1] - peaks[0] < 200_000


def test_truncated_stack(tmp_path, capfd):
    path = tmp_path / "stack.tif"
    with tifffile.TiffWriter(path) as writer:  # page by page, as cameras write
        for picture in TWELVE:
            writer.write(picture, contiguous=False)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    frames = list(open_frames(path))
    assert len(frames) == len(open_frames(path))
    readable = [frame for frame in frames if frame.pixels is not None]
    assert 1 <= len(readable) < 12
    assert frames[-1].pixels is None
    assert "those that follow are lost" in frames[-1].reason or "cannot be decoded" in frames[-1].reason
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("numbers", "found"),
    [
        ([0, 1, 2, 3, 8, 9, 10], (0, 1, 2, 3, 8, 9, 10)),
        ([10, 12, 14, 16, 20, 22], (0, 1, 2, 3, 5, 6)),  # every second one kept, one lost
        ([10, 12, 14, 16, 18, 20], None),  # only the rate is known
        ([101, 184, 267, 350, 434, 517], None),  # times
        ([1, 2, 3, 9], None),  # too few
    ],
)
def test_numbers_of_file_names_tell_missing_frames(tmp_path, numbers, found):
    for number in numbers:
        Image.new("L", (4, 4)).save(tmp_path / f"press2_{number}.png")
    assert open_frames(tmp_path).numbers == found


def test_a_clock_follows_the_numbers_of_file_names(tmp_path):
    for number in (7, 8, 9, 10, 15, 16, 17, 18, 20):
        Image.new("L", (4, 4)).save(tmp_path / f"f{number:04d}.png")
    frames = open_frames(tmp_path)
    assert frames.skipped == (
        "file names skip 5 frames in 2 places, the first between f0010.png and f0015.png: times follow the "
        "numbers"
    )
    clock = frame_clock(10, start_time=1.0, numbers=frames.numbers)
    times = [clock.time_of(k, None) for k in range(9)]
    np.testing.assert_allclose(times, 1 + np.array([0, 1, 2, 3, 8, 9, 10, 11, 13]) / 10)
    seen = [FrameResult(index=k, reason="no contact") for k in range(9)]
    for of, notes in ((clock, (frames.skipped,)), (FrameStamps(np.arange(9.0)), ()), (None, ())):
        assert sequence_summary(seen, frames=frames, clock=of).notes == notes
    by_contact = FrameRate(10, anchor_time=2.0, anchor_frame=None, numbers=frames.numbers)
    assert by_contact.time_of(4, first_contact=3) == pytest.approx(2.5)
    assert math.isnan(clock.time_of(len(clock.numbers), None))
