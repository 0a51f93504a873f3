"""`auricle phantom`, `segment` and `analyze` of a CT, from the command line."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pydicom
import pytest

from auricle.cli.app import main
from auricle.cli.volume_steps import FoundAtrium
from auricle.imaging.dicom_writing import write_dicom_series
from auricle.imaging.labels import label_mask
from auricle.imaging.reading import read_volume
from auricle.imaging.volume import Volume
from auricle.imaging.writing import write_volume
from auricle.study.segmented import SegmentationConfig, segment_file
from auricle.surface.cleaning import clean
from auricle.surface.reading import read_surface

FILES = {"report.html", "result.json", "mask.nrrd", "surface.vtp", "timings.json", "figures"}
PERSON = {
    "PatientName": "Zyxwv^Qponm",
    "PatientID": "MRN7654321",
    "PatientBirthDate": "19470203",
    "PatientAddress": "Elm Street 99",
    "OtherPatientIDs": "ALT8899",
    "AccessionNumber": "ACC445566",
    "InstitutionName": "Hospital Vwxyz",
    "ReferringPhysicianName": "Drjkl^Mnbvc",
    "OperatorsName": "Opqwe^Rtyui",
    "StationName": "STATIONXQ",
    "DeviceSerialNumber": "SER998877",
    "StudyDate": "20190817",
    "SeriesDate": "20190818",
    "AcquisitionDate": "20190819",
    "ContentDate": "20190821",
    "StudyDescription": "Studywords Zyxwv",
    "SeriesDescription": "Serieswords Zyxwv",
    "ProtocolName": "Protocolwords Zyxwv",
    "StudyID": "STU5544",
    "PatientComments": "Commentwords",
    "StudyInstanceUID": "1.2.826.0.1.7777.1",
    "FrameOfReferenceUID": "1.2.826.0.1.7777.3",
}


@pytest.fixture
def inside(monkeypatch, capsys):
    """Runs `auricle ARGUMENTS…` in this process, which has all libraries loaded already."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        monkeypatch.setattr(sys, "argv", ["auricle", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        said = capsys.readouterr()
        return subprocess.CompletedProcess([], ended.value.code or 0, said.out, said.err)

    return run


@pytest.fixture(scope="module")
def scan(auricle, tmp_path_factory) -> Path:
    """A generated CT as a DICOM folder, with its labels and its truth."""
    folder = tmp_path_factory.mktemp("scan") / "made"
    done = auricle("phantom", "-o", folder, "--preset", "tiny", "--seed", 1, "--as", "dicom")
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith(f"{folder / 'volume'}\n")
    return folder


@pytest.fixture(scope="module")
def volume(scan) -> Volume:
    return read_volume(scan / "volume")


@pytest.fixture(scope="module")
def marked(scan, tmp_path_factory) -> Path:
    """The same series with a person in every tag that can hold one, its files out of order."""
    folder = tmp_path_factory.mktemp("marked") / "series"
    folder.mkdir()
    files = sorted((scan / "volume").iterdir())
    order = np.random.default_rng(4).permutation(len(files)).tolist()
    for number, path in zip(order, files, strict=True):
        dataset = pydicom.dcmread(path)
        for keyword, value in PERSON.items():
            setattr(dataset, keyword, value)
        dataset.save_as(folder / f"z{number}", enforce_file_format=True)
    return folder


@pytest.fixture(scope="module")
def analysis(auricle, marked, tmp_path_factory) -> Path:
    """The whole way from the marked series to the answer, with what was said beside it."""
    folder = tmp_path_factory.mktemp("analysis") / "out"
    done = auricle(
        *("analyze", marked, "-o", folder, "-n", 500, "-k", 40),
        *("--focus-width", 12, "--focus-count", 1),
        AURICLE_CACHE=str(folder.parent / "cache"),
    )
    assert done.returncode == 0, done.stderr
    (folder.parent / "said").write_text(done.stdout + done.stderr)
    return folder


def test_the_truth_stands_beside_the_generated_image(scan, volume) -> None:
    truth = json.loads((scan / "truth.json").read_text())
    surface = clean(read_surface(scan / "truth.vtp")).soundness
    assert surface.volume_mm3 / 1000 == pytest.approx(truth["volume_ml"])
    label = next(int(n) for n, name in truth["labels"].items() if name == "left atrium")
    mask = label_mask(scan / "labels.nrrd", label)
    assert mask.volume_ml == pytest.approx(truth["mask_volume_ml"])
    np.testing.assert_allclose(mask.affine, volume.affine, atol=1e-6)
    seed = np.round(mask.index_of(truth["landmarks"]["seed_mm"])).astype(int)
    assert mask.voxels[tuple(seed)]


def test_the_same_seed_gives_the_same_bytes_in_every_file(auricle, tmp_path) -> None:
    for name in ("one", "two"):
        done = auricle("phantom", "-o", tmp_path / name, "--preset", "tiny", "--as", "nifti")
        assert done.returncode == 0, done.stderr
    for path in (tmp_path / "one").iterdir():
        assert path.read_bytes() == (tmp_path / "two" / path.name).read_bytes(), path.name


