"""Preparation: from a surface file to the chamber that samples are planned and maps rebuilt on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from auricle.arrays import Truths
from auricle.errors import InputError
from auricle.progress import Progress, silent
from auricle.sampling.chamber import Chamber
from auricle.study.basis_cache import cached_harmonics
from auricle.study.provenance import source_of
from auricle.study.result import Source
from auricle.surface.capping import cap_holes
from auricle.surface.cleaning import Repair, clean
from auricle.surface.distance import geometric_distance
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.simplification import simplify
from auricle.surface.soundness import Soundness, soundness, zero_area_remark
from auricle.surface.soup import TriangleSoup
from auricle.surface.transfer import transfer

N_VERTICES = 10_000
N_MODES = 500


@dataclass(frozen=True, eq=False)
class PreparedSurface:
    """A chamber and the file it comes from.

    Attributes
    ----------
    source
        The file.
    surface
        The real surface after cleaning and simplification, with its holes.
    chamber
        The surface closed, with its harmonics; the vertices of `surface` come first in it.
    fields
        Fields of the file, on `surface`.
    space
        Frame of the positions, as the file states it.
    as_read, analyzed
        Soundness of the cleaned and of the simplified surface.
    repairs, remarks
        What cleaning changed, and what else the reader of a result should know.
    """

    source: Source
    surface: Mesh
    chamber: Chamber
    fields: tuple[FieldMap, ...]
    space: str
    as_read: Soundness
    analyzed: Soundness
    repairs: tuple[Repair, ...]
    remarks: tuple[str, ...]

    def field(self, name: str) -> FieldMap:
        """The field of this name.

        Raises
        ------
        InputError
            If there is none, or it holds more than a number a vertex.
        """
        return _scalar(self.fields, name)

    def allowed_by(self, forbidding: str) -> Truths:
        """Vertices of the chamber where a field is 0 or NaN, caps included, shape (n,).

        Raises
        ------
        InputError
            As `field`, or if that leaves no vertex.
        """
        values = np.nan_to_num(self.field(forbidding).values)
        allowed = np.ones(self.chamber.mesh.n_vertices, dtype=np.bool_)
        allowed[: len(values)] = values == 0
        if not (allowed & self.chamber.accessible).any():
            raise InputError(f"field {forbidding!r} forbids all of the surface: give another")
        return allowed


def prepare(
    path: Path,
    *,
    n_vertices: int = N_VERTICES,
    n_modes: int = N_MODES,
    seed: int = 1,
    needed: Sequence[str] = (),
    progress: Progress = silent,
) -> PreparedSurface:
    """Read, clean, simplify and close a surface, and solve for its harmonics.

    Parameters
    ----------
    path
        A surface file.
    n_vertices
        Vertices to simplify to.
    n_modes
        Harmonics to solve for, the constant one included.
    seed
        Of the eigensolver.
    needed
        Names of fields without which to stop before the harmonics are solved for.
    progress
        Told the stages.

    Raises
    ------
    InputError
        If the file or the surface in it cannot be used.
    SolverError
        If the harmonics miss their certificate.
    """
    progress("prepare surface", 0, 3)
    soup = read_surface(path)
    for name in needed:
        _require_scalar({each: values.ndim for each, values in soup.point_fields.items()}, name)
    return prepare_soup(
        soup,
        source_of(path),
        n_vertices=n_vertices,
        n_modes=n_modes,
        seed=seed,
        progress=progress,
    )


def prepare_soup(
    soup: TriangleSoup,
    source: Source,
    *,
    n_vertices: int = N_VERTICES,
    n_modes: int = N_MODES,
    seed: int = 1,
    progress: Progress = silent,
) -> PreparedSurface:
    """As `prepare`, of triangles that have been read already.

    Parameters
    ----------
    soup
        The triangles and the fields on them.
    source
        Where they come from.
    n_vertices, n_modes, seed, progress
        As `prepare`.

    Raises
    ------
    InputError
        If the surface cannot be used.
    SolverError
        If the harmonics miss their certificate.
    """
    progress("prepare surface", 0, 3)
    cleaned = clean(soup)
    n_left = min(n_vertices, cleaned.mesh.n_vertices)
    if not 2 <= n_modes < n_left:
        raise InputError(
            f"{n_modes} harmonics of {n_left} vertices: ask for at least 2, and for fewer than "
            "there are vertices"
        )
    progress("prepare surface", 1, 3)
    surface = simplify(cleaned.mesh, n_vertices)
    fields = tuple(transfer(each, surface) for each in cleaned.fields)
    progress("prepare surface", 2, 3)
    capped = cap_holes(surface)
    progress("prepare surface", 3, 3)
    basis = cached_harmonics(capped.mesh, n_modes, seed=seed, progress=progress)
    remarks = list(soup.remarks)
    if cleaned.soundness.n_zero_area_faces:
        remarks.append(zero_area_remark(cleaned.soundness))
    if surface is not cleaned.mesh:
        deviation = geometric_distance(cleaned.mesh, surface).mean
        remarks.append(
            f"simplified from {cleaned.mesh.n_vertices:,} to {surface.n_vertices:,} vertices, "
            f"mean distance {deviation:.3f} mm"
        )
    if capped.cap_areas:
        share = sum(capped.cap_areas) / basis.area
        remarks.append(
            f"{len(capped.cap_areas)} holes were closed by caps, {share:.1%} of the closed "
            "surface's area; points and errors are for the real surface"
        )
    return PreparedSurface(
        source=source,
        surface=surface,
        chamber=Chamber(capped.mesh, basis, capped.original),
        fields=fields,
        space=soup.space,
        as_read=cleaned.soundness,
        analyzed=soundness(surface),
        repairs=cleaned.repairs,
        remarks=tuple(remarks),
    )


def _scalar(fields: Sequence[FieldMap], name: str) -> FieldMap:
    _require_scalar({each.name: each.values.ndim for each in fields}, name)
    return next(each for each in fields if each.name == name)


def _require_scalar(dimensions: Mapping[str, int], name: str) -> None:
    """Refuse a name that is of no field, or of one with more than a number a vertex."""
    if name not in dimensions:
        have = ", ".join(sorted(dimensions)) or "none"
        raise InputError(f"no field named {name!r}: the surface has {have}")
    if dimensions[name] != 1:
        raise InputError(f"field {name!r} is a vector: choose one number a vertex")
