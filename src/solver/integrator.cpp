// SPDX-License-Identifier: Apache-2.0
#include "solver/integrator.h"

#include "base/slack.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

namespace {

constexpr int max_depth = 6;      // sub-steps down to a 64th: a whip needs them, for a few steps
constexpr double max_turn = 1.1;  // rad: a mid-point step that turns a link further is halved
constexpr double max_turn_cosine = 0.4536;
constexpr double standing_gap = 1e-6;  // relative start gap beyond which positions are projected before the step
constexpr int patience = 400;          // iterations after which sub-steps are no longer halved

}  // namespace

void Integrator::compile(Problem& problem) {
  newton_.compile(problem);
  make_room(problem);
}

void Integrator::relink(Problem& problem, std::span<const std::array<std::uint32_t, 2>> added,
                        std::span<const std::uint32_t> removed, std::span<const std::uint32_t> touched) {
  newton_.relink(problem, added, removed, touched);
  make_room(problem);
}

void Integrator::make_room(const Problem& problem) {
  for (auto* list : {&guess_, &start_position_, &start_velocity_}) resize_with_slack(*list, problem.size());
  resize_with_slack(lumped_mass_, problem.size());
  std::copy(problem.mass.begin(), problem.mass.end(), lumped_mass_.begin());
  for (const auto& c : problem.mass_couplings) lumped_mass_[c.a] += c.mass, lumped_mass_[c.b] += c.mass;
  std::size_t count = 0;
  problem.for_each_constraint_pool([&](const auto& pool) { count += pool.multipliers.size(); });
  multipliers_saved_.resize(count);
}

void Integrator::save_multipliers(const Problem& problem) {
  auto out = multipliers_saved_.begin();
  problem.for_each_constraint_pool(
      [&](const auto& p) { out = std::copy(p.multipliers.begin(), p.multipliers.end(), out); });
}

void Integrator::restore_multipliers(Problem& problem) const {
  auto in = multipliers_saved_.begin();
  problem.for_each_constraint_pool([&](auto& pool) {
    std::copy_n(in, pool.multipliers.size(), pool.multipliers.begin());
    in += static_cast<std::ptrdiff_t>(pool.multipliers.size());
  });
}

// End point: where the forces of the last step would carry the points, x0 + h v0 + (f - G0' lambda) / (inertia m), which
// saves half an iteration to one over x0 + h v0. Coupled masses are lumped: exact for neighbours that accelerate alike.
// Mid-point: plain x0 + h v0, since its multipliers ring from step to step (measured: twice the iterations otherwise).
void Integrator::make_guess(const Problem& problem, const Stage& stage) {
  const std::size_t n = problem.size();
  std::fill(guess_.begin(), guess_.end(), Vec3{});
  if (stage.midpoint || stage.is_projection()) return;

  const std::span<Vec3> flight = newton_.room();
  for (std::size_t i = 0; i < n; ++i) {
    flight[i] = problem.position[i] + stage.h * problem.velocity[i];
    guess_[i] = problem.force[i] + lumped_mass_[i] * problem.gravity;
  }
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const C& c = pool.items[k];
      const Gradients<C> gradients(c, problem.position.data(), stage.fraction_start);
      for (int i = 0; i < c.node_count(); ++i) {
        Vec3 rows[C::rows];
        gradients.of_node(i, rows);
        for (int r = 0; r < C::rows; ++r) guess_[c.nodes[i]] -= pool.multiplier(k)[r] * rows[r];
      }
    }
  });
  const ForceStage force_stage{stage.h, false, false};
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items) {
      const Vec3 force = f.force(f.arm.value(problem.position.data()), f.arm.value(flight.data()), force_stage);
      for (std::uint32_t i = 0; i < f.arm.count; ++i) guess_[f.arm.nodes[i]] += f.arm.weights[i] * force;
    }
  });
  // A pull that would fling points away (a stiff spring, an outdated multiplier) is no help.
  const double limit = newton_.reference_length() * newton_.reference_length();
  double farthest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    guess_[i] *= 1 / (stage.inertia * lumped_mass_[i]);
    farthest = std::max(farthest, dot(guess_[i], guess_[i]));
  }
  if (!(farthest < limit)) std::fill(guess_.begin(), guess_.end(), Vec3{});
}

