"""The main job on one surface: from a file to how many points its maps need."""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from auricle.arrays import PerVertex, Points, read_only
from auricle.errors import InputError
from auricle.progress import Progress, silent
from auricle.simulation.foci import focal_map, gaussian_modes_for_power, random_foci
from auricle.spectral.harmonics import Harmonics, manifold_harmonics
from auricle.study.clock import Clock
from auricle.study.config import AnalysisConfig
from auricle.study.fields import chosen_fields
from auricle.study.provenance import source_of, versions
from auricle.study.result import CaseResult, GeometryError, Signal
from auricle.study.signals import analyzed_signal
from auricle.surface.capping import CappedSurface, cap_holes
from auricle.surface.cleaning import CleanSurface, clean
from auricle.surface.distance import geometric_distance, vertexwise_rms
from auricle.surface.field import FieldMap
from auricle.surface.filling import extend_over_caps
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.simplification import simplify
from auricle.surface.soundness import soundness, zero_area_remark
from auricle.surface.transfer import transfer

GEOMETRY_COUNTS = (5, 10, 20, 50, 100, 150, 250, 350, 500, 700, 1000, 1500, 2000)
"""Numbers of harmonics at which the rebuilt surface is compared with the original."""

PICTURED_COUNTS = (50, 250, 500)
"""Numbers of harmonics whose surface is shown, as in the paper's Figure 3."""


@dataclass(frozen=True, eq=False)
class _Analysis:
    """What every map of one case is analysed on."""

    capped: CappedSurface
    surface: Mesh
    basis: Harmonics


def analyze_surface(
    path: Path, config: AnalysisConfig | None = None, *, progress: Progress = silent
) -> CaseResult:
    """The main job: how many harmonics, and points, the maps on a surface need.

    Read and clean → simplify → close the holes → manifold harmonics → spectra of the geometry,
    of every field on the surface and of simulated foci → criteria, errors in mm.

    Parameters
    ----------
    path
        A surface file (VTP, VTK, VTU, PLY, STL, OBJ, OFF, openCARP).
    config
        The parameters; the defaults follow the paper.
    progress
        Told the stages and how far they are.

    Raises
    ------
    InputError
        If the file or the surface in it cannot be analysed.
    SolverError
        If the harmonics miss their certificate.
    """
    config = config or AnalysisConfig()
    clock = Clock(progress)
    with clock.stage("read and clean"):
        source = source_of(path) if path.is_file() else None
        soup = read_surface(path)
        cleaned = clean(soup)
        fields, remarks = chosen_fields(cleaned.fields, config.fields)
    if source is None or config.n_modes >= min(config.n_vertices, cleaned.mesh.n_vertices):
        raise InputError(
            f"{config.n_modes} harmonics of {cleaned.mesh.n_vertices} vertices: "
            "ask for fewer harmonics or give a finer surface"
        )
    with clock.stage("simplify"):
        surface = simplify(cleaned.mesh, config.n_vertices)
        fields = tuple(transfer(each, surface) for each in fields)
        deviation = geometric_distance(cleaned.mesh, surface).mean
    with clock.stage("close holes"):
        capped = cap_holes(surface)
    with clock.stage("harmonics"):
        basis = manifold_harmonics(capped.mesh, config.n_modes, seed=config.seed, progress=progress)
    analysis = _Analysis(capped, surface, basis)
    with clock.stage("geometry"):
        geometry = _geometry_signal(analysis)
        rebuilt = _reconstructions(analysis, (*GEOMETRY_COUNTS, *PICTURED_COUNTS, basis.n_modes))
        errors = tuple(
            _geometry_error(analysis, count, rebuilt[count]) for count in sorted(rebuilt)
        )
    with clock.stage("fields"):
        measured = tuple(_field_signal(analysis, each) for each in fields)
    with clock.stage("simulated foci"):
        simulated = tuple(_simulated_signals(analysis, config, progress))
    return CaseResult(
        source=source,
        config=config,
        original=cleaned.soundness,
        repairs=cleaned.repairs,
        remarks=(*soup.remarks, *remarks, *_remarks(cleaned, analysis, measured)),
        surface=surface,
        analyzed=soundness(surface),
        simplification_gd_mm=deviation,
        shell_area_mm2=basis.area,
        cap_areas_mm2=capped.cap_areas,
        n_shell_vertices=capped.mesh.n_vertices,
        laplacian=basis.laplacian,
        certificate=basis.certificate,
        geometry=geometry,
        fields=measured,
        simulated=simulated,
        geometry_errors=errors,
        reconstructions={k: rebuilt[k] for k in PICTURED_COUNTS if k in rebuilt},
        versions=versions(),
        seconds=clock.seconds,
        space=soup.space,
    )


