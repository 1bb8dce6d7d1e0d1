# SPDX-License-Identifier: Apache-2.0
"""Bodies given by shape."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from shown import show

import iota
from iota import looks


def cube(size: float = 1.0) -> iota.Mesh:
    corners = [(x, y, z) for z in (0, size) for y in (0, size) for x in (0, size)]
    triangles = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4)]
    triangles += [(2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
    return iota.Mesh(corners, triangles)


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        (iota.Sphere(0.5), math.pi / 6),
        (iota.Box((1, 2, 3)), 6),
        (iota.Cylinder(0.5, 2), math.pi / 2),
        (iota.Capsule(0.5, 2), math.pi / 2 + math.pi / 6),
        (iota.Torus(1, 0.1), 2 * math.pi**2 * 0.01),
        (iota.Ellipsoid((1, 2, 3)), math.pi),
        (iota.Cone(1, 3), math.pi),
        (cube(2), 8),
    ],
)
def test_a_body_of_any_shape_has_its_mass_and_center(system: iota.System, shape: object, volume: float) -> None:
    body = system.body(shape=shape, density=700, position=(1, 2, 3), orientation=(0, 0, 1, 1))
    assert body.mass == pytest.approx(700 * volume)
    assert shape.mass_properties.volume == pytest.approx(volume)
    assert len(body.particles) == 4 and body.attachments == []
    (solid,) = body.solids
    assert type(solid.shape) is type(shape)
    assert solid.position == pytest.approx((1, 2, 3))
    assert solid.orientation == pytest.approx((0, 0, math.sqrt(0.5), math.sqrt(0.5)))
    assert body.orientation == pytest.approx(solid.orientation)


def test_inertia_velocity_and_spin_are_read_and_assigned(system: iota.System) -> None:
    body = system.body(shape=iota.Box((1, 2, 3)), mass=12, velocity=(1, 0, 0), spin=(0, 0, 2))
    np.testing.assert_allclose(body.inertia, np.diag([13, 10, 5]), atol=1e-12)
    assert body.velocity == pytest.approx((1, 0, 0)) and body.angular_velocity == pytest.approx((0, 0, 2))
    body.velocity, body.angular_velocity = (0, 1, 0), (3, 0, 0)
    assert body.velocity == pytest.approx((0, 1, 0)) and body.angular_velocity == pytest.approx((3, 0, 0))
    assert body.angular_momentum == pytest.approx((39, 0, 0))


def test_attachments_are_ordinary_particles(system: iota.System) -> None:
    door = system.body(shape=iota.Box((0.9, 2, 0.04)), density=600, attachments=[(-0.45, 0.8, 0), (-0.45, -0.8, 0)])
    inertia = door.inertia
    for hinge in door.attachments:
        hinge.nail()
    door.angular_velocity = (0, 1, 0)
    for _ in range(60):
        report = system.step(1 / 120)
    assert report.worst_gap < 1e-9
    own = (0.9**2 + 0.04**2) / 12  # about its middle; the nails take what is no turn about its edge
    assert door.angular_velocity.y == pytest.approx(own / (own + 0.45**2), rel=1e-6)
    extra = system.body(shape=iota.Sphere(0.1)).attachment((5, 5, 5))
    assert extra.position == pytest.approx((5, 5, 5)) and 0 < extra.mass < 1e-3
    assert door.inertia.trace() == pytest.approx(inertia.trace())


def test_sizes_that_make_no_shape_are_refused(system: iota.System) -> None:
    with pytest.raises(ValueError, match="the radius of a sphere must be between 1e-09 and"):
        iota.Sphere(-1)
    with pytest.raises(ValueError, match="not closed: triangle"):
        iota.Mesh(cube().vertices, cube().triangles[:-1])
    with pytest.raises(ValueError, match="inside out"):
        iota.Mesh(cube().vertices, cube().triangles[:, ::-1])
    with pytest.raises(ValueError, match="names vertex"):
        iota.Mesh(cube().vertices[:-1], cube().triangles)
    with pytest.raises(ValueError, match=r"must have the shape \(n, 3\)"):
        iota.Mesh([1, 2, 3], [[0, 1, 2]])
    with pytest.raises(TypeError, match="a shape must be one of Sphere, Box"):
        system.body(shape="box")
    with pytest.raises(TypeError, match="are of bodies with a shape"):
        system.body(position=(1, 2, 3))
    with pytest.raises(ValueError, match="orientation must be finite and not zero"):
        system.body(shape=iota.Sphere(1), orientation=(0, 0, 0, 0))
    with pytest.raises(ValueError, match="mass"):
        system.body(shape=iota.Sphere(1), mass=0)
    with pytest.raises(ValueError, match="use create_particle"):
        system.body().attachment((0, 0, 0))
    assert system.bodies and system.validate() == []


def test_the_skin_round_loose_points_is_a_shape(system: iota.System) -> None:
    points = np.vstack([cube(2).vertices, cube(1).vertices, cube(2).vertices])
    hull = iota.Mesh.convex_hull(points)
    assert len(hull.vertices) == 8 and len(hull.triangles) == 12
    assert system.body(shape=hull, density=100).mass == pytest.approx(800)
    with pytest.raises(ValueError, match="in one plane"):
        iota.Mesh.convex_hull([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    with pytest.raises(ValueError, match=r"points must have the shape \(n, 3\)"):
        iota.Mesh.convex_hull([1, 2, 3, 4])


def test_the_page_draws_the_shapes(system: iota.System) -> None:
    a = system.body(shape=iota.Box((1, 1, 1)))
    b = system.body(shape=iota.Box((1, 1, 1)), position=(3, 0, 0), orientation=(0, 1, 0, 1))
    c = system.body(shape=cube(), position=(0, 5, 0))
    with show(system) as shown:
        assert shown.bodies[a.slot]["visual"] == shown.bodies[b.slot]["visual"] != shown.bodies[c.slot]["visual"]
        (part,) = shown.parts(a)
        assert (
            part["shape"]["kind"] == "box" and part["shape"]["sizes"][:3] == [1, 1, 1] and part["offset"] == (0, 0, 0)
        )
        (skin,) = shown.parts(c)
        assert skin["shape"]["kind"] == "mesh"
        assert len(skin["shape"]["vertices"]) == 24 and len(skin["shape"]["triangles"]) == 36
        corners = np.reshape(skin["shape"]["vertices"], (8, 3)) + skin["offset"]
        assert np.allclose(corners.mean(axis=0), 0, atol=1e-6), "about the center of mass"
        a.combine(b)
        shown.look()
        assert [part["offset"][0] for part in shown.parts(a)] == pytest.approx([-1.5, 1.5])


def test_a_locked_pair_unlocks_by_the_torque_on_one_of_its_blocks() -> None:
    """Algorithm 4 of the thesis asks for the torque on each block of a locked pair, by what is outside of the two."""
    system = iota.System()
    upper = system.body(shape=iota.Box((1, 0.1, 0.5)), mass=1, attachments=[(-0.5, 0, 0), (0.5, 0, 0)])
    lower = system.body(
        shape=iota.Box((1, 0.1, 0.5)), mass=1, position=(1, 0, 0), attachments=[(-0.5, 0, 0), (0.5, 0, 0)]
    )
    hinge = upper.attachments[1], lower.attachments[0]
    hinge[0].combine(hinge[1])
    hinge[0].combine(hinge[1])
    upper.particles[4].nail()
    block = upper.parts[1]
    end = block.particles[-1]
    assert block.origin == lower and end.position.x == pytest.approx(1.5)
    end.apply_force((0, -7, 0))
    system.step(1e-4)
    assert block.outside_force == pytest.approx((0, -7 - 9.81, 0), abs=0.01)
    assert block.outside_torque == pytest.approx((0, 0, -3.5), abs=0.01)
    # The two fall as one beam about the nail; what the weight on this block falls short of that, the lock gives it.
    inertia = 2 * (1 + 0.1**2) / 12 + 0.5**2 + 1.5**2
    falls = 1.5 * (2 * 9.81 * 1 + 7 * 2) / inertia
    assert (block.net_force - block.outside_force).y == pytest.approx(7 + 9.81 - falls, abs=0.01)
    (opened,) = block.separate().created_bodies
    assert opened.articulate == upper.articulate and system.validate() == []


def test_a_rod_spins_and_points_on_a_line_do_not(system: iota.System) -> None:
    rod = system.body()
    rod.particle((0, 0, 0)), rod.particle((0, 0, 1))
    with pytest.raises(ValueError, match="on one line, about which they have no inertia"):
        rod.angular_velocity = (0, 0, 3)
    rod.set_rod(2, 0.1)
    rod.angular_velocity = (1, 0, 30)
    assert rod.angular_velocity == pytest.approx((1, 0, 30))
    assert rod.angular_momentum.z == pytest.approx(2 * 0.1**2 / 2 * 30)
    system.step(1e-3)
    assert abs(rod.angular_velocity) == pytest.approx(math.hypot(1, 30), rel=1e-6)


def test_a_mesh_too_large_to_draw_is_drawn_as_its_box(system: iota.System) -> None:
    turns = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    ring = np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1)
    points = np.concatenate([ring * np.cos(a) + (0, 0, np.sin(a)) for a in np.linspace(-1.5, 1.5, 80)])
    ball = iota.Mesh.convex_hull(points)
    assert len(ball.triangles) > looks.MOST_TRIANGLES
    system.body(shape=ball)
    body = system.bodies[0]
    with show(system) as shown:
        (warning,) = shown.room.take_warnings()
        assert "at most 50000 triangles, that of body 0 has" in warning
        (part,) = shown.parts(body)
        assert part["shape"]["kind"] == "box" and part["shape"]["sizes"][:3] == pytest.approx([2, 2, 2], abs=0.01)


def test_a_pose_is_assigned(system: iota.System) -> None:
    body = system.body(shape=iota.Cylinder(0.1, 1), attachments=[(0.5, 0, 0)])
    body.set_pose((1, 2, 3), (0, 0, 1, 1))
    assert body.center_of_mass == pytest.approx((1, 2, 3))
    assert body.attachments[0].position == pytest.approx((1, 2.5, 3))


def test_a_rigid_molecule_breaks_where_its_bond_graph_does(system: iota.System) -> None:
    body = system.body()
    atoms = [body.particle((i, i % 2, 0), velocity=(0, i, 0)) for i in range(4)]
    bonds = [system.cosmetic_bond(p, q) for p, q in pairwise(atoms)]
    system.step(0.01)
    momentum = system.momentum
    report = bonds[1].destroy()
    (piece,) = report.created_bodies
    assert piece.particles == atoms[2:] and body.particles == atoms[:2]
    assert system.momentum == pytest.approx(momentum)
    assert not bonds[0].destroy().queued and len(system.bodies) == 3
    assert system.validate() == []


def test_parts_of_a_locked_pair_are_told_apart_and_unlocked(system: iota.System) -> None:
    a = system.body(shape=iota.Box((1, 1, 0.1)), attachments=[(0.5, 0.5, 0)])
    b = system.body(shape=iota.Box((1, 1, 0.1)), position=(1, 0, 0), attachments=[(-0.5, 0.5, 0)])
    p, q = a.attachments[0], b.attachments[0]
    p.combine(q)
    p.combine(q)
    system.step(0.01)
    assert [part.origin for part in a.parts] == [a, b]
    part = a.parts[1]
    assert part.mass == pytest.approx(100, rel=1e-3) and len(part.particles) == 4
    assert part.net_force == pytest.approx((0, -981, 0), rel=1e-3, abs=1e-6)
    assert a.net_force == pytest.approx((0, -1962, 0), abs=1e-6)
    assert a.net_torque == pytest.approx((0, 0, 0), abs=1e-6)
    assert a.particles[0].net_force.y == pytest.approx(-9.81 * a.particles[0].mass)
    (unlocked,) = part.separate().created_bodies
    assert unlocked.articulate == a.articulate and len(p.ring) == 2
    assert system.validate() == []


def test_a_massless_particle_that_is_combined_keeps_its_place_on_its_body(system: iota.System) -> None:
    """Two boxes on one hinge are laid flat on each other by their markers, just after one of them was hinged to a third."""
    lower = system.body(shape=iota.Box((0.01, 0.08, 0.05)), position=(0, 0.92, 0))
    corners = [lower.attachment((x, y, 0)) for x in (-0.005, 0.005) for y in (0.88, 0.96)]
    marker = lower.particle((0, 0.96, 0), mass=0)
    upper = system.body(shape=iota.Box((0.01, 0.08, 0.05)), position=(0, 1, 0))
    mark_above = upper.particle((0, 0.96, 0), mass=0)
    hinge = upper.attachment((-0.005, 0.96, 0))
    turn, arm = 0.03, lower.position - hinge.position
    place = (arm.x * math.cos(turn) - arm.y * math.sin(turn), arm.x * math.sin(turn) + arm.y * math.cos(turn), 0)
    lower.set_pose(hinge.position + place, (0, 0, math.sin(turn / 2), math.cos(turn / 2)))
    hinge.combine(corners[1])
    third = system.body(shape=iota.Box((0.01, 0.08, 0.05)), position=(0, 0.84, 0))
    before = [abs(marker.position - p.position) for p in lower.particles]
    corners[3].combine(third.attachment(corners[3].position))
    report = mark_above.combine(marker)
    assert report.closed_distance == pytest.approx(0.005 * turn, rel=1e-3)
    assert [abs(marker.position - p.position) for p in lower.particles] == pytest.approx(before, abs=1e-12)
    assert system.worst_gap < 1e-12


@pytest.mark.parametrize("mode", ["robust", "plausible", "energy_keeping", "accurate"])
@pytest.mark.parametrize("rate", [60, 1000])
@pytest.mark.parametrize("tie", ["rod", "span", "ball", "combine", "nail"])
def test_an_attachment_leaves_the_motion_of_a_jointed_body_as_it_is(mode: str, rate: int, tie: str) -> None:
    system = iota.System(mode=mode, gravity=(0, 0, -3))
    box = iota.Box((1, 0.7, 0.5))
    first = system.body(shape=box, mass=2, velocity=(1, 2, -1), spin=(3, -5, 4))
    second = system.body(shape=box, mass=2, position=(1.6, 0, 0))
    p, q = first.attachment((-0.5, -0.3, -0.6)), second.attachment((1.3, 0.2, 0.1))
    if tie == "rod":
        system.rod(p, q)
    elif tie == "span":
        system.span(p, q, spring=(200, 2, 0.5))
    elif tie == "ball":
        system.ball(first, second, at=(0.8, 0, 0))
    elif tie == "combine":
        p.combine(second.attachment(p.position))
    else:
        p.nail()

    def motion() -> list[float]:
        return [x for body in (first, second) for x in (*body.velocity, *body.angular_velocity)]

    for _ in range(3):
        system.step(1 / rate)
    before, inertia = motion(), first.inertia
    x, y, z = first.position
    first.attachment((x + 0.2, y + 0.3, z + 0.1))
    assert motion() == pytest.approx(before, rel=1e-11, abs=1e-11)
    assert first.inertia.trace() == pytest.approx(inertia.trace(), rel=1e-12)
