// SPDX-License-Identifier: Apache-2.0
#include "solver/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace iota::solver {

namespace {

/// Equations, and bounded rows at their bound: without open stops, slack ropes, springs and friction.
template <class C>
bool holds(const ConstraintPool<C>& pool, std::size_t item, int row, const Vec3* x) {
  constexpr double touching = 1e-6;
  if (!pool.has_laws()) return true;
  const RowLaw& law = pool.law(item)[row];
  if (law.is_off() || law.is_rate || law.is_compliant()) return false;
  if (law.lower == -RowLaw::unbounded && law.upper == RowLaw::unbounded) return true;
  double g[C::rows];
  pool.items[item].value(x, 0, g);
  return std::abs(g[row]) < touching * pool.items[item].reference_length();
}

template <class Visit>  // visit(constraint, name of the row)
void for_each_row_that_holds(const Problem& problem, Visit visit) {
  std::size_t index = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k)
      for (int r = 0; r < C::rows; ++r)
        if (holds(pool, k, r, problem.position.data())) visit(pool.items[k], RowName{index, k, r});
    ++index;
  });
}

/// Cholesky factor L of the mass matrix between points (each entry stands for a 3 x 3 multiple of the identity).
Dense factor_masses(const Problem& problem) {
  const std::size_t n = problem.size();
  Dense l(n, n);
  for (std::size_t i = 0; i < n; ++i) l(i, i) = problem.mass[i];
  for (const auto& c : problem.mass_couplings) l(c.a, c.b) += c.mass, l(c.b, c.a) += c.mass;
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k)
      for (std::size_t i = j; i < n; ++i) l(i, j) -= l(i, k) * l(j, k);
    if (!(l(j, j) > 0)) throw std::invalid_argument("diagnose: the mass matrix is not positive definite");
    const double pivot = std::sqrt(l(j, j));
    for (std::size_t i = j; i < n; ++i) l(i, j) /= pivot;
  }
  return l;
}

}  // namespace

std::size_t count_rows_that_hold(const Problem& problem) {
  std::size_t count = 0;
  for_each_row_that_holds(problem, [&](const auto&, const RowName&) { ++count; });
  return count;
}

ConstraintSpectrum calc_spectrum(const Problem& problem) {
  ConstraintSpectrum spectrum;
  for_each_row_that_holds(problem, [&](const auto&, const RowName& name) { spectrum.names.push_back(name); });
  const std::size_t n = problem.size(), rows = spectrum.names.size();
  spectrum.unknowns = 3 * n;
  if (rows == 0) return spectrum;

  const Dense l = factor_masses(problem);
  Dense g(rows, std::max(3 * n, rows + 1));  // wider than high, so that U is complete
  std::size_t at = 0;
  for_each_row_that_holds(problem, [&]<class C>(const C& c, const RowName& name) {
    const Gradients<C> gradients(c, problem.position.data(), 0);
    double* const row = g.row(at++);
    for (int i = 0; i < c.node_count(); ++i) {
      Vec3 directions[C::rows];
      gradients.of_node(i, directions);
      const Vec3& d = directions[name.row];
      row[3 * c.nodes[i]] += d.x, row[3 * c.nodes[i] + 1] += d.y, row[3 * c.nodes[i] + 2] += d.z;
    }
    double size = 0;
    for (std::size_t j = 0; j < 3 * n; ++j) {  // solve with L'... from the left: row L^-T
      for (std::size_t k = 0; k < j / 3; ++k) row[j] -= l(j / 3, k) * row[3 * k + j % 3];
      row[j] /= l(j / 3, j / 3);
      size += row[j] * row[j];
    }
    if (size > 0)
      for (std::size_t j = 0; j < 3 * n; ++j) row[j] /= std::sqrt(size);
  });
  spectrum.svd = calc_svd(g);
  spectrum.rank = spectrum.svd.rank(ConstraintSpectrum::rank_tolerance);
  return spectrum;
}

Dense ConstraintSpectrum::repeated_rows() const {
  const std::size_t rows = names.size();
  Dense null(rows - rank, rows);
  for (std::size_t k = 0; k < null.rows; ++k)
    for (std::size_t i = 0; i < rows; ++i) null(k, i) = svd.u(i, rank + k);
  // Gauss-Jordan with full pivoting: each combination then has a row that is in no other one.
  std::vector<bool> used(null.rows, false);
  for (std::size_t step = 0; step < null.rows; ++step) {
    std::size_t pivot_row = 0, pivot_column = 0;
    double largest = -1;
    for (std::size_t k = 0; k < null.rows; ++k)
      for (std::size_t i = 0; !used[k] && i < rows; ++i)
        if (std::abs(null(k, i)) > largest) largest = std::abs(null(k, i)), pivot_row = k, pivot_column = i;
    used[pivot_row] = true;
    for (std::size_t k = 0; k < null.rows; ++k) {
      if (k == pivot_row) continue;
      const double factor = null(k, pivot_column) / null(pivot_row, pivot_column);
      for (std::size_t i = 0; i < rows; ++i) null(k, i) -= factor * null(pivot_row, i);
      null(k, pivot_column) = 0;
    }
  }
  for (std::size_t k = 0; k < null.rows; ++k) {
    double largest = 0;
    for (std::size_t i = 0; i < rows; ++i) largest = std::max(largest, std::abs(null(k, i)));
    for (std::size_t i = 0; i < rows; ++i)
      null(k, i) = std::abs(null(k, i)) < 1e-6 * largest ? 0 : null(k, i) / largest;
  }
  return null;
}

double ConstraintSpectrum::kkt_condition(double compliance) const {
  // Each singular value s gives the pair of eigenvalues of [1 s; s -compliance]; unknowns without rows give 1.
  double largest = 1, smallest = 1;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double s = svd.s[i], mean = (1 - compliance) / 2, product = -compliance - s * s;
    const double big = mean + std::sqrt(mean * mean - product), small = product / big;
    largest = std::max(largest, big), smallest = std::min(smallest, std::abs(small));
  }
  return largest / smallest;
}

}  // namespace iota::solver
