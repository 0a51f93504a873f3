"""What the page asks of the open surface."""

from auricle.viewer.bundle import surface_bundle
from auricle.viewer.endpoints import Call, Endpoint
from auricle.viewer.open_case import OpenCase


def case(call: Call) -> bytes:
    """The bundle of the open surface."""
    opened = call.workspace.require(OpenCase, "no surface is open")
    return surface_bundle(opened.prepared, name=opened.name, remarks=opened.remarks)


ENDPOINTS = (Endpoint("GET", "/api/case", case),)
