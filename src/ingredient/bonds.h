// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"
#include "ingredient/laws.h"

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace iota::ingredient {

/// A force between two particles, by a law.
struct Bond : model::Ends {
  std::uint32_t law = spring_law;
  static constexpr std::uint8_t as_force = 1, as_row = 2;
  std::uint8_t active = 1;
  std::uint8_t implicit = as_force;  ///< 0: held; how it is solved otherwise
  std::uint8_t muted = 0;            ///< one of its ends is inactive
  std::uint8_t broken = 0;           ///< by a force above `break_force`
  std::array<double, laws::max_parameters> parameters{};
  double break_force = std::numeric_limits<double>::infinity();  ///< N
  Vec3 held_force;           ///< on p in the last step, N; of held bonds and of rows
  std::uint64_t script = 0;  ///< key of its own function, which is outside of the tables

  /// Whether it is solved implicitly, so that its two ends belong to one problem.
  bool ties() const { return acts() && implicit; }
  bool acts() const { return active && !muted; }
  /// Whether it is between points of one rigid body, which a held force does not move: it spun the body up.
  bool is_within_body(const model::Structure& structure) const {
    return structure.particles[p].body == structure.particles[q].body;
  }
};

/// Forces between two particles. Implicit ones, of the positions at the end of the step, are in the problem of an
/// island; the others are evaluated once a step and held, see `held_forces`. A spring so stiff that the round-off of its
/// length would be a considerable force is a row with a compliance: its tension is an unknown.
class Bonds : public NoAnswers {
 public:
  struct Tables {
    model::EndTable<Bond, BondId> bonds;
    std::uint64_t bonds_revision = 0;   ///< rises when a bond is added, removed, moved or switched; not saved
    model::ChangedSlots changed_bonds;  ///< not saved
    /// Acting bonds with a breaking force, at a `bonds_revision`; not saved.
    std::vector<std::uint32_t> breakable_bonds;
    std::uint64_t breakable_revision = ~0ull;

    const auto& table_of(BondId) const { return bonds; }
    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      bonds.archive(ar, structure.particles.slot_count());
    }
  };
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static void add_energy(const Scope&, Energies&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static bool holds(const Model&, std::uint32_t particle);
  static bool uses(const Model&, std::uint32_t particle);
  static bool ties_any(const Model&);
  static void visit_tied(const Model&, std::uint32_t particle, Visit);
  static void absorb(Model&, std::uint32_t q, std::uint32_t p);
  static void drop(Model&, std::uint32_t particle);
  static void acting_changed(Model&, std::uint32_t particle);
  static void tell(Model&, Outcome&);
  static void visit_stirred(const Model&, double h, Visit);
  static model::ChangedSlots* scene_log(Model&);
  static void describe(const SceneView&, SceneChanges&);

  static std::uint32_t add(Model&, const Bond&);  ///< returns the slot
  static void remove(Model&, std::uint32_t bond);
  static void set_active(Model&, std::uint32_t bond, bool active);  ///< true repairs a broken one
  static void parameter_changed(Model&, std::uint32_t bond);

  /// The state of a bond for its law: distance and its rate (positions extrapolated by `ahead` seconds), time, masses.
  static laws::PairState state(const Model&, const Bond& bond, double ahead = 0);
  static double energy(const Model&, std::uint32_t bond);  ///< of one that is solved implicitly, at `Model::time`, J
  /// On the second particle at the present state, N.
  static Vec3 force(const Model&, std::uint32_t bond);
  /// On the first particle, N: of an implicit force at present, of others in the last step.
  static Vec3 force_on_first(const Model&, std::uint32_t bond);

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
};

}  // namespace iota::ingredient
