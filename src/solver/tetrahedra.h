// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace iota::solver {

/// Four points whose six distances are rows, as those of a solid: their mirror image meets the rows, too. A large step may
/// end there: thin plates turned inside out in one of twenty falls by the end-point rule, and had no orientation any more.
class Tetrahedra {
 public:
  /// By the rows with both signs. Takes the time of all rows.
  void find(const Problem&);
  std::size_t size() const { return all_.size(); }
  /// Whether one is its mirror image after a motion. Flat ones are not looked at: round-off decides their side.
  bool are_mirrored(std::span<const Vec3> before, std::span<const Vec3> after) const;

 private:
  std::vector<std::array<std::uint32_t, 4>> all_;  // nodes
};

}  // namespace iota::solver
