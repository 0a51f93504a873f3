import sys

import pytest

from auricle.errors import FormatError
from auricle.isolation import run_child

LIMITED = "from auricle.isolation import limit_memory; limit_memory(3 * 2**29); "


def test_a_child_keeps_within_its_memory():
    resource = pytest.importorskip("resource", reason="this system has no limits to set")
    assert resource.RLIM_INFINITY  # the limit is the child's, not ours
    run_child([sys.executable, "-c", LIMITED + "bytearray(2**20)"], seconds=30)
    if sys.platform == "darwin":
        pytest.skip("macOS refuses the limit")
    with pytest.raises(FormatError, match="more memory than its size allows"):
        run_child([sys.executable, "-c", LIMITED + "bytearray(2**31)"], seconds=30)


def test_the_last_words_of_a_child_are_the_fault():
    program = "import sys; sys.stderr.write('noise\\nthe cause: the remedy\\n'); sys.exit(3)"
    with pytest.raises(FormatError, match=r"^the cause: the remedy$"):
        run_child([sys.executable, "-c", program], seconds=30)
