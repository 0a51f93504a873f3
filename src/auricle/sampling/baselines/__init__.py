"""Baselines: how mapping systems colour a surface between samples, behind one signature."""

from collections.abc import Mapping
from types import MappingProxyType

from auricle.sampling.baselines.harmonic import harmonic
from auricle.sampling.baselines.interpolation import Interpolator
from auricle.sampling.baselines.inverse_distance import inverse_distance
from auricle.sampling.baselines.nearest import nearest
from auricle.sampling.baselines.radial import linear_radial, thin_plate

BASELINES: Mapping[str, Interpolator] = MappingProxyType(
    {
        "nearest": nearest,
        "inverse_distance": inverse_distance,
        "harmonic": harmonic,
        "linear_radial": linear_radial,
        "thin_plate": thin_plate,
    }
)
"""Every baseline by its name."""

__all__ = ["BASELINES", "Interpolator"]
