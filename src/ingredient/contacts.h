// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/touch.h"
#include "ingredient/ingredient.h"
#include "model/basis_weights.h"
#include "model/end_table.h"

#include <iota/materials.h>

#include <span>
#include <string>

namespace iota::ingredient {

/// A place where two bodies are near each other, or touch: body p with a point, body q with a plane. See contact::Touch.
struct Contact : model::Ends {
  std::uint32_t part = 0, feature = 0, other_part = 0, other_feature = 0;
  contact::TouchForm form = contact::TouchForm::face;
  std::uint8_t turns = 0, slips_turn = 0;  ///< arm 2 turns with a body; arms 3 and 4 do
  std::uint8_t is_of_sweeps = 0;           ///< its overlap was left by sweeps, see solver::Heap
  std::uint8_t is_off = 0;  ///< it has no rows in this part of a step: the bodies are solved together, but do not touch
  std::uint8_t continues = 0;               ///< it adds its impulse to that of an earlier part of the step
  std::array<std::uint32_t, 8> points{};    ///< the basis of p, then that of q, of those that are not static
  std::uint32_t point_count = 0, of_p = 0;  ///< all points, those of p
  std::uint32_t roll_rows = 0;              ///< of rolling resistance, at one of the places of two bodies
  std::uint32_t spin_rows = 0;              ///< of friction against spinning on the spot
  /// The weights of the points in the arms of solver::ContactConstraint.
  std::array<std::array<double, 8>, 5> weights{};
  Vec3 center, place;             ///< of a static body instead: the constants of the first two arms, in the world
  Vec3 normal, first, second;     ///< now; they turn with a body, or keep their direction
  Vec3 axis;                      ///< of round things and wires, see contact::Touch
  std::array<double, 2> bends{};  ///< of wires
  double radius = 0, friction = 0, static_friction = 0, restitution = 0;
  double ball = 0;                       ///< part of the radius that is p's
  Vec3 drift;                            ///< of q's surface against p's, beyond their bodies' motion, m/s
  double rolling = 0;                    ///< bound of the torque against rolling, of the force, m
  double carried = 0;                    ///< by all places of both in the last step, N
  Vec3 roller;                           ///< the direction of p that will be the normal in the middle of the step
  Vec3 roll_first, roll_second, torque;  ///< the directions of q in which p may roll; the multipliers along them, N m
  double spinning = 0;                   ///< bound of the torque against spinning, of the force, m
  Vec3 spinner, spin_second;   ///< a direction of p and one of q, which in the middle of the step are along the plane
  double twist = 0;            ///< the torque about the normal, N m
  Vec3 pivot;                  ///< see solver::ContactConstraint::rate_of, m/s
  double depth = 0;            ///< of an overlap that was there before the contact, m, not positive: it only shrinks
  double push = 0;             ///< force along the normal on p in the last step, N
  Vec3 drag;                   ///< force of friction on it, N
  double energy = 0;           ///< of its elastic strain, J
  double duration = 0;         ///< of the step, or the part of it, in which these forces were found, s
  Vec3 impulse;                ///< on p in the last step, with that of an impact, N s
  double time = 0;             ///< in which it was given, s
  double approach = 0;         ///< of p towards the plane before the step, if it carried nothing in the one before, m/s
  std::uint64_t found_in = 0;  ///< step

