"""Exports that lie, attack or are damaged: one line, or an omission that is named and counted."""

import io
import re
import shutil
import stat
import struct
import time
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from auricle.electroanatomy.formats import carto_map, export_files
from auricle.electroanatomy.formats.carto_writing import write_carto
from auricle.electroanatomy.formats.ensite_writing import write_ensite
from auricle.electroanatomy.formats.openep_writing import write_openep
from auricle.electroanatomy.reading import read_study
from auricle.electroanatomy.study import ElectroanatomicStudy
from auricle.errors import FormatError

STUDY = "Study 1.xml"
BOMB = (
    b'<!DOCTYPE s [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">'
    b"]><Study>&b;</Study>"
)
EXTERNAL = b'<!DOCTYPE s [<!ENTITY x SYSTEM "file:///etc/hostname">]><Study>&x;</Study>'


def refusal(path: Path) -> str:
    start = time.perf_counter()
    with pytest.raises(FormatError) as caught:
        read_study(path)
    assert time.perf_counter() - start < 20
    message = str(caught.value)
    assert message.startswith(str(path))
    assert message.count(str(path)) == 1
    assert message.isprintable()
    return message


@pytest.fixture(scope="module")
def pristine(one_map, tmp_path_factory) -> Path:
    """One map as CARTO, EnSite and OpenEP hold it."""
    folder = tmp_path_factory.mktemp("pristine")
    study = ElectroanatomicStudy("synthetic", (one_map,))
    write_carto(folder / "carto", study)
    write_ensite(folder / "ensite", study)
    write_openep(folder / "map.mat", one_map)
    write_openep(folder / "new.mat", one_map, version="7.3")
    return folder


@pytest.fixture
def carto(pristine, tmp_path) -> Path:
    return Path(shutil.copytree(pristine / "carto", tmp_path / "carto"))


def edited(folder: Path, name: str, old: str, new: str) -> Path:
    place = folder / name
    content = place.read_bytes()
    changed = re.sub(old.encode(), new.encode(), content, count=1, flags=re.MULTILINE)
    assert changed != content
    place.write_bytes(changed)
    return folder


MESH, CAR, POINT = "1-Map.mesh", "1-Map_car.txt", "1-Map_P1_Point_Export.xml"
SIGNALS = "1-Map_P1_ECG_Export.txt"
DAMAGED = {
    "another number of maps": (STUDY, 'Maps Count="1"', 'Maps Count="7"', "number of maps"),
    "another number of points": (STUDY, 'Points Count="12"', 'Points Count="13"', "of points"),
    "a position of two numbers": (STUDY, r'Position3D="\S+ ', 'Position3D="', "three numbers"),
    "a study cut short": (STUDY, r"</Maps>[\s\S]*", "", "well-formed"),
    "more vertices than there are": (MESH, r"(NumVertex +=) \d+", r"\1 9999", "holds 162"),
    "vertices beyond all": (MESH, r"(NumVertex +=) \d+", r"\1 99999999999", "more vertices"),
    "a negative number of triangles": (MESH, r"(NumTriangle +=) \d+", r"\1 -3", "'-3'"),
    "decimal commas": (MESH, r"^0 = (-?\d+)\.(\d+)", r"0 = \1,\2", "a comma is not a decimal"),
    "a row of a control character": (MESH, r"^0 = .*$", "\x1e", "a word in its VerticesSection"),
    "a word for a number": (MESH, r"^0 = \S+", "0 = Smith", "a word in its VerticesSection"),
    "a triangle out of range": (MESH, r"^0 = \d+ (\d+ \d+ )", r"0 = 999 \1", "none of its 162"),
    "rows out of order": (MESH, r"^1 = ", "7 = ", "another way"),
    "a row cut short": (MESH, r"^(1 = \S+ \S+) .*$", r"\1", "different lengths"),
    "a mesh of another kind": (MESH, "#TriangulatedMesh", "solid", "does not begin"),
    "points of a version to come": (CAR, "VERSION_5", "VERSION_9", "none of 4, 5, 6"),
    "a point cut short": (CAR, r"^(P\t0\t1\t0\t\S+).*$", r"\1", "cut short"),
    "a decimal comma in a point": (CAR, r"^(P\t0\t1\t0\t-?\d+)\.", r"\1,", "'-?[0-9]+,[0-9]+'"),
    "a fractional point number": (CAR, r"^P\t0\t1\t", "P\t0\t1.5\t", "whole number"),
    "an annotation of words": (POINT, r'Reference_Annotation="\d+"',
                               'Reference_Annotation="late"', "a word"),
    "no gain": (SIGNALS, "gain", "loss", "no gain"),
    "a gain of nothing": (SIGNALS, "0.003000", "0.000000", "no size"),
    "samples of words": (SIGNALS, r"^-?\d+ ", "NN ", "a word in its electrograms"),
    "a sample of a control character": (SIGNALS, r"^-?\d+ .*$", "\x1e",
                                       "a word in its electrograms"),
    "a channel fewer": (SIGNALS, r"CS1-CS2\(\d\)", "", "names 2 channels|names 1 channels"),
}  # fmt: skip


