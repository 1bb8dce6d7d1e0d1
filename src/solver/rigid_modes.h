// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace iota::solver {

/// A rigid motion, or what a row notices of one.
struct RigidMode {
  Vec3 velocity, turning;  ///< of the center; the second in units of a length

  double along(const RigidMode& other) const { return dot(velocity, other.velocity) + dot(turning, other.turning); }
  void add(double factor, const RigidMode& other) {
    velocity += factor * other.velocity, turning += factor * other.turning;
  }
};

/// A line about which something turns.
struct Axle {
  Vec3 place, direction;  ///< the second of length 1
};

/// Some rigid motions, orthonormal, of points about a center.
struct RigidModes {
  static constexpr double independent = 1e-12;  ///< of the square of a size
  Vec3 center{};
  double length = 1;  ///< the extent of the points, m
  std::array<RigidMode, 6> modes{};
  std::size_t count = 0;

  bool are_all() const { return count == modes.size(); }
  /// The part of a mode that they do not have.
  RigidMode beside(RigidMode mode) const;
  /// A mode that they do not have; zero if they are all.
  RigidMode another() const;
  /// `size`: of the mode, squared, with what cancels in it.
  void add(const RigidMode& mode, double size);
  /// If they leave one motion, and this turns about a line.
  std::optional<Axle> axle() const;
};

enum class Noticed : std::uint8_t { by_all_rows, by_joints };

/// Adds to each part the rigid motions of its points that the rows of the world, and those on points of no part, notice; with
/// `by_joints` contacts do not count. part_of: each node; Pieces::none for what does not move.
void add_noticed_modes(const Problem&, std::span<const std::uint32_t> part_of, std::span<RigidModes> noticed,
                       Noticed = Noticed::by_all_rows);

}  // namespace iota::solver
