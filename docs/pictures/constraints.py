# SPDX-License-Identifier: Apache-2.0
"""Draws docs/pictures/constraints/*.svg: each kind of constraint in a real simulation, as a strobe picture.

    python docs/pictures/constraints.py [NAME ...]

Bodies are drawn at equal times, the older the paler, with the traces of some points; what the world holds is orange.
"""

import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import iota

FOLDER = Path(__file__).parent / "constraints"
WIDTH, HEIGHT, MARGIN = 320, 220, 22
INK, TRACE, WORLD, SECOND = "#26323e", "#2f7fc1", "#e07b24", "#5a9a4a"

Point = Sequence[float]
SCENES: dict[str, Callable[["Picture"], None]] = {}


def scene(function: Callable[["Picture"], None]) -> Callable[["Picture"], None]:
    SCENES[function.__name__] = function
    return function


def flat(p: Point) -> tuple[float, float]:
    """Seen along -z."""
    return p[0], p[1]


def tilted(p: Point) -> tuple[float, float]:
    """Seen from the right and above, without perspective."""
    x, y, z = p[0], p[1], (p[2] if len(p) > 2 else 0)
    a, b = math.radians(35), math.radians(20)
    return x * math.cos(a) - z * math.sin(a), y * math.cos(b) - (x * math.sin(a) + z * math.cos(a)) * math.sin(b)


class Picture:
    """Lines and outlines in meters; fitted into the frame when written."""

    def __init__(self, view: Callable[[Point], tuple[float, float]] = flat) -> None:
        self.view = view
        self.items: list[tuple[str, list[tuple[float, float]], str]] = []
        self.words: list[tuple[tuple[float, float], str]] = []

    def line(
        self, points: Sequence[Point], color: str = INK, width: float = 1.5, opacity: float = 1, extra: str = ""
    ) -> None:
        style = f'fill="none" stroke="{color}" stroke-width="{width}" stroke-opacity="{opacity:.2f}" {extra}'
        self.items.append(("polyline", [self.view(p) for p in points], style))

    def trace(self, points: Sequence[Point], color: str = TRACE) -> None:
        self.line(points, color, 1.1, 0.9)

    def dot(self, p: Point, size: float = 3.2, color: str = INK, opacity: float = 1) -> None:
        self.items.append(("circle", [self.view(p)], f'r="{size}" fill="{color}" fill-opacity="{opacity:.2f}"'))

    def ring(self, center: Point, radius: float, color: str = INK, opacity: float = 1, width: float = 1.5) -> None:
        """A circle facing the viewer."""
        steps = [(math.cos(math.tau * i / 48), math.sin(math.tau * i / 48)) for i in range(49)]
        x, y = self.view(center)
        style = f'fill="none" stroke="{color}" stroke-width="{width}" stroke-opacity="{opacity:.2f}"'
        self.items.append(("polyline", [(x + radius * c, y + radius * s) for c, s in steps], style))

    def box(self, corners: Sequence[Point], opacity: float, color: str = INK) -> None:
        """Eight corners in binary order of their signs."""
        edges = [(a, a | bit) for bit in (1, 2, 4) for a in range(8) if not a & bit]
        if self.view is flat:
            edges = [(0, 1), (1, 3), (3, 2), (2, 0)]
        for a, b in edges:
            self.line([corners[a], corners[b]], color, 1.6 if opacity > 0.9 else 1.2, opacity)

    def text(self, p: Point, words: str) -> None:
        self.words.append((self.view(p), words))

    def write(self, path: Path) -> None:
        points = [p for _, shape, _ in self.items for p in shape] + [p for p, _ in self.words]
        low = [min(p[i] for p in points) for i in (0, 1)]
        high = [max(p[i] for p in points) for i in (0, 1)]
        scale = min(
            (WIDTH - 2 * MARGIN) / max(high[0] - low[0], 1e-9), (HEIGHT - 2 * MARGIN) / max(high[1] - low[1], 1e-9)
        )
        middle = [(low[i] + high[i]) / 2 for i in (0, 1)]

        def place(p: tuple[float, float]) -> tuple[str, str]:
            return (
                f"{WIDTH / 2 + scale * (p[0] - middle[0]):.1f}",
                f"{HEIGHT / 2 - scale * (p[1] - middle[1]):.1f}",
            )

        out = [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}">',
            f'<rect width="{WIDTH}" height="{HEIGHT}" rx="8" fill="#fbfaf7"/>',
            '<g stroke-linecap="round" stroke-linejoin="round">',
        ]
        for tag, shape, style in self.items:
            if tag == "circle":
                x, y = place(shape[0])
                out.append(f'<circle cx="{x}" cy="{y}" {style}/>')
            else:
                out.append(f'<polyline points="{" ".join(",".join(place(p)) for p in shape)}" {style}/>')
        out.append("</g>")
        for p, words in self.words:
            x, y = place(p)
            out.append(f'<text x="{x}" y="{y}" font-family="sans-serif" font-size="11" fill="{INK}">{words}</text>')
        path.write_text("\n".join([*out, "</svg>", ""]), encoding="utf-8")


