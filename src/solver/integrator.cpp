// SPDX-License-Identifier: Apache-2.0
// A step as a walk through a table of attempts (settings.h), each judged by one balance of its energy (judge.h).
// Other parts of the class: integrator_guess.cpp has the starts of solves; integrator_energy.cpp the corrections at the end
// of a (sub-)step; integrator_impacts.cpp its impacts; integrator_gaps.cpp gaps that are open at the start; integrator_accurate.cpp steps to a tolerance.
#include "solver/integrator.h"

#include "base/slack.h"
#include "solver/active_set.h"
#include "solver/back_off.h"
#include "solver/timed.h"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>
#include <utility>

namespace iota::solver {

namespace {

/// Not quadratic in the points: the mean of two gradients is not an exact discrete gradient, or does not turn with the bodies.
template <class C>
constexpr bool is_curved = std::is_same_v<C, AngleConstraint> || std::is_same_v<C, CouplingConstraint> ||
                           std::is_same_v<C, CurveConstraint> || std::is_same_v<C, StationConstraint> ||
                           std::is_same_v<C, SurfaceConstraint> || std::is_same_v<C, SurfacePairConstraint>;

/// Its target is a length or an angle. That of others is a place, to which nails move with what hangs on them.
template <class C>
constexpr bool has_length = requires(const C& c) {
  { c.target } -> std::convertible_to<double>;
};

constexpr int unlimited = std::numeric_limits<int>::max();
// Iterations of problems with contacts: at least, of a step; of closing what is open, and of projections, where many contacts switch.
constexpr double fewest = 4, of_closing = 60, of_projection = 60;
constexpr auto never = std::chrono::steady_clock::time_point::max();

int most_iterations(double budget, double cost) {
  const double most = budget / std::max(cost, 1.0);
  return most < 1e6 ? static_cast<int>(most) : unlimited;
}

}  // namespace

void Integrator::compile(Problem& problem, const KnownOrder& order) {
  forget_steps(problem);
  is_due_ = !problem.items_of<ContactConstraint>().empty();
  if (!is_due_) return analyze(problem, order);
  if (!problem.has_slots()) problem.forget_slots();  // fit_pools resizes them
  problem.fit_pools();
  reference_length_ = set_reference_lengths(problem);
  make_room(problem);
}

void Integrator::forget_steps(Problem& problem) {
  newton_.forget_factors();
  const auto affines = problem.items_of<AffineConstraint>();
  may_be_in_pieces_ =
      std::any_of(affines.begin(), affines.end(), [](const AffineConstraint& c) { return c.is_nail(); });
  pieces_.clear();
  problem.forget_acting();
  acting_version_ = problem.acting_version();
  has_advanced_ = is_taken_back_ = false;
  if (spin_) spin_->forget();
}

void Integrator::analyze(Problem& problem, const KnownOrder& order) {
  is_due_ = false;
  const bool is_alike = newton_.compile(problem, order);
  if (spin_) is_alike ? spin_->forget_masses() : spin_->forget();
  make_room(problem);
}

void Integrator::make_ready(Problem& problem) {
  if (!is_due_) return;
  analyze(problem);
  newton_.set_slots_of_velocity_forces(problem);
}

void Integrator::follow(Problem& problem) {
  may_be_in_pieces_ = true;
  newton_.follow(problem);
  if (spin_) spin_->forget();
  make_room(problem);
}

void Integrator::make_room(const Problem& problem) {
  has_advanced_ = is_taken_back_ = false;
  is_heap_known_ = knows_tetrahedra_ = false;
  if (!is_due_) reference_length_ = newton_.reference_length();
  if (local_) local_->forget();
  lumped_mass_.clear();
  multipliers_saved_.resize(problem.multiplier_count());
}

namespace {

/// The friction of sweeps has strained nothing: contacts that stick begin to hold here.
void begin_strain(Problem& problem) {
  if (!problem.has_used<ContactConstraint>()) return;
  auto& pool = problem.pool_of<ContactConstraint>();
  for (std::size_t i = 0; i < pool.items.size(); ++i) {
    if (std::exchange(pool.items[i].is_strained, true)) continue;
    double* const l = pool.multiplier(i);
    l[1] = l[2] = 0;
    pool.items[i].unstored -= strain_energy(pool.items[i], l);
  }
}

}  // namespace

AdvanceReport Integrator::advance(Problem& problem, double h, const IntegratorSettings& settings) {
  const AdvanceReport report = advance_within_limits(problem, h, settings);
  if (solves_part_ && report.converged && !report.is_approximate) newton_.share_among_redundant(problem);
  // Accelerations are means then, too. Corrections of the end-point rule are not by rows.
  if (problem.end_impulses(report.converged && !report.is_approximate ? h : 0)) {
    is_instant_ = false;
    has_corrected_ = has_corrected_ && settings.scheme == Scheme::end_point;
  }
  // Projections between steps have none. With the deadline of a step that was long ago, each of them was given up at once.
  iterations_left_ = unlimited, settings_.deadline = never;
  return report;
}

AdvanceReport Integrator::advance_within_limits(Problem& problem, double h, const IntegratorSettings& settings) {
  AdvanceReport report;
  if (settings.max_turn != settings_.max_turn) least_turn_cosine_ = std::cos(settings.max_turn);
  settings_ = settings;
  step_length_ = h;
  double cost = 0;
  if (is_beyond_budget(problem, cost)) {
    problem.has_new_rows = false, problem.standing_gap = 0;
    energy_ = {};
    energy_.measure(problem, 0);
    damp(problem, h / 2, report);
    sweep(problem, {.h = h}, report);
    damp(problem, h / 2, report);
    return report;
  }
  begin_strain(problem);
  make_ready(problem);
  newton_.add_times_to(times_of_thread());
  iterations_left_ = settings.max_iterations > 0 ? settings.max_iterations : unlimited;
  if (contacts_ != Contacts::exact) {
    const double burst = settings.contact_burst(heap_->is_tree(), contacts_ == Contacts::machine);
    const double left =
        std::clamp(IntegratorSettings::most_owed * burst - problem.owed_work, 0.0, settings.part * burst);
    iterations_left_ = std::min(iterations_left_, most_iterations(left, cost));
  }
  if (may_sweep() && !heap_->is_tree() && settings.max_error == 0)
    settings_.max_depth = std::min(settings_.max_depth, IntegratorSettings::heap_depth(settings.scheme));
  const bool is_brief = problem.unsolved_steps >= IntegratorSettings::full_tries && !is_due(problem.unsolved_steps);
  if (is_brief) iterations_left_ = std::min(iterations_left_, IntegratorSettings::brief_iterations);
  resort_left_ = IntegratorSettings::last_resort_iterations;
  is_cut_short_ = is_over_ = solves_part_ = is_instant_ = has_corrected_ = false;
  look_at(problem);
  std::exchange(is_taken_back_, false) ? begin_like_the_latest() : note_beginning();
  has_advanced_ = true;
  close_gaps(problem, report);
  energy_ = {};
  energy_.measure(problem, 0);
  // If moving nails have left a conflict, the mid-point rule would double the speed at which bodies catch up.
  const bool by_end_point = (settings.scheme == Scheme::end_point && !find_bounces(problem, {.h = h})) ||
                            (keeps_offsets_ && !is_conservative_);
  const double taken = settings.max_error > 0 && !by_end_point ? advance_explicitly(problem, h, report) : 0;
  if (taken < 1) {
    const Part part{.from = taken, .h = (1 - taken) * h};
    damp(problem, part.h / 2, report);
    advance_part(problem, part, by_end_point ? 1 : 0, report);
    damp(problem, part.h / 2, report);
  }
  if (keeps_offsets_) {
    drop_offsets(problem);
    (void)problem.end_impulses(0);  // in a conflict rows push with any force
  }
  const bool is_unsolved = taken == 0 && !solves_part_;
  const bool is_new = is_unsolved && (is_brief || !is_cut_short_);
  problem.unsolved_steps = is_new || report.is_approximate ? problem.unsolved_steps + 1 : 0;
  if (is_cut_short_ && !is_brief && !report.is_approximate) {
    report.cut_short = true;
    report.gap = problem.worst_gap(problem.position.data());
  }
  if (settings.max_error == 0 && contacts_ != Contacts::exact) problem.owed_work += report.iterations * cost;
  newton_.add_times_to(nullptr);
  return report;
}

// Half of it before the rest of the motion and half after it (Strang 1968): of second order, and exact for what only damping
// slows. Explicit sub-steps have it as a force.
void Integrator::damp(Problem& problem, double time, AdvanceReport& report) {
  if (!problem.is_damped()) return;
  problem.damp_velocities(time);
  const double before = energy_.kinetic;
  energy_.kinetic = problem.kinetic_energy();
  energy_.total += energy_.kinetic - before, report.dissipated += before - energy_.kinetic;
}

// Which pieces a problem has is found out when it is needed, and depends on the history since then.
void Integrator::note_beginning() {
  may_have_been_in_pieces_ = may_be_in_pieces_;
  piece_count_before_ = pieces_.size();
  if (!pieces_.empty()) connected_before_ = connected_;
}

void Integrator::begin_like_the_latest() {
  may_be_in_pieces_ = may_have_been_in_pieces_;
  pieces_.resize(piece_count_before_);
  if (!pieces_.empty()) connected_ = connected_before_;
}

// Finds out how the world outside may act on the problem during the step.
void Integrator::look_at(Problem& problem) {
  bool moves_rows = false, moves_points = false, has_rates = false, drives = false;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if (pool.items.empty()) return;  // as nearly all are: of many small problems each look at one waits for memory
    bool moves = false;
    for (const C& c : pool.items) moves = moves || c.is_moving();
    moves_rows = moves_rows || moves, moves_points = moves_points || (moves && !has_length<C>);
    for (const RowLaw& law : pool.laws) {
      if (!law.is_rate || law.is_off() || ConeConstraint<C>) continue;
      has_rates = true, drives = drives || law.rate != 0;
    }
  });
  drives_rows_ = moves_rows || drives;
  const bool may_meet = problem.has_laws() && (!may_sweep() || heap_->has_joints());
  if ((has_rates || may_meet || moves_rows) && !moves_points && !problem.adds_impulses()) problem.begin_impulses();
  find_holds(problem);
  is_conservative_ = !drives_rows_ && problem.items_of<GripForce>().empty() && !problem.has_pushes();
  // The push of a law has no energy: its work is not a gain.
  for (const auto& f : problem.items_of<RadialForce>())
    is_conservative_ = is_conservative_ && !f.does_external_work() &&
                       !f.attracts_more_nearby(norm(f.arm.value(problem.position.data())));
}

