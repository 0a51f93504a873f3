"""The folder a case leaves behind: report, figures, spectrum, result, written whole."""

from pathlib import Path

from auricle.atomic import write_bytes, write_text
from auricle.progress import Progress, silent
from auricle.report.gallery import figure_files
from auricle.report.page import report_page
from auricle.report.tables import spectrum_csv
from auricle.study.result import CaseResult
from auricle.study.store import json_text, result_document


def write_report(result: CaseResult, folder: Path, *, progress: Progress = silent) -> Path:
    """Write everything known about a case into `folder`; returns the report's path.

    ``report.html`` alone is complete; beside it stand ``figures/``, ``spectrum.csv``,
    ``timings.json`` and, last of all, ``result.json``, whose presence says the folder is whole.

    Raises
    ------
    OutputError
        If the folder cannot be written.
    """
    figures = figure_files(result, progress=progress)
    page = report_page(result, figures)
    document = json_text(result_document(result))
    for name, content in figures.items():
        write_bytes(folder / "figures" / name, content)
    write_text(folder / "spectrum.csv", spectrum_csv(result))
    write_text(folder / "report.html", page)
    write_text(folder / "timings.json", json_text({"wall_s": dict(result.seconds)}))
    write_text(folder / "result.json", document)
    return folder / "report.html"
