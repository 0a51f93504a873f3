"""Beside quLATi: basis and posterior on the same clinical atrium, from the same samples.

    python benchmarks/qulati_peer.py [--basis FILE.npz] [--draws 5]

quLATi (Coveney et al., Phil Trans A 2020, Gaussian process manifold interpolation; GPL-3) is not on
PyPI: clone github.com/samcoveney/quLATi and install it by pip, in an environment of its own that
has auricle too. Needs AURICLE_DATA. quLATi's basis takes minutes: with `--basis` it is kept in that
file, with the time it took, and not solved again. Writes a section of docs/reconstruction.md.
"""

import argparse
import contextlib
import io
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from markdown_tables import table
from reconstruction_report import write_section

from auricle.arrays import Floats, Integers, PerVertex
from auricle.atomic import write_whole
from auricle.sampling.chamber import Chamber
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.random_design import random_sampling
from auricle.sampling.sites import Sites
from auricle.spectral.harmonics import manifold_harmonics
from auricle.surface.capping import cap_holes
from auricle.surface.cleaning import CleanSurface, clean
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere, rectangle

MAP = "maps/openep-dataset2/openep_ds2_lat_bip.vtk"
FIELD = "LAT"
N_MODES = 128
MOST_MODES = 500
COUNTS = (100, 400)
LAYERS, RESTARTS, SMOOTHNESS = 10, 5, 1.5
MIXTURE = "auricle, as `reconstruct` does"
"""As quLATi's README has them, but for the number of harmonics."""
REPEATS = 3
ABSENT = (
    "quLATi is not installed: it is not on PyPI; clone github.com/samcoveney/quLATi (GPL-3), "
    "install it by pip beside auricle and run this again"
)

Seconds = tuple[float, float]
"""Wall and processor time."""


@dataclass(frozen=True)
class Outcome:
    """One map rebuilt by one method."""

    method: str
    n_samples: int
    rmse: float
    stated: float
    coverage: float
    seconds: Seconds


@dataclass(frozen=True, eq=False)
class Truth:
    """The map and where it is known: the chamber is accessible there only."""

    chamber: Chamber
    values: PerVertex

    def judged(
        self, method: str, count: int, rebuild: Callable[[], tuple[Floats, Floats]]
    ) -> Outcome:
        """Time a method and compare what it gives, vertices of the surface first, with this."""
        (mean, std), seconds = timed(rebuild)
        known = np.flatnonzero(self.chamber.accessible)
        weights = self.chamber.accessible_areas[known] / self.chamber.accessible_area
        off, std = mean[known] - self.values[known], std[known]
        return Outcome(
            method,
            count,
            float(np.sqrt(weights @ off**2)),
            float(np.sqrt(weights @ std**2)),
            float(weights @ (np.abs(off) <= 1.96 * std)),
            seconds,
        )


def timed(work: Callable[[], Any]) -> tuple[Any, Seconds]:
    """What a call gives, and its wall and processor time."""
    wall, cpu = time.perf_counter(), time.process_time()
    found = work()
    return found, (time.perf_counter() - wall, time.process_time() - cpu)


def peer_basis(cleaned: CleanSurface, kept: Path | None) -> tuple[Floats, Floats, Seconds]:
    """Eigenvalues of quLATi, its eigenfunctions at the vertices and centroids, and time."""
    if kept is not None and kept.exists():
        with np.load(kept) as file:
            wall, cpu = file["seconds"].tolist()
            return file["eigenvalues"], file["modes"], (wall, cpu)
    _peer_modes(rectangle(width=30.0, height=20.0, n_x=10, n_y=8), n_holes=1, n_modes=6)
    sys.stderr.write("quLATi: basis, some minutes\n")
    (values, modes), seconds = timed(
        lambda: _peer_modes(cleaned.mesh, n_holes=cleaned.soundness.n_holes, n_modes=N_MODES)
    )
    if kept is not None:
        content = {"eigenvalues": values, "modes": modes, "seconds": seconds}
        write_whole(kept, lambda place: np.savez(place.open("wb"), **content))
    return values, modes, seconds


def _peer_modes(mesh: Mesh, *, n_holes: int, n_modes: int) -> tuple[Floats, Floats]:
    from qulati import eigensolver

    np.random.seed(1)  # noqa: NPY002 (quLATi draws from the global generator)
    with contextlib.redirect_stdout(io.StringIO()):
        values, modes, _, _ = eigensolver(
            np.array(mesh.vertices),
            np.array(mesh.faces),
            holes=n_holes,
            layers=LAYERS,
            num=n_modes,
            calc_gradV=False,
        )
    return values, modes


