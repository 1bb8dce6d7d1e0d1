// SPDX-License-Identifier: Apache-2.0
// The first iterate of Newton's method.
#include "solver/integrator.h"

#include "solver/row_masses.h"

#include <algorithm>

namespace iota::solver {

// Summed on first use, as the mid-point scheme does not need them, and only where masses are coupled. Zero where masses of
// both signs cancel, as at the rim of a balanced wheel: no force tells how such a point moves.
std::span<const double> Integrator::lumped_masses(const Problem& problem) {
  if (problem.mass_couplings.empty()) return problem.mass;
  if (lumped_mass_.empty()) {
    sum_row_masses(problem, lumped_mass_);
    for (std::size_t i = 0; i < lumped_mass_.size(); ++i)
      if (lumped_mass_[i] < 1e-6 * problem.mass[i]) lumped_mass_[i] = 0;
  }
  return lumped_mass_;
}

// End point: the positions to which the forces of the last step would carry the points,
//   x0 + h v0 + (f - G0' lambda) / (inertia m).
// This saves half an iteration to one over x0 + h v0. Coupled masses are lumped, which is exact for neighbors with equal
// accelerations. Mid-point: two sweeps over x0 + h v0 restore the lengths. From the same guess, whose forces are means of
// the last step there, a chain of 4096 two-point links takes 3.8 iterations instead of 3.0, a net of 16 x 16 bars 19 instead
// of 12; with two sweeps after it a hub 2.6 instead of 3.0, and the net 19 again.
void Integrator::make_guess(const Problem& problem, const Stage& stage) {
  const std::size_t n = problem.size();
  const std::span<Vec3> guess = newton_.displacement();
  std::fill(guess.begin(), guess.end(), Vec3{});
  if (stage.is_projection()) return;
  if (stage.is_mid_point()) return sweep_lengths(problem, stage);

  const std::span<const double> mass = lumped_masses(problem);
  const std::span<Vec3> flight = newton_.room();
  for (std::size_t i = 0; i < n; ++i) guess[i] = mass[i] * problem.gravity;
  if (problem.has_used_forces())
    for (std::size_t i = 0; i < n; ++i) flight[i] = problem.position[i] + stage.h * problem.velocity[i];
  for (std::size_t i = 0; i < problem.force.size(); ++i) guess[i] += problem.force[i];
  for (const BodyTorque& t : problem.torques) {
    const BodyTorque::Forces forces = t.forces([&](std::uint32_t node) { return problem.position[node]; });
    for (std::uint32_t i = 0; i < t.count; ++i) guess[t.nodes[i]] += forces[i];
  }
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const C& c = pool.items[k];
      const Gradients<C> gradients(c, problem.position.data(), stage.fraction_start);
      for (int i = 0; i < c.node_count(); ++i) {
        Vec3 rows[C::rows];
        gradients.of_node(i, rows);
        for (int r = 0; r < C::rows; ++r) guess[c.nodes[i]] -= pool.multiplier(k)[r] * rows[r];
      }
    }
  });
  const ForceStage force_stage{stage.h, false, false};
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items) {
      const Vec3 force = f.force(f.arm.value(problem.position.data()), f.arm.value(flight.data()), force_stage);
      for (std::uint32_t i = 0; i < f.arm.count; ++i) guess[f.arm.nodes[i]] += f.arm.weights[i] * force;
    }
  });
  // A stiff spring or an outdated multiplier may move points far away: then free flight is the better guess. So it is where
  // a lumped mass is zero, whose guess is not a number. With the point's own mass a cylinder on two nails took 18 iterations
  // instead of 6; with one of 1e-17 of it, guesses were wrong by a third of a length in short steps.
  const double limit = newton_.reference_length() * newton_.reference_length();
  bool are_near = true;
  for (std::size_t i = 0; i < n; ++i) {
    guess[i] *= 1 / (stage.inertia * mass[i]);
    are_near = are_near && dot(guess[i], guess[i]) < limit;
  }
  if (!are_near) std::fill(guess.begin(), guess.end(), Vec3{});
}

// Gauss-Seidel over lengths as in SHAKE (Ryckaert, Ciccotti, Berendsen 1977), along the gradients of the mid-point rule.
// A body that spins freely is then at its solution, and Newton's method only has to find the forces between bodies.
void Integrator::sweep_lengths(const Problem& problem, const Stage& stage) {
  constexpr int sweeps = 2;
  const std::span<Vec3> x = newton_.room(), guess = newton_.displacement();
  for (std::size_t i = 0; i < problem.size(); ++i) x[i] = problem.position[i] + stage.h * problem.velocity[i];
  const auto& pool = problem.pool_of<DistanceConstraint>();
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const DistanceConstraint& c = pool.items[k];
      const auto [a, b] = c.nodes;
      const double mobility_a = 1 / problem.mass[a], mobility_b = 1 / problem.mass[b];
      const Vec3 end = x[b] - x[a], mean = 0.5 * (problem.position[b] - problem.position[a] + end);
      const double slope = dot(end, mean);
      if (!(slope > 0.1 * c.length * c.length)) continue;  // turned too far for that
      double g = 0;
      pool.value(k, x.data(), stage.fraction, &g);
      const Vec3 push = (g * c.scale / (slope * (mobility_a + mobility_b))) * mean;
      guess[a] += mobility_a * push, guess[b] -= mobility_b * push;
      x[a] += mobility_a * push, x[b] -= mobility_b * push;
    }
}

}  // namespace iota::solver
