from dataclasses import replace

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.imaging.chambers import ATRIUM, VENTRICLE
from auricle.imaging.mask import Mask
from auricle.imaging.region_of_interest import BoxRegion
from auricle.imaging.resampling import mask_on
from auricle.imaging.seed import find_seed, given_seed
from auricle.imaging.segmentation import SegmentationOptions, segment
from auricle.imaging.verdict import SegmentationError, Verdict
from auricle.imaging.volume import Volume
from auricle.simulation.phantom import PhantomOptions, phantom

COARSE = SegmentationOptions(step=2.0)


@pytest.fixture(scope="module")
def patient():
    return phantom(PhantomOptions(preset="tiny", seed=1))


@pytest.fixture(scope="module")
def found(patient):
    return segment(patient.volume, SegmentationOptions(step=1.5))


def dice(one, other):
    return 2.0 * (one & other).sum() / (one.sum() + other.sum())


def refusal_of(volume, options=COARSE):
    with pytest.raises(SegmentationError) as refusal:
        segment(volume, options)
    return refusal.value.code


def test_the_atrium_of_a_phantom_is_found_without_any_hint(patient, found):
    mask = mask_on(found.mask, patient.volume)
    assert dice(mask.voxels, patient.mask.voxels) > 0.95
    assert mask.volume_ml == pytest.approx(patient.mask.volume_ml, rel=0.06)
    assert found.verdict is Verdict.OK
    assert found.measurements["n_veins"] == 4
    assert found.branches[0].kind == "appendage"


def test_the_mitral_plane_lies_at_the_annulus(patient, found):
    offset = found.mitral.centre - patient.truth.mitral_centre
    assert offset @ patient.truth.mitral_normal == pytest.approx(0.0, abs=2.5)
    assert found.mitral.normal @ patient.truth.mitral_normal > np.cos(np.radians(15.0))


def test_the_branches_lie_where_the_veins_and_the_appendage_are(patient, found):
    appendage, *veins = found.branches
    assert np.linalg.norm(appendage.ostium - patient.truth.appendage_tip) < 30.0
    away = np.linalg.norm(patient.truth.ostia[:, None] - [vein.ostium for vein in veins], axis=2)
    assert (away.min(axis=1) < 18.0).all()
    assert len(set(away.argmin(axis=1))) == 4


def test_mask_and_territories_agree_and_the_ventricle_is_beyond_the_plane(found):
    np.testing.assert_array_equal(found.mask.voxels & (found.labels != ATRIUM), False)
    ventricle = found.image.points_at(np.argwhere(found.labels == VENTRICLE))
    beyond = (ventricle - found.mitral.centre) @ found.mitral.normal > 0
    assert beyond.mean() > 0.9
    assert found.volume_ml == found.mask.volume_ml == found.measurements["volume_ml"]


def test_a_flipped_and_permuted_array_of_the_same_patient_gives_the_same_atrium(patient):
    flip = np.eye(4)
    flip[0, 0], flip[0, 3] = -1.0, patient.volume.shape[0] - 1.0
    order = np.eye(4)[[2, 0, 1, 3]].T
    voxels = np.flip(patient.volume.voxels, 0).transpose(2, 0, 1)
    turned = Volume(voxels, patient.volume.affine @ flip @ order)
    np.testing.assert_allclose(
        turned.points_at([3, 5, 7]),
        patient.volume.points_at([patient.volume.shape[0] - 1 - 5, 7, 3]),
    )
    here, there = segment(patient.volume, COARSE), segment(turned, COARSE)
    np.testing.assert_allclose(here.seed.position, there.seed.position, atol=1e-6)
    assert dice(here.mask.voxels, there.mask.voxels) > 0.999


def test_a_seed_anywhere_in_the_atrium_leads_to_its_middle(patient):
    automatic = find_seed(patient.volume)
    beside = given_seed(patient.volume, automatic.position + np.array([8.0, 4.0, -3.0]))
    np.testing.assert_allclose(beside.position, automatic.position)
    assert (beside.given, automatic.given) == (True, False)
    assert patient.truth.distance(automatic.position[None])[0] < -10.0
    assert automatic.margin > 3.0


def test_a_region_of_interest_keeps_the_mask_inside(patient, found):
    low = found.mask.points_at(np.argwhere(found.mask.voxels)).min(axis=0)
    high = found.mask.points_at(np.argwhere(found.mask.voxels)).max(axis=0)
    region = BoxRegion(low + 8.0, high + np.array([9.0, 9.0, -12.0]))
    inside = segment(patient.volume, replace(COARSE, region=region))
    points = inside.mask.points_at(np.argwhere(inside.mask.voxels))
    assert region.contains(points).all()
    assert inside.volume_ml < found.volume_ml


