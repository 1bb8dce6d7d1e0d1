// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/scope.h"

#include <cstdint>
#include <span>

namespace iota::ingredient {

/// Energies and momenta of everything in the scope, without held forces.
Energies calc_energies(const Scope&);
inline Energies calc_energies(const model::Model& model) { return calc_energies(Scope(model)); }
Momenta calc_momenta(const Scope&);
inline Momenta calc_momenta(const model::Model& model) { return calc_momenta(Scope(model)); }

/// The same for some bodies and their items; destroyed bodies are skipped.
Energies calc_energies(const model::Model&, std::span<const std::uint32_t> bodies);
Momenta calc_momenta(const model::Model&, std::span<const std::uint32_t> bodies);

/// The largest gap over rigid distances, tied particles, nails and joints, m.
double worst_gap(const Scope&);
inline double worst_gap(const model::Model& model) { return worst_gap(Scope(model)); }
double worst_gap(const model::Model&, std::span<const std::uint32_t> bodies);

/// A step reports this of a part of the model.
struct Book {
  Energies energies;
  double worst_gap = 0;  ///< m

  void add(const Book&);
};
Book calc_book(const model::Model&, std::span<const std::uint32_t> bodies);
inline Book calc_book(const model::Model& model) { return {calc_energies(model), worst_gap(model)}; }

/// The change by edits is the difference of the energy before the first and after the last of them: one sum for all.
/// Between steps `Model::booked_energy` is that of the end of the last step.
void begin_edits(model::Model&);
/// See Model::has_edits: after those of bodies that are awake by them, what is known of still ones is right.
void note_edits(model::Model&, bool of_awake);
void book_edits(model::Model&, double energy_now);
double energy_of_edits(const model::Model&);  ///< those not booked yet included, J

}  // namespace iota::ingredient
