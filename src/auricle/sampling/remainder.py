"""The remainder: what a prior of several Matérn terms holds beyond the harmonics."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import KDTree

from auricle.arrays import Floats
from auricle.sampling.chamber import Chamber
from auricle.sampling.matern import matern_correlation, split_prior
from auricle.sampling.sites import Sites
from auricle.spectral.harmonics import Harmonics

_NEGLIGIBLE = 5e-3
"""Correlation below which a sample says nothing of a vertex."""


@dataclass(frozen=True)
class Term:
    """One Matérn covariance of several that make up a prior.

    Attributes
    ----------
    length
        Correlation length, mm.
    smoothness
        ν.
    share
        Of the prior's variance; those of all terms add up to 1.
    """

    length: float
    smoothness: float
    share: float


@dataclass(frozen=True)
class Remainder:
    """Detail finer than the harmonics: correlated over a millimetre or two of straight way.

    The straight way, since detail reaches no farther than a wall is thick.

    Attributes
    ----------
    variance
        Of the detail, the whole prior's being 1.
    parts
        Share of it, rate κ (1/mm) and smoothness ν of every term.
    """

    variance: float
    parts: tuple[tuple[float, float, float], ...]

    @classmethod
    def of(cls, basis: Harmonics, n_modes: int, terms: tuple[Term, ...]) -> Self:
        """What a prior of these terms holds beyond the first `n_modes` harmonics."""
        splits = [
            split_prior(basis, n_modes, length=each.length, smoothness=each.smoothness)
            for each in terms
        ]
        held = [term.share * split.remainder for term, split in zip(terms, splits, strict=True)]
        variance = sum(held)
        parts = zip(held, splits, terms, strict=True)
        return cls(
            variance,
            tuple((each / variance, split.rate, term.smoothness) for each, split, term in parts),
        )

    def correlation(self, distances: Floats) -> Floats:
        """Correlation of the detail at places so far apart, mm."""
        correlation: Floats = np.zeros(np.shape(distances))
        for share, rate, smoothness in self.parts:
            correlation += share * matern_correlation(rate * distances, smoothness)
        return correlation

    @cached_property
    def reach(self) -> float:
        """Distance, mm, beyond which the correlation is negligible."""
        slowest = min(rate for _, rate, _ in self.parts)
        distances = np.linspace(0.0, 20.0, 401) / slowest
        return float(distances[np.flatnonzero(self.correlation(distances) > _NEGLIGIBLE)[-1] + 1])

    def between(self, chamber: Chamber, sites: Sites) -> csr_array:
        """Correlation of the detail at each vertex with that at each sample, shape (n, N)."""
        vertices = KDTree(chamber.mesh.vertices)
        samples = KDTree(sites.positions(chamber.mesh))
        near = vertices.sparse_distance_matrix(samples, self.reach, output_type="coo_matrix")
        entries = (self.correlation(near.data), (near.row, near.col))
        return csr_array(entries, shape=(vertices.n, samples.n))
