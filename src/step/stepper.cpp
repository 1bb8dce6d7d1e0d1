// SPDX-License-Identifier: Apache-2.0
// One step of the whole system, stage by stage; see `docs/architecture.md`.
#include "step/stepper.h"

#include "base/text.h"
#include "ingredient/quantities.h"
#include "model/outline.h"
#include "solver/timed.h"
#include "step/edits.h"

#include <algorithm>

namespace iota::step {

using solver::Timed, solver::times_of_thread;

StepReport Stepper::step(double dt) {
  if (!(dt > 0 && dt <= 1)) throw std::invalid_argument(text("step: dt must be above 0 and at most 1 s, got ", dt));
  const Timed timed(times_of_thread(), &StepTimes::integrate, Timed::none);
  StepReport report;
  report.dt = dt;
  using Clock = island::Island::Clock;
  const double seconds = editor_.model.budget_seconds;
  deadline_ = seconds > 0 && seconds < 1e6
                  ? Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))
                  : Clock::time_point::max();
  watches_.begin_step(editor_.model, outlines_);
  door_.begin_step();
  model::choose_usual_radius(editor_.model);
  ingredient::Strides::disturb_edited(editor_.model);
  take_held_forces(report);
  find_contacts(dt);
  update_islands(dt);
  editor_.held.add_missed(report);
  look_along_ways(dt);
  made_ = spin_lost_ = 0, solves_ = iterations_ = handed_back_ = 0;
  advance_in_parts(report);
  advance_islands(report);
  door_.end_step();
  contacts_.sense_on_the_way(editor_.model, outlines_, dt);
  watches_.end_step(editor_.model, outlines_, contacts_.sensed(), report);
  apply_edits(report);
  fill(report);
  return report;
}

// 1. Functions of the script, and other held forces, at the start of the step.
void Stepper::take_held_forces(StepReport& report) {
  const Timed timed(times_of_thread(), &StepTimes::forces);
  editor_.held.begin_step(report);
}

// 1b. Bodies with a material and the obstacles near them.
void Stepper::find_contacts(double h) {
  const Timed timed(times_of_thread(), &StepTimes::analyze);
  if (ContactFinder::may_find_any(editor_.model)) editor_.islands.flag_stirred_sleepers(editor_.model, h);
  contacts_.find(editor_.model, outlines_, h, editor_.islands.awake_version());
}

// 2. Islands with a changed structure are analyzed again; assigned velocities are projected.
void Stepper::update_islands(double dt) {
  model::Model& model = editor_.model;
  island::Islands& islands = editor_.islands;
  outlines_.lose_flags();
  model.take_flagged(flagged_);
  dirty_.clear(), woken_.clear();
  for (const std::uint32_t slot : flagged_) {
    model::Articulate& a = model.articulates[slot];
    if (a.velocity_dirty) dirty_.push_back(slot);
    if (a.to_wake) woken_.push_back(slot);
    a.velocity_dirty = a.to_wake = 0;
  }
  {
    const Timed timed(times_of_thread(), &StepTimes::analyze);
    if (islands.update(model, editor_.parallel) || !dirty_.empty()) ingredient::note_edits(model, true);
  }
  wake(dt);
  islands.plan_strides(model);
  islands.for_each_of(model, dirty_, [&](island::Island& island) { island.project_assigned(model); });
  if (model.has_edits) ingredient::book_edits(model, islands.energies(model).total());
}

// Edits, forces and laws of the time wake islands.
void Stepper::wake(double dt) {
  editor_.islands.wake(editor_.model, woken_);
  editor_.islands.wake_stirred(editor_.model, dt);
}

// Contacts that are found within a step join islands, and a joined one does not know any more that it is to wake.
void Stepper::renew_islands(double dt) {
  editor_.islands.update(editor_.model, editor_.parallel);
  wake(dt);
  (void)editor_.islands.awake(editor_.model);  // they share the budget by their sizes now, not by those before
}

namespace {

/// Which islands the budget left undone.
void tell_cut_short(island::Islands& islands, StepReport& report) {
  constexpr int most = 3;
  int count = 0;
  islands.for_each_advanced([&](std::uint32_t body, const solver::AdvanceReport& advanced) {
    if (!advanced.cut_short || ++count > most) return;
    report.warnings.push_back(text("the budget of a step ended before the solution of the island of body ", body,
                                   ": its worst gap is ", advanced.gap, " m"));
  });
  if (count > most) report.warnings.push_back(text("the budget of a step ended too early for ", count, " islands"));
}

/// Parallel::for_each, with the times of all threads if those of this one are taken.
template <class Work>
void for_each_timed(const Parallel& parallel, std::size_t count, std::size_t grain, Work work) {
  StepTimes* const sum = times_of_thread();
  if (!sum) return parallel.for_each(count, grain, work);
  std::vector<StepTimes> all(count);
  {
    const Timed timed(sum, Timed::none);  // not this thread's alone
    parallel.for_each(count, grain, [&](std::size_t i) {
      const TimedSteps here(all[i]);
      const Timed timed_island(&all[i], &StepTimes::integrate, Timed::none);
      work(i);
    });
  }
  for (const StepTimes& each : all)
    for (const Timed::Part part :
         {&StepTimes::forces, &StepTimes::analyze, &StepTimes::factor, &StepTimes::solve, &StepTimes::integrate})
      sum->*part += each.*part;
}

}  // namespace

