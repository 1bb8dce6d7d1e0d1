// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// What few particles have: a life, a look, and an orientation of their own. Oriented particles turn like balls; their
/// turning is stepped in closed form, see `particle_life`.
class OrientedParticles : public NoAnswers {
 public:
  static void validate(const Model&, model::Audit&);
  static void add_energy(const Scope&, Energies&);
  static void add_momentum(const Scope&, Momenta&);
};

}  // namespace iota::ingredient
