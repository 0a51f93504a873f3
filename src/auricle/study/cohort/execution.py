"""One case in a worker: computed or found finished, its files written, its fault told in a line."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from threadpoolctl import threadpool_limits

from auricle.errors import AuricleError
from auricle.foreign import printable
from auricle.study.cohort.case import Case
from auricle.study.cohort.case_files import CaseFiles


class Document(Protocol):
    """What a case yields: values that are the same to the byte on every run, and seconds."""

    @property
    def values(self) -> Mapping[str, Any]:
        """Plain data for JSON."""

    @property
    def timings(self) -> Mapping[str, float]:
        """Seconds by stage."""


class CaseFunction(Protocol):
    """Computes one case; a module's function, so that another process can find it."""

    def __call__(self, source: Path, *, parameters: Any) -> Document:
        """What is found in `source`."""


@dataclass(frozen=True)
class Outcome:
    """How one case ended.

    Attributes
    ----------
    key
        Of the case.
    error
        Why it has no result, in one line; None if it has.
    seconds
        How long it took, s; 0 if it was finished before.
    """

    key: str
    error: str | None = None
    seconds: float = 0.0


@dataclass(frozen=True)
class Work:
    """What a worker does with a case; it can be sent to another process.

    Attributes
    ----------
    compute
        Computes the case.
    parameters
        Of the computation.
    folder
        Of the study's results.
    """

    compute: CaseFunction
    parameters: Any
    folder: Path

    def __call__(self, case: Case) -> Outcome:
        """Compute a case on one thread, unless it has a result, and keep what comes of it.

        Whatever the computation raises becomes the case's one line; only results that cannot be
        written are raised, for no other case could be kept either.

        Raises
        ------
        OutputError
            If a file cannot be written.
        """
        files = CaseFiles(self.folder)
        if files.is_finished(case.key):
            return Outcome(case.key)
        files.sweep(case.key)
        start = time.perf_counter()
        try:
            with threadpool_limits(1):
                document = self.compute(Path(case.source), parameters=self.parameters)
        except Exception as fault:
            error = _line(fault, case)
            files.keep_failure(case.key, name=case.name, error=error)
            return Outcome(case.key, error, time.perf_counter() - start)
        files.keep(case.key, document.values, document.timings)
        return Outcome(case.key, seconds=time.perf_counter() - start)


def _line(fault: Exception, case: Case) -> str:
    """A fault in one line, without the folders of this machine."""
    if isinstance(fault, AuricleError):
        words = str(fault)
    elif isinstance(fault, MemoryError):
        words = "out of memory: give its worker more, or the case fewer vertices"
    else:
        words = f"internal fault ({type(fault).__name__}: {fault}): report it"
    place = Path(case.source)
    words = words.replace(str(place), place.name)
    if place.parent.name:
        words = words.replace(f"{place.parent}/", "")
    return printable(" ".join(words.split()))
