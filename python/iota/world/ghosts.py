# SPDX-License-Identifier: Apache-2.0
"""The shape of a body at a place where it is not: what a socket will hold."""

from __future__ import annotations

from collections.abc import Sequence

from iota._core import Body, Vec3
from iota.frames import into_frame, relative_turn
from iota.looks import Look, capsule
from iota.world.drawings import Drawings
from iota.world.scene import Scene
from iota.world.shown import Marker
from iota.world.visuals import listed

SEEN_THROUGH = "a0"  # of a color #rrggbbaa
FREE, READY = "#2f9d92", "#f2a324"  # far from its place, and so near that a release joins it

Pose = tuple[Vec3, Sequence[float]]


class Ghost:
    """A body's shape, seen through, on a frame of its own."""

    def __init__(self, drawings: Drawings, scene: Scene, body: Body, color: str) -> None:
        self.body = body
        self.frame = drawings.frame()
        self._color = ""
        self._markers: list[Marker] = [
            drawings.shape(look, position=tuple(position), rotation=rotation, on=self.frame)
            for look, (position, rotation) in _shapes_of(scene, body)
        ]
        self.paint(color)

    def paint(self, color: str) -> None:
        """Color: "#rrggbb"."""
        if color != self._color:
            self._color = color
            for marker in self._markers:
                marker.color = color + SEEN_THROUGH

    def follow(self, shift: Vec3) -> None:
        """Moves it to the place of its body, moved by `shift`, m."""
        self.put(self.body.center_of_mass + shift, self.body.orientation)

    def put(self, center: Vec3, rotation: Sequence[float]) -> None:
        """Moves its center to a place, m, with a rotation, quaternion x y z w."""
        self.frame.at, self.frame.rotation = center, rotation

    def destroy(self) -> None:
        for marker in self._markers:
            marker.destroy()
        self.frame.destroy()


def _shapes_of(scene: Scene, body: Body) -> list[tuple[Look, Pose]]:
    """Its shapes as they are drawn, and their poses in its frame."""
    middle, turn = body.center_of_mass, body.orientation
    if body.solids:
        return [
            (
                Look(solid.shape),
                (into_frame(solid.position, middle, list(turn)), relative_turn(turn, solid.orientation)),
            )
            for solid in body.solids
        ]
    length = max((abs(p.position - body.particles[0].position) for p in body.particles), default=0.0)
    styles = scene.look_of(body) or {}
    drawn = styles.get(scene.style or "", styles.get("*", next(iter(styles.values()), [])))
    looks = [look for look in listed(drawn) if look.shape is not None]
    if not looks:
        looks = [capsule(body.radius, length=max(length, 1e-6 * body.radius))]
    return [(look.of_length(length or look.length), (Vec3(*look.offset), tuple(look.rotation))) for look in looks]
