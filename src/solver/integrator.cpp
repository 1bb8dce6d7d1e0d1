// SPDX-License-Identifier: Apache-2.0
#include "solver/integrator.h"

#include "base/disjoint_sets.h"
#include "base/slack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

namespace iota::solver {

namespace {

constexpr double round_off = 1e-14;         // of energies
constexpr double finest = 1e-12;            // of a length: motion below it is round-off
constexpr double of_motion = 1e-9;          // of the kinetic energy: limit of the gain by the tolerance of a solve
constexpr double largest_violation = 1e-2;  // relative: a step with wider gaps is rejected

/// Not quadratic in the points: the mean of two gradients is not an exact discrete gradient.
template <class C>
constexpr bool is_curved =
    std::is_same_v<C, AngleConstraint> || std::is_same_v<C, CurveConstraint> || std::is_same_v<C, StationConstraint> ||
    std::is_same_v<C, SurfaceConstraint> || std::is_same_v<C, SurfacePairConstraint>;

}  // namespace

void Integrator::compile(Problem& problem) {
  may_be_in_pieces_ = false, pieces_.clear();
  newton_.compile(problem);
  make_room(problem);
}

void Integrator::follow(Problem& problem) {
  may_be_in_pieces_ = true;
  newton_.follow(problem);
  make_room(problem);
}

void Integrator::make_room(const Problem& problem) {
  if (local_) local_->forget();
  spin_.forget();
  for (auto* list : {&start_position_, &start_velocity_}) reserve_for_rare_use(*list, problem.size());
  lumped_mass_.clear();
  multipliers_saved_.resize(problem.multiplier_count());
}

// Summed on first use, as the mid-point scheme does not need them, and only where masses are coupled.
std::span<const double> Integrator::lumped_masses(const Problem& problem) {
  if (problem.mass_couplings.empty()) return problem.mass;
  if (lumped_mass_.empty()) {
    lumped_mass_.assign(problem.mass.begin(), problem.mass.end());
    for (const auto& c : problem.mass_couplings) lumped_mass_[c.a] += c.mass, lumped_mass_[c.b] += c.mass;
  }
  return lumped_mass_;
}

// End point: the positions to which the forces of the last step would carry the points,
//   x0 + h v0 + (f - G0' lambda) / (inertia m).
// This saves half an iteration to one over x0 + h v0. Coupled masses are lumped, which is exact for neighbors with equal
// accelerations. Mid-point: two sweeps over x0 + h v0 restore the lengths. The same guess would save 5 to 9 % of a step on
// chains, but from the huge forces of a taut net Newton's method goes to solutions that make energy (of a net of 8 x 8 bars
// that hangs from its corners 705 J in 2 s instead of 0.1).
void Integrator::make_guess(const Problem& problem, const Stage& stage) {
  const std::size_t n = problem.size();
  const std::span<Vec3> guess = newton_.displacement();
  std::fill(guess.begin(), guess.end(), Vec3{});
  if (stage.is_projection()) return;
  if (stage.midpoint) return sweep_lengths(problem, stage);

  const std::span<const double> mass = lumped_masses(problem);
  const std::span<Vec3> flight = newton_.room();
  for (std::size_t i = 0; i < n; ++i) {
    flight[i] = problem.position[i] + stage.h * problem.velocity[i];
    guess[i] = mass[i] * problem.gravity;
  }
  for (std::size_t i = 0; i < problem.force.size(); ++i) guess[i] += problem.force[i];
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
  // A stiff spring or an outdated multiplier may move points far away: then free flight is the better guess.
  const double limit = newton_.reference_length() * newton_.reference_length();
  double farthest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    guess[i] *= 1 / (stage.inertia * mass[i]);
    farthest = std::max(farthest, dot(guess[i], guess[i]));
  }
  if (!(farthest < limit)) std::fill(guess.begin(), guess.end(), Vec3{});
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

bool Integrator::try_step(Problem& problem, const Stage& stage, AdvanceReport& report) {
  make_guess(problem, stage);
  return solve(problem, stage, report);
}

// The last resort has no deadline.
bool Integrator::is_out_of_budget() {
  using Clock = std::chrono::steady_clock;
  if (care_.deadline != Clock::time_point::max() && Clock::now() > care_.deadline) iterations_left_ = 0;
  if (iterations_left_ <= 0) care_.patience = 0;  // no more halving
  return iterations_left_ <= 0;
}

bool Integrator::solve(Problem& problem, const Stage& stage, AdvanceReport& report) {
  if (is_out_of_budget()) {
    cut_short_ = true;
    return false;
  }
  Stage limited = stage;
  limited.max_iterations = std::min(stage.max_iterations, iterations_left_);
  const NewtonReport newton = newton_.solve(problem, limited);
  iterations_left_ -= newton.iterations;
  cut_short_ = cut_short_ || (!newton.converged && iterations_left_ <= 0);
  ++report.solves;
  met_ = newton.met, violation_ = newton.violation;
  report.handed_back += newton.handed_back;
  report.iterations += newton.iterations;
  report.iterations_max = std::max(report.iterations_max, newton.iterations);
  return newton.converged;
}

void Integrator::commit(Problem& problem, const Stage& stage, AdvanceReport& report) {
  has_corrected_ = false;
  const Vec3* const x0 = problem.position.data();
  const Vec3* const x1 = newton_.solution().data();
  const Dissipation taken = calc_dissipation(problem, stage);
  double work = 0;
  const ForceStage force_stage{stage.h, stage.midpoint, false};
  for (const auto& f : problem.items_of<GripForce>()) {
    const Vec3 e0 = f.arm.value(x0), e1 = f.arm.value(x1);
    work += dot(f.force(e0, e1, force_stage), e1 - e0);
  }
  for (const auto& f : problem.items_of<RadialForce>())
    work += f.push_work(f.arm.value(x0), f.arm.value(x1), force_stage);
  const std::span<const AffineConstraint> affines = problem.items_of<AffineConstraint>();
  for (std::size_t k = 0; k < affines.size(); ++k) {
    const AffineConstraint& c = affines[k];
    if (c.target == c.target_start) continue;
    const double* const l = problem.pool_of<AffineConstraint>().multiplier(k);
    Vec3 moved;
    for (std::uint32_t i = 0; i < c.count; ++i) moved += c.weights[i] * (x1[c.nodes[i]] - x0[c.nodes[i]]);
    work -= dot(Vec3{l[0], l[1], l[2]}, moved);
  }
  work += work_of_drives(problem, stage);
  for (std::size_t i = 0; i < problem.force.size(); ++i) work += dot(problem.force[i], x1[i] - problem.position[i]);
  report.external_work += work;
  book_solution(problem, stage, work - taken.steady);
  const double impact = std::clamp(missing_, 0.0, std::max(0.0, taken.impact));  // at most what is missing
  report.dissipated += taken.steady + impact, missing_ -= impact;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    problem.velocity[i] += ((stage.midpoint ? 2 : 1) / stage.h) * newton_.displacement()[i];
    problem.position[i] = x1[i];
  }
  track(problem, stage.fraction);
  is_instant_ = false;
  ++report.substeps;
}

