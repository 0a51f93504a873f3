from contextlib import suppress

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from auricle.errors import SurfaceError
from auricle.imaging.labels import label_mask
from auricle.imaging.mask import Mask
from auricle.imaging.segmentation import SegmentationOptions, segment
from auricle.simulation.phantom import PhantomOptions, phantom
from auricle.surface.endocardium import endocardium, endocardium_of_mask


@pytest.fixture(scope="module")
def patient():
    return phantom(PhantomOptions(preset="tiny", seed=1))


@pytest.fixture(scope="module")
def found(patient):
    return segment(patient.volume, SegmentationOptions(step=1.5))


@pytest.fixture(scope="module")
def surface(patient, found):
    return endocardium(patient.volume, found)


def lattice_mask(inside, *, spacing=(1.0, 1.0, 1.0), shape=(60, 60, 60), turn=None):
    """A mask of the points, about the lattice's middle, for which `inside` holds."""
    affine = np.eye(4)
    axes = np.eye(3) if turn is None else turn
    affine[:3, :3] = axes * spacing
    affine[:3, 3] = -affine[:3, :3] @ (np.array(shape) / 2 - 0.37)
    points = np.indices(shape).reshape(3, -1).T @ affine[:3, :3].T + affine[:3, 3]
    return Mask(inside(points).reshape(shape), affine)


def ball(points):
    return np.linalg.norm(points, axis=1) < 20.0


def torus(points):
    ring = np.hypot(points[:, 0], points[:, 1]) - 16.0
    return np.hypot(ring, points[:, 2]) < 6.0


def is_sphere_like(soundness):
    closed = soundness.is_closed and soundness.is_manifold and soundness.is_oriented
    return closed and soundness.n_pieces == 1 and soundness.genus == 0


def test_the_surface_of_a_phantom_is_closed_and_faces_outward(surface, found):
    assert is_sphere_like(surface.soundness)
    assert surface.soundness.volume_mm3 / 1000 == pytest.approx(found.volume_ml, rel=0.05)
    assert surface.soundness.smallest_quality > 0.01


def test_the_endocardium_lies_where_it_truly_is_to_a_tenth_of_a_voxel(surface, patient):
    vertices = surface.mesh.vertices
    truth = patient.truth
    to_ostia = np.linalg.norm(vertices[:, None] - truth.ostia, axis=2).min(axis=1)
    to_valve = (truth.mitral_centre - vertices) @ truth.mitral_normal
    error = truth.distance(vertices[(to_ostia > 20.0) & (to_valve > 5.0)])
    assert len(error) > 500
    assert np.abs(error).mean() < 0.32
    assert abs(np.median(error)) < 0.2


def test_a_finer_lattice_has_more_vertices_on_the_same_surface(patient, found, surface):
    finer = endocardium(patient.volume, found, spacing=1.0)
    ratio = finer.mesh.n_vertices / surface.mesh.n_vertices
    assert ratio == pytest.approx((surface.spacing / 1.0) ** 2, rel=0.1)
    assert finer.soundness.volume_mm3 == pytest.approx(surface.soundness.volume_mm3, rel=0.02)


@pytest.mark.parametrize("spacing", [(1.0, 1.0, 1.0), (0.8, 1.0, 2.0)])
@pytest.mark.parametrize("angles", [(0, 0, 0), (10, 25, -40)])
def test_a_mask_of_a_ball_on_any_lattice_becomes_that_ball(spacing, angles):
    turn = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
    shape = tuple(np.ceil(48.0 / np.array(spacing)).astype(int))
    found = endocardium_of_mask(lattice_mask(ball, spacing=spacing, shape=shape, turn=turn))
    assert is_sphere_like(found.soundness)
    radii = np.linalg.norm(found.mesh.vertices, axis=1)
    assert np.abs(radii - 20.0).mean() < 0.25 * max(spacing)
    assert found.soundness.volume_mm3 == pytest.approx(4 / 3 * np.pi * 20.0**3, rel=0.02)


def test_a_flipped_lattice_gives_a_surface_that_still_faces_outward():
    mirror = np.diag([-1.0, 1.0, 1.0])
    found = endocardium_of_mask(lattice_mask(ball, turn=mirror))
    assert found.soundness.volume_mm3 > 0


def test_a_handle_is_opened_and_counted():
    found = endocardium_of_mask(lattice_mask(torus))
    assert is_sphere_like(found.soundness)
    [repair] = found.repairs
    assert repair.name == "voxels cut to open handles"
    assert (repair.count > 0, repair.detail) == (True, "1 of them")
    assert found.soundness.volume_mm3 == pytest.approx(2 * np.pi**2 * 16 * 36, rel=0.06)


def test_cavities_are_filled_and_loose_pieces_dropped_and_both_counted():
    def spoilt(points):
        hollow = ball(points) & ~(np.linalg.norm(points - [5, 0, 0], axis=1) < 4.0)
        return hollow | (np.linalg.norm(points - [24, 24, 0], axis=1) < 2.5)

    found = endocardium_of_mask(lattice_mask(spoilt))
    assert is_sphere_like(found.soundness)
    names = [repair.name for repair in found.repairs]
    assert names == ["detached voxels dropped", "voxels of cavities filled"]
    assert found.soundness.volume_mm3 == pytest.approx(4 / 3 * np.pi * 20.0**3, rel=0.02)


def test_a_mask_that_fills_its_lattice_is_closed_at_the_edge():
    found = endocardium_of_mask(Mask(np.ones((20, 20, 20), bool), np.diag([2.0, 2.0, 2.0, 1.0])))
    assert is_sphere_like(found.soundness)
    assert found.soundness.volume_mm3 == pytest.approx(40.0**3, rel=0.03)


def test_noise_ends_in_a_sound_surface_or_a_clear_refusal(rng):
    for share in (0.5, 0.8):
        noise = rng.random((24, 24, 24)) < share
        with suppress(SurfaceError):
            found = endocardium_of_mask(Mask(noise, np.eye(4)))
            assert is_sphere_like(found.soundness)


def test_an_empty_mask_is_refused():
    with pytest.raises(SurfaceError, match="empty"):
        endocardium_of_mask(Mask(np.zeros((5, 5, 5), bool), np.eye(4)))


@pytest.mark.parametrize(
    "name", ["wh_labels.nii.gz", pytest.param("mmwhs_labels.nii.gz", marks=pytest.mark.slow)]
)
def test_real_label_maps_become_closed_surfaces_of_their_volume(real_data, name):
    mask = label_mask(real_data / "volumes/heart-labels" / name, 2)
    found = endocardium_of_mask(mask, spacing=0.8)
    assert is_sphere_like(found.soundness)
    assert found.soundness.volume_mm3 / 1000 == pytest.approx(mask.volume_ml, rel=0.01)