// By the rows that act: in the last step, as long as this one is not solved, then in this one. See Problem::note_acting.
void Integrator::find_holds(Problem& problem, const Vec3* x) {
  has_curved_rows_ = false;
  holds_ = {};
  problem.note_acting(x);
  problem.for_each_acting([&]<class C>(const ConstraintPool<C>& pool, std::size_t i) {
    has_curved_rows_ = has_curved_rows_ || is_curved<C>;
    holds_.add(pool.items[i]);
  });
  if (acting_version_ != problem.acting_version()) may_be_in_pieces_ = true;
  acting_version_ = problem.acting_version();
}

void Integrator::advance_part(Problem& problem, const Part& part, std::size_t first, AdvanceReport& report) {
  if (is_over_) return;
  for (std::size_t i = first; i < attempts.size(); ++i) {
    const Attempt& attempt = attempts[i];
    if (may_sweep() && attempt.compliance > exact_rows) break;  // sweeps do better
    const bool turns = attempt.scheme == Scheme::mid_point && may_halve(part, report) &&
                       will_turn_too_far(problem, part.h);  // no need to try
    if (!turns && take(problem, part, attempt, report)) return;
    if (first == 1 && i == 1 && may_need_mid_point(problem) && take(problem, part, attempts[0], report)) return;
    if (attempt.is_halved && may_halve(part, report)) {
      for (const Part& half : part.halves()) advance_part(problem, half, i, report);
      return;
    }
    if (attempt.scheme == Scheme::mid_point) ++report.fallbacks;
  }
  const double rest = (1 - part.from) * step_length_;
  is_over_ = may_sweep() || (contacts_ == Contacts::machine && is_cut_short_);
  // Sweeps would close the gaps of a conflict at once.
  if (may_sweep() || (is_over_ && !keeps_offsets_)) return sweep(problem, {.from = part.from, .h = rest}, report);
  report.converged = false;
  note_unknown_error(report);
  coast(problem, is_over_ ? rest : part.h, report);
}