@pytest.mark.parametrize("case", DAMAGED)
def test_a_damaged_carto_export_is_refused_in_one_line(case, carto) -> None:
    name, old, new, cause = DAMAGED[case]
    assert re.search(cause, refusal(edited(carto, name, old, new)))


@pytest.mark.parametrize("content", [BOMB, EXTERNAL], ids=["a bomb", "an external entity"])
@pytest.mark.parametrize("name", [STUDY, POINT])
def test_entities_are_refused_wherever_they_are(content, name, carto) -> None:
    (carto / name).write_bytes(content)
    assert "DTD or entities" in refusal(carto)


def test_xml_nested_without_end_is_refused(carto) -> None:
    (carto / STUDY).write_bytes(b"<Study>" + b"<a>" * 100_000)
    assert "nested more than 64 deep" in refusal(carto)


OMITTED = {
    "a mesh": (MESH, "surfaces not there: 1"),
    "a car file": (CAR, "car files not there: 1"),
    "electrograms": (SIGNALS, "electrogram files not there: 1"),
    "a point's export": (POINT, "point exports not there: 1"),
    "the index of points": ("1-Map_Points_Export.xml", "indices of points not there: 1"),
    "a force": ("1-Map_P3_ContactForce.txt", "force files not there: 1"),
}


@pytest.mark.parametrize("case", OMITTED)
def test_what_is_not_there_is_named_and_counted(case, carto) -> None:
    name, remark = OMITTED[case]
    (carto / name).unlink()
    (one,) = read_study(carto).maps
    assert remark in one.remarks
    assert len(one.points) == 12


def test_without_its_car_file_a_map_has_the_positions_of_the_study(carto, one_map) -> None:
    (carto / CAR).unlink()
    (one,) = read_study(carto).maps
    np.testing.assert_allclose(one.points.positions, one_map.points.positions, atol=1e-4)
    lag = one.points.local_activation_time
    np.testing.assert_allclose(lag, one_map.points.local_activation_time)


def test_deleted_anatomy_is_left_out_and_counted(carto, one_map) -> None:
    edited(carto, MESH, r"^(5 = .*) 0\r$", r"\1 -1000000\r")
    (one,) = read_study(carto).maps
    deleted = int((one_map.surface.faces == 5).any(axis=1).sum())
    assert len(one.surface.faces) == len(one_map.surface.faces) - deleted
    assert f"triangles of deleted anatomy left out: {deleted}" in one.remarks
    assert not (one.surface.faces == 5).any()


def test_points_without_a_position_and_of_one_number_are_left_out_and_counted(carto) -> None:
    edited(carto, CAR, r"^P\t0\t2\t", "P\t0\t1\t")
    edited(carto, CAR, r"^(P\t0\t4\t0\t)\S+", r"\1nan")
    (one,) = read_study(carto).maps
    assert one.points.identifiers.tolist() == [1, 3, *range(5, 13)]
    assert "points without a position left out: 1" in one.remarks
    assert "points of a number met before left out: 1" in one.remarks


def test_activation_times_that_disagree_are_counted(carto) -> None:
    edited(carto, POINT, r'(Map_Annotation=)"-?\d+"', r'\1"300"')
    (one,) = read_study(carto).maps
    assert one.points.local_activation_time[0] == 100.0
    assert any("the car file disagreeing: 1" in remark for remark in one.remarks)


def test_xml_in_windows_encoding_is_read(carto) -> None:
    edited(carto, STUDY, 'Angle="radian"', 'Angle="radian" Micro="MARK"')
    content = (carto / STUDY).read_bytes().replace(b"MARK", b"\xb5Bi")
    (carto / STUDY).write_bytes(content)
    assert len(read_study(carto).maps) == 1


