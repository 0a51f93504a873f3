"""Focal maps placed by position: the same places however a surface's vertices are numbered.

A place is where a random straight line meets the surface. Lines that come evenly from all sides
meet every patch in proportion to its area (Cauchy and Crofton), so the places are even over the
area, and they depend on the shape alone: renumbering the vertices moves none, and refining or
simplifying the mesh moves them by about as much as it moves the surface.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from scipy.spatial import cKDTree

from auricle.arrays import Floats, PerVertex, Points
from auricle.errors import InputError, SurfaceError
from auricle.surface.fast_marching import FastMarching
from auricle.surface.geodesics import distances_from
from auricle.surface.mesh import Mesh

FocusProfile = Literal["gaussian", "raised_cosine", "disc"]
PROFILES: tuple[FocusProfile, ...] = get_args(FocusProfile)

REACH_IN_WIDTHS = float(np.sqrt(-2.0 * np.log(1e-9)))
"""Where a Gaussian focus has fallen to 1e-9 of its height and counts as 0, in widths."""

_MOST_MEETINGS = 8
"""Of one line with the surface, beyond which they are passed over: a left atrium's are 2 to 6."""
_LINES = 100_000


@dataclass(frozen=True, eq=False)
class _Triangles:
    """Triangles about the origin, ready to be met by lines."""

    starts: Floats
    first: Floats
    second: Floats
    squares: Floats
    longest: float
    radius: float

    @classmethod
    def around(cls, centre: Floats, mesh: Mesh) -> "_Triangles":
        corners = mesh.vertices[mesh.faces] - centre
        starts = corners[:, 0]
        first, second = corners[:, 1] - starts, corners[:, 2] - starts
        squares = (starts**2).sum(axis=1)
        edges = max(float((edge**2).sum(axis=1).max()) for edge in (first, second))
        radius = float(np.linalg.norm(corners, axis=2).max())
        return cls(starts, first, second, squares, np.sqrt(edges), radius)

    def meetings(self, along: Floats, offset: Floats) -> Floats:
        """Where a line meets them (Möller and Trumbore), ascending along it, mm."""
        aside = self.squares - (self.starts @ along) ** 2 - 2 * self.starts @ offset
        near = np.flatnonzero(aside + offset @ offset <= (1.001 * self.longest) ** 2)
        first, second = self.first[near], self.second[near]
        across = np.cross(along, second)
        reach = offset - self.starts[near]
        turned = np.cross(reach, first)
        volumes = np.einsum("fi,fi->f", first, across)
        u, v = np.einsum("fi,fi->f", reach, across), turned @ along
        heights = np.einsum("fi,fi->f", second, turned)
        # Divided by the volume only where there is one: a triangle along the line is not met.
        met = (u * volumes >= 0) & (v * volumes >= 0) & (np.abs(u + v) <= np.abs(volumes))
        met &= volumes != 0.0
        return np.sort(heights[met] / volumes[met])


@dataclass(frozen=True, eq=False)
class Foci:
    """Foci on a mesh, kept as distances, so that every width and profile follows at once.

    Attributes
    ----------
    distances_mm
        Along the surface from each focus to each vertex, shape (c, n), mm; infinite out of reach.
    """

    distances_mm: Floats

    def map_of(
        self, n_foci: int, width_mm: float, *, profile: FocusProfile = "gaussian"
    ) -> PerVertex:
        """Sum of bumps of height 1 around the first `n_foci` places, shape (n,).

        Parameters
        ----------
        n_foci
            How many of the places.
        width_mm
            σ of ``gaussian``, exp(-d²/2σ²). ``raised_cosine`` is (1 + cos(πd/2w))/2 up to 2w, and
            ``disc`` 1 up to the width; both 0 beyond.
        profile
            Which of these.

        Raises
        ------
        InputError
            If there are fewer places, or the width is not positive.
        """
        if not 1 <= n_foci <= len(self.distances_mm):
            raise InputError(f"{n_foci} foci of {len(self.distances_mm)} places: draw more places")
        if not width_mm > 0:
            raise InputError(f"a width of {width_mm} mm: give a positive one")
        scaled = self.distances_mm[:n_foci] / width_mm
        values: PerVertex = _bump(scaled, profile).sum(axis=0)
        return values


