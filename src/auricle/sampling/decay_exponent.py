"""The decay exponent: how fast the error of a map falls with the harmonics, and what that means."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import PerMode
from auricle.errors import BandError, InputError
from auricle.simulation.map_classes import TAIL_EXPONENTS
from auricle.spectral.weyl import trusted_modes

FIRST_SHARE = 0.90
"""The power law is looked for beyond the harmonics that hold this share of the power."""
LEAST_TAIL = 1e-5
"""Tail below which rounding, and the mesh's error in drawing the map, take over."""
STEEPEST_POWER = 3.5
"""An octave steeper than this means an exponential decay.

The singularities of cardiac maps end at 2; measured on a sphere and a generated atrium, no octave
of an activation map exceeded 3.3, and every Gaussian focus had one of 4.2 or more.
"""
_PER_OCTAVE = 4
_FEWEST_OCTAVES = 1.0


@dataclass(frozen=True)
class DecayExponent:
    """The power law 1 − P(k) ~ k^-s of a map's tail.

    Attributes
    ----------
    slope
        The exponent s, fitted over k in [first, last].
    standard_error
        Of the slope, from the scatter of the slopes of quarter octaves. On the safe side: 2.3 times
        the actual scatter for maps with independent random coefficients (300 draws).
    first, last
        Harmonics it was fitted between: from 90 % of the power to what the mesh resolves.
    singularity
        The nearest of `TAIL_EXPONENTS`: ``jump``, ``phase singularity``, ``crease``, ``cone``;
        or ``smooth`` where the tail bends down as an exponential does: the slope then only says
        how far it got. A scar whose border has a width lies between a jump and a crease.
    """

    slope: float
    standard_error: float
    first: int
    last: int
    singularity: str

    @property
    def points_to_halve_the_error(self) -> float:
        """Factor on the number of samples that halves the error: 2^(2/s)."""
        return float(2.0 ** (2.0 / self.slope))


def decay_exponent(tail: PerMode, n_vertices: int) -> DecayExponent:
    """Fit the decay of a map's tail.

    A line through log(1 − P) over log k, at four k an octave; if any octave is steeper than all
    powers (`STEEPEST_POWER`), the decay is that of a smooth map. On a sphere of 2,562 vertices the
    slope came out at 0.49–0.51 for a hemisphere (theory ½), 0.94–0.98 for exp(iφ) (1) and
    1.86–1.88 for the distance from a point (2).

    Parameters
    ----------
    tail
        Share of the power beyond the first 1, 2, …, k harmonics, 1 − P(k), without the
        constant one's, shape (k,): the squared nRMSE.
    n_vertices
        Of the mesh: harmonics beyond a twelfth of it are not used.

    Raises
    ------
    BandError
        If there is less than an octave between 90 % of the power and the end of the harmonics,
        of what the mesh resolves, or of what exceeds rounding.
    InputError
        If the tail is not one finite number, not negative, a harmonic.

    Examples
    --------
    >>> fit = decay_exponent(np.arange(1.0, 400.0) ** -2, 10_000)
    >>> round(fit.slope, 6), fit.singularity
    (2.0, 'cone')
    """
    if tail.ndim != 1 or not (np.isfinite(tail).all() and (tail >= 0).all()):
        raise InputError("a tail is one finite number of at least 0 a harmonic")
    first, last = _range(tail, n_vertices)
    octaves = np.log2(last / first)
    n_points = int(np.ceil(octaves * _PER_OCTAVE)) + 1
    modes = np.unique(np.rint(np.geomspace(first, last, n_points)).astype(np.int64))
    height = np.log(tail[modes - 1])
    logarithm = np.log(modes)
    offset = logarithm - logarithm.mean()
    slope = -float(offset @ height / (offset @ offset))
    local = -np.diff(height) / np.diff(logarithm)
    error = float(local.std(ddof=1) / np.sqrt(len(local)))
    octave = np.ones(min(_PER_OCTAVE, len(local)))
    steepest = float(np.convolve(local, octave / octave.sum(), mode="valid").max())
    singularity = "smooth" if steepest > STEEPEST_POWER else _nearest(slope)
    return DecayExponent(slope, error, first, last, singularity)


def _range(tail: PerMode, n_vertices: int) -> tuple[int, int]:
    """First and last harmonic to fit."""
    held = np.flatnonzero(tail <= 1 - FIRST_SHARE)
    visible = np.flatnonzero(tail < LEAST_TAIL)
    last = min(trusted_modes(n_vertices), int(visible[0]) if len(visible) else len(tail))
    first = int(held[0]) + 1 if len(held) else len(tail)
    # The constant harmonic is the first: no law of decay includes it.
    first = max(first, 2)
    if last < first * 2**_FEWEST_OCTAVES:
        raise BandError(
            f"90 % of the power takes {first} harmonics and {last} can be used: "
            "a decay exponent needs twice as many; refine the mesh or solve for more"
        )
    return first, last


def _nearest(slope: float) -> str:
    powers = {name: power for name, power in TAIL_EXPONENTS.items() if np.isfinite(power)}
    return min(powers, key=lambda name: abs(powers[name] - slope))
