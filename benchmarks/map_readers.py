"""What other readers of vendors' exports make of the same files, beside ours.

    python benchmarks/map_readers.py [--pyceps PYTHON] [--carto-reader PYTHON] [--report FILE]

Each PYTHON is the interpreter of a throw-away environment that holds that package and nothing of
auricle; a reader without one is left out. The inputs are the genuine CARTO 3 export found through
AURICLE_DATA, zipped and unpacked, and synthetic exports of a known map: CARTO 3 (`_car.txt` 4 to
6, a zip and a folder), EnSite Precision and OpenEP. Told are maps, vertices, points, points with
signals and, where the truth is known, the largest deviation of positions, times and voltages; or
the fault.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from auricle.atomic import write_text
from auricle.electroanatomy.formats.carto_writing import write_carto
from auricle.electroanatomy.formats.ensite_writing import write_ensite
from auricle.electroanatomy.formats.openep_writing import write_openep
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.electroanatomy.synthetic import Acquisition, synthetic_map
from auricle.surface.shapes import ellipsoid

GENUINE = "maps/carto3-export/carto_flat.zip"
SECONDS = 300
OURS = """
import json, sys
from pathlib import Path
from auricle.electroanatomy.reading import read_study
study = read_study(Path(sys.argv[1]))
maps = [
    {
        "vertices": 0 if one.surface is None else len(one.surface.vertices),
        "points": len(one.points),
        "signals": len(one.electrograms),
        "positions": one.points.positions.tolist(),
        "times": one.points.local_activation_time.tolist(),
        "voltages": one.points.bipolar_voltage.tolist(),
    }
    for one in study.maps
]
print("RESULT" + json.dumps(maps))
"""
PYCEPS = """
import json, sys
from pathlib import Path
import numpy as np
from pyceps.carto import CartoStudy
from pyceps.precision import PrecisionStudy
path = sys.argv[1]
study = (PrecisionStudy if "ensite" in path else CartoStudy)(path)
study.import_study()
study.import_maps()
maps = []
for one in study.maps.values():
    points = one.points
    maps.append({
        "vertices": 0 if one.surface is None else len(one.surface.X),
        "points": len(points),
        "signals": sum(bool(len(point.egmBip)) for point in points),
        "positions": [np.asarray(point.recX, float).ravel().tolist() for point in points],
        "times": [float(point.latAnnotation) - float(point.refAnnotation) for point in points],
        "voltages": [float(point.bipVoltage) for point in points],
    })
print("RESULT" + json.dumps(maps))
"""
CARTO_READER = """
import json, sys
from carto_reader import Carto
study = Carto(sys.argv[1])
maps = []
for name in study:
    one = study[name]
    points = list(one.points.values())
    heard = 0
    for point in points:
        signals = study.signal_from_point(point)
        heard += len(signals["bi"]) > 0
    maps.append({
        "vertices": one.mesh.num_v,
        "points": len(points),
        "signals": heard,
        "positions": [list(map(float, point.pos)) for point in points],
        "times": [float(point["lat"]) for point in points],
        "voltages": [float(point["bi"]) for point in points],
    })
