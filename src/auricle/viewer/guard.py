"""The guard: which requests reach the server at all, and under which headers answers leave."""

import base64
import hashlib
import re
import secrets

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

NAMES = ("127.0.0.1", "localhost", "[::1]")
"""Under which this machine may call itself."""
OPEN = (("GET", "/"), ("HEAD", "/"), ("POST", "/api/session"))
"""Requests that need no secret: the empty page, and the exchange of the token for the secret."""
_SAME = ("same-origin", "none")


class Keys:
    """The token of the address, good once, and the secret it is exchanged for.

    >>> keys = Keys("once")
    >>> keys.exchange("once") == keys.secret, keys.exchange("once")
    (True, None)
    """

    def __init__(self, token: str) -> None:
        self.secret = secrets.token_urlsafe(32)
        self._token: str | None = token

    def exchange(self, token: str) -> str | None:
        """The secret, for the token the first time; otherwise None."""
        expected = self._token
        if expected is None or not _equal(token, expected):
            return None
        self._token = None
        return self.secret

    def accept(self, authorization: str) -> bool:
        """Whether a request's header carries the secret."""
        return _equal(authorization, f"Bearer {self.secret}")


class Guard:
    """In front of the whole server: nothing is answered, not even "no such page", before this.

    Refused are web sockets, hosts other than this machine's own names with the right port (a
    foreign name that was made to point here), requests a foreign page caused, and whatever does
    not carry the secret. Every answer leaves with a content security policy and the headers that
    keep it out of caches, frames and foreign pages.

    Parameters
    ----------
    app
        The server.
    keys
        Token and secret.
    port
        Where the server listens.
    policy
        The content security policy, see `content_policy`.
    """

    def __init__(self, app: ASGIApp, *, keys: Keys, port: int, policy: str) -> None:
        self.app = app
        self.keys = keys
        self.hosts = {f"{name}:{port}" for name in NAMES}
        self.headers = {
            "content-security-policy": policy,
            "x-content-type-options": "nosniff",
            "x-frame-options": "DENY",
            "referrer-policy": "no-referrer",
            "cache-control": "no-store",
            "cross-origin-opener-policy": "same-origin",
            "cross-origin-resource-policy": "same-origin",
            "permissions-policy": "camera=(), geolocation=(), microphone=()",
        }

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request, or refuse it."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
        elif scope["type"] != "http":
            await send({"type": "websocket.close", "code": 1008})
        else:
            await self._answer(scope, receive, send)

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def send_guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(self.headers)
            await send(message)

        refused = self._refusal(scope)
        if refused is None:
            await self.app(scope, receive, send_guarded)
            return
        code, cause = refused
        response = JSONResponse({"error": cause}, code, headers={"connection": "close"})
        await response(scope, receive, send_guarded)

    def _refusal(self, scope: Scope) -> tuple[int, str] | None:
        headers = Headers(scope=scope)
        if headers.getlist("host") not in [[host] for host in self.hosts]:
            return 400, "foreign host: open the address that auricle printed"
        origins = {f"http://{host}" for host in self.hosts}
        if any(origin not in origins for origin in headers.getlist("origin")):
            return 403, "foreign origin: open the address that auricle printed"
        if headers.get("sec-fetch-site", "none") not in _SAME:
            return 403, "asked by a foreign page: open the address that auricle printed"
        if (scope["method"], scope["path"]) in OPEN:
            return None
        if not self.keys.accept(headers.get("authorization", "")):
            return 401, "no secret: open the address that auricle printed last"
        return None


def content_policy(page: str) -> str:
    """The content security policy under which this page, and nothing else, runs.

    Its inline scripts and styles are named by their SHA-256; there is no other source of either.

    Examples
    --------
    >>> "script-src 'sha256-" in content_policy("<script>start()</script>")
    True
    >>> "unsafe" in content_policy("")
    False
    """
    scripts = " ".join(_hashes(page, "script")) or "'none'"
    styles = " ".join(_hashes(page, "style")) or "'none'"
    return (
        f"default-src 'none'; script-src {scripts}; style-src {styles}; img-src data: blob:; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )


def _hashes(page: str, tag: str) -> list[str]:
    found = re.findall(rf"<{tag}\b([^>]*)>(.*?)</{tag}>", page, re.DOTALL)
    runs = (text for attributes, text in found if "application/" not in attributes)
    digests = (hashlib.sha256(text.encode()).digest() for text in runs)
    return [f"'sha256-{base64.b64encode(digest).decode()}'" for digest in digests]


def _equal(given: str, expected: str) -> bool:
    return secrets.compare_digest(given.encode(), expected.encode())
