// SPDX-License-Identifier: Apache-2.0
// Bodies that fall into pieces, the parts they were combined from, and the forces on all of these.
#include "vectors.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace iota {
namespace {

/// A rigid chain of particles with cosmetic bonds, spinning as it flies.
struct Molecule {
  System system{{.gravity = {}}};
  BodyId body = system.bodies().create();
  std::vector<ParticleId> atoms;
  std::vector<CosmeticBondId> bonds;

  explicit Molecule(const std::vector<Vec3>& places) {
    for (const Vec3& x : places) {
      atoms.push_back(
          system.particles().create(body, x, 1 + 0.1 * atoms.size(), Vec3{1, 0, 0} + cross({0.3, -1, 2}, x)));
      if (atoms.size() > 1) bonds.push_back(system.cosmetic_bonds().create(atoms[atoms.size() - 2], atoms.back()));
    }
  }
};

const std::vector<Vec3> zigzag{{0, 0, 0}, {1, 0.5, 0}, {2, 0, 0.5}, {3, 1, 0}, {4, 0, 0}, {5, 0.5, 1}};

TEST(Split, breaking_the_only_bond_between_two_pieces_splits_the_body_and_keeps_momenta) {
  Molecule m(zigzag);
  System& system = m.system;
  (void)system.step(0.01);
  const Vec3 momentum = system.momentum(), angular = system.angular_momentum();
  const double energy = system.energy().kinetic;
  const RestructureReport report = system.cosmetic_bonds().destroy(m.bonds[2]);  // between atoms 2 and 3
  ASSERT_EQ(report.created_bodies.size(), 1u);
  const BodyId piece = report.created_bodies[0];
  EXPECT_EQ(system.bodies().particles(m.body).size(), 3u);
  EXPECT_EQ(system.bodies().particles(piece).size(), 3u);
  EXPECT_EQ(system.particles().body(m.atoms[2]), m.body);
  EXPECT_EQ(system.particles().body(m.atoms[3]), piece);
  EXPECT_NEAR(system.bodies().mass(m.body), 1 + 1.1 + 1.2, 1e-14);
  EXPECT_NEAR(system.bodies().mass(piece), 1.3 + 1.4 + 1.5, 1e-14);
  EXPECT_NE(system.bodies().articulate(m.body), system.bodies().articulate(piece));
  expect_near(system.momentum(), momentum, 1e-13);
  expect_near(system.angular_momentum(), angular, 1e-12);
  EXPECT_NEAR(system.energy().kinetic, energy, 1e-12);
  EXPECT_EQ(report.articulates_after, 2u);
  for (int i = 0; i < 100; ++i) (void)system.step(0.01);
  expect_near(system.momentum(), momentum, 1e-11);
  expect_near(system.angular_momentum(), angular, 1e-10);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Split, a_bond_on_a_ring_of_bonds_breaks_without_a_split) {
  Molecule m(zigzag);
  const CosmeticBondId closing = m.system.cosmetic_bonds().create(m.atoms.back(), m.atoms.front());
  EXPECT_TRUE(m.system.cosmetic_bonds().destroy(m.bonds[1]).created_bodies.empty());
  EXPECT_EQ(m.system.bodies().ids().size(), 1u);
  EXPECT_EQ(m.system.cosmetic_bonds().destroy(closing).created_bodies.size(), 1u);
}

TEST(Split, particles_without_a_bond_go_with_the_nearer_piece) {
  Molecule m({{0, 0, 0}, {1, 0, 0}, {5, 0, 0}, {6, 0, 0}});
  System& system = m.system;
  const ParticleId near_left = system.particles().create(m.body, {0, 1, 0}),
                   near_right = system.particles().create(m.body, {6, 1, 0});
  const RestructureReport report = system.cosmetic_bonds().destroy(m.bonds[1]);
  ASSERT_EQ(report.created_bodies.size(), 1u);
  EXPECT_EQ(system.particles().body(near_left), m.body);
  EXPECT_EQ(system.particles().body(near_right), report.created_bodies[0]);
  EXPECT_EQ(report.notes.size(), 1u);
}

// Thesis, Fig. 5.2: a rigid molecule on a nail loses a part, which falls; the rest swings on.
TEST(Split, a_piece_off_a_nailed_body_falls_freely) {
  Molecule m(zigzag);
  System& system = m.system;
  system.set_gravity({0, -9.81, 0});
  system.bodies().set_velocity(m.body, {});
  system.bodies().set_angular_velocity(m.body, {});
  system.particles().nail(m.atoms[0]);
  const BodyId piece = system.cosmetic_bonds().destroy(m.bonds[3]).created_bodies.at(0);
  const Vec3 start = system.bodies().center_of_mass(piece), v = system.bodies().velocity(piece);
  double t = 0;
  for (int i = 0; i < 50; ++i) (void)system.step(0.01), t += 0.01;
  EXPECT_NEAR(system.bodies().center_of_mass(piece).y, start.y + v.y * t - 9.81 * t * t / 2, 1e-9);
  expect_near(system.particles().position(m.atoms[0]), {0, 0, 0}, 1e-9);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Split, a_grip_stays_with_the_piece_that_it_holds) {
  for (const bool at_the_end : {false, true}) {
    Molecule m(zigzag);
    System& system = m.system;
    system.bodies().set_velocity(m.body, {});
    system.bodies().set_angular_velocity(m.body, {});
    const std::vector<Vec3> before = [&] {
      std::vector<Vec3> places;
      for (const ParticleId atom : m.atoms) places.push_back(system.particles().position(atom));
      return places;
    }();
    // The drawn frame's origin is at the center of mass and its axes are the world's.
    const Vec3 held = before[at_the_end ? 5 : 0] - system.bodies().center_of_mass(m.body);
    (void)system.grips().create(m.body, held, {2, 9, 0});
    const BodyId piece = system.cosmetic_bonds().destroy(m.bonds[2]).created_bodies.at(0);
    const BodyId gripped = at_the_end ? piece : m.body, let_go = at_the_end ? m.body : piece;
    for (int i = 0; i < 20; ++i) (void)system.step(1.0 / 120);
    ASSERT_EQ(system.viewer().poses().holds.size(), 1u);
    EXPECT_EQ(system.viewer().poses().holds[0].body, gripped.slot);
    EXPECT_GT(norm(system.bodies().velocity(gripped)), 0.5);
    EXPECT_LT(norm(system.bodies().velocity(let_go)), 1e-12) << "nobody pulls on the other piece";
    EXPECT_EQ(system.validate(), std::vector<std::string>{});
  }
}

TEST(Split, hinges_and_bonds_of_the_pieces_stay) {
  Molecule m(zigzag);
  System& system = m.system;
  const BodyId other = system.bodies().create();
  const ParticleId end = system.particles().create(other, {5, 0.5, 1}),
                   far = system.particles().create(other, {6, 0, 1});
  (void)system.edits().combine(m.atoms[5], end);
  const BondId bond = system.bonds().create(m.atoms[0], m.atoms[5], SpringLaw{});
  (void)system.step(0.01);
  const BodyId piece = system.cosmetic_bonds().destroy(m.bonds[2]).created_bodies.at(0);
  EXPECT_EQ(system.bodies().articulate(piece), system.bodies().articulate(other));
  EXPECT_NE(system.bodies().articulate(piece), system.bodies().articulate(m.body));
  EXPECT_EQ(system.particles().ring(m.atoms[5]).size(), 2u);
  EXPECT_TRUE(system.bonds().contains(bond));
  for (int i = 0; i < 50; ++i) EXPECT_EQ(system.step(0.01).unconverged, 0);
  EXPECT_TRUE(system.particles().contains(far));
  EXPECT_TRUE(system.validate().empty());
}

TEST(Split, solids_are_never_torn_but_their_compounds_are) {
  System system({.gravity = {}});
  const BodyId a = system.bodies().create(Box{}, {.attachments = {{0.5, 0, 0}, {-0.5, 0, 0}}});
  const BodyId b =
      system.bodies().create(Sphere{0.5}, {.position = {1, 0, 0}, .spin = {0, 0, 3}, .attachments = {{0, 0.5, 0}}});
  const auto ends = system.bodies().attachments(a);
  const CosmeticBondId own = system.cosmetic_bonds().create(ends[0], ends[1]);
  EXPECT_TRUE(system.cosmetic_bonds().destroy(own).created_bodies.empty());
  const ParticleId top = system.bodies().attachments(b)[0];
  (void)system.edits().combine(a, b);
  const Vec3 angular = system.angular_momentum();
  const CosmeticBondId joint = system.cosmetic_bonds().create(ends[0], top);
  const RestructureReport report = system.cosmetic_bonds().destroy(joint);
  ASSERT_EQ(report.created_bodies.size(), 1u);
  const BodyId ball = report.created_bodies[0];
  EXPECT_EQ(system.bodies().solids(a).size(), 1u);
  ASSERT_EQ(system.bodies().solids(ball).size(), 1u);
  EXPECT_TRUE(std::holds_alternative<Sphere>(system.bodies().solids(ball)[0].shape));
  EXPECT_NEAR(system.bodies().inertia(ball)[0].x, 0.4 * system.bodies().mass(ball) * 0.25,
              1e-12 * system.bodies().mass(ball));
  expect_near(system.angular_momentum(), angular, 1e-9);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Split, parts_are_remembered_and_can_leave_again) {
  System system({.gravity = {}});
  const BodyId a = system.bodies().create(Box{}), b = system.bodies().create(Box{}, {.position = {2, 0, 0}}),
               c = system.bodies().create(Sphere{}, {.position = {4, 0, 0}, .velocity = {0, 1, 0}});
  EXPECT_EQ(system.bodies().parts(a), std::vector<BodyId>{a});
  (void)system.edits().combine(b, c);
  (void)system.edits().combine(a, b);
  EXPECT_EQ(system.bodies().parts(a), (std::vector<BodyId>{a, b, c}));
  EXPECT_EQ(system.bodies().particles(a, c).size(), 4u);
  const Vec3 momentum = system.momentum(), angular = system.angular_momentum();
  const RestructureReport report = system.edits().separate(a, b);
  ASSERT_EQ(report.created_bodies.size(), 1u);
  EXPECT_EQ(system.bodies().parts(a), (std::vector<BodyId>{a, c}));
  EXPECT_EQ(system.bodies().parts(report.created_bodies[0]), report.created_bodies);
  expect_near(system.momentum(), momentum, 1e-10);
  expect_near(system.angular_momentum(), angular, 1e-9);
  EXPECT_FALSE(system.edits().separate(a, b).changed);
  EXPECT_TRUE(system.validate().empty());
}

// What Jacob's ladder does all the time: a hinge is locked by combining its two particles again, and unlocked.
TEST(Split, unlocking_a_hinge_brings_the_hinge_back) {
  System system({.gravity = {}});
  const BodyId a = system.bodies().create(Box{{1, 1, 1}}, {.mass = 2, .attachments = {{0.5, 0.5, 0}}});
  const BodyId b =
      system.bodies().create(Box{{1, 1, 1}}, {.mass = 3, .position = {1, 0, 0}, .attachments = {{-0.5, 0.5, 0}}});
  const ParticleId p = system.bodies().attachments(a)[0], q = system.bodies().attachments(b)[0];
  (void)system.edits().combine(p, q);
  const Matrix3 before = system.bodies().inertia(b);
  (void)system.edits().combine(p, q);  // locked
  EXPECT_FALSE(system.bodies().contains(b));
  EXPECT_EQ(system.bodies().parts(a), (std::vector<BodyId>{a, b}));
  const RestructureReport report = system.edits().separate(a, b);
  ASSERT_EQ(report.created_bodies.size(), 1u);
  ASSERT_EQ(report.created_particles.size(), 1u);
  const BodyId unlocked = report.created_bodies[0];
  EXPECT_EQ(system.particles().ring(p), (std::vector<ParticleId>{p, report.created_particles[0]}));
  EXPECT_EQ(system.particles().body(report.created_particles[0]), unlocked);
  EXPECT_EQ(system.bodies().articulate(a), system.bodies().articulate(unlocked));
  EXPECT_NEAR(system.bodies().mass(a), 2, 1e-13);
  EXPECT_NEAR(system.bodies().mass(unlocked), 3, 1e-13);
  for (int i = 0; i < 3; ++i) expect_near(system.bodies().inertia(unlocked)[i], before[i], 1e-12);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(system.step(0.01).unconverged, 0);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Split, parts_of_a_star_leave_its_locked_hinge_in_any_order_and_the_hinge_is_whole_again) {
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    System system({.gravity = {}});
    std::vector<BodyId> arms;
    std::vector<ParticleId> centers;
    for (int i = 0; i < 6; ++i) {
      arms.push_back(system.bodies().create());
      centers.push_back(system.particles().create(arms.back(), {}, 1));
      (void)system.particles().create(arms.back(), {std::cos(i), std::sin(i), 0.1 * i}, 2);
      if (i > 0) (void)system.edits().combine(centers[0], centers.back());
    }
    std::vector<BodyId> order(arms.begin() + 1, arms.end());
    std::shuffle(order.begin(), order.end(), random);
    for (const BodyId arm : order) {
      (void)system.edits().combine(arms[0], arm);
      ASSERT_EQ(system.validate(), std::vector<std::string>{});
    }
    EXPECT_EQ(system.bodies().ids().size(), 1u);
    EXPECT_NEAR(system.bodies().mass(arms[0]), 18, 1e-12);
    std::shuffle(order.begin(), order.end(), random);
    for (const BodyId arm : order) {
      const RestructureReport report = system.edits().separate(arms[0], arm);
      ASSERT_EQ(system.validate(), std::vector<std::string>{});
      ASSERT_EQ(report.created_bodies.size(), 1u);
      EXPECT_NEAR(system.bodies().mass(report.created_bodies[0]), 3, 1e-12);
      EXPECT_EQ(system.bodies().particles(report.created_bodies[0]).size(), 2u);
    }
    EXPECT_EQ(system.bodies().ids().size(), 6u);
    for (const BodyId arm : system.bodies().ids())
      EXPECT_EQ(system.bodies().articulate(arm), system.bodies().articulate(arms[0])) << "hinged at the center";
  }
}

