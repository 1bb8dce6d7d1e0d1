// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"
#include "ingredient/joint_rows.h"

namespace iota::ingredient {

/// Joints, rods, ropes, paths and surfaces with their limits, motors, friction and springs.
class Joints : public NoAnswers {
 public:
  template <class Archive>
  static void archive(Model& model, Archive& ar) {
    model.constraints.archive(ar);
    ar.vector(model.curve_points);
  }
  static void validate(const Model&, model::Audit&);
  static void add_energy(const Scope&, Energies&);
  static double worst_gap(const Model&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static bool holds(const Model&, std::uint32_t particle);

  void build(const IslandMap&, Problem&);
  void leave(const IslandMap&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  void refresh(Model&, const IslandNodes&, bool moved) const;
  bool meets_pinned(const Model&) const;
  std::string name_of_row(const Model&, solver::ItemKey) const;

 private:
  void add(const IslandMap&, std::uint32_t joint, Problem&);

  std::vector<std::uint32_t> joints_;
  std::vector<std::uint32_t> pinned_;  // those with rows whose nodes are all pinned: these rows are left out
};

}  // namespace iota::ingredient