namespace {

constexpr int most_looks = 3;  ///< along the ways of an island in a step or a part of it

bool is_of_sweeps(const model::Model& model, const island::Island& island) {
  return std::ranges::any_of(island.bodies(),
                             [&](std::uint32_t body) { return ingredient::Contacts::is_of_sweeps(model, body); });
}

}  // namespace

// 2b. Springs, motors and hands may move bodies further in a step than their velocities tell. Such islands try it first; one that meets
// something on its way, of which it has no contact yet, tries again with that. Other islands have not moved then.
void Stepper::look_along_ways(double dt) {
  if (contacts_.movers().empty()) return;
  model::Model& model = editor_.model;
  island::Islands& islands = editor_.islands;
  sprung_.clear();
  for (island::Island* const island : islands.awake(model))
    if (may_go_beyond(*island)) sprung_.push_back(model.bodies[island->bodies().front()].articulate);
  for (int round = 0; round < most_looks && !sprung_.empty(); ++round) {
    islands.replace_by_leaders(sprung_);
    for_each_timed(editor_.parallel, sprung_.size(), islands.grain(editor_.parallel), [&](std::size_t i) {
      islands.try_ahead(model, *islands.of_articulate(sprung_[i]), dt, dt, deadline_);
    });
    std::erase_if(sprung_,
                  [&](std::uint32_t leader) { return !meets_on_its_way(*islands.of_articulate(leader), dt, false); });
    if (!sprung_.empty()) renew_islands(dt);
  }
}

// The same for a part of a step; without one, for the rest.
void Stepper::look_along_way_of_part(std::uint32_t leader, std::optional<double> part, double dt) {
  model::Model& model = editor_.model;
  island::Islands& islands = editor_.islands;
  const double h = part.value_or(dt - islands.ahead(model, *islands.of_articulate(leader)));
  for (int round = 0; round < most_looks && may_go_beyond(*islands.of_articulate(leader)); ++round) {
    islands.try_ahead(model, *islands.of_articulate(leader), h, dt, deadline_);
    if (!meets_on_its_way(*islands.of_articulate(leader), h, true)) return;
    renew_islands(dt);
  }
}

bool Stepper::may_go_beyond(island::Island& island) {
  model::Model& model = editor_.model;
  return island.is_sprung() && island.agree_on_stride(model) == 1 &&
         std::ranges::any_of(island.bodies(), [&](std::uint32_t body) { return contacts_.is_watched(model, body); });
}

bool Stepper::meets_on_its_way(island::Island& island, double h, bool is_part) {
  model::Model& model = editor_.model;
  bool is_beyond = false;
  ways_.clear();
  contacts_.set_length(model, h);
  island.for_each_way(model, [&](std::uint32_t ring, const Vec3& way) {
    ways_.push_back({ring, (1 / h) * way});
    const double beside = norm(way - h * model.rings[ring].velocity);
    model.for_each_in_ring(ring, [&](std::uint32_t p) {
      is_beyond = is_beyond || contacts_.is_beyond(model, model.particles[p].body, beside);
    });
  });
  if (!is_beyond) return false;
  const auto exchange = [&] {
    for (auto& [ring, velocity] : ways_) std::swap(model.rings[ring].velocity, velocity);
  };
  exchange();
  const bool meets = contacts_.find_on_ways(model, outlines_, island.bodies(), is_part);
  exchange();
  if (meets) island.try_again(model);
  return meets;
}

// 3a. An island of which a body would pass or hit another one far along its way takes the step in parts, each with contacts
// of its own: up to the place where they meet, then a short one, and so on. The last part is taken with all other islands. At
// first a part was a share of the same step, in which a contact began: a second law for each row, which made energy.
void Stepper::advance_in_parts(StepReport& report) {
  constexpr int most = 24;
  constexpr std::size_t most_points = 2000;  // in all parts of an island
  model::Model& model = editor_.model;
  island::Islands& islands = editor_.islands;
  hasty_ = contacts_.hasty();
  for (int round = 0; !hasty_.empty(); ++round) {
    islands.replace_by_leaders(hasty_);
    std::erase_if(hasty_, [&](std::uint32_t leader) { return !islands.of_articulate(leader); });
    parts_.clear();
    for (const std::uint32_t leader : hasty_) {
      const island::Island& island = *islands.of_articulate(leader);
      const bool of_sweeps = is_of_sweeps(model, island);
      const bool may_cut = round < most && !island.is_driven(model) &&
                           (of_sweeps || static_cast<std::size_t>(round) * island.size() <= most_points);
      parts_.push_back(contacts_.find_part(model, outlines_, island.bodies(), report.dt - islands.ahead(model, island),
                                           {.is_first = round == 0, .may_cut = may_cut, .of_sweeps = of_sweeps}));
    }
    renew_islands(report.dt);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < hasty_.size(); ++i) {
      if (!islands.of_articulate(hasty_[i])) continue;
      look_along_way_of_part(hasty_[i], parts_[i], report.dt);
      if (!parts_[i]) continue;
      add(islands.advance_part(model, *islands.of_articulate(hasty_[i]), *parts_[i], report.dt, deadline_), report);
      hasty_[kept++] = hasty_[i];
    }
    hasty_.resize(kept);
  }
}