TEST(Split, net_force_and_torque_are_those_from_outside) {
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    System system({.mode = mode});
    const double h = 0.001;
    const BodyId plate =
        system.bodies().create(Box{{1, 2, 0.3}}, {.mass = 4, .spin = {1, 2, 3}, .attachments = {{0.5, 1, 0}}});
    const ParticleId corner = system.bodies().attachments(plate)[0];
    (void)system.step(h);
    expect_near(system.bodies().net_force(plate), {0, -4 * 9.81, 0}, 1e-6);
    EXPECT_LT(norm(system.bodies().net_torque(plate)), 1e-6);
    const Vec3 force{0, 3, 7}, before = system.bodies().angular_momentum(plate);
    system.particles().apply_force(corner, force);
    (void)system.step(h);
    expect_near(system.bodies().net_force(plate), Vec3{0, -4 * 9.81, 0} + force, 1e-6);
    const Vec3 arm = system.particles().position(corner) - system.bodies().center_of_mass(plate);
    expect_near(system.bodies().net_torque(plate), cross(arm, force), mode == IntegrationMode::robust ? 1e-6 : 0.02);
    if (mode == IntegrationMode::energy_keeping)  // the change of angular momentum, to the last digit
      expect_near(system.bodies().net_torque(plate), (1 / h) * (system.bodies().angular_momentum(plate) - before),
                  1e-6);
  }
}

