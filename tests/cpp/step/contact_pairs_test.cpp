// SPDX-License-Identifier: Apache-2.0
// Bodies that touch each other while both can move, judged from places, velocities and momenta.
#include "step/contacts.h"

#include "gravity.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace iota {
namespace {

constexpr double step_of_pairs = 1.0 / 120;

System make_world(IntegrationMode mode = IntegrationMode::energy_keeping, double friction = 0.5) {
  System system;
  system.set_mode(mode);
  system.set_usual_material(Material{friction});
  const BodyId ground = system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, {}, {});
  system.bodies().set_material(ground, Material{friction});
  return system;
}
int run_all(System& system, double seconds, double h = step_of_pairs) {
  int unsolved = 0;
  for (int i = 0; i < static_cast<int>(std::lround(seconds / h)); ++i) unsolved += system.step(h).unconverged;
  return unsolved;
}
/// Cubes on each other, each a little aside; the last one of another density.
std::vector<BodyId> make_tower(System& system, int count, double edge, double shrink, double last_density) {
  std::vector<BodyId> tower;
  double top = 0;
  for (int i = 0; i < count; ++i) {
    const double a = edge * (1 - shrink * i / count);
    const Vec3 position{0.005 * edge * ((i * 7) % 5 - 2), top + a / 2, 0.005 * edge * ((i * 3) % 5 - 2)};
    SolidOptions options{.position = position};
    if (i == count - 1) options.density = last_density;
    tower.push_back(system.bodies().create(Box{{a, a, a}}, options));
    top += a;
  }
  return tower;
}

TEST(ContactPairs, hold_a_tower_of_ten_still) {
  for (const IntegrationMode mode : {IntegrationMode::energy_keeping, IntegrationMode::robust})
    for (const double shrink : {0.0, 0.2}) {
      System system = make_world(mode);
      const std::vector<BodyId> tower = make_tower(system, 10, 0.2, shrink, 1000);
      std::vector<Vec3> before;
      for (const BodyId body : tower) before.push_back(system.bodies().center_of_mass(body));
      EXPECT_EQ(run_all(system, 3), 0);
      for (std::size_t i = 0; i < tower.size(); ++i)
        EXPECT_LT(norm(system.bodies().center_of_mass(tower[i]) - before[i]), 1e-8);
    }
}

TEST(ContactPairs, of_a_tower_that_stands_keep_the_factors_of_an_earlier_step) {
  System system = make_world();
  (void)make_tower(system, 10, 0.2, 0.2, 1000);
  (void)run_all(system, 1);
  int iterations = 0;
  for (int i = 0; i < 100; ++i) {
    (void)system.step(step_of_pairs);
    for (const IslandReport& island : system.islands()) iterations += island.iterations;
  }
  EXPECT_LT(iterations, 50) << "each has a factor of its own";
}

TEST(ContactPairs, carry_a_thousand_times_their_weight) {
  System system = make_world();
  const std::vector<BodyId> tower = make_tower(system, 10, 0.2, 0.2, 1e6);
  const Vec3 before = system.bodies().center_of_mass(tower.back());
  EXPECT_EQ(run_all(system, 3), 0);
  EXPECT_LT(norm(system.bodies().center_of_mass(tower.back()) - before), 1e-6);
  double weight = 0;
  for (const ContactPoint& contact : system.bodies().contacts(tower.back())) weight += contact.force.y;
  EXPECT_NEAR(weight, system.bodies().mass(tower.back()) * g, 1e-5 * weight);
}

TEST(ContactPairs, give_the_other_body_the_opposite_force) {
  System system = make_world();
  const std::vector<BodyId> tower = make_tower(system, 2, 0.2, 0, 1000);
  (void)run_all(system, 0.2);
  Vec3 on_lower, on_upper;
  for (const ContactPoint& contact : system.bodies().contacts(tower[0]))
    if (contact.other == tower[1]) on_lower += contact.force;
  for (const ContactPoint& contact : system.bodies().contacts(tower[1])) on_upper += contact.force;
  EXPECT_NEAR(on_upper.y, system.bodies().mass(tower[1]) * g, 1e-6);
  EXPECT_LT(norm(on_lower + on_upper), 1e-9);
}

struct Totals {
  Vec3 momentum, angular;
};
Totals totals_of(const System& system) {
  Totals sum;
  for (const BodyId body : system.bodies().ids()) {
    const double mass = system.bodies().mass(body);
    const Vec3 v = system.bodies().velocity(body);
    sum.momentum += mass * v;
    sum.angular += mass * cross(system.bodies().center_of_mass(body), v) + system.bodies().angular_momentum(body);
  }
  return sum;
}

