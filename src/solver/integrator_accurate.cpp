// SPDX-License-Identifier: Apache-2.0
// The accurate mode: explicit steps of fifth order where no row changes, estimated mid-point steps elsewhere.
#include "solver/integrator.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

namespace {

/// Whether a force or damping oscillates or decays within a step of h seconds. Explicit steps that are shorter only where their error
/// shows it let a spring at rest oscillate up to the tolerance: one of 1e6 N/m pulled a gram at rest with 22 N.
bool has_stiff_forces(const Problem& problem, double h) {
  bool stiff = false;
  for (std::size_t i = 0; problem.is_damped() && i < problem.size(); ++i)
    stiff = stiff || !(problem.damping_of(i) * h < 4);
  const ForceStage stage{.h = h};
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items) {
      const Vec3 e = f.arm.value(problem.position.data());
      const Mat3 k = f.stiffness_matrix(e, e, stage);
      double most = 0, mobility = 0;
      for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) most += norm(k * axis);
      for (std::uint32_t i = 0; i < f.arm.count; ++i)
        mobility += f.arm.weights[i] * f.arm.weights[i] / problem.mass[f.arm.nodes[i]];
      stiff = stiff || !(most * mobility * h * h < 4);
    }
  });
  return stiff;
}

constexpr double most_parts = 100;  // of a step by the springs of rows; shorter ones are stiff

/// Whether there is a rope that yields or a soft stop. Where it begins or ends to pull its force has a bend, and the error of
/// an explicit step across that is no energy of one piece.
bool has_one_sided_springs(const Problem& problem) {
  bool any = false;
  problem.for_each_constraint_pool([&](const auto& pool) {
    for (const RowLaw& law : pool.laws) any = any || (law.is_compliant() && law.is_one_sided());
  });
  return any;
}

}  // namespace

// Explicit steps need rows at rest in time.
bool Integrator::is_smooth(Problem& problem, double h) {
  if (keeps_offsets_ || newton_.has_external()) return false;
  if (has_one_sided_springs(problem)) {
    find_pieces_if_due(problem);
    if (!pieces_.empty()) return false;
  }
  if (!problem.items_of<GripForce>().empty()) return false;
  if (drives_rows_) {
    bool moves = false;
    problem.for_each_constraint_pool([&](const auto& pool) {
      for (const auto& c : pool.items) moves = moves || c.is_moving();
    });
    if (moves) return false;
  }
  return !has_stiff_forces(problem, h) &&
         h < most_parts * ActiveSet::longest_step(problem, step_length_, ActiveSet::Springs::obey_loads);
}

// Finds the sides of bounded rows for explicit sub-steps, and the accelerations with them. What stops takes its last speed
// with it.
bool Integrator::begin_motion(Problem& problem, bool has_accelerations, AdvanceReport& report) {
  constexpr int most_releases = 12;
  const auto begin = [&] {
    runge_kutta_->begin(newton_, problem);
    ++report.iterations, --iterations_left_;
  };
  if (problem.has_laws()) {
    const ActiveSet::Sides sides = ActiveSet::begin_motion(problem, step_length_, springs_);
    if (!sides.can_follow) return false;
    if (sides.jump_any) problem.note_late_impulses();
    if (sides.stop_any) {
      const double before = energy_.kinetic, missing = energy_.missing;
      if (!newton_.project_state(problem, 0)) return false;
      energy_.measure_kinetic(problem);
      const double given = energy_.kinetic - before;  // by a motor that reaches its speed at once, or by brakes
      (given > 0 ? report.external_work : report.dissipated) += std::abs(given), energy_.missing = missing;
    }
    has_accelerations = has_accelerations && !sides.are_new;
  }
  if (!has_accelerations) begin();
  for (int i = 0; i < most_releases && problem.has_laws(); ++i, begin())
    if (!ActiveSet::release_motion(problem)) return true;
  return !problem.has_laws();
}

