// SPDX-License-Identifier: Apache-2.0
#include "solver/general/dense.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace iota::solver {
namespace {

Dense random_matrix(std::size_t rows, std::size_t columns, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  Dense a(rows, columns);
  for (double& v : a.values) v = number(random);
  return a;
}

TEST(Svd, rebuilds_random_matrices_of_any_shape) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  for (const auto& [rows, columns] : {std::pair{1, 1}, {4, 4}, {7, 3}, {3, 7}, {12, 12}}) {
    Dense a(static_cast<std::size_t>(rows), static_cast<std::size_t>(columns));
    for (double& v : a.values) v = number(random);
    const Svd svd = calc_svd(a);
    EXPECT_TRUE(std::is_sorted(svd.s.rbegin(), svd.s.rend()));
    for (std::size_t i = 0; i < a.rows; ++i)
      for (std::size_t j = 0; j < a.columns; ++j) {
        double value = 0;
        for (std::size_t k = 0; k < svd.s.size(); ++k) value += svd.u(i, k) * svd.s[k] * svd.v(j, k);
        EXPECT_NEAR(value, a(i, j), 1e-14);
      }
  }
}

TEST(Svd, knows_the_condition_of_a_hilbert_matrix) {
  Dense hilbert(8, 8);
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t j = 0; j < 8; ++j) hilbert(i, j) = 1.0 / static_cast<double>(i + j + 1);
  const Svd svd = calc_svd(hilbert);
  EXPECT_NEAR(svd.s.front() / svd.s.back() / 1.5257575e10, 1, 1e-5);  // e.g. Higham 2002, table 28.1
}

TEST(Svd, counts_the_rank_of_redundant_rows) {
  Dense a(4, 3);
  for (std::size_t j = 0; j < 3; ++j)
    a(0, j) = 1.0 + double(j), a(1, j) = double(j * j), a(2, j) = a(0, j) - 2 * a(1, j);
  const Svd svd = calc_svd(a);
  EXPECT_EQ(svd.rank(1e-12), 2u);
}

TEST(DenseLu, refuses_singular_matrices_and_solves_others) {
  Dense a(2, 2);
  a(0, 1) = 2, a(1, 0) = 3, a(1, 1) = 1;
  DenseLu lu;
  ASSERT_TRUE(lu.factorize(a));
  std::vector<double> b{4, 5};
  lu.solve(b);
  EXPECT_NEAR(b[0], 1, 1e-15);
  EXPECT_NEAR(b[1], 2, 1e-15);
  a(0, 1) = 0;
  EXPECT_FALSE(lu.factorize(a));
}

TEST(DenseLu, solves_random_equations_whose_first_pivots_are_zero) {
  std::mt19937 random(5);
  for (const std::size_t n : {1u, 2u, 5u, 20u}) {
    Dense a = random_matrix(n, n, random);
    if (n > 1) a(0, 0) = a(1, 1) = 0;
    std::vector<double> x(n), b(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) x[i] = 1.0 + static_cast<double>(i);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) b[i] += a(i, j) * x[j];
    DenseLu lu;
    ASSERT_TRUE(lu.factorize(a));
    lu.solve(b);
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(b[i], x[i], 1e-10) << n;
  }
}

TEST(DenseLu, refuses_numbers_that_are_not_finite) {
  Dense a(2, 2);
  a(0, 0) = a(1, 1) = 1, a(0, 1) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(DenseLu().factorize(a));
}

TEST(Svd, has_orthonormal_vectors_and_the_shortest_least_squares_solution) {
  std::mt19937 random(7);
  for (const auto& [rows, columns] : {std::pair{6u, 4u}, {4u, 6u}}) {
    const Dense a = random_matrix(rows, columns, random);
    const Svd svd = calc_svd(a);
    for (const Dense* const side : {&svd.u, &svd.v})
      for (std::size_t k = 0; k < svd.s.size(); ++k)
        for (std::size_t l = 0; l < svd.s.size(); ++l) {
          double product = 0;
          for (std::size_t i = 0; i < side->rows; ++i) product += (*side)(i, k) * (*side)(i, l);
          EXPECT_NEAR(product, k == l, 1e-13);
        }
    std::vector<double> b(rows);
    for (std::size_t i = 0; i < rows; ++i) b[i] = static_cast<double>(i * i);
    const std::vector<double> x = svd.solve(b, 1e-12);
    // A' (A x - b) = 0, and x is in the space of the rows: no vector that A maps to zero shortens it.
    std::vector<double> rest(rows);
    for (std::size_t i = 0; i < rows; ++i) {
      rest[i] = -b[i];
      for (std::size_t j = 0; j < columns; ++j) rest[i] += a(i, j) * x[j];
    }
    double length = 0, along = 0;
    for (std::size_t j = 0; j < columns; ++j) {
      double gradient = 0;
      for (std::size_t i = 0; i < rows; ++i) gradient += a(i, j) * rest[i];
      EXPECT_NEAR(gradient, 0, 1e-11);
      length += x[j] * x[j];
    }
    for (std::size_t k = 0; k < svd.s.size(); ++k) {
      double part = 0;
      for (std::size_t j = 0; j < columns; ++j) part += svd.v(j, k) * x[j];
      along += part * part;
    }
    EXPECT_NEAR(along, length, 1e-11 * length);
  }
}

}  // namespace
}  // namespace iota::solver
