// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Optional attributes of particles: lifetime, look, and orientation. Oriented particles rotate like balls; their
/// rotation is stepped in closed form.
class OrientedParticles : public NoAnswers {
 public:
  static void validate(const Model&, model::Audit&);
  static void add_energy(const Scope&, Energies&);
  static void add_momentum(const Scope&, Momenta&);
  static void end_step(Model&, double h);
  static void tell(Model&, Outcome&);
};

}  // namespace iota::ingredient
