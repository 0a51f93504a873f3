"""Whoever is not the page that auricle opened gets nothing, from any address of the server."""

import asyncio
import http.client
import itertools
import json
import re
import socket
import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from auricle.progress import Progress
from auricle.viewer.endpoints import Call, Endpoint, Work
from auricle.viewer.guard import Guard, Keys, content_policy
from auricle.viewer.registry import ENDPOINTS
from auricle.viewer.server import PAGE

Serve = Callable[..., Any]
ADDRESSES = [
    ("GET", "/"),
    ("POST", "/api/session"),
    ("GET", "/api/nothing-here"),
    *((each.method, re.sub(r"\{[^}]*\}", "1", each.address)) for each in ENDPOINTS),
]
"""Every address of the server, and one that is none."""


def ask(
    server: Any,
    method: str,
    address: str,
    *,
    body: bytes | None = None,
    **headers: str,
) -> tuple[int, dict[str, str], bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    connection.request(method, address, body, named)
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, {name.lower(): value for name, value in answer.getheaders()}, content


def exchange(server: Any, token: object) -> tuple[int, dict[str, str], bytes]:
    body = json.dumps({"token": token}).encode()
    return ask(server, "POST", "/api/session", body=body, Content_Type="application/json")


def secret(server: Any) -> str:
    code, _, content = exchange(server, "once")
    assert code == 200
    return f"Bearer {json.loads(content)['secret']}"


@pytest.fixture
def server(serve: Serve) -> Any:
    return serve(page="<script>start()</script><style>p {}</style>")


def test_a_foreign_host_is_refused_everywhere(server: Any) -> None:
    key = secret(server)
    hosts = ("evil.example", f"evil.example:{server.port}", "127.0.0.1", "127.0.0.1:1", "")
    for (method, address), host in itertools.product(ADDRESSES, hosts):
        code, headers, content = ask(server, method, address, Host=host, Authorization=key)
        assert code == 400, (method, address, host)
        assert b"foreign host" in content
        assert "default-src 'none'" in headers["content-security-policy"]


def test_a_foreign_origin_is_refused_everywhere(server: Any) -> None:
    key = secret(server)
    foreign = [{"Origin": each} for each in ("http://evil.example", "null", "https://127.0.0.1")]
    foreign += [{"Sec-Fetch-Site": each} for each in ("cross-site", "same-site")]
    for (method, address), header in itertools.product(ADDRESSES, foreign):
        code, _, _ = ask(server, method, address, Authorization=key, **header)
        assert code == 403, (method, address, header)


def test_nothing_but_the_empty_page_comes_without_the_secret(server: Any) -> None:
    key = secret(server)
    bare = key.removeprefix("Bearer ")
    wrong = ("", "Bearer ", "Bearer once", "Bearer wrong", key[:-1], bare, f"Basic {bare}")
    for (method, address), given in itertools.product(ADDRESSES[1:], wrong):
        code, headers, _ = ask(server, method, address, Authorization=given)
        assert (code, headers["cache-control"]) == (401, "no-store"), (method, address, given)
    assert [ask(server, *each)[0] for each in ADDRESSES] == [200] + [401] * (len(ADDRESSES) - 1)


def test_every_answer_leaves_under_the_policy(server: Any) -> None:
    key = secret(server)
    for method, address in ADDRESSES:
        body = None if method == "GET" else b"{}"
        code, headers, _ = ask(
            server, method, address, body=body, Authorization=key, Content_Type="application/json"
        )
        assert code in (200, 401, 404, 409, 415, 422), (method, address)
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy
        assert "*" not in policy
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["referrer-policy"] == "no-referrer"
        assert "access-control-allow-origin" not in headers
        assert "set-cookie" not in headers


def test_no_address_becomes_a_web_socket(server: Any) -> None:
    key = secret(server)
    for _, address in ADDRESSES:
        code, _, _ = ask(
            server,
            "GET",
            address,
            Authorization=key,
            Connection="Upgrade",
            Upgrade="websocket",
            Sec_WebSocket_Version="13",
            Sec_WebSocket_Key="MDEyMzQ1Njc4OWFiY2RlZg==",
        )
        assert code != 101, address


def test_the_guard_itself_closes_web_sockets() -> None:
    said: list[Any] = []

    async def unreached(*_: Any) -> None:
        pytest.fail("the server was asked")

    async def receive() -> Any:
        return {"type": "websocket.connect"}

    async def send(message: Any) -> None:
        said.append(message)

    guard = Guard(unreached, keys=Keys("once"), port=1, policy="")
    scope = {"type": "websocket", "path": "/", "headers": []}
    # In a thread of its own: a browser of an earlier test keeps a loop running in this one.
    with ThreadPoolExecutor(1) as thread:
        thread.submit(lambda: asyncio.run(guard(scope, receive, send))).result()
    assert said == [{"type": "websocket.close", "code": 1008}]


def test_the_token_is_good_once_and_the_secret_for_long(server: Any) -> None:
    key = secret(server)
    assert exchange(server, "once")[0] == 401
    assert [ask(server, "GET", "/api/page", Authorization=key)[0] for _ in range(3)] == [200] * 3


def test_a_wrong_token_does_not_use_up_the_right_one(server: Any) -> None:
    for wrong in ("guess", "", None, 7, ["once"], {"once": 1}):
        assert exchange(server, wrong)[0] == 401
    assert secret(server)


def test_what_a_foreign_form_could_send_is_refused(server: Any) -> None:
    key = secret(server)
    kinds = ("text/plain", "multipart/form-data", "application/x-www-form-urlencoded", "")
    for each, kind in itertools.product(ENDPOINTS, kinds):
        if each.method == "POST":
            address = re.sub(r"\{[^}]*\}", "1", each.address)
            code, _, _ = ask(
                server, "POST", address, body=b"{}", Authorization=key, Content_Type=kind
            )
            assert code == 415, address


UPLOADS = [each.address for each in ENDPOINTS if each.takes_file]


@pytest.mark.parametrize("address", UPLOADS)
def test_a_file_announced_too_large_is_refused_before_it_comes(serve: Serve, address: str) -> None:
    server = serve(page="", largest_upload=1000)
    code, _, content = ask(
        server,
        "POST",
        address,
        body=bytes(1001),
        Authorization=secret(server),
        Content_Type="application/octet-stream",
    )
    assert code == 413
    assert b"command line" in content


@pytest.mark.parametrize("address", UPLOADS)
def test_a_file_that_grows_too_large_is_refused_while_it_comes(serve: Serve, address: str) -> None:
    server = serve(page="", largest_upload=100_000)
    key = secret(server)
    sent, answer = 0, b""
    with socket.create_connection(("127.0.0.1", server.port), timeout=20) as wire:
        head = (
            f"POST {address} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n"
            f"Authorization: {key}\r\nContent-Type: application/octet-stream\r\n"
            "Transfer-Encoding: chunked\r\n\r\n"
        )
        wire.sendall(head.encode())
        try:
            for _ in range(10_000):
                wire.sendall(b"2710\r\n" + bytes(10_000) + b"\r\n")
                sent += 10_000
                wire.settimeout(0.002)
                try:
                    answer += wire.recv(4096)
                except TimeoutError:
                    wire.settimeout(20)
                    continue
                break
        except OSError:
            pass
    assert b" 413 " in answer
    assert sent < 20_000_000
    assert list(server.workspace.folder.iterdir()) == []


def test_a_request_too_large_is_refused(server: Any) -> None:
    code, _, _ = ask(
        server,
        "POST",
        "/api/map",
        body=bytes(5 * 1024**2),
        Authorization=secret(server),
        Content_Type="application/json",
    )
    assert code == 413


def test_an_uploaded_name_cannot_lead_out_of_its_folder(serve: Serve) -> None:
    seen: list[Path] = []

    def keep(call: Call) -> Mapping[str, Any]:
        seen.append(call.uploaded())
        return {}

    server = serve(page="", endpoints=(Endpoint("POST", "/api/keep", keep, takes_file=True),))
    key = secret(server)
    for name in ("../../evil", "..%2F..%2Fevil", "/etc/evil", "C%3A%5Cevil", "%00evil", "..", ""):
        code, _, _ = ask(
            server,
            "POST",
            "/api/keep",
            body=b"x",
            Authorization=key,
            Content_Type="application/octet-stream",
            X_File_Name=name,
        )
        assert code == 200
    folder = server.workspace.folder
    assert {place.parent.parent for place in seen} == {folder}
    assert {place.name for place in seen} == {"evil", "upload"}


def test_closing_the_stream_cancels_the_work(serve: Serve) -> None:
    steps, ended = [], threading.Event()

    def run(progress: Progress) -> Mapping[str, Any]:
        try:
            for step in range(1000):
                steps.append(step)
                progress("count", step, 1000)
                time.sleep(0.02)
        finally:
            ended.set()
        return {}

    server = serve(page="", endpoints=(Endpoint("POST", "/api/work", lambda _: Work(run)),))
    key = secret(server)
    head = (
        f"POST /api/work HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nAuthorization: {key}\r\n"
        "Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{}"
    )
    with socket.create_connection(("127.0.0.1", server.port), timeout=20) as wire:
        wire.sendall(head.encode())
        seen = b""
        while b'"stage"' not in seen:
            seen += wire.recv(4096)
        busy = ask(
            server,
            "POST",
            "/api/work",
            body=b"{}",
            Authorization=key,
            Content_Type="application/json",
        )
        assert busy[0] == 409
    assert ended.wait(5)
    assert len(steps) < 500
    assert not server.workspace.busy.locked()


def test_a_stream_ends_with_the_result(serve: Serve) -> None:
    def run(progress: Progress) -> Mapping[str, Any]:
        progress("count", 1, 2)
        return {"n": 3}

    server = serve(page="", endpoints=(Endpoint("POST", "/api/work", lambda _: Work(run)),))
    code, headers, content = ask(
        server,
        "POST",
        "/api/work",
        body=b"{}",
        Authorization=secret(server),
        Content_Type="application/json",
    )
    assert code == 200
    assert headers["content-type"].startswith("application/x-ndjson")
    lines = [json.loads(line) for line in content.splitlines()]
    assert lines[0] == {"stage": "count", "done": 1.0, "total": 2.0}
    assert lines[-1] == {"result": {"n": 3}}


def test_the_built_page_runs_nothing_that_its_policy_does_not_name() -> None:
    text = PAGE.read_text(encoding="utf-8")
    policy = content_policy(text)
    assert policy.count("'sha256-") == 2
    assert not re.search(
        r"<[^>]*\s(?:style|on[a-z]+)=", re.sub(r"(?s)<script.*?</script>", "", text)
    )
    assert not re.search(r"""(?:src|href)=["']?https?:""", text)
