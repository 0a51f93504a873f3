"""How samples compare in noise, and how far they spread when those of less noise count more."""

import math

import numpy as np

from auricle.arrays import Floats
from auricle.errors import InputError


def relative_noise(noise_shape: Floats | None, n_samples: int) -> Floats:
    """Noise of each sample relative to the root mean square, shape (N,).

    Raises
    ------
    InputError
        If it is not one positive number a sample; None is all alike.

    Examples
    --------
    >>> relative_noise(np.array([1.0, 7.0]), 2).tolist()
    [0.2, 1.4]
    """
    shape = np.ones(n_samples) if noise_shape is None else np.asarray(noise_shape, dtype=float)
    if shape.shape != (n_samples,) or not (np.isfinite(shape) & (shape > 0)).all():
        raise InputError(f"noise of shape {shape.shape}: give one positive number a site")
    relative: Floats = shape / math.sqrt(np.square(shape).mean())
    return relative


def weighted_deviation(values: Floats, noise_shape: Floats) -> float:
    """Standard deviation of samples of shape (N, c), those of less noise counting more.

    Examples
    --------
    >>> weighted_deviation(np.array([[1.0], [3.0]]), np.ones(2)) == 2**0.5
    True
    """
    if len(values) < 2:
        return 0.0
    weights = noise_shape**-2.0
    mean = weights @ values / weights.sum()
    squares = weights @ np.square(values - mean) / weights.sum()
    return math.sqrt(squares.mean() * len(values) / (len(values) - 1))
