"""The Matérn prior over the harmonics: how much of a map each of them is expected to hold."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import k1

from auricle.arrays import Floats, PerMode
from auricle.errors import InputError
from auricle.spectral.harmonics import Harmonics


def matern_variances(basis: Harmonics, *, length: float, smoothness: float = 1.5) -> PerMode:
    """Prior variance of every coefficient of a map of standard deviation 1.

    On a surface the Matérn covariance has the spectral density (2ν/ℓ² + λ)^-(ν + 1). It is scaled
    so that the map's variance is 1 in the mean over the surface. The constant mode stands apart:
    its variance is given as 0 here, and whoever conditions on samples leaves it free (a flat
    prior), since samples say nothing of a map's mean beforehand.

    Parameters
    ----------
    basis
        The harmonics.
    length
        Correlation length ℓ, mm.
    smoothness
        ν: such maps have just fewer than ν derivatives.

    Returns
    -------
    PerMode
        Shape (k,), mm² (times the map's variance).

    Raises
    ------
    InputError
        If the length or the smoothness is not positive, or there is only the constant mode.

    References
    ----------
    Borovitskiy et al. 2020, "Matérn Gaussian processes on Riemannian manifolds", Eq. 10;
    Coveney et al. 2020, Phil. Trans. R. Soc. A 378:20190345, on atria.

    Examples
    --------
    The variances add up to the area, since a mode of coefficient 1 has mean square 1/area:

    >>> from auricle.spectral.harmonics import manifold_harmonics
    >>> from auricle.surface.shapes import icosphere
    >>> basis = manifold_harmonics(icosphere(radius=10.0, subdivisions=2), 25)
    >>> round(float(matern_variances(basis, length=5.0).sum() / basis.area), 12)
    1.0
    """
    if not (length > 0 and smoothness > 0):
        raise InputError(f"length {length} mm, smoothness {smoothness}: both must be positive")
    if basis.n_modes < 2:
        raise InputError("the basis holds the constant mode only: ask for more harmonics")
    # Relative to the first term, so that no power of a number in 1/mm² can overflow.
    density = (1.0 + basis.eigenvalues * length**2 / (2 * smoothness)) ** -(smoothness + 1)
    density[0] = 0.0
    variances: PerMode = density * (basis.area / density.sum())
    return variances


_EQUAL = 1e-6
_COARSE_SHARE = 1 / 30
"""Harmonics a vertex from which on the mesh's eigenvalues are more than 3 % too small."""


@dataclass(frozen=True, eq=False)
class SplitPrior:
    """A Matérn prior of standard deviation 1 in two parts: on some harmonics, and beyond them.

    Attributes
    ----------
    variances
        Of the coefficients of the first k harmonics, shape (k,), mm²; 0 for the constant.
    remainder
        Variance that the map has beyond them.
    rate
        κ of the remainder, 1/mm: its correlation at the distance r is `matern_correlation` of κr.
    """

    variances: PerMode
    remainder: float
    rate: float


def split_prior(
    basis: Harmonics, n_modes: int, *, length: float, smoothness: float = 1.5
) -> SplitPrior:
    """The Matérn prior on the first `n_modes` harmonics, and what it holds beyond the last.

    By Weyl's law, A·dλ/4π harmonics lie between λ and λ + dλ, so that the spectral density
    (κ² + λ)^-(ν + 1), κ² = 2ν/ℓ², holds A·(κ² + λ_k)^-ν/4πν beyond λ_k: just what the whole of a
    Matérn process of the rate √(κ² + λ_k) holds. That process, which has the same spectrum at
    short wavelengths, stands for the remainder. It is correlated over a millimetre or two.

    Examples
    --------
    The two parts have the variance 1 together, and a rough prior leaves more beyond:

    >>> from auricle.spectral.harmonics import manifold_harmonics
    >>> from auricle.surface.shapes import icosphere
    >>> basis = manifold_harmonics(icosphere(radius=10.0, subdivisions=3), 100)
    >>> rough, smooth = (split_prior(basis, 100, length=5.0, smoothness=nu) for nu in (0.5, 2.5))
    >>> round(float(rough.variances.sum() / basis.area + rough.remainder), 12)
    1.0
    >>> rough.remainder > 10 * smooth.remainder
    True
    """
    eigenvalues = _resolved_eigenvalues(basis, n_modes)
    last = float(eigenvalues[-1])
    scale = length**2 / (2 * smoothness)
    # Relative to the density of the first harmonics, 1: a share of the basis' own Weyl count.
    beyond = n_modes / (last * smoothness * scale) * (1.0 + last * scale) ** -smoothness
    density = (1.0 + eigenvalues * scale) ** -(smoothness + 1)
    density[0] = 0.0
    total = float(density.sum() + beyond)
    variances: PerMode = density * (basis.area / total)
    return SplitPrior(variances, float(beyond / total), math.sqrt(1.0 / scale + last))


def _resolved_eigenvalues(basis: Harmonics, n_modes: int) -> PerMode:
    """Eigenvalues of the surface, shape (k,): Weyl's where the mesh's fall short of them.

    Those of the mesh are too small by about 0.8·k/n, which would make a prior rougher than it
    says at short wavelengths; the surface's are 4πk/A to a few per cent there.
    """
    found = basis.eigenvalues[:n_modes]
    # Equal ones share their place: the prior must not tell apart what the surface does not.
    first = np.searchsorted(found, found * (1 - _EQUAL))
    last = np.searchsorted(found, found * (1 + _EQUAL), side="right") - 1
    counts = (first + last) / 2
    weyl = np.where(counts > _COARSE_SHARE * len(basis.areas), 4 * np.pi * counts / basis.area, 0)
    eigenvalues: PerMode = np.maximum(found, weyl)
    return eigenvalues


def matern_correlation(distances: Floats, smoothness: float) -> Floats:
    """Correlation of a Matérn process of ν = ½, 1, 3/2 or 5/2 at distances in units of 1/κ.

    Raises
    ------
    InputError
        If ν is another.

    Examples
    --------
    >>> matern_correlation(np.array([0.0, 1.0]), 0.5).round(4).tolist()
    [1.0, 0.3679]
    """
    if smoothness == 1.0:
        away = np.maximum(distances, 1e-9)
        return np.asarray(away * k1(away))
    if smoothness not in _POLYNOMIALS:
        raise InputError(f"smoothness {smoothness}: choose 0.5, 1, 1.5 or 2.5")
    return np.asarray(np.polyval(_POLYNOMIALS[smoothness], distances) * np.exp(-distances))


_POLYNOMIALS = {0.5: (1.0,), 1.5: (1.0, 1.0), 2.5: (1 / 3, 1.0, 1.0)}
