"""The vendor's own interpolation beside the reconstruction, on the surface and at the points."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, PerVertex, Truths
from auricle.sampling.cycle import circular_difference
from auricle.sampling.sites import Sites


@dataclass(frozen=True)
class VendorComparison:
    """How far the vendor's map and the reconstruction are apart.

    Attributes
    ----------
    coloured_share
        Share of the real surface's area on which the vendor's map has a value.
    rms_difference
        Root mean square of vendor − reconstruction where both are: mapped and coloured, in the
        values' unit.
    relative
        The same over the standard deviation of the vendor's map there.
    beyond_share
        Share of that area where they differ by more than two standard deviations of the
        reconstruction: about 0.05 if the vendor's map were as good as the truth.
    vendor_at_points, map_at_points
        Root mean square of vendor − sample and of reconstruction − sample at the samples: how
        closely each follows what was measured, noise included. NaN if the vendor's map has no
        value there.
    """

    coloured_share: float
    rms_difference: float
    relative: float
    beyond_share: float
    vendor_at_points: float
    map_at_points: float


@dataclass(frozen=True, eq=False)
class MapOnSurface:
    """A reconstruction as it is compared: mean and deviation at each vertex, shape (n,)."""

    mean: PerVertex
    std: PerVertex
    cycle_length: float | None = None

    def off(self, values: Floats, others: Floats) -> Floats:
        """`values` − `others`, the short way round a cycle if there is one."""
        if self.cycle_length is None:
            return values - others
        return circular_difference(values, others, self.cycle_length)


def vendor_comparison(
    ours: MapOnSurface,
    vendor: PerVertex,
    areas: PerVertex,
    mapped: Truths,
    sites: Sites,
    samples: Floats,
) -> VendorComparison | None:
    """Hold the vendor's map against the reconstruction; None if they share no place.

    Parameters
    ----------
    ours
        The reconstruction.
    vendor
        The vendor's values, shape (n,), NaN where there are none.
    areas
        Of the vertices, 0 where not real surface, shape (n,), mm².
    mapped
        Vertices near enough to a sample to be judged, shape (n,).
    sites, samples
        Where the samples lie, within these n vertices, and their values.
    """
    coloured = np.isfinite(vendor)
    both = coloured & mapped & (areas > 0)
    if not both.any():
        return None
    weights = areas[both] / areas[both].sum()
    off = ours.off(vendor[both], ours.mean[both])
    rms = float(np.sqrt(weights @ off**2))
    mean = float(weights @ vendor[both])
    spread = float(np.sqrt(weights @ (vendor[both] - mean) ** 2))
    at_samples = [_rms(ours.off(sites.of(values), samples)) for values in (vendor, ours.mean)]
    return VendorComparison(
        coloured_share=float(areas[coloured].sum() / areas.sum()),
        rms_difference=rms,
        relative=rms / spread if spread > 0 else np.nan,
        beyond_share=float(weights @ (np.abs(off) > 2 * ours.std[both])),
        vendor_at_points=at_samples[0],
        map_at_points=at_samples[1],
    )


def _rms(values: Floats) -> float:
    """Root mean square of those that are known; NaN if none is."""
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else float("nan")
