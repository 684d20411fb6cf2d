"""Damaged copies of every format: read or refused by name, never a traceback."""

import random
import zlib

import pytest
from tests.mutated_images import NAMES, mutated, originals, use


def test_every_file_has_a_test():
    assert set(originals()) == set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_intact_files_are_read(tmp_path, name):
    (tmp_path / name).write_bytes(originals()[name])
    sequence = name in {"video.avi", "video.mp4", "stack.tif"}
    frames = "read" if sequence or name.endswith(".tif") else "refused"
    assert use(tmp_path / name, as_photograph=False) == ["refused" if sequence else "read"] * 2 + [frames]


@pytest.mark.parametrize("name", NAMES)
def test_damaged_files_read_or_refused(tmp_path, name):
    rng = random.Random(zlib.crc32(name.encode()))
    for number in range(10):
        (tmp_path / name).write_bytes(mutated(originals()[name], rng))
        assert set(use(tmp_path / name, as_photograph=number == 0)) <= {"read", "refused"}
