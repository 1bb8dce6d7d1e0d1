// SPDX-License-Identifier: Apache-2.0
// Four points in place of a solid: its mass, center and inertia, to round-off.
#include "model/solid.h"
#include "ingredient/quantities.h"
#include "ingredient/tables.h"

#include "shape/shape.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

namespace iota::model {
namespace {

double difference(const Mat3& a, const Mat3& b) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) worst = std::max(worst, std::abs(a.m[i][j] - b.m[i][j]));
  return worst;
}

/// A brick of 2 x 3 x 6 m and 12 kg, off its frame's origin, turned in the world. Second moments of a box: size^2 / 12.
struct Brick : testing::Test {
  SmallModel m;
  Model& model = m.model;
  const double mass = 12;
  const Vec3 center{0.1, -0.2, 0.3};
  const Mat3 squares{{{4.0 / 12, 0, 0}, {0, 9.0 / 12, 0}, {0, 0, 36.0 / 12}}};
  const SolidPose pose{{5, 6, 7}, axis_angle({0.6, 0, 0.8}, 1.1)};
  const std::uint32_t body = model.make_body(BodyKind::dynamic, 0);
  const std::uint32_t solid = add_solid(model, body, {.shape = shape::to_data(Box{})}, mass, center, squares, pose);

  /// About the center of mass, in the world frame: m (trace S I - S), turned.
  Mat3 inertia() const {
    Mat3 world;
    for (int i = 0; i < 3; ++i) {
      const Vec3 axis = rotate(pose.orientation, Vec3{double(i == 0), double(i == 1), double(i == 2)});
      world += squares.m[i][i] * Mat3::outer(axis, axis);
    }
    return mass * (Mat3::diagonal(4.0 / 12 + 9.0 / 12 + 36.0 / 12) + -1.0 * world);
  }
  Vec3 world_center() const { return pose.position + rotate(pose.orientation, center); }
  void set_motion(const Vec3& velocity, const Vec3& spin) {
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      model.rings[model.particles[p].ring].velocity = velocity + cross(spin, model.position(p) - world_center());
    });
  }
};

TEST_F(Brick, has_the_mass_center_and_inertia_that_were_given) {
  EXPECT_NEAR(model.body_mass(body), mass, 1e-14);
  EXPECT_LT(norm(model.center_of_mass(body) - world_center()), 1e-14);
  EXPECT_LT(difference(body_inertia(model, body), inertia()), 1e-13);
  EXPECT_EQ(model.bodies[body].rank, 4);
  EXPECT_TRUE(ingredient::validate(model).empty());
}

TEST_F(Brick, tells_where_its_frame_is) {
  const SolidPose found = solid_pose(model, solid);
  EXPECT_LT(norm(found.position - pose.position), 1e-14);
  const Vec3 any{0.3, 0.4, -0.5};
  EXPECT_LT(norm(rotate(found.orientation, any) - rotate(pose.orientation, any)), 1e-14);
}

TEST_F(Brick, moves_as_its_points_do) {
  const Vec3 velocity{1, -2, 3}, spin{0.4, 0.5, -0.6};
  set_motion(velocity, spin);
  EXPECT_LT(norm(body_velocity(model, body) - velocity), 1e-14);
  EXPECT_LT(norm(body_angular_velocity(model, body) - spin), 1e-13);
  EXPECT_LT(norm(body_angular_momentum(model, body) - inertia() * spin), 1e-12);
  EXPECT_NEAR(ingredient::calc_energies(model).kinetic,
              0.5 * mass * dot(velocity, velocity) + 0.5 * dot(spin, inertia() * spin), 1e-12);
}

TEST_F(Brick, with_attachments_keeps_mass_center_inertia_and_motion) {
  const Vec3 velocity{1, -2, 3}, spin{0.4, 0.5, -0.6};
  set_motion(velocity, spin);
  EXPECT_TRUE(may_move_points(model, solid));
  for (const Vec3& place : {pose.position, world_center(), pose.position + Vec3{3, 0, 0}, Vec3{500, -80, 20}}) {
    const std::uint32_t p = attach(model, solid, place);
    EXPECT_EQ(model.position(p), place);
    EXPECT_GT(model.particles[p].mass, 0);
    EXPECT_NEAR(model.body_mass(body), mass, 1e-13);
    EXPECT_LT(norm(model.center_of_mass(body) - world_center()), 1e-12);
    EXPECT_LT(difference(body_inertia(model, body), inertia()), 1e-9);
    EXPECT_LT(norm(body_velocity(model, body) - velocity), 1e-12);
    EXPECT_LT(norm(body_angular_velocity(model, body) - spin), 1e-10);
    EXPECT_TRUE(ingredient::validate(model).empty());
  }
}

TEST_F(Brick, keeps_its_points_once_something_holds_one_of_them) {
  const std::uint32_t other = m.body({model.position(m.particle(body, 2))});
  m.hinge(m.particle(body, 2), m.particle(other, 0));
  EXPECT_FALSE(may_move_points(model, solid));
}

}  // namespace
}  // namespace iota::model
