// SPDX-License-Identifier: Apache-2.0
// Points, boxes and balls on a plane: against closed forms, and against Coulomb's conditions in every step.
#include "solver/constraints/contact.h"

#include "solver/integrator.h"
#include "tests/cpp/allocations.h"
#include "tests/cpp/solver/constraints/cone_derivatives.h"
#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace iota::solver {
namespace {

/// A rigid body of four equal points; gravity is (0, -g, 0) turned by a slope.
class Contacts : public testing::TestWithParam<Scheme> {
 protected:
  Problem problem;
  Integrator integrator;
  AdvanceReport total;
  std::vector<AdvanceReport> reports;
  double mass = 0;

  bool is_mid_point() const { return GetParam() == Scheme::mid_point; }
  void tilt(double angle, double direction = 0) {
    problem.gravity = {g * std::sin(angle) * std::cos(direction), -g * std::cos(angle),
                       g * std::sin(angle) * std::sin(direction)};
  }
  /// Four points at the corners of a regular tetrahedron in a sphere of radius r around the center.
  void add_body(const Vec3& center, double r, double of_mass, const Vec3& v = {}, const Vec3& spin = {}) {
    const auto first = static_cast<std::uint32_t>(problem.size());
    const Vec3 corners[4] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    for (const Vec3& c : corners) {
      const Vec3 arm = (r / std::sqrt(3.0)) * c;
      (void)add_point(problem, center + arm, of_mass / 4, v + cross(spin, arm));
    }
    for (std::uint32_t a = 0; a < 4; ++a)
      for (std::uint32_t b = a + 1; b < 4; ++b)
        add_rod(problem, first + a, first + b, norm(problem.position[first + a] - problem.position[first + b]));
    mass = of_mass;
  }
  /// The weights of a place in the body of the first four points, where they are now.
  std::array<double, 4> weights(const Vec3& place) const {
    Mat3 m;
    const Vec3& o = problem.position[0];
    Vec3 e[3];
    for (int k = 0; k < 3; ++k) e[k] = problem.position[static_cast<std::size_t>(k) + 1] - o;
    const double volume = dot(e[0], cross(e[1], e[2]));
    const Vec3 d = place - o;
    const double w[3] = {dot(d, cross(e[1], e[2])) / volume, dot(d, cross(e[2], e[0])) / volume,
                         dot(d, cross(e[0], e[1])) / volume};
    return {1 - w[0] - w[1] - w[2], w[0], w[1], w[2]};
  }
  Vec3 center() const {
    Vec3 sum;
    for (const Vec3& x : problem.position) sum += (1.0 / static_cast<double>(problem.size())) * x;
    return sum;
  }
  ContactConstraint make(double friction, double step, double radius = 0) const {
    ContactConstraint c;
    c.set_directions({{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}});
    c.friction = friction, c.radius = radius, c.reference = 0.1;
    const double natural = step * step / mass;
    c.normal_compliance = 1e-8 * natural, c.compliance = 1e-2 * natural;
    return c;
  }
  static void place(ContactConstraint& c, int arm, const std::array<double, 4>& weights) {
    for (std::uint32_t i = 0; i < 4; ++i) c.add(arm, i, weights[i]);
  }
  void add_corner(const Vec3& corner, double friction, double step) {
    ContactConstraint c = make(friction, step);
    place(c, 0, weights(corner)), place(c, 1, weights(corner));
    add(problem, c);
  }
  void step(double h) {
    const AdvanceReport report = integrator.advance(problem, h, IntegratorSettings{.scheme = GetParam()});
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.fallbacks, 0);
    total.dissipated += report.dissipated, total.lost += report.lost, total.made += report.made;
    total.iterations += report.iterations, total.substeps += report.substeps;
    total.iterations_max = std::max(total.iterations_max, report.iterations_max);
  }
  /// With that of the strain.
  double energy() const {
    return problem.kinetic_energy() + problem.potential_energy(problem.position.data()) +
           problem.row_energy(problem.position.data(), 1);
  }
  const ConstraintPool<ContactConstraint>& contacts() { return pool<ContactConstraint>(problem); }
  Vec3 force() {
    Vec3 sum;
    for (std::size_t i = 0; i < contacts().items.size(); ++i) {
      const double* const l = contacts().multiplier(i);
      sum -= Vec3{l[1], l[0], l[2]};
    }
    return sum;
  }
};