bool Integrator::try_step(Problem& problem, const Stage& stage, AdvanceReport& report) {
  make_guess(problem, stage);
  const NewtonReport newton = newton_.solve(problem, stage, guess_);
  ++report.solves;
  met_ = newton.met;
  report.handed_back += newton.handed_back;
  report.iterations += newton.iterations;
  report.iterations_max = std::max(report.iterations_max, newton.iterations);
  return newton.converged;
}

void Integrator::commit(Problem& problem, const Stage& stage, AdvanceReport& report) {
  const Vec3* const x0 = problem.position.data();
  const Vec3* const x1 = newton_.solution().data();
  const double before = energy_;
  double work = 0;
  const ForceStage force_stage{stage.h, stage.midpoint, false};
  for (const auto& f : std::get<ForcePool<GripForce>>(problem.forces).items) {
    const Vec3 e0 = f.arm.value(x0), e1 = f.arm.value(x1);
    work += dot(f.force(e0, e1, force_stage), e1 - e0);
  }
  for (const auto& f : std::get<ForcePool<RadialForce>>(problem.forces).items)
    work += f.push_work(f.arm.value(x0), f.arm.value(x1), force_stage);
  const auto& affines = std::get<ConstraintPool<AffineConstraint>>(problem.constraints);
  for (std::size_t k = 0; k < affines.items.size(); ++k) {
    const AffineConstraint& c = affines.items[k];
    if (c.target == c.target_start) continue;
    const double* const l = affines.multiplier(k);
    Vec3 moved;
    for (std::uint32_t i = 0; i < c.count; ++i) moved += c.weights[i] * (x1[c.nodes[i]] - x0[c.nodes[i]]);
    work -= dot(Vec3{l[0], l[1], l[2]}, moved);
  }
  work += work_of_drives(problem, stage);
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const Vec3 moved = x1[i] - problem.position[i];
    work += dot(problem.force[i], moved);
    problem.velocity[i] += ((stage.midpoint ? 2 : 1) / stage.h) * newton_.displacement()[i];
    problem.position[i] = x1[i];
  }
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if constexpr (TrackingConstraint<C>)
      for (C& c : pool.items) c.track(problem.position.data(), stage.fraction);
  });
  take_stock(problem, stage.fraction);
  report.external_work += work;
  report.dissipated += before + work - energy_;
  ++report.substeps;
}

// What moving targets feed in: lambda dg/dt. A motor that does not keep up is a drive behind a slipping clutch: what slips
// away is dissipated.
double Integrator::work_of_drives(const Problem& problem, const Stage& stage) const {
  double work = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      if constexpr (GeneralConstraint<C>)
        if (pool.items[k].is_moving()) {
          double before[C::rows], after[C::rows];
          pool.items[k].value(newton_.solution().data(), stage.fraction_start, before);
          pool.items[k].value(newton_.solution().data(), stage.fraction, after);
          for (int r = 0; r < C::rows; ++r) work += pool.multiplier(k)[r] * (after[r] - before[r]);
        }
      if (pool.has_laws())
        for (int r = 0; r < C::rows; ++r)
          if (pool.law(k)[r].hold) work -= pool.multiplier(k)[r] * pool.law(k)[r].rate * stage.h;
    }
  });
  return work;
}

void Integrator::take_stock(const Problem& problem, double fraction) {
  kinetic_ = problem.kinetic_energy();
  energy_ = kinetic_ + problem.potential_energy(problem.position.data()) +
            problem.row_energy(problem.position.data(), fraction);
}

