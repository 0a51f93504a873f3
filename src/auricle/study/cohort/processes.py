"""Cases side by side on this machine: one process a worker, which may be killed at any moment."""

import multiprocessing
import os
import signal
import threading
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess

from auricle.errors import SolverError
from auricle.isolation import ONE_THREAD
from auricle.study.cohort.case import Case
from auricle.study.cohort.execution import Outcome

MOST_ATTEMPTS = 3
"""How often a case is begun whose worker dies; after that the case is taken for the cause."""

_MOST_STILLBORN = 20
"""How many workers in a row may die before they are ready; after that it is no accident."""

_NEW_PROCESS = multiprocessing.get_context("spawn")
_PATIENCE = 10.0
"""Seconds a process has to end after it was told to."""

CaseWork = Callable[[Case], Outcome]


@dataclass(eq=False)
class _Worker:
    """A process, the way to speak with it, whether it has come up, and the case it is at."""

    process: SpawnProcess
    connection: Connection
    ready: bool = False
    case: Case | None = None


class LocalWorkers:
    """Processes of this machine, each with one thread.

    A worker that dies, by its case or by a kill, is replaced and its case begun again after all
    others, up to `MOST_ATTEMPTS` times; no other case notices.

    Parameters
    ----------
    count
        How many.
    """

    def __init__(self, count: int) -> None:
        self.count = count

    def outcomes(self, cases: Sequence[Case], work: CaseWork) -> Iterator[Outcome]:
        """Outcomes of all cases, as they come.

        Raises
        ------
        AuricleError
            As `work` does, which ends all workers.
        SolverError
            If workers die again and again before they are ready.
        """
        queue = _Queue(deque(cases))
        crew = [_hired(work) for _ in range(min(self.count, len(cases)))]
        try:
            while queue.waiting or any(worker.case for worker in crew):
                crew = [_replaced_if_dead(worker, work) for worker in crew]
                for worker in crew:
                    _give(worker, queue)
                heard = {each.connection: each for each in crew if each.case or not each.ready}
                for connection in wait(list(heard), timeout=_PATIENCE):
                    outcome = _heard(heard[connection], queue)  # type: ignore[index]
                    if outcome is not None:
                        yield outcome
        finally:
            for worker in crew:
                _dismiss(worker)


@dataclass(eq=False)
class _Queue:
    """Cases that wait, how often each lost its worker, and workers that never came up."""

    waiting: deque[Case]
    deaths: Counter[str] = field(default_factory=Counter)
    stillborn: int = 0


def _hired(work: CaseWork) -> _Worker:
    here, there = _NEW_PROCESS.Pipe()
    process = _NEW_PROCESS.Process(target=_serve, args=(there, work), daemon=True)
    with _one_thread():
        process.start()
    there.close()
    return _Worker(process, here)


def _replaced_if_dead(worker: _Worker, work: CaseWork) -> _Worker:
    if worker.case is not None or worker.process.is_alive():
        return worker
    _dismiss(worker)
    return _hired(work)


def _give(worker: _Worker, queue: _Queue) -> None:
    """Set an idle worker to the next case; one that has just died leaves it where it is."""
    if not worker.ready or worker.case is not None or not queue.waiting:
        return
    try:
        worker.connection.send(queue.waiting[0])
    except OSError:
        worker.process.join()
        return
    worker.case = queue.waiting.popleft()


def _heard(worker: _Worker, queue: _Queue) -> Outcome | None:
    """The outcome a worker tells; None if it only came up, or died and the case waits again."""
    case, worker.case = worker.case, None
    try:
        said: Outcome | Exception | None = worker.connection.recv()
    except (EOFError, OSError):
        worker.process.join()
        how = _ending(worker.process.exitcode or 0)
        if case is not None:
            return _after_death(case, how, queue)
        _note_stillborn(how, queue)
        return None
    if isinstance(said, Exception):
        raise said
    if said is None:
        worker.ready = True
        queue.stillborn = 0
    return said


def _note_stillborn(how: str, queue: _Queue) -> None:
    queue.stillborn += 1
    if queue.stillborn >= _MOST_STILLBORN:
        raise SolverError(
            f"{queue.stillborn} workers ended before they were ready, the last by {how}: look "
            "whether there is memory for them, or ask for fewer"
        )


def _after_death(case: Case, how: str, queue: _Queue) -> Outcome | None:
    queue.deaths[case.key] += 1
    if queue.deaths[case.key] < MOST_ATTEMPTS:
        queue.waiting.append(case)
        return None
    return Outcome(
        case.key,
        f"{case.name}: ended its worker {MOST_ATTEMPTS} times, last by {how}: look whether it "
        "needs more memory than there is",
    )


def _ending(code: int) -> str:
    return signal.Signals(-code).name if code < 0 else f"exit code {code}"


def _dismiss(worker: _Worker) -> None:
    """End a process, whatever it does."""
    worker.connection.close()
    worker.process.terminate()
    worker.process.join(_PATIENCE)
    if worker.process.is_alive():
        worker.process.kill()
        worker.process.join()
    worker.process.close()


def _serve(connection: Connection, work: CaseWork) -> None:
    """What a worker does all its life: a case comes in, its outcome goes out."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the study itself is interrupted, and ends it
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    connection.send(None)
    while True:
        try:
            case = connection.recv()
        except EOFError:
            return
        try:
            said: Outcome | Exception = work(case)
        except Exception as fault:  # told to the study, which raises it
            said = fault
        connection.send(said)


def _leave_with_parent() -> None:
    """End this process when the one that began it is gone, even if that was killed."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def _one_thread() -> Iterator[None]:
    """An environment in which the libraries of a new process begin with one thread."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(ONE_THREAD)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
