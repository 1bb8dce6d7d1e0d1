// SPDX-License-Identifier: Apache-2.0
#include "solver/problem.h"

#include "base/renumbering.h"
#include "base/slack.h"
#include "solver/largest.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace iota::solver {

namespace {

/// Takes the groups of `count` values at some indices (in order) out of a list. What lies between them moves as it is.
template <class T>
void take_out(std::vector<T>& list, std::size_t count, std::span<const std::size_t> indices) {
  if (indices.empty() || list.empty()) return;
  const auto at = [&](std::size_t index) { return list.begin() + static_cast<std::ptrdiff_t>(index * count); };
  auto end = at(indices[0]);
  for (std::size_t i = 0; i < indices.size(); ++i)
    end = std::move(at(indices[i] + 1), i + 1 < indices.size() ? at(indices[i + 1]) : list.end(), end);
  list.erase(end, list.end());
}

}  // namespace

void Problem::clear() {
  const auto clear = [](auto&... lists) { (lists.clear(), ...); };
  clear(position, velocity, force, torques, mass, damping, mass_couplings, counted_angles);
  for_each_constraint_pool([&](auto& p) {
    acting_version_ += !p.acting.empty();  // the next ones may have no laws, and all act
    clear(p.items, p.keys, p.multipliers, p.impulses, p.offsets, p.laws, p.states, p.acting, p.temporary);
  });
  for_each_force_pool([&](auto& p) { clear(p.items, p.keys); });
  changes_.clear(), is_open_.clear();
  structure_ = no_structure;
  gravity = origin = {};
  places_.clear();
  has_new_rows = false;
  standing_gap = 0, standing_steps = unsolved_steps = 0, owed_work = 0;
  used_ = 0;
}

void Problem::begin_impulses() {
  adds_impulses_ = true, has_late_impulses_ = false;
  for_each_constraint_pool([](auto& pool) { pool.impulses.assign(pool.multipliers.size(), 0.0); });
}

void Problem::add_impulses(double h) {
  for_each_constraint_pool([&](auto& pool) {
    for (std::size_t i = 0; i < pool.impulses.size(); ++i) pool.impulses[i] += h * pool.multipliers[i];
  });
}

// A spring has its force at the end of the step, and contacts add up their impulses themselves.
bool Problem::end_impulses(double h) {
  const bool adds = std::exchange(adds_impulses_, false), tells = adds && has_late_impulses_ && h > 0;
  if (!adds) return false;
  for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for (std::size_t i = 0; i < pool.impulses.size() && tells && !ConeConstraint<C>; ++i)
      if (!pool.has_laws() || !pool.laws[i].is_compliant()) pool.multipliers[i] = pool.impulses[i] / h;
    pool.impulses.clear();
  });
  return tells;
}

// From the places as they were added, so that the same origin gives the same bits.
void Problem::set_origin(const Vec3& place) {
  origin = place;
  if (place == Vec3{} && places_.empty()) return;
  if (places_.empty()) for_each_place([&](const Vec3& constant, double) { places_.push_back(constant); });
  auto added = places_.begin();
  for_each_place([&](Vec3& constant, double weight) { constant = *added++ + weight * place; });
  if (place == Vec3{}) places_.clear();
}

void Problem::add_nodes(std::size_t count) {
  const std::size_t n = size() + count;
  note_structure(count);
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
    note_change(std::array{a, b});
    reserve_with_slack(mass_couplings, mass_couplings.size() + 1);
  }
  note_structure(std::uint64_t{a} << 32 | b);
  mass_couplings.push_back({a, b, m});
}

void Problem::count(const AngleConstraint& angle, ItemKey key) {
  if (!is_any_open({angle.nodes.data(), angle.count})) return;
  reserve_with_slack(counted_angles, counted_angles.size() + 1);
  counted_angles.push_back({angle, key});
}

