// SPDX-License-Identifier: Apache-2.0
// Rows with bounds, springs and holds against closed forms, in both schemes.
#include "shape/shape.h"
#include "solver/integrator.h"
#include "tests/cpp/allocations.h"
#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace iota::solver {
namespace {

class Rows : public testing::TestWithParam<Scheme> {
 protected:
  Problem problem;
  Integrator integrator;
  AdvanceReport total;

  bool exact() const { return GetParam() == Scheme::mid_point; }
  void SetUp() override { problem.gravity = {0, -g, 0}; }
  void start() { integrator.compile(problem); }
  void step(double h) {
    const AdvanceReport report = integrator.advance(problem, h, IntegratorSettings{.scheme = GetParam()});
    ASSERT_TRUE(report.converged);
    EXPECT_EQ(report.fallbacks, 0);
    total.dissipated += report.dissipated, total.lost += report.lost;
    EXPECT_LE(report.made, 1e-5) << "curves and driven angles are no quadratic functions of points";
    total.external_work += report.external_work, total.closing_energy += report.closing_energy;
    total.iterations += report.iterations;
  }
  void run(double seconds, double h) {
    for (int i = 0; i < std::lround(seconds / h); ++i) step(h);
  }
  double energy() const {
    return problem.kinetic_energy() + problem.potential_energy(problem.position.data()) +
           problem.row_energy(problem.position.data(), 1);
  }
};

INSTANTIATE_TEST_SUITE_P(Both, Rows, testing::Values(Scheme::end_point, Scheme::mid_point),
                         [](const auto& info) { return info.param == Scheme::mid_point ? "mid_point" : "end_point"; });

/// A block on a slope of `angle`: downhill is `down`.
struct Slope {
  Vec3 down;
  std::shared_ptr<const shape::Surface> plane;
  explicit Slope(double angle)
      : down{std::cos(angle), -std::sin(angle), 0},
        plane(shape::make_surface(HalfSpace{{std::sin(angle), std::cos(angle), 0}})) {}
};

TEST_P(Rows, hold_a_block_on_a_slope_up_to_the_friction_that_they_have) {
  const double angle = 0.4, pull = 2 * g * std::sin(angle);
  const Slope slope(angle);
  for (const double friction : {1.01 * pull, 0.6 * pull}) {
    problem = Problem{};
    problem.gravity = {0, -g, 0};
    const auto block = add_point(problem, {}, 2);
    SurfaceConstraint surface;
    surface.surface = slope.plane.get();
    surface.set_world_frame({});
    surface.add(0, block, 1);
    add(problem, surface);
    add(problem, along(block, {0, 0, 1}, 0));
    const auto hold = add(problem, along(block, slope.down, 0));
    start();
    *pool<BilinearConstraint>(problem).law(hold) = {.lower = -friction, .upper = friction, .is_rate = true};
    start();
    const double h = 0.01;
    const int steps = 100;
    for (int i = 0; i < steps; ++i) step(h);
    const double way = dot(problem.position[block], slope.down);
    if (friction > pull) {
      EXPECT_NEAR(way, 0, 1e-9);
      EXPECT_NEAR(pool<BilinearConstraint>(problem).multiplier(hold)[0], pull, 1e-5);
    } else {
      const double a = g * std::sin(angle) - friction / 2;
      const double expected = a * h * h * steps * (exact() ? steps : steps + 1) / 2;
      EXPECT_NEAR(way, expected, 1e-9);
    }
  }
}

TEST_P(Rows, make_a_sliding_block_stop_and_stay) {
  const auto block = add_point(problem, {}, 2, {3, 0, 0});
  add(problem, along(block, {0, 1, 0}, 0)), add(problem, along(block, {0, 0, 1}, 0));
  const auto hold = add(problem, along(block, {1, 0, 0}, 0));
  *pool<BilinearConstraint>(problem).law(hold) = {.lower = -5, .upper = 5, .is_rate = true};
  start();
  const double before = energy();
  run(3, 0.005);
  EXPECT_NEAR(problem.position[block].x, 3 * 3 / (2 * 5 / 2.0), exact() ? 2e-3 : 1e-2) << "v^2 / 2a";
  EXPECT_NEAR(problem.velocity[block].x, 0, 1e-9);
  EXPECT_NEAR(total.dissipated + total.lost, before - energy(), 1e-9);
}

TEST_P(Rows, leave_a_slack_rope_alone_and_stop_it_without_a_bounce) {
  const auto hook = add_point(problem, {}), end = add_point(problem, {0.3, 0, 0}, 2);
  nail(problem, hook);
  const auto rope = add(problem, distance(hook, end, 1));
  pool<BilinearConstraint>(problem).law(rope)->lower = 0;
  start();
  const double h = 1.0 / 240;
  for (int i = 0; i < 60; ++i) {
    step(h);
    ASSERT_EQ(pool<BilinearConstraint>(problem).multiplier(rope)[0], 0) << "free fall";
    ASSERT_NEAR(problem.velocity[end].y, -g * h * (i + 1), 1e-9);
  }
  double longest = 0;
  for (int i = 0; i < 4000; ++i) {
    step(h);
    longest = std::max(longest, norm(problem.position[end]));
    ASSERT_GE(pool<BilinearConstraint>(problem).multiplier(rope)[0], -1e-9);
  }
  EXPECT_LE(longest, 1 + 1e-9);
  EXPECT_GT(total.dissipated, 0.1) << "impacts are inelastic";
  EXPECT_LE(energy(), 0.0);
}

TEST_P(Rows, keep_a_taut_rope_swinging_like_a_rod) {
  const auto pendulum = [&](bool rope) {
    problem = Problem{};
    problem.gravity = {0, -g, 0};
    const auto hook = add_point(problem, {}), end = add_point(problem, {std::sin(1.0), -std::cos(1.0), 0}, 2);
    nail(problem, hook);
    const auto row = add(problem, distance(hook, end, 1));
    if (rope) pool<BilinearConstraint>(problem).law(row)->lower = 0;
    start();
    run(2, 1.0 / 120);
    return problem.position[end];
  };
  const Vec3 rod = pendulum(false);
  const double change = energy();
  const Vec3 rope = pendulum(true);
  EXPECT_NEAR(norm(rope - rod), 0, 1e-9);
  EXPECT_NEAR(energy(), change, 1e-9);
}

/// A wheel: two points about a nailed center in the plane z = 0. Its angle is that of the first point.
struct Wheel {
  std::uint32_t hub, rim;
  std::size_t angle;
  Wheel(Problem& problem, double mass) {
    hub = add_point(problem, {}), rim = add_point(problem, {1, 0, 0}, mass);
    nail(problem, hub);
    add(problem, distance(hub, rim, 1));
    add(problem, along(rim, {0, 0, 1}, 0));
    AngleConstraint c;
    c.set_constant(0, {0, 0, 1}), c.set_constant(1, {1, 0, 0});
    c.add(2, hub, -1), c.add(2, rim, 1);
    angle = add(problem, c);
  }
};

TEST_P(Rows, drive_a_wheel_with_capped_torque_up_to_a_motors_speed) {
  problem.gravity = {};
  const Wheel wheel(problem, 2);
  auto& angles = pool<AngleConstraint>(problem);
  *angles.law(wheel.angle) = {.lower = -3, .upper = 3, .rate = 4, .is_rate = true};
  start();
  const double h = 0.005;
  run(1, h);
  EXPECT_NEAR(norm(problem.velocity[wheel.rim]), 3.0 / 2 * 1, 1e-2) << "torque / inertia * time";
  EXPECT_NEAR(angles.multiplier(wheel.angle)[0], -3, 1e-12);
  run(5, h);
  EXPECT_NEAR(norm(problem.velocity[wheel.rim]), 4, 1e-2) << "and no faster";
  EXPECT_NEAR(angles.multiplier(wheel.angle)[0], 0, exact() ? 0.05 : 1) << "backward Euler brakes by itself";
  EXPECT_NEAR(total.external_work, energy() + total.dissipated + total.lost, 1e-9);
  EXPECT_GT(angles.items[wheel.angle].near, 2 * std::numbers::pi) << "turns are counted";
}

TEST_P(Rows, stall_a_motor_that_is_too_weak) {
  const Wheel wheel(problem, 2);
  auto& angles = pool<AngleConstraint>(problem);
  *angles.law(wheel.angle) = {.lower = -10, .upper = 10, .rate = 1, .is_rate = true};
  start();
  std::fill(problem.velocity.begin(), problem.velocity.end(), Vec3{});
  for (int i = 0; i < 4000; ++i) {
    problem.velocity[wheel.rim] *= 0.97;  // a damped load
    step(0.005);
  }
  const Vec3 arm = problem.position[wheel.rim];
  EXPECT_NEAR(2 * g * arm.x, 10, 1e-2) << "it hangs where the weight's torque is the motor's most";
  EXPECT_LT(norm(problem.velocity[wheel.rim]), 1e-2);
}

TEST_P(Rows, stop_a_hinge_at_its_limit) {
  const Wheel wheel(problem, 2);
  auto& angles = pool<AngleConstraint>(problem);
  angles.items[wheel.angle].target = angles.items[wheel.angle].target_start = -0.5;
  angles.law(wheel.angle)->upper = 0;  // theta >= -0.5
  start();
  const double before = energy();
  run(3, 1.0 / 120);
  double value = 0;
  angles.items[wheel.angle].value(problem.position.data(), 1, &value);
  EXPECT_NEAR(value, 0, 1e-8);
  EXPECT_NEAR(norm(problem.velocity[wheel.rim]), 0, 1e-6) << "it stopped dead";
  EXPECT_NEAR(angles.multiplier(wheel.angle)[0], -2 * g * std::cos(0.5), 1e-3) << "and bears the weight";
  EXPECT_NEAR(total.dissipated + total.lost, before - energy(), 1e-9);
}

TEST_P(Rows, that_are_springs_swing_with_their_period) {
  problem.gravity = {};
  const double k = 50, mass = 2;
  const auto p = add_point(problem, {0.1, 0, 0}, mass);
  add(problem, along(p, {0, 1, 0}, 0)), add(problem, along(p, {0, 0, 1}, 0));
  const auto spring = add(problem, along(p, {1, 0, 0}, 0));
  pool<BilinearConstraint>(problem).law(spring)->compliance = 1 / k;
  start();
  const double before = energy(), period = 2 * std::numbers::pi * std::sqrt(mass / k);
  EXPECT_NEAR(before, 0.5 * k * 0.01, 1e-12);
  run(period, period / 1000);
  EXPECT_NEAR(problem.position[p].x, 0.1, exact() ? 1e-6 : 3e-3);
  if (exact()) {
    EXPECT_NEAR(energy(), before, 1e-9 * before);
  } else {
    EXPECT_LT(energy(), before);
  }
}

TEST_P(Rows, that_are_damped_springs_settle_under_a_load) {
  const auto p = add_point(problem, {}, 2);
  add(problem, along(p, {1, 0, 0}, 0)), add(problem, along(p, {0, 0, 1}, 0));
  const auto spring = add(problem, along(p, {0, 1, 0}, 0));
  *pool<BilinearConstraint>(problem).law(spring) = {.compliance = 1 / 200.0, .damping = 30};
  start();
  run(4, 0.01);
  EXPECT_NEAR(problem.position[p].y, -2 * g / 200, 1e-6);
  EXPECT_NEAR(pool<BilinearConstraint>(problem).multiplier(spring)[0], -2 * g, 1e-4);
  EXPECT_NEAR(total.dissipated + total.lost, 2 * g * 2 * g / 200 / 2, 1e-3) << "half of the work that gravity did";
}

TEST_P(Rows, keep_a_point_inside_a_sphere) {
  const auto sphere = shape::make_surface(Sphere{1.0});
  const auto p = add_point(problem, {0.5, 0.2, 0.1}, 2, {1, 0, 0});
  SurfaceConstraint c;
  c.surface = sphere.get();
  c.set_world_frame({});
  c.add(0, p, 1);
  const auto row = add(problem, c);
  pool<SurfaceConstraint>(problem).law(row)->lower = 0;
  start();
  const double before = energy();
  double farthest = 0, highest = before;
  for (int i = 0; i < 2400; ++i) {
    step(1.0 / 240);
    farthest = std::max(farthest, norm(problem.position[p])), highest = std::max(highest, energy());
  }
  EXPECT_LE(farthest, 1 + 1e-8);
  EXPECT_LE(highest, before + 1e-8);
  EXPECT_NEAR(total.dissipated + total.lost, before - energy(), 1e-8);
}

TEST_P(Rows, keep_a_bead_on_a_wire_and_its_energy) {
  const auto hoop = geometry::Spline::of_function(
      [](double u) { return Vec3{std::sin(u), -std::cos(u), 0.3 * std::sin(2 * u)}; }, 0, 2 * std::numbers::pi, true);
  const double s = hoop.nearest({1, 0.3, 0});
  const auto bead = add_point(problem, hoop.at(s).position, 2);
  CurveConstraint c;
  c.curve = &hoop;
  c.set_world_frame({});
  c.add(0, bead, 1);
  double multipliers[2];
  c.start(s, {}, multipliers);
  add(problem, c);
  start();
  const double before = energy();
  double lowest = before, highest = before;
  for (int i = 0; i < 1200; ++i) {
    step(1.0 / 240);
    lowest = std::min(lowest, energy()), highest = std::max(highest, energy());
    const Vec3& p = problem.position[bead];
    ASSERT_LT(norm(p - hoop.at(hoop.nearest(p, pool<CurveConstraint>(problem).items[0].parameter)).position), 1e-8);
  }
  EXPECT_LE(highest, before + (exact() ? 2e-3 : 1e-9));
  if (exact()) {
    EXPECT_GE(lowest, before - 2e-3) << "no exact discrete gradient for such a curve, but no drift either";
  }
}

TEST_P(Rows, let_a_bead_pass_the_corners_of_a_polyline) {
  const geometry::Polyline path(std::vector<Vec3>{{0, 0, 0}, {1, -0.3, 0}, {2, 0, 0}, {3, -0.4, 0.5}, {4, 0.3, 0}});
  const auto bead = add_point(problem, {0.001, -0.0003, 0}, 2, {0.5, -0.15, 0});
  CurveConstraint c;
  c.curve = &path;
  c.set_world_frame({});
  c.add(0, bead, 1);
  double multipliers[2];
  c.start(path.nearest(problem.position[bead]), {}, multipliers);
  add(problem, c);
  start();
  run(1.7, 1.0 / 120);
  EXPECT_GT(problem.position[bead].x, 1.5);
}

TEST_P(Rows, let_a_ball_rest_on_the_floor) {
  const auto ball = shape::make_surface(Sphere{0.5});
  const auto floor = shape::make_surface(HalfSpace{});
  // A rigid body of four points around (0, 2, 0).
  std::vector<std::uint32_t> corner;
  for (const Vec3& x : {Vec3{0, 2, 0}, Vec3{1, 2, 0}, Vec3{0, 3, 0}, Vec3{0, 2, 1}})
    corner.push_back(add_point(problem, x));
  for (std::uint32_t i = 0; i < 4; ++i)
    for (std::uint32_t j = i + 1; j < 4; ++j) {
      const double length = norm(problem.position[i] - problem.position[j]);
      add(problem, DistanceConstraint{{i, j}, length, length});
    }
  SurfacePairConstraint c;
  c.surface_a = ball.get(), c.surface_b = floor.get();
  for (std::uint32_t k = 0; k < 3; ++k) {
    c.add(static_cast<int>(1 + k), corner[0], -1), c.add(static_cast<int>(1 + k), corner[1 + k], 1);
    c.set_constant(static_cast<int>(4 + k), {k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0});
  }
  for (std::uint32_t k = 0; k < 4; ++k) c.add(0, corner[k], -0.25);
  // The ball's center is the first corner plus nothing: its frame has its origin at the mean of the points.
  c.start(problem.position.data(), 0);
  const auto row = add(problem, c);
  pool<SurfacePairConstraint>(problem).law(row)->upper = 0;
  start();
  const double before = energy();
  for (int i = 0; i < 1000; ++i) {
    for (Vec3& v : problem.velocity) v *= 0.995;
    step(1.0 / 240);
  }
  Vec3 middle;
  for (const auto i : corner) middle += 0.25 * problem.position[i];
  EXPECT_NEAR(middle.y, 0.5, 1e-4);
  EXPECT_LT(energy(), before);
  EXPECT_NEAR(pool<SurfacePairConstraint>(problem).multiplier(row)[0], -4 * g, 1e-2);
}

TEST_P(Rows, that_are_switched_off_do_nothing) {
  const auto p = add_point(problem, {});
  const auto row = add(problem, along(p, {0, 1, 0}, 0));
  auto& rows = pool<BilinearConstraint>(problem);
  rows.law(row)->lower = rows.law(row)->upper = 0;
  start();
  run(1, 0.01);
  EXPECT_NEAR(problem.velocity[p].y, -g, 1e-9);
}

TEST_P(Rows, cost_no_allocation_in_a_warm_step) {
  const Wheel wheel(problem, 2);
  auto& angles = pool<AngleConstraint>(problem);
  *angles.law(wheel.angle) = {.lower = -3, .upper = 3, .rate = 4, .is_rate = true};
  const auto end = add_point(problem, {1.4, 0, 0});
  const auto rope = add(problem, distance(wheel.rim, end, 0.5));
  pool<BilinearConstraint>(problem).law(rope)->lower = 0;
  start();
  run(0.2, 0.01);
  const long before = allocations;
  run(1, 0.01);
  EXPECT_EQ(allocations - before, 0);
}

}  // namespace
}  // namespace iota::solver