def packed(path: Path, members: dict[str, bytes], *, method: int = zipfile.ZIP_DEFLATED) -> Path:
    with zipfile.ZipFile(path, "w", method) as archive:
        for name, content in members.items():
            archive.writestr(zipfile.ZipInfo(name), content, method)
    return path


@pytest.mark.parametrize("name", ["../evil.xml", "/etc/evil.xml", "a/../../b", "C:/x", "a\\..\\b"])
def test_names_that_lead_out_of_an_archive_are_refused(name, tmp_path) -> None:
    path = packed(tmp_path / "slip.zip", {STUDY: b"<Study/>", name: b"x"})
    message = refusal(path)
    assert "leads out" in message
    assert [place.name for place in tmp_path.iterdir()] == ["slip.zip"]


def test_archives_that_unpack_to_too_much_are_refused_unread(tmp_path, monkeypatch) -> None:
    bomb = packed(tmp_path / "bomb.zip", {STUDY: b"<Study>" + b" " * 8_000_000})
    assert "times over" in refusal(bomb)
    monkeypatch.setattr(export_files, "MOST_TOTAL_BYTES", 1000)
    assert "unpacks to" in refusal(bomb)
    monkeypatch.setattr(export_files, "MOST_MEMBERS", 3)
    many = packed(tmp_path / "many.zip", {f"{k}.txt": b"" for k in range(4)})
    assert "more than 3 files" in refusal(many)


def test_archives_that_lie_of_sizes_are_refused(pristine, tmp_path) -> None:
    members = {place.name: place.read_bytes() for place in (pristine / "carto").iterdir()}
    path = packed(tmp_path / "lies.zip", members, method=zipfile.ZIP_STORED)
    content = bytearray(path.read_bytes())
    entry = content.rfind(b"PK\x01\x02")
    struct.pack_into("<I", content, entry + 24, 10)
    path.write_bytes(content)
    with pytest.raises(FormatError):
        read_study(path)


def test_a_changed_byte_fails_the_checksum(pristine, tmp_path) -> None:
    members = {place.name: place.read_bytes() for place in (pristine / "carto").iterdir()}
    path = packed(tmp_path / "changed.zip", members, method=zipfile.ZIP_STORED)
    content = path.read_bytes().replace(b"VERSION_5", b"VERSION_6")
    path.write_bytes(content)
    assert "not a whole zip" in refusal(path)


def test_links_and_encryption_and_noise_are_refused(tmp_path) -> None:
    link = zipfile.ZipInfo("link.xml")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(tmp_path / "link.zip", "w") as archive:
        archive.writestr(link, "/etc/hostname")
    assert "a link" in refusal(tmp_path / "link.zip")
    locked = bytearray(packed(tmp_path / "locked.zip", {STUDY: b"<Study/>"}).read_bytes())
    struct.pack_into("<H", locked, locked.rfind(b"PK\x01\x02") + 8, 1)
    (tmp_path / "locked.zip").write_bytes(locked)
    assert "encrypted" in refusal(tmp_path / "locked.zip")
    (tmp_path / "noise.zip").write_bytes(bytes(range(256)) * 10)
    assert "not a whole zip" in refusal(tmp_path / "noise.zip")
    assert "no such file" in refusal(tmp_path / "none.zip")
    (tmp_path / "empty").mkdir()
    assert "no known system" in refusal(tmp_path / "empty")


def test_links_out_of_a_folder_are_refused(carto, tmp_path) -> None:
    (tmp_path / "secret.txt").write_text("secret")
    (carto / "1-Map_P2_Extra.txt").symlink_to(tmp_path / "secret.txt")
    assert "leads out of the folder" in refusal(carto)


def test_two_studies_at_once_are_refused(carto) -> None:
    shutil.copy(carto / STUDY, carto / "Study 2.xml")
    assert "holds 2 studies" in refusal(carto)


DAMAGED_ENSITE = {
    "more vertices than there are": ("Landmark", r'Vertices number="\d+"',
                                     'Vertices number="99"', "holds 162"),
    "faces that count from 0": ("Landmark", r"(<Polygons[^>]*>\s+)\d+", r"\g<1>0", "none of 1"),
    "decimal commas": ("Landmark", r"(<Vertices[^>]*>\s+-?\d+)\.", r"\1,", "comma"),
    "a revision to come": ("DxL_", "Revision : 5.2", "Revision : 8.0", "revision that is not 5"),
    "more points than there are": ("DxL_", "columns\\):, 12", "columns):, 14", "announces 14"),
    "words for positions": ("DxL_", r"^roving x:,[^,]+", "roving x:,here", "a word"),
    "a longer duration": ("DxL_", "Exported seconds:,0.4", "Exported seconds:,4.4", "holds 400"),
    "a waveform cut short": ("DxL_", r"^,[^,\n]+,", ",", "different lengths|another number"),
    "no rate": ("DxL_", "Sample rate", "Simple rate", "no sample rate"),
}  # fmt: skip


