// SPDX-License-Identifier: Apache-2.0
#include "solver/active_set.h"

#include "base/slack.h"
#include "solver/row_equation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace iota::solver {

namespace {

struct Bounds {
  double lower, upper;
};

Bounds bounds_of(const RowLaw& law, const Stage& stage) {
  if (stage.is_projection()) return {law.lower_impulse(), law.upper_impulse()};
  return {law.lower, law.upper};
}

/// Which rows have velocities that differ from their rates by more than the curvature of their coordinates explains within a
/// step. Otherwise the mid-point rule makes a motor that was just switched on oscillate around its target speed.
template <class C>
std::array<bool, C::rows> are_off_speed(const Problem& problem, const C& c, const std::array<double, C::rows>& rates,
                                        const Stage& stage) {
  constexpr double bent = 1e-3, still = 1e-9;
  Vec3 mean;  // which an internal row does not notice
  for (int i = 0; i < c.node_count() && c.is_internal(); ++i)
    mean += (1.0 / c.node_count()) * problem.velocity[c.nodes[i]];
  const Gradients<C> gradients(c, problem.position.data(), stage.fraction_start);
  Vec3 rows[C::rows];
  std::array<double, C::rows> speeds{};
  for (int i = 0; i < c.node_count(); ++i) {
    gradients.of_node(i, rows);
    for (std::size_t r = 0; r < speeds.size(); ++r) speeds[r] += dot(rows[r], problem.velocity[c.nodes[i]] - mean);
  }
  std::array<bool, C::rows> are_off{};
  for (std::size_t r = 0; r < speeds.size(); ++r) {
    const double excess = std::abs(speeds[r] - rates[r]) * stage.h - still * c.reference_length();
    if (!(excess > 0)) continue;
    double largest = std::abs(rates[r]);
    for (int i = 0; i < c.node_count(); ++i) {
      gradients.of_node(i, rows);
      largest += norm(rows[r]) * norm(problem.velocity[c.nodes[i]] - mean);
    }
    are_off[r] = excess > bent * largest * stage.h;
  }
  return are_off;
}

/// The displacement of each row by a multiplier of 1, if its points were free: sum |G|^2 / (inertia m).
template <class C>
std::array<double, C::rows> natural_compliances(const Problem& problem, const C& c, const Stage& stage, const Vec3* x) {
  std::array<double, C::rows> sum{};
  const Gradients<C> gradients(c, x, stage.fraction);
  for (int i = 0; i < c.node_count(); ++i) {
    Vec3 rows[C::rows];
    gradients.of_node(i, rows);
    for (std::size_t r = 0; r < sum.size(); ++r)
      sum[r] += dot(rows[r], rows[r]) / (stage.inertia * problem.mass[c.nodes[i]]);
  }
  return sum;
}

}  // namespace

template <class C>
void ActiveSet::set_cone(ConstraintPool<C>& pool, std::size_t k, ConeState state) {
  const bool is_open = state.mode == ConeState::Mode::open;
  for (int r = 0; r < C::rows; ++r) {
    const int side = is_open ? 1 : C::is_tangent(r) ? state.direction : 0;
    pool.states.rows_[k * C::rows + static_cast<std::size_t>(r)].side = static_cast<std::int8_t>(side);
  }
}

template void ActiveSet::set_cone(ConstraintPool<ContactConstraint>&, std::size_t, ConeState);

template <class C>
void ActiveSet::begin_cone(ConstraintPool<C>& pool, std::size_t k, const Problem& problem, const Stage& stage) {
  const C& c = pool.items[k];
  double g[C::rows];
  pool.value(k, problem.position.data(), stage.fraction_start, g);
  double* const lambda = pool.multiplier(k);
  if (stage.is_projection())
    for (int r = 0; r < C::rows; ++r)
      if (C::is_tangent(r)) lambda[r] = 0;
  ConeState state_before = c.state_of(lambda);
  if (stage.is_projection() && state_before.mode != ConeState::Mode::open) state_before = {ConeState::Mode::slips, 1};
  if (state_before.mode == ConeState::Mode::open) std::fill_n(lambda, C::rows, 0.0);
  set_cone(pool, k, state_before);
  std::array<double, C::rows> rates{};
  if constexpr (BouncingConstraint<C>)
    for (int r = 0; r < C::rows; ++r) rates[static_cast<std::size_t>(r)] = c.rate_of(r, stage.fraction_start);
  const std::array<bool, C::rows> are_off = are_off_speed(problem, c, rates, stage);
  for (int r = 0; r < C::rows; ++r) {
    RowStates::Row& state = pool.states.rows_[k * C::rows + r];
    state.start = g[r] - c.compliance_of(r) * lambda[r], state.side_before = state.side, state.slips_on = 0;
    state.off_speed = C::is_tangent(r) && are_off[static_cast<std::size_t>(r)];
    if constexpr (BouncingConstraint<C>)
      if (c.meets && !C::is_tangent(r)) state.side_before = 1;
  }
}

