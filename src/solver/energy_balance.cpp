// SPDX-License-Identifier: Apache-2.0
#include "solver/energy_balance.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace iota::solver {

namespace {

constexpr double round_off_of_energy = 1e-14;
constexpr double of_motion = 1e-9;            // of the kinetic energy: what the tolerance of a solve may make
constexpr double most_of_held_forces = 0.05;  // of the kinetic energy: the error of a force that is held over a step
constexpr double finest = 1e-12;              // of a length: motion below it is round-off, of a body at rest
constexpr double closings = 1e-9;             // of a length: what round-off moves while gaps are closed
// Joints may return so much of the kinetic energy of what they store. Chains whose end has 1e8 times their mass need it.
constexpr double most_of_recoil = 0.05;

/// The energy of motions by this share of a length in a step, J.
double jitter_energy(const Problem& problem, double share, double reference_length, double h) {
  const double jitter = share * reference_length / h;
  return std::accumulate(problem.mass.begin(), problem.mass.end(), 0.0) * jitter * jitter;
}

/// Work, and the size of its terms, J. Its round-off is a share of that: a force of 1 N that holds something 1 m from the
/// origin still has a work of 1e-16 J, by the last bits of the place.
struct Work {
  double sum = 0, terms = 0;
  void add(double work, const Vec3& force, double distance) { sum += work, terms += norm(force) * distance; }
  void add(const Vec3& force, const Vec3& from, const Vec3& to) { add(dot(force, to - from), force, norm(to)); }
};

/// One solved (sub-)step.
struct Solved {
  const Problem& problem;
  const Newton& newton;
  const Stage& stage;

  const Vec3* start() const { return problem.position.data(); }
  const Vec3* end() const { return newton.solution().data(); }
  ForceStage force_stage() const { return {stage.h, stage.is_mid_point(), false}; }
  Vec3 velocity_at_end(std::size_t node) const {
    return problem.velocity[node] + ((stage.is_mid_point() ? 2 : 1) / stage.h) * newton.displacement()[node];
  }
  Vec3 mean_velocity(std::size_t node) const {
    return problem.velocity[node] + (0.5 / stage.h) * newton.displacement()[node];
  }
  /// visit(item, values before, values after)
  template <class C, class Visit>
  void for_each_row(const ConstraintPool<C>& pool, Visit visit) const {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      double before[C::rows], after[C::rows];
      pool.items[k].value(start(), stage.fraction_start, before);
      pool.items[k].value(end(), stage.fraction, after);
      visit(k, before, after);
    }
  }

  Work external_work() const;
  double held_force_error() const;
  double work_of_drives() const;
  void add_dissipation(StepEnergy&, std::span<const double> multipliers_before) const;
  template <class C>
  void add_dissipation_of_rows(const ConstraintPool<C>&, const double* multipliers_before, StepEnergy&) const;
  template <class C>
  double mean_speed_across(const C&, int row) const;
  double work_of_gaps() const;
  double work_of_imbalance() const;
};

// The work of grips, forces of velocities, pushes of laws, targets of points and explicit forces.
Work Solved::external_work() const {
  Work work;
  for (const auto& f : problem.items_of<GripForce>()) {
    const Vec3 e0 = f.arm.value(start()), e1 = f.arm.value(end()), force = f.force(e0, e1, force_stage());
    work.add(dot(force, e1 - e0), force, f.arm.size(end()));
  }
  for (const auto& f : problem.items_of<VelocityForce>()) {
    const Vec3 e0 = f.arm.value(start()), e1 = f.arm.value(end());
    work.add(f.work(e0, e1, force_stage()), f.force(e0, e1, force_stage()), f.arm.size(end()));
  }
  for (const auto& f : problem.items_of<RadialForce>())
    work.sum += f.external_work(f.arm.value(start()), f.arm.value(end()), force_stage());
  const std::span<const AffineConstraint> affines = problem.items_of<AffineConstraint>();
  for (std::size_t k = 0; k < affines.size(); ++k) {
    const AffineConstraint& c = affines[k];
    if (c.target == c.target_start) continue;
    const double* const l = problem.pool_of<AffineConstraint>().multiplier(k);
    for (std::uint32_t i = 0; i < c.count; ++i)
      work.add(-c.weights[i] * Vec3{l[0], l[1], l[2]}, start()[c.nodes[i]], end()[c.nodes[i]]);
  }
  for (std::size_t i = 0; i < problem.force.size(); ++i) work.add(problem.force[i], start()[i], end()[i]);
  for (const BodyTorque& t : problem.torques) work.sum += t.work(start(), end(), stage.is_mid_point());
  return work;
}

