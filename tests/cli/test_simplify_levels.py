"""`auricle simplify` at several levels, and with fields that decide."""

import numpy as np

from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere
from auricle.surface.writing import write_surface


def test_every_level_is_a_file_of_its_count(auricle, surface, tmp_path):
    done = auricle("simplify", surface, "--levels", "50,300", "-o", tmp_path / "small.vtp")
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["small_300.vtp", "small_50.vtp"]
    for n_vertices in (50, 300):
        assert len(read_surface(tmp_path / f"small_{n_vertices}.vtp").vertices) == n_vertices
    assert done.stdout.count("after:") == done.stdout.count("distance") == 2


def test_fields_that_decide_come_through_closer(auricle, surface, tmp_path):
    errors = []
    for options in ((), ("--feature-weight", 10)):
        name = tmp_path / "small.vtp"
        field = ("--field", "local_activation_time")
        done = auricle("simplify", surface, "-n", 60, "-o", name, *field, *options)
        assert done.returncode == 0, done.stderr
        small = read_surface(name)
        expected = 80 + small.vertices[:, 0] + 0.02 * small.vertices[:, 1] ** 2
        errors.append(np.abs(small.point_fields["local_activation_time"] - expected).mean())
    assert errors[1] < errors[0]


def test_a_level_too_coarse_writes_nothing(auricle, surface, tmp_path):
    done = auricle("simplify", surface, "--levels", "300,3", "-o", tmp_path / "small.vtp")
    assert done.returncode == 3
    assert "give 4 or more" in done.stderr
    assert not list(tmp_path.iterdir())


def test_levels_that_are_no_numbers_are_a_usage_error(auricle, surface, tmp_path):
    done = auricle("simplify", surface, "--levels", "50;300", "-o", tmp_path / "small.vtp")
    assert done.returncode == 2
    assert "whole numbers" in done.stderr


def test_a_weight_with_no_field_to_count_for_is_refused(auricle, tmp_path):
    write_surface(tmp_path / "bare.ply", icosphere(radius=30.0, subdivisions=3))
    done = auricle(
        "simplify", tmp_path / "bare.ply", "-n", 60, "--feature-weight", 1, "-o", tmp_path / "a.ply"
    )
    assert done.returncode == 3
    assert "no field" in done.stderr
    assert not (tmp_path / "a.ply").exists()
