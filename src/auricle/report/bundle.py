"""The folder a case leaves behind: report, figures, spectrum, result, written whole."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from auricle.atomic import write_bytes, write_text
from auricle.progress import Progress, silent
from auricle.report.gallery import figure_files
from auricle.report.page import report_page
from auricle.report.segmentation_page import segmentation_context
from auricle.report.tables import spectrum_csv
from auricle.study.result import CaseResult
from auricle.study.segmented import SegmentedCase
from auricle.study.segmented_store import segmentation_document
from auricle.study.store import json_text, result_document
from auricle.surface.writing import write_surface


def write_report(
    result: CaseResult,
    folder: Path,
    *,
    scan: SegmentedCase | None = None,
    scan_figures: Mapping[str, bytes] = MappingProxyType({}),
    progress: Progress = silent,
) -> Path:
    """Write everything known about a case into `folder`; returns the report's path.

    ``report.html`` alone is complete; beside it stand ``figures/``, ``spectrum.csv``,
    ``surface.vtp`` (the surface analysed, with its fields), ``timings.json`` and, last of all,
    ``result.json``, whose presence says the folder is whole.

    Parameters
    ----------
    result
        The case.
    folder
        Where to.
    scan, scan_figures
        The CT the surface was found in, if it was, and the pictures of that; they enter the
        report and the result.
    progress
        Told how many figures are drawn.

    Raises
    ------
    OutputError
        If the folder cannot be written.
    """
    figures = figure_files(result, progress=progress)
    told = None if scan is None else segmentation_context(scan, scan_figures)
    page = report_page(result, figures, scan=told)
    found = {} if scan is None else {"segmentation": segmentation_document(scan)}
    document = json_text(result_document(result) | found)
    for name, content in figures.items():
        write_bytes(folder / "figures" / name, content)
    write_text(folder / "spectrum.csv", spectrum_csv(result))
    fields = [signal.field for signal in result.fields]
    write_surface(folder / "surface.vtp", result.surface, fields, space=result.space)
    write_text(folder / "report.html", page)
    write_text(folder / "timings.json", json_text({"wall_s": dict(result.seconds)}))
    write_text(folder / "result.json", document)
    return folder / "report.html"
