// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Pairs of particles that come together over some time and are combined then: distance rows that get shorter.
class Closings : public NoAnswers {
 public:
  template <class Archive>
  static void archive(Model& model, Archive& ar) {
    model.closings.archive(ar);
  }
  static void validate(const Model&, model::Audit&);
  static bool holds(const Model&, std::uint32_t particle);

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  std::string name_of_row(const Model&, solver::ItemKey) const;
};

}  // namespace iota::ingredient
