"""The gallery: every figure of a report as the bytes of a file, the same bytes every time."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from io import BytesIO
from types import MappingProxyType
from typing import Any

from matplotlib import rc_context, style
from matplotlib.figure import Figure

from auricle.progress import Progress, silent
from auricle.report.figures import (
    cumulative_power_figure,
    field_error_figure,
    geometry_error_figure,
    spectrum_figure,
)
from auricle.report.pictures import (
    RESOLUTION,
    fields_picture,
    foci_picture,
    reconstruction_picture,
)
from auricle.study.result import CaseResult

_STYLE: Mapping[str, Any] = MappingProxyType(
    {
        "font.family": "DejaVu Sans",
        "font.size": 9.0,
        "legend.fontsize": 8.0,
        "svg.fonttype": "path",
        "svg.hashsalt": "auricle",
        "path.simplify_threshold": 0.2,
    }
)
"""Fonts that come with matplotlib, drawn as outlines: the same on every machine."""


@contextmanager
def drawing_style() -> Iterator[None]:
    """Draw as a report does, whatever the user's own settings of matplotlib are."""
    with style.context("default"), rc_context(dict[Any, Any](_STYLE)):
        yield


def figure_files(result: CaseResult, *, progress: Progress = silent) -> dict[str, bytes]:
    """Draw every figure of a case.

    Parameters
    ----------
    result
        The case.
    progress
        Told how many figures are drawn.

    Returns
    -------
    dict
        File name → content. ``spectrum.svg``, ``cumulative_power.svg``, ``geometry_error.svg``,
        ``field_error.svg``, ``surface_reconstruction.png``; ``fields.png`` if the surface came
        with maps and ``foci.png`` if some were simulated. No dates, no random identifiers: one
        result gives the same bytes always.
    """
    wanted: dict[str, Callable[[CaseResult], Figure]] = {
        "spectrum.svg": spectrum_figure,
        "cumulative_power.svg": cumulative_power_figure,
        "geometry_error.svg": geometry_error_figure,
        "field_error.svg": field_error_figure,
        "surface_reconstruction.png": reconstruction_picture,
    }
    if result.fields:
        wanted["fields.png"] = fields_picture
    if result.simulated:
        wanted["foci.png"] = foci_picture
    return drawn_files({name: partial(draw, result) for name, draw in wanted.items()}, progress)


def drawn_files(
    wanted: Mapping[str, Callable[[], Figure]], progress: Progress = silent
) -> dict[str, bytes]:
    """Draw figures in a report's style; file name (`.svg` or `.png`) → content, always the same."""
    files = {}
    for done, (name, draw) in enumerate(wanted.items()):
        progress("figures", done, len(wanted))
        with drawing_style():
            files[name] = _content(draw(), name)
    progress("figures", len(wanted), len(wanted))
    return files


def _content(figure: Figure, name: str) -> bytes:
    file = BytesIO()
    if name.endswith(".svg"):
        figure.savefig(file, format="svg", metadata={"Date": None, "Creator": None})
    else:
        figure.savefig(file, format="png", dpi=RESOLUTION, metadata={"Software": None})
    return file.getvalue()
