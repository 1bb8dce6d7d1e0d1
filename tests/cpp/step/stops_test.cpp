// SPDX-License-Identifier: Apache-2.0
#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace iota {
namespace {

TEST(StopEvents, tell_once_when_a_rope_becomes_taut_and_once_when_it_becomes_slack) {
  System system;
  const ParticleId nail = system.particles().create(system.bodies().create(), {0, 0, 0});
  const ParticleId weight = system.particles().create(system.bodies().create(), {0, -0.5, 0});
  system.particles().nail(nail);
  const ConstraintId rope =
      system.joints().create(DistanceSpec{.kind = ConstraintKind::rope, .p = nail, .q = weight, .length = 1});
  std::vector<StopEvent> events;
  double met_at = 0;
  const auto step = [&](int count) {
    for (int i = 0; i < count; ++i) {
      const StepReport report = system.step(1e-3);
      for (const StopEvent& event : report.stops) events.push_back(event), met_at = report.time;
    }
  };
  step(1000);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, StopEvent::Kind::met);
  EXPECT_EQ(events[0].constraint, rope);
  EXPECT_FALSE(events[0].coordinate.has_value());
  EXPECT_NEAR(met_at, std::sqrt(2 * 0.5 / 9.81), 3e-3);
  system.particles().set_velocity(weight, {0, 1, 0});
  step(100);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[1].kind, StopEvent::Kind::parted);
}

TEST(StopEvents, name_the_coordinate_whose_stop_is_reached) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId slider = system.bodies().create(Box{}, {.velocity = {1, 0, 0}});
  const ConstraintId rail = system.joints().create(JointSpec{
      .kind = ConstraintKind::prismatic, .a = slider, .axis = {1, 0, 0}, .slide = {.lower = -1, .upper = 0.255}});
  std::vector<StopEvent> events;
  for (int i = 0; i < 50; ++i)
    for (const StopEvent& event : system.step(0.01).stops) events.push_back(event);
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events[0].kind, StopEvent::Kind::met);
  EXPECT_EQ(events[0].constraint, rail);
  EXPECT_EQ(events[0].coordinate, JointCoordinate::slide);
}

}  // namespace
}  // namespace iota
