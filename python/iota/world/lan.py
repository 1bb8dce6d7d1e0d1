# SPDX-License-Identifier: Apache-2.0
"""Phones, headsets and other computers on the local network: addresses, certificate, and the text about them."""

from __future__ import annotations

import socket
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

from iota._core import kept_certificate


@dataclass(frozen=True)
class Lan:
    """Lets a server accept other machines, by https. cert, key: files in PEM; without them a self-signed certificate is
    made."""

    cert: Path | None = None
    key: Path | None = None

    def __post_init__(self) -> None:
        if (self.cert is None) != (self.key is None):
            raise ValueError("a certificate needs its key, and the key its certificate: give both cert and key")

    def certificate(self) -> tuple[str, str]:
        """Certificate and key in PEM. Raises OSError for files that cannot be read or written."""
        if self.cert is not None and self.key is not None:
            return self.cert.read_text(), self.key.read_text()
        return kept_certificate(["localhost", "127.0.0.1", address()])


def address() -> str:
    """This machine's address on its network. Raises OSError if there is none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # an address for documentation; connecting a datagram socket sends nothing
        except OSError:
            raise OSError("this machine is on no network, so lan cannot serve other machines") from None
        return str(probe.getsockname()[0])


def qr_code(text: str) -> str:
    """A QR code for a terminal with light text on dark or dark text on light."""
    import segno  # 30 ms, needed only here

    out = StringIO()
    segno.make(text, error="l").terminal(out, compact=True)
    return out.getvalue().rstrip("\n")


def announcement(url: str, fingerprint: str, port: int, shows_code: bool) -> list[str]:
    """Lines with the addresses."""
    lines = [f"  phones, headsets, other computers: {url}"]
    if shows_code:
        lines += qr_code(url).split("\n")
    lines.append("  their browser warns once, as the certificate is self-signed; SHA-256 fingerprint:")
    lines.append(f"    {fingerprint}")
    lines.append(
        f"  a headset on a cable needs no certificate: adb reverse tcp:{port} tcp:{port}, then the first address there"
    )
    return lines