@pytest.mark.parametrize("case", DAMAGED_ENSITE)
def test_a_damaged_ensite_export_is_refused_in_one_line(case, pristine, tmp_path) -> None:
    kind, old, new, cause = DAMAGED_ENSITE[case]
    folder = Path(shutil.copytree(pristine / "ensite", tmp_path / "ensite"))
    (place,) = (folder / "map 1").glob(f"*{kind}*")
    edited(place.parent, place.name, old, new)
    assert re.search(cause, refusal(folder))


def test_ensite_without_some_of_its_files_says_so(pristine, tmp_path) -> None:
    folder = Path(shutil.copytree(pristine / "ensite", tmp_path / "ensite"))
    place = folder / "map 1"
    edited(place, "DxL_1.csv", "file 1 of 1", "file 1 of 3")
    (place / "DxLandmarkGeo.xml").unlink()
    (one,) = read_study(folder).maps
    assert {"files of points not there: 2", "surfaces not there: 1"} <= set(one.remarks)


def external_link(path: Path) -> None:
    import h5py

    with h5py.File(path, "r+") as file:
        file["userdata/electric/egmExtra"] = h5py.ExternalLink("/etc/passwd", "/x")


def external_storage(path: Path) -> None:
    import h5py

    with h5py.File(path, "r+") as file:
        del file["userdata/electric/egmX"]
        file["userdata/electric"].create_dataset(
            "egmX", (3, 12), "f8", external=[("/etc/hostname", 0, 288)]
        )


def huge_dataset(path: Path) -> None:
    import h5py

    with h5py.File(path, "r+") as file:
        del file["userdata/electric/egmX"]
        file["userdata/electric"].create_dataset("egmX", (3, 10**9), "f8", chunks=(3, 1000))


def other_root(path: Path) -> None:
    import h5py

    with h5py.File(path, "r+") as file:
        file.move("userdata", "other")


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:900])


HOSTILE_HDF5: dict[str, tuple[Callable[[Path], None], str]] = {
    "an external link": (external_link, "links"),
    "numbers in another file": (external_storage, "in other files"),
    "an array without end": (huge_dataset, "announces an array of 24,000,000,000"),
    "no userdata": (other_root, "no variable userdata"),
    "a file cut short": (cut, "damaged"),
}


@pytest.mark.parametrize("case", HOSTILE_HDF5)
def test_a_hostile_file_of_version_7_3_is_refused(case, pristine, tmp_path) -> None:
    hurt, cause = HOSTILE_HDF5[case]
    path = Path(shutil.copy(pristine / "new.mat", tmp_path / "new.mat"))
    hurt(path)
    assert cause in refusal(path)


def saved(path: Path, **changes) -> Path:
    from scipy.io import savemat

    surface = {"triRep": {"X": np.eye(3), "Triangulation": np.array([[1.0, 2.0, 3.0]])}}
    electric = {"egmX": np.zeros((2, 3)), "sampleFrequency": 1000.0}
    savemat(path, {"userdata": {"surface": surface, "electric": {**electric, **changes}}})
    return path