TEST(Split, net_forces_of_parts_add_up_to_the_bodys) {
  System system;
  const BodyId a = system.bodies().create(Box{}, {.mass = 1}),
               b = system.bodies().create(Box{}, {.mass = 2, .position = {2, 0, 0}});
  (void)system.edits().combine(a, b);
  system.bodies().set_angular_velocity(a, {0, 0, 4});
  (void)system.step(0.001);
  expect_near(system.bodies().net_force(a, a) + system.bodies().net_force(a, b), system.bodies().net_force(a), 1e-9);
  // Turning at omega about the common center, each part is pulled towards it: m r omega^2.
  EXPECT_NEAR(system.bodies().net_force(a, b).x, -2 * (2.0 / 3) * 16, 0.01);
  EXPECT_NEAR(system.bodies().net_force(a, a).x, 1 * (4.0 / 3) * 16, 0.01);
  Vec3 sum;
  for (const ParticleId p : system.bodies().particles(a)) sum += system.particles().net_force(p);
  expect_near(sum, system.bodies().net_force(a), 1e-9);
}

/// Two boxes that touch at x = 0.5, as one rigid body.
struct LockedPair {
  System system;
  BodyId a, b;

  explicit LockedPair(IntegrationMode mode, const Vec3& gravity = {}) : system({.gravity = gravity, .mode = mode}) {
    a = system.bodies().create(Box{{1, 0.4, 0.2}}, {.mass = 3, .attachments = {{-0.5, 0.2, 0.1}}});
    b = system.bodies().create(Box{{1, 0.4, 0.2}},
                               {.mass = 2, .position = {1, 0, 0}, .attachments = {{0.5, 0.2, -0.1}}});
    (void)system.edits().combine(a, b);
  }
  ParticleId corner(BodyId part) const { return system.bodies().particles(a, part).back(); }
};