void Integrator::track(Problem& problem, double fraction) {
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if constexpr (TrackingConstraint<C>)
      for (C& c : pool.items) c.track(problem.position.data(), fraction);
  });
}

// The energy of the solved step, and the missing part: `gain` is the external work minus the dissipation.
void Integrator::book_solution(const Problem& problem, const Stage& stage, double gain) {
  const Vec3* const x1 = newton_.solution().data();
  const double energy_before = energy_, kinetic_before = kinetic_;
  kinetic_ = problem.kinetic_energy([&](std::size_t i) { return velocity_after(problem, stage, i); });
  energy_ = kinetic_ + problem.potential_energy(x1) + problem.row_energy(x1, stage.fraction);
  const double missing = energy_before + gain - energy_;
  missing_ += missing;
  const double little = of_motion * std::max(kinetic_before, kinetic_) +
                        round_off * (std::abs(energy_before) + std::abs(energy_) + std::abs(gain));
  slack_ += little;
  if (missing < -little)
    slack_ += work_of_gaps(problem, stage) + work_of_imbalance(problem, stage) +
              std::max(0.0, newton_.strain_released(problem, stage));
}

// Books the unexplained energy of a (sub-)step and its corrections. A surplus within the tolerance of the solve is
// subtracted from `lost`, as its sign varies from step to step.
void Integrator::book_rest(const Problem& problem, double h, AdvanceReport& report) {
  if (missing_ < -slack_) {
    double mass = 0;
    for (const double m : problem.mass) mass += m;
    const double jitter = finest * newton_.reference_length() / h;
    slack_ += mass * jitter * jitter;
  }
  (missing_ < -slack_ ? report.made : report.lost) += missing_ < -slack_ ? -missing_ : missing_;
  missing_ = slack_ = 0;
}

