// SPDX-License-Identifier: Apache-2.0
// Many things in one call are what the same things made one by one are.
#include <iota/system.h>

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace iota {
namespace {

struct Rows {
  std::vector<Vec3> starts, ends;
  std::vector<double> masses, radii;

  explicit Rows(std::size_t count) {
    std::mt19937 random(7);
    const auto number = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
    for (std::size_t i = 0; i < count; ++i) {
      starts.push_back({2.0 * static_cast<double>(i), number(-1, 1), number(-1, 1)});
      ends.push_back(starts.back() + Vec3{number(0.5, 1.5), number(-1, 1), number(-1, 1)});
      masses.push_back(number(0.1, 3)), radii.push_back(i % 2 == 0 ? 0.0 : 0.05);
    }
  }
};

std::vector<Vec3> places(const System& system) {
  std::vector<Vec3> all;
  for (const ParticleId p : system.particles().ids()) all.push_back(system.particles().position(p));
  return all;
}

TEST(Many, rods_points_bonds_and_hinges_move_as_those_made_one_by_one) {
  const Rows rows(12);
  System at_once, one_by_one;

  const std::vector<BodyId> rods = at_once.many().create_rods({rows.starts, rows.ends, rows.masses, rows.radii, {}});
  const std::vector<ParticleId> points = at_once.many().create_points({rows.ends, {{0, 1, 0}}, rows.masses, {}});
  std::vector<ParticleId> firsts, lasts;
  for (const BodyId rod : rods) {
    firsts.push_back(at_once.bodies().particles(rod)[0]);
    lasts.push_back(at_once.bodies().particles(rod)[1]);
  }
  (void)at_once.many().create_bonds(
      {firsts, points, {at_once.laws().find("spring"), {{"stiffness", 5}, {"length", 1}}, {}}, {}});
  (void)at_once.many().combine(lasts, points);

  std::vector<ParticleId> first, last, point;
  for (std::size_t i = 0; i < rows.starts.size(); ++i) {
    const BodyId rod = one_by_one.bodies().create();
    const double half = rows.masses[i] / 2;
    first.push_back(one_by_one.particles().create(rod, rows.starts[i], half));
    last.push_back(one_by_one.particles().create(rod, rows.ends[i], half));
    if (rows.radii[i] > 0) one_by_one.bodies().set_rod(rod, rows.masses[i], rows.radii[i]);
  }
  for (std::size_t i = 0; i < rows.starts.size(); ++i)
    point.push_back(
        one_by_one.particles().create(one_by_one.bodies().create(), rows.ends[i], rows.masses[i], {0, 1, 0}));
  for (std::size_t i = 0; i < rows.starts.size(); ++i)
    (void)one_by_one.bonds().create(first[i], point[i], SpringLaw{.stiffness = 5, .length = 1});
  for (std::size_t i = 0; i < rows.starts.size(); ++i) (void)one_by_one.edits().combine(last[i], point[i]);

  for (System* const system : {&at_once, &one_by_one}) EXPECT_EQ(system->validate(), std::vector<std::string>{});
  EXPECT_NEAR(at_once.energy().total(), one_by_one.energy().total(), 1e-9);
  for (int i = 0; i < 60; ++i) (void)at_once.step(1.0 / 120), (void)one_by_one.step(1.0 / 120);
  const std::vector<Vec3> a = places(at_once), b = places(one_by_one);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT(norm(a[i] - b[i]), 1e-7) << i;
}

TEST(Many, a_row_that_is_refused_leaves_nothing_of_the_others) {
  System system;
  Rows rows(5);
  rows.masses[3] = -1;
  const std::uint64_t before = system.state_hash();
  EXPECT_THROW((void)system.many().create_rods({rows.starts, rows.ends, rows.masses, rows.radii, {}}),
               std::invalid_argument);
  EXPECT_TRUE(system.bodies().ids().empty());
  EXPECT_EQ(system.state_hash(), before);
}

}  // namespace
}  // namespace iota