void Problem::open(std::span<const std::uint32_t> nodes) {
  set_origin({});
  is_open_.assign(size(), 0);
  for (const std::uint32_t node : nodes) {
    is_open_[node] = 1;
    mass[node] = 0;
    if (!damping.empty()) damping[node] = 0;
  }
  note_change(nodes);
  thread_local std::vector<std::size_t> leaving;
  const auto find_leaving = [&](const auto& items, auto nodes_of) {
    leaving.clear();
    for (std::size_t i = 0; i < items.size(); ++i)
      if (const auto nodes_of_item = nodes_of(items[i]); is_any_open(nodes_of_item))
        note_change(nodes_of_item), leaving.push_back(i);
  };
  find_leaving(mass_couplings, [](const MassCoupling& c) { return std::array{c.a, c.b}; });
  take_out(mass_couplings, 1, leaving);
  std::erase_if(counted_angles,
                [&](const CountedAngle& c) { return is_any_open({c.angle.nodes.data(), c.angle.count}); });
  for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    find_leaving(pool.items, pool.nodes_of);
    for (const std::size_t i : leaving) changes_.removed_rows.push_back(pool.slots[i].unknown);
    take_out(pool.items, 1, leaving), take_out(pool.keys, 1, leaving), take_out(pool.slots, 1, leaving);
    take_out(pool.multipliers, C::rows, leaving), take_out(pool.laws, C::rows, leaving);
    pool.offsets.clear(), pool.states.clear();
  });
  for_each_force_pool([&](auto& pool) {
    find_leaving(pool.items, pool.nodes_of);
    take_out(pool.items, 1, leaving), take_out(pool.keys, 1, leaving), take_out(pool.slots, 1, leaving);
  });
}

void Problem::fit_pools() {
  for_each_constraint_pool([]<class C>(ConstraintPool<C>& pool) {
    resize_with_slack(pool.multipliers, pool.items.size() * C::rows);
    resize_with_slack(pool.slots, pool.items.size());
    if constexpr (ConeConstraint<C>)
      for (std::size_t i = 0; i < pool.items.size(); ++i)
        for (int r = 0; r < C::rows; ++r) {
          pool.law(i)[r].is_rate = C::is_tangent(r);
          if (C::is_one_sided(r)) pool.law(i)[r].upper = 0;
        }
    if (pool.has_laws()) pool.laws.resize(pool.multipliers.size());
    pool.states.reset(pool.laws.size());
    pool.acting.clear();
    pool.offsets.clear();
  });
  for_each_force_pool([](auto& pool) { resize_with_slack(pool.slots, pool.items.size()); });
}

void Problem::note_acting(const Vec3* x) {
  bool is_other = false;
  for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if (!pool.has_laws()) {  // all act; they may have had bounds for a conflict
      if (pool.acting.empty()) return;
      is_other = is_other || std::find(pool.acting.begin(), pool.acting.end(), 0) != pool.acting.end();
      pool.acting.clear();
      return;
    }
    constexpr std::uint8_t unknown = 2;
    // Friction acts where its reaction does: bodies that were near each other counted as one, and shared their spins.
    constexpr int rows = [] {
      if constexpr (ConeConstraint<C>) return C::is_one_sided(0) ? 1 : C::rows;
      return C::rows;
    }();
    pool.acting.resize(pool.items.size(), unknown);
    for (std::size_t i = 0; i < pool.items.size(); ++i) {
      const RowLaw* const law = pool.law(i);
      std::uint8_t acts = 0;
      for (int r = 0; r < rows; ++r) acts |= law[r].acts(pool.multiplier(i)[r]);
      if (x && !acts) {
        double g[C::rows];
        pool.value(i, x, 0, g);
        for (int r = 0; r < rows; ++r) acts |= law[r].violation(g[r]) > 0;
      }
      is_other = is_other || acts != pool.acting[i];
      pool.acting[i] = acts;
    }
  });
  if (is_other) ++acting_version_;
}

void Problem::forget_acting() {
  for_each_constraint_pool([](auto& pool) { pool.acting.clear(); });
}

