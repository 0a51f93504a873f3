"""Farthest-point sampling: every new point where the surface is farthest from those before."""

import numpy as np

from auricle.arrays import Integers, Truths
from auricle.errors import InputError
from auricle.sampling.candidates import candidates
from auricle.sampling.chamber import Chamber
from auricle.sampling.sites import Sites
from auricle.sampling.voronoi import add_sites
from auricle.surface.fast_marching import VoronoiCells


def farthest_point_sampling(
    chamber: Chamber,
    count: int,
    *,
    allowed: Truths | None = None,
    existing: Sites | None = None,
    start: int | None = None,
) -> Integers:
    """Vertices chosen greedily by geodesic distance from all before: evenly spread, nested.

    Distances run along the whole closed surface, caps included. The first points of a longer
    design are a shorter one. On 10,000 vertices 800 points take 0.25 s.

    Parameters
    ----------
    chamber
        Where to sample.
    count
        How many points to add.
    allowed
        Which vertices may be chosen, shape (n,); only accessible ones ever are.
    existing
        Points taken already, which the new ones keep away from.
    start
        The first vertex. By default, without existing points: the allowed vertex that is
        farthest, in a straight line, from the centroid of the accessible surface.

    Returns
    -------
    Integers
        Vertex indices in the order chosen, shape (count,).

    Raises
    ------
    InputError
        If fewer than `count` vertices are allowed, or `start` is not one of them.

    References
    ----------
    Eldar, Lindenbaum, Porat and Zeevi 1997, "The farthest point strategy for progressive image
    sampling".

    Examples
    --------
    The second of two points on a ball lies opposite the first:

    >>> from auricle.sampling.chamber import chamber
    >>> from auricle.surface.shapes import icosphere
    >>> ball = chamber(icosphere(radius=10.0, subdivisions=2), 4)
    >>> first, second = ball.mesh.vertices[farthest_point_sampling(ball, 2)]
    >>> bool(np.allclose(first, -second))
    True
    """
    choice = candidates(chamber, count, allowed=allowed, existing=existing)
    cells = VoronoiCells(chamber.marching)
    if existing is not None:
        add_sites(cells, chamber.mesh, existing)
    chosen: list[int] = []
    if start is not None or not cells.n_sources:
        chosen.append(_start(chamber, choice, start))
        cells.add(chosen)
    while len(chosen) < count:
        choice[chosen[-1:]] = False
        chosen.append(int(np.where(choice, cells.distances, -1.0).argmax()))
        cells.add(chosen[-1:])
    return np.array(chosen, dtype=np.int64)


def _start(chamber: Chamber, choice: Truths, start: int | None) -> int:
    if start is None:
        vertices, areas = chamber.mesh.vertices, chamber.accessible_areas
        centroid = areas @ vertices / areas.sum()
        away = np.linalg.norm(vertices - centroid, axis=1)
        return int(np.where(choice, away, -1.0).argmax())
    if not 0 <= start < len(choice) or not choice[start]:
        raise InputError(f"vertex {start} to start from is not allowed: name one that is")
    return start
