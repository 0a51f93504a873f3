"""The recommended number of samples for an error, from how a kind of map's error falls.

A reconstruction from N samples that keeps k harmonics has a squared nRMSE of about
(1 + α)·(1 − P(k)) + η²·g·k/N: what lies beyond the k harmonics, with the part α of it that the
samples mistake for them, and the share k/N of the noise (η: its standard deviation over the
map's) that gets through, amplified by g. The recommended N is the least for which some k brings
this down to the target, at no fewer than a stated number of samples a harmonic.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from scipy.spatial import KDTree

from auricle.arrays import Floats, PerMode, Points, Truths
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.criteria import POINTS_PER_HARMONIC, Shell, lattice_spacing
from auricle.sampling.tails import Tails
from auricle.spectral.weyl import TRUSTED_SHARE, trusted_modes, weyl_wavelength

DENSEST_PER_CM2 = 20.0
"""Samples per cm² beyond which none are recommended: the densest mapping reported, 20 ± 10 sites
per cm² (Nairn et al., Front Physiol 2020, 575846)."""

_JUMP = 0.75
"""Decay exponent below which a map is taken to jump: half-way from ½ to 1."""
_SLOWEST = 0.05


@dataclass(frozen=True)
class Acquisition:
    """What a way of taking samples costs.

    Attributes
    ----------
    per_harmonic
        Fewest samples a harmonic (`POINTS_PER_HARMONIC`).
    aliasing
        α: share of the power beyond the harmonics that is mistaken for them.
    noise_gain
        g: noise power that gets through, over the ideal k/N.
    """

    per_harmonic: float
    aliasing: float
    noise_gain: float


ACQUISITIONS: Mapping[str, Acquisition] = MappingProxyType(
    {
        "planned": Acquisition(POINTS_PER_HARMONIC["planned"], aliasing=0.1, noise_gain=1.06),
        "unplanned": Acquisition(POINTS_PER_HARMONIC["unplanned"], aliasing=0.4, noise_gain=1.3),
    }
)
"""By how the samples are placed: evenly spread on purpose, or wherever the catheter was.

