"""RO-Crate metadata of a study's folder: what its files are and what made them (JSON-LD).

After RO-Crate 1.1 (https://w3id.org/ro/crate/1.1) and its profile for runs of a process.
"""

import hashlib
import mimetypes
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from auricle import __version__
from auricle.atomic import write_text
from auricle.study.cohort.gathering import Cohort
from auricle.study.cohort.study_file import Study
from auricle.study.store import json_text

CRATE = "ro-crate-metadata.json"

_CONFORMS = "https://w3id.org/ro/crate/1.1"
_ENGINE = "#auricle"
_RUN = "#run"
_NO_LICENCE = "Not stated: the licences of the inputs apply."
_MEDIA = {".parquet": "application/vnd.apache.parquet", ".md": "text/markdown"}


def write_crate(study: Study, cohort: Cohort, folder: Path) -> Path:
    """Write the metadata of everything in `folder`; to be called last. Returns the place.

    Inputs are named by file name and SHA-256, never by the folder they lie in.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    files = sorted(each for each in folder.rglob("*") if _belongs(each, folder))
    parts = [_file(each, folder) for each in files]
    inputs = [_input(kept.values) for kept in cohort.finished]
    graph = [
        _descriptor(),
        _root(study, parts),
        _licence(study),
        _engine(),
        _run(inputs, parts),
        *inputs,
        *parts,
    ]
    place = folder / CRATE
    write_text(place, json_text({"@context": f"{_CONFORMS}/context", "@graph": graph}))
    return place


def _belongs(path: Path, folder: Path) -> bool:
    inside = path.relative_to(folder)
    hidden = any(part.startswith(".") for part in inside.parts)
    return path.is_file() and not hidden and inside != Path(CRATE)


def _reference(entities: Sequence[dict[str, Any]]) -> list[dict[str, str]]:
    return [{"@id": each["@id"]} for each in entities]


def _descriptor() -> dict[str, Any]:
    return {
        "@id": CRATE,
        "@type": "CreativeWork",
        "conformsTo": {"@id": _CONFORMS},
        "about": {"@id": "./"},
    }


def _root(study: Study, parts: Sequence[dict[str, Any]]) -> dict[str, Any]:
    return {
        "@id": "./",
        "@type": "Dataset",
        "name": study.title,
        "description": study.description or f"{study.title}: results of `auricle study`.",
        "datePublished": datetime.now(UTC).date().isoformat(),
        "license": {"@id": "#licence"},
        "mentions": {"@id": _RUN},
        "hasPart": _reference(parts),
    }


def _licence(study: Study) -> dict[str, Any]:
    return {"@id": "#licence", "@type": "CreativeWork", "name": study.licence or _NO_LICENCE}


def _engine() -> dict[str, Any]:
    return {
        "@id": _ENGINE,
        "@type": "SoftwareApplication",
        "name": "auricle",
        "softwareVersion": __version__,
        "description": "Research software, not a medical device.",
    }


def _run(inputs: Sequence[dict[str, Any]], parts: Sequence[dict[str, Any]]) -> dict[str, Any]:
    return {
        "@id": _RUN,
        "@type": "CreateAction",
        "name": "auricle study",
        "instrument": {"@id": _ENGINE},
        "object": _reference(inputs),
        "result": _reference(parts),
    }


def _input(values: dict[str, Any]) -> dict[str, Any]:
    source = values.get("source", {})
    digest = source.get("sha256", "")
    return {
        "@id": f"#input-{digest[:16] or values['case']}",
        "@type": "CreativeWork",
        "name": source.get("name", values["case"]),
        "identifier": f"sha256:{digest}",
    }


def _file(path: Path, folder: Path) -> dict[str, Any]:
    with path.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    media = _MEDIA.get(path.suffix) or mimetypes.guess_type(path.name)[0]
    return {
        "@id": path.relative_to(folder).as_posix(),
        "@type": "File",
        "name": path.name,
        "contentSize": str(path.stat().st_size),
        "encodingFormat": media or "application/octet-stream",
        "sha256": digest,
    }
