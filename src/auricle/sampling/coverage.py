"""Coverage: how much of the surface lies near a sample, and how far the farthest part is."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites
from auricle.sampling.voronoi import Voronoi, voronoi

RADII_MM = (5.0, 7.0, 10.0, 15.0)
"""Distances at which coverage is read: fill thresholds of mapping systems."""


@dataclass(frozen=True, eq=False)
class Coverage:
    """How sites cover the accessible surface, by distance along it.

    Attributes
    ----------
    radius_mm
        Covering radius: the greatest distance of any accessible vertex from its nearest site. A
        focus that is smaller can lie between the samples unseen. Between vertices it can be
        larger, by up to 0.6 edges.
    within
        Share of the accessible area within each of `RADII_MM` of a site.
    shares
        Share of the accessible area nearest to each site, shape (m,).
    spacing_mm
        Median over the sites of the distance to the nearest other site, infinite for one site.
    density_per_cm2
        Sites per cm² of accessible area.
    """

    radius_mm: float
    within: dict[float, float]
    shares: Floats
    spacing_mm: float
    density_per_cm2: float


def coverage(chamber: Chamber, sites: Sites) -> Coverage:
    """Coverage of a chamber by sites.

    Raises
    ------
    InputError
        If there is no site, or none on a piece of the surface.

    Examples
    --------
    From one point of a ball the opposite one is half-way round, 10π mm away:

    >>> from auricle.sampling.chamber import chamber
    >>> from auricle.surface.shapes import icosphere
    >>> ball = chamber(icosphere(radius=10.0, subdivisions=3), 4)
    >>> bool(abs(coverage(ball, Sites.at_vertices([0])).radius_mm / (10 * np.pi) - 1) < 0.03)
    True
    """
    return covered(chamber, sites, voronoi(chamber, sites))


def covered(chamber: Chamber, sites: Sites, partition: Voronoi) -> Coverage:
    """As `coverage`, with the sites' Voronoi partition at hand."""
    distances = partition.distances[chamber.accessible]
    areas = chamber.accessible_areas[chamber.accessible]
    total = float(areas.sum())
    return Coverage(
        radius_mm=float(distances.max()),
        within={radius: float(areas[distances <= radius].sum()) / total for radius in RADII_MM},
        shares=partition.shares,
        spacing_mm=float(np.median(neighbour_distances(chamber, sites, partition))),
        density_per_cm2=100 * len(sites) / total,
    )


def neighbour_distances(chamber: Chamber, sites: Sites, partition: Voronoi) -> Floats:
    """Distance along the surface from each site to the nearest other one, shape (m,), mm.

    The nearest other site is no farther than twice the radius of the site's own Voronoi cell, so
    no more of the surface is searched. Sites that share a vertex are a straight line apart.
    Infinite for a single site.
    """
    positions = sites.positions(chamber.mesh)
    offsets = np.linalg.norm(chamber.mesh.vertices[sites.corners] - positions[:, None], axis=2)
    reaches = _search_radii(chamber, sites, partition)
    nearest = np.full(len(sites), np.inf)
    for i, (corners, away) in enumerate(zip(sites.corners, offsets, strict=True)):
        used = sites.weights[i] > 0
        field = chamber.marching.from_source(corners[used], away[used], reach=reaches[i])
        along = (sites.weights * np.where(sites.weights > 0, field[sites.corners], 0.0)).sum(axis=1)
        touching = np.isin(sites.corners, corners[used]) & (sites.weights > 0)
        straight = np.linalg.norm(positions - positions[i], axis=1)
        along = np.where(touching.any(axis=1), straight, along)
        along[i] = np.inf
        nearest[i] = along.min()
    return nearest


def _search_radii(chamber: Chamber, sites: Sites, partition: Voronoi) -> Floats:
    """Twice the radius of each site's cell, and some edges more, shape (m,), mm."""
    radii = np.zeros(len(sites))
    reached = partition.owners >= 0
    np.maximum.at(radii, partition.owners[reached], partition.distances[reached])
    corners = chamber.mesh.vertices[chamber.mesh.faces]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
    reaches: Floats = 2 * radii + 3 * longest
    return reaches
