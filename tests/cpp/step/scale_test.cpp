// SPDX-License-Identifier: Apache-2.0
// The same scene in other sizes, masses and places, and at sizes at which shortcuts show.
#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace iota {
namespace {

constexpr IntegrationMode modes[] = {IntegrationMode::plausible, IntegrationMode::robust,
                                     IntegrationMode::energy_keeping};

/// Links on a line from `top` on, hinged; the first is nailed.
struct Row {
  std::vector<ParticleId> upper, lower;  ///< of each link

  template <class MassOf>
  Row(System& system, int links, const Vec3& top, double length, MassOf mass_of) {
    for (int i = 0; i < links; ++i) {
      const BodyId body = system.bodies().create();
      const double half = mass_of(i) / 2;
      upper.push_back(system.particles().create(body, top + Vec3{i * length, 0, 0}, half));
      const ParticleId end = system.particles().create(body, top + Vec3{(i + 1) * length, 0, 0}, half);
      if (i > 0) (void)system.edits().combine(lower.back(), upper.back());
      lower.push_back(end);
    }
    system.particles().nail(upper.front());
  }
  Vec3 end(const System& system) const { return system.particles().position(lower.back()); }
  /// The longest and the shortest link, as multiples of `length`.
  std::pair<double, double> extremes(const System& system, double length) const {
    std::pair<double, double> found{0, 1e300};
    for (std::size_t i = 0; i < upper.size(); ++i) {
      const double l = norm(system.particles().position(lower[i]) - system.particles().position(upper[i])) / length;
      found = {std::max(found.first, l), std::min(found.second, l)};
    }
    return found;
  }
};

/// Where a zigzag of links with a ball on a spring is after half a second, lengths, masses and times in the given units.
std::vector<Vec3> swing_in_units(double length, double mass, IntegrationMode mode) {
  const double time = std::sqrt(length);  // gravity stays
  System system({.mode = mode});
  std::vector<ParticleId> points;
  const auto joint = [&](int i) { return length * Vec3{0.1 * i, 0.05 * (i % 2), 0}; };
  for (int i = 0; i < 8; ++i) {
    const BodyId body = system.bodies().create();
    const ParticleId upper = system.particles().create(body, joint(i), 0.05 * mass);
    const ParticleId lower = system.particles().create(body, joint(i + 1), 0.05 * mass);
    if (i > 0)
      (void)system.edits().combine(points.back(), upper);
    else
      system.particles().nail(upper);
    points.push_back(lower);
  }
  points.push_back(system.particles().create(system.bodies().create(), length * Vec3{0.9, 0.1, 0}, 0.1 * mass));
  system.bonds().create(points[7], points[8], SpringLaw{.stiffness = 50 * mass / length});
  for (int step = 0; step < 60; ++step) (void)system.step(time / 120);
  std::vector<Vec3> places;
  for (const ParticleId p : points) places.push_back((1 / length) * system.particles().position(p));
  return places;
}

TEST(Scale, of_lengths_and_masses_changes_nothing_but_the_units) {
  for (const IntegrationMode mode : modes) {
    const std::vector<Vec3> usual = swing_in_units(1, 1, mode);
    for (const auto& [length, mass] : {std::pair{1e-9, 1e-12}, {1e-6, 1e6}, {1e-3, 1.0}, {1e3, 1e-6}, {1e4, 1e12}}) {
      const std::vector<Vec3> scaled = swing_in_units(length, mass, mode);
      for (std::size_t i = 0; i < usual.size(); ++i)
        EXPECT_LT(norm(scaled[i] - usual[i]), 1e-6) << "unit of length " << length << ", of mass " << mass;
    }
  }
}

/// Where two chains are that are brought together while the wall that holds one of them is moved by the script.
std::vector<Vec3> edit_in_units(double length, double mass, IntegrationMode mode) {
  const double time = std::sqrt(length);
  System system({.mode = mode});
  const BodyId wall = system.bodies().create({.kind = BodyKind::static_});
  const ParticleId hook = system.particles().create(wall, {}, mass);
  std::vector<ParticleId> points{hook};
  const auto hang = [&](Vec3 from, int links) {
    ParticleId last;
    for (int i = 0; i < links; ++i) {
      const BodyId body = system.bodies().create();
      const Vec3 to = from + Vec3{0.1 * length, (i % 2 ? -0.02 : 0.02) * length, 0};
      const ParticleId upper = system.particles().create(body, from, mass),
                       lower = system.particles().create(body, to, mass);
      if (i > 0) (void)system.edits().combine(last, upper);
      points.push_back(upper), points.push_back(lower);
      last = lower, from = to;
    }
    return last;
  };
  const ParticleId end = hang({}, 3);
  (void)system.edits().combine(hook, points[1]);
  const std::size_t other = points.size();
  (void)hang({0.5 * length, 0.1 * length, 0}, 3);
  (void)system.edits().combine(end, points[other], 0.2 * time);
  for (int step = 0; step < 60; ++step) {
    if (step == 30) system.particles().set_position(hook, {0, 0.03 * length, 0});
    (void)system.step(time / 120);
  }
  std::vector<Vec3> places;
  for (const ParticleId p : points) places.push_back((1 / length) * system.particles().position(p));
  return places;
}

/// Two boxes on a hinge with stop, motor and friction, a rope with a weight and a dashpot, in the given units.
std::vector<Vec3> run_machine_in_units(double length, double mass, IntegrationMode mode) {
  const double time = std::sqrt(length), torque = mass * length;  // gravity stays, so forces are like masses
  System system({.mode = mode});
  const auto box = [&](Vec3 at) {
    return system.bodies().create(Box{length * Vec3{0.2, 0.1, 0.3}}, {.mass = mass, .position = length * at});
  };
  const BodyId arm = box({0.1, 0, 0}), hand = box({0.3, 0, 0});
  const Vec3 axis{0, 0, 1};
  (void)system.joints().create(JointSpec{
      .kind = ConstraintKind::revolute, .a = arm, .at = {}, .axis = axis, .angle = {.lower = -0.7, .upper = 0.3}});
  (void)system.joints().create(
      JointSpec{.kind = ConstraintKind::revolute,
                .a = arm,
                .b = hand,
                .at = length * Vec3{0.2, 0, 0},
                .axis = axis,
                .angle = {.motor_speed = 2 / time, .motor_max = 0.5 * torque, .friction = 0.1 * torque}});
  const ParticleId end = system.bodies().create_attachment(hand, length * Vec3{0.4, 0, 0});
  const ParticleId weight =
      system.particles().create(system.bodies().create(), length * Vec3{0.5, -0.1, 0}, 0.5 * mass);
  (void)system.joints().create(
      DistanceSpec{.kind = ConstraintKind::rope, .p = end, .q = weight, .length = 0.2 * length});
  (void)system.bonds().create(end, weight, SpringLaw{.stiffness = mass / length, .damping = 0.2 * mass / time});
  for (int step = 0; step < 90; ++step) (void)system.step(time / 120);
  return {(1 / length) * system.particles().position(end), (1 / length) * system.particles().position(weight)};
}

/// Powers of two leave all digits as they are, and so all results, if no limit anywhere is in units.
TEST(Scale, of_lengths_and_masses_changes_no_digit_of_an_edited_world) {
  for (const IntegrationMode mode : modes) {
    const std::vector<Vec3> usual = edit_in_units(1, 1, mode);
    for (const auto& [length, mass] : {std::pair{0x1p-30, 0x1p-40}, {0x1p-20, 0x1p20}, {0x1p10, 0x1p-20}})
      EXPECT_EQ(edit_in_units(length, mass, mode), usual)
          << "unit of length " << length << ", of mass " << mass << ", mode " << static_cast<int>(mode);
    const std::vector<Vec3> machine = run_machine_in_units(1, 1, mode);
    for (const auto& [length, mass] : {std::pair{0x1p-24, 0x1p-40}, {0x1p-20, 0x1p20}, {0x1p10, 0x1p-20}})
      EXPECT_EQ(run_machine_in_units(length, mass, mode), machine)
          << "unit of length " << length << ", of mass " << mass << ", mode " << static_cast<int>(mode);
  }
}

TEST(Scale, of_masses_over_twelve_decades_leaves_joints_closed) {
  for (const IntegrationMode mode : modes)
    for (const double ratio : {1e8, 1e10, 1e12})
      for (const bool falling : {false, true}) {
        System system({.mode = mode});
        const Row row(system, 20, {0, 2, 0}, 0.1,
                      [&](int i) { return std::pow(ratio, (falling ? 19 - i : i) / 19.0 - 0.5); });
        double gap = 0;
        for (int step = 0; step < 120; ++step) gap = std::max(gap, system.step(1.0 / 60).worst_gap);
        EXPECT_LT(gap, 2e-7) << "ratio " << ratio << (falling ? ", heavy end first" : ", light end first");
      }
}

// Positions are doubles: at 1e7 m they are 2e-9 m apart.
// A link that is a hundred thousandth of its neighbors moves like a ball of its mass in their joint.
TEST(Scale, of_lengths_over_five_decades_lets_a_tiny_link_move_like_a_ball) {
  constexpr int links = 20, tiny_at = 10;
  constexpr double length = 0.1, mass = 0.01, tiny = 1e-6;
  for (const IntegrationMode mode : modes) {
    std::vector<Vec3> ends;
    for (const bool is_ball : {false, true}) {
      System system({.mode = mode});
      double at = 0;
      ParticleId before, tiny_ends[2];
      for (int i = 0; i < links; ++i) {
        const BodyId body = system.bodies().create();
        if (is_ball && i == tiny_at) {
          (void)system.edits().combine(before, system.particles().create(body, {at, 0, 0}, mass));
          continue;
        }
        const ParticleId upper = system.particles().create(body, {at, 0, 0}, mass / 2);
        at += i == tiny_at ? tiny : length;
        const ParticleId lower = system.particles().create(body, {at, 0, 0}, mass / 2);
        if (i > 0)
          (void)system.edits().combine(before, upper);
        else
          system.particles().nail(upper);
        if (i == tiny_at) tiny_ends[0] = upper, tiny_ends[1] = lower;
        before = lower;
      }
      for (int step = 0; step < 30; ++step) {
        const StepReport report = system.step(1.0 / 60);
        EXPECT_EQ(report.energy.made, 0) << step;
        EXPECT_EQ(report.unconverged, 0) << step;
      }
      ends.push_back(system.particles().position(before));
      if (is_ball) continue;
      EXPECT_NEAR(norm(system.particles().position(tiny_ends[1]) - system.particles().position(tiny_ends[0])) / tiny, 1,
                  1e-3);
    }
    EXPECT_LT(norm(ends[1] - ends[0]), 1e-3);  // energy-keeping steps of so small a link fall back to robust ones
  }
}

TEST(Scale, of_a_link_below_a_millionth_of_its_neighbors_makes_it_a_point_between_them) {
  for (const IntegrationMode mode : modes)
    for (const double tiny : {1e-7, 1e-8, 1e-10, 1e-12, 1e-16}) {
      System system({.gravity = {}, .mode = mode});
      Row row(system, 2, {}, 0.1, [](int) { return 2.0; });
      system.particles().release(row.upper.front());
      const BodyId needle = system.bodies().create(), last = system.bodies().create();
      const ParticleId from = system.particles().create(needle, {0.2, 0, 0}),
                       to = system.particles().create(needle, {0.2 + tiny, 0, 0}),
                       next = system.particles().create(last, {0.2 + tiny, 0, 0}),
                       end = system.particles().create(last, {0.3 + tiny, 0, 0});
      (void)system.edits().combine(row.lower.back(), from);
      (void)system.edits().combine(to, next);
      for (const ParticleId p : system.particles().ids()) system.particles().set_velocity(p, {1, 0, 0});
      system.particles().set_velocity(end, {1, 3, 1});
      (void)system.step(1e-6);
      const Vec3 momentum = system.momentum(), angular = system.angular_momentum();
      for (int step = 0; step < 60; ++step) EXPECT_EQ(system.step(1.0 / 60).unconverged, 0) << tiny;
      EXPECT_LT(norm(system.momentum() - momentum), 1e-9) << tiny;
      EXPECT_LT(norm(system.angular_momentum() - angular), 1e-6) << tiny;
      EXPECT_TRUE(system.validate().empty());
    }
}

TEST(Scale, of_places_to_ten_million_meters_lets_a_chain_swing_as_at_home) {
  for (const IntegrationMode mode : modes) {
    std::vector<Vec3> ends;
    for (const double far : {0.0, 1e5, 1e7}) {
      System system({.mode = mode});
      const Row row(system, 50, {far, -far, 0}, 0.02, [](int) { return 0.01; });
      const double start = system.energy().total();
      int failed = 0;
      double kinetic = 0;
      for (int step = 0; step < 60; ++step) {
        const StepReport report = system.step(1.0 / 120);
        failed += report.unconverged + report.fallbacks;
        kinetic = std::max(kinetic, report.energy.kinetic);
      }
      EXPECT_EQ(failed, 0) << far;
      if (mode == IntegrationMode::energy_keeping)
        EXPECT_NEAR(system.energy().total(), start, 1e-4 * kinetic + 1e-15 * std::abs(start)) << far;
      ends.push_back(row.end(system) - Vec3{far, -far, 0});
    }
    EXPECT_LT(norm(ends[1] - ends[0]), 1e-6);
    EXPECT_LT(norm(ends[2] - ends[0]), 1e-3);
  }
}

// Both know the distance of the two points from places that were rounded when they were made there.
TEST(Scale, of_places_lets_bodies_that_share_two_points_move_accurately_as_at_home) {
  const auto move = [](const Vec3& home, double width, std::vector<Vec3>& places) {
    System system{SystemOptions{.mode = IntegrationMode::accurate, .tolerance = 1e-8}};
    const auto box = [&](const Vec3& at, const Vec3& spin) {
      return system.bodies().create(
          Box{{0.41, 0.3, 0.23}},
          {.mass = 1, .position = home + at, .orientation = {0.6 * at.x, 0.48, 0.64, 0.8 - at.x}, .spin = spin});
    };
    const BodyId first = box({}, {1, 2, 3}), second = box({0.8, 0.05, 0}, {-2, 1, 4});
    for (const double side : {0.1, 0.1 - width}) {
      const Vec3 at = home + Vec3{0.4, 0.013, side};
      (void)system.edits().combine(system.bodies().create_attachment(first, at),
                                   system.bodies().create_attachment(second, at));
    }
    system.particles().nail(system.bodies().create_attachment(first, home + Vec3{-0.1, 0.1, 0}));
    int substeps = 0;
    for (int i = 0; i < 60; ++i) substeps = std::max(substeps, system.step(1.0 / 120).substeps_max);
    for (const BodyId body : {first, second}) places.push_back(system.bodies().center_of_mass(body) - home);
    return substeps;
  };
  for (const double width : {0.12, 0.15, 0.18, 0.21, 0.24, 0.27}) {
    std::vector<Vec3> at_home;
    const int substeps = move({}, width, at_home);
    for (const double far : {1e5, 1e6}) {
      std::vector<Vec3> places;
      EXPECT_LE(move({far, -far, 0.5 * far}, width, places), substeps + 1) << far << ", " << width;
      for (std::size_t i = 0; i < places.size(); ++i)
        EXPECT_LT(norm(places[i] - at_home[i]), 1e-6) << far << ", " << width << " substeps " << substeps;
    }
  }
}

TEST(Conflict, is_shared_by_all_links_of_a_chain_of_any_length) {
  for (const int links : {2, 20, 50, 100, 400}) {
    System system;
    const double length = 1.0 / links;
    const Row row(system, links, {0, 2, 0}, length, [&](int) { return 1.0 / links; });
    system.particles().nail(row.lower.back(), {1.5, 2, 0});
    int unconverged = 0;
    for (int step = 0; step < 20; ++step) unconverged += system.step(1.0 / 60).unconverged;
    const auto [longest, shortest] = row.extremes(system, length);
    EXPECT_LT(longest, 2) << links << " links, half as long again";
    EXPECT_GT(shortest, 1.1) << links << " links";
    EXPECT_EQ(unconverged, 20) << "reported, step by step";
  }
}

}  // namespace
}  // namespace iota
