"""How long work tells its caller where it stands."""

from typing import Protocol


class Progress(Protocol):
    """Called with a stage's name and how much of it is done; may raise to cancel the work."""

    def __call__(self, stage: str, done: float, total: float) -> None:
        """Take notice that `done` of `total` parts of `stage` are finished."""


def silent(stage: str, done: float, total: float) -> None:
    """Take notice of nothing: the default of every function that can report progress."""