// It counted as none: sweeps left 6 mm where 1e-6 of a length was told.
void Integrator::note_unknown_error(AdvanceReport& report) const {
  if (settings_.max_error > 0) report.error = std::numeric_limits<double>::infinity();
}

namespace {

/// Overlaps that sweeps have left, if they are small: the equations would close them at once.
void accept_overlaps(Problem& problem) {
  constexpr double small = 3e-3;  // of the size
  for (ContactConstraint& c : problem.items_of<ContactConstraint>()) {
    if (!c.is_of_sweeps) continue;
    double g[ContactConstraint::rows];
    c.value(problem.position.data(), 0, g);
    c.is_of_sweeps = g[0] < -closed_gap * c.reference_length();
    if (c.is_of_sweeps && g[0] > -small * c.reference_length()) c.radius += g[0];
  }
}

}  // namespace

// The cost of a factor depends on the structure alone, so that a restored problem takes the same way.
Integrator::Contacts Integrator::kind_of_contacts(Problem& problem, const IntegratorSettings& settings, double& cost) {
  const double budget = settings.contact_budget;
  if (problem.items_of<ContactConstraint>().empty() || budget == std::numeric_limits<double>::infinity())
    return Contacts::exact;
  if (!heap_) heap_ = std::make_unique<Heap>();
  if (!std::exchange(is_heap_known_, true)) {
    is_heap_ = heap_->find_bodies(problem);
    heap_cost_.reset();
  }
  if (!is_heap_) return Contacts::exact;
  cost = heap_->least_cost_of_factor();
  if (!(fewest * cost > budget)) {
    if (!heap_cost_) heap_cost_ = heap_->cost_of_factor();
    cost = *heap_cost_;
  }
  // Joints within a part of the budget are not left to sweeps. These lost a load that beads of a 4000th of its mass held.
  const double of_machine = heap_->has_light_joints() ? 1 : 1.0 / 8;
  if (!heap_->has_joints() || fewest * cost > of_machine * budget) return Contacts::heap;
  return heap_->has_light_joints() || settings.max_error > 0 ? Contacts::exact : Contacts::machine;
}

// Whether so many iterations take more than its share of the budget.
bool Integrator::is_beyond(Problem& problem, const IntegratorSettings& settings, double iterations) {
  double cost = 0;
  return kind_of_contacts(problem, settings, cost) == Contacts::heap && settings.is_beyond_share(iterations * cost);
}

bool Integrator::is_projected_as_heap(Problem& problem, const IntegratorSettings& settings) {
  return is_beyond(problem, settings, of_projection);
}

std::optional<bool> Integrator::project_heap(Problem& problem, const IntegratorSettings& settings,
                                             const Heap::Projection& projection) {
  if (!is_beyond(problem, settings, projection.h > 0 ? fewest : of_projection)) return std::nullopt;
  const bool is_alone = problem.has_no_world();
  RigidMotion motion = is_alone ? rigid_motion_of(problem) : RigidMotion{};
  for (std::size_t i = 0; is_alone && i < projection.impulses.size(); ++i) {
    motion.velocity += (1 / motion.mass) * projection.impulses[i];
    motion.angular_momentum += cross(problem.position[i] - motion.center, projection.impulses[i]);
  }
  const bool is_met = heap_->project(problem, projection);
  // The masses of points that bodies share are shared out, which may leave a body without inertia.
  if (is_alone) keep_momenta(problem, {motion}, 0);
  return is_met;
}