Planned: measured on one generated atrium with farthest-point designs at two samples a harmonic
(2 to 8 seeds; issue "sampling", notes §3): g = 1.06 at k = 100. Band-limited least squares showed
α = 0.15 to 0.5; for maps as `reconstruct` makes them 0.3 asked for 1.4 to 1.8 times the samples
that real atria needed, 0.1 asks for a tenth less (docs/calibration.md). Unplanned: g read off
between random designs of 3 and 4 samples a harmonic (1.4 at 3); α = g·k/N, what a tail does that
the samples take for noise. A first check on one real, capped atrium of 6,888 vertices (Gaussian
foci, activation, macro re-entry, scar; targets 0.1 to 0.3, noise 0 to 0.2, quantile 0.9; α = 0.3
if planned): a Gaussian process on the recommended number met the target in 29 of 30 maps if
planned, 23 of 26 if not; on 1/1.6 of the planned number in 12 of 30.
"""


@dataclass(frozen=True)
class Recommendation:
    """How many samples for a target error, and how dense; or why none suffice.

    Attributes
    ----------
    target_nrmse
        The error to reach.
    n_samples
        Number of samples on the accessible area; None if unreachable, as are the next four.
    n_modes
        Harmonics that the reconstruction then rests on, the constant one included.
    density_per_cm2, spacing_mm
        Of the samples; distance of neighbours if they form a triangular lattice.
    wavelength_mm
        Of the last of the harmonics.
    predicted_nrmse
        With these samples; if unreachable, the least that the trusted harmonics allow at
        `DENSEST_PER_CM2`.
    limited_by
        ``bandwidth`` if the samples a harmonic needs decide, ``noise`` if averaging it does.
    unreachable
        None, or the reason, then what to do.
    """

    target_nrmse: float
    n_samples: int | None
    n_modes: int | None
    density_per_cm2: float | None
    spacing_mm: float | None
    wavelength_mm: float | None
    predicted_nrmse: float
    limited_by: str
    unreachable: str | None

    def points_for(self, existing: Points) -> int | None:
        """How many more samples are needed beside existing ones; None if unreachable.

        Samples closer together than half the recommended spacing count as one. The distance is
        the straight one, so that across a thin wall two may be counted as one: never too few
        are asked for.

        Parameters
        ----------
        existing
            Positions on the accessible surface, shape (m, 3), mm.
        """
        if self.n_samples is None or self.spacing_mm is None:
            return None
        return max(self.n_samples - _count_apart(existing, self.spacing_mm / 2), 0)


@dataclass(frozen=True)
class _Question:
    """One recommendation to make: the tail, what it is on, and how it is to be sampled."""

    tail: PerMode
    shell: Shell
    target: float
    noise_ratio: float
    acquisition: Acquisition

    @property
    def n_trusted(self) -> int:
        """Harmonics that are at hand and resolved by the mesh."""
        return min(len(self.tail), trusted_modes(self.shell.n_vertices))

    @property
    def accessible_share(self) -> float:
        return self.shell.accessible_area / self.shell.area

    def squared_error(self, n_samples: float) -> PerMode:
        """Predicted squared nRMSE by number of harmonics; infinite where samples are too few."""
        modes = np.arange(1, self.n_trusted + 1) * self.accessible_share
        missed = (1 + self.acquisition.aliasing) * self.tail[: self.n_trusted]
        noise = self.noise_ratio**2 * self.acquisition.noise_gain * modes / n_samples
        allowed: Truths = modes * self.acquisition.per_harmonic <= n_samples * (1 + 1e-9)
        return np.where(allowed, missed + noise, np.inf)

    def samples_by_modes(self) -> tuple[Floats, Floats]:
        """Samples that bandwidth and noise ask for, by number of harmonics; infinite if none do."""
        modes = np.arange(1, self.n_trusted + 1) * self.accessible_share
        room = self.target**2 - (1 + self.acquisition.aliasing) * self.tail[: self.n_trusted]
        enough = room > 0
        for_bandwidth = np.where(enough, self.acquisition.per_harmonic * modes, np.inf)
        noise_power = self.noise_ratio**2 * self.acquisition.noise_gain * modes
        for_noise = np.full(len(modes), np.inf)
        np.divide(noise_power, room, out=for_noise, where=enough)
        return for_bandwidth, for_noise


def shell_of(chamber: Chamber) -> Shell:
    """What the criteria need to know of a chamber."""
    return Shell(chamber.basis.area, chamber.accessible_area, chamber.mesh.n_vertices)


def recommendation(
    tails: Tails,
    chamber: Chamber,
    *,
    target_nrmse: float,
    noise_ratio: float = 0.0,
    acquisition: str = "planned",
    quantile: float = 0.9,
) -> Recommendation:
    """The number of samples with which a kind of map is reconstructed to a target error.

    Parameters
    ----------
    tails
        Of maps of the kind to be expected, on this chamber (`auricle.sampling.bandwidth`).
    chamber
        What is to be sampled.
    target_nrmse
        Root-mean-square error over the map's standard deviation, in (0, 1).
    noise_ratio
        Standard deviation of a sample's noise over that of the map.
    acquisition
        ``planned`` or ``unplanned`` (`ACQUISITIONS`).
    quantile
        Share of the maps for which the number is to suffice: 0.5 for the middling one.

    Returns
    -------
    Recommendation
        Never less than `per_harmonic` samples for each of the harmonics that hold 1 − target²
        of the power; `unreachable` says why where there is no number.

    Raises
    ------
    InputError
        If a number is out of range, the acquisition is unknown, or the tails are another
        basis'.
    """
    if not 0 < target_nrmse < 1:
        raise InputError(f"a target error of {target_nrmse}: give more than 0 and less than 1")
    if not (noise_ratio >= 0 and math.isfinite(noise_ratio)):
        raise InputError(f"a noise ratio of {noise_ratio}: give at least 0")
    if acquisition not in ACQUISITIONS:
        raise InputError(f"acquisition {acquisition!r}: choose {' or '.join(ACQUISITIONS)}")
    if tails.n_modes != chamber.basis.n_modes:
        raise InputError(
            f"tails of {tails.n_modes} harmonics and {chamber.basis.n_modes} of the chamber: "
            "draw or carry over the maps to this chamber"
        )
    question = _Question(
        tails.at(quantile),
        shell_of(chamber),
        target_nrmse,
        noise_ratio,
        ACQUISITIONS[acquisition],
    )
    return _answer(question)


def _answer(question: _Question) -> Recommendation:
    for_bandwidth, for_noise = question.samples_by_modes()
    needed = np.maximum(for_bandwidth, for_noise)
    best = int(needed.argmin())
    most = DENSEST_PER_CM2 * question.shell.accessible_area / 100
    if needed[best] > most:
        return _refusal(question, most, for_bandwidth)
    n_samples = math.ceil(needed[best] - 1e-9)
    squared = question.squared_error(n_samples)
    n_modes = int(squared.argmin()) + 1
    return Recommendation(
        target_nrmse=question.target,
        n_samples=n_samples,
        n_modes=n_modes,
        density_per_cm2=100 * n_samples / question.shell.accessible_area,
        spacing_mm=lattice_spacing(n_samples, area=question.shell.accessible_area),
        wavelength_mm=weyl_wavelength(n_modes, area=question.shell.area),
        predicted_nrmse=float(np.sqrt(squared[n_modes - 1])),
        limited_by="noise" if for_noise[best] > for_bandwidth[best] else "bandwidth",
        unreachable=None,
    )


def _refusal(question: _Question, most: float, for_bandwidth: Floats) -> Recommendation:
    is_noise = bool((for_bandwidth <= most).any())
    return Recommendation(
        target_nrmse=question.target,
        n_samples=None,
        n_modes=None,
        density_per_cm2=None,
        spacing_mm=None,
        wavelength_mm=None,
        predicted_nrmse=float(np.sqrt(question.squared_error(most).min())),
        limited_by="noise" if is_noise else "bandwidth",
        unreachable=_noise_reason(question) if is_noise else _bandwidth_reason(question),
    )


def _noise_reason(question: _Question) -> str:
    return (
        f"the noise ({question.noise_ratio:.0%} of the map's deviation) is not averaged to "
        f"{question.target:.0%} by {DENSEST_PER_CM2:g} samples per cm²: annotate better or "
        "allow a larger error"
    )


def _bandwidth_reason(question: _Question) -> str:
    bound = question.target**2 / (1 + question.acquisition.aliasing)
    tail = question.tail[: question.n_trusted]
    too_dense = f"more than {DENSEST_PER_CM2:g} samples per cm²"
    if (tail <= bound).any():
        return f"it takes {too_dense}: plan where to sample, or allow a larger error"
    left = f"{len(tail)} harmonics leave {math.sqrt(tail[-1]):.0%} of error"
    slope = _last_slope(tail)
    modes = len(tail) * (float(tail[-1]) / bound) ** (1 / slope)
    if question.acquisition.per_harmonic * modes > DENSEST_PER_CM2 * question.shell.area / 100:
        what = "the map jumps" if slope < _JUMP else "the error falls slowly"
        return (
            f"{what} (decay exponent {slope:.2f}: half the error takes {2 ** (2 / slope):.1f} "
            f"times the samples): it would take {too_dense}; allow a larger error"
        )
    if len(tail) < trusted_modes(question.shell.n_vertices):
        return f"{left}: solve for {modes:.0f}"
    n_vertices = math.ceil(modes / TRUSTED_SHARE / 1000) * 1000
    return (
        f"{left} and the mesh resolves no more: use one of {n_vertices} vertices, and {modes:.0f} "
        "harmonics"
    )


def _last_slope(tail: PerMode) -> float:
    """Decay exponent over the last two octaves."""
    first = max(len(tail) // 4, 1)
    fall = float(np.log(tail[first - 1] / tail[-1]))
    return max(fall / math.log(len(tail) / first), _SLOWEST)


def _count_apart(positions: Points, spacing: float) -> int:
    """How many of the positions stay if each that is nearer to one kept than `spacing` goes."""
    if not len(positions):
        return 0
    near = KDTree(positions).query_ball_point(positions, spacing * (1 - 1e-9))
    gone = np.zeros(len(positions), dtype=bool)
    kept = 0
    for place, neighbours in enumerate(near):
        if not gone[place]:
            kept += 1
            gone[neighbours] = True
    return kept
