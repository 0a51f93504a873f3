"""What the page asks of the open surface."""

from dataclasses import dataclass

from auricle.study.preparation import PreparedSurface
from auricle.viewer.bundle import surface_bundle
from auricle.viewer.endpoints import Call, Endpoint
from auricle.viewer.open_case import OpenCase


@dataclass(frozen=True, eq=False)
class CaseBundle:
    """What was last sent of a surface: a page that is reloaded need not wait for it again."""

    prepared: PreparedSurface
    content: bytes


def case(call: Call) -> bytes:
    """The bundle of the open surface."""
    opened = call.workspace.require(OpenCase, "no surface is open")
    sent = call.workspace.find(CaseBundle)
    if sent is None or sent.prepared is not opened.prepared:
        content = surface_bundle(opened.prepared, name=opened.name, remarks=opened.remarks)
        sent = CaseBundle(opened.prepared, content)
        call.workspace.put(sent)
    return sent.content


ENDPOINTS = (Endpoint("GET", "/api/case", case),)
