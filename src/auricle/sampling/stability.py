"""Stability: whether samples at given sites fix a number of harmonics, and how firmly."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from auricle.arrays import Floats, read_only
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites
from auricle.sampling.slepian import SlepianFunctions, slepian_functions
from auricle.sampling.voronoi import voronoi

LEAST_STABLE = 0.3
"""Stability constant from which sites count as stable.

On a generated atrium, 100 harmonics: farthest points 1.5 times as many have 0.41, twice as many
0.59; random ones 0.002 and 0.04, three times as many 0.13. Least squares on random places three
times as many as harmonics passes noise on 1.5 times as large as on ideal ones.
"""
LEAST_MARGINAL = 0.05
"""Stability constant below which least squares is refused."""

Verdict = Literal["stable", "marginal", "unstable"]


@dataclass(frozen=True, eq=False)
class Stability:
    """How firmly samples at some sites hold a band of harmonics on the accessible surface.

    With Ψ the band's Slepian functions at the sites (the harmonics themselves where there are no
    caps), r of them, A the accessible area and w the sites' Voronoi shares. No number depends on
    the caps: densely and evenly spread sites bring each of them to 1, with caps or without.

    Attributes
    ----------
    n_sites, n_modes, n_free
        Number N of sites, k of harmonics, and r of degrees of freedom these have on the
        accessible surface.
    constant
        σ_min²(Ψ·√(A/N)): least ratio of a band-limited map's mean square at the sites to that
        over the accessible area; 0 for fewer sites than degrees of freedom.
    weighted
        s = σ_min(diag(w)^½·Ψ·√A), the same with Voronoi weights, as a root: what
        `error_bound` divides by.
    condition
        σ_max/σ_min of Ψ; infinite where the samples leave the map undetermined.
    noise_gain
        g = (N/r) times the mean variance of the least-squares map from samples of variance 1;
        1 is ideal, infinite where the map is undetermined.
    shares
        w, shape (N,).
    """

    n_sites: int
    n_modes: int
    n_free: int
    constant: float
    weighted: float
    condition: float
    noise_gain: float
    shares: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "shares", read_only(self.shares, np.float64))

    @property
    def verdict(self) -> Verdict:
        """Whether least squares at these sites can be relied on."""
        if self.constant >= LEAST_STABLE:
            return "stable"
        return "marginal" if self.constant >= LEAST_MARGINAL else "unstable"


def stability(chamber: Chamber, sites: Sites, n_modes: int) -> Stability:
    """Judge sites for the first `n_modes` harmonics.

    Raises
    ------
    BandError
        If there are not so many harmonics.
    InputError
        If there is no site, or none on a piece of the surface.

    Examples
    --------
    A single site fixes the mean and nothing else:

    >>> from auricle.sampling.chamber import chamber
    >>> from auricle.surface.shapes import icosphere
    >>> ball = chamber(icosphere(radius=10.0, subdivisions=2), 4)
    >>> site = Sites.at_vertices([0])
    >>> stability(ball, site, 1).verdict, stability(ball, site, 2).verdict
    ('stable', 'unstable')
    """
    return judged(chamber, sites, n_modes, voronoi(chamber, sites).shares)


def judged(chamber: Chamber, sites: Sites, n_modes: int, shares: Floats) -> Stability:
    """As `stability`, with the sites' Voronoi shares at hand, shape (N,)."""
    if shares.shape != (len(sites),):
        raise InputError(f"{len(sites)} sites and {shares.size} Voronoi shares: give one a site")
    functions = slepian_functions(chamber, n_modes)
    values = slepian_values(chamber, functions, sites)
    constant, condition, noise_gain = _unweighted(values, functions.area)
    weighted = values * np.sqrt(shares * functions.area)[:, None]
    return Stability(
        n_sites=len(sites),
        n_modes=n_modes,
        n_free=functions.n_free,
        constant=constant,
        weighted=float(_singular_values(weighted)[-1]),
        condition=condition,
        noise_gain=noise_gain,
        shares=shares,
    )


def slepian_values(chamber: Chamber, functions: SlepianFunctions, sites: Sites) -> Floats:
    """Values of Slepian functions at sites, shape (N, r), 1/mm."""
    harmonics = sites.of(chamber.basis.modes[:, : functions.n_modes])
    return harmonics if functions.concentrations.min() == 1.0 else harmonics @ functions.transform


def _unweighted(values: Floats, area: float) -> tuple[float, float, float]:
    singular = _singular_values(values * np.sqrt(area / len(values)))
    if singular[-1] == 0:
        return 0.0, np.inf, np.inf
    gain = float((1 / singular**2).mean())
    return float(singular[-1] ** 2), float(singular[0] / singular[-1]), gain


def _singular_values(matrix: Floats) -> Floats:
    """All r singular values of an (N, r) matrix, descending; 0 where lost in rounding."""
    n_sites, n_free = matrix.shape
    singular = np.zeros(n_free)
    found = np.linalg.svd(matrix, compute_uv=False)
    singular[: len(found)] = found
    singular[singular <= max(n_sites, n_free) * np.finfo(float).eps * singular[0]] = 0.0
    return singular
