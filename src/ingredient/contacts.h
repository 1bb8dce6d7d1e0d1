// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/touch.h"
#include "ingredient/body_table.h"
#include "ingredient/ingredient.h"

#include <iota/materials.h>

#include <span>
#include <string>

namespace iota::ingredient {

/// A place where a body is near an obstacle, or touches it.
struct Contact {
  std::uint32_t body = none, other = none;  ///< the second one is static
  std::uint32_t part = 0, feature = 0;      ///< see contact::Touch
  std::array<std::uint32_t, 4> points{};    ///< the basis of the body
  std::uint32_t count = 0;
  std::array<double, 4> center{}, place{};  ///< weights of the points: see contact::Touch
  Vec3 origin, normal;                      ///< of the plane
  double radius = 0, friction = 0;
  double depth = 0;     ///< of an overlap that was there before the contact, m, not positive: it only shrinks
  Vec3 force;           ///< on the body in the last step, N
  double energy = 0;    ///< of its elastic strain, J
  double approach = 0;  ///< speed towards the plane before the step, if it carried nothing in the one before, m/s
};

/// Contacts of bodies with obstacles: bounded rows with Coulomb friction, see solver/constraints/contact.h. The step finds
/// them before it solves (src/step/contacts.h); in a table they keep their forces for the next step.
class Contacts : public NoAnswers {
 public:
  struct Tables {
    BodyTable<Contact, Id<"contact">> contacts;

    template <class Archive>
    void archive(Archive& ar, const Structure&) {
      contacts.archive(ar);
    }
  };
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static double worst_gap(const Scope&);
  static void add_energy(const Scope&, Energies&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static bool holds(const Model&, std::uint32_t particle);
  static void forget_body(Model&, std::uint32_t body);
  static void inertia_changed(Model& model, std::uint32_t body) { end(model, body); }
  static void absorb(Model&, std::uint32_t q, std::uint32_t p);
  static void drop(Model&, std::uint32_t particle);
  static void prepare(Model&, std::uint32_t body);

  struct Found {
    std::uint32_t other;
    contact::Touch touch;
  };
  struct Motion {
    double size;  ///< of the body, m
    Vec3 spin;    ///< rad/s
    double h;     ///< of the step, s
  };
  /// Replaces the contacts of a body for a step. Those that it had before keep their forces.
  static void take(Model&, std::uint32_t body, std::span<const Found>, const Motion&);
  /// The place where it touches, m.
  static Vec3 place(const Model&, const Contact&);
  /// The hardest of those that began to carry in the last step.
  static Impact hardest_impact(const Model&);
  /// Ends all contacts of a body.
  static void end(Model&, std::uint32_t body);

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  std::string name_of_row(const Model&, solver::ItemKey) const;
};

}  // namespace iota::ingredient
