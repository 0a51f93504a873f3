"""Capping: holes closed by discs, so that harmonics need not end at a cut vein or the mitral ring.

A disc has the hole's vertices on its rim, at angles in proportion to their distance along it,
and rings of new vertices inside, as far from each other as those on the rim and, further in, as
those of the surface. Its Delaunay triangulation is carried into space by the harmonic map that
holds the rim: cotangent weights of a Delaunay triangulation are not negative, so each new vertex
is a mean of its neighbours (Tutte 1963; Pinkall and Polthier 1993) and the map exists whatever
the hole's shape.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu
from scipy.spatial import Delaunay

from auricle.arrays import Faces, Floats, Integers, PerVertex, Points, Truths
from auricle.errors import SolverError, SurfaceError
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import require_sound, soundness
from auricle.surface.topology import boundary_loops

SHORTEST_STEP = 0.25
"""Least step between neighbours on the rim of a disc, in mean steps: three neighbours must not
lie on a line to within rounding."""
LONGEST_SHARE = 0.4
"""Most of the rim's circle that one step may take: the centre must lie well inside."""
CLEARANCE = 0.35
"""Least distance of a ring's vertices from the rim, in distances between the ring's vertices."""
GROWTH = 1.25
"""Spacing on a ring over that on the ring around it, until the surface's own is reached."""
ROW = np.sqrt(3) / 2
"""Distance between rows of a hexagonal lattice over that between points."""
EQUILATERAL = np.sqrt(3) / 4
"""Area of an equilateral triangle of side 1."""
LARGEST_RESIDUAL = 1e-8
"""Of a harmonic extension, against its largest entry times its largest value."""
SIDES = ((0, 1), (1, 2), (2, 0))
MOST_RINGS = 150
"""A hole of more than about 1000 vertices gets coarser triangles inside, not millions of them."""


@dataclass(frozen=True, eq=False)
class CappedSurface:
    """A closed surface, part of it measured and part of it made up.

    Attributes
    ----------
    mesh
        Closed, manifold and oriented; the original vertices and faces come first, unchanged.
    n_original_vertices, n_original_faces
        How many of them there are.
    cap_areas
        Area of each cap, mm².
    hole_perimeters
        Length around each hole, mm, in the same order (that of `boundary_loops`).
    """

    mesh: Mesh
    n_original_vertices: int
    n_original_faces: int
    cap_areas: tuple[float, ...]
    hole_perimeters: tuple[float, ...]

    @property
    def original(self) -> Truths:
        """Which vertices belong to the original surface, its rims included, shape (n,)."""
        return np.arange(self.mesh.n_vertices) < self.n_original_vertices

    @property
    def original_faces(self) -> Truths:
        """Which faces belong to the original surface, shape (f,)."""
        return np.arange(self.mesh.n_faces) < self.n_original_faces


def cap_holes(mesh: Mesh, *, largest_share: float = 0.4) -> CappedSurface:
    """Close every hole of a surface.

    Parameters
    ----------
    mesh
        One manifold, oriented piece; if it is closed it comes back as it is.
    largest_share
        Most of the closed surface's area that the caps may hold together. Half a sphere needs
        1/3, a flat sheet 1/2 whatever its outline.

    Raises
    ------
    SurfaceError
        If the mesh is not one manifold, oriented piece, or the caps hold more than their share.
    SolverError
        If the result is not closed and manifold with the handles it had.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> ball = icosphere(radius=10.0, subdivisions=3)
    >>> low = (ball.vertices[ball.faces][:, :, 2] < 5).any(axis=1)
    >>> kept, faces = np.unique(ball.faces[low], return_inverse=True)
    >>> capped = cap_holes(Mesh(ball.vertices[kept], faces.reshape(-1, 3)))
    >>> soundness(capped.mesh).is_closed, len(capped.cap_areas)
    (True, 1)
    """
    before = soundness(mesh)
    require_sound(before)
    if before.is_closed:
        return CappedSurface(mesh, mesh.n_vertices, mesh.n_faces, (), ())
    # Backwards, so that a cap runs through its rim against the surface.
    rims = [loop[::-1] for loop in boundary_loops(mesh)]
    edge_length = float(np.sqrt(mesh.area / mesh.n_faces / EQUILATERAL))
    caps = [_cap(mesh.vertices[rim], edge_length) for rim in rims]
    areas = tuple(cap.area for cap in caps)
    _refuse_share(sum(areas), mesh.area, len(rims), largest_share)
    closed = _joined(mesh, rims, caps)
    after = soundness(closed)
    if not (after.is_closed and after.is_manifold and after.genus == before.genus):
        raise SolverError("closing the holes changed the topology: cap them in a mesh editor")
    perimeters = tuple(float(_steps(mesh.vertices[rim]).sum()) for rim in rims)
    return CappedSurface(closed, mesh.n_vertices, mesh.n_faces, areas, perimeters)


