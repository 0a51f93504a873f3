"""What running a cohort costs beyond its cases, and what the cases cost by stage and size.

::

    python benchmarks/cohort_throughput.py            # 200 tiny cases, 1 and 2 workers; minutes
    python benchmarks/cohort_throughput.py --scaling  # one atrium at seven sizes; minutes

Each rewrites its section of docs/performance_study.md. Seconds are CPU seconds, so that other work
on the machine disturbs them little; wall times are said beside where they are meant.
"""

import argparse
import gc
import json
import os
import re
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

os.environ.setdefault("AURICLE_CACHE", "off")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import psutil

from auricle.study.cohort.costs import cluster_need, stage_costs
from auricle.study.cohort.execution import Work
from auricle.study.cohort.identity import identified
from auricle.study.cohort.processes import LocalWorkers
from auricle.study.cohort.runner import run_cases
from auricle.study.paper.case import CaseDocument, run_case
from auricle.study.paper.parameters import PaperParameters

PAGE = Path(__file__).parents[1] / "docs" / "performance_study.md"
TITLE = """# Speed of a study

Written by `benchmarks/cohort_throughput.py`; do not edit. How to repeat it is said there.
"""
TINY = PaperParameters(
    n_vertices=300,
    n_modes=60,
    coefficient_counts=(10, 20, 30, 40, 50),
    point_counts=(20, 30, 40, 50),
    fitted_counts=(20, 30, 40, 50),
    pictured_counts=(50,),
    placements=1,
    curve_widths_mm=(8.0, 16.0),
    class_draws=0,
    convention_vertices=0,
)
SIZES = (
    (2_500, 200),
    (5_000, 200),
    (10_000, 200),
    (20_000, 200),
    (10_000, 50),
    (10_000, 100),
    (10_000, 500),
)
"""Vertices and harmonics of each run: one row in either for each exponent."""
LIKELY = (10_000, 500)
"""That which a cluster's need is worked out for."""
MANY_CASES, CORES = 10_000, (100, 1_000)
LEAST_SECONDS = 0.1
"""Of a stage over all runs, below which it is taken to have had nothing to do."""
WARM = 10
"""Cases after which a worker's memory is looked at: all is loaded and compiled by then."""


@dataclass(frozen=True)
class Throughput:
    """One run of the cohort: CPU and wall seconds, and memory of a worker in MB."""

    workers: int
    n_cases: int
    cpu_s: float
    wall_s: float
    warm_mb: float
    last_mb: float
    mb_per_100_cases: float
    load: float


def sources(count: int) -> tuple[str, ...]:
    """Generated atria, another for each seed."""
    return tuple(f"atrium:seed={seed},spacing=3" for seed in range(1, count + 1))


def seconds_of_one_case(count: int) -> float:
    """Mean CPU seconds of a case in a process that has done some: every fourth of the cohort."""
    chosen = sources(count)[::4]
    for source in chosen[:2]:
        run_case(Path(source), parameters=TINY)
    start = time.process_time()
    for source in chosen:
        run_case(Path(source), parameters=TINY)
    return (time.process_time() - start) / len(chosen)


def throughput(workers: int, count: int) -> Throughput:
    """The cohort on so many workers, from hiring them to the last result on disk."""
    memory: list[tuple[int, float]] = []
    gc.collect()
    children = os.times()
    own = time.process_time()
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as place:
        work = Work(run_case, TINY, Path(place))
        cases = identified(sources(count), TINY)
        run_cases(cases, work, LocalWorkers(workers), tell=watching(memory))
    wall = time.monotonic() - start
    after = os.times()
    cpu = after.children_user + after.children_system
    cpu -= children.children_user + children.children_system
    done, used = np.array([each for each in memory if each[0] >= WARM * workers]).T
    return Throughput(
        workers,
        count,
        cpu + time.process_time() - own,
        wall,
        float(used[:10].mean()),
        float(used[-10:].mean()),
        float(np.polyfit(done, used, 1)[0]) * 100 * workers,
        os.getloadavg()[2],
    )


def watching(memory: list[tuple[int, float]]) -> Callable[..., None]:
    """Notes the mean resident memory of the workers, MB, at every case that ends."""

    def tell(standing) -> None:
        if standing.outcome.error is not None:
            raise SystemExit(standing.outcome.error)
        sizes = [
            child.memory_info().rss
            for child in psutil.Process().children()
            if "spawn_main" in " ".join(child.cmdline())
        ]
        memory.append((standing.n_done, float(np.mean(sizes)) / 2**20))

    return tell


