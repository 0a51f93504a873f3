"""Everything the page may ask of the server, gathered from the modules that answer."""

from auricle.viewer.endpoints import Endpoint
from auricle.viewer.page_routes import ENDPOINTS as PAGE

ENDPOINTS: tuple[Endpoint, ...] = (*PAGE,)
"""Each module of answers adds its own."""