def test_a_short_stub_leaves_less_of_the_veins(patient, found):
    short = segment(patient.volume, SegmentationOptions(step=1.5, vein_stub=4.0))
    assert found.volume_ml - 14.0 < short.volume_ml < found.volume_ml - 2.0


def test_progress_is_told_from_start_to_end(patient):
    told = []
    segment(patient.volume, COARSE, progress=lambda *step: told.append(step))
    assert [done for _, done, _ in told] == [0, 1, 2, 3, 4, 5, 6]


def test_an_image_cut_through_the_atrium_is_told_truncated(patient):
    middle = round(float(patient.volume.index_of(patient.truth.seed)[2])) + 3
    part = Volume(patient.volume.voxels[:, :, :middle], patient.volume.affine)
    cut = segment(part, replace(COARSE, seed=patient.truth.seed - [0.0, 0.0, 6.0]))
    assert cut.verdict is Verdict.CHECK
    assert "truncated" in {reason.code for reason in cut.reasons}


def test_a_scan_without_contrast_is_refused(patient):
    plain = np.minimum(patient.volume.voxels, 60)
    assert refusal_of(Volume(plain, patient.volume.affine)) == "no_contrast"


def test_grey_values_that_are_not_hu_are_refused(patient):
    shifted = (patient.volume.voxels.astype(np.int32) + 1024).astype(np.int16)
    assert refusal_of(Volume(shifted, patient.volume.affine)) == "not_hu"


def test_seeds_in_the_wrong_place_are_refused_by_name(patient):
    outside = patient.volume.points_at([-30, 5, 5])
    lung_index = np.argwhere(patient.volume.voxels[20:-20, 20:-20, 20:-20] < -800)[0] + 20
    lung = patient.volume.points_at(lung_index)
    assert refusal_of(patient.volume, replace(COARSE, seed=outside)) == "seed_outside"
    assert refusal_of(patient.volume, replace(COARSE, seed=lung)) == "seed_not_in_blood"
    region = BoxRegion(patient.truth.seed + 20.0, patient.truth.seed + 60.0)
    options = replace(COARSE, seed=patient.truth.seed, region=region)
    assert refusal_of(patient.volume, options) == "seed_outside"


def test_without_known_axes_a_seed_must_be_given_and_the_verdict_is_check(patient):
    blind = Volume(patient.volume.voxels, patient.volume.affine, orientation_known=False)
    assert refusal_of(blind) == "orientation"
    guided = segment(blind, replace(COARSE, seed=patient.truth.seed))
    assert guided.verdict is Verdict.CHECK
    assert "orientation" in {reason.code for reason in guided.reasons}


def test_thresholds_of_the_user_replace_those_of_the_histogram(patient):
    options = replace(COARSE, lower=200.0, upper=700.0)
    thresholds = segment(patient.volume, options).thresholds
    assert (thresholds.lower, thresholds.upper) == (200.0, 700.0)
    assert refusal_of(patient.volume, replace(COARSE, lower=600.0)) == "seed_not_in_blood"


@pytest.mark.parametrize(
    "wrong", [{"seed": [0.0, 1.0]}, {"seed": [0, 0, np.nan]}, {"step": 9.0}, {"vein_stub": -1.0}]
)
def test_options_out_of_range_are_refused(wrong):
    with pytest.raises(InputError):
        SegmentationOptions(**wrong)


def test_a_mask_of_another_patient_would_not_pass(found):
    other = phantom(PhantomOptions(preset="tiny", seed=2))
    carried = mask_on(Mask(found.mask.voxels, found.mask.affine), other.volume)
    assert dice(carried.voxels, other.mask.voxels) < 0.9


def test_the_real_heart_gives_an_atrium_of_plausible_volume_with_its_leak_named(real_data):
    from auricle.imaging.reading import read_volume

    volume = read_volume(real_data / "volumes/ct-heart/ct_heart_cropped_1.5mm.nii.gz")
    real = segment(volume)
    assert 60.0 < real.volume_ml < 180.0
    assert real.verdict is Verdict.CHECK
    assert [reason.code for reason in real.reasons if reason.stops] == ["leak"]
    assert np.median(real.image.voxels[real.mask.voxels]) == pytest.approx(495.0, abs=15.0)
    assert real.branches[0].kind == "appendage"
    share_of_bright = (real.image.voxels[real.mask.voxels] > 600.0).mean()
    assert share_of_bright < 0.01
