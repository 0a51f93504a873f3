"""A generated CT on disk: the image, what each voxel is, the true surface and its landmarks."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from auricle.atomic import write_text
from auricle.errors import InputError
from auricle.imaging.dicom_writing import write_dicom_series
from auricle.imaging.volume import Volume
from auricle.imaging.writing import write_volume
from auricle.progress import Progress, silent
from auricle.simulation.phantom import Phantom, truth_surface
from auricle.study.provenance import versions
from auricle.study.store import json_text
from auricle.surface.soundness import soundness
from auricle.surface.writing import write_surface

FORMATS = {"nrrd": "volume.nrrd", "nifti": "volume.nii.gz", "dicom": "volume"}
"""Name of the image by its format; DICOM is a folder."""


def write_phantom(
    patient: Phantom, folder: Path, *, form: str = "nrrd", progress: Progress = silent
) -> Path:
    """Write a phantom into `folder`; returns the place of the image.

    ``volume.nrrd``, ``volume.nii.gz`` or the folder ``volume``; ``labels.nrrd``, a number a
    voxel; ``truth.vtp``, the true endocardium; and last ``truth.json``, what was asked for, the
    names of the labels and the landmarks.

    Raises
    ------
    InputError
        If the format is none of `FORMATS`.
    OutputError
        If a file cannot be written, or the folder of the DICOM series holds something.
    """
    image = folder / image_name(form)
    if form == "dicom":
        write_dicom_series(patient.volume, image, progress=progress)
    else:
        write_volume(patient.volume, image)
    labels = patient.labels.astype(np.int16)
    labels.flags.writeable = False
    write_volume(Volume(labels, patient.volume.affine), folder / "labels.nrrd")
    surface = truth_surface(patient.truth)
    write_surface(folder / "truth.vtp", surface, space="LPS")
    document = _document(patient) | {"volume_ml": (soundness(surface).volume_mm3 or 0.0) / 1000}
    write_text(folder / "truth.json", json_text(document))
    return image


def image_name(form: str) -> str:
    """Name of the image in a format.

    Raises
    ------
    InputError
        If it is none of `FORMATS`.
    """
    if form not in FORMATS:
        raise InputError(f"no format {form!r}: choose from {', '.join(FORMATS)}")
    return FORMATS[form]


def _document(patient: Phantom) -> dict[str, Any]:
    truth = patient.truth
    return {
        "format": "auricle phantom 1",
        "parameters": asdict(patient.options),
        "versions": versions(),
        "space": "LPS",
        "labels": {str(label): name for label, name in patient.tissues.items()},
        "landmarks": {
            "seed_mm": truth.seed.tolist(),
            "mitral_centre_mm": truth.mitral_centre.tolist(),
            "mitral_normal": truth.mitral_normal.tolist(),
            "mitral_radius_mm": truth.mitral_radius,
            "ostia_mm": truth.ostia.tolist(),
            "appendage_tip_mm": truth.appendage_tip.tolist(),
        },
        "mask_volume_ml": patient.mask.volume_ml,
    }