// 3. Every island separately, on several threads if that is faster; reports are added up in a fixed order. No island asks
// another how its step ends, so each commits its try at once, while its problem is in the cache: two passes took 5 to 7 %
// longer for 1000 ragdolls.
void Stepper::advance_islands(StepReport& report) {
  model::Model& model = editor_.model;
  island::Islands& islands = editor_.islands;
  const std::size_t count = islands.awake(model).size() + islands.loose(model).size();
  for_each_timed(editor_.parallel, count, islands.grain(editor_.parallel),
                 [&](std::size_t i) { islands.advance(model, i, report.dt, deadline_); });
  if (model.corrections.lacks_room()) model.corrections.make_room(model.rings.slot_count());
  tell_cut_short(islands, report);
  islands.for_each_advanced([&](std::uint32_t, const solver::AdvanceReport& r) { add(r, report); });
  add(islands.free_bodies().advance(model, report.dt, editor_.parallel), report);
  islands.end_step();
  report.resting = islands.resting(model);
  if (spin_lost_ > 0)
    report.warnings.push_back(text("bodies that were moved together, almost into one place, cannot carry ", spin_lost_,
                                   " kg m^2/s of their angular momentum"));
  if (handed_back_ > 0)
    report.warnings.push_back(text("the solver ", model.solver.data(), " found no root in ", handed_back_, " of ",
                                   solves_, " solves; the built-in one took over"));
  report.iterations_mean = solves_ ? static_cast<double>(iterations_) / solves_ : 0;
  ingredient::end_step(model, report.dt);
  model.time += report.dt, model.last_dt = report.dt;
  ++model.step;
}

void Stepper::add(const solver::AdvanceReport& r, StepReport& report) {
  model::Model& model = editor_.model;
  solves_ += r.solves, iterations_ += r.iterations, handed_back_ += r.handed_back;
  report.iterations_max = std::max(report.iterations_max, r.iterations_max);
  report.substeps_max = std::max(report.substeps_max, r.substeps);
  report.fallbacks += r.fallbacks;
  report.unconverged += !r.converged;
  report.cut_short += r.cut_short, report.approximate += r.is_approximate;
  report.error = std::max(report.error, r.error);
  model.dissipated += r.dissipated;
  model.lost += r.lost;
  model.made += r.made, made_ += r.made;
  model.external_work += r.external_work;
  model.edit_energy += r.closing_energy;
  spin_lost_ = std::max(spin_lost_, r.spin_lost);
}

// 4. What the step has led to, and its edits: failures, deaths, births, breaks and particles that have met; then the
// requests of the step, in order.
void Stepper::apply_edits(StepReport& report) {
  editor_.held.end_step();
  ingredient::tell(editor_.model, outcome_);
  make_edits(editor_, outcome_, report);
  door_.apply_queue(report);
  if (editor_.model.has_edits) editor_.held.note_change(), editor_.held.book_edits();
}

// 5. The report.
void Stepper::fill(StepReport& report) {
  model::Model& model = editor_.model;
  constexpr double worth_telling = 1e-4;  // of the kinetic energy, in a step
  constexpr double worth_in_all =
      1e-3;  // of the energy that motion has had, since the start: less than sweeps need to close gaps
  constexpr double round_off = 1e-12;  // of all energy: what rests drifts by, until its rows are closed
  const auto [energies, worst_gap] = editor_.islands.book(model);
  if (made_ > worth_telling * energies.kinetic + round_off * (energies.kinetic + std::abs(energies.potential)) &&
      model.made > worth_in_all * (energies.kinetic + model.dissipated))
    report.warnings.emplace_back("the integration made energy that no force explains (energy.made); try shorter steps");
  report.warnings.insert(report.warnings.end(), model.notes.begin(), model.notes.end());
  model.notes.clear();
  report.impact = ingredient::Contacts::hardest_impact(model, contacts_.movers());
  report.step = model.step;
  report.time = model.time;
  report.worst_gap = worst_gap;
  ingredient::book_edits(model, energies.total());
  report.energy = {.kinetic = energies.kinetic,
                   .potential = energies.potential + editor_.held.energy(),
                   .dissipated = model.dissipated,
                   .lost = model.lost,
                   .made = model.made,
                   .external_work = model.external_work,
                   .edits = model.edit_energy};
  // Accounts are those at the end of a stride: `lost` takes the rest meanwhile.
  if (ingredient::Strides::any(model)) model.lost = report.energy.lost -= report.energy.balance();
  report.articulates = model.articulate_count();
  report.structure_version = model.structure_version;
}

}  // namespace iota::step
