"""The queue gives back the smallest key, whatever was put in and in whatever order."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.surface.priority_queue import drop_first, next_bucket, put, queue_for

key = st.one_of(st.floats(0, 100), st.floats(0, 1e-9), st.sampled_from([0.0, -0.0, 1e300]))
keys = st.lists(key, min_size=1, max_size=60)


def queue_of(values):
    """A queue with item i under the i-th key."""
    queue = queue_for(len(values))
    for item, value in enumerate(values):
        put(queue, value, item)
    return queue


def take(queue, known):
    """Key and item of the first, taken out; nothing once the queue is empty."""
    batch = np.empty(len(queue.links), dtype=np.int32)
    while queue.counts[0] == 0:
        n_items = next_bucket(queue, batch)
        if n_items == 0:
            return None
        for item in batch[:n_items].tolist():
            put(queue, known[item], item)
    first = float(queue.keys[0]), int(queue.items[0])
    drop_first(queue)
    return first


@settings(deadline=None)
@given(keys)
def test_all_come_out_in_order(values):
    queue, known = queue_of(values), dict(enumerate(values))
    taken = [take(queue, known) for _ in values]
    assert [key for key, _ in taken] == sorted(values)
    assert sorted(item for _, item in taken) == list(range(len(values)))
    assert take(queue, known) is None


@settings(deadline=None)
@given(keys, st.data())
def test_items_put_back_come_in_their_new_place(values, data):
    """Also where the new key is below all that came before."""
    queue, known, seen = queue_of(values), dict(enumerate(values)), 0
    waiting = dict(known)
    while waiting:
        key, item = take(queue, known)
        assert key == waiting.pop(item) == min([key, *waiting.values()])
        seen += 1
        if seen < 3 * len(values) and data.draw(st.booleans()):
            known[item] = waiting[item] = data.draw(st.floats(0, 200))
            put(queue, known[item], item)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_thousands_come_out_in_order(seed):
    values = 10.0 ** np.random.default_rng(seed).uniform(-12, 3, size=3000)
    queue, known = queue_of(values), dict(enumerate(values))
    assert [take(queue, known)[1] for _ in values] == np.argsort(values).tolist()


def test_equal_keys_come_in_order_of_number():
    values = np.repeat([2.0, 1.0], 40)
    queue, known = queue_of(values), dict(enumerate(values))
    assert [take(queue, known)[1] for _ in range(80)] == [*range(40, 80), *range(40)]
