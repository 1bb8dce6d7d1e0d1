// SPDX-License-Identifier: Apache-2.0
// Velocities that constraints allow.
#include "solver/largest.h"
#include "solver/newton.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace iota::solver {

void Newton::project_velocities(Problem& problem, double h, bool as_solved, std::span<const Vec3> impulses) {
  std::copy(problem.position.begin(), problem.position.end(), x_.begin());
  std::copy(problem.velocity.begin(), problem.velocity.end(), u_saved_.begin());
  has_laws_ = problem.has_laws();  // which may have been lent since the last solve
  impulses_.resize(has_laws_ ? assembly_.unknown_count() : 0);
  if (has_laws_) ActiveSet::begin_impulses(problem, as_solved);
  bool found = project_onto_sides(problem, h, as_solved, impulses);
  while (has_laws_ && !as_solved && found && ActiveSet::release_impulses(problem, impulses_)) {
    std::copy(u_saved_.begin(), u_saved_.end(), problem.velocity.begin());
    found = project_onto_sides(problem, h, as_solved, impulses);
  }

  if (found && problem.is_isolated()) give_back_momentum(problem, impulses);
}

void Newton::find_velocity_change(const Problem& problem, std::span<const double> rates, std::span<Vec3> change) {
  constexpr int passes = 3;  // the later ones take away what compliance and round-off leave
  std::copy(problem.position.begin(), problem.position.end(), x_.begin());
  std::fill(change.begin(), change.end(), Vec3{});
  Stage stage = Stage::projection();
  stage.fraction = 0;
  for (int pass = 0; pass < passes; ++pass) {
    const std::span<double> residuals = assembly_.residuals();
    std::fill(residuals.begin(), residuals.end(), 0.0);
    auto rate = rates.begin();
    problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
      for (std::size_t k = 0; k < pool.items.size(); ++k) {
        const C& c = pool.items[k];
        double* const row = residuals.data() + pool.slots[k].unknown;
        for (int r = 0; r < C::rows; ++r) row[r] = *rate++;
        const Gradients<C> gradients(c, x_.data(), 0);
        for (int i = 0; i < c.node_count(); ++i) {
          Vec3 rows[C::rows];
          gradients.of_node(i, rows);
          for (int r = 0; r < C::rows; ++r) row[r] += dot(rows[r], change[c.nodes[i]]);
        }
      }
    });
    if (pass == 0)
      (void)assembly_.factor_and_solve<false>(problem, stage, x_.data(), Hessian::none);
    else
      assembly_.solve();
    for (std::size_t i = 0; i < change.size(); ++i) change[i] -= assembly_.step_of(static_cast<std::uint32_t>(i));
  }
}

// Nearly redundant rows have huge multipliers that cancel only to round-off. Where nothing outside holds on, momentum is
// given back by a translation, which no internal constraint notices.
void Newton::give_back_momentum(Problem& problem, std::span<const Vec3> impulses) const {
  double mass = 0;
  Vec3 lost;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    mass += problem.mass[i];
    lost += problem.mass[i] * (u_saved_[i] - problem.velocity[i]);
  }
  for (const auto& c : problem.mass_couplings) {
    mass += 2 * c.mass;
    lost += c.mass * (u_saved_[c.a] - problem.velocity[c.a] + u_saved_[c.b] - problem.velocity[c.b]);
  }
  for (const Vec3& impulse : impulses) lost += impulse;
  for (Vec3& v : problem.velocity) v += (1 / mass) * lost;
}

// min |v - velocity|_M with G v = rate: one linear solve with the matrix of a projection without curvature. Redundant
// rows (a closed loop in a plane) can leave no pivot at the usual compliance, so it may have to rise. So it may for an arm that
// is straight but for a hair while its end is driven inwards: its elbow would have to leave at any speed.
bool Newton::project_onto_sides(Problem& problem, double h, bool as_solved, std::span<const Vec3> impulses) {
  constexpr double leverage = 10;  // of speeds over those that drive them
  const double mass = std::accumulate(problem.mass.begin(), problem.mass.end(), 0.0);
  double fastest = 0;
  for (const Vec3& v : problem.velocity) fastest = std::max(fastest, norm(v));
  for (const double compliance : {1e-12, 1e-9, 1e-6, 1e-3}) {
    Stage stage = Stage::projection(compliance);
    stage.fraction = as_solved ? 1 : 0;
    std::fill(impulses_.begin(), impulses_.end(), 0.0);
    const double energy = problem.kinetic_energy();
    const double drive = std::max(find_rates(problem, h, impulses), fastest);
    (void)assembly_.factor_and_solve<false>(problem, stage, x_.data(), Hessian::none);
    add_step_to_velocities(problem);
    for (int again = 0; again < 2 && find_rates(problem, h, {}) > 0; ++again) {  // compliance and round-off
      assembly_.solve();
      add_step_to_velocities(problem);
    }
    const double projected = problem.kinetic_energy();
    double most = energy * (1 + 1e-9);
    if (h > 0) most += 0.5 * mass * (leverage * drive) * (leverage * drive);  // energy may come in
    if (std::isfinite(projected) && (projected <= most || !impulses.empty())) return true;
    std::copy(u_saved_.begin(), u_saved_.end(), problem.velocity.begin());
  }
  return false;
}

// What the velocities miss in each row goes into the residuals. Returns the largest; zero where it is round-off.
double Newton::find_rates(const Problem& problem, double h, std::span<const Vec3> impulses) {
  constexpr double round_off = 2e-15;  // of the largest velocity
  const std::span<double> residuals = assembly_.residuals();
  Largest worst;
  std::fill(residuals.begin(), residuals.end(), 0.0);
  for (std::size_t i = 0; i < impulses.size(); ++i) {
    double* const r = residuals.data() + assembly_.unknown_of(static_cast<std::uint32_t>(i));
    r[0] = -impulses[i].x, r[1] = -impulses[i].y, r[2] = -impulses[i].z;
  }
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const C& c = pool.items[k];
      double* const row = residuals.data() + pool.slots[k].unknown;
      if (h > 0) {
        double start[C::rows], end[C::rows];
        c.value(problem.position.data(), 0, start);
        c.value(problem.position.data(), 1, end);
        for (int r = 0; r < C::rows; ++r) row[r] = (end[r] - start[r]) / h;
      }
      const Gradients<C> gradients(c, problem.position.data(), 0);
      for (int i = 0; i < c.node_count(); ++i) {
        Vec3 rows[C::rows];
        gradients.of_node(i, rows);
        for (int r = 0; r < C::rows; ++r) row[r] += dot(rows[r], problem.velocity[c.nodes[i]]);
      }
      if (pool.has_laws())
        for (int r = 0; r < C::rows; ++r) {
          if (pool.law(k)[r].hold) row[r] -= pool.law(k)[r].rate;
          if (pool.states[k * C::rows + r].side != 0) row[r] = 0;
        }
      for (int r = 0; r < C::rows; ++r) worst.add(std::abs(row[r]));
    }
  });
  Largest speed;
  for (const Vec3& v : problem.velocity) speed.add(largest_component(v));
  return worst.value <= round_off * speed.value ? 0 : worst.value;
}

void Newton::add_step_to_velocities(Problem& problem) {
  for (std::size_t i = 0; i < impulses_.size(); ++i) impulses_[i] -= assembly_.step()[i];
  for (std::size_t i = 0; i < problem.size(); ++i)
    problem.velocity[i] -= assembly_.step_of(static_cast<std::uint32_t>(i));
}

}  // namespace iota::solver