// Whether even the fewest iterations of a step would take more, or the closing of overlaps; or the last steps have taken more,
// so that this one is not tried.
bool Integrator::is_beyond_budget(Problem& problem, double& cost) {
  contacts_ = kind_of_contacts(problem, settings_, cost);
  if (!may_sweep()) {
    // A joint that is added to what lies in a heap may prevent that they are closed.
    if (settings_.contact_budget < std::numeric_limits<double>::infinity()) accept_overlaps(problem);
    return false;
  }
  std::uint64_t& swept = problem.unsolved_steps;
  if (swept > 0 && settings_.part < 1) return ++swept > 0;  // a step is tried as a whole
  const auto is_open = [&] { return problem.worst_gap(problem.position.data(), 0, true) > strained_gap; };
  const bool is_large = settings_.is_beyond_share(fewest * cost);
  const bool waits = swept > 0 && !is_due(swept);
  if (is_large) is_due_ = true;
  if (is_large || waits) return ++swept > 0;
  std::span<ContactConstraint> contacts = problem.items_of<ContactConstraint>();
  std::vector<ContactConstraint> before;
  if (swept > 0 || of_closing * cost > settings_.contact_burst(true)) before.assign(contacts.begin(), contacts.end());
  accept_overlaps(problem);
  if (before.empty() || !is_open()) return false;
  // It is tried as soon as nothing is open. Until then sweeps push also those overlaps apart.
  std::copy(before.begin(), before.end(), contacts.begin());
  swept = std::max<std::uint64_t>(swept, 1);
  return true;
}

void Integrator::fit_contacts(Problem& problem, double share) {
  if (!problem.has_used<ContactConstraint>()) return;
  auto& pool = problem.pool_of<ContactConstraint>();
  for (std::size_t k = 0; k < pool.items.size(); ++k) pool.items[k].fit(share, pool.multiplier(k));
}

// Nothing moves against each other. The momenta of what nothing holds stay as they are.
void Integrator::stay(Problem& problem, double h, bool is_alone) {
  const Vec3 way = is_alone ? h * (rigid_motion_of(problem).velocity + 0.5 * h * problem.gravity) : Vec3{};
  for (std::size_t i = 0; i < problem.size(); ++i) {
    if (problem.mass[i] == 0) continue;
    problem.position[i] += way;
    problem.velocity[i] = is_alone ? problem.velocity[i] + h * problem.gravity : 0.5 * problem.velocity[i];
  }
}

// To the end of the step, in place of the equations of all contacts: these would close its overlaps at once.
void Integrator::sweep(Problem& problem, const Part& part, AdvanceReport& report) {
  fit_contacts(problem, 1);
  has_corrected_ = is_instant_ = false;
  const EnergyBalance before = energy_;
  const double share = settings_.part * part.h / step_length_;
  const int sub_steps =
      std::clamp(static_cast<int>(std::lround(Heap::most_sub_steps * share)), 1, Heap::most_sub_steps);
  const bool is_alone = problem.has_no_world();
  const bool is_free = is_alone && problem.items_of<GripForce>().empty() && !problem.has_pushes();
  const std::optional<RigidMotion> free =
      (heap_->has_joints() || heap_->has_forces()) && is_free ? std::optional(rigid_motion_of(problem)) : std::nullopt;
  const HeapReport swept = heap_->advance(problem, part.h, part.from, part.to, sub_steps);
  if (swept.has_diverged) stay(problem, part.h, is_alone);
  track(problem, part.to);
  // A joint that is open within the step has its forces at two places, and is closed at its end. A spring has them where it was.
  if (free) keep_momenta(problem, {*free}, part.h);
  report.converged = report.converged && swept.are_joints_met;
  energy_.measure_change(problem, part.to, swept.external_work);
  // A light body between heavy ones may be shot away. Overlaps that are pushed apart lift bodies: that is not motion.
  const double lifted = energy_.total - energy_.kinetic - (before.total - before.kinetic);
  const double pushed = std::clamp(swept.lifted, 0.0, std::max(0.0, lifted));
  const double made = energy_.kinetic - before.kinetic + lifted - pushed - std::max(0.0, swept.external_work);
  if (made > 0)
    (void)change_kinetic_energy(problem, made, is_alone ? std::optional(rigid_motion_of(problem)) : std::nullopt);
  report.external_work += swept.external_work;
  // The rest of what they have lifted has been paid by nothing, as where gaps are closed.
  const double raised = std::clamp(-energy_.missing, 0.0, std::max(0.0, lifted));
  report.closing_energy += raised, energy_.missing += raised;
  // Impacts and friction are not told apart from what the sub-steps lose.
  report.dissipated += std::exchange(energy_.missing, std::min(0.0, energy_.missing)) - energy_.missing;
  energy_.close(problem, reference_length(), part.h, report);
  note_unknown_error(report);
  report.is_approximate = true;
  report.gap = std::max(report.gap, swept.depth);
  ++report.substeps;
  solves_part_ = true;
}

