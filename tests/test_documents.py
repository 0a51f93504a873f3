"""What the documents say to users, held against the program."""

import importlib
import math
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import typer

from auricle import __version__, errors
from auricle.cli import app
from auricle.cli.commands import COMMANDS
from auricle.surface.reading import READABLE
from auricle.surface.shapes import ellipsoid
from auricle.surface.writing import WRITABLE, write_surface

ROOT = Path(__file__).resolve().parents[1]
DOCUMENTS = sorted([*ROOT.glob("*.md"), ROOT / "CITATION.cff", *(ROOT / "docs").rglob("*.md")])
DECISIONS = sorted((ROOT / "docs" / "decisions").glob("*.md"))
PARTS = ("**Question.**", "**Choice", "**Evidence.**", "**What would change our mind.**")
THIS_MACHINE = re.compile(r"/(?:work|root|home|tmp|opt|Users)/|[A-Z]:\\|pypi|localhost", re.I)


def text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


README = text("README.md")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL)


def shell_lines() -> list[list[str]]:
    """Words of every line of the README's shell blocks, without comments."""
    lines = "\n".join(blocks("sh")).splitlines()
    return [line.partition("#")[0].split() for line in lines if line.strip()]


def table_under(heading: str) -> list[list[str]]:
    """Cells of the first table after a heading of the README, without its head."""
    section = README.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    rows = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows[2:]]


def test_the_readme_is_short_enough_to_be_read():
    assert len(README.splitlines()) <= 150


def test_the_python_of_the_readme_runs_and_meets_the_closed_form(tmp_path, monkeypatch, capsys):
    """A Gaussian focus of 8 mm, as the program has it, needs about −A·ln(1−p)/(4πσ²) harmonics."""
    chamber = ellipsoid(semi_axes=(36.0, 30.0, 24.0), subdivisions=3)
    write_surface(tmp_path / "atrium.vtp", chamber)
    monkeypatch.chdir(tmp_path)
    (program,) = blocks("python")
    names: dict[str, int] = {}
    exec(compile(program, "README.md", "exec"), names)
    closed_form = chamber.area * math.log(10) / (4 * math.pi * 8.0**2)
    assert names["n_modes"] == pytest.approx(closed_form, rel=0.15)
    assert capsys.readouterr().out.startswith(f"{2 * names['n_modes']} points")


@pytest.mark.slow
def test_the_answer_in_the_readme_is_the_one_the_program_gives(tmp_path):
    (session,) = blocks("console")
    said = ""
    for line in re.findall(r"^\$ auricle (.*)$", session, re.MULTILINE):
        command = [sys.executable, "-m", "auricle", *line.split()]
        said += subprocess.run(
            command, cwd=tmp_path, capture_output=True, encoding="utf-8", check=True
        ).stdout
    shown = re.sub(r"^\$ .*$", "", session, flags=re.MULTILINE)
    assert shown.split() == said.split()


def test_the_program_in_the_readme_has_ten_lines_or_so():
    (program,) = blocks("python")
    statements = [line for line in program.splitlines() if line and "import" not in line]
    assert len(statements) <= 10


def test_every_command_has_an_example_in_the_readme():
    shown = {words[1] for words in shell_lines() if words[0] == "auricle"}
    assert set(COMMANDS) <= shown


def test_every_command_and_option_in_the_readme_and_the_makefile_exists():
    group = typer.main.get_command(app.app)
    demo = re.findall(r"\$\(BIN\)/(auricle .*)", text("Makefile"))
    assert demo
    for words in [*shell_lines(), *map(str.split, demo)]:
        if words[0] != "auricle":
            continue
        rest = words[3:] if words[1] == "--config" else words[1:]
        known = {name for parameter in group.commands[rest[0]].params for name in parameter.opts}
        assert {word for word in rest if word.startswith("-")} <= known, words


def test_every_make_verb_in_the_documents_exists():
    verbs = set(re.findall(r"^([a-z-]+):", text("Makefile"), re.MULTILINE))
    shown = re.findall(r"(?:`|^)make ([a-z-]+)", README + text("CONTRIBUTING.md"), re.MULTILINE)
    assert set(shown) <= verbs
    assert {"demo", "test"} <= set(shown)


def test_the_settings_in_the_readme_name_options_that_exist():
    (settings,) = blocks("toml")
    for command, options in tomllib.loads(settings).items():
        known = COMMANDS[command].__annotations__
        assert set(options) <= set(known)


def test_the_exit_codes_are_those_of_the_program():
    faults = [kind for kind in vars(errors).values() if isinstance(kind, type)]
    codes = {kind.exit_code for kind in faults if issubclass(kind, errors.AuricleError)}
    usage, done = 2, 0
    rows = table_under("Commands")
    assert {int(row[0]) for row in rows} == {done, usage, app.EXIT_INTERRUPTED, *codes}


def test_the_formats_are_those_of_the_program():
    read, _, written = README.partition("Read: ")[2].partition("\n\n")[0].partition("Written: ")
    assert set(re.findall(r"`(\.\w+)`", read)) == {*READABLE, ".dat"}
    assert set(re.findall(r"`(\.\w+)`", written)) == set(WRITABLE)


def test_the_table_of_dependencies_is_that_of_the_package():
    wanted = tomllib.loads(text("pyproject.toml"))["project"]["dependencies"]
    names = [re.split(r"[<>=!~;\[ ]", line)[0] for line in wanted]
    assert [row[0] for row in table_under("Dependencies")] == names


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_to_files_of_the_project(path):
    for link in re.findall(r"\]\(([^)]+)\)", path.read_text(encoding="utf-8")):
        assert (path.parent / link.partition("#")[0]).exists(), link


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_named_modules_and_tests_exist(path):
    for name in re.findall(r"`([\w./-]+/[\w.-]+\.(?:py|md))`", path.read_text(encoding="utf-8")):
        assert (ROOT / name).exists() or (ROOT / "src" / "auricle" / name).exists(), name


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_no_place_of_a_machine_is_in_the_documents(path):
    assert THIS_MACHINE.findall(path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("path", DECISIONS, ids=lambda path: path.name)
def test_a_decision_is_short_and_has_its_parts_in_order(path):
    record = path.read_text(encoding="utf-8")
    assert len(record.splitlines()) <= 20
    assert record.startswith(f"# {path.name[:4]}. ")
    places = [record.find(part) for part in PARTS]
    assert -1 not in places
    assert places == sorted(places)


def test_decisions_are_numbered_without_gaps():
    assert [int(path.name[:4]) for path in DECISIONS] == list(range(1, len(DECISIONS) + 1))


@pytest.mark.parametrize(
    "name", sorted(set(re.findall(r"`(auricle(?:\.\w+)+)`", text("docs/quantities.md"))))
)
def test_every_quantity_is_where_its_page_says(name):
    room, _, entry = name.rpartition(".")
    if entry[0].islower() and room.rpartition(".")[2][0].isupper():
        room, _, owner = room.rpartition(".")
        assert hasattr(getattr(importlib.import_module(room), owner), entry)
    else:
        assert hasattr(importlib.import_module(room), entry)


def test_changelog_and_citation_name_this_version():
    assert f"## [{__version__}]" in text("CHANGELOG.md")
    assert f"\nversion: {__version__}\n" in text("CITATION.cff")
