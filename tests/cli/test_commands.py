"""The other commands, help, settings, and the exit codes scripts rely on."""

import json
import subprocess
import sys

import numpy as np
import pytest

from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere, joined
from auricle.surface.writing import write_surface

COMMANDS = ("analyze", "study", "harmonics", "simplify", "atrium")


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(auricle, command) -> None:
    done = auricle(command, "--help")
    assert done.returncode == 0
    assert f"Example: auricle {command}" in " ".join(done.stdout.split())


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys; sys.argv = ['auricle', '--help']\n"
        "from auricle.cli.app import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "heavy = {'numpy', 'scipy', 'matplotlib', 'vtkmodules', 'igl', 'jinja2'}\n"
        "sys.stderr.write(repr(sorted(heavy & set(sys.modules))))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stderr == "[]"


def test_the_version_is_the_packages(auricle) -> None:
    from auricle import __version__

    assert auricle("--version").stdout == f"auricle {__version__}\n"


def test_an_unknown_option_is_a_usage_error(auricle) -> None:
    assert auricle("analyze", "--no-such-option").returncode == 2


def test_options_for_a_ct_are_not_ignored_with_a_surface(auricle, surface, tmp_path) -> None:
    done = auricle("analyze", surface, "-o", tmp_path / "out", "--roi", "0,0,0:9,9,9")
    assert done.returncode == 2
    assert "is no CT" in " ".join(done.stderr.split())
    assert not (tmp_path / "out").exists()


def test_harmonics_of_a_sphere(auricle, tmp_path) -> None:
    sphere = icosphere(radius=30.0, subdivisions=3)
    write_surface(tmp_path / "sphere.ply", sphere)
    done = auricle("harmonics", tmp_path / "sphere.ply", "-k", 9, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    document = json.loads((tmp_path / "out" / "harmonics.json").read_text())
    values = np.array(document["eigenvalues_per_mm2"]) * 30.0**2
    np.testing.assert_allclose(values[:9], [0, 2, 2, 2, 6, 6, 6, 6, 6], atol=0.05)
    assert document["zero_modes"] == 1
    assert document["certificate"]["eigenvalues_below_gap"] == document["n_modes"]
    modes, areas = (np.load(tmp_path / "out" / f"{name}.npy") for name in ("modes", "areas"))
    gram = modes.T @ (areas[:, None] * modes)
    assert np.abs(gram - np.eye(len(gram))).max() < 1e-10


def test_harmonics_keep_every_piece_and_one_constant_mode_each(auricle, tmp_path) -> None:
    sphere = icosphere(radius=1.0, subdivisions=3)
    pair = joined([sphere, Mesh(sphere.vertices + 5.0, sphere.faces)])
    write_surface(tmp_path / "pair.vtp", pair)
    done = auricle("harmonics", tmp_path / "pair.vtp", "-k", 20, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "out" / "harmonics.json").read_text())["zero_modes"] == 2


@pytest.mark.parametrize("count", [0, 42, 100])
def test_harmonics_that_do_not_exist_are_refused(auricle, tmp_path, count) -> None:
    write_surface(tmp_path / "sphere.ply", icosphere(radius=30.0, subdivisions=1))
    done = auricle("harmonics", tmp_path / "sphere.ply", "-k", count, "-o", tmp_path / "out")
    assert done.returncode == 3
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_simplify_reaches_the_count_and_carries_the_fields(auricle, surface, tmp_path) -> None:
    done = auricle("simplify", surface, "-n", 300, "-o", tmp_path / "small.vtp")
    assert done.returncode == 0, done.stderr
    small = read_surface(tmp_path / "small.vtp")
    assert len(small.vertices) == 300
    assert set(small.point_fields) == {
        "local_activation_time",
        "bipolar_voltage",
        "constant",
        "nothing",
    }
    activation = 80 + small.vertices[:, 0] + 0.02 * small.vertices[:, 1] ** 2
    np.testing.assert_allclose(small.point_fields["local_activation_time"], activation, atol=1.0)
    assert small.units["local_activation_time"] == "ms"


def test_an_atrium_is_the_same_for_a_seed_and_another_for_another(auricle, tmp_path) -> None:
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        done = auricle("atrium", "--spacing", 3, "--seed", seed, "-o", tmp_path / f"{name}.vtp")
        assert done.returncode == 0, done.stderr
    content = {name: (tmp_path / f"{name}.vtp").read_bytes() for name in "abc"}
    assert content["a"] == content["b"] != content["c"]


def test_flags_go_before_the_environment_and_that_before_the_file(auricle, tmp_path) -> None:
    write_surface(tmp_path / "sphere.ply", icosphere(radius=30.0, subdivisions=2))
    settings = tmp_path / "auricle.toml"
    settings.write_text("[harmonics]\nmodes = 4\n")

    def modes(*flags: object, **environment: str) -> int:
        done = auricle(
            "--config",
            settings,
            "harmonics",
            tmp_path / "sphere.ply",
            "-o",
            tmp_path / "out",
            *flags,
            **environment,
        )
        assert done.returncode == 0, done.stderr
        document = json.loads((tmp_path / "out" / "harmonics.json").read_text())
        return document["certificate"]["n_asked"]

    assert modes() == 4
    assert modes(AURICLE_HARMONICS_MODES="9") == 9
    assert modes("-k", 16, AURICLE_HARMONICS_MODES="9") == 16


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("[harmonics]\nmoods = 4\n", "no option 'moods'"),
        ("[dance]\nmodes = 4\n", "no command named 'dance'"),
        ("modes = = 4", "not TOML"),
    ],
)
def test_a_settings_file_with_a_mistake_is_refused(auricle, tmp_path, text, cause) -> None:
    settings = tmp_path / "auricle.toml"
    settings.write_text(text)
    done = auricle("--config", settings, "atrium", "-o", tmp_path / "atrium.vtp")
    assert done.returncode == 3
    assert cause in done.stderr
    assert not (tmp_path / "atrium.vtp").exists()


def test_a_place_that_cannot_be_written_is_a_failure_in_one_line(auricle, tmp_path) -> None:
    (tmp_path / "file").write_text("")
    done = auricle("atrium", "--spacing", 3, "-o", tmp_path / "file" / "atrium.vtp")
    assert done.returncode == 1
    assert "cannot be written" in done.stderr
    assert done.stderr.count("\n") == 1
