"""Palettes: how the values of a map become colours, in bands, with limits one can read."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import matplotlib as mpl
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.ticker import MaxNLocator

from auricle.arrays import Floats
from auricle.errors import InputError
from auricle.report.labels import unit_of, with_unit
from auricle.surface.field import FieldMap

UNKNOWN = (150, 150, 150)
"""Grey of places without a value."""

STYLES = ("perceptual", "EP classic", "cyclic")
"""Ways to colour a measured map: equal steps look equal; as mapping systems do (red low or early,
purple high or late); or closed in itself, for activation times of a re-entry."""

_STRETCHES: Mapping[str, tuple[str, float, float]] = MappingProxyType(
    {
        "perceptual": ("viridis", 0.0, 1.0),
        "EP classic": ("hsv", 0.0, 0.78),
        "cyclic": ("twilight", 0.0, 1.0),
        "distance": ("YlOrRd", 0.0, 0.95),
    }
)
"""A named colour map of matplotlib's and the part of it in use."""


@dataclass(frozen=True)
class ColourScale:
    """Colours in bands.

    Attributes
    ----------
    palette
        One of `STYLES`, or ``distance``.
    boundaries
        Where one band ends and the next begins, ascending, one more than there are bands. Values
        beyond the first or last take the colour of the band next to them.
    label
        What is coloured, with its unit.
    """

    palette: str
    boundaries: tuple[float, ...]
    label: str

    def __post_init__(self) -> None:
        if self.palette not in _STRETCHES:
            raise InputError(f"no palette {self.palette!r}: choose from {', '.join(_STRETCHES)}")
        if len(self.boundaries) < 2 or min(np.diff(self.boundaries)) <= 0:
            raise InputError("a colour scale has ascending boundaries: give at least two")

    @property
    def bands(self) -> Floats:
        """Colour of each band, shape (b, 3), 0 to 255."""
        name, first, last = _STRETCHES[self.palette]
        places = np.linspace(first, last, 2 * (len(self.boundaries) - 1) + 1)[1::2]
        colours: Floats = np.rint(255 * mpl.colormaps[name](places)[:, :3])
        return colours

    @property
    def colormap(self) -> ListedColormap:
        """The bands as matplotlib has them, for a colour bar."""
        return ListedColormap(self.bands / 255)

    @property
    def norm(self) -> BoundaryNorm:
        """The boundaries as matplotlib has them, for a colour bar."""
        return BoundaryNorm(self.boundaries, len(self.boundaries) - 1)

    def colours_of(self, values: Floats) -> Floats:
        """Colour of each value, shape (n, 3), 0 to 255.

        Examples
        --------
        >>> scale = ColourScale("perceptual", (0.0, 1.0, 2.0), "voltage (mV)")
        >>> bool((scale.colours_of(np.array([0.2, 0.9]))[0] == scale.bands[0]).all())
        True
        >>> scale.colours_of(np.array([np.nan]))[0].tolist()
        [150.0, 150.0, 150.0]
        """
        band = np.searchsorted(self.boundaries[1:-1], values, side="right")
        known = np.isfinite(values)
        colours: Floats = np.where(known[:, None], self.bands[band], UNKNOWN).astype(np.float64)
        return colours


def round_boundaries(values: Floats, *, n_bands: int = 10, share: float = 0.98) -> Floats:
    """Round numbers that part the middle `share` of the values into at most `n_bands` bands.

    Examples
    --------
    >>> round_boundaries(np.linspace(0.0, 2.0, 1001), n_bands=4, share=1.0).tolist()
    [0.0, 0.5, 1.0, 1.5, 2.0]
    """
    known = values[np.isfinite(values)]
    if not len(known):
        raise InputError("a map without values has no colour scale: leave it out")
    low, high = np.quantile(known, [(1 - share) / 2, (1 + share) / 2])
    if low == high:
        low, high = known.min(), known.max()
    locator = MaxNLocator(nbins=n_bands, steps=[1, 2, 2.5, 5, 10])
    ticks: Floats = np.asarray(locator.tick_values(float(low), float(high)))
    return ticks


def scale_for_field(field: FieldMap, title: str, *, style: str = "perceptual") -> ColourScale:
    """Colour scale of a map, from the values that are known.

    Parameters
    ----------
    field
        The map, one value a vertex.
    title
        Words for the colour bar.
    style
        One of `STYLES`; ``cyclic`` is for activation times only, other maps stay perceptual.
    """
    if style not in STYLES:
        raise InputError(f"no style of colours {style!r}: choose from {', '.join(STYLES)}")
    unit = unit_of(field)
    is_time = unit.startswith("ms")
    palette = "perceptual" if style == "cyclic" and not is_time else style
    boundaries = tuple(float(tick) for tick in round_boundaries(field.values))
    return ColourScale(palette, boundaries, with_unit(title, unit))
