// SPDX-License-Identifier: Apache-2.0
#include "island/kept_orders.h"

#include <algorithm>

namespace iota::island {

void KeptOrders::read(const model::Model& model) {
  const auto& [rings, ends, work] = model.eliminations;
  clear();
  const std::uint32_t count = model.rings.slot_count();
  const bool fit = !ends.empty() && work.size() == ends.size() && ends.back() == rings.size() &&
                   std::is_sorted(ends.begin(), ends.end()) &&
                   std::all_of(rings.begin(), rings.end(), [&](std::uint32_t ring) { return ring < count; });
  if (!fit) return;
  ends_ = ends, work_ = work;
  index_of_ring_.assign(count, model::none);
  for (std::uint32_t i = 0; i < rings.size(); ++i) index_of_ring_[rings[i]] = i;
}

void KeptOrders::find(std::span<const std::uint32_t> rings, solver::KnownOrder& order) const {
  order.clear();
  const auto index_of = [&](std::uint32_t ring) {
    return ring < index_of_ring_.size() ? index_of_ring_[ring] : model::none;
  };
  if (rings.empty() || index_of(rings.front()) == model::none) return;
  const auto end = std::upper_bound(ends_.begin(), ends_.end(), index_of(rings.front()));
  const std::uint32_t first = end == ends_.begin() ? 0 : end[-1];
  if (*end - first != rings.size()) return;
  order.work = work_[static_cast<std::size_t>(end - ends_.begin())];
  order.nodes.assign(rings.size(), model::none);
  for (std::uint32_t node = 0; node < rings.size(); ++node) {
    const std::uint32_t index = index_of(rings[node]);
    if (index < first || index >= *end) return order.clear();
    order.nodes[index - first] = node;
  }
}

}  // namespace iota::island
