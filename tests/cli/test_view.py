"""`auricle view`: a page that can be sent, and a server that prints where it is."""

import http.client
import os
import re
import signal
import subprocess
import sys

import pytest

from auricle.surface.shapes import icosphere
from auricle.surface.writing import write_surface


@pytest.fixture
def ball(tmp_path):
    write_surface(tmp_path / "ball.vtp", icosphere(radius=20.0, subdivisions=2))
    return tmp_path / "ball.vtp"


def test_the_exported_page_is_whole_and_asks_nobody(auricle, ball, tmp_path) -> None:
    page = tmp_path / "page.html"
    done = auricle("view", ball, "--export", page, "-k", 20)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == str(page)
    text = page.read_text(encoding="utf-8")
    assert "connect-src 'none'" in text
    assert not re.search(r"""(?:src|href)=["']?https?:""", text)


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["absent.vtp", "--no-browser"], 3, "is not there"),
        (["ball.vtp", "--export", "page.pdf", "-k", "20"], 2, ".html"),
        (["ball.vtp", "--no-browser", "--port", "70000"], 2, "--port"),
    ],
)
def test_what_cannot_be_shown_is_said_in_words(auricle, ball, arguments, code, said) -> None:
    done = auricle("view", ball.with_name(arguments[0]), *arguments[1:])
    assert done.returncode == code
    assert said in " ".join(done.stderr.split())
    assert not ball.with_name("page.pdf").exists()


def test_the_server_answers_on_this_machine_until_it_is_interrupted(ball) -> None:
    command = [sys.executable, "-m", "auricle", "view", str(ball), "--no-browser", "-k", "20"]
    server = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ}
    )
    assert server.stdout is not None
    try:
        address = server.stdout.readline()
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/#token=[\w-]{43}\n", address)
        assert found is not None
        connection = http.client.HTTPConnection("127.0.0.1", int(found[1]), timeout=20)
        connection.request("GET", "/")
        assert connection.getresponse().status == 200
        connection.close()
        server.send_signal(signal.SIGINT)
        _, said = server.communicate(timeout=20)
        assert server.returncode in (0, 130)
        assert "Traceback" not in said
    finally:
        server.kill()
        server.wait()
