"""The Matérn prior over the harmonics: how much of a map each of them is expected to hold."""

from auricle.arrays import PerMode
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
