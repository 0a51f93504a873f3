"""A page served on this machine, and a browser to look at it."""

import os
import shutil
import socket
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import uvicorn

from auricle.study.preparation import prepare_soup
from auricle.study.result import Source
from auricle.surface.shapes import icosphere
from auricle.surface.soup import TriangleSoup
from auricle.viewer.open_case import OpenCase
from auricle.viewer.server import application
from auricle.viewer.workspace import Workspace

FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
"""Software drawing, and a browser that calls nobody."""
SECONDS_TO_WAIT = 120
"""For anything in the browser: patience for busy machines."""


@dataclass(frozen=True)
class Server:
    """A page being served."""

    workspace: Workspace
    port: int
    token: str

    @property
    def origin(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def address(self) -> str:
        return f"{self.origin}/#token={self.token}"


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Callable[..., Server]]:
    """Serves a workspace in a thread: `serve(part, …, name="ball", **options of application)`."""
    running: list[tuple[uvicorn.Server, threading.Thread, socket.socket]] = []

    def start(*parts: object, name: str = "ball.vtp", **options: Any) -> Server:
        folder = tmp_path / f"uploads_{len(running)}"
        folder.mkdir()
        workspace = Workspace(folder)
        workspace.open(name, parts)
        listener = socket.create_server(("127.0.0.1", 0))
        port = int(listener.getsockname()[1])
        app = application(workspace, token="once", port=port, **options)
        settings = uvicorn.Config(
            app, log_level="error", ws="none", lifespan="off", timeout_graceful_shutdown=1
        )
        server = uvicorn.Server(settings)
        thread = threading.Thread(target=server.run, args=([listener],), daemon=True)
        thread.start()
        while not server.started:
            time.sleep(0.01)
        running.append((server, thread, listener))
        return Server(workspace, port, "once")

    yield start
    for server, thread, listener in running:
        server.should_exit = True
        thread.join(5)
        listener.close()


@pytest.fixture(scope="session")
def ball() -> OpenCase:
    """A sphere of radius 20 mm with a smooth map on it."""
    mesh = icosphere(radius=20.0, subdivisions=3)
    x, y, z = (mesh.vertices / 20.0).T
    soup = TriangleSoup(
        vertices=mesh.vertices,
        faces=mesh.faces,
        point_fields={"local_activation_time": 40.0 + 20.0 * x + 10.0 * y * z},
        units={"local_activation_time": "ms"},
        space="LPS",
    )
    prepared = prepare_soup(soup, Source("ball.vtp", 1, "0" * 64), n_modes=120)
    return OpenCase("ball.vtp", prepared, remarks=prepared.remarks)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """Debian's Chromium; skipped only where there is none."""
    place = os.environ.get("AURICLE_CHROMIUM") or next(
        filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
    )
    if place is None:
        pytest.skip("no Chromium on this machine: install Debian's package chromium")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=place, args=FLAGS)
        yield browser
        browser.close()


@dataclass
class Browsing:
    """A tab, and what its console complained of."""

    page: Any
    complaints: list[str]

    def open(self, address: str) -> Any:
        self.page.goto(address)
        self.page.wait_for_selector("html[data-ready=true]", timeout=1000 * SECONDS_TO_WAIT)
        return self.page

    def until(self, expression: str) -> None:
        """Waits until a JavaScript expression is true (the page's policy bars doing it there)."""
        end = time.monotonic() + SECONDS_TO_WAIT
        while not self.page.evaluate(expression):
            assert time.monotonic() < end, f"never true: {expression}"
            self.page.wait_for_timeout(30)

    def violations(self) -> list[str]:
        """What axe finds wrong for people who cannot see the page or use a mouse."""
        from axe_playwright_python.sync_playwright import Axe

        found = Axe().run(self.page).response["violations"]
        return [
            f"{each['id']}: {node['target']} {node['failureSummary']}"
            for each in found
            for node in each["nodes"]
        ]


@pytest.fixture
def browsing(chromium: Any) -> Iterator[Browsing]:
    """A new tab of 1280×760; the test fails if its console shows an error."""
    context = chromium.new_context(viewport={"width": 1280, "height": 760})
    page = context.new_page()
    page.set_default_timeout(1000 * SECONDS_TO_WAIT)
    complaints: list[str] = []
    page.on("console", lambda said: complaints.append(said.text) if said.type == "error" else None)
    page.on("pageerror", lambda fault: complaints.append(str(fault)))
    yield Browsing(page, complaints)
    context.close()
    assert complaints == []
