"""Tables of samples: what is understood, and in one line what is not."""

from pathlib import Path

import numpy as np
import pytest

from auricle.errors import FormatError
from auricle.sampling.chamber import Chamber
from auricle.sampling.gaussian_process import reconstruct
from auricle.sampling.samples import place
from auricle.sampling.samples_file import read_samples


def written(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    path = folder / "points.csv"
    path.write_bytes(text.encode(encoding))
    return path


@pytest.mark.parametrize(
    "text",
    [
        pytest.param("x,y,z,LAT\n1.5,2,3,40\n4,5,-6e0,50.25\n", id="plain"),
        pytest.param("LAT;X;Y;Z\n40;1,5;2;3\n50,25;4;5;-6\n", id="decimal comma"),
        pytest.param("x\ty\tz\tLAT\n1,5\t2\t3\t40\n4\t5\t-6\t50,25\n", id="tabs"),
        pytest.param("# CARTO\r\n\r\nx,y,z,LAT\r\n1.5,2,3,40\r\n\r\n4,5,-6,50.25", id="lines"),
        pytest.param('"x","y","z","LAT"\n"1.5","2","3","40"\n4, 5, -6, 50.25\n', id="quotes"),
        pytest.param("\ufeffx_mm,y_mm,z_mm,LAT [ms]\n1.5,2,3,40\n4,5,-6,50.25\n", id="units"),
        pytest.param("x (cm),y (cm),z (cm),LAT_ms\n.15,.2,.3,40\n.4,.5,-.6,50.25\n", id="cm"),
        pytest.param("x_m,y_mm,z_um,LAT_ms\n.0015,2,3000,40\n.004,5,-6000,50.25\n", id="mixed"),
    ],
)
def test_one_table_written_in_many_ways_is_one_table(tmp_path: Path, text: str) -> None:
    samples = read_samples(written(tmp_path, text))
    assert np.allclose(samples.positions, [[1.5, 2, 3], [4, 5, -6]])
    assert samples.values.tolist() == [40.0, 50.25]
    assert samples.name == "LAT"
    assert samples.noise is None


def test_columns_can_be_named_and_missing_cells_are_missing(tmp_path: Path) -> None:
    text = "Point X,y,z,Bipolar (mV),sd [mV],LAT\n1,2,3,,0.1,a\n4,5,6,2.5,,b\nNaN,0,0,n/a,0.1,c\n"
    path = written(tmp_path, text)
    samples = read_samples(path, columns={"x": "point x"}, value="bipolar", noise="sd")
    assert (samples.name, samples.unit) == ("Bipolar", "mV")
    assert np.array_equal(samples.values, [np.nan, 2.5, np.nan], equal_nan=True)
    assert samples.noise is not None
    assert np.array_equal(samples.noise, [0.1, np.nan, 0.1], equal_nan=True)
    assert np.isnan(samples.positions[2, 0])


HEADER = "x,y,z,LAT\n"


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("", "is empty"),
        ("# only a remark\n\n", "is empty"),
        (HEADER, "has a header but no sample"),
        ("1,2,3,4\n5,6,7,8\n", "has no header, only numbers"),
        ("a b c\n1 2 3\n", "its header has 1 columns"),
        ("x,y,z,cycle,volts\n1,2,3,4,5\n", "has no column 'LAT': it has x, y, z, cycle, volts"),
        ("x,y,z,LAT [ms],lat (s)\n1,2,3,4,5\n", "has 2 columns 'LAT'"),
        ("x_furlong [furlong],y,z,LAT\n1,2,3,4\n", "has no column 'x'"),
        ("x [furlong],y,z,LAT\n1,2,3,4\n", "is in 'furlong': give mm"),
        (HEADER + "1,2,3,4\n1,2,three,4\n", "line 3, column 'z': 'three' is no number"),
        (HEADER + "1,2,3,1_000\n", "'1_000' is no number"),
        (HEADER + "1,2,3\n", "line 2 has 3 cells under 4 headings"),
        (HEADER + "1,5,2,3,40\n", "decimal commas need semicolons"),
        ("x;y;z;LAT\n1.000,5;2;3;40\n", "'1.000,5' is no number"),
        (HEADER + '1,2,3,"4\n', "line 2 is damaged"),
        (HEADER + "1,2,3,\0\n", "is not text"),
    ],
)
def test_faults_are_one_line_that_names_file_and_cause(
    tmp_path: Path, text: str, cause: str
) -> None:
    path = written(tmp_path, text)
    with pytest.raises(FormatError) as caught:
        read_samples(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert cause in message
    assert "\n" not in message


def test_what_is_not_a_text_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"missing.csv: cannot be read \(No such file"):
        read_samples(tmp_path / "missing.csv")
    with pytest.raises(FormatError, match="is a folder"):
        read_samples(tmp_path)
    with pytest.raises(FormatError, match="is not UTF-8 text"):
        read_samples(written(tmp_path, HEADER + "1,2,3,4\n", "utf-16"))


def test_noise_is_positive_or_the_line_is_named(tmp_path: Path) -> None:
    path = written(tmp_path, "x,y,z,LAT,sd\n1,2,3,4,1\n1,2,3,4,-1\n")
    with pytest.raises(FormatError, match="line 3: the noise -1 is not positive"):
        read_samples(path, noise="sd")


def test_a_mapping_systems_own_table_is_read(real_data: Path) -> None:
    samples = read_samples(real_data / "maps" / "points-csv" / "epPoints.csv")
    assert len(samples) == 152
    assert samples.positions[0].tolist() == [-15.9375, -29.8125, 11.2656]
    assert samples.values[:2].tolist() == [1240.0, 750.0]


def test_from_table_to_map(tmp_path: Path, sphere_chamber: Chamber) -> None:
    """A map linear in space comes back from 80 samples of it, off the surface and in cm."""
    rng = np.random.default_rng(7)
    positions = rng.normal(size=(80, 3))
    positions *= 31.0 / np.linalg.norm(positions, axis=1, keepdims=True)
    slope = np.array([1.0, -2.0, 0.5])
    values = 100 + positions @ slope + rng.standard_normal(80)
    rows = [
        f"{x / 10};{y / 10};{z / 10};{value};1.0"
        for (x, y, z), value in zip(positions, values, strict=True)
    ]
    table = "x [cm];y [cm];z [cm];LAT [ms];sd [ms]\n" + "\n".join(rows).replace(".", ",")
    placed = place(read_samples(written(tmp_path, table), noise="sd"), sphere_chamber)
    found = reconstruct(placed, sphere_chamber)
    truth = 100 + sphere_chamber.mesh.vertices @ slope * 31 / 30
    assert (placed.name, placed.unit, placed.remarks) == ("LAT", "ms", ())
    assert 0.4 < found.hyperparameters.noise < 1.6
    assert sphere_chamber.nrmse(found.mean, truth) < 0.05