// The work of attracting poles by the end-point rule, as that of held forces, counts as work from outside.
double Solved::held_force_error() const {
  double error = 0;
  for (const auto& f : problem.items_of<RadialForce>())
    error += f.held_force_error(f.arm.value(start()), f.arm.value(end()), force_stage());
  return error;
}

// The work of moving targets, lambda dg/dt, J. A motor that does not reach its speed counts as a drive behind a slipping
// clutch: the difference is dissipated.
double Solved::work_of_drives() const {
  double work = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      if constexpr (GeneralConstraint<C>)
        if (pool.items[k].is_moving()) {
          double before[C::rows], after[C::rows];
          pool.items[k].value(end(), stage.fraction_start, before);
          pool.items[k].value(end(), stage.fraction, after);
          for (int r = 0; r < C::rows; ++r) work += pool.multiplier(k)[r] * (after[r] - before[r]);
        }
      if (pool.has_laws())
        for (int r = 0; r < C::rows; ++r)
          if (pool.law(k)[r].is_rate) work -= pool.multiplier(k)[r] * pool.law(k)[r].rate * stage.h;
    }
  });
  return work;
}

void Solved::add_dissipation(StepEnergy& energy, std::span<const double> multipliers_before) const {
  const double* before = multipliers_before.data();
  problem.for_each_constraint_pool([&](const auto& pool) {
    if (pool.has_laws() && pool.temporary.empty()) add_dissipation_of_rows(pool, before, energy);
    before += pool.multipliers.size();
  });
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items)
      energy.damped += f.dissipation(f.arm.value(start()), f.arm.value(end()), force_stage());
  });
  energy.dissipated += energy.damped;
}

// A row takes lambda dg. Of that a spring stores its part and a drive has given its rate. What is left are dashpots,
// friction and slipping clutches. The impact of a row that has just met: in the mid-point rule lambda dg is its first half, a
// projection takes the other; the end-point rule takes all at once, the impulse times the mean speed across the row.
template <class C>
void Solved::add_dissipation_of_rows(const ConstraintPool<C>& pool, const double* multipliers_before,
                                     StepEnergy& energy) const {
  for_each_row(pool, [&](std::size_t k, const double* before, const double* after) {
    if constexpr (ConeConstraint<C>)  // of what the rows have taken, their compliance stores a part
      energy.dissipated -= strain_energy(pool.items[k], pool.multiplier(k)) -
                           strain_energy(pool.items[k], multipliers_before + k * C::rows);
    for (int r = 0; r < C::rows; ++r) {
      const RowLaw& law = pool.law(k)[r];
      const double lambda = pool.multiplier(k)[r], moved = after[r] - before[r];
      const double stretched = law.stretch(after[r]) - law.stretch(before[r]);
      const bool is_free = pool.is_equation(k, r);
      if (law == RowLaw{} || law.is_off()) continue;
      if (law.is_rate)
        energy.dissipated += lambda * (moved - law.rate * stage.h);
      else if (law.is_compliant())
        energy.dissipated += is_free ? law.damping / stage.h * stretched * stretched
                                     : std::max(0.0, lambda * moved - law.energy(after[r]) + law.energy(before[r]));
      else if (pool.states.has_been_met(k * C::rows + static_cast<std::size_t>(r)))
        energy.impact += lambda * (stage.is_mid_point() ? moved : stage.h * mean_speed_across(pool.items[k], r));
      else if (ConeConstraint<C>)
        energy.dissipated += lambda * moved;
    }
  });
}

/// Mean velocity of a row over the step, by its gradient at the end, m/s.
template <class C>
double Solved::mean_speed_across(const C& c, int row) const {
  const Gradients<C> gradients(c, end(), stage.fraction);
  double speed = 0;
  for (int i = 0; i < c.node_count(); ++i) {
    Vec3 rows[C::rows];
    gradients.of_node(i, rows);
    speed += dot(rows[row], mean_velocity(c.nodes[i]));
  }
  return speed;
}

