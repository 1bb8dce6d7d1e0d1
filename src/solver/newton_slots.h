// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/newton.h"

#include <algorithm>

namespace iota::solver {

template <class C>
void Newton::set_slots(ConstraintPool<C>& pool, std::size_t item, const BlockPattern::ConstraintSlot& where) const {
  auto& slots = pool.slots[item];
  slots.unknown = where.unknown, slots.diagonal = where.diagonal, slots.stride = where.stride;
  std::copy_n(where.gradients.begin(), C::max_nodes, slots.gradients.begin());
  if constexpr (C::has_curvature)
    for (int a = 0, pair = 0; a < pool.items[item].node_count(); ++a)
      for (int b = a + 1; b < pool.items[item].node_count(); ++b, ++pair)
        slots.pairs[pair] = pattern_.pair_slot(pool.items[item].nodes[a], pool.items[item].nodes[b]);
}

template <class F>
void Newton::set_slots(ForcePool<F>& pool, std::size_t item) const {
  const ForceArm& arm = pool.items[item].arm;
  for (std::uint32_t a = 0, pair = 0; a < arm.count; ++a)
    for (std::uint32_t b = a + 1; b < arm.count; ++b, ++pair)
      pool.slots[item].pairs[pair] = pattern_.pair_slot(arm.nodes[a], arm.nodes[b]);
}

}  // namespace iota::solver
