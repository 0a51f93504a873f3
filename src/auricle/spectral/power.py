"""The power spectrum of a map: how its energy is spread over the harmonics."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import PerMode, read_only
from auricle.errors import BandError, InputError

# A share reached up to rounding counts as reached: 0.6 + 0.3 is less than 0.9 in floating point.
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Power by harmonic, against the total that Parseval's identity gives without them.

    Parameters
    ----------
    eigenvalues
        Shape (k,), 1/mm², ascending.
    power
        Squared coefficients, shape (k,), in the map's unit squared times mm²; summed over the
        columns of a vector map.
    varying_total
        Area integral of the squared map without its mean, the same unit: what the power of *all*
        harmonics but the constant ones (AC), solved for or not, adds up to. A truncated basis can
        therefore not overstate a share. Kept apart from the constant's power, beside which it can
        be lost to rounding.
    n_constant
        How many leading harmonics are constant on each piece of the surface: 1 on a single piece.

    Raises
    ------
    InputError
        If the map does not vary: a constant has no bandwidth.
    """

    eigenvalues: PerMode
    power: PerMode
    varying_total: float
    n_constant: int = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "eigenvalues", read_only(self.eigenvalues, np.float64))
        object.__setattr__(self, "power", read_only(self.power, np.float64))
        if self.power.shape != self.eigenvalues.shape or self.power.ndim != 1:
            raise InputError("power and eigenvalues must be one number a harmonic each")
        if not self.varying_total > 1e-24 * self.total:
            raise InputError("the map is constant: it has no spectrum; choose one that varies")

    @property
    def constant_power(self) -> float:
        """Power of the constant harmonics (DC)."""
        return float(self.power[: self.n_constant].sum())

    @property
    def total(self) -> float:
        """Area integral of the squared map: the constant harmonics' power and all the rest."""
        return self.constant_power + self.varying_total

    def cumulative(self, *, with_constant: bool = False) -> PerMode:
        """Share of the total power in the first 1, 2, …, k harmonics, shape (k,), in [0, 1].

        Without the constant harmonics (the default) the share does not depend on where the
        scanner's origin lies or on an offset of the map.
        """
        if with_constant:
            shares: PerMode = np.cumsum(self.power) / self.total
        else:
            varying = np.where(np.arange(len(self.power)) < self.n_constant, 0.0, self.power)
            shares = np.cumsum(varying) / self.varying_total
        return np.minimum(shares, 1.0)

    def modes_for_power(self, share: float, *, with_constant: bool = False) -> int:
        """Least number of leading harmonics that hold `share` of the power.

        The constant harmonic is always counted among them, since a reconstruction needs it, but
        its power enters only `with_constant`. The paper reads this count, at 0.85 and 0.90, as
        the least number of samples (Table 1).

        Raises
        ------
        BandError
            If the harmonics at hand hold less than that.

        Examples
        --------
        >>> spectrum = Spectrum([0.0, 1.0, 2.0], [90.0, 9.0, 1.0], varying_total=10.0)
        >>> spectrum.modes_for_power(0.90), spectrum.modes_for_power(0.90, with_constant=True)
        (2, 1)
        """
        if not 0 < share <= 1:
            raise InputError(f"a share of power lies in (0, 1], not {share}")
        cumulative = self.cumulative(with_constant=with_constant)
        reached = cumulative >= share * (1 - _ROUNDING)
        if not reached.any():
            raise BandError(
                f"{len(reached)} harmonics hold {cumulative[-1]:.1%} of the power and "
                f"{share:.1%} is asked for: solve for more harmonics"
            )
        return int(reached.argmax()) + 1
