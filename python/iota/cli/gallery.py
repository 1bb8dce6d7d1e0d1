# SPDX-License-Identifier: Apache-2.0
"""`iota gallery`: all studies on one page."""

from __future__ import annotations

import argparse
import math
import time
import webbrowser
from contextlib import suppress

from iota.cli.run import can_show_a_page, plain_failures
from iota.gallery.serving import Gallery, make_folder
from iota.world.callbacks import print_on_terminal


def run(arguments: argparse.Namespace) -> None:
    """Serves it until Ctrl-C, or for so many seconds."""
    end = time.monotonic() + (math.inf if arguments.seconds is None else arguments.seconds)
    with plain_failures(arguments.port), make_folder() as folder:
        gallery = Gallery(folder, 8080 if arguments.port is None else arguments.port)
        print_on_terminal(f"gallery: {gallery.url}\n", is_error=False)
        if not arguments.no_open and can_show_a_page():
            webbrowser.open(gallery.url)
        with suppress(KeyboardInterrupt):
            gallery.run(lambda: time.monotonic() < end)
