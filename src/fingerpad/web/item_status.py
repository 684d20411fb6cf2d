"""The seam to the engine: how far each item is, without measuring and without reading pictures anew."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, Final

from fingerpad._files import digest_of
from fingerpad.exceptions import StoreError
from fingerpad.study.corrections.history import CORRECTIONS_NAME, ActiveCorrection
from fingerpad.study.editing.documents import STUDY_NAME
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.manifest import Study
from fingerpad.study.measuring.run import items_of
from fingerpad.study.measuring.tasks import CacheKeys
from fingerpad.web.study_session import StudySession

_UNREADABLE: Final = (OSError, StoreError)


def item_states(
    study: Study, opened: StudySession, active_corrections: Mapping[str, ActiveCorrection]
) -> dict[str, str]:
    """Return for each item whether it is done, failed, stale or left.

    An item that is not in the store is left, whatever its file holds: 2,000 pictures are not read to say so.
    """
    keys = CacheKeys(study=study, folder=opened.folder, digest=str, active_corrections=active_corrections)
    states = {name: "left" for name, _ in items_of(keys)}
    path = opened.out / STORE_NAME
    if not path.is_file():
        return states
    try:
        with Store.reading(path) as store:
            statuses = store.statuses()
            keys = CacheKeys(
                study=study,
                folder=opened.folder,
                digest=cache(store.digest),
                active_corrections=active_corrections,
            )
            for name, key in items_of(keys):
                if (status := statuses.get(name)) is not None:
                    states[name] = status.status if status.key == key() else "stale"
    except _UNREADABLE:
        return states  # the run says what is wrong with it
    return states


def overlay_of(opened: StudySession, item: str) -> Path | None:
    """Return the picture that was drawn of an item."""
    path = opened.out / STORE_NAME
    if not path.is_file():
        return None
    with Store.reading(path) as store:
        status = store.statuses().get(item)
        drawn = status.drawn.items() if status is not None else ()
        return next((store.drawn_file(name, digest) for name, digest in drawn), None)


def said_the_same(opened: StudySession, study: Study, provenance: Mapping[str, Any]) -> bool:
    """Tell whether manifest, spreadsheet and corrections are those of a run, by its provenance."""
    names = [STUDY_NAME, *([study.observations_csv] if study.observations_csv else []), CORRECTIONS_NAME]
    known = provenance["inputs_sha256"]
    return all(digest_of(opened.folder / name) == known.get(name, "") for name in names)
