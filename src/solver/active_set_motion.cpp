// SPDX-License-Identifier: Apache-2.0
// The sides of bounded rows in the explicit sub-steps of the accurate mode.
#include "solver/active_set.h"
#include "solver/row_equation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iota::solver {

namespace {

/// The speed below which a row counts as at rest: a part of the largest one that its points can cause, and of its length a
/// step.
template <class C>
double little(const C& c, double size, double rate, double h) {
  return 1e-6 * (size + std::abs(rate)) + 1e-9 * c.reference_length() / h;
}

/// The rate of a row by a unit of its multiplier if no other row acted, m/s^2/N.
template <class C>
double mobility_of(const RowMotion<C>& motion, const Problem& problem, const C& c, int r) {
  double mobility = 0;
  for (int i = 0; i < c.node_count(); ++i)
    mobility += dot(motion.gradient(i, r), motion.gradient(i, r)) / problem.mass[c.nodes[i]];
  return mobility;
}

/// The time of a radian of a spring's vibration if no other row acted, s.
double time_of_radian(const RowLaw& law, double mobility) { return std::sqrt(law.compliance / mobility); }

/// Whether sub-steps would follow nothing but the vibration of a spring with both signs, which its dashpot does not make slow.
bool is_fast(const RowLaw& law, double mobility, double h) {
  constexpr double part = 1.0 / 16;  // of a step
  return law.is_compliant() && !law.is_rate && law.lower == -RowLaw::unbounded && law.upper == RowLaw::unbounded &&
         time_of_radian(law, mobility) < part * h && law.compliance * law.damping < part * h;
}

/// The direction in which a one-sided row opens.
int opening(const RowLaw& law) { return law.upper == 0 ? 1 : -1; }

}  // namespace

ActiveSet::Sides ActiveSet::begin_motion(Problem& problem, double h, Springs springs) {
  constexpr double at_once = 1e-9;  // of the step: a motor or brake that reaches its speed earlier
  Sides sides;
  bool& can_follow = sides.can_follow;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    can_follow = can_follow && !ConeConstraint<C>;
    for (std::size_t k = 0; k < pool.items.size() && can_follow; ++k) {
      const RowMotion<C> motion(problem, pool.items[k]);
      for (int r = 0; r < C::rows; ++r) {
        const RowLaw& law = pool.law(k)[r];
        RowStates::Row& state = pool.states.rows_[k * C::rows + static_cast<std::size_t>(r)];
        const double speed = motion.speed[r] - law.rate;
        const double rest = little(pool.items[k], motion.size[r], law.rate, h);
        const int side_before = state.side;
        state.start = motion.value[r], state.stretching = motion.speed[r], state.yield = 0;
        if (law == RowLaw{}) {
          state.side = 0;
        } else if (law.is_off()) {
          state.side = 1;
        } else if (law.is_compliant()) {
          const bool obeys =
              springs == Springs::obey_loads && is_fast(law, mobility_of(motion, problem, pool.items[k], r), h);
          state.side = obeys ? 0 : 1;
        } else if (state.next_side != RowStates::as_it_moves) {
          state.side = state.next_side;
        } else if (law.is_rate) {
          const bool is_at_rest = std::abs(speed) <= rest;
          // Sub-steps cannot follow what takes no time: a motor of unlimited torque turned nothing.
          const double bound = std::abs(speed > 0 ? law.upper : law.lower);
          const double soon = at_once * h * bound * mobility_of(motion, problem, pool.items[k], r);
          const bool jumps = !is_at_rest && !(std::abs(speed) >= soon);  // also where nothing can move
          state.side = static_cast<std::int8_t>(is_at_rest || jumps ? 0 : speed > 0 ? 1 : -1);
          sides.jump_any = sides.jump_any || jumps;
        } else {
          const int open = opening(law);
          const bool touches = open * motion.value[r] <= closed_gap * pool.items[k].reference_length();
          can_follow = can_follow && !(touches && open * speed < -rest);
          state.side = static_cast<std::int8_t>(touches && open * speed <= rest ? 0 : open);
        }
        if (state.side != 0 && !law.is_compliant())
          pool.multiplier(k)[r] = law.is_rate ? (state.side > 0 ? law.upper : law.lower) : 0;
        state.before = std::abs(speed), state.next_side = RowStates::as_it_moves;
        sides.are_new = sides.are_new || state.side != side_before;
        sides.stop_any = sides.stop_any || (state.side == 0 && side_before != 0 && !law.is_compliant());
      }
    }
  });
  sides.stop_any = sides.stop_any || sides.jump_any;
  return sides;
}

namespace {

/// visit(item, row, law): of the springs that obey their loads.
template <class C, class Visit>
void for_each_obeying(const ConstraintPool<C>& pool, Visit visit) {
  for (std::size_t k = 0; k < pool.items.size() && pool.has_laws(); ++k)
    for (int r = 0; r < C::rows; ++r)
      if (const RowLaw& law = pool.law(k)[r]; law.is_compliant() && pool.is_equation(k, r)) visit(k, r, law);
}

}  // namespace

