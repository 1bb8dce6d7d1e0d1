// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Point masses with the inertia pairs of their bodies, weight and damping.
class Masses : public NoAnswers {
 public:
  static void validate(const Model&, model::Audit&);
  static void add_energy(const Scope&, Energies&);
  static void add_momentum(const Scope&, Momenta&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  /// Damping rate of the velocity of an unknown ring, 1/s: that of the world, and those of its bodies, weighted by
  /// their shares of mass.
  static double damping_rate(const Model&, std::uint32_t ring);

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  double virtual_energy(const Model&) const;
  void leave(const IslandMap&);
  void clear() { virtual_.clear(); }

 private:
  std::vector<std::uint32_t> virtual_;  // markers with a virtual mass
};

}  // namespace iota::ingredient
