// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// The spin of a rod about its axis, which its two points do not have.
struct RodSpin {
  double momentum =
      0;             ///< about the line from the first to the second particle of its inertia pair, kg m^2/s; constant
  double angle = 0;  ///< turned by since it began, rad
  double drawn = 0;  ///< of that, what the drawn frame shows
};

/// Rods spin about their axes. Only a gyroscopic force of that acts on their two points.
class RodSpins : public NoAnswers {
 public:
  struct Tables {
    SideTable<RodSpin> spins;  ///< of bodies that are rods

    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      spins.archive(ar, structure.bodies.slot_count());
    }
  };
  static void validate(const Model&, model::Audit&);
  static void forget_body(Model&, std::uint32_t body);
  static void inertia_changed(Model&, std::uint32_t body);
  static Vec3 inner_momentum(const Model&, std::uint32_t body);
  static void add_energy(const Scope&, Energies&);
  static void add_momentum(const Scope&, Momenta&);
  static void set(Model&, std::uint32_t body, double angular_velocity);  ///< of a rod about itself, rad/s
  static double energy(const Model&, std::uint32_t body);                ///< of one that spins, J
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);

  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  double after_step(Model&, double h, Problem&);
  bool keeps_awake(const Model&, const Problem& problem) const {
    return !problem.items_of<solver::GyroscopicForce>().empty();
  }
  void put_to_rest(Model&, const Problem&) const;
};

}  // namespace iota::ingredient
