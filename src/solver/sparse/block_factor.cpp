// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/block_factor.h"

#include "solver/sparse/pivot_block.h"

#include "base/slack.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

namespace {

using Lanes = LanesOf<2>::Type;

Lanes product(const TwoTriangles& a, const TwoTriangles& b) { return a.value * Lanes{b.value[1], b.value[0]}; }
double product(double a, double b) { return a * b; }

/// One row each of two blocks; unsymmetric: L21 times U12 in one lane, U12 times L21 in the other.
template <int Pivot, class Number>
auto row_product(const Number* a, const Number* b) {
  auto sum = product(a[0], b[0]);
  unroll<Pivot - 1>([&](auto k) { sum += product(a[k + 1], b[k + 1]); });
  return sum;
}

/// subtract(r, c, row r of a times row c of b) for all r and c, or those of the lower triangle. The usual size, two nodes,
/// is calculated whole before the first subtraction: the compiler must assume that the target aliases a and b.
template <int Pivot, bool Lower, class Number, class Subtract>
void for_each_product(const Number* a, int rows, const Number* b, int columns, Subtract subtract) {
  if (rows == 3 && columns == 3) {
    decltype(row_product<Pivot>(a, b)) sum[3][3];
    unroll<3>([&](auto r) {
      unroll<Lower ? r + 1 : 3>([&](auto c) { sum[r][c] = row_product<Pivot>(a + r * Pivot, b + c * Pivot); });
    });
    unroll<3>([&](auto r) { unroll<Lower ? r + 1 : 3>([&](auto c) { subtract(r, c, sum[r][c]); }); });
    return;
  }
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < (Lower ? r + 1 : columns); ++c)
      subtract(r, c, row_product<Pivot>(a + r * Pivot, b + c * Pivot));
}

}  // namespace

void BlockFactor::reset(const BlockPattern& pattern) {
  upper_.clear();
  grow(pattern);
}

void BlockFactor::grow(const BlockPattern& pattern) {
  pattern_ = &pattern;
  resize_with_slack(diagonals_, pattern_->diagonal_count());
  resize_with_slack(lower_, pattern_->lower_count());
  size_fronts();
}

void BlockFactor::size_fronts() {
  const auto widest = static_cast<std::size_t>(pattern_->widest_front()) * BlockPattern::max_pivot;
  unscaled_.resize(widest), front_.resize(widest);
  std::size_t largest = 0;
  for (const BlockPattern::Panel& panel : pattern_->panels())
    largest = std::max(largest, std::size_t{strips_in(panel.rows)} * strip_rows * panel.columns);
  if (largest == 0) return;
  resize_with_slack(panel_lower_, largest), resize_with_slack(panel_upper_, largest);
  resize_with_slack(row_of_, pattern_->vertices().size());
}

void BlockFactor::clear(Storage storage) {
  symmetric_ = storage == Storage::symmetric;
  std::fill(diagonals_.begin(), diagonals_.end(), 0.0);
  std::fill(lower_.begin(), lower_.end(), 0.0);
  if (symmetric_) return;
  reserve_with_slack(upper_, lower_.size());
  upper_.assign(lower_.size(), 0.0);
}

