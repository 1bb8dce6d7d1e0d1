# SPDX-License-Identifier: Apache-2.0
"""The process of one study of the gallery: `python -m iota.gallery.study NAME`.

It prints one line of JSON: {"port": ..., "tokens": [...]}, or {"error": ...} in words. It ends when its stdin does, so it
does not outlive the gallery, however that ends. What the study prints goes to stderr.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from typing import Any

from iota import studies
from iota.world import Server
from iota.world.callbacks import one_line, print_error


def main(name: str) -> int:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C in the terminal is for the gallery, which ends this
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)

    def answer(**values: Any) -> None:
        answers.write(json.dumps(values) + "\n")
        answers.flush()

    try:
        world = studies.module(name).build()
        server = Server(port=0)
        world.start(server=server, id=name)
    except Exception as error:  # such as a missing package
        print_error(error)
        answer(error=one_line(error))
        return 1
    answer(port=server.port, tokens=server.tokens)
    sys.stdin.buffer.read()
    world.stop()
    server.close()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
