"""Circular reconstruction: activation times that wrap round a cycle, fitted without a seam."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import ive

from auricle.arrays import Floats, PerVertex, Truths
from auricle.errors import InputError
from auricle.sampling.cycle import wrapped
from auricle.sampling.gaussian_process import GaussianProcess, NoisePrior
from auricle.sampling.reconstruction import Reconstruction

SINGULAR_BELOW = 0.5
"""Resultant length under which a vertex counts as part of a phase singularity."""


@dataclass(frozen=True, eq=False)
class CircularReconstruction:
    """Activation times in [0, cycle length), from cosine and sine fitted together.

    Attributes
    ----------
    cycle_length
        In the unit of the times (ms).
    components
        The reconstruction of cosine and sine, columns 0 and 1.
    """

    cycle_length: float
    components: Reconstruction

    @cached_property
    def time(self) -> PerVertex:
        """The map, shape (n,), in [0, cycle length)."""
        angle = np.arctan2(self.components.mean[:, 1], self.components.mean[:, 0])
        return wrapped(angle * self.cycle_length / (2 * np.pi), self.cycle_length)

    @cached_property
    def resultant(self) -> PerVertex:
        """Length |z| of the mean of (cos, sin), shape (n,); near 1 where all is well."""
        length: PerVertex = np.hypot(self.components.mean[:, 0], self.components.mean[:, 1])
        return length

    @property
    def singular(self) -> Truths:
        """Where |z| < `SINGULAR_BELOW`: a phase singularity, or nothing known, shape (n,)."""
        return np.asarray(self.resultant < SINGULAR_BELOW)

    @cached_property
    def std(self) -> PerVertex:
        """Circular standard deviation √(−2 ln R), shape (n,), in the unit of the times.

        R is the mean resultant of the direction of a normal vector about z (Mardia and Jupp
        2000, §3.5.6). Never more than cycle length/√12, that of a time wholly unknown.
        """
        ratio = self.resultant**2 / np.maximum(4 * self.components.variance, 1e-300)
        # Beyond 1e6 the Bessel functions lose what the series 1 − 1/(8·ratio) … keeps.
        near = np.minimum(ratio, 1e6)
        directed = np.sqrt(np.pi * near / 2) * (ive(0, near) + ive(1, near))
        small = np.sqrt(1 / (4 * ratio), where=ratio > 0, out=np.zeros_like(ratio))
        angle = np.where(ratio > 1e6, small, np.sqrt(-2 * np.log(np.clip(directed, 1e-300, 1.0))))
        deviation = angle * self.cycle_length / (2 * np.pi)
        return np.asarray(np.minimum(deviation, self.cycle_length / math.sqrt(12)))


def fit_circular(
    process: GaussianProcess,
    times: Floats,
    cycle_length: float,
    *,
    noise: float | None = None,
    noise_prior: NoisePrior | None = None,
) -> CircularReconstruction:
    """Reconstruct activation times of a re-entry.

    Parameters
    ----------
    process
        On the sites of the samples.
    times
        Shape (N,); any number of cycles may be added to each.
    cycle_length
        Period, in the unit of the times.
    noise, noise_prior
        Of a time, as in `GaussianProcess.fit`; a small error δ of the time moves (cos, sin) by
        2πδ/cycle, which is shared between the two.

    Raises
    ------
    InputError
        If the cycle length is not positive, or as `GaussianProcess.fit`.
    """
    if not (cycle_length > 0 and math.isfinite(cycle_length)):
        raise InputError(f"cycle length {cycle_length}: give a positive number, ms")
    to_component = 2 * math.pi / (cycle_length * math.sqrt(2))
    if noise_prior is not None:
        noise_prior = NoisePrior(noise_prior.median * to_component, noise_prior.spread)
    angle = 2 * np.pi * times / cycle_length
    components = process.fit(
        np.column_stack([np.cos(angle), np.sin(angle)]),
        noise=None if noise is None else noise * to_component,
        noise_prior=noise_prior,
    )
    return CircularReconstruction(cycle_length, components)
