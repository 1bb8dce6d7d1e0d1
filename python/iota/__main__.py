# SPDX-License-Identifier: Apache-2.0
"""`python -m iota` is the command line."""

import sys

from iota.cli import main

sys.exit(main())