  Vec3 force() const { return push * normal + drag; }
  /// The force that is told: in the last step, with what an impact or a jump of a prescribed velocity took. The mid-point rule alone
  /// has twice the force of what begins to move.
  Vec3 mean_force() const { return time > 0 && impulse != Vec3{} ? (1 / time) * impulse : force(); }
  bool is_round() const { return form == contact::TouchForm::round || form == contact::TouchForm::wires; }
  /// From the plane or what is round to the center, of d between the origin and the center.
  Vec3 off(const Vec3& d) const;
  bool carries() const { return push != 0 || drag != Vec3{}; }
  /// It holds no more, though it carried in the last step. Sweeps, which strain nothing, do not end it.
  bool has_left() const { return energy == 0 && is_of_sweeps == 0; }
  /// Also in a part of the step only.
  bool has_touched() const { return carries() || impulse != Vec3{}; }
};

/// Contacts of two bodies: bounded rows with Coulomb friction, see solver/constraints/contact.h. The step finds them before it
/// solves (src/step/contacts.h); in a table they keep their forces for the next step. Two that move
/// are solved together; one of them may be static.
class Contacts : public NoAnswers {
 public:
  static constexpr bool ties_by_contact = true;
  struct Tables {
    model::EndTable<Contact, Id<"contact">> contacts;  ///< the ends are bodies
    std::uint64_t restores = 0;                        ///< of this model; not saved
    std::vector<std::uint32_t> told_as_buried;         ///< bodies that a note has been made of; not saved

    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      contacts.archive(ar, structure.bodies.slot_count());
    }
  };
  static void take_over(Model& restored, Model& before);
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static double worst_gap(const Scope&);
  static void add_energy(const Scope&, Energies&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static bool holds(const Model&, std::uint32_t particle);
  static void visit_tied(const Model&, std::uint32_t particle, Visit);
  static bool ties_any(const Model&);
  static void forget_body(Model&, std::uint32_t body);
  static void inertia_changed(Model&, std::uint32_t body);
  static void acting_changed(Model& model, std::uint32_t particle) { drop(model, particle); }  ///< a new kind, too
  static void absorb(Model&, std::uint32_t q, std::uint32_t p);
  static void drop(Model&, std::uint32_t particle);
  static void prepare(Model&, std::uint32_t body);

  struct Motion {
    double size;                          ///< of the smaller body, m
    Vec3 spins[2];                        ///< of both, rad/s
    double h;                             ///< of the step, s
    const model::BasisWeights* bases[2];  ///< of both, where they are known
  };
  /// The contacts of two bodies for a step. Those that they had before, `former`, keep their forces.
  static void take(Model&, std::uint32_t first, std::uint32_t second, std::span<const std::uint32_t> former,
                   std::span<const contact::Touch>, const Motion&);
  /// The same for bodies that are where they were found the last time: they touch at the same places. False, without a change,
  /// if they have not touched.
  static bool renew(Model&, std::uint32_t first, std::uint32_t second, std::span<const std::uint32_t> former,
                    const Motion&);
  /// Two bodies that may meet on their way in this step are solved together from its begin.
  static void tie(Model&, std::uint32_t first, std::uint32_t second);
  /// Before and after the contacts of an island are taken for a part of a step. Those of these that are not taken have no rows
  /// in it, but stay until the end of the step with their impulse.
  static void begin_part(Model&, std::span<const std::uint32_t> slots, bool is_first);
  static void end_part(Model&, std::span<const std::uint32_t> slots);
  /// The contacts of two bodies that hardly move against each other stay for a part of a step. False: they have none.
  static bool keep(Model&, std::span<const std::uint32_t> slots);
  /// Whether contacts of a body were solved one by one in its last step, or part of one: see solver::Heap.
  static bool is_of_sweeps(const Model&, std::uint32_t body);
  /// Ends all contacts of a body that were not taken in this step.
  static void end_old(Model&, std::uint32_t body);
  /// Wakes a body whose place, material or size changes, and what touches it.
  static void wake(Model&, std::uint32_t body);
  /// Ends all contacts of a body.
  static void end(Model&, std::uint32_t body);
  /// The place where the bodies touch, m.
  static Vec3 place(const Model&, const Contact&);
  /// At the end of the last step, m.
  static double gap(const Model&, const Contact&);
  /// The hardest of those of some bodies that began to carry in the last step.
  static Impact hardest_impact(const Model&, std::span<const std::uint32_t> bodies);

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  double after_step(Model&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  bool keeps_awake(const Model&, const Problem&) const;
  std::string name_of_row(const Model&, solver::ItemKey) const;
};

}  // namespace iota::ingredient
