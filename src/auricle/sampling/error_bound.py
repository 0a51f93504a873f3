"""The error bound: what a weighted least-squares map cannot be off by more than."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, PerVertex
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites
from auricle.sampling.slepian import slepian_functions, tail
from auricle.sampling.stability import Stability


@dataclass(frozen=True)
class ErrorBound:
    """A bound on the error of a map rebuilt from samples by Voronoi-weighted least squares.

    ‖f̂ − f‖² ≤ ‖f_⊥‖² + ((‖f_⊥‖_S + ‖e‖_S)/s)², with f_⊥ what the map has beyond the band, e the
    samples' errors, ‖·‖ the root mean square over the accessible area, ‖·‖_S that over the sites
    with Voronoi weights, and s the weighted stability: by Pythagoras, and since least squares
    fits f_⊥ + e no worse than 0 would.

    Attributes
    ----------
    nrmse
        The bound relative to the map's standard deviation; infinite if the samples leave the
        map undetermined.
    tail, tail_at_sites, noise_at_sites
        ‖f_⊥‖, ‖f_⊥‖_S and ‖e‖_S relative to the map's standard deviation.
    weighted_stability
        s.
    certified
        Whether the tail at the sites is known; otherwise the bound holds if it is no more than
        the number stated, which was assumed.
    """

    nrmse: float
    tail: float
    tail_at_sites: float
    noise_at_sites: float
    weighted_stability: float
    certified: bool

    @property
    def statement(self) -> str:
        """The bound in words, its condition included."""
        claim = f"error at most {self.nrmse:.1%} of the map's deviation"
        if self.certified:
            return f"{claim}, certified"
        return (
            f"{claim}, if what lies beyond the band is no more than {self.tail:.1%} over the "
            f"surface and {self.tail_at_sites:.1%} at the samples, and the samples' errors no "
            f"more than {self.noise_at_sites:.1%}"
        )


def planned_error_bound(judged: Stability, *, tail: float, noise: float) -> ErrorBound:
    """Bound before any sample is taken.

    Parameters
    ----------
    judged
        Stability of the planned sites for the band.
    tail
        Assumed root mean square of the map beyond the band, relative to its standard deviation:
        √(1 − P(k)) for a map with share P(k) of its power in k harmonics. Assumed to be no larger
        at the sites, which holds on average but not for every set of sites.
    noise
        Assumed root mean square of the samples' errors, relative likewise.

    Raises
    ------
    InputError
        If the tail or the noise is negative or not finite.

    Examples
    --------
    Perfect sites, a tail of 3 and noise of 1 (hundredths of the deviation): √(3² + (3 + 1)²) = 5.

    >>> perfect = Stability(2, 1, 1, 1.0, weighted=1.0, condition=1.0, noise_gain=1.0, shares=[])
    >>> round(planned_error_bound(perfect, tail=0.03, noise=0.01).nrmse, 12)
    0.05
    """
    return _bound(judged, (tail, tail, noise), certified=False)


def certified_error_bound(
    chamber: Chamber, sites: Sites, judged: Stability, *, truth: PerVertex, errors: Floats
) -> ErrorBound:
    """Bound for a map that is known, as in a simulation or for a map of an earlier study.

    Parameters
    ----------
    chamber
        Where the map lives.
    sites
        Where it is sampled.
    judged
        Stability of these sites for the band.
    truth
        The map, shape (n,).
    errors
        The samples' errors, shape (m,), the map's unit.

    Raises
    ------
    InputError
        If the map does not vary over the accessible surface, `errors` is not one a site, or a
        site lies on a cap.
    """
    if errors.shape != (len(sites),) or judged.n_sites != len(sites):
        raise InputError(f"{len(sites)} sites, {errors.size} errors: give one a site")
    if not chamber.accessible[sites.corners[sites.weights > 0]].all():
        raise InputError("a site lies on a cap, where the map is not known: leave it out")
    deviation = chamber.rms(truth - chamber.mean(truth))
    if not deviation > 0:
        raise InputError("the map is constant: an error relative to its deviation has no meaning")
    beyond = tail(chamber, slepian_functions(chamber, judged.n_modes), truth)
    norms = (
        chamber.rms(beyond),
        _weighted_rms(sites.of(beyond), judged.shares),
        _weighted_rms(errors, judged.shares),
    )
    return _bound(judged, tuple(norm / deviation for norm in norms), certified=True)


def _weighted_rms(values: Floats, shares: Floats) -> float:
    return float(np.sqrt(shares @ values**2))


def _bound(judged: Stability, norms: tuple[float, ...], *, certified: bool) -> ErrorBound:
    beyond, at_sites, noise = norms
    if not (np.isfinite(norms).all() and min(norms) >= 0):
        raise InputError(f"tail {beyond} and noise {noise}: give finite numbers, not negative")
    undetermined = judged.weighted == 0
    aliased = np.inf if undetermined else (at_sites + noise) / judged.weighted
    return ErrorBound(
        nrmse=float(np.hypot(beyond, aliased)),
        tail=beyond,
        tail_at_sites=at_sites,
        noise_at_sites=noise,
        weighted_stability=judged.weighted,
        certified=certified,
    )