TEST(ContactPairs, keep_momentum_and_angular_momentum_of_what_collides) {
  for (const IntegrationMode mode : {IntegrationMode::energy_keeping, IntegrationMode::robust})
    for (unsigned seed = 0; seed < 4; ++seed) {
      SCOPED_TRACE(seed);
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> within(-1, 1);
      const auto any = [&] { return Vec3{within(random), within(random), within(random)}; };
      System system;
      system.set_mode(mode), system.set_gravity({}), system.set_usual_material(Material{0.5});
      for (int i = 0; i < 12; ++i) {
        const Vec3 place = 0.4 * any();
        const double a = 0.06 + 0.03 * within(random);
        const std::vector<Shape> shapes{Sphere{a}, Box{{2 * a, a, 1.5 * a}}, Capsule{a / 2, a}, Cylinder{a, a}};
        const SolidOptions options{.position = place, .velocity = -2.0 * place + 0.3 * any(), .spin = 4.0 * any()};
        (void)system.bodies().create(shapes[static_cast<std::size_t>(i) % 4], options);
      }
      const Totals before = totals_of(system);
      const double tolerance = mode == IntegrationMode::robust ? 1e-7 : 1e-11;
      double energy = system.energy().kinetic;
      for (int i = 0; i < 120; ++i) {
        const StepReport report = system.step(step_of_pairs);
        EXPECT_EQ(report.unconverged, 0) << i;
        EXPECT_LT(report.energy.kinetic, energy * (1 + 1e-3));
        energy = report.energy.kinetic;
      }
      const Totals after = totals_of(system);
      EXPECT_LT(norm(after.momentum - before.momentum), tolerance);
      EXPECT_LT(norm(after.angular - before.angular), tolerance);
    }
}

TEST(ContactPairs, are_not_made_between_solids_that_a_joint_holds_deep_in_each_other) {
  System system;
  system.set_usual_material(Material{0.5});
  const auto add = [&](const Capsule& shape, const Vec3& position, const Quaternion& orientation) {
    return system.bodies().create(shape, SolidOptions{.position = position, .orientation = orientation});
  };
  const Quaternion upright{0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  const BodyId pelvis = add(Capsule{0.1, 0.16}, {}, {});
  for (const double side : {-0.1, 0.1}) {
    const BodyId thigh = add(Capsule{0.07, 0.25}, {side, -0.275, 0}, upright);
    system.bodies().set_velocity(thigh, {0.5 + 4 * side, 0, 0.3});
    (void)system.joints().create(
        JointSpec{.kind = ConstraintKind::ball, .a = pelvis, .b = thigh, .at = {side, -0.1, 0}});
  }
  for (int i = 0; i < 60; ++i) {
    (void)system.step(step_of_pairs);
    ASSERT_TRUE(system.contacts().points().empty()) << "in step " << i;
  }
}

TEST(ContactPairs, let_a_ball_pass_its_speed_on_as_inelastic_impacts_do) {
  System system;
  system.set_gravity({}), system.set_usual_material(Material{0});
  const BodyId first = system.bodies().create(Sphere{0.1}, {.position = {-0.5, 0, 0}, .velocity = {1, 0, 0}});
  const BodyId second = system.bodies().create(Sphere{0.1}, {});
  double hardest = 0;
  for (int i = 0; i < 120; ++i) hardest = std::max(hardest, system.step(step_of_pairs).impact.speed);
  EXPECT_NEAR(system.bodies().velocity(first).x, 0.5, 1e-9);
  EXPECT_NEAR(system.bodies().velocity(second).x, 0.5, 1e-9);
  EXPECT_NEAR(hardest, 1, 1e-9);
}

TEST(ContactPairs, lets_a_ball_roll_on_a_plank_that_slides_away) {
  System system = make_world(IntegrationMode::energy_keeping, 0);  // the ground is smooth
  const BodyId plank = system.bodies().create(Box{{4, 0.1, 1}}, {.density = 100, .position = {0, 0.05, 0}});
  const BodyId ball =
      system.bodies().create(Sphere{0.1}, {.density = 2000, .position = {-1, 0.2, 0}, .velocity = {1, 0, 0}});
  system.bodies().set_material(plank, Material{0.5}), system.bodies().set_material(ball, Material{0.5});
  system.bodies().set_material(system.bodies().obstacles()[0], Material{0});
  const double m = system.bodies().mass(ball), all = m + system.bodies().mass(plank);
  EXPECT_EQ(run_all(system, 1.5), 0);
  // The impulse J of friction stops the slip: v - J/m - J/M = J R^2/I, with I = 2/5 m R^2.
  const double impulse = 1 / (1 / m + 1 / (all - m) + 2.5 / m);
  EXPECT_NEAR(system.bodies().velocity(ball).x, 1 - impulse / m, 2e-3);
  EXPECT_NEAR(system.bodies().velocity(plank).x, impulse / (all - m), 2e-3 * m / (all - m));
}

TEST(ContactPairs, are_none_between_bodies_that_are_joined) {
  System system = make_world();
  system.set_gravity({});
  const BodyId a = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 1, 0}});
  const BodyId b = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0.19, 1, 0}});
  const ParticleId p = system.bodies().create_attachment(a, {0.095, 1, 0});
  const ParticleId q = system.bodies().create_attachment(b, {0.095, 1, 0});
  (void)system.edits().combine(p, q);
  (void)run_all(system, 0.2);
  EXPECT_LT(norm(system.bodies().center_of_mass(a) - Vec3{0, 1, 0}), 1e-12);
  EXPECT_TRUE(system.bodies().contacts(a).empty());
}

