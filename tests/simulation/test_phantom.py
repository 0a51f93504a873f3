"""The phantom: a CT whose every number is what was asked for, and whose truth is its content."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import (
    binary_dilation,
    binary_erosion,
    distance_transform_edt,
    gaussian_filter,
    label,
)

from auricle.simulation import ct_scanner
from auricle.simulation.ct_layers import Tissue
from auricle.simulation.phantom import Phantom, PhantomOptions, phantom, truth_surface
from auricle.simulation.phantom_options import hostile
from auricle.surface.soundness import signed_volume

TINY = PhantomOptions(preset="tiny", seed=3)
CLEAN = replace(TINY, noise=0.0, blur=0.0)


@pytest.fixture(scope="module")
def tiny() -> Phantom:
    return phantom(TINY)


@pytest.fixture(scope="module")
def clean() -> Phantom:
    return phantom(CLEAN)


@pytest.fixture(scope="module")
def small() -> Phantom:
    return phantom(PhantomOptions(preset="small", seed=3))


def where(case: Phantom, tissue: Tissue) -> np.ndarray:
    return case.labels == tissue


def core(case: Phantom, tissue: Tissue, passes: int = 2) -> np.ndarray:
    """HU of the voxels of a tissue away from its border."""
    values = case.volume.voxels[binary_erosion(where(case, tissue), iterations=passes)]
    assert len(values) > 20
    return values.astype(float)


def test_the_image_is_a_chest_of_hounsfield_units_in_lps(small):
    volume = small.volume
    assert volume.voxels.dtype == np.int16
    assert volume.shape == small.labels.shape == (128, 128, 100)
    np.testing.assert_allclose(volume.spacing, (1.6, 1.6, 1.5))
    np.testing.assert_array_equal(volume.direction, np.eye(3))
    assert not volume.voxels.flags.writeable
    assert not small.labels.flags.writeable


def test_the_parts_lie_where_a_supine_patient_has_them(small):
    def middle(tissue):
        return small.volume.points_at(np.argwhere(where(small, tissue))).mean(axis=0)

    atrium = middle(Tissue.LEFT_ATRIUM)
    left, back, up = np.eye(3)
    assert (middle(Tissue.RIGHT_ATRIUM) - atrium) @ left < -20
    assert (middle(Tissue.LEFT_VENTRICLE) - atrium) @ left > 10
    assert (middle(Tissue.LEFT_VENTRICLE) - atrium) @ up < -15
    assert (middle(Tissue.RIGHT_VENTRICLE) - atrium) @ back < -30
    assert (middle(Tissue.SPINAL_CANAL) - atrium) @ back > 40
    assert (middle(Tissue.OESOPHAGUS) - atrium) @ back > 20
    assert (middle(Tissue.PULMONARY_ARTERY) - atrium) @ up > 5
    assert (middle(Tissue.LIVER) - atrium) @ left < -20
    assert (middle(Tissue.LIVER) - atrium) @ up < -50


def test_each_tissue_has_its_density(small):
    for tissue, hu in (
        (Tissue.LEFT_ATRIUM, 400),
        (Tissue.LEFT_VENTRICLE, 388),
        (Tissue.AORTA, 390),
        (Tissue.RIGHT_VENTRICLE, 180),
        (Tissue.PULMONARY_ARTERY, 210),
        (Tissue.MYOCARDIUM, 105),
        (Tissue.LUNG, -860),
        (Tissue.LIVER, 85),
    ):
        assert core(small, tissue).mean() == pytest.approx(hu, abs=4), tissue.name
    assert core(small, Tissue.RIGHT_ATRIUM).mean() == pytest.approx(170, abs=10)
    assert small.volume.voxels[where(small, Tissue.AIRWAY)].min() < -800


def test_vertebrae_are_not_all_of_one_density(clean):
    bone = clean.volume.voxels[where(clean, Tissue.BONE)]
    assert np.percentile(bone, 90) - np.percentile(bone, 10) > 150


def test_the_mask_is_what_the_true_surface_encloses(tiny):
    near = np.argwhere(binary_dilation(tiny.mask.voxels, iterations=3))
    distance = tiny.truth.distance(tiny.volume.points_at(near))
    sure = np.abs(distance) > 1e-3
    np.testing.assert_array_equal(tiny.mask.voxels[tuple(near[sure].T)], distance[sure] < 0)
    assert sure.mean() > 0.99


def test_the_volume_hardly_depends_on_the_voxels(tiny, small):
    exact = signed_volume(truth_surface(tiny.truth, spacing=1.0)) / 1000
    assert tiny.mask.volume_ml == pytest.approx(exact, rel=0.01)
    assert small.mask.volume_ml == pytest.approx(exact, rel=0.005)


def test_the_atrium_is_one_piece_that_opens_only_into_its_veins_and_the_ventricle(small):
    atrium = where(small, Tissue.LEFT_ATRIUM)
    assert label(atrium)[1] == 1
    away = distance_transform_edt(~atrium, sampling=small.volume.spacing)
    assert away[where(small, Tissue.LEFT_VENTRICLE)].min() < 1.7
    assert away[where(small, Tissue.PULMONARY_VEIN)].min() < 1.7
    for tissue in (
        Tissue.RIGHT_ATRIUM,
        Tissue.RIGHT_VENTRICLE,
        Tissue.PULMONARY_ARTERY,
        Tissue.VENA_CAVA,
        Tissue.AORTA,
        Tissue.LUNG,
    ):
        assert away[where(small, tissue)].min() >= 2.0, tissue.name
    ventricle = np.argwhere(where(small, Tissue.LEFT_VENTRICLE) & (away < 1.7))
    touching = small.volume.points_at(ventricle) - small.truth.mitral_centre
    beside = np.linalg.norm(np.cross(touching, small.truth.mitral_normal), axis=1)
    assert beside.max() < small.truth.mitral_radius + 2.0
    veins = where(small, Tissue.PULMONARY_VEIN)
    assert label(veins | atrium)[1] == 1


def test_the_ventricle_begins_at_the_annulus(small):
    truth = small.truth
    places = truth.mitral_centre + np.array([[-5.0], [11.0]]) * truth.mitral_normal
    indices = np.round(small.volume.index_of(places)).astype(int)
    found = [Tissue(small.labels[tuple(index)]) for index in indices]
    assert found == [Tissue.LEFT_ATRIUM, Tissue.LEFT_VENTRICLE]


def test_the_noise_is_as_strong_as_asked(clean):
    noisy = phantom(replace(CLEAN, noise=30.0))
    added = noisy.volume.voxels.astype(float) - clean.volume.voxels
    assert added[clean.volume.voxels > -900].std() == pytest.approx(30.0, rel=0.02)
    np.testing.assert_array_equal(noisy.labels, clean.labels)


def test_the_blur_is_as_wide_as_asked(clean):
    soft = phantom(replace(CLEAN, blur=3.0))
    expected = gaussian_filter(
        clean.volume.voxels.astype(float), 3.0 / clean.volume.spacing, mode="nearest"
    )
    np.testing.assert_allclose(soft.volume.voxels, expected, atol=4.0)


def test_the_same_options_give_the_same_bytes_in_slabs_of_any_height(monkeypatch):
    options = replace(TINY, blur=2.0)
    once = phantom(options)
    monkeypatch.setattr(ct_scanner, "_SLAB_VOXELS", 64 * 64 * 7)
    again = phantom(options)
    assert again.volume.voxels.tobytes() == once.volume.voxels.tobytes()
    assert again.labels.tobytes() == once.labels.tobytes()
    assert again.volume.affine.tobytes() == once.volume.affine.tobytes()


def test_another_seed_is_another_patient(tiny):
    other = phantom(replace(TINY, seed=4))
    assert (other.labels != tiny.labels).mean() > 0.05
    assert abs(other.mask.volume_ml - tiny.mask.volume_ml) > 1.0


def test_contrast_changes_the_image_but_not_the_patient(clean):
    dark = phantom(replace(CLEAN, contrast=220.0))
    np.testing.assert_array_equal(dark.labels, clean.labels)
    assert core(dark, Tissue.LEFT_ATRIUM).mean() == pytest.approx(220.0, abs=1)


def test_an_oblique_image_shows_the_same_truth(clean):
    oblique = phantom(replace(CLEAN, oblique=20.0))
    assert oblique.mask.volume_ml == pytest.approx(clean.mask.volume_ml, rel=0.01)
    turned = np.degrees(np.arccos((np.trace(oblique.volume.direction) - 1) / 2))
    assert turned == pytest.approx(20.0)
    assert np.linalg.det(oblique.volume.direction) == pytest.approx(1.0)
    inside = oblique.volume.points_at(np.argwhere(oblique.mask.voxels))
    assert (clean.truth.distance(inside) < 1e-3).all()


def test_a_thin_gap_brings_the_aorta_to_the_atrium(small):
    thin = phantom(replace(small.options, aorta_gap=0.3))
    near = []
    for case in (small, thin):
        aorta = case.volume.points_at(np.argwhere(where(case, Tissue.AORTA)))
        near.append(case.truth.distance(aorta).min())
    assert 2.0 <= near[0] < 2.5
    assert 0.3 <= near[1] < 0.8


def test_a_thin_wall_is_thinner(clean):
    thin = phantom(replace(CLEAN, wall=0.8))
    walls = [(where(case, Tissue.ATRIAL_WALL)).sum() for case in (clean, thin)]
    assert walls[1] < 0.6 * walls[0]
    np.testing.assert_array_equal(thin.mask.voxels, clean.mask.voxels)


def test_a_filling_defect_darkens_the_appendage_but_not_the_truth(clean):
    defect = phantom(hostile("filling_defect", CLEAN))
    np.testing.assert_array_equal(defect.labels, clean.labels)
    tip = np.round(clean.volume.index_of(clean.truth.appendage_tip[None])[0]).astype(int)
    assert clean.volume.voxels[tuple(tip)] > 300
    assert defect.volume.voxels[tuple(tip)] < 150
    seed = np.round(clean.volume.index_of(clean.truth.seed[None])[0]).astype(int)
    assert defect.volume.voxels[tuple(seed)] == clean.volume.voxels[tuple(seed)]


def test_motion_shifts_bands_of_slices_by_what_was_asked(clean):
    moved = phantom(replace(CLEAN, motion=6.4))
    np.testing.assert_array_equal(moved.labels, clean.labels)
    same = (moved.volume.voxels == clean.volume.voxels).all(axis=(0, 1))
    band = (np.arange(50) * 3.0 // 24.0).astype(int) % 2
    np.testing.assert_array_equal(same, band == 0)


def test_a_lead_is_of_metal_and_casts_streaks():
    bare = phantom(replace(CLEAN, lead=True))
    streaked = phantom(hostile("lead", CLEAN))
    assert where(bare, Tissue.LEAD).any()
    assert bare.volume.voxels.max() > 1000
    rays = streaked.volume.voxels.astype(float) - bare.volume.voxels
    assert 40 < np.abs(rays).max() <= 60.5
    assert np.abs(rays[where(bare, Tissue.LEFT_ATRIUM)]).mean() > 5


def test_without_contrast_the_blood_is_as_dark_as_the_muscle(clean):
    plain = phantom(hostile("no_contrast", CLEAN))
    np.testing.assert_array_equal(plain.labels, clean.labels)
    for tissue in (Tissue.LEFT_ATRIUM, Tissue.MYOCARDIUM, Tissue.RIGHT_VENTRICLE):
        assert abs(core(plain, tissue, 1).mean() - 45) < 12


def test_a_closed_valve_bars_the_way_to_the_ventricle(small):
    closed = phantom(hostile("mitral_closed", small.options))
    way = closed.truth.mitral_centre + np.arange(0.0, 14.0)[:, None] * closed.truth.mitral_normal
    i, j, k = np.round(closed.volume.index_of(way)).astype(int).T
    assert small.volume.voxels[i, j, k].min() > 320
    assert closed.volume.voxels[i, j, k].min() < 280


def test_an_image_off_centre_cuts_the_atrium_but_not_the_truth(clean):
    cut = phantom(hostile("truncated", CLEAN))
    assert cut.mask.voxels[0].any()
    assert 0.3 < cut.mask.volume_ml / clean.mask.volume_ml < 0.9
    np.testing.assert_array_equal(cut.truth.seed, clean.truth.seed)


def test_progress_is_told_and_may_cancel(monkeypatch):
    monkeypatch.setattr(ct_scanner, "_SLAB_VOXELS", 64 * 64 * 20)
    told = []
    phantom(TINY, progress=lambda *news: told.append(news))
    assert told == [("painting", done, 50) for done in (20, 40, 50)]

    def cancel(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        phantom(TINY, progress=cancel)


def test_every_label_has_a_name(small):
    assert {small.tissues[int(found)] for found in np.unique(small.labels)} >= {
        "air",
        "left atrium",
        "left ventricle",
        "pulmonary vein",
        "mitral valve",
        "coronary vessel",
        "spinal canal",
    }


@pytest.mark.slow
def test_a_clinical_phantom_takes_little_time_and_memory():
    script = (
        "import resource, time; from auricle.simulation.phantom import *;"
        "case = phantom(PhantomOptions(preset='clinical'));"
        "print(time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True)
    seconds, kilobytes = map(float, done.stdout.split())
    assert seconds < 90
    assert kilobytes < 1.2 * 1024**2
