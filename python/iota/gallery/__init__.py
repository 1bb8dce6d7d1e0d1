# SPDX-License-Identifier: Apache-2.0
"""All studies on one page: `iota gallery`."""

from iota.gallery.serving import Gallery

__all__ = ["Gallery"]
