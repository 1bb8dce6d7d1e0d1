# SPDX-License-Identifier: Apache-2.0
"""The command line: `iota list`, `iota run`, `iota bench`, `iota verify`."""

from iota.cli.main import main

__all__ = ["main"]
