// SPDX-License-Identifier: Apache-2.0
#include "held/held_forces.h"

#include "ingredient/quantities.h"

#include <iota/reports.h>

#include <algorithm>
#include <cmath>

namespace iota::held {

void HeldForces::begin_step(StepReport& report) {
  book_edits();
  in_step_ = true;
  error_.begin(model_);
  take_laws(report);
  take_scripts(report);
  take_fields(report);
  report.error = std::max(report.error, error_.estimate(model_, report.dt));
}

void HeldForces::end_step() {
  in_step_ = false;
  const double before = model_.held_energy;
  model_.held_energy = calc_energy();
  model_.external_work += model_.held_energy - before;
}

// Held forces are evaluated in the middle of the step. With the mid-point rule and positions extrapolated by half a
// step this is the leapfrog scheme, whose energy does not drift; forces at the start of the step would add energy.
double HeldForces::look_ahead(double h) const { return model_.steps_to_end_point() ? 0 : h / 2; }

double HeldForces::time_of_places(double h) const { return model_.time + look_ahead(h); }

void HeldForces::forget() {
  batches_.forget(), sets_.forget(), error_.forget();
  energy_is_known_ = false;
}

double HeldForces::energy() {
  if (energy_is_known_ || in_step_) return energy_;
  sets_.update(model_);  // and load all of them again
  return calc_energy();
}

double HeldForces::calc_energy() {
  double sum = 0;
  batches_.update(model_);
  for (BondBatch& batch : batches_.held)
    if (model_.laws[batch.law].has_derivative()) sum += batch.energy(model_);
  for (const auto& set : sets_.sets)
    if (set->is_loaded) set->follow(model_);
  model_.fields.for_each([&](std::uint32_t slot, const ingredient::Field& f) {
    if (f.active && f.kind != ingredient::FieldKind::function && model_.compiled_field(slot).has_energy())
      sum += model_.compiled_field(slot).energy(loaded_set(f.group, 0).arrays, model_.time, f.parameters.data());
  });
  model_.pairs.for_each([&](std::uint32_t slot, const ingredient::PairForce& p) {
    if (!p.active || !model_.compiled(p.law).has_energy()) return;
    const ParticleSet& set = loaded_set(p, 0, 0);
    sum += sets_.sum(slot).energy(set.arrays, {set.family, set.sides}, model_.compiled(p.law), p.parameters.data(),
                                  {p.cutoff, p.shifted != 0}, model_.time, parallel_);
  });
  energy_ = sum, energy_is_known_ = true;
  return sum;
}

void HeldForces::book_edits() {
  const double now = energy();
  model_.edit_energy += now - model_.held_energy;
  model_.held_energy = now;
}

Energy HeldForces::book() {
  const double held = energy();
  const ingredient::Energies now = ingredient::calc_energies(model_);
  return {.kinetic = now.kinetic,
          .potential = now.potential + held,
          .dissipated = model_.dissipated,
          .lost = model_.lost,
          .made = model_.made,
          .external_work = model_.external_work,
          .edits = ingredient::energy_of_edits(model_) + held - model_.held_energy};
}

double HeldForces::energy_of_pairs(std::uint32_t slot) const {
  const ingredient::PairForce& pairs = model_.pairs[slot];
  ParticleSet set;  // a separate set, as this may be called while others are in use
  set.group = pairs.group, set.other = pairs.other;
  set.has_normals = model_.compiled(pairs.law).depends_on_normals();
  set.find(model_);
  set.load(model_, 0, 0, parallel_);
  return neighbors::PairSum().energy(set.arrays, {set.family, set.sides}, model_.compiled(pairs.law),
                                     pairs.parameters.data(), {pairs.cutoff, pairs.shifted != 0}, model_.time,
                                     parallel_);
}

}  // namespace iota::held