// Energy dissipated by forces and rows in the solved step: call it before the commit.
Integrator::Dissipation Integrator::calc_dissipation(const Problem& problem, const Stage& stage) const {
  const ForceStage force_stage{stage.h, stage.midpoint, false};
  Dissipation taken;
  problem.for_each_constraint_pool([&](const auto& pool) {
    if (pool.has_laws() && pool.held.empty()) add_dissipation_of_rows(problem, stage, pool, taken);
  });
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items)
      taken.steady +=
          f.dissipation(f.arm.value(problem.position.data()), f.arm.value(newton_.solution().data()), force_stage);
  });
  return taken;
}

namespace {

/// Mean velocity of a row over the step, by its gradient at the end, m/s.
template <class C>
double mean_speed_across(const Problem& problem, const C& c, int row, std::span<const Vec3> solution,
                         std::span<const Vec3> displacement, const Stage& stage) {
  const Gradients<C> gradients(c, solution.data(), stage.fraction);
  double speed = 0;
  for (int i = 0; i < c.node_count(); ++i) {
    Vec3 rows[C::rows];
    gradients.of_node(i, rows);
    const std::uint32_t node = c.nodes[i];
    speed += dot(rows[row], problem.velocity[node] + (0.5 / stage.h) * displacement[node]);
  }
  return speed;
}

}  // namespace

// A row takes lambda dg. Of that a spring stores its part and a drive has given its rate. What is left are dashpots,
// friction and slipping clutches. The impact of a row that has just met: in the mid-point rule lambda dg is its first half, a
// projection takes the other; the end-point rule takes all at once, the impulse times the mean speed across the row.
template <class C>
void Integrator::add_dissipation_of_rows(const Problem& problem, const Stage& stage, const ConstraintPool<C>& pool,
                                         Dissipation& taken) const {
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    const C& c = pool.items[k];
    double before[C::rows], after[C::rows];
    c.value(problem.position.data(), stage.fraction_start, before);
    c.value(newton_.solution().data(), stage.fraction, after);
    for (int r = 0; r < C::rows; ++r) {
      const RowLaw& law = pool.law(k)[r];
      const RowState& state = pool.states[k * C::rows + r];
      const double lambda = pool.multiplier(k)[r], moved = after[r] - before[r];
      const bool is_free = state.side == 0;
      if (law == RowLaw{} || law.is_off()) continue;
      if (law.hold)
        taken.steady += lambda * (moved - law.rate * stage.h);
      else if (law.is_compliant())
        taken.steady += is_free ? law.damping / stage.h * moved * moved
                                : std::max(0.0, lambda * moved - law.energy(after[r]) + law.energy(before[r]));
      else if (is_free && state.side_before != 0)
        taken.impact += lambda * (stage.midpoint ? moved
                                                 : stage.h * mean_speed_across(problem, c, r, newton_.solution(),
                                                                               newton_.displacement(), stage));
    }
  }
}

// The work of moving targets, lambda dg/dt, J. A motor that does not reach its speed counts as a drive behind a slipping
// clutch: the difference is dissipated.
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

// After a change of velocities alone; what the change takes is missing.
void Integrator::measure_kinetic_energy(const Problem& problem) {
  const double before = std::exchange(kinetic_, problem.kinetic_energy());
  energy_ += kinetic_ - before;
  missing_ += before - kinetic_;
}

void Integrator::measure_energy(const Problem& problem, double fraction) {
  kinetic_ = problem.kinetic_energy();
  energy_ = kinetic_ + problem.potential_energy(problem.position.data()) +
            problem.row_energy(problem.position.data(), fraction);
}

bool Integrator::will_turn_too_far(const Problem& problem, double h) const {
  for (const auto& c : problem.items_of<DistanceConstraint>()) {
    const Vec3 d = problem.position[c.nodes[1]] - problem.position[c.nodes[0]];
    const Vec3 moved = h * (problem.velocity[c.nodes[1]] - problem.velocity[c.nodes[0]]);
    if (dot(moved, moved) > care_.max_turn * care_.max_turn * dot(d, d)) return true;
  }
  return false;
}

bool Integrator::turns_too_far(const Problem& problem) const {
  const auto x1 = newton_.solution();
  for (const auto& c : problem.items_of<DistanceConstraint>()) {
    const Vec3 d0 = problem.position[c.nodes[1]] - problem.position[c.nodes[0]];
    const Vec3 d1 = x1[c.nodes[1]] - x1[c.nodes[0]];
    const double d = dot(d0, d1);
    if (d <= 0 || d * d < care_.max_turn_cosine * care_.max_turn_cosine * dot(d0, d0) * dot(d1, d1)) return true;
  }
  return false;
}

