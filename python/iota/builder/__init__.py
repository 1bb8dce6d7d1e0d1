# SPDX-License-Identifier: Apache-2.0
"""Builders: whole structures in one call."""

from iota.builder.chain import chain

__all__ = ["chain"]
