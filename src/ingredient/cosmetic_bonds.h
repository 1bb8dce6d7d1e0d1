// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"
#include "model/restructure.h"

namespace iota::ingredient {

/// Two particles of one body with a line between them.
struct CosmeticBond : model::Ends {};

/// Lines between particles of a body. They do not act in a step: they are drawn, and define which particles stay
/// together when the body is split.
class CosmeticBonds : public NoAnswers {
 public:
  struct Tables {
    model::EndTable<CosmeticBond, CosmeticBondId> cosmetic_bonds;

    const auto& table_of(CosmeticBondId) const { return cosmetic_bonds; }
    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      cosmetic_bonds.archive(ar, structure.particles.slot_count());
    }
  };
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static void visit_companions(const Model&, std::uint32_t particle, Visit);
  static void absorb(Model&, std::uint32_t q, std::uint32_t p);
  static void drop(Model&, std::uint32_t particle);
  static void visit_lines(const Model&, std::uint32_t body, Structure::VisitLine);
  static void draw(const SceneView&, std::uint32_t body, DrawnBody&);

  static std::uint32_t add(Model&, const CosmeticBond&);  ///< returns the slot
  static void remove(Model&, std::uint32_t bond);
  /// Removes one. If its two ends are not connected otherwise, the body is split: the piece with the bond's first end
  /// stays this body, the other one is new.
  static model::Edit break_(Model&, std::uint32_t bond, RestructureReport&);
};

}  // namespace iota::ingredient
