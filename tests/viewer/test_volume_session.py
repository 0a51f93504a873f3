import json
from dataclasses import replace

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.imaging.dicom_writing import write_dicom_series
from auricle.imaging.segmentation import segment
from auricle.imaging.writing import write_volume
from auricle.simulation.phantom import PhantomOptions, phantom
from auricle.study.segmented import SegmentationConfig, segment_file
from auricle.viewer.endpoints import Call, Work
from auricle.viewer.open_case import OpenCase
from auricle.viewer.opening import Detail
from auricle.viewer.segment_routes import ENDPOINTS, config_of, trial_document
from auricle.viewer.volume_session import SKETCH_MM, VolumeSession, volume_session
from auricle.viewer.work_stream import CancelledError
from auricle.viewer.workspace import Workspace

CONFIG = SegmentationConfig(lower_hu=250.0, cuts_mm=((0.0, -150.0, -620.0, 5.0),))


@pytest.fixture(scope="module")
def patient():
    return phantom(PhantomOptions(preset="tiny", seed=1))


@pytest.fixture(scope="module")
def path(patient, tmp_path_factory):
    place = tmp_path_factory.mktemp("scan") / "volume.nrrd"
    write_volume(patient.volume, place)
    return place


@pytest.fixture(scope="module")
def session(path):
    return volume_session(path)


def answered(session, address, *, method="GET", path=None, body=None, folder=None):
    workspace = Workspace(folder)
    workspace.put(session)
    workspace.put(Detail(n_vertices=400, n_modes=30))
    (endpoint,) = [each for each in ENDPOINTS if (each.method, each.address) == (method, address)]
    call = Call(workspace, path or {}, body=json.dumps(body or {}).encode())
    answer = endpoint.answer(call)
    return (answer.run(lambda *_: None) if isinstance(answer, Work) else answer), workspace


def test_the_page_draws_the_values_of_the_volume(session, patient):
    drawn, place = session.shown, patient.truth.seed
    of_volume = patient.volume.voxels[tuple(np.round(patient.volume.index_of(place)).astype(int))]
    of_page = drawn.voxels[tuple(np.round(drawn.index_of(place)).astype(int))]
    assert of_page == pytest.approx(float(of_volume), abs=120.0)
    content, _ = answered(session, "/api/segment/voxels")
    nx, ny, nz = drawn.shape
    np.testing.assert_array_equal(
        np.frombuffer(content, "<i2").reshape(nz, ny, nx).transpose(2, 1, 0), drawn.voxels
    )


def test_a_sketch_is_the_segmentation_of_the_pipeline_at_its_own_spacing(session, patient):
    session.trial(SegmentationConfig(), sketch=True)
    shown = session.trial(CONFIG, sketch=True)
    alone = segment(patient.volume, replace(CONFIG.options, step=SKETCH_MM))
    np.testing.assert_array_equal(shown.found.mask.voxels, alone.mask.voxels)
    assert shown.found.reasons == alone.reasons
    document = trial_document(shown)
    assert document["sketch"] is True
    assert document["step_mm"] == SKETCH_MM
    assert document["volume_ml"] == alone.volume_ml


@pytest.mark.slow
def test_the_preview_is_the_result_voxel_for_voxel(session, path, tmp_path):
    body = {"config": {"lower_hu": CONFIG.lower_hu, "cuts_mm": [list(CONFIG.cuts_mm[0])]}}
    document, _ = answered(
        session, "/api/segment/preview", method="POST", body=body, folder=tmp_path
    )
    content, _ = answered(session, "/api/segment/mask/{key}", path={"key": document["key"]})
    nx, ny, nz = document["mask_shape"]
    seen = np.frombuffer(content, np.uint8).reshape(nz, ny, nx).transpose(2, 1, 0).astype(bool)
    case = session.accept(document["key"])
    commanded = segment_file(path, CONFIG)
    for found in (case, commanded):
        np.testing.assert_array_equal(seen, found.segmentation.mask.voxels)
        assert document["mask_origin_mm"] == found.segmentation.mask.origin.tolist()
        assert document["step_mm"] == found.segmentation.mask.spacing[0]
        assert document["volume_ml"] == found.segmentation.volume_ml
    np.testing.assert_array_equal(case.mask.voxels, commanded.mask.voxels)
    np.testing.assert_array_equal(
        case.endocardium.mesh.vertices, commanded.endocardium.mesh.vertices
    )
    assert case.source == commanded.source


