"""What a reader left out, counted by kind, for the remarks of a map or a study."""

from collections import Counter


class Omissions:
    """A count by kind, in the order the kinds were first met.

    Examples
    --------
    >>> omissions = Omissions()
    >>> omissions.add("points without a position left out")
    >>> omissions.add("points without a position left out", 2)
    >>> omissions.remarks
    ('points without a position left out: 3',)
    """

    def __init__(self) -> None:
        self._counts: Counter[str] = Counter()

    def add(self, what: str, count: int = 1) -> None:
        """Count `count` more of a kind; nothing if that is 0 or less."""
        if count > 0:
            self._counts[what] += count

    @property
    def remarks(self) -> tuple[str, ...]:
        """One phrase a kind."""
        return tuple(f"{what}: {count:,}" for what, count in self._counts.items())
