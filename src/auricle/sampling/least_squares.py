"""Band-limited least squares: the harmonics' map nearest to samples, behind a certificate."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, PerMode, PerVertex, read_only
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites
from auricle.sampling.slepian import slepian_functions
from auricle.sampling.stability import (
    LEAST_MARGINAL,
    LEAST_STABLE,
    Stability,
    judged,
    slepian_values,
)
from auricle.sampling.voronoi import voronoi


@dataclass(frozen=True, eq=False)
class LeastSquaresMap:
    """A map rebuilt from samples.

    Attributes
    ----------
    coefficients
        Of the harmonics, shape (k,), the samples' unit times mm.
    values
        At every vertex, shape (n,); on caps too, where they mean nothing.
    certificate
        Stability of the sites for these harmonics.
    leave_one_out
        Error at each sample when the map is fitted without it, shape (m,): sample minus map;
        infinite where the others leave the map undetermined there.
    """

    coefficients: PerMode
    values: PerVertex
    certificate: Stability
    leave_one_out: Floats

    def __post_init__(self) -> None:
        for name in ("coefficients", "values", "leave_one_out"):
            object.__setattr__(self, name, read_only(getattr(self, name), np.float64))


def least_squares(
    chamber: Chamber, sites: Sites, samples: Floats, *, n_modes: int, allow_unstable: bool = False
) -> LeastSquaresMap:
    """The band-limited map with the least Voronoi-weighted squares of residuals.

    Exact, noise and tail apart: `error_bound` has the bound.

    Parameters
    ----------
    chamber
        Where the map lives.
    sites
        Where the samples were taken.
    samples
        Their values, shape (m,).
    n_modes
        Harmonics of the map.
    allow_unstable
        Fit at sites with a stability constant below 0.05 as well, where noise and tail can come
        back hundreds of times larger; never with fewer samples than degrees of freedom.

    Raises
    ------
    InputError
        If there are fewer samples than degrees of freedom, a value is not finite, or the sites
        are unstable for the harmonics.
    BandError
        If there are not so many harmonics.

    Examples
    --------
    Five samples of a map of four harmonics give it back:

    >>> from auricle.sampling.chamber import chamber
    >>> from auricle.surface.shapes import icosphere
    >>> ball = chamber(icosphere(radius=10.0, subdivisions=2), 4)
    >>> truth = ball.basis.inverse(np.array([1.0, 2.0, -3.0, 4.0]))
    >>> sites = Sites.at_vertices([0, 1, 3, 4, 11])
    >>> rebuilt = least_squares(ball, sites, sites.of(truth), n_modes=4)
    >>> bool(np.allclose(rebuilt.values, truth, rtol=1e-12))
    True
    """
    certificate = judged(chamber, sites, n_modes, voronoi(chamber, sites).shares)
    determined = certificate.n_sites >= certificate.n_free
    if determined and certificate.constant < LEAST_MARGINAL and not allow_unstable:
        raise InputError(
            f"{len(sites)} samples fix {n_modes} harmonics with a stability of "
            f"{certificate.constant:.1e}, below {LEAST_MARGINAL}: ask for fewer harmonics, "
            "spread the samples or use the Gaussian process"
        )
    return fitted(chamber, sites, samples, certificate)


def leave_one_out_modes(
    chamber: Chamber, sites: Sites, samples: Floats, choices: Iterable[int]
) -> int:
    """The number of harmonics with the least leave-one-out error, of those the sites hold stably.

    Raises
    ------
    InputError
        If the sites are stable for none of the choices, or a value is not finite.
    """
    shares = voronoi(chamber, sites).shares
    errors = {}
    for n_modes in choices:
        certificate = judged(chamber, sites, n_modes, shares)
        if certificate.constant >= LEAST_STABLE:
            left_out = fitted(chamber, sites, samples, certificate).leave_one_out
            errors[n_modes] = float(shares @ left_out**2)
    if not errors:
        raise InputError(
            f"{len(sites)} samples hold none of these numbers of harmonics stably: "
            "try fewer, or use the Gaussian process"
        )
    return min(errors, key=lambda n_modes: errors[n_modes])


def _checked(sites: Sites, samples: Floats) -> Floats:
    values = np.asarray(samples, dtype=np.float64)
    if values.shape != (len(sites),):
        raise InputError(f"{len(sites)} sites and samples of shape {values.shape}: give one a site")
    if not np.isfinite(values).all():
        raise InputError("a sample is NaN or infinite: leave it out")
    return values


def _require_determined(certificate: Stability) -> None:
    if certificate.n_sites < certificate.n_free:
        raise InputError(
            f"{certificate.n_sites} samples for {certificate.n_free} degrees of freedom: "
            "ask for fewer harmonics or take more samples"
        )


def fitted(
    chamber: Chamber, sites: Sites, samples: Floats, certificate: Stability
) -> LeastSquaresMap:
    """As `least_squares`, with the sites' stability at hand and whatever it is.

    Raises
    ------
    InputError
        If there are fewer samples than degrees of freedom or a value is not finite.
    """
    values = _checked(sites, samples)
    _require_determined(certificate)
    functions = slepian_functions(chamber, certificate.n_modes)
    roots = np.sqrt(certificate.shares)
    design = slepian_values(chamber, functions, sites) * roots[:, None]
    left, singular, right = np.linalg.svd(design, full_matrices=False)
    kept = singular > max(design.shape) * np.finfo(float).eps * singular[0]
    solved = right[kept].T @ ((left[:, kept].T @ (roots * values)) / singular[kept])
    leverages = (left[:, kept] ** 2).sum(axis=1)
    coefficients = functions.transform @ solved
    rebuilt = chamber.basis.inverse(coefficients)
    residuals = values - sites.of(rebuilt)
    left_out = np.full(len(values), np.inf)
    free = 1 - leverages > 1e-12
    left_out[free] = residuals[free] / (1 - leverages[free])
    return LeastSquaresMap(coefficients, rebuilt, certificate, left_out)
