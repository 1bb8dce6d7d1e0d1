// SPDX-License-Identifier: Apache-2.0
// What does not act has no effect: a slack rope, a stop that is not reached, a joint that is switched off.
#include "modes.h"
#include "vectors.h"

#include <iota/system.h>

#include <gtest/gtest.h>

namespace iota {
namespace {

struct Spinner {
  BodyId box;
  ParticleId corner;

  Spinner(System& system, const Vec3& place, const Vec3& spin) {
    box =
        system.bodies().create(Box{{0.3, 0.4, 0.5}}, {.mass = 2, .position = place, .attachments = {{0.1, 0.2, 0.2}}});
    corner = system.bodies().attachments(box)[0];
    system.bodies().set_angular_velocity(box, spin);
  }
};

constexpr Vec3 spin{1, 2, 20};
constexpr double sixtieth = 1.0 / 60;

void run_for(System& system, double seconds) {
  for (double t = 0; t < seconds - sixtieth / 2; t += sixtieth) ASSERT_EQ(system.step(sixtieth).unconverged, 0u);
}

/// Runs for two seconds, in which a box keeps its angular momentum.
void expect_free(System& system, const Spinner& spinner) {
  (void)system.step(1e-6);
  const Vec3 before = system.bodies().angular_momentum(spinner.box);
  run_for(system, 2);
  expect_near(system.bodies().angular_momentum(spinner.box), before, 1e-4 * norm(before));
}

class Slack : public testing::TestWithParam<IntegrationMode> {};

// It lost 6 of 20 rad/s in mode robust.
TEST_P(Slack, a_rope_to_the_world_leaves_a_spinning_box_as_it_is_without) {
  System system{{.gravity = {}, .mode = GetParam()}};
  const Spinner tied(system, {}, spin);
  const BodyId anchor = system.bodies().create(Sphere{0.1}, {.position = {3, 0, 0}, .attachments = {{0, 0, 0}}});
  system.bodies().set_kind(anchor, BodyKind::static_);
  (void)system.joints().create(
      DistanceSpec{ConstraintKind::rope, tied.corner, system.bodies().attachments(anchor)[0], 10});
  expect_free(system, tied);
}

TEST_P(Slack, a_rope_between_two_boxes_leaves_each_its_own_spin) {
  System system{{.gravity = {}, .mode = GetParam()}};
  const Spinner a(system, {}, spin), b(system, {3, 0, 0}, {});
  (void)system.joints().create(DistanceSpec{ConstraintKind::rope, a.corner, b.corner, 10});
  expect_free(system, a);
  expect_near(system.bodies().angular_velocity(b.box), {}, 1e-9);
}

TEST_P(Slack, a_rope_that_is_switched_off_is_none) {
  System system{{.gravity = {}, .mode = GetParam()}};
  const Spinner a(system, {}, spin), b(system, {3, 0, 0}, {});
  const ConstraintId rope = system.joints().create(DistanceSpec{ConstraintKind::rope, a.corner, b.corner});
  system.joints().set_active(rope, false);
  expect_free(system, a);
}

TEST_P(Slack, a_rope_that_tightens_and_slackens_keeps_momentum_and_angular_momentum) {
  System system{{.gravity = {}, .mode = GetParam()}};
  const Spinner a(system, {}, spin), b(system, {3, 0, 0}, {0, 5, 0});
  system.particles().set_velocity(b.corner, {2, 1, 0});
  (void)system.joints().create(DistanceSpec{ConstraintKind::rope, a.corner, b.corner, 3.2});
  (void)system.step(1e-6);  // projects what was assigned
  const Vec3 linear = system.momentum(), angular = system.angular_momentum();
  bool has_been_taut = false;
  for (int i = 0; i < 600; ++i) {
    (void)system.step(sixtieth);
    has_been_taut = has_been_taut ||
                    norm(system.particles().position(a.corner) - system.particles().position(b.corner)) > 3.2 - 1e-3;
  }
  EXPECT_TRUE(has_been_taut);
  expect_near(system.momentum(), linear, 1e-9);
  // A jerk is not solved to the end in mode plausible.
  const double most = GetParam() == IntegrationMode::plausible ? 3e-4 : 1e-6;
  expect_near(system.angular_momentum(), angular, most * norm(angular));
}

INSTANTIATE_TEST_SUITE_P(Acting, Slack, testing::ValuesIn(all_modes));

}  // namespace
}  // namespace iota
