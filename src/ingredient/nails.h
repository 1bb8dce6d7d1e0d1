// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// What pins a ring to a place: a nail, a static or a scripted body. Nails that the script moves arrive at the end of the
/// step.
class Nails : public NoAnswers {
 public:
  template <class Archive>
  static void archive(Model& model, Archive& ar) {
    model.nails.archive(ar, model.rings.slot_count());
  }
  static void validate(const Model&, model::Audit&);
  static double worst_gap(const Model&);

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  void refresh(Model&, const IslandNodes&, bool moved) const;
  std::string name_of_row(const Model&, solver::ItemKey) const;

  void accept_assigned(Model&, const IslandNodes&) const;
  bool prescribes_motion(const Model&, const IslandNodes&) const;
  double velocity_jump(const Problem&, double h) const;
  void impose_velocities(Problem&, double h) const;
  void impose_positions(Problem&) const;

  bool wakes(const Model& model, const IslandNodes& nodes) const { return prescribes_motion(model, nodes); }
};

}  // namespace iota::ingredient
