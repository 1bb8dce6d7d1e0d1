// SPDX-License-Identifier: Apache-2.0
// Heaps whose contacts are solved one by one: judged from places, velocities and momenta, beside the equations of all contacts.
#include "solver/heap.h"

#include "gravity.h"
#include "math/mat3.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace iota {
namespace {

enum class Way { exact, sweeps };

System make_heap_world(Way way, const Vec3& gravity = {0, -9.81, 0}) {
  System system({.gravity = gravity});
  StepBudget budget = system.budget();
  budget.contacts = way == Way::exact ? 0 : 1;
  system.set_budget(budget);
  system.set_usual_material(Material{0.5});
  if (gravity != Vec3{}) {
    const BodyId ground = system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, {}, {});
    system.bodies().set_material(ground, Material{0.5});
  }
  return system;
}
BodyId add_cube(System& system, const Vec3& position, double edge = 0.2) {
  return system.bodies().create(Box{{edge, edge, edge}}, SolidOptions{.position = position});
}
std::vector<BodyId> add_pyramid(System& system, int rows, double edge = 0.2) {
  std::vector<BodyId> all;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < rows - y; ++x)
      all.push_back(add_cube(system, {1.05 * edge * (x - 0.5 * (rows - y - 1)), edge * (y + 0.5), 0}, edge));
  return all;
}
std::vector<Vec3> centers_of(const System& system, const std::vector<BodyId>& bodies) {
  std::vector<Vec3> all;
  for (const BodyId body : bodies) all.push_back(system.bodies().center_of_mass(body));
  return all;
}
double largest_way(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  double most = 0;
  for (std::size_t i = 0; i < from.size(); ++i) most = std::max(most, norm(to[i] - from[i]));
  return most;
}

TEST(Heap, by_sweeps_stands_as_a_pyramid_at_any_size) {
  for (const double edge : {0.002, 0.2, 20.0}) {
    System system = make_heap_world(Way::sweeps, {0, -9.81 * edge / 0.2, 0});
    const std::vector<BodyId> pyramid = add_pyramid(system, 6, edge);
    const std::vector<Vec3> before = centers_of(system, pyramid);
    for (int i = 0; i < 120; ++i) EXPECT_EQ(system.step(1.0 / 60).approximate, 1);
    EXPECT_LT(largest_way(before, centers_of(system, pyramid)), 0.01 * edge) << edge;
  }
}

TEST(Heap, by_sweeps_keeps_momentum_and_angular_momentum_of_what_collides_in_space) {
  System system = make_heap_world(Way::sweeps, {});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<BodyId> all;
  for (int i = 0; i < 12; ++i) {
    const Vec3 place{0.5 * (i % 3) + 0.05 * u(random), 0.5 * (i / 3 % 2), 0.5 * (i / 6)};
    const BodyId body = i % 3 == 0   ? add_cube(system, place)
                        : i % 3 == 1 ? system.bodies().create(Sphere{0.1}, SolidOptions{.position = place})
                                     : system.bodies().create(Capsule{0.08, 0.2}, SolidOptions{.position = place});
    system.bodies().set_velocity(body,
                                 -2 * (place - Vec3{0.5, 0.25, 0.25}) + 0.3 * Vec3{u(random), u(random), u(random)});
    system.bodies().set_angular_velocity(body, 5 * Vec3{u(random), u(random), u(random)});
    all.push_back(body);
  }
  const auto momenta = [&] {
    Vec3 p, l;
    for (const BodyId body : all) {
      const double m = system.bodies().mass(body);
      const Vec3 v = system.bodies().velocity(body), c = system.bodies().center_of_mass(body);
      p += m * v, l += system.bodies().angular_momentum(body) + m * cross(c, v);
    }
    return std::pair(p, l);
  };
  const auto [p, l] = momenta();
  const double energy = system.energy().kinetic;
  int approximate = 0;
  for (int i = 0; i < 120; ++i) approximate += system.step(1.0 / 120).approximate;
  EXPECT_GT(approximate, 0);
  const auto [q, k] = momenta();
  EXPECT_LT(norm(q - p), 1e-9 * norm(l));
  EXPECT_LT(norm(k - l), 1e-9 * norm(l));
  EXPECT_LT(system.energy().kinetic, energy);
}

