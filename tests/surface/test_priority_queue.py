"""The queue gives back the smallest key, whatever was put in and in whatever order."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from auricle.surface.priority_queue import drop_first, put, queue_of

keys = st.lists(st.floats(0, 100), min_size=1, max_size=60)


def take(queue):
    """Key and item of whichever head is smaller, taken out."""
    listed = queue.listed_keys[queue.counts[0]]
    if listed <= queue.keys[0]:
        item = int(queue.listed_items[queue.counts[0]])
        queue.counts[0] += item >= 0
        return float(listed), item
    key, item = float(queue.keys[0]), int(queue.items[0])
    drop_first(queue.keys, queue.items, queue.counts)
    return key, item


@given(keys)
def test_all_come_out_in_order(values):
    queue = queue_of(np.array(values))
    taken = [take(queue) for _ in values]
    assert [key for key, _ in taken] == sorted(values)
    assert sorted(item for _, item in taken) == list(range(len(values)))
    assert take(queue) == (np.inf, -1)


@given(keys, st.data())
def test_items_put_back_come_in_their_new_place(values, data):
    queue, waiting, seen = queue_of(np.array(values)), dict(enumerate(values)), 0
    while waiting:
        key, item = take(queue)
        assert key == waiting.pop(item) == min([key, *waiting.values()])
        seen += 1
        if seen < 3 * len(values) and data.draw(st.booleans()):
            waiting[item] = key + data.draw(st.floats(0, 50))
            put(queue.keys, queue.items, queue.counts, waiting[item], item)


def test_equal_keys_come_in_order_of_number():
    queue = queue_of(np.repeat([2.0, 1.0], 40))
    assert [take(queue)[1] for _ in range(80)] == [*range(40, 80), *range(40)]
