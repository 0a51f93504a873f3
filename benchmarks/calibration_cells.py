"""The cells of the calibration: one anatomy, every class, design, number of samples and noise.

    python benchmarks/calibration_cells.py OUT.csv [SURFACE …] [--seeds 5] [--vertices 3000]

For every cell a map of the class is drawn, sampled with noise and rebuilt, by auricle and by the
methods mapping systems use, and compared with the truth at every vertex that can be sampled.
Without a surface the atria named in `ATRIA` under AURICLE_DATA are used. The rows of a part (an
anatomy, design and number of samples) go into OUT.csv when it is done, and a part that is there
is left out, so that a run can be broken off and taken up again; `calibration_report.py` makes the
tables.
"""

import argparse
import csv
import os
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from auricle.arrays import Floats
from auricle.sampling.bandwidth import class_tails
from auricle.sampling.baselines import BASELINES
from auricle.sampling.catheter import placed, star_catheter
from auricle.sampling.chamber import Chamber
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.pivoted_qr import pivoted_qr_sampling
from auricle.sampling.plan import ExpectedMap, predicted_nrmse
from auricle.sampling.random_design import random_sampling
from auricle.sampling.sites import Sites
from auricle.sampling.stability import LEAST_MARGINAL, judged
from auricle.sampling.voronoi import voronoi
from auricle.simulation.map_classes import MAP_CLASSES
from auricle.study.preparation import prepare

ATRIA = (
    "meshes/atlas/la_endo1_Labelled.pts",
    "meshes/atlas/la_endo2_Labelled.pts",
    "meshes/atlas/LASC2018_06SR5RB_LA_mri_closed.vtk",
    "meshes/lasc2013-b002/gt_noclip_mesh.vtp",
    "meshes/lausm/test.vtk",
    "meshes/lge/LA_A_lge.vtk",
)
CLASSES = ("gaussian", "activation", "macro_reentry", "scar", "disc")
COUNTS = (25, 50, 100, 200, 400, 800)
NOISES = (0.0, 0.05, 0.2)
N_MODES = 750
FIELDS = (
    "anatomy", "area_cm2", "map", "design", "n", "noise", "seed", "nrmse", "predicted", "planned",
    "coverage95", "coverage95_with_detail", "length_mm", "smoothness", "noise_found", *BASELINES,
)  # fmt: skip


def designed(chamber: Chamber, design: str, count: int, seed: int) -> Sites:
    """Sites of a design: the even ones are the same for every seed."""
    rng = np.random.default_rng(1000 + seed)
    if design == "farthest":
        return Sites.at_vertices(farthest_point_sampling(chamber, count))
    if design == "pivoted_qr":
        n_modes = min(int(count / 1.25), chamber.basis.n_modes)
        return Sites.at_vertices(pivoted_qr_sampling(chamber, count, n_modes=n_modes))
    if design == "random":
        return Sites.at_vertices(random_sampling(chamber, count, rng=rng))
    # One run of the catheter a seed: the fewer samples are the first of the more.
    return catheter_run(chamber, COUNTS[-1], rng)[np.arange(count)]