// The mid-point rule only fixes the mean of two successive multipliers; the mean is the better start for the next solve
// and the reaction that a user wants to read.
void Integrator::smooth_multipliers(Problem& problem) const {
  auto before = multipliers_saved_.begin();
  problem.for_each_constraint_pool([&](auto& pool) {
    for (std::size_t row = 0; row < pool.multipliers.size(); ++row) {
      double& m = pool.multipliers[row];
      const double last = *before++;
      if (pool.has_laws() && (pool.states[row].side != 0 || pool.states[row].side_before != 0)) continue;
      if (last != 0) m = 0.5 * (m + last);  // zero: there was no last time
    }
  });
}

bool Integrator::will_turn_too_far(const Problem& problem, double h) const {
  for (const auto& c : std::get<ConstraintPool<DistanceConstraint>>(problem.constraints).items) {
    const Vec3 d = problem.position[c.nodes[1]] - problem.position[c.nodes[0]];
    const Vec3 moved = h * (problem.velocity[c.nodes[1]] - problem.velocity[c.nodes[0]]);
    if (dot(moved, moved) > max_turn * max_turn * dot(d, d)) return true;
  }
  return false;
}

bool Integrator::turns_too_far(const Problem& problem) const {
  const auto x1 = newton_.solution();
  for (const auto& c : std::get<ConstraintPool<DistanceConstraint>>(problem.constraints).items) {
    const Vec3 d0 = problem.position[c.nodes[1]] - problem.position[c.nodes[0]];
    const Vec3 d1 = x1[c.nodes[1]] - x1[c.nodes[0]];
    const double d = dot(d0, d1);
    if (d <= 0 || d * d < max_turn_cosine * max_turn_cosine * dot(d0, d0) * dot(d1, d1)) return true;
  }
  return false;
}

bool Integrator::gains_energy(const Problem& problem, const Stage& stage) {
  if (!conservative_) return false;
  const auto x1 = newton_.solution();
  const std::span<Vec3> velocity = guess_;  // which has served
  for (std::size_t i = 0; i < problem.size(); ++i) velocity[i] = (1 / stage.h) * (x1[i] - problem.position[i]);
  const double kinetic = 0.5 * problem.mass_norm2(velocity.data());
  const double gain =
      kinetic + problem.potential_energy(x1.data()) + problem.row_energy(x1.data(), stage.fraction) - energy_;
  const double slack = 1e-9 * (kinetic_ + kinetic) + 1e-12;
  return !(gain <= slack) && !(gain <= slack + work_of_gaps(problem, stage));
}

// What the constraint forces do where gaps, within the tolerance, open and close.
double Integrator::work_of_gaps(const Problem& problem, const Stage& stage) const {
  double work = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      double before[C::rows], after[C::rows];
      pool.items[k].value(problem.position.data(), stage.fraction_start, before);
      pool.items[k].value(newton_.solution().data(), stage.fraction, after);
      const double limit = 10 * stage.tolerance * pool.items[k].reference_length();
      for (int r = 0; r < C::rows; ++r)
        work += std::abs(pool.multiplier(k)[r]) * std::min(std::abs(after[r] - before[r]), limit);
    }
  });
  return work;
}

void Integrator::advance_mid_point(Problem& problem, double h, double from, double to, int depth,
                                   AdvanceReport& report) {
  const auto halve = [&] {
    const double middle = (from + to) / 2;
    advance_mid_point(problem, h / 2, from, middle, depth + 1, report);
    advance_mid_point(problem, h / 2, middle, to, depth + 1, report);
  };
  if (depth < max_depth && will_turn_too_far(problem, h)) return halve();  // do not even try
  save_multipliers(problem);
  const Stage stage = Stage::mid_point(h, from, to);
  const bool solved = try_step(problem, stage, report);
  if (solved && !turns_too_far(problem)) {
    const bool met = met_ > 0;
    commit(problem, stage, report);
    smooth_multipliers(problem);
    if (met) absorb_impact(problem, to, report);
    return;
  }
  restore_multipliers(problem);
  if (depth == max_depth || report.iterations > patience) {
    ++report.fallbacks;
    return advance_end_point(problem, h, from, to, depth, report);
  }
  halve();
}

