// SPDX-License-Identifier: Apache-2.0
#include "scenes/chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace iota {
namespace {

/// A parallelogram of three bars between two nails on the ground, with `couplers` coupling bars: one moves, two move only
/// because they are parallel.
std::vector<BodyId> make_parallelogram(System& system, int couplers, double lean = 0) {
  std::vector<BodyId> bars;
  std::vector<std::pair<ParticleId, ParticleId>> ends;
  const auto bar = [&](const Vec3& a, const Vec3& b) {
    bars.push_back(system.bodies().create());
    const ParticleId p = system.particles().create(bars.back(), a), q = system.particles().create(bars.back(), b);
    ends.push_back({p, q});
  };
  bar({0, 0, 0}, {lean, 1, 0});
  bar({1, 0, 0}, {1 + lean, 1, 0});
  for (int i = 0; i < couplers; ++i) {
    bar({lean, 1, 0}, {1 + lean, 1, 0});
    (void)system.edits().combine(ends[0].second, ends.back().first);
    (void)system.edits().combine(ends[1].second, ends.back().second);
  }
  system.particles().nail(ends[0].first), system.particles().nail(ends[1].first);
  return bars;
}

bool mentions(const Diagnosis& d, const std::string& words) {
  return std::any_of(d.findings.begin(), d.findings.end(),
                     [&](const std::string& f) { return f.find(words) != std::string::npos; });
}

TEST(Diagnosis, counts_the_degrees_of_freedom_of_a_hanging_chain) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 5});
  const Diagnosis d = system.diagnose(chain.links[2]);
  EXPECT_EQ(d.unknowns, 6u * 3);
  EXPECT_EQ(d.rows, 5u + 3);
  EXPECT_EQ(d.rank, 8u);
  EXPECT_EQ(d.redundancy, 0u);
  EXPECT_EQ(d.degrees_of_freedom, 10u);
  EXPECT_EQ(d.singular_values.size(), 8u);
  EXPECT_EQ(d.findings, std::vector<std::string>{});
  EXPECT_LT(d.condition, 20);
}

TEST(Diagnosis, of_a_free_body_gives_it_six_degrees_of_freedom) {
  System system;
  const BodyId body = system.bodies().create();
  for (int i = 0; i < 6; ++i) system.particles().create(body, {std::cos(i * 1.0), std::sin(2.0 * i), 0.3 * i * i});
  EXPECT_EQ(system.diagnose(body).degrees_of_freedom, 6u);
  const BodyId point = system.bodies().create();
  system.particles().create(point, {5, 0, 0});
  const Diagnosis d = system.diagnose(point);
  EXPECT_EQ(d.degrees_of_freedom, 3u);
  EXPECT_EQ(d.rows, 0u);
  EXPECT_EQ(d.condition, 1);
}

TEST(Diagnosis, singular_values_are_those_of_the_two_rows_worked_out_by_hand) {
  // Two rods of unit masses in line: rows scaled to 1 share the middle point (mass 2) and meet there at 180 degrees.
  System system;
  const auto chain = scenes::make_chain(system, {.links = 2, .link_length = 1, .link_mass = 2, .nailed = false});
  const Diagnosis d = system.diagnose(chain.links[0]);
  ASSERT_EQ(d.singular_values.size(), 2u);
  // Row 1: (-1, 1/sqrt 2) / sqrt 1.5 on points 1, 2; row 2: (-1/sqrt 2, 1) / sqrt 1.5 on points 2, 3; product -1/3.
  EXPECT_NEAR(d.singular_values[0], std::sqrt(1 + 1.0 / 3), 1e-12);
  EXPECT_NEAR(d.singular_values[1], std::sqrt(1 - 1.0 / 3), 1e-12);
  EXPECT_NEAR(d.condition, std::sqrt(2.0), 1e-12);
  const double low = (1 - std::sqrt(1 + 4 * 2.0 / 3)) / 2, high = (1 + std::sqrt(1 + 4 * 4.0 / 3)) / 2;
  EXPECT_NEAR(d.kkt_condition, high / -low, 1e-9);
}

TEST(Diagnosis, finds_the_coupler_that_is_said_twice_and_names_it) {
  System system;
  const auto bars = make_parallelogram(system, 2, 0.3);
  const Diagnosis d = system.diagnose(bars[0]);
  EXPECT_EQ(d.redundancy, 1u);
  ASSERT_EQ(d.findings.size(), 2u);
  EXPECT_TRUE(mentions(d, "rank"));
  EXPECT_EQ(d.findings[1], "One of these follows from the others: the rigidity of body 2 and the rigidity of body 3.");
  EXPECT_GT(d.kkt_condition, 1e10);
}

TEST(Diagnosis, finds_a_fully_extended_linkage_nearly_singular) {
  // A chain between two nails, a millionth short of taut: the rows nearly repeat each other.
  System system;
  const auto chain = scenes::make_chain(system, {.links = 2, .link_length = 1});
  system.particles().set_position(chain.lower[0], {1, -1e-4, 0});
  system.particles().nail(chain.lower[1]);
  const Diagnosis d = system.diagnose(chain.links[0]);
  EXPECT_EQ(d.redundancy, 0u);
  EXPECT_GT(d.condition, 1e3);
  EXPECT_TRUE(mentions(d, "Nearly singular"));
  EXPECT_TRUE(mentions(d, "body 0") && mentions(d, "body 1")) << d.findings.front();

  System taut;
  const auto straight = scenes::make_chain(taut, {.links = 2, .link_length = 1});
  taut.particles().nail(straight.lower[1]);
  EXPECT_EQ(taut.diagnose(straight.links[0]).redundancy, 1u);
}

TEST(Diagnosis, names_joints) {
  System system;
  const BodyId a = system.bodies().create(), b = system.bodies().create();
  for (const BodyId body : {a, b})
    for (const Vec3& x : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      system.particles().create(body, body == a ? x : x + Vec3{0.1, 0.2, 0.3});
  const ConstraintId hinge = system.joints().create(JointSpec{.kind = ConstraintKind::revolute, .a = a, .b = b});
  EXPECT_EQ(system.diagnose(a).degrees_of_freedom, 7u);
  (void)system.joints().create(JointSpec{.kind = ConstraintKind::ball, .a = a, .b = b});
  const Diagnosis d = system.diagnose(b);
  EXPECT_EQ(d.degrees_of_freedom, 7u);
  EXPECT_EQ(d.redundancy, 3u);
  EXPECT_TRUE(mentions(d, "the revolute constraint " + std::to_string(hinge.slot))) << d.findings[1];
  EXPECT_TRUE(mentions(d, "the ball constraint"));
}

TEST(Diagnosis, changes_nothing) {
  System system;
  const auto bars = make_parallelogram(system, 2, 0.3);
  for (int i = 0; i < 5; ++i) (void)system.step(0.01);
  const std::uint64_t hash = system.state_hash();
  (void)system.diagnose(bars[1]);
  EXPECT_EQ(system.state_hash(), hash);
}

TEST(Diagnosis, refuses_destroyed_bodies_and_too_large_islands) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 700});
  EXPECT_THROW((void)system.diagnose(chain.links[0]), std::invalid_argument);
  const BodyId gone = system.bodies().create();
  system.bodies().destroy(gone);
  EXPECT_THROW((void)system.diagnose(gone), StaleIdError);
}

}  // namespace
}  // namespace iota
