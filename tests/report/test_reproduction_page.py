"""The page on reproduction: complete, and as careful as its numbers."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

from auricle.report.reproduction_page import reproduction_markdown
from auricle.report.reproduction_tables import factor, reproduction_tables


@pytest.fixture(scope="module")
def made_up() -> ModuleType:
    """The documents with known nearness, from the tests of `study.paper.reproduction`."""
    place = Path(__file__).parents[1] / "study" / "paper" / "test_reproduction.py"
    spec = importlib.util.spec_from_file_location("made_up_documents", place)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_counts_as_printed_are_said_to_reproduce_the_table(made_up: ModuleType) -> None:
    page = reproduction_markdown([made_up.document(made_up.only_true)] * 2)
    assert "That reproduces the table." in page
    assert "typical factor 1.00" in page
    assert "look more like accumulated amplitude than energy" in page


def test_counts_three_times_off_are_said_not_to(made_up: ModuleType) -> None:
    page = reproduction_markdown([made_up.document(lambda _: 3.0)])
    assert "does not reproduce the table" in page
    assert "which one the authors used stays open" in page
    assert "The geometry's row does not tell" in page


def test_growth_with_the_mesh_is_inferred_only_where_it_was_shown(made_up: ModuleType) -> None:
    growing = made_up.document(lambda _: 1.0, lambda _: 0.4)
    steady = made_up.document(lambda _: 1.0, lambda _: 1.0)
    assert "tail of small coefficients" in reproduction_markdown([growing])
    assert "tail of small coefficients" not in reproduction_markdown([steady])


def test_an_operator_that_was_refused_is_named(made_up: ModuleType) -> None:
    case = made_up.document(made_up.only_true)
    case["conventions"]["refused"] = [
        {"operator": "as_printed", "dual_cell": "voronoi", "reason": "no certificate"}
    ]
    assert "case: as printed, voronoi (no certificate)" in reproduction_markdown([case])


def test_an_operator_that_is_no_laplacian_is_told_with_its_number(made_up: ModuleType) -> None:
    case = made_up.document(made_up.only_true)
    assert "has negative eigenvalues, and is" not in reproduction_markdown([case])
    case["conventions"]["operators"][0]["n_negative"] = 2
    assert "is no Laplacian, on (their number): case, third (2)" in reproduction_markdown([case])


@pytest.mark.parametrize(
    ("counts", "verdict"),
    [((20, 21, 20), "does not bias counts"), ((23, 26, 24), "biases counts")],
)
def test_what_the_reduction_does_to_counts_is_answered(
    made_up: ModuleType, counts: tuple[int, ...], verdict: str
) -> None:
    cases = []
    for count in counts:
        case = made_up.document(made_up.only_true)
        finer = {"n_vertices": 100_000, "geometry": {"0.99": count}, "features": []}
        case["beyond"]["resolution"] = [finer]
        cases.append(case)
    text = reproduction_markdown(cases)
    assert "With 100,000 (3 atria) in its place" in text
    assert verdict in text
    assert "Does the reduction" not in reproduction_markdown([made_up.document(made_up.only_true)])


def test_a_case_with_a_refused_operator_takes_no_reading_from_the_others(
    made_up: ModuleType,
) -> None:
    solved, refused = made_up.document(made_up.only_true), made_up.document(made_up.only_true)
    refused["conventions"]["refused"] = [
        {"operator": "as_printed", "dual_cell": "third", "reason": "no certificate"}
    ]
    text = reproduction_markdown([solved, refused])
    assert "Cases left out, since an operator was not solved: case: as printed, third" in text
    assert reproduction_markdown([solved]).split("## All readings")[1] in text


def test_surfaces_of_another_resolution_and_widths_at_an_end_are_said_to_be_so(
    made_up: ModuleType,
) -> None:
    case = made_up.document(made_up.only_true)
    assert "other than about 10,000 vertices" in reproduction_markdown([case])  # 9,000: 10.5 %
    assert "an end of the range tried, 2 to 32 mm" in reproduction_markdown([case])
    case["conventions"]["n_vertices"] = 10_012
    steady = reproduction_markdown([case])
    assert "other than about" not in steady


def test_every_table_has_cells_for_its_columns_and_every_reading_is_listed(
    made_up: ModuleType,
) -> None:
    cases = [made_up.document(made_up.only_true)]
    for table in reproduction_tables(cases):
        assert {len(row) for row in table.rows} == {len(table.head)}
    full = reproduction_markdown(cases).split("## All readings")[1]
    assert full.count("\n| as printed |") == 8


def test_without_conventions_the_page_says_so_and_there_are_no_tables() -> None:
    assert "left out of this study" in reproduction_markdown([{"conventions": {}}])
    assert reproduction_tables([{"conventions": {}}]) == ()


def test_a_distance_is_shown_as_a_factor() -> None:
    assert factor(0.0) == "1.00"
