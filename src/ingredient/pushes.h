// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"
#include "math/mat3.h"

#include <vector>

namespace iota::ingredient {

/// Forces that were applied to a ring, N.
struct Push {
  Vec3 force;   ///< for the next step only
  Vec3 before;  ///< in the last step
};

/// The part of a push that is linear in the velocity of the ring, in the step at hand.
struct PushByVelocity {
  Mat3 rate;   ///< derivative by the velocity, N s/m
  Vec3 force;  ///< its value in `Push::force`, N
};

/// A torque that was applied to a body, N m.
struct Torque {
  Vec3 torque;  ///< for the next step only
  Vec3 before;  ///< in the last step
};

/// Forces and torques that were applied to particles and bodies for one step.
class Pushes : public NoAnswers {
 public:
  struct Tables {
    SideTable<Push> pushes;                        ///< of rings
    SideTable<PushByVelocity> pushes_by_velocity;  ///< of rings; empty between steps, and not saved

    SideTable<Torque> torques;  ///< of bodies

    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      pushes.archive(ar, structure.rings.slot_count());
      torques.archive(ar, structure.bodies.slot_count());
    }
  };
  static void validate(const Model&, model::Audit&);
  static void ring_changed(Model&, std::uint32_t ring);
  static void ring_merged(Model&, std::uint32_t into, std::uint32_t from, bool replaces);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static void end_step(Model&, double h);
  static void forget_body(Model&, std::uint32_t body);
  /// Adds a torque to a body during the next step. Throws std::invalid_argument if the body has no lever about its axis.
  static void check_torque(const Model&, std::uint32_t body, const Vec3& torque);
  static void add_torque(Model&, std::uint32_t body, const Vec3& torque);

  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  static void visit_stirred(const Model&, double h, Visit);
  bool keeps_awake(const Model&, const Problem&) const;

 private:
  static void load_torques(const Model&, const IslandNodes&, Problem&);
  void load_parts_by_velocity(const Model&, const IslandNodes&, Problem&);
  Vec3 force_by_velocity(const Model&, std::uint32_t ring, double h, const Problem&, std::size_t item) const;

  std::vector<Vec3> arms_;  // of the forces by velocity at the start of the step
};

}  // namespace iota::ingredient
