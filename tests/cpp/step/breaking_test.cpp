// SPDX-License-Identifier: Apache-2.0
// Surfaces whose function fails within a step: the step goes on without them, as if they had not been there.
#include "energy_book.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace iota {
namespace {

/// A floor that holds what stands on it until its function has been called `calls` times.
struct Floor {
  int calls = 1 << 30;
  bool throws = true;
  SurfaceFunction function{[this](const Vec3& r) -> double {
    if (--calls >= 0) return r.y;
    if (throws) throw std::runtime_error("the floor gave way");
    return std::nan("");
  }};
};

class FailingSurface : public testing::TestWithParam<std::tuple<IntegrationMode, int>> {};

TEST_P(FailingSurface, leaves_the_step_as_it_is_without_the_surface) {
  const auto [mode, after] = GetParam();
  for (const bool throws : {true, false}) {
    Floor floor{.throws = throws};
    System system{{.mode = mode}}, without{{.mode = mode}};
    ConstraintId held;
    for (System* s : {&system, &without}) {
      const BodyId rod = s->bodies().create();
      const ParticleId low = s->particles().create(rod, {0, 0, 0}, 1, {1, 0, 0});
      s->particles().create(rod, {0, 1, 0}, 2, {-1, 0, 0});
      if (s == &system)
        held = s->joints().create(
            SurfaceSpec{.kind = ConstraintKind::outside, .particle = low, .surface = {floor.function, {}, {}}});
    }
    floor.calls = after;
    const StepReport report = system.step(1.0 / 60), free = without.step(1.0 / 60);
    EXPECT_EQ(report.switched_off_constraints, std::vector<ConstraintId>{held});
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_EQ(report.warnings[0], std::string("constraint 0 (outside): the function of its surface ") +
                                      (throws ? "raised: the floor gave way" : "is not finite") +
                                      "; the constraint is switched off");
    EXPECT_EQ(report.unconverged, 0);
    EXPECT_FALSE(system.joints().state(held).active);
    EXPECT_TRUE(system.validate().empty());
    for (int i = 0; i < 30; ++i) {
      EXPECT_LT(report.worst_gap, 1e-6);
      for (std::size_t p = 0; p < 2; ++p) {
        const Vec3 off = system.particles().position(system.particles().ids()[p]) -
                         without.particles().position(without.particles().ids()[p]);
        EXPECT_LT(norm(off), 1e-3) << "it falls as if nothing had been there";
      }
      EXPECT_TRUE(system.step(1.0 / 60).switched_off_constraints.empty());
      (void)without.step(1.0 / 60);
    }
    EXPECT_NEAR(book(system.energy()), book(without.energy()), 1e-6);

    floor.calls = 1 << 30;
    system.joints().set_active(held, true);
    for (int i = 0; i < 60; ++i) EXPECT_TRUE(system.step(1.0 / 60).switched_off_constraints.empty());
    EXPECT_GT(system.particles().position(system.particles().ids()[0]).y, -1e-6) << "switched on again it holds again";
  }
}

INSTANTIATE_TEST_SUITE_P(, FailingSurface,
                         testing::Combine(testing::Values(IntegrationMode::robust, IntegrationMode::energy_keeping,
                                                          IntegrationMode::accurate),
                                          testing::Values(0, 5, 30, 50, 70, 130)));

TEST(SurfaceFailure, of_one_of_two_surfaces_in_touch_lets_both_go) {
  for (const int after : {0, 100, 1000, 2500}) {
    Floor floor;
    System system;
    const BodyId ball = system.bodies().create(Sphere{0.5}, {.position = {0, 0.6, 0}});
    const ConstraintId held = system.joints().create(SurfacePairSpec{
        .a = ball, .b = {}, .surface_a = {Sphere{0.5}, {0, 0.6, 0}, {}}, .surface_b = {floor.function, {}, {}}});
    for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 60);
    EXPECT_NEAR(system.bodies().center_of_mass(ball).y, 0.5, 1e-6);
    floor.calls = after;
    int told = 0;
    for (int i = 0; i < 30; ++i) told += static_cast<int>(system.step(1.0 / 60).switched_off_constraints.size());
    EXPECT_EQ(told, 1);
    EXPECT_FALSE(system.joints().state(held).active);
    EXPECT_LT(system.bodies().center_of_mass(ball).y, 0.4) << "it falls";
    EXPECT_TRUE(system.validate().empty());
  }
}

TEST(SurfaceFailure, at_once_refuses_the_constraint_and_changes_nothing) {
  System system;
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 1, 0});
  Floor floor{.calls = 0};
  const std::uint64_t before = system.state_hash();
  EXPECT_THROW(system.joints().create(SurfaceSpec{.particle = p, .surface = {floor.function, {}, {}}}),
               std::invalid_argument);
  EXPECT_EQ(system.state_hash(), before);
}

TEST(SurfaceFailure, is_what_a_surface_without_its_function_is_in_another_system) {
  Floor floor;
  System system, other;
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0});
  const ConstraintId held = system.joints().create(SurfaceSpec{.particle = p, .surface = {floor.function, {}, {}}});
  other.restore(system.snapshot());
  const StepReport report = other.step(0.01);
  EXPECT_EQ(report.switched_off_constraints, std::vector<ConstraintId>{held});
  EXPECT_NE(report.warnings.at(0).find("has no function in this system"), std::string::npos);
}

}  // namespace
}  // namespace iota
