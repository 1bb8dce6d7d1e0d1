// SPDX-License-Identifier: Apache-2.0
// Accelerations, and the projection of a state that nearly satisfies the constraints.
#include "solver/largest.h"
#include "solver/newton.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace iota::solver {

void Newton::find_accelerations(Problem& problem, std::span<Vec3> accelerations) {
  assembly_.load_rates(problem);
  (void)assembly_.factor_and_solve(problem, Stage::projection(), problem.position.data(), Hessian::none);
  for (std::size_t i = 0; i < problem.size(); ++i) accelerations[i] = -assembly_.step_of(static_cast<std::uint32_t>(i));
  const std::span<const double> step = assembly_.step();
  shares_.clear();  // rows of accelerations have no gaps
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k)
      for (int r = 0; r < C::rows; ++r) pool.multiplier(k)[r] = -step[pool.slots[k].unknown + r];
  });
}

// Relative; what the rows lack goes into the residuals. A row with a hold has moved by its rate for `time` seconds;
// a spring that obeys its load has the stretch that is set.
double Newton::find_gaps(const Problem& problem, double time) {
  const std::span<double> residuals = assembly_.residuals();
  std::fill(residuals.begin(), residuals.end(), 0.0);
  Largest worst;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      double* const row = residuals.data() + pool.slots[k].unknown;
      const double per_length = 1 / pool.items[k].reference_length();
      pool.value(k, problem.position.data(), 1, row);
      for (int r = 0; r < C::rows; ++r) {
        if (!pool.is_equation(k, r))
          row[r] = 0;
        else if (pool.has_laws() && (pool.law(k)[r].is_rate || pool.law(k)[r].is_compliant()))
          row[r] -= pool.states.start(k * C::rows + static_cast<std::size_t>(r)) + pool.law(k)[r].rate * time;
        worst.add(std::abs(row[r]) * per_length);
      }
    }
  });
  return worst.value;
}

// One matrix for all: the positions change by little.
bool Newton::project_state(Problem& problem, double time) {
  constexpr int most_passes = 4;
  constexpr double clean = 1e-13, sufficient = 1e-10;  // of a length
  double gap = find_gaps(problem, time);
  (void)assembly_.factor_and_solve(problem, Stage::projection(), problem.position.data(), Hessian::none);
  for (int pass = 0; pass < most_passes && gap > clean; ++pass) {
    if (pass > 0) assembly_.solve();
    for (std::size_t i = 0; i < problem.size(); ++i)
      problem.position[i] -= assembly_.step_of(static_cast<std::uint32_t>(i));
    const double before = std::exchange(gap, find_gaps(problem, time));
    if (!(gap < before)) break;
  }
  const Wanted wanted;
  impulses_.assign(problem.adds_impulses() ? assembly_.unknown_count() : 0, 0.0);
  for (int pass = 0; pass < most_passes && find_rates(problem, wanted) > 0; ++pass) {
    assembly_.solve();
    add_step_to_velocities(problem);
  }
  add_impulses(problem);
  // Two bodies that share two points know their distance from places that were rounded far from the origin: nothing meets
  // both lengths.
  const double blur =
      8 * std::numeric_limits<double>::epsilon() * largest_component(problem.origin) / reference_length();
  return gap <= std::clamp(blur, sufficient, closed_gap);
}

}  // namespace iota::solver
