"""The cache of pictures: what is kept, and up to what size."""

import threading
import time

import pytest

from fingerpad.web.pictures import Cache


def test_what_was_used_last_is_kept_up_to_the_size():
    cache, made = Cache(10, len), []
    for key in "abacab":
        cache.get(key, lambda key=key: made.append(key) or bytes(4))
    # c made room by b, which had not been used for longest.
    assert made == ["a", "b", "c", "b"]


def test_a_value_is_made_once_though_the_first_who_made_it_failed():
    cache, made = Cache(10, len), []
    failing, fail, making, finish = (threading.Event() for _ in range(4))

    def fail_on_signal():
        failing.set()
        assert fail.wait(60)
        raise ValueError("as planned")

    def make_on_signal():
        made.append("a")
        making.set()
        assert finish.wait(60)
        return bytes(4)

    def ask_and_fail():
        with pytest.raises(ValueError, match="as planned"):
            cache.get("a", fail_on_signal)

    first = threading.Thread(target=ask_and_fail)
    first.start()
    assert failing.wait(60)
    second = threading.Thread(target=cache.get, args=("a", make_on_signal))
    second.start()
    time.sleep(0.2)  # until it waits for the first
    fail.set()
    assert making.wait(60)
    third = threading.Thread(target=cache.get, args=("a", make_on_signal))
    third.start()
    time.sleep(0.2)
    finish.set()
    for thread in (first, second, third):
        thread.join()
    assert made == ["a"]
    cache.get("b", lambda: bytes(6))  # together they fit to the last byte
    cache.get("a", make_on_signal)
    assert made == ["a"]
