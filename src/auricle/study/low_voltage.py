"""Low-voltage area: how much of a surface lies below a threshold, and how sure that is."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, PerVertex, Truths

THRESHOLD_MV = 0.5
"""Bipolar voltage below which atrial wall is usually taken for scarred."""
QUANTILES = (0.05, 0.95)
"""Of the draws: the ends of the interval that is told."""


@dataclass(frozen=True)
class LowVoltage:
    """Area below a threshold within the part of the surface that was mapped, mm².

    Attributes
    ----------
    threshold_mv
        The threshold.
    mapped_mm2
        Area that was mapped.
    of_map_mm2
        Below the threshold on the most probable map, which is smoother than the truth.
    expected_mm2
        Expected, over maps that agree with the samples as well as the truth may.
    low_mm2, high_mm2
        `QUANTILES` of the same.
    vendor_mm2, vendor_mapped_mm2
        On the vendor's own map, and the area on which it has a value; NaN if there is none.
    share_of_points
        Share of the samples below the threshold.
    """

    threshold_mv: float
    mapped_mm2: float
    of_map_mm2: float
    expected_mm2: float
    low_mm2: float
    high_mm2: float
    vendor_mm2: float
    vendor_mapped_mm2: float
    share_of_points: float


@dataclass(frozen=True, eq=False)
class MappedRegion:
    """The part of a surface that is judged: truth and area of each vertex, shape (n,), mm²."""

    mapped: Truths
    areas: PerVertex

    def share(self, vertices: Truths) -> float:
        """Share of all the area that these vertices hold."""
        return float(self.areas[vertices].sum() / self.areas.sum())

    def below(self, values: Floats, threshold: float) -> Floats:
        """Area where `values`, shape (…, n), lie below the threshold, shape (…); NaN does not."""
        part = np.where(self.mapped, self.areas, 0.0)
        area: Floats = (values < threshold).astype(np.float64) @ part
        return area


def low_voltage(
    region: MappedRegion,
    voltage: PerVertex,
    draws: Floats,
    samples: Floats,
    *,
    vendor: PerVertex | None = None,
    threshold: float = THRESHOLD_MV,
) -> LowVoltage:
    """Area of low voltage within a region.

    Parameters
    ----------
    region
        What was mapped.
    voltage
        The most probable map, shape (n,), mV.
    draws
        Maps that agree with the samples, shape (c, n), mV.
    samples
        Values of the samples, mV.
    vendor
        The vendor's map, NaN where it has no value.
    threshold
        In mV.

    Examples
    --------
    >>> region = MappedRegion(np.array([True, True, False]), np.array([3.0, 1.0, 9.0]))
    >>> map_, sure = np.array([0.2, 0.9, 0.1]), np.array([[0.2, 0.9, 0.1], [0.6, 0.9, 0.1]])
    >>> found = low_voltage(region, map_, sure, np.array([0.2, 0.9]))
    >>> found.of_map_mm2, found.expected_mm2, found.mapped_mm2
    (3.0, 1.5, 4.0)
    """
    areas = region.below(draws, threshold)
    low, high = np.quantile(areas, QUANTILES)
    of_vendor = vendor_mapped = np.nan
    if vendor is not None:
        of_vendor = float(region.below(vendor, threshold))
        vendor_mapped = float(region.areas[region.mapped & np.isfinite(vendor)].sum())
    return LowVoltage(
        threshold_mv=threshold,
        mapped_mm2=float(region.areas[region.mapped].sum()),
        of_map_mm2=float(region.below(voltage, threshold)),
        expected_mm2=float(areas.mean()),
        low_mm2=float(low),
        high_mm2=float(high),
        vendor_mm2=of_vendor,
        vendor_mapped_mm2=vendor_mapped,
        share_of_points=float((samples < threshold).mean()),
    )
