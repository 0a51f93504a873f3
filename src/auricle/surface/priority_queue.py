"""Priority queue of numbered items for keys that mostly grow: a sorted list and a heap.

All items start in a list sorted by key. An item taken from it may come back with another key,
then into a heap; the smaller of the two heads is the first of all. Where most items are taken
once or never, the list costs next to nothing.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats, Integers
from auricle.compiled import compiled

WIDTH = 4
"""Children of a place in the heap: with four, half as deep as with two, in as many cache lines."""


class Queue(NamedTuple):
    """A list and a heap; an item is in one of them or in none.

    Attributes
    ----------
    listed_keys, listed_items
        Ascending, with an infinite key at the end; shape (n + 1,).
    keys, items
        The heap; only its first places count; shape (n + 1,). The first key of an empty heap is
        infinite.
    counts
        How many were taken off the list, and how many are in the heap.
    """

    listed_keys: Floats
    listed_items: Integers
    keys: Floats
    items: NDArray[np.int32]
    counts: Integers


def queue_of(keys: Floats) -> Queue:
    """Queue of the items 0, 1, … with these keys.

    Examples
    --------
    >>> queue = queue_of(np.array([3.0, 1.0, 2.0]))
    >>> queue.counts[0] += 1  # item 1 comes off the list …
    >>> put(queue.keys, queue.items, queue.counts, 2.5, 1)  # … and goes into the heap
    >>> put(queue.keys, queue.items, queue.counts, 1.5, 3)
    >>> drop_first(queue.keys, queue.items, queue.counts)
    >>> float(queue.listed_keys[queue.counts[0]]), float(queue.keys[0]), int(queue.items[0])
    (2.0, 2.5, 1)
    """
    order = np.argsort(keys)
    if (keys[order[1:]] == keys[order[:-1]]).any():
        # The fast sort leaves the order of equal keys to the processor.
        order = np.argsort(keys, kind="stable")
    return Queue(
        np.append(keys[order], np.inf),
        np.append(order, -1),
        np.full(len(keys) + 1, np.inf),
        np.empty(len(keys) + 1, dtype=np.int32),
        np.zeros(2, dtype=np.int64),
    )


@compiled
def drop_first(keys: Floats, items: NDArray[np.int32], counts: Integers) -> None:
    """Take the first item out of the heap."""
    last = counts[1] - 1
    key, item = keys[last], items[last]
    place, child = 0, 1
    while child < last:
        for sibling in range(child + 1, min(child + WIDTH, last)):
            if keys[sibling] < keys[child]:
                child = sibling
        if keys[child] >= key:
            break
        keys[place] = keys[child]
        items[place] = items[child]
        place, child = child, WIDTH * child + 1
    keys[place] = key
    items[place] = item
    keys[last] = np.inf
    counts[1] = last


@compiled
def put(keys: Floats, items: NDArray[np.int32], counts: Integers, key: float, item: int) -> None:
    """Put an item that is in neither into the heap."""
    place = counts[1]
    counts[1] += 1
    while place > 0 and keys[(place - 1) // WIDTH] > key:
        keys[place] = keys[(place - 1) // WIDTH]
        items[place] = items[(place - 1) // WIDTH]
        place = (place - 1) // WIDTH
    keys[place] = key
    items[place] = item
