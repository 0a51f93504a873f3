"""Collapse sequence: a surface at every number of vertices, from one pass of simplification.

A progressive mesh (Hoppe, SIGGRAPH 1996) of which only the collapses are kept: a level's faces
are those of the full surface whose corners still stand for three different vertices.
"""

import json
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from auricle.arrays import Floats, Integers, read_only
from auricle.atomic import write_whole
from auricle.compiled import compiled
from auricle.errors import FormatError, InputError, SurfaceError
from auricle.surface.distance import GeometricDistance, geometric_distance
from auricle.surface.feature_scaling import FeatureScale, feature_lengths
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.soundness import vertex_areas

FEWEST_VERTICES = 4
SMALLEST_SAMPLED_SHARE = 0.5
_FORMAT = "auricle collapse sequence 1"


@dataclass(frozen=True, eq=False)
class CollapseSequence:
    """Every level of a surface, the full one included.

    Parameters
    ----------
    mesh
        The full surface.
    fields
        Fields that the quadrics knew of, on `mesh`.
    scales
        How each became lengths.
    kept, gone
        Vertices of each collapse in order, shape (c,): the one that stays, and the other; frozen.
    places
        Where the kept vertex went, position first, then the scaled fields, shape (c, d), mm.
    errors
        Error of the surface after 0, 1, …, c collapses, mm: the root mean square distance of its
        vertices from the planes of the full surface's faces they stand for, weighted by area. With
        fields, in the space of positions and scaled values. Quick to know and mostly larger than
        the distance between the surfaces; `distance_at` measures that.
    """

    mesh: Mesh
    fields: tuple[FieldMap, ...]
    scales: tuple[FeatureScale, ...]
    kept: Integers
    gone: Integers
    places: Floats
    errors: Floats

    def __post_init__(self) -> None:
        for name, dtype in (("kept", np.int32), ("gone", np.int32)):
            object.__setattr__(self, name, read_only(getattr(self, name), dtype))
        for name in ("places", "errors"):
            object.__setattr__(self, name, read_only(getattr(self, name), np.float64))

    @property
    def n_least(self) -> int:
        """Number of vertices of the coarsest level."""
        return self.mesh.n_vertices - len(self.kept)

    def mesh_at(self, n_vertices: int) -> Mesh:
        """Surface with exactly `n_vertices` vertices.

        Vertices and faces are in the order of the full surface; so many or more vertices than
        that has give that itself.

        Raises
        ------
        InputError
            If fewer than 4 vertices are asked for.
        SurfaceError
            If there is no level so coarse.
        """
        if n_vertices >= self.mesh.n_vertices:
            return self.mesh
        stands_for = self._stands_for(n_vertices)
        remaining = stands_for == np.arange(len(stands_for))
        faces = stands_for[self.mesh.faces]
        whole = (
            (faces[:, 0] != faces[:, 1])
            & (faces[:, 1] != faces[:, 2])
            & (faces[:, 2] != faces[:, 0])
        )
        vertices = self._places_at(n_vertices)[remaining, :3]
        return Mesh(vertices, (np.cumsum(remaining) - 1)[faces[whole]])

    def fields_at(self, n_vertices: int) -> tuple[FieldMap, ...]:
        """Fields on ``mesh_at(n_vertices)``, as the quadrics placed their values.

        A vertex has no value (NaN) if less than half of the area it stands for was sampled.

        Raises
        ------
        InputError, SurfaceError
            As `mesh_at`.
        """
        if n_vertices >= self.mesh.n_vertices:
            return self.fields
        mesh, column, carried = self.mesh_at(n_vertices), 3, []
        stands_for = self._stands_for(n_vertices)
        remaining = stands_for == np.arange(len(stands_for))
        places = self._places_at(n_vertices)[remaining]
        for field, scale in zip(self.fields, self.scales, strict=True):
            values = scale.values(places[:, column : column + len(scale.mean)])
            values[self._sampled_share(field, stands_for)[remaining] < SMALLEST_SAMPLED_SHARE] = (
                np.nan
            )
            column += len(scale.mean)
            shape = (mesh.n_vertices, *field.values.shape[1:])
            carried.append(FieldMap(mesh, values.reshape(shape), field.name, field.unit))
        return tuple(carried)

    def error_at(self, n_vertices: int) -> float:
        """Error of a level, mm, as `errors` has it."""
        return float(self.errors[self._n_collapses(n_vertices)])

    def distance_at(self, n_vertices: int, *, symmetric: bool = False) -> GeometricDistance:
        """Exact distance from the full surface's vertices to a level, mm."""
        return geometric_distance(self.mesh, self.mesh_at(n_vertices), symmetric=symmetric)

    def save(self, path: Path) -> None:
        """Write the sequence, its surface and its fields to an .npz file.

        Raises
        ------
        OutputError
            If the file cannot be written.
        """
        about = {
            "format": _FORMAT,
            "fields": [
                {"name": field.name, "unit": field.unit, "mm_per_unit": scale.mm_per_unit}
                for field, scale in zip(self.fields, self.scales, strict=True)
            ],
        }
        arrays: dict[str, Any] = {
            "about": np.array(json.dumps(about)),
            "vertices": self.mesh.vertices,
            "faces": self.mesh.faces.astype(np.int32),
            "kept": self.kept,
            "gone": self.gone,
            "places": self.places,
            "errors": self.errors,
        }
        for i, (field, scale) in enumerate(zip(self.fields, self.scales, strict=True)):
            arrays[f"values_{i}"], arrays[f"mean_{i}"] = field.values, scale.mean

        def fill(place: Path) -> None:
            with place.open("wb") as file:
                np.savez(file, **arrays)

        write_whole(path, fill)

    @classmethod
    def load(cls, path: Path) -> "CollapseSequence":
        """Read what `save` wrote.

        Raises
        ------
        InputError
            If the file cannot be opened.
        FormatError
            If it is not a collapse sequence.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                return cls._from(file.__getitem__)
        except OSError as fault:
            reason = fault.strerror or str(fault)
            raise InputError(f"{path}: cannot be read ({reason}): check the name") from fault
        except (KeyError, ValueError, TypeError, zipfile.BadZipFile) as fault:
            raise FormatError(
                f"{path}: is not a collapse sequence: simplify the surface again"
            ) from fault

    @classmethod
    def _from(cls, stored: Callable[[str], Any]) -> "CollapseSequence":
        about = json.loads(str(stored("about")))
        if about["format"] != _FORMAT:
            raise ValueError(about["format"])
        mesh = Mesh(stored("vertices"), stored("faces"))
        fields, scales = [], []
        for i, entry in enumerate(about["fields"]):
            fields.append(FieldMap(mesh, stored(f"values_{i}"), entry["name"], entry["unit"]))
            scales.append(FeatureScale(stored(f"mean_{i}"), entry["mm_per_unit"]))
        numbers = (stored(name) for name in ("kept", "gone", "places", "errors"))
        return cls(mesh, tuple(fields), tuple(scales), *numbers)

    def _n_collapses(self, n_vertices: int) -> int:
        if n_vertices < FEWEST_VERTICES:
            raise InputError(f"{n_vertices} vertices asked for: give {FEWEST_VERTICES} or more")
        if n_vertices < self.n_least:
            raise SurfaceError(
                f"no fewer than {self.n_least} vertices keep the surface's holes and handles "
                f"without folding it: ask for {self.n_least} or more"
            )
        return max(self.mesh.n_vertices - n_vertices, 0)

    def _stands_for(self, n_vertices: int) -> Integers:
        """Vertex that stands for each vertex of the full surface at a level, shape (n,)."""
        count = self._n_collapses(n_vertices)
        return _representatives(self.kept[:count], self.gone[:count], self.mesh.n_vertices)

    def _places_at(self, n_vertices: int) -> Floats:
        """Where the vertices of the full surface are when they are left, shape (n, d), mm."""
        count = self._n_collapses(n_vertices)
        places = np.zeros((self.mesh.n_vertices, self.places.shape[1]))
        places[:, :3] = self.mesh.vertices
        if self.fields:
            places[:, 3:] = self._lengths
        # Of several places of one vertex numpy keeps the last, which is the one that counts.
        places[self.kept[:count]] = self.places[:count]
        return places

    @cached_property
    def _lengths(self) -> Floats:
        return feature_lengths(self.mesh, self.fields, self.scales)

    def _sampled_share(self, field: FieldMap, stands_for: Integers) -> Floats:
        """Share of the area each vertex stands for that was sampled, shape (n,)."""
        areas = vertex_areas(self.mesh)
        whole = np.bincount(stands_for, weights=areas, minlength=len(areas))
        sampled = np.bincount(stands_for, weights=areas * field.sampled, minlength=len(areas))
        return np.divide(sampled, whole, out=np.ones_like(whole), where=whole > 0)


@compiled
def _representatives(kept: Integers, gone: Integers, n_vertices: int) -> Integers:
    """Follow the collapses backwards: whom the one that stayed stands under, the other does too."""
    stands_for = np.arange(n_vertices)
    for collapse in range(len(kept) - 1, -1, -1):
        stands_for[gone[collapse]] = stands_for[kept[collapse]]
    return stands_for
