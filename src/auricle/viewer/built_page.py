"""The exported page: the same page with its data inside, for a disk without a network."""

import base64
import re
from pathlib import Path

from auricle.viewer.guard import content_policy

BUILT = Path(__file__).with_name("static") / "page.html"
"""The page as built from ``page/``."""

_EMPTY = '<script type="application/octet-stream" id="case"></script>'


def exported_page(bundle: bytes, page: str | None = None) -> str:
    """The page as one HTML text that carries a case and asks nobody for anything.

    Parameters
    ----------
    bundle
        What `auricle.viewer.bundle.surface_bundle` gave.
    page
        The page without a case; None for the built one.

    Examples
    --------
    >>> text = exported_page(b"case", "<head>" + _EMPTY)
    >>> "Y2FzZQ==" in text, "connect-src 'none'" in text
    (True, True)
    """
    empty = BUILT.read_text(encoding="utf-8") if page is None else page
    # A policy in the page itself cannot say who may frame it.
    policy = re.sub(r"; frame-ancestors[^;]*", "", content_policy(empty))
    policy = policy.replace("connect-src 'self'", "connect-src 'none'")
    meta = f'<head>\n<meta http-equiv="Content-Security-Policy" content="{policy}">'
    carried = _EMPTY.replace("></", f">{base64.b64encode(bundle).decode()}</")
    return empty.replace("<head>", meta, 1).replace(_EMPTY, carried, 1)
