"""Cases on worker processes: none lost, none computed twice, the same bytes whoever is killed."""

import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import numpy as np
import psutil
import pytest

from auricle.errors import OutputError, SolverError
from auricle.study.cohort import processes
from auricle.study.cohort.case import Case
from auricle.study.cohort.case_files import CaseFiles
from auricle.study.cohort.execution import Work
from auricle.study.cohort.identity import identified
from auricle.study.cohort.processes import MOST_ATTEMPTS, LocalWorkers
from auricle.study.cohort.runner import run_cases, unheard
from auricle.study.cohort.shard import Shard
from auricle.study.cohort.sources import expanded


def cases_in(inputs: Path, parameters) -> tuple[Case, ...]:
    return identified(expanded([str(inputs)]), parameters)


def results(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / "cases").glob("[!.]*.json")}


def times(folder: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in (folder / "cases").glob("[!.]*.json")}


@pytest.fixture
def run(stand_ins, inputs, tmp_path):
    """Runs the study of `inputs` into `tmp_path/NAME`."""

    def study(name: str, *, workers=1, seconds=0.0, shard=None, tell=unheard):
        parameters = stand_ins.Parameters(seconds=seconds)
        cases = cases_in(inputs, parameters)
        work = Work(stand_ins.digest, parameters, tmp_path / name)
        chosen = cases if shard is None else shard.of(cases)
        return run_cases(chosen, work, LocalWorkers(workers), tell=tell)

    return study


def children() -> list[psutil.Process]:
    """The workers of this process: not the tracker of resources."""
    return [
        child
        for child in psutil.Process().children()
        if child.status() != psutil.STATUS_ZOMBIE and "spawn_main" in " ".join(child.cmdline())
    ]


def kill_at_random(rng: np.random.Generator, times: int):
    """Something to be told of ended cases, that kills a worker at its first calls."""
    left = [times]

    def tell(_) -> None:
        if left[0]:
            left[0] -= 1
            time.sleep(rng.uniform(0, 0.05))
            alive = children()
            if alive:
                alive[rng.integers(len(alive))].send_signal(signal.SIGKILL)

    return tell


def test_every_case_ends_once_and_has_a_whole_result_with_its_timings_apart(run, tmp_path) -> None:
    told = []
    tally = run("out", workers=2, tell=told.append)
    assert len(tally.computed) == 20
    assert [standing.n_done for standing in told] == list(range(1, 21))
    assert told[-1].seconds_left == 0
    files = CaseFiles(tmp_path / "out")
    for case in tally.computed:
        assert files.values(case.key)["name"] == f"{case.name}.vtp"
        assert set(files.timings(case.key)) == {"hash"}
    assert len(results(tmp_path / "out")) == 20


def test_workers_have_one_thread_each(run, tmp_path) -> None:
    tally = run("out", workers=2)
    files = CaseFiles(tmp_path / "out")
    assert {files.values(case.key)["threads"] for case in tally.computed} == {"1"}


def test_a_second_run_computes_nothing_and_touches_nothing(run, tmp_path) -> None:
    run("out")
    before = times(tmp_path / "out")
    tally = run("out", workers=2)
    assert (len(tally.found), tally.computed, tally.failed) == (20, (), ())
    assert times(tmp_path / "out") == before


def test_what_is_missing_or_changed_is_computed_and_nothing_else(run, inputs, tmp_path) -> None:
    run("out")
    (inputs / "atrium03.vtp").write_text("another surface\n")
    next((tmp_path / "out" / "cases").iterdir()).unlink()
    assert 1 <= len(run("out").computed) <= 2
    assert len(run("out").found) == 20


def test_other_parameters_are_another_result(run, tmp_path) -> None:
    run("out")
    assert len(run("out", seconds=0.001).computed) == 20
    assert len(results(tmp_path / "out")) == 40


def test_one_bad_case_among_twenty_leaves_nineteen_and_its_error(run, inputs, tmp_path) -> None:
    (inputs / "atrium07.vtp").write_text("bad")
    tally = run("out", workers=2)
    assert len(tally.computed) == 19
    ((case, error),) = tally.failed
    assert (case.name, error) == (
        "atrium07",
        "atrium07.vtp: bad from the first line: export it again",
    )
    assert CaseFiles(tmp_path / "out").failure(case.key) == error
    assert str(tmp_path) not in (tmp_path / "out" / "failures" / f"{case.key}.json").read_text()


def test_a_fault_of_the_program_is_told_in_one_line_too(run, inputs) -> None:
    (inputs / "atrium07.vtp").write_text("fault")
    ((_, error),) = run("out").failed
    assert error == "internal fault (ZeroDivisionError: by nought): report it"


