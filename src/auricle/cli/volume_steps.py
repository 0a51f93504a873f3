"""The step from a CT to the surface of its atrium, shared by `segment` and `analyze`."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from auricle.cli.options import about, echo_notes
from auricle.errors import InputError

if TYPE_CHECKING:
    from auricle.progress import Progress
    from auricle.study.segmented import SegmentationConfig, SegmentedCase


@dataclass(frozen=True, eq=False)
class FoundAtrium:
    """What a segmentation wrote.

    Attributes
    ----------
    path
        The input.
    case
        The segmentation.
    figures
        Its pictures, by file name.
    page, surface
        Its report and the file of its surface.
    """

    path: Path
    case: "SegmentedCase"
    figures: Mapping[str, bytes]
    page: Path
    surface: Path

    def require_accepted(self, accepted: bool) -> None:
        """Stop at a verdict of check unless someone has looked.

        Raises
        ------
        InputError
            If there is a reason for doubt and it is not accepted.
        """
        codes = dict.fromkeys(reason.code for reason in self.case.reasons if reason.stops)
        if codes and not accepted:
            raise InputError(
                f"{self.path}: verdict check ({', '.join(codes)}): look at {self.page}, then give "
                "--accept-warnings, or a seed and a region of interest"
            )


def find_atrium(
    path: Path,
    folder: Path,
    config: "SegmentationConfig",
    *,
    labels: Path | None,
    progress: "Progress",
) -> FoundAtrium:
    """Segment a CT, write everything about it into `folder` and tell what to know."""
    from auricle.report.segmentation_page import segmentation_figures, write_segmentation
    from auricle.study.segmented import segment_file

    with about(path, labels):
        case = segment_file(path, config, labels=labels, progress=progress)
        figures = segmentation_figures(case, progress=progress)
        page = write_segmentation(case, folder, figures=figures)
    echo_notes(case.endocardium.repairs, case.remarks)
    for reason in case.reasons:
        typer.echo(f"{'check' if reason.stops else 'note'}: {reason}", err=True)
    return FoundAtrium(path, case, figures, page, folder / "surface.vtp")
