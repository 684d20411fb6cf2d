"""The named scales of the open study, each measured once as long as its table and picture stay the same."""

from collections.abc import Mapping
from typing import Any, Final

from fingerpad.study.manifest import CoinScale, ScaleKey
from fingerpad.study.measuring.scales import FoundScale, find_scale, named_scales
from fingerpad.web.errors import RequestError
from fingerpad.web.pictures import Cache, ImageLocation
from fingerpad.web.study_session import StudySession

_FOUND: Final[Cache[dict[str, FoundScale | str]]] = Cache(20, lambda _: 1)


def scales_of(opened: StudySession) -> Mapping[str, FoundScale | str]:
    """Return each named scale, or why there is none."""
    study = opened.study()
    stamps = [
        (name, table.model_dump_json(), _stamp(opened, table.coin) if isinstance(table, CoinScale) else None)
        for name, table in study.scales.items()
    ]
    return _FOUND.get((str(opened.folder), tuple(stamps)), lambda: named_scales(study, opened.folder))


def scale_of(opened: StudySession, key: ScaleKey) -> FoundScale:
    """Return the scale that a key of the manifest means."""
    if isinstance(key, str):
        known = scales_of(opened)
        if key not in known:
            raise RequestError.not_there(f"no scale is named {key!r}")
        return find_scale(key, known, opened.folder)
    if isinstance(key, CoinScale):
        opened.file(key.coin)  # one of the study's own
    return find_scale(key, {}, opened.folder)


def _stamp(opened: StudySession, file: str) -> Any:
    return ImageLocation(opened.folder / file).stamp