def test_a_failed_case_is_tried_again_and_its_failure_forgotten(run, stand_ins, inputs, tmp_path):
    (inputs / "atrium07.vtp").write_text("bad")
    run("out")
    (case,) = (each for each in cases_in(inputs, stand_ins.Parameters()) if each.name == "atrium07")
    assert len(run("out").failed) == 1
    CaseFiles(tmp_path / "out").keep(case.key, {}, {})
    assert run("out").failed == ()
    assert not any((tmp_path / "out" / "failures").iterdir())


def test_a_case_that_ends_its_worker_is_given_up_and_the_others_go_on(run, inputs, tmp_path):
    (inputs / "atrium07.vtp").write_text("deadly")
    tally = run("out", workers=2)
    assert len(tally.computed) == 19
    ((case, error),) = tally.failed
    assert f"ended its worker {MOST_ATTEMPTS} times, last by exit code 7" in error
    assert CaseFiles(tmp_path / "out").failure(case.key) == error


@pytest.mark.parametrize("seed", [1, 2])
def test_killed_workers_lose_no_case_and_change_no_byte(run, tmp_path, seed) -> None:
    run("undisturbed")
    tell = kill_at_random(np.random.default_rng(seed), times=2)
    tally = run("out", workers=2, seconds=0.0, tell=tell)
    assert (len(tally.computed), tally.failed) == (20, ())
    assert results(tmp_path / "out") == results(tmp_path / "undisturbed")


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10, 20))
def test_ten_kills_lose_no_case_and_change_no_byte(run, tmp_path, seed) -> None:
    run("undisturbed", seconds=0.05, workers=2)
    tell = kill_at_random(np.random.default_rng(seed), times=10)
    tally = run("out", workers=2, seconds=0.05, tell=tell)
    assert (len(tally.computed), tally.failed) == (20, ())
    assert results(tmp_path / "out") == results(tmp_path / "undisturbed")


def test_a_killed_study_is_resumed_where_it_stood(run, stand_ins, inputs, tmp_path) -> None:
    """Its workers go with it, and what was finished is not touched again."""
    out = tmp_path / "out"
    cases = cases_in(inputs, stand_ins.Parameters(seconds=0.1))
    program = textwrap.dedent(
        f"""
        import sys
        sys.path[:0] = {[str(Path(stand_ins.__file__).parent), *sys.path]!r}
        from pathlib import Path
        from case_stand_ins import Parameters, digest
        from auricle.study.cohort.case import Case
        from auricle.study.cohort.execution import Work
        from auricle.study.cohort.processes import LocalWorkers
        from auricle.study.cohort.runner import run_cases
        if __name__ == "__main__":
            work = Work(digest, Parameters(seconds=0.1), Path({str(out)!r}))
            run_cases({cases!r}, work, LocalWorkers(2))
        """
    )
    script = tmp_path / "study.py"
    script.write_text(program)
    with subprocess.Popen([sys.executable, str(script)]) as study:
        deadline = time.monotonic() + 60
        while len(results(out)) < 5 and time.monotonic() < deadline:
            time.sleep(0.02)
        crew = psutil.Process(study.pid).children(recursive=True)
        study.kill()
    assert psutil.wait_procs(crew, timeout=10)[1] == []
    before = times(out)
    assert 5 <= len(before) < 20
    tally = run("out", seconds=0.1, workers=2)
    assert len(tally.found) == len(before)
    assert len(tally.computed) == 20 - len(before)
    assert {name: times(out)[name] for name in before} == before


def test_shards_together_are_the_whole_study(run, tmp_path) -> None:
    run("whole")
    sizes = [len(run("out", shard=Shard(index, 3)).computed) for index in (3, 1, 2)]
    assert sizes == [6, 7, 7]
    assert results(tmp_path / "out") == results(tmp_path / "whole")
    assert len(run("out").found) == 20


def test_workers_that_never_come_up_end_the_study_with_a_reason(
    run, stand_ins, monkeypatch
) -> None:
    monkeypatch.setattr(processes, "_MOST_STILLBORN", 2)
    Path(stand_ins.__file__).unlink()  # so that no worker can find the case function
    with pytest.raises(SolverError, match="2 workers ended before they were ready"):
        run("out")


def test_a_place_that_cannot_be_written_ends_the_study(run, tmp_path) -> None:
    (tmp_path / "out").write_text("a file")
    with pytest.raises(OutputError, match="cannot be written"):
        run("out", workers=2)
    assert children() == []


def test_the_remains_of_a_killed_writer_are_swept_away(run, stand_ins, inputs, tmp_path) -> None:
    case = cases_in(inputs, stand_ins.Parameters())[0]
    remains = tmp_path / "out" / "cases" / f".{case.key}.abc123.json"
    remains.parent.mkdir(parents=True)
    remains.write_text("{")
    run("out")
    assert not remains.exists()