// A joint of 1e-6 m/N between boxes of 0.5 kg vibrates 11 times in a step of 1/60 s, which takes 67 sub-steps, and one of 1e-7 m/N
// 122 parts by the mid-point rule, of which each adds the error of a phase. A vibration by less than half of what a second may add
// is left out: such springs have the stretch of their loads, as a rod has.
bool Integrator::begin_springs(Problem& problem, double h, AdvanceReport& report) {
  constexpr double most = 0.5;
  springs_ = ActiveSet::Springs::obey_loads;
  if (!begin_motion(problem, false, report)) return false;
  if (!problem.has_laws()) return true;
  const double vibration = ActiveSet::largest_vibration(problem) / newton_.reference_length();
  if (vibration <= most * settings_.max_error) {
    report.error += vibration / h;
    return true;
  }
  springs_ = ActiveSet::Springs::vibrate;
  return h < most_parts * ActiveSet::longest_step(problem, step_length_, springs_) &&
         begin_motion(problem, false, report);
}

namespace {

bool has_closed_row(const Problem& problem) {
  constexpr double met = 1e-9;  // a row that has just opened is closed to round-off
  bool closed = false;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      double g[C::rows];
      pool.value(k, problem.position.data(), 1, g);
      for (int r = 0; r < C::rows; ++r) {
        const RowLaw& law = pool.law(k)[r];
        const double start = pool.states.start(k * C::rows + static_cast<std::size_t>(r));
        closed = closed || (!pool.is_equation(k, r) &&
                            law.violation(g[r]) > law.violation(start) + met * pool.items[k].reference_length());
      }
    }
  });
  return closed;
}

/// Time in which the motion may change its direction, s: of the links by their rates and accelerations.
double time_scale(const Problem& problem, std::span<const Vec3> accelerations) {
  double fastest = 0;  // squared, 1/s^2
  for (const auto& c : problem.items_of<DistanceConstraint>()) {
    const auto [a, b] = c.nodes;
    const double per_length = 1 / (c.length * c.length + 1e-300);
    const Vec3 v = problem.velocity[b] - problem.velocity[a], acceleration = accelerations[b] - accelerations[a];
    fastest = std::max(fastest, dot(v, v) * per_length);
    fastest = std::max(fastest, std::sqrt(dot(acceleration, acceleration) * per_length));
  }
  return 1 / std::sqrt(fastest + 1e-300);
}

}  // namespace

// Returns the fraction of the step that was taken.
double Integrator::advance_explicitly(Problem& problem, double h, AdvanceReport& report) {
  if (!is_smooth(problem, h)) return 0;
  if (!runge_kutta_) runge_kutta_ = std::make_unique<RungeKutta>();
  const std::optional<double> start = problem.time_of_laws();
  if (start) set_times_of_laws(problem, *start, *start, report);
  const double time = take_explicit_steps(problem, h, start.value_or(0), report);
  if (start) set_times_of_laws(problem, *start, *start + h, report);
  return time < h ? time / h : 1;
}

// The change of energy is external work; for the whole step it has been booked before.
void Integrator::set_times_of_laws(Problem& problem, double before, double at_end, AdvanceReport& report) {
  problem.set_times_of_laws(before, at_end);
  const double total = energy_.total;
  energy_.measure(problem, 1);
  report.external_work += energy_.total - total;
}

