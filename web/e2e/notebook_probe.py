# SPDX-License-Identifier: Apache-2.0
"""A page of another port that shows a world in a frame, as a notebook shows the last value of a cell."""

from __future__ import annotations

import http.server

import iota

system = iota.System(damping=0.3)
iota.builder.chain(links=8, length=1.2, top=(0, 1.6, 0)).realize(system)
world = iota.World(system, title="in a cell")
world.start()
cell = f"<!doctype html><title>notebook</title><body>{world._repr_html_()}</body>".encode()
stranger = cell.replace(b"token=", b"other=")


class Notebook(http.server.BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(stranger if self.path.startswith("/stranger") else cell)

    def log_message(self, format: str, *arguments: object) -> None:
        pass


server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Notebook)
print(f"http://127.0.0.1:{server.server_port}/?token=notebook", flush=True)
try:
    server.serve_forever()
except KeyboardInterrupt:
    world.stop()