template <class C>
ConeState ActiveSet::choose_state(const ConstraintPool<C>& pool, std::size_t k, const Problem& problem,
                                  const Stage& stage, const Vec3* x) {
  const C& c = pool.items[k];
  double g[C::rows];
  pool.value(k, x, stage.fraction, g);
  for (int r = 0; r < C::rows; ++r)
    if (C::is_tangent(r)) {
      g[r] -= pool.states.start(k * C::rows + static_cast<std::size_t>(r));
      if (!stage.is_projection()) g[r] -= way_of(c, r, stage);
    }
  const ConeState next =
      c.switch_state(pool.states.cone(k * C::rows), pool.multiplier(k), g,
                     natural_compliances(problem, c, stage, x).data(), stage.tolerance * c.reference_length());
  // Positions and impulses have no friction.
  return stage.is_projection() && next.mode != ConeState::Mode::open ? ConeState{ConeState::Mode::slips, 1} : next;
}

void ActiveSet::begin(Problem& problem, const Stage& stage, const Vec3* x) {
  fewest_wrong_ = std::numeric_limits<int>::max(), stalled_ = 0;
  softening_ = 0, has_softened_ = false, followed_ = 0;
  has_many_cones_ = stage.is_heap && problem.pool_of<ContactConstraint>().items.size() > few_cones;
  if (has_many_cones_) reserve_for_rare_use(changes_, problem.multiplier_count());
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      if constexpr (ConeConstraint<C>) {
        begin_cone(pool, k, problem, stage);
        continue;
      }
      double g[C::rows] = {};
      const RowLaw* const law = pool.law(k);
      if (std::any_of(law, law + C::rows,
                      [](const RowLaw& l) { return !l.is_off() && (l.is_rate || l.is_compliant()); }))
        pool.value(k, problem.position.data(), stage.fraction_start, g);
      std::array<bool, C::rows> are_off{};
      if (std::any_of(law, law + C::rows, [](const RowLaw& l) { return l.is_rate; })) {
        std::array<double, C::rows> rates;
        std::transform(law, law + C::rows, rates.begin(), [](const RowLaw& l) { return l.rate; });
        are_off = are_off_speed(problem, pool.items[k], rates, stage);
      }
      for (int r = 0; r < C::rows; ++r) {
        const Bounds bounds = bounds_of(law[r], stage);
        double& lambda = pool.multiplier(k)[r];
        RowStates::Row& state = pool.states.rows_[k * C::rows + r];
        state.start = g[r], state.yield = 0;
        state.side = lambda <= bounds.lower ? -1 : lambda >= bounds.upper ? 1 : 0;
        if (state.side != 0) lambda = state.side < 0 ? bounds.lower : bounds.upper;
        state.side_before = state.side;
        state.off_speed = law[r].is_rate && are_off[static_cast<std::size_t>(r)];
      }
    }
  });
  close_touching(problem, stage, x);
}

void ActiveSet::close_touching(Problem& problem, const Stage& stage, const Vec3* x) {
  if (stage.begins_softly || stage.is_projection() || !problem.has_used<ContactConstraint>()) return;
  auto& pool = problem.pool_of<ContactConstraint>();
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    const std::size_t normal = k * ContactConstraint::rows;
    const double little = stage.tolerance * pool.items[k].reference_length();
    if (pool.states.cone(normal).mode != ConeState::Mode::open || std::abs(pool.states.start(normal)) > little)
      continue;
    double g[ContactConstraint::rows];
    pool.value(k, x, stage.fraction, g);
    if (std::abs(g[0]) <= little) set_cone(pool, k, {});
  }
}

// With the force of the step before, resistance went on with that of an impact, a hundred times the weight, and in flight.
bool ActiveSet::follow_reactions(Problem& problem, const Stage& stage) {
  constexpr double same = 1e-3;
  constexpr int most = 4;
  if (!problem.has_used<ResistanceConstraint>() || followed_ == most) return false;
  auto& pool = problem.pool_of<ResistanceConstraint>();
  const auto& contacts = problem.pool_of<ContactConstraint>();
  bool any = false;
  for (std::size_t i = 0; i < pool.items.size(); ++i) {
    const ResistanceConstraint& c = pool.items[i];
    if (c.contacts[0] == ResistanceConstraint::none || (c.begins && stage.is_mid_point())) continue;
    RowLaw& law = *pool.law(i);
    const double bound = c.bound([&](std::uint32_t k) { return std::max(0.0, -contacts.multiplier(k)[0]); });
    if (std::abs(bound - law.upper) <= same * std::max(bound, law.upper)) continue;
    law.lower = -bound, law.upper = bound, any = true;
    RowStates::Row& state = pool.states.rows_[i];
    if (bound == 0 && state.side == 0) state.side = 1;
    if (state.side != 0) *pool.multiplier(i) = state.side * bound;
  }
  followed_ += any;
  return any;
}