def test_analyze_goes_from_the_scan_to_one_report_with_its_pictures(scan, analysis) -> None:
    assert {path.name for path in (analysis / "segmentation").iterdir()} == FILES
    page = (analysis / "report.html").read_text()
    for words in ("The left atrium in the scan", "The atrium in the CT", "verdict: ok"):
        assert words in page
    result = json.loads((analysis / "result.json").read_text())
    found = result["segmentation"]
    truth = json.loads((scan / "truth.json").read_text())
    assert found["volume_ml"] == pytest.approx(truth["volume_ml"], rel=0.05)
    assert result["surface_as_read"]["genus"] == 0
    assert found == json.loads((analysis / "segmentation" / "result.json").read_text())


def test_the_mask_lies_on_the_lattice_of_the_scan_and_the_surface_encloses_it(
    volume, analysis
) -> None:
    mask = label_mask(analysis / "segmentation" / "mask.nrrd", 1)
    np.testing.assert_allclose(mask.affine, volume.affine, atol=1e-6)
    assert mask.shape == volume.shape
    surface = read_surface(analysis / "segmentation" / "surface.vtp")
    assert surface.space == "LPS"
    found = clean(surface).soundness
    assert (found.is_closed, found.genus) == (True, 0)
    assert found.volume_mm3 / 1000 == pytest.approx(mask.volume_ml, rel=0.06)


def test_no_identity_of_the_scan_is_in_any_output_or_word_or_cache(analysis) -> None:
    places = [path for path in analysis.parent.rglob("*") if path.is_file()]
    assert {"result.json", "report.html", "surface.vtp", "said"} <= {p.name for p in places}
    for path in places:
        content = path.read_bytes().lower()
        for keyword, value in PERSON.items():
            for part in value.split("^"):
                assert part.lower().encode() not in content, f"{keyword} in {path.name}"
        assert str(analysis.parents[1]).encode() not in content or path.name == "said"


def test_the_order_of_the_files_and_who_is_in_them_change_no_byte(inside, scan, analysis, tmp_path):
    """The same voxels in another folder: the same mask, surface, report and numbers."""
    done = inside("segment", scan / "volume", "-o", tmp_path / "plain")
    assert done.returncode == 0, done.stderr
    for path in (tmp_path / "plain").rglob("*"):
        if path.is_file() and path.name != "timings.json":
            other = analysis / "segmentation" / path.relative_to(tmp_path / "plain")
            assert path.read_bytes() == other.read_bytes(), path.name


def test_one_file_of_the_voxels_gives_the_surface_of_the_series(volume, analysis, tmp_path) -> None:
    write_volume(volume, tmp_path / "scan.nii.gz")
    again = segment_file(tmp_path / "scan.nii.gz").endocardium.mesh
    first = read_surface(analysis / "segmentation" / "surface.vtp")
    np.testing.assert_allclose(first.vertices, again.vertices, atol=1e-3)


def test_a_label_map_is_meshed_alone_and_beside_its_scan(inside, scan, tmp_path) -> None:
    truth = json.loads((scan / "truth.json").read_text())
    label = next(int(n) for n, name in truth["labels"].items() if name == "left atrium")
    done = inside("segment", scan / "labels.nrrd", "--label", label, "-o", tmp_path / "alone")
    assert done.returncode == 0, done.stderr
    found = clean(read_surface(tmp_path / "alone" / "surface.vtp"))
    assert (found.soundness.is_closed, found.soundness.genus) == (True, 0)
    expected = pytest.approx(truth["mask_volume_ml"], rel=0.02)
    assert found.soundness.volume_mm3 / 1000 == expected
    beside = segment_file(
        scan / "volume", SegmentationConfig(label=(label,)), labels=scan / "labels.nrrd"
    )
    assert beside.volume_ml == expected
    assert beside.labels_source.name == "labels.nrrd"


def test_a_verdict_of_check_stops_after_writing_unless_it_is_accepted(
    inside, volume, scan, tmp_path
) -> None:
    truth = json.loads((scan / "truth.json").read_text())
    seed = np.array(truth["landmarks"]["seed_mm"])
    top = round(float(volume.index_of(seed)[2])) + 3
    cut = tmp_path / "cut.nrrd"
    write_volume(Volume(volume.voxels[:, :, :top], volume.affine), cut)
    place = ",".join(map(str, (seed - [0, 0, 6]).tolist()))
    stopped = inside("analyze", cut, "--seed-point", place, "-o", tmp_path / "out")
    assert stopped.returncode == 3
    assert "check: truncated: " in stopped.stderr
    assert stopped.stderr.splitlines()[-1].startswith(f"auricle: {cut}: verdict check (truncated)")
    folder = tmp_path / "out" / "segmentation"
    assert json.loads((folder / "result.json").read_text())["verdict"] == "check"
    assert not (tmp_path / "out" / "report.html").exists()
    case = segment_file(cut, SegmentationConfig(seed_mm=tuple(seed - [0, 0, 6])))
    FoundAtrium(cut, case, {}, cut, cut).require_accepted(True)


