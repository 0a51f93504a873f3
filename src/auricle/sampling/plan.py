"""Sampling plans: where to take samples, and what to expect of the map rebuilt from them."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from auricle.arrays import Integers, PerMode, Truths, read_only
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.coverage import Coverage, covered
from auricle.sampling.error_bound import ErrorBound, planned_error_bound
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.local_nyquist import bands
from auricle.sampling.optimal_design import Prior, a_optimal_sampling, d_optimal_sampling
from auricle.sampling.pivoted_qr import pivoted_qr_sampling
from auricle.sampling.sites import Sites
from auricle.sampling.stability import LEAST_MARGINAL, Stability, judged
from auricle.sampling.voronoi import Voronoi, voronoi

Design = Literal["farthest", "pivoted_qr", "a_optimal", "d_optimal"]

POINTS_PER_PIVOTED_MODE = 1.25
"""Points a harmonic that pivoted QR fixes in a plan: from here on its noise gain is about 1.1."""
_LEAST_NOISE = 0.01
"""Relative noise that optimal designs assume at least: without any, every point is perfect."""
_N_BANDWIDTHS = 14
"""Bandwidths a plan tries out; the predicted error is flat around its least."""


@dataclass(frozen=True, eq=False)
class ExpectedMap:
    """What is assumed of a map that is yet to be measured.

    Attributes
    ----------
    tail
        Share of its power beyond the first 1, 2, …, K harmonics without the constant one, 1 − P(k),
        shape (K,): from its class, or from maps of earlier studies.
    noise_ratio
        Standard deviation of a sample's error relative to the map's.

    Raises
    ------
    InputError
        If the tail grows or leaves [0, 1], or the noise is negative or not finite.
    """

    tail: PerMode
    noise_ratio: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "tail", read_only(self.tail, np.float64))
        bounded = (self.tail >= 0).all() and (self.tail <= 1).all()
        if (
            self.tail.ndim != 1
            or not len(self.tail)
            or not bounded
            or np.diff(self.tail).max(initial=0.0) > 1e-12
        ):
            raise InputError("a tail of power is a share by harmonic, in [0, 1], that never grows")
        if not 0 <= self.noise_ratio < np.inf:
            raise InputError(f"noise of {self.noise_ratio} deviations: give a ratio, 0 or more")

    def prior(self, *, area: float) -> Prior:
        """Variances of the coefficients of a map of deviation 1, smoothed over bands."""
        increments = -np.diff(self.tail)
        if not len(increments):
            return Prior(np.array([area]), max(self.noise_ratio, _LEAST_NOISE))
        edges = bands(len(self.tail))
        means = np.add.reduceat(increments, edges[:-1] - 1) / np.diff(edges)
        variances = area * np.concatenate([[1.0], np.repeat(means, np.diff(edges))])
        return Prior(variances, max(self.noise_ratio, _LEAST_NOISE))


@dataclass(frozen=True, eq=False)
class SamplingPlan:
    """Sites and what they are good for.

    Attributes
    ----------
    sites
        Existing ones first, then the planned ones in the order to take them.
    planned
        Vertex indices of the planned ones; empty if the sites came from elsewhere.
    design
        Name of the rule that chose them.
    n_modes
        Bandwidth at which the predicted error is least, of those the sites hold.
    stability
        At that bandwidth; `stability.noise_gain` is g.
    coverage
        Of the accessible surface.
    predicted_nrmse
        Error to expect of least squares at that bandwidth, relative to the map's deviation:
        √((1 − P(k))(1 + g·r/N) + η²·g·r/N), with η the noise, r the degrees of freedom (k
        without caps). The tail comes back aliased like noise. On a generated atrium, for
        activation, Gaussian, disc and scar maps, N of 100 and 300, k/N from ¼ to 0.6: 0.95 to 1.20
        times the true error on farthest points, 0.8 to 1.4 times on random ones.
    bound
        What the error cannot exceed if the assumptions hold at the sites.
    """

    sites: Sites
    planned: Integers
    design: str
    n_modes: int
    stability: Stability
    coverage: Coverage
    predicted_nrmse: float
    bound: ErrorBound

    @property
    def n(self) -> int:
        """Number of sites, existing ones included."""
        return len(self.sites)


def plan_samples(
    chamber: Chamber,
    n_samples: int,
    expected: ExpectedMap,
    *,
    design: Design = "farthest",
    allowed: Truths | None = None,
    existing: Sites | None = None,
) -> SamplingPlan:
    """Where to take `n_samples` more samples of a map that is expected to be so.

    Parameters
    ----------
    chamber
        Where to sample.
    n_samples
        How many, besides the existing ones.
    expected
        The map's tail of power and noise.
    design
        ``farthest`` (spread by distance along the surface, the default), ``pivoted_qr`` (best
        where points are scarce), ``a_optimal`` or ``d_optimal`` (for the expected spectrum).
    allowed
        Which vertices may be chosen, shape (n,); only accessible ones ever are.
    existing
        Samples taken already.

    Raises
    ------
    InputError
        If the design has no such name, or fewer than `n_samples` vertices are allowed.
    """
    planned = _designed(chamber, n_samples, expected, (design, allowed, existing))
    sites = Sites.at_vertices(planned)
    if existing is not None and len(existing):
        sites = Sites(
            np.concatenate([existing.corners, sites.corners]),
            np.concatenate([existing.weights, sites.weights]),
        )
    return evaluated_plan(chamber, sites, expected, design=design, planned=planned)


def evaluated_plan(
    chamber: Chamber,
    sites: Sites,
    expected: ExpectedMap,
    *,
    design: str,
    planned: Integers | None = None,
) -> SamplingPlan:
    """What sites chosen by any rule are good for: random ones, a catheter's, those taken so far."""
    partition = voronoi(chamber, sites)
    certificate, predicted = _operating_point(chamber, sites, expected, partition)
    beyond = float(np.sqrt(expected.tail[certificate.n_modes - 1]))
    return SamplingPlan(
        sites=sites,
        planned=np.empty(0, np.int64) if planned is None else planned,
        design=design,
        n_modes=certificate.n_modes,
        stability=certificate,
        coverage=covered(chamber, sites, partition),
        predicted_nrmse=predicted,
        bound=planned_error_bound(certificate, tail=beyond, noise=expected.noise_ratio),
    )


