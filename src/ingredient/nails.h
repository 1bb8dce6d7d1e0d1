// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// The pin of a ring: a nail, or a static or scripted body.
struct Nail {
  /// Its place, and that at the last step, m. The ring of a static body: the assigned place, and where the last step has
  /// left the ring: elsewhere than there the script has moved it.
  Vec3 position, position_before;
  Vec3 multiplier;  ///< minus its force, N; warm start and reaction
};

/// Pins of rings: nails, static and scripted bodies. Nails that the script moves arrive at the end of the step. Also tells
/// which nails and hinges are overloaded.
class Nails : public NoAnswers {
 public:
  struct Tables {
    SideTable<Nail> nails;              ///< of rings
    model::ChangedSlots changed_nails;  ///< rings; not saved

    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      nails.archive(ar, structure.rings.slot_count());
    }
  };
  static void validate(const Model&, model::Audit&);
  static void ring_changed(Model&, std::uint32_t ring);
  static void ring_merged(Model&, std::uint32_t into, std::uint32_t from, bool replaces);
  static void prepare(Model&, std::uint32_t body);
  static model::ChangedSlots* scene_log(Model&);
  static void describe(const SceneView&, SceneChanges&);
  static double worst_gap(const Scope&);
  static void visit_stirred(const Model&, double h, Visit);
  static void tell(Model&, Outcome&);

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
};

}  // namespace iota::ingredient