print("RESULT" + json.dumps(maps))
"""
PROBES: Mapping[str, str] = {"auricle": OURS, "pyCEPS": PYCEPS, "carto-reader": CARTO_READER}


def truth() -> ElectroanatomicMap:
    """A map of 40 points, a tenth of them without a unipole."""
    mesh = ellipsoid(semi_axes=(30.0, 25.0, 20.0), subdivisions=3)
    fields = {
        "local_activation_time": np.asarray(mesh.vertices[:, 0] / 0.5),
        "bipolar_voltage": 2.0 + mesh.vertices[:, 2] / 20.0,
    }
    acquisition = Acquisition(n_points=40, duration=2500.0)
    return synthetic_map(mesh, fields, acquisition=acquisition, rng=np.random.default_rng(1))


def inputs(folder: Path, one: ElectroanatomicMap) -> Iterator[tuple[str, Path, bool]]:
    """Name, place and whether the truth is known of each input."""
    genuine = Path(os.environ["AURICLE_DATA"]) / GENUINE
    yield "CARTO 3 v7, genuine, zip", genuine, False
    with zipfile.ZipFile(genuine) as archive:
        archive.extractall(folder / "genuine")
    yield "the same, unpacked", folder / "genuine", False
    study = ElectroanatomicStudy("synthetic", (one,))
    for version in (4, 5, 6):
        place = folder / f"carto_{version}"
        write_carto(place, study, version=version)
        yield f"CARTO 3 synthetic, _car {version}, zip", zipped(place), True
    yield "CARTO 3 synthetic, folder", folder / "carto_6", True
    write_ensite(folder / "ensite", study)
    yield "EnSite Precision synthetic, zip", zipped(folder / "ensite"), True
    yield "EnSite Precision synthetic, folder", folder / "ensite", True
    for version in ("7", "7.3"):
        place = folder / f"openep_{version}.mat"
        write_openep(place, one, version=version)
        yield f"OpenEP .mat {version}, synthetic", place, True


def zipped(place: Path) -> Path:
    """A zip archive of a folder, beside it."""
    archive_place = place.with_suffix(".zip")
    with zipfile.ZipFile(archive_place, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(path for path in place.rglob("*") if path.is_file()):
            archive.write(file, file.relative_to(place))
    return archive_place


def probed(python: str, probe: str, path: Path) -> list[dict[str, Any]] | str:
    """What a reader finds in an export, or its fault in a line."""
    try:
        done = subprocess.run(
            [python, "-c", probe, str(path)],
            capture_output=True,
            text=True,
            timeout=SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no end after {SECONDS} s"
    for line in done.stdout.splitlines():
        if "RESULT" in line:
            found: list[dict[str, Any]] = json.loads(line[line.index("RESULT") + 6 :])
            return found
    lines = done.stderr.strip().splitlines() or ["no result"]
    return lines[-1][:110].replace(str(path), path.name)


def told(found: list[dict[str, Any]] | str, one: ElectroanatomicMap | None) -> str:
    """A cell of the table."""
    if isinstance(found, str):
        return f"fails: {found}"
    vertices = ", ".join(str(each["vertices"]) for each in found)
    n_points, n_signals = (sum(each[key] for each in found) for key in ("points", "signals"))
    words = f"{len(found)} maps ({vertices} vertices), {n_points} points, {n_signals} with signals"
    if one is None or len(found) != 1 or found[0]["points"] != len(one.points):
        return words
    known = one.points
    pairs = (
        ("positions", known.positions, "mm"),
        ("times", known.local_activation_time, "ms"),
        ("voltages", known.bipolar_voltage, "mV"),
    )
    off = []
    for key, right, unit in pairs:
        error = np.abs(np.asarray(found[0][key], dtype=float) - right)
        n_known = int(np.isfinite(error).sum())
        largest = f"{np.nanmax(error):.2g} {unit}" if n_known else "none"
        lost = "" if n_known == error.size else f" ({error.size - n_known} missing)"
        off.append(f"{key} {largest}{lost}")
    return f"{words}; off by {', '.join(off)}"


def main() -> None:
    """Print the table and, if asked for, write it."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--pyceps")
    options.add_argument("--carto-reader")
    options.add_argument("--report", type=Path)
    chosen = options.parse_args()
    pythons = {
        "auricle": sys.executable,
        "pyCEPS": chosen.pyceps,
        "carto-reader": chosen.carto_reader,
    }
    names = [name for name in PROBES if pythons[name]]
    lines = [f"| input | {' | '.join(names)} |", "|---" * (len(names) + 1) + "|"]
    one = truth()
    with tempfile.TemporaryDirectory() as folder:
        for title, path, known in inputs(Path(folder), one):
            cells = [
                told(probed(str(pythons[name]), PROBES[name], path), one if known else None)
                for name in names
            ]
            lines.append(f"| {title} | {' | '.join(cells)} |")
            sys.stdout.write(lines[-1] + "\n")
            sys.stdout.flush()
    if chosen.report is not None:
        write_text(chosen.report, "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