// Returns the time until which it went, s: less than h if a row closes, or if steps become too short, as they do for stiff
// springs. A sub-step ends where friction stops or begins to slide, or a motor reaches its speed. start: the time of laws, s.
double Integrator::take_explicit_steps(Problem& problem, double h, double start, AdvanceReport& report) {
  constexpr double shortest = 1.0 / 4096, safety = 0.9, least = 0.2, most = 5, first = 0.5;
  constexpr int most_changes = 60;  // of sides: then rows switch all the time
  RungeKutta& steps = *runge_kutta_;
  if (!begin_springs(problem, h, report)) return 0;
  const bool has_laws = problem.has_laws();
  const double longest = ActiveSet::longest_step(problem, step_length_, springs_);
  double time = 0, part = std::min(longest, first * time_scale(problem, steps.accelerations()));
  double until_change = 0;  // s, if a row changes its side in the present sub-step
  int changes = 0;
  double since = 0;  // s, when the free motions were found
  while (time < h) {
    part = std::min(part, longest);
    part = (h - time) / std::ceil((h - time) / part * (1 - 1e-9));
    if (!(part >= shortest * h) || is_out_of_budget() || iterations_left_ < RungeKutta::solves) break;
    const double length = until_change > 0 ? until_change : part;
    if (time == 0 || has_laws) find_free_motions(problem), since = time;
    if (problem.is_damped()) free_motions_.clear();
    if (!pieces_.empty() && has_one_sided_springs(problem)) break;
    const AdvanceReport before = report;
    const EnergyBalance energy = energy_;
    const bool is_last = length == h - time;
    report.iterations += RungeKutta::solves, ++report.solves, iterations_left_ -= RungeKutta::solves;
    bool good = steps.step(newton_, problem, length, start + time);
    for (const FreeMotion& free : free_motions_) keep_momenta(problem, free, time + length - since);
    keep_energy(problem, steps, report);
    steps.end(newton_, problem);
    const double error = steps.estimate_error(length).position / newton_.reference_length();
    const double ratio = error / (settings_.max_error * length);
    const bool closes = good && ratio <= 1 && has_closed_row(problem);
    const bool is_too_long = !good && ratio <= 1;  // the constraints cannot be met
    good = good && ratio <= 1 && !closes;
    const double change = good && has_laws ? ActiveSet::find_change(problem, step_length_, shortest * h / length) : 1;
    if (good && change == 1) {
      time = is_last ? h : time + length;
      steps.accept(problem);
      if (problem.adds_impulses()) problem.add_impulses(length);
      track(problem, 1);
      ++report.substeps, report.error += error / h;
    } else {
      const int iterations = report.iterations, solves = report.solves;
      steps.reject(problem);
      problem.set_times_of_laws(start + time, start + time);
      report = before, report.iterations = iterations, report.solves = solves, energy_ = energy;
      if (closes) break;
      if (change < 1) problem.note_late_impulses();
      if (change < 1 && ++changes > most_changes) break;
    }
    until_change = change < 1 && change * length >= shortest * h ? change * length : 0;
    if (has_laws && time < h && !begin_motion(problem, good && change == 1, report)) break;
    if (is_too_long)
      part = least * length;
    else if (change == 1)
      part *= std::clamp(safety * std::pow(ratio, -0.25), least, most);
  }
  if (time > 0) energy_.close(problem, reference_length(), time, report), is_instant_ = true;
  return time;
}

// Pieces on which nothing outside acts but gravity, and whose own forces keep angular momentum. Drag between points does not,
// as it also acts across their line.
void Integrator::find_free_motions(Problem& problem) {
  free_motions_.clear();
  if (problem.has_laws()) find_holds(problem);
  find_pieces_if_due(problem);
  if (!problem.items_of<GyroscopicForce>().empty() || problem.has_pushes()) return;
  bool is_free = holds_.are_none();
  if (!pieces_.empty()) find_holds_of_pieces(problem);
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items) {
      if (f.arm.is_internal() && f.keeps_angular_momentum()) continue;
      is_free = false;
      for (std::uint32_t i = 0; i < f.arm.count && !pieces_.empty(); ++i)
        ++pieces_[connected_.of[f.arm.nodes[i]]].holds.count;
    }
  });
  if (pieces_.empty() && is_free) free_motions_.push_back({rigid_motion_of(problem)});
  for (std::uint32_t k = 0; k < pieces_.size(); ++k)
    if (pieces_[k].holds.are_none()) free_motions_.push_back({rigid_motion_of(problem, connected_.of, k), k});
}

