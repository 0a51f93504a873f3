"""Figures: the charts of a report, each from one result to one matplotlib figure."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from auricle.arrays import Floats
from auricle.report.lines import add_legend, line_style, signals_of
from auricle.sampling.criteria import SHARES
from auricle.spectral.power import Spectrum
from auricle.spectral.weyl import trusted_modes, weyl_wavelength
from auricle.study.result import CaseResult, Signal

WIDTH = 7.0
"""Width of a chart, inches: at 100 pixels an inch its text is as large as the page's."""

BANDS_PER_DECADE = 10
LEAST_SHARE = 1e-8
"""Shares of the power below this are rounding and are not shown."""

MARKED_SHARE = 0.90

_GUIDE = "#777777"
_STEPS = (1.0, 2.0, 5.0)
_WAVELENGTHS = tuple(factor * 10.0**decade for decade in range(-3, 4) for factor in _STEPS)
_ERROR_STYLES = (
    ("hausdorff_mm", "largest distance (Hausdorff)", "#d55e00", "^"),
    ("gd_percentile_95_mm", "95th percentile of the distance", "#cc79a7", "s"),
    ("rms_mm", "root mean square, vertex by vertex", "#009e73", "D"),
    ("gd_mean_mm", "mean geometric distance (GD)", "#0072b2", "o"),
)


def spectrum_figure(result: CaseResult) -> Figure:
    """Power against harmonic, the paper's Figures 1a and 5: geometry and fields above, foci below.

    Each line is the mean share of the varying power a harmonic holds, over bands of a tenth of a
    decade; behind the lines of geometry and fields stand the single harmonics.
    """
    panels = [(result.geometry, *result.fields)] + ([result.simulated] if result.simulated else [])
    figure = Figure(figsize=(WIDTH, 2.6 + 2.0 * len(panels)), layout="constrained")
    column = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    everything = signals_of(result)
    for axes, signals in zip(column, panels, strict=True):
        for signal in signals:
            style = line_style(signal, everything)
            axes.plot(*banded_shares(signal.spectrum), **style, label=signal.name)
            if signal.kind != "simulated":
                shares = _shares(signal.spectrum)
                index = np.arange(signal.spectrum.n_constant, len(shares)) + 1
                axes.plot(index, shares[index - 1], color=style["color"], lw=0.5, alpha=0.3)
        axes.set_yscale("log")
        low, high = axes.get_ylim()
        axes.set_ylim(max(low, 100 * LEAST_SHARE), high)
        axes.set_ylabel("share of power\nper harmonic (%)")
        _number_axis(axes, result)
    _name_number_axis(column[-1])
    _add_wavelengths(column[0], result)
    add_legend(figure, everything, further=_limit_entries(result))
    return figure


def banded_shares(spectrum: Spectrum) -> tuple[Floats, Floats]:
    """Mean share of the varying power a harmonic holds, by bands of neighbouring harmonics.

    Single powers scatter over decades; their mean over a band is what the spectrum's fall is
    read from.

    Returns
    -------
    harmonics, shares
        Geometric mean of each band's first and last harmonic, and the mean share in %.
    """
    first, n_modes = spectrum.n_constant + 1, len(spectrum.power)
    n_edges = int(np.ceil(BANDS_PER_DECADE * np.log10(max(n_modes / first, 1)))) + 2
    edges = np.unique(np.rint(np.geomspace(first, n_modes + 1, n_edges)).astype(int))
    cumulative = np.concatenate([[0.0], np.cumsum(_shares(spectrum))])
    shares = (cumulative[edges[1:] - 1] - cumulative[edges[:-1] - 1]) / np.diff(edges)
    return np.sqrt(edges[:-1] * (edges[1:] - 1.0)), shares


def _shares(spectrum: Spectrum) -> Floats:
    """Share of the varying power in each harmonic, %; the constant ones have none."""
    varying = np.where(np.arange(len(spectrum.power)) < spectrum.n_constant, 0.0, spectrum.power)
    shares: Floats = 100 * varying / spectrum.varying_total
    return shares


def cumulative_power_figure(result: CaseResult) -> Figure:
    """Share of the varying power in the first k harmonics, the paper's Figure 1b.

    The right axis reads the same heights as the error √(1 − share) of the best reconstruction.
    """
    figure = Figure(figsize=(WIDTH, 4.8), layout="constrained")
    axes = figure.subplots()
    signals = signals_of(result)
    for signal in signals:
        cumulative = 100 * signal.spectrum.cumulative()
        axes.plot(_counts(signal), cumulative, **line_style(signal, signals), label=signal.name)
    for share in SHARES:
        axes.axhline(100 * share, color=_GUIDE, linewidth=0.6, zorder=0)
    axes.set_ylim(0, 102)
    axes.set_yticks([0, 25, 50, 75, *(100 * share for share in SHARES)])
    axes.set_ylabel("share of the varying power (%)")
    _number_axis(axes, result)
    _name_number_axis(axes)
    _add_wavelengths(axes, result)
    right = axes.twinx()
    right.set_ylim(axes.get_ylim())
    ticks = axes.get_yticks()
    right.set_yticks(ticks, [f"{100 * np.sqrt(1 - tick / 100):.0f}" for tick in ticks])
    right.set_ylabel("best error √(1 − share) (% of the map's deviation)")
    add_legend(figure, signals, further=_limit_entries(result))
    return figure


