// SPDX-License-Identifier: Apache-2.0
#include "solver/runge_kutta.h"

#include "solver/active_set.h"
#include "solver/largest.h"
#include "solver/row_equation.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace iota::solver {

namespace {

constexpr int stages = 7;
using Row = std::array<double, stages>;
using Matrix = std::array<Row, stages>;

/// Weights of the slopes in each stage; the last row is that of the step.
constexpr Matrix for_velocity{{{},
                               {1.0 / 5},
                               {3.0 / 40, 9.0 / 40},
                               {44.0 / 45, -56.0 / 15, 32.0 / 9},
                               {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                               {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                               {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}}};
/// The fifth-order weights minus the fourth-order ones.
constexpr Row error_of_velocity{71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

/// Positions are integrals of velocities by the same weights: x = x0 + c h v0 + h^2 sum_j (A A)_ij a_j.
constexpr Row times_matrix(const Row& row) {
  Row out{};
  for (int i = 0; i < stages; ++i)
    for (int j = 0; j < stages; ++j) out[j] += row[i] * for_velocity[i][j];
  return out;
}
constexpr Matrix for_position = [] {
  Matrix out{};
  for (int i = 0; i < stages; ++i) out[i] = times_matrix(for_velocity[i]);
  return out;
}();
constexpr Row error_of_position = times_matrix(error_of_velocity);

constexpr double sum_of(const Row& row) {
  double sum = 0;
  for (const double weight : row) sum += weight;
  return sum;
}

constexpr int inner_stage = 3;
static_assert(sum_of(for_velocity[inner_stage]) - ActiveSet::inner_time < 1e-15 &&
              ActiveSet::inner_time - sum_of(for_velocity[inner_stage]) < 1e-15);

/// Power of the forces that have no energy, W.
struct Power {
  double external = 0, dissipated = 0;
};
Power calc_power(const Problem& problem, double h) {
  const Vec3 *const x = problem.position.data(), *const v = problem.velocity.data();
  Power power;
  problem.for_each_drag_of_damping(
      [&](std::uint32_t node, const Vec3& drag) { power.dissipated += dot(drag, v[node]); });
  for (std::size_t i = 0; i < problem.force.size(); ++i) power.external += dot(problem.force[i], v[i]);
  for (const BodyTorque& t : problem.torques) {
    const BodyTorque::Forces forces = t.forces([&](std::uint32_t node) { return x[node]; });
    for (std::uint32_t i = 0; i < t.count; ++i) power.external += dot(forces[i], v[t.nodes[i]]);
  }
  problem.for_each_force_pool([&]<class F>(const ForcePool<F>& pool) {
    for (const auto& f : pool.items) {
      const Vec3 e = f.arm.value(x), before = e - f.arm.rate(v);
      power.dissipated += f.dissipation(before, e, ForceStage::at_an_instant());
      if constexpr (std::is_same_v<F, RadialForce>)
        power.external += f.external_work(before, e, ForceStage::at_an_instant()) + f.power_of_time(e, h / 64);
      if constexpr (std::is_same_v<F, VelocityForce>) power.external += f.work(before, e, ForceStage::at_an_instant());
    }
  });
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size() && pool.has_laws(); ++k) {
      const RowMotion<C> motion(problem, pool.items[k]);
      for (int r = 0; r < C::rows; ++r) {
        const RowLaw& law = pool.law(k)[r];
        const double lambda = pool.multiplier(k)[r], speed = motion.speed[r];
        if (law.is_compliant() && pool.is_equation(k, r)) continue;  // it obeys its load
        if (law.is_rate)
          power.external -= lambda * law.rate, power.dissipated += lambda * (speed - law.rate);
        else if (law.is_compliant())  // what it does not store
          power.dissipated += (lambda - std::clamp(motion.value[r] / law.compliance, law.lower, law.upper)) * speed;
      }
    }
  });
  return power;
}

}  // namespace

void RungeKutta::begin(Newton& newton, Problem& problem) {
  for (auto& slope : slopes_) slope.resize(problem.size());
  newton.find_accelerations(problem, slopes_[0]);
  position_.assign(problem.position.begin(), problem.position.end());
  velocity_.assign(problem.velocity.begin(), problem.velocity.end());
}

bool RungeKutta::step(Newton& newton, Problem& problem, double h, double start) {
  external_work_ = dissipated_ = 0;
  const auto add_work = [&](double weight) {
    if (weight == 0) return;
    const Power power = calc_power(problem, h);
    external_work_ += weight * h * power.external, dissipated_ += weight * h * power.dissipated;
  };
  const Row& weights = for_velocity[stages - 1];
  add_work(weights[0]);
  for (int stage = 1; stage < stages; ++stage) {
    const double time = sum_of(for_velocity[stage]) * h;
    problem.set_times_of_laws(start + time, start + time);
    for (std::size_t i = 0; i < problem.size(); ++i) {
      Vec3 kick, moved;
      for (int j = 0; j < stage; ++j)
        kick += for_velocity[stage][j] * slopes_[j][i], moved += for_position[stage][j] * slopes_[j][i];
      problem.velocity[i] = velocity_[i] + h * kick;
      problem.position[i] = position_[i] + time * velocity_[i] + h * h * moved;
    }
    if (stage == stages - 1) break;
    newton.find_accelerations(problem, slopes_[stage]);
    if (stage == inner_stage && problem.has_laws()) ActiveSet::note_loads(problem);
    add_work(weights[stage]);
  }
  if (problem.has_laws()) ActiveSet::stretch_by_loads(problem, h);  // those of the last stage, at the end
  return newton.project_state(problem, h);
}

void RungeKutta::end(Newton& newton, Problem& problem) { newton.find_accelerations(problem, slopes_[stages - 1]); }

RungeKutta::Error RungeKutta::estimate_error(double h) const {
  Largest position, velocity;  // squared; not a number if any is
  for (std::size_t i = 0; i < position_.size(); ++i) {
    Vec3 kick, moved;
    for (int j = 0; j < stages; ++j)
      kick += error_of_velocity[j] * slopes_[j][i], moved += error_of_position[j] * slopes_[j][i];
    position.add(dot(moved, moved)), velocity.add(dot(kick, kick));
  }
  return {h * h * std::sqrt(position.value), h * std::sqrt(velocity.value)};
}

void RungeKutta::accept(const Problem& problem) {
  slopes_.front().swap(slopes_.back());
  std::copy(problem.position.begin(), problem.position.end(), position_.begin());
  std::copy(problem.velocity.begin(), problem.velocity.end(), velocity_.begin());
}

void RungeKutta::reject(Problem& problem) const {
  std::copy(position_.begin(), position_.end(), problem.position.begin());
  std::copy(velocity_.begin(), velocity_.end(), problem.velocity.begin());
}

}  // namespace iota::solver
