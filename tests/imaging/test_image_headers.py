"""NIfTI, NRRD and MetaImage headers that promise what the file does not keep."""

import gzip
import struct
import tracemalloc
import zlib
from contextlib import suppress

import numpy as np
import pytest
import SimpleITK
from hypothesis import given, settings
from hypothesis import strategies as st

from auricle.errors import FormatError
from auricle.imaging.header import MOST_VOXELS
from auricle.imaging.reading import read_volume
from auricle.imaging.volume import Volume
from auricle.imaging.writing import write_volume

VOXELS = np.random.default_rng(2).integers(-1000, 1000, (3, 4, 5), dtype=np.int16)
FLAT = VOXELS.tobytes(order="F")
NRRD = {
    "type": "short",
    "dimension": "3",
    "space": "left-posterior-superior",
    "sizes": "3 4 5",
    "space directions": "(0.5,0,0) (0,0.5,0) (0,0,1)",
    "space origin": "(1,2,3)",
    "endian": "little",
    "encoding": "raw",
}
META = {
    "ObjectType": "Image",
    "NDims": "3",
    "BinaryData": "True",
    "BinaryDataByteOrderMSB": "False",
    "CompressedData": "False",
    "TransformMatrix": "1 0 0 0 1 0 0 0 1",
    "Offset": "1 2 3",
    "ElementSpacing": "0.5 0.5 1",
    "DimSize": "3 4 5",
    "ElementType": "MET_SHORT",
    "ElementDataFile": "LOCAL",
}


def nifti(order="<", data=FLAT, **changes):
    """Bytes of a NIfTI-1 file; the keywords put values at named places of the header."""
    places = {
        "dim": (40, "8h", (3, 3, 4, 5, 1, 1, 1, 1)),
        "datatype": (70, "h", (4,)),
        "pixdim": (76, "8f", (1, 0.5, 0.5, 1, 0, 0, 0, 0)),
        "vox_offset": (108, "f", (352,)),
        "scl": (112, "2f", (0, 0)),
        "units": (123, "B", (2,)),
        "codes": (252, "2h", (0, 1)),
        "quatern": (256, "3f", (0, 0, 0)),
        "qoffset": (268, "3f", (0, 0, 0)),
        "srow": (280, "12f", (-0.5, 0, 0, -1, 0, -0.5, 0, -2, 0, 0, 1, 3)),
        "magic": (344, "4s", (b"n+1\0",)),
    }
    header = bytearray(352)
    struct.pack_into(order + "i", header, 0, 348)
    for name, (place, layout, values) in places.items():
        struct.pack_into(order + layout, header, place, *changes.get(name, values))
    return bytes(header) + data


def nrrd(data=FLAT, **changes):
    fields = NRRD | {name.replace("_", " "): value for name, value in changes.items()}
    lines = [f"{name}: {value}" for name, value in fields.items() if value is not None]
    return "\n".join(["NRRD0004", "# by hand", *lines, "", ""]).encode() + data


def meta(data=FLAT, **changes):
    fields = META | changes
    last = fields.pop("ElementDataFile")
    lines = [f"{name} = {value}" for name, value in fields.items() if value is not None]
    return "\n".join([*lines, f"ElementDataFile = {last}", ""]).encode() + data