TEST(Heap, by_sweeps_slides_and_rolls_as_the_equations_of_all_contacts) {
  const auto run = [](Way way) {
    System system = make_heap_world(way);
    // Pairs, so that the sweeps are not of one body: a plank on which a ball is, and a box behind it.
    const BodyId plank = system.bodies().create(Box{{2, 0.1, 0.5}}, SolidOptions{.position = {0, 0.05, 0}});
    const BodyId ball = system.bodies().create(Sphere{0.1}, SolidOptions{.position = {-0.5, 0.2, 0}});
    const BodyId box = add_cube(system, {0.5, 0.2, 0});
    system.bodies().set_velocity(ball, {1, 0, 0});
    system.bodies().set_velocity(box, {1.5, 0, 0});
    for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 120);
    return centers_of(system, {plank, ball, box});
  };
  const std::vector<Vec3> exact = run(Way::exact), swept = run(Way::sweeps);
  EXPECT_LT(largest_way(exact, swept), 1e-2);
  EXPECT_GT(exact[1].x, -0.2);
}

TEST(Heap, is_chosen_where_the_factor_would_take_more_than_the_budget) {
  System system = make_heap_world(Way::exact);
  add_pyramid(system, 5);
  EXPECT_EQ(system.step(1.0 / 60).approximate, 0);
  StepBudget budget = system.budget();
  budget.contacts = 1e9;
  system.set_budget(budget);
  EXPECT_EQ(system.step(1.0 / 60).approximate, 0);
  budget.contacts = 1e4;
  system.set_budget(budget);
  EXPECT_EQ(system.step(1.0 / 60).approximate, 1);
}

// A body that was hinged to the world where it lay had rows that contradict each other, in each step from then on.
TEST(Heap, leaves_overlaps_that_a_hinge_may_hold_as_they_are) {
  for (int k = 0; k < 3; ++k) {
    System system = make_heap_world(Way::sweeps);
    std::vector<BodyId> tower;
    for (int y = 0; y < 3; ++y) tower.push_back(add_cube(system, {0, 0.2 * y + 0.1, 0}));
    for (int i = 0; i < 30; ++i) (void)system.step(1.0 / 60);
    StepBudget budget = system.budget();
    budget.contacts = 1e9;
    system.set_budget(budget);
    const Vec3 at = system.bodies().center_of_mass(tower[k]);
    (void)system.joints().create(JointSpec{.a = tower[k], .at = at, .axis = {0, 1, 0}});
    for (int i = 0; i < 10; ++i) {
      const StepReport report = system.step(1.0 / 60);
      EXPECT_EQ(report.unconverged + report.approximate, 0) << k;
      EXPECT_LT(report.energy.made, 1e-6) << k;
    }
    EXPECT_LT(norm(system.bodies().center_of_mass(tower[k]) - at), 1e-9) << k;
  }
}

TEST(Heap, by_sweeps_follows_a_hand_and_a_moving_floor) {
  System system = make_heap_world(Way::sweeps);
  const BodyId floor = add_cube(system, {0, 0.5, 0}, 0.6);
  system.bodies().set_kind(floor, BodyKind::scripted);
  const BodyId low = add_cube(system, {0, 0.9, 0}), high = add_cube(system, {0, 1.1, 0});
  for (int i = 0; i < 120; ++i) {
    system.bodies().set_pose(floor, {0.2 * (i + 1) / 120.0, 0.5, 0}, {});
    (void)system.step(1.0 / 120);
  }
  const double slipped = 0.2 * 0.2 / (2 * 0.5 * 9.81);  // until it has the speed of the floor
  EXPECT_NEAR(system.bodies().center_of_mass(low).x, 0.2 - slipped, 2e-3);
  EXPECT_NEAR(system.bodies().center_of_mass(high).y, 1.1, 2e-3);
  const GripId grip = system.grips().create(high, {}, {0.2, 1.1, 0});
  for (int i = 0; i < 240; ++i) {
    system.grips().move(grip, {0.2, 1.5, 0});
    (void)system.step(1.0 / 120);
  }
  EXPECT_NEAR(system.bodies().center_of_mass(high).y, 1.5, 0.05);
  EXPECT_NEAR(system.bodies().center_of_mass(low).y, 0.9, 2e-3);
}

