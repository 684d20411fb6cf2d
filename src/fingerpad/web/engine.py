"""The seam to the engine: how far each item is, without measuring and without reading pictures anew."""

from typing import Final

from fingerpad.exceptions import StoreError
from fingerpad.study.manifest import Contact, Study
from fingerpad.study.store import STORE_NAME, Store
from fingerpad.study.tasks import tasks_of
from fingerpad.web.open_study import OpenStudy
from fingerpad.web.scales import scales_of

_UNREADABLE: Final = (OSError, StoreError)


def item_states(study: Study, opened: OpenStudy) -> dict[str, str]:
    """Return for each observation and sequence whether it is done, failed, stale or left."""
    contacts: list[Contact] = [*study.observations, *study.sequences]
    states = dict.fromkeys((contact.name for contact in contacts), "left")
    path = opened.out / STORE_NAME
    if not path.is_file():
        return states
    try:
        with Store.open(path) as store:
            stored = store.results()
            known = [contact for contact in contacts if contact.name in stored]
            for task in tasks_of(known, scales_of(opened), opened.folder, store.digest):
                found = stored[task.contact.name]
                states[task.contact.name] = found.status if found.key == task.key else "stale"
    except _UNREADABLE:
        return states  # the run says what is wrong with it
    return states
