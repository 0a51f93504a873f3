"""Threads that work side by side, for a caller who hears of progress and may call it off."""

from collections.abc import Callable, Iterable
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from threading import Event
from types import TracebackType
from typing import ParamSpec, Self, TypeVar

from auricle.progress import Progress, silent

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")

_PATIENCE = 0.2
"""Seconds between two words to the caller."""


class Workers:
    """A pool of threads, whose work stops soon after the caller's `progress` raises.

    While results are awaited `progress` is called several times a second in the thread that waits
    for them, so that a caller can cancel also where nothing was finished. Leaving the ``with``
    block by an exception stops work that is under way at its next `pause`.

    Parameters
    ----------
    threads
        How many.
    progress
        Told what `report` was told.

    Attributes
    ----------
    threads
        How many.

    Examples
    --------
    >>> with Workers(2) as workers:
    ...     workers.each(abs, [-1, 2, -3])
    [1, 2, 3]
    """

    def __init__(self, threads: int, progress: Progress = silent) -> None:
        self.threads = threads
        self._pool = ThreadPoolExecutor(threads)
        self._progress = progress
        self._latest: tuple[str, float, float] | None = None
        self._stopped = Event()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is not None:
            self._stopped.set()
        self._pool.shutdown(cancel_futures=True)

    def report(self, stage: str, done: float, total: float) -> None:
        """Tell the caller how far a stage is, now and again while it goes on."""
        self._latest = (stage, done, total)
        self._progress(*self._latest)

    def pause(self) -> None:
        """End the work of this thread if the caller has given up.

        Raises
        ------
        concurrent.futures.CancelledError
            If so.
        """
        if self._stopped.is_set():
            raise CancelledError

    def submit(self, work: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> Future[R]:
        """Work begun in another thread; `result` waits for it."""
        return self._pool.submit(work, *args, **kwargs)

    def result(self, submitted: Future[R]) -> R:
        """What the work returned or raised; while it lasts the caller hears of progress."""
        while True:
            try:
                return submitted.result(timeout=_PATIENCE)
            except TimeoutError:
                if submitted.done():
                    raise  # the work's own
                if self._latest is not None:
                    self._progress(*self._latest)

    def each(self, work: Callable[[T], R], items: Iterable[T]) -> list[R]:
        """What `work` returns for every item, in their order."""
        submitted = [self._pool.submit(self._unless_stopped, work, item) for item in items]
        return [self.result(future) for future in submitted]

    def _unless_stopped(self, work: Callable[[T], R], item: T) -> R:
        self.pause()
        return work(item)


def slices(count: int, size: int) -> list[slice]:
    """So many items in slices of `size`, the last one shorter where they do not come out even.

    Examples
    --------
    >>> slices(5, 2)
    [slice(0, 2, None), slice(2, 4, None), slice(4, 5, None)]
    """
    return [slice(begin, min(begin + size, count)) for begin in range(0, count, size)]
