// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// What viewers hold: a damped spring from a point of a body to a target, of limited force.
class Grips : public NoAnswers {
 public:
  template <class Archive>
  static void archive(Model& model, Archive& ar) {
    model.grips.archive(ar);
  }
  static void validate(const Model&, model::Audit&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static bool holds(const Model&, std::uint32_t particle);

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  bool keeps_awake(const Problem&) const { return !slots_.empty(); }
  bool can_follow() const { return slots_.empty(); }

 private:
  std::vector<std::uint32_t> slots_;  // of each grip force
  std::vector<double> masses_;        // kg, that each one feels
  std::vector<Vec3> arms_;            // of each force, at the start of the step, m
};

}  // namespace iota::ingredient
