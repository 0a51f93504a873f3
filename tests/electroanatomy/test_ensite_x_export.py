"""EnSite X: tables with a row a point, waveforms looked up by point and freeze group."""

from pathlib import Path

import numpy as np
import pytest

from auricle.electroanatomy.reading import read_study
from auricle.errors import FormatError

DIF = """<DIF><DIFBody><Volumes number="1"><Volume name="x">
<Vertices number="3">
0 0 0
10 0 0
0 10 0
</Vertices><Polygons number="1">
1 2 3
</Polygons>
<!-- Data values at each vertex of DxL map P-P Voltage -->
<Map_data number="3">
1.5
2.5
3.5
</Map_data>
<!-- Data values at each vertex of DxL map Score -->
<Map_data number="3">
1
2
3
</Map_data></Volume><Volume name="y"/></Volumes></DIFBody></DIF>"""
HEAD = "Export Data Element : Map\n# mapping pts : ,3\nSample rate : ,2000\n"
COLUMNS = (
    "(Point #),Freeze Grp #,roving x,roving y,roving z,surface x,surface y,surface z,utilized,"
    "Ref Tick,Rov Tick 1,adjTime (ms),left curtain (ms),right curtain (ms)"
)
POINTS = """11,1,1,1,1,1,1,0,1,110,150,5,-80,120
12,1,2,1,1,2,1,0,0,110,90,5,-80,120
13,2,3,1,1,3,1,0,1,120,invalid,5,-80,120
EOF
"""
VOLTAGES = (
    "(Point #),roving x,roving y,roving z,P-P,force (g)\n13,3,1,1,0.3,invalid\n11,1,1,1,0.1,9\n"
)


def wave(kind: str, rows: str, count: int) -> str:
    return (
        f"Export Data Element : Wave\n# {kind} : ,{count}\nSample rate : ,2000\n"
        f"(Point #),Freeze Grp #,Trace,0,1,2,3,...\n{rows}"
    )


@pytest.fixture
def export(tmp_path: Path) -> Path:
    place = tmp_path / "export" / "Contact_Mapping"
    place.mkdir(parents=True)
    (place.parent / "Contact_Mapping_Model.xml").write_text(DIF)
    (place / "Map_LAT_bi.csv").write_text(f"{HEAD}{COLUMNS}\n{POINTS}")
    (place / "Map_PP_bi.csv").write_text(f"{HEAD.replace(',3', ',2')}{VOLTAGES}")
    rov = "12,1,A1-A2,5,6,7,8,\n11,1,A1-A2,1,2,3,4,\n"
    (place / "Wave_rov.csv").write_text(wave("mapping pts", rov, 2))
    refs = "0,1,CS,9,9,9,9\n0,2,CS,8,8,8,8\n"
    (place / "Wave_refs.csv").write_text(wave("freeze groups", refs, 2))
    return tmp_path / "export"


def test_points_values_and_waveforms_are_brought_together(export) -> None:
    study = read_study(export)
    assert study.system == "EnSite X"
    (one,) = study.maps
    assert one.surface.faces.tolist() == [[0, 1, 2]]
    assert one.surface.point_fields["bipolar_voltage"].tolist() == [1.5, 2.5, 3.5]
    assert {"further volumes left out: 1", "maps of another meaning left out: 1"} <= set(
        one.remarks
    )
    points = one.points
    assert points.identifiers.tolist() == [11, 12, 13]
    np.testing.assert_array_equal(points.local_activation_time, [20.0, -10.0, np.nan])
    np.testing.assert_array_equal(points.bipolar_voltage, [0.1, np.nan, 0.3])
    np.testing.assert_array_equal(points.force, [9.0, np.nan, np.nan])
    assert points.included.tolist() == [True, False, True]
    assert points.projected_positions[2].tolist() == [3.0, 1.0, 0.0]
    assert one.window_of_interest == (-80.0, 120.0)
    first, second, third = (one.electrograms[row] for row in range(3))
    assert first.channel("bipolar").tolist() == [1.0, 2.0, 3.0, 4.0]
    assert second.channel("bipolar").tolist() == [5.0, 6.0, 7.0, 8.0]
    assert third.channels == ("reference",)
    assert third.channel("reference").tolist() == [8.0] * 4
    assert first.local_activation_time == 20.0
    assert first.reference_annotation == 100.0


@pytest.mark.parametrize(
    ("name", "old", "new", "cause"),
    [
        ("Map_LAT_bi.csv", ",3", ",4", "announces 4 points and holds 3"),
        ("Map_LAT_bi.csv", "roving x", "somewhere", "names no columns"),
        ("Map_LAT_bi.csv", "12,1,2,1", "11,1,2,1", "numbers two points alike"),
        ("Map_LAT_bi.csv", "11,1,1,1,1", "11,1,here,1,1", "a word"),
        ("Map_LAT_bi.csv", "12,1,2,1,1,2,1,0,0,110,90,5,-80,120", "12,1", "cut short"),
        ("Wave_rov.csv", "Sample rate", "Rate", "no sampling rate"),
        ("Wave_rov.csv", ",5,6,7,8,", ",5,6,loud,8,", "a word"),
        ("Wave_refs.csv", ",2000", ",1000", "different rates"),
    ],
)
def test_damaged_tables_are_refused(name, old, new, cause, export) -> None:
    place = export / "Contact_Mapping" / name
    content = place.read_text()
    assert old in content
    place.write_text(content.replace(old, new, 1))
    with pytest.raises(FormatError, match=cause):
        read_study(export)
