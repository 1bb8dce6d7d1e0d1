// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/model.h"
#include "solver/problem.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace iota::step {

/// A place of a constraint as the solver sees it: a weighted sum of nodes plus a constant.
struct PlaceArm {
  std::array<std::pair<std::uint32_t, double>, 4> nodes{};  ///< weight 0 ends the list
  Vec3 constant;
};
using PlaceArms = std::array<PlaceArm, model::place_count>;

/// What a solver's row is to its constraint.
struct RowUse {
  enum class Role : std::uint8_t { hold, limit, motor, friction, spring } role = Role::hold;
  std::uint8_t coordinate = 0;  ///< of all but `hold`
  std::uint8_t first = 0;       ///< of `hold`: which of the constraint's multipliers
};

/// The rows of an island's constraints: made with the island, loaded from the model before a step, stored back after it.
class ConstraintRows {
 public:
  /// Adds the rows of a constraint to a problem that is being built. Rows whose nodes are all pinned are left out: a step
  /// can do nothing about them, but to see whether they are met.
  void add(const model::Model&, std::uint32_t constraint, const PlaceArms&, const std::vector<std::uint8_t>& pinned,
           solver::Problem&);
  void load(const model::Model&, solver::Problem&) const;
  /// Multipliers, gaps and coordinates; particles must be where they are at the end of the step.
  void store(model::Model&, const solver::Problem&) const;
  void refresh_coordinates(model::Model&) const;
  /// Whether the rows that were left out are met, as far as anybody holds them; after `store`.
  bool meets_pinned(const model::Model&) const;
  /// The constraint that a row of the problem is of: `pool` is the place of its type in the list of types. `none` if it is
  /// of no constraint.
  std::uint32_t constraint_of(std::size_t pool, std::size_t item) const;

 private:
  template <class C>
  struct Uses {
    struct Row {
      std::uint32_t constraint, item;
      RowUse use;
    };
    std::vector<Row> list;
  };
  solver::ConstraintPools<Uses> uses_;
  std::vector<std::uint32_t> constraints_;
  std::vector<std::uint32_t> pinned_;  // those with rows that were left out
};

/// Which of limit, motor, friction and spring a coordinate has rows for.
using RowsOf = std::array<bool, 4>;
RowsOf rows_of(const CoordinateOptions&);

/// Makes the model's coordinates of a constraint those of the present places.
void refresh_coordinates(model::Model&, std::uint32_t constraint);

/// Finds where two surfaces are nearest, for those that a constraint joins.
void start_contact(model::Model&, std::uint32_t constraint);

/// Force and torque of a constraint on its side a, about `position`, from the last step's multipliers at the present
/// places.
struct Reaction {
  Vec3 position, force, torque;
};
Reaction calc_reaction(const model::Model&, std::uint32_t constraint);

/// Force of a constraint on one of its places, N, as `calc_reaction` has it.
Vec3 calc_force_at(const model::Model&, std::uint32_t constraint, int place);

/// The largest violation of what a constraint holds, limits apart, at the present places: absolute (m; rad where it is
/// about directions), and over the reference length of its row.
struct Violation {
  double absolute = 0, relative = 0;
};
Violation calc_violation(const model::Model&, std::uint32_t constraint);

/// Value and speed of a coordinate at the present places; the angle is unwrapped near the last one.
std::pair<double, double> calc_coordinate(const model::Model&, std::uint32_t constraint, JointCoordinate);

}  // namespace iota::step
