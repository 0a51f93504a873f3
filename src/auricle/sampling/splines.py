"""Splines through the samples of a chamber, over place and direction of the wall."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import eigh
from scipy.spatial.distance import cdist

from auricle.arrays import Floats
from auricle.sampling.chamber import Chamber
from auricle.sampling.noise_shape import weighted_deviation
from auricle.sampling.sites import Sites

WALL_SHARE = 1 / 18
"""How far apart, relative to the diameter √(A/π), walls of normals a radian apart count."""
NORMAL_MODES = 60
"""Harmonics that carry the direction of the wall: its folds, not the roughness of a mesh."""
_SMOOTHINGS = np.geomspace(1e-8, 1e3, 45)
_FINER, _REFINEMENTS = 17, 3
_ENTRIES_AT_ONCE = 2_000_000


@dataclass(frozen=True)
class SplineTerm:
    """One spline of a map's mixture.

    Attributes
    ----------
    power
        Of the distance.
    share
        In the map.
    smoothing
        Noise variance over the spline's: how far it may stay off the samples.
    """

    power: float
    share: float
    smoothing: float


def wall_places(chamber: Chamber) -> Floats:
    """Place and direction of the wall of every vertex, shape (n, 6), in units of the diameter.

    The outward normal, on the first `NORMAL_MODES` harmonics, stands beside the place: two walls
    back to back are as far apart as `WALL_SHARE` says, however thin they are.
    """
    mesh, basis = chamber.mesh, chamber.basis
    modes = basis.modes[:, :NORMAL_MODES]
    weighted = mesh.face_normals * mesh.face_areas[:, None]
    normals = np.zeros_like(mesh.vertices)
    for corner in mesh.faces.T:
        np.add.at(normals, corner, weighted)
    normals = modes @ (modes.T @ normals)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    diameter = math.sqrt(basis.area / math.pi)
    return np.hstack([mesh.vertices / diameter, WALL_SHARE * normals])


class Spline:
    """The smoothest map near the samples, as −(distance)^power judges smoothness.

    Kriging with a generalised covariance (Matheron 1973): −r^β, 0 < β < 2, is positive beside a
    constant, which is free. β = 1 is the linear radial function of mapping systems; β near 2 is
    nearly as smooth as the thin-plate spline, but has no slope in space that goes on for ever
    where there are no samples. Both are here smoothed for noise and kept from leaking through
    thin walls.

    Parameters
    ----------
    chamber
        Where the map lives.
    sites
        Where it was sampled.
    power
        β.
    noise_shape
        Noise of each sample relative to the root mean square, shape (N,).
    """

    def __init__(self, chamber: Chamber, sites: Sites, power: float, noise_shape: Floats) -> None:
        self.power = power
        self.noise_shape = noise_shape
        self._vertices = wall_places(chamber)
        self._samples = sites.of(self._vertices)

    @cached_property
    def _decomposed(self) -> tuple[Floats, Floats]:
        """Eigenvalues of the whitened covariance beside the constant, and their vectors."""
        whole, _ = np.linalg.qr(1 / self.noise_shape[:, None], mode="complete")
        beside = whole[:, 1:]
        eigenvalues, vectors = eigh(beside.T @ self._among @ beside)
        return np.maximum(eigenvalues, 0.0), beside @ vectors

    @cached_property
    def _among(self) -> Floats:
        covariance: Floats = -(cdist(self._samples, self._samples) ** self.power)
        return covariance / np.outer(self.noise_shape, self.noise_shape)

    def smoothing(self, values: Floats, noise: float) -> float:
        """The most probable smoothing of values, shape (N, c), of a known noise.

        By the restricted likelihood of their contrasts; what is guessed of the spline's variance
        beforehand, from the values' deviation, counts as one sample.
        """
        eigenvalues, vectors = self._decomposed
        scale = float(eigenvalues.mean()) if len(eigenvalues) else 0.0
        if not scale > 0:
            return 1.0
        shares = eigenvalues / scale
        energies = np.square(vectors.T @ (values / self.noise_shape[:, None])).sum(axis=1)
        guess = weighted_deviation(values, self.noise_shape) ** 2 / noise**2

        def objective(ratios: Floats) -> Floats:
            spread = shares / ratios[:, None] + 1
            fit = (values.shape[1] * np.log(spread) + energies / noise**2 / spread).sum(axis=1)
            return np.asarray(fit + guess * ratios - np.log(ratios))

        best = _SMOOTHINGS[int(objective(_SMOOTHINGS).argmin())]
        reach = math.log(_SMOOTHINGS[1] / _SMOOTHINGS[0])
        for _ in range(_REFINEMENTS):
            around = best * np.exp(np.linspace(-reach, reach, _FINER))
            best = around[int(objective(around).argmin())]
            reach *= 2 / (_FINER - 1)
        return float(best * scale)

    def mean(self, values: Floats, smoothing: float) -> Floats:
        """The map, shape (n, c), of values of shape (N, c): linear in them."""
        whitened = values / self.noise_shape[:, None]
        weights, _ = self._weights(whitened, smoothing)
        rest = whitened - self._among @ weights - smoothing * weights
        level = (rest / self.noise_shape[:, None]).sum(axis=0) / (self.noise_shape**-2.0).sum()
        weights = weights / self.noise_shape[:, None]
        rows = max(_ENTRIES_AT_ONCE // len(values), 1)
        parts = [
            level - cdist(some, self._samples) ** self.power @ weights
            for some in np.split(self._vertices, range(rows, len(self._vertices), rows))
        ]
        return np.concatenate(parts)

    def left_out(self, values: Floats, smoothing: float) -> Floats:
        """Each value minus its prediction from all the others, shape (N, c), in closed form.

        Of a lone sample, 0.
        """
        weights, own = self._weights(values / self.noise_shape[:, None], smoothing)
        known = own > np.finfo(float).eps / smoothing
        residuals = weights / np.where(known, own, np.inf)[:, None]
        return np.asarray(residuals * self.noise_shape[:, None])

    def precision(self, smoothing: float) -> Floats:
        """Of the values beside the constant, in units of the noise variance, shape (N, N).

        Divided by the smoothing it is inverse to the covariance whose noise is one.
        """
        eigenvalues, vectors = self._decomposed
        scaled = vectors / self.noise_shape[:, None]
        return np.asarray((scaled / (eigenvalues + smoothing)) @ scaled.T)

    def _weights(self, whitened: Floats, smoothing: float) -> tuple[Floats, Floats]:
        """Precision times values, and the precision's diagonal."""
        eigenvalues, vectors = self._decomposed
        inverse = 1 / (eigenvalues + smoothing)
        weights = vectors @ (inverse[:, None] * (vectors.T @ whitened))
        return weights, np.square(vectors) @ inverse
