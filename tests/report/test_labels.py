"""Names from files in figures: never a formula, never a missing glyph, never too long."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from auricle.report.gallery import drawing_style
from auricle.report.labels import LONGEST, figure_text, signal_label, unit_of
from auricle.surface.field import FieldMap
from auricle.surface.shapes import icosphere

SPHERE = icosphere(radius=10.0, subdivisions=1)


@settings(max_examples=50, deadline=None)
@given(st.text())
def test_any_name_can_be_drawn_and_is_short(name):
    text = figure_text(name)
    assert 1 <= len(text.replace(r"\$", "$")) <= LONGEST
    with drawing_style():
        figure = Figure(figsize=(3, 1))
        figure.text(0.5, 0.5, text)
        FigureCanvasAgg(figure).draw()


@pytest.mark.parametrize("name", ["$\\frac", "$x$", "a$b", "\\$", "$$", "$\\undefined$"])
def test_a_formula_stays_text(name):
    figure = Figure()
    shown = figure.text(0.5, 0.5, figure_text(name))
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    assert not shown._preprocess_math(shown.get_text())[1]


def test_glyphs_the_font_lacks_are_marked():
    assert figure_text("電 map") == "\N{REPLACEMENT CHARACTER} map"


@pytest.mark.parametrize(
    ("name", "stated", "unit"),
    [
        ("local_activation_time", "", "ms, by its name"),
        ("LAT", "", "ms, by its name"),
        ("bipolar_voltage", "uV", "uV"),
        ("tawss", "", ""),
    ],
)
def test_a_unit_is_stated_or_said_to_be_implied(name, stated, unit):
    assert unit_of(FieldMap(SPHERE, SPHERE.vertices[:, 0], name, stated)) == unit


def test_a_field_is_called_by_its_words(case):
    assert signal_label(case.fields[0]) == "local activation time"
