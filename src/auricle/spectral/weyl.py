"""Weyl's law: what the index of a harmonic means in millimetres."""

import math

from auricle.errors import InputError

TRUSTED_SHARE = 1 / 12
"""Harmonics up to this share of the vertices have eigenvalues right to about 7 %.

The discretisation lowers the k-th eigenvalue by about 0.8·k/n of itself (linear elements, lumped
areas), so wavelengths are claimed up to n/12 only.
"""


def weyl_eigenvalue(n_modes: int, *, area: float) -> float:
    """Asymptotic eigenvalue 4πk/A of the k-th harmonic on a surface of `area` mm², in 1/mm²."""
    _require_positive(n_modes, area)
    return 4 * math.pi * n_modes / area


def weyl_wavelength(n_modes: int, *, area: float) -> float:
    """Wavelength √(πA/k) of the k-th harmonic, mm: 2π over the root of its Weyl eigenvalue.

    Examples
    --------
    Four times as many harmonics resolve half the wavelength:

    >>> weyl_wavelength(100, area=12_500.0) / weyl_wavelength(400, area=12_500.0)
    2.0
    """
    return 2 * math.pi / math.sqrt(weyl_eigenvalue(n_modes, area=area))


def nyquist_spacing(n_modes: int, *, area: float) -> float:
    """Half the wavelength of the k-th harmonic, mm: the widest spacing that still resolves it."""
    return weyl_wavelength(n_modes, area=area) / 2


def trusted_modes(n_vertices: int) -> int:
    """How many harmonics of a mesh have a wavelength worth stating: n/12."""
    return int(n_vertices * TRUSTED_SHARE)


def _require_positive(n_modes: int, area: float) -> None:
    if n_modes < 1 or not area > 0:
        raise InputError(f"{n_modes} harmonics on {area} mm²: both must be positive")
