// SPDX-License-Identifier: Apache-2.0
// Constraints that are violated at the start of a step: closed by moving positions only, or held at their gap.
#include "solver/back_off.h"
#include "solver/integrator.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace iota::solver {

namespace {

// Bounds of moving gaps are 10 % wider than the gaps, since the constraint gradient is singular at full extension.
constexpr double relaxation = 1.1;

}  // namespace

void Integrator::close_gaps(Problem& problem, AdvanceReport& report) {
  keeps_offsets_ = false;
  const double gap = problem.worst_gap(problem.position.data(), 0, true);
  const bool has_new_rows = std::exchange(problem.has_new_rows, false);
  const bool is_open = gap > strained_gap;
  if (!is_open) {
    problem.standing_gap = 0;
    if (!has_new_rows) return;
  }
  // An unchanged, unsolvable constraint set is tried again with exponential back-off, by one short solve.
  const bool stands = is_open && is_conservative_ && gap <= 1.001 * problem.standing_gap;
  problem.standing_steps = stands ? problem.standing_steps + 1 : 0;
  if (stands && !is_due(problem.standing_steps)) {
    keep_offsets(problem, report);
    return;
  }
  const bool are_joints_closed =
      problem.worst_gap(problem.position.data(), 0, true, Problem::Rows::but_contacts) <= strained_gap;
  energy_.measure(problem, 0);
  const double before = energy_.total;
  if (is_open) {
    find_holds(problem, problem.position.data());
    spin().note(problem, holds_);
  }
  problem.standing_gap = 0;
  if (!project_locally(problem, is_open)) {
    if (is_open && !(stands ? project_in_one_solve(problem) : project_positions(problem))) {
      keep_offsets(problem, report);
      problem.standing_gap = problem.worst_gap(problem.position.data(), 0, true);
    }
    // Bodies that move as prescribed go on: stopped here and driven on in the step, a turning plate had its energy booked in each.
    project_velocities(problem, drives_rows_ && !keeps_offsets_ ? step_length_ : 0);
  }
  if (is_open) report.spin_lost = spin().restore(problem);
  energy_.measure(problem, 0);
  const double added = energy_.total - before, kinetic = energy_.kinetic;
  report.closing_energy += added;
  // Repeated attempts must not add energy without end. And bodies that have swung into each other would be lifted in each step.
  const bool is_by_motion = is_open && are_joints_closed;
  if (!(added > 0 && (is_by_motion || (keeps_offsets_ && is_conservative_)))) return;
  (void)change_kinetic_energy(problem, added);
  report.closing_energy -= kinetic - energy_.kinetic, energy_.missing = 0;
}

// Gaps that cannot be closed are constant during the step. If nails move, a gap may be at most the one at the nails'
// final places: its row gets a bound instead of an equation. With an equation, an arm that was pulled beyond its reach
// would have to snap sideways when the pull ends (measured: 400 J to 3 kJ, against 20 J).
void Integrator::keep_offsets(Problem& problem, AdvanceReport& report) {
  report.converged = false;
  keeps_offsets_ = true;
  bool moving = false;
  problem.for_each_constraint_pool([&](const auto& pool) {
    for (const auto& c : pool.items) moving = moving || c.is_moving();
  });
  saved_position_.assign(problem.position.begin(), problem.position.end());
  if (moving) {
    problem.copy_multipliers_to(multipliers_saved_);
    problem.clear_multipliers();
    problem.clear_offsets();
    (void)share_gaps(problem, 1, report);
    problem.position.swap(saved_position_);
    problem.set_multipliers(multipliers_saved_);
  }
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    pool.offsets.resize(pool.multipliers.size());
    for (std::size_t i = 0; i < pool.items.size(); ++i) {
      double* const offset = pool.offsets.data() + i * C::rows;
      pool.items[i].value(saved_position_.data(), moving ? 1 : 0, offset);
      for (int r = 0; r < C::rows; ++r) {
        const auto row = static_cast<std::uint32_t>(i * C::rows + r);
        if (pool.has_laws() && pool.laws[row].violation(offset[r]) == 0) offset[r] = 0;
        if (!moving || !(std::abs(offset[r]) > closed_gap * pool.items[i].reference_length())) continue;
        RowLaw& law = pool.law(i)[r];
        if (ConeConstraint<C> || law.lower_impulse() == 0 || law.upper_impulse() == 0) continue;  // already bounded
        (offset[r] > 0 ? law.lower : law.upper) = 0;
        offset[r] *= relaxation;
        pool.temporary.push_back(row);
      }
    }
    if (pool.has_laws()) pool.states.resize(pool.laws.size());
  });
}

// Rows that keep_offsets has given a bound are equations again. At the end of the step: a projection of velocities before the
// next one is not in it.
void Integrator::drop_offsets(Problem& problem) {
  problem.clear_offsets();
  problem.for_each_constraint_pool([&](auto& pool) {
    if (pool.temporary.empty()) return;
    for (const std::uint32_t row : pool.temporary) pool.laws[row] = {};
    pool.temporary.clear();
    const bool none =
        std::all_of(pool.laws.begin(), pool.laws.end(), [](const RowLaw& law) { return law == RowLaw{}; });
    if (none) pool.laws.clear(), pool.states.clear();
  });
}

