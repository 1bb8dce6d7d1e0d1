// SPDX-License-Identifier: Apache-2.0
#include "ingredient/quantities.h"
#include "ingredient/tables.h"
#include "system/core.h"

#include <algorithm>

namespace iota {

Diagnosis System::diagnose(BodyId id) const {
  const model::Model& model = implementation_->model;
  const std::uint32_t body = implementation_->slot(id);
  std::vector<std::uint32_t> articulates;
  for (const std::uint32_t b : model.tied_bodies(std::span(&body, 1)))
    articulates.push_back(model.bodies[b].articulate);
  std::sort(articulates.begin(), articulates.end());
  articulates.erase(std::unique(articulates.begin(), articulates.end()), articulates.end());
  // An island of its own: the one that steps is left alone, and with it the state.
  step::Island island;
  std::vector<std::uint32_t> node_of_ring(model.rings.slot_count(), model::none);
  island.assemble(model, articulates, node_of_ring);
  island.load(model, 0);
  return island.diagnose(model);
}

RestOptions System::rest() const { return {implementation_->model.rest_after, implementation_->model.rest_speed}; }

void System::set_rest(const RestOptions& options) { implementation_->execute(edit::SetRest{options}); }

System::System(const SystemOptions& options) : implementation_(std::make_unique<Implementation>()) {
  set_threads(options.threads);
  set_gravity(options.gravity);
  set_damping(options.damping);
  set_rest(options.rest);
  set_mode(options.mode);
}

System::~System() = default;

System::System(System&&) noexcept = default;

System& System::operator=(System&&) noexcept = default;

void System::set_gravity(const Vec3& value) { implementation_->execute(edit::SetGravity{value}); }

void System::set_mode(IntegrationMode mode) { implementation_->execute(edit::SetMode{mode}); }

void System::set_solver(std::string_view name) { implementation_->execute(edit::SetSolver{std::string(name)}); }

void System::set_damping(double per_second) { implementation_->execute(edit::SetDamping{per_second}); }

int System::threads() const { return implementation_->parallel.threads(); }

void System::set_threads(int threads) {
  if (implementation_->door.is_stepping()) throw std::logic_error("set_threads: not while the system steps");
  implementation_->parallel = Parallel(threads);
}

StepReport System::step(double dt) { return implementation_->execute(edit::Step{dt}); }

Vec3 System::gravity() const { return implementation_->model.gravity; }

std::string System::solver() const {
  const char* const name = implementation_->model.solver.data();
  return *name ? name : "direct";
}

IntegrationMode System::mode() const { return implementation_->model.mode; }

double System::damping() const { return implementation_->model.damping; }

double System::time() const { return implementation_->model.time; }

std::uint64_t System::step_count() const { return implementation_->model.step; }

std::uint32_t System::structure_version() const { return implementation_->model.structure_version; }

Vec3 System::momentum() const { return ingredient::calc_momenta(implementation_->model).linear; }

Vec3 System::angular_momentum() const { return ingredient::calc_momenta(implementation_->model).angular; }

double System::worst_gap() const { return ingredient::worst_gap(implementation_->model); }

bool System::is_stepping() const { return implementation_->door.is_stepping(); }

std::vector<std::string> System::validate() const { return ingredient::validate(implementation_->model); }

std::uint64_t System::state_hash() const { return implementation_->model.hash(); }

Energy System::energy() const { return implementation_->held.book(); }

Snapshot System::snapshot() const { return implementation_->editor.snapshot(); }

void System::restore(const Snapshot& snapshot) {
  if (implementation_->door.is_stepping()) throw std::logic_error("restore: not while the system steps");
  if (implementation_->door.is_recording()) throw std::logic_error("restore: stop the recording first");
  implementation_->editor.restore(snapshot);
  implementation_->editor.forget_history();
}

}  // namespace iota
