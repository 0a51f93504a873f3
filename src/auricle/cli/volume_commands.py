"""Commands on a CT: the left atrium in it, and one made up with its truth.

Everything heavy is imported when a command runs, so that help comes at once.
"""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from auricle.cli.options import FolderOption, SeedOption, require_folder
from auricle.cli.volume_options import (
    AcceptOption,
    CutOption,
    DepthOption,
    LabelOption,
    LabelsOption,
    RegionOption,
    SeriesOption,
    cut_of,
    segmentation_config,
)
from auricle.cli.volume_steps import find_atrium

VolumeArgument = Annotated[
    Path,
    typer.Argument(
        metavar="VOLUME",
        help="DICOM folder, NIfTI, NRRD or MetaImage; contrast CT in HU, or a label map.",
        show_default=False,
    ),
]


def segment(
    volume: VolumeArgument,
    output: FolderOption,
    seed_point: Annotated[
        str | None,
        typer.Option(
            "--seed",
            "--seed-point",
            metavar="X,Y,Z",
            help="A place in the left atrium, mm, LPS. Default: found.",
            show_default=False,
        ),
    ] = None,
    roi: RegionOption = None,
    depth: DepthOption = 60.0,
    cut: CutOption = None,
    series: SeriesOption = None,
    labels: LabelsOption = None,
    label: LabelOption = None,
    lower: Annotated[
        float | None,
        typer.Option(
            metavar="HU", help="Where the surface lies. Default: half height.", show_default=False
        ),
    ] = None,
    upper: Annotated[
        float | None,
        typer.Option(metavar="HU", help="What is brighter is something else.", show_default=False),
    ] = None,
    vein_stub: Annotated[
        float, typer.Option(metavar="MM", help="Length of vein kept from its ostium.")
    ] = 12.0,
    spacing: Annotated[
        float | None,
        typer.Option(
            metavar="MM",
            help="Lattice of the surface. Default: half the voxels' size, 0.5 to 1.5.",
            show_default=False,
        ),
    ] = None,
    accept_warnings: AcceptOption = False,
) -> None:
    """The left atrium of a contrast CT, or of a label map: mask, closed surface, verdict.

    Writes report.html, mask.nrrd, surface.vtp (mm, LPS), result.json, figures and timings.json
    into DIR. A verdict of check ends with exit code 3 after writing, unless --accept-warnings.

    Example: `auricle segment scan/ -o atrium`
    """
    from auricle.cli.progress import progress_bars
    from auricle.report.segmentation_page import segmentation_answer

    require_folder(output)
    config = replace(
        segmentation_config(seed_point, roi, series, label),
        region_depth_mm=depth,
        lower_hu=lower,
        upper_hu=upper,
        vein_stub_mm=vein_stub,
        spacing_mm=spacing,
        cuts_mm=tuple(cut_of(text) for text in cut or ()),
    )
    with progress_bars() as progress:
        found = find_atrium(volume, output, config, labels=labels, progress=progress)
    typer.echo(segmentation_answer(found.case))
    typer.echo(str(found.page))
    found.require_accepted(accept_warnings)


def phantom(
    output: FolderOption,
    preset: Annotated[
        str,
        typer.Option(metavar="NAME", help="tiny, small, medium or clinical (512×512×250)."),
    ] = "small",
    seed: SeedOption = 1,
    case: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="What makes it hard: low_contrast, noisy, common_trunk, motion, truncated …",
        ),
    ] = "nominal",
    form: Annotated[str, typer.Option("--as", metavar="FORMAT", help="nrrd, nifti or dicom.")] = (
        "nrrd"
    ),
) -> None:
    """A generated contrast CT of a chest with a known left atrium, another patient a seed.

    Writes the volume, labels.nrrd, truth.vtp (mm, LPS) and truth.json into DIR.

    Example: `auricle phantom -o phantom --preset medium --seed 3 --as dicom`
    """
    from auricle.cli.progress import progress_bars
    from auricle.simulation.phantom import PhantomOptions
    from auricle.simulation.phantom import phantom as generated
    from auricle.simulation.phantom_options import hostile
    from auricle.study.phantom_files import image_name, write_phantom

    require_folder(output)
    image_name(form)
    options = hostile(case, PhantomOptions(preset=preset, seed=seed))
    with progress_bars() as progress:
        patient = generated(options, progress=progress)
        written = write_phantom(patient, output, form=form, progress=progress)
    shape = "×".join(map(str, patient.volume.shape))
    typer.echo(f"{shape} voxels, left atrium of {patient.mask.volume_ml:.1f} ml")
    typer.echo(str(written))