def predicted_nrmse(certificate: Stability, expected: ExpectedMap) -> float:
    """Error to expect of least squares with this stability, as `SamplingPlan` states it."""
    share = certificate.noise_gain * certificate.n_free / certificate.n_sites
    beyond = float(expected.tail[certificate.n_modes - 1])
    return float(np.sqrt(beyond * (1 + share) + expected.noise_ratio**2 * share))


def _designed(
    chamber: Chamber,
    count: int,
    expected: ExpectedMap,
    how: tuple[Design, Truths | None, Sites | None],
) -> Integers:
    design, allowed, existing = how
    if design == "farthest":
        return farthest_point_sampling(chamber, count, allowed=allowed, existing=existing)
    if design == "pivoted_qr":
        n_sites = count + (0 if existing is None else len(existing))
        n_modes = max(1, min(chamber.basis.n_modes, int(n_sites / POINTS_PER_PIVOTED_MODE)))
        return pivoted_qr_sampling(
            chamber, count, n_modes=n_modes, allowed=allowed, existing=existing
        )
    if design in ("a_optimal", "d_optimal"):
        rule = a_optimal_sampling if design == "a_optimal" else d_optimal_sampling
        prior = expected.prior(area=chamber.basis.area)
        return rule(chamber, count, prior=prior, allowed=allowed, existing=existing)
    raise InputError(
        f"no design is called {design!r}: choose farthest, pivoted_qr, a_optimal or d_optimal"
    )


def _operating_point(
    chamber: Chamber, sites: Sites, expected: ExpectedMap, partition: Voronoi
) -> tuple[Stability, float]:
    """Stability at the bandwidth with the least predicted error, and that error."""
    most = min(len(sites), chamber.basis.n_modes, len(expected.tail))
    choices = np.unique(np.rint(np.geomspace(1, most, _N_BANDWIDTHS)).astype(np.int64))
    points: list[tuple[float, Stability]] = []
    for n_modes in choices.tolist():
        certificate = judged(chamber, sites, n_modes, partition.shares)
        if certificate.constant >= LEAST_MARGINAL or not points:
            points.append((predicted_nrmse(certificate, expected), certificate))
    predicted, certificate = min(points, key=lambda point: point[0])
    return certificate, predicted
