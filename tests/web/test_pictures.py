"""The cache of pictures: what is kept, and up to what size."""

import threading
import time
from contextlib import suppress

from fingerpad.web.pictures import Cache


def test_what_was_used_last_is_kept_up_to_the_size():
    cache, made = Cache(10, len), []
    for key in "abacab":
        cache.get(key, lambda key=key: made.append(key) or bytes(4))
    # c made room by b, which had not been used for longest.
    assert made == ["a", "b", "c", "b"]


def test_a_value_is_made_once_though_the_first_who_made_it_failed():
    cache, made, started = Cache(10, len), [], threading.Barrier(3)

    def make():
        made.append("a")
        time.sleep(0.1)  # until the others wait for this one
        if len(made) == 1:
            raise ValueError("as planned")
        return bytes(4)

    def ask():
        started.wait(60)
        with suppress(ValueError):
            cache.get("a", make)

    asking = [threading.Thread(target=ask) for _ in range(3)]
    for thread in asking:
        thread.start()
    for thread in asking:
        thread.join()
    assert made == ["a", "a"]
    cache.get("b", lambda: bytes(6))  # together they fit to the last byte
    cache.get("a", make)
    assert made == ["a", "a"]
