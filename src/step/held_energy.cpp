// SPDX-License-Identifier: Apache-2.0
// The energy of forces that are held: bonds, fields and pairs whose law has one. It is potential energy like that of a
// spring that is solved for; but nobody solves for it, so the book is kept from outside:
// - what edits have changed since the last step is found at the start of the next one;
// - what a step takes of it is taken off the work that the held forces did, which their island books as external. What is
//   left there is the error of holding, and is small where the step is short beside the swing.
#include "ingredient/quantities.h"
#include "step/implementation.h"

#include <cmath>

namespace iota {

using namespace step;

namespace step {

double LawBatch::energy(const model::Model& model) {
  const laws::PairLaw& compiled = model.compiled(law);
  if (!compiled.has_energy()) return 0;
  load(model, 0);
  laws::PairBatch numbers = loaded(model.time);
  numbers.energy = force.data();
  compiled.energies(numbers);
  double sum = 0;
  for (const double one : force)
    if (std::isfinite(one)) sum += one;
  return sum;
}

void ParticleSet::follow(const model::Model& model) {
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const Vec3& x = model.rings[rings[i]].position;
    arrays.x[i] = x.x, arrays.y[i] = x.y, arrays.z[i] = x.z;
  }
}

}  // namespace step

double System::Implementation::held_energy() {
  if (held_energy_is_known || stepping) return held_energy_now;
  particle_sets.update(model);  // and have all of them loaded anew
  return calc_held_energy();
}

double System::Implementation::calc_held_energy() {
  double sum = 0;
  held_forces.update(model);
  for (LawBatch& batch : held_forces.held)
    if (model.laws[batch.law].has_derivative()) sum += batch.energy(model);
  for (const auto& set : particle_sets.sets)
    if (set->is_loaded) set->follow(model);
  const auto set_of = [&](std::uint32_t group) -> ParticleSet& {
    ParticleSet& set = particle_sets.of(model, group);
    if (!set.is_loaded) set.load(model, 0, parallel);
    return set;
  };
  model.fields.for_each([&](std::uint32_t slot, const model::Field& f) {
    if (f.active && f.kind != model::FieldKind::function && model.compiled_field(slot).has_energy())
      sum += model.compiled_field(slot).energy(set_of(f.group).arrays, model.time, f.parameters.data());
  });
  model.pairs.for_each([&](std::uint32_t slot, const model::Pairs& p) {
    if (!p.active || !model.compiled(p.law).has_energy()) return;
    const ParticleSet& set = set_of(p.group);
    sum += particle_sets.sum(slot).energy(set.arrays, set.family, model.compiled(p.law), p.parameters.data(), p.cutoff,
                                          model.time, parallel);
  });
  held_energy_now = sum, held_energy_is_known = true;
  return sum;
}

void System::Implementation::book_held_edits() {
  const double now = held_energy();
  model.edit_energy += now - model.held_energy;
  model.held_energy = now;
}

void System::Implementation::book_held_work() {
  const double before = model.held_energy;
  model.held_energy = calc_held_energy();
  model.external_work += model.held_energy - before;
}

Energy System::Implementation::energy() {
  const double held = held_energy();
  const ingredient::Energies now = ingredient::calc_energies(model);
  return {now.kinetic, now.potential + held, model.dissipated, model.external_work,
          ingredient::energy_of_edits(model) + held - model.held_energy};
}

double System::Implementation::pairs_energy(std::uint32_t slot) {
  const model::Pairs& pairs = model.pairs[slot];
  ParticleSet set;  // of its own: this may be asked for while others are in use
  set.group = pairs.group;
  set.find(model);
  set.load(model, 0, parallel);
  return neighbors::PairSum().energy(set.arrays, set.family, model.compiled(pairs.law), pairs.parameters.data(),
                                     pairs.cutoff, model.time, parallel);
}

}  // namespace iota
