"""Samples on a chamber: what is kept, what is merged, what is said of the rest."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.samples import Samples, place


def above(chamber: Chamber, vertices: list[int], height: float = 1.0) -> np.ndarray:
    """Positions at a height in mm over some vertices of the sphere."""
    return np.asarray(chamber.mesh.vertices[vertices] * (1 + height / 30.0))


def test_samples_off_the_surface_are_projected_not_snapped(sphere_chamber: Chamber) -> None:
    corners = sphere_chamber.mesh.vertices[sphere_chamber.mesh.faces[100]]
    inside = np.array([0.2, 0.3, 0.5]) @ corners
    normal = sphere_chamber.mesh.face_normals[100]
    placed = place(
        Samples([inside + 2 * normal / np.linalg.norm(normal)], [7.0], name="LAT", unit="ms"),
        sphere_chamber,
    )
    assert np.allclose(placed.sites.positions(sphere_chamber.mesh), inside, atol=1e-9)
    assert placed.distances == pytest.approx([2.0])
    assert (placed.name, placed.unit, placed.remarks) == ("LAT", "ms", ())
    # A map that is linear in space is itself at the site.
    linear = sphere_chamber.mesh.vertices @ [1.0, -2.0, 0.5]
    assert placed.sites.of(linear) == pytest.approx([inside @ [1.0, -2.0, 0.5]])


def test_everything_left_out_is_counted_and_named(open_chamber: Chamber) -> None:
    top = int(open_chamber.mesh.vertices[:, 2].argmax())
    positions = np.vstack(
        [
            above(open_chamber, [3, 40, 77]),
            above(open_chamber, [5], 9.0),
            above(open_chamber, [top]),
            [[np.nan, 0, 0]],
            above(open_chamber, [90]),
        ]
    )
    values = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, np.nan])
    placed = place(Samples(positions, values), open_chamber)
    assert placed.kept.tolist() == [0, 1, 2]
    assert placed.values.tolist() == [1.0, 2.0, 3.0]
    assert placed.remarks == (
        "2 of 7 samples left out: value, position or noise not finite",
        "1 of 7 samples left out: more than 5 mm off the surface (9.0 mm in the median)",
        "1 of 7 samples left out: over caps or parts not accessible",
    )


def test_repeats_are_averaged_by_inverse_variance(sphere_chamber: Chamber) -> None:
    positions = above(sphere_chamber, [8, 300, 8, 8])
    positions[2] += [0.0, 0.0, 0.03]
    placed = place(
        Samples(positions, [10.0, 50.0, 20.0, 40.0], [1.0, 3.0, 2.0, 2.0], unit="ms"),
        sphere_chamber,
    )
    assert placed.counts.tolist() == [3, 1]
    expected = (10 + 20 / 4 + 40 / 4) / (1 + 1 / 4 + 1 / 4)
    assert placed.values == pytest.approx([expected, 50.0])
    assert placed.noise == pytest.approx([1.5**-0.5, 3.0])
    assert placed.noise_level == pytest.approx(np.sqrt((1 / 1.5 + 9) / 2))
    assert placed.remarks == (
        "3 samples merged into 1 places (values there up to 30 ms from the first)",
    )


def test_without_noise_a_mean_of_four_counts_as_twice_as_sure(sphere_chamber: Chamber) -> None:
    placed = place(
        Samples(above(sphere_chamber, [8, 8, 8, 8, 9]), [1.0, 2.0, 3.0, 4.0, 5.0]), sphere_chamber
    )
    assert placed.noise is None
    assert placed.noise_level is None
    assert placed.noise_shape.tolist() == [0.5, 1.0]


def test_times_on_a_cycle_are_averaged_across_the_seam(sphere_chamber: Chamber) -> None:
    samples = Samples(above(sphere_chamber, [8, 8]), [195.0, 5.0])
    placed = place(samples, sphere_chamber, cycle_length=200.0)
    assert placed.values % 200 == pytest.approx([0.0])
    assert place(samples, sphere_chamber).values == pytest.approx([100.0])


@settings(max_examples=20, deadline=None)
@given(order=st.permutations(range(8)))
def test_the_order_of_samples_does_not_matter(sphere_chamber: Chamber, order: list[int]) -> None:
    positions = above(sphere_chamber, [1, 2, 3, 3, 4, 5, 5, 5])
    values = np.arange(8.0)
    straight = place(Samples(positions, values), sphere_chamber)
    shuffled = place(Samples(positions[order], values[order]), sphere_chamber)
    assert np.allclose(np.sort(shuffled.values), np.sort(straight.values))
    assert sorted(shuffled.counts.tolist()) == sorted(straight.counts.tolist())


def test_no_samples_and_only_bad_ones_are_refused(open_chamber: Chamber) -> None:
    with pytest.raises(InputError, match="there is no sample"):
        place(Samples(np.zeros((0, 3)), []), open_chamber)
    with pytest.raises(InputError, match="none of 2 samples has a finite value"):
        place(Samples(np.zeros((2, 3)), [np.nan, np.inf]), open_chamber)
    top = above(open_chamber, [int(open_chamber.mesh.vertices[:, 2].argmax())])
    with pytest.raises(InputError, match="no sample lies on the accessible surface: 0 are too far"):
        place(Samples(top, [1.0]), open_chamber)


def test_another_frame_or_unit_is_suspected_when_all_lie_far_off(sphere_chamber: Chamber) -> None:
    positions = above(sphere_chamber, [1, 2, 3], 0.0)
    with pytest.raises(InputError, match="all 3 samples lie more than 5 mm off"):
        place(Samples(positions / 1000, [1.0, 2.0, 3.0]), sphere_chamber)
    with pytest.raises(InputError, match=r"170\.0 mm in the median"):
        place(Samples(positions * (200 / 30), [1.0, 2.0, 3.0]), sphere_chamber)


def test_shapes_and_noise_are_checked_at_the_door() -> None:
    with pytest.raises(InputError, match=r"give \(m, 3\) and \(m,\)"):
        Samples(np.zeros((2, 3)), [1.0])
    with pytest.raises(InputError, match=r"give \(m, 3\) and \(m,\)"):
        Samples(np.zeros((2, 2)), [1.0, 2.0])
    with pytest.raises(InputError, match="one positive number a sample"):
        Samples(np.zeros((2, 3)), [1.0, 2.0], [1.0, 0.0])