def peer_posterior(
    mesh: Mesh, basis: tuple[Floats, Floats], chosen: Integers, samples: Floats
) -> tuple[Floats, Floats]:
    """Mean and deviation by quLATi at the vertices, all hyper-parameters and the noise fitted."""
    from qulati import gpmi

    with contextlib.redirect_stdout(io.StringIO()):
        model = gpmi.Matern(np.array(mesh.vertices), np.array(mesh.faces), *basis, None)
        model.set_data(samples, chosen)
        model.kernelSetup(smoothness=SMOOTHNESS)
        model.optimize(nugget=None, restarts=RESTARTS)
        mean, std = model.posterior(indices=range(mesh.n_vertices), pointwise=True)
    return mean, std


def own_basis(solve: Callable[[], Chamber], name: str) -> tuple[Chamber, Seconds]:
    """A chamber with its harmonics, and the median time of some solutions."""
    results = []
    for _ in range(REPEATS):
        results.append(timed(solve))
        sys.stderr.write(f"{name}, {results[-1][1][1]:.1f} s\n")
    wall, cpu = np.median([seconds for _, seconds in results], axis=0).tolist()
    return results[0][0], (wall, cpu)


def closed(mesh: Mesh, n_modes: int) -> Chamber:
    """As auricle does it: holes capped."""
    capped = cap_holes(mesh)
    return Chamber(capped.mesh, manifold_harmonics(capped.mesh, n_modes), capped.original)


def left_open(mesh: Mesh, n_modes: int) -> Chamber:
    """The surface with its holes, for comparison: no slope across a rim."""
    everywhere = np.ones(mesh.n_vertices, dtype=bool)
    return Chamber(mesh, manifold_harmonics(mesh, n_modes), everywhere)


def rebuilt(
    chamber: Chamber,
    sites: Sites,
    samples: Floats,
    *,
    n_modes: int | None,
    detail: bool,
    smoothness: float | None,
) -> tuple[Floats, Floats]:
    """The map and its deviation, from nothing but the samples."""
    found = GaussianProcess(chamber, sites, smoothness=smoothness, n_modes=n_modes).fit(samples)
    return found.mean, found.std_with_detail() if detail else found.std


def outcomes(
    truth: Truth, peer: Callable[[Integers, Floats], tuple[Floats, Floats]], opened: Chamber, n: int
) -> Iterator[Outcome]:
    """Every method on every of n draws, one after the other so that a busy spell meets all."""
    own = {
        f"auricle, {N_MODES}": (truth.chamber, N_MODES, False, SMOOTHNESS),
        "auricle, as it chooses": (truth.chamber, None, False, SMOOTHNESS),
        "auricle, as it chooses, with detail": (truth.chamber, None, True, SMOOTHNESS),
        "the same, holes left open": (opened, None, False, SMOOTHNESS),
        "the same, holes left open, with detail": (opened, None, True, SMOOTHNESS),
        MIXTURE: (truth.chamber, None, False, None),
        f"{MIXTURE}, with detail": (truth.chamber, None, True, None),
    }
    for count in COUNTS:
        for draw in range(n):
            np.random.seed(draw)  # noqa: NPY002 (as above)
            chosen = random_sampling(truth.chamber, count, rng=np.random.default_rng(draw))
            sites, samples = Sites.at_vertices(chosen), truth.values[chosen]
            yield truth.judged(f"quLATi, {N_MODES}", count, partial(peer, chosen, samples))
            for name, (chamber, n_modes, detail, smoothness) in own.items():
                rebuild = partial(
                    rebuilt,
                    chamber,
                    sites,
                    samples,
                    n_modes=n_modes,
                    detail=detail,
                    smoothness=smoothness,
                )
                yield truth.judged(name, count, rebuild)
            sys.stderr.write(f"{count} samples, draw {draw}\n")