constexpr std::array both_schemes{IntegrationMode::robust, IntegrationMode::energy_keeping};

TEST(Outside, a_push_on_one_of_two_locked_blocks_is_force_and_torque_on_that_one_alone) {
  for (const IntegrationMode mode : both_schemes) {
    LockedPair pair(mode);
    System& system = pair.system;
    const double h = 1e-3;
    const Vec3 push{0, 1, 5}, arm{0.5, 0.2, -0.1};
    system.particles().apply_force(pair.corner(pair.b), push);
    (void)system.step(h);
    expect_near(system.bodies().outside_force(pair.a, pair.b), push, 1e-12);
    expect_near(system.bodies().outside_torque(pair.a, pair.b), cross(arm, push),
                1e-4);  // turned by 1e-5 within the step
    expect_near(system.bodies().outside_force(pair.a, pair.a), {}, 1e-12);
    expect_near(system.bodies().outside_torque(pair.a, pair.a), {}, 1e-12);
    // What the lock carries is what moves the other block, by the motion of the two as one.
    const Vec3 center{0.4, 0, 0}, spin_up = (1 / h) * system.bodies().angular_velocity(pair.a);
    const Vec3 of_a = 3 * ((1 / 5.0) * push + cross(spin_up, Vec3{0, 0, 0} - center));
    expect_near(system.bodies().net_force(pair.a, pair.a), of_a, 1e-3);
    expect_near(system.bodies().outside_force(pair.a, pair.b) - system.bodies().net_force(pair.a, pair.b), of_a, 1e-3);
  }
}