def _joined(mesh: Mesh, rims: list[Integers], caps: list[Mesh]) -> Mesh:
    """Sew each cap, whose first vertices are the rim's, to its rim."""
    vertices, faces = [mesh.vertices], [mesh.faces]
    n_vertices = mesh.n_vertices
    for rim, cap in zip(rims, caps, strict=True):
        n_new = cap.n_vertices - len(rim)
        index = np.concatenate([rim, n_vertices + np.arange(n_new)])
        vertices.append(cap.vertices[len(rim) :])
        faces.append(index[cap.faces])
        n_vertices += n_new
    return Mesh(np.concatenate(vertices), np.concatenate(faces))


def _refuse_share(caps: float, surface: float, n_holes: int, largest: float) -> None:
    share = caps / (caps + surface)
    if share > largest:
        raise SurfaceError(
            f"closing the {n_holes} holes would make up {share:.0%} of the surface, more than "
            f"{largest:.0%}: use a surface with smaller holes, or raise largest_share"
        )


def harmonic_extension(stiffness: csc_array, values: Floats, known: Truths) -> Floats:
    """Values everywhere, of least Dirichlet energy among those that agree where known.

    Parameters
    ----------
    stiffness
        Symmetric, positive semidefinite, of row sum 0, shape (n, n); every unknown vertex must
        be connected to a known one.
    values
        Shape (n,) or (n, c), read where `known` only.
    known
        Which rows of `values` to keep, shape (n,).

    Raises
    ------
    SolverError
        If the system is not solved to 1e-8.
    """
    # Far from zero the solution would lose digits: solve for the deviation from the mean.
    mean = values[known].mean(axis=0)
    rows = stiffness[~known]
    free = csc_array(rows[:, ~known])
    pull = -(rows[:, known] @ (values[known] - mean))
    # Without the symmetric mode this ordering fills in several times as much.
    factors = splu(
        free,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    solution = factors.solve(pull)
    residual = float(np.abs(free @ solution - pull).max(initial=0.0))
    scale = float(free.diagonal().max(initial=0.0) * np.abs(solution).max(initial=0.0))
    if not residual <= LARGEST_RESIDUAL * scale:
        raise SolverError(
            f"the harmonic extension is solved to {residual:.1e} only: remesh the worst faces"
        )
    extended = values.copy()
    extended[~known] = solution + mean
    return extended


def _cap(rim: Points, edge_length: float) -> Mesh:
    """Span a disc over a rim, whose vertices come first and in their order."""
    disc = _disc(_steps(rim), edge_length)
    triangles = _delaunay(disc, len(rim))
    places = np.zeros((len(disc), 3))
    places[: len(rim)] = rim
    on_rim = np.arange(len(disc)) < len(rim)
    return Mesh(harmonic_extension(_stiffness(disc, triangles), places, on_rim), triangles)


def _steps(rim: Points) -> PerVertex:
    """Distance from each vertex of the rim to the next, shape (m,), mm."""
    steps: PerVertex = np.linalg.norm(np.roll(rim, -1, axis=0) - rim, axis=1)
    return steps


def _disc(steps: PerVertex, edge_length: float) -> Floats:
    """Points of the unit disc, shape (d, 2): the rim counter-clockwise, the rings, the centre."""
    turns = 2 * np.pi * _shares(steps)
    starts = np.cumsum(turns) - turns
    angles, radii = [], []
    for ring, (distance, spacing) in enumerate(_rings(len(steps), edge_length / steps.mean())):
        count = max(3, round(2 * np.pi * distance / spacing))
        # Every other ring is turned by half a step, as the rows of a hexagonal lattice are.
        angle = 2 * np.pi * (np.arange(count) + (ring + 1) % 2 / 2) / count
        sector = np.searchsorted(starts, angle, side="right") - 1
        from_rim = np.cos(turns[sector] / 2)
        from_rim -= distance * np.cos(angle - starts[sector] - turns[sector] / 2)
        clear = from_rim > CLEARANCE * spacing
        angles.append(angle[clear])
        radii.append(np.full(clear.sum(), distance))
    every_angle = np.concatenate([starts, *angles, [0.0]])
    every_radius = np.concatenate([np.ones(len(steps)), *radii, [0.0]])
    points: Floats = np.column_stack([np.cos(every_angle), np.sin(every_angle)])
    points *= every_radius[:, None]
    return points


def _rings(n_rim: int, coarsening: float) -> list[tuple[float, float]]:
    """Radius of each ring between rim and centre, and the spacing of vertices on it.

    The spacing grows from that on the rim to `coarsening` times as much.
    """
    spacing = 2 * np.pi / n_rim
    widest = max(spacing * coarsening, 1 / (MOST_RINGS * ROW), spacing)
    depth, rings = 0.0, []
    while depth + ROW * spacing / 2 < 1:
        depth += ROW * spacing
        rings.append((depth, spacing))
        spacing = min(spacing * GROWTH, widest)
    return [(1 - place / depth, width / depth) for place, width in rings[:-1]]


def _shares(steps: PerVertex) -> PerVertex:
    """Share of the circle for each step of the rim: its length's, evened out if it must be."""
    shares, even = steps / steps.sum(), 1 / len(steps)
    shortest, longest = shares.min(), shares.max()
    evened = 0.0
    if shortest < SHORTEST_STEP * even:
        evened = (SHORTEST_STEP * even - shortest) / (even - shortest)
    if longest > LONGEST_SHARE:
        evened = max(evened, (longest - LONGEST_SHARE) / (longest - even))
    blended: PerVertex = (1 - evened) * shares + evened * even
    return blended


def _delaunay(disc: Floats, n_rim: int) -> Faces:
    """Counter-clockwise Delaunay triangles of a disc whose rim comes first.

    All of the rim lies on one circle and the centre inside it, so the triangulation is convex
    with the rim as its hull, and no inner edge has both ends on the rim: every circle through
    both would hold a vertex of the rim or the centre.
    """
    triangles = Delaunay(disc).simplices.astype(np.int64)
    one, two, three = disc[triangles].transpose(1, 0, 2)
    (ux, uy), (vx, vy) = (two - one).T, (three - one).T
    clockwise = ux * vy - uy * vx < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    n_rim_sides = sum((triangles[:, [a, b]] < n_rim).all(axis=1).sum() for a, b in SIDES)
    if len(triangles) != 2 * len(disc) - 2 - n_rim or n_rim_sides != n_rim:
        raise SolverError("a hole cannot be triangulated: cap it in a mesh editor")
    return triangles


def _stiffness(points: Floats, triangles: Faces) -> csc_array:
    """Cotangent stiffness of a plane triangulation, shape (d, d)."""
    corners = points[triangles]
    rows: list[Integers] = []
    columns: list[Integers] = []
    values: list[Floats] = []
    for corner in range(3):
        first, second = (corner + 1) % 3, (corner + 2) % 3
        (ux, uy) = (corners[:, first] - corners[:, corner]).T
        (vx, vy) = (corners[:, second] - corners[:, corner]).T
        half_cotangent = 0.5 * (ux * vx + uy * vy) / (ux * vy - uy * vx)
        one, other = triangles[:, first], triangles[:, second]
        rows += [one, other, one, other]
        columns += [other, one, one, other]
        values += [-half_cotangent, -half_cotangent, half_cotangent, half_cotangent]
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    return csc_array(coo_array(entries, shape=(len(points), len(points))))
