// SPDX-License-Identifier: Apache-2.0
#include "solver/general/dense.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace iota::solver {

bool DenseLu::factorize(Dense a, double tolerance) {
  lu_ = std::move(a);
  const std::size_t n = lu_.rows;
  order_.resize(n), permuted_.resize(n);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  double largest = 0;
  for (const double v : lu_.values) largest = std::max(largest, std::abs(v));
  if (!std::isfinite(largest)) return false;
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(lu_(i, k)) > std::abs(lu_(pivot, k))) pivot = i;
    if (!(std::abs(lu_(pivot, k)) > tolerance * largest)) return false;
    if (pivot != k) {
      std::swap_ranges(lu_.row(k), lu_.row(k) + n, lu_.row(pivot));
      std::swap(order_[k], order_[pivot]);
    }
    for (std::size_t i = k + 1; i < n; ++i) {
      if (lu_(i, k) == 0) continue;
      const double factor = lu_(i, k) /= lu_(k, k);
      for (std::size_t j = k + 1; j < n; ++j) lu_(i, j) -= factor * lu_(k, j);
    }
  }
  return true;
}

void DenseLu::solve(std::span<double> b) const {
  const std::size_t n = lu_.rows;
  for (std::size_t i = 0; i < n; ++i) permuted_[i] = b[order_[i]];
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) permuted_[i] -= lu_(i, j) * permuted_[j];
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = i + 1; j < n; ++j) permuted_[i] -= lu_(i, j) * permuted_[j];
    permuted_[i] /= lu_(i, i);
  }
  std::copy(permuted_.begin(), permuted_.end(), b.begin());
}

std::size_t Svd::rank(double tolerance) const {
  return static_cast<std::size_t>(
      std::count_if(s.begin(), s.end(), [&](double value) { return value > tolerance * s.front(); }));
}

std::vector<double> Svd::solve(std::span<const double> b, double tolerance) const {
  std::vector<double> x(v.rows, 0.0);
  const std::size_t used = rank(tolerance);
  for (std::size_t k = 0; k < used; ++k) {
    double part = 0;
    for (std::size_t i = 0; i < u.rows; ++i) part += u(i, k) * b[i];
    part /= s[k];
    for (std::size_t j = 0; j < v.rows; ++j) x[j] += part * v(j, k);
  }
  return x;
}

namespace {

/// Four independent sums, so that additions do not wait for each other.
double dot(const double* a, const double* b, std::size_t n) {
  double sums[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4)
    for (std::size_t k = 0; k < 4; ++k) sums[k] += a[i + k] * b[i + k];
  for (; i < n; ++i) sums[0] += a[i] * b[i];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/// Replaces (x, y) by (c x - s y, s x + c y).
void rotate(double* x, double* y, std::size_t n, double c, double s) {
  for (std::size_t i = 0; i < n; ++i) {
    const double old = x[i];
    x[i] = c * old - s * y[i], y[i] = s * old + c * y[i];
  }
}

/// Rotates pairs of rows of `work` until all are orthogonal; `turns` is rotated too.
void orthogonalize(Dense& work, Dense& turns) {
  constexpr int max_sweeps = 40;
  constexpr double round_off = 1e-15;
  const std::size_t n = work.rows, m = work.columns;
  std::vector<double> square(n);  // of each row's length
  double nothing = 0;             // round-off relative to the whole
  for (std::size_t i = 0; i < n; ++i) nothing += 1e-34 * dot(work.row(i), work.row(i), m);
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    bool rotated = false;
    for (std::size_t i = 0; i < n; ++i) square[i] = dot(work.row(i), work.row(i), m);
    for (std::size_t p = 0; p + 1 < n; ++p)
      for (std::size_t q = p + 1; q < n; ++q) {
        if (std::min(square[p], square[q]) <= nothing) continue;
        const double gamma = dot(work.row(p), work.row(q), m);
        if (!(std::abs(gamma) > round_off * std::sqrt(square[p]) * std::sqrt(square[q]))) continue;
        rotated = true;
        const double zeta = (square[q] - square[p]) / (2 * gamma);
        const double t = (zeta >= 0 ? 1 : -1) / (std::abs(zeta) + std::sqrt(1 + zeta * zeta));
        const double c = 1 / std::sqrt(1 + t * t), s = c * t;
        rotate(work.row(p), work.row(q), m, c, s);
        rotate(turns.row(p), turns.row(q), n, c, s);
        square[p] -= t * gamma, square[q] += t * gamma;
      }
    if (!rotated) return;
  }
}

}  // namespace

Svd calc_svd(const Dense& a) {
  const bool wide = a.columns > a.rows;  // then the rows of A are turned, else its columns
  const std::size_t n = std::min(a.rows, a.columns), m = std::max(a.rows, a.columns);
  Dense work(n, m), turns(n, n);
  for (std::size_t i = 0; i < a.rows; ++i)
    for (std::size_t j = 0; j < a.columns; ++j) (wide ? work(i, j) : work(j, i)) = a(i, j);
  for (std::size_t i = 0; i < n; ++i) turns(i, i) = 1;
  orthogonalize(work, turns);

  std::vector<double> size(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < m; ++i) size[k] += work(k, i) * work(k, i);
    size[k] = std::sqrt(size[k]);
  }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return size[i] > size[j]; });

  Svd svd;
  Dense along(m, n), across(n, n);  // of the long side and of the short one
  for (std::size_t k = 0; k < n; ++k) {
    const double s = size[order[k]];
    svd.s.push_back(s);
    for (std::size_t i = 0; i < m; ++i) along(i, k) = s > 0 ? work(order[k], i) / s : 0;
    for (std::size_t i = 0; i < n; ++i) across(i, k) = turns(order[k], i);
  }
  svd.u = wide ? std::move(across) : std::move(along);
  svd.v = wide ? std::move(along) : std::move(across);
  return svd;
}

}  // namespace iota::solver
