"""Cleaning: from what a file held to one oriented manifold, every repair named and counted.

The steps, in this order: unused vertices without a position dropped; vertices at exactly the
same place merged; faces with a repeated vertex dropped; faces that are there twice dropped once;
all pieces but the largest dropped; vertices where sheets touch in a point split; faces oriented
alike; a surface that is inside out turned outward; vertices of no face dropped; infinite field
values marked NaN. Nothing else moves: slivers and faces of no area stay (`Soundness` counts them
and the Laplacian bears them), and so do vertices that only nearly coincide. The copies of a split
vertex stay where it was, so cleaning again merges and splits it again, to the same mesh.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from auricle.arrays import Faces, Floats, Integers, Points, Truths
from auricle.errors import SurfaceError
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import Soundness, nonmanifold_vertices, signed_volume, soundness
from auricle.surface.soup import TriangleSoup
from auricle.surface.topology import (
    corner_fans,
    face_flips,
    pieces,
    unique_edges,
)

SMALLEST_DIAGONAL_MM = 5.0
LARGEST_DIAGONAL_MM = 2000.0
LARGEST_SHARE_OF_FACES_LOST = 0.5
SMALLEST_SHARE_OF_MAIN_PIECE = 0.6
FLAT = 1e-9
"""Volume over area^1.5 below which a surface has no inside."""


@dataclass(frozen=True)
class Repair:
    """One thing that was mended.

    Attributes
    ----------
    name
        What was done, such that count and name read as a phrase: "12 coincident vertices merged".
    count
        To how many vertices, faces, pieces or values.
    detail
        More to know; may be empty.
    """

    name: str
    count: int
    detail: str = ""

    def __str__(self) -> str:
        return f"{self.count} {self.name}" + (f" ({self.detail})" if self.detail else "")


@dataclass(frozen=True, eq=False)
class CleanSurface:
    """A sound surface with its fields, and what it took to get there.

    Attributes
    ----------
    mesh
        One piece, manifold, oriented, outward (an open surface as if its holes were closed).
    fields
        The fields of the soup on the mesh's vertices.
    face_tags
        The tags of the soup on the mesh's faces, each of shape (f,).
    repairs
        What was mended, in the order it was done; empty if the file was clean.
    soundness
        Of the mesh.
    """

    mesh: Mesh
    fields: tuple[FieldMap, ...]
    face_tags: Mapping[str, Integers]
    repairs: tuple[Repair, ...]
    soundness: Soundness


@dataclass(frozen=True, eq=False)
class _Draft:
    """The surface between two steps; origins are rows of the soup's arrays."""

    vertices: Points
    faces: Faces
    vertex_origin: Integers
    face_origin: Integers
    soup: TriangleSoup

    def with_faces(self, kept: Truths) -> "_Draft":
        return replace(self, faces=self.faces[kept], face_origin=self.face_origin[kept])

    def with_vertices(self, kept: Integers | Truths, new_index: Integers) -> "_Draft":
        """Keep these vertices; `new_index` says where each old one went."""
        return replace(
            self,
            vertices=self.vertices[kept],
            vertex_origin=self.vertex_origin[kept],
            faces=new_index[self.faces],
        )


_Step = Callable[[_Draft], tuple[_Draft, Repair | None]]


def clean(
    soup: TriangleSoup, *, check_scale: bool = True, keep_pieces: bool = False
) -> CleanSurface:
    """Make one oriented manifold of a soup, or refuse it.

    Parameters
    ----------
    soup
        As read from a file; not changed.
    check_scale
        Refuse a surface whose bounding box has a diagonal below 5 mm or above 2000 mm: a left
        atrium measures 50 to 120 mm, so the units are likely not millimetres.
    keep_pieces
        Keep every piece of the surface and not only the largest.

    Raises
    ------
    SurfaceError
        If there are no faces, an index is out of range, a face uses a vertex that is NaN or
        infinite, a field or tag has the wrong length, the largest piece holds less than 60 % of
        the area, an edge has more than two faces, the surface is one-sided, more than half of
        the faces would be dropped, or the scale is implausible.

    Examples
    --------
    >>> from auricle.surface.shapes import cube
    >>> box = cube(side=30.0, n=2)
    >>> soup = TriangleSoup(box.vertices[box.faces].reshape(-1, 3), np.arange(144).reshape(-1, 3))
    >>> cleaned = clean(soup)
    >>> [str(repair) for repair in cleaned.repairs]
    ['118 coincident vertices merged']
    >>> cleaned.mesh.n_vertices == box.n_vertices
    True
    """
    _refuse_malformed(soup)
    draft = _Draft(
        np.asarray(soup.vertices, dtype=np.float64),
        np.asarray(soup.faces, dtype=np.int64),
        np.arange(len(soup.vertices)),
        np.arange(len(soup.faces)),
        soup,
    )
    repairs = []
    for step in _STEPS:
        if keep_pieces and step is _keep_main_piece:
            continue
        draft, repair = step(draft)
        if repair is not None:
            repairs.append(repair)
        _refuse_loss(draft)
    mesh = Mesh(draft.vertices, draft.faces)
    if check_scale:
        _refuse_scale(mesh)
    fields, marked = _fields(draft, mesh)
    tags = {name: np.asarray(tag)[draft.face_origin] for name, tag in soup.face_tags.items()}
    return CleanSurface(mesh, fields, MappingProxyType(tags), (*repairs, *marked), soundness(mesh))


