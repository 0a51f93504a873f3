"""Features: simulated focal maps in a fourth component, and how many harmonics they need."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from auricle.arrays import Floats, Points
from auricle.errors import BandError
from auricle.simulation.foci import gaussian_modes_for_power
from auricle.spectral.harmonics import Harmonics
from auricle.spectral.power import Spectrum
from auricle.study.paper.foci import REACH_IN_WIDTHS, Foci, draw_places
from auricle.study.paper.parameters import PaperParameters
from auricle.surface.capping import CappedSurface
from auricle.surface.fast_marching import FastMarching
from auricle.surface.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Stage:
    """What the maps of a case are analysed on.

    Attributes
    ----------
    surface
        The real surface, simplified, with its holes.
    capped
        The same closed; the real vertices come first.
    basis
        Harmonics of the closed surface.
    """

    surface: Mesh
    capped: CappedSurface
    basis: Harmonics


def places_of(surface: Mesh, parameters: PaperParameters) -> list[Points]:
    """Places of the foci of every placement, each shape (most foci, 3), mm.

    They are drawn by position on the real surface: renumbering its vertices moves none. Fewer
    foci are the first ones of more.
    """
    most = max(parameters.focus_counts, default=1)
    return [
        draw_places(surface, most, rng=np.random.default_rng([parameters.seed, placement]))
        for placement in range(parameters.placements)
    ]


def marched_foci(stage: Stage, places: Sequence[Points], *, widest_mm: float) -> list[Foci]:
    """Foci at the real vertices nearest to the places, by fast marching over the closed surface.

    Fast marching is within 0.4 % of exact distances and a hundredth of their cost.
    """
    marching = FastMarching(stage.capped.mesh)
    tree = cKDTree(stage.surface.vertices)
    reach = REACH_IN_WIDTHS * widest_mm
    return [
        Foci(
            np.stack(
                [
                    marching.from_source([centre], reach=reach)
                    for centre in np.asarray(tree.query(placed)[1]).tolist()
                ]
            )
        )
        for placed in places
    ]


def counts_by_share(
    basis: Harmonics, maps: Floats, shares: Sequence[float]
) -> dict[str, list[int | None]]:
    """Number of harmonics that hold each share of each map's power, the constant one counted.

    Parameters
    ----------
    basis
        Of the closed surface.
    maps
        One a column, shape (n, m).
    shares
        Of the power without the constant's.

    Returns
    -------
    dict
        Share as text → one count a map, None where the harmonics hold less.
    """
    return {
        f"{share:g}": [modes_holding(spectrum, share) for spectrum in spectra(basis, maps)]
        for share in shares
    }


def spectra(basis: Harmonics, maps: Floats) -> list[Spectrum]:
    """Spectrum of each map, one a column of shape (n, m): as `power_spectrum`, in one product."""
    weights = basis.areas / basis.area
    varying = maps - weights @ maps
    power = basis.transform(varying) ** 2
    power[0] = basis.area * (weights @ maps) ** 2
    totals = basis.areas @ varying**2
    return [
        Spectrum(basis.eigenvalues, column, float(total))
        for column, total in zip(power.T, totals, strict=True)
    ]


def feature_records(
    stage: Stage, foci: Sequence[Foci], parameters: PaperParameters
) -> list[dict[str, Any]]:
    """Table 1 and Figure 5 of one case: a record for every width and number of foci.

    Returns
    -------
    list of dict
        ``size``, ``sigma_mm``, ``n_foci``; ``counts`` by share, one a placement;
        ``closed_form`` by share, without the constant; ``nrmse``, the mean measured error on the
        real surface of the pictured numbers of harmonics; ``share_by_harmonic``, the mean share
        of the power over placements, the constant's being 0.
    """
    records = []
    for size, width in zip(parameters.sizes, parameters.focus_widths_mm, strict=True):
        for n_foci in parameters.focus_counts:
            maps = np.column_stack([each.map_of(n_foci, width) for each in foci])
            found = spectra(stage.basis, maps)
            shares = np.mean([each.power / each.varying_total for each in found], axis=0)
            shares[0] = 0.0
            records.append(
                {
                    "size": size,
                    "sigma_mm": width,
                    "n_foci": n_foci,
                    "counts": {
                        f"{share:g}": [modes_holding(each, share) for each in found]
                        for share in parameters.shares
                    },
                    "closed_form": {
                        f"{share:g}": gaussian_modes_for_power(
                            area=stage.basis.area, width=width, share=share
                        )
                        for share in parameters.shares
                    },
                    "nrmse": {
                        f"{count}": float(relative_errors(stage, maps, rebuilt).mean())
                        for count, rebuilt in rebuilt_maps(
                            stage.basis, maps, parameters.pictured_counts
                        ).items()
                    },
                    "share_by_harmonic": significant(shares),
                }
            )
    return records


def rebuilt_maps(basis: Harmonics, maps: Floats, counts: Sequence[int]) -> dict[int, Floats]:
    """Maps rebuilt from the first harmonics, by their number, each shape (n, m)."""
    coefficients = basis.transform(maps)
    return {
        count: basis.inverse(coefficients[:count]) for count in counts if count <= basis.n_modes
    }


def significant(values: Floats, digits: int = 5) -> list[float]:
    """Numbers to so many significant digits: short in JSON, exact enough for a figure."""
    return [float(f"{value:.{digits}g}") for value in values]


def relative_errors(stage: Stage, maps: Floats, recovered: Floats) -> Floats:
    """Root mean square error of recovered maps on the real surface over their deviation there.

    Parameters
    ----------
    stage
        The surface.
    maps, recovered
        One map a column, shape (n, m); n vertices of the real surface at least, those first.

    Returns
    -------
    One number a map, shape (m,), without unit: 1 for a map recovered as its mean.
    """
    n = stage.surface.n_vertices
    areas = stage.basis.areas[:n]
    weights = areas / areas.sum()
    real = maps[:n]
    variances = weights @ (real - weights @ real) ** 2
    errors: Floats = np.sqrt(weights @ (recovered[:n] - real) ** 2 / variances)
    return errors


def modes_holding(spectrum: Spectrum, share: float) -> int | None:
    """Number of leading harmonics that hold a share of the power; None if those at hand do not."""
    try:
        return spectrum.modes_for_power(share)
    except BandError:
        return None
