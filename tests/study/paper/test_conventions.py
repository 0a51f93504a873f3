"""Counts under every convention: complete, the same however vertices are numbered, and right."""

import json
from itertools import product

import numpy as np
import pytest

from auricle.spectral.harmonics import manifold_harmonics
from auricle.study.paper.conventions import SHAPES, convention_counts, modes_for_share
from auricle.study.paper.features import places_of
from auricle.study.paper.foci import foci_at
from auricle.study.paper.parameters import PaperParameters
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import ellipsoid

PARAMETERS = PaperParameters.tiny(n_vertices=642, convention_vertices=642, placements=2)


@pytest.fixture(scope="module")
def uneven() -> Mesh:
    """A closed surface of 642 vertices whose cells differ, away from the origin."""
    smooth = ellipsoid(semi_axes=(20.0, 28.0, 36.0), subdivisions=3)
    jitter = np.random.default_rng(1).normal(scale=0.4, size=smooth.vertices.shape)
    return Mesh(smooth.vertices + jitter + [100.0, -50.0, 30.0], smooth.faces)


@pytest.fixture(scope="module")
def counted(uneven: Mesh) -> dict:
    return convention_counts(uneven, parameters=PARAMETERS)


def chosen(records: list[dict], **wanted: str) -> dict:
    """The one record with these choices."""
    (found,) = (r for r in records if all(r[key] == value for key, value in wanted.items()))
    return found


def test_every_combination_is_there_once(counted: dict) -> None:
    keys = ("operator", "projection", "dual_cell", "coordinates", "measure", "constant")
    assert len({tuple(row[key] for key in keys) for row in counted["geometry"]}) == 80
    assert len(counted["geometry"]) == 80
    assert len(counted["features"]) == 40 * len(SHAPES)
    assert counted["refused"] == []
    assert counted["coarser"]["n_vertices"] == 642 // 3
    shape = (len(counted["widths_mm"]), len(counted["focus_counts"]))
    assert all(np.shape(row["counts"]["0.9"]) == shape for row in counted["features"])


def test_the_sound_reading_counts_as_the_power_spectrum_does(counted: dict, uneven: Mesh) -> None:
    basis = manifold_harmonics(uneven, 300)
    sound = {
        "operator": "area_weighted",
        "projection": "weighted",
        "dual_cell": "third",
        "measure": "energy",
        "constant": "out",
    }
    spectrum = basis.power_spectrum(uneven.vertices)
    for coordinates, share in product(("centred", "as given"), (0.85, 0.90)):
        row = chosen(counted["geometry"], coordinates=coordinates, **sound)
        assert row["counts"][f"{share:g}"] == spectrum.modes_for_power(share)
    row = chosen(counted["features"], profile="gaussian", **sound)
    places = places_of(uneven, PARAMETERS)
    widest = counted["widths_mm"].index(8.0)
    expected = np.median(
        [
            basis.power_spectrum(
                foci_at(uneven, each, marched=True).map_of(2, 8.0)
            ).modes_for_power(0.9)
            for each in places
        ]
    )
    assert row["counts"]["0.9"][widest][1] == expected


def test_amplitude_asks_for_more_than_energy_under_every_reading(counted: dict) -> None:
    for row in counted["geometry"]:
        if row["measure"] == "amplitude":
            same = {key: row[key] for key in row if key not in ("measure", "counts")}
            energy = chosen(counted["geometry"], measure="energy", **same)
            assert row["counts"]["0.9"] >= energy["counts"]["0.9"]


def test_where_the_constant_is_a_mode_and_left_out_the_origin_does_not_matter(
    counted: dict,
) -> None:
    differing = set()
    for row in counted["geometry"]:
        if row["coordinates"] == "centred" and row["constant"] == "out":
            same = {key: row[key] for key in row if key not in ("coordinates", "counts")}
            given = chosen(counted["geometry"], coordinates="as given", **same)
            if given["counts"] != row["counts"]:
                differing.add((row["operator"], row["projection"]))
    assert differing == {
        ("as_printed", "weighted"),
        ("symmetrised", "unweighted"),
        ("area_weighted", "unweighted"),
    }


def test_the_document_is_the_same_to_the_byte_and_for_any_numbering(
    counted: dict, uneven: Mesh, rng: np.random.Generator
) -> None:
    assert json.dumps(convention_counts(uneven, parameters=PARAMETERS)) == json.dumps(counted)
    order = rng.permutation(uneven.n_vertices)
    faces = np.argsort(order)[uneven.faces][rng.permutation(uneven.n_faces)]
    other = convention_counts(Mesh(uneven.vertices[order], faces), parameters=PARAMETERS)
    assert other["geometry"] == counted["geometry"]
    assert other["features"] == counted["features"]


def test_a_flat_spectrum_needs_its_share_of_the_modes() -> None:
    assert modes_for_share(np.ones(1000), 0.9, with_constant=True) == 900
    # The constant is counted though nothing of the sum is its.
    assert modes_for_share(np.ones(1001), 0.9, with_constant=False) == 901
