"""Decay: an exponential fitted to how an error falls with the number of points or harmonics."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize_scalar, nnls
from scipy.stats import t as student

from auricle.arrays import Floats
from auricle.errors import InputError

CONFIDENCE = 0.95
SHORTEST, LONGEST = 1e-3, 1e3
"""Where τ is looked for, in widths of the range of counts."""
GRID = 241


@dataclass(frozen=True)
class Decay:
    """error ≈ initial · exp(-count / tau) + floor.

    Attributes
    ----------
    tau
        Count over which the error falls to 1/e of its way to the floor.
    initial
        Height above the floor at count 0, in the errors' unit.
    floor
        What the error falls to; 0 if fitted without.
    residual
        Root mean square of what the fit leaves, in the errors' unit.
    tau_low, tau_high
        Confidence interval of 95 % for τ, by the profile of the squared residuals; infinite above
        where the data do not tell τ from a straight line.
    """

    tau: float
    initial: float
    floor: float
    residual: float
    tau_low: float
    tau_high: float


@dataclass(frozen=True, eq=False)
class _Samples:
    counts: Floats
    errors: Floats
    with_floor: bool

    def fit(self, log_tau: float) -> tuple[Floats, float]:
        """Best height and floor for a τ, neither below 0, and the sum of squared residuals."""
        # From the first count on, as the height at 0 overflows nowhere then.
        falling = np.exp(-(self.counts - self.counts.min()) / np.exp(log_tau))
        columns = [falling, np.ones_like(falling)] if self.with_floor else [falling]
        heights, norm = nnls(np.column_stack(columns), self.errors)
        return heights, float(norm) ** 2

    def squares(self, log_tau: float) -> float:
        return self.fit(log_tau)[1]


def fit_decay(counts: Floats, errors: Floats, *, floor: bool) -> Decay:
    """Fit an exponential by least squares, as the paper does for GD and MSE ("decay constant τ").

    For each τ height and floor follow linearly, so one number is searched, over a grid first:
    the fit cannot end in a local minimum finer than the grid.

    Parameters
    ----------
    counts
        Numbers of points or harmonics, shape (c,), in any order.
    errors
        Error at each, shape (c,), not negative.
    floor
        Whether the error falls to a floor, fitted as well, or to 0.

    Raises
    ------
    InputError
        If the shapes do not agree, there are fewer than four different counts, a number is not
        finite or an error negative, or the errors do not fall.

    Examples
    --------
    >>> counts = np.arange(50.0, 1000.0, 50.0)
    >>> found = fit_decay(counts, 3.0 * np.exp(-counts / 170.0) + 0.2, floor=True)
    >>> round(found.tau, 3), round(found.initial, 4), round(found.floor, 4)
    (170.0, 3.0, 0.2)
    """
    samples = _Samples(*_checked(counts, errors), floor)
    width = np.log(np.ptp(samples.counts))
    grid = np.linspace(width + np.log(SHORTEST), width + np.log(LONGEST), GRID)
    squares = np.array([samples.squares(log_tau) for log_tau in grid])
    best = int(squares.argmin())
    if best in (0, GRID - 1):
        raise InputError("the errors do not fall exponentially with the count: give other counts")
    log_tau = float(
        minimize_scalar(
            samples.squares, bounds=(grid[best - 1], grid[best + 1]), options={"xatol": 1e-10}
        ).x
    )
    heights, least = samples.fit(log_tau)
    low, high = _interval(samples, grid, log_tau)
    tau = float(np.exp(log_tau))
    return Decay(
        tau=tau,
        initial=float(heights[0] * np.exp(samples.counts.min() / tau)),
        floor=float(heights[1]) if floor else 0.0,
        residual=float(np.sqrt(least / len(samples.counts))),
        tau_low=low,
        tau_high=high,
    )


def _checked(counts: Floats, errors: Floats) -> tuple[Floats, Floats]:
    counts, errors = np.asarray(counts, dtype=np.float64), np.asarray(errors, dtype=np.float64)
    if counts.ndim != 1 or counts.shape != errors.shape:
        raise InputError(
            f"counts {counts.shape} and errors {errors.shape} do not belong together: "
            "give one error a count"
        )
    if len(np.unique(counts)) < 4:
        raise InputError("fewer than four different counts: give more")
    if not (np.isfinite(counts).all() and np.isfinite(errors).all() and (errors >= 0).all()):
        raise InputError("a count or an error is not finite, or an error negative: leave it out")
    return counts, errors


def _interval(samples: _Samples, grid: Floats, log_tau: float) -> tuple[float, float]:
    """Where the squared residuals exceed the least by what chance would give."""
    n_free = len(samples.counts) - (3 if samples.with_floor else 2)
    quantile = float(student.ppf(0.5 + CONFIDENCE / 2, n_free))
    allowed = samples.squares(log_tau) * (1.0 + quantile**2 / n_free)

    def excess(at: float) -> float:
        return samples.squares(at) - allowed

    ends = []
    for beyond, unbounded in (
        (grid[grid < log_tau][::-1], 0.0),
        (grid[grid > log_tau], np.inf),
    ):
        over = [at for at in beyond if excess(at) > 0.0]
        if not over:
            ends.append(unbounded)
        elif excess(log_tau) >= 0.0:  # an exact fit leaves no room
            ends.append(float(np.exp(log_tau)))
        else:
            ends.append(float(np.exp(brentq(excess, log_tau, over[0]))))
    return ends[0], ends[1]
