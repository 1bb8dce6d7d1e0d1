// SPDX-License-Identifier: Apache-2.0
// Many things in one call are what the same things made one by one are.
#include "tests/cpp/allocations.h"

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

/// Four rods in a row, end to end but apart; `p` and `q`: the ends that meet.
struct Row {
  System system;
  std::vector<BodyId> rods;
  std::vector<ParticleId> p, q;

  Row() {
    RodRows rows;
    for (int i = 0; i < 4; ++i) {
      rows.starts.push_back({i + 0.0, 0, 0});
      rows.ends.push_back({i + 0.9, 0, 0});
    }
    rods = system.many().create_rods(rows);
    for (std::size_t i = 0; i < 3; ++i) p.push_back(end_of(i, 1)), q.push_back(end_of(i + 1, 0));
  }
  ParticleId end_of(std::size_t rod, std::size_t end) const { return system.bodies().particles(rods[rod])[end]; }
  void expect_refused() {
    const std::uint64_t before = system.state_hash();
    EXPECT_THROW((void)system.many().combine(p, q), std::invalid_argument);
    EXPECT_EQ(system.state_hash(), before);
  }
};

TEST(Many, a_hinge_that_would_close_a_rod_to_a_point_leaves_nothing_of_the_others) {
  Row row;
  row.p.push_back(row.end_of(0, 0)),
      row.q.push_back(row.end_of(1, 0));  // where the other end of the first one is by then
  row.expect_refused();
}

TEST(Many, a_hinge_between_two_held_places_leaves_nothing_of_the_others) {
  Row nailed;
  nailed.system.particles().nail(nailed.end_of(2, 1));
  nailed.system.bodies().set_kind(nailed.rods[3], BodyKind::static_);
  nailed.expect_refused();
  Row fixed;  // held by bodies that are hinged in the same call
  fixed.system.bodies().set_kind(fixed.rods[0], BodyKind::static_);
  fixed.system.bodies().set_kind(fixed.rods[3], BodyKind::static_);
  fixed.p = {fixed.end_of(0, 1), fixed.end_of(2, 1), fixed.end_of(1, 0)};
  fixed.q = {fixed.end_of(1, 0), fixed.end_of(3, 0), fixed.end_of(2, 1)};
  fixed.expect_refused();
}

TEST(Many, hinging_an_end_twice_makes_two_rods_one_as_it_does_one_by_one) {
  Row row;
  row.p.push_back(row.p.front()), row.q.push_back(row.q.front());
  (void)row.system.many().combine(row.p, row.q);
  EXPECT_EQ(row.system.bodies().ids().size(), 3u);
  EXPECT_EQ(row.system.validate(), std::vector<std::string>{});
}

// The state before it would be most of the work.
TEST(Many, hinges_that_cannot_be_refused_keep_no_copy_of_the_system) {
  System system;
  RodRows rows;
  for (int i = 0; i < 4000; ++i) rows.starts.push_back({i + 0.0, 0, 0}), rows.ends.push_back({i + 1.0, 0, 0});
  const std::vector<BodyId> rods = system.many().create_rods(rows);
  std::vector<ParticleId> p, q;
  for (std::size_t i = 1; i < 4; ++i)
    p.push_back(system.bodies().particles(rods[i - 1])[1]), q.push_back(system.bodies().particles(rods[i])[0]);
  const long saved = static_cast<long>(system.snapshot().bytes.size()), before = allocated_bytes;
  (void)system.many().combine(p, q);
  EXPECT_LT(allocated_bytes - before, saved / 4);
}

}  // namespace
}  // namespace iota