void Problem::remove_nodes(std::span<const std::uint32_t> removed) {
  if (removed.empty()) return;
  thread_local Renumbering number;
  number.set(size(), removed);
  number.apply(position), number.apply(velocity), number.apply(mass);
  if (!damping.empty()) number.apply(damping);
  const auto renumber = [&](std::uint32_t& node) { node = number(node); };
  for (auto& c : mass_couplings) renumber(c.a), renumber(c.b);
  for (auto& c : counted_angles) std::for_each_n(c.angle.nodes.begin(), c.angle.count, renumber);
  for_each_constraint_pool([&](auto& pool) {
    for (auto& c : pool.items) std::for_each_n(c.nodes.begin(), c.node_count(), renumber);
  });
  for_each_force_pool([&](auto& pool) {
    for (auto& f : pool.items) std::for_each_n(f.arm.nodes.begin(), f.arm.count, renumber);
  });
}

void Problem::damp_velocities(double time) {
  thread_local std::vector<Vec3> prescribed;
  prescribed.clear();
  const std::span<const AffineConstraint> affines = items_of<AffineConstraint>();
  for (const AffineConstraint& c : affines)
    if (c.is_nail()) prescribed.push_back(velocity[c.nodes[0]]);
  for (std::size_t i = 0; i < size(); ++i) velocity[i] *= std::exp(-damping_of(i) * time);
  auto own = prescribed.begin();
  for (const AffineConstraint& c : affines)
    if (c.is_nail()) velocity[c.nodes[0]] = *own++;
}

double Problem::potential_energy(const Vec3* x, bool with_external) const {
  double energy = 0;
  for (std::size_t i = 0; i < size(); ++i) energy -= mass[i] * dot(gravity, x[i]);
  for (const auto& c : mass_couplings) energy -= c.mass * dot(gravity, x[c.a] + x[c.b]);
  add_energies_of_forces(x, with_external, energy);
  return energy;
}

Problem::Potential Problem::potential(const Vec3* x) const {
  double energy = 0, moment = 0;
  for (std::size_t i = 0; i < size(); ++i) energy -= mass[i] * dot(gravity, x[i]), moment += mass[i] * norm(x[i]);
  for (const auto& c : mass_couplings) {
    const Vec3 sum = x[c.a] + x[c.b];
    energy -= c.mass * dot(gravity, sum), moment += std::abs(c.mass) * norm(sum);
  }
  add_energies_of_forces(x, false, energy);
  return {energy, norm(gravity) * moment};
}

void Problem::add_energies_of_forces(const Vec3* x, bool with_external, double& energy) const {
  for_each_force_pool([&]<class F>(const ForcePool<F>& pool) {
    if (F::is_external && !with_external) return;
    for (const auto& f : pool.items) {
      const double stored = f.energy(f.arm.value(x));
      // Infinite for coincident ends: not counted in the balance, as in the model; a barrier for a search.
      if (with_external || std::isfinite(stored)) energy += stored;
    }
  });
}

double Problem::row_energy(const Vec3* x, double fraction) const {
  double energy = 0;
  for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    for (std::size_t i = 0; i < pool.items.size(); ++i) {
      if constexpr (ConeConstraint<C>) energy += strain_energy(pool.items[i], pool.multiplier(i));
      const RowLaw* const law = pool.law(i);
      if (std::none_of(law, law + C::rows, [](const RowLaw& l) { return l.is_compliant(); })) continue;
      double g[C::rows];
      pool.items[i].value(x, fraction, g);
      for (int r = 0; r < C::rows; ++r) energy += law[r].energy(g[r]);
    }
  });
  return energy;
}

double Problem::worst_gap(const Vec3* x, double fraction, bool relative, Rows rows) const {
  Largest worst;
  for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if (rows == Rows::but_contacts && std::is_same_v<C, ContactConstraint>) return;
    for (std::size_t i = 0; i < pool.items.size(); ++i) {
      const C& c = pool.items[i];
      double g[3] = {};
      c.value(x, fraction, g);
      if (pool.has_laws())
        for (int r = 0; r < C::rows; ++r) g[r] = pool.law(i)[r].violation(g[r]);
      double size = std::abs(g[0]);
      if constexpr (C::rows > 1) {
        double size2 = 0;
        for (const double v : g) size2 += v * v;
        size = std::sqrt(size2);
      }
      worst.add(size / (relative ? c.reference_length() : 1));
    }
  });
  return worst.value;
}

}  // namespace iota::solver
