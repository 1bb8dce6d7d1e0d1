# SPDX-License-Identifier: Apache-2.0
"""Compares the engine with exact and independent results: `iota verify`.

Needs SciPy, and Matplotlib for the figures: the extra `iota-worlds[verify]`. Each case runs real simulations, compares them with
an independent solver or an exact answer, and fills a table; see docs/verification.md.
"""
