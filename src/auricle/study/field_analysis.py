"""One quantity of one map: what of it was mapped, what was redundant, areas and velocities."""

import math
from dataclasses import dataclass, replace

import numpy as np

from auricle.arrays import Floats, Integers, PerVertex, Truths
from auricle.sampling.cycle import wrapped
from auricle.sampling.gaussian_process import GaussianProcess
from auricle.sampling.literature import FILL_DISTANCES_MM
from auricle.sampling.reconstruction import Hyperparameters, Reconstruction
from auricle.sampling.voronoi import voronoi
from auricle.study.conduction_velocity import ConductionVelocity, conduction_velocity
from auricle.study.low_voltage import LowVoltage, MappedRegion, low_voltage
from auricle.study.map_study import FieldAnalysis, MapStudyConfig
from auricle.study.mapping_result import MappingResult
from auricle.study.redundancy import redundancy
from auricle.study.vendor_comparison import MapOnSurface, VendorComparison, vendor_comparison


@dataclass(frozen=True, eq=False)
class _Rebuilt:
    """A reconstruction with what is derived from it more than once; arrays of the surface."""

    result: MappingResult
    found: Reconstruction
    config: MapStudyConfig
    region: MappedRegion
    vendor: PerVertex | None

    @property
    def n(self) -> int:
        return self.result.prepared.surface.n_vertices

    @property
    def cycle_length(self) -> float | None:
        return self.result.config.cycle_length_ms

    @property
    def mapped_areas(self) -> PerVertex:
        """Areas of the chamber's vertices that were mapped, 0 elsewhere."""
        areas = np.zeros(self.found.chamber.mesh.n_vertices)
        areas[: self.n] = np.where(self.region.mapped, self.region.areas, 0.0)
        return areas

    def draws(self) -> Floats:
        """Maps that agree with the samples as well as the truth may, shape (c, n)."""
        rng = np.random.default_rng(self.config.seed)
        found, cycle = self.found, self.cycle_length
        if cycle is None:
            return found.draw(rng, self.config.n_draws)[:, : self.n]
        modes = found.chamber.basis.modes[: self.n, : len(found.coefficient_mean)]
        cosine, sine = (
            (modes @ (mean[:, None] + found.posterior.draw(rng, self.config.n_draws))).T
            for mean in found.coefficient_mean.T
        )
        return wrapped(np.arctan2(sine, cosine) * cycle / (2 * np.pi), cycle)


def analyzed_field(
    result: MappingResult,
    config: MapStudyConfig,
    identifiers: Integers,
    *,
    vendor: PerVertex | None = None,
) -> FieldAnalysis:
    """What a reconstruction says of the map it is of, and of the vendor's.

    Where the points say too little of the map nothing is derived from it.

    Parameters
    ----------
    result
        The reconstruction.
    config
        The parameters.
    identifiers
        Number of the mapping point of each sample placed.
    vendor
        The vendor's own map on the surface, NaN where it has no value, shape (n,).
    """
    chamber = result.prepared.chamber
    n = result.prepared.surface.n_vertices
    distances = voronoi(chamber, result.placed.sites).distances[:n]
    mapped: Truths = (distances <= config.mapped_within_mm) & chamber.accessible[:n]
    region = MappedRegion(mapped, chamber.accessible_areas[:n])
    blank = FieldAnalysis(
        rebuilt=result,
        identifiers=identifiers,
        mapped=mapped,
        mapped_share=region.share(mapped),
        undersampled_share=region.share(mapped & result.undersampled) / region.share(mapped)
        if mapped.any()
        else 0.0,
        fill_shares={
            words: region.share(distances <= radius) for words, radius in FILL_DISTANCES_MM.items()
        },
        redundancy=None,
        vendor_values=vendor,
        vendor=None,
        low_voltage=None,
        velocity=None,
    )
    if result.hyperparameters is None or not mapped.any():
        return blank
    case = _Rebuilt(result, _reconstruction(result, result.hyperparameters), config, region, vendor)
    return replace(
        blank,
        redundancy=redundancy(case.found, case.mapped_areas, detail=_detail(result)),
        vendor=_compared(case),
        low_voltage=_low_voltage(case),
        velocity=_velocity(case),
    )


def _reconstruction(result: MappingResult, hyper: Hyperparameters) -> Reconstruction:
    """The reconstruction behind a result, under the hyper-parameters found."""
    placed, cycle = result.placed, result.config.cycle_length_ms
    process = GaussianProcess(result.prepared.chamber, placed.sites, noise_shape=placed.noise_shape)
    values = placed.values
    if cycle is not None:
        angle = 2 * np.pi * values / cycle
        values = np.column_stack([np.cos(angle), np.sin(angle)])
    return process.given(values, hyper)


def _detail(result: MappingResult) -> float:
    """Deviation of detail too fine for the points, in the unit of the reconstruction."""
    stated, cycle = result.noise_stated or 0.0, result.config.cycle_length_ms
    unit = 1.0 if cycle is None else cycle * math.sqrt(2) / (2 * math.pi)
    return math.sqrt(max(result.noise_fitted**2 - stated**2, 0.0)) / unit


def _compared(case: _Rebuilt) -> VendorComparison | None:
    if case.vendor is None:
        return None
    chamber = case.found.chamber
    beyond = np.full(chamber.mesh.n_vertices - case.n, np.nan)
    ours = MapOnSurface(
        np.concatenate([case.result.mean, beyond]),
        np.concatenate([case.result.std, beyond]),
        case.cycle_length,
    )
    return vendor_comparison(
        ours,
        np.concatenate([case.vendor, beyond]),
        chamber.accessible_areas,
        np.concatenate([case.region.mapped, np.zeros(len(beyond), dtype=bool)]),
        case.result.placed.sites,
        case.result.placed.values,
    )


def _low_voltage(case: _Rebuilt) -> LowVoltage | None:
    if case.result.placed.name != "bipolar_voltage":
        return None
    return low_voltage(
        case.region,
        case.result.mean,
        case.draws(),
        case.result.placed.values,
        vendor=case.vendor,
        threshold=case.config.low_voltage_mv,
    )


def _velocity(case: _Rebuilt) -> ConductionVelocity | None:
    if case.result.placed.name != "local_activation_time":
        return None
    return conduction_velocity(
        case.result.prepared.surface,
        case.result.mean,
        case.draws(),
        mapped=case.region.mapped,
        vendor=case.vendor,
        cycle_length=case.cycle_length,
    )
