"""The charts: what is drawn is what was computed, and every axis says what it is."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from auricle.report.figures import (
    banded_shares,
    cumulative_power_figure,
    field_error_figure,
    geometry_error_figure,
    spectrum_figure,
)
from auricle.report.gallery import drawing_style
from auricle.report.lines import line_style, signals_of
from auricle.spectral.power import Spectrum
from auricle.spectral.weyl import weyl_wavelength

pytestmark = pytest.mark.usefixtures("style")

CHARTS = (spectrum_figure, cumulative_power_figure, geometry_error_figure, field_error_figure)


@pytest.fixture
def style():
    with drawing_style():
        yield


def line(figure: Figure, label: str):
    """The curve a chart draws for a signal."""
    (found,) = [one for axes in figure.axes for one in axes.lines if one.get_label() == label]
    return found


@pytest.mark.parametrize("chart", CHARTS)
def test_every_axis_names_its_quantity_and_unit(case, chart):
    figure = chart(case)
    names = {axes.get_ylabel() for axes in figure.axes} | {
        axes.get_xlabel() for axes in figure.axes
    }
    names.discard("")
    assert "harmonics k (number)" in names
    assert all(name.endswith(")") for name in names), names
    if chart is not geometry_error_figure:
        assert "wavelength (mm)" in names


@pytest.mark.parametrize("chart", CHARTS)
def test_the_legend_hides_no_data(case, chart):
    figure = chart(case)
    FigureCanvasAgg(figure).draw()
    (legend,) = figure.legends
    place = legend.get_window_extent()
    assert not any(place.overlaps(axes.get_window_extent()) for axes in figure.axes)
    assert place.x0 >= 0
    assert place.x1 <= figure.bbox.width


def test_the_cumulative_curves_are_the_spectra(case):
    figure = cumulative_power_figure(case)
    for signal in signals_of(case):
        counts, shares = line(figure, signal.name).get_data()
        np.testing.assert_array_equal(counts, np.arange(1, len(signal.spectrum.power) + 1))
        np.testing.assert_allclose(shares, 100 * signal.spectrum.cumulative())


def test_the_right_axis_reads_a_share_as_its_error(case):
    left, *others = cumulative_power_figure(case).axes
    (right,) = [axes for axes in others if "error" in axes.get_ylabel()]
    assert right.get_ylim() == left.get_ylim()
    read = dict(
        zip(right.get_yticks(), [t.get_text() for t in right.get_yticklabels()], strict=True)
    )
    assert (read[0.0], read[90.0], read[99.0]) == ("100", "32", "10")


def test_the_error_curves_are_the_measured_errors_and_the_dots_the_criteria(case):
    figure = field_error_figure(case)
    axes = figure.axes[0]
    for signal in signals_of(case):
        np.testing.assert_allclose(line(figure, signal.name).get_ydata(), 100 * signal.nrmse)
    dots = {tuple(one.get_xdata()) for one in axes.lines if one.get_marker() == "o"}
    needs = {
        (criterion.need.n_modes,)
        for signal in signals_of(case)
        for criterion in signal.criteria
        if criterion.need and criterion.share == 0.90 and not criterion.with_constant
    }
    assert dots == needs
    assert needs


def test_the_geometry_errors_are_drawn_as_they_are(case):
    axes = geometry_error_figure(case).axes[0]
    drawn = {one.get_label(): one.get_data() for one in axes.lines}
    counts, means = drawn["mean geometric distance (GD)"]
    assert list(counts) == [error.n_modes for error in case.geometry_errors]
    assert list(means) == [error.gd_mean_mm for error in case.geometry_errors]
    largest = drawn["largest distance (Hausdorff)"][1]
    assert list(largest) == [error.hausdorff_mm for error in case.geometry_errors]


def test_banded_shares_lose_no_power():
    power = np.random.default_rng(3).exponential(size=500)
    spectrum = Spectrum(np.arange(500.0), power, varying_total=2 * power[1:].sum())
    centres, shares = banded_shares(spectrum)
    assert (np.diff(centres) > 0).all()
    widths = np.array([round(width) for width in _widths(centres, first=2)])
    assert widths.sum() == 499
    assert (shares * widths).sum() == pytest.approx(50.0)


def _widths(centres, *, first):
    """Number of harmonics of each band, from the geometric means of its ends."""
    for centre in centres:
        last = round(centre**2 / first)
        yield last - first + 1
        first = last + 1


def test_banded_shares_of_a_power_law_lie_on_it():
    index = np.arange(1.0, 1001.0)
    spectrum = Spectrum(index - 1, index**-2.0, varying_total=float((index[1:] ** -2.0).sum()))
    centres, shares = banded_shares(spectrum)
    law = 100 * centres**-2.0 / spectrum.varying_total
    np.testing.assert_allclose(shares, law, rtol=0.02)


def test_the_top_axis_is_the_wavelength_of_the_harmonic_below(case):
    bottom, top = field_error_figure(case).axes
    assert top.get_xlim() == bottom.get_xlim()
    for place, label in zip(top.get_xticks(), top.get_xticklabels(), strict=True):
        length = weyl_wavelength(1, area=case.shell_area_mm2) / np.sqrt(place)
        assert length == pytest.approx(float(label.get_text()))


def test_harmonics_beyond_a_twelfth_of_the_vertices_are_marked(case):
    def entries(result):
        (legend,) = field_error_figure(result).legends
        return {text.get_text() for text in legend.get_texts()}

    mark = "beyond a twelfth of the vertices"
    assert mark in entries(case)
    assert mark not in entries(replace(case, n_shell_vertices=12 * 80))


def test_the_legend_groups_the_simulated_maps(case):
    (legend,) = cumulative_power_figure(case).legends
    entries = [text.get_text() for text in legend.get_texts()]
    assert len(entries) == len(set(entries)) == 1 + 2 + 2 + 2 + 1
    assert {"Geometry (x, y, z)", "local activation time", "1 focus", "2 foci"} <= set(entries)


def test_no_two_curves_look_alike(case):
    signals = signals_of(case)
    looks = {
        (style["color"], style["linestyle"]) for style in (line_style(s, signals) for s in signals)
    }
    assert len(looks) == len(signals)


def test_a_field_named_like_another_signal_has_a_look_of_its_own(case):
    alike = replace(case.fields[0], name="geometry")
    signals = (case.geometry, alike)
    assert line_style(alike, signals)["color"] != line_style(case.geometry, signals)["color"]


def test_lines_stand_out_from_white(case):
    for signal in signals_of(case):
        parts = np.array(to_rgb(line_style(signal, signals_of(case))["color"]))
        linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
        assert 1.05 / (linear @ [0.2126, 0.7152, 0.0722] + 0.05) > 2.3


@pytest.mark.parametrize("chart", CHARTS)
def test_a_case_without_maps_is_drawn_too(case, chart):
    bare = replace(case, fields=(), simulated=())
    FigureCanvasAgg(chart(bare)).draw()
