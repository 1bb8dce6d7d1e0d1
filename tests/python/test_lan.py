# SPDX-License-Identifier: Apache-2.0
"""Other machines come in by https on the same port; a real server and real TLS."""

from __future__ import annotations

import socket
import ssl
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest
from page_client import PageClient
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

import iota
from iota._core import fingerprint, kept_certificate
from iota.world.lan import Lan, address, announcement, qr_code


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    return tmp_path / "iota"


@pytest.fixture
def world(state: Path) -> Iterator[iota.World]:
    system = iota.System()
    iota.builder.chain(links=3, top=(0, 2, 0), direction=(1, 0, 0)).realize(system)
    world = iota.World(system)
    world.serve(port=0, lan=True)
    yield world
    world.close()


@pytest.fixture
def trust(world: iota.World, state: Path) -> ssl.SSLContext:
    """Of a client that trusts this server's certificate and nobody else's."""
    return ssl.create_default_context(cafile=str(state / "certificate.pem"))


@pytest.fixture
def socket_trust(trust: ssl.SSLContext) -> ssl.SSLContext:
    """For WebSockets, whose client reads and writes in two threads: with TLS 1.3, Python's ssl then loses one of 700
    requests, as tickets arrive while it writes (python/cpython#137583). A browser's client does not."""
    trust.maximum_version = ssl.TLSVersion.TLSv1_2
    return trust


def place(url: str | None) -> tuple[str, int]:
    assert url is not None
    host, port = url.split("/")[2].split(":")
    return host, int(port)


def test_a_client_that_checks_the_certificate_gets_the_page(world: iota.World, trust: ssl.SSLContext) -> None:
    assert world.pages.lan_url is not None and world.pages.lan_url.startswith(f"https://{address()}:")
    with urllib.request.urlopen(world.pages.lan_url, context=trust) as answer:
        assert answer.status == 200 and b"<!doctype html>" in answer.read().lower()
        assert "wss://" in answer.headers["Content-Security-Policy"]


def test_a_client_that_does_not_know_the_certificate_refuses_it(world: iota.World) -> None:
    assert world.pages.lan_url is not None
    with pytest.raises(OSError, match="certificate verify failed"):
        urllib.request.urlopen(world.pages.lan_url)


def test_the_printed_fingerprint_is_that_of_the_certificate(world: iota.World, state: Path) -> None:
    sent = ssl.get_server_certificate(place(world.pages.lan_url))
    assert fingerprint(sent) == fingerprint((state / "certificate.pem").read_text())


def test_poses_come_by_wss_too(world: iota.World, socket_trust: ssl.SSLContext) -> None:
    assert world.pages.lan_url is not None
    with PageClient(world.pages.lan_url, trust=socket_trust) as client:
        frames = client.pose_frames
        for _ in range(30):
            world.step()
        client.wait_for(lambda: client.pose_frames > frames + 3 and len(client.places) == 3 + 1)  # and the ground


def test_this_machine_needs_no_https(world: iota.World) -> None:
    assert world.pages.url is not None and world.pages.url.startswith("http://127.0.0.1:")
    with urllib.request.urlopen(world.pages.url) as answer:
        assert answer.status == 200


def test_a_page_of_http_may_not_open_the_socket_of_https(world: iota.World, socket_trust: ssl.SSLContext) -> None:
    assert world.pages.lan_url is not None
    socket_url = world.pages.lan_url.replace("https://", "wss://").replace("/?", "/ws?")
    origin = world.pages.lan_url.split("/?")[0]
    with connect(socket_url, ssl=socket_trust, origin=origin), pytest.raises(WebSocketException):  # type: ignore[arg-type]
        connect(socket_url, ssl=socket_trust, origin=origin.replace("https", "http"))  # type: ignore[arg-type]


@pytest.mark.parametrize("rubbish", [b"\x16", b"\x16\x03\x01\x02\x00" + bytes(600), b"\x16\x03\x01\xff\xff", bytes(64)])
def test_broken_handshakes_disturb_nobody(world: iota.World, trust: ssl.SSLContext, rubbish: bytes) -> None:
    for _ in range(50):
        with socket.create_connection(place(world.pages.lan_url)) as stranger:
            stranger.sendall(rubbish)
    test_a_client_that_checks_the_certificate_gets_the_page(world, trust)


def test_old_versions_of_tls_are_refused(world: iota.World) -> None:
    old = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    old.check_hostname, old.verify_mode = False, ssl.CERT_NONE
    old.set_ciphers("ALL:@SECLEVEL=0")
    with pytest.warns(DeprecationWarning):
        old.minimum_version = old.maximum_version = ssl.TLSVersion.TLSv1_1
    with socket.create_connection(place(world.pages.lan_url)) as plain, pytest.raises((ssl.SSLError, ConnectionError)):
        old.wrap_socket(plain)


def test_a_certificate_of_your_own_is_used(state: Path, tmp_path: Path) -> None:
    chain, key = kept_certificate(["localhost"])
    cert_file, key_file = tmp_path / "mine.pem", tmp_path / "mine.key"
    cert_file.write_text(chain)
    key_file.write_text(key)
    server = iota.Server(port=0, lan=Lan(cert_file, key_file))
    try:
        assert server.fingerprint == fingerprint(chain)
        assert fingerprint(ssl.get_server_certificate(("127.0.0.1", server.port))) == server.fingerprint
    finally:
        server.close()


def test_files_that_are_no_certificate_are_refused_with_a_reason(state: Path, tmp_path: Path) -> None:
    (tmp_path / "no.pem").write_text("rubbish")
    with pytest.raises(ValueError, match="certificate"):
        iota.Server(port=0, lan=Lan(tmp_path / "no.pem", tmp_path / "no.pem"))
    with pytest.raises(FileNotFoundError, match=r"missing\.pem"):
        iota.Server(port=0, lan=Lan(tmp_path / "missing.pem", tmp_path / "missing.pem"))
    with pytest.raises(ValueError, match="give both cert and key"):
        Lan(cert=tmp_path / "no.pem")


def test_without_lan_only_this_machine_is_served() -> None:
    server = iota.Server(port=0)
    try:
        assert server.lan_url() is None and server.fingerprint is None
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection((address(), server.port))
    finally:
        server.close()


def test_the_terminal_shows_address_code_fingerprint_and_the_way_by_cable() -> None:
    lines = announcement("https://192.168.0.2:8080/?token=1", "AB:CD", 8080, shows_code=True)
    text = "\n".join(lines)
    assert "https://192.168.0.2:8080/?token=1" in text and "AB:CD" in text and "adb reverse tcp:8080 tcp:8080" in text
    assert any(qr_code("https://192.168.0.2:8080/?token=1").split("\n")[3] == line for line in lines)