def draw_places(mesh: Mesh, count: int, *, rng: np.random.Generator) -> Points:
    """Points of the surface at random, evenly over its area, shape (count, 3), mm.

    The first ones drawn do not depend on how many follow, nor any on the numbering of vertices
    and faces.

    Raises
    ------
    SurfaceError
        If the lines do not meet the surface: it is as good as a point.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> sphere = icosphere(radius=10.0, subdivisions=3)
    >>> places = draw_places(sphere, 2, rng=np.random.default_rng(1))
    >>> bool((abs(np.linalg.norm(places, axis=1) - 10.0) < 0.2).all())
    True
    """
    centre = 0.5 * (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0))
    triangles = _Triangles.around(centre, mesh)
    places: list[Floats] = []
    for _ in range(_LINES):
        if len(places) == count:
            break
        along, offset = _line(rng, triangles.radius)
        chosen = int(rng.integers(_MOST_MEETINGS))
        heights = triangles.meetings(along, offset)
        # Each meeting is taken with the same chance, however many the line has.
        if chosen < len(heights):
            places.append(centre + offset + heights[chosen] * along)
    else:
        raise SurfaceError("random lines do not meet the surface: is it as thin as a point?")
    return np.reshape(places, (-1, 3))


def foci_at(mesh: Mesh, places: Points, *, reach_mm: float = np.inf, marched: bool = False) -> Foci:
    """Foci at the vertices nearest to some places.

    Parameters
    ----------
    mesh
        The surface.
    places
        Points near it, shape (c, 3), mm.
    reach_mm
        How far along the surface a focus reaches; the exact search takes seconds for all of a
        surface of 10,000 vertices.
    marched
        Whether distances are those of fast marching, in milliseconds and to 0.2 %, and not exact.
        Counts by energy change by a few modes then; by amplitude, which weighs the crease where
        paths from both sides meet, by up to 15 % for widths of 10 mm and more.
    """
    centres = np.asarray(cKDTree(mesh.vertices).query(places)[1]).tolist()
    if marched:
        marching = FastMarching(mesh)
        return Foci(np.stack([marching.from_source([at], reach=reach_mm) for at in centres]))
    return Foci(np.stack([distances_from(mesh, at, reach=reach_mm) for at in centres]))


def straight_foci(mesh: Mesh, places: Points) -> Foci:
    """Foci at the same vertices with distances straight through space, not along the surface.

    They have no crease where paths from both sides meet, but reach across a thin wall.
    """
    centres = np.asarray(cKDTree(mesh.vertices).query(places)[1])
    return Foci(np.linalg.norm(mesh.vertices - mesh.vertices[centres][:, None], axis=2))


def placed_foci(
    mesh: Mesh,
    *,
    n_foci: int,
    sigma_mm: float,
    rng: np.random.Generator,
    profile: FocusProfile = "gaussian",
) -> PerVertex:
    """A map of `n_foci` bumps at random places, even over the area, shape (n,), peak about 1.

    The same generator gives the same places for every width, profile and numbering of the mesh,
    and for more foci the same first ones. The bumps are added, as `simulation.foci.focal_map`
    does. A focus is centred at the vertex nearest to its place.

    Parameters
    ----------
    mesh
        The surface, closed or with holes.
    n_foci
        How many foci, at least 1.
    sigma_mm
        Width of a focus, mm: the standard deviation of a Gaussian.
    rng
        Source of randomness.
    profile
        As in `Foci.map_of`.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> sphere = icosphere(radius=10.0, subdivisions=3)
    >>> one = placed_foci(sphere, n_foci=1, sigma_mm=3.0, rng=np.random.default_rng(1))
    >>> float(one.max()), bool(one.min() < 1e-9)
    (1.0, True)
    """
    if not sigma_mm > 0:
        raise InputError(f"a width of {sigma_mm} mm: give a positive one")
    places = draw_places(mesh, n_foci, rng=rng)
    foci = foci_at(mesh, places, reach_mm=REACH_IN_WIDTHS * sigma_mm)
    return foci.map_of(n_foci, sigma_mm, profile=profile)


def _bump(scaled: Floats, profile: FocusProfile) -> Floats:
    """Height at a distance in widths; 0 at infinity."""
    if profile == "gaussian":
        return np.where(scaled <= REACH_IN_WIDTHS, np.exp(-0.5 * scaled**2), 0.0)
    if profile == "raised_cosine":
        return np.where(
            scaled < 2.0, 0.5 + 0.5 * np.cos(0.5 * np.pi * np.minimum(scaled, 2.0)), 0.0
        )
    if profile == "disc":
        return np.where(scaled <= 1.0, 1.0, 0.0)
    raise InputError(f"profile {profile!r}: choose one of {', '.join(PROFILES)}")


def _line(rng: np.random.Generator, radius: float) -> tuple[Floats, Floats]:
    """A line through a ball, even over all lines: its direction and its foot from the centre."""
    along = rng.standard_normal(3)
    along /= np.linalg.norm(along)
    aside = rng.standard_normal(3)
    aside -= (aside @ along) * along
    aside *= radius * np.sqrt(rng.random()) / np.linalg.norm(aside)
    return along, aside
