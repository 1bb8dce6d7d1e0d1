# SPDX-License-Identifier: Apache-2.0
"""Implicit surfaces around points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

REACH = 2.0  # of a particle's field, in radii
LEVEL = (1 - 1 / REACH**2) ** 3  # of the field at the radius of a single particle
MOST = 2_000_000  # points of the grid


def skin(positions: Any, radius: float, cell: float | None = None) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """An implicit surface (J. Blinn 1982): the level set of a sum of bumps, one per particle, with the value of a single
    bump at `radius`. A single particle is a ball of that radius; close ones merge. positions: (n, 3), m. cell: of the
    grid of samples, m; None: a third of the radius. Returns points (m, 3) and triangles (k, 3), closed
    and turned outwards. Raises ValueError where the grid would be too large.

    `Drawings.skin` draws it.

        points, triangles = effects.skin(system.positions, 0.1)
    """
    places = np.asarray(positions, float).reshape(-1, 3)
    cell = radius / 3 if cell is None else cell
    if not (np.isfinite(places).all() and 0 < radius < np.inf and 0 < cell <= radius):
        raise ValueError(
            f"skin: needs finite positions, a radius above 0 and a cell above 0 and up to it, not {radius}, {cell}"
        )
    if not len(places):
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    # The grid stands still in the world, so that the surface does not shimmer while its bounds change.
    low = np.floor((places.min(axis=0) - REACH * radius) / cell) - 1
    size = (np.ceil((places.max(axis=0) + REACH * radius) / cell) + 2 - low).astype(int)
    if float(np.prod(size, dtype=float)) > MOST:
        raise ValueError(
            f"skin: a grid of {' x '.join(map(str, size))} points is too large; make cell larger than {cell} m"
        )
    points, triangles = _surface_net(_field(places / cell - low, REACH * radius / cell, size) - LEVEL)
    return (points + low) * cell, triangles


def _field(places: NDArray[np.float64], reach: float, size: NDArray[Any]) -> NDArray[np.float64]:
    """The sum of all bumps, (1 - d^2 / reach^2)^3 within the reach, on the points of the grid. All in cells."""
    field = np.zeros(size)
    span = int(np.ceil(reach))
    around = np.stack(np.meshgrid(*[np.arange(-span, span + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    nearest = np.rint(places).astype(int)
    for place, middle in zip(places, nearest, strict=True):
        at = middle + around
        bump = np.maximum(1 - ((at - place) ** 2).sum(axis=1) / reach**2, 0) ** 3
        inside = bump > 0
        field[tuple(at[inside].T)] += bump[inside]
    return field


def _surface_net(field: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The surface on which a field on a grid is 0 (S. Gibson 1998): a point in each cell that the surface passes, in the middle of where it cuts
    the cell's edges, and a square across each such edge. The field is below 0 at the sides of the grid."""
    cells = tuple(n - 1 for n in field.shape)
    sums, counts = np.zeros((*cells, 3)), np.zeros(cells)
    cuts = []
    for axis in range(3):
        front = [slice(None)] * 3
        back = [slice(None)] * 3
        front[axis], back[axis] = slice(0, -1), slice(1, None)
        a, b = field[tuple(front)], field[tuple(back)]
        is_cut = (a > 0) != (b > 0)
        share = np.divide(a, a - b, out=np.zeros_like(a), where=is_cut)
        cuts.append((is_cut, a > 0))
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for du in (0, 1):
            for dv in (0, 1):
                edges = [slice(None)] * 3
                edges[u], edges[v] = slice(du, du + cells[u]), slice(dv, dv + cells[v])
                cut = is_cut[tuple(edges)]
                counts += cut
                sums[..., axis] += share[tuple(edges)]
                sums[..., u] += du * cut
                sums[..., v] += dv * cut
    used = counts > 0
    number = np.full(cells, -1)
    number[used] = np.arange(np.count_nonzero(used))
    points = np.argwhere(used) + sums[used] / counts[used][:, None]

    triangles = []
    for axis, (is_cut, leaves) in enumerate(cuts):
        u, v = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
        at = np.argwhere(is_cut)
        # Counter-clockwise, seen from the end of the axis.
        p, q, r, s = (number[tuple((at - step).T)] for step in (u + v, v, 0 * u, u))
        outwards = leaves[is_cut]
        q, s = np.where(outwards, q, s), np.where(outwards, s, q)
        triangles += [np.stack([p, q, r], axis=1), np.stack([p, r, s], axis=1)]
    return points, np.concatenate(triangles)
