"""Re-entry: activation that circles for ever, as a time within the cycle with two singular points.

The phase is the angle of a complex harmonic function with one zero and one pole, the cores: around
the first it grows by 2π counter-clockwise, around the second clockwise, as it must on a surface
without handles, where the turns add up to nothing. Elsewhere it is as even as can be (least
∫|∇phase|²). At a distance r from a core that is small against the distance of the cores, the front
turns with a speed of 2πr/cycle, tangentially; on a sphere with the cores at the poles the phase is
the longitude.
"""

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.csgraph import dijkstra
from scipy.sparse.linalg import splu

from auricle.arrays import Floats, Integers, PerVertex
from auricle.errors import InputError, SurfaceError
from auricle.surface.fast_marching import FastMarching
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import soundness
from auricle.surface.topology import edge_table

LEAST_WEIGHT = 0.01
"""Least weight of an edge: an obtuse pair of triangles must not turn the phase back."""


def macro_reentry(
    mesh: Mesh, *, cores: tuple[int, int], cycle_length: float, obstacle_radius: float = 0.0
) -> FieldMap:
    """Activation time of a front that circles around one obstacle, and so around another.

    The front is a line from one core to the other that sweeps the surface once a cycle. Circles
    about a core meet it at a right angle, so that a round obstacle there leaves it as it is.

    Parameters
    ----------
    mesh
        Closed, without handles.
    cores
        Vertices that the obstacles are centred on; the front turns counter-clockwise, seen from
        outside, around the first.
    cycle_length
        Time of one turn, ms.
    obstacle_radius
        Distance from a core up to which nothing is activated (NaN), mm; 0 leaves no vertex out.

    Returns
    -------
    FieldMap
        ``local_activation_time`` in [0, cycle_length), ms.

    Raises
    ------
    InputError
        If the cores are the same or out of range, the cycle is not positive or the radius is
        negative.
    SurfaceError
        If the mesh is not closed and oriented, or a core has no neighbour to turn around.
    """
    _check_cycle(cycle_length)
    if obstacle_radius < 0:
        raise InputError(f"an obstacle of radius {obstacle_radius} mm: give at least 0")
    times = cycle_length * winding_phase(mesh, cores) / (2 * np.pi)
    times = _within_cycle(times, cycle_length)
    if obstacle_radius > 0:
        marching = FastMarching(mesh)
        for core in cores:
            times[np.isfinite(marching.from_source([core], reach=obstacle_radius))] = np.nan
    return FieldMap(mesh, times, "local_activation_time", "ms")


def rotor_pair(
    mesh: Mesh, *, cores: tuple[int, int], cycle_length: float, velocity: float
) -> FieldMap:
    """Activation time of two counter-rotating spiral waves (a figure of eight).

    The turning phase of `macro_reentry` plus the time that a front takes from the nearer core:
    arms of wavelength velocity·cycle_length, which collide half-way between the cores. Far from
    the cores a front moves with `velocity`, near them more slowly: at r with
    1/√(1/velocity² + (cycle/2πr)²).

    Parameters
    ----------
    mesh
        Closed, without handles.
    cores
        Vertices that the spirals turn around, the first counter-clockwise.
    cycle_length
        Time of one turn, ms.
    velocity
        Conduction velocity, mm/ms.

    Returns
    -------
    FieldMap
        ``local_activation_time`` in [0, cycle_length), ms.

    Raises
    ------
    InputError, SurfaceError
        As `macro_reentry`; or if the velocity is not positive.
    """
    _check_cycle(cycle_length)
    if not velocity > 0:
        raise InputError(f"a conduction velocity of {velocity} mm/ms: give a positive one")
    turning = cycle_length * winding_phase(mesh, cores) / (2 * np.pi)
    marching = FastMarching(mesh)
    away = np.minimum(*(marching.from_source([core]) for core in cores))
    times = _within_cycle(turning + away / velocity, cycle_length)
    return FieldMap(mesh, times, "local_activation_time", "ms")