// Moves positions to where the rows share what cannot be closed. A row of compliance c shares with about c^-1/2 others, since
// masses hold points back: at 1e-3 alone, one link of a chain of 100 took all. Stiff rows do not converge from afar.
bool Integrator::share_gaps(Problem& problem, double fraction, AdvanceReport& report) {
  constexpr int most_rounds = 8;
  const auto size = static_cast<double>(problem.size());
  bool helped = false;
  for (std::size_t rung = row_compliances.size() - 1; rung > 0; --rung) {
    const double compliance = row_compliances[rung];
    bool solved = false;
    for (int round = 0; round < most_rounds && !solved; ++round) {
      problem.clear_multipliers();
      Stage stage = Stage::projection(compliance);
      stage.fraction = fraction, stage.max_iterations = 40;
      solved = try_step(problem, stage, report);
      // Also without convergence: from far away it takes several rounds.
      const double before = problem.worst_gap(problem.position.data(), fraction, true);
      if (!solved && !(problem.worst_gap(newton_.solution().data(), fraction, true) < 0.9 * before)) return helped;
      std::copy(newton_.solution().begin(), newton_.solution().end(), problem.position.begin());
      helped = true;
    }
    if (!solved || size * size * compliance < 1) break;
  }
  return helped;
}

bool Integrator::project_locally(Problem& problem, bool positions, std::span<const std::uint32_t> nodes) {
  make_ready(problem);
  constexpr double open = 0.1 * closed_gap;
  constexpr std::size_t most = 64;
  if (!LocalProjection::is_worthwhile(problem)) return false;
  center_.assign(nodes.begin(), nodes.end());
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t i = 0; i < pool.items.size() && center_.size() <= most; ++i) {
      double g[C::rows];
      pool.items[i].value(problem.position.data(), 0, g);
      const double limit = open * pool.items[i].reference_length();
      const auto nodes_of_item = pool.nodes_of(pool.items[i]);
      for (int r = 0; r < C::rows; ++r)
        if (!((pool.has_laws() ? pool.law(i)[r].violation(g[r]) : std::abs(g[r])) <= limit))
          center_.insert(center_.end(), nodes_of_item.begin(), nodes_of_item.end());
    }
  });
  if (!local_) local_ = std::make_unique<LocalProjection>();
  return local_->project(problem, center_, positions);
}

/// To where the rows are met at the start of the step.
bool Integrator::try_projection(Problem& problem, int iterations) {
  AdvanceReport ignored;
  problem.clear_multipliers();
  Stage stage = Stage::projection(exact_rows);
  stage.fraction = 0;
  stage.max_iterations = iterations;
  const bool solved = try_step(problem, stage, ignored);
  if (solved) std::copy(newton_.solution().begin(), newton_.solution().end(), problem.position.begin());
  return solved;
}

// Contacts yield a little in Newton's matrix of a projection: what its first iteration leaves open would become motion.
void Integrator::close_to_round_off(Problem& problem) {
  if (!problem.has_used<ContactConstraint>()) return;
  AdvanceReport ignored;
  Stage stage = Stage::projection(exact_rows);
  stage.fraction = 0, stage.tolerance = 1e-13, stage.max_iterations = 2;
  const double gap = problem.worst_gap(problem.position.data(), 0, true);
  (void)try_step(problem, stage, ignored);
  if (problem.worst_gap(newton_.solution().data(), 0, true) < gap)
    std::copy(newton_.solution().begin(), newton_.solution().end(), problem.position.begin());
}

// For an unchanged conflict. More attempts took the time of 20 to 36 frames and left the same gaps.
bool Integrator::project_in_one_solve(Problem& problem) {
  problem.copy_multipliers_to(multipliers_saved_);
  problem.clear_offsets();
  const bool solved = try_projection(problem, 8);
  if (solved) close_to_round_off(problem);
  problem.set_multipliers(multipliers_saved_);
  return solved;
}

bool Integrator::project_positions(Problem& problem) {
  make_ready(problem);
  AdvanceReport ignored;
  problem.copy_multipliers_to(multipliers_saved_);
  problem.clear_offsets();
  // In one solve; if that fails, in parts; if that fails, by soft steps, which distribute the violation over the rows.
  bool solved = try_projection(problem, 20) || close_bit_by_bit(problem);
  for (int soft = 0; soft < 3 && !solved; ++soft) {
    if (!share_gaps(problem, 0, ignored)) break;
    solved = try_projection(problem, 12);
  }
  if (solved) close_to_round_off(problem);
  problem.set_multipliers(multipliers_saved_);
  return solved;
}

// Newton's method may diverge over a distance of many links, but converge over a part of it (a fine chain pulled together
// over centimeters). Offsets hold the rest of the gap.
bool Integrator::close_bit_by_bit(Problem& problem) {
  double remaining = 1, part = 0.25;
  bool solved = false;
  for (int tries = 0; tries < 60 && remaining > 0 && part > 2e-3; ++tries) {
    part = std::min(part, remaining);
    problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
      pool.offsets.resize(pool.multipliers.size());
      for (std::size_t i = 0; i < pool.items.size(); ++i) {
        double* const offset = pool.offsets.data() + i * C::rows;
        pool.items[i].value(problem.position.data(), 0, offset);
        for (int r = 0; r < C::rows; ++r) {
          offset[r] *= (remaining - part) / remaining;
          if (pool.has_laws() && pool.law(i)[r].violation(offset[r]) == 0) offset[r] = 0;
        }
      }
    });
    solved = try_projection(problem, 10);
    if (solved)
      remaining -= part, part *= 2;
    else
      part /= 4;
  }
  problem.clear_offsets();
  return solved && !(remaining > 0);
}

}  // namespace iota::solver