int ActiveSet::count_met(const Problem& problem) {
  int count = 0;
  problem.for_each_constraint_pool([&](const auto& pool) {
    for (const RowStates::Row& state : pool.states.rows_)
      count += state.side == 0 && (state.side_before != 0 || state.off_speed);
  });
  return count;
}

template <class C>
void ActiveSet::note(ConstraintPool<C>& pool, std::size_t k, int first, int count) {
  if (!has_many_cones_) return;
  for (int r = first; r < first + count; ++r) {
    RowStates::Row& row = pool.states.rows_[k * C::rows + static_cast<std::size_t>(r)];
    double& multiplier = pool.multiplier(k)[r];
    changes_.push_back({&row, row, &multiplier, multiplier});
  }
}

bool ActiveSet::choose(Problem& problem, const Stage& stage, const Vec3* x) {
  constexpr int before_softening = 1, patience = 6;
  constexpr std::int8_t to_slip = 4;
  const bool one_only = stalled_ > patience;
  has_changed_cones_ = false;
  changes_.clear();
  int wrong = 0;
  bool changed = false;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      if constexpr (ConeConstraint<C>) {
        const ConeState now = pool.states.cone(k * C::rows), next = choose_state(pool, k, problem, stage, x);
        if (now == next) continue;
        has_changed_cones_ = true;
        note(pool, k, 0, C::rows);
        std::int8_t& slips_on = pool.states.rows_[k * C::rows].slips_on;
        if (now.mode == ConeState::Mode::sticks && next.mode == ConeState::Mode::open) slips_on = to_slip;
        if (slips_on > 0 && now.slips() && next.mode == ConeState::Mode::sticks) {
          --slips_on, changed = true;
          continue;
        }
        ++wrong;
        if (one_only && changed && !has_many_cones_) continue;
        set_cone(pool, k, next), changed = true;
        if (next.mode == ConeState::Mode::open) std::fill_n(pool.multiplier(k), C::rows, 0.0);
        continue;
      }
      const C& c = pool.items[k];
      const RowLaw* const law = pool.law(k);
      RowStates::Row* const states = pool.states.rows_.data() + k * C::rows;
      double* const lambda = pool.multiplier(k);
      bool any = false, any_free = false;
      for (int r = 0; r < C::rows; ++r) {
        const Bounds bounds = bounds_of(law[r], stage);
        any = any || bounds.lower != bounds.upper;
        any_free = any_free || states[r].side == 0;
      }
      if (!any) continue;
      double g[C::rows];
      std::array<double, C::rows> scale{};
      pool.value(k, x, stage.fraction, g);
      if (any_free) scale = natural_compliances(problem, c, stage, x);
      for (int r = 0; r < C::rows; ++r) {
        const Bounds bounds = bounds_of(law[r], stage);
        RowStates::Row& state = states[r];
        if (bounds.lower == bounds.upper) continue;
        const RowEquation equation = equation_of(pool, k, r, g[r], stage);
        const double open = equation.value - equation.softness * lambda[r];
        const double little = stage.tolerance * c.reference_length();
        int side = state.side;
        if (side == 0) {
          const double soft = scale[r] + equation.softness;
          if (open + soft * (lambda[r] - bounds.lower) < -little) side = -1;
          if (open + soft * (lambda[r] - bounds.upper) > little) side = 1;
        } else if (side * open < -little) {
          side = 0;
        }
        if (side == state.side) continue;
        ++wrong;
        if (one_only && changed) continue;
        note(pool, k, r, 1);
        state.side = static_cast<std::int8_t>(side), changed = true;
        if (side != 0) lambda[r] = side < 0 ? bounds.lower : bounds.upper;
      }
    }
  });
  if (wrong < fewest_wrong_)
    fewest_wrong_ = wrong, stalled_ = 0;
  else if (wrong > 0)
    ++stalled_;
  if (softening_ > 0 ? wrong == 0 : stalled_ > before_softening && !has_softened_) {
    soften(problem, stage, x);
    return true;
  }
  return changed;
}

void ActiveSet::take_back() {
  for (const Change& change : changes_) *change.row = change.row_before, *change.multiplier = change.multiplier_before;
}

int ActiveSet::times_for_sides(const Stage& stage) const {
  if (!has_changed_cones_) return NewtonSettings::more_for_sides;
  if (has_many_cones_) return 1;
  return stage.begins_softly && stage.is_mid_point() ? NewtonSettings::more_for_cones : NewtonSettings::more_for_sides;
}

