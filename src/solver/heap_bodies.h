// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"
#include "solver/pieces.h"
#include "solver/problem.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace iota::solver {

/// All that a sweep needs of a body. Of what is driven, and of the world: zero. Lanes gather it in this order, in fours.
struct alignas(32) HeapMotion {
  Vec3 velocity;       ///< m/s
  double by_mass = 0;  ///< 1/kg
  Vec3 spin;           ///< rad/s
  Mat3 by_inertia;     ///< about the center, now; along the line of a rod zero
};

/// A rigid body of a Heap: points that all have lengths between each other. Bodies may share points.
struct HeapBody {
  static constexpr std::size_t most_points = 4;

  std::array<std::uint32_t, most_points> nodes{};
  std::array<double, most_points> shares{};  ///< of the points' masses
  std::uint32_t count = 0;
  bool is_driven = false;  ///< its points follow targets
  bool is_even = false;    ///< its inertia is the same in all directions: of a ball, a cube
  // In a step.
  Mat3 inertia, by_inertia_at_begin;   ///< about the center, at the begin
  Vec3 center, moved;                  ///< at the begin; since then, m
  Quaternion turn;                     ///< since the begin
  Mat3 turned;                         ///< the same as a matrix
  Vec3 gain, turning;                  ///< of held forces in a sub-step: m/s, N m s
  std::array<Vec3, most_points> arms;  ///< of the points at the begin, m

  Vec3 arm_now(std::uint32_t k) const { return turned * arms[k]; }
  Vec3 center_now() const { return center + moved; }
  Vec3 angular_momentum(const Vec3& spin) const { return turned * (inertia * transposed_times(turned, spin)); }
  /// Turns it and its inertia; the spin is that of this angular momentum.
  void turn_to(const Quaternion&, const Vec3& angular_momentum, HeapMotion&);
  /// Moves and turns it for h seconds by its motion.
  void move(double h, HeapMotion&);
};

/// The bodies of a problem. A point that several bodies share belongs to the first of them, the others have a copy of it: its mass
/// is shared out, as the masses that couple it with the points of each body. Any other shares would move alike, as
/// the copies stay together, and converge more slowly.
struct HeapBodies {
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  struct Copy {
    std::uint32_t node, body, place;  ///< place: of the node in the body
  };
  struct Coupling {
    std::uint32_t item, body;  ///< of Problem::mass_couplings
    double share;
  };

  std::vector<HeapBody> all;
  std::vector<std::uint32_t> owner;     ///< of each node
  std::vector<Copy> copies;             ///< of shared points, but for the first
  std::vector<Coupling> couplings;      ///< in the order of items
  std::vector<std::uint8_t> is_target;  ///< of each node: a nail holds it

  /// After a change of structure. False if a driven body shares a point, or a share of mass is not positive.
  bool find(const Problem&);
  bool have(std::uint32_t body, std::uint32_t node) const { return place_of(body, node) < all[body].count; }
  /// The number of a point in a body; its count if it has no such point.
  std::uint32_t place_of(std::uint32_t body, std::uint32_t node) const;
  bool is_shared(std::uint32_t node) const { return !copies.empty() && bodies_at_[node].size() > 1; }
  /// The mass of each body, kg; zero where it is driven.
  std::vector<double> masses(const Problem&) const;
  /// The places of all points in a step, and those that driven ones reach next: at these fractions of the way of their targets.
  void find_places(const Problem&, double from, double to, std::vector<Vec3>& now, std::vector<Vec3>& next) const;
  /// The body that has all these points, or the first of them.
  std::uint32_t with(std::span<const std::uint32_t> nodes) const;

 private:
  void add_body(std::uint32_t a, std::uint32_t b, const std::vector<std::vector<std::uint32_t>>& neighbors);
  bool have_body(std::uint32_t a, std::uint32_t b) const;
  bool share_masses(const Problem&);

  Pieces pieces_;
  std::vector<std::vector<std::uint32_t>> bodies_at_;  // each node of a piece of several bodies
};

}  // namespace iota::solver
