// SPDX-License-Identifier: Apache-2.0
#include "solver/rigid_motion.h"

#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

namespace iota::solver {
namespace {

const Vec3 center{3, 1, -2}, velocity{1, 2, 0.5}, turning{0.5, -4, 2};

/// Four points of different masses about their center of mass, in rigid motion.
Problem tumbling() {
  Problem problem;
  const double masses[]{1, 2, 3, 4};
  Vec3 places[]{{1, 0, 0}, {0, 1.2, 0.3}, {-0.5, 0, 1}, {}};
  for (int i = 0; i < 3; ++i) places[3] -= (masses[i] / masses[3]) * places[i];
  for (int i = 0; i < 4; ++i)
    (void)add_point(problem, center + places[i], masses[i], velocity + cross(turning, places[i]));
  return problem;
}
Vec3 momentum_of(const Problem& problem) {
  Vec3 sum;
  for (std::size_t i = 0; i < problem.size(); ++i) sum += problem.mass[i] * problem.velocity[i];
  return sum;
}
Vec3 angular_momentum_of(const Problem& problem) {
  Vec3 sum;
  for (std::size_t i = 0; i < problem.size(); ++i)
    sum += problem.mass[i] * cross(problem.position[i], problem.velocity[i]);
  return sum;
}

TEST(RigidMotion, of_a_rigid_body_is_its_motion) {
  const Problem problem = tumbling();
  const RigidMotion motion = rigid_motion_of(problem);
  EXPECT_NEAR(motion.mass, 10, 1e-12);
  EXPECT_LT(norm(motion.center - center), 1e-14);
  EXPECT_LT(norm(motion.velocity - velocity), 1e-14);
  EXPECT_LT(norm(motion.turning - turning), 1e-13);
  EXPECT_NEAR(motion.kinetic_energy(), problem.kinetic_energy(), 1e-12);
}

TEST(RigidMotion, has_the_momenta_and_leaves_a_rest_whose_energy_adds_up) {
  Problem problem = tumbling();
  problem.velocity[1] += {0.3, 0.7, -2}, problem.velocity[3] += {1, 0, 0.4};
  const RigidMotion motion = rigid_motion_of(problem);
  double rest = 0;
  Vec3 momentum;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const Vec3 beside = problem.velocity[i] - motion.velocity_at(problem.position[i]);
    rest += 0.5 * problem.mass[i] * dot(beside, beside), momentum += problem.mass[i] * beside;
  }
  EXPECT_LT(norm(momentum), 1e-13);
  EXPECT_GT(rest, 0.1);
  EXPECT_NEAR(motion.kinetic_energy() + rest, problem.kinetic_energy(), 1e-12);
}

TEST(RigidMotion, about_a_pivot_has_the_angular_momentum_about_it) {
  Problem problem = tumbling();
  const Vec3 pivot{1, 1, 1};
  const RigidMotion motion = rigid_motion_about(problem, pivot);
  EXPECT_EQ(motion.velocity_at(pivot), Vec3{});
  Vec3 about;
  for (std::size_t i = 0; i < problem.size(); ++i)
    about += problem.mass[i] * cross(problem.position[i] - pivot, motion.velocity_at(problem.position[i]));
  EXPECT_LT(norm(about - (angular_momentum_of(problem) - cross(pivot, momentum_of(problem)))), 1e-12);
}

TEST(RigidMotion, of_one_piece_does_not_see_the_others) {
  Problem problem = tumbling();
  const RigidMotion alone = rigid_motion_of(problem);
  std::vector<std::uint32_t> piece_of(4, 0);
  (void)add_point(problem, {100, 0, 0}, 50, {0, 7, 0}), piece_of.push_back(1);
  EXPECT_LT(norm(rigid_motion_of(problem, piece_of, 0).turning - alone.turning), 1e-15);
  EXPECT_LT(norm(rigid_motion_of(problem, piece_of, 1).velocity - Vec3{0, 7, 0}), 1e-15);
}

TEST(TurnForEnergy, restores_the_energy_and_keeps_momentum_and_angular_momentum) {
  for (const double energy : {1e-4, -1e-4}) {
    Problem problem = tumbling();
    const double start = problem.kinetic_energy();
    const Vec3 momentum = momentum_of(problem), angular = angular_momentum_of(problem);
    turn_for_energy(problem, energy, 0.1);
    EXPECT_NEAR(problem.kinetic_energy(), start + energy, 1e-9);
    EXPECT_LT(norm(momentum_of(problem) - momentum), 1e-13);
    EXPECT_LT(norm(angular_momentum_of(problem) - angular), 1e-12);
    EXPECT_NEAR(norm(problem.position[0] - problem.position[1]), norm(tumbling().position[0] - tumbling().position[1]),
                1e-14)
        << "it stays rigid";
  }
}

TEST(TurnForEnergy, does_nothing_that_would_take_more_than_a_small_angle) {
  Problem problem = tumbling();
  turn_for_energy(problem, 1e3, 0.1);
  EXPECT_EQ(problem.position, tumbling().position);
  EXPECT_EQ(problem.velocity, tumbling().velocity);
}

/// The energy of a turning body after it has turned.
double energy_of(const TurningBody& body, const Turned& turned) {
  return 0.5 * dot(turned.angular_momentum - rotate(turned.turn, body.spin), turned.turning);
}

TEST(TurnRigidly, by_many_turns_keeps_the_angular_momentum_and_nearly_the_energy) {
  for (const double thin : {1.0, 1e-3, 1e-9, 0.0}) {  // from a body of three different inertias to points on a line
    TurningBody body{.inertia = {{{2, 0, 0}, {0, 1 + thin, 0}, {0, 0, thin}}}, .angular_momentum = {1, 20, 3 * thin}};
    if (thin > 1e-12) body.inertia.m[0][0] = 1 + 2 * thin;
    const double start = energy_of(body, turn_rigidly(body, {}, 0));
    const Turned turned = turn_rigidly(body, {}, 1);
    EXPECT_EQ(turned.angular_momentum, body.angular_momentum);
    EXPECT_NEAR(energy_of(body, turned), start, 1e-3 * start) << thin;
  }
}

TEST(TurnRigidly, agrees_with_the_equations_of_a_body_with_a_wheel_in_gravity) {
  const TurningBody body{.inertia = {{{2, 0.1, 0}, {0.1, 3, 0.2}, {0, 0.2, 1.5}}},
                         .angular_momentum = {1, -2, 4},
                         .spin = {0, 3, 0},
                         .torque = {0.5, 0, -0.2},
                         .moment = {0.3, 0.1, 0.2}};
  const Vec3 gravity{0, -9.81, 0};
  constexpr int parts = 20000;
  Quaternion turn;
  Vec3 angular = body.angular_momentum;
  for (int i = 0; i < parts; ++i) {  // explicit and fine
    const Quaternion back{-turn.x, -turn.y, -turn.z, turn.w};
    const Vec3 turning = rotate(turn, solve_semidefinite(body.inertia, rotate(back, angular) - body.spin));
    angular += (1.0 / parts) * (body.torque + cross(rotate(turn, body.moment), gravity));
    turn = normalized(multiply(turn_by((1.0 / parts) * turning), turn));
  }
  const Turned turned = turn_rigidly(body, gravity, 1);
  EXPECT_LT(norm(turned.angular_momentum - angular), 2e-3);
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}})
    EXPECT_LT(norm(rotate(turned.turn, axis) - rotate(turn, axis)), 2e-3);
}

}  // namespace
}  // namespace iota::solver