def winding_phase(mesh: Mesh, cores: tuple[int, int]) -> PerVertex:
    """Phase that grows by 2π counter-clockwise about one core and clockwise about the other.

    Harmonic elsewhere; each singular point lies in a triangle beside its core, so that the phase
    is defined at every vertex. Errors as `macro_reentry`.

    Returns
    -------
    PerVertex
        Shape (n,), radians; only its value modulo 2π has a meaning.

    Examples
    --------
    >>> from auricle.surface.shapes import icosphere
    >>> ball = icosphere(radius=30.0, subdivisions=3)
    >>> poles = int(ball.vertices[:, 2].argmax()), int(ball.vertices[:, 2].argmin())
    >>> phase = winding_phase(ball, poles)
    >>> longitude = np.arctan2(ball.vertices[:, 1], ball.vertices[:, 0])
    >>> low = np.abs(ball.vertices[:, 2]) < 25
    >>> offset = np.exp(1j * (phase - longitude)[low])
    >>> bool(abs(offset.mean()) > 0.99)
    True
    """
    _check_cores(mesh, cores)
    found = soundness(mesh)
    if not (found.is_closed and found.is_manifold and found.is_oriented):
        raise SurfaceError("re-entry needs a closed, manifold, oriented surface: cap its holes")
    edges, weights = _weighted_edges(mesh)
    path = _shortest_path(mesh, edges, cores)
    n = mesh.n_vertices
    rows, columns = np.concatenate([edges, edges[:, ::-1]]).T
    adjacency = csc_array(
        coo_array((np.tile(weights, 2), (rows, columns)), shape=(n, n)), dtype=np.float64
    )
    pull = np.zeros(n)
    for on_path, left in _edges_to_the_left(mesh, path):
        flow = 2 * np.pi * adjacency[on_path, left]
        pull[on_path] += flow
        pull[left] -= flow
    degree: Floats = np.asarray(adjacency.sum(axis=0)).ravel()
    stiffness = csc_array(coo_array((degree, (np.arange(n), np.arange(n))))) - adjacency
    return _grounded_solution(csc_array(stiffness), pull)


def _check_cycle(cycle_length: float) -> None:
    if not cycle_length > 0:
        raise InputError(f"a cycle length of {cycle_length} ms: give a positive one")


def _check_cores(mesh: Mesh, cores: tuple[int, int]) -> None:
    if len(cores) != 2 or cores[0] == cores[1]:
        raise InputError(f"cores {tuple(cores)}: give two different vertices")
    if min(cores) < 0 or max(cores) >= mesh.n_vertices:
        raise InputError(f"cores {tuple(cores)} of {mesh.n_vertices}: indices count from 0")


def _within_cycle(times: PerVertex, cycle_length: float) -> PerVertex:
    """Times modulo the cycle; rounding must not return the cycle itself."""
    wrapped = np.mod(times, cycle_length)
    return np.where(wrapped >= cycle_length, 0.0, wrapped)


def _weighted_edges(mesh: Mesh) -> tuple[Integers, Floats]:
    """Edges, shape (e, 2), and their cotangent weights, no smaller than `LEAST_WEIGHT`."""
    table = edge_table(mesh.faces)
    corners = mesh.vertices[mesh.faces]
    apex = np.roll(corners, -2, axis=1)
    along = np.einsum("fsi,fsi->fs", corners - apex, np.roll(corners, -1, axis=1) - apex)
    doubled = np.maximum(2 * mesh.face_areas, np.finfo(float).tiny)
    cotangents = along / doubled[:, None]
    weights = np.bincount(table.edge_of_side.ravel(), 0.5 * cotangents.ravel())
    return table.edges, np.maximum(weights, LEAST_WEIGHT)


def _shortest_path(mesh: Mesh, edges: Integers, ends: tuple[int, int]) -> list[int]:
    """Vertices along edges from the first end to the second."""
    lengths = np.linalg.norm(np.diff(mesh.vertices[edges], axis=1)[:, 0], axis=1)
    graph = coo_array((lengths, edges.T), shape=(mesh.n_vertices, mesh.n_vertices))
    distances, before = dijkstra(
        graph.tocsr(), directed=False, indices=[ends[1]], return_predecessors=True
    )
    if not np.isfinite(distances[0, ends[0]]):
        raise SurfaceError("the cores lie on different pieces of the surface: keep one piece")
    path = [ends[0]]
    while path[-1] != ends[1]:
        path.append(int(before[0, path[-1]]))
    if len(path) < 3:
        raise InputError("the cores are neighbours: choose two farther apart")
    return path


def _edges_to_the_left(mesh: Mesh, path: list[int]) -> list[tuple[int, int]]:
    """Edges from the path's inner vertices to its left, each as (vertex on it, other vertex).

    Where the phase jumps by 2π; every triangle has two of them or none, but for one at each end.
    """
    near = mesh.faces[np.isin(mesh.faces, path).any(axis=1)]
    apex = {
        (int(face[side]), int(face[(side + 1) % 3])): int(face[(side + 2) % 3])
        for face in near
        for side in range(3)
    }
    edges = []
    for previous, vertex, following in zip(path[:-2], path[1:-1], path[2:], strict=True):
        spoke = apex[vertex, following]
        while spoke != previous:
            edges.append((vertex, spoke))
            spoke = apex[vertex, spoke]
    return edges


def _grounded_solution(stiffness: csc_array, pull: PerVertex) -> PerVertex:
    """Solution of stiffness·x = pull that is 0 at the last vertex."""
    factors = splu(
        csc_array(stiffness[:-1, :-1]),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    solution: PerVertex = np.append(factors.solve(pull[:-1]), 0.0)
    return solution