# --- simulating -------------------------------------------------------------------------------------------------------


def box(system: iota.System, center: Point, size: Point, mass: float = 1) -> tuple[iota.Body, list[iota.Particle]]:
    """A solid box and its corners as markers, to draw it by."""
    body = system.body(shape=iota.Box(size), mass=mass, position=center)
    signs = [((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2) - 0.5) for i in range(8)]
    return body, [
        body.particle(tuple(c + s * e for c, s, e in zip(center, sign, size, strict=True)), mass=0) for sign in signs
    ]


def strobe(
    system: iota.System,
    seconds: float,
    flashes: int,
    draw: Callable[[float], None],
    watch: Sequence[iota.Particle] = (),
    picture: Picture | None = None,
    each: Callable[[float], None] | None = None,
) -> None:
    """Runs, calls draw(opacity) at equal times, and traces what is watched."""
    dt = 1 / 240
    steps = round(seconds / dt)
    traces: list[list[Point]] = [[tuple(p.position)] for p in watch]
    due = [round(i * steps / (flashes - 1)) for i in range(flashes)]
    shown = 0
    for step in range(steps + 1):
        if shown < flashes and step >= due[shown]:
            draw(0.22 + 0.78 * shown / (flashes - 1))
            shown += 1
        if step == steps:
            break
        if each:
            each(system.time)
        system.step(dt)
        for trace, p in zip(traces, watch, strict=True):
            trace.append(tuple(p.position))
    if picture:
        for trace in traces:
            picture.trace(trace)


def hatch(picture: Picture, a: Point, b: Point) -> None:
    """A wall or floor: a line."""
    picture.line([a, b], WORLD, 3)


# --- the scenes -------------------------------------------------------------------------------------------------------


@scene
def nail(picture: Picture) -> None:
    system = iota.System()
    rod = system.body()
    top, end = rod.particle((0, 0, 0)), rod.particle((0.8, 0.6, 0))
    top.nail()
    strobe(
        system,
        0.75,
        9,
        lambda o: (picture.line([top.position, end.position], INK, 3, o), picture.dot(end.position, 4, INK, o)),
        [end],
        picture,
    )
    picture.dot((0, 0, 0), 5, WORLD)


@scene
def hinge(picture: Picture) -> None:
    system = iota.System()
    bodies = [system.body() for _ in range(2)]
    a, b = bodies[0].particle((0, 0, 0)), bodies[0].particle((1, 0.1, 0))
    c, d = bodies[1].particle((1, 0.1, 0)), bodies[1].particle((1.9, 0.5, 0))
    a.nail()
    b.combine(c)

    def draw(o: float) -> None:
        picture.line([a.position, b.position, d.position], INK, 2.6, o)
        picture.dot(b.position, 3.4, SECOND, o)

    strobe(system, 1.1, 9, draw, [b, d], picture)
    picture.dot((0, 0, 0), 5, WORLD)


