"""A frame decoded alone is the one that comes in its turn."""

import cv2
import numpy as np
import pytest
import tifffile

from fingerpad.exceptions import ImageError
from fingerpad.image import Scale, open_frames


@pytest.fixture(params=["folder", "tiff", "video"])
def frames(request, tmp_path):
    levels = np.arange(12)[:, None, None] * 15 + np.zeros((12, 32, 48))
    pictures = levels.astype(np.uint8)
    if request.param == "tiff":
        tifffile.imwrite(tmp_path / "stack.tif", pictures, photometric="minisblack")
        return open_frames(tmp_path / "stack.tif")
    if request.param == "folder":
        (tmp_path / "frames").mkdir()
        for k, picture in enumerate(pictures):
            cv2.imwrite(str(tmp_path / "frames" / f"{k}.png"), picture)
        return open_frames(tmp_path / "frames")
    writer = cv2.VideoWriter(str(tmp_path / "video.avi"), cv2.VideoWriter_fourcc(*"MJPG"), 20, (48, 32))
    for picture in pictures:
        writer.write(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR))
    writer.release()
    return open_frames(tmp_path / "video.avi")


def test_frame_alone_equals_frame_in_sequence(frames):
    for frame in list(frames):
        alone = frames.at(frame.index)
        assert alone.index == frame.index
        np.testing.assert_array_equal(alone.pixels, frame.pixels)


@pytest.mark.parametrize("index", [-1, 12, 10**9])
def test_missing_frame_refused(frames, index):
    with pytest.raises(ImageError, match="there are 12"):
        frames.at(index)


def test_length_uncertainty():
    scale = Scale.of_line(50.0, (0, 0), (300, 400), length_mm_std=0.5)
    length, std = scale.length((0, 0), (300, 400))
    assert (length, std) == (pytest.approx(50.0), pytest.approx(0.5))  # the line itself, to what it was given
    assert scale.length((7, 7), (7, 7), point_px_std=1.0) == (0.0, pytest.approx(np.sqrt(2) * 0.1))
    assert scale.ppi == pytest.approx(254.0)
