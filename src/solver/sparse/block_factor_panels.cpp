// SPDX-License-Identifier: Apache-2.0
// The vertices of a panel, eliminated together as dense columns.
#include "solver/sparse/block_factor.h"
#include "solver/sparse/pivot_block.h"

#include <algorithm>
#include <array>

namespace iota::solver {

namespace {

constexpr std::uint32_t widest_product = BlockPattern::max_pivot;
constexpr std::uint32_t chunk_strips = 16;    // of a product on the stack
constexpr std::uint32_t entries_at_once = 6;  // of a panel's last vertex: their products read the same strips

}  // namespace

template <bool Symmetric>
int BlockFactor::eliminate(const BlockPattern::Panel& panel) {
  stride_ = std::size_t{panel.columns} * strip_rows;
  number_rows(panel);
  gather<Symmetric>(panel);
  int wrong = 0;
  for (const std::uint32_t v : pattern_->panel_vertices().subspan(panel.first, panel.count)) {
    const BlockPattern::Vertex& vertex = pattern_->vertices()[v];
    with_pivot(vertex.pivot,
               [&]<int Pivot> { wrong += factor_columns<Symmetric, Pivot>(vertex, row_of_[v], panel.rows); });
  }
  store<Symmetric>(panel);
  update_later<Symmetric>(panel);
  return wrong;
}

template int BlockFactor::eliminate<true>(const BlockPattern::Panel&);
template int BlockFactor::eliminate<false>(const BlockPattern::Panel&);

void BlockFactor::number_rows(const BlockPattern::Panel& panel) {
  const auto members = pattern_->panel_vertices().subspan(panel.first, panel.count);
  std::uint32_t row = 0;
  for (const std::uint32_t v : members) row_of_[v] = row, row += pattern_->vertices()[v].pivot;
  const BlockPattern::Vertex& last = pattern_->vertices()[members.back()];
  for (const auto& e : pattern_->entries().subspan(last.first_entry, last.entry_count))
    row_of_[e.vertex] = row, row += e.width;
}

/// visit(offset of a value below the diagonal, its index in the panel).
template <class Visit>
void BlockFactor::for_each_below(const BlockPattern::Panel& panel, Visit visit) const {
  for (const std::uint32_t v : pattern_->panel_vertices().subspan(panel.first, panel.count)) {
    const BlockPattern::Vertex& vertex = pattern_->vertices()[v];
    const auto entries = pattern_->entries().subspan(vertex.first_entry, vertex.entry_count);
    with_pivot(vertex.pivot, [&]<int Pivot> {
      for (const auto& e : entries) {
        std::size_t offset = e.offset;
        for (std::uint32_t r = 0; r < e.width; ++r, offset += Pivot) {
          const std::size_t index = index_in_panel(row_of_[e.vertex] + r, row_of_[v]);
          for (std::size_t c = 0; c < Pivot; ++c) visit(offset + c, index + c * strip_rows);
        }
      }
    });
  }
}

template <bool Symmetric>
void BlockFactor::gather(const BlockPattern::Panel& panel) {
  const std::size_t size = strips_in(panel.rows) * stride_;
  std::fill_n(panel_lower_.begin(), size, 0.0);
  if constexpr (!Symmetric) std::fill_n(panel_upper_.begin(), size, 0.0);
  for (const std::uint32_t v : pattern_->panel_vertices().subspan(panel.first, panel.count)) {
    const BlockPattern::Vertex& vertex = pattern_->vertices()[v];
    const std::uint32_t pivot = vertex.pivot;
    for (std::uint32_t r = 0; r < pivot; ++r)
      for (std::uint32_t c = 0; c < pivot; ++c)
        panel_lower_[index_in_panel(row_of_[v] + r, row_of_[v] + c)] = diagonals_[vertex.diagonal + r * pivot + c];
  }
  for_each_below(panel, [&](std::size_t offset, std::size_t index) {
    panel_lower_[index] = lower_[offset];
    if constexpr (!Symmetric) panel_upper_[index] = upper_[offset];
  });
}

template <bool Symmetric>
void BlockFactor::store(const BlockPattern::Panel& panel) {
  for_each_below(panel, [&](std::size_t offset, std::size_t index) {
    lower_[offset] = panel_lower_[index];
    if constexpr (!Symmetric) upper_[offset] = panel_upper_[index];
  });
}

// Updates by the previous columns, then the pivot block, then the rows below it. Strips are calculated whole: what that
// leaves above the diagonal is never read.
template <bool Symmetric, int Pivot>
[[gnu::flatten]] int BlockFactor::factor_columns(const BlockPattern::Vertex& vertex, std::uint32_t at,
                                                 std::uint32_t rows) {
  const std::uint32_t first = at / strip_rows, end = strips_in(rows);
  const int depth = static_cast<int>(at);
  const auto subtract_product = [&](std::vector<double>& from, const std::vector<double>& of) {
    double product[chunk_strips * strip_rows * Pivot];
    for (std::uint32_t s = first; s < end; s += chunk_strips) {
      const std::uint32_t strips = std::min(chunk_strips, end - s);
      double* x = from.data() + s * stride_;
      multiply_strips(product, x, static_cast<int>(strips), of.data(), at, Pivot, depth, stride_);
      const double* p = product;
      for (std::uint32_t i = 0; i < strips; ++i, x += stride_, p += strip_rows * Pivot)
        for (int j = 0; j < strip_rows * Pivot; ++j) x[at * strip_rows + static_cast<std::uint32_t>(j)] -= p[j];
    }
  };
  if (depth > 0) {
    subtract_product(panel_lower_, panel_upper_);
    if constexpr (!Symmetric) subtract_product(panel_upper_, panel_lower_);
  }
  int wrong = 0;
  double d[Pivot][Pivot];
  for (std::uint32_t r = 0; r < Pivot; ++r)
    for (std::uint32_t c = 0; c < (Symmetric ? r + 1 : Pivot); ++c)
      d[r][c] = panel_lower_[index_in_panel(at + r, at + c)];
  factor_pivot_block<Symmetric>(
      d, [&](int k, double pivot) { wrong += k < vertex.positives ? !(pivot > 0) : !(pivot < 0); });
  for (int r = 0; r < Pivot; ++r)
    for (int c = 0; c < (Symmetric ? r + 1 : Pivot); ++c) diagonals_[vertex.diagonal + r * Pivot + c] = d[r][c];
  using Rows __attribute__((vector_size(strip_rows * sizeof(double)), aligned(8), may_alias)) = double;
  for (std::uint32_t s = first; s < end; ++s) {  // like factor_row_below, by columns of eight rows
    auto* const l = reinterpret_cast<Rows*>(panel_lower_.data() + s * stride_ + at * strip_rows);
    auto* const u = reinterpret_cast<Rows*>(panel_upper_.data() + s * stride_ + at * strip_rows);
    Rows left[Pivot], right[Pivot];
    unroll<Pivot>([&](auto k) {
      left[k] = l[k];
      if constexpr (Symmetric) {
        right[k] = left[k];
        unroll<k>([&](auto j) { right[k] -= right[j] * d[k][j]; });
        left[k] = right[k] * d[k][k];
      } else {
        right[k] = u[k];
        unroll<k>([&](auto j) {
          left[k] -= left[j] * d[j][k];
          right[k] -= right[j] * d[k][j];
        });
        left[k] *= d[k][k];
      }
      l[k] = left[k], u[k] = right[k];
    });
  }
  return wrong;
}

// The last vertex of a panel has coupled all later ones of its entries with each other, so each of these has entries for
// those after it.
template <bool Symmetric>
void BlockFactor::update_later(const BlockPattern::Panel& panel) {
  const BlockPattern::Vertex& last = pattern_->vertices()[pattern_->panel_vertices()[panel.first + panel.count - 1]];
  for (std::uint32_t begin = 0; begin < last.entry_count; begin += entries_at_once)
    update_columns<Symmetric>(panel, last, begin, std::min(begin + entries_at_once, last.entry_count));
}

namespace {

/// Subtracts `rows` rows of strips with `columns` columns, of which p points to the first that is wanted, from row-major ones.
inline void subtract_rows(double* to, std::uint32_t to_stride, const double* p, std::uint32_t row,
                          std::uint32_t columns, int width, std::uint32_t rows) {
  const auto subtract = [&](auto count) {
    for (std::uint32_t i = 0; i < rows; ++i, to += to_stride) {
      for (int c = 0; c < count; ++c) to[c] -= p[row + static_cast<std::uint32_t>(c) * strip_rows];
      if (++row == strip_rows) row = 0, p += columns * strip_rows;
    }
  };
  if (width == 3) return subtract(std::integral_constant<int, 3>{});  // the usual one
  subtract(width);
}

}  // namespace

// Subtracts products of the panel from the columns of the entries [begin, end) of its last vertex.
template <bool Symmetric>
void BlockFactor::update_columns(const BlockPattern::Panel& panel, const BlockPattern::Vertex& last,
                                 std::uint32_t begin, std::uint32_t end) {
  constexpr std::uint32_t most_groups = entries_at_once;
  const auto entries = pattern_->entries().subspan(last.first_entry, last.entry_count);
  const auto all = static_cast<std::uint32_t>(entries.size());
  const auto row_at = [&](std::uint32_t e) { return row_of_[entries[e].vertex]; };
  const auto later = [&](std::uint32_t e) -> const BlockPattern::Vertex& {
    return pattern_->vertices()[entries[e].vertex];
  };
  const int depth = static_cast<int>(panel.columns);

  struct Group {  // neighboring entries of at most six columns together
    std::uint32_t first, end, row, columns;
  };
  std::array<Group, most_groups> groups;
  std::array<const BlockPattern::Entry*, most_groups> targets{},
      reached{};  // of each entry, in these strips and the next
  std::uint32_t count = 0;
  for (std::uint32_t e = begin; e < end; ++count) {
    Group& g = groups[count];
    g.first = e, g.row = row_at(e), g.columns = 0;
    for (std::uint32_t i = 0; i < 2 && e < end && g.columns + entries[e].width <= widest_product; ++i, ++e) {
      g.columns += entries[e].width;
      targets[e - begin] = pattern_->entries().data() + later(e).first_entry;
    }
    g.end = e;
  }

  static_assert(most_groups * widest_product + strip_rows < chunk_strips * strip_rows,
                "diagonal blocks are in one chunk");
  double product[chunk_strips * strip_rows * widest_product];
  std::uint32_t first_entry = begin;  // of the strips at hand
  for (std::uint32_t s = row_at(begin) / strip_rows; s < strips_in(panel.rows); s += chunk_strips) {
    const std::uint32_t rows_end = std::min((s + chunk_strips) * strip_rows, panel.rows);
    while (first_entry + 1 < all && row_at(first_entry + 1) <= s * strip_rows) ++first_entry;
    for (const Group& g : std::span(groups).first(count)) {
      const std::uint32_t strip = std::max(s, g.row / strip_rows), row = strip * strip_rows;
      // Multiplies rows with columns of the panel, and subtracts the products from blocks of the triangle `values`, and
      // from diagonal blocks on request.
      const auto multiply_and_subtract = [&](const double* x, const double* y, double* values, double* diagonals) {
        multiply_strips(product, x + strip * stride_, static_cast<int>(strips_in(rows_end) - strip), y, g.row,
                        static_cast<int>(g.columns), depth, stride_);
        std::uint32_t column = 0;
        for (std::uint32_t a = g.first; a < g.end; column += entries[a].width, ++a) {
          const int width = entries[a].width;
          const std::uint32_t pivot = later(a).pivot;
          // From the block that begins at row `at`, what of its rows is at hand.
          const auto subtract = [&](double* to, std::uint32_t at, std::uint32_t rows) {
            const std::uint32_t begin_row = std::max(at, row), end_row = std::min(at + rows, rows_end);
            const double* p = product + ((begin_row - row) / strip_rows * g.columns + column) * strip_rows;
            subtract_rows(to + (begin_row - at) * pivot, pivot, p, begin_row % strip_rows, g.columns, width,
                          end_row - begin_row);
          };
          if (diagonals && first_entry <= a) subtract(diagonals + later(a).diagonal, row_at(a), entries[a].width);
          const BlockPattern::Entry* target = targets[a - begin];
          std::uint32_t b = std::max(first_entry, a + 1);
          if (b == all) continue;
          for (std::uint32_t at = row_at(b); b < all && at < rows_end; at += entries[b++].width) {
            while (target->vertex != entries[b].vertex) ++target;
            subtract(values + target->offset, at, entries[b].width);
          }
          reached[a - begin] = target;
        }
      };
      multiply_and_subtract(panel_lower_.data(), panel_upper_.data(), lower_.data(), diagonals_.data());
      if constexpr (!Symmetric) multiply_and_subtract(panel_upper_.data(), panel_lower_.data(), upper_.data(), nullptr);
    }
    targets = reached;
  }
}

}  // namespace iota::solver
