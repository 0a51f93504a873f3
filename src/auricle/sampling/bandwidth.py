"""Bandwidth of a map not yet known: from its class, from past maps, or from the samples so far."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, PerMode
from auricle.errors import BandError, InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.criteria import SHARES
from auricle.sampling.tails import Tails, first_within, truncation_tail
from auricle.simulation.foci import gaussian_modes_for_power
from auricle.simulation.map_classes import MapClass
from auricle.surface.field import FieldMap

_VANISHING = 1e-18
"""Share of the energy below which a map counts as constant."""


def class_tails(
    chamber: Chamber,
    map_class: MapClass,
    *,
    n_draws: int,
    rng: np.random.Generator,
    **changed: float,
) -> Tails:
    """Tails of maps of a class, drawn on this very chamber.

    Parameters
    ----------
    chamber
        Foci, cores and scars are centred on its accessible part.
    map_class
        One of `auricle.simulation.map_classes.MAP_CLASSES`.
    n_draws
        How many maps; twenty tell a median from a 90th percentile.
    rng
        Source of randomness.
    **changed
        Parameters of the class other than their defaults.

    Raises
    ------
    InputError
        If there are no draws or a parameter is unknown.
    """
    if n_draws < 1:
        raise InputError(f"{n_draws} draws: ask for at least one map")
    rows = []
    for _ in range(n_draws):
        field = map_class.draw(chamber.mesh, rng, allowed=chamber.accessible, **changed)
        rows.append(truncation_tail(chamber, map_class.columns(field, **changed)))
    return Tails(np.array(rows), source=f"{n_draws} maps drawn: {map_class.title}")


def closed_form_modes(
    map_class: MapClass, *, area: float, share: float, **changed: float
) -> float | None:
    """Number of harmonics that hold a share of the power, where theory has a formula.

    Without the constant one. For Gaussian foci `gaussian_modes_for_power`; for discs of radius r
    k = A/(π³·r²·(1 − p)²), which measurements on a sphere and an atrium met within 40 % only (the
    asymptotic regime begins late); None for the other classes.
    """
    settings = map_class.settings(**changed)
    if map_class.name == "gaussian":
        return gaussian_modes_for_power(area=area, width=settings["width_mm"], share=share)
    if map_class.name == "disc":
        return float(area / (np.pi**3 * settings["radius_mm"] ** 2 * (1 - share) ** 2))
    return None


def past_tails(past: Sequence[tuple[Chamber, FieldMap]], chamber: Chamber) -> Tails:
    """Tails of maps of other chambers, carried over to this one.

    What carries over is the wavelength: the tail at k harmonics on A mm² is taken to be that at
    the same number a mm² elsewhere. Beyond the past harmonics it stays at their last value, which
    can only be too high.

    Parameters
    ----------
    past
        Chambers and maps on their closed meshes, shape (n,) or (n, c); of re-entry, cosine and
        sine of the phase. NaN where not sampled.
    chamber
        The one to map next.

    Raises
    ------
    InputError
        If there is no map, or one does not lie on its chamber's mesh.
    """
    if not past:
        raise InputError("no past maps: give at least one")
    here = np.arange(1, chamber.basis.n_modes + 1)
    rows = []
    for elsewhere, field in past:
        if field.mesh.n_vertices != elsewhere.mesh.n_vertices:
            raise InputError(
                f"field {field.name!r} has {field.mesh.n_vertices} vertices and its chamber "
                f"{elsewhere.mesh.n_vertices}: transfer it to the closed surface first"
            )
        tail = truncation_tail(elsewhere, field.values)
        same_density = here * elsewhere.basis.area / chamber.basis.area
        rows.append(np.interp(same_density, np.arange(1, len(tail) + 1), tail))
    return Tails(np.array(rows), source=f"{len(past)} past maps")


def left_out_coverage(tails: Tails, share: float, *, quantile: float) -> float:
    """Share of maps whose bandwidth is within what the other maps foretell.

    Each map in turn is left out; its number of harmonics for `share` of the power is covered if
    it is at most the one read off the others at `quantile`. A coverage near `quantile` says that
    past maps speak for the next one. What is beyond the harmonics at hand is covered only where
    that was foretold.

    Raises
    ------
    InputError
        If there are fewer than three maps.
    """
    if tails.n_maps < 3:
        raise InputError(f"{tails.n_maps} maps: leaving one out needs at least three")
    errors = tails.squared_errors
    covered = 0
    for left_out in range(tails.n_maps):
        others = Tails(np.delete(errors, left_out, axis=0), tails.source)
        own = _modes_or_more(errors[left_out], 1 - share)
        covered += own <= _modes_or_more(others.at(quantile), 1 - share)
    return covered / tails.n_maps


@dataclass(frozen=True)
class Bracket:
    """Where a map's bandwidth lies, as the samples so far have it.

    Attributes
    ----------
    share
        Share of the power.
    lower, upper
        Harmonics that hold it if the coefficients are their posterior means (too few, since what
        is not yet seen counts as nothing), and if their power is its posterior expectation (too
        many, since what is not known counts in full). Not a confidence interval.
    """

    share: float
    lower: int
    upper: int

    @property
    def closing(self) -> float:
        """The ratio upper/lower: sampling can stop when it has come close to 1."""
        return self.upper / self.lower


def bracket(
    mean: PerMode,
    variance: Floats,
    *,
    shares: Sequence[float] = SHARES,
    gram: Floats | None = None,
) -> tuple[Bracket, ...]:
    """Bandwidth of the map behind the samples so far, from below and above.

    Both ends stem from E[c²] = mean² (+ variance), summed beyond each number of harmonics.

    Parameters
    ----------
    mean
        Posterior mean of the coefficients, shape (k,), the constant one first.
    variance
        Their posterior variances, shape (k,), or covariance, shape (k, k).
    shares
        Shares of the power, without the constant's.
    gram
        Inner products of the modes over the area one can sample, modesᵀ·areas·modes, shape
        (k, k). Give it, with the covariance, where there are caps: what lies on them is not
        known and does not matter. None: the identity, as on a chamber without caps.

    Raises
    ------
    InputError
        If the shapes do not fit, or the posterior is that of a constant map.

    Examples
    --------
    Known coefficients have a bracket that is closed:

    >>> found = bracket(np.array([5.0, 3.0, 1.0]), np.zeros(3), shares=[0.9])
    >>> found[0].lower, found[0].upper, found[0].closing
    (2, 2, 1.0)
    """
    k = len(mean)
    if variance.shape not in ((k,), (k, k)) or (gram is not None and gram.shape != (k, k)):
        raise InputError(f"{k} coefficients with a variance of shape {variance.shape}")
    covariance = np.diag(variance) if variance.ndim == 1 else variance
    products = np.eye(k) if gram is None else gram
    seen = np.outer(mean, mean)
    plug_in, expected = (_expected_tail(each, products) for each in (seen, seen + covariance))
    brackets = []
    for share in shares:
        ends = sorted(first_within(tail, 1 - share) for tail in (plug_in, expected))
        brackets.append(Bracket(share, ends[0], ends[1]))
    return tuple(brackets)


def _expected_tail(moments: Floats, gram: Floats) -> PerMode:
    """Expected share of the power beyond 1, 2, …, k harmonics, from second moments, shape (k,)."""
    energy = moments * gram
    along = gram[0]
    varying = float((energy - moments * np.outer(along, along) / gram[0, 0]).sum())
    if not varying > _VANISHING * float(energy.sum()):
        raise InputError("the posterior is that of a constant map: take samples that vary")
    beyond = np.cumsum(np.cumsum(energy[::-1, ::-1], axis=0), axis=1)[::-1, ::-1].diagonal()
    tail: PerMode = np.append(np.maximum(beyond[1:], 0.0), 0.0) / varying
    return tail


def _modes_or_more(tail: PerMode, bound: float) -> int:
    """Harmonics within a bound, or one more than there are."""
    try:
        return first_within(tail, bound)
    except BandError:
        return len(tail) + 1
