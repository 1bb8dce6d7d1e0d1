// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/constraint_list.h"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <variant>

namespace iota::solver {

/// Whether a row refers to a direction in the world.
template <class C>
bool holds_direction(const C& c) {
  if constexpr (std::is_same_v<C, CouplingConstraint>)
    return std::any_of(c.terms.begin(), c.terms.end(), [](const auto& term) {
      return std::visit([](const auto& row) { return holds_direction(row); }, term.coordinate);
    });
  else if constexpr (GeneralConstraint<C>)
    return std::any_of(c.constant.begin(), c.constant.end(), [](const Vec3& v) { return !(v == Vec3{}); });
  else
    return false;
}

/// How the world outside holds a problem, or a piece of it.
struct Holds {
  int count = 0;                ///< of rows that are not between points of the problem
  std::optional<Vec3> place;    ///< of the latest, where that is a point at rest
  bool are_directions = false;  ///< a row refers to a direction in the world

  bool are_none() const { return count == 0 && !are_directions; }
  /// All hangs on that point, and may turn about it.
  std::optional<Vec3> pivot() const { return count == 1 && !are_directions ? place : std::nullopt; }
  template <class C>
  void add(const C& c) {
    are_directions = are_directions || holds_direction(c);
    if (c.is_internal()) return;
    ++count;
    if constexpr (std::is_same_v<C, AffineConstraint>)
      if (!c.is_moving()) place = c.target;
  }
  /// It hangs on a nail; the same place counts once.
  void add_nail(const AffineConstraint& nail) {
    if (nail.is_moving())
      ++count, place = std::nullopt;
    else if (!(count == 1 && place == nail.target))
      ++count, place = nail.target;
  }
};

}  // namespace iota::solver