// The work of constraint forces on gaps that open or close within the tolerance, J.
double Solved::work_of_gaps() const {
  double work = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for_each_row(pool, [&](std::size_t k, const double* before, const double* after) {
      const double limit = 10 * stage.tolerance * pool.items[k].reference_length();
      for (int r = 0; r < C::rows; ++r)
        work += std::abs(pool.multiplier(k)[r]) * std::min(std::abs(after[r] - before[r]), limit);
    });
  });
  return work;
}

// The work of the residual forces within the tolerance, J.
double Solved::work_of_imbalance() const {
  double work = 0;
  for (std::size_t i = 0; i < problem.size(); ++i) work += problem.mass[i] * norm(end()[i] - start()[i]);
  return work * stage.inertia * stage.tolerance * newton.reference_length();
}

}  // namespace

void EnergyBalance::measure(const Problem& problem, double fraction) {
  kinetic = problem.kinetic_energy();
  const Problem::Potential potential = problem.potential(problem.position.data());
  terms = potential.size;
  total = kinetic + potential.energy + problem.row_energy(problem.position.data(), fraction);
}

void EnergyBalance::measure_change(const Problem& problem, double fraction, double work) {
  const double expected = total + work;
  measure(problem, fraction);
  missing += expected - total;
}

double EnergyBalance::tolerance(double kinetic, double size) {
  return of_motion * kinetic + round_off_of_energy * size;
}

void EnergyBalance::measure_kinetic(const Problem& problem) {
  const double before = std::exchange(kinetic, problem.kinetic_energy());
  total += kinetic - before, missing += before - kinetic;
}

StepEnergy EnergyBalance::of_solution(const Problem& problem, const Newton& newton, const Stage& stage, Outside outside,
                                      std::span<const double> multipliers_before) const {
  const Solved step{problem, newton, stage};
  StepEnergy energy{.kinetic_before = kinetic, .total_before = total, .terms = terms};
  const Work held = step.external_work();
  energy.external_work = held.sum + (outside.drives_rows ? step.work_of_drives() : 0), energy.terms += held.terms;
  step.add_dissipation(energy, multipliers_before);
  const auto velocity_at_end = [&](std::size_t i) { return step.velocity_at_end(i); };
  energy.kinetic = problem.kinetic_energy(velocity_at_end);
  if (!outside.holds) {
    energy.flight_before = problem.flight_energy([&](std::size_t i) { return problem.velocity[i]; });
    energy.flight = problem.flight_energy(velocity_at_end);
  }
  if (!stage.is_mid_point()) {  // a larger error is made energy: the step is halved
    const double most = most_of_held_forces * std::min(kinetic, energy.kinetic);
    energy.external_work += std::clamp(step.held_force_error(), -most, most);
  }
  energy.total = energy.kinetic + problem.potential_energy(step.end()) + problem.row_energy(step.end(), stage.fraction);
  energy.round_off = round_off_of_energy * energy.size();
  if (energy.gained() > energy.round_off)
    energy.round_off += jitter_energy(problem, finest, newton.reference_length(), stage.h);
  energy.slack = tolerance(energy.motion(), energy.size());
  if (energy.made() > energy.slack) {
    const Strain strain = newton.strain_released(problem, stage, multipliers_before);
    energy.slack += step.work_of_gaps() + step.work_of_imbalance() + std::max(0.0, strain.released);
    energy.overdrawn = std::max(0.0, strain.released) - std::max(0.0, strain.of_stored);
    energy.recoil = std::max(0.0, strain.of_joints - most_of_recoil * energy.motion());
  }
  return energy;
}

void EnergyBalance::take(const StepEnergy& step, AdvanceReport& report) {
  kinetic = step.kinetic, total = step.total;
  missing += step.missing(), slack += step.slack - step.overdrawn;
  const double impact = std::clamp(missing, 0.0, std::max(0.0, step.impact));  // at most what is missing
  missing -= impact;
  report.external_work += step.external_work, report.dissipated += step.dissipated + impact;
}

void EnergyBalance::close(const Problem& problem, double reference_length, double h, AdvanceReport& report) {
  if (missing < -slack) slack += jitter_energy(problem, closings, reference_length, h);
  (missing < -slack ? report.made : report.lost) += missing < -slack ? -missing : missing;
  missing = slack = 0;
}

}  // namespace iota::solver
