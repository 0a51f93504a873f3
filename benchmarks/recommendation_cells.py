"""Whether the recommended number of samples suffices, and how much fewer would have done.

    python benchmarks/recommendation_cells.py OUT.csv [SURFACE …] [--seeds 5]

For every anatomy, class of maps, noise and target the number is recommended from maps of the class
drawn with other seeds; then fresh maps are sampled at so many farthest points and rebuilt. The
points truly needed by each map are the first of a ladder of numbers at which it meets the target.
"""

import os
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from calibration_cells import CLASSES, N_MODES, NOISES, drawn, measured, rebuilt_error

from auricle.sampling.bandwidth import class_tails
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.recommendation import recommendation
from auricle.sampling.sites import Sites
from auricle.simulation.map_classes import MAP_CLASSES
from auricle.study.preparation import prepare

TARGETS = (0.1, 0.2, 0.3)
LADDER = tuple(round(10 * 1.4**step) for step in range(14))
N_DRAWS = 20
QUANTILES = (0.9,)
FIELDS = (
    "anatomy", "area_cm2", "map", "noise", "target", "quantile", "seed", "recommended", "reason",
    "nrmse", "needed",
)  # fmt: skip


def cells(path: Path, n_seeds: int, n_vertices: int) -> Iterator[dict[str, Any]]:
    """Every case of one anatomy."""
    chamber = prepare(path, n_vertices=n_vertices, n_modes=N_MODES).chamber
    order = farthest_point_sampling(chamber, 1000)
    processes: dict[int, GaussianProcess] = {}

    def error(name: str, seed: int, noise: float, count: int) -> float:
        if count not in processes:
            processes[count] = GaussianProcess(chamber, Sites.at_vertices(order[:count]))
        return rebuilt_error(processes[count], maps[name, seed], noise, seed)

    maps = {(name, seed): drawn(chamber, name, seed) for name in CLASSES for seed in range(n_seeds)}

    ladder = {
        (name, seed, noise): climbed(partial(error, name, seed, noise))
        for name in CLASSES
        for seed in range(n_seeds)
        for noise in NOISES
    }
    for name in CLASSES:
        rng = np.random.default_rng(9_000)
        tails = class_tails(chamber, MAP_CLASSES[name], n_draws=N_DRAWS, rng=rng)
        for noise in NOISES:
            for target in TARGETS:
                for quantile in QUANTILES:
                    advised = recommendation(
                        tails, chamber, target_nrmse=target, noise_ratio=noise, quantile=quantile
                    )
                    count = advised.n_samples
                    processes = {key: each for key, each in processes.items() if key in LADDER}
                    for seed in range(n_seeds):
                        errors = np.array(ladder[name, seed, noise])
                        met = np.flatnonzero(errors <= target)
                        within = count is not None and count <= len(order)
                        yield {
                            "anatomy": path.stem,
                            "area_cm2": chamber.accessible_area / 100,
                            "map": name,
                            "noise": noise,
                            "target": target,
                            "quantile": quantile,
                            "seed": seed,
                            "recommended": count,
                            "reason": advised.unreachable,
                            "nrmse": error(name, seed, noise, count or 1) if within else None,
                            "needed": LADDER[met[0]] if len(met) else None,
                        }


def climbed(error: Callable[[int], float]) -> list[float]:
    """Errors with more and more samples, up to where the hardest target is met."""
    errors: list[float] = []
    for count in LADDER:
        errors.append(error(count))
        if errors[-1] <= min(TARGETS):
            break
    return errors


def main() -> None:
    """Measure the cells."""
    measured(cells, FIELDS)


if __name__ == "__main__":
    main()
