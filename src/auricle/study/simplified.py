"""Simplification of one file: read, clean, simplify, carry the fields over, compare, write."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from auricle.errors import InputError
from auricle.progress import Progress, silent
from auricle.surface.cleaning import CleanSurface, Repair, clean
from auricle.surface.collapse_sequence import CollapseSequence
from auricle.surface.distance import GeometricDistance
from auricle.surface.field import FieldMap
from auricle.surface.reading import read_surface
from auricle.surface.simplification import simplification_sequence
from auricle.surface.soundness import Soundness, soundness
from auricle.surface.transfer import transfer
from auricle.surface.writing import write_surface


@dataclass(frozen=True)
class SimplifiedLevel:
    """One simplified surface on disk.

    Attributes
    ----------
    path
        Where it was written.
    soundness
        Its counts and measures.
    distance
        From the cleaned surface's vertices to it, mm.
    """

    path: Path
    soundness: Soundness
    distance: GeometricDistance


@dataclass(frozen=True)
class SimplifiedFile:
    """What simplification did to a file.

    Attributes
    ----------
    before
        Soundness of the cleaned surface.
    levels
        The surfaces written, in the order asked for.
    repairs
        What cleaning changed first.
    """

    before: Soundness
    levels: tuple[SimplifiedLevel, ...]
    repairs: tuple[Repair, ...]


def simplify_file(
    path: Path,
    targets: Mapping[int, Path],
    *,
    fields: tuple[str, ...] = (),
    feature_weight: float | None = None,
    progress: Progress = silent,
) -> SimplifiedFile:
    """Write the surface of `path` with exactly so many vertices to each target, in one pass.

    Parameters
    ----------
    path
        Any surface file.
    targets
        File to write by number of vertices. A surface that has no more is written as it is.
    fields
        Names of the fields to carry over, by closest point; all without names.
    feature_weight
        If given, the fields carried over also decide which vertices stay, a standard deviation
        of each counting for so many mm (`simplify_with_fields`).
    progress
        Told what is done.

    Raises
    ------
    InputError
        If the file cannot be read, has no such field, or none for the weight to count for; if
        fewer than 4 vertices are asked for, or the weight is not positive.
    SurfaceError
        If the surface cannot be cleaned, or its topology needs more vertices.
    OutputError
        If a target cannot be written. With any other error, none is.
    """
    n_steps = 2 + len(targets)
    progress("simplify", 0, n_steps)
    soup = read_surface(path)
    cleaned = clean(soup)
    carried = _named(cleaned, fields)
    if feature_weight is not None and not carried:
        raise InputError("no field that a feature weight could count for: leave the weight out")
    progress("simplify", 1, n_steps)
    sequence = (
        simplification_sequence(cleaned.mesh)
        if feature_weight is None
        else simplification_sequence(cleaned.mesh, fields=carried, weight=feature_weight)
    )
    sequence.mesh_at(min(targets))
    progress("simplify", 2, n_steps)
    levels = []
    for n_vertices, target in targets.items():
        levels.append(_written(sequence, n_vertices, target, carried, soup.space))
        progress("simplify", 2 + len(levels), n_steps)
    return SimplifiedFile(cleaned.soundness, tuple(levels), cleaned.repairs)


def _named(cleaned: CleanSurface, names: tuple[str, ...]) -> tuple[FieldMap, ...]:
    carried = tuple(field for field in cleaned.fields if not names or field.name in names)
    missing = sorted(set(names) - {field.name for field in carried})
    if missing:
        raise InputError(f"no field named {missing[0]!r}: leave it out")
    return carried


def _written(
    sequence: CollapseSequence,
    n_vertices: int,
    target: Path,
    carried: tuple[FieldMap, ...],
    space: str,
) -> SimplifiedLevel:
    if sequence.fields:
        level = sequence.fields_at(n_vertices)
        mesh = level[0].mesh
    else:
        mesh = sequence.mesh_at(n_vertices)
        level = tuple(transfer(field, mesh) for field in carried)
    write_surface(target, mesh, list(level), space=space)
    return SimplifiedLevel(target, soundness(mesh), sequence.distance_at(n_vertices))
