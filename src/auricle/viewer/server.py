"""The server behind the live page: one visitor, this machine only."""

import asyncio
import contextlib
import json
import secrets
import shutil
import socket
import tempfile
import urllib.parse
from collections.abc import AsyncIterator, Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import anyio.to_thread
import uvicorn
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route
from starlette.types import ASGIApp

from auricle.errors import AuricleError, OutputError
from auricle.viewer.endpoints import LARGEST_DOCUMENT, Answer, Call, Endpoint, Work
from auricle.viewer.file_names import plain_name
from auricle.viewer.guard import Guard, Keys, content_policy
from auricle.viewer.registry import ENDPOINTS
from auricle.viewer.work_stream import lines
from auricle.viewer.workspace import Workspace

PAGE = Path(__file__).with_name("static") / "page.html"
LARGEST_UPLOAD = 1024**3
"""Bytes of an uploaded file, unless told otherwise."""
SECONDS_FOR_A_PART = 30.0
"""Longest wait for the next part of a request."""
_DRAINED = 8 * 1024**2
_SECONDS_TO_DRAIN = 1.0


def application(
    workspace: Workspace,
    *,
    token: str,
    port: int,
    largest_upload: int = LARGEST_UPLOAD,
    endpoints: Sequence[Endpoint] = ENDPOINTS,
    page: str | None = None,
) -> ASGIApp:
    """The page and everything it may ask, behind its guard.

    Parameters
    ----------
    workspace
        What is open.
    token
        Good once, for the secret that all other requests must carry.
    port
        Where it will listen: part of the names it answers to.
    largest_upload
        Bytes of a file beyond which an upload is refused while it comes.
    endpoints
        What answers under ``/api``.
    page
        The page itself; None for the built one.
    """
    keys = Keys(token)
    text = PAGE.read_text(encoding="utf-8") if page is None else page

    async def show(_request: Request) -> Response:
        return Response(text, media_type="text/html; charset=utf-8")

    async def exchange(request: Request) -> Response:
        body = await _body(request, LARGEST_DOCUMENT)
        secret = keys.exchange(_token_in(body))
        if secret is None:
            raise HTTPException(401, "this link has been used or is old: run auricle view again")
        return JSONResponse({"secret": secret})

    routes = [
        Route("/", show, methods=["GET"]),
        Route("/api/session", exchange, methods=["POST"]),
        *(
            Route(
                each.address,
                partial(_respond, each, workspace, largest_upload),
                methods=[each.method],
            )
            for each in endpoints
        ),
    ]
    handlers: dict[Any, Callable[..., Any]] = {HTTPException: _refused, Exception: _broken}
    app = Starlette(routes=routes, exception_handlers=handlers)
    return Guard(app, keys=keys, port=port, policy=content_policy(text))


def serve(
    open_workspace: Callable[[Path], Workspace],
    *,
    port: int = 0,
    largest_upload: int = LARGEST_UPLOAD,
    ready: Callable[[str], None],
) -> None:
    """Serve the page on this machine until interrupted.

    Parameters
    ----------
    open_workspace
        From the folder for uploads to what is shown first.
    port
        Where to listen; 0 for any free port.
    largest_upload
        As in `application`.
    ready
        Told the page's address, with its token, once it listens.

    Raises
    ------
    OutputError
        If the port is taken.
    """
    with tempfile.TemporaryDirectory(prefix="auricle-") as folder:
        workspace = open_workspace(Path(folder))
        with _listening(port) as listener:
            token = secrets.token_urlsafe(32)
            found = listener.getsockname()[1]
            app = application(workspace, token=token, port=found, largest_upload=largest_upload)
            settings = uvicorn.Config(
                app,
                access_log=False,
                log_level="warning",
                ws="none",
                lifespan="off",
                server_header=False,
                timeout_graceful_shutdown=1,
            )
            ready(f"http://127.0.0.1:{found}/#token={token}")
            uvicorn.Server(settings).run(sockets=[listener])


def _listening(port: int) -> socket.socket:
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind(("127.0.0.1", port))
    except (OSError, OverflowError) as fault:
        listener.close()
        raise OutputError(f"port {port} cannot be used ({fault}): give another") from fault
    listener.listen(64)
    return listener


