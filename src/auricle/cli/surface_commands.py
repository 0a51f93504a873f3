"""Commands on a surface: its analysis, its harmonics, fewer vertices, one made up.

Everything heavy is imported when a command runs, so that help comes at once.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from auricle.cli.map_commands import ColumnOption, analyze_maps
from auricle.cli.options import (
    FileOption,
    FolderOption,
    SeedOption,
    SurfaceArgument,
    about,
    echo_notes,
    require_folder,
)
from auricle.cli.volume_options import (
    AcceptOption,
    LabelOption,
    LabelsOption,
    RegionOption,
    SeedPointOption,
    SeriesOption,
    segmentation_config,
)
from auricle.cli.volume_steps import FoundAtrium, find_atrium

if TYPE_CHECKING:
    from auricle.progress import Progress
    from auricle.study.config import AnalysisConfig
    from auricle.surface.soundness import Soundness


def analyze(
    surface: Annotated[
        Path,
        typer.Argument(
            metavar="SURFACE|CT|EXPORT",
            help="A surface (VTP, VTK, VTU, PLY, STL, OBJ, OFF, openCARP) with its fields; a "
            "contrast CT (DICOM folder, NIfTI, NRRD, MetaImage); or an export with mapping points "
            "(CARTO or EnSite folder or zip, OpenEP .mat, CSV).",
            show_default=False,
        ),
    ],
    output: FolderOption,
    field: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME", help="Field to analyse; repeatable. Default: all.", show_default=False
        ),
    ] = None,
    vertices: Annotated[
        int, typer.Option("--vertices", "-n", help="Vertices to simplify to.")
    ] = 10_000,
    modes: Annotated[
        int | None,
        typer.Option(
            "--modes",
            "-k",
            help="Harmonics to solve. Default: 1000, of an export 500.",
            show_default=False,
        ),
    ] = None,
    focus_width: Annotated[
        list[float] | None,
        typer.Option(
            metavar="MM",
            help="Width σ of simulated foci, mm; repeatable. Default: 4 8 16. Surfaces only.",
            show_default=False,
        ),
    ] = None,
    focus_count: Annotated[
        list[int] | None,
        typer.Option(
            metavar="N",
            help="Number of simulated foci; repeatable. Default: 1 2 3. Surfaces only.",
            show_default=False,
        ),
    ] = None,
    target: Annotated[
        float, typer.Option(metavar="SHARE", help="Error at which points are enough. Exports only.")
    ] = 0.1,
    cycle_length: Annotated[
        float | None,
        typer.Option(
            metavar="MS",
            help="Cycle length of a re-entry: activation wraps round. Exports only.",
            show_default=False,
        ),
    ] = None,
    low_voltage: Annotated[
        float, typer.Option(metavar="MV", help="Bipolar voltage of low-voltage area. Exports only.")
    ] = 0.5,
    max_distance: Annotated[
        float,
        typer.Option(metavar="MM", help="Farthest a point may lie off the surface. Exports only."),
    ] = 5.0,
    mapped_within: Annotated[
        float,
        typer.Option(metavar="MM", help="What is nearer to a point is mapped. Exports only."),
    ] = 10.0,
    column: ColumnOption = None,
    seed: SeedOption = 1,
    seed_point: SeedPointOption = None,
    roi: RegionOption = None,
    series: SeriesOption = None,
    labels: LabelsOption = None,
    label: LabelOption = None,
    accept_warnings: AcceptOption = False,
) -> None:
    """What a map needs or has: the whole analysis of a surface or of an export, and its report.

    Of a surface: how many points the maps on it need. Of a CT: the same, the left atrium found
    first, as `auricle segment` does, into DIR/segmentation. Of a mapping system's export: what
    its points say of each map, how sure that is, where they are too few and which were redundant.
    Writes report.html, result.json, figures and tables into DIR.

    Example: `auricle analyze atrium.vtp -o result -k 500`
    """
    from auricle.imaging.recognition import is_volume
    from auricle.study.exports import is_export

    require_folder(output)
    if not is_volume(surface) and any((seed_point, roi, series, labels, label, accept_warnings)):
        raise typer.BadParameter(f"{surface} is no CT: leave out the options of its segmentation")
    if is_export(surface) and not is_volume(surface):
        from auricle.study.map_study import MapStudyConfig

        with about(surface):
            maps = MapStudyConfig(
                fields=tuple(field or ()),
                target_nrmse=target,
                cycle_length_ms=cycle_length,
                max_distance_mm=max_distance,
                mapped_within_mm=mapped_within,
                low_voltage_mv=low_voltage,
                n_vertices=vertices,
                n_modes=modes or 500,
                seed=seed,
            )
        analyze_maps(surface, output, maps, column=column or [])
        return
    from auricle.cli.progress import progress_bars
    from auricle.study.config import AnalysisConfig

    defaults = AnalysisConfig()
    with about(surface):
        config = AnalysisConfig(
            n_vertices=vertices,
            n_modes=defaults.n_modes if modes is None else modes,
            fields=tuple(field or ()),
            focus_widths_mm=tuple(focus_width or defaults.focus_widths_mm),
            focus_counts=tuple(focus_count or defaults.focus_counts),
            seed=seed,
        )
    with progress_bars() as progress:
        scan = None
        if is_volume(surface):
            scan = find_atrium(
                surface,
                output / "segmentation",
                segmentation_config(seed_point, roi, series, label),
                labels=labels,
                progress=progress,
            )
            scan.require_accepted(accept_warnings)
        answer = _analyzed(surface, output, config, scan=scan, progress=progress)
    typer.echo(answer)


def _analyzed(
    path: Path,
    output: Path,
    config: "AnalysisConfig",
    *,
    scan: FoundAtrium | None,
    progress: "Progress",
) -> str:
    """Analyse a surface, write its report; returns the answer and where it is."""
    from auricle.report.answer import answer_sentence
    from auricle.report.bundle import write_report
    from auricle.study.case import analyze_surface

    surface = path if scan is None else scan.surface
    with about(surface):
        result = analyze_surface(surface, config, progress=progress)
        written = write_report(
            result,
            output,
            scan=None if scan is None else scan.case,
            scan_figures={} if scan is None else scan.figures,
            progress=progress,
        )
    echo_notes(result.repairs, result.remarks)
    return f"{answer_sentence(result)}\n{written}"


def harmonics(
    surface: SurfaceArgument,
    output: FolderOption,
    modes: Annotated[int, typer.Option("--modes", "-k", help="Harmonics to solve.")] = 500,
    cap: Annotated[
        bool, typer.Option(help="Close holes by caps first; else boundaries are free (Neumann).")
    ] = False,
    seed: SeedOption = 1,
) -> None:
    """Manifold harmonics of a surface as it is, with the certificate that none is missing.

    Writes harmonics.json (eigenvalues_per_mm2, zero_modes, certificate), modes.npy and areas.npy.

    Example: `auricle harmonics atrium.vtp -k 200 -o harmonics`
    """
    from auricle.cli.progress import progress_bars
    from auricle.spectral.harmonics import manifold_harmonics
    from auricle.study.provenance import source_of
    from auricle.study.store import write_harmonics
    from auricle.surface.capping import cap_holes
    from auricle.surface.cleaning import clean
    from auricle.surface.reading import read_surface
    from auricle.surface.soundness import zero_area_remark

    require_folder(output)
    with about(surface), progress_bars() as progress:
        progress("read and clean", 0, 1)
        cleaned = clean(read_surface(surface), check_scale=False, keep_pieces=True)
        progress("read and clean", 1, 1)
        mesh = cap_holes(cleaned.mesh).mesh if cap else cleaned.mesh
        basis = manifold_harmonics(mesh, modes, seed=seed, progress=progress)
        written = write_harmonics(
            basis,
            output,
            source=source_of(surface),
            parameters={"modes": modes, "cap": cap, "seed": seed},
        )
    found = cleaned.soundness
    echo_notes(cleaned.repairs, [zero_area_remark(found)] if found.n_zero_area_faces else [])
    certificate = basis.certificate
    typer.echo(
        f"{basis.n_modes} harmonics of {len(basis.areas):,} vertices, {basis.area / 100:.1f} cm²: "
        f"{certificate.n_zero_modes} constant, largest eigenvalue {basis.eigenvalues[-1]:.6g}/mm²"
    )
    typer.echo(
        f"certificate: {certificate.eigenvalues_below_gap} eigenvalues below "
        f"{certificate.gap_per_mm2:.6g}/mm² by inertia; residual "
        f"{certificate.largest_residual:.1e}, orthogonality "
        f"{certificate.largest_orthogonality_error:.1e}; {certificate.method}; "
        f"{len(certificate.retries)} searched again"
    )
    typer.echo(str(written))


def simplify(
    surface: SurfaceArgument,
    output: FileOption,
    vertices: Annotated[
        int, typer.Option("--vertices", "-n", help="Number of vertices to reach.")
    ] = 10_000,
    levels: Annotated[
        str,
        typer.Option(
            metavar="N,N,…",
            help="Several numbers of vertices instead, as in 50,500: FILE_50, FILE_500.",
            show_default=False,
        ),
    ] = "",
    field: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Field to carry over; repeatable. Default: all.",
            show_default=False,
        ),
    ] = None,
    feature_weight: Annotated[
        float | None,
        typer.Option(
            metavar="MM",
            help="Let the fields decide too, a standard deviation of each counting for MM.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Fewer vertices, the same shape and topology, the fields carried over.

    Example: `auricle simplify atrium.vtp -n 5000 -o small.vtp`
    """
    from auricle.cli.progress import progress_bars
    from auricle.study.simplified import simplify_file

    targets = {vertices: output}
    if levels:
        targets = {n: output.with_stem(f"{output.stem}_{n}") for n in _counts(levels)}
    with about(surface), progress_bars() as progress:
        outcome = simplify_file(
            surface,
            targets,
            fields=tuple(field or ()),
            feature_weight=feature_weight,
            progress=progress,
        )
    echo_notes(outcome.repairs)
    typer.echo(_measures("before", outcome.before))
    for level in outcome.levels:
        distance = level.distance
        typer.echo(_measures("after", level.soundness))
        typer.echo(
            f"distance to the simplified surface: mean {distance.mean:.4f} mm, "
            f"rms {distance.rms:.4f} mm, 95 % {distance.percentile_95:.4f} mm, "
            f"largest {distance.hausdorff:.4f} mm"
        )
        typer.echo(str(level.path))


