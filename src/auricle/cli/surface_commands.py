"""Commands on a surface: its analysis, its harmonics, fewer vertices, one made up.

Everything heavy is imported when a command runs, so that help comes at once.
"""

from pathlib import Path
from typing import Annotated

import typer

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
from auricle.cli.volume_steps import find_atrium, is_volume


def analyze(
    surface: Annotated[
        Path,
        typer.Argument(
            metavar="SURFACE",
            help="VTP, VTK, VTU, PLY, STL, OBJ, OFF or openCARP .pts/.elem, in mm; or a contrast "
            "CT: DICOM folder, NIfTI, NRRD or MetaImage.",
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
    modes: Annotated[int, typer.Option("--modes", "-k", help="Harmonics to solve.")] = 1_000,
    focus_width: Annotated[
        list[float] | None,
        typer.Option(
            metavar="MM",
            help="Width σ of simulated foci, mm; repeatable. Default: 4 8 16.",
            show_default=False,
        ),
    ] = None,
    focus_count: Annotated[
        list[int] | None,
        typer.Option(
            metavar="N",
            help="Number of simulated foci; repeatable. Default: 1 2 3.",
            show_default=False,
        ),
    ] = None,
    seed: SeedOption = 1,
    seed_point: SeedPointOption = None,
    roi: RegionOption = None,
    series: SeriesOption = None,
    labels: LabelsOption = None,
    label: LabelOption = None,
    accept_warnings: AcceptOption = False,
) -> None:
    """How many points the maps on a surface need: the whole analysis and its report.

    Writes report.html, result.json, spectrum.csv, figures and timings.json into DIR. From a CT,
    the left atrium is found first, as `auricle segment` does, into DIR/segmentation; the last
    six options are for that.

    Example: `auricle analyze atrium.vtp -o result -k 500`
    """
    from auricle.cli.progress import progress_bars
    from auricle.report.answer import answer_sentence
    from auricle.report.bundle import write_report
    from auricle.study.case import analyze_surface
    from auricle.study.config import AnalysisConfig

    require_folder(output)
    defaults = AnalysisConfig()
    with progress_bars() as progress:
        with about(surface):
            config = AnalysisConfig(
                n_vertices=vertices,
                n_modes=modes,
                fields=tuple(field or ()),
                focus_widths_mm=tuple(focus_width or defaults.focus_widths_mm),
                focus_counts=tuple(focus_count or defaults.focus_counts),
                seed=seed,
            )
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
            surface = scan.surface
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
    typer.echo(answer_sentence(result))
    typer.echo(str(written))


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
    field: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Field to carry over; repeatable. Default: all.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Fewer vertices, the same shape and topology, the fields carried over.

    Example: `auricle simplify atrium.vtp -n 5000 -o small.vtp`
    """
    from auricle.cli.progress import progress_bars
    from auricle.study.simplified import simplify_file

    with about(surface), progress_bars() as progress:
        outcome = simplify_file(
            surface, output, n_vertices=vertices, fields=tuple(field or ()), progress=progress
        )
    echo_notes(outcome.repairs)
    for name, found in (("before", outcome.before), ("after", outcome.after)):
        volume = "open" if found.volume_mm3 is None else f"{found.volume_mm3 / 1000:.2f} ml"
        typer.echo(
            f"{name:>6}: {found.n_vertices:,} vertices, {found.area_mm2 / 100:.2f} cm², {volume}, "
            f"genus {found.genus}, {found.n_holes} holes"
        )
    distance = outcome.distance
    typer.echo(
        f"distance to the simplified surface: mean {distance.mean:.4f} mm, "
        f"rms {distance.rms:.4f} mm, 95 % {distance.percentile_95:.4f} mm, "
        f"largest {distance.hausdorff:.4f} mm"
    )
    typer.echo(str(output))


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