// Heaps that the end-point rule cannot solve: of 20 bodies that fall, 3 to 37 of 300 steps. And rows that push, as a rod below a mass that
// tips over: by the end-point rule they make energy in a part of any length, which the mid-point rule keeps.
bool Integrator::may_need_mid_point(Problem& problem) const {
  if (keeps_offsets_) return false;
  bool has_forces = false;
  problem.for_each_force_pool([&](const auto& pool) { has_forces = has_forces || !pool.items.empty(); });
  return !problem.items_of<ContactConstraint>().empty() || (makes_energy_ && !has_forces);
}

bool Integrator::may_halve(const Part& part, const AdvanceReport& report) const {
  return part.depth < settings_.max_depth && report.iterations <= settings_.patience;
}

bool Integrator::take(Problem& problem, const Part& part, const Attempt& attempt, AdvanceReport& report) {
  const bool is_mid_point = attempt.scheme == Scheme::mid_point, is_soft = attempt.compliance > exact_rows;
  makes_energy_ = false;
  Stage stage =
      is_mid_point ? Stage::mid_point(part.h, part.from, part.to) : Stage::end_point(part.h, part.from, part.to);
  stage.tolerance *= settings_.tolerance, stage.compliance = attempt.compliance;
  stage.part = is_soft ? 1 : compliance_part(part, attempt.scheme);
  stage.is_held = holds_.count > 1;
  // Parts of a step that only its solution needs are solved more easily with the compliances of the whole one.
  if (settings_.max_error > 0) fit_contacts(problem, part.h / step_length_);
  if (part.h < step_length_)
    for (ContactConstraint& c : problem.items_of<ContactConstraint>())
      c.begin_part(problem.position.data(), problem.velocity.data(), part.from, part.to, part.h);
  problem.copy_multipliers_to(multipliers_saved_);
  (void)find_bounces(problem, part);
  if (part.to < 1) spread_overlaps(problem, part.from, stage.part_left());
  const Trial trial{.scheme = attempt.scheme,
                    .is_finest = !attempt.is_halved || !may_halve(part, report),
                    .is_conservative = is_conservative_,
                    .drives_rows = drives_rows_};
  StepEnergy energy;
  if (!try_step(problem, stage, report) || !is_acceptable(problem, stage, trial, energy, report)) {
    problem.set_multipliers(multipliers_saved_);
    forget_bounces(problem);
    return false;
  }
  if (!is_mid_point || trial.is_finest) note_unknown_error(report);
  if (problem.has_laws()) find_holds(problem);
  // The mean gradient of an angle does not turn with the body: a free screw lost 4e-3 of its angular momentum in a second,
  // free gears 1e-5.
  free_motions_.clear();
  if (is_mid_point && has_curved_rows_) find_free_motions(problem);
  // In a conflict also what targets take that give way to rows: what these store in their gaps is in no book.
  if (drives_rows_) energy.external_work -= keeps_offsets_ ? energy.idle_work() : std::max(0.0, energy.idle_work());
  if (keeps_offsets_) energy.overdrawn = 0;
  if (keeps_offsets_) note_momenta(problem, stage);
  const AdvanceReport before = report;
  commit(problem, stage, energy, report);
  for (const FreeMotion& free : free_motions_) keep_momenta(problem, free, part.h);
  if (!free_motions_.empty()) energy_.measure_kinetic(problem);
  if (!is_mid_point) {
    book_held_forces_that_press(problem, stage, report);
    give_spin_back(problem, stage, energy.damped, report);
  }
  if (has_impacts(problem, stage))
    solve_impacts(problem, stage, energy, report);
  else if (is_mid_point)
    project_velocities_after_step(problem, stage, report);
  const bool keeps_momenta = !keeps_offsets_ || restore_momenta(problem);
  if (!is_mid_point || keeps_offsets_)
    remove_made_energy(problem, energy.total_before);
  else
    remove_energy_of_gaps(problem, energy.recoil);
  if (!keeps_momenta || (keeps_offsets_ && has_taken_off(energy))) {
    report.external_work = before.external_work, report.dissipated = before.dissipated;
    move_rigidly_instead(problem, part, report);
  }
  forget_bounces(problem);
  if (has_corrected_) keep_correction(problem);
  energy_.close(problem, reference_length(), part.h, report);
  report.converged = report.converged && !is_soft;
  return true;
}

// A held gap of a point is a direction in the world, which does not turn with the bodies: steps in conflict changed the
// angular momentum of what flies freely by a third.
void Integrator::note_momenta(const Problem& problem, const Stage& stage) {
  const auto end = newton_.solution();
  saved_position_.assign(end.begin(), end.end());
  if (stage.is_mid_point())
    for (std::size_t i = 0; i < end.size(); ++i) saved_position_[i] = 0.5 * (problem.position[i] + end[i]);
  spin().note(problem, holds_, Connection::rows_and_forces);
  spin().expect(problem, saved_position_, stage.h);
  saved_position_.assign(problem.position.begin(), problem.position.end());
  saved_velocity_.assign(problem.velocity.begin(), problem.velocity.end());
}

// False if what is free cannot carry them any more.
bool Integrator::restore_momenta(Problem& problem) {
  const double lost = spin().restore(problem);
  energy_.measure_kinetic(problem);
  has_corrected_ = true;
  return lost == 0 || drives_rows_ || !holds_.are_none();
}

