// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/loads.h"
#include "ingredient/model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <type_traits>
#include <utility>

namespace iota::ingredient {

/// A place of a joint in the solver: a weighted sum of nodes plus a constant.
struct PlaceArm {
  WeightedNodes nodes{};
  Vec3 constant;
};
using PlaceArms = std::array<PlaceArm, place_count>;

/// The role of a solver's row in its joint.
struct RowUse {
  enum class Role : std::uint8_t { hold, limit, motor, friction, spring } role = Role::hold;
  std::uint8_t coordinate = 0;  ///< of `hold`: slide or angle, the one whose unit its value has
  std::uint8_t first = 0;       ///< of `hold`: which of the joint's multipliers
};

/// The rows of a coordinate: limit, motor, friction and spring.
using RowsOf = std::array<bool, 4>;
RowsOf rows_of(const CoordinateOptions&);

namespace joint {

using Form = ConstraintKindInfo::Form;
using Role = RowUse::Role;

inline constexpr int angle = static_cast<int>(JointCoordinate::angle), slide = static_cast<int>(JointCoordinate::slide),
                     second_angle = static_cast<int>(JointCoordinate::second_angle);

/// A joint with its places, from which its form makes rows.
struct JointArms {
  const Constraint& c;
  const ConstraintGeometry& geometry;
  const PlaceArms& places;

  /// Adds a place, times a sign, to an arm of a row.
  template <class Row>
  void add(Row& row, int arm, int place, double sign) const {
    for (const auto& [node, weight] : places[place].nodes) {
      if (weight == 0) break;
      (void)row.add(arm, node, sign * weight);
    }
    const Vec3 constant = row.constant[arm] + sign * places[place].constant;
    row.set_constant(arm, constant);
  }
  /// Adds a direction: the vector from the origin of its side to the place.
  template <class Row>
  void direction(Row& row, int arm, int place) const {
    add(row, arm, place, 1);
    add(row, arm, place < b_origin ? a_origin : b_origin, -1);
  }
  /// Lists the nodes of a's places first, so that the elimination can separate the two bodies.
  template <class Row>
  void sides(Row& row, std::initializer_list<int> of_a, std::initializer_list<int> of_b) const {
    const auto list = [&](std::initializer_list<int> listed) {
      for (const int place : listed)
        for (const auto& [node, weight] : places[place].nodes)
          if (weight != 0 && c.has(place)) (void)row.add(0, node, 0);
    };
    list(of_a);
    row.first_side = row.count;
    list(of_b);
    if (row.first_side == row.count) row.first_side = 0;
  }

  /// Arm 0 is a's origin relative to b's, arms 1 to 3 are the axes of b's frame.
  template <class Row>
  void place_in_frame(Row& row) const {
    sides(row, {a_origin}, {b_origin, b_axis, b_side, b_third});
    add(row, 0, a_origin, 1), add(row, 0, b_origin, -1);
    frame(row, 1, b_origin);
  }
  /// The unit axes x, y, z of a frame as three arms.
  template <class Row>
  void frame(Row& row, int arm, int origin) const {
    const double scale = 1 / c.scale[origin == b_origin];
    for (const int place : {origin + 2, origin + 3, origin + 1}) {
      add(row, arm, place, scale), add(row, arm, origin, -scale);
      ++arm;
    }
  }

  /// A weighted sum of places, which is zero.
  solver::AffineConstraint sum_of(std::initializer_list<std::pair<int, double>> terms) const {
    solver::AffineConstraint row;
    for (const auto& [place, sign] : terms) {
      for (const auto& [node, weight] : places[place].nodes) {
        if (weight == 0) break;
        const auto end = row.nodes.begin() + row.count;
        const auto at = std::find(row.nodes.begin(), end, node) - row.nodes.begin();
        if (at == row.count) row.nodes[row.count++] = node;
        row.weights[static_cast<std::size_t>(at)] += sign * weight;
      }
      row.target -= sign * places[place].constant;
    }
    row.target_start = row.target;
    row.reference = std::max(c.scale[0], c.scale[1]);
    return row;
  }
};

/// Takes the rows of a joint in their order and passes each to sink(row, use). Used for the problem, in which places are
/// combinations of nodes, and for reactions, in which each place is a node.
template <class Sink>
class RowSink {
 public:
  RowSink(const Constraint& c, Sink& sink) : c_(c), sink_(sink) {}

