// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Forces between two particles. Those that are solved implicitly, with the positions at the end of the step, are rows of
/// an island; the others are taken once a step and held, see `held_forces`.
class Bonds : public NoAnswers {
 public:
  template <class Archive>
  static void archive(Model& model, Archive& ar) {
    model.bonds.archive(ar);
  }
  static void validate(const Model&, model::Audit&);
  static void add_energy(const Scope&, Energies&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static bool holds(const Model&, std::uint32_t particle);

  /// The two ends of a bond for its law: distance and its rate (positions `ahead` seconds on), time, masses.
  static laws::PairState state(const Model&, const model::Bond& bond, double ahead = 0);
  static double energy(const Model&, std::uint32_t bond);  ///< of one that is solved implicitly, at `Model::time`, J
  /// On the second particle, as things stand, N.
  static Vec3 force(const Model&, std::uint32_t bond);

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
};

}  // namespace iota::ingredient