void ActiveSet::note_loads(Problem& problem) {
  problem.for_each_constraint_pool([]<class C>(ConstraintPool<C>& pool) {
    for_each_obeying(pool, [&](std::size_t k, int r, const RowLaw&) {
      pool.states.rows_[k * C::rows + static_cast<std::size_t>(r)].within = pool.multiplier(k)[r];
    });
  });
}

// The rate is that of the parabola through three multipliers. With a rate of 0 a pendulum of 1e-6 m/N was 5e-5 m off after 1 s.
void ActiveSet::stretch_by_loads(Problem& problem, double h) {
  constexpr double a = inner_time, of_start = (1 - a) / a, of_inner = 1 / (a * (a - 1)), of_end = (2 - a) / (1 - a);
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for_each_obeying(pool, [&](std::size_t k, int r, const RowLaw& law) {
      RowStates::Row& state = pool.states.rows_[k * C::rows + static_cast<std::size_t>(r)];
      const double lambda = pool.multiplier(k)[r];
      state.start = law.compliance * lambda;
      state.stretching = law.compliance / h * (of_start * state.before + of_inner * state.within + of_end * lambda);
    });
  });
}

double ActiveSet::largest_vibration(const Problem& problem) {
  double largest = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for_each_obeying(pool, [&](std::size_t k, int r, const RowLaw& law) {
      const RowMotion<C> motion(problem, pool.items[k]);
      const double off = motion.value[r] - law.compliance * pool.multiplier(k)[r];
      const double radian = time_of_radian(law, mobility_of(motion, problem, pool.items[k], r));
      largest = std::max(largest, std::hypot(off, radian * motion.speed[r]));
    });
  });
  return largest;
}

bool ActiveSet::release_motion(Problem& problem) {
  bool released = false;
  problem.for_each_constraint_pool([&](auto& pool) {
    for (std::size_t row = 0; row < pool.laws.size(); ++row) {
      RowStates::Row& state = pool.states.rows_[row];
      if (state.side != 0) continue;
      double& lambda = pool.multipliers[row];
      state.before = lambda;
      const RowLaw& law = pool.laws[row];
      if (lambda >= law.lower && lambda <= law.upper) continue;
      state.side = static_cast<std::int8_t>(lambda > law.upper ? 1 : -1);
      lambda = std::clamp(lambda, law.lower, law.upper);
      state.before = 0, released = true;
    }
  });
  return released;
}

double ActiveSet::find_change(Problem& problem, double h, double least) {
  constexpr double beyond = 1e-3;  // of a bound: reached early enough
  double part = 1;
  const auto note = [&](RowStates::Row& state, int next_side, double until) {
    if (until < least) state.next_side = static_cast<std::int8_t>(next_side);
    part = std::min(part, until);
  };
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size() && pool.has_laws(); ++k) {
      const RowMotion<C> motion(problem, pool.items[k]);
      for (int r = 0; r < C::rows; ++r) {
        const RowLaw& law = pool.law(k)[r];
        RowStates::Row& state = pool.states.rows_[k * C::rows + static_cast<std::size_t>(r)];
        if (law == RowLaw{} || law.is_off() || law.is_compliant()) continue;
        if (state.side == 0) {
          const double lambda = pool.multiplier(k)[r], bound = std::clamp(lambda, law.lower, law.upper);
          if (std::abs(lambda - bound) > beyond * std::max(std::abs(bound), std::abs(state.before)))
            note(state, lambda > bound ? 1 : -1, (bound - state.before) / (lambda - state.before));
        } else if (law.is_rate) {
          const double speed = state.side * (motion.speed[r] - law.rate);
          if (!(speed < -little(pool.items[k], motion.size[r], law.rate, h))) continue;
          note(state, 0, state.before / (state.before - speed));
        }
      }
    }
  });
  return part;
}

double ActiveSet::longest_step(const Problem& problem, double h, Springs springs) {
  constexpr double of_radian = 1, of_decay = 2;
  double longest = std::numeric_limits<double>::infinity();
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size() && pool.has_laws(); ++k) {
      const RowLaw* const law = pool.law(k);
      if (std::none_of(law, law + C::rows, [](const RowLaw& l) { return l.is_compliant() && !l.is_off(); })) continue;
      const RowMotion<C> motion(problem, pool.items[k]);
      for (int r = 0; r < C::rows; ++r) {
        if (!law[r].is_compliant() || law[r].is_off()) continue;
        const double mobility = mobility_of(motion, problem, pool.items[k], r);
        if (springs == Springs::obey_loads && is_fast(law[r], mobility, h)) continue;
        longest =
            std::min({longest, of_radian * time_of_radian(law[r], mobility), of_decay / (mobility * law[r].damping)});
      }
    }
  });
  return longest;
}

}  // namespace iota::solver
