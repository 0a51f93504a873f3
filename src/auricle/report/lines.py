"""Lines: how the signals of a case are told apart in a chart, with a legend that stays readable.

Up to fourteen curves share a chart, so that a legend with one entry each would hide it. Colour
tells what is mapped (the geometry, each field, the width of simulated foci), the dash how many
foci; the legend names the colours and the dashes once.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from auricle.report.labels import signal_label
from auricle.study.result import CaseResult, Signal

GEOMETRY_COLOUR = "#000000"
FIELD_COLOURS = ("#d55e00", "#009e73", "#cc79a7", "#e69f00")
"""Colours of measured fields; they differ for every kind of colour vision (Okabe and Ito)."""

DASHES = ("-", "--", ":", "-.")
"""Line styles of one, two, three … foci."""

ROW_OF_LETTERS = 84
"""Letters of three legend entries that fit side by side."""

Style = Mapping[str, Any]
"""Keyword arguments of a matplotlib line."""


def signals_of(result: CaseResult) -> tuple[Signal, ...]:
    """Every signal of a case, those drawn on top last: simulated, geometry, fields."""
    return (*result.simulated, result.geometry, *result.fields)


def line_style(signal: Signal, signals: Sequence[Signal]) -> Style:
    """Colour, dash and width of a signal's line among those of `signals`."""
    if signal.kind == "geometry":
        return {"color": GEOMETRY_COLOUR, "linestyle": "-", "linewidth": 1.6}
    if signal.kind == "field":
        return _field_style([each for each in signals if each.kind == "field"].index(signal))
    return {
        "color": _width_colour(_distinct(signals, "width_mm"), signal.details["width_mm"]),
        "linestyle": _dash(_distinct(signals, "n_foci").index(signal.details["n_foci"])),
        "linewidth": 1.1,
    }


def add_legend(
    figure: Figure, signals: Sequence[Signal], *, further: Sequence[Line2D] = ()
) -> None:
    """Put the legend below the chart, where it hides nothing.

    Parameters
    ----------
    figure
        The chart.
    signals
        What it shows, as given to `line_style`.
    further
        Entries for whatever else it shows.
    """
    handles = [*_entries(signals), *further]
    longest = sorted((len(str(handle.get_label())) for handle in handles), reverse=True)[:3]
    n_columns = 3 if sum(longest) <= ROW_OF_LETTERS else 2
    figure.legend(handles=handles, loc="outside lower center", ncols=n_columns, frameon=False)


def _entries(signals: Sequence[Signal]) -> Iterator[Line2D]:
    for signal in sorted(signals, key=lambda signal: signal.kind != "field"):
        if signal.kind != "simulated":
            yield _entry(signal_label(signal), line_style(signal, signals))
    widths, counts = _distinct(signals, "width_mm"), _distinct(signals, "n_foci")
    for width in widths:
        style = {"color": _width_colour(widths, width), "linewidth": 1.6}
        yield _entry(f"simulated foci, σ = {width:g} mm", style)
    for index, count in enumerate(counts):
        style = {"color": "#555555", "linestyle": _dash(index), "linewidth": 1.1}
        yield _entry("1 focus" if count == 1 else f"{count:g} foci", style)


def _entry(label: str, style: Style) -> Line2D:
    line = Line2D([], [], label=label)
    line.update(dict(style))
    return line


def _distinct(signals: Sequence[Signal], detail: str) -> list[float]:
    return sorted({signal.details[detail] for signal in signals if signal.kind == "simulated"})


def _field_style(index: int) -> Style:
    turn, colour = divmod(index, len(FIELD_COLOURS))
    return {"color": FIELD_COLOURS[colour], "linestyle": _dash(turn), "linewidth": 2.4}


def _width_colour(widths: Sequence[float], width: float) -> str:
    place = widths.index(width) / max(len(widths) - 1, 1)
    return mpl.colors.to_hex(mpl.colormaps["Blues"](1.0 - 0.5 * place))


def _dash(index: int) -> str:
    return DASHES[index % len(DASHES)]
