"""A live session at full size: time from a sample to map, deviation and next point; agreement.

    python benchmarks/live_session.py [--points 100] [--vertices 10000] [--modes 500]

A generated atrium, 500 samples in a session, then more one by one: each is timed from the call to
the map, its standard deviation and the next point. Every tenth, a full refit under the same
hyper-parameters is timed beside it and compared. Writes a section of docs/reconstruction.md.
"""

import argparse
import os
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from markdown_tables import table
from reconstruction_report import write_section

from auricle.arrays import Floats, PerVertex
from auricle.sampling.chamber import Chamber, chamber
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.live import Session
from auricle.sampling.next_point import next_point
from auricle.sampling.random_design import random_sampling
from auricle.sampling.running_posterior import RunningPosterior
from auricle.sampling.sites import Sites
from auricle.simulation.anatomy import AtriumShape
from auricle.simulation.atrium import atrium
from auricle.simulation.map_classes import MAP_CLASSES
from auricle.surface.simplification import simplify

N_BEFORE = 500
EVERY = 10
NOISES = (0.0, 0.05, 0.2)
BAR_MS = 50.0
BAR_AGREEMENT = 1e-8


@dataclass(frozen=True)
class Clock:
    """Wall and processor time, s."""

    wall: float
    cpu: float

    @classmethod
    def now(cls) -> "Clock":
        """The time."""
        return cls(time.perf_counter(), time.process_time())

    def since(self, start: "Clock") -> "Clock":
        """Time passed."""
        return Clock(self.wall - start.wall, self.cpu - start.cpu)


@dataclass(frozen=True)
class Run:
    """One session: noise, times of each point and of refits, largest relative differences."""

    noise: float
    fitted_noise: float
    points: Sequence[Clock]
    absorbing: Sequence[Clock]
    choosing: Sequence[Clock]
    undoing: Sequence[Clock]
    refits: Sequence[Clock]
    fit: Clock
    n_samples: int
    off_mean: float
    off_std: float
    off_drop: float
    same_next: bool


def off_surface(place: Chamber, count: int, rng: np.random.Generator) -> Floats:
    """Positions about a millimetre off random places of the surface, shape (count, 3)."""
    chosen = random_sampling(place, count, rng=rng)
    positions: Floats = place.mesh.vertices[chosen] + rng.normal(0, 0.6, (count, 3))
    return positions


def refitted(session: Session) -> tuple[PerVertex, PerVertex, int, float]:
    """Map, deviation, next vertex and its worth from all samples at once."""
    process = GaussianProcess(session.chamber, session.sites, n_modes=session.n_modes)
    whole = process.given(session.values, session.hyperparameters)
    gram = session.chamber.accessible_gram[: session.n_modes, : session.n_modes]
    running = RunningPosterior.of(session.chamber, gram, whole.posterior, session.values)
    following = next_point(running, session.hyperparameters.noise**2)
    return whole.mean, whole.std, following.vertex, following.expected_drop


def furthest(found: PerVertex, wanted: PerVertex) -> float:
    """Largest difference, relative to the largest magnitude."""
    return float(np.abs(found - wanted).max() / np.abs(wanted).max())


def ran(place: Chamber, noise: float, n_points: int, n_modes: int) -> Run:
    """A session with this noise."""
    rng = np.random.default_rng(7)
    truth = MAP_CLASSES["activation"].draw(place.mesh, rng).values
    positions = off_surface(place, N_BEFORE + n_points, rng)
    session = Session(place, n_modes=n_modes)
    spread = place.rms(truth - place.mean(truth))
    sites, _ = Sites.nearest(place.mesh, positions)
    values = sites.of(truth) + noise * spread * rng.standard_normal(len(positions))
    for at, value in zip(positions[:N_BEFORE], values[:N_BEFORE], strict=True):
        session.add(at, value)
    sys.stderr.write(f"noise {noise:.0%}: {session.n_samples} samples in\n")
    return taken(session, positions[N_BEFORE:], values[N_BEFORE:], noise)


def taken(session: Session, positions: Floats, values: Floats, noise: float) -> Run:
    """Add samples one by one, timed, and compare every tenth time."""
    times: dict[str, list[Clock]] = {name: [] for name in ("all", "add", "next", "undo", "refit")}
    off: list[tuple[float, float, float, bool]] = []
    for turn, (at, value) in enumerate(zip(positions, values, strict=True)):
        start = Clock.now()
        session.add(at, value)
        mean, std = session.mean, session.std
        shown = Clock.now()
        following = session.next_point()
        end = Clock.now()
        times["add"].append(shown.since(start))
        times["next"].append(end.since(shown))
        times["all"].append(end.since(start))
        if turn % EVERY == EVERY - 1:
            start = Clock.now()
            all_mean, all_std, vertex, drop = refitted(session)
            times["refit"].append(Clock.now().since(start))
            agreed = vertex == following.vertex
            worth = abs(following.expected_drop / drop - 1)
            off.append((furthest(mean, all_mean), furthest(std, all_std), worth, agreed))
            start = Clock.now()
            session.undo()
            times["undo"].append(Clock.now().since(start))
            session.add(at, value)
    fitted = session.hyperparameters.noise
    n_samples = session.n_samples
    start = Clock.now()
    session.refit()
    scale = session.chamber.rms(session.mean - session.chamber.mean(session.mean))
    means, stds, drops, agreements = zip(*off, strict=True)
    return Run(
        noise,
        fitted / scale,
        times["all"],
        times["add"],
        times["next"],
        times["undo"],
        times["refit"],
        Clock.now().since(start),
        n_samples,
        max(means),
        max(stds),
        max(drops),
        all(agreements),
    )