@scene
def ball(picture: Picture) -> None:
    picture.view = tilted
    system = iota.System()
    body, corners = box(system, (0.55, -0.2, 0), (0.5, 0.2, 0.3))
    system.ball(body, at=(0, 0, 0))
    body.angular_velocity = (3, 3, -2)
    arm = body.particle((0, 0, 0), mass=0)

    def draw(o: float) -> None:
        picture.box([p.position for p in corners], o)
        picture.line([arm.position, body.center_of_mass], INK, 1, o, 'stroke-dasharray="3 3"')

    strobe(system, 2.2, 4, draw, [corners[7]], picture)
    picture.dot((0, 0, 0), 5, WORLD)


@scene
def universal(picture: Picture) -> None:
    picture.view = tilted
    system = iota.System(gravity=(0, 0, 0))
    bend = 0.6
    out = (math.cos(bend), -math.sin(bend), 0)
    shafts = [
        system.body(shape=iota.Cylinder(0.06, 0.9), mass=1, position=(-0.5, 0, 0)),
        system.body(
            shape=iota.Cylinder(0.06, 0.9),
            mass=1,
            position=tuple(0.5 * v for v in out),
            orientation=(0, 0, -math.sin(bend / 2), math.cos(bend / 2)),
        ),
    ]
    driven = system.revolute(shafts[0], at=(-0.5, 0, 0), axis=(1, 0, 0), motor=(4, 100))
    follower = system.revolute(shafts[1], at=tuple(0.5 * v for v in out), axis=out)
    system.universal(
        shafts[0], shafts[1], at=(0, 0, 0), axis=(0, 0, 1), second_axis=(math.sin(bend), math.cos(bend), 0)
    )
    arms = [
        [shafts[0].particle((0, 0, z), mass=0) for z in (-0.2, 0.2)],
        [shafts[1].particle((s * math.sin(bend), s * math.cos(bend), 0), mass=0) for s in (-0.2, 0.2)],
    ]
    handles = [
        shafts[0].particle((-0.95, 0.22, 0), mass=0),
        shafts[1].particle(
            tuple(0.95 * v + 0.22 * w for v, w in zip(out, (math.sin(bend), math.cos(bend), 0), strict=True)),
            mass=0,
        ),
    ]
    ends = [(-0.95, 0, 0), (0, 0, 0), tuple(0.95 * v for v in out)]

    def draw(o: float) -> None:
        for pair, color in zip(arms, (TRACE, SECOND), strict=True):
            picture.line([p.position for p in pair], color, 3, o)
        for p, end in zip(handles, (ends[0], ends[2]), strict=True):
            picture.line([end, p.position], INK, 1.6, o)

    strobe(system, 1.2, 5, draw, handles, picture)
    picture.line([ends[0], ends[1]], INK, 4)
    picture.line([ends[1], ends[2]], INK, 4)
    # The cross starts at right angles to the plane of the bend: tan(out) = tan(in) cos(bend).
    turned, expected = follower.angle.value, math.atan(math.tan(driven.angle.value) * math.cos(bend))
    assert abs(math.sin(turned - expected)) < 1e-3


@scene
def revolute(picture: Picture) -> None:
    picture.view = tilted
    system = iota.System()
    door, corners = box(system, (0.5, 0, 0), (0.9, 1, 0.06), 8)
    joint = system.revolute(door, at=(0, 0, 0), axis=(0, 1, 0), limits=(-0.2, 2.2), friction=0.4)
    door.velocity, door.angular_velocity = (0, 0, -1.1), (0, 2.2, 0)
    strobe(system, 1.6, 6, lambda o: picture.box([p.position for p in corners], o), [corners[1]], picture)
    picture.line([(0, -0.6, 0), (0, 0.6, 0)], WORLD, 3)
    assert 1.5 < joint.angle.value < 2.2001


