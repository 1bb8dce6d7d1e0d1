// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

struct Balloon {
  static constexpr std::uint32_t count = 1;
  std::array<std::uint32_t, count> particles{model::none}, next{model::none}, previous{model::none};
  std::uint32_t padding = 0;
  Vec3 lift;  ///< N

  std::uint32_t at(std::uint32_t end) const { return particles[end]; }
  void set(std::uint32_t end, std::uint32_t particle) { particles[end] = particle; }
};

struct CreateBalloon {
  ParticleId particle;
  Vec3 lift;
};
struct SetLift {
  Id<"balloon"> balloon;
  Vec3 lift;
};

/// Constant forces on particles.
class Balloons : public NoAnswers {
 public:
  struct Tables {
    model::EndTable<Balloon, Id<"balloon">> balloons;

    const auto& table_of(Id<"balloon">) const { return balloons; }
    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      balloons.archive(ar, structure.particles.slot_count());
    }
  };
  using Commands = std::tuple<CreateBalloon, SetLift, Destroy<Id<"balloon">>>;
  static Id<"balloon"> apply(Model&, const CreateBalloon&);
  static void apply(Model&, const SetLift&);
  static void apply(Model&, const Destroy<Id<"balloon">>&);

  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static void add_energy(const Scope&, Energies&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static bool holds(const Model&, std::uint32_t particle);
  static bool uses(const Model& model, std::uint32_t particle) { return holds(model, particle); }
  static void absorb(Model&, std::uint32_t q, std::uint32_t p);
  static void drop(Model&, std::uint32_t particle);

  void load(const Model&, const IslandNodes&, double h, Problem&);
};

}  // namespace iota::ingredient
