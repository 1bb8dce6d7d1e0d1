// SPDX-License-Identifier: Apache-2.0
#include "base/sort_unique.h"
#include "ingredient/quantities.h"
#include "ingredient/tables.h"
#include "model/outline.h"
#include "system/core.h"

#include <algorithm>
#include <string>

namespace iota {

Diagnosis System::diagnose(BodyId id) const {
  const model::Model& model = core_->model;
  const std::uint32_t body = core_->slot(id);
  std::vector<std::uint32_t> articulates;
  for (const std::uint32_t b : model.tied_bodies(std::span(&body, 1)))
    articulates.push_back(model.bodies[b].articulate);
  sort_unique(articulates);
  // A separate island, so that the stepped one and the state do not change.
  island::Island island;
  std::vector<std::uint32_t> node_of_ring(model.rings.slot_count(), model::none);
  island.assemble(model, articulates, node_of_ring);
  island.load(model, 0);
  return island.diagnose(model);
}

RestOptions System::rest() const { return {core_->model.rest_after, core_->model.rest_speed}; }

void System::set_rest(const RestOptions& options) { core_->execute(edit::SetRest{options}); }

double System::usual_radius() const { return model::usual_radius(core_->model); }

void System::set_usual_radius(double meters) { core_->execute(edit::SetUsualRadius{meters}); }

std::optional<Material> System::usual_material() const {
  return core_->model.has_usual_material ? std::optional(core_->model.usual_material) : std::nullopt;
}

void System::set_usual_material(const std::optional<Material>& material) {
  core_->execute(edit::SetUsualMaterial{material.has_value(), material.value_or(Material{})});
}

System::System(const SystemOptions& options) : core_(std::make_unique<Core>()) {
  set_threads(options.threads);
  set_gravity(options.gravity);
  set_damping(options.damping);
  set_rest(options.rest);
  set_mode(options.mode);
  set_tolerance(options.tolerance);
  set_budget(options.budget);
}

System::~System() = default;

System::System(System&&) noexcept = default;

System& System::operator=(System&&) noexcept = default;

void System::set_gravity(const Vec3& value) { core_->execute(edit::SetGravity{value}); }

void System::set_mode(IntegrationMode mode) { core_->execute(edit::SetMode{mode}); }

void System::set_tolerance(double tolerance) { core_->execute(edit::SetTolerance{tolerance}); }

void System::set_budget(const StepBudget& budget) { core_->execute(edit::SetBudget{budget}); }

void System::set_solver(std::string_view name) { core_->execute(edit::SetSolver{std::string(name)}); }

void System::set_damping(double per_second) { core_->execute(edit::SetDamping{per_second}); }

int System::threads() const { return core_->parallel.threads(); }

void System::set_threads(int threads) {
  if (core_->door.is_stepping()) throw std::logic_error("set_threads: not while the system steps");
  core_->parallel = Parallel(threads);
}

StepReport System::step(double dt) { return core_->execute(edit::Step{dt}); }

StepReport System::step(double dt, int count) {
  if (count < 1) throw std::invalid_argument("step: count must be at least 1, got " + std::to_string(count));
  StepReport sum = step(dt);
  for (int i = 1; i < count; ++i) add_step(sum, step(dt));
  return sum;
}

void add_step(StepReport& sum, const StepReport& next) {
  const auto append = [](auto& list, const auto& more) { list.insert(list.end(), more.begin(), more.end()); };
  sum.iterations_mean += (next.iterations_mean - sum.iterations_mean) * next.dt / (sum.dt + next.dt);
  sum.dt += next.dt;
  sum.iterations_max = std::max(sum.iterations_max, next.iterations_max);
  sum.substeps_max = std::max(sum.substeps_max, next.substeps_max);
  sum.cut_short += next.cut_short, sum.approximate += next.approximate, sum.error = std::max(sum.error, next.error);
  sum.fallbacks += next.fallbacks, sum.unconverged += next.unconverged;
  sum.step = next.step, sum.time = next.time, sum.energy = next.energy;
  sum.worst_gap = std::max(sum.worst_gap, next.worst_gap);
  sum.articulates = next.articulates, sum.resting = next.resting, sum.structure_version = next.structure_version;
  append(sum.switched_off, next.switched_off);
  append(sum.switched_off_constraints, next.switched_off_constraints);
  append(sum.broken, next.broken);
  append(sum.stops, next.stops);
  append(sum.contacts, next.contacts);
  append(sum.born, next.born), append(sum.died, next.died);
  append(sum.warnings, next.warnings);
  if (next.edits && !sum.edits) sum.edits.emplace();
  if (next.edits) edit::add_report(*sum.edits, *next.edits);
}

Vec3 System::gravity() const { return core_->model.gravity; }

std::string System::solver() const {
  const char* const name = core_->model.solver.data();
  return *name ? name : "direct";
}

IntegrationMode System::mode() const { return core_->model.mode; }

double System::tolerance() const { return core_->model.tolerance; }

StepBudget System::budget() const {
  return {core_->model.budget_iterations, core_->model.budget_seconds, core_->model.budget_contacts,
          core_->model.contacts_share};
}

std::vector<IslandReport> System::islands() const { return core_->islands.reports(core_->model); }

double System::damping() const { return core_->model.damping; }

double System::time() const { return core_->model.time; }

std::uint64_t System::step_count() const { return core_->model.step; }

std::uint32_t System::structure_version() const { return core_->model.structure_version; }

Vec3 System::momentum() const { return ingredient::calc_momenta(core_->model).linear; }

Vec3 System::angular_momentum() const { return ingredient::calc_momenta(core_->model).angular; }

double System::worst_gap() const { return ingredient::worst_gap(core_->model); }

std::string System::queued_edits() { return edit::queued_edits(); }

bool System::is_stepping() const { return core_->door.is_stepping(); }

std::vector<std::string> System::validate() const {
  std::vector<std::string> complaints = ingredient::validate(core_->model);
  model::Audit of_islands(core_->model);
  core_->islands.validate(core_->model, of_islands);
  for (std::string& each : std::move(of_islands).complaints()) complaints.push_back(std::move(each));
  return complaints;
}

std::uint64_t System::state_hash() const { return core_->model.hash(); }

Energy System::energy() const { return core_->held.book(); }

Snapshot System::snapshot() const { return core_->door.take_snapshot(); }

void System::restore(const Snapshot& snapshot) {
  if (core_->door.is_stepping()) throw std::logic_error("restore: not while the system steps");
  if (core_->door.is_recording()) throw std::logic_error("restore: stop the recording first");
  core_->editor.restore(snapshot);
  core_->editor.forget_history();
  core_->door.log().break_off();
}

}  // namespace iota
