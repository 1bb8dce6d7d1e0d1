// SPDX-License-Identifier: Apache-2.0
#include "solver/delassus_factor.h"

#include "base/sort_unique.h"
#include "solver/sparse/block_pattern.h"

#include <algorithm>
#include <iterator>

namespace iota::solver {

namespace {

/// c -= a b'
void subtract_product(Mat3& c, const Mat3& a, const Mat3& b) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) c.m[i][j] -= a.m[i][0] * b.m[j][0] + a.m[i][1] * b.m[j][1] + a.m[i][2] * b.m[j][2];
}

/// The inverse of a symmetric matrix by sweeping its pivots, but for those that are at most these (Goodnight 1979, A Tutorial on
/// the SWEEP Operator, doi:10.1080/00031305.1979.10482685): their rows and columns are zero.
Mat3 inverse_of(Mat3 a, const Vec3& least) {
  const double bounds[3] = {least.x, least.y, least.z};
  bool is_taken[3];
  for (int k = 0; k < 3; ++k) {
    const double pivot = a.m[k][k];
    is_taken[k] = pivot > bounds[k];
    if (!is_taken[k]) continue;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (i != k && j != k) a.m[i][j] -= a.m[i][k] * a.m[k][j] / pivot;
    for (int i = 0; i < 3; ++i)
      if (i != k) a.m[i][k] /= pivot, a.m[k][i] /= pivot;
    a.m[k][k] = -1 / pivot;
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) a.m[i][j] = is_taken[i] && is_taken[j] ? -a.m[i][j] : 0;
  return a;
}

}  // namespace

bool DelassusFactor::analyze(std::uint32_t n, std::span<const Incidence> incidences, std::uint32_t body_count) {
  constexpr std::size_t most_ties = 64;  // of a body
  std::vector<std::vector<std::uint32_t>> ties_of(body_count);
  for (const Incidence& incidence : incidences) ties_of[incidence.body].push_back(incidence.tie);
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (const auto& list : ties_of) {
    if (list.size() > most_ties) return false;
    for (std::size_t k = 0; k < list.size(); ++k)
      for (std::size_t l = 0; l < k; ++l) pairs.push_back({list[l], list[k]});
  }
  sort_unique(pairs);
  find_elimination_order(n, pairs, {}, order_);
  std::vector<std::uint32_t> place(n);
  for (std::uint32_t k = 0; k < n; ++k) place[order_[k]] = k;

  // The blocks of a column: those of the matrix, and those of the columns whose first block is in its row.
  std::vector<std::vector<std::uint32_t>> columns(n);
  for (const auto& [i, j] : pairs) columns[std::min(place[i], place[j])].push_back(std::max(place[i], place[j]));
  first_.assign(1, 0), rows_.clear();
  std::vector<std::vector<std::uint32_t>> children(n);
  for (std::uint32_t k = 0; k < n; ++k) {
    std::vector<std::uint32_t>& rows = columns[k];
    for (const std::uint32_t child : children[k])
      rows.insert(rows.end(), columns[child].begin() + 1, columns[child].end());
    sort_unique(rows);
    if (!rows.empty()) children[rows[0]].push_back(k);
    rows_.insert(rows_.end(), rows.begin(), rows.end());
    first_.push_back(static_cast<std::uint32_t>(rows_.size()));
  }
  const auto slot_of = [&](std::uint32_t row, std::uint32_t column) {
    const auto begin = rows_.begin();
    return static_cast<std::uint32_t>(std::lower_bound(begin + first_[column], begin + first_[column + 1], row) -
                                      begin);
  };
  targets_.clear();
  for (std::uint32_t k = 0; k < n; ++k)
    for (std::uint32_t p = first_[k]; p < first_[k + 1]; ++p)
      for (std::uint32_t q = p + 1; q < first_[k + 1]; ++q) targets_.push_back(slot_of(rows_[q], rows_[p]));
  entries_.clear();
  for (std::uint32_t i = 0; i < n; ++i) entries_.push_back({i, i, place[i], true});
  for (const auto& [i, j] : pairs)
    if (place[i] > place[j])
      entries_.push_back({i, j, slot_of(place[i], place[j]), false});
    else
      entries_.push_back({j, i, slot_of(place[j], place[i]), false});
  return true;
}

void DelassusFactor::begin() {
  pivots_.resize(order_.size());
  below_.assign(rows_.size(), Mat3{});
}

// Each column, when it is complete, takes its products from those to its right.
void DelassusFactor::factorize() {
  constexpr double dependent = 1e-11;  // of a pivot of the matrix
  least_.resize(pivots_.size());
  for (std::size_t k = 0; k < pivots_.size(); ++k)
    least_[k] = dependent * Vec3{pivots_[k].m[0][0], pivots_[k].m[1][1], pivots_[k].m[2][2]};
  auto target = targets_.begin();
  for (std::size_t k = 0; k < pivots_.size(); ++k) {
    pivots_[k] = inverse_of(pivots_[k], least_[k]);
    const std::uint32_t first = first_[k], last = first_[k + 1];
    column_.assign(below_.begin() + first, below_.begin() + last);
    for (std::uint32_t p = first; p < last; ++p) {
      below_[p] = below_[p] * pivots_[k];
      subtract_product(pivots_[rows_[p]], below_[p], column_[p - first]);
    }
    for (std::uint32_t p = first; p < last; ++p)
      for (std::uint32_t q = p + 1; q < last; ++q) subtract_product(below_[*target++], below_[q], column_[p - first]);
  }
}

void DelassusFactor::solve(std::span<Vec3> x) const {
  const std::size_t n = order_.size();
  x_.resize(n);
  for (std::size_t k = 0; k < n; ++k) x_[k] = x[order_[k]];
  for (std::size_t k = 0; k < n; ++k)
    for (std::uint32_t p = first_[k]; p < first_[k + 1]; ++p) x_[rows_[p]] -= below_[p] * x_[k];
  for (std::size_t k = n; k-- > 0;) {
    x_[k] = pivots_[k] * x_[k];
    for (std::uint32_t p = first_[k]; p < first_[k + 1]; ++p) x_[k] -= transposed_times(below_[p], x_[rows_[p]]);
  }
  for (std::size_t k = 0; k < n; ++k) x[order_[k]] = x_[k];
}

}  // namespace iota::solver
