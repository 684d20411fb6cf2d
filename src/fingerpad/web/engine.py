"""The seam to the engine: how far each item is, without measuring and without reading pictures anew."""

from collections.abc import Iterator
from functools import cache
from typing import Final

from pydantic import BaseModel

from fingerpad.exceptions import StoreError
from fingerpad.study.fingers import photograph_item
from fingerpad.study.manifest import Study
from fingerpad.study.store import STORE_NAME, Store
from fingerpad.study.tasks import Keys
from fingerpad.web.open_study import OpenStudy

_UNREADABLE: Final = (OSError, StoreError)


def item_states(study: Study, opened: OpenStudy) -> dict[str, str]:
    """Return for each item whether it is done, failed, stale or left.

    An item that is not in the store is left, whatever its file holds: 2,000 pictures are not read to say so.
    """
    tables = list(_measured(study))
    states = {name: "left" for name, _, _ in tables}
    path = opened.out / STORE_NAME
    if not path.is_file():
        return states
    try:
        with Store.open(path) as store:
            marks = store.marks()
            keys = Keys(study=study, folder=opened.folder, digest=cache(store.digest))
            for name, table, more in tables:
                if (mark := marks.get(name)) is not None:
                    states[name] = mark.status if mark.key == keys.of(table, *more) else "stale"
    except _UNREADABLE:
        return states  # the run says what is wrong with it
    return states


def _measured(study: Study) -> Iterator[tuple[str, BaseModel, tuple[int, ...]]]:
    """Yield the name of each item, its table, and what else its key depends on."""
    for finger in study.fingers:
        for number, photograph in enumerate(finger.photographs):
            if photograph.image is not None:
                yield photograph_item(finger, photograph), photograph, (number,)
    for contact in (*study.observations, *study.sequences):
        yield contact.name, contact, ()