// Energy that a solved step would add, J. With external work, any gain is allowed: -1.
double Integrator::calc_energy_gain(const Problem& problem, const Stage& stage) {
  if (!conservative_) return -1;
  const auto x1 = newton_.solution();
  return problem.kinetic_energy([&](std::size_t i) { return velocity_after(problem, stage, i); }) +
         problem.potential_energy(x1.data()) + problem.row_energy(x1.data(), stage.fraction) - energy_;
}

// The mid-point rule keeps energy with quadratic constraints only. On a curve or surface a too long step may gain any
// amount of energy (half of a random scene's in one step), so it is halved.
bool Integrator::gains_energy_on_curves(const Problem& problem, const Stage& stage) {
  // Largest accepted gain; the second share is for motions that reverse, whose kinetic energy vanishes.
  constexpr double of_kinetic = 0.05, of_total = 1e-3;
  return has_curved_rows_ && calc_energy_gain(problem, stage) > of_kinetic * kinetic_ + of_total * std::abs(energy_);
}

// The work of the residual forces within the tolerance, J.
double Integrator::work_of_imbalance(const Problem& problem, const Stage& stage) const {
  double work = 0;
  for (std::size_t i = 0; i < problem.size(); ++i)
    work += problem.mass[i] * norm(newton_.solution()[i] - problem.position[i]);
  return work * stage.inertia * stage.tolerance * newton_.reference_length();
}

// The work of constraint forces on gaps that open or close within the tolerance, J.
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

// Sub-steps have the row compliance of the whole step, as a taut net of bars stores energy in it; only down to a quarter,
// which is enough there, as a millionfold heavy end opens joints by it. Not where rows are driven: an arm that is pulled
// beyond its reach would store more before its elbow snaps (227 J of kinetic energy instead of 37). Its price: the energy
// of a four-bar linkage deviates by 1.4e-8 instead of 4e-9.
double Integrator::compliance_part(double from, double to) const {
  constexpr double smallest = 0.25;
  return drives_rows_ ? 1 : std::max(to - from, smallest);
}

void Integrator::advance_mid_point(Problem& problem, double h, double from, double to, int depth,
                                   AdvanceReport& report) {
  const auto halve = [&] {
    keep_start(problem);
    const double middle = (from + to) / 2;
    advance_mid_point(problem, h / 2, from, middle, depth + 1, report);
    advance_mid_point(problem, h / 2, middle, to, depth + 1, report);
  };
  if (depth < care_.max_depth && will_turn_too_far(problem, h)) return halve();  // without a try
  problem.copy_multipliers_to(multipliers_saved_);
  Stage stage = Stage::mid_point(h, from, to);
  stage.tolerance *= care_.tolerance, stage.part = compliance_part(from, to);
  if (try_step(problem, stage, report) && !turns_too_far(problem) &&
      !(depth < care_.max_depth && gains_energy_on_curves(problem, stage))) {
    const bool last = depth == care_.max_depth || report.iterations > care_.patience;
    if (care_.max_error == 0 || last || is_accurate(problem, stage, report)) {
      const bool met = met_ > 0;
      commit(problem, stage, report);
      project_velocities_after_step(problem, stage, met, report);
      return book_rest(problem, h, report);
    }
    problem.set_multipliers(multipliers_saved_);
    return halve();
  }
  problem.set_multipliers(multipliers_saved_);
  if (depth == care_.max_depth || report.iterations > care_.patience) {
    ++report.fallbacks;
    keep_start(problem);
    return advance_end_point(problem, h, from, to, depth, report);
  }
  halve();
}