/// Points that a conflict draws almost into one place can carry their angular momentum only with an energy that nothing gives.
bool Integrator::has_taken_off(const StepEnergy& step) const {
  constexpr double most = 1e-6;  // of the kinetic energy
  const double made = energy_.total - step.total_before - step.external_work;
  return !drives_rows_ && !(made <= most * step.motion() + energy_.slack);
}

void Integrator::move_rigidly_instead(Problem& problem, const Part& part, AdvanceReport& report) {
  std::copy(saved_position_.begin(), saved_position_.end(), problem.position.begin());
  std::copy(saved_velocity_.begin(), saved_velocity_.end(), problem.velocity.begin());
  has_corrected_ = false;
  energy_ = {};
  energy_.measure(problem, part.from);
  move_rigidly(problem, part.h, report);
}

bool Integrator::is_acceptable(Problem& problem, const Stage& stage, Trial trial, StepEnergy& energy,
                               AdvanceReport& report) {
  if (stage.compliance > exact_rows && violation_ > IntegratorSettings::largest_violation) return false;
  if (stage.is_mid_point() && turns_too_far(problem)) return false;
  if (mirrors_a_solid(problem, problem.position, newton_.solution())) return false;
  if (passes_through_round(problem, stage, newton_.solution())) return false;
  if (stage.is_mid_point() && settings_.max_error > 0 && !trial.is_finest && !is_accurate(problem, stage, report))
    return false;
  const Outside outside{.drives_rows = drives_rows_, .holds = !holds_.are_none()};
  energy = energy_.of_solution(problem, newton_, stage, outside, multipliers_saved_);
  Verdict verdict = judge(trial, energy);
  if (verdict == Verdict::refine) {
    Stage finer = stage;
    finer.tolerance *= 1e-4;
    (void)solve(problem, finer, report);
    trial.is_refined = true;
    energy = energy_.of_solution(problem, newton_, stage, outside, multipliers_saved_);
    verdict = judge(trial, energy);
  }
  makes_energy_ = verdict == Verdict::reject;
  return !makes_energy_;
}

void Integrator::commit(Problem& problem, const Stage& stage, const StepEnergy& energy, AdvanceReport& report) {
  energy_.take(energy, report);
  for (std::size_t i = 0; i < problem.size(); ++i) {
    problem.velocity[i] += ((stage.is_mid_point() ? 2 : 1) / stage.h) * newton_.displacement()[i];
    problem.position[i] = newton_.solution()[i];
  }
  add_impulses(problem, stage.h);
  if (problem.adds_impulses()) problem.add_impulses(stage.h);
  track(problem, stage.fraction);
  has_corrected_ = is_instant_ = false;
  ++report.substeps;
  solves_part_ = true;
}

void Integrator::add_impulses(Problem& problem, double h) {
  if (!problem.has_used<ContactConstraint>()) return;
  auto& pool = problem.pool_of<ContactConstraint>();
  for (std::size_t i = 0; i < pool.items.size(); ++i)
    for (std::size_t r = 0; r < ContactConstraint::rows; ++r) pool.items[i].impulse[r] += h * pool.multiplier(i)[r];
}

void Integrator::track(Problem& problem, double fraction) {
  for (Problem::CountedAngle& c : problem.counted_angles) c.angle.track(problem.position.data(), fraction);
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if constexpr (TrackingConstraint<C>)
      for (C& c : pool.items) c.track(problem.position.data(), fraction);
  });
}

// If no attempt has succeeded: moves the points by their velocities, in small pieces, and projects positions and velocities
// on the constraints after each. From the first piece that cannot be taken to the end of the part the problem moves as a
// rigid body, or stays if it is held. First order and without an energy balance, but plausible, finite and reported; what
// nothing holds keeps momentum and angular momentum.
void Integrator::coast(Problem& problem, double h, AdvanceReport& report) {
  const int left = iterations_left_, allowed = std::max(left, resort_left_);
  iterations_left_ = allowed;
  settings_.deadline = never;
  has_corrected_ = is_instant_ = false;
  constexpr int pieces = IntegratorSettings::last_resort_pieces;
  int taken = 0;
  while (taken < pieces && coast_a_piece(problem, h / pieces, report)) ++taken;
  if (taken < pieces) move_rigidly(problem, h * (pieces - taken) / pieces, report);
  resort_left_ = std::min(resort_left_, iterations_left_);
  iterations_left_ = std::max(0, left - (allowed - iterations_left_));
  energy_.close(problem, reference_length(), h, report);
  ++report.substeps;
}