def read(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    return read_volume(path)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.nii", nifti()),
        ("a.nii", nifti(">", VOXELS.astype(">i2").tobytes(order="F"))),
        ("a.nii.gz", gzip.compress(nifti())),
        ("a.nii.gz", nifti()),
        ("a.nii", nifti(codes=(1, 0), quatern=(0, 0, 1), qoffset=(-1, -2, 3))),
        (
            "a.nii",
            nifti(units=(1,), srow=np.array([-0.5, 0, 0, -1, 0, -0.5, 0, -2, 0, 0, 1, 3]) / 1e3),
        ),
        ("a.nii", nifti(dim=(4, 3, 4, 5, 1, 1, 1, 1))),
        ("a.nrrd", nrrd()),
        ("a.nrrd", nrrd(VOXELS.astype(">i2").tobytes(order="F"), endian="big")),
        ("a.nrrd", nrrd(gzip.compress(FLAT), encoding="gzip")),
        ("a.nrrd", nrrd(gzip.compress(FLAT[:50]) + gzip.compress(FLAT[50:]), encoding="gz")),
        (
            "a.nrrd",
            nrrd(
                space="RAS",
                space_directions="(-.5,0,0) (0,-.5,0) (0,0,1)",
                space_origin="(-1,-2,3)",
            ),
        ),
        (
            "a.nrrd",
            nrrd(
                space="left-anterior-superior",
                space_directions="(.5,0,0) (0,-.5,0) (0,0,1)",
                space_origin="(1,-2,3)",
            ),
        ),
        (
            "a.nrrd",
            nrrd(dimension="4", sizes="1 3 4 5", space_directions="none (.5,0,0) (0,.5,0) (0,0,1)"),
        ),
        ("a.nrrd", nrrd(b"junk" + FLAT, byte_skip="4")),
        ("a.nrrd", nrrd(b"junk" + FLAT, byte_skip="-1")),
        ("a.mha", meta()),
        ("a.mha", meta(VOXELS.astype(">i2").tobytes(order="F"), BinaryDataByteOrderMSB="True")),
        ("a.mha", meta(zlib.compress(FLAT), CompressedData="True")),
        ("a.mha", meta(b"junk" + FLAT, HeaderSize="-1")),
    ],
)
def test_every_way_of_writing_one_volume_gives_that_volume(tmp_path, name, content):
    volume = read(tmp_path, name, content)
    np.testing.assert_array_equal(volume.voxels, VOXELS)
    expected = [[0.5, 0, 0, 1], [0, 0.5, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]
    np.testing.assert_allclose(volume.affine, expected, atol=1e-7)
    assert volume.remarks == ()
    assert volume.orientation_known


def test_a_detached_header_finds_its_voxels_beside_it(tmp_path):
    (tmp_path / "a.raw").write_bytes(FLAT)
    for name, content in (
        ("a.nhdr", nrrd(b"", data_file="a.raw")),
        ("a.mhd", meta(b"", ElementDataFile="a.raw")),
    ):
        np.testing.assert_array_equal(read(tmp_path, name, content).voxels, VOXELS)


@pytest.mark.parametrize("handed", [1, -1])
def test_a_qform_places_voxels_where_itk_does(tmp_path, handed):
    quaternion = np.array([0.1, -0.35, 0.2])
    content = nifti(
        codes=(1, 0),
        quatern=quaternion,
        qoffset=(11, -22, 33),
        pixdim=(handed, 0.5, 0.6, 0.7, 0, 0, 0, 0),
    )
    volume = read(tmp_path, "a.nii", content)
    assert np.linalg.det(volume.affine[:3, :3]) > 0
    image = SimpleITK.ReadImage(str(tmp_path / "a.nii"))
    for index in np.ndindex(VOXELS.shape):
        point = image.TransformIndexToPhysicalPoint([int(place) for place in index])
        place = np.rint(volume.index_of(point)).astype(int)
        np.testing.assert_allclose(volume.points_at(place), point, atol=1e-5)
        assert volume.voxels[tuple(place)] == VOXELS[index]


def test_an_unscaled_offset_and_a_scale_give_hu(tmp_path):
    volume = read(tmp_path, "a.nii", nifti(scl=(2, -24)))
    np.testing.assert_array_equal(volume.voxels, np.maximum(VOXELS * 2 - 24, -1024))
    assert volume.voxels.dtype == np.int16
    halves = read(tmp_path, "a.nii", nifti(scl=(0.5, -24)))
    np.testing.assert_array_equal(halves.voxels, VOXELS / 2 - 24)
    assert halves.voxels.dtype == np.float32


def test_a_nifti_without_qform_and_sform_has_no_known_orientation(tmp_path):
    volume = read(tmp_path, "a.nii", nifti(codes=(0, 0)))
    assert not volume.orientation_known
    assert volume.remarks[0].startswith("orientation unknown")
    np.testing.assert_allclose(volume.spacing, [0.5, 0.5, 1])


@pytest.mark.parametrize(
    ("name", "content"),
    [
        (
            "a.nrrd",
            nrrd(space=None, space_directions=None, space_origin=None, spacings="0.5 0.5 1"),
        ),
        ("a.nrrd", nrrd(space="scanner-xyz")),
        ("a.mha", meta(TransformMatrix=None)),
    ],
)
def test_a_file_that_names_no_axes_has_no_known_orientation(tmp_path, name, content):
    volume = read(tmp_path, name, content)
    assert not volume.orientation_known
    assert volume.remarks[0].startswith("orientation unknown")


def test_sform_and_qform_that_disagree_are_remarked(tmp_path):
    (remark,) = read(tmp_path, "a.nii", nifti(codes=(1, 1), quatern=(0, 0, 1))).remarks
    assert "3 mm apart" in remark or "2 mm apart" in remark
    agreeing = nifti(codes=(1, 1), quatern=(0, 0, 1), qoffset=(-1, -2, 3))
    assert read(tmp_path, "a.nii", agreeing).remarks == ()


def test_surplus_data_are_remarked(tmp_path):
    for name, content in (
        ("a.nii", nifti() + b"more"),
        ("a.nii.gz", gzip.compress(nifti() + b"more")),
        ("a.mha", meta(zlib.compress(FLAT + b"more"), CompressedData="True")),
    ):
        assert "more data than it announces" in read(tmp_path, name, content).remarks[0]


SHEARED = (-0.5, 0.05, 0, -1, 0, -0.5, 0, -2, 0, 0, 1, 3)
FAULTS = {
    "empty.nii": (b"", "is empty"),
    "text.nii": (b"hello" * 100, "no NIfTI file"),
    "short.nii": (nifti()[:200], "within its header"),
    "pair.nii": (nifti(magic=(b"ni1\0",)), "one .nii"),
    "cut.nii": (nifti()[:-1], "3×4×5 voxels, so 472 bytes or more, with 471"),
    "cut.nii.gz": (gzip.compress(nifti())[:-30], "cannot be unpacked"),
    "less.nii.gz": (
        gzip.compress(nifti(data=FLAT[:-2])),
        "announces 120 bytes of voxels, holds 118",
    ),
    "torn.nii.gz": (gzip.compress(nifti())[:-60] + b"\xff" * 60, "cannot be unpacked"),
    "crc.nii.gz": (gzip.compress(nifti())[:-8] + b"\0" * 8, "cannot be unpacked"),
    "four.nii": (nifti(dim=(4, 3, 4, 5, 7, 1, 1, 1)), "holds 7 volumes or components"),
    "flat.nii": (nifti(dim=(2, 3, 4, 1, 1, 1, 1, 1)), "one slice"),
    "minus.nii": (nifti(dim=(3, 3, -4, 5, 1, 1, 1, 1)), "announces 3×-4×5"),
    "dims.nii": (nifti(dim=(9, 3, 4, 5, 1, 1, 1, 1)), "9 dimensions"),
    "huge.nii": (nifti(dim=(3, 32767, 32767, 32767, 1, 1, 1, 1)), f"limit is {MOST_VOXELS:,}"),
    "bomb.nii.gz": (
        gzip.compress(nifti(dim=(3, 800, 800, 800, 1, 1, 1, 1))),
        "800×800×800 voxels, so",
    ),
    "rgb.nii": (nifti(datatype=(128,)), "colour image"),
    "complex.nii": (nifti(datatype=(32,)), "NIfTI type 32"),
    "shear.nii": (nifti(srow=SHEARED), r"axes of its sform are sheared by 5\.7°: resample"),
    "nan.nii": (nifti(srow=(np.nan,) * 12), "NaN or infinite"),
    "metres.nii": (nifti(srow=(-5e-4, 0, 0, 0, 0, -5e-4, 0, 0, 0, 0, 1e-3, 0)), "in metres"),
    "zero.nii": (nifti(codes=(0, 0), pixdim=(1, 0, 0, 0, 0, 0, 0, 0)), "voxels 0×0×0 mm apart"),
    "unit.nii": (nifti(units=(6,)), "unit of length number 6"),
    "offset.nii": (nifti(vox_offset=(np.nan,)), "at byte nan"),
    "far.nii": (nifti(vox_offset=(1e6,)), "bytes left"),
    "nan-voxels.nii": (
        nifti(datatype=(16,), data=np.where(VOXELS > 900, np.nan, VOXELS).astype("<f4").tobytes()),
        "NaN or infinite: fill",
    ),
    "unit-range.nii": (
        nifti(datatype=(16,), data=np.linspace(0, 1, 60, dtype="<f4").tobytes()),
        "from 0 to 1, which are not Hounsfield units",
    ),
    "text.nrrd": (b"hello", "no NRRD file"),
    "cut.nrrd": (nrrd()[:-1], "120 bytes or more, with 119"),
    "line.nrrd": (nrrd(type="short\nwhat"), "header line 'what'"),
    "size.nrrd": (nrrd(sizes=None), "has no sizes"),
    "sizes.nrrd": (nrrd(sizes="3 4"), "2 sizes for 3 dimensions"),
    "word.nrrd": (nrrd(sizes="3 4 x"), "announces 'x'"),
    "rgb.nrrd": (
        nrrd(dimension="4", sizes="3 3 4 5", kinds="RGB-color domain domain domain"),
        "colour or vector",
    ),
    "four.nrrd": (nrrd(dimension="4", sizes="3 4 5 20"), r"several volumes or components \(4-D\)"),
    "flat.nrrd": (nrrd(dimension="2", sizes="3 4"), "2-D image"),
    "type.nrrd": (nrrd(type="block"), "type 'block'"),
    "endian.nrrd": (nrrd(endian=None), "has no endian"),
    "ascii.nrrd": (nrrd(encoding="ascii"), "save it as raw or gzip"),
    "bzip.nrrd": (nrrd(encoding="bzip2"), "save it as raw or gzip"),
    "axes.nrrd": (nrrd(space_directions="(1,0,0) (0,1,0)"), "as its space directions"),
    "nan.nrrd": (nrrd(space_directions="(nan,0,0) (0,1,0) (0,0,1)"), "as its space directions"),
    "shear.nrrd": (nrrd(space_directions="(1,0,0) (.1,1,0) (0,0,1)"), "sheared by 5.7°"),
    "metres.nrrd": (nrrd(space_units='"m" "m" "m"'), "save it in mm"),
    "away.nhdr": (nrrd(b"", data_file="../../a.raw"), "into one folder"),
    "gone.nhdr": (nrrd(b"", data_file="a.raw"), "not there: copy both"),
    "list.nhdr": (nrrd(b"", data_file="LIST"), "several files"),
    "text.mha": (b"hello", "no MetaImage"),
    "end.mha": (b"NDims = 3\n", "no ElementDataFile"),
    "cut.mha": (meta()[:-1], "120 bytes or more, with 119"),
    "torn.mha": (meta(zlib.compress(FLAT)[:-20], CompressedData="True"), "holds "),
    "rgb.mha": (meta(ElementNumberOfChannels="3"), "colour or vector"),
    "four.mha": (meta(NDims="4", DimSize="3 4 5 2"), "4-D"),
    "ascii.mha": (meta(BinaryData="False"), "save it as binary"),
    "type.mha": (meta(ElementType="MET_FLOAT_ARRAY"), "MET_FLOAT_ARRAY"),
    "axes.mha": (meta(TransformMatrix="2 0 0 0 1 0 0 0 1"), "no unit vectors"),
    "spacing.mha": (meta(ElementSpacing="0.5 0.5"), "3 numbers are due"),
    "zero.mha": (meta(ElementSpacing="0.5 0.5 0"), "0.5×0.5×0 mm apart"),
    "list.mhd": (meta(b"", ElementDataFile="slice%03d.raw 1 5 1"), "several files"),
    "zip.zip": (b"PK", "unpack it"),
    "surface.vtp": (b"<", "is a surface"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_told_in_one_line_with_the_file_and_a_remedy(tmp_path, name):
    content, words = FAULTS[name]
    with pytest.raises(FormatError, match=words) as caught:
        read(tmp_path, name, content)
    text = str(caught.value)
    assert text.startswith(f"{tmp_path / name}: ")
    assert text.isprintable()
    assert ": " in text.removeprefix(f"{tmp_path / name}: ")


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FormatError, match="no such file or folder"):
        read_volume(tmp_path / "gone.nii")


def test_a_bomb_costs_no_memory(tmp_path):
    content = gzip.compress(nifti(dim=(3, 880, 880, 880, 1, 1, 1, 1), data=bytes(10**6)))
    tracemalloc.start()
    with pytest.raises(FormatError, match="880×880×880 voxels, so"):
        read(tmp_path, "a.nii.gz", content)
    assert tracemalloc.get_traced_memory()[1] < 10**7
    tracemalloc.stop()


@settings(max_examples=60, deadline=None)
@given(place=st.integers(0, 359), value=st.integers(0, 255), kind=st.sampled_from("nrm"))
def test_a_spoilt_byte_gives_a_volume_or_an_error_of_ours(tmp_path_factory, place, value, kind):
    name, whole = {"n": ("a.nii", nifti()), "r": ("a.nrrd", nrrd()), "m": ("a.mha", meta())}[kind]
    content = bytearray(whole)
    content[place % len(content)] = value
    path = tmp_path_factory.mktemp("spoilt") / name
    path.write_bytes(content)
    with suppress(FormatError):
        assert read_volume(path).voxels.size <= VOXELS.size


def test_progress_reaches_its_end_and_may_cancel(tmp_path):
    path = tmp_path / "a.nrrd"
    write_volume(Volume(VOXELS, np.eye(4)), path)
    seen = []
    read_volume(path, progress=lambda stage, done, total: seen.append((stage, done, total)))
    assert seen[-1] == ("reading voxels", 120, 120)

    def cancel(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        read_volume(path, progress=cancel)
