"""The next point: where one more sample is expected to lower the error most."""

import math
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, PerVertex, Truths
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.running_posterior import RunningPosterior


@dataclass(frozen=True, eq=False)
class NextPoint:
    """A place worth a sample.

    Attributes
    ----------
    vertex
        Its vertex.
    position
        Where that is, shape (3,), mm.
    expected_drop
        By how much it lowers the mean variance of the map, unit².
    predicted_nrmse
        Predicted error once it is taken.
    travel_mm
        Straight way from where the catheter is; NaN if that was not said.
    """

    vertex: int
    position: Floats
    expected_drop: float
    predicted_nrmse: float
    travel_mm: float


@dataclass(frozen=True, eq=False)
class Travel:
    """Where the catheter is and what moving it costs.

    Attributes
    ----------
    start
        Position of the tip, shape (3,), mm.
    reach
        Way in mm that takes as long as a sample does: points are chosen by expected drop over
        (1 + way / reach), that is by drop a unit of time. Infinite: moving is free.
    """

    start: Floats
    reach: float = math.inf

    def __post_init__(self) -> None:
        object.__setattr__(self, "start", np.asarray(self.start, dtype=float).reshape(-1))
        if self.start.shape != (3,) or not np.isfinite(self.start).all() or not self.reach > 0:
            raise InputError("travel: give a start of three finite mm and a positive reach")

    def to(self, chamber: Chamber) -> PerVertex:
        """Straight way to each vertex (through the blood), shape (n,), mm."""
        ways: PerVertex = np.linalg.norm(chamber.mesh.vertices - self.start, axis=1)
        return ways


def next_point(
    running: RunningPosterior,
    noise_variance: float,
    *,
    allowed: Truths | None = None,
    travel: Travel | None = None,
) -> NextPoint:
    """The A-optimal next sample.

    Parameters
    ----------
    running
        What is known so far.
    noise_variance
        Of the sample to come, unit².
    allowed
        Where a sample may be taken, shape (n,); None for everywhere accessible.
    travel
        Where the catheter is.

    Raises
    ------
    InputError
        If no vertex is both allowed and accessible.
    """
    chamber = running.chamber
    open_to = chamber.accessible if allowed is None else chamber.accessible & allowed
    if not open_to.any():
        raise InputError("no vertex is both allowed and accessible: allow more of the surface")
    drops = running.expected_drop(noise_variance)
    ways = np.full(len(drops), np.nan) if travel is None else travel.to(chamber)
    worth = drops if travel is None else drops / (1 + ways / travel.reach)
    vertex = int(np.where(open_to, worth, -1.0).argmax())
    drop = float(drops[vertex])
    left = max(running.mean_square_error - drop, 0.0)
    return NextPoint(
        vertex,
        chamber.mesh.vertices[vertex],
        drop,
        math.sqrt(left / running.variation),
        float(ways[vertex]),
    )


def next_points(
    running: RunningPosterior,
    count: int,
    noise_variance: float,
    *,
    allowed: Truths | None = None,
    travel: Travel | None = None,
) -> tuple[NextPoint, ...]:
    """Several next samples, each chosen as if those before it had been taken (greedily).

    The variance does not depend on the values to come, so this needs no guess of them. The
    catheter moves from each to the next.
    """
    ahead = running.copy()
    modes = running.chamber.basis.modes[:, : len(running.coefficients)]
    chosen = []
    for _ in range(count):
        point = next_point(ahead, noise_variance, allowed=allowed, travel=travel)
        ahead.absorb(modes[point.vertex], float(ahead.mean[point.vertex]), noise_variance)
        travel = None if travel is None else Travel(point.position, travel.reach)
        chosen.append(point)
    return tuple(chosen)