def _geometry_signal(analysis: _Analysis) -> Signal:
    positions = analysis.capped.mesh.vertices
    return analyzed_signal(
        analysis.basis,
        field=FieldMap(analysis.surface, analysis.surface.vertices, "geometry", "mm"),
        on_shell=positions,
        kind="geometry",
        title="Geometry (x, y, z)",
    )


def _reconstructions(analysis: _Analysis, counts: tuple[int, ...]) -> dict[int, Points]:
    """Positions of the real surface's vertices rebuilt from the first harmonics, by count, mm."""
    basis, n = analysis.basis, analysis.surface.n_vertices
    centre = analysis.surface.vertices.mean(axis=0)
    coefficients = basis.transform(analysis.capped.mesh.vertices - centre)
    return {
        count: read_only(basis.inverse(coefficients[:count])[:n] + centre, np.float64)
        for count in counts
        if count <= basis.n_modes
    }


def _geometry_error(analysis: _Analysis, count: int, positions: Points) -> GeometryError:
    surface = analysis.surface
    areas = analysis.basis.areas[: surface.n_vertices]
    rebuilt = Mesh(positions, surface.faces)
    there = geometric_distance(rebuilt, surface)
    both = geometric_distance(rebuilt, surface, symmetric=True)
    return GeometryError(
        n_modes=count,
        rms_mm=vertexwise_rms(positions, surface.vertices, areas),
        gd_mean_mm=there.mean,
        gd_percentile_95_mm=there.percentile_95,
        hausdorff_mm=both.hausdorff,
    )


def _field_signal(analysis: _Analysis, known: FieldMap) -> Signal:
    return analyzed_signal(
        analysis.basis,
        field=known,
        on_shell=extend_over_caps(analysis.capped, known).values,
        kind="field",
        title=known.name,
    )


def _simulated_signals(
    analysis: _Analysis, config: AnalysisConfig, progress: Progress
) -> Iterator[Signal]:
    """Focal maps of every number and width, at places drawn from the seed."""
    shell, n = analysis.capped.mesh, analysis.surface.n_vertices
    most = max(config.focus_counts, default=0)
    centres = random_foci(
        shell,
        count=most,
        separation=0.5 * np.sqrt(shell.area / max(most, 1)),
        rng=np.random.default_rng(config.seed),
        allowed=np.arange(shell.n_vertices) < n,
    )
    bumps = _bumps(shell, centres, config.focus_widths_mm, progress)
    for count, width in itertools.product(config.focus_counts, config.focus_widths_mm):
        on_shell = np.sum(bumps[width][:count], axis=0)
        foci = "1 focus" if count == 1 else f"{count} foci"
        yield analyzed_signal(
            analysis.basis,
            field=FieldMap(analysis.surface, on_shell[:n], f"foci_{count}_width_{width:g}_mm"),
            on_shell=on_shell,
            kind="simulated",
            title=f"{foci}, σ = {width:g} mm",
            details={
                "n_foci": count,
                "width_mm": width,
                "expected_modes_90": gaussian_modes_for_power(
                    area=shell.area, width=width, share=0.90
                ),
            },
        )


def _bumps(
    shell: Mesh, centres: Sequence[int], widths: Sequence[float], progress: Progress
) -> dict[float, list[PerVertex]]:
    """A bump of every width around every centre: what the maps of several foci are sums of."""
    bumps: dict[float, list[PerVertex]] = {width: [] for width in widths}
    for done, (width, centre) in enumerate(itertools.product(widths, centres)):
        progress("simulated foci", done, len(widths) * len(centres))
        bumps[width].append(focal_map(shell, centres=[centre], width=width).values)
    return bumps


def _remarks(
    cleaned: CleanSurface, analysis: _Analysis, measured: tuple[Signal, ...]
) -> Iterator[str]:
    """What of the analysis itself the reader of the result should know."""
    if analysis.surface is cleaned.mesh:
        yield f"the surface has {cleaned.mesh.n_vertices} vertices and was not simplified"
    if cleaned.soundness.n_zero_area_faces:
        yield zero_area_remark(cleaned.soundness)
    if analysis.capped.cap_areas:
        share = sum(analysis.capped.cap_areas) / analysis.basis.area
        yield (
            f"{len(analysis.capped.cap_areas)} holes were closed by caps, {share:.1%} of the "
            "shell's area; errors and recommended points are for the real surface"
        )
    if analysis.basis.laplacian != "cotangent":
        yield (
            f"triangles as poor as quality {soundness(analysis.capped.mesh).smallest_quality:.2g} "
            "made the intrinsic Delaunay Laplacian necessary"
        )
    for signal in measured:
        if signal.unsampled_share:
            yield (
                f"{signal.name}: {signal.unsampled_share:.1%} of the area holds no value and was "
                "filled smoothly for the transform; errors are measured on the rest"
            )
