// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"
#include "ingredient/tables.h"

#include <iota/system.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

namespace iota::model {

/// The tables of a system, as a snapshot has them: after mark and length (base/seal.h) and the schema with its hash and length,
/// before the checksum.
inline Model model_of(System& system) {
  const Snapshot snapshot = system.snapshot();
  const std::span<const std::byte> bytes(snapshot.bytes);
  std::uint64_t schema = 0;
  std::memcpy(&schema, bytes.data() + 24, sizeof schema);
  Reader reader(bytes.subspan(32 + schema, bytes.size() - 40 - schema));
  Model model;
  model.archive(reader);
  if (!reader.ok() || !reader.at_end()) throw std::logic_error("the tables of a snapshot are laid out otherwise");
  return model;
}

/// One of everything that a system can hold, and the slots of what the tests damage; `fill` puts it into an empty system.
struct Everything {
  std::uint32_t loner, hinged, hinge_partner, inner, corner, rod, corners_body, box;
  std::uint32_t bond, scripted, cosmetic, angle_spring, joint, grip, field, pairs;
  Model model;

  Everything() {
    System system;
    fill(system);
    model = model_of(system);
  }

  void fill(System& system) {
    const auto slot = [](auto id) { return id.slot; };
    const ParticleId alone = system.particles().create(system.bodies().create(), {9, 9, 9});
    loner = slot(alone);

    // A short chain on a nail, of rods, one of which spins.
    std::vector<ParticleId> upper, lower;
    std::vector<BodyId> links;
    for (int i = 0; i < 3; ++i) {
      links.push_back(system.bodies().create());
      upper.push_back(system.particles().create(links[i], {double(i), 0, 0}));
      lower.push_back(system.particles().create(links[i], {i + 1.0, 0, 0}));
      system.bodies().set_rod(links[i], 1, 0.1);
      if (i > 0) (void)system.edits().combine(lower[i - 1], upper[i]);
    }
    system.particles().nail(upper[0]);
    system.bodies().set_angular_velocity(links[2], {3, 0, 0});
    system.particles().set_break_force(upper[1], 1e6);
    system.bodies().set_radius(links[1], 0.02);
    hinged = slot(upper[1]), hinge_partner = slot(lower[0]), rod = slot(links[2]);

    // A body of four corners and a particle that is not in its basis, with a cosmetic bond and a group.
    const BodyId four = system.bodies().create();
    std::vector<ParticleId> corners;
    for (const Vec3& x : {Vec3{0, 5, 0}, Vec3{1, 5, 0}, Vec3{0, 6, 0}, Vec3{0, 5, 1}})
      corners.push_back(system.particles().create(four, x));
    const ParticleId middle = system.particles().create(four, {0.3, 5.3, 0});
    inner = slot(middle), corner = slot(corners[0]), corners_body = slot(four);
    cosmetic = slot(system.cosmetic_bonds().create(corners[0], corners[1]));
    angle_spring = slot(system.angle_springs().create(alone, corners[3], upper[2], {.stiffness = 1}));
    const GroupId group = system.groups().create("corners");
    system.groups().add(group, corners[0]);
    field = slot(system.fields().create("fx = m", {.group = group}));
    pairs = slot(system.pairs().create({system.laws().find("soft_repulsion"), {{"length", 0.5}}, {}}, {.cutoff = 0.5}));

    // A solid on a joint, in a hand.
    const BodyId solid = system.bodies().create(Box{{0.2, 0.3, 0.4}}, {.position = {0, 5, 3}});
    (void)system.bodies().create_attachment(solid, {0, 5.2, 3});
    const ConstraintId hinge =
        system.joints().create(JointSpec{.kind = ConstraintKind::revolute, .a = solid, .b = four, .at = {0, 5, 1}});
    joint = slot(hinge);
    // A wheel in the world, geared to that joint.
    const BodyId wheel = system.bodies().create(Box{{0.1, 0.1, 0.1}}, {.position = {3, 5, 3}});
    const ConstraintId axle =
        system.joints().create(JointSpec{.kind = ConstraintKind::revolute, .a = wheel, .at = {3, 5, 3}});
    (void)system.joints().create(
        CouplingSpec{.terms = {{hinge, JointCoordinate::angle, 1}, {axle, JointCoordinate::angle, 2}}});
    grip = slot(system.grips().create(solid, {}, {1, 1, 1}));
    box = slot(solid);

    // Bonds of both kinds; two on their way to each other; one rigid body that was two.
    bond = slot(system.bonds().create(alone, corners[1], SpringLaw{}));
    (void)system.bonds().create(alone, corners[2], SpringLaw{});
    scripted = slot(system.bonds().create(alone, lower[2], ScriptedLaw{[](const BondState&) { return Vec3{}; }}));
    const ParticleId left = system.particles().create(system.bodies().create(), {-5, 0, 0}),
                     right = system.particles().create(system.bodies().create(), {-6, 0, 0});
    (void)system.edits().combine(left, right, 10);
    const ParticleId one = system.particles().create(system.bodies().create(), {-9, 0, 0}),
                     two = system.particles().create(system.bodies().create(), {-9, 0, 0});
    system.particles().create(system.particles().body(two), {-9, 1, 0});
    (void)system.edits().combine(one, two), (void)system.edits().combine(one, two);

    system.emitters().create({.rate = 240});
    (void)system.step(1.0 / 60);
    system.particles().apply_force(alone, {1, 0, 0});
  }
};

}  // namespace iota::model
