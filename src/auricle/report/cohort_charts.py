"""Charts of a cohort: the paper's Figures 1, 2 and 5, and what goes beyond them."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from auricle.arrays import Floats
from auricle.report.labels import figure_text
from auricle.report.wording import percent
from auricle.study.paper.printed import DECAYS, GEOMETRY
from auricle.study.paper.surfaces import PICTURED_FOCI
from auricle.study.paper.tables import PRINTED_SHARES, READINGS, Values, taus

WIDTH = 9.0
"""Width of a chart, inches: a report's page shows it at about its own size."""

METHOD_COLOURS = {"mha": "#0072b2", "qslim": "#d55e00"}
METHOD_NAMES = {"mha": "harmonics (MHA)", "qslim": "points left (Qslim)"}
WAY_STYLES = {
    "harmonics": ("harmonics", "#0072b2", "-"),
    "points_with_feature": ("points, Qslim with the map in R⁴", "#d55e00", "-"),
    "points": ("points, Qslim of the geometry", "#8a6d3b", "--"),
}
"""Name, colour and line of each way to recover a map, as `thinned_features.WAYS` has them."""
AXIS_COLOURS = {"x": "#0072b2", "y": "#d55e00", "z": "#009e73"}
SIZE_COLOURS = ("#08306b", "#2f7fbc", "#e69f00", "#cc79a7")
_PAPER = "#b00000"
_GUIDE = "#777777"
_BANDS_PER_DECADE = 10
_NARROW = (1.0, 3.0)
"""Labelled numbers in a decade where three panels stand side by side."""
_LAST_SHOWN = 500
"""The paper: coefficients beyond were not shown "because of their extremely low power"."""
_UNITS = {"GD": "mm", "MSE": "mm²"}
_PANEL_NAMES = {"GD": "GD: mean distance from the original", "MSE": "MSE: mean squared error"}


