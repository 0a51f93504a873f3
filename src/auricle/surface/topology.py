"""How triangles hang together: edges, corners, pieces, holes, orientation, genus.

Everything here follows from the faces alone. Two faces touch where they share an edge; a shared
vertex does not join them, so two balls that touch in a point are two pieces.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from auricle.arrays import Faces, Integers, Truths
from auricle.errors import SurfaceError
from auricle.surface.mesh import Mesh


@dataclass(frozen=True, eq=False)
class EdgeTable:
    """The undirected edges of a set of faces and the sides that lie on them.

    Side 3f + c of face f runs from its corner c to the next corner; there are 3·n_faces sides.

    Attributes
    ----------
    edges
        Shape (e, 2), vertex indices, the smaller first, in lexicographic order.
    faces_per_edge
        Shape (e,): 1 on the boundary, 2 inside, more where the surface is not manifold.
    sides
        Shape (3f, 2), the vertices each side runs from and to.
    edge_of_side
        Shape (3f,), the row of `edges` each side lies on.
    """

    edges: Integers
    faces_per_edge: Integers
    sides: Integers
    edge_of_side: Integers

    @property
    def boundary_sides(self) -> Integers:
        """Sides with no face across, shape (b, 2), as their face runs through them."""
        boundary: Integers = self.sides[self.faces_per_edge[self.edge_of_side] == 1]
        return boundary

    @property
    def side_pairs(self) -> Integers:
        """The two sides of every edge that has exactly two, shape (i, 2)."""
        order = np.argsort(self.edge_of_side, kind="stable")
        first = np.cumsum(self.faces_per_edge) - self.faces_per_edge
        start = first[self.faces_per_edge == 2]
        pairs: Integers = np.column_stack([order[start], order[start + 1]])
        return pairs


def edge_table(faces: Faces) -> EdgeTable:
    """Edges of the faces, with how many faces hold each and which sides lie on it."""
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    low, high = sides.min(axis=1), sides.max(axis=1)
    keys, edge_of_side, counts = np.unique(
        low * (int(faces.max()) + 1) + high, return_inverse=True, return_counts=True
    )
    edges = np.column_stack(np.divmod(keys, int(faces.max()) + 1))
    return EdgeTable(edges, counts, sides, edge_of_side)


def unique_edges(faces: Faces) -> tuple[Integers, Integers]:
    """Undirected edges, shape (e, 2), and the number of faces on each, shape (e,).

    Examples
    --------
    >>> edges, faces_per_edge = unique_edges(np.array([[0, 1, 2], [2, 1, 3]]))
    >>> edges.tolist(), faces_per_edge.tolist()
    ([[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]], [1, 1, 2, 1, 1])
    """
    table = edge_table(faces)
    return table.edges, table.faces_per_edge


def pieces(faces: Faces) -> Integers:
    """Label of the piece each face belongs to, shape (f,), 0, 1, … in order of first face.

    Faces belong together if a path over shared edges joins them.

    Examples
    --------
    >>> pieces(np.array([[0, 1, 2], [3, 4, 5], [2, 1, 6]])).tolist()
    [0, 1, 0]
    """
    table = edge_table(faces)
    face_of_side = np.arange(faces.size) // 3
    labels = _joined_labels(
        np.column_stack([face_of_side, table.edge_of_side + len(faces)]),
        len(faces) + len(table.edges),
    )
    return labels[: len(faces)]


def corner_fans(faces: Faces) -> Integers:
    """Label of the fan each corner belongs to, shape (f, 3).

    A fan is a set of faces around a vertex, each joined to the next by an edge at that vertex
    with exactly two faces. On a manifold there are as many fans as vertices; a vertex with
    several is where sheets touch in a point (a bow-tie).

    Examples
    --------
    >>> corner_fans(np.array([[0, 1, 2], [0, 3, 4]])).tolist()
    [[0, 1, 2], [3, 4, 5]]
    """
    table = edge_table(faces)
    one, other = table.side_pairs.T
    starts = np.arange(faces.size)
    ends = np.roll(starts.reshape(-1, 3), -1, axis=1).ravel()
    opposed = table.sides[one, 0] == table.sides[other, 1]
    meets_start = np.where(opposed, ends[other], starts[other])
    meets_end = np.where(opposed, starts[other], ends[other])
    joins = np.concatenate(
        [np.column_stack([starts[one], meets_start]), np.column_stack([ends[one], meets_end])]
    )
    return _joined_labels(joins, faces.size).reshape(-1, 3)


def boundary_loops(mesh: Mesh) -> tuple[Integers, ...]:
    """Vertex indices around each hole, the surface on the left seen from outside.

    Returns
    -------
    tuple of arrays
        One a hole, each starting at its smallest index, holes in order of these; a loop runs
        the way its faces run through their boundary sides.

    Raises
    ------
    SurfaceError
        If two holes meet in a vertex, an edge has more than two faces, or the faces at the
        boundary are not oriented consistently.

    Examples
    --------
    >>> from auricle.surface.shapes import rectangle
    >>> [loop.tolist() for loop in boundary_loops(rectangle(width=1, height=1, n_x=2, n_y=3))]
    [[0, 1, 3, 5, 4, 2]]
    """
    sides = edge_table(mesh.faces).boundary_sides
    if not len(sides):
        return ()
    leaving, entering = np.sort(sides[:, 0]), np.sort(sides[:, 1])
    if not np.array_equal(leaving, entering):
        raise SurfaceError("the faces at a hole do not run the same way: orient the surface first")
    repeated = np.unique(leaving[1:][leaving[1:] == leaving[:-1]])
    if len(repeated):
        raise SurfaceError(
            f"{len(repeated)} vertices lie on a hole's edge twice (first: {repeated[0]}): "
            "clean the surface first, which parts them"
        )
    return _closed_walks(dict(zip(sides[:, 0].tolist(), sides[:, 1].tolist(), strict=True)))


def face_flips(faces: Faces) -> Truths:
    """Faces to turn over, shape (f,), so that neighbours agree: in each piece the fewer.

    Every face is taken twice, as it is and turned over, and joined to the copy of its
    neighbour that agrees with it; if both copies end up in one piece the surface is one-sided.

    Raises
    ------
    SurfaceError
        If no choice makes neighbours agree (the surface holds a Möbius strip).

    Examples
    --------
    >>> face_flips(np.array([[0, 1, 2], [1, 2, 3], [2, 4, 3]])).tolist()
    [True, False, False]
    """
    table = edge_table(faces)
    one, other = table.side_pairs.T
    disagree = (table.sides[one, 0] == table.sides[other, 0]).astype(np.int64)
    face, neighbour = one // 3, other // 3
    joins = np.concatenate(
        [
            np.column_stack([face, neighbour + len(faces) * disagree]),
            np.column_stack([face + len(faces), neighbour + len(faces) * (1 - disagree)]),
        ]
    )
    kept, turned = _joined_labels(joins, 2 * len(faces)).reshape(2, -1)
    if (kept == turned).any():
        raise SurfaceError(
            "the surface is one-sided (it holds a Möbius strip): repair it in a mesh editor"
        )
    piece = np.minimum(kept, turned)
    on_second_side = kept != piece
    n_second = np.bincount(piece, weights=on_second_side)
    second_is_larger = 2 * n_second > np.bincount(piece)
    flips: Truths = on_second_side != second_is_larger[piece]
    return flips


def is_oriented(faces: Faces) -> bool:
    """Whether no two faces run through an edge the same way."""
    table = edge_table(faces)
    one, other = table.side_pairs.T
    opposed = table.sides[one, 0] == table.sides[other, 1]
    return bool(opposed.all() and (table.faces_per_edge <= 2).all())


def euler_number(faces: Faces) -> int:
    """Vertices - edges + faces, counting only vertices that a face uses.

    Examples
    --------
    >>> from auricle.surface.shapes import cube, torus
    >>> euler_number(cube(side=1, n=3).faces)
    2
    >>> euler_number(torus(major=3, minor=1, n_major=8, n_minor=6).faces)
    0
    """
    n_used = int(np.count_nonzero(np.bincount(faces.ravel())))
    return n_used - len(unique_edges(faces)[0]) + len(faces)


def hole_count(faces: Faces) -> int:
    """Count the connected runs of boundary edges; holes that meet in a vertex count as one."""
    boundary = edge_table(faces).boundary_sides
    if not len(boundary):
        return 0
    vertices, ends = np.unique(boundary, return_inverse=True)
    return int(_joined_labels(ends.reshape(-1, 2), len(vertices)).max()) + 1


def genus(faces: Faces) -> int:
    """Count the handles of an oriented manifold, over all pieces: χ = 2·pieces - 2·genus - holes.

    Examples
    --------
    >>> from auricle.surface.shapes import torus
    >>> genus(torus(major=3, minor=1, n_major=8, n_minor=6).faces)
    1
    """
    n_pieces = int(pieces(faces).max()) + 1
    return (2 * n_pieces - hole_count(faces) - euler_number(faces)) // 2


def _joined_labels(joins: Integers, n: int) -> Integers:
    """Component of each of n nodes when the pairs `joins`, shape (j, 2), are connected.

    Components are numbered in order of their first node.
    """
    graph = coo_array((np.ones(len(joins), dtype=np.int8), (joins[:, 0], joins[:, 1])), (n, n))
    labels: Integers = connected_components(graph, directed=False)[1].astype(np.int64)
    return labels


def _closed_walks(following: dict[int, int]) -> tuple[Integers, ...]:
    walks = []
    for start in sorted(following):
        walk = []
        while start in following:
            walk.append(start)
            start = following.pop(start)
        if walk:
            walks.append(np.array(walk, dtype=np.int64))
    return tuple(walks)