TEST(Outside, a_joint_made_at_one_of_two_locked_blocks_goes_with_that_one) {
  LockedPair pair(IntegrationMode::energy_keeping);
  System& system = pair.system;
  const ConstraintId joint = system.joints().create(JointSpec{.a = pair.a, .at = {1.4, 0, 0}, .axis = {0, 1, 0}});
  const RestructureReport report = system.edits().separate(pair.a, pair.b);
  ASSERT_EQ(report.created_bodies.size(), 1u);
  ASSERT_TRUE(system.joints().contains(joint));
  EXPECT_EQ(system.joints().state(joint).a, report.created_bodies[0]);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Outside, whatever_holds_a_body_its_parts_forces_add_up_to_its_net_force) {
  for (const bool damped : {false, true}) {
    LockedPair pair(IntegrationMode::robust, {0, -9.81, 0});
    System& system = pair.system;
    if (damped) system.set_damping(0.7), system.bodies().set_damping(pair.a, 2);
    system.particles().nail(pair.corner(pair.a));
    const BodyId wheel = system.bodies().create(Sphere{0.2}, {.mass = 1, .position = {1, 0.5, 0}});
    system.joints().create(JointSpec{.a = pair.a, .b = wheel, .at = {1, 0.3, 0}, .angle = {.stiffness = 2}});
    const BodyId ball = system.bodies().create();
    const ParticleId weight = system.particles().create(ball, {2, -1, 0});
    system.bonds().create(pair.corner(pair.b), weight, SpringLaw{40, 0, 0.3});
    (void)system.grips().create(pair.a, {0.3, 0, 0}, {1, 2, 1});
    for (int i = 0; i < 20; ++i) {
      system.particles().apply_force(pair.corner(pair.b), {1, 2, 3});
      (void)system.step(0.005);
      Vec3 force, moments;
      for (const BodyId part : system.bodies().parts(pair.a)) {
        const Vec3 f = system.bodies().outside_force(pair.a, part);
        double mass = 0;
        Vec3 center;
        for (const ParticleId p : system.bodies().particles(pair.a, part))
          mass += system.particles().mass(p), center += system.particles().mass(p) * system.particles().position(p);
        force += f;
        moments += system.bodies().outside_torque(pair.a, part) +
                   cross((1 / mass) * center - system.bodies().center_of_mass(pair.a), f);
      }
      expect_near(force, system.bodies().net_force(pair.a), 1e-4);
      expect_near(moments, system.bodies().net_torque(pair.a), 1e-4);
    }
    EXPECT_GT(norm(system.bodies().net_force(pair.a)), 1);
  }
}

