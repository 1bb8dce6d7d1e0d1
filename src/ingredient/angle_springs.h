// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

#include <iota/ids.h>

namespace iota::ingredient {

/// A spring on the angle that three particles span at the middle one.
struct AngleSpring : model::ThreeEnds {
  double stiffness = 0;                 ///< N m/rad, at the rest angle
  double damping = 0;                   ///< N m s/rad, there
  double rest = 0;                      ///< angle, rad, above 0 and up to pi
  std::array<double, 2> lengths{1, 1};  ///< of the legs, from the middle to the first and to the last particle, m
};

/// Commands, with AngleSpringOptions as plain data.
struct CreateAngleSpring {
  ParticleId p, middle, q;
  double stiffness, damping, rest;
};
struct SetAngleSpring {
  Id<"angle spring"> spring;
  double stiffness, damping, rest;
};

/// Springs on angles: bending stiffness of ropes and beams, angle terms of molecules.
///
///   e = (b x_p + a x_q) / (a + b) - x_m    a, b: the lengths of the legs m-p and m-q when the spring was made
///   U = k/2 (|e| - L)^2
///
/// e goes from the middle particle to the point of the chord that divides it as a : b. With s = a b / (a + b) and legs
/// of these lengths |e| = 2 s cos(angle / 2), so U depends on the angle alone; k and L are such that it is least at the
/// rest angle and has there the second derivative `stiffness`. Unlike the angle itself |e|^2 is smooth where the legs are
/// straight. Forces b/(a + b) F, -F and a/(a + b) F along e have neither a sum nor a moment. It is the spring of the
/// solver with three points, so its energy is kept in steps.
/// The spring has no force while two of the three particles share a ring.
class AngleSprings : public NoAnswers {
 public:
  struct Tables {
    model::EndTable<AngleSpring, Id<"angle spring">> angle_springs;

    const auto& table_of(Id<"angle spring">) const { return angle_springs; }
    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      angle_springs.archive(ar, structure.particles.slot_count());
    }
  };
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static void add_energy(const Scope&, Energies&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static bool holds(const Model&, std::uint32_t particle);
  static bool uses(const Model& model, std::uint32_t particle) { return holds(model, particle); }
  static bool ties_any(const Model&);
  static void visit_tied(const Model&, std::uint32_t particle, Visit);
  static void absorb(Model&, std::uint32_t q, std::uint32_t p);
  static void drop(Model&, std::uint32_t particle);

  using Commands = std::tuple<CreateAngleSpring, SetAngleSpring, Destroy<Id<"angle spring">>>;
  static Id<"angle spring"> apply(Model&, const CreateAngleSpring&);
  static void apply(Model&, const SetAngleSpring&);
  static void apply(Model&, const Destroy<Id<"angle spring">>&);

  static double angle(const Model&, const AngleSpring&);     ///< now, rad
  static double moment(const Model&, std::uint32_t spring);  ///< that opens the angle, -dU/dangle, N m

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
};

}  // namespace iota::ingredient
