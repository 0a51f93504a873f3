"""How well the left atrium of a generated CT is found, against its analytic truth.

    python benchmarks/segmentation.py table OUT.csv            thirty phantoms, seeds and hardships
    python benchmarks/segmentation.py document OUT.csv PAGE.md the table put into the page
    python benchmarks/segmentation.py clinical                 512×512×250: seconds, memory, errors
    python benchmarks/segmentation.py formats                  DICOM, NRRD, NIfTI: one surface
    python benchmarks/segmentation.py labels FILE N[,N] …      surface volume of label maps

Ends are vertices more than 1.5 mm off the true endocardium: nearly all lie where a vein or the
mitral orifice was cut, which is a convention and no wall; their share is told.
"""

import argparse
import csv
import os
import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from auricle.errors import AuricleError
from auricle.imaging.dicom_writing import write_dicom_series
from auricle.imaging.labels import label_mask
from auricle.imaging.reading import read_volume
from auricle.imaging.resampling import mask_on
from auricle.imaging.segmentation import Segmentation, segment
from auricle.imaging.writing import write_volume
from auricle.simulation.phantom import Phantom, PhantomOptions, phantom
from auricle.simulation.phantom_options import HOSTILE, hostile
from auricle.surface.endocardium import Endocardium, endocardium, endocardium_of_mask
from auricle.surface.soundness import soundness

END_MM = 1.5
CASES = (
    *((preset, seed, "nominal") for seed in range(1, 7) for preset in ("small", "medium")),
    *(
        ("medium" if number % 3 == 0 else "small", 11 + number % 7, name)
        for number, name in enumerate(name for name in HOSTILE if name != "nominal")
    ),
    ("small", 21, "equal_contrast"),
)
"""Thirty: preset, seed and hardship."""
FIELDS = (
    "preset", "seed", "case", "verdict", "reasons", "truth_ml", "dice", "volume_percent",
    "mean_mm", "bias_mm", "p95_mm", "ends_percent", "vertices", "seconds",
)  # fmt: skip

HEAD = (
    "preset", "seed", "case", "verdict", "reasons", "truth, ml", "Dice", "volume, %",
    "mean, mm", "bias, mm", "95 %, mm", "ends, %", "vertices", "s",
)  # fmt: skip