def test_the_page_gets_the_mask_the_session_found(session, tmp_path):
    body = {"config": {"lower_hu": 250.0}}
    document, _ = answered(
        session, "/api/segment/sketch", method="POST", body=body, folder=tmp_path
    )
    content, _ = answered(session, "/api/segment/mask/{key}", path={"key": document["key"]})
    inside = np.frombuffer(content, np.uint8)
    ml = inside.sum() * document["step_mm"] ** 3 / 1000
    assert ml == pytest.approx(document["volume_ml"])
    assert inside.size == np.prod(document["mask_shape"])


def test_a_refusal_is_an_answer_with_its_reason(session, tmp_path):
    body = {"config": {"seed_mm": [0, 0, 0]}}
    document, _ = answered(
        session, "/api/segment/sketch", method="POST", body=body, folder=tmp_path
    )
    assert document["verdict"] == "refused"
    (reason,) = document["reasons"]
    assert reason["code"] == "seed_outside"
    assert reason["cause"].endswith("lies outside the volume or the region")
    with pytest.raises(InputError, match="no mask"):
        answered(session, "/api/segment/mask/{key}", path={"key": document["key"]})


def test_going_back_to_parameters_tried_before_takes_no_second_segmentation(session):
    first = session.trial(CONFIG, sketch=True)
    session.trial(SegmentationConfig(lower_hu=260.0), sketch=True)

    def unwanted(*_):
        pytest.fail("segmented again")

    assert session.trial(CONFIG, sketch=True, progress=unwanted) is first


def test_a_sketch_cannot_be_accepted_nor_a_file_had_before(session):
    fresh = VolumeSession(session.volume, session.source, session.shown)
    key = fresh.trial(CONFIG, sketch=True).key
    with pytest.raises(InputError, match="wait for the preview"):
        fresh.accept(key)
    with pytest.raises(InputError, match="accept first"):
        answered(fresh, "/api/segment/file/{name}", path={"name": "mask.nrrd"})


def test_cancelled_work_leaves_nothing_behind(session):
    def cancel(*told):
        if told[0] == "chambers":
            raise CancelledError

    config = SegmentationConfig(lower_hu=244.0)
    with pytest.raises(CancelledError):
        session.trial(config, sketch=True, progress=cancel)
    assert session.trial(config, sketch=True).found is not None


@pytest.mark.parametrize(
    "wrong",
    [
        {"seed_mm": [1, 2]},
        {"seed_mm": "1,2,3"},
        {"lower_hu": "a"},
        {"lower_hu": True},
        {"lower_hu": float("nan")},
        {"cuts_mm": [[1, 2, 3]]},
        {"spacing": 3},
        {"region_mm": [[0, 0, 0]] * 501},
        ["seed_mm"],
    ],
)
def test_parameters_that_are_none_are_refused(wrong):
    with pytest.raises(InputError):
        config_of(wrong).options  # noqa: B018


@pytest.mark.slow
def test_an_accepted_atrium_opens_beside_its_ct(session, tmp_path):
    key = session.trial(SegmentationConfig()).key
    answer, workspace = answered(
        session, "/api/segment/accept", method="POST", body={"key": key}, folder=tmp_path
    )
    opened = workspace.require(OpenCase, "no case")
    assert workspace.described()["views"] == ["segment", "explore", "plan"]
    assert opened.prepared.space == "LPS"
    assert opened.prepared.as_read.volume_mm3 / 1000 == pytest.approx(answer["volume_ml"])
    for name, begin in [("mask.nrrd", b"NRRD"), ("surface.vtp", b"<"), ("result.json", b"{")]:
        content, _ = answered(
            session, "/api/segment/file/{name}", path={"name": name}, folder=tmp_path
        )
        assert content.startswith(begin)
    assert list(tmp_path.iterdir()) == []


def test_nothing_of_a_dicom_header_or_of_its_folder_reaches_the_page(patient, tmp_path):
    folder = tmp_path / "CANARYNAME^ANNA 19530412"
    write_dicom_series(patient.volume, folder)
    plant(folder)
    session = volume_session(folder)
    document = trial_document(session.trial(SegmentationConfig(), sketch=True))
    told = json.dumps([dict(session.described()), document])
    assert "CANARY" not in told
    assert "19530412" not in told
    assert session.described()["volume"]["name"] == "DICOM series"


def plant(folder):
    import pydicom

    for place in folder.iterdir():
        header = pydicom.dcmread(place)
        header.PatientName, header.PatientID = "CANARYNAME^ANNA", "CANARYID"
        header.PatientBirthDate, header.InstitutionName = "19530412", "CANARYHOSPITAL"
        header.SeriesDescription = "CANARYNAME heart"
        header.save_as(place)