TEST(ContactPairs, are_with_what_the_materials_of_both_say) {
  for (const Touches touches : {Touches::all, Touches::obstacles, Touches::nothing}) {
    System system = make_world();
    const BodyId lower = system.bodies().create(Box{{1, 0.2, 1}}, {.position = {0, 0.1, 0}});
    const BodyId upper = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 0.3, 0}});
    system.bodies().set_material(upper, Material{0.5, touches});
    (void)run_all(system, 1);
    const double height = system.bodies().center_of_mass(upper).y;
    EXPECT_LT(norm(system.bodies().center_of_mass(lower) - Vec3{0, 0.1, 0}), 1e-8);
    if (touches == Touches::all) EXPECT_NEAR(height, 0.3, 1e-8);
    if (touches == Touches::obstacles) EXPECT_NEAR(height, 0.1, 1e-8);
    if (touches == Touches::nothing) EXPECT_LT(height, -3);
  }
}

TEST(ContactPairs, are_none_between_particles_unless_both_have_materials) {
  for (const bool have_materials : {false, true}) {
    System system = make_world();
    system.set_gravity({}), system.set_usual_radius(0.1);
    BodyId bodies[2];
    for (int i = 0; i < 2; ++i) {
      bodies[i] = system.bodies().create();
      const double side = i == 0 ? -1 : 1;
      const ParticleId particle = system.particles().create(bodies[i], {0.3 * side, 1, 0}, 1);
      system.particles().set_velocity(particle, {-side, 0, 0});
      if (have_materials) system.bodies().set_material(bodies[i], Material{});
    }
    (void)run_all(system, 1);
    const double x = system.bodies().center_of_mass(bodies[0]).x;
    if (have_materials) EXPECT_NEAR(x, -system.bodies().radius(bodies[0]), 1e-6);
    if (!have_materials) EXPECT_NEAR(x, 0.7, 1e-9);
  }
}

TEST(ContactPairs, let_a_scripted_body_push_others) {
  System system = make_world();
  const BodyId pusher = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {-0.3, 0.1, 0}});
  const BodyId box = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 0.1, 0}});
  system.bodies().set_kind(pusher, BodyKind::scripted);
  for (int i = 0; i < 120; ++i) {
    system.bodies().set_pose(pusher, {-0.3 + 0.005 * (i + 1), 0.1, 0}, {});
    (void)system.step(step_of_pairs);
  }
  EXPECT_GT(system.bodies().center_of_mass(box).x, 0.3 + 0.2 - 0.01);
  EXPECT_NEAR(system.bodies().center_of_mass(box).y, 0.1, 1e-3);
}

TEST(ContactPairs, wake_a_tower_that_sleeps_when_something_falls_on_it) {
  System system = make_world();
  system.set_rest({.after = 0.3, .speed = 0.01});
  const std::vector<BodyId> tower = make_tower(system, 3, 0.2, 0, 1000);
  (void)run_all(system, 1);
  EXPECT_EQ(system.bodies().kind(tower[2]), BodyKind::resting);
  const BodyId ball = system.bodies().create(Sphere{0.1}, {.position = {0.02, 1.2, 0}});
  (void)run_all(system, 0.4);
  EXPECT_EQ(system.bodies().kind(tower[2]), BodyKind::dynamic);
  EXPECT_GT(system.bodies().center_of_mass(ball).y, 0.55);
  system.bodies().destroy(tower[0]);
  (void)run_all(system, 1);
  EXPECT_LT(system.bodies().center_of_mass(tower[1]).y, 0.3 - 0.05);
}