// The mid-point rule satisfies the rows by the mean velocity, not by the velocity at the end: the residual of a row
// there would change its sign in each step, as a rate of stretch of rigid links (up to 30 % of the kinetic energy of a
// whip) and as oscillating reactions. So velocities are projected, and the energy of that is returned to the motion.
// Not in an impact, when a bounded row has just become active: that is inelastic, and the projection takes its energy.
void Integrator::project_velocities_after_step(Problem& problem, const Stage& stage, bool met, AdvanceReport& report) {
  const std::optional<double> kinetic = newton_.project_velocities_after(
      problem, stage, {.kinetic = kinetic_, .drives_rows = drives_rows_, .is_isolated = holds_.count == 0});
  has_corrected_ = kinetic.has_value();
  double taken = 0;
  if (kinetic) {
    taken = kinetic_ - *kinetic;
    kinetic_ -= taken, energy_ -= taken;
    if (drives_rows_) {  // rows that move do work in it
      const auto earlier = newton_.velocities_before();
      const double own = problem.kinetic_energy([&](std::size_t i) { return problem.velocity[i] - earlier[i]; });
      report.external_work += own - taken;
      taken = own;
    }
  }
  if (met)
    report.dissipated += taken;
  else
    missing_ += taken;
  if (!met && !drives_rows_ && give_energy_back(problem, stage, taken, report)) has_corrected_ = true;
  if (has_corrected_) keep_correction(problem);
}

// Newton's velocities before the correction become the correction.
void Integrator::keep_correction(const Problem& problem) {
  const auto changes = newton_.velocities_before();
  for (std::size_t i = 0; i < changes.size(); ++i) changes[i] = problem.velocity[i] - changes[i];
}

void Integrator::advance_end_point(Problem& problem, double h, double from, double to, int depth,
                                   AdvanceReport& report) {
  problem.copy_multipliers_to(multipliers_saved_);
  Stage stage = Stage::end_point(h, from, to);
  stage.tolerance *= care_.tolerance;
  stage.part = compliance_part(from, to);
  const bool solved = try_step(problem, stage, report);
  if (solved) {
    double gained = calc_energy_gain(problem, stage);
    if (gained > round_off * (std::abs(energy_) + kinetic_)) {  // more than the tolerance explains
      Stage finer = stage;
      finer.tolerance *= 1e-4;
      (void)solve(problem, finer, report);
      gained = calc_energy_gain(problem, stage);
    }
    const double slack = 1e-9 * kinetic_ + 1e-12;
    if (!(depth < care_.max_depth && gained > slack && gained > slack + work_of_gaps(problem, stage))) {
      const double before = energy_;
      commit(problem, stage, report);
      give_spin_back(problem, stage);
      // Also beside what dampers dissipate; down to half of the slack, as all of it would leave round-off above.
      const double unexplained = drives_rows_ || -missing_ <= slack_ ? 0 : -missing_ - 0.5 * slack_;
      const double made = conservative_ ? std::max(energy_ - before, unexplained) : unexplained;
      if (made > 0) change_kinetic_energy(problem, made);
      if (has_corrected_) keep_correction(problem);
      return book_rest(problem, h, report);
    }
  }
  problem.set_multipliers(multipliers_saved_);
  keep_start(problem);
  if (depth < care_.max_depth && report.iterations <= care_.patience) {
    const double middle = (from + to) / 2;
    advance_end_point(problem, h / 2, from, middle, depth + 1, report);
    advance_end_point(problem, h / 2, middle, to, depth + 1, report);
    return;
  }
  report.converged = false;
  if (least_violation(problem, stage, report)) {
    commit(problem, stage, report);
  } else {
    last_resort_step(problem, h, report);
  }
}

// What the end-point rule has lost of the angular momentum; the energy of that is at most what the step has lost.
void Integrator::give_spin_back(Problem& problem, const Stage& stage) {
  std::copy(problem.velocity.begin(), problem.velocity.end(), newton_.velocities_before().begin());
  const double most_gain = std::max(0.0, missing_);
  has_corrected_ = spin_.give_back(problem, newton_.displacement(), stage.h, holds_, most_gain, is_free_body_);
  if (has_corrected_) measure_kinetic_energy(problem);
}

// Removes `excess` from the kinetic energy, or adds it if negative: scales all velocities, in an isolated problem
// relative to the rigid motion, so that momentum and angular momentum are kept. Velocities still satisfy the
// constraints afterwards. If the rigid motion alone has too much energy, all of the velocities are scaled.
void Integrator::change_kinetic_energy(Problem& problem, double excess, const std::optional<RigidMotion>& found) {
  if (!scale_motion(problem, excess, found)) return measure_kinetic_energy(problem);
  const double before = kinetic_;
  kinetic_ -= excess, energy_ -= excess, missing_ += before - kinetic_;
}

// Of what nothing outside holds, or one point at rest.
std::optional<RigidMotion> Integrator::rigid_motion(const Problem& problem) const {
  if (holds_.are_none()) return rigid_motion_of(problem);
  if (const auto pivot = holds_.pivot()) return rigid_motion_about(problem, *pivot);
  return {};
}