  /// A row that holds. unit: the coordinate whose unit its value has.
  template <class Row>
  void hold(const Row& row, int unit = slide) {
    sink_(row, RowUse{Role::hold, static_cast<std::uint8_t>(unit), next_});
    next_ += Row::rows;
  }

  /// A coordinate: a row each for its limit, motor, friction and spring, as far as it has them.
  template <class Row>
  void coordinate(int which, const Row& row) {
    const RowsOf wanted = rows_of(c_.options[which]);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      if (wanted[i]) sink_(row, RowUse{static_cast<Role>(i + 1), static_cast<std::uint8_t>(which), 0});
  }

 private:
  const Constraint& c_;
  Sink& sink_;
  std::uint8_t next_ = 0;
};

/// Every particle is a node, with the number of its place.
struct JointPlaces {
  PlaceArms arms{};
  std::array<Vec3, place_count> position{}, velocity{};

  JointPlaces(const Model&, const Constraint&);
  /// Their positions at the start of the last step.
  std::array<Vec3, place_count> calc_start(const LastStep&, const Constraint&) const;
};

/// The places of a joint by the nodes of an island; none if one of its sides is inactive.
std::optional<PlaceArms> arms_of(const IslandMap&, const Constraint&);

/// visit(term): of a coupling, in their order.
template <class Visit>
void for_each_term(const Model& model, const Constraint& coupling, Visit visit) {
  for (std::uint32_t t = coupling.first_term; t != none; t = model.coupled_terms[t].next) visit(model.coupled_terms[t]);
}
/// visit(slot of a coupling): of those that couple a constraint's coordinates; once for each of its terms in them.
template <class Visit>
void for_each_coupling_of(const Model& model, const Constraint& c, Visit visit) {
  for (std::uint32_t t = c.coupled; t != none; t = model.coupled_terms[t].next_at_joint)
    visit(model.coupled_terms[t].coupling);
}

/// A form without answers of its own. A form inherits it, has `build`, and hides the functions that it defines itself.
struct PlainForm {
  /// visit(row): the row of a coordinate, with a target of zero. False if the bodies are too thin for it.
  template <class Visit>
  static bool with_coordinate(const JointArms&, JointCoordinate, Visit) {
    return false;
  }
  /// Brings a row that holds, and its multipliers, to the state of the joint.
  template <class Row>
  static void load(Row&, const Model&, const Constraint&, double* /*multipliers*/) {}
  template <class Row>
  static void store(const Row&, Constraint&, const double* /*multipliers*/) {}
  /// The curve or surface from its data; throws std::invalid_argument for invalid ones.
  static void make_geometry(const Model&, const Constraint&, ConstraintGeometry&) {}
  /// Finds the state from which the rows of a new joint start.
  static void start(Model&, std::uint32_t) {}
};

/// Sets the value of a coordinate's row that is zero: an overload for each type in the header of its form. `now` is the
/// last value of the coordinate.
template <class Row>
void set_target(Row&, double, double) {}

/// Lets the target of a row that is loaded arrive where it is at the end of the step: an even way from its start.
template <class Row>
void move_target(Row& row, double way) {
  if constexpr (requires { row.target_start = row.target - way; }) row.target_start = row.target - way;
}

/// The value of a row that holds an angle, over that angle, m.
inline double lever_of(const solver::BilinearConstraint& row) { return row.reference; }
template <class Row>
double lever_of(const Row&) {
  return 1;
}

/// The law of a row that holds: of a rope's bound, and of its compliance.
template <class Row>
solver::RowLaw law_of_hold(const Constraint& c, RowUse use, const Row& row) {
  solver::RowLaw law;
  const int sign = info(c.kind).sign;
  if (sign > 0) law.lower = 0;
  if (sign < 0) law.upper = 0;
  const double lever = use.coordinate == angle ? lever_of(row) : 1;
  law.compliance = use.coordinate == angle ? c.compliance.angular * lever * lever : c.compliance.linear;
  if (law.is_compliant()) law.damping = c.compliance.time / law.compliance;
  return law;
}
/// The law of its r-th row: along the tangent of a cone it has no value to hold.
template <class Row>
solver::RowLaw law_of_hold(const Constraint& c, RowUse use, const Row& row, int r) {
  if constexpr (solver::ConeConstraint<Row>)
    if (Row::is_tangent(r)) return {.is_rate = true};
  return law_of_hold(c, use, row);
}

}  // namespace joint

}  // namespace iota::ingredient