INSTANTIATE_TEST_SUITE_P(Both, Contacts, testing::Values(Scheme::end_point, Scheme::mid_point),
                         [](const auto& info) { return info.param == Scheme::mid_point ? "mid_point" : "end_point"; });

TEST_P(Contacts, of_a_box_stick_to_a_slope_or_slide_as_the_coefficient_says) {
  constexpr double angle = 0.4, h = 1.0 / 120;
  for (const double direction : {0.0, 0.7, 2.5})
    for (const double friction : {0.0, 0.2, 0.999 * std::tan(angle), 1.001 * std::tan(angle), 1.5}) {
      SCOPED_TRACE(friction);
      problem = Problem{}, total = {};
      tilt(angle, direction);
      add_body({0, 0.05, 0}, 0.2, 3);
      for (const double x : {-0.1, 0.1})
        for (const double z : {-0.1, 0.1}) add_corner({x, 0, z}, friction, h);
      integrator.compile(problem);
      const Vec3 start = center();
      const int steps = 120;
      const double before = energy();
      for (int i = 0; i < steps; ++i) step(h);
      const Vec3 way = center() - start, down{std::cos(direction), 0, std::sin(direction)};
      EXPECT_NEAR(way.y, 0, 1e-9);
      EXPECT_NEAR(norm(way - dot(way, down) * down), 0, 1e-7) << "straight down the slope";
      if (friction > std::tan(angle)) {
        EXPECT_LT(norm(way), 2e-5) << "the strain of c_t";
        const Vec3 there = center();
        for (int i = 0; i < 600; ++i) step(h);
        EXPECT_LT(norm(center() - there), 1e-9) << "it does not creep";
        EXPECT_LT(norm(force() + mass * problem.gravity), 1e-6);
      } else {
        const double a = g * (std::sin(angle) - friction * std::cos(angle));
        const double expected = a * h * h * steps * (is_mid_point() ? steps : steps + 1) / 2;
        EXPECT_NEAR(dot(way, down), expected, friction > 0.3 ? 2e-4 : 1e-6) << "it swings a little before it slips";
        EXPECT_NEAR(before - energy(), total.dissipated + total.lost - total.made, 1e-8);
      }
      EXPECT_LE(total.iterations, 4 * 720);
    }
}

TEST_P(Contacts, of_a_ball_that_slides_make_it_roll_as_its_inertia_says) {
  constexpr double h = 1.0 / 120, radius = 0.1, friction = 0.3, speed = 1;
  add_body({0, radius, 0}, 0.08, 2, {speed, 0, 0});
  tilt(0);
  ContactConstraint c = make(friction, h, radius);
  add(problem, c);
  const auto turn_along = [&] {
    auto& ball = pool<ContactConstraint>(problem).items[0];
    const Vec3 below = center() - Vec3{0, radius, 0};
    ContactConstraint now = make(friction, h, radius);
    place(now, 0, weights(center())), place(now, 1, weights(below));
    ball = now;
  };
  turn_along();
  integrator.compile(problem);
  for (int i = 0; i < 240; ++i) {
    turn_along();
    step(h);
  }
  // Four points at r: I = 2/3 m r^2; v (1 + I / m R^2) = v0.
  const double inertia = 2.0 / 3 * 0.08 * 0.08, rolling = speed / (1 + inertia / (radius * radius));
  Vec3 v;
  for (const Vec3& each : problem.velocity) v += 0.25 * each;
  EXPECT_NEAR(v.x, rolling, is_mid_point() ? 2e-2 : 0.2) << "backward Euler takes spin";
  EXPECT_NEAR(v.y, 0, 1e-6);
  EXPECT_NEAR(center().y, radius, 1e-8);
}