def throughput_section(count: int) -> str:
    """One case by itself against the cohort on one and two workers."""
    one = seconds_of_one_case(count)
    runs = [throughput(workers, count) for workers in (1, 2)]
    lines = [
        f"{count} cases of 300 vertices and 60 harmonics; one case takes {one:.3f} s of CPU in a "
        "process that has done others. Efficiency is that times the cases over the CPU seconds of "
        "the whole run, with starting the workers, hashing, writing and reporting: the share of "
        "the ideal throughput a core reaches. Memory is that of a worker, mean of ten cases after "
        f"the first {WARM} and at the end.",
        "",
        "| workers | CPU, s | wall, s | efficiency | memory, MB | at the end, MB | MB per 100 "
        "cases | load |",
        "|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {run.workers} | {run.cpu_s:.0f} | {run.wall_s:.0f} | {one * count / run.cpu_s:.2f} | "
        f"{run.warm_mb:.0f} | {run.last_mb:.0f} | {run.mb_per_100_cases:+.1f} | {run.load:.1f} |"
        for run in runs
    ]
    sys.stdout.write(json.dumps([one, *map(asdict, runs)]) + "\n")
    return "\n".join(lines)


@dataclass
class Stopwatch:
    """CPU seconds by stage of a case, as it tells of its stages."""

    started: dict[str, float]
    seconds: dict[str, float]

    def __call__(self, stage: str, done: int, total: int) -> None:
        """Note when a stage begins and when it ends."""
        now = time.process_time()
        self.started.setdefault(stage, now)
        if done >= total:
            self.seconds[stage] = now - self.started[stage]


def timed_case(n_vertices: int, n_modes: int) -> CaseDocument:
    """One generated atrium as the paper's study has it, with CPU seconds for its timings."""
    parameters = replace(
        PaperParameters(),
        n_vertices=n_vertices,
        n_modes=n_modes,
        placements=5,
        convention_vertices=0,
    )
    source = Path(f"atrium:seed=1,spacing={0.5 * (20_000 / n_vertices) ** 0.5:.3f}")
    watch = Stopwatch({}, {})
    document = run_case(source, parameters=parameters, progress=watch)
    return CaseDocument(
        document.values, {stage: watch.seconds[stage] for stage in document.timings}
    )


def scaling_section() -> str:
    """Cost by stage of one generated atrium at several sizes, and what it says of many."""
    run_case(Path(sources(1)[0]), parameters=TINY)  # compiles what is compiled
    documents = [timed_case(*size) for size in SIZES]
    read = [document.values["surface_as_read"]["n_vertices"] for document in documents]
    lines = [
        f"One generated atrium, {min(read):,} to {max(read):,} vertices as read, simplified to n "
        "vertices, with k harmonics, five placements and no comparison of conventions; CPU seconds "
        "of one thread. b and c are those of seconds ∝ nᵇ·kᶜ over the seven runs with their "
        "standard errors, n of the surface as read for the first two stages. A stage that rebuilds "
        "at more counts where there are more harmonics grows with k by that alone.",
        "",
        "| stage | " + " | ".join(f"n = {n:,}, k = {k}" for n, k in SIZES) + " | b | c |",
        "|---|" + "---|" * (len(SIZES) + 2),
    ]
    done = (cost for cost in stage_costs(documents) if cost.total_s >= LEAST_SECONDS)
    for cost in done:
        cells = [f"{document.timings[cost.stage]:.2f}" for document in documents]
        exponents = (
            with_error(cost.exponent, cost.exponent_error),
            with_error(cost.modes_exponent, cost.modes_exponent_error),
        )
        lines.append(f"| {cost.stage} | " + " | ".join((*cells, *exponents)) + " |")
    totals = [f"{sum(document.timings.values()):.1f}" for document in documents]
    lines.append("| all | " + " | ".join(totals) + " | | |")
    likely = documents[SIZES.index(LIKELY)]
    needs = [cluster_need([likely], n_cases=MANY_CASES, n_cores=n) for n in CORES]
    lines += [
        "",
        f"{MANY_CASES:,} such cases of {LIKELY[0]:,} vertices and {LIKELY[1]} harmonics need "
        f"{needs[0].core_hours:.0f} core-hours: "
        + ", ".join(f"{need.wall_hours:.1f} h on {need.n_cores:,} cores" for need in needs)
        + ". A study's own page works this out from its own cases, conventions included.",
    ]
    return "\n".join(lines)


def with_error(exponent: float | None, error: float | None) -> str:
    """An exponent as the table has it."""
    return "–" if exponent is None or error is None else f"{exponent:.2f} ± {error:.2f}"


def write(heading: str, section: str) -> None:
    """Put a section into the page in place of the one of that heading."""
    text = PAGE.read_text(encoding="utf-8") if PAGE.exists() else TITLE
    kept = re.sub(rf"\n## {heading}\n.*?(?=\n## |\Z)", "", text, flags=re.DOTALL)
    PAGE.write_text(f"{kept.rstrip()}\n\n## {heading}\n\n{section}\n", encoding="utf-8")


def main() -> None:
    """Measure what is asked for and rewrite its section."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--scaling", action="store_true")
    chosen = parser.parse_args()
    if chosen.scaling:
        write("Cost by stage", scaling_section())
    else:
        write("Throughput of a cohort", throughput_section(chosen.cases))


if __name__ == "__main__":
    main()
