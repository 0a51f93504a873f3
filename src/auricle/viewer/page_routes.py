"""What every page asks first: what is open; and the opening of files dropped on it."""

from collections.abc import Mapping
from typing import Any

from auricle import __version__
from auricle.errors import InputError
from auricle.progress import Progress
from auricle.viewer.dropped_files import unpacked
from auricle.viewer.endpoints import Call, Endpoint, Work
from auricle.viewer.open_case import OpenStudy
from auricle.viewer.opening import Detail, chosen_map, open_path

NOTICE = "Research software, not a medical device."


def page(call: Call) -> Mapping[str, Any]:
    """What is open: its name, the views that show it, and what there is of it."""
    return {"version": __version__, "notice": NOTICE, **call.workspace.described()}


def open_upload(call: Call) -> Work:
    """Open the uploaded file in place of what was open."""
    path, workspace = call.uploaded(), call.workspace

    def run(progress: Progress) -> Mapping[str, Any]:
        try:
            open_path(workspace, path, workspace.find(Detail), progress=progress)
        except InputError as fault:
            raise InputError(str(fault).replace(str(path), path.name)) from fault
        return page(call)

    return Work(run)


def open_dropped(call: Call) -> Work:
    """Open a folder, or several files of one case, in place of what was open."""
    packed, workspace = call.uploaded(), call.workspace

    def run(progress: Progress) -> Mapping[str, Any]:
        path = unpacked(packed, packed.parent / "files")
        packed.unlink()
        try:
            open_path(workspace, path, workspace.find(Detail), progress=progress)
        except InputError as fault:
            raise InputError(str(fault).replace(str(path), "the dropped files")) from fault
        return page(call)

    return Work(run)


def open_map(call: Call) -> Work:
    """Open another map of the export: ``{"number": 2}``."""
    number = call.document().get("number")
    if not isinstance(number, int):
        raise InputError("which map: give its number")
    workspace = call.workspace
    study = workspace.require(OpenStudy, "no export of a mapping system is open")

    def run(progress: Progress) -> Mapping[str, Any]:
        detail = workspace.find(Detail) or Detail()
        parts = chosen_map(study.study, study.source, number, detail, progress=progress)
        with workspace.lock:
            workspace.open(workspace.name, (detail, *parts))
        return page(call)

    return Work(run)


ENDPOINTS = (
    Endpoint("GET", "/api/page", page),
    Endpoint("POST", "/api/open", open_upload, takes_file=True),
    Endpoint("POST", "/api/open-dropped", open_dropped, takes_file=True),
    Endpoint("POST", "/api/map", open_map),
)
