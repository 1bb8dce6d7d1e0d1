// SPDX-License-Identifier: Apache-2.0
#include "solver/problem.h"

#include "base/slack.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

void Problem::add_nodes(std::size_t count) {
  const std::size_t n = size() + count;
  resize_with_slack(position, n), resize_with_slack(velocity, n), resize_with_slack(mass, n);
  force.clear();
}

void Problem::remove_nodes(std::span<const std::uint32_t> removed) {
  std::vector<std::uint32_t> highest_first(removed.begin(), removed.end());
  std::sort(highest_first.begin(), highest_first.end(), std::greater<>());
  for (const std::uint32_t node : highest_first) {
    const auto last = static_cast<std::uint32_t>(size() - 1);
    if (node != last)
      for_each_reference([&](std::uint32_t& named) {
        if (named == last) named = node;
      });
    const auto take_last = [&](auto& list) { list[node] = list.back(), list.pop_back(); };
    take_last(position), take_last(velocity), take_last(mass);
  }
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
  double worst = 0;
  for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t i = 0; i < pool.items.size(); ++i) {
      const C& c = pool.items[i];
      double g[3] = {};
      c.value(x, fraction, g);
      if (pool.has_laws())
        for (int r = 0; r < C::rows; ++r) g[r] = pool.law(i)[r].violation(g[r]);
      double size2 = 0;
      for (const double v : g) size2 += v * v;
      const double size = std::sqrt(size2) / (relative ? c.reference_length() : 1);
      if (!(size <= worst)) worst = size;
    }
  });
  return worst;
}

}  // namespace iota::solver