TEST_P(Contacts, of_a_falling_box_stop_it_and_make_no_energy) {
  constexpr double h = 1.0 / 120;
  tilt(0);
  add_body({0, 0.45, 0}, 0.2, 3, {0.4, 0, 0.1}, {0.5, 1, -0.8});
  const double half = 0.1;
  for (const double x : {-half, half})
    for (const double y : {-half, half})
      for (const double z : {-half, half}) add_corner(center() + Vec3{x, y, z}, 0.5, h);
  integrator.compile(problem);
  double before = energy();
  for (int i = 0; i < 480; ++i) {
    step(h);
    EXPECT_LE(energy(), before + 1e-9) << i;
    before = energy();
  }
  EXPECT_LT(norm(problem.velocity[0]), 1e-6);
  EXPECT_LT(norm(force() + mass * problem.gravity), 1e-5);
}

TEST(Contact, has_equations_with_the_derivatives_that_finite_differences_say) {
  std::mt19937 random(5);
  const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  const double natural[3] = {0.4, 0.7, 0.7};
  for (int round = 0; round < 50; ++round) {
    ContactConstraint c;
    c.friction = 0.1 + 0.05 * number(), c.normal_compliance = 0.01, c.compliance = 0.02;
    using Mode = ConeState::Mode;
    for (const ConeState state : {ConeState{}, ConeState{Mode::slips, 1}, ConeState{Mode::slips, 0}}) {
      std::array<double, 6> at;
      for (double& value : at) value = number();
      at[0] = -std::abs(at[0]), at[1] += 1;
      expect_derivatives(c, state, at, natural);
    }
  }
}

/// A contact of two bodies of four points each, with weights of either sign.
ContactConstraint random_contact(std::mt19937& random, bool is_round) {
  std::uniform_real_distribution<double> any(-1, 1);
  ContactConstraint c;
  c.count = 8, c.first_side = 4, c.radius = 0.7, c.is_round = is_round;
  for (std::uint32_t i = 0; i < 8; ++i) c.nodes[i] = i;
  for (auto& arm : c.weights)
    for (double& w : arm) w = any(random);
  return c;
}

TEST(Contact, sticks_up_to_its_static_friction_and_slips_with_the_kinetic_one) {
  using Mode = ConeState::Mode;
  ContactConstraint c;
  c.friction = 0.3, c.static_friction = 0.5;
  const double natural[3] = {1e-4, 1e-4, 1e-4}, gap[3] = {0, 0, 0}, tolerance = 1e-12;
  const auto after = [&](Mode mode, double share) {
    const double multipliers[3] = {-10, share * 10, 0};
    return c.switch_state({mode, mode == Mode::slips ? 1 : 0}, multipliers, gap, natural, tolerance).mode;
  };
  EXPECT_EQ(after(Mode::sticks, 0.49), Mode::sticks);
  EXPECT_EQ(after(Mode::sticks, 0.51), Mode::slips);
  EXPECT_EQ(after(Mode::slips, 0.31), Mode::slips);
  EXPECT_EQ(after(Mode::slips, 0.29), Mode::sticks);
  c.drag_before[0] = -3;  // it would turn back, after it was moved on from its rest
  EXPECT_EQ(after(Mode::slips, 1.29), Mode::sticks);
  EXPECT_EQ(after(Mode::sticks, 1.29), Mode::sticks);
  EXPECT_EQ(after(Mode::sticks, 1.31), Mode::slips);
  c.drag_before[0] = 0;
  const auto at_start = [&](double share) {
    const double multipliers[3] = {-10, share * 10, 0};
    return c.state_of(multipliers).mode;
  };
  for (const double share : {0.0, 0.29, 0.31, 0.49, 0.9}) EXPECT_EQ(at_start(share), Mode::sticks) << share;
  EXPECT_EQ(at_start(0.3), Mode::slips);
}

TEST(Contact, has_a_rate_of_its_sticking_point_before_and_after_the_middle_of_a_step) {
  ContactConstraint c;
  c.pivots[0] = 0.2, c.pivots[1] = -0.1;
  EXPECT_EQ(c.rate_of(0, 1), 0);
  EXPECT_EQ(c.rate_of(1, 1), 0.2);
  EXPECT_EQ(c.rate_of(1, 0), -0.2);
  EXPECT_EQ(c.rate_of(2, 0.5), 0);
}