// It began `time` seconds before.
void Integrator::keep_momenta(Problem& problem, const FreeMotion& free, double time) const {
  const RigidMotion& start = free.motion;
  const std::span<const std::uint32_t> piece_of =
      free.piece == FreeMotion::all ? std::span<const std::uint32_t>{} : std::span(connected_.of);
  const RigidMotion now = rigid_motion_of(problem, piece_of, free.piece);
  const Vec3 drift = start.velocity + time * problem.gravity - now.velocity;
  const Vec3 turning = solve_semidefinite(now.inertia, start.angular_momentum - now.angular_momentum, 1e-12);
  for (std::size_t i = 0; i < problem.size(); ++i)
    if (piece_of.empty() || piece_of[i] == free.piece)
      problem.velocity[i] += drift + cross(turning, problem.position[i] - now.center);
}

// The work of a step is integrated with its weights, so its energy is known: the rest is its error, and is returned.
void Integrator::keep_energy(Problem& problem, const RungeKutta& steps, AdvanceReport& report) {
  constexpr double most = 1e-2;    // of the energy of motion: the rest waits for the next step
  constexpr double drift = 1e-12;  // of the places: what rests drifts by, until its rows are closed
  report.external_work += steps.external_work(), report.dissipated += steps.dissipated();
  const double start = energy_.total, work = steps.external_work() - steps.dissipated();
  energy_.measure_change(problem, 1, work);
  const double motion = kinetic_energy_of_motion(problem);
  energy_.slack +=
      EnergyBalance::tolerance(motion, std::abs(start + work) + std::abs(energy_.total)) + drift * energy_.terms;
  if (!(std::abs(energy_.missing) <= most * motion)) return;
  if (pieces_.empty())
    (void)give_energy_back(problem, Stage::projection(), energy_.missing, report);
  else
    scale_motions_of_pieces(problem, energy_.missing, report);
}

// Compares the solved step with one of half its length from the same start. With their accelerations a and a', the
// third derivative is about 4 (a - a') / h, and the error of the mid-point rule h^3 / 12 of that. The half step ends (a
// - a') h^2 / 8 away from the parabola of the whole one. Afterwards the whole step is solved again.
bool Integrator::is_accurate(Problem& problem, const Stage& stage, AdvanceReport& report) {
  const int met = met_;
  candidate_.assign(newton_.displacement().begin(), newton_.displacement().end());
  candidate_multipliers_.resize(problem.multiplier_count());
  problem.copy_multipliers_to(candidate_multipliers_);

  Stage half = Stage::mid_point(stage.h / 2, stage.fraction_start, (stage.fraction_start + stage.fraction) / 2);
  half.tolerance = stage.tolerance, half.part = stage.part;
  // The half closes a quarter of what the whole step closes, as by a constant acceleration.
  spread_overlaps(problem, stage.fraction_start, 0.75 + 0.25 * stage.part_left());
  const bool solved = try_step(problem, half, report);
  spread_overlaps(problem, stage.fraction_start, stage.part_left());
  double worst = 0;
  for (std::size_t i = 0; i < problem.size(); ++i) {  // displacements from the same free flight
    const Vec3 off = newton_.displacement()[i] - 0.25 * candidate_[i];
    worst = std::max(worst, dot(off, off));
  }
  const double limit = settings_.max_error * stage.h * newton_.reference_length() * 3 / 8;
  if (!solved || !(worst <= limit * limit)) return false;
  report.error += 8.0 / 3 * std::sqrt(worst) / (step_length_ * newton_.reference_length());

  std::copy(candidate_.begin(), candidate_.end(), newton_.displacement().begin());
  problem.set_multipliers(candidate_multipliers_);
  const bool again = solve(problem, stage, report);  // starts at the solution: no iterations
  met_ = met;
  return again;
}

}  // namespace iota::solver
