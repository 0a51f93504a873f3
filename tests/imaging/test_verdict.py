import pytest

from auricle.errors import InputError
from auricle.imaging.verdict import REMEDIES, Reason, SegmentationError, Verdict, verdict_of


def test_one_reason_that_stops_makes_the_verdict_check():
    told = Reason("no_appendage", "none found", stops=False)
    assert verdict_of([told]) is Verdict.OK
    assert verdict_of([told, Reason("leak", "a branch of 168 ml is no vein")]) is Verdict.CHECK
    assert verdict_of([]) is Verdict.OK


@pytest.mark.parametrize("code", REMEDIES)
def test_every_refusal_is_one_line_with_its_remedy_and_counts_as_bad_input(code):
    refusal = SegmentationError(code, "the cause")
    assert isinstance(refusal, InputError)
    assert (refusal.code, refusal.remedy) == (code, REMEDIES[code])
    assert str(refusal) == f"the cause: {REMEDIES[code]}"
    assert "\n" not in str(Reason(code, "the cause"))