@scene
def cylindrical(picture: Picture) -> None:
    picture.view = tilted
    system = iota.System(damping=0.1)
    nut, corners = box(system, (0.12, 1, 0), (0.5, 0.14, 0.3))
    system.cylindrical(nut, at=(0, 1, 0), axis=(0, 1, 0), angle={"motor": (14, 50)}, slide={"friction": 7.5})
    strobe(system, 1.1, 5, lambda o: picture.box([p.position for p in corners], o), [corners[5]], picture)
    picture.line([(0, -0.5, 0), (0, 1.25, 0)], WORLD, 3)


@scene
def prismatic(picture: Picture) -> None:
    system = iota.System()
    slope = math.radians(30)
    along, up = (math.cos(slope), -math.sin(slope), 0), (math.sin(slope), math.cos(slope), 0)
    block = system.body(
        shape=iota.Box((0.36, 0.2, 0.2)),
        mass=1,
        position=tuple(0.1 * u for u in up),
        orientation=(0, 0, -math.sin(slope / 2), math.cos(slope / 2)),
    )
    corners = [
        block.particle(tuple(0.18 * sx * a + (0.1 + 0.1 * sy) * u for a, u in zip(along, up, strict=True)), mass=0)
        for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    joint = system.prismatic(block, at=(0, 0, 0), axis=along, friction=1, limits=(-1, 2))

    def draw(o: float) -> None:
        places = [p.position for p in corners]
        picture.line([*places, places[0]], INK, 1.6, o)

    strobe(system, 1.0, 5, draw, [corners[2]], picture)
    hatch(picture, tuple(-0.4 * a for a in along), tuple(2.3 * a for a in along))
    assert abs(joint.slide.speed - (9.81 * 0.5 - 1)) < 1e-3


@scene
def orientation(picture: Picture) -> None:
    system = iota.System()
    kept, corners = box(system, (0, 0, 0), (0.4, 0.2, 0.2))
    free, others = box(system, (0, -0.9, 0), (0.4, 0.2, 0.2))
    system.orientation(kept)
    for particles in (corners, others):
        particles[0].body.velocity = (2.2, 3, 0)
    free.angular_velocity = (0, 0, -5)
    kept.angular_velocity = (0, 0, -5)

    def draw(o: float) -> None:
        picture.box([p.position for p in corners], o)
        picture.box([p.position for p in others], o, "#9aa5ae")

    strobe(system, 0.75, 6, draw)
    picture.text((-0.2, -0.3), "kept")
    picture.text((-0.2, -1.2), "free")


@scene
def weld(picture: Picture) -> None:
    system = iota.System()
    beam, corners = box(system, (0.6, 0, 0), (1.2, 0.12, 0.12), 1)
    load, others = box(system, (1.05, 0.6, 0), (0.2, 0.2, 0.2), 1)
    joint = system.weld(beam, at=(0, 0, 0), break_torque=9)
    landing = system.surface_to_surface(load, iota.Sphere(0.1), beam, iota.Box((1.2, 0.12, 0.12)))

    def draw(o: float) -> None:
        picture.box([p.position for p in corners], o)
        picture.box([p.position for p in others], o, SECOND)

    strobe(system, 0.62, 7, draw)
    picture.line([(0, -0.35), (0, 0.35)], WORLD, 4)
    assert joint.broken
    assert landing.alive


@scene
def rod(picture: Picture) -> None:
    system = iota.System()
    p, q = (
        system.body().particle((x, 0, 0), mass=m, velocity=v)
        for x, m, v in ((-0.3, 2, (1.2, 2, 0)), (0.5, 1, (1.2, 5, 0)))
    )
    system.rod(p, q)

    def draw(o: float) -> None:
        picture.line([p.position, q.position], SECOND, 2, o)
        picture.dot(p.position, 6, INK, o)
        picture.dot(q.position, 4, INK, o)

    strobe(system, 0.85, 8, draw, [p, q], picture)


@scene
def rope(picture: Picture) -> None:
    system = iota.System()
    hook = system.body(kind="static").particle((0, 0, 0))
    stone = system.body().particle((-0.75, 0.1, 0), velocity=(2.6, 2.6, 0))
    line = system.rope(hook, stone, 1)

    def draw(o: float) -> None:
        distance = math.dist(stone.position, hook.position)
        taut = distance > 1 - 1e-6
        points = [(0, 0), tuple(stone.position)[:2]]
        if not taut:  # hangs in a bow that is as long as the rope, or nearly
            sag = 0.5 * math.sqrt(max(1 - distance**2, 0))
            points = [
                (points[1][0] * t, points[1][1] * t - 4 * sag * t * (1 - t) * 0.8) for t in (i / 16 for i in range(17))
            ]
        picture.line(points, SECOND, 1.6, o)
        picture.dot(stone.position, 5, INK, o)

    strobe(system, 1.25, 9, draw, [stone], picture)
    picture.dot((0, 0, 0), 5, WORLD)
    assert line.gap < 1e-6


@scene
def tackle(picture: Picture) -> None:
    system = iota.System()
    left, right = (system.body(kind="static").particle((x, 2, 0)) for x in (0, 0.8))
    block = system.body().particle((0.4, 0.4, 0), mass=2)
    weight = system.body().particle((1.2, 1.5, 0), mass=1.4)
    points = [left, block, right, weight]
    line = system.rope(points)

    def draw(o: float) -> None:
        picture.line([tuple(p.position)[:2] for p in points], SECOND, 1.6, o)
        picture.dot(block.position, 7, INK, o)
        picture.dot(weight.position, 5, INK, o)

    strobe(system, 0.75, 7, draw, [block, weight], picture)
    for pulley in (left, right):
        picture.dot(pulley.position, 5, WORLD)
    assert line.gap < 1e-6


@scene
def gear(picture: Picture) -> None:
    system = iota.System(gravity=(0, 0, 0))
    radii, teeth = (1.0, 0.5), (20, 10)
    wheels = [
        system.body(
            shape=iota.Cylinder(radius, 0.1),
            mass=1,
            position=(x, 0, 0),
            orientation=(0, math.sqrt(0.5), 0, math.sqrt(0.5)),
        )
        for radius, x in zip(radii, (0, 1.5), strict=True)
    ]
    joints = [system.revolute(w, at=tuple(w.position), axis=(0, 0, 1)) for w in wheels]
    mesh = system.gear(*joints, -teeth[0] / teeth[1])
    joints[0].angle.motor = (0.8, 100)

    def draw(o: float) -> None:
        for wheel, joint, radius in zip(wheels, joints, radii, strict=True):
            x, angle = wheel.position.x, joint.angle.value
            picture.line([(x, 0), (x + radius * math.cos(angle), radius * math.sin(angle))], INK, 2, o)

    strobe(system, 1, 7, draw)
    for wheel, radius in zip(wheels, radii, strict=True):
        picture.ring(wheel.position, radius)
        picture.dot(wheel.position, 5, WORLD)
    assert mesh.gap < 1e-9


@scene
def path(picture: Picture) -> None:
    system = iota.System()
    points = [(0, 1), (0.35, 0.45), (0.8, 0.12), (1.3, 0.35), (1.7, 0.75), (2.15, 0.6), (2.6, 0.1), (3.1, 0.3)]
    bead = system.body().particle(points[0])
    wire = system.on_path(bead, points)
    strobe(system, 1.5, 16, lambda o: picture.dot(bead.position, 5, INK, o))
    probe = iota.System(gravity=(0, 0, 0))
    rider = probe.body().particle(points[0])
    probe.on_path(rider, points, motor=(wire.length, 1e6))
    outline: list[Point] = []
    strobe(probe, 1, 200, lambda o: outline.append(tuple(rider.position)))
    picture.items.insert(
        0, ("polyline", [picture.view(p) for p in outline], f'fill="none" stroke="{WORLD}" stroke-width="2"')
    )


@scene
def surface(picture: Picture) -> None:
    picture.view = tilted
    system = iota.System()
    bob = system.body().particle((0.9, -0.43589, 0), velocity=(0, 0, 1.3))
    system.on_surface(bob, iota.Sphere(1))
    strobe(system, 6, 2, lambda o: None, [bob], picture)
    strobe(system, 0.5, 5, lambda o: picture.dot(bob.position, 4.5, INK, o))
    picture.ring((0, 0, 0), 1, WORLD, 0.8)
    for height in (-0.8, -0.4, 0):
        r = math.sqrt(1 - height * height)
        picture.line(
            [(r * math.cos(a), height, r * math.sin(a)) for a in (math.tau * i / 60 for i in range(61))],
            WORLD,
            0.7,
            0.5,
        )


@scene
def inside(picture: Picture) -> None:
    system = iota.System(damping=0.15)
    ball = system.body().particle((-0.62, 0.3, 0), velocity=(0.2, 0, 0))
    system.inside(ball, iota.Sphere(1))
    strobe(system, 1.35, 15, lambda o: picture.dot(ball.position, 5, INK, o), [ball], picture)
    picture.line([(math.sin(a), -math.cos(a)) for a in (-2.2 + 4.4 * i / 60 for i in range(61))], WORLD, 2.5)


@scene
def outside(picture: Picture) -> None:
    system = iota.System()
    ball = system.body().particle((0.05, 1.0487, 0))
    system.outside(ball, iota.Sphere(1.05))
    strobe(system, 1.4, 22, lambda o: picture.dot(ball.position, 4.5, INK, o), [ball], picture)
    picture.ring((0, 0, 0), 1, WORLD, 1, 2.5)


@scene
def surfaces(picture: Picture) -> None:
    system = iota.System(damping=0.2)
    slope = math.radians(20)
    normal = (math.sin(slope), math.cos(slope), 0)
    balls = []
    for x, height, radius in ((0, 0, 0.25), (0.55, 0.9, 0.3), (1.6, 0.2, 0.2)):
        body = system.body(
            shape=iota.Sphere(radius),
            mass=radius**3,
            position=(x, -math.tan(slope) * x + radius / math.cos(slope) + height, 0),
        )
        system.surface_to_surface(body, iota.Sphere(radius), None, iota.HalfSpace(normal))
        balls.append((body, radius))
    for i, (a, r) in enumerate(balls):
        for b, s in balls[:i]:
            system.surface_to_surface(a, iota.Sphere(r), b, iota.Sphere(s))
    colors = (INK, TRACE, SECOND)

    def draw(o: float) -> None:
        for (body, radius), color in zip(balls, colors, strict=True):
            picture.ring(body.center_of_mass, radius, color, o, 1.8)

    strobe(system, 0.9, 5, draw)
    hatch(picture, (-0.5, 0.5 * math.tan(slope)), (3.4, -3.4 * math.tan(slope)))


@scene
def acting(picture: Picture) -> None:
    """The angle of one block on an axle against time, under what can act on it."""
    cases = [
        ("limits", {"limits": (-2.2, 0)}, INK),
        ("motor", {"motor": (-1.5, 50)}, TRACE),
        ("friction", {"friction": 0.7}, SECOND),
        ("spring", {"spring": (6, 0.2, 0.5)}, WORLD),
    ]
    seconds = 5
    for name, options, color in cases:
        system = iota.System()
        body, _ = box(system, (0.5, 0, 0), (0.3, 0.2, 0.2))
        joint = system.revolute(body, at=(0, 0, 0), axis=(0, 0, 1), **options)
        curve: list[Point] = [(0, 0)]
        for i in range(seconds * 120):
            system.step(1 / 120)
            if joint.angle.value > -3.4:
                curve.append((i / 120, joint.angle.value * 0.9))
        picture.line(curve, color, 1.8)
        picture.text((curve[-1][0] * 1.01, curve[-1][1]), name)
    picture.line([(0, 0.8), (0, -3.1)], INK, 0.8)
    picture.line([(0, 0), (seconds, 0)], INK, 0.8)
    picture.text((0.06, 0.75), "angle")
    picture.text((seconds, 0.12), "time")


def main() -> None:
    FOLDER.mkdir(exist_ok=True)
    for name in sys.argv[1:] or SCENES:
        picture = Picture()
        SCENES[name](picture)
        picture.write(FOLDER / f"{name}.svg")


if __name__ == "__main__":
    main()
