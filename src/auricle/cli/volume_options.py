"""Options of the commands that take a CT, and how places in it are written."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from auricle.study.segmented import Place, SegmentationConfig

SeedPointOption = Annotated[
    str | None,
    typer.Option(
        "--seed-point",
        metavar="X,Y,Z",
        help="A place in the left atrium, mm, LPS. Default: found.",
        show_default=False,
    ),
]
RegionOption = Annotated[
    str | None,
    typer.Option(
        "--roi",
        metavar="X,Y,Z:X,Y,Z[:…]",
        help="Where to look, mm, LPS: two corners of a box, or three and more of a polygon drawn "
        "on a slice.",
        show_default=False,
    ),
]
DepthOption = Annotated[
    float, typer.Option(metavar="MM", help="How far a polygon reaches to either side of its slice.")
]
CutOption = Annotated[
    list[str] | None,
    typer.Option(
        "--cut",
        metavar="X,Y,Z,[NX,NY,NZ,]R",
        help="Where blood is not followed, mm, LPS: a ball, or with a normal a disc; repeatable.",
        show_default=False,
    ),
]
SeriesOption = Annotated[
    int | None,
    typer.Option(metavar="N", help="Which series of a DICOM folder, from 1.", show_default=False),
]
LabelsOption = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", help="Label map that holds the atrium already.", show_default=False
    ),
]
LabelOption = Annotated[
    list[int] | None,
    typer.Option(
        metavar="N",
        help="Number of the atrium in the label map; repeatable. Without --labels, in VOLUME.",
        show_default=False,
    ),
]
AcceptOption = Annotated[
    bool,
    typer.Option("--accept-warnings", help="Go on with a verdict of check; someone has looked."),
]


def place_of(text: str, option: str) -> "Place":
    """The coordinates in ``X,Y,Z``.

    Raises
    ------
    typer.BadParameter
        If they are not three numbers.
    """
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError as fault:
        raise typer.BadParameter(f"{text!r}: give X,Y,Z in mm", param_hint=option) from fault
    return x, y, z


def region_of(text: str) -> tuple["Place", ...]:
    """The corners in ``X,Y,Z:X,Y,Z…``.

    Raises
    ------
    typer.BadParameter
        If there is one corner only, or one is not three numbers.
    """
    corners = tuple(place_of(part, "--roi") for part in text.split(":"))
    if len(corners) < 2:
        raise typer.BadParameter(f"{text!r}: give two corners or more", param_hint="--roi")
    return corners


def cut_of(text: str) -> tuple[float, ...]:
    """The numbers of a ball or a disc.

    Raises
    ------
    typer.BadParameter
        If they are not four or seven numbers.
    """
    try:
        cut = tuple(float(part) for part in text.split(","))
    except ValueError:
        cut = ()
    if len(cut) not in (4, 7):
        raise typer.BadParameter(
            f"{text!r}: give X,Y,Z,R or X,Y,Z,NX,NY,NZ,R in mm", param_hint="--cut"
        )
    return cut


def segmentation_config(
    seed_point: str | None, roi: str | None, series: int | None, label: list[int] | None
) -> "SegmentationConfig":
    """The parameters as the user wrote them."""
    from auricle.study.segmented import SegmentationConfig

    return SegmentationConfig(
        seed_mm=None if seed_point is None else place_of(seed_point, "--seed-point"),
        region_mm=() if roi is None else region_of(roi),
        series=series,
        label=tuple(label or ()),
    )
