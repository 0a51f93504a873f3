"""The stream of a long piece of work: its progress line by line, its result last."""

import asyncio
import json
import threading
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from typing import Any

from auricle.errors import AuricleError
from auricle.viewer.endpoints import Work

SECONDS_BETWEEN = 0.1
"""Least time between two lines of one stage."""
_POLL_SECONDS = 0.1


class CancelledError(Exception):
    """Raised in the work when the page no longer waits for it."""


class _Reporter:
    """Progress from the thread of the work into the queue of the stream."""

    def __init__(self, put: Callable[[Mapping[str, Any]], None]) -> None:
        self.put = put
        self.cancelled = threading.Event()
        self._stage, self._last = "", 0.0

    def __call__(self, stage: str, done: float, total: float) -> None:
        if self.cancelled.is_set():
            raise CancelledError
        now = time.monotonic()
        if stage == self._stage and now - self._last < SECONDS_BETWEEN and done < total:
            return
        self._stage, self._last = stage, now
        self.put({"stage": stage, "done": float(done), "total": float(total)})


async def lines(
    work: Work,
    *,
    is_gone: Callable[[], Awaitable[bool]],
    finished: Callable[[], None],
) -> AsyncIterator[bytes]:
    """Run `work` in a thread; its lines of JSON as they come.

    Each is ``{"stage", "done", "total"}``; the last one ``{"result": …}`` or ``{"error": …}``.

    Parameters
    ----------
    work
        What to do.
    is_gone
        Whether nobody listens any more: the work is then cancelled at its next report.
    finished
        Called when the work has ended, whichever way.
    """
    loop = asyncio.get_running_loop()
    queue: asyncio.Queue[Mapping[str, Any]] = asyncio.Queue()
    reporter = _Reporter(lambda line: _put(loop, queue, line))
    thread = threading.Thread(
        target=_run, args=(work, reporter, finished), name="auricle work", daemon=True
    )
    thread.start()
    try:
        while True:
            try:
                line = await asyncio.wait_for(queue.get(), _POLL_SECONDS)
            except TimeoutError:
                if await is_gone():
                    return
                continue
            yield json.dumps(line, allow_nan=False).encode() + b"\n"
            if "result" in line or "error" in line:
                return
    finally:
        reporter.cancelled.set()


def _put(
    loop: asyncio.AbstractEventLoop,
    queue: asyncio.Queue[Mapping[str, Any]],
    line: Mapping[str, Any],
) -> None:
    if not loop.is_closed():
        loop.call_soon_threadsafe(queue.put_nowait, line)


def _run(work: Work, reporter: _Reporter, finished: Callable[[], None]) -> None:
    last: Mapping[str, Any]
    try:
        last = {"result": dict(work.run(reporter))}
    except CancelledError:
        last = {"error": "cancelled"}
    except AuricleError as fault:
        last = {"error": str(fault)}
    except MemoryError:
        last = {"error": "out of memory: give a smaller file or ask for fewer harmonics"}
    except Exception as fault:
        last = {"error": f"internal fault ({type(fault).__name__}: {fault}): please report it"}
    finally:
        finished()
    reporter.put(last)