def _counts(text: str) -> list[int]:
    """Numbers in a list with commas."""
    try:
        return [int(part) for part in text.split(",")]
    except ValueError as fault:
        raise typer.BadParameter(
            f"{text!r}: give whole numbers with commas between", param_hint="--levels"
        ) from fault


def _measures(when: str, found: "Soundness") -> str:
    volume = "open" if found.volume_mm3 is None else f"{found.volume_mm3 / 1000:.2f} ml"
    return (
        f"{when:>6}: {found.n_vertices:,} vertices, {found.area_mm2 / 100:.2f} cm², {volume}, "
        f"genus {found.genus}, {found.n_holes} holes"
    )


def atrium(
    output: FileOption,
    seed: SeedOption = 1,
    spacing: Annotated[
        float, typer.Option(min=0.3, max=3.0, help="Grid spacing of the generator, mm.")
    ] = 1.0,
) -> None:
    """A generated left atrium with four veins and an appendage, another one for every seed.

    Example: `auricle atrium --seed 3 -o atrium.vtp`
    """
    import numpy as np

    from auricle.simulation.atrium import AtriumShape
    from auricle.simulation.atrium import atrium as generated
    from auricle.surface.writing import write_surface

    mesh = generated(AtriumShape.random(np.random.default_rng(seed)), spacing=spacing)
    write_surface(output, mesh, space="LPS")
    typer.echo(f"{mesh.n_vertices:,} vertices, {mesh.area / 100:.1f} cm²")
    typer.echo(str(output))