TEST(Heap, that_falls_is_solved_in_each_step_and_restored_with_the_same_bits) {
  System system = make_heap_world(Way::sweeps);
  StepBudget budget = system.budget();
  budget.contacts = 3e5;
  system.set_budget(budget);
  for (int i = 0; i < 24; ++i)
    add_cube(system, {0.21 * (i % 2), 0.12 + 0.22 * (i / 4), 0.21 * (i / 2 % 2)}, 0.15 + 0.002 * i);
  int approximate = 0;
  for (int i = 0; i < 30; ++i) {
    const StepReport report = system.step(1.0 / 60);
    EXPECT_EQ(report.unconverged, 0);
    approximate += report.approximate;
  }
  EXPECT_GT(approximate, 0);
  System copy;
  copy.restore(system.snapshot());
  for (int i = 0; i < 20; ++i) (void)system.step(1.0 / 60), (void)copy.step(1.0 / 60);
  EXPECT_EQ(system.snapshot().bytes, copy.snapshot().bytes);
}

/// Cubes and balls of 5 to 10 cm that fall into a box 0.8 m wide, and how deep they are in each other and in the box: by
/// separating axes, from places and turns alone.
class FallingHeap {
 public:
  FallingHeap(System& system, int count, unsigned seed) : system_(system) {
    constexpr double wide = 0.8, pitch = 0.15;
    constexpr int each = 5;
    const auto add_wall = [&](const Vec3& size, const Vec3& at) {
      system.bodies().set_material(system.bodies().create_obstacle(Box{size}, at, {}), Material{0.5});
    };
    add_wall({wide + 1, 0.5, wide + 1}, {0, -0.25, 0});
    for (const double side : {1.0, -1.0}) {
      add_wall({0.5, 6, wide + 1}, {side * (wide + 0.5) / 2, 3, 0});
      add_wall({wide + 1, 6, 0.5}, {0, 3, side * (wide + 0.5) / 2});
    }
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> sizes(0.05, 0.1);
    std::normal_distribution<double> normal;
    for (int k = 0; k < count; ++k) {
      const double size = sizes(random);
      const int rest = k % (each * each);
      const Vec3 at{pitch * (rest % each - 2), 0.1 + pitch * (k / (each * each)), pitch * (rest / each - 2)};
      const Quaternion turn = normalized(Quaternion{normal(random), normal(random), normal(random), normal(random)});
      const SolidOptions options{.position = at, .orientation = turn};
      const bool is_ball = k % 2 == 1;
      things_.push_back({is_ball ? system.bodies().create(Sphere{size / 2}, options)
                                 : system.bodies().create(Box{{size, size, size}}, options),
                         is_ball, size / 2});
    }
  }
  double overlap() const {
    constexpr double wall = 0.4;
    double deepest = 0;
    for (const Thing& a : things_) {
      const Pose pose = pose_of(a);
      for (const Vec3& outward : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}})
        deepest = std::max(deepest, dot(outward, pose.center) + a.reach_along(pose, outward) - wall);
      deepest = std::max(deepest, a.reach_along(pose, {0, -1, 0}) - pose.center.y);
      for (const Thing& b : things_)
        if (&a < &b) deepest = std::max(deepest, overlap(a, pose, b, pose_of(b)));
    }
    return deepest;
  }

 private:
  struct Pose {
    Vec3 center;
    std::array<Vec3, 3> axes;
  };
  struct Thing {
    BodyId body;
    bool is_ball;
    double half;
    double reach_along(const Pose& pose, const Vec3& n) const {
      double sum = is_ball ? half : 0;
      for (const Vec3& axis : pose.axes) sum += is_ball ? 0 : half * std::abs(dot(axis, n));
      return sum;
    }
  };
  Pose pose_of(const Thing& thing) const {
    const Quaternion turn = system_.bodies().orientation(thing.body);
    return {system_.bodies().center_of_mass(thing.body),
            {rotate(turn, {1, 0, 0}), rotate(turn, {0, 1, 0}), rotate(turn, {0, 0, 1})}};
  }
  static double overlap(const Thing& a, const Pose& pa, const Thing& b, const Pose& pb) {
    const Vec3 way = pb.center - pa.center;
    if (norm(way) > 1.74 * (a.half + b.half)) return 0;
    if (a.is_ball && !b.is_ball) return overlap(b, pb, a, pa);
    double least = std::numeric_limits<double>::infinity();
    const auto look = [&](const Vec3& direction) {
      const double length = norm(direction);
      if (length < 1e-3) return;
      const Vec3 n = (1 / length) * direction;
      least = std::min(least, a.reach_along(pa, n) + b.reach_along(pb, n) - std::abs(dot(n, way)));
    };
    if (b.is_ball) {  // against the nearest place of the box, or the center of a ball
      Vec3 nearest;
      for (const Vec3& axis : pa.axes) nearest += std::clamp(dot(axis, way), -a.half, a.half) * axis;
      look(a.is_ball ? way : way - nearest);
    }
    if (!a.is_ball)
      for (const Vec3& axis : pa.axes) look(axis);
    if (b.is_ball) return least;
    for (const Vec3& axis : pb.axes) look(axis);
    for (const Vec3& u : pa.axes)
      for (const Vec3& v : pb.axes) look(cross(u, v));
    return least;
  }

  System& system_;
  std::vector<Thing> things_;
};

