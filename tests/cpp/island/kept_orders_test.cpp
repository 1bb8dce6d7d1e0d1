// SPDX-License-Identifier: Apache-2.0
#include "island/kept_orders.h"

#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>
#include <iota/system.h>

#include <array>
#include <map>

namespace iota::island {
namespace {

using Numbers = std::vector<std::uint32_t>;

struct Kept {
  model::SmallModel m;
  Kept(Numbers rings, Numbers ends) {
    (void)m.chain(8);  // nine rings
    auto& kept = m.model.eliminations;
    kept.rings = std::move(rings), kept.ends = std::move(ends);
    for (std::size_t i = 0; i < kept.ends.size(); ++i) kept.work.push_back(10.0 * static_cast<double>(i + 1));
  }
  Numbers of(const Numbers& rings) const {
    KeptOrders orders;
    orders.read(m.model);
    solver::KnownOrder order{{99}, 99};
    orders.find(rings, order);
    EXPECT_EQ(order.is_empty(), order.work == 0);
    return order.nodes;
  }
};

TEST(KeptOrders, are_those_of_islands_with_exactly_the_same_rings) {
  const Kept kept({4, 2, 0, 7, 1}, {3, 5});
  EXPECT_EQ(kept.of({0, 2, 4}), (Numbers{2, 1, 0}));
  EXPECT_EQ(kept.of({1, 7}), (Numbers{1, 0}));
  for (const Numbers& other : {Numbers{0, 2}, {0, 2, 1}, {0, 2, 3}, {0, 2, 4, 7}, {4, 2, 0, 7, 1}, {3}, {}})
    EXPECT_EQ(kept.of(other), Numbers{});
}

TEST(KeptOrders, that_do_not_fit_together_count_as_none) {
  const Numbers rings{0, 1, 2};
  EXPECT_EQ(Kept({0, 1, 2}, {3}).of(rings), rings);
  EXPECT_EQ(Kept({0, 1, 2}, {2}).of(rings), Numbers{}) << "the last end is that of the list";
  EXPECT_EQ(Kept({0, 1, 2}, {4, 3}).of(rings), Numbers{}) << "ends are in order";
  EXPECT_EQ(Kept({0, 1, 1000}, {3}).of(rings), Numbers{}) << "a ring that there is not";
  EXPECT_EQ(Kept({0, 1, 1}, {3}).of(rings), Numbers{}) << "a ring twice";
  EXPECT_EQ(Kept({}, {}).of(rings), Numbers{});
}

/// A block of particles on springs, so many that their order is a dissection by places.
void make_lattice(System& system, int n) {
  std::map<std::array<int, 3>, ParticleId> at;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        at[{i, j, k}] = system.particles().create(system.bodies().create(),
                                                  {0.1 * i + 0.001 * (j * k % 7), 0.1 * j, 0.1 * k}, 0.01);
  for (const auto& [place, p] : at)
    for (const std::array<int, 3>& by : {std::array{1, 0, 0},
                                         {0, 1, 0},
                                         {0, 0, 1},
                                         {1, 1, 0},
                                         {1, -1, 0},
                                         {0, 1, 1},
                                         {0, 1, -1},
                                         {1, 0, 1},
                                         {1, 0, -1}})
      if (const auto q = at.find({place[0] + by[0], place[1] + by[1], place[2] + by[2]}); q != at.end())
        system.bonds().create(p, q->second, SpringLaw{100, 0.1});
  system.particles().nail(at[{0, n - 1, 0}]);
}

// The order of elimination depended on the places at the time of the analysis.
TEST(KeptOrders, let_a_restored_lattice_continue_with_the_same_bits) {
  System system({.mode = IntegrationMode::robust, .threads = 1});
  make_lattice(system, 8);
  for (int i = 0; i < 8; ++i) (void)system.step(1.0 / 60);
  System other({.threads = 1});
  other.restore(system.snapshot());
  for (int i = 0; i < 3; ++i) {
    (void)system.step(1.0 / 60), (void)other.step(1.0 / 60);
    ASSERT_EQ(system.state_hash(), other.state_hash()) << "step " << i;
  }
}

TEST(KeptOrders, are_in_each_snapshot_of_built_islands_once) {
  System system({.threads = 1});
  std::vector<ParticleId> ends;
  for (int i = 0; i < 40; ++i) {
    const BodyId rod = system.bodies().create();
    const ParticleId upper = system.particles().create(rod, {0, -1.0 * i, 0});
    if (i > 0) (void)system.edits().combine(ends.back(), upper);
    ends.push_back(system.particles().create(rod, {0, -1.0 * i - 1, 0}));
  }
  (void)system.step(1.0 / 240);
  const std::size_t with = system.snapshot().bytes.size();
  EXPECT_EQ(system.snapshot().bytes.size(), with);
  System other({.threads = 1});
  other.restore(system.snapshot());
  const std::size_t before = other.snapshot().bytes.size();
  (void)system.step(1.0 / 240), (void)other.step(1.0 / 240);
  EXPECT_EQ(with - before, 41 * 4 + 4 + 8) << "a system that has built nothing yet keeps no order";
  EXPECT_EQ(other.snapshot().bytes.size(), system.snapshot().bytes.size());
}

}  // namespace
}  // namespace iota::island