def error_lines(found: Sequence[Outcome]) -> Iterator[list[str]]:
    """Rows of the table of errors: means over the draws, median times."""
    for count in COUNTS:
        for method in dict.fromkeys(each.method for each in found):
            some = [each for each in found if (each.method, each.n_samples) == (method, count)]
            wall, cpu = np.median([each.seconds for each in some], axis=0)
            errors = [each.rmse for each in some]
            yield [
                str(count),
                method,
                f"{np.mean(errors):.2f} ({min(errors):.2f}–{max(errors):.2f})",
                f"{np.mean([each.stated for each in some]):.2f}",
                f"{100 * np.mean([each.coverage for each in some]):.1f}",
                f"{wall:.2f}",
                f"{cpu:.2f}",
            ]


def mean_rmse(found: Sequence[Outcome], method: str, count: int) -> float:
    """Mean error of a method with so many samples, ms."""
    some = [each.rmse for each in found if (each.method, each.n_samples) == (method, count)]
    return float(np.mean(some))


def report(
    truth: Truth, mesh: Mesh, bases: dict[str, Seconds], found: Sequence[Outcome], source: str
) -> str:
    """The section."""
    spread = truth.chamber.rms(truth.values - truth.chamber.mean(truth.values))
    first = next(iter(bases.values()))
    n_draws = len(found) // len({(each.method, each.n_samples) for each in found})
    ratios = {
        count: mean_rmse(found, f"quLATi, {N_MODES}", count)
        / mean_rmse(found, "auricle, as it chooses", count)
        for count in COUNTS
    }
    basis_table = table(
        ["basis", "wall, s", "processor, s", "quLATi's processor time over it"],
        [
            [name, f"{wall:.1f}", f"{cpu:.1f}", f"{first[1] / cpu:.1f}"]
            for name, (wall, cpu) in bases.items()
        ],
    )
    compared = " and ".join(f"{each:.2f} with {count} samples" for count, each in ratios.items())
    head = [
        "samples", "method, harmonics", "RMSE, ms: mean (range)", "stated, ms", "95 % covers, %",
        "wall, s", "processor, s",
    ]  # fmt: skip
    return f"""## Beside quLATi

`benchmarks/qulati_peer.py`. The LAT map of OpenEP's data set 2: its main piece,
{mesh.n_vertices:,} vertices, deviation {spread:.1f} ms. The same vertices, drawn at random by area
({n_draws} draws), are the samples of both; both fit all hyper-parameters and the noise
(ν = {SMOOTHNESS}). quLATi, {source}, is used as its README has it: holes extended by
{LAYERS} layers, every triangle split in nine, {RESTARTS} restarts; its gradients left out,
compiled beforehand; its basis solved once, ours {REPEATS} times. auricle caps the holes and solves
on the triangles as they are. One thread of a machine of two cores that had other work: compare
processor times.

{basis_table}

quLATi's error over auricle's with as many harmonics as it chooses: {compared}.

{table(head, error_lines(found))}

Stated: root mean square over the area of the deviation that the method gives. Times are of fit, map
and deviation, medians. "Holes left open" is not what auricle does: the same process on the
harmonics of the surface with its holes, to tell the effect of the caps from that of the rest.
"As `reconstruct` does": of all smoothnesses by their probability, and splines beside.
"""


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--basis", type=Path)
    parser.add_argument("--draws", type=int, default=5)
    parser.add_argument("--source", default="as installed", help="which quLATi, for the report")
    given = parser.parse_args()
    if find_spec("qulati") is None:
        raise SystemExit(ABSENT)
    data = Path(os.environ.get("AURICLE_DATA", "../shared/data"))
    cleaned = clean(read_surface(data / MAP))
    mesh = cleaned.mesh
    (field,) = (each for each in cleaned.fields if each.name == FIELD)
    values, modes, seconds = peer_basis(cleaned, given.basis)
    closed(icosphere(radius=20.0, subdivisions=3), 6)
    bases = {f"quLATi, {N_MODES} harmonics": seconds}
    for n_modes in (N_MODES, MOST_MODES):
        name = f"auricle, {n_modes} harmonics"
        chamber, bases[name] = own_basis(partial(closed, mesh, n_modes), name)
    on_shell = np.full(chamber.mesh.n_vertices, np.nan)
    on_shell[: mesh.n_vertices] = field.values
    known = chamber.accessible & np.isfinite(on_shell)
    truth = Truth(replace(chamber, accessible=known), np.where(known, on_shell, 0.0))
    peer = partial(peer_posterior, mesh, (values, modes))
    found = list(outcomes(truth, peer, left_open(mesh, MOST_MODES), given.draws))
    write_section("qulati_peer", report(truth, mesh, bases, found, given.source))


if __name__ == "__main__":
    main()
