"""Simplification: the same surface with fewer vertices, to the vertex.

Quadric edge collapse (Garland and Heckbert, *Surface simplification using quadric error
metrics*, SIGGRAPH 1997) with the link condition, which keeps pieces, holes and handles
(Dey, Edelsbrunner, Guha and Nekhayev, 1999), as libigl has it.
"""

import igl
import numpy as np

from auricle.arrays import Faces, Points
from auricle.errors import InputError, SolverError, SurfaceError
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import Soundness, require_sound, soundness
from auricle.surface.topology import euler_number

FEWEST_VERTICES = 4


def simplify(mesh: Mesh, n_vertices: int) -> Mesh:
    """Thin a surface out to exactly `n_vertices` vertices, each step the least quadric error.

    Parameters
    ----------
    mesh
        One manifold, oriented piece, with or without holes.
    n_vertices
        How many vertices to leave; with as many or more than there are, the mesh itself comes
        back.

    Returns
    -------
    Mesh
        As many pieces, holes and handles as before, oriented as before. Vertices are new, also
        along the holes: carry fields over with `transfer`.

    Raises
    ------
    InputError
        If fewer than 4 vertices are asked for.
    SurfaceError
        If the mesh is not one manifold, oriented piece, or no edge is left that can collapse
        without changing the topology.
    SolverError
        If the simplifier changed the topology after all.

    Examples
    --------
    >>> from auricle.surface.shapes import torus
    >>> ring = torus(major=20.0, minor=8.0, n_major=40, n_minor=20)
    >>> coarse = simplify(ring, 123)
    >>> coarse.n_vertices, euler_number(coarse.faces)
    (123, 0)
    """
    if n_vertices < FEWEST_VERTICES:
        raise InputError(f"{n_vertices} vertices asked for: give {FEWEST_VERTICES} or more")
    if n_vertices >= mesh.n_vertices:
        return mesh
    before = soundness(mesh)
    require_sound(before)
    # The quadrics lose digits far from the origin, and on lengths much below 1.
    centre, spacing = mesh.vertices.mean(axis=0), np.sqrt(mesh.area / mesh.n_vertices)
    vertices, faces = _collapsed((mesh.vertices - centre) / spacing, mesh.faces, n_vertices)
    simpler = Mesh(vertices * spacing + centre, faces)
    if _topology(soundness(simpler)) != _topology(before):
        raise SolverError("simplification changed the topology: ask for more vertices")
    return simpler


def _collapsed(vertices: Points, faces: Faces, n_vertices: int) -> tuple[Points, Faces]:
    """Collapse edges until the count is met.

    The simplifier counts faces. Of V = χ + (faces + boundary edges)/2 the boundary is not known
    beforehand; leaving 2(n - χ) faces leaves at least n vertices, and since a collapse takes one
    vertex and one or two faces, taking d more faces takes d/2 to d more vertices: never too many.
    """
    n_faces = 2 * (n_vertices - euler_number(faces))
    while len(vertices) > n_vertices:
        n_before = len(vertices)
        vertices, faces, *_ = igl.qslim(
            np.asfortranarray(vertices), np.asfortranarray(faces, dtype=np.int32), n_faces
        )
        if len(vertices) == n_before:
            raise SurfaceError(
                f"no fewer than {n_before} vertices keep the surface's holes and handles: "
                f"ask for {n_before} or more"
            )
        n_faces = len(faces) - (len(vertices) - n_vertices)
    return vertices, faces


def _topology(found: Soundness) -> tuple[bool, int, int, int | None]:
    return found.is_manifold, found.n_pieces, found.n_holes, found.genus