TEST(Heap, by_sweeps_falls_into_a_box_with_small_overlaps_though_corners_swing_far_in_a_step) {
  System system = make_heap_world(Way::sweeps, {});
  system.set_gravity({0, -9.81, 0});
  const FallingHeap heap(system, 60, 1);
  for (int i = 0; i < 90; ++i) {
    (void)system.step(1.0 / 60);
    ASSERT_LT(heap.overlap(), 4e-3) << "step " << i;
  }
}

TEST(Heap, of_two_hundred_that_fall_pushes_out_what_was_pressed_into_others) {
  System system = make_heap_world(Way::sweeps, {});
  system.set_gravity({0, -9.81, 0});
  system.set_budget({});
  const FallingHeap heap(system, 200, 1);
  for (int i = 0; i < 90; ++i) (void)system.step(1.0 / 60);
  EXPECT_LT(heap.overlap(), 4e-3);
}

TEST(Heap, by_sweeps_makes_no_energy_of_thin_rods_that_spin_many_times_in_a_step) {
  std::mt19937 random(2);
  const auto number = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  for (int round = 0; round < 20; ++round) {
    System system = make_heap_world(Way::sweeps);
    system.set_gravity({});
    const BodyId rod = system.bodies().create(Cylinder{0.004, 0.08},
                                              {.position = {0, 0.005, 0},
                                               .orientation = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)},
                                               .velocity = {number(-20, 20), number(-5, 0), number(-20, 20)},
                                               .spin = {number(-500, 500), number(-500, 500), number(-2000, 2000)}});
    const double before = system.energy().kinetic;
    for (int i = 0; i < 20; ++i) {
      (void)system.step(1.0 / 60);
      ASSERT_LE(system.energy().kinetic, before * (1 + 1e-6)) << round << ", step " << i;
    }
    EXPECT_LT(norm(system.bodies().velocity(rod)), 100);
  }
}

}  // namespace
}  // namespace iota
