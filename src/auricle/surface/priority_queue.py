"""Priority queue of numbered items for keys that mostly grow: buckets and a small heap.

A bucket holds the items whose keys begin with the same bits, so that its keys are at most an
eighth apart. Items of the first bucket are in a heap; when that is empty, the next bucket is
taken, and whoever takes it may put each item back under another key. An item far from its turn is
so put in or forgotten at the cost of a note, and the heap stays small enough for the processor's
cache.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats, Integers
from auricle.compiled import compiled_in_place

Items = NDArray[np.int32]

WIDTH = 4
"""Children of a place in the heap: with four, half as deep as with two, in as many cache lines."""
N_BUCKETS = 1 << 14
SHIFT = 49
"""Bits of a key that a bucket leaves open: all but the exponent and three more."""
N_IN_HEAP, BUCKET = 0, 1


class Queue(NamedTuple):
    """Buckets and a heap; an item is in one of them or in none.

    Attributes
    ----------
    heads
        First item of each bucket, -1 where it is empty.
    links
        The item after each one in its bucket, -1 after the last; shape (n,).
    keys, items
        The heap; only its first places count; shape (n + 1,). The first key of an empty heap is
        infinite.
    counts
        ``N_IN_HEAP``; ``BUCKET``: the one whose items the heap holds, with all below it.
    """

    heads: Items
    links: Items
    keys: Floats
    items: Items
    counts: Integers


def queue_for(n_items: int) -> Queue:
    """Return an empty queue for items 0, 1, …, `n_items` - 1.

    Examples
    --------
    >>> queue, batch = queue_for(3), np.empty(3, dtype=np.int32)
    >>> for item, key in enumerate([3.0, 1.0, 2.0]):
    ...     put(queue, key, item)
    >>> batch[: next_bucket(queue, batch)].tolist()  # item 1 is in the first bucket alone …
    [1]
    >>> put(queue, 1.01, 1)  # … and goes into the heap
    >>> float(queue.keys[0]), int(queue.items[0])
    (1.01, 1)
    """
    keys = np.empty(n_items + 1)
    keys[0] = np.inf
    return Queue(
        np.full(N_BUCKETS, -1, dtype=np.int32),
        np.empty(n_items, dtype=np.int32),
        keys,
        np.empty(n_items + 1, dtype=np.int32),
        np.array([0, -1], dtype=np.int64),
    )


@compiled_in_place
def put(queue: Queue, key: float, item: int) -> None:
    """Put an item that is in neither into its bucket, or the heap; the key is not negative."""
    heads, links, keys, items, counts = queue
    bucket = (np.float64(key).view(np.int64) >> SHIFT) & (N_BUCKETS - 1)  # for -0.0 the last bits
    if bucket > counts[BUCKET]:
        links[item] = heads[bucket]
        heads[bucket] = item
        return
    place = counts[N_IN_HEAP]
    counts[N_IN_HEAP] += 1
    while place > 0:
        parent = (place - 1) // WIDTH
        if not _precedes(key, item, keys[parent], items[parent]):
            break
        keys[place] = keys[parent]
        items[place] = items[parent]
        place = parent
    keys[place] = key
    items[place] = item


@compiled_in_place
def next_bucket(queue: Queue, batch: Items) -> int:
    """Take the items of the next bucket into `batch`; return how many, 0 once all are empty."""
    heads, links, _, _, counts = queue
    for bucket in range(counts[BUCKET] + 1, N_BUCKETS):
        item = heads[bucket]
        if item >= 0:
            heads[bucket] = -1
            counts[BUCKET] = bucket
            n_taken = 0
            while item >= 0:
                batch[n_taken] = item
                n_taken += 1
                item = links[item]
            return n_taken
    return 0


@compiled_in_place
def drop_first(queue: Queue) -> None:
    """Take the first item out of the heap."""
    _, _, keys, items, counts = queue
    last = counts[N_IN_HEAP] - 1
    key, item = keys[last], items[last]
    place, child = 0, 1
    while child < last:
        for sibling in range(child + 1, min(child + WIDTH, last)):
            if _precedes(keys[sibling], items[sibling], keys[child], items[child]):
                child = sibling
        if not _precedes(keys[child], items[child], key, item):
            break
        keys[place] = keys[child]
        items[place] = items[child]
        place, child = child, WIDTH * child + 1
    keys[place] = key
    items[place] = item
    if last == 0:
        keys[0] = np.inf
    counts[N_IN_HEAP] = last


@compiled_in_place
def _precedes(key: float, item: int, other_key: float, other_item: int) -> bool:
    """Whether an item comes before another; of equal keys, the one with the smaller number."""
    return key < other_key or (key == other_key and item < other_item)