template <int Pivot, bool Symmetric>
[[gnu::flatten]] int BlockFactor::eliminate(const BlockPattern::Vertex& v) {
  using Number = std::conditional_t<Symmetric, double, TwoTriangles>;
  double* const diagonal = diagonals_.data() + v.diagonal;
  int wrong = 0;

  double d[Pivot][Pivot];
  unroll<Pivot>([&](auto i) { unroll<Symmetric ? i + 1 : Pivot>([&](auto j) { d[i][j] = diagonal[i * Pivot + j]; }); });
  factor_pivot_block<Symmetric>(d,
                                [&](int k, double pivot) { wrong += k < v.positives ? !(pivot > 0) : !(pivot < 0); });
  unroll<Pivot>([&](auto i) { unroll<Symmetric ? i + 1 : Pivot>([&](auto j) { diagonal[i * Pivot + j] = d[i][j]; }); });
  if (v.entry_count == 0) return wrong;

  const auto entries = pattern_->entries().subspan(v.first_entry, v.entry_count);
  int rows = 0;
  for (const auto& e : entries) rows += e.width;
  double* const l21 = lower_.data() + entries.front().offset;  // the blocks of a front are contiguous
  const Number *left, *right;                                  // the factors of the update
  if constexpr (Symmetric) {
    for (int r = 0; r < rows; ++r) {
      double l[Pivot], u[Pivot];
      unroll<Pivot>([&](auto k) { l[k] = l21[r * Pivot + k]; });
      factor_row_below<true>(d, l, u);
      unroll<Pivot>([&](auto k) { l21[r * Pivot + k] = l[k], unscaled_[r * Pivot + k] = u[k]; });
    }
    left = l21, right = unscaled_.data();
  } else {
    double* const u12 = upper_.data() + entries.front().offset;
    Lanes pivots[Pivot][Pivot];
    unroll<Pivot>([&](auto k) {
      unroll<k>([&](auto j) { pivots[j][k] = Lanes{d[j][k], d[k][j]}; });
      pivots[k][k] = Lanes{d[k][k], 1};
    });
    for (int r = 0; r < rows; ++r) {
      Lanes x[Pivot];
      unroll<Pivot>([&](auto k) {
        x[k] = Lanes{l21[r * Pivot + k], u12[r * Pivot + k]};
        unroll<k>([&](auto j) { x[k] -= x[j] * pivots[j][k]; });
        x[k] *= pivots[k][k];
      });
      unroll<Pivot>([&](auto k) {
        l21[r * Pivot + k] = x[k][0], u12[r * Pivot + k] = x[k][1];
        front_[r * Pivot + k].value = x[k];
      });
    }
    left = right = front_.data();
  }

  // Updates the later vertices.
  const std::uint32_t* target = pattern_->pair_targets().data() + v.first_pair;
  const auto vertices = pattern_->vertices();
  for (auto a = entries.begin(); a != entries.end(); ++a) {
    const int stride = vertices[a->vertex].pivot;
    double* const own = diagonals_.data() + *target++;
    for_each_product<Pivot, true>(left, a->width, right, a->width, [&](int r, int c, const auto& product) {
      if constexpr (Symmetric) {
        own[r * stride + c] -= product;
      } else {
        own[r * stride + c] -= product[0];
        if (r != c) own[c * stride + r] -= product[1];
      }
    });
    const Number* below = left + a->width * Pivot;
    for (auto b = a + 1; b != entries.end(); ++b, ++target) {
      double* const lower = lower_.data() + *target;
      [[maybe_unused]] double* const upper = upper_.data() + *target;
      for_each_product<Pivot, false>(below, b->width, right, a->width, [&](int r, int c, const auto& product) {
        if constexpr (Symmetric) {
          lower[r * stride + c] -= product;
        } else {
          lower[r * stride + c] -= product[0];
          upper[r * stride + c] -= product[1];
        }
      });
      below += b->width * Pivot;
    }
    left += a->width * Pivot, right += a->width * Pivot;
  }
  return wrong;
}

// --- all vertices ------------------------------------------------------------------------------------------------------

template <class Visit>
void BlockFactor::for_each_forward(Visit visit) const {
  const auto vertices = pattern_->vertices();
  const auto panel_of = pattern_->panel_of();
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (panel_of.empty() || panel_of[v] == BlockPattern::no_panel) {
      visit(vertices[v]);
      continue;
    }
    const BlockPattern::Panel& panel = pattern_->panels()[panel_of[v]];
    const auto members = pattern_->panel_vertices().subspan(panel.first, panel.count);
    if (members.back() != v) continue;
    for (const std::uint32_t member : members) visit(vertices[member]);
  }
}

template <int Pivot, int N>
[[gnu::always_inline]] inline Leaves<Pivot, N> BlockFactor::leaves(std::size_t first, double* unknowns) {
  Leaves<Pivot, N> leaves;
  for (std::size_t lane = 0; lane < N; ++lane) {
    const BlockPattern::Vertex& v = pattern_->vertices()[first + lane];
    const BlockPattern::Entry& e = pattern_->entries()[v.first_entry];
    leaves.diagonal[lane] = diagonals_.data() + v.diagonal;
    leaves.lower[lane] = lower_.data() + e.offset;
    if (!symmetric_) leaves.upper[lane] = upper_.data() + e.offset;
    leaves.target[lane] = diagonals_.data() + pattern_->pair_targets()[v.first_pair];
    leaves.target_stride[lane] = pattern_->vertices()[e.vertex].pivot;
    leaves.own[lane] = unknowns ? unknowns + v.unknown : nullptr;
    leaves.later[lane] = unknowns ? unknowns + e.unknown : nullptr;
  }
  return leaves;
}

int BlockFactor::factorize(std::span<double> unknowns) {
  int wrong = 0;
  double* const b = unknowns.data();
  const auto vertices = pattern_->vertices();
  const auto panel_of = pattern_->panel_of();
  for (std::size_t i = 0; i < vertices.size();) {
    const BlockPattern::Vertex& v = vertices[i];
    if (!panel_of.empty() && panel_of[i] != BlockPattern::no_panel) {
      const BlockPattern::Panel& panel = pattern_->panels()[panel_of[i]];
      const auto members = pattern_->panel_vertices().subspan(panel.first, panel.count);
      if (members.back() == i) {
        wrong += symmetric_ ? eliminate<true>(panel) : eliminate<false>(panel);
        for (const std::uint32_t member : members) {
          const BlockPattern::Vertex& w = vertices[member];
          if (b) with_pivot(w.pivot, [&]<int Pivot> { forward<Pivot>(w, b); });
        }
      }
      ++i;
      continue;
    }
    const int alike = v.leaves;
    with_pivot(v.pivot, [&]<int Pivot> {
      const auto eliminate_all = [&](const auto& leaves) {
        wrong +=
            symmetric_ ? leaves.template eliminate<true>(v.positives) : leaves.template eliminate<false>(v.positives);
      };
      if (alike == 2) return eliminate_all(leaves<Pivot, 2>(i, b));
      if (alike == 1) return eliminate_all(leaves<Pivot, 1>(i, b));
      wrong += symmetric_ ? eliminate<Pivot, true>(v) : eliminate<Pivot, false>(v);
      if (b) forward<Pivot>(v, b);
    });
    i += static_cast<std::size_t>(std::max(alike, 1));
  }
  return wrong;
}