bool Integrator::coast_a_piece(Problem& problem, double h, AdvanceReport& report) {
  saved_position_.assign(problem.position.begin(), problem.position.end());
  saved_velocity_.assign(problem.velocity.begin(), problem.velocity.end());
  const EnergyBalance before = energy_;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    problem.velocity[i] += h * problem.gravity;
    problem.position[i] += h * problem.velocity[i];
  }
  spin().note(problem, holds_);
  bool is_taken = keeps_offsets_ ? !opens_gaps(problem) : project_positions(problem);
  if (is_taken) {
    project_velocities(problem);
    const bool keeps_momenta = spin().restore(problem) == 0;
    energy_.measure_change(problem, 1);
    const double gained = energy_.total - before.total;
    is_taken = keeps_momenta && std::isfinite(gained) && (drives_rows_ || gained <= 0 || pay(problem, gained)) &&
               !mirrors_a_solid(problem, saved_position_, problem.position);
  }
  if (is_taken) {
    act_with_held_forces(problem, h, report);
    track(problem, 1);
    return true;
  }
  std::copy(saved_position_.begin(), saved_position_.end(), problem.position.begin());
  std::copy(saved_velocity_.begin(), saved_velocity_.end(), problem.velocity.begin());
  energy_ = before;
  return false;
}

// Whether the points have left the gaps of a conflict behind: what flies freely can go on as a rigid body instead.
bool Integrator::opens_gaps(const Problem& problem) const {
  if (!holds_.are_none()) return false;
  const double before = problem.worst_gap(saved_position_.data(), 1, true);
  return !(problem.worst_gap(problem.position.data(), 1, true) <= before + strained_gap);
}

// A projection may have raised the points by more than the motion can pay: a rigid one keeps its angular momentum.
bool Integrator::pay(Problem& problem, double energy) {
  const std::optional<RigidMotion> rigid = rigid_motion(problem);
  return !(rigid && energy_.kinetic - rigid->kinetic_energy() <= energy) &&
         change_kinetic_energy(problem, energy, rigid);
}

// Their impulses, which the rows distribute.
void Integrator::act_with_held_forces(Problem& problem, double h, AdvanceReport& report) {
  if (problem.force.empty()) return;
  std::vector<Vec3>& impulses = saved_velocity_;
  std::transform(problem.force.begin(), problem.force.end(), impulses.begin(), [h](const Vec3& f) { return h * f; });
  project_velocities(problem, 0, impulses);
  const double work = problem.kinetic_energy() - energy_.kinetic;
  energy_.kinetic += work, energy_.total += work, report.external_work += work;
}

namespace {

/// Whether a slack rope, an open stop or a near surface should have acted.
bool violates_idle_rows(const Problem& problem) {
  bool any = false;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t i = 0; i < pool.items.size() && pool.has_laws(); ++i) {
      if (pool.acts(i)) continue;
      double g[C::rows];
      pool.items[i].value(problem.position.data(), 1, g);
      for (int r = 0; r < C::rows; ++r)
        any = any || !(pool.law(i)[r].violation(g[r]) <= strained_gap * pool.items[i].reference_length());
    }
  });
  return any;
}

}  // namespace

// From the saved state. What would meet a stop or a surface on its way stays, as what is held does.
void Integrator::move_rigidly(Problem& problem, double h, AdvanceReport& report) {
  double work = spin().move_rigidly(problem, h, holds_);
  if (violates_idle_rows(problem)) {
    work = 0;
    std::copy(saved_position_.begin(), saved_position_.end(), problem.position.begin());
    for (std::size_t i = 0; i < problem.size(); ++i) problem.velocity[i] = 0.5 * saved_velocity_[i];
  }
  if (!std::isfinite(problem.kinetic_energy())) std::fill(problem.velocity.begin(), problem.velocity.end(), Vec3{});
  energy_.measure_change(problem, 1, work);
  report.external_work += work;
}

// Sub-steps have the row compliance of the whole step, as a taut net of bars stores energy in it: a shorter one with less would
// return more than was stored, in steps of 1/60 s 100 to 660 J. Only down to a quarter by the end-point rule, which gains none,
// and to a sixteenth by the mid-point rule, as a millionfold heavy end and springs of 1e12 N m/rad open joints by it. Not
// where rows are driven: an arm that is pulled beyond its reach would store more before its elbow snaps (227 J of kinetic energy
// instead of 37). Its price: the energy of a four-bar linkage deviates by 1.4e-8 instead of 4e-9.
double Integrator::compliance_part(const Part& part, Scheme scheme) const {
  const double smallest = scheme == Scheme::mid_point ? 1.0 / 16 : 0.25;
  return drives_rows_ ? 1 : std::max(part.to - part.from, smallest);
}

bool Integrator::will_turn_too_far(const Problem& problem, double h) const {
  for (const auto& c : problem.items_of<DistanceConstraint>()) {
    const Vec3 d = problem.position[c.nodes[1]] - problem.position[c.nodes[0]];
    const Vec3 moved = h * (problem.velocity[c.nodes[1]] - problem.velocity[c.nodes[0]]);
    if (dot(moved, moved) > settings_.max_turn * settings_.max_turn * dot(d, d)) return true;
  }
  return false;
}

bool Integrator::passes_through_round(const Problem& problem, const Stage& stage, std::span<const Vec3> after) {
  if (!problem.has_used<ContactConstraint>()) return false;
  const auto apart = [](const ContactConstraint& c, const Vec3* x, double fraction) {
    return c.off(c.arm(0, x, fraction), c.arm(2, x, fraction), c.arm(3, x, fraction));
  };
  const auto& pool = problem.pool_of<ContactConstraint>();
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    const ContactConstraint& c = pool.items[k];
    if (!c.is_round) continue;
    const Vec3 start = apart(c, problem.position.data(), stage.fraction_start);
    if (dot(start, apart(c, after.data(), stage.fraction)) < 0) return true;
  }
  return false;
}

