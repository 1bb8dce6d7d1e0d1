// SPDX-License-Identifier: Apache-2.0
#include "ingredient/quantities.h"

#include "ingredient/ingredient_list.h"
#include "ingredient/model.h"
#include "solver/largest.h"

#include <algorithm>

namespace iota::ingredient {

Scope::Scope(const model::Model& model, std::uint32_t body) : model(model), structure_(model), body_(body) {}

namespace {

template <class Visit>
void for_each_alive(const model::Model& model, std::span<const std::uint32_t> bodies, Visit visit) {
  for (const std::uint32_t body : bodies)
    if (model.bodies.is_alive(body)) visit(Scope(model, body));
}

}  // namespace

Energies calc_energies(const Scope& scope) {
  Energies sum;
  add_energies<Ingredients>(scope, sum);
  return sum;
}

Momenta calc_momenta(const Scope& scope) {
  Momenta sum;
  add_momenta<Ingredients>(scope, sum);
  return sum;
}

Energies calc_energies(const model::Model& model, std::span<const std::uint32_t> bodies) {
  Energies sum;
  for_each_alive(model, bodies, [&](const Scope& body) { add_energies<Ingredients>(body, sum); });
  return sum;
}

Momenta calc_momenta(const model::Model& model, std::span<const std::uint32_t> bodies) {
  Momenta sum;
  for_each_alive(model, bodies, [&](const Scope& body) { add_momenta<Ingredients>(body, sum); });
  return sum;
}

double worst_gap(const Scope& scope) {
  solver::Largest worst;
  for_each_type<Ingredients>([&]<class I>() { worst.add(I::worst_gap(scope)); });
  return worst.value;
}

double worst_gap(const model::Model& model, std::span<const std::uint32_t> bodies) {
  solver::Largest worst;
  for_each_alive(model, bodies, [&](const Scope& body) { worst.add(worst_gap(body)); });
  return worst.value;
}

void Book::add(const Book& part) {
  energies.kinetic += part.energies.kinetic, energies.potential += part.energies.potential;
  solver::Largest worst;  // which passes NaN on
  worst.add(worst_gap), worst.add(part.worst_gap);
  worst_gap = worst.value;
}

Book calc_book(const model::Model& model, std::span<const std::uint32_t> bodies) {
  return {calc_energies(model, bodies), worst_gap(model, bodies)};
}

void begin_edits(model::Model& model) {
  if (!model.has_edits) model.booked_energy = calc_energies(model).total();
  note_edits(model, false);
}

void note_edits(model::Model& model, bool of_awake) {
  model.has_edits = std::max(model.has_edits, of_awake ? model::edits_of_awake : model::edits_of_any);
}

void book_edits(model::Model& model, double energy_now) {
  if (model.has_edits) model.edit_energy += energy_now - model.booked_energy;
  model.booked_energy = energy_now, model.has_edits = 0;
}

double energy_of_edits(const model::Model& model) {
  return model.edit_energy + (model.has_edits ? calc_energies(model).total() - model.booked_energy : 0);
}

}  // namespace iota::ingredient