def test_hostile_files_of_version_5_are_refused(pristine, tmp_path) -> None:
    (tmp_path / "noise.mat").write_bytes(bytes(1000))
    assert "no MATLAB file" in refusal(tmp_path / "noise.mat")
    content = (pristine / "map.mat").read_bytes()
    (tmp_path / "short.mat").write_bytes(content[: len(content) // 2])
    assert "damaged" in refusal(tmp_path / "short.mat")
    assert "electric.egm of shape (5, 9)" in refusal(
        saved(tmp_path / "shape.mat", egm=np.zeros((5, 9)))
    )
    assert "sampling rate" in refusal(saved(tmp_path / "rate.mat", sampleFrequency=-1.0))
    assert "lengths" in refusal(
        saved(tmp_path / "long.mat", egm=np.ones((2, 9)), egmRef=np.ones((2, 8)))
    )


def test_python_objects_in_a_matlab_file_are_never_made(tmp_path) -> None:
    """A pickle is bytes to both readers; in place of numbers it is not there."""
    import pickle

    path = saved(tmp_path / "pickle.mat", egmSurfX=np.frombuffer(pickle.dumps(print), np.uint8))
    assert "egmSurfX of shape" in refusal(path)


def test_planted_names_dates_and_identifiers_never_come_out(pristine, carto, tmp_path) -> None:
    """Of whatever is text in an export nothing leaves but chambers, channels and vendor words."""
    secrets = ("Smith", "19610314", "MRN12345", "Mercy", "14/03/1961")
    who = "Smith MRN12345 14/03/1961 Mercy 19610314"
    edited(carto, STUDY, 'name="Study 1"', f'name="{who}"')
    named = (carto / STUDY).read_bytes().replace(b'Name="1-Map"', b'Name="LA Smith 19610314"')
    (carto / STUDY).write_bytes(named.replace(b"1-Map.mesh", b"LA Smith 19610314.mesh"))
    for place in sorted(carto.iterdir()):
        content = place.read_bytes().replace(b"1-Map", b"LA Smith 19610314")
        place.unlink()
        (carto / place.name.replace("1-Map", "LA Smith 19610314")).write_bytes(content)
    edited(carto, "LA Smith 19610314_P1_ECG_Export.txt", r"M1-M2\(1\)", f"{who}(1)")
    (carto / "Patient Smith MRN12345.txt").write_text(who)
    ensite = Path(shutil.copytree(pristine / "ensite", tmp_path / "ensite"))
    edited(ensite / "map 1", "DxL_1.csv", "^Begin data", f"Export from Study : {who}\nBegin data")
    edited(ensite / "map 1", "DxLandmarkGeo.xml", "volume 1", who)
    (ensite / "map 1").rename(ensite / "Smith 19610314")
    mat = saved(tmp_path / "map.mat", names=[[who], [who]], tags=who)
    told = io.StringIO()
    for path in (carto, ensite, mat):
        study = read_study(path, all_channels=True)
        told.write(repr(study))
        for one in study.maps:
            told.write(repr((one, one.surface, one.points, dict(one.electrograms))))
            told.write(repr([signal.channels for signal in one.electrograms.values()]))
    assert len(told.getvalue()) > 1000
    for secret in secrets:
        assert secret not in told.getvalue()
    edited(carto, "LA Smith 19610314.mesh", r"^0 = \S+", "0 = Smith")
    message = refusal(carto).removeprefix(str(carto))
    assert not any(secret in message for secret in secrets)


def test_scar_that_was_marked_is_a_field(carto, one_map) -> None:
    count = len(one_map.surface.vertices)
    rows = "".join(f"{k} = {int(k == 3)} 0\r\n" for k in range(count))
    with (carto / MESH).open("ab") as file:
        file.write(b"\r\n[VerticesAttributesSection]\r\n" + rows.encode())
    (one,) = read_study(carto).maps
    assert np.flatnonzero(one.surface.point_fields["scar"]).tolist() == [3]


def test_more_electrograms_than_memory_allows_are_refused(carto, monkeypatch) -> None:
    monkeypatch.setattr(carto_map, "MOST_SIGNAL_BYTES", 20_000)
    assert "read it without them" in refusal(carto)
    assert read_study(carto, signals=False).maps[0].electrograms == {}


@pytest.mark.parametrize("kind", ["carto", "ensite"])
def test_damage_anywhere_is_read_or_refused_but_never_crashes(kind, pristine, tmp_path) -> None:
    folder = Path(shutil.copytree(pristine / kind, tmp_path / kind))
    places = sorted(place for place in folder.rglob("*") if place.is_file())
    rng = np.random.default_rng(7)
    words = [
        b"nan",
        b"inf",
        b"1e308",
        b"-1",
        b"0,5",
        b"",
        b"\x00",
        b"<",
        b"\n",
        b"99999999999999999999",
    ]
    refused = 0
    for _ in range(40):
        place = places[rng.integers(len(places))]
        whole = place.read_bytes()
        start = int(rng.integers(len(whole)))
        word = words[rng.integers(len(words))]
        place.write_bytes(whole[:start] + word + whole[start + int(rng.integers(60)) :])
        told = ""
        try:
            read_study(folder)
        except FormatError as fault:
            told = str(fault)
        assert told.isprintable()
        refused += bool(told)
        place.write_bytes(whole)
    assert 10 < refused < 40