def geometry_spectra_figure(documents: Sequence[Values], example: Values) -> Figure:
    """Figure 1: (a) coefficients of x, y and z of one atrium, (b) accumulated power of all."""
    figure = Figure(figsize=(WIDTH, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    for axis, values in example["geometry"]["coefficients_mm"].items():
        shown = np.abs(np.array(values[1:_LAST_SHOWN]))
        left.plot(np.arange(2, len(shown) + 2), shown, color=AXIS_COLOURS[axis], lw=0.6, label=axis)
    left.set_yscale("log")
    left.set_ylim(1e-4, 100)
    _number_axis(left, 2, _LAST_SHOWN)
    left.set_xlabel("harmonic k (number)")
    left.set_ylabel("size of the coefficient (mm, root mean square)")
    left.set_title(f"(a) {figure_text(str(example.get('case', example['name'])))}")
    left.legend(frameon=False, title="coordinate", loc="lower left")
    for document in documents:
        shares = 100 * np.array(document["geometry"]["accumulated_share"])
        right.plot(np.arange(1, len(shares) + 1), shares, color="#0072b2", lw=0.8, alpha=0.6)
    n_modes = max(len(each["geometry"]["accumulated_share"]) for each in documents)
    printed = [100 * share for share in PRINTED_SHARES]
    right.plot(GEOMETRY, printed, "x", color=_PAPER, ms=8, mew=2)
    for count, share, below in zip(GEOMETRY, printed, (-18, 8), strict=True):
        right.annotate(
            f"printed: {count}", (count, share), xytext=(0, below), textcoords="offset points",
            ha="right", color=_PAPER, fontsize="small",
        )  # fmt: skip
    for share in printed:
        right.axhline(share, color=_GUIDE, lw=0.6, zorder=0)
    right.set_ylim(0, 102)
    right.set_yticks([0, 25, 50, 75, *printed, 100])
    _number_axis(right, 1, max(n_modes, *GEOMETRY))
    right.set_xlabel("harmonics k (number)")
    right.set_ylabel("accumulated power without the constant (%)")
    right.set_title(f"(b) all {len(documents)} atria")
    return figure


def quality_figure(documents: Sequence[Values]) -> Figure:
    """Figure 2: mean GD (a) and MSE (b) over the cases, by number of coefficients or points.

    The bands are one standard deviation over cases; single cases are thin lines.
    """
    figure = Figure(figsize=(WIDTH, 4.4), layout="constrained")
    headline = {error: reading for error, reading in reversed(READINGS)}
    for letter, axes, error in zip("ab", figure.subplots(1, 2), ("GD", "MSE"), strict=True):
        for method, colour in METHOD_COLOURS.items():
            curves = [
                (
                    document["quality"][method]["counts"],
                    document["quality"][method][headline[error]],
                )
                for document in documents
            ]
            for counts, errors in curves:
                axes.plot(counts, errors, color=colour, lw=0.5, alpha=0.35)
            counts, mean, deviation = _mean_curve(curves)
            axes.fill_between(
                counts,
                np.maximum(mean - deviation, mean / 50),
                mean + deviation,
                color=colour,
                alpha=0.15,
                lw=0,
            )
            axes.plot(counts, mean, "o-", color=colour, ms=3, label=METHOD_NAMES[method])
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        _number_axis(axes, 10, max(max(counts) for counts, _ in curves))
        axes.set_xlabel("coefficients or points (number)")
        axes.set_ylabel(f"{_PANEL_NAMES[error]} ({_UNITS[error]})")
        axes.set_title(f"({letter}) {error}")
        axes.legend(frameon=False)
    return figure


def tau_figure(documents: Sequence[Values]) -> Figure:
    """τ of every case under both methods, and what the paper prints beside it."""
    figure = Figure(figsize=(WIDTH, 3.8), layout="constrained")
    headline = {error: reading for error, reading in reversed(READINGS)}
    for axes, error in zip(figure.subplots(1, 2), ("GD", "MSE"), strict=True):
        found = taus(documents, headline[error], "even", with_floor=False)
        for pair in zip(found["mha"], found["qslim"], strict=True):
            if None not in pair:
                axes.plot([0, 1], pair, "o-", color=_GUIDE, ms=4, lw=0.8, alpha=0.7)
        for place, method in enumerate(METHOD_COLOURS):
            known = [value for value in found[method] if value is not None]
            ours = np.mean(known) if known else np.nan
            spread = np.std(known, ddof=1) if len(known) > 1 else 0.0
            axes.errorbar(
                place + (-0.12, 0.12)[place], ours, yerr=spread, fmt="s", capsize=4,
                color=METHOD_COLOURS[method], ms=7,
            )  # fmt: skip
            mean, deviation = DECAYS[error, method]
            axes.errorbar(
                place + (-0.24, 0.24)[place], mean, yerr=deviation, fmt="x", capsize=4,
                color=_PAPER, ms=8, mew=2,
            )  # fmt: skip
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.set_xlim(-0.5, 1.5)
        axes.set_xticks([0, 1], [METHOD_NAMES["mha"], METHOD_NAMES["qslim"]])
        axes.set_ylabel("decay constant τ (harmonics or points)")
        axes.set_title(error)
        axes.grid(axis="y", color="#e4e4e4", lw=0.5)
    handles = [
        Line2D([], [], color=_GUIDE, marker="o", ms=4, label="one atrium"),
        Line2D([], [], color="#333333", marker="s", ls="none", label="mean ± deviation here"),
        Line2D(
            [], [], color=_PAPER, marker="x", mew=2, ls="none", label="mean ± deviation printed"
        ),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    return figure


def feature_spectra_figure(documents: Sequence[Values]) -> Figure:
    """Figure 5: share of the power of focal maps by harmonic, a panel for each number of foci.

    Lines are means over placements and cases, over bands of a tenth of a decade.
    """
    kinds = [(each["n_foci"], each["size"], each["sigma_mm"]) for each in documents[0]["features"]]
    foci = sorted({n_foci for n_foci, _, _ in kinds})
    sizes = list(dict.fromkeys((size, sigma) for _, size, sigma in kinds))
    figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
    row = figure.subplots(1, max(len(foci), 1), sharey=True, squeeze=False)[0]
    for axes, n_foci in zip(row, foci, strict=True):
        for number, (size, sigma) in enumerate(sizes):
            spectra = [
                np.array(each["share_by_harmonic"])
                for document in documents
                for each in document["features"]
                if (each["n_foci"], each["size"]) == (n_foci, size)
            ]
            n_modes = min(len(each) for each in spectra)
            mean = 100 * np.mean([each[:n_modes] for each in spectra], axis=0)
            axes.plot(
                *banded(mean),
                color=SIZE_COLOURS[number % len(SIZE_COLOURS)],
                lw=1.8,
                label=f"{size}, σ = {sigma:g} mm",
            )
        axes.set_yscale("log")
        axes.set_ylim(1e-5, 50)
        _number_axis(axes, 2, n_modes, steps=_NARROW)
        axes.set_xlabel("harmonic k (number)")
        axes.set_title("1 focus" if n_foci == 1 else f"{n_foci} foci")
    row[0].set_ylabel("share of power per harmonic (%)")
    handles, labels = row[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(sizes), frameon=False)
    return figure


def feature_error_figure(documents: Sequence[Values]) -> Figure:
    """Error of the focal maps by number of harmonics or points, a panel for each size.

    Lines are geometric means over cases, the bands one standard deviation of the logarithm, for
    the number of foci of the paper's Figure 4 or the nearest there is.
    """
    records = documents[0]["thinned_features"]
    n_foci = min({each["n_foci"] for each in records}, key=lambda n: abs(n - PICTURED_FOCI))
    places = [place for place, each in enumerate(records) if each["n_foci"] == n_foci]
    figure = Figure(figsize=(WIDTH, 3.8), layout="constrained")
    row = figure.subplots(1, len(places), sharey=True, squeeze=False)[0]
    left = 100 * (1 - documents[0]["parameters"]["shares"][-1]) ** 0.5
    for axes, place in zip(row, places, strict=True):
        for way, (name, colour, line) in WAY_STYLES.items():
            found = [document["thinned_features"][place] for document in documents]
            curves = [(each["counts"], each["nrmse"][way]) for each in found]
            counts, mean, deviation = _mean_curve([(at, np.log(errors)) for at, errors in curves])
            low, middle, high = (100 * np.exp(mean + by * deviation) for by in (-1, 0, 1))
            axes.fill_between(counts, low, high, color=colour, alpha=0.15, lw=0)
            axes.plot(counts, middle, f"o{line}", color=colour, ms=3, label=name)
        axes.axhline(left, color=_GUIDE, lw=0.8, ls=":")
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.yaxis.set_minor_formatter(NullFormatter())
        _number_axis(axes, counts[0], counts[-1], steps=_NARROW)
        axes.set_xlabel("harmonics or points (number)")
        axes.set_title(f"{records[place]['size']}, σ = {records[place]['sigma_mm']:g} mm")
    row[0].set_ylabel("error of the map (% of its standard deviation)")
    handles, labels = row[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    figure.suptitle("1 focus" if n_foci == 1 else f"{n_foci} foci", fontsize="medium")
    return figure


def width_figure(documents: Sequence[Values]) -> Figure:
    """Counts for one focus against its width, each case at its own area, beside the closed form.

    Counts are put for a surface of the mean area: k scales with it.
    """
    figure = Figure(figsize=(WIDTH, 4.2), layout="constrained")
    axes = figure.subplots()
    area = float(np.mean([document["shell"]["area_mm2"] for document in documents]))
    shares = [f"{share:g}" for share in documents[0]["parameters"]["shares"]]
    widths = [each["sigma_mm"] for each in documents[0]["beyond"]["width_curve"]]
    for share, colour in zip(shares, SIZE_COLOURS, strict=False):
        closed = [-area * np.log1p(-float(share)) / (4 * np.pi * w**2) for w in widths]
        axes.plot(widths, closed, color=colour, lw=1.2, ls="--")
        for document in documents:
            scale = area / document["shell"]["area_mm2"]
            curve = document["beyond"]["width_curve"]
            found = [[k for k in each["counts"][share] if k is not None] for each in curve]
            low, middle, high = (
                np.array([_at(counts, q) - 1 for counts in found]) * scale for q in (0.0, 0.5, 1.0)
            )
            axes.errorbar(
                widths, middle, yerr=[middle - low, high - middle], fmt="o", ms=3, lw=0.6,
                color=colour, alpha=0.6,
            )  # fmt: skip
    axes.set_yscale("log")
    axes.set_xscale("log")
    axes.set_xticks(widths, [f"{w:g}" for w in widths])
    axes.minorticks_off()
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.set_xlabel("width σ of the focus (mm)")
    axes.set_ylabel(f"harmonics without the constant,\nfor {area / 100:.0f} cm² (number)")
    axes.grid(color="#e4e4e4", lw=0.5)
    handles = [
        Line2D(
            [],
            [],
            color=colour,
            marker="o",
            ls="none",
            label=f"{percent(float(share))} of the power",
        )
        for share, colour in zip(shares, SIZE_COLOURS, strict=False)
    ]
    handles.append(Line2D([], [], color=_GUIDE, ls="--", label="closed form −A·ln(1 − p)/(4πσ²)"))
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    return figure


def banded(shares: Floats) -> tuple[Floats, Floats]:
    """Mean over bands of a tenth of a decade of what each harmonic from the second on holds.

    Returns
    -------
    harmonics, means
        Geometric mean of each band's ends, and the mean in it.
    """
    n_modes = len(shares)
    n_edges = int(np.ceil(_BANDS_PER_DECADE * np.log10(n_modes / 2))) + 2
    edges = np.unique(np.rint(np.geomspace(2, n_modes + 1, n_edges)).astype(int))
    sums = np.concatenate([[0.0], np.cumsum(shares)])
    means = (sums[edges[1:] - 1] - sums[edges[:-1] - 1]) / np.diff(edges)
    return np.sqrt(edges[:-1] * (edges[1:] - 1.0)), means


def _mean_curve(
    curves: Sequence[tuple[Sequence[float], Sequence[float] | Floats]],
) -> tuple[Floats, ...]:
    """Counts that all cases have, with mean and deviation over them."""
    common = sorted(set.intersection(*(set(counts) for counts, _ in curves)))
    table = np.array([[errors[counts.index(k)] for k in common] for counts, errors in curves])
    deviation = table.std(axis=0, ddof=1) if len(curves) > 1 else np.zeros(len(common))
    return np.array(common), table.mean(axis=0), deviation


def _at(counts: Sequence[float], quantile: float) -> float:
    return float(np.quantile(counts, quantile)) if counts else float("nan")


def _number_axis(
    axes: Axes, first: float, last: float, *, steps: Sequence[float] = (1.0, 2.0, 5.0)
) -> None:
    axes.set_xscale("log")
    axes.set_xlim(first, max(last, first + 1))
    axes.xaxis.set_major_locator(LogLocator(subs=steps))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.grid(color="#e4e4e4", linewidth=0.5)
    axes.set_axisbelow(True)
