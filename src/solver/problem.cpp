// SPDX-License-Identifier: Apache-2.0
#include "solver/problem.h"

#include "base/slack.h"
#include "solver/largest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace iota::solver {

namespace {

/// Keeps the groups of `count` values for which keeps(index of the group).
template <class T, class Keeps>
void compact(std::vector<T>& list, std::size_t count, Keeps keeps) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i * count < list.size(); ++i) {
    if (!keeps(i)) continue;
    if (kept != i)
      std::copy_n(list.begin() + static_cast<std::ptrdiff_t>(i * count), count,
                  list.begin() + static_cast<std::ptrdiff_t>(kept * count));
    ++kept;
  }
  list.resize(kept * count);
}

}  // namespace

void Problem::add_nodes(std::size_t count) {
  const std::size_t n = size() + count;
  resize_with_slack(position, n), resize_with_slack(velocity, n), resize_with_slack(mass, n);
  if (!damping.empty()) damping.resize(n);
  force.clear();
}

std::uint32_t Problem::add_node_beside(std::uint32_t neighbor) {
  const auto node = static_cast<std::uint32_t>(size());
  add_nodes(1);
  changes_.added.push_back({node, neighbor});
  return node;
}

void Problem::couple_masses(std::uint32_t a, std::uint32_t b, double m) {
  if (is_changing()) {
    if (!is_any_open(std::array{a, b})) return;
    touch(std::array{a, b});
    reserve_with_slack(mass_couplings, mass_couplings.size() + 1);
  }
  mass_couplings.push_back({a, b, m});
}

void Problem::open(std::span<const std::uint32_t> nodes) {
  is_open_.assign(size(), 0);
  for (const std::uint32_t node : nodes) {
    is_open_[node] = 1;
    mass[node] = 0;
    if (!damping.empty()) damping[node] = 0;
  }
  touch(nodes);
  std::erase_if(mass_couplings, [&](const MassCoupling& c) {
    const bool goes = is_any_open(std::array{c.a, c.b});
    if (goes) touch(std::array{c.a, c.b});
    return goes;
  });
  std::vector<std::uint8_t> goes;
  const auto note_leaving = [&](const auto& pool) {
    goes.assign(pool.items.size(), 0);
    for (std::size_t i = 0; i < pool.items.size(); ++i) {
      const auto nodes_of_item = pool.nodes_of(pool.items[i]);
      if ((goes[i] = is_any_open(nodes_of_item))) touch(nodes_of_item);
    }
  };
  const auto stays = [&](std::size_t i) { return !goes[i]; };
  for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    note_leaving(pool);
    for (std::size_t i = 0; i < pool.items.size(); ++i)
      if (goes[i]) changes_.removed_rows.push_back(pool.slots[i].unknown);
    compact(pool.items, 1, stays), compact(pool.keys, 1, stays), compact(pool.slots, 1, stays);
    compact(pool.multipliers, C::rows, stays), compact(pool.laws, C::rows, stays);
    pool.offsets.clear(), pool.states.clear();
  });
  for_each_force_pool([&](auto& pool) {
    note_leaving(pool);
    compact(pool.items, 1, stays), compact(pool.keys, 1, stays), compact(pool.slots, 1, stays);
  });
}

void Problem::fit_pools() {
  for_each_constraint_pool([]<class C>(ConstraintPool<C>& pool) {
    resize_with_slack(pool.multipliers, pool.items.size() * C::rows);
    resize_with_slack(pool.slots, pool.items.size());
    if (pool.has_laws()) pool.laws.resize(pool.multipliers.size());
    pool.states.assign(pool.laws.size(), {});
    pool.offsets.clear();
  });
  for_each_force_pool([](auto& pool) { resize_with_slack(pool.slots, pool.items.size()); });
}

void Problem::remove_nodes(std::span<const std::uint32_t> removed) {
  if (removed.empty()) return;
  std::vector<std::uint32_t> highest_first(removed.begin(), removed.end());
  std::sort(highest_first.begin(), highest_first.end(), std::greater<>());
  std::vector<std::uint32_t> number(size());
  std::iota(number.begin(), number.end(), 0u);
  for (const std::uint32_t node : highest_first) {
    const auto last = static_cast<std::uint32_t>(size() - 1);
    std::replace(number.begin() + last, number.end(), last, node);
    const auto take_last = [&](auto& list) {
      if (!list.empty()) list[node] = list.back(), list.pop_back();
    };
    take_last(position), take_last(velocity), take_last(mass), take_last(damping);
  }
  const auto renumber = [&](std::uint32_t& node) { node = number[node]; };
  for (auto& c : mass_couplings) renumber(c.a), renumber(c.b);
  for_each_constraint_pool([&](auto& pool) {
    for (auto& c : pool.items) std::for_each_n(c.nodes.begin(), c.node_count(), renumber);
  });
  for_each_force_pool([&](auto& pool) {
    for (auto& f : pool.items) std::for_each_n(f.arm.nodes.begin(), f.arm.count, renumber);
  });
}

double Problem::potential_energy(const Vec3* x, bool with_external) const {
  double energy = 0;
  for (std::size_t i = 0; i < size(); ++i) energy -= mass[i] * dot(gravity, x[i]);
  for (const auto& c : mass_couplings) energy -= c.mass * dot(gravity, x[c.a] + x[c.b]);
  for_each_force_pool([&]<class F>(const ForcePool<F>& pool) {
    if (F::is_external && !with_external) return;
    for (const auto& f : pool.items) {
      const double stored = f.energy(f.arm.value(x));
      // Infinite where ends have met: nothing in the book, as the model has it; a barrier to a search.
      if (with_external || std::isfinite(stored)) energy += stored;
    }
  });
  return energy;
}

double Problem::row_energy(const Vec3* x, double fraction) const {
  double energy = 0;
  for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    for (std::size_t i = 0; i < pool.items.size(); ++i) {
      const RowLaw* const law = pool.law(i);
      if (std::none_of(law, law + C::rows, [](const RowLaw& l) { return l.is_compliant(); })) continue;
      double g[C::rows];
      pool.items[i].value(x, fraction, g);
      for (int r = 0; r < C::rows; ++r) energy += law[r].energy(g[r]);
    }
  });
  return energy;
}

double Problem::worst_gap(const Vec3* x, double fraction, bool relative) const {
  Largest worst;
  for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t i = 0; i < pool.items.size(); ++i) {
      const C& c = pool.items[i];
      double g[3] = {};
      c.value(x, fraction, g);
      if (pool.has_laws())
        for (int r = 0; r < C::rows; ++r) g[r] = pool.law(i)[r].violation(g[r]);
      double size2 = 0;
      for (const double v : g) size2 += v * v;
      worst.add(std::sqrt(size2) / (relative ? c.reference_length() : 1));
    }
  });
  return worst.value;
}

}  // namespace iota::solver