def geometry_error_figure(result: CaseResult) -> Figure:
    """How far the rebuilt surface lies from the original, mm, against the number of harmonics."""
    figure = Figure(figsize=(WIDTH, 4.2), layout="constrained")
    axes = figure.subplots()
    counts = [error.n_modes for error in result.geometry_errors]
    for name, label, colour, marker in _ERROR_STYLES:
        errors = [getattr(error, name) for error in result.geometry_errors]
        axes.plot(counts, errors, color=colour, marker=marker, markersize=4, label=label)
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(subs=_STEPS))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_ylabel("distance to the original (mm)")
    _number_axis(axes, result, first=min(counts, default=1))
    _name_number_axis(axes)
    handles = [*axes.get_legend_handles_labels()[0], *_limit_entries(result)]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
    return figure


def field_error_figure(result: CaseResult) -> Figure:
    """Measured error of each map rebuilt from k harmonics; a dot where 90 % of the power is held.

    The horizontal lines are the errors √(1 − share) that the shares of the criteria promise.
    Errors below 1 % are not shown.
    """
    figure = Figure(figsize=(WIDTH, 4.8), layout="constrained")
    axes = figure.subplots()
    signals = signals_of(result)
    for signal in signals:
        style = line_style(signal, signals)
        errors = 100 * signal.nrmse
        axes.plot(_counts(signal), errors, **style, label=signal.name)
        for count in _marked_counts(signal):
            axes.plot(count, errors[count - 1], "o", color=style["color"], markersize=4.5)
    for share in SHARES:
        axes.axhline(100 * np.sqrt(1 - share), color=_GUIDE, linewidth=0.6, zorder=0)
    axes.set_yscale("log")
    axes.set_ylim(1, 120)
    ticks = [1, 2, 5, *(100 * np.sqrt(1 - share) for share in SHARES), 100]
    axes.set_yticks(ticks, [f"{tick:.0f}" for tick in ticks])
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_ylabel("measured error, nRMSE (% of the map's deviation)")
    _number_axis(axes, result)
    _name_number_axis(axes)
    _add_wavelengths(axes, result)
    dot = Line2D([], [], color=_GUIDE, marker="o", markersize=4.5, linestyle="none")
    dot.set_label(f"{MARKED_SHARE:.0%} of the power held")
    add_legend(figure, signals, further=[dot, *_limit_entries(result)])
    return figure


def _marked_counts(signal: Signal) -> list[int]:
    """The least number of harmonics that hold `MARKED_SHARE`, if those at hand do."""
    return [
        criterion.need.n_modes
        for criterion in signal.criteria
        if criterion.need and criterion.share == MARKED_SHARE and not criterion.with_constant
    ]


def _counts(signal: Signal) -> Floats:
    return np.arange(1.0, len(signal.spectrum.power) + 1)


def _number_axis(axes: Axes, result: CaseResult, *, first: int = 1) -> None:
    """Logarithmic axis of harmonics, grey where they are finer than the mesh can be trusted."""
    last = len(result.geometry.spectrum.power)
    axes.set_xscale("log")
    axes.set_xlim(first, max(last, first + 1))
    axes.xaxis.set_major_locator(LogLocator(subs=_STEPS))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.grid(color="#e4e4e4", linewidth=0.5)
    axes.set_axisbelow(True)
    trusted = trusted_modes(result.n_shell_vertices)
    if trusted < last:
        axes.axvspan(max(trusted, first), last, color="#eeeeee", zorder=-1)


def _name_number_axis(axes: Axes) -> None:
    axes.set_xlabel("harmonics k (number)")


def _limit_entries(result: CaseResult) -> list[Line2D]:
    """Legend entry for the harmonics beyond a twelfth of the vertices, where there are any."""
    if trusted_modes(result.n_shell_vertices) >= len(result.geometry.spectrum.power):
        return []
    block = Line2D([], [], color="#dddddd", linewidth=8)
    block.set_label("beyond a twelfth of the vertices")
    return [block]


def _add_wavelengths(axes: Axes, result: CaseResult) -> None:
    """Name on a second axis the wavelength, mm, of the harmonics below."""
    area, (first, last) = result.shell_area_mm2, axes.get_xlim()
    longest, shortest = (weyl_wavelength(round(k), area=area) for k in (first, last))
    lengths = [length for length in _WAVELENGTHS if shortest <= length <= longest]
    top = axes.twiny()
    top.set_xscale("log")
    top.set_xlim(first, last)
    top.set_xticks([np.pi * area / length**2 for length in lengths], [f"{x:g}" for x in lengths])
    top.minorticks_off()
    top.set_xlabel("wavelength (mm)")
