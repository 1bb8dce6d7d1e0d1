// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Rows that keep particles that are unknowns of their own, but not in a basis, at their places in their bodies.
class AffineRows : public NoAnswers {
 public:
  static void validate(const Model&, model::Audit&);
  static double worst_gap(const Scope&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);

  void build(const IslandMap&, Problem&);
  void leave(const IslandMap&);
  void clear() { pinned_.clear(); }
  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  bool meets_pinned(const Model& model) const { return pinned_.empty() || are_pinned_met(model); }
  std::string name_of_row(const Model&, solver::ItemKey) const;

 private:
  bool are_pinned_met(const Model&) const;
  std::vector<std::uint32_t> pinned_;  // particles with pinned points only: left out of the problem
};

}  // namespace iota::ingredient
