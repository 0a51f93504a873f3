"""How many samples a map needs, read off its spectrum."""

import math
from dataclasses import dataclass

import numpy as np

from auricle.arrays import PerMode
from auricle.errors import BandError
from auricle.spectral.power import Spectrum
from auricle.spectral.weyl import nyquist_spacing, trusted_modes, weyl_wavelength

SHARES = (0.85, 0.90, 0.95, 0.99)
"""Shares of the power the criteria are read at; the paper's are the first two."""

POINTS_PER_HARMONIC = {"planned": 2.0, "unplanned": 3.5}
"""Samples a harmonic costs in practice: evenly spread on purpose, or wherever the catheter was.

The count of harmonics is what sampling theory demands at least; at that count the reconstruction
is unstable. The factors are design values above those at which a reconstruction reached the best
error of the harmonics on synthetic anatomies (foci, activation times, re-entry, scar): 1.1 to 2.2
for farthest-point placement, 2 to 3.8 for random placement; docs/decisions/0006 has the grounds.
"""


@dataclass(frozen=True)
class Shell:
    """The closed surface that harmonics live on, as far as sampling is concerned.

    Attributes
    ----------
    area
        Its area, mm², caps over holes included.
    accessible_area
        Area where samples can be taken, mm²: without the caps.
    n_vertices
        Its number of vertices, which limits the harmonics to be trusted.
    """

    area: float
    accessible_area: float
    n_vertices: int

    def samples(self, per_harmonic: float, n_modes: int) -> int:
        """Number of samples on the accessible part at `per_harmonic` samples a harmonic."""
        return math.ceil(per_harmonic * n_modes * self.accessible_area / self.area - 1e-9)


@dataclass(frozen=True)
class Need:
    """What it takes to hold a share of the power.

    Attributes
    ----------
    n_modes
        Number of leading harmonics that hold the share, the constant one included.
    wavelength_mm, nyquist_spacing_mm
        Weyl wavelength of the last of them, and half of it.
    density_per_cm2
        Harmonics per cm²: the least density of samples.
    n_least
        That density times the accessible area: the least number of samples.
    n_planned, n_unplanned
        Recommended number of samples, evenly spread or not (`POINTS_PER_HARMONIC`).
    planned_spacing_mm
        Distance between neighbours when `n_planned` samples form a triangular lattice.
    trusted
        Whether `n_modes` lies within what the mesh resolves (a twelfth of its vertices).
    """

    n_modes: int
    wavelength_mm: float
    nyquist_spacing_mm: float
    density_per_cm2: float
    n_least: int
    n_planned: int
    n_unplanned: int
    planned_spacing_mm: float
    trusted: bool


@dataclass(frozen=True)
class Criterion:
    """One reading of a spectrum: a share of power, the error it stands for, what it needs.

    Attributes
    ----------
    share
        Share of the power, in (0, 1].
    with_constant
        Whether the constant harmonic's power is part of the share.
    nrmse
        The best error at that share: √(1 − share), relative to the map's own deviation from its
        mean (or, with the constant, to its root mean square).
    need
        None if the harmonics at hand hold less than the share.
    """

    share: float
    with_constant: bool
    nrmse: float
    need: Need | None


def need(n_modes: int, shell: Shell) -> Need:
    """What `n_modes` harmonics on `shell` mean for samples.

    Examples
    --------
    Four times the harmonics halve the spacing:

    >>> shell = Shell(area=12_500.0, accessible_area=12_500.0, n_vertices=10_000)
    >>> round(need(50, shell).nyquist_spacing_mm / need(200, shell).nyquist_spacing_mm, 12)
    2.0
    """
    n_planned = shell.samples(POINTS_PER_HARMONIC["planned"], n_modes)
    return Need(
        n_modes=n_modes,
        wavelength_mm=weyl_wavelength(n_modes, area=shell.area),
        nyquist_spacing_mm=nyquist_spacing(n_modes, area=shell.area),
        density_per_cm2=n_modes / (shell.area / 100),
        n_least=shell.samples(1.0, n_modes),
        n_planned=n_planned,
        n_unplanned=shell.samples(POINTS_PER_HARMONIC["unplanned"], n_modes),
        planned_spacing_mm=lattice_spacing(n_planned, area=shell.accessible_area),
        trusted=n_modes <= trusted_modes(shell.n_vertices),
    )


def lattice_spacing(n_samples: int, *, area: float) -> float:
    """Distance between neighbours of `n_samples` points in a triangular lattice on `area`, mm."""
    return math.sqrt(2 * area / (math.sqrt(3) * n_samples))


def criterion(
    spectrum: Spectrum, share: float, shell: Shell, *, with_constant: bool = False
) -> Criterion:
    """Read `spectrum` at one share of the power."""
    try:
        n_modes = spectrum.modes_for_power(share, with_constant=with_constant)
    except BandError:
        needed = None
    else:
        needed = need(n_modes, shell)
    return Criterion(share, with_constant, math.sqrt(1 - share), needed)


def error_criteria(nrmse: PerMode, shell: Shell) -> tuple[Criterion, ...]:
    """Read a measured error curve at the errors that `SHARES` stand for.

    Parameters
    ----------
    nrmse
        Measured error of the first 1 … k harmonics of a map, shape (k,), relative to its
        standard deviation where it was measured.
    shell
        What the harmonics live on.

    Returns
    -------
    tuple of Criterion
        Without the constant; `need` is what it takes for the error to stay within bounds from
        there on. On a closed surface sampled everywhere these are the `criteria`; with caps or
        gaps they are not, since the spectrum is then that of the map with its continuation.

    Examples
    --------
    >>> shell = Shell(area=12_500.0, accessible_area=12_500.0, n_vertices=10_000)
    >>> found = error_criteria(np.array([1.0, 0.35, 0.30, 0.05]), shell)
    >>> [each.need.n_modes for each in found]
    [2, 3, 4, 4]
    """
    readings = []
    for share in SHARES:
        bound = math.sqrt(1 - share)
        beyond = np.flatnonzero(nrmse > bound * (1 + 1e-9))
        n_modes = int(beyond[-1]) + 2 if len(beyond) else 1
        needed = need(n_modes, shell) if n_modes <= len(nrmse) else None
        readings.append(Criterion(share, False, bound, needed))
    return tuple(readings)


def criteria(spectrum: Spectrum, shell: Shell) -> tuple[Criterion, ...]:
    """Read `spectrum` at every share of `SHARES`, without and then with the constant harmonic."""
    return tuple(
        criterion(spectrum, share, shell, with_constant=with_constant)
        for with_constant in (False, True)
        for share in SHARES
    )
