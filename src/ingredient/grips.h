// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/body_table.h"
#include "ingredient/ingredient.h"

#include <vector>

namespace iota::ingredient {

/// A point of a body that a viewer holds.
struct Grip {
  std::uint32_t body = none, count = 0;
  std::array<std::uint32_t, 4> points{};
  std::array<double, 4> weights{};
  Vec3 target;
  std::uint32_t client = 0, hold = 0;
  double frequency = 0, max_acceleration = 0;
  Vec3 force;  ///< in the last step, N

  /// By the mass that it feels, 1/s^2: at this distance, m, from the target it gives the largest acceleration if that is far away.
  double stiffness_at(double distance) const;
};

/// Grips of viewers: a damped spring of limited force from a point of a body to a target.
class Grips : public NoAnswers {
 public:
  struct Tables {
    BodyTable<Grip, GripId> grips;

    const auto& table_of(GripId) const { return grips; }
    template <class Archive>
    void archive(Archive& ar, const Structure&) {
      grips.archive(ar);
    }
  };
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static bool holds(const Model&, std::uint32_t particle);

  /// A grip keeps its place, on the body of the nearest particle.
  struct Held {
    std::uint32_t grip;
    Vec3 point;
    ParticleId nearest;
    BodyId body;
  };
  using Memory = std::vector<Held>;
  static Memory remember(const Model&, std::span<const std::uint32_t> bodies);
  static void reattach(Model&, const Memory&);
  static void prepare(Model&, std::uint32_t body);

  /// A grip at a body was added or will be removed. A single particle then enters an island, or leaves it.
  static void mark(Model&, std::uint32_t body);
  static Vec3 point(const Model&, const Grip&);  ///< where it holds, world frame
  /// Attaches a grip to the point of its body nearest to `point` (world frame): in the span of the body's basis, for a
  /// rod between its ends.
  static void anchor(const Model&, Grip&, const Vec3& point);

  void build(const IslandMap&, Problem&);
  void renew_pulls(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  bool keeps_awake(const Model&, const Problem& problem) const {
    return !problem.items_of<solver::GripForce>().empty();
  }
  void leave(const IslandMap&) { felt_masses_.clear(); }
  void clear() { felt_masses_.clear(); }

 private:
  struct FeltMass {
    std::uint32_t grip, body;
    double mass;  // kg
  };
  void add(const IslandMap&, std::span<const std::uint32_t> bodies, Problem&);
  const double* find_felt_mass(std::uint32_t grip, std::uint32_t body) const;

  std::vector<FeltMass> felt_masses_;  // of the island's grips
  std::vector<Vec3> arms_;             // of each force, at the start of the step, m
};

}  // namespace iota::ingredient