void ActiveSet::soften_cones(Problem& problem, double by) {
  for (ContactConstraint& c : problem.items_of<ContactConstraint>()) c.softening = by;
}

// Most of 40 hinges with friction stick at the start of a fall: a beam, whose rows switched for hundreds of iterations (590
// medians of the time without friction, and the step was given up). Rows that yield by a part of their natural compliance
// find their sides in two iterations, for any number of hinges; less and less of it leads to the sides without it.
void ActiveSet::soften(Problem& problem, const Stage& stage, const Vec3* x) {
  constexpr double first = 0.03, less = 0.03, last = 3e-8;
  softening_ = !has_softened_ ? first : softening_ > 1.5 * last ? less * softening_ : 0;
  has_softened_ = true, fewest_wrong_ = std::numeric_limits<int>::max(), stalled_ = 0;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if (ConeConstraint<C> || !pool.has_laws()) return;
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const auto natural = natural_compliances(problem, pool.items[k], stage, x);
      for (std::size_t r = 0; r < natural.size(); ++r)
        if (pool.laws[k * C::rows + r].is_rate) pool.states.rows_[k * C::rows + r].yield = softening_ * natural[r];
    }
  });
}

void ActiveSet::begin_impulses(Problem& problem) {
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      double g[C::rows];
      pool.value(k, problem.position.data(), 0, g);
      for (int r = 0; r < C::rows; ++r) {
        const RowLaw& law = pool.law(k)[r];
        RowStates::Row& state = pool.states.rows_[k * C::rows + r];
        const double touching = closed_gap * pool.items[k].reference_length();
        const bool pulls = law.upper_impulse() > 0 && g[r] > -touching;
        const bool pushes = law.lower_impulse() < 0 && g[r] < touching;
        state.side = pulls || pushes ? 0 : 1;
      }
    }
  });
}

void ActiveSet::begin_impulses_after_step(Problem& problem) {
  problem.for_each_constraint_pool([](auto& pool) {
    for (std::size_t row = 0; row < pool.laws.size(); ++row)
      if (pool.laws[row].is_compliant()) pool.states.rows_[row].side = 1;
  });
}

bool ActiveSet::release_impulses(Problem& problem, std::span<const double> impulses) {
  bool released = false;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    for (std::size_t row = 0; row < pool.laws.size(); ++row) {
      const double impulse = impulses[pool.slots[row / C::rows].unknown + row % C::rows];
      const RowLaw& law = pool.laws[row];
      RowStates::Row& state = pool.states.rows_[row];
      if (state.side != 0 || (impulse >= law.lower_impulse() && impulse <= law.upper_impulse())) continue;
      state.side = 1, released = true;
      if constexpr (ConeConstraint<C>) set_cone(pool, row / C::rows, {ConeState::Mode::open});
    }
  });
  return released;
}

bool ActiveSet::switch_impacts(Problem& problem, double h, std::span<const double> impulses) {
  constexpr double noise = 1e-9;  // of an impulse
  bool any = false;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if constexpr (BouncingConstraint<C>)
      for (std::size_t k = 0; k < pool.items.size(); ++k) {
        const ConeState now = pool.states.cone(k * C::rows);
        if (now.mode == ConeState::Mode::open) continue;
        const double* const late = impulses.data() + pool.slots[k].unknown;
        double impulse[C::rows];
        for (int r = 0; r < C::rows; ++r) impulse[r] = h * pool.multiplier(k)[r] + late[r];
        if (impulse[0] > noise * std::abs(late[0])) {
          set_cone(pool, k, {ConeState::Mode::open}), any = true;
          continue;
        }
        if (!now.slips()) {  // by less than the cone allows, or it begins to slip
          C& c = pool.items[k];
          const double size = std::hypot(impulse[1], impulse[2]), most = -c.friction * impulse[0];
          if (!(size > most + noise * std::abs(impulse[0]))) continue;
          for (int i = 0; i < 2; ++i) c.drags[i] = -c.friction * impulse[1 + i] / size;
          c.stays_slipping = true;
          set_cone(pool, k, {ConeState::Mode::slips, 1}), any = true;
          continue;
        }
        if (pool.items[k].stays_slipping || !pool.states.has_been_met(k * C::rows)) continue;
        const RowMotion<C> motion(problem, pool.items[k]);
        double power = 0, size = 0;
        for (int r = 1; r < C::rows; ++r)
          power -= impulse[r] * motion.speed[r], size += std::abs(impulse[r]) * motion.size[r];
        if (power > noise * size) set_cone(pool, k, {}), any = true;
      }
  });
  return any;
}

}  // namespace iota::solver
