"""A map as the page shows it: its coefficients, spectrum and the error of every truncation."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, Modes, PerMode, Truths
from auricle.spectral.harmonics import Harmonics
from auricle.study.signals import measured_nrmse


@dataclass(frozen=True, eq=False)
class ShownSignal:
    """One map on the real surface, or its geometry.

    Attributes
    ----------
    name, title, unit
        As the file has it, words for people, unit of its values.
    modes
        Harmonics on the vertices of the real surface, shape (n, k), 1/mm.
    coefficients
        Shape (k, c), the unit times mm, of the map less its `offset`.
    offset
        Shape (c,): what is added to every reconstruction.
    power
        Of each harmonic but the constant ones, shape (k,), the unit squared times mm².
    share
        Of the power in the first 1 … k harmonics, shape (k,), 0 to 1.
    error
        Root mean square of map minus reconstruction over the area that holds values, shape (k,).
    spread
        Standard deviation of the map over that area, to which errors are put in relation.
    """

    name: str
    title: str
    unit: str
    modes: Modes
    coefficients: Floats
    offset: Floats
    power: PerMode
    share: PerMode
    error: PerMode
    spread: float

    @property
    def n_modes(self) -> int:
        """Number of harmonics."""
        return len(self.coefficients)

    def rebuilt(self, count: int) -> Floats:
        """The map of the first `count` harmonics, shape (n, c)."""
        values: Floats = self.modes[:, :count] @ self.coefficients[:count] + self.offset
        return values


def shown_signal(
    basis: Harmonics,
    on_shell: Floats,
    known: Truths,
    *,
    name: str,
    unit: str,
    n_vertices: int,
) -> ShownSignal:
    """A map's coefficients, spectrum and errors.

    Parameters
    ----------
    basis
        Harmonics of the closed surface.
    on_shell
        The map on all of its vertices, shape (n,) or (n, c).
    known
        On which of them it was measured.
    name, unit
        Of the map.
    n_vertices
        How many of the leading vertices are the real surface's.

    Raises
    ------
    InputError
        If the map is constant.

    Examples
    --------
    All harmonics rebuild a map without error:

    >>> from auricle.spectral.harmonics import manifold_harmonics
    >>> from auricle.surface.shapes import icosphere
    >>> ball = icosphere(radius=10.0, subdivisions=2)
    >>> basis = manifold_harmonics(ball, 100)
    >>> height, everywhere = ball.vertices[:, 2], np.ones(ball.n_vertices, bool)
    >>> signal = shown_signal(basis, height, everywhere, name="z", unit="mm", n_vertices=162)
    >>> bool(signal.error[80] < 1e-3 * signal.spread)
    True
    """
    columns = on_shell.reshape(len(on_shell), -1)
    weights = np.where(known, basis.areas, 0.0)
    weights = weights / weights.sum()
    offset: Floats = weights @ columns
    varying = columns - offset
    spread = float(np.sqrt((weights[:, None] * varying**2).sum()))
    spectrum = basis.power_spectrum(varying)
    constant = np.arange(basis.n_modes) < spectrum.n_constant
    return ShownSignal(
        name=name,
        title=" ".join(name.replace("_", " ").split()),
        unit=unit,
        modes=basis.modes[:n_vertices],
        coefficients=basis.transform(varying),
        offset=offset,
        power=np.where(constant, 0.0, spectrum.power),
        share=spectrum.cumulative(),
        error=spread * measured_nrmse(basis, varying, known),
        spread=spread,
    )
