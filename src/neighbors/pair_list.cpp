// SPDX-License-Identifier: Apache-2.0
#include "neighbors/pair_list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace iota::neighbors {

namespace {

constexpr std::uint64_t axis_bits = 21, axis_cells = 1ull << axis_bits;
constexpr std::uint64_t nowhere = std::numeric_limits<std::uint64_t>::max();

/// Cells of one row along x have successive numbers. The outermost cells stay empty, so that a neighbor's number is
/// always that of a cell.
std::uint64_t cell_number(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return (z << axis_bits | y) << axis_bits | x;
}

}  // namespace

void PairList::build(const laws::ParticleArrays& p, double radius, std::span<const std::uint32_t> family,
                     std::span<const std::uint8_t> sides) {
  const std::size_t n = p.size();
  double low[3] = {INFINITY, INFINITY, INFINITY};
  const std::vector<double>* const axes[3] = {&p.x, &p.y, &p.z};
  for (int k = 0; k < 3; ++k)
    for (const double v : *axes[k])
      if (std::isfinite(v)) low[k] = std::min(low[k], v);

  placed_.resize(n);
  const double inverse = 1 / radius;
  for (std::size_t i = 0; i < n; ++i) {
    std::uint64_t c[3];
    bool finite = true;
    for (int k = 0; k < 3; ++k) {
      const double at = ((*axes[k])[i] - low[k]) * inverse;
      finite = finite && std::isfinite(at);
      // All cells above two million share one: correct, but slow.
      c[k] = 1 + (finite ? static_cast<std::uint64_t>(std::min(at, static_cast<double>(axis_cells - 4))) : 0);
    }
    placed_[i] = {finite ? cell_number(c[0], c[1], c[2]) : nowhere, static_cast<std::uint32_t>(i)};
  }
  std::sort(placed_.begin(), placed_.end(), [](const Placed& a, const Placed& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.particle < b.particle;
  });
  while (!placed_.empty() && placed_.back().cell == nowhere) placed_.pop_back();

  const std::size_t m = placed_.size();
  x_.resize(m), y_.resize(m), z_.resize(m), particle_.resize(m), family_.resize(m);
  for (std::size_t a = 0; a < m; ++a) {
    const std::uint32_t i = placed_[a].particle;
    x_[a] = p.x[i], y_[a] = p.y[i], z_[a] = p.z[i];
    particle_[a] = i, family_[a] = family.empty() ? i : family[i];
  }

  // Each pair of cells once: the rest of the own cell and the next in its row, then three cells of each of four rows ahead.
  std::size_t count = 0;
  const double radius2 = radius * radius;
  const auto look = [&](std::size_t a, std::size_t from, std::size_t to) {
    if (found_.size() < count + (to - from)) found_.resize(2 * found_.size() + (to - from));
    const double x = x_[a], y = y_[a], z = z_[a];
    const std::uint32_t i = particle_[a], own = family_[a];
    for (std::size_t b = from; b < to; ++b) {  // no branch: one candidate in six is near, which is hard to predict
      const double dx = x_[b] - x, dy = y_[b] - y, dz = z_[b] - z;
      const std::uint32_t j = particle_[b];
      found_[count] = {std::min(i, j), std::max(i, j)};
      count += (dx * dx + dy * dy + dz * dz < radius2) & (family_[b] != own);
    }
  };
  constexpr std::uint64_t row = axis_cells, layer = axis_cells * axis_cells;
  const std::uint64_t ahead[4] = {row, layer - row, layer, layer + row};
  std::size_t begin[4] = {0, 0, 0, 0}, end[4] = {0, 0, 0, 0};
  for (std::size_t first = 0; first < m;) {
    const std::uint64_t cell = placed_[first].cell;
    std::size_t last = first, beside = 0;
    while (last < m && placed_[last].cell == cell) ++last;
    for (beside = last; beside < m && placed_[beside].cell == cell + 1;) ++beside;
    for (int k = 0; k < 4; ++k) {  // cells are in rising order, so the ranges only advance
      while (begin[k] < m && placed_[begin[k]].cell < cell + ahead[k] - 1) ++begin[k];
      end[k] = std::max(end[k], begin[k]);
      while (end[k] < m && placed_[end[k]].cell <= cell + ahead[k] + 1) ++end[k];
    }
    for (std::size_t a = first; a < last; ++a) {
      look(a, a + 1, beside);
      for (int k = 0; k < 4; ++k) look(a, begin[k], end[k]);
    }
    first = last;
  }

  if (!sides.empty()) {
    const auto is_apart = [&](const Pair& q) {
      return !((sides[q.i] & 1 && sides[q.j] & 2) || (sides[q.i] & 2 && sides[q.j] & 1));
    };
    const auto end = found_.begin() + static_cast<std::ptrdiff_t>(count);
    count = static_cast<std::size_t>(std::remove_if(found_.begin(), end, is_apart) - found_.begin());
  }

  // Two counting sorts, by the second and then by the first, leave every row in rising order.
  const auto sort_by = [&](std::span<const Pair> from, auto key, auto put) {
    count_.assign(n + 1, 0);
    for (const Pair& pair : from) ++count_[key(pair) + 1];
    for (std::size_t i = 0; i < n; ++i) count_[i + 1] += count_[i];
    start_ = count_;
    for (const Pair& pair : from) put(count_[key(pair)]++, pair);
  };
  by_second_.resize(count), partners_.resize(count);
  sort_by(
      std::span(found_).first(count), [](const Pair& q) { return q.j; },
      [&](std::size_t at, const Pair& q) { by_second_[at] = q; });
  sort_by(by_second_, [](const Pair& q) { return q.i; }, [&](std::size_t at, const Pair& q) { partners_[at] = q.j; });
}

}  // namespace iota::neighbors