def main() -> None:
    """Run the part asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=("table", "document", "clinical", "formats", "labels"))
    parser.add_argument("arguments", nargs="*")
    given = parser.parse_args()
    if given.part == "table":
        _table(Path(given.arguments[0]))
    elif given.part == "document":
        _document(Path(given.arguments[0]), Path(given.arguments[1]))
    elif given.part == "labels":
        for path, label in zip(given.arguments[::2], given.arguments[1::2], strict=True):
            _label_map(Path(path), [int(each) for each in label.split(",")])
    else:
        {"clinical": _clinical, "formats": _formats}[given.part]()


def _table(place: Path) -> None:
    rows = []
    with place.open("w", newline="") as file:
        writer = csv.DictWriter(file, FIELDS)
        writer.writeheader()
        for case in CASES:
            rows.append(_row(*case))
            writer.writerow(rows[-1])
            file.flush()
            _say("  ".join(map(str, rows[-1].values())))
    good = [row for row in rows if row["verdict"] == "ok" and row["dice"] >= 0.93]
    silent = [row for row in rows if row["verdict"] == "ok" and row["dice"] < 0.90]
    _say(f"{len(good)} of {len(rows)} ok with Dice 0.93; {len(silent)} silently under 0.90")


def _document(place: Path, page: Path) -> None:
    """Put the table where the page has one, after the line that begins with its head."""
    with place.open(newline="") as file:
        rows = list(csv.DictReader(file))
    table = ["| " + " | ".join(HEAD) + " |", "|" + "---|" * len(HEAD)]
    table += ["| " + " | ".join(row[name] or "–" for name in FIELDS) + " |" for row in rows]
    before, _, rest = page.read_text(encoding="utf-8").partition(f"| {HEAD[0]} | {HEAD[1]} |")
    after = rest.partition("\n\n")[2]
    page.write_text(before + "\n".join(table) + "\n\n" + after, encoding="utf-8")


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def _row(preset: str, seed: int, case: str) -> dict[str, Any]:
    patient = phantom(hostile(case, PhantomOptions(preset=preset, seed=seed)))
    row: dict[str, Any] = dict.fromkeys(FIELDS, "") | {
        "preset": preset,
        "seed": seed,
        "case": case,
        "truth_ml": round(patient.mask.volume_ml, 1),
    }
    start = time.perf_counter()
    try:
        found = segment(patient.volume)
        surface = endocardium(patient.volume, found)
    except AuricleError as fault:
        code = getattr(fault, "code", type(fault).__name__)
        return row | {"verdict": "refused", "reasons": code, "dice": 0.0}
    seconds = time.perf_counter() - start
    return row | _measures(patient, found, surface) | {"seconds": round(seconds, 1)}


def _measures(patient: Phantom, found: Segmentation, surface: Endocardium) -> dict[str, Any]:
    mask, truth = mask_on(found.mask, patient.volume).voxels, patient.mask
    away = patient.truth.distance(surface.mesh.vertices)
    wall = away[np.abs(away) <= END_MM]
    volume_ml = (surface.soundness.volume_mm3 or 0.0) / 1000
    return {
        "verdict": found.verdict.value,
        "reasons": " ".join(sorted({each.code for each in found.reasons})),
        "dice": round(2.0 * (mask & truth.voxels).sum() / (mask.sum() + truth.voxels.sum()), 3),
        "volume_percent": round(100 * (volume_ml / truth.volume_ml - 1), 1),
        "mean_mm": round(float(np.abs(wall).mean()), 3),
        "bias_mm": round(float(wall.mean()), 3),
        "p95_mm": round(float(np.percentile(np.abs(wall), 95)), 2),
        "ends_percent": round(100 * (1 - len(wall) / len(away)), 1),
        "vertices": surface.mesh.n_vertices,
    }


def _clinical() -> None:
    start = time.process_time()
    patient = phantom(PhantomOptions(preset="clinical", seed=1))
    _say(f"generated: {time.process_time() - start:.1f} s CPU, peak {_peak_gib():.2f} GiB")
    begun, start = time.perf_counter(), time.process_time()
    found = segment(patient.volume)
    halfway = time.perf_counter() - begun
    surface = endocardium(patient.volume, found)
    _say(
        f"segmented: {halfway:.1f} s wall, and meshed: {time.perf_counter() - begun:.1f} s wall, "
        f"{time.process_time() - start:.1f} s CPU, peak {_peak_gib():.2f} GiB"
    )
    for name, value in _measures(patient, found, surface).items():
        _say(f"{name}: {value}")


def _peak_gib() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


def _formats() -> None:
    for oblique in (0.0, 17.0):
        patient = phantom(PhantomOptions(preset="small", seed=2, oblique=oblique))
        with tempfile.TemporaryDirectory() as folder:
            surfaces = dict(_surfaces_by_format(patient, Path(folder)))
        first = surfaces.pop("dicom")
        for name, mesh in surfaces.items():
            same = mesh.faces.shape == first.faces.shape and (mesh.faces == first.faces).all()
            apart = np.abs(mesh.vertices - first.vertices).max() if same else np.nan
            _say(f"{oblique:g}° {name} against DICOM: {apart:.2e} mm, {first.n_vertices} vertices")


def _surfaces_by_format(patient: Phantom, folder: Path) -> Iterator[tuple[str, Any]]:
    write_volume(patient.volume, folder / "a.nrrd")
    write_volume(patient.volume, folder / "a.nii.gz")
    write_dicom_series(patient.volume, folder / "dicom")
    write_dicom_series(patient.volume, folder / "shuffled")
    files = sorted((folder / "shuffled").iterdir())
    order = np.random.default_rng(3).permutation(len(files)).tolist()
    for number, file in zip(order, files, strict=True):
        file.rename(file.with_name(f"x{number:04d}"))
    for name in ("dicom", "shuffled", "a.nrrd", "a.nii.gz"):
        volume = read_volume(folder / name)
        yield name, endocardium(volume, segment(volume)).mesh


def _label_map(path: Path, label: list[int]) -> None:
    mask = label_mask(path, label)
    start = time.perf_counter()
    surface = endocardium_of_mask(mask)
    found = soundness(surface.mesh)
    volume_ml = (found.volume_mm3 or 0.0) / 1000
    _say(
        f"{path.name} {label}: voxels {mask.volume_ml:.2f} ml, surface {volume_ml:.2f} ml "
        f"({100 * (volume_ml / mask.volume_ml - 1):+.2f} %), closed {found.is_closed}, genus "
        f"{found.genus}, {found.n_vertices:,} vertices, {time.perf_counter() - start:.1f} s; "
        f"{'; '.join(map(str, surface.repairs)) or 'no repair'}"
    )


if __name__ == "__main__":
    sys.exit(main())