def _refuse_malformed(soup: TriangleSoup) -> None:
    faces = np.asarray(soup.faces)
    if faces.ndim != 2 or faces.shape[1] != 3 or not len(faces):
        raise SurfaceError("the file holds no triangles: export the surface, not its points")
    outside = (faces < 0) | (faces >= len(soup.vertices))
    if outside.any():
        raise SurfaceError(
            f"{outside.any(axis=1).sum()} faces name vertices {faces.min()}…{faces.max()} where "
            f"there are 0…{len(soup.vertices) - 1}: export the surface again"
        )
    _refuse_lengths(soup.point_fields, len(soup.vertices), "field", "vertices")
    _refuse_lengths(soup.face_tags, len(faces), "tag", "faces")


def _refuse_lengths(arrays: Mapping[str, Floats | Integers], n: int, kind: str, of: str) -> None:
    for name, values in arrays.items():
        if len(values) != n:
            raise SurfaceError(
                f"{kind} {name!r} has {len(values)} values on {n} {of}: export it again"
            )


def _refuse_loss(draft: _Draft) -> None:
    n_before = len(draft.soup.faces)
    lost = n_before - len(draft.faces)
    if lost > LARGEST_SHARE_OF_FACES_LOST * n_before:
        raise SurfaceError(
            f"{lost} of {n_before} faces are repeated, collapsed or detached: "
            "repair the surface in a mesh editor"
        )


def _refuse_scale(mesh: Mesh) -> None:
    diagonal = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    if not SMALLEST_DIAGONAL_MM <= diagonal <= LARGEST_DIAGONAL_MM:
        raise SurfaceError(
            f"the surface is {diagonal:.3g} mm across where a left atrium is 50 to 120 mm: "
            "are the units millimetres?"
        )


def _drop_unplaced(draft: _Draft) -> tuple[_Draft, Repair | None]:
    placed = np.isfinite(np.abs(draft.vertices).max(axis=1))
    if placed.all():
        return draft, None
    n_used = len(np.unique(draft.faces[~placed[draft.faces]]))
    if n_used:
        raise SurfaceError(f"{n_used} vertices of faces are NaN or infinite: export again")
    repair = Repair("unused vertices without a position dropped", int((~placed).sum()))
    return draft.with_vertices(placed, np.cumsum(placed) - 1), repair


def _merge_coincident(draft: _Draft) -> tuple[_Draft, Repair | None]:
    _, first, place = np.unique(draft.vertices, axis=0, return_index=True, return_inverse=True)
    n_merged = len(draft.vertices) - len(first)
    if not n_merged:
        return draft, None
    kept = np.sort(first)
    new_index = np.searchsorted(kept, first)[place.ravel()]
    detail = _disagreement(draft, kept[new_index])
    repair = Repair("coincident vertices merged", n_merged, detail)
    return draft.with_vertices(kept, new_index), repair


def _disagreement(draft: _Draft, representative: Integers) -> str:
    """Tell which fields lose values because merged vertices held different ones."""
    phrases = []
    for name, field in draft.soup.point_fields.items():
        values = np.asarray(field)[draft.vertex_origin].reshape(len(draft.vertices), -1)
        kept = values[representative]
        differ = ((values != kept) & ~(np.isnan(values) & np.isnan(kept))).any(axis=1)
        if differ.any():
            phrases.append(f"{name!r} differed at {differ.sum()}, the first value was kept")
    return "; ".join(phrases)


def _drop_collapsed(draft: _Draft) -> tuple[_Draft, Repair | None]:
    collapsed = (draft.faces == np.roll(draft.faces, 1, axis=1)).any(axis=1)
    if not collapsed.any():
        return draft, None
    repair = Repair("faces with a repeated vertex dropped", int(collapsed.sum()))
    return draft.with_faces(~collapsed), repair


def _drop_repeated(draft: _Draft) -> tuple[_Draft, Repair | None]:
    _, first = np.unique(np.sort(draft.faces, axis=1), axis=0, return_index=True)
    n_repeated = len(draft.faces) - len(first)
    if not n_repeated:
        return draft, None
    kept = np.zeros(len(draft.faces), dtype=bool)
    kept[first] = True
    return draft.with_faces(kept), Repair("duplicate faces dropped", n_repeated)