namespace {

/// Scales what a point's velocity has beside a rigid motion.
void scale_beside(const RigidMotion& rigid, double factor, Problem& problem, std::size_t node) {
  const Vec3 shared = rigid.velocity_at(problem.position[node]);
  problem.velocity[node] = shared + factor * (problem.velocity[node] - shared);
}

}  // namespace

// Returns whether the kinetic energy is reduced by the excess, to round-off.
bool Integrator::scale_motion(Problem& problem, double excess, const std::optional<RigidMotion>& found) {
  RigidMotion rigid;
  double rest = kinetic_;
  if (found) {
    rigid = *found;
    rest -= rigid.kinetic_energy();
    if (!(rest > excess)) {
      rest = kinetic_ - 0.5 * rigid.mass * dot(rigid.velocity, rigid.velocity);
      rigid.turning = {};
    }
  }
  constexpr double most_given = 1;  // of the kinetic energy of the motion
  if (!(rest > 0 && -excess <= most_given * rest)) return false;
  const double factor = std::sqrt(std::max(0.0, 1 - excess / rest));
  for (std::size_t i = 0; i < problem.size(); ++i) scale_beside(rigid, factor, problem, i);
  return excess < rest;
}

// Returns to the motion the energy that a projection of velocities has taken. Curves, surfaces and angles have no exact
// discrete gradient: the error of the mean of two gradients is returned as well, limited if the motion reverses and has
// little kinetic energy.
bool Integrator::give_energy_back(Problem& problem, const Stage& stage, double taken, AdvanceReport& report) {
  constexpr double most = 0.1;  // of the kinetic energy: limit of the returned error on curves
  const bool is_made = has_curved_rows_ && std::abs(missing_) > slack_;
  const double missing = is_made ? std::clamp(missing_, -most * kinetic_, most * kinetic_) : taken;
  if (missing == 0) return false;
  if (may_be_in_pieces_) find_pieces(problem);
  if (!pieces_.empty()) {
    give_energy_back_by_piece(problem);
    return true;
  }
  const std::optional<RigidMotion> rigid = rigid_motion(problem);
  if (rigid && problem.items_of<GripForce>().empty() && problem.items_of<GyroscopicForce>().empty()) {
    if (!(kinetic_ - rigid->kinetic_energy() > std::abs(missing))) {
      std::copy(problem.position.begin(), problem.position.end(), newton_.room().begin());
      turn_for_energy(problem, missing, holds_.pivot());
      double work = 0;
      for (std::size_t i = 0; i < problem.force.size(); ++i)
        work += dot(problem.force[i], problem.position[i] - newton_.room()[i]);
      report.external_work += work;
      const double before = energy_;
      measure_energy(problem, stage.fraction);
      missing_ += before + work - energy_;
      return true;
    }
  }
  change_kinetic_energy(problem, -missing, rigid);
  return true;
}

// After a cut both halves stay in one problem for a while, but their energies are balanced separately.
void Integrator::give_energy_back_by_piece(Problem& problem) {
  const auto earlier = newton_.velocities_before();
  for (Piece& piece : pieces_) piece = {.first = piece.first};
  problem.for_each_constraint_pool([&](const auto& pool) {
    for (const auto& c : pool.items) pieces_[piece_of_[pool.nodes_of(c).front()]].holds.add(c);
  });
  const auto add = [&](double mass, std::uint32_t a, std::uint32_t b) {
    Piece& piece = pieces_[piece_of_[a]];
    const double kinetic = 0.5 * mass * dot(problem.velocity[a], problem.velocity[b]);
    piece.kinetic += kinetic, piece.taken += 0.5 * mass * dot(earlier[a], earlier[b]) - kinetic;
  };
  for (std::uint32_t i = 0; i < problem.size(); ++i) add(problem.mass[i], i, i);
  for (const auto& c : problem.mass_couplings) add(2 * c.mass, c.a, c.b);
  for (std::uint32_t k = 0; k < pieces_.size(); ++k) {
    const Piece& piece = pieces_[k];
    if (!(piece.taken > 0)) continue;
    RigidMotion rigid;
    if (const auto pivot = piece.holds.pivot())
      rigid = rigid_motion_about(problem, *pivot, piece_of_, k);
    else if (piece.holds.are_none())
      rigid = rigid_motion_of(problem, piece_of_, k);
    const double rest = piece.kinetic - rigid.kinetic_energy();
    if (!(piece.taken <= rest)) continue;
    const double factor = std::sqrt(1 + piece.taken / rest);
    for (std::size_t i = piece.first; i < problem.size(); ++i)
      if (piece_of_[i] == k) scale_beside(rigid, factor, problem, i);
  }
  measure_kinetic_energy(problem);
}