def catheter_run(chamber: Chamber, count: int, rng: np.random.Generator) -> Sites:
    """So many sites of a 20-pole star put down at random, one place after another."""
    key = (chamber, count, rng.bit_generator.state["state"]["state"])
    if key not in _RUNS:
        centres = random_sampling(chamber, count, rng=rng)
        pattern, angles = star_catheter(), rng.uniform(0, 2 * np.pi, count)
        sites, used = Sites.at_vertices([]), 0
        while len(sites) < count:
            used += max(1, (count - len(sites)) // 20)
            sites = placed(chamber, pattern, centres[:used], angles=angles[:used]).sites
        _RUNS[key] = sites
    return _RUNS[key]


_RUNS: dict[tuple[Chamber, int, int], Sites] = {}


DESIGNS = ("farthest", "pivoted_qr", "random", "catheter")


def relative_error(chamber: Chamber, rebuilt: Floats, truth: Floats) -> float:
    """The nRMSE of all columns together."""
    pairs = list(zip(rebuilt.T, truth.T, strict=True))
    error = sum(chamber.rms(found - true) ** 2 for found, true in pairs)
    spread = sum(chamber.rms(true - chamber.mean(true)) ** 2 for _, true in pairs)
    return float(np.sqrt(error / spread))


UP_TO, BIG, FEW = COUNTS[:-1], COUNTS[-1:], (50,)
ROUNDS = (
    ((0, 1), UP_TO),
    ((2,), UP_TO),
    ((0, 1), BIG),
    ((3, 4), UP_TO),
    ((2, 3, 4), BIG),
    ((5, 6, 7), FEW),
)
"""Seeds and numbers of samples in the order they are measured: two maps of every cell before a
third of any, and most samples, which take as long as all others, last. With ``--seeds 8`` three
maps more of the cells in which the methods differ least, by which nothing was chosen."""


@dataclass(frozen=True, eq=False)
class Anatomy:
    """One atrium, and what is known of its maps beforehand."""

    name: str
    chamber: Chamber
    tails: dict[str, Floats]

    @classmethod
    def of(cls, path: Path, n_vertices: int) -> Self:
        """Prepare a surface."""
        chamber = prepare(path, n_vertices=n_vertices, n_modes=N_MODES).chamber
        rng = [np.random.default_rng(77) for _ in CLASSES]
        tails = {
            name: class_tails(chamber, MAP_CLASSES[name], n_draws=10, rng=each).at(0.5)
            for name, each in zip(CLASSES, rng, strict=True)
        }
        return cls(path.stem, chamber, tails)


def cells(
    anatomy: Anatomy, design: str, count: int, seeds: Sequence[int]
) -> Iterator[dict[str, Any]]:
    """Every class and noise at one design's sites, for maps of some seeds."""
    chamber = anatomy.chamber
    process = GaussianProcess(chamber, designed(chamber, design, count, seeds[0]))
    planned = planned_errors(chamber, process.sites, anatomy.tails)
    cases = [
        Case(name, noise, seed, truth)
        for seed in seeds
        for name in CLASSES
        for truth in [drawn(chamber, name, seed)]
        for noise in NOISES
    ]
    others = by_baselines(process, cases)
    for case in cases:
        yield {
            "anatomy": anatomy.name,
            "area_cm2": chamber.accessible_area / 100,
            "map": case.name,
            "design": design,
            "n": count,
            "noise": case.noise,
            "seed": case.seed,
            "planned": planned[case.name, case.noise],
            **rebuilt(process, case),
            **others[case.name, case.noise, case.seed],
        }


@dataclass(frozen=True, eq=False)
class Case:
    """One map to sample and rebuild."""

    name: str
    noise: float
    seed: int
    truth: Floats

    def sampled(self, process: GaussianProcess) -> Floats:
        """Its noisy samples, shape (m, c)."""
        spread = deviation(process.chamber, self.truth)
        return noisy(process.sites, self.truth, self.noise, self.seed, spread)


def by_baselines(
    process: GaussianProcess, cases: Sequence[Case]
) -> dict[tuple[str, float, int], dict[str, float]]:
    """Errors of the methods of mapping systems, each run once for all maps on the same sites."""
    chamber = process.chamber
    values = [case.sampled(process) for case in cases]
    ends = np.cumsum([each.shape[1] for each in values])[:-1]
    rebuilt_by = {
        name: np.split(interpolate(chamber, process.sites, np.hstack(values)), ends, axis=1)
        for name, interpolate in BASELINES.items()
    }
    return {
        (case.name, case.noise, case.seed): {
            name: relative_error(chamber, maps[index], case.truth)
            for name, maps in rebuilt_by.items()
        }
        for index, case in enumerate(cases)
    }


def planned_errors(
    chamber: Chamber, sites: Sites, tails: dict[str, Floats]
) -> dict[tuple[str, float], float]:
    """What a plan with these sites predicts, by class and noise; as `evaluated_plan` does."""
    shares = voronoi(chamber, sites).shares
    most = min(len(sites), chamber.basis.n_modes)
    choices = np.unique(np.rint(np.geomspace(1, most, 8)).astype(int)).tolist()
    certificates = [judged(chamber, sites, n_modes, shares) for n_modes in choices]
    sound = [each for each in certificates if each.constant >= LEAST_MARGINAL]
    return {
        (name, noise): min(
            predicted_nrmse(each, ExpectedMap(monotone(tail), noise))
            for each in sound or certificates[:1]
        )
        for name, tail in tails.items()
        for noise in NOISES
    }


def monotone(tail: Floats) -> Floats:
    """The least tail above this one that never grows."""
    return np.minimum(np.maximum.accumulate(tail[::-1])[::-1], 1.0)


def drawn(chamber: Chamber, name: str, seed: int) -> Floats:
    """A map of the class, one column a component, shape (n, c)."""
    map_class = MAP_CLASSES[name]
    rng = np.random.default_rng([seed, CLASSES.index(name)])
    field = map_class.draw(chamber.mesh, rng, allowed=chamber.accessible)
    columns = map_class.columns(field)
    return columns.reshape(chamber.mesh.n_vertices, -1)


def noisy(sites: Sites, truth: Floats, noise: float, seed: int, spread: float) -> Floats:
    """Samples of a map, shape (m, c)."""
    rng = np.random.default_rng([seed, 5])
    return sites.of(truth) + noise * spread * rng.standard_normal((len(sites), truth.shape[1]))


def deviation(chamber: Chamber, truth: Floats) -> float:
    """Standard deviation of a map over the accessible area, root mean square of its columns."""
    squares = [chamber.rms(column - chamber.mean(column)) ** 2 for column in truth.T]
    return float(np.sqrt(np.mean(squares)))


def rebuilt_error(process: GaussianProcess, truth: Floats, noise: float, seed: int) -> float:
    """Error of the Gaussian process alone."""
    values = noisy(process.sites, truth, noise, seed, deviation(process.chamber, truth))
    mean = process.fit(values).mean.reshape(truth.shape)
    return relative_error(process.chamber, mean, truth)


def rebuilt(process: GaussianProcess, case: Case) -> dict[str, float]:
    """Error of the Gaussian process on one map, and what it says of it."""
    chamber, truth = process.chamber, case.truth
    spread = deviation(chamber, truth)
    found = process.fit(case.sampled(process))
    mean = found.mean.reshape(truth.shape)
    off = np.abs(mean - truth)
    covered = {
        "coverage95": off <= 1.96 * found.std[:, None],
        "coverage95_with_detail": off
        <= 1.96 * found.std_with_detail(noise=case.noise * spread)[:, None],
    }
    return {
        "nrmse": relative_error(chamber, mean, truth),
        "predicted": found.predicted_nrmse,
        **{
            name: float(np.mean([chamber.mean(column.astype(float)) for column in inside.T]))
            for name, inside in covered.items()
        },
        "length_mm": found.hyperparameters.length,
        "smoothness": found.hyperparameters.smoothness,
        "noise_found": float(found.hyperparameters.noise / spread),
    }


Measure = Callable[[Path, int, int], Iterator[dict[str, Any]]]
"""From a surface, a number of seeds and one of vertices to the rows of one anatomy."""


def arguments(default_seeds: int) -> argparse.Namespace:
    """Where to write, the surfaces, the number of seeds and of vertices."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("surfaces", type=Path, nargs="*")
    parser.add_argument("--seeds", type=int, default=default_seeds)
    parser.add_argument("--vertices", type=int, default=3000)
    given = parser.parse_args()
    data = Path(os.environ.get("AURICLE_DATA", "../shared/data"))
    given.surfaces = given.surfaces or [data / name for name in ATRIA]
    return given


def measured(measure: Measure, fields: Sequence[str], default_seeds: int = 5) -> None:
    """Run every anatomy that is not whole yet, and write each row as it comes."""
    given = arguments(default_seeds)
    whole = whole_anatomies(given.out, fields)
    with given.out.open("a", newline="") as file:
        writer = csv.DictWriter(file, fields)
        for done, path in enumerate(given.surfaces):
            sys.stderr.write(f"{path.stem}: {done} of {len(given.surfaces)} anatomies before it\n")
            if path.stem in whole:
                continue
            for row in measure(path, given.seeds, given.vertices):
                writer.writerow(row)
                file.flush()


def whole_anatomies(out: Path, fields: Sequence[str]) -> set[str]:
    """Anatomies measured to the end in a table; the rows of one broken off are taken out of it.

    Every anatomy but the last is whole; the last is if it has as many rows as the first.
    """
    rows: list[dict[str, str]] = []
    if out.exists():
        with out.open(newline="") as file:
            rows = list(csv.DictReader(file))
    counts = Counter(row["anatomy"] for row in rows)
    whole = {name for name, count in counts.items() if count == max(counts.values())}
    if len(counts) == 1:
        whole = set()
    with out.open("w", newline="") as file:
        writer = csv.DictWriter(file, fields)
        writer.writeheader()
        writer.writerows(row for row in rows if row["anatomy"] in whole)
    return whole


Part = tuple[Path, str, int, tuple[int, ...]]
"""A surface, a design, a number of samples and the seeds measured together."""


def parts(surfaces: Sequence[Path], n_seeds: int) -> Iterator[Part]:
    """What to measure, in the order of `ROUNDS`."""
    for among, counts in ROUNDS:
        seeds = tuple(seed for seed in among if seed < n_seeds)
        for surface in surfaces:
            for design in DESIGNS:
                shared = design in ("farthest", "pivoted_qr")
                groups = [seeds] if shared else [(seed,) for seed in seeds]
                for count in counts:
                    yield from ((surface, design, count, group) for group in groups if group)


def main() -> None:
    """Measure what is not in the table yet, a part at a time."""
    given = arguments(5)
    rows: list[dict[str, str]] = []
    if given.out.exists():
        with given.out.open(newline="") as file:
            rows = list(csv.DictReader(file))
    done = {(row["anatomy"], row["design"], int(row["n"]), int(row["seed"])) for row in rows}
    anatomies: dict[Path, Anatomy] = {}
    for surface, design, count, seeds in parts(given.surfaces, given.seeds):
        if (surface.stem, design, count, seeds[-1]) in done:
            continue
        if surface not in anatomies:
            anatomies[surface] = Anatomy.of(surface, given.vertices)
        measured_now = list(cells(anatomies[surface], design, count, seeds))
        with given.out.open("a", newline="") as file:
            writer = csv.DictWriter(file, FIELDS)
            if not file.tell():
                writer.writeheader()
            writer.writerows(measured_now)
        sys.stderr.write(f"{surface.stem}, {design}, {count} samples, seeds {seeds}\n")


if __name__ == "__main__":
    main()