async def _respond(
    endpoint: Endpoint, workspace: Workspace, largest_upload: int, request: Request
) -> Response:
    _require_kind(request, endpoint)
    if not endpoint.takes_file:
        call = Call(
            workspace,
            request.path_params,
            request.query_params,
            await _body(request, LARGEST_DOCUMENT),
        )
        return await _answered(endpoint, call, request)
    place = Path(tempfile.mkdtemp(dir=workspace.folder))
    with contextlib.ExitStack() as unless_whole:
        unless_whole.callback(shutil.rmtree, place, ignore_errors=True)
        upload = place / _file_name(request)
        await _store(request, upload, largest_upload)
        unless_whole.pop_all()
    call = Call(workspace, request.path_params, request.query_params, upload=upload)
    return await _answered(endpoint, call, request)


async def _answered(endpoint: Endpoint, call: Call, request: Request) -> Response:
    def answer() -> Answer:
        with call.workspace.lock if endpoint.locked else contextlib.nullcontext():
            return endpoint.answer(call)

    try:
        found = await anyio.to_thread.run_sync(answer)
    except AuricleError as fault:
        return JSONResponse({"error": str(fault)}, 422)
    if isinstance(found, bytes):
        return Response(found, media_type="application/octet-stream")
    if not isinstance(found, Work):
        return Response(json.dumps(found, allow_nan=False), media_type="application/json")
    busy = call.workspace.busy
    if not busy.acquire(blocking=False):
        return JSONResponse({"error": "something else is being worked on: wait or cancel it"}, 409)
    stream = lines(found, is_gone=request.is_disconnected, finished=busy.release)
    return StreamingResponse(stream, media_type="application/x-ndjson")


def _require_kind(request: Request, endpoint: Endpoint) -> None:
    """Refuse what a foreign page's form could send."""
    wanted = "application/octet-stream" if endpoint.takes_file else "application/json"
    given = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if request.method == "POST" and given != wanted:
        raise HTTPException(415, f"send {wanted}")


async def _body(request: Request, largest: int) -> bytes:
    parts: list[bytes] = []
    await _receive(request, largest, parts.append)
    return b"".join(parts)


async def _store(request: Request, place: Path, largest: int) -> None:
    with place.open("wb") as file:
        await _receive(request, largest, file.write)


async def _receive(request: Request, largest: int, take: Callable[[bytes], object]) -> None:
    """Hand over the request's body part by part; refuse it as soon as it is too large."""
    announced = request.headers.get("content-length", "0")
    stream = request.stream()
    if not announced.isdigit() or int(announced) > largest:
        await _drain(stream)
        raise _too_large(largest)
    received = 0
    while True:
        try:
            part = await asyncio.wait_for(anext(stream, None), SECONDS_FOR_A_PART)
        except TimeoutError as fault:
            raise HTTPException(408, "the request stopped half way: send it again") from fault
        except ClientDisconnect as fault:
            raise HTTPException(400, "the request ended half way") from fault
        if part is None:
            return
        received += len(part)
        if received > largest:
            await _drain(stream)
            raise _too_large(largest)
        take(part)


async def _drain(stream: AsyncIterator[bytes]) -> None:
    """Let a little of what is refused pass unread: whoever still sends could not hear why."""
    left = _DRAINED
    with contextlib.suppress(TimeoutError, ClientDisconnect):
        async with asyncio.timeout(_SECONDS_TO_DRAIN):
            async for part in stream:
                left -= len(part)
                if left <= 0:
                    return


def _too_large(largest: int) -> HTTPException:
    return HTTPException(
        413, f"more than {largest / 1024**2:,.0f} MB: open it from the command line"
    )


def _token_in(body: bytes) -> str:
    try:
        found = json.loads(body)["token"]
    except (ValueError, TypeError, KeyError):
        return ""
    return found if isinstance(found, str) else ""


def _file_name(request: Request) -> str:
    """The name the uploaded file had, fit for this machine."""
    return plain_name(urllib.parse.unquote(request.headers.get("x-file-name", "")))


async def _refused(_request: Request, fault: Exception) -> Response:
    code, cause = (
        (fault.status_code, fault.detail) if isinstance(fault, HTTPException) else (500, str(fault))
    )
    return JSONResponse({"error": cause}, code, headers={"connection": "close"})


async def _broken(_request: Request, fault: Exception) -> Response:
    cause = f"internal fault ({type(fault).__name__}: {fault}): please report it"
    return JSONResponse({"error": cause}, 500)
