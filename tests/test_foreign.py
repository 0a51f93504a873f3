import pytest

from auricle.errors import FormatError
from auricle.foreign import count_of, damaged, printable, require_bytes, shown


@pytest.mark.parametrize("word", ["", "-1", "1.5", "1e3", "0x10", "1" * 16, b"\xff"])
def test_what_counts_nothing_is_no_count(word):
    with pytest.raises(FormatError, match="as its number of things: the file is damaged"):
        count_of(word, "things")


def test_a_promise_may_fill_the_rest_of_a_file_and_no_more():
    require_bytes("two", needed=2, left=2)
    with pytest.raises(FormatError, match="announces two, so 2 bytes or more, with 1 bytes left"):
        require_bytes("two", needed=2, left=1)


def test_foreign_text_stays_on_one_short_printable_line():
    for text in ("a\nb", "\x1b[31mred", "é\u202e", b"\xff\x00" * 99):
        line = shown(text)
        assert line.isprintable()
        assert len(line) < 60
    assert printable("a\tb\u2028c") == "a\\tb\\u2028c"
    assert str(damaged("x")) == "x: the file is damaged or cut short; export it again"
