// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <iota/system.h>

namespace iota {
namespace {

bool warns_of(const StepReport& report, const std::string& text) {
  for (const std::string& warning : report.warnings)
    if (warning.find(text) != std::string::npos) return true;
  return false;
}

TEST(SetMass, of_a_rods_end_that_ends_its_inertia_is_noted) {
  System system;
  const BodyId rod = system.bodies().create();
  const ParticleId end = system.particles().create(rod, {0, 0, 0});
  system.particles().create(rod, {1, 0, 0});
  system.bodies().set_rod(rod, 1, 0.1);
  system.particles().set_mass(end, 0.6);
  EXPECT_FALSE(warns_of(system.step(0.01), "not a rod"));
  system.particles().set_mass(end, 0.01);
  EXPECT_TRUE(warns_of(system.step(0.01), "not a rod"));
  EXPECT_FALSE(warns_of(system.step(0.01), "not a rod")) << "it is said once";
}

TEST(SetPosition, of_a_solids_point_that_ends_the_solid_is_noted) {
  System system;
  const BodyId box = system.bodies().create(Box{}, {.attachments = {{0, 1, 0}}});
  system.bodies().set_pose(box, {0, 1, 0}, {});
  EXPECT_FALSE(warns_of(system.step(0.01), "not the solid"));
  system.particles().set_position(system.bodies().particles(box)[0], {3, 3, 3});
  EXPECT_TRUE(system.bodies().solids(box).empty());
  EXPECT_TRUE(warns_of(system.step(0.01), "not the solid"));
}

TEST(Bond, can_be_switched_in_a_function_of_the_step) {
  System system;
  const BodyId a = system.bodies().create(), b = system.bodies().create();
  const ParticleId p = system.particles().create(a, {0, 0, 0}), q = system.particles().create(b, {1, 0, 0});
  const BondId spring = system.bonds().create(p, q, SpringLaw{});
  system.bonds().create(p, q,
                        ScriptedLaw{[&](const BondState&) {
                                      system.bonds().set_active(spring, false);
                                      system.bodies().set_kind(b, BodyKind::static_);
                                      EXPECT_THROW(system.set_gravity({}), std::logic_error);
                                      EXPECT_TRUE(system.bonds().is_active(spring)) << "not before the step is over";
                                      return Vec3{};
                                    },
                                    "switch"});
  (void)system.step(0.01);
  EXPECT_FALSE(system.bonds().is_active(spring));
  EXPECT_EQ(system.bodies().kind(b), BodyKind::static_);
}

}  // namespace
}  // namespace iota
