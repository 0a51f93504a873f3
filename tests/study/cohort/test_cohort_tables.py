"""A cohort as tables, costs and a crate: complete, plain, without the folders of this machine."""

import csv
import json

import pyarrow.parquet as pq
import pytest

from auricle.study.cohort.case import Case
from auricle.study.cohort.costs import cluster_need, stage_costs
from auricle.study.cohort.crate import write_crate
from auricle.study.cohort.gathering import Cohort, KeptCase
from auricle.study.cohort.study_file import Study
from auricle.study.cohort.tables import write_tables


def kept(name: str, n: int, *, seconds: float = 1.0) -> KeptCase:
    values = {
        "case": name,
        "source": {"name": f"{name}.vtp", "n_bytes": 10 * n, "sha256": f"{n:064x}"},
        "surface_as_read": {"n_vertices": n},
        "surface_analyzed": {"n_vertices": n},
        "tau": [1.5, 2.5 * n],
        "versions": {"numpy": "2"},
        "surfaces": {"original": [1.0] * 100},
        "reached": n if n > 200 else None,
    }
    return KeptCase(Case(name, f"/home/me/{name}.vtp", f"{n:032x}"), values, {"solve": seconds})


@pytest.fixture
def cohort() -> Cohort:
    finished = tuple(kept(name, n, seconds=1e-5 * n**1.5) for name, n in SIZES.items())
    return Cohort(finished, ((Case("bad", "/home/me/bad.vtp", "f" * 32), "bad.vtp: torn"),))


SIZES = {"=evil()": 100, "left": 1_000, "right": 10_000, "last": 4_000}


def test_csv_and_parquet_say_the_same_one_row_a_case(cohort, tmp_path) -> None:
    write_tables(cohort, tmp_path)
    with (tmp_path / "cohort.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    table = pq.read_table(tmp_path / "cohort.parquet").to_pylist()
    assert [row["case"] for row in table] == list(SIZES)
    assert rows[0]["case"] == "'=evil()"
    assert rows[0]["reached"] == ""
    assert table[0]["reached"] is None
    for text, typed in zip(rows, table, strict=True):
        assert int(text["surface_as_read.n_vertices"]) == typed["surface_as_read.n_vertices"]
    assert not {"versions.numpy", "surfaces.original"} & set(table[0])


def test_every_number_is_a_row_of_the_measurements(cohort, tmp_path) -> None:
    write_tables(cohort, tmp_path)
    rows = pq.read_table(tmp_path / "measurements.parquet").to_pylist()
    found = {(row["case"], row["quantity"]): row["value"] for row in rows}
    assert found["right", "tau.1"] == 25_000.0
    assert not [row for row in rows if row["quantity"].startswith("surfaces")]


def test_failures_are_told_in_a_table(cohort, tmp_path) -> None:
    write_tables(cohort, tmp_path)
    assert (tmp_path / "failures.csv").read_text() == "case,error\nbad,bad.vtp: torn\n"


def test_a_cohort_without_a_result_has_tables_too(tmp_path) -> None:
    write_tables(Cohort((), ()), tmp_path)
    assert pq.read_table(tmp_path / "measurements.parquet").num_rows == 0


def test_the_exponent_of_a_power_law_is_found(cohort) -> None:
    (cost,) = stage_costs(cohort.finished)
    assert cost.exponent == pytest.approx(1.5, abs=1e-6)
    assert cost.share == 1.0
    assert cost.total_s == pytest.approx(sum(1e-5 * n**1.5 for n in SIZES.values()))


def test_exponents_in_vertices_and_harmonics_are_told_apart() -> None:
    cases = []
    for n, k in ((1_000, 50), (2_000, 50), (4_000, 50), (2_000, 100), (2_000, 200)):
        case = kept(f"{n}-{k}", n, seconds=1e-6 * n**1.2 * k**0.8)
        case.values["certificate"] = {"n_modes": k}
        cases.append(case)
    (cost,) = stage_costs(cases)
    assert cost.exponent == pytest.approx(1.2, abs=1e-9)
    assert cost.modes_exponent == pytest.approx(0.8, abs=1e-9)
    (alone,) = stage_costs(cases[:3])
    assert (alone.exponent, alone.modes_exponent) == (pytest.approx(1.2), None)


def test_cases_of_one_size_give_no_exponent() -> None:
    alike = [kept("a", 10_000), kept("b", 10_100), kept("c", 10_200)]
    assert stage_costs(alike)[0].exponent is None


def test_the_stages_of_all_cases_together_are_all_the_time() -> None:
    cases = [kept("a", 100, seconds=2.0), kept("b", 200, seconds=3.0)]
    cases[1].timings["read"] = 5.0
    costs = stage_costs(cases)
    assert [cost.n_cases for cost in costs] == [2, 1]
    assert sum(cost.share for cost in costs) == pytest.approx(1.0)


def test_more_cores_share_the_hours_but_not_the_longest_case() -> None:
    cases = [kept("a", 100, seconds=1800.0), kept("b", 200, seconds=5400.0)]
    few, many = (cluster_need(cases, n_cases=1000, n_cores=n) for n in (10, 10_000_000))
    assert few.core_hours == many.core_hours == pytest.approx(1000.0)
    assert few.wall_hours == pytest.approx(101.5)
    assert many.wall_hours == pytest.approx(many.longest_case_hours, rel=1e-3)


def test_the_crate_names_every_file_once_and_no_folder_of_this_machine(cohort, tmp_path) -> None:
    write_tables(cohort, tmp_path)
    (tmp_path / "cases").mkdir()
    (tmp_path / "cases" / "0f.json").write_text("{}")
    (tmp_path / "cases" / ".0f.abc.json").write_text("{")
    text = write_crate(Study((), title="Four atria"), cohort, tmp_path).read_text()
    assert "/home/me" not in text
    assert str(tmp_path) not in text
    entities = {each["@id"]: each for each in json.loads(text)["@graph"]}
    files = {name for name, each in entities.items() if each["@type"] == "File"}
    there = {
        path.relative_to(tmp_path).as_posix()
        for path in tmp_path.rglob("[!.]*")
        if path.is_file() and path.name != "ro-crate-metadata.json"
    }
    assert files == there
    root = entities["./"]
    assert {part["@id"] for part in root["hasPart"]} == files
    assert {"name", "description", "datePublished", "license"} <= set(root)
    assert entities["ro-crate-metadata.json"]["about"] == {"@id": "./"}
    for each in entities["#run"]["object"]:
        assert each["@id"] in entities


def test_a_written_crate_is_the_same_when_written_again(cohort, tmp_path) -> None:
    write_tables(cohort, tmp_path)
    first = write_crate(Study(()), cohort, tmp_path).read_bytes()
    assert write_crate(Study(()), cohort, tmp_path).read_bytes() == first
