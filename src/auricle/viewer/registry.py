"""Everything the page may ask of the server, gathered from the modules that answer."""

from auricle.viewer.case_routes import ENDPOINTS as CASE
from auricle.viewer.cohort_routes import ENDPOINTS as COHORT
from auricle.viewer.endpoints import Endpoint
from auricle.viewer.live_routes import ENDPOINTS as LIVE
from auricle.viewer.page_routes import ENDPOINTS as PAGE
from auricle.viewer.plan_routes import ENDPOINTS as PLAN
from auricle.viewer.segment_routes import ENDPOINTS as SEGMENT

ENDPOINTS: tuple[Endpoint, ...] = (*PAGE, *CASE, *PLAN, *LIVE, *SEGMENT, *COHORT)
"""Each module of answers adds its own."""
