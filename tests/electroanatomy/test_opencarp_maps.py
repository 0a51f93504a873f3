"""openCARP simulations as maps, and the IGB format."""

import numpy as np
import pytest

from auricle.electroanatomy.formats.igb import read_igb
from auricle.electroanatomy.opencarp import read_opencarp_map
from auricle.electroanatomy.reading import read_study
from auricle.errors import FormatError
from auricle.surface.field import FieldMap
from auricle.surface.writing import write_surface


def igb(values: np.ndarray, *, kind: str = "float", order: str = "little", **more: object) -> bytes:
    """An IGB file of values (t, n)."""
    words = {"x": values.shape[1], "y": 1, "z": 1, "t": len(values), "type": kind, **more}
    words["systeme"] = f"{order}_endian"
    head = " ".join(f"{name}:{value}" for name, value in words.items())
    code = {"float": "f4", "double": "f8", "short": "i2"}[kind]
    stored = values.astype(("<" if order == "little" else ">") + code).tobytes()
    return head.encode().ljust(1024, b"\x00") + stored


@pytest.mark.parametrize("kind", ["float", "double", "short"])
@pytest.mark.parametrize("order", ["little", "big"])
def test_numbers_of_every_type_and_order_are_read(kind, order, tmp_path) -> None:
    values = np.arange(12.0).reshape(3, 4)
    (tmp_path / "a.igb").write_bytes(igb(values, kind=kind, order=order, inc_t=2.5))
    series = read_igb(tmp_path / "a.igb")
    np.testing.assert_array_equal(series.values, values)
    assert series.interval == 2.5


def test_the_scale_of_the_header_is_applied(tmp_path) -> None:
    content = igb(np.array([[1.0, 2.0]]), kind="short", facteur=0.5, zero=10)
    (tmp_path / "a.igb").write_bytes(content)
    assert read_igb(tmp_path / "a.igb").values.tolist() == [[10.5, 11.0]]


@pytest.mark.parametrize(
    ("content", "cause"),
    [
        (igb(np.ones((1, 4)))[:-3], "bytes left"),
        (igb(np.ones((1, 4))) + b"x", "goes on"),
        (igb(np.ones((1, 4))).replace(b"x:4", b"x:9"), "bytes left"),
        (igb(np.ones((1, 4))).replace(b"x:4", b"x:-4"), "'-4'"),
        (igb(np.ones((1, 4))).replace(b"t:1", b"t:999999999999"), "bytes left"),
        (igb(np.ones((1, 4))).replace(b"float", b"words"), "not known"),
        (bytes(2000), "no IGB header"),
        (b"", "empty"),
    ],
)
def test_damaged_series_are_refused(content, cause, tmp_path) -> None:
    (tmp_path / "a.igb").write_bytes(content)
    with pytest.raises(FormatError, match=cause):
        read_igb(tmp_path / "a.igb")


def test_fields_at_nodes_become_fields_of_the_map(chamber, tmp_path) -> None:
    times = FieldMap(chamber, np.arange(float(chamber.n_vertices)), "lat", "ms")
    write_surface(tmp_path / "la.pts", chamber, [times])
    voltage = np.linspace(0.0, 4.0, chamber.n_vertices)
    (tmp_path / "la_vm.igb").write_bytes(igb(voltage[None, :], kind="double"))
    (tmp_path / "la_phie.igb").write_bytes(igb(np.ones((5, chamber.n_vertices))))
    names = {"lat": "local_activation_time"}
    (one,) = read_opencarp_map(tmp_path / "la.pts", names=names).maps
    fields = one.surface.point_fields
    np.testing.assert_array_equal(fields["local_activation_time"], times.values)
    np.testing.assert_array_equal(fields["vm"], voltage)
    assert one.surface.units["local_activation_time"] == "ms"
    np.testing.assert_allclose(one.surface.vertices, chamber.vertices, atol=1e-9)
    assert "series of several moments left out: 1" in one.remarks
    assert read_study(tmp_path / "la.elem").maps[0].surface.point_fields.keys() == {"lat", "vm"}
    with pytest.raises(FormatError, match="no field 'uni'"):
        read_opencarp_map(tmp_path / "la.pts", names={"uni": "unipolar_voltage"})
    (tmp_path / "la_bad.igb").write_bytes(igb(np.ones((1, 3))))
    with pytest.raises(FormatError, match="3 values for 162"):
        read_opencarp_map(tmp_path / "la.pts")
