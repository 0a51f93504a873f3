"""Surfaces kept for pictures: Figures 3 and 4 of one case, rounded and packed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from auricle.arrays import Floats, PerVertex
from auricle.errors import FormatError
from auricle.study.paper.features import Stage, rebuilt_maps
from auricle.study.paper.foci import Foci
from auricle.study.paper.packing import packed, unpacked
from auricle.study.paper.parameters import PaperParameters
from auricle.study.paper.thinned_features import thinned_maps
from auricle.surface.collapse_sequence import CollapseSequence
from auricle.surface.field import FieldMap
from auricle.surface.mesh import Mesh

STEP_MM = 0.01
STEP_OF_MAP = 0.005
PICTURED_FOCI = 2
"""Number of foci in the paper's Figure 4."""
WELL_APART = 2.5
"""Widths of the widest foci that the two shown lie apart, as nearly as a placement has it."""


@dataclass(frozen=True, eq=False)
class PicturedMap:
    """One focal map and what harmonics make of it.

    Attributes
    ----------
    size, sigma_mm, n_foci
        Which.
    values
        On the closed surface, shape (n,).
    rebuilt
        The same from the first harmonics, by their number.
    thinned
        Surface and map thinned out by Qslim with the map in the fourth component, by the number
        of points.
    """

    size: str
    sigma_mm: float
    n_foci: int
    values: PerVertex
    rebuilt: Mapping[int, PerVertex]
    thinned: Mapping[int, FieldMap]


@dataclass(frozen=True, eq=False)
class PicturedSurfaces:
    """What the pictures of a case show, to a hundredth of a millimetre.

    Attributes
    ----------
    original
        The closed surface, about its middle, mm.
    mha, qslim
        The same rebuilt from harmonics, and thinned out, by their number.
    maps
        Focal maps from small to wide.
    """

    original: Mesh
    mha: Mapping[int, Mesh]
    qslim: Mapping[int, Mesh]
    maps: tuple[PicturedMap, ...]


def kept_surfaces(
    stage: Stage,
    rebuilt: Mapping[int, Mesh],
    sequence: CollapseSequence,
    foci: Sequence[Foci],
    parameters: PaperParameters,
) -> dict[str, Any]:
    """Surfaces and maps of a case as JSON holds them; empty if none are to be kept."""
    if not parameters.surfaces_kept:
        return {}
    surface = stage.capped.mesh
    centre = surface.vertices.mean(axis=0)
    counts = [count for count in parameters.pictured_counts if count in rebuilt]
    points = [
        count
        for count in parameters.pictured_counts
        if sequence.n_least <= count < surface.n_vertices
    ]
    return {
        "original": _whole(surface, centre),
        "mha": {f"{count}": _mesh(rebuilt[count], centre) for count in counts},
        "qslim": {f"{count}": _whole(sequence.mesh_at(count), centre) for count in points},
        "maps": _maps(stage, foci, centre, parameters),
    }


def pictured_surfaces(document: Mapping[str, Any]) -> PicturedSurfaces:
    """The surfaces that `kept_surfaces` made a document of.

    Raises
    ------
    FormatError
        If none were kept, or the document is torn.
    """
    if not document:
        raise FormatError("no surfaces were kept: run the case with surfaces_kept = true")
    original = _unpacked_mesh(document["original"])
    return PicturedSurfaces(
        original=original,
        mha={
            int(count): Mesh(unpacked(each["vertices_mm"]), original.faces)
            for count, each in document["mha"].items()
        },
        qslim={int(count): _unpacked_mesh(each) for count, each in document["qslim"].items()},
        maps=tuple(
            PicturedMap(
                each["size"],
                each["sigma_mm"],
                each["n_foci"],
                unpacked(each["values"]),
                {int(count): unpacked(values) for count, values in each["rebuilt"].items()},
                {
                    int(count): FieldMap(
                        _unpacked_mesh(level), unpacked(level["values"]), each["size"]
                    )
                    for count, level in each["thinned"].items()
                },
            )
            for each in document["maps"]
        ),
    )


def _apart(foci: Foci) -> float:
    """Distance along the surface from the first focus to the second, mm; 0 for one focus."""
    if len(foci.distances_mm) < PICTURED_FOCI:
        return 0.0
    return float(foci.distances_mm[0][foci.distances_mm[1].argmin()])


def _mesh(mesh: Mesh, centre: Floats) -> dict[str, Any]:
    return {"vertices_mm": packed(mesh.vertices - centre, step=STEP_MM)}


def _whole(mesh: Mesh, centre: Floats) -> dict[str, Any]:
    return _mesh(mesh, centre) | {"faces": packed(mesh.faces.astype(np.float64))}


def _unpacked_mesh(document: Mapping[str, Any]) -> Mesh:
    return Mesh(unpacked(document["vertices_mm"]), unpacked(document["faces"]).astype(np.int64))


def _maps(
    stage: Stage, foci: Sequence[Foci], centre: Floats, parameters: PaperParameters
) -> list[dict[str, Any]]:
    """Maps of the paper's Figure 4: as many foci as there, or the nearest number there is."""
    if not parameters.focus_counts or not parameters.focus_widths_mm:
        return []
    n_foci = min(parameters.focus_counts, key=lambda count: abs(count - PICTURED_FOCI))
    shown = min(
        foci, key=lambda each: abs(_apart(each) - WELL_APART * parameters.focus_widths_mm[-1])
    )
    maps = np.column_stack([shown.map_of(n_foci, width) for width in parameters.focus_widths_mm])
    rebuilt = rebuilt_maps(stage.basis, maps, parameters.pictured_counts)
    return [
        {
            "size": size,
            "sigma_mm": width,
            "n_foci": n_foci,
            "values": packed(maps[:, column], step=STEP_OF_MAP),
            "rebuilt": {
                f"{count}": packed(values[:, column], step=STEP_OF_MAP)
                for count, values in rebuilt.items()
            },
            "thinned": {
                f"{count}": _whole(each.mesh, centre)
                | {"values": packed(each.values, step=STEP_OF_MAP)}
                for count, each in thinned_maps(
                    stage,
                    maps[:, column],
                    parameters.pictured_counts,
                    weight_mm=parameters.feature_weight_mm,
                ).items()
            },
        }
        for column, (size, width) in enumerate(
            zip(parameters.sizes, parameters.focus_widths_mm, strict=True)
        )
    ]