TEST(Split, a_bond_whose_ends_were_separated_just_goes) {
  Molecule m(zigzag);
  (void)m.system.edits().separate(m.atoms[1], m.atoms[2]);  // now of two bodies, its bonds with it
  for (const CosmeticBondId bond : m.bonds) (void)m.system.cosmetic_bonds().destroy(bond);
  EXPECT_TRUE(m.system.cosmetic_bonds().ids().empty());
  EXPECT_TRUE(m.system.validate().empty());
}

TEST(Split, a_part_of_massless_places_alone_cannot_be_left_behind) {
  System system;
  const BodyId plate = system.bodies().create(), other = system.bodies().create();
  const ParticleId own = system.particles().create(plate, {0, 0, 0});
  for (const Vec3& x : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, 1, 1}})
    system.particles().create(other, x);
  (void)system.edits().combine(plate, other);
  system.particles().create(plate, {0.2, 0.2, 0.2}, 0);
  system.particles().destroy(own);
  EXPECT_THROW((void)system.edits().separate(plate, other), std::invalid_argument);
  EXPECT_EQ(system.bodies().particles(plate).size(), 5u);
}

TEST(Split, splits_are_recorded_and_replayed) {
  Molecule m(zigzag);
  System& system = m.system;
  system.record().start();
  (void)system.step(0.01);
  (void)system.cosmetic_bonds().destroy(m.bonds[2]);
  (void)system.step(0.01);
  const BodyId other = system.bodies().create(Sphere{0.1});
  (void)system.edits().combine(m.body, other);
  (void)system.step(0.01);
  (void)system.edits().separate(m.body, other);
  (void)system.step(0.01);
  EXPECT_EQ(system.record().replay(system.record().stop()), std::nullopt);
}

}  // namespace
}  // namespace iota