def refused(done, path: Path, folder: Path) -> str:
    assert done.returncode == 3, done.stderr
    assert done.stderr.startswith(f"auricle: {path}: "), done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stdout == ""
    assert not folder.exists()
    return done.stderr


def changed(folder: Path, target: Path, change) -> Path:
    """A copy of a series, each dataset as `change(dataset)` leaves it, or not at all."""
    target.mkdir()
    for path in sorted(folder.iterdir()):
        dataset = pydicom.dcmread(path)
        if change(dataset) is not False:
            dataset.save_as(target / path.name, enforce_file_format=True)
    return target


def without_one(dataset):
    return dataset.InstanceNumber != 21


def doubled(dataset):
    if dataset.InstanceNumber == 21:
        dataset.ImagePositionPatient = [*dataset.ImagePositionPatient[:2], "-700"]


def tilted(dataset):
    c, s = np.cos(0.2), np.sin(0.2)
    dataset.ImageOrientationPatient = [1, 0, 0, 0, round(float(c), 6), round(float(s), 6)]


def flat(dataset):
    dataset.PixelSpacing = [0, 0]


def alone(dataset):
    return dataset.InstanceNumber == 21


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        (without_one, "IM0020.dcm"),
        (doubled, ""),
        (tilted, "tilt"),
        (flat, "spacing"),
        (alone, "only slice"),
    ],
)
def test_a_series_that_is_no_even_stack_ends_in_one_line(
    inside, scan, tmp_path, change, cause
) -> None:
    folder = changed(scan / "volume", tmp_path / "bad", change)
    line = refused(inside("segment", folder, "-o", tmp_path / "out"), folder, tmp_path / "out")
    assert cause in line


def bad_files(volume: Volume, folder: Path) -> dict[str, Path]:
    plain = Volume(np.minimum(volume.voxels, 60), volume.affine)
    write_volume(plain, folder / "plain.nrrd")
    shifted = Volume((volume.voxels.astype(np.int32) + 1024).astype(np.int16), volume.affine)
    write_volume(shifted, folder / "shifted.nrrd")
    write_volume(volume, folder / "whole.nii")
    (folder / "half.nii").write_bytes((folder / "whole.nii").read_bytes()[:90_000])
    (folder / "bomb.nrrd").write_text(
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 99999 99999 9999\nencoding: gzip\n\n"
    )
    (folder / "empty").mkdir()
    return {
        "contrast": folder / "plain.nrrd",
        "no air": folder / "shifted.nrrd",
        "truncated": folder / "half.nii",
        "bomb": folder / "bomb.nrrd",
        "empty folder": folder / "empty",
        "no such file": folder / "absent.nii.gz",
    }


def test_unusable_files_end_in_one_line_that_names_them(inside, volume, tmp_path) -> None:
    for number, (cause, path) in enumerate(bad_files(volume, tmp_path).items()):
        command = "analyze" if number % 2 else "segment"
        line = refused(inside(command, path, "-o", tmp_path / "out"), path, tmp_path / "out")
        if cause not in ("truncated", "bomb"):
            assert cause in line


def test_two_series_in_a_folder_are_listed_and_one_is_chosen(inside, volume, tmp_path) -> None:
    small = Volume(volume.voxels[:8, :8, :4], volume.affine)
    for number in (1, 2):
        write_dicom_series(small, tmp_path / "both" / str(number), series_number=number)
    done = inside("segment", tmp_path / "both", "-o", tmp_path / "out")
    line = refused(done, tmp_path / "both", tmp_path / "out")
    assert "--series N: 1: CT" in line
    chosen = inside("segment", tmp_path / "both", "--series", 2, "-o", tmp_path / "out")
    assert "--series N" not in refused(chosen, tmp_path / "both", tmp_path / "out")


@pytest.mark.parametrize(
    ("options", "code"),
    [
        (("--seed", "1,2"), 2),
        (("--roi", "1,2,3"), 2),
        (("--cut", "1,2,3"), 2),
        (("--cut", "1,2,3,x"), 2),
        (("--cut", "1,2,3,0"), 3),
        (("--seed", "9999,0,0"), 3),
        (("--vein-stub", -4), 3),
        (("--labels", "absent.nii.gz"), 3),
    ],
)
def test_an_impossible_request_is_refused_and_leaves_nothing(
    inside, scan, tmp_path, options, code
) -> None:
    done = inside("segment", scan / "volume", "-o", tmp_path / "out", *options)
    assert done.returncode == code, done.stderr
    assert not (tmp_path / "out").exists()


def test_an_unknown_phantom_is_refused(inside, tmp_path) -> None:
    for options in (("--preset", "huge"), ("--case", "odd"), ("--as", "jpeg")):
        done = inside("phantom", "-o", tmp_path / "out", *options)
        assert (done.returncode, done.stderr.count("\n")) == (3, 1), done.stderr
        assert not (tmp_path / "out").exists()
