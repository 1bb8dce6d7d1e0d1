// SPDX-License-Identifier: Apache-2.0
#include "solver/general/dense.h"
#include "solver/general/general.h"

#include <algorithm>

namespace iota::solver {

namespace {

constexpr double sufficient = 1e-4;      // required share of the predicted decrease (Armijo)
constexpr double shortest_step = 1e-12;  // of the Newton direction
constexpr double singular = 1e-12;       // singular values below it times the largest count as zero
constexpr double stationary = 1e-9;      // |J' f| / (|J| |f|) below it: |f| has a minimum there, but no zero

double half_square(std::span<const double> f) {
  double sum = 0;
  for (const double v : f) sum += v * v;
  return std::isfinite(sum) ? 0.5 * sum : std::numeric_limits<double>::infinity();
}

double norm(std::span<const double> v) { return std::sqrt(2 * half_square(v)); }

/// Newton's direction d = -J^-1 f, shortened until 1/2 |f|^2 falls: by a parabola through the known values,
/// between a tenth and a half at a time. If J is singular, d is the shortest least-squares solution. Source:
/// Dennis and Schnabel, Numerical Methods for Unconstrained Optimization, 1983, chapter 6; the thesis, Appendix
/// C.4.
class NewtonRaphson final : public Solver {
  Ending search(NonlinearProblem& problem, std::span<double> x, const SolverOptions& options) override {
    const std::size_t n = problem.size();
    std::vector<double> f(n), trial_f(n), trial(n), direction(n), gradient(n);
    Dense jacobian(n, n);
    DenseLu lu;
    problem.evaluate(x, f);
    double value = half_square(f);
    if (!std::isfinite(value)) return {0, "the equations are not finite at the first guess"};

    for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
      if (largest(f) <= options.tolerance) return {iteration, "converged"};
      calc_jacobian(problem, x, jacobian.values);
      if (!std::isfinite(largest(jacobian.values))) return {iteration, "the Jacobian is not finite"};
      for (std::size_t i = 0; i < n; ++i) direction[i] = -f[i];
      if (lu.factorize(jacobian)) {
        lu.solve(direction);
      } else {
        direction = calc_svd(jacobian).solve(direction, singular);
      }
      std::fill(gradient.begin(), gradient.end(), 0.0);
      double slope = 0;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) gradient[j] += jacobian(i, j) * f[i];
      for (std::size_t j = 0; j < n; ++j) slope += gradient[j] * direction[j];
      if (norm(gradient) <= stationary * norm(jacobian.values) * norm(f))
        return {iteration, "the equations come no nearer to zero here: a minimum of their size, and no root"};
      if (!(slope < 0)) return {iteration, "round-off: no direction is better"};

      double t = 1, trial_value = 0;
      while (true) {
        for (std::size_t i = 0; i < n; ++i) trial[i] = x[i] + t * direction[i];
        problem.evaluate(trial, trial_f);
        trial_value = half_square(trial_f);
        if (trial_value <= value + sufficient * t * slope) break;
        const double bend = trial_value - value - t * slope;
        const double best = std::isfinite(bend) ? -0.5 * slope * t * t / bend : 0;
        t = std::clamp(best, 0.1 * t, 0.5 * t);
        if (t < shortest_step) return {iteration, "stuck: no step along Newton's direction is better"};
      }
      std::copy(trial.begin(), trial.end(), x.begin());
      f.swap(trial_f);
      value = trial_value;
    }
    return {options.max_iterations, largest(f) <= options.tolerance ? "converged" : "out of iterations"};
  }
};

}  // namespace

std::unique_ptr<Solver> make_newton_raphson() { return std::make_unique<NewtonRaphson>(); }

}  // namespace iota::solver
