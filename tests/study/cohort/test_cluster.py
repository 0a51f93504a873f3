"""Cases on a dask cluster: what comes of it is what one process leaves, byte for byte."""

import os
import signal

import pytest

from auricle.errors import InputError
from auricle.study.cohort import cluster
from auricle.study.cohort.cluster import ClusterWorkers, connected
from auricle.study.cohort.execution import Work
from auricle.study.cohort.identity import identified
from auricle.study.cohort.processes import LocalWorkers
from auricle.study.cohort.runner import run_cases
from auricle.study.cohort.sources import expanded


def test_a_missing_library_is_named_with_what_to_install(monkeypatch) -> None:
    monkeypatch.setattr(cluster.util, "find_spec", lambda _: None)
    with (
        pytest.raises(InputError, match=r"the package distributed: install auricle\[cluster\]"),
        connected("tcp://127.0.0.1:8786"),
    ):
        pass


def test_a_scheduler_file_that_is_not_there_is_named(tmp_path) -> None:
    pytest.importorskip("distributed", reason="no dask.distributed: install auricle[cluster]")
    with pytest.raises(InputError, match="does not exist"), connected(str(tmp_path / "none.json")):
        pass


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")  # dask's own, in its threads
def test_a_cluster_that_loses_a_worker_leaves_what_one_process_leaves(
    stand_ins, inputs, tmp_path
) -> None:
    distributed = pytest.importorskip(
        "distributed", reason="no dask.distributed: install auricle[cluster]"
    )
    (inputs / "atrium07.vtp").write_text("bad")
    parameters = stand_ins.Parameters(seconds=0.2)
    cases = identified(expanded([str(inputs)]), parameters)
    run_cases(cases, Work(stand_ins.digest, parameters, tmp_path / "alone"), LocalWorkers(2))

    ended = []

    def tell(standing) -> None:
        ended.append(standing)
        if len(ended) == 5:
            os.kill(next(iter(pids.values())), signal.SIGKILL)

    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
        ) as machines,
        distributed.Client(machines) as client,
    ):
        pids = client.run(os.getpid)
        work = Work(stand_ins.digest, parameters, tmp_path / "cluster")
        tally = run_cases(cases, work, ClusterWorkers(client), tell=tell)
    assert (len(tally.computed), len(tally.failed)) == (19, 1)
    assert len(ended) == 20
    for name in ("cases", "failures"):
        alone, there = (
            {path.name: path.read_bytes() for path in (tmp_path / where / name).iterdir()}
            for where in ("alone", "cluster")
        )
        assert alone == there


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_a_slurm_job_is_one_core_and_one_thread() -> None:
    jobqueue = pytest.importorskip(
        "dask_jobqueue", reason="no dask-jobqueue: install auricle[cluster]"
    )
    with jobqueue.SLURMCluster(
        **cluster.job_options(),
        scheduler_options={"host": "127.0.0.1", "dashboard_address": None},
    ) as machines:
        script = machines.job_script()
    assert "--cpus-per-task=1" in script
    assert "--nthreads 1" in script
    assert "--mem=4G" in script
