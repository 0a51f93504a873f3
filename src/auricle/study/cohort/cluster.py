"""Cases on many machines: a dask.distributed scheduler, or SLURM by dask-jobqueue."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module, util
from pathlib import Path
from typing import Any

from auricle.errors import InputError
from auricle.study.cohort.case import Case
from auricle.study.cohort.case_files import CaseFiles
from auricle.study.cohort.execution import Outcome, Work

_CONNECTING = 30.0
"""Seconds to wait for a scheduler."""
_JOB_MEMORY = "4GiB"


class ClusterWorkers:
    """The workers of a dask.distributed client; start them with one thread each.

    The folder of the results must be the same on all machines. A worker that dies is replaced by
    dask and its case begun again, as often as dask's setting ``allowed-failures`` says.

    Parameters
    ----------
    client
        A `distributed.Client`.
    """

    def __init__(self, client: Any) -> None:
        self.client = client

    def outcomes(self, cases: Sequence[Case], work: Callable[[Case], Outcome]) -> Iterator[Outcome]:
        """Outcomes of all cases, as they come.

        Raises
        ------
        InputError
            If a result that was written there is not found here.
        """
        distributed = import_module("distributed")
        futures = {
            self.client.submit(work, case, key=f"auricle-{case.key}", pure=False): case
            for case in cases
        }
        try:
            for future in distributed.as_completed(list(futures)):
                yield _outcome(future, futures[future], work)
        finally:
            self.client.cancel(list(futures))


def _outcome(future: Any, case: Case, work: Callable[[Case], Outcome]) -> Outcome:
    fault = future.exception()
    if fault is not None:
        words = " ".join(str(fault).split())
        return Outcome(
            case.key, f"{case.name}: lost on the cluster ({type(fault).__name__}: {words})"
        )
    outcome: Outcome = future.result()
    if outcome.error is None and isinstance(work, Work):
        _require_shared(CaseFiles(work.folder), case)
    return outcome


def _require_shared(files: CaseFiles, case: Case) -> None:
    if not files.is_finished(case.key):
        raise InputError(
            f"{files.folder}: the cluster's results are not here: name a folder all machines share"
        )


@contextmanager
def connected(scheduler: str) -> Iterator[ClusterWorkers]:
    """Workers of a scheduler, by its address or by the JSON file it wrote.

    Raises
    ------
    InputError
        If dask.distributed is missing or there is no scheduler.
    """
    distributed = _library("distributed")
    by_file = scheduler.endswith(".json")
    where = {"scheduler_file": scheduler} if by_file else {"address": scheduler}
    if by_file and not Path(scheduler).is_file():
        raise InputError(f"{scheduler}: does not exist: give the scheduler's file or address")
    try:
        client = distributed.Client(**where, timeout=_CONNECTING)
    except (OSError, ValueError) as fault:
        raise InputError(f"{scheduler}: no scheduler answers: start one or correct it") from fault
    with client:
        yield ClusterWorkers(client)


@contextmanager
def slurm(jobs: int) -> Iterator[ClusterWorkers]:
    """Workers in `jobs` SLURM jobs of one core, set up by dask's own settings for ``slurm``.

    Queue, account, time and all else are dask's settings (``jobqueue.slurm``); memory, where they
    leave it open, is 4 GiB a job.

    Raises
    ------
    InputError
        If dask-jobqueue is missing.
    """
    jobqueue = _library("dask_jobqueue")
    with jobqueue.SLURMCluster(**job_options()) as cluster:
        cluster.scale(jobs=jobs)
        with _library("distributed").Client(cluster) as client:
            yield ClusterWorkers(client)


def job_options() -> dict[str, Any]:
    """What every job is given: one core, one process, and memory if dask's settings name none."""
    settings = import_module("dask.config").get("jobqueue.slurm", {})
    options: dict[str, Any] = {"cores": 1, "processes": 1}
    if settings.get("memory") is None:
        options["memory"] = _JOB_MEMORY
    return options


def _library(name: str) -> Any:
    if util.find_spec(name) is None:
        package = name.replace("_", "-")
        raise InputError(f"a cluster needs the package {package}: install auricle[cluster]")
    return import_module(name)
