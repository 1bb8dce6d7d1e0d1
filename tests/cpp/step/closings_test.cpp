// SPDX-License-Identifier: Apache-2.0
#include <iota/system.h>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace iota {
namespace {

struct Pair {
  System system{SystemOptions{.gravity = {}}};
  BodyId a = system.bodies().create(), b = system.bodies().create();
  ParticleId p = system.particles().create(a, {}), q = system.particles().create(b, {1, 0, 0});
};

TEST(FinishedClosing, is_a_combine_in_the_step_in_which_its_time_is_over) {
  Pair s;
  (void)s.system.edits().combine(s.p, s.q, 0.095);
  for (int i = 1; i <= 10; ++i) {
    EXPECT_EQ(s.system.edits().closing_count(), 1u) << i;
    (void)s.system.step(0.01);
  }
  EXPECT_EQ(s.system.edits().closing_count(), 0u);
  EXPECT_EQ(s.system.particles().ring(s.p).size(), 2u);
}

TEST(FinishedClosing, that_has_become_impossible_is_given_up_with_a_warning) {
  Pair s;
  (void)s.system.edits().combine(s.p, s.q, 0.05);
  s.system.bodies().set_kind(s.a, BodyKind::static_), s.system.bodies().set_kind(s.b, BodyKind::static_);
  std::vector<std::string> warnings;
  for (int i = 0; i < 10; ++i)
    for (const std::string& warning : s.system.step(0.01).warnings) warnings.push_back(warning);
  EXPECT_EQ(s.system.edits().closing_count(), 0u);
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings.back().find("release or move one"), std::string::npos) << warnings.back();
  EXPECT_EQ(s.system.particles().ring(s.p).size(), 1u);
}

TEST(ClosingRods, act_on_each_other_only_by_their_ends_that_come_together) {
  System system{SystemOptions{.gravity = {}}};
  system.set_usual_material(Material{});
  std::vector<ParticleId> inner;
  for (const double side : {-1.0, 1.0}) {
    const BodyId rod = system.bodies().create();
    system.bodies().set_radius(rod, 0.05);
    inner.push_back(system.particles().create(rod, {0.5 * side, 0.03 * side, 0}));
    (void)system.particles().create(rod, {1.5 * side, 0.03 * side, 0});
  }
  const auto gap = [&] { return norm(system.particles().position(inner[1]) - system.particles().position(inner[0])); };
  const double first = gap();
  (void)system.edits().combine(inner[0], inner[1], 0.5);
  for (int i = 1; i < 50; ++i) {
    (void)system.step(0.01);
    const double s = i / 50.0;
    // The rods' surfaces meet at a tenth of it.
    ASSERT_NEAR(gap(), (1 - 0.99 * s * s * (3 - 2 * s)) * first, 1e-9 * first) << i;
    ASSERT_EQ(system.contacts().points().size(), 0u) << i;
  }
  (void)system.step(0.01);
  EXPECT_EQ(system.particles().ring(inner[0]).size(), 2u);
}

}  // namespace
}  // namespace iota
