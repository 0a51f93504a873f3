"""What a surface is fit for: its topology, its triangles and its size, counted."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Faces, Floats, Integers, PerFace, PerVertex
from auricle.errors import SurfaceError
from auricle.surface.mesh import Mesh
from auricle.surface.topology import (
    boundary_loops,
    corner_fans,
    edge_table,
    genus,
    hole_count,
    is_oriented,
    pieces,
)

SLIVER_QUALITY = 0.05
"""Quality below which a triangle counts as a sliver."""
FLAT = 1e-12
"""Area over squared length below which a triangle counts as flat in its cotangents."""
ROUNDING = 1e-9
"""Cotangent weights closer to 0 than this count as 0."""


@dataclass(frozen=True)
class Soundness:
    """Counts and measures of a surface, all plain numbers.

    Slivers and faces of no area are told here, not repaired: the Laplacian in use (intrinsic
    Delaunay, mollified) keeps its accuracy on them.

    Attributes
    ----------
    n_vertices, n_faces
        As the mesh holds them.
    n_pieces
        Sets of faces joined over edges.
    n_holes
        Runs of boundary edges.
    genus
        Number of handles; None unless manifold and oriented.
    is_closed
        No edge has a single face.
    is_manifold
        Every edge has one or two faces and the faces at every vertex are one fan.
    is_oriented
        Neighbouring faces run through their edge in opposite directions.
    n_nonmanifold_edges
        Edges with more than two faces.
    n_nonmanifold_vertices
        Vertices whose faces are several fans.
    n_isolated_vertices
        Vertices of no face.
    n_duplicate_vertices
        Vertices at exactly the place of an earlier one.
    n_duplicate_faces
        Faces with the vertices of an earlier one.
    n_zero_area_faces
        Faces whose area is exactly 0.
    n_slivers
        Faces with quality below 0.05, those of no area included.
    smallest_quality
        Quality of the worst face: 4√3·area / Σ edge², 1 for an equilateral triangle.
    negative_weight_share
        Share of the inner edges whose cotangent weight is negative (not Delaunay).
    edge_length_mm
        Median length of an edge, mm.
    area_mm2
        Total area, mm².
    volume_mm3
        Volume enclosed, positive if the faces look outward; None unless closed and oriented.
    """

    n_vertices: int
    n_faces: int
    n_pieces: int
    n_holes: int
    genus: int | None
    is_closed: bool
    is_manifold: bool
    is_oriented: bool
    n_nonmanifold_edges: int
    n_nonmanifold_vertices: int
    n_isolated_vertices: int
    n_duplicate_vertices: int
    n_duplicate_faces: int
    n_zero_area_faces: int
    n_slivers: int
    smallest_quality: float
    negative_weight_share: float
    edge_length_mm: float
    area_mm2: float
    volume_mm3: float | None


def soundness(mesh: Mesh) -> Soundness:
    """Count and measure everything `Soundness` holds.

    Examples
    --------
    >>> from auricle.surface.shapes import cube
    >>> found = soundness(cube(side=2.0, n=4))
    >>> found.is_closed, found.genus, found.area_mm2, found.volume_mm3
    (True, 0, 24.0, 8.0)
    """
    table = edge_table(mesh.faces)
    is_closed = bool((table.faces_per_edge != 1).all())
    n_nonmanifold_edges = int((table.faces_per_edge > 2).sum())
    n_nonmanifold_vertices = len(nonmanifold_vertices(mesh.faces))
    is_manifold = not n_nonmanifold_edges and not n_nonmanifold_vertices
    oriented = is_oriented(mesh.faces)
    lengths = np.linalg.norm(np.diff(mesh.vertices[table.edges], axis=1)[:, 0], axis=1)
    quality = triangle_quality(mesh)
    return Soundness(
        n_vertices=mesh.n_vertices,
        n_faces=mesh.n_faces,
        n_pieces=int(pieces(mesh.faces).max()) + 1,
        n_holes=hole_count(mesh.faces),
        genus=genus(mesh.faces) if is_manifold and oriented else None,
        is_closed=is_closed,
        is_manifold=is_manifold,
        is_oriented=oriented,
        n_nonmanifold_edges=n_nonmanifold_edges,
        n_nonmanifold_vertices=n_nonmanifold_vertices,
        n_isolated_vertices=int(
            (np.bincount(mesh.faces.ravel(), minlength=mesh.n_vertices) == 0).sum()
        ),
        n_duplicate_vertices=mesh.n_vertices - len(np.unique(mesh.vertices, axis=0)),
        n_duplicate_faces=mesh.n_faces - len(np.unique(np.sort(mesh.faces, axis=1), axis=0)),
        n_zero_area_faces=int((mesh.face_areas == 0.0).sum()),
        n_slivers=int((quality < SLIVER_QUALITY).sum()),
        smallest_quality=float(quality.min()),
        negative_weight_share=_negative_weight_share(mesh),
        edge_length_mm=float(np.median(lengths)),
        area_mm2=mesh.area,
        volume_mm3=signed_volume(mesh) if is_closed and oriented else None,
    )


def require_sound(found: Soundness) -> None:
    """Refuse a surface on which no Laplacian should be built.

    Raises
    ------
    SurfaceError
        Naming the first of: edges with more than two faces, faces not oriented alike, several
        fans at a vertex, duplicate faces, several pieces, isolated vertices.
    """
    faults = (
        (found.n_nonmanifold_edges, "edges have more than two faces: repair them in a mesh editor"),
        (not found.is_oriented, "neighbouring faces disagree on the outside: clean the surface"),
        (found.n_nonmanifold_vertices, "vertices join sheets in a point: clean the surface"),
        (found.n_duplicate_faces, "faces are there twice: clean the surface"),
        (found.n_pieces > 1 and found.n_pieces, "pieces: split the file"),
        (found.n_isolated_vertices, "vertices belong to no face: clean the surface"),
    )
    for count, fault in faults:
        if count:
            raise SurfaceError(fault if count is True else f"{count} {fault}")


def zero_area_remark(found: Soundness) -> str:
    """What to tell of faces without area: they are kept, and which Laplacian copes with them."""
    return (
        f"{found.n_zero_area_faces} faces without area kept: where simplification leaves them, the "
        "intrinsic Delaunay Laplacian and distances by the heat method cope with them"
    )


def triangle_quality(mesh: Mesh) -> PerFace:
    """4√3·area / Σ edge² of each face, shape (f,): 1 for equilateral, 0 for no area.

    Examples
    --------
    >>> flat = Mesh([[0, 0, 0], [2, 0, 0], [1, 3**0.5, 0]], [[0, 1, 2]])
    >>> round(float(triangle_quality(flat)[0]), 12)
    1.0
    """
    a, b, c = np.take(mesh.vertices, mesh.faces.T, axis=0)
    squares = sum(np.einsum("fi,fi->f", side, side) for side in (a - b, b - c, c - a))
    quality: PerFace = np.zeros(mesh.n_faces)
    np.divide(4 * np.sqrt(3) * mesh.face_areas, squares, out=quality, where=squares > 0)
    return quality


def vertex_areas(mesh: Mesh) -> PerVertex:
    """Area each vertex stands for, shape (n,), mm²: a third of each of its faces; sums to the area.

    Examples
    --------
    >>> from auricle.surface.shapes import cube
    >>> round(float(vertex_areas(cube(side=2.0, n=3)).sum()), 12)
    24.0
    """
    shares = np.repeat(mesh.face_areas / 3, 3)
    totals = np.bincount(mesh.faces.ravel(), weights=shares, minlength=mesh.n_vertices)
    return totals.astype(np.float64)


def signed_volume(mesh: Mesh) -> float:
    """Volume an oriented surface encloses, mm³, positive if its faces look outward.

    By the divergence theorem, from the middle of the vertices so that a far origin costs no
    digits. A hole counts as closed by a cone from the middle of its rim.

    Examples
    --------
    >>> from auricle.surface.shapes import cube
    >>> box = cube(side=2.0, n=1)
    >>> round(signed_volume(Mesh(box.vertices, box.faces[2:])), 12)
    8.0
    """
    vertices = mesh.vertices - mesh.vertices.mean(axis=0)
    total = _cones(vertices[mesh.faces])
    for loop in boundary_loops(mesh):
        rim = vertices[loop]
        top = np.broadcast_to(rim.mean(axis=0), rim.shape)
        total += _cones(np.stack([np.roll(rim, -1, axis=0), rim, top], axis=1))
    return total


def _cones(triangles: Floats) -> float:
    """Volume between the origin and triangles, shape (t, 3, 3)."""
    one, two, three = triangles.transpose(1, 0, 2)
    return float(np.einsum("ti,ti->", one, np.cross(two, three)) / 6)


def nonmanifold_vertices(faces: Faces) -> Integers:
    """Vertices whose faces form more than one fan, in increasing order."""
    fans = corner_fans(faces)
    _, one_corner = np.unique(fans, return_index=True)
    vertices, n_fans = np.unique(faces.ravel()[one_corner], return_counts=True)
    several: Integers = vertices[n_fans > 1]
    return several


def _negative_weight_share(mesh: Mesh) -> float:
    table = edge_table(mesh.faces)
    inner = table.faces_per_edge > 1
    if not inner.any():
        return 0.0
    corners = mesh.vertices[mesh.faces]
    to_next = np.roll(corners, -1, axis=1) - corners
    to_last = np.roll(corners, -2, axis=1) - corners
    dots = np.einsum("fci,fci->fc", to_next, to_last)
    # A face of no area has infinite cotangents: large ones give the same sign.
    doubled = np.maximum(2 * mesh.face_areas, FLAT * (to_next**2).sum(axis=(1, 2)))[:, None]
    cotangents = np.divide(dots, doubled, out=np.zeros_like(dots), where=doubled > 0)
    opposite_side = np.roll(cotangents, -2, axis=1).ravel()
    weights = np.bincount(table.edge_of_side, weights=opposite_side)
    # Four vertices on a circle give weight 0, which rounding may make slightly negative.
    return float((weights[inner] < -ROUNDING).mean())