def milliseconds(clocks: Sequence[Clock]) -> tuple[str, str]:
    """Median (10–90 %) of wall and of processor time, ms."""
    return _spread([each.wall for each in clocks]), _spread([each.cpu for each in clocks])


def _spread(seconds: Sequence[float]) -> str:
    low, middle, high = 1000 * np.quantile(seconds, [0.1, 0.5, 0.9])
    return f"{middle:.1f} ({low:.1f}–{high:.1f})"


def time_lines(runs: Sequence[Run]) -> Iterator[Sequence[str]]:
    """Rows of the table of times, all runs together."""
    named = {
        "**one more sample: map, deviation, next point**": [c for r in runs for c in r.points],
        "of this: sample taken in, map and deviation": [c for r in runs for c in r.absorbing],
        "of this: next point": [c for r in runs for c in r.choosing],
        "last sample taken back": [c for r in runs for c in r.undoing],
        "the same from all samples at once": [c for r in runs for c in r.refits],
        "hyper-parameters fitted anew": [r.fit for r in runs],
    }
    for name, clocks in named.items():
        yield [name, str(len(clocks)), *milliseconds(clocks)]


def report(place: Chamber, runs: Sequence[Run], n_modes: int, load: float) -> str:
    """The section."""
    points = [each for run in runs for each in run.points]
    wall, cpu = 1000 * np.median([(each.wall, each.cpu) for each in points], axis=0)
    worst = max(max(run.off_mean, run.off_std, run.off_drop) for run in runs)
    agreement = table(
        [
            "noise put on",
            "noise fitted",
            "map",
            "deviation",
            "worth of the next point",
            "same next",
        ],
        [
            [
                f"{run.noise:.0%}",
                f"{run.fitted_noise:.1%}",
                *(f"{each:.1e}" for each in (run.off_mean, run.off_std, run.off_drop)),
                "yes" if run.same_next else "no",
            ]
            for run in runs
        ],
    )
    return f"""## A live session

`benchmarks/live_session.py`. A generated atrium of {place.mesh.n_vertices:,} vertices and
{place.basis.area / 100:.0f} cm², {n_modes} harmonics, activation from foci sampled about a
millimetre off the surface at random; {N_BEFORE} samples in the session, then
{len(runs[0].points)} more one by one, at each of {len(runs)} levels of noise. One thread; on
average {load:.1f} others wanted the machine's {os.cpu_count()} cores, which the wall clock shows
and the processor time does not.

One more sample takes {cpu:.1f} ms of processor time, {wall:.1f} ms by the wall clock (medians).
The bar is {BAR_MS:.0f} ms: {_verdict(cpu < BAR_MS)} by processor time, {_verdict(wall < BAR_MS)} by
the wall clock.

{table(["what", "times", "wall, ms: median (10–90 %)", "processor, ms"], time_lines(runs))}

Largest difference from a refit of all samples under the same hyper-parameters, relative to the
largest value, over {len(runs[0].refits)} comparisons up to {runs[0].n_samples} samples. The bar is
{BAR_AGREEMENT:.0e}: {_verdict(worst <= BAR_AGREEMENT)}. Noise is relative to the map's deviation.

{agreement}
"""


def _verdict(met: bool) -> str:
    return "met" if met else "not met"


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--points", type=int, default=100)
    parser.add_argument("--vertices", type=int, default=10_000)
    parser.add_argument("--modes", type=int, default=500)
    given = parser.parse_args()
    shape = AtriumShape.random(np.random.default_rng(1))
    place = chamber(simplify(atrium(shape), given.vertices), given.modes)
    sys.stderr.write(f"{place.mesh.n_vertices} vertices, {place.basis.n_modes} harmonics\n")
    runs, loads = [], []
    for noise in NOISES:
        runs.append(ran(place, noise, given.points, given.modes))
        loads.append(max(os.getloadavg()[0] - 1, 0.0))
    write_section("live_session", report(place, runs, given.modes, float(np.mean(loads))))


if __name__ == "__main__":
    main()
