"""Names and numbers as people read them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.report.wording import field_words, number, percent, printable

plain = st.floats(min_value=1e-2, max_value=1e8)


@given(plain, st.integers(1, 6))
def test_a_number_reads_back_to_the_digits_shown(value, digits):
    shown = float(number(value, digits=digits).replace(",", ""))
    assert shown == pytest.approx(value, rel=0.5001 * 10.0 ** (1 - digits))


@given(plain)
def test_a_number_keeps_its_order_of_size_and_its_sign(value):
    assert number(-value) == "−" + number(value)


@pytest.mark.parametrize(
    ("value", "text"),
    [(99.96, "100"), (0.09996, "0.1"), (1234.5, "1,230"), (9.999e8, "1e+09"), (math.inf, "–")],
)
def test_rounding_up_to_a_new_digit_leaves_no_trailing_ones(value, text):
    assert number(value) == text


def test_percent_never_claims_all_where_a_digit_would_show_the_rest():
    assert percent(0.996) == "99.6 %"
    assert percent(0.9) == "90 %"


@given(st.text(max_size=200))
def test_a_field_s_name_is_short_printable_and_never_empty(name):
    words = field_words(name)
    assert words.isprintable()
    assert 0 < len(words) <= 60


@given(st.text(alphabet=st.characters(codec="utf-8", exclude_categories=["C", "Z"]), max_size=50))
def test_ordinary_text_stays_as_it_is(text):
    assert printable(text) == text
