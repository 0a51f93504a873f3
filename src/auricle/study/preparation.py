"""Preparation: from a surface file to the chamber that samples are planned and maps rebuilt on."""

from dataclasses import dataclass
from pathlib import Path

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


def prepare(
    path: Path,
    *,
    n_vertices: int = N_VERTICES,
    n_modes: int = N_MODES,
    seed: int = 1,
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
    cleaned = clean(soup)
    if not path.is_file() or n_modes >= min(n_vertices, cleaned.mesh.n_vertices):
        raise InputError(
            f"{n_modes} harmonics of {cleaned.mesh.n_vertices} vertices: "
            "ask for fewer harmonics or give a finer surface"
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
        source=source_of(path),
        surface=surface,
        chamber=Chamber(capped.mesh, basis, capped.original),
        fields=fields,
        space=soup.space,
        as_read=cleaned.soundness,
        analyzed=soundness(surface),
        repairs=cleaned.repairs,
        remarks=tuple(remarks),
    )
