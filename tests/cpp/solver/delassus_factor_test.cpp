// SPDX-License-Identifier: Apache-2.0
#include "solver/delassus_factor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <vector>

namespace iota::solver {
namespace {

using Matrix = std::vector<std::vector<double>>;

/// Rows of ties between random bodies, with the matrix that couples them, in full.
struct Ties {
  std::vector<DelassusFactor::Incidence> incidences;
  std::uint32_t count;
  Matrix rows;  // each by six velocities of each body, in units of which all masses are one

  Ties(std::mt19937& random, std::uint32_t bodies, std::uint32_t ties) : count(ties) {
    std::uniform_int_distribution<std::uint32_t> any_body(0, bodies - 1);
    std::normal_distribution<double> number;
    for (std::uint32_t i = 0; i < ties; ++i) {
      std::set<std::uint32_t> ends;
      for (std::uint32_t k = 0; k <= i % 5; ++k) ends.insert(any_body(random));
      for (const std::uint32_t body : ends) incidences.push_back({i, body});
      for (std::uint32_t r = 0; r < 3; ++r) {
        std::vector<double>& row = rows.emplace_back(6 * bodies, 0.0);
        if (r > i % 3) continue;  // ties of one, two and three rows
        for (const std::uint32_t end : ends)
          for (std::size_t k = 0; k < 6; ++k) row[6 * end + k] = number(random);
      }
    }
  }
  bool analyze(DelassusFactor& factor, std::uint32_t bodies) const { return factor.analyze(count, incidences, bodies); }
  double coupled(std::size_t i, std::size_t j) const {
    double sum = 0;
    for (std::size_t k = 0; k < rows[i].size(); ++k) sum += rows[i][k] * rows[j][k];
    return sum;
  }
  void factorize(DelassusFactor& factor) const {
    factor.factorize([&](std::uint32_t i, std::uint32_t j) {
      Mat3 block;
      for (int r = 0; r < 3; ++r)
        for (int s = 0; s < 3; ++s)
          block.m[r][s] = coupled(3 * i + static_cast<std::size_t>(r), 3 * j + static_cast<std::size_t>(s));
      return block;
    });
  }
  std::vector<double> times(const std::vector<Vec3>& x) const {
    std::vector<double> sums(rows.size(), 0.0);
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t j = 0; j < rows.size(); ++j) {
        const Vec3& of_tie = x[j / 3];
        sums[i] += coupled(i, j) * (j % 3 == 0 ? of_tie.x : j % 3 == 1 ? of_tie.y : of_tie.z);
      }
    return sums;
  }
};

TEST(DelassusFactor, solves_the_equations_of_random_ties) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    const Ties ties(random, 12, 14);  // 28 rows of 72 velocities
    DelassusFactor factor;
    ASSERT_TRUE(ties.analyze(factor, 12));
    ties.factorize(factor);
    std::normal_distribution<double> number;
    std::vector<Vec3> wanted;
    for (std::size_t i = 0; i < ties.count; ++i)
      wanted.push_back({number(random), i % 3 > 0 ? number(random) : 0, i % 3 > 1 ? number(random) : 0});
    std::vector<Vec3> answer = wanted;
    factor.solve(answer);
    const std::vector<double> got = ties.times(answer);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      EXPECT_LT(norm(Vec3{got[3 * i], got[3 * i + 1], got[3 * i + 2]} - wanted[i]), 1e-8) << seed << ", tie " << i;
  }
}

TEST(DelassusFactor, gives_no_impulse_to_rows_that_are_there_twice) {
  std::mt19937 random(1);
  Ties ties(random, 4, 3);
  for (const DelassusFactor::Incidence& one : std::vector(ties.incidences))
    ties.incidences.push_back({one.tie + 3, one.body});
  ties.count = 6;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t r = 0; r < 3; ++r) ties.rows.push_back(ties.rows[3 * i + r]);
  }
  DelassusFactor factor;
  ASSERT_TRUE(ties.analyze(factor, 4));
  ties.factorize(factor);
  std::vector<Vec3> answer{{1, 0, 0}, {2, 3, 0}, {4, 5, 6}, {1, 0, 0}, {2, 3, 0}, {4, 5, 6}};
  const std::vector<Vec3> wanted = answer;
  factor.solve(answer);
  const std::vector<double> got = ties.times(answer);
  for (std::size_t i = 0; i < wanted.size(); ++i)
    EXPECT_LT(norm(Vec3{got[3 * i], got[3 * i + 1], got[3 * i + 2]} - wanted[i]), 1e-9) << i;
}

TEST(DelassusFactor, is_not_for_bodies_with_hundreds_of_ties) {
  std::vector<DelassusFactor::Incidence> incidences;
  for (std::uint32_t i = 0; i < 200; ++i) incidences.push_back({i, 0});
  EXPECT_FALSE(DelassusFactor().analyze(200, incidences, 1));
}

}  // namespace
}  // namespace iota::solver