// Rows that have just met leave velocities that they no longer allow, and that the mid-point rule would throw back:
// impacts are inelastic. The sub-step itself does no harm: a row that ends met and began apart has taken energy.
void Integrator::absorb_impact(Problem& problem, double to, AdvanceReport& report) {
  const double before = energy_;
  newton_.project_velocities(problem, conservative_ ? 0 : step_length_, true);
  take_stock(problem, to);
  report.dissipated += before - energy_;
  report.impacts += before - energy_ > 1e-9 * kinetic_;
}

void Integrator::advance_end_point(Problem& problem, double h, double from, double to, int depth,
                                   AdvanceReport& report) {
  save_multipliers(problem);
  Stage stage = Stage::end_point(h, from, to);
  const bool solved = try_step(problem, stage, report);
  if (solved && !(depth < max_depth && gains_energy(problem, stage))) return commit(problem, stage, report);
  restore_multipliers(problem);
  if (depth < max_depth && report.iterations <= patience) {
    const double middle = (from + to) / 2;
    advance_end_point(problem, h / 2, from, middle, depth + 1, report);
    advance_end_point(problem, h / 2, middle, to, depth + 1, report);
    return;
  }
  report.converged = false;
  if (least_violation(problem, stage, report)) {
    commit(problem, stage, report);
  } else {
    coast(problem, h, report);
  }
}

// The last resort keeps moving: points fly on by their velocities, and positions and velocities are projected on the
// constraints. First order and not energy-keeping, but plausible, finite, and reported.
void Integrator::coast(Problem& problem, double h, AdvanceReport& report) {
  restore_multipliers(problem);
  const double before = energy_;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    problem.velocity[i] += h * problem.gravity;
    problem.position[i] += h * problem.velocity[i];
  }
  (void)project_positions(problem);
  project_velocities(problem);
  take_stock(problem, 1);
  if (!std::isfinite(energy_)) {
    problem.position = start_position_;
    std::fill(problem.velocity.begin(), problem.velocity.end(), Vec3{});
    take_stock(problem, 1);
  }
  report.dissipated += before - energy_;
  ++report.substeps;
}

bool Integrator::least_violation(Problem& problem, Stage stage, AdvanceReport& report) {
  // Rising compliance turns conflicting constraints into the springs that share the violation.
  for (const double compliance : {1e-8, 1e-6, 1e-4, 1e-2}) {
    stage.compliance = compliance;
    restore_multipliers(problem);
    if (try_step(problem, stage, report)) return true;
  }
  return false;
}

AdvanceReport Integrator::advance(Problem& problem, double h, Scheme scheme) {
  AdvanceReport report;
  conservative_ = std::get<ForcePool<GripForce>>(problem.forces).items.empty();
  for (const auto& f : std::get<ForcePool<RadialForce>>(problem.forces).items)
    conservative_ = conservative_ && !f.law->may_do_work();
  for (const Vec3& f : problem.force) conservative_ = conservative_ && f == Vec3{};
  problem.for_each_constraint_pool([&](const auto& pool) {
    for (const auto& c : pool.items) conservative_ = conservative_ && !c.is_moving();
    for (const RowLaw& law : pool.laws) conservative_ = conservative_ && (law.rate == 0 || law.is_off());
  });
  step_length_ = h;
  close_gaps(problem, report);
  std::copy(problem.position.begin(), problem.position.end(), start_position_.begin());
  std::copy(problem.velocity.begin(), problem.velocity.end(), start_velocity_.begin());
  take_stock(problem, 0);
  const double start_kinetic = kinetic_, start_energy = energy_;
  if (scheme == Scheme::mid_point)
    advance_mid_point(problem, h, 0, 1, 0, report);
  else
    advance_end_point(problem, h, 0, 1, 0, report);
  // Where Newton found no solution, what it found instead may be anything; made-up energy gives it away.
  const bool found = report.converged && report.fallbacks == 0;
  if (!found && conservative_ && energy_ > start_energy + 0.1 * start_kinetic + 1e-9 * std::abs(start_energy)) {
    std::copy(start_position_.begin(), start_position_.end(), problem.position.begin());
    std::copy(start_velocity_.begin(), start_velocity_.end(), problem.velocity.begin());
    report.dissipated += energy_ - start_energy;  // taken out of the book again
    report.converged = false;
    take_stock(problem, 0);
    coast(problem, h, report);
  }
  return report;
}

