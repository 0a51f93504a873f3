"""The Voronoi partition: which site each part of a surface is nearest to, along the surface."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, Integers, PerVertex
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites
from auricle.surface.fast_marching import VoronoiCells
from auricle.surface.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Voronoi:
    """Nearest sites by geodesic distance.

    Attributes
    ----------
    distances
        From each vertex to the nearest site, shape (n,), mm; infinite on a piece without sites.
    owners
        Index of that site, shape (n,); of sites equally near the first; -1 on a piece without.
    shares
        Share of the accessible area that is nearest to each site, shape (m,), of sum 1. Sites at
        one place divide theirs equally. Vertices' areas are given out whole, so that a site
        between other sites' vertices can have none.
    """

    distances: PerVertex
    owners: Integers
    shares: Floats


def voronoi(chamber: Chamber, sites: Sites) -> Voronoi:
    """Partition a chamber among sites.

    Raises
    ------
    InputError
        If there is no site, or none on a piece of the surface that has accessible area.
    """
    if not len(sites):
        raise InputError("no site to divide the surface among: give at least one")
    cells = VoronoiCells(chamber.marching)
    add_sites(cells, chamber.mesh, sites)
    if not np.isfinite(cells.distances[chamber.accessible]).all():
        raise InputError("a piece of the surface has no site: sample every piece or leave it out")
    reached = cells.owners >= 0
    areas = np.bincount(
        cells.owners[reached], chamber.accessible_areas[reached], minlength=len(sites)
    )
    _, place, n_there = np.unique(
        sites.positions(chamber.mesh), axis=0, return_inverse=True, return_counts=True
    )
    area_of_place = np.bincount(place.reshape(-1), areas)
    shares = (area_of_place / n_there)[place.reshape(-1)] / areas.sum()
    return Voronoi(cells.distances, cells.owners, shares)


def add_sites(cells: VoronoiCells, mesh: Mesh, sites: Sites) -> None:
    """Add sites to a partition one by one, each by the straight way to its corners."""
    away = mesh.vertices[sites.corners] - sites.positions(mesh)[:, None]
    offsets = np.linalg.norm(away, axis=2)
    counted = sites.weights > 0
    for corners, distances, used in zip(sites.corners, offsets, counted, strict=True):
        cells.add(corners[used], distances[used])
