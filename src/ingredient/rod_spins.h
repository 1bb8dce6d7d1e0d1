// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Rods turn about themselves. Their two points know nothing of that but a gyroscopic force.
class RodSpins : public NoAnswers {
 public:
  template <class Archive>
  static void archive(Model& model, Archive& ar) {
    model.spins.archive(ar, model.bodies.slot_count());
  }
  static void validate(const Model&, model::Audit&);
  static void add_energy(const Scope&, Energies&);
  static void add_momentum(const Scope&, Momenta&);
  static double energy(const Model&, std::uint32_t body);  ///< of one that spins, J
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  double after_step(Model&, double h, Problem&);
  bool keeps_awake(const Problem& problem) const { return !problem.pool_of<solver::GyroscopicForce>().items.empty(); }
  void put_to_rest(Model&, const Problem&) const;
};

}  // namespace iota::ingredient
