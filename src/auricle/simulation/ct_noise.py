"""What a scanner adds to a scene: blur, correlated noise, streaks and steps between heartbeats."""

from collections.abc import Iterator
from math import sqrt

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.ndimage import gaussian_filter1d, shift

from auricle.arrays import Floats
from auricle.simulation.ct_block import Grid

Slice = NDArray[np.float32]
"""One number a pixel, indexed [row, column]."""

_NOISE_CUTOFF = 0.35
"""Where the noise of a soft-tissue kernel falls off, cycles/mm."""
_NEIGHBOUR = 0.35
"""Weight of the slices above and below in the noise of one."""


def blurred(hu: Grid, sigmas: tuple[float, float, float]) -> Grid:
    """The scene behind a Gaussian point spread; `sigmas` in voxels along k, j and i."""
    for axis, sigma in enumerate(sigmas):
        if sigma > 0.05:
            hu = gaussian_filter1d(hu, sigma, axis=axis, truncate=3.5, mode="nearest")
    return hu


def noise_response(shape: tuple[int, int], spacing: tuple[float, float]) -> Slice:
    """Filter of white noise in the frequency plane of a slice, of unit mean square gain.

    The noise power of filtered back-projection: a ramp times a Gaussian (Riederer, Pelc and
    Chesler 1978, with a smooth kernel).

    Parameters
    ----------
    shape
        Rows and columns.
    spacing
        Their distances, mm.
    """
    rows = fft.fftfreq(shape[0], spacing[0])
    columns = fft.rfftfreq(shape[1], spacing[1])
    frequency = np.hypot(rows[:, None], columns)
    response: Floats = np.sqrt(frequency) * np.exp(-((frequency / _NOISE_CUTOFF) ** 2) / 2)
    weights = np.full(len(columns), 2.0)
    weights[0] = 1.0
    if shape[1] % 2 == 0:
        weights[-1] = 1.0
    mean_square = (response**2 * weights).sum() / (shape[0] * shape[1])
    response /= np.sqrt(mean_square)
    return response.astype(np.float32)


def noise_slices(
    rng: np.random.Generator, shape: tuple[int, int], spacing: tuple[float, float]
) -> Iterator[Slice]:
    """Slice after slice of CT-like noise of unit standard deviation, correlated in 3-D."""
    response = noise_response(shape, spacing)
    total = sqrt(1.0 + 2.0 * _NEIGHBOUR**2)

    def plane() -> Slice:
        white = rng.standard_normal(shape, dtype=np.float32)
        filtered: Slice = fft.irfft2(fft.rfft2(white) * response, s=shape)
        return filtered

    before, here, after = plane(), plane(), plane()
    while True:
        yield ((here + _NEIGHBOUR * (before + after)) / total).astype(np.float32, copy=False)
        before, here, after = here, after, plane()


def streaks(
    shape: tuple[int, int], spacing: tuple[float, float], metal: tuple[float, float]
) -> Slice:
    """Bright and dark rays about a piece of metal in a slice, within ±1.

    Parameters
    ----------
    shape
        Rows and columns.
    spacing
        Their distances, mm.
    metal
        Row and column of the metal, in pixels.
    """
    rows = (np.arange(shape[0], dtype=np.float32)[:, None] - metal[0]) * spacing[0]
    columns = (np.arange(shape[1], dtype=np.float32) - metal[1]) * spacing[1]
    angle = np.arctan2(rows, columns)
    fading = np.exp(-np.hypot(rows, columns) / 45.0)
    rays: Slice = (np.cos(9.0 * angle) * fading).astype(np.float32)
    return rays


def stepped(plane: Slice, offset: tuple[float, float]) -> Slice:
    """A slice moved by rows and columns, its border continued."""
    moved: Slice = shift(plane, offset, order=1, mode="nearest")
    return moved
