"""The command on many cases: a study from its file to its report, on one machine or many."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from auricle.cli.options import FolderOption, require_folder
from auricle.errors import CohortError

if TYPE_CHECKING:
    from auricle.study.cohort.case import Case
    from auricle.study.cohort.runner import Crew, Standing
    from auricle.study.cohort.study_file import Study
    from auricle.study.paper.parameters import PaperParameters

_BETWEEN_LINES = 1.0
"""Seconds between two lines on cases that went well."""


def study(
    entries: Annotated[
        list[str],
        typer.Argument(
            metavar="STUDY.toml|CASE…",
            help="A study's file; or its cases: surfaces, CTs, folders of them, patterns, and "
            "generated ones as phantom:seed=1..7,preset=medium or atrium:seed=1..7.",
            show_default=False,
        ),
    ],
    output: FolderOption,
    workers: Annotated[
        int, typer.Option(min=1, help="Processes on this machine, of one thread each.")
    ] = 1,
    shard: Annotated[
        str,
        typer.Option(
            metavar="I/N",
            help="Compute part I of N only, as in a job array; a run without it gathers them.",
            show_default=False,
        ),
    ] = "",
    gather: Annotated[
        bool, typer.Option("--gather", help="Compute nothing: report on what is there.")
    ] = False,
    scheduler: Annotated[
        str,
        typer.Option(
            metavar="ADDRESS|FILE.json",
            help="Compute on the workers of this dask.distributed scheduler (auricle[cluster]).",
            show_default=False,
        ),
    ] = "",
    slurm: Annotated[
        int,
        typer.Option(
            metavar="JOBS",
            min=0,
            help="Compute in so many SLURM jobs of one core, by dask-jobqueue (auricle[cluster]).",
            show_default=False,
        ),
    ] = 0,
) -> None:
    """The paper's study on many atria: every table and figure, and what goes beyond.

    Each case is computed once: what has its result in DIR, for the same input, parameters and
    code, is not computed again, so that a study interrupted by anything goes on where it stood.
    A case that fails is told, kept and left out (exit code 4). Writes report.html, tables,
    reproduction.md and, for each case, cases/KEY.json into DIR.

    Example: `auricle study atrium:seed=1..3 -o study --workers 2`
    """
    from auricle.study.cohort.identity import identified
    from auricle.study.cohort.shard import shard_from_text
    from auricle.study.cohort.study_file import chosen_study

    if sum(map(bool, (gather, scheduler, slurm))) > 1:
        raise typer.BadParameter("give one of --gather, --scheduler and --slurm")
    if gather and shard:
        raise typer.BadParameter("--gather reports on all shards: leave --shard out")
    require_folder(output)
    part = shard_from_text(shard) if shard else None
    wanted = chosen_study(entries)
    for remark in wanted.remarks:
        typer.echo(f"note: {remark}", err=True)
    parameters = _parameters(wanted, entries[0])
    sources = wanted.sources if part is None else part.of(wanted.sources)
    cases = identified(sources, parameters, among=wanted.sources)
    if not gather:
        with _crew(workers, scheduler, slurm) as crew:
            _compute(cases, parameters, output, crew)
    if part is None:
        _report(wanted, cases, output)
    _require_all(cases, output)


def _parameters(wanted: "Study", name: str) -> "PaperParameters":
    from auricle.errors import InputError
    from auricle.study.paper.parameters import PaperParameters

    try:
        return PaperParameters.from_table(wanted.parameters)
    except InputError as fault:
        raise InputError(f"{name}: parameters: {fault}") from fault


@contextmanager
def _crew(workers: int, scheduler: str, slurm_jobs: int) -> "Iterator[Crew]":
    from auricle.study.cohort import cluster
    from auricle.study.cohort.processes import LocalWorkers

    if scheduler:
        with cluster.connected(scheduler) as crew:
            yield crew
    elif slurm_jobs:
        with cluster.slurm(slurm_jobs) as crew:
            yield crew
    else:
        yield LocalWorkers(workers)


def _compute(
    cases: "Sequence[Case]", parameters: "PaperParameters", output: Path, crew: "Crew"
) -> None:
    from auricle.study.cohort.execution import Work
    from auricle.study.cohort.runner import run_cases
    from auricle.study.paper.case import run_case

    work = Work(run_case, parameters, output.resolve())
    tally = run_cases(cases, work, crew, tell=_told())
    typer.echo(
        f"{len(tally.computed)} computed, {len(tally.found)} found finished, "
        f"{len(tally.failed)} failed"
    )


def _told() -> "Callable[[Standing], None]":
    """Says on standard error how each case ended, not more than one a second that went well."""
    import time

    last = [-_BETWEEN_LINES]

    def tell(standing: "Standing") -> None:
        failed = standing.outcome.error is not None
        now = time.monotonic()
        if not failed and standing.n_done < standing.n_total and now - last[0] < _BETWEEN_LINES:
            return
        last[0] = now
        typer.echo(_line(standing), err=True)

    return tell


def _line(standing: "Standing") -> str:
    ended = standing.outcome.error or f"{standing.outcome.seconds:.0f} s"
    left = standing.seconds_left
    rest = f"{left / 60:.0f} min left" if left > 90 else f"{left:.0f} s left"
    return f"[{standing.n_done}/{standing.n_total}] {standing.case.name}: {ended}; {rest}"


def _report(wanted: "Study", cases: "Sequence[Case]", output: Path) -> None:
    """Gather what is there into tables, the page and, last, the crate; says where the page is."""
    from auricle.cli.progress import progress_bars
    from auricle.report.cohort_page import write_cohort
    from auricle.study.cohort.crate import write_crate
    from auricle.study.cohort.gathering import gather
    from auricle.study.cohort.tables import write_tables

    cohort = gather(cases, output)
    write_tables(cohort, output)
    if cohort.finished:
        with progress_bars() as progress:
            page = write_cohort(cohort.finished, output, progress=progress)
        typer.echo(str(page))
    write_crate(wanted, cohort, output)


def _require_all(cases: "Sequence[Case]", output: Path) -> None:
    from auricle.study.cohort.case_files import CaseFiles

    files = CaseFiles(output)
    missing = [case for case in cases if not files.is_finished(case.key)]
    if not missing:
        return
    first = missing[0]
    why = files.failure(first.key) or "not computed yet"
    raise CohortError(
        f"{len(missing)} of {len(cases)} cases have no result, first {first.name}: {why}: "
        "correct or remove them and run again"
    )