// Connected points; the lowest of each piece is its leader.
void Integrator::find_pieces(const Problem& problem) {
  may_be_in_pieces_ = false;
  pieces_.clear(), piece_of_.resize(problem.size());
  DisjointSets connected(problem.size());
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    a = connected.root(a), b = connected.root(b);
    connected.join(std::max(a, b), std::min(a, b));
  };
  const auto join_all = [&](const auto& pool) {
    for (const auto& item : pool.items)
      for (const std::uint32_t node : pool.nodes_of(item)) join(pool.nodes_of(item).front(), node);
  };
  problem.for_each_constraint_pool(join_all);
  problem.for_each_force_pool(join_all);
  for (const auto& c : problem.mass_couplings) join(c.a, c.b);
  for (std::uint32_t node = 0; node < problem.size(); ++node) {
    const std::uint32_t leader = connected.root(node);
    if (leader == node) {
      piece_of_[node] = static_cast<std::uint32_t>(pieces_.size());
      pieces_.push_back({.first = node});
    } else {
      piece_of_[node] = piece_of_[leader];  // lower, so known
    }
  }
  if (pieces_.size() == 1) pieces_.clear();
}

// If no scheme has found a solution: moves the points by their velocities, in small pieces, and projects positions and
// velocities on the constraints after each. If a projection fails, the points stay and lose half of their speed. First
// order and without energy balance, but plausible, finite and reported.
void Integrator::last_resort_step(Problem& problem, double h, AdvanceReport& report) {
  constexpr int pieces = 8;
  iterations_left_ = std::max(iterations_left_, resort_left_);
  care_.deadline = std::chrono::steady_clock::time_point::max();
  problem.set_multipliers(multipliers_saved_);
  has_corrected_ = is_instant_ = false;
  const double before = energy_;
  bool whole = true;
  for (int piece = 0; piece < pieces && whole; ++piece) {
    candidate_.assign(problem.position.begin(), problem.position.end());
    for (std::size_t i = 0; i < problem.size(); ++i) {
      problem.velocity[i] += (h / pieces) * problem.gravity;
      problem.position[i] += (h / pieces) * problem.velocity[i];
    }
    whole = holds_offsets_ || project_positions(problem);
    if (!whole) std::copy(candidate_.begin(), candidate_.end(), problem.position.begin());
    project_velocities(problem);
  }
  if (!whole)
    for (Vec3& v : problem.velocity) v *= 0.5;
  measure_energy(problem, 1);
  if (!std::isfinite(energy_)) {
    problem.position = start_position_;
    std::fill(problem.velocity.begin(), problem.velocity.end(), Vec3{});
    measure_energy(problem, 1);
  }
  missing_ += before - energy_;
  resort_left_ = std::min(resort_left_, iterations_left_);
  ++report.substeps;
}

// Saves the start of the step, to which `advance` may have to return. It never returns after the first solve of a
// conservative problem, so most steps need no copy.
void Integrator::keep_start(const Problem& problem) {
  if (std::exchange(keeps_start_, true)) return;
  start_position_.assign(problem.position.begin(), problem.position.end());
  start_velocity_.assign(problem.velocity.begin(), problem.velocity.end());
}

bool Integrator::least_violation(Problem& problem, Stage stage, AdvanceReport& report) {
  // Rising compliance makes conflicting constraints springs that share the violation.
  stage.part = 1;
  for (const double compliance : {1e-8, 1e-6, 1e-4, 1e-2}) {
    stage.compliance = compliance;
    problem.set_multipliers(multipliers_saved_);
    if (try_step(problem, stage, report)) return violation_ <= largest_violation;
  }
  return false;
}

namespace {

/// Two to four points, each at a fixed distance from each other, and nothing else that holds them or turns them.
bool is_free_body(const Problem& problem) {
  const std::size_t n = problem.size();
  if (n < 2 || n > 4 || !problem.items_of<GyroscopicForce>().empty()) return false;
  std::size_t rows = 0;
  problem.for_each_constraint_pool([&](const auto& pool) { rows += pool.items.size(); });
  const std::size_t rods = problem.items_of<DistanceConstraint>().size();
  return rods == rows && rods == n * (n - 1) / 2;
}

}  // namespace

