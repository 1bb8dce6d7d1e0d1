# SPDX-License-Identifier: Apache-2.0
"""The numbers by which levels are chosen, with a row for each thing."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from iota._core import BodyArray, ParticleArray, System
from iota.errors import StaleIdError
from iota.levels.level import last_that_moves
from iota.levels.managed import Managed

Floats = NDArray[np.float64]

SLICES = (8, 64)  # steps in which each thing is looked at once: with few and with many things
PER_SLICE = 200  # things: with more, each is looked at less often
NEAR = 1.25  # of the reach: a viewer may come nearer before a thing is looked at again
HOLD = 30  # steps between two changes of a thing
REFUSED = 240  # steps: after the engine has ended the strides of a thing, they save nothing for so long; after a hand it is full
WOKEN = 60  # steps in which a thing is not frozen again that something woke
IDLE = 0.02  # rad/s: so much the picture of a thing at rest may move soon
EARLY, LATE = 1.1, 0.9  # of the sight: nearer, it begins to be found; nearer, it is too late
SIGHT = 30.0  # m: from so far, nobody sees whether a frozen thing moves
UNSEEN = 1 / SIGHT  # rad, rad/s: what is smaller, slower and out of sight may stand still without anybody's noticing it


def lengths(vectors: Floats) -> Floats:
    result: Floats = np.sqrt(np.einsum("...i,...i", vectors, vectors))
    return result


class _Spots:
    """The middles of the articulates of things, which say where these are."""

    def __init__(self, system: System, things: list[Managed]) -> None:
        spots = [thing._spots for thing in things]
        counts = [len(each) for each in spots]
        self._starts = np.cumsum([0, *counts[:-1]])
        self._middles: ParticleArray = system.array([middle for each in spots for middle, _ in each])
        self._extents = np.array([extent for each in spots for _, extent in each])
        halves = np.repeat([0.5 * thing.size for thing in things], counts)
        self._halves = np.where(np.repeat(counts, counts) > 1, self._extents, halves)
        self._has_several = len(self._extents) > len(things)

    def speeds(self) -> Floats:
        """The speed of the fastest middle of each thing, m/s."""
        speeds = lengths(self._middles.velocities)
        return np.maximum.reduceat(speeds, self._starts) if self._has_several else speeds

    def distances(self, eyes: Floats) -> tuple[Floats, Floats]:
        """From the nearest viewer to the nearest point that each thing may have, and to about where its picture is, m."""
        distance = lengths(self._middles.positions[:, None, :] - eyes[None, :, :]).min(axis=1)
        gap, seen = distance - self._extents, np.maximum(distance - self._halves, 1e-3)
        if self._has_several:
            gap, seen = np.minimum.reduceat(gap, self._starts), np.minimum.reduceat(seen, self._starts)
        return gap, seen


class Arrays:
    """The numbers that decisions are made of, with a row for each thing."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._row: dict[Managed, int] = {}
        self.significance, self.load, self.full_load = np.zeros(0), np.zeros(0), np.zeros(0)
        self.changed = np.zeros(0, dtype=int)
        self._refused = np.zeros(0, dtype=int)  # strides, until this step
        self._awake = np.zeros(0, dtype=int)  # may not be frozen until this step
        self.now = 0  # steps in which there was a budget
        self.since = np.zeros(0)  # s: it has been frozen and out of sight; nan: it is not
        self.is_mild = False  # nothing in sight is stopped
        self.build([])

    def build(self, things: list[Managed]) -> None:
        before = [
            (key, row, self.significance, self.load, self.full_load, self.changed) for key, row in self._row.items()
        ]
        count, width = len(things), max((len(thing.levels) for thing in things), default=1)
        self.slices = min(max(SLICES[0], count // PER_SLICE), SLICES[1])
        self._row = {thing: row for row, thing in enumerate(things)}
        self.own = [(row, thing) for row, thing in enumerate(things) if thing.significance is not None]
        self._asked = np.array([thing.significance is not None for thing in things], dtype=bool)
        self.level = np.array([thing.index for thing in things], dtype=int)
        self._last = np.array([len(thing.levels) - 1 for thing in things], dtype=int)
        self._mildest = np.array([last_that_moves(thing.levels) for thing in things], dtype=int)
        self.lowest = (self._mildest if self.is_mild else self._last).copy()  # level that it may have now
        self.pinned = np.array([thing.is_pinned for thing in things], dtype=bool)
        self.size = np.array([thing.size for thing in things], dtype=float)
        self.qualities, self.shares = np.zeros((count, width)), np.zeros((count, width))
        self.strides = np.ones((count, width), dtype=int)
        for row, thing in enumerate(things):
            for i, level in enumerate(thing.levels):
                self.qualities[row, i], self.shares[row, i], self.strides[row, i] = (
                    level.quality,
                    level.share,
                    level.stride,
                )
        self.stride = np.array([thing.level.stride for thing in things], dtype=int)  # at its level
        self.near, self.is_far, self.is_near = (np.zeros(count, dtype=bool) for _ in range(3))
        self.significance, self.load, self.full_load = np.zeros(count), np.zeros(count), np.zeros(count)
        self.touches, self.runs = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        self.changed = np.full(count, -HOLD, dtype=int)
        since, self.since = self.since, np.full(count, np.nan)
        refused, self._refused = self._refused, np.zeros(count, dtype=int)
        awake, self._awake = self._awake, np.zeros(count, dtype=int)
        for key, former, significance, load, full_load, changed in before:
            row = self._row.get(key, -1)
            if row >= 0:
                self.significance[row], self.load[row] = significance[former], load[former]
                self.full_load[row], self.changed[row] = full_load[former], changed[former]
                self.since[row], self._refused[row] = since[former], refused[former]
                self._awake[row] = awake[former]
        self._way = np.zeros(self.slices)  # m: of the viewers, since its things were looked at
        self._roots: list[BodyArray | None] = [None] * self.slices
        self._starts = [np.zeros(0, dtype=int)] * self.slices
        self._spots: list[_Spots | None] = [None] * self.slices
        self._is_old = np.ones(self.slices, dtype=bool)
        self._things = things

    def _find_points(self, part: int) -> None:
        """The bodies and particles by which things of a slice are looked at."""
        things = self._things[part :: self.slices]
        roots = [thing._roots for thing in things]
        if not all(roots):
            raise StaleIdError("a thing was destroyed since the last step")
        self._roots[part] = self._system.array([root for each in roots for root in each]) if roots else None
        self._starts[part] = np.cumsum([0, *(len(each) for each in roots[:-1])])
        self._spots[part] = _Spots(self._system, things) if things else None
        self._is_old[part] = False

    def note(self, thing: Managed) -> None:
        """Its level has changed in this step."""
        row = self._row.get(thing)
        if row is not None:
            self.level[row], self.changed[row] = thing.index, self.now
            self.stride[row] = thing.level.stride
            if self.stride[row] != 0:  # what was frozen together may part
                self._refused[row] = min(self._refused[row], self.now + REFUSED)
            self.load[row] = self.full_load[row] * self.shares[row, thing.index]
            self.touches[row] = self.runs[row] = False

    def refuse_strides(self, thing: Managed, until: int) -> None:
        """Strides of a thing that something full touches, or that the script edits in each step, save nothing until this step."""
        if (row := self._row.get(thing)) is not None:
            self._refused[row] = until

    def keep_awake(self, thing: Managed) -> None:
        """It is not frozen for a while: something woke it, or what is solved with it may not be frozen. Each further try would cost as much as
        this one, in vain."""
        if (row := self._row.get(thing)) is not None:
            self._awake[row] = self.now + WOKEN

    def find_points_of(self, thing: Managed) -> None:
        """Its bodies have become one, or come apart: its middle may be another particle."""
        if (row := self._row.get(thing)) is not None:
            self._is_old[row % self.slices] = True

    def keep_full(self, thing: Managed) -> None:
        """In this step it may not be reduced."""
        if (row := self._row.get(thing)) is not None:
            self.near[row] = True

    def is_free(self, thing: Managed) -> bool:
        """Whether it may be reduced."""
        row = self._row.get(thing)
        return row is not None and not self.near[row] and not self.pinned[row]

    def may_have(self, thing: Managed, index: int) -> bool:
        """Whether it may be reduced to a level."""
        return self.is_free(thing) and index <= self.lowest[self._row[thing]]

    def saved_at(self, thing: Managed, index: int) -> float:
        """The work that another level of a thing is expected to save; negative: to cost."""
        row = self._row.get(thing)
        if row is None or index >= self.shares.shape[1]:
            return 0.0
        rows = np.array([row])
        return float(self.full_load[row] * (self.share_now(rows)[0] - self._shares_of(rows)[0, index]))

    def is_seen(self, thing: Managed) -> bool:
        """Whether it has been in sight for some time."""
        row = self._row.get(thing)
        return row is not None and bool(self.is_near[row])

    def come_into_sight(self, rows: slice, now: float) -> NDArray[np.intp]:
        """The frozen things that have. Notes those that are out of sight."""
        since = self.since[rows]  # a view
        is_frozen, is_missed, is_far = self.stride[rows] == 0, np.isfinite(since), self.is_far[rows]
        since[is_frozen & is_far & ~is_missed] = now
        come: NDArray[np.intp] = rows.start + rows.step * np.nonzero(is_frozen & ~is_far & is_missed)[0]
        return come

    def missed(self, row: int, now: float) -> float:
        """For how long it has been frozen out of sight, s."""
        seconds = now - float(self.since[row])
        return seconds if math.isfinite(seconds) else 0.0

    def has_missed(self, thing: Managed) -> bool:
        """Whether it has been frozen out of sight."""
        row = self._row.get(thing)
        return row is not None and bool(np.isfinite(self.since[row]))

    def take_missed(self, thing: Managed, now: float) -> float:
        """For how long that was, s; it begins anew."""
        row = self._row.get(thing)
        if row is None:
            return 0.0
        seconds = self.missed(row, now)
        self.since[row] = np.nan
        return seconds

    def due(self, moved: float, slack: float) -> list[int]:
        """The slices that are to be looked at: one in each step, and those since whose last look the viewers may have come nearer than
        the slack, m."""
        self.now += 1
        self._way += moved
        is_due = self._way > slack
        is_due[self.now % self.slices] = True
        self._way[is_due] = 0.0
        return [int(part) for part in np.nonzero(is_due)[0]]

    def look(self, rows: slice, part: int, eyes: Floats, reach: float, sight: float) -> None:
        """Reads some things, and what they mean to the viewers."""
        if self._is_old[part]:
            self._find_points(part)
        roots, spots = self._roots[part], self._spots[part]
        if roots is None or spots is None:
            return
        speeds = spots.speeds()
        work, steps = roots.work.T
        size = self.size[rows]
        load = np.where(steps > 0, work / np.maximum(steps, 1), 0.0)
        takes_each = steps == 1
        starts = self._starts[part]
        if len(load) > len(size):  # things of several articulates
            of_roots = lengths(roots.velocities)
            speeds = np.maximum(speeds, np.maximum.reduceat(of_roots, starts))
            load, takes_each = np.add.reduceat(load, starts), np.logical_or.reduceat(takes_each, starts)
        self.load[rows] = load
        at_full = (self.level[rows] == 0) & (load > 0)
        full = self.full_load[rows]
        self.full_load[rows] = np.where(at_full, np.where(full > 0, full + 0.3 * (load - full), load), full)
        stride = self.stride[rows]
        self.touches[rows] = (stride > 1) & takes_each
        self.runs[rows] = (stride != 1) & takes_each
        if len(eyes):
            gap, distance = spots.distances(eyes)
            self.near[rows] = gap <= NEAR * reach
            self.is_far[rows] = gap > EARLY * sight
            self.is_near[rows] = gap < LATE * sight
            seen = np.minimum(size / distance, math.pi) * (speeds / distance + IDLE)
            if self.is_mild:
                is_unseen = self.is_far[rows] & (np.maximum(size, speeds) < UNSEEN * distance)
                self.lowest[rows] = np.where(is_unseen, self._last[rows], self._mildest[rows])
        else:
            seen = speeds + IDLE
            self.near[rows], self.is_far[rows], self.is_near[rows] = False, True, False
        self.significance[rows] = np.where(self._asked[rows], self.significance[rows], seen) if self.own else seen

    def _shares_of(self, rows: NDArray[np.intp]) -> Floats:
        """Shares of the full cost, as far as they are known: strides save nothing for what touches something."""
        takes_each = self.touches[rows] | (self._refused[rows] > self.now)
        result: Floats = np.where(takes_each[:, None] & (self.strides[rows] > 1), 1.0, self.shares[rows])
        return result

    def share_now(self, rows: NDArray[np.intp]) -> Floats:
        """The share of the full cost at the present level."""
        result: Floats = self._shares_of(rows)[np.arange(len(rows)), self.level[rows]]
        return result

    def next_level(self, rows: NDArray[np.intp]) -> NDArray[np.intp]:
        """The next one that is expected to cost less; the present one if there is none."""
        index = np.arange(self.shares.shape[1])
        is_less = (index > self.level[rows, None]) & (index <= self.lowest[rows, None])
        is_less &= (self.strides[rows] != 0) | (self._awake[rows] <= self.now)[:, None]
        is_less &= self._shares_of(rows) < 0.9 * self.share_now(rows)[:, None]
        target: NDArray[np.intp] = np.where(is_less.any(axis=1), is_less.argmax(axis=1), self.level[rows])
        return target

    def steps_up(
        self, rows: NDArray[np.intp], unit: Floats
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], Floats, Floats]:
        """The ways up of things, in steps of which each gains the most significance for its cost; unit: ms that each costs at full. For each
        step the place of its thing in `rows`, the level it leads to, what it gains, and what it costs, ms."""
        places = np.arange(len(rows))
        level, share, shares = self.level[rows], self.share_now(rows), self._shares_of(rows)
        found = []
        while len(places):
            row = rows[places]
            gain = self.qualities[row] - self.qualities[row, level][:, None]
            cost = np.maximum(shares[places] - share[:, None], 0.0)
            worth = np.where(np.arange(gain.shape[1]) < level[:, None], gain / (cost + 1e-9), -np.inf)
            target = worth.argmax(axis=1)
            goes = np.isfinite(worth[np.arange(len(row)), target])
            places, row, level, target = places[goes], row[goes], level[goes], target[goes]
            here = np.arange(len(goes))[goes]
            found.append(
                (places, target, self.significance[row] * gain[here, target], unit[places] * cost[here, target])
            )
            level, share = target, shares[places, target]
        at, targets, gains, costs = (np.concatenate(each) for each in zip(*found, strict=True))
        return at, targets, gains, costs
