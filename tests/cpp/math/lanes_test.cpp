// SPDX-License-Identifier: Apache-2.0
#include "math/lanes.h"

#include "math/mat3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace iota {
namespace {

TEST(Lanes, have_the_bits_of_plain_numbers) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int round = 0; round < 100; ++round) {
    Vec3 a[lane_count], b[lane_count];
    Mat3 m[lane_count];
    Vec3Lanes of_a, of_b;
    Mat3Lanes of_m;
    for (int k = 0; k < lane_count; ++k) {
      a[k] = {u(random), u(random), u(random)}, b[k] = {u(random), u(random), u(random)};
      of_a.set(k, a[k]), of_b.set(k, b[k]);
      for (int r = 0; r < 3; ++r) {
        for (double& entry : m[k].m[r]) entry = u(random);
        of_m.rows[r].set(k, {m[k].m[r][0], m[k].m[r][1], m[k].m[r][2]});
      }
    }
    const Lanes products = dot(of_a, of_b), roots = square_root(products * products);
    const Vec3Lanes crossed = cross(of_a, of_b), sums = of_a + products * of_b, turned = of_m * (of_a - of_b);
    for (int k = 0; k < lane_count; ++k) {
      EXPECT_EQ(products[k], dot(a[k], b[k]));
      EXPECT_EQ(roots[k], std::abs(products[k]));
      EXPECT_EQ(crossed.at(k), cross(a[k], b[k]));
      EXPECT_EQ(sums.at(k), a[k] + dot(a[k], b[k]) * b[k]);
      EXPECT_EQ(turned.at(k), m[k] * (a[k] - b[k]));
    }
  }
}

TEST(Lanes, are_chosen_one_by_one) {
  const Lanes a{1, -2, 3, std::nan("")}, b{0, 5, 3, 1};
  const Lanes most = largest(a, b), chosen = select(a > b, a, b);
  const double wanted_most[] = {1, 5, 3}, wanted[] = {1, 5, 3, 1};
  for (int k = 0; k < 3; ++k) EXPECT_EQ(most[k], wanted_most[k]);
  for (int k = 0; k < lane_count; ++k) EXPECT_EQ(chosen[k], wanted[k]);
  EXPECT_TRUE(any(a > b));
  EXPECT_FALSE(any(a > b + 9));
}

TEST(Lanes, are_gathered_from_records_and_scattered_back) {
  struct alignas(32) Record {
    double numbers[8];
  };
  std::vector<Record> records(5);
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 8; ++k) records[static_cast<std::size_t>(i)].numbers[k] = 10 * i + k;
  const LaneNumbers numbers{4, 0, 2, 1};
  FourLanes later = gather(records.data(), numbers, 1);
  for (int k = 0; k < 4; ++k)
    for (std::size_t lane = 0; lane < lane_count; ++lane)
      EXPECT_EQ(later[k][static_cast<int>(lane)], 10.0 * numbers[lane] + 4 + k);
  for (int k = 0; k < 4; ++k) later[k] += 100;
  scatter(later, records.data(), numbers, 1);
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 8; ++k)
      EXPECT_EQ(records[static_cast<std::size_t>(i)].numbers[k], 10 * i + k + (k >= 4 && i != 3 ? 100 : 0));
}

}  // namespace
}  // namespace iota
