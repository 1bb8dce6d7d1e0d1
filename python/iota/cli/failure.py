# SPDX-License-Identifier: Apache-2.0


class Failure(Exception):
    """What the user is told in one line."""