def _keep_main_piece(draft: _Draft) -> tuple[_Draft, Repair | None]:
    labels = pieces(draft.faces)
    areas = np.bincount(labels, weights=Mesh(draft.vertices, draft.faces).face_areas)
    if len(areas) == 1:
        return draft, None
    shares = areas / areas.sum() if areas.sum() > 0 else np.zeros(len(areas))
    main = int(np.argmax(areas))
    if shares[main] < SMALLEST_SHARE_OF_MAIN_PIECE:
        raise SurfaceError(
            f"the surface is in {len(areas)} pieces, the largest with {shares[main]:.1%} of the "
            "area: split the file, or merge vertices that nearly coincide"
        )
    detail = f"{1 - shares[main]:.2%} of the area, {(labels != main).sum()} faces"
    shorter = draft.with_faces(labels == main)
    alone = np.zeros(len(draft.vertices), dtype=bool)
    alone[draft.faces[labels != main]] = True
    alone[shorter.faces] = False
    repair = Repair("detached pieces dropped", len(areas) - 1, detail)
    return shorter.with_vertices(~alone, np.cumsum(~alone) - 1), repair


def _refuse_branching(draft: _Draft) -> tuple[_Draft, Repair | None]:
    edges, faces_per_edge = unique_edges(draft.faces)
    branching = edges[faces_per_edge > 2]
    if len(branching):
        one, other = draft.vertex_origin[branching[0]]
        raise SurfaceError(
            f"{len(branching)} edges have more than two faces (first: vertices {one} and {other}): "
            "repair the surface in a mesh editor"
        )
    return draft, None


def _split_bow_ties(draft: _Draft) -> tuple[_Draft, Repair | None]:
    n_split = len(nonmanifold_vertices(draft.faces))
    if not n_split:
        return draft, None
    fan_of_corner = corner_fans(draft.faces)
    fans, corner = np.unique(fan_of_corner, return_index=True)
    vertex = draft.faces.ravel()[corner]
    _, first_fan = np.unique(vertex, return_index=True)
    extra = np.setdiff1d(fans, first_fan)
    vertex_of_fan = vertex.copy()
    vertex_of_fan[extra] = len(draft.vertices) + np.arange(len(extra))
    split = replace(
        draft,
        vertices=np.concatenate([draft.vertices, draft.vertices[vertex[extra]]]),
        vertex_origin=np.concatenate([draft.vertex_origin, draft.vertex_origin[vertex[extra]]]),
        faces=vertex_of_fan[fan_of_corner],
    )
    detail = f"{len(extra)} vertices added"
    return split, Repair("vertices joining sheets in a point split", n_split, detail)


def _orient(draft: _Draft) -> tuple[_Draft, Repair | None]:
    flips = face_flips(draft.faces)
    if not flips.any():
        return draft, None
    return _turned(draft, flips), Repair("faces turned to agree with the others", int(flips.sum()))


def _turn_outward(draft: _Draft) -> tuple[_Draft, Repair | None]:
    mesh = Mesh(draft.vertices, draft.faces)
    if signed_volume(mesh) >= -FLAT * mesh.area**1.5:
        return draft, None
    everything = np.ones(len(draft.faces), dtype=bool)
    repair = Repair("faces turned outward", len(draft.faces), "the surface was inside out")
    return _turned(draft, everything), repair


def _turned(draft: _Draft, flips: Truths) -> _Draft:
    return replace(draft, faces=np.where(flips[:, None], draft.faces[:, [0, 2, 1]], draft.faces))


def _drop_isolated(draft: _Draft) -> tuple[_Draft, Repair | None]:
    used = np.zeros(len(draft.vertices), dtype=bool)
    used[draft.faces] = True
    if used.all():
        return draft, None
    repair = Repair("isolated vertices dropped", int((~used).sum()))
    return draft.with_vertices(used, np.cumsum(used) - 1), repair


_STEPS: tuple[_Step, ...] = (
    _drop_unplaced,
    _merge_coincident,
    _drop_collapsed,
    _drop_repeated,
    _keep_main_piece,
    _refuse_branching,
    _split_bow_ties,
    _orient,
    _turn_outward,
    _drop_isolated,
)


def _fields(draft: _Draft, mesh: Mesh) -> tuple[tuple[FieldMap, ...], tuple[Repair, ...]]:
    fields, repairs = [], []
    for name, held in draft.soup.point_fields.items():
        values = np.array(held, dtype=np.float64)[draft.vertex_origin]
        infinite = np.isinf(values)
        if infinite.any():
            values[infinite] = np.nan
            repairs.append(Repair(f"infinite values of {name!r} marked NaN", int(infinite.sum())))
        fields.append(FieldMap(mesh, values, name, draft.soup.units.get(name, "")))
    return tuple(fields), tuple(repairs)