TEST(Contact, has_the_point_that_touches_in_the_middle_of_a_part_of_a_step) {
  const Vec3 center{3, 1, 0}, spin{0, 0, -2}, speed{2, 0, 0};
  std::vector<Vec3> x, v;
  for (const Vec3 arm : {Vec3{1, 1, 1}, Vec3{1, -1, -1}, Vec3{-1, 1, -1}, Vec3{-1, -1, 1}})
    x.push_back(center + 0.3 * arm), v.push_back(speed + cross(spin, 0.3 * arm));
  ContactConstraint c;
  c.nodes = {0, 1, 2, 3}, c.count = c.of_first = 4, c.first_turns = true, c.ball = c.radius = 1;
  c.weights[0] = {0.25, 0.25, 0.25, 0.25};
  c.set_directions({Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, -1}});
  const double h = 0.3;
  c.begin_part(x.data(), v.data(), 0.5, 0.75, h);
  EXPECT_LT(norm(c.arm(1, x.data(), 0.5) - (center + Vec3{h / 2 * 2, -1, 0})), 1e-12);
  std::vector<Vec3> middle;  // by the velocities at the start
  for (std::size_t i = 0; i < x.size(); ++i) middle.push_back(x[i] + h / 2 * v[i]);
  const Vec3 below = c.arm(1, middle.data(), 0.5) - (center + h / 2 * speed);
  EXPECT_LT(std::abs(below.x), 1e-12) << "it is below the center";
  EXPECT_EQ(c.rate_of(1, 0.5), -c.rate_of(1, 0.75)) << "pivots are those of the part";
}

TEST(ContactRows, have_the_gradients_and_the_curvature_of_their_values) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const int form : {0, 1, 2}) {  // of a plane, round, of wires
    ContactConstraint c = random_contact(random, form > 0);
    if (form == 2) c.has_wires = true, c.bends[0] = 1.4, c.bends[1] = 0.8;
    std::array<Vec3, 8> x, moved;
    for (Vec3& p : x) p = {any(random), any(random), any(random)};
    for (std::size_t i = 0; i < 8; ++i) moved[i] = x[i] + Vec3{any(random), any(random), any(random)};
    const double lambda[3] = {-0.7, 0.4, 0.9};
    std::array<Vec3, 24> gradients, ahead, back, mean;
    c.gradients(x.data(), 1, gradients.data());
    std::vector<Mat3> blocks(36);
    c.curvature(x.data(), 1, lambda, false, blocks.data());
    constexpr double e = 1e-5;
    for (std::size_t j = 0; j < 8; ++j)
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 way{axis == 0 ? e : 0, axis == 1 ? e : 0, axis == 2 ? e : 0};
        std::array<Vec3, 8> to = x, from = x;
        to[j] += way, from[j] -= way;
        double g[3], before[3];
        c.value(to.data(), 1, g), c.value(from.data(), 1, before);
        c.gradients(to.data(), 1, ahead.data()), c.gradients(from.data(), 1, back.data());
        for (std::size_t r = 0; r < 3; ++r)
          EXPECT_NEAR(dot(gradients[3 * j + r], way) / e, (g[r] - before[r]) / (2 * e), 1e-8);
        for (std::size_t i = 0; i <= j; ++i) {
          Vec3 change;
          for (std::size_t r = 0; r < 3; ++r) change += (lambda[r] / (2 * e)) * (ahead[3 * i + r] - back[3 * i + r]);
          const std::size_t pair = i * 8 - i * (i - 1) / 2 + (j - i);
          EXPECT_LT(norm((1 / e) * (blocks[pair] * way) - change), 1e-8);
        }
      }
    // The mean gradients give the change of the values exactly, and no torque.
    double first[3], last[3];
    c.value(x.data(), 1, first), c.value(moved.data(), 1, last);
    const MeanGradients<ContactConstraint> means(c, x.data(), 1, {c, moved.data(), 1});
    for (int i = 0; i < 8; ++i) means.of_node(i, nullptr, mean.data() + 3 * i);
    for (std::size_t r = 0; r < 3; ++r) {
      double change = 0;
      Vec3 torque;
      for (std::size_t i = 0; i < 8; ++i) {
        change += dot(mean[3 * i + r], moved[i] - x[i]);
        torque += cross(0.5 * (x[i] + moved[i]), mean[3 * i + r]);
      }
      EXPECT_NEAR(change, last[r] - first[r], 1e-12);
      EXPECT_LT(norm(torque), 1e-12);
    }
  }
}

}  // namespace
}  // namespace iota::solver
