// SPDX-License-Identifier: Apache-2.0
#include "step/edits.h"
#include "gravity.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <vector>

namespace iota {
namespace {

/// A mass of 1 kg that is nailed, and pulled down by a held spring with a force of 20 N.
struct Hook {
  System system;
  ParticleId mass = system.particles().create(system.bodies().create(), {0, 0, 0}, 1);
  ParticleId below = system.particles().create(system.bodies().create({.kind = BodyKind::static_}), {0, -1, 0}, 1);
  BondId spring = system.bonds().create(mass, below, SpringLaw{.stiffness = 40, .length = 0.5});

  Hook() { system.particles().nail(mass); }
};

TEST(EditsOfAStep, a_load_is_that_of_the_step_also_of_what_breaks_in_it) {
  Hook s;
  s.system.bonds().set_break_force(s.spring, 15);
  s.system.particles().set_break_force(s.mass, 20 + g + 1);
  EXPECT_TRUE(s.system.particles().is_nailed(s.mass));
  const StepReport report = s.system.step(1e-3);
  ASSERT_EQ(report.broken.size(), 1u);
  EXPECT_EQ(report.broken[0].bond, s.spring);
  EXPECT_TRUE(s.system.particles().is_nailed(s.mass));

  Hook both;
  both.system.bonds().set_break_force(both.spring, 15);
  both.system.particles().set_break_force(both.mass, 20);  // above its weight: it is the spring that breaks the nail
  const StepReport broken = both.system.step(1e-3);
  ASSERT_EQ(broken.broken.size(), 2u);
  EXPECT_EQ(broken.broken[0].bond, both.spring);
  EXPECT_EQ(broken.broken[1].particle, both.mass);
  EXPECT_NEAR(broken.broken[1].force, 20 + g, 1e-6);
  EXPECT_FALSE(both.system.particles().is_nailed(both.mass));
}

/// A mass that falls 0.5 m until a rope stops it.
struct Falling {
  System system;
  ParticleId anchor = system.particles().create(system.bodies().create(), {0, 0, 0});
  ParticleId mass = system.particles().create(system.bodies().create(), {0, -0.5, 0}, 1);
  ConstraintId rope =
      system.joints().create(DistanceSpec{.kind = ConstraintKind::rope, .p = anchor, .q = mass, .length = 1});

  Falling() { system.particles().nail(anchor); }
  StepReport fall(int steps) {
    StepReport all;
    for (int i = 0; i < steps; ++i) {
      const StepReport report = system.step(1e-3);
      all.stops.insert(all.stops.end(), report.stops.begin(), report.stops.end());
      all.broken.insert(all.broken.end(), report.broken.begin(), report.broken.end());
      all.died.insert(all.died.end(), report.died.begin(), report.died.end());
    }
    return all;
  }
};

TEST(EditsOfAStep, a_rope_that_breaks_parts_in_the_same_report) {
  Falling s;
  (void)s.fall(1000);
  s.system.joints().set_break_limits(s.rope, {.force = 1});
  const StepReport report = s.system.step(1e-3);
  ASSERT_EQ(report.broken.size(), 1u);
  EXPECT_EQ(report.broken[0].constraint, s.rope);
  ASSERT_EQ(report.stops.size(), 1u);
  EXPECT_EQ(report.stops[0].kind, StopEvent::Kind::parted);
  EXPECT_TRUE(s.fall(10).stops.empty()) << "it is told once";

  Falling at_once;  // breaks in the step in which it becomes taut: it was never seen to carry
  at_once.system.joints().set_break_limits(at_once.rope, {.force = 1});
  const StepReport fall = at_once.fall(1000);
  EXPECT_EQ(fall.broken.size(), 1u);
  EXPECT_TRUE(fall.stops.empty());
}

TEST(EditsOfAStep, no_stop_is_told_of_a_rope_whose_particle_dies_in_the_step) {
  Falling once;
  int taut_at = 0;
  for (int i = 1; i < 1000 && taut_at == 0; ++i)
    if (!once.system.step(1e-3).stops.empty()) taut_at = i;
  ASSERT_GT(taut_at, 0);

  Falling s;
  s.system.particles().set_attributes(s.mass, {.lifetime = (taut_at - 0.5) * 1e-3});
  const StepReport report = s.fall(taut_at + 2);
  EXPECT_EQ(report.died, std::vector<ParticleId>{s.mass});
  EXPECT_TRUE(report.stops.empty());
  EXPECT_FALSE(s.system.joints().contains(s.rope));
}

}  // namespace
}  // namespace iota
