# SPDX-License-Identifier: Apache-2.0
"""A custom simulator in place of iota's: a cloth of point masses and springs, symplectic Euler, NumPy.

    iota run examples/python/explicit_particles.py

The page, its hands, keys, pause and reset are those of every World; see docs/replaceable.md.
"""

import numpy as np

import iota


class Knot(iota.SimulatedBody):
    """One particle."""

    @property
    def center_of_mass(self):
        return iota.Vec3(*self.system.x[self.slot])

    @property
    def kind(self):
        return "static" if self.system.fixed[self.slot] else "dynamic"


class Hand(iota.SimulatedGrip):
    """A critically damped spring to a user's hand."""

    def __init__(self, slot, target, client, hold):
        self.slot, self.target, self.client, self.hold = slot, np.array(target), client, hold

    def move(self, target):
        self.target = np.array(target)

    def destroy(self):
        self.alive = False


class ParticleSimulator(iota.Simulator):
    """Point masses and damped springs. Explicit: a step is divided so that the stiffest spring is stable."""

    def __init__(self, positions, mass, pairs, stiffness, damping, fixed=(), gravity=(0, -9.81, 0), drag=0.1):
        self.x = np.array(positions, float)
        self.v = np.zeros_like(self.x)
        self.mass, self.stiffness, self.damping, self.drag = mass, stiffness, damping, drag
        self.gravity = np.array(gravity, float)
        self.pairs = np.array(pairs, int)
        self.length = np.linalg.norm(self.x[self.pairs[:, 1]] - self.x[self.pairs[:, 0]], axis=1)
        self.fixed = np.zeros(len(self.x), bool)
        self.fixed[list(fixed)] = True
        self.hands, self.flashes = [], []
        self._bodies = [Knot(self, i) for i in range(len(self.x))]

    # --- required by a World ------------------------------------------------------------------------------------

    @property
    def bodies(self):
        return self._bodies

    def poses(self):
        places = np.zeros((len(self.x), 7))
        places[:, :3], places[:, 6] = self.x, 1
        return np.arange(len(self.x)), places

    def snapshot(self):
        return self.time, self.x.copy(), self.v.copy(), self.pairs.copy(), self.length.copy()

    def restore(self, snapshot):
        self.time, self.x, self.v, self.pairs, self.length = snapshot[0], *(a.copy() for a in snapshot[1:])
        self.hands.clear()
        self.structure_version += 1

    def step(self, dt):
        # A knot of eight springs has a frequency of at most sqrt(16 k/m); Euler is stable up to 2 / frequency.
        parts = int(np.ceil(dt * np.sqrt(16 * self.stiffness / self.mass)))
        h = dt / parts
        for _ in range(parts):
            self.v += h / self.mass * self.forces()
            self.v *= np.exp(-self.drag * h)
            self.v[self.fixed] = 0
            self.x += h * self.v
        self.time += dt
        self.step_count += 1
        return iota.types.StepReport(step=self.step_count, time=self.time, dt=dt, energy=self.energy)

    # --- optional -----------------------------------------------------------------------------

    @property
    def energy(self):
        stretch = np.linalg.norm(self.x[self.pairs[:, 1]] - self.x[self.pairs[:, 0]], axis=1) - self.length
        potential = 0.5 * self.stiffness * np.sum(stretch**2) - self.mass * np.sum(self.x @ self.gravity)
        return iota.types.Energy(kinetic=0.5 * self.mass * np.sum(self.v**2), potential=potential)

    def grip(self, body, local_point, target, client, hold):
        hand = Hand(body.slot, target, client, hold)
        self.hands.append(hand)
        return hand

    def holds(self):
        for hand in self.hands:
            force = float(np.linalg.norm(self.hand_force(hand)))
            yield hand.client, hand.hold, hand.slot, self.x[hand.slot], hand.target, force

    def body_articulates(self):
        part = np.arange(len(self.x))
        while True:  # spread the lowest number along the springs
            lowest = part.copy()
            np.minimum.at(lowest, self.pairs[:, 0], part[self.pairs[:, 1]])
            np.minimum.at(lowest, self.pairs[:, 1], part[self.pairs[:, 0]])
            if (lowest == part).all():
                return [(slot, int(number)) for slot, number in enumerate(part)]
            part = lowest

    def take_edits(self):
        flashes, self.flashes = self.flashes, []
        return flashes

    # --- physics --------------------------------------------------------------------------------------------------

    def forces(self):
        i, j = self.pairs[:, 0], self.pairs[:, 1]
        line = self.x[j] - self.x[i]
        size = np.linalg.norm(line, axis=1)
        line /= np.maximum(size, 1e-12)[:, None]
        speed = np.einsum("ij,ij->i", self.v[j] - self.v[i], line)
        pull = (self.stiffness * (size - self.length) + self.damping * speed)[:, None] * line
        force = np.tile(self.mass * self.gravity, (len(self.x), 1))
        np.add.at(force, i, pull)
        np.add.at(force, j, -pull)
        self.hands = [hand for hand in self.hands if hand.alive]
        for hand in self.hands:
            force[hand.slot] += self.hand_force(hand)
        return force

    def hand_force(self, hand):
        stiffness = 0.2 * self.stiffness
        damping = 2 * np.sqrt(stiffness * self.mass)
        return stiffness * (hand.target - self.x[hand.slot]) - damping * self.v[hand.slot]

    def cut(self, slot):
        """Removes the springs of a particle."""
        keep = (self.pairs != slot).all(axis=1)
        self.pairs, self.length = self.pairs[keep], self.length[keep]
        self.flashes.append(("break", iota.Vec3(*self.x[slot])))
        self.structure_version += 1


def build(n=16):
    """A square cloth that hangs from two corners."""
    spacing = 1.2 / (n - 1)
    positions = [(spacing * (k % n) - 0.6, 1.8, spacing * (k // n)) for k in range(n * n)]
    near = [(1, 0), (0, 1), (1, 1), (1, -1)]
    pairs = [
        (r * n + c, (r + dr) * n + c + dc)
        for r in range(n)
        for c in range(n)
        for dr, dc in near
        if r + dr < n and 0 <= c + dc < n
    ]
    cloth = ParticleSimulator(positions, 0.01, pairs, stiffness=60, damping=0.02, fixed=(0, n - 1))
    world = iota.World(cloth, title="a simulator of one's own")
    world.draw(cloth.bodies, iota.looks.sphere(0.25 * spacing))

    @world.action("cut", key="b", help="cuts the held or selected knot loose")
    def cut(event):
        cloth.cut(event.body.slot)

    return world


if __name__ == "__main__":
    build().run()