bool Integrator::mirrors_a_solid(const Problem& problem, std::span<const Vec3> before, std::span<const Vec3> after) {
  if (!std::exchange(knows_tetrahedra_, true)) tetrahedra_.find(problem);
  return tetrahedra_.are_mirrored(before, after);
}

bool Integrator::turns_too_far(const Problem& problem) const {
  const auto x1 = newton_.solution();
  const double least = least_turn_cosine_ * least_turn_cosine_;
  for (const auto& c : problem.items_of<DistanceConstraint>()) {
    const Vec3 d0 = problem.position[c.nodes[1]] - problem.position[c.nodes[0]];
    const Vec3 d1 = x1[c.nodes[1]] - x1[c.nodes[0]];
    const double d = dot(d0, d1);
    if (d <= 0 || d * d < least * dot(d0, d0) * dot(d1, d1)) return true;
  }
  return false;
}

// Contacts that are as near as each other, as those of a wheel with a bump and with the road, all close in the first iteration.
// Their forces of 1000 times the weight opened others and made them slip, and so on: one in 130 steps of a car on bumps took
// 120 iterations. While contacts are soft, such forces are small: a car takes a sixth fewer iterations, a rope that slides over a
// beam two fifths. Closing by sticking, too, was better for wheels and three times as bad for the rope. Heaps of loose bodies took
// a tenth more time.
bool Integrator::try_step(Problem& problem, const Stage& stage, AdvanceReport& report) {
  make_guess(problem, stage);
  Stage first = stage;
  first.begins_softly = !may_sweep() && !stage.is_projection() && problem.has_used<ContactConstraint>();
  return solve(problem, first, report) || solve_jammed_contacts(problem, stage, report) ||
         solve_softer_contacts(problem, stage, report);
}

// A contact that slips may press itself so that no friction along its slip balances it, as chalk that is pushed over a board
// (Painleve 1895): it jams. Newton's method finds no solution from slipping, for any length of the part. It does from
// sticking. In heaps, which have sweeps, this would only take from their iterations.
bool Integrator::solve_jammed_contacts(Problem& problem, const Stage& stage, AdvanceReport& report) {
  const std::span<ContactConstraint> contacts = problem.items_of<ContactConstraint>();
  if (contacts.empty() || may_sweep() || stage.is_projection() || stage.compliance > exact_rows) return false;
  constexpr int few = 6;  // iterations: where it jams, 2 to 8 do
  problem.set_multipliers(multipliers_saved_);
  make_guess(problem, stage);
  for (ContactConstraint& c : contacts) c.never_slips = true;
  Stage brief = stage;
  brief.max_iterations = few;
  const bool is_held = solve(problem, brief, report);
  for (ContactConstraint& c : contacts) c.never_slips = false;
  return is_held && solve(problem, brief, report);
}

// Contacts that cycle between sticking, slipping and opening find their states where they are soft, and keep them while they
// harden: of the unsolved steps of jointed bodies that fall, by the end-point rule, half remain.
bool Integrator::solve_softer_contacts(Problem& problem, const Stage& stage, AdvanceReport& report) {
  const std::span<ContactConstraint> contacts = problem.items_of<ContactConstraint>();
  if (contacts.empty() || stage.is_mid_point() || stage.is_projection() || stage.compliance > exact_rows) return false;
  problem.set_multipliers(multipliers_saved_);
  make_guess(problem, stage);
  bool is_solved = false;
  for (const double softening : {1e6, 1e4, 1e2, 1.0}) {
    ActiveSet::soften_cones(problem, softening);
    is_solved = solve(problem, stage, report);
  }
  return is_solved;
}

bool Integrator::solve(Problem& problem, const Stage& stage, AdvanceReport& report) {
  if (is_out_of_budget()) {
    is_cut_short_ = true;
    return false;
  }
  Stage limited = stage;
  limited.iterations_left = iterations_left_;
  limited.is_heap = may_sweep() && !heap_->is_tree() && !stage.is_projection();
  const bool is_end_point = !stage.is_mid_point() && !stage.is_projection();
  const bool has_contacts = !problem.items_of<ContactConstraint>().empty();
  if (is_end_point && has_contacts && (limited.is_heap || settings_.scheme == Scheme::end_point))
    limited.max_iterations = IntegratorSettings::contact_iterations;
  else if (limited.is_heap)
    limited.max_iterations = IntegratorSettings::heap_iterations;
  problem.begin_forces(stage.h);
  const NewtonReport newton = newton_.solve(problem, limited);
  iterations_left_ -= newton.iterations;
  is_cut_short_ = is_cut_short_ || (!newton.converged && iterations_left_ <= 0);
  ++report.solves;
  met_ = newton.met, violation_ = newton.violation;
  report.handed_back += newton.handed_back;
  report.iterations += newton.iterations;
  report.iterations_max = std::max(report.iterations_max, newton.iterations);
  return newton.converged;
}

// The last resort has no deadline.
bool Integrator::is_out_of_budget() {
  if (settings_.deadline != never && std::chrono::steady_clock::now() > settings_.deadline) iterations_left_ = 0;
  if (iterations_left_ <= 0) settings_.patience = 0;  // no more halving
  return iterations_left_ <= 0;
}

}  // namespace iota::solver