void Integrator::close_gaps(Problem& problem, AdvanceReport& report) {
  if (holds_offsets_) problem.clear_offsets();
  holds_offsets_ = false;
  if (!(problem.worst_gap(problem.position.data(), 0, true) > standing_gap)) return;

  const double before = problem.kinetic_energy() + problem.potential_energy(problem.position.data());
  if (!project_positions(problem)) {
    report.converged = false;
    holds_offsets_ = true;
    problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
      for (std::size_t i = 0; i < pool.items.size(); ++i) {
        double* const offset = pool.offsets.data() + i * C::rows;
        pool.items[i].value(problem.position.data(), 0, offset);
        if (pool.has_laws())
          for (int r = 0; r < C::rows; ++r)
            if (pool.law(i)[r].violation(offset[r]) == 0) offset[r] = 0;
      }
    });
  }
  project_velocities(problem);
  report.closing_energy += problem.kinetic_energy() + problem.potential_energy(problem.position.data()) - before;
}

bool Integrator::project_positions(Problem& problem) {
  save_multipliers(problem);
  problem.clear_offsets();
  AdvanceReport ignored;
  const auto attempt = [&](double compliance, int iterations) {
    problem.clear_multipliers();
    Stage stage = Stage::projection(compliance);
    stage.fraction = 0;
    stage.max_iterations = iterations;
    const bool solved = try_step(problem, stage, ignored);
    if (solved) std::copy(newton_.solution().begin(), newton_.solution().end(), problem.position.begin());
    return solved;
  };
  // At once; else bit by bit, as far as there is a way; else by soft steps, each of which shares what cannot be closed.
  bool solved = attempt(1e-12, 20) || close_bit_by_bit(problem, attempt);
  for (int soft = 0; soft < 3 && !solved; ++soft) {
    if (!attempt(1e-3, 40)) break;
    solved = attempt(1e-12, 12);
  }
  restore_multipliers(problem);
  return solved;
}

// Many links away from a solution Newton gets lost, but a part of the way it finds (a fine chain pulled together over
// centimetres). What remains is held as offsets meanwhile.
template <class Attempt>
bool Integrator::close_bit_by_bit(Problem& problem, Attempt attempt) {
  double remaining = 1, part = 0.25;
  bool solved = false;
  for (int tries = 0; tries < 60 && remaining > 0 && part > 2e-3; ++tries) {
    part = std::min(part, remaining);
    problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
      for (std::size_t i = 0; i < pool.items.size(); ++i) {
        double* const offset = pool.offsets.data() + i * C::rows;
        pool.items[i].value(problem.position.data(), 0, offset);
        for (int r = 0; r < C::rows; ++r) {
          offset[r] *= (remaining - part) / remaining;
          if (pool.has_laws() && pool.law(i)[r].violation(offset[r]) == 0) offset[r] = 0;
        }
      }
    });
    solved = attempt(1e-12, 10);
    if (solved)
      remaining -= part, part *= 2;
    else
      part /= 4;
  }
  problem.clear_offsets();
  return solved && !(remaining > 0);
}

}  // namespace iota::solver
