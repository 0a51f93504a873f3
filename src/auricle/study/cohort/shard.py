"""The share of a study that one job of an array takes."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

from auricle.errors import InputError

T = TypeVar("T")


@dataclass(frozen=True)
class Shard:
    """Part `index` of `count`, counted from 1.

    Examples
    --------
    Every case is in one shard and in no other:

    >>> [Shard(index, 3).of(range(7)) for index in (1, 2, 3)]
    [(0, 3, 6), (1, 4), (2, 5)]
    """

    index: int
    count: int

    def __post_init__(self) -> None:
        if not 1 <= self.index <= self.count:
            raise InputError(f"shard {self.index}/{self.count}: give one from 1 to {self.count}")

    def of(self, cases: Sequence[T]) -> tuple[T, ...]:
        """The cases of this shard, in order."""
        return tuple(cases[self.index - 1 :: self.count])


def shard_from_text(text: str) -> Shard:
    """A shard as it is written, ``2/8``.

    Raises
    ------
    InputError
        If it is not.
    """
    found = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text.strip())
    if found is None:
        raise InputError(f"shard {text!r}: write it as 2/8")
    return Shard(int(found[1]), int(found[2]))