TEST(ContactPairs, go_on_with_the_same_bits_after_a_restored_snapshot) {
  System system = make_world();
  (void)make_tower(system, 4, 0.2, 0, 1000);
  (void)system.bodies().create(Sphere{0.1}, {.position = {0.05, 1.5, 0.02}});
  (void)run_all(system, 0.5);
  const Snapshot snapshot = system.snapshot();
  System other;
  other.restore(snapshot);
  system.restore(snapshot);
  (void)run_all(system, 0.5), (void)run_all(other, 0.5);
  for (const BodyId body : system.bodies().ids())
    EXPECT_EQ(system.bodies().center_of_mass(body), other.bodies().center_of_mass(body));
}

TEST(ContactPairs, are_found_by_lists_that_are_kept_as_by_lists_made_anew) {
  System system = make_world();
  system.set_rest({.after = 0.1, .speed = 0.02});
  std::mt19937 random(11);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Bodies bodies = system.bodies();
  for (int i = 0; i < 24; ++i)
    (void)bodies.create(Box{{0.2, 0.2, 0.2}}, {.position = {number(-1, 1), number(0.2, 3), number(-1, 1)}});
  std::size_t most_resting = 0, contacts = 0;
  for (int i = 0; i < 400; ++i) {
    const std::vector<BodyId> all = bodies.ids();
    const BodyId body = all[1 + random() % (all.size() - 1)];
    try {
      switch (random() % 40) {
        case 0: bodies.set_kind(body, BodyKind::resting); break;
        case 1: bodies.set_kind(body, BodyKind::dynamic); break;
        case 2:
          bodies.set_kind(body, bodies.kind(body) == BodyKind::inactive ? BodyKind::dynamic : BodyKind::inactive);
          break;
        case 3: bodies.set_material(body, bodies.material(body) ? std::optional<Material>() : Material{0.4}); break;
        case 4: bodies.set_stride(body, 0); break;
        case 5: bodies.set_stride(body, 1); break;
        case 6: bodies.set_velocity(body, {number(-2, 2), number(0, 3), number(-2, 2)}); break;
        case 7: bodies.destroy(body); break;
        case 8: (void)bodies.create(Sphere{0.1}, {.position = {number(-1, 1), 2, number(-1, 1)}}); break;
        case 9:
          bodies.set_kind(body, bodies.kind(body) == BodyKind::static_ ? BodyKind::dynamic : BodyKind::static_);
          break;
        default: break;
      }
    } catch (const std::invalid_argument&) {  // what is inactive does not rest, for example
    }
    System fresh;
    fresh.restore(system.snapshot());
    const StepReport kept = system.step(step_of_pairs), anew = fresh.step(step_of_pairs);
    ASSERT_EQ(kept.impact.speed, anew.impact.speed) << "step " << i;
    most_resting = std::max<std::size_t>(most_resting, kept.resting);
    for (const BodyId each : bodies.ids()) {
      ASSERT_EQ(bodies.contacts(each).size(), fresh.bodies().contacts(each).size()) << "step " << i;
      ASSERT_EQ(bodies.center_of_mass(each), fresh.bodies().center_of_mass(each)) << "step " << i;
      contacts += bodies.contacts(each).size();
    }
  }
  EXPECT_GT(most_resting, 10u);
  EXPECT_GT(contacts, 4000u);
}

TEST(ContactPairs, stand_at_the_edge_of_a_table_and_fall_beyond_it) {
  for (const double overhang : {0.045, 0.055}) {
    System system = make_world();
    const BodyId table = system.bodies().create_obstacle(Box{{1, 0.5, 1}}, {0, 0.25, 0}, {});
    system.bodies().set_material(table, Material{0.5});
    const BodyId box = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0.4 + overhang + 0.05, 0.6, 0}});
    EXPECT_EQ(run_all(system, 2), 0);
    const double height = system.bodies().center_of_mass(box).y;
    if (overhang < 0.05) EXPECT_NEAR(height, 0.6, 1e-6);
    if (overhang > 0.05) EXPECT_LT(height, 0.2);
  }
}

}  // namespace
}  // namespace iota
