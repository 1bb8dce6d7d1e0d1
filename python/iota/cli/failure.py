# SPDX-License-Identifier: Apache-2.0


class Failure(Exception):
    """An error that the user is told in one line."""
