import hashlib
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from auricle.viewer.built_page import BUILT, exported_page
from auricle.viewer.bundle import Shipped
from auricle.viewer.guard import content_policy

SOURCES = Path(__file__).resolve().parents[2] / "page"
MB = 1_000_000


def digest_of(folder: Path) -> str:
    """SHA-256 of the page's sources, as page/build.mjs describes it."""
    digest = hashlib.sha256()
    names = {
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*")
        if path.is_file()
        and not any(
            part == "node_modules" or part.startswith(".")
            for part in path.relative_to(folder).parts
        )
    }
    for name in sorted(names):
        content = (folder / name).read_bytes()
        digest.update(f"{name}\n{len(content)}\n".encode() + content)
    return digest.hexdigest()


@pytest.fixture(scope="module")
def built() -> str:
    return BUILT.read_text(encoding="utf-8")


def test_the_built_page_is_that_of_its_sources(built):
    found = re.search(r'<meta name="auricle-sources" content="([0-9a-f]{64})">', built)
    assert found is not None
    assert found[1] == digest_of(SOURCES), "run `npm run build` in page/"


def test_the_built_page_is_smaller_than_a_megabyte():
    assert BUILT.stat().st_size < MB


def test_the_page_names_nothing_to_be_fetched_from_elsewhere(built):
    head = built[: built.index("<style>")] + built[built.index("</style>") : built.index("<script")]
    assert not re.search(r'(?:src|href)="(?!data:)', head)
    assert not re.search(r"@import|url\((?!data:)", built[built.index("<style>") :][:200_000])


def test_the_lock_file_names_no_address_of_a_registry():
    assert '"resolved"' not in (SOURCES / "package-lock.json").read_text(encoding="utf-8")


def test_an_exported_page_may_run_its_own_script_only_and_ask_nobody(built):
    page = exported_page(b"case")
    policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', page)
    assert policy is not None
    assert "connect-src 'none'" in policy[1]
    assert "unsafe" not in policy[1]
    scripts = re.search(r"script-src ([^;]*)", content_policy(built))
    assert scripts is not None
    assert scripts[1] in policy[1]


def test_an_exported_page_of_ten_thousand_vertices_and_250_harmonics_is_below_ten_megabytes(rng):
    n, k = 10_000, 250
    arrays = {
        # A mode uses all of the 16 bits only at its largest value.
        "modes": (rng.normal(size=(k, n)) * 9_000).clip(-32_767, 32_767).astype(np.int16),
        "positions": rng.normal(size=(n, 3)).astype(np.float32),
        "faces": rng.integers(0, n, (2 * n, 3)).astype(np.uint32),
        "areas": rng.random(n),
        "collapse_kept": rng.integers(0, n, n).astype(np.int32),
        "collapse_gone": rng.integers(0, n, n).astype(np.int32),
        "collapse_places": rng.normal(size=(n, 3)).astype(np.float32),
        "field_0": rng.random(n).astype(np.float32),
        "field_1": rng.random(n).astype(np.float32),
    }
    assert len(exported_page(Shipped({}, arrays).content)) < 10 * MB


@pytest.mark.slow
def test_the_sources_build_to_the_page_that_is_there(tmp_path, built):
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip("no npm on this machine")
    page = tmp_path / "page"
    shutil.copytree(SOURCES, page, ignore=shutil.ignore_patterns("node_modules"))
    for command in (["ci"], ["run", "build"]):
        subprocess.run([npm, *command], cwd=page, check=True, capture_output=True, timeout=300)
    again = tmp_path / "src" / "auricle" / "viewer" / "static" / "page.html"
    assert again.read_text(encoding="utf-8") == built
