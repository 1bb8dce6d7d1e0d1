// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/newton.h"

#include <span>
#include <vector>

namespace iota::solver {

/// Projects positions and velocities of a large problem on its rows by moving only the points around a few of them, in
/// a time independent of the problem's size. An edit disturbs few rows, and along a chain the correction decays by a
/// factor per link, unless the links are in a straight line. So only the part around the disturbed points is solved,
/// with its rim fixed, and the solution is accepted only if it has decayed before the rim: it is then that of the whole
/// problem, to 1e-12. Other rows keep their gaps and rates.
class LocalProjection {
 public:
  /// Restores the rows at some points, the center, for velocities and, on request, for positions. False, without a
  /// change, if the whole problem must be projected: the center or its surroundings are large, the solution reaches
  /// further, there is none, or bounded rows would have to choose their sides.
  bool project(Problem&, std::span<const std::uint32_t> center, bool positions);
  /// A whole small problem is solved in less time than a part of it is chosen.
  static bool is_worthwhile(const Problem& problem) { return problem.size() >= 1024; }
  /// The structure of the problem has changed.
  void forget() { is_known_ = false; }
  /// The points that the latest projection may have moved.
  std::span<const std::uint32_t> nodes() const { return {nodes_.data(), inner_count_}; }

 private:
  enum class Outcome { done, reaches_further, none };
  bool choose_part(const Problem&, std::uint32_t reach);
  void list_neighbors(const Problem&);
  bool build_part(const Problem&);
  void load_part(const Problem&);
  Outcome solve_positions();
  Outcome solve_velocities(std::span<const double> rates);
  Outcome judge(std::span<const Vec3> change);

  std::vector<std::uint32_t> center_;             // of the part, in order
  std::vector<std::uint32_t> nodes_;              // of the part, by distance from the center: inner ones, then the rim
  std::size_t inner_count_ = 0, skin_begin_ = 0;  // the skin: the last inner ones
  bool is_known_ = false;                         // whether the part of the latest center can be used again
  double decay_ = 0;                              // from the largest change to that in the skin, of the latest answer

  Problem part_;
  Newton newton_;
  std::vector<Vec3> change_;
  std::vector<double> rates_before_, rates_;  // of the rows in the order of the pools

  // Scratch for the choice of a part.
  std::vector<std::uint32_t> next_center_, first_neighbor_, neighbors_, number_in_part_;
};

}  // namespace iota::solver