AdvanceReport Integrator::advance(Problem& problem, double h, const Care& care) {
  AdvanceReport report;
  care_ = care;
  conservative_ = problem.items_of<GripForce>().empty();
  for (const Vec3& f : problem.force) conservative_ = conservative_ && f == Vec3{};
  // The push of a law has no energy: its work is not a gain.
  for (const auto& f : problem.items_of<RadialForce>()) conservative_ = conservative_ && !f.law->has_push();
  step_length_ = h;
  has_curved_rows_ = drives_rows_ = has_corrected_ = false;
  holds_ = {};
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if (pool.items.empty()) return;  // as nearly all are: of many small problems each look at one waits for memory
    has_curved_rows_ = has_curved_rows_ || is_curved<C>;
    for (const C& c : pool.items) {
      holds_.add(c);
      drives_rows_ = drives_rows_ || c.is_moving();
    }
    for (const RowLaw& law : pool.laws) drives_rows_ = drives_rows_ || (law.rate != 0 && !law.is_off());
  });
  conservative_ = conservative_ && !drives_rows_;
  is_free_body_ = is_free_body(problem);
  constexpr int unlimited = std::numeric_limits<int>::max();
  iterations_left_ = care.max_iterations > 0 ? care.max_iterations : unlimited;
  resort_left_ = 24;
  close_gaps(problem, report);
  keeps_start_ = false;
  if (!conservative_ || !report.converged) keep_start(problem);
  measure_energy(problem, 0);
  const double start_kinetic = kinetic_, start_energy = energy_;
  const AdvanceReport start = report;
  // If moving nails have left a conflict, the mid-point rule would double the speed at which bodies catch up.
  is_instant_ = false;
  if (care.scheme == Scheme::mid_point && (conservative_ || !holds_offsets_)) {
    const double taken = care.max_error > 0 ? advance_explicitly(problem, h, report) : 0;
    if (taken < 1) advance_mid_point(problem, (1 - taken) * h, taken, 1, 0, report);
  } else
    advance_end_point(problem, h, 0, 1, 0, report);
  // If Newton failed, check the energy balance; an increase means that the iterate is unphysical: discard it.
  const bool found = report.converged && report.fallbacks == 0;
  // If motors, grips or moving nails do work, only the part beyond that work counts. There even a solution may be
  // wrong: a body that has jumped by half a turn satisfies the equations for directions, too.
  const double made_up = conservative_ ? energy_ - start_energy
                                       : report.made - start.made - (report.lost - start.lost) -
                                             (report.dissipated - start.dissipated) - missing_;
  const double work = conservative_ ? 0 : std::abs(report.external_work - start.external_work);
  const bool too_much = made_up > 0.1 * start_kinetic + work + 1e-9 * std::abs(start_energy);
  const bool absurd =
      !conservative_ && made_up > start_kinetic + work + 0.5 * kinetic_ + 1e-6 * (1 + std::abs(start_energy));
  if ((!found && too_much) || absurd) {
    std::copy(start_position_.begin(), start_position_.end(), problem.position.begin());
    std::copy(start_velocity_.begin(), start_velocity_.end(), problem.velocity.begin());
    // Subtracted from the balance again.
    report.external_work = start.external_work, report.dissipated = start.dissipated;
    report.lost = start.lost, report.made = start.made, missing_ = slack_ = 0;
    report.converged = false;
    measure_energy(problem, 0);
    last_resort_step(problem, h, report);
  }
  if (!found && conservative_ && energy_ > start_energy) {
    // Projection raised the potential energy by more than the kinetic energy available: restore the start state.
    if (energy_ - start_energy > kinetic_) {
      std::copy(start_position_.begin(), start_position_.end(), problem.position.begin());
      for (std::size_t i = 0; i < problem.size(); ++i) problem.velocity[i] = 0.5 * start_velocity_[i];
      const double before = energy_;
      measure_energy(problem, 1);
      missing_ += before - energy_;
    } else {
      change_kinetic_energy(problem, energy_ - start_energy);
    }
    // That removed the gains of sub-steps.
    const double back = std::clamp(missing_, 0.0, report.made);
    report.made -= back, missing_ -= back;
  }
  book_rest(problem, h, report);
  if (holds_offsets_) restore_bounds(problem);
  if (std::exchange(cut_short_, false)) {
    report.cut_short = true;
    report.gap = problem.worst_gap(problem.position.data());
  }
  iterations_left_ = unlimited;
  return report;
}

}  // namespace iota::solver
