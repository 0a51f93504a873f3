"""Simplification of one file: read, clean, simplify, carry the fields over, compare, write."""

from dataclasses import dataclass
from pathlib import Path

from auricle.errors import InputError
from auricle.progress import Progress, silent
from auricle.surface.cleaning import Repair, clean
from auricle.surface.distance import GeometricDistance, geometric_distance
from auricle.surface.field import FieldMap
from auricle.surface.reading import read_surface
from auricle.surface.simplification import simplify
from auricle.surface.soundness import Soundness, soundness
from auricle.surface.transfer import transfer
from auricle.surface.writing import write_surface


@dataclass(frozen=True)
class SimplifiedFile:
    """What simplification did to a file.

    Attributes
    ----------
    before, after
        Soundness of the cleaned and of the simplified surface.
    distance
        From the cleaned surface's vertices to the simplified surface, mm.
    repairs
        What cleaning changed first.
    """

    before: Soundness
    after: Soundness
    distance: GeometricDistance
    repairs: tuple[Repair, ...]


def simplify_file(
    path: Path,
    output: Path,
    *,
    n_vertices: int,
    fields: tuple[str, ...] = (),
    progress: Progress = silent,
) -> SimplifiedFile:
    """Write the surface of `path` with exactly `n_vertices` vertices to `output`.

    Fields named, or all without names, are carried over by closest point. A surface that has no
    more vertices than asked for is written as it is.

    Raises
    ------
    InputError
        If the file cannot be read, has no such field, or its topology needs more vertices.
    OutputError
        If `output` cannot be written.
    """
    progress("simplify", 0, 3)
    soup = read_surface(path)
    cleaned = clean(soup)
    carried = [field for field in cleaned.fields if not fields or field.name in fields]
    missing = sorted(set(fields) - {field.name for field in carried})
    if missing:
        raise InputError(f"no field named {missing[0]!r}: leave it out")
    progress("simplify", 1, 3)
    mesh = simplify(cleaned.mesh, n_vertices)
    progress("simplify", 2, 3)
    on_simplified: list[FieldMap] = [transfer(field, mesh) for field in carried]
    distance = geometric_distance(cleaned.mesh, mesh)
    write_surface(output, mesh, on_simplified, space=soup.space)
    progress("simplify", 3, 3)
    return SimplifiedFile(cleaned.soundness, soundness(mesh), distance, cleaned.repairs)