// Both substitutions keep the vertex' own unknowns in registers: the compiler must assume that the arrays alias, and
// each sum would wait for its own store.
template <int Pivot>
void BlockFactor::forward(const BlockPattern::Vertex& v, double* b) const {
  const double* const d = diagonals_.data() + v.diagonal;
  double y[Pivot];
  unroll<Pivot>([&](auto k) {
    y[k] = b[v.unknown + k];
    unroll<k>([&](auto j) { y[k] -= d[k * Pivot + j] * y[j]; });
    b[v.unknown + k] = y[k];
  });
  for (const auto& e : pattern_->entries().subspan(v.first_entry, v.entry_count)) {
    const double* l = lower_.data() + e.offset;
    for (int r = 0; r < e.width; ++r, l += Pivot) {
      double sum = l[0] * y[0];
      for (int k = 1; k < Pivot; ++k) sum += l[k] * y[k];
      b[e.unknown + r] -= sum;
    }
  }
}

template <int Pivot, bool Symmetric>
void BlockFactor::backward(const BlockPattern::Vertex& v, double* b) const {
  const double* const d = diagonals_.data() + v.diagonal;
  double x[Pivot];
  unroll<Pivot>([&](auto k) {
    x[k] = b[v.unknown + k];
    if constexpr (Symmetric) x[k] *= d[k * Pivot + k];
  });
  const double* const off_diagonal = Symmetric ? lower_.data() : upper_.data();
  for (const auto& e : pattern_->entries().subspan(v.first_entry, v.entry_count)) {
    const double* u = off_diagonal + e.offset;
    for (int r = 0; r < e.width; ++r, u += Pivot) {
      const double later = b[e.unknown + r];
      unroll<Pivot>([&](auto k) { x[k] -= u[k] * later; });
    }
  }
  unroll<Pivot>([&](auto from_last) {
    constexpr int k = Pivot - 1 - from_last;
    unroll<Pivot - 1 - k>([&](auto right) {
      constexpr int j = k + 1 + right;
      x[k] -= d[Symmetric ? j * Pivot + k : k * Pivot + j] * x[j];
    });
    if constexpr (!Symmetric) x[k] *= d[k * Pivot + k];
    b[v.unknown + k] = x[k];
  });
}

void BlockFactor::solve(std::span<double> unknowns) {
  for_each_forward([&](const BlockPattern::Vertex& v) {
    with_pivot(v.pivot, [&]<int Pivot> { forward<Pivot>(v, unknowns.data()); });
  });
  finish(unknowns);
}

namespace {

/// Leaves for backward substitution alone, which needs less of them. `off_diagonal`: their blocks.
template <int Pivot, int N>
[[gnu::always_inline]] inline Leaves<Pivot, N> factored_leaves(const BlockPattern& pattern, std::size_t first,
                                                               double* diagonals, double* off_diagonal,
                                                               double* unknowns) {
  Leaves<Pivot, N> leaves;
  for (std::size_t lane = 0; lane < N; ++lane) {
    const BlockPattern::Vertex& v = pattern.vertices()[first + lane];
    const BlockPattern::Entry& e = pattern.entries()[v.first_entry];
    leaves.diagonal[lane] = diagonals + v.diagonal;
    leaves.lower[lane] = leaves.upper[lane] = off_diagonal + e.offset;
    leaves.own[lane] = unknowns + v.unknown, leaves.later[lane] = unknowns + e.unknown;
  }
  return leaves;
}

}  // namespace

void BlockFactor::finish(std::span<double> unknowns) {
  double* const b = unknowns.data();
  double *const diagonals = diagonals_.data(), *const off_diagonal = symmetric_ ? lower_.data() : upper_.data();
  const auto vertices = pattern_->vertices();
  for (std::size_t end = vertices.size(); end > 0;) {
    const int alike = end > 1 && vertices[end - 2].leaves == 2 ? 2 : std::min<int>(vertices[end - 1].leaves, 1);
    const BlockPattern::Vertex& v = vertices[end - 1];
    with_pivot(v.pivot, [&]<int Pivot> {
      const auto finish_all = [&](const auto& leaves) {
        symmetric_ ? leaves.template finish<true>() : leaves.template finish<false>();
      };
      if (alike == 2) return finish_all(factored_leaves<Pivot, 2>(*pattern_, end - 2, diagonals, off_diagonal, b));
      if (alike == 1) return finish_all(factored_leaves<Pivot, 1>(*pattern_, end - 1, diagonals, off_diagonal, b));
      symmetric_ ? backward<Pivot, true>(v, b) : backward<Pivot, false>(v, b);
    });
    end -= static_cast<std::size_t>(std::max(alike, 1));
  }
}

}  // namespace iota::solver
