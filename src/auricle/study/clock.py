"""The clock of a run: wall time by stage, and where the work stands among the stages."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from auricle.progress import Progress


@dataclass
class Clock:
    """Tells progress of each stage and keeps how long it took.

    Attributes
    ----------
    progress
        Told when a stage begins and ends.
    seconds
        Wall time by stage, s.
    """

    progress: Progress
    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time what is done inside."""
        self.progress(name, 0, 1)
        start = time.perf_counter()
        yield
        self.seconds[name] = round(time.perf_counter() - start, 3)
        self.progress(name, 1, 1)
