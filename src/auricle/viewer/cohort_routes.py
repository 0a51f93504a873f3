"""What the page asks of a study: its tables, and a case to be opened."""

from collections.abc import Mapping
from typing import Any

from auricle.progress import Progress
from auricle.study.preparation import prepare_soup
from auricle.study.result import Source
from auricle.viewer.cohort_session import CohortSession
from auricle.viewer.endpoints import Call, Endpoint, Work
from auricle.viewer.open_case import OpenCase
from auricle.viewer.opening import Detail

_NO_COHORT = "no study is open"
_VERTICES_A_MODE = 4


def cohort(call: Call) -> Mapping[str, Any]:
    """The study's cases and tables."""
    return call.workspace.require(CohortSession, _NO_COHORT).document()


def open_case(call: Call) -> Work:
    """Open a case of the study, ``{"key": …}``, beside it."""
    workspace = call.workspace
    session = workspace.require(CohortSession, _NO_COHORT)
    key = str(call.document().get("key", ""))

    def run(progress: Progress) -> Mapping[str, Any]:
        progress("prepare surface", 0, 3)
        name, soup = session.surface(key)
        detail = workspace.find(Detail) or Detail()
        prepared = prepare_soup(
            soup,
            Source(name, 0, key),
            n_vertices=detail.n_vertices,
            n_modes=max(min(detail.n_modes, len(soup.vertices) // _VERTICES_A_MODE), 2),
            progress=progress,
        )
        with workspace.lock:
            workspace.put(OpenCase(name, prepared, remarks=prepared.remarks))
        return {"name": name}

    return Work(run)


ENDPOINTS = (
    Endpoint("GET", "/api/cohort", cohort),
    Endpoint("POST", "/api/cohort/open", open_case),
)
