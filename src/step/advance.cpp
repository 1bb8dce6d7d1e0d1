// SPDX-License-Identifier: Apache-2.0
// One step of the whole system, stage by stage; `docs/architecture.md` tells the same story.
#include "ingredient/quantities.h"
#include "step/checks.h"
#include "step/implementation.h"

#include <algorithm>
#include <cmath>

namespace iota {

namespace {

/// Forces act for one step, also where nothing takes them: kept, they would strike at once when a body becomes dynamic.
void forget_unheeded_forces(model::Model& model) {
  model.pushes.for_each([&](std::uint32_t ring, const model::Push& push) {
    if (push.force == Vec3{}) return;
    bool heeded = true;
    model.for_each_in_ring(
        ring, [&](std::uint32_t p) { heeded = heeded && model::is_free(model.bodies[model.particles[p].body].kind); });
    if (!heeded) model.pushes.at(ring).force = {};
  });
}

}  // namespace

StepReport System::Implementation::apply(const step::Step& command) {
  const double h = command.dt;
  if (!(h > 0 && h <= 1)) throw std::invalid_argument(step::text("step: dt must be above 0 and at most 1 s, got ", h));
  StepReport report;
  report.dt = h;
  book_held_edits();
  stepping = true;

  // 1. Forces of the script, at the state at the start of the step.
  run_laws(report);
  run_scripts(report);
  run_fields(report);

  // 2. Islands whose structure changed are analyzed anew; velocities that were assigned are made consistent.
  jolted.clear(), disturbed.clear();
  model.articulates.for_each([&](std::uint32_t slot, model::Articulate& a) {
    if (a.jolted) jolted.push_back(slot);
    if (a.disturbed) disturbed.push_back(slot);
    a.jolted = a.disturbed = 0;
  });
  if (islands.update(model, parallel) || !jolted.empty()) model.has_edits = 1;
  for (const std::uint32_t articulate : disturbed) {
    if (step::Island* const island = islands.of_articulate(articulate))
      island->disturb();
    else
      step::FreeParticles::wake(model, articulate);
  }
  for (const std::uint32_t articulate : jolted)
    if (step::Island* const island = islands.of_articulate(articulate)) (void)island->project(model, false);
  if (model.has_edits) ingredient::book_edits(model, ingredient::calc_energies(model).total());

  // 3. Every island by itself, on as many threads as pay; reports are added up in a fixed order.
  const auto all = islands.all();
  advanced.resize(all.size());
  parallel.for_each(all.size(), islands.grain(parallel),
                    [&](std::size_t i) { advanced[i] = all[i]->advance(model, h, model.mode); });
  int solves = 0, iterations = 0, handed_back = 0;
  for (const auto* island : all)
    if (island->is_asleep(model)) report.resting += static_cast<std::uint32_t>(island->body_count());
  advanced.push_back(islands.free_particles().advance(model, h, parallel));
  report.resting += islands.free_particles().resting();
  for (const solver::AdvanceReport& r : advanced) {
    solves += r.solves, iterations += r.iterations, handed_back += r.handed_back;
    report.iterations_max = std::max(report.iterations_max, r.iterations_max);
    report.substeps_max = std::max(report.substeps_max, r.substeps);
    report.fallbacks += r.fallbacks;
    report.unconverged += !r.converged;
    model.dissipated += r.dissipated;
    model.external_work += r.external_work;
    model.edit_energy += r.closing_energy;
  }
  if (handed_back > 0)
    report.warnings.push_back("the solver " + std::string(model.solver.data()) + " found no root in " +
                              std::to_string(handed_back) + " of " + std::to_string(solves) +
                              " solves; the built-in one took over");
  report.iterations_mean = solves ? static_cast<double>(iterations) / solves : 0;
  model.time += h, model.last_dt = h;
  ++model.step;
  stepping = false;
  forget_unheeded_forces(model);
  book_held_work();

  // 4. Edits: what failed or broke, particles that have met, then what was asked for during the step, in order.
  switch_off_failed_surfaces(report);
  if (model.attributes.size() + model.emitters.size() > 0) live(report);
  break_overloaded(report);
  finish_closings(report);
  apply_queue(report);
  if (model.has_edits) held_energy_is_known = false, book_held_edits();

  report.warnings.insert(report.warnings.end(), model.notes.begin(), model.notes.end());
  model.notes.clear();
  report.step = model.step;
  report.time = model.time;
  report.worst_gap = ingredient::worst_gap(model);
  const ingredient::Energies energy = ingredient::calc_energies(model);
  ingredient::book_edits(model, energy.total());
  report.energy = {energy.kinetic, energy.potential + held_energy(), model.dissipated, model.external_work,
                   model.edit_energy};
  report.articulates = model.articulates.size();
  report.structure_version = model.structure_version;
  if (recording) recording->hashes.push_back(model.hash());
  return report;
}

void System::Implementation::finish_closings(StepReport& report) {
  std::vector<std::pair<Id<model::Closing>, step::CombineParticles>> met;
  model.closings.for_each([&](std::uint32_t slot, model::Closing& c) {
    c.elapsed += report.dt;
    if (c.elapsed >= c.duration)
      met.push_back({model.closings.id(slot), {model.particles.id(c.p), model.particles.id(c.q), 0}});
  });
  for (const auto& [closing, combine] : met) {
    if (!model.closings.contains(closing)) continue;  // an earlier one has settled it
    ingredient::begin_edits(model);
    try {
      const RestructureReport met_now = apply(combine);
      report.unconverged += met_now.remaining_gap > 0;
      for (const std::string& note : met_now.notes) report.warnings.push_back(note);
    } catch (const std::exception& error) {  // it cannot be; give up rather than ask again at every step
      if (model.closings.contains(closing)) (void)call_off(closing.slot);
      report.warnings.push_back(error.what());
    }
  }
}

void System::Implementation::apply_queue(StepReport& report) {
  if (queue.empty()) return;
  report.edits.emplace();
  report.edits->articulates_before = model.articulates.size();
  ingredient::begin_edits(model);
  const double before = energy().edits;
  const std::uint32_t version = model.structure_version;
  std::vector<step::Command> edits;
  edits.swap(queue);
  for (const step::Command& edit : edits) {
    try {
      std::visit(
          [&](const auto& c) {
            if constexpr (std::is_same_v<decltype(apply(c)), RestructureReport>)
              step::add_report(*report.edits, apply(c));
            else
              (void)apply(c);
          },
          edit);
    } catch (const std::exception& error) {
      report.warnings.push_back(std::string("an edit asked for during the step could not be made: ") + error.what());
    }
  }
  report.edits->changed = model.structure_version != version;
  report.edits->articulates_after = model.articulates.size();
  report.edits->structure_version = model.structure_version;
  held_energy_is_known = false;
  report.edits->energy_change = energy().edits - before;
}

}  // namespace iota
