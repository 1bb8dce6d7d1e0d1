// SPDX-License-Identifier: Apache-2.0
#include "neighbors/pair_list.h"

#include "tests/cpp/neighbors/cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace iota::neighbors {
namespace {

void expect_brute_force(const laws::ParticleArrays& p, double radius, const std::vector<std::uint32_t>& family) {
  PairList list;
  list.build(p, radius, family);
  std::size_t count = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    std::vector<std::uint32_t> wanted;
    for (std::uint32_t j = static_cast<std::uint32_t>(i) + 1; j < p.size(); ++j)
      if (distance2(p, i, j) < radius * radius && (family.empty() || family[i] != family[j])) wanted.push_back(j);
    ASSERT_EQ(std::vector<std::uint32_t>(list.row(i), list.row(i) + list.row_size(i)), wanted) << "row " << i;
    count += wanted.size();
  }
  EXPECT_EQ(list.pair_count(), count);
}

TEST(PairList, finds_what_all_against_all_finds) {
  for (const double radius : {0.01, 0.2, 0.7, 5.0}) expect_brute_force(cloud(400, 1, 2), radius, {});
  expect_brute_force(cloud(1, 1, 2), 1, {});
  expect_brute_force(cloud(0, 1, 2), 1, {});
  std::vector<std::uint32_t> family(400);
  for (std::size_t i = 0; i < family.size(); ++i) family[i] = static_cast<std::uint32_t>(i / 7);
  expect_brute_force(cloud(400, 1, 3), 0.5, family);
}

TEST(PairList, takes_any_places_on_a_lattice_on_a_line_and_far_away) {
  laws::ParticleArrays p = cloud(343, 1, 4);
  for (std::size_t i = 0; i < 343; ++i)
    p.x[i] = 0.5 * static_cast<double>(i % 7), p.y[i] = 0.5 * static_cast<double>(i / 7 % 7),
    p.z[i] = 0.5 * static_cast<double>(i / 49);
  expect_brute_force(p, 0.5, {});
  expect_brute_force(p, 0.50001, {});
  for (double& z : p.z) z = 3;
  expect_brute_force(p, 0.6, {});
  p.x[3] = 1e9, p.y[5] = -1e9, p.x[8] = 1e9 + 0.1;
  expect_brute_force(p, 0.6, {});
  p.x[10] = NAN, p.y[11] = INFINITY;
  expect_brute_force(p, 0.6, {});
}

}  // namespace
}  // namespace iota::neighbors
