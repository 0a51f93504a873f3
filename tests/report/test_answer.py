"""The answer in words, held against the readings it tells."""

import math
import re
from dataclasses import replace

import pytest

from auricle.report.answer import advice, answer_sentence, focal_advice, measured_advice
from auricle.report.tables import PLANNED, UNPLANNED, bound_of
from auricle.study.result import CaseResult, Signal


def only(case: CaseResult, *fields: Signal) -> CaseResult:
    return replace(case, fields=fields, simulated=())


def at_99(signal: Signal):
    return next(c for c in signal.for_error if c.share == 0.99).need


def numbers(text: str) -> set[str]:
    return set(re.findall(r"\d[\d,.]*\d|\d", text))


def with_need(signal: Signal, share: float, found) -> Signal:
    """The signal with another need for the error of one share."""
    return replace(
        signal,
        for_error=tuple(
            replace(c, need=found) if c.share == share else c for c in signal.for_error
        ),
    )


def test_the_answer_for_one_map_holds_its_numbers_at_99_percent(case):
    signal = case.fields[0]
    need = at_99(signal)
    told = answer_sentence(only(case, signal))
    for words in (
        f"plan about {need.n_planned} evenly spread points",
        "to map local activation time with an error of 10 %",
        f"or about {need.n_unplanned} if they are taken wherever",
        f"at least {need.n_least},",
        f"({case.surface.area / 100:.0f} cm²)",
        f"every {need.planned_spacing_mm:.2g} mm",
    ):
        assert words in told


def test_an_error_is_told_in_the_unit_of_the_map_where_the_file_states_one(case):
    time, voltage = measured_advice(case)
    spread = math.sqrt(case.fields[0].spectrum.varying_total / case.shell_area_mm2)
    assert spread == pytest.approx(case.fields[0].field.values.std(), rel=0.1)
    assert time.target_error == f"{0.1 * spread:.2g} ms"
    assert voltage.target_error == ""
    assert time.target_error in answer_sentence(only(case, case.fields[0]))


def test_measured_maps_come_first_then_foci_as_a_range(case):
    told = answer_sentence(case)
    wide, narrow = (
        next(s for s in case.simulated if s.name == f"foci_1_width_{mm}_mm") for mm in (16, 8)
    )
    maps, foci = told.index("local activation time"), told.index("A simulated focal source")
    assert maps < told.index("bipolar voltage") < foci
    assert f"takes {at_99(wide).n_planned} (σ = 16 mm) to " in told[foci:]
    assert f"to {at_99(narrow).n_planned} (σ = 8 mm" in told[foci:]


def test_without_fields_the_foci_are_the_answer(case):
    told = answer_sentence(replace(case, fields=()))
    least, most = focal_advice(case)
    assert told.startswith("On this surface")
    assert f"plan about {least.count(PLANNED)} (σ = 16 mm) to " in told
    assert f"to {most.count(PLANNED, note='σ = 8 mm')}" in told
    assert f"or about {least.count(UNPLANNED)} (σ = 16 mm)" in told


def test_without_any_map_the_shape_is_told_in_millimetres(case):
    told = answer_sentence(only(case))
    near = next(error for error in case.geometry_errors if error.gd_mean_mm <= 1.0)
    assert f"{near.n_modes} harmonics rebuild the shape" in told
    assert told.endswith(" mm.")


def test_a_need_that_is_not_reached_is_said_to_be_more_than_all_harmonics_ask_for(case):
    voltage = case.fields[1]
    missed = with_need(voltage, 0.99, None)
    told = answer_sentence(only(case, missed))
    assert f"more than {bound_of(case).n_planned} evenly spread points" in told
    share = voltage.spectrum.cumulative()[-1]
    assert f"80 harmonics solved hold only {100 * share:.0f} % of its power" in told
    assert "plan about" not in told
    assert "None" not in told


def test_what_the_mesh_does_not_resolve_is_said(case):
    signal = case.fields[0]
    rough = with_need(signal, 0.99, replace(at_99(signal), trusted=False))
    assert "finer than this mesh resolves" in answer_sentence(only(case, rough))
    rough = signal.for_error[1].need
    assert ("finer" in answer_sentence(only(case, signal))) == (not (rough and rough.trusted))


def test_the_answer_is_one_line_of_at_most_two_sentences(case):
    many = replace(case, fields=tuple(replace(case.fields[0], name=f"map_{i}") for i in range(30)))
    for each in (case, many, only(case), only(case, *case.fields), replace(case, fields=())):
        told = answer_sentence(each)
        assert "\n" not in told
        assert told.endswith(".")
        assert len(re.findall(r"[.?!] [A-Z]", told)) <= 1
        assert len(told) < 600


def test_further_maps_are_counted_and_told_as_a_range(case):
    told = answer_sentence(replace(case, fields=(*case.fields, *case.simulated)))
    rest = sorted(at_99(signal).n_planned for signal in case.simulated[1:])
    assert f"{rest[0]} to {rest[-1]}" in told
    assert "for 3 further maps" in told


def test_a_name_from_a_file_cannot_reach_the_terminal(case):
    hostile = replace(case.fields[0], name="LAT\x1b[2J\n\u202e" + "x" * 500)
    told = answer_sentence(only(case, hostile))
    assert told.isprintable()
    assert len(told) < 500


def test_advice_does_not_count_the_constant_harmonic_s_power(case):
    for signal in case.fields:
        found = advice(signal, case)
        assert not found.target.with_constant
        assert not found.coarse.with_constant
        assert (found.target.share, found.coarse.share) == (0.99, 0.90)


def test_the_same_case_gives_the_same_words(case):
    assert answer_sentence(case) == answer_sentence(replace(case, seconds={"all": 1.0}))


def test_numbers_in_the_answer_are_those_of_the_criteria_and_no_others(case):
    need, signal = at_99(case.fields[0]), case.fields[0]
    rough = signal.for_error[1].need or bound_of(case)
    known = {need.n_planned, need.n_unplanned, need.n_least, rough.n_planned, 32, 10}
    known_text = {str(number) for number in known}
    known_text |= {f"{case.surface.area / 100:.0f}", f"{need.planned_spacing_mm:.2g}"}
    known_text |= numbers(advice(signal, case).target_error)
    assert numbers(answer_sentence(only(case, signal))) <= known_text


@pytest.mark.parametrize("count", [1, 2])
def test_one_extreme_is_told_once(case, count):
    same = replace(case, fields=(), simulated=(case.simulated[0],) * count)
    assert len(focal_advice(same)) == 1
    assert " to " not in answer_sentence(same).partition("plan about")[2].partition(" evenly")[0]
