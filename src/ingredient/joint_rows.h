// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/loads.h"
#include "ingredient/model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
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

using Role = RowUse::Role;

inline constexpr int angle = static_cast<int>(JointCoordinate::angle), slide = static_cast<int>(JointCoordinate::slide),
                     second_angle = static_cast<int>(JointCoordinate::second_angle);

/// Builds the rows of a joint and passes each to sink(row, use). Used for the problem, in which places are combinations
/// of nodes, and for reactions, in which each place is a node.
template <class Sink>
class JointRowBuilder {
 public:
  JointRowBuilder(const Constraint& c, const ConstraintGeometry& geometry, const PlaceArms& places, Sink& sink)
      : c_(c), geometry_(geometry), places_(places), sink_(sink) {}

  void run() {
    using Form = ConstraintKindInfo::Form;
    const ConstraintKindInfo& kind = info(c_.kind);
    switch (kind.form) {
      case Form::joint: return joint(kind);
      case Form::distance: return c_.kind == ConstraintKind::span ? coordinate(slide, span_row()) : distance();
      case Form::path: hold(curve_row()); return coordinate(slide, station_row());
      case Form::surface: return hold(surface_row());
      case Form::surface_pair: return hold(surface_pair_row());
      case Form::coupling: return;  // its row has other joints' places
    }
  }

  void joint(const ConstraintKindInfo& kind) {
    if (kind.meet) meet();
    if (kind.line) line();
    if (kind.align) align();
    if (c_.lock == Constraint::Lock::side_of_a) product(a_side, b_third, 0);
    if (c_.lock == Constraint::Lock::third_of_a) product(a_third, b_side, 0);
    if (kind.cross) product(a_axis, b_axis, 0);
    if (kind.plane) hold(slide_row());
    if (kind.screw) hold(screw_row());
    if (kind.angle && has_angle(c_)) coordinate(angle, angle_row());
    if (kind.slide) coordinate(slide, slide_row());
    if (has_second_angle(c_)) coordinate(second_angle, second_angle_row());
  }

  /// visit(row): the row of one coordinate, with a target of zero. False if the bodies are too thin for it.
  template <class Visit>
  bool with_coordinate(JointCoordinate which, Visit visit) const {
    if (which == JointCoordinate::slide) {
      const auto form = info(c_.kind).form;
      form == ConstraintKindInfo::Form::path       ? visit(station_row())
      : form == ConstraintKindInfo::Form::distance ? visit(span_row())
                                                   : visit(slide_row());
      return true;
    }
    const bool second = which == JointCoordinate::second_angle;
    if (second ? !has_second_angle(c_) : !has_angle(c_)) return false;
    visit(second ? second_angle_row() : angle_row());
    return true;
  }

  static bool has_angle(const Constraint& c) {
    return c.has(a_side) && (info(c.kind).cross || (c.has(b_side) && (c.has(a_axis) || c.has(b_axis))));
  }

  static bool has_second_angle(const Constraint& c) { return info(c.kind).second_angle && c.has(b_side); }

  /// From b's reference to a's, about the axis.
  solver::AngleConstraint angle_row() const {
    solver::AngleConstraint row;
    const bool cross = info(c_.kind).cross;
    sides(row, {a_origin, a_axis, a_side}, {b_origin, b_axis, b_side});
    direction(row, 0, c_.has(a_axis) ? a_axis : b_axis);
    direction(row, 1, cross ? b_axis : b_side);
    direction(row, 2, a_side);
    return row;
  }

  /// From b's reference to a's axis, about b's.
  solver::AngleConstraint second_angle_row() const {
    solver::AngleConstraint row;
    sides(row, {a_origin, a_axis}, {b_origin, b_axis, b_side});
    direction(row, 0, b_axis), direction(row, 1, b_side), direction(row, 2, a_axis);
    return row;
  }

  /// The row of a slide: it holds the place of a's origin relative to b's along the axis. product / scale is the target
  /// in m.
  solver::BilinearConstraint slide_row() const {
    solver::BilinearConstraint row;
    const int axis = c_.has(b_axis) ? b_axis : a_axis;
    sides(row, {a_origin, a_axis}, {b_origin, b_axis});
    add(row, 0, a_origin, 1), add(row, 0, b_origin, -1);
    direction(row, 1, axis);
    row.scale = c_.scale[axis >= b_origin];
    row.reference = std::max(c_.scale[0], c_.scale[1]);
    return row;
  }

  /// The slide is `length` times the angle.
  solver::CouplingConstraint screw_row() const {
    solver::CouplingConstraint row;
    const auto turned = angle_row();
    const auto slid = slide_row();
    const auto list = [&](const auto& part, std::uint32_t from, std::uint32_t to) {
      for (std::uint32_t i = from; i < to; ++i) (void)row.list_node(part.nodes[i]);
    };
    list(turned, 0, turned.first_side), list(slid, 0, slid.first_side);
    row.first_side = row.count;
    list(turned, 0, turned.count), list(slid, 0, slid.count);
    row.add(c_.length, turned), row.add(-1, slid);
    return row;
  }

  solver::StationConstraint station_row() const {
    solver::StationConstraint row;
    place_in_frame(row);
    row.curve = geometry_.curve.get();
    row.parameter = c_.coordinate[slide];
    row.reference = 0.1 * c_.length;
    return row;
  }

  solver::SpanConstraint span_row() const {
    solver::SpanConstraint row;
    sides(row, {a_origin}, {b_origin});
    add(row, 0, a_origin, 1), add(row, 0, b_origin, -1);
    row.reference = c_.scale[0];
    return row;
  }

  solver::SurfacePairConstraint surface_pair_row() const {
    solver::SurfacePairConstraint row;
    sides(row, {a_origin, a_axis, a_side, a_third}, {b_origin, b_axis, b_side, b_third});
    add(row, 0, b_origin, 1), add(row, 0, a_origin, -1);
    frame(row, 1, a_origin), frame(row, 4, b_origin);
    row.surface_a = geometry_.surfaces[0].get(), row.surface_b = geometry_.surfaces[1].get();
    row.reference = std::min(row.surface_a->scale(), row.surface_b->scale());
    row.nearest = c_.nearest;
    return row;
  }

 private:
  solver::CurveConstraint curve_row() const {
    solver::CurveConstraint row;
    place_in_frame(row);
    row.curve = geometry_.curve.get();
    row.reference = 0.1 * c_.length;
    return row;
  }
  solver::SurfaceConstraint surface_row() const {
    solver::SurfaceConstraint row;
    place_in_frame(row);
    row.surface = geometry_.surfaces[1].get();
    return row;
  }
  /// a's place in b's frame.
  template <class Row>
  void place_in_frame(Row& row) const {
    sides(row, {a_origin}, {b_origin, b_axis, b_side, b_third});
    add(row, 0, a_origin, 1), add(row, 0, b_origin, -1);
    frame(row, 1, b_origin);
  }
  /// The unit axes x, y, z of a frame as three arms.
  template <class Row>
  void frame(Row& row, int arm, int origin) const {
    const double scale = 1 / c_.scale[origin == b_origin];
    for (const int place : {origin + 2, origin + 3, origin + 1}) {
      add(row, arm, place, scale), add(row, arm, origin, -scale);
      ++arm;
    }
  }

  template <class Row>
  void hold(const Row& row, int unit = slide) {
    sink_(row, RowUse{Role::hold, static_cast<std::uint8_t>(unit), next_});
    next_ += Row::rows;
  }

  template <class Row>
  void coordinate(int which, const Row& row) {
    const RowsOf wanted = rows_of(c_.options[which]);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      if (wanted[i]) sink_(row, RowUse{static_cast<Role>(i + 1), static_cast<std::uint8_t>(which), 0});
  }

  template <class Row>
  void add(Row& row, int arm, int place, double sign) const {
    for (const auto& [node, weight] : places_[place].nodes) {
      if (weight == 0) break;
      (void)row.add(arm, node, sign * weight);
    }
    const Vec3 constant = row.constant[arm] + sign * places_[place].constant;
    row.set_constant(arm, constant);
  }
  template <class Row>
  void direction(Row& row, int arm, int place) const {
    add(row, arm, place, 1);
    add(row, arm, place < b_origin ? a_origin : b_origin, -1);
  }
  /// Lists the nodes of a's places first, so that the elimination can separate the two bodies.
  template <class Row>
  void sides(Row& row, std::initializer_list<int> of_a, std::initializer_list<int> of_b) const {
    const auto list = [&](std::initializer_list<int> places) {
      for (const int place : places)
        for (const auto& [node, weight] : places_[place].nodes)
          if (weight != 0 && c_.has(place)) (void)row.add(0, node, 0);
    };
    list(of_a);
    row.first_side = row.count;
    list(of_b);
    if (row.first_side == row.count) row.first_side = 0;
  }

  solver::AffineConstraint sum_of(std::initializer_list<std::pair<int, double>> terms) const {
    solver::AffineConstraint row;
    for (const auto& [place, sign] : terms) {
      for (const auto& [node, weight] : places_[place].nodes) {
        if (weight == 0) break;
        const auto end = row.nodes.begin() + row.count;
        const auto at = std::find(row.nodes.begin(), end, node) - row.nodes.begin();
        if (at == row.count) row.nodes[row.count++] = node;
        row.weights[static_cast<std::size_t>(at)] += sign * weight;
      }
      row.target -= sign * places_[place].constant;
    }
    row.target_start = row.target;
    row.reference = std::max(c_.scale[0], c_.scale[1]);
    return row;
  }

  void meet() { hold(sum_of({{a_origin, 1}, {b_origin, -1}})); }

  void line() {
    for (const int across : {a_side, a_third}) {
      solver::BilinearConstraint row;
      const int place = c_.line_side ? across + b_origin : across;
      sides(row, {a_origin, a_side, a_third}, {b_origin, b_side, b_third});
      add(row, 0, a_origin, 1), add(row, 0, b_origin, -1);
      direction(row, 1, place);
      row.scale = c_.scale[c_.line_side];
      row.reference = std::max(c_.scale[0], c_.scale[1]);
      hold(row);
    }
  }

  void align() {
    using Alignment = Constraint::Alignment;
    if (c_.alignment == Alignment::axes) {
      // Equal directions: three rows, one of them redundant, which is simpler than a special case.
      hold(sum_of({{a_axis, 1 / c_.scale[0]},
                   {a_origin, -1 / c_.scale[0]},
                   {b_axis, -1 / c_.scale[1]},
                   {b_origin, 1 / c_.scale[1]}}),
           angle);
    } else if (c_.alignment != Alignment::none) {
      const bool of_a = c_.alignment == Alignment::axis_of_a;
      const int axis = of_a ? a_axis : b_axis, side = of_a ? b_side : a_side;
      product(axis, side, c_.cosines[0]);
      if (c_.aligned == 2) product(axis, side + 1, c_.cosines[1]);
    }
  }

  /// The angle between two directions, one of each side, is constant.
  void product(int p, int q, double cosine) {
    solver::BilinearConstraint row;
    sides(row, {a_origin, a_axis, a_side, a_third}, {b_origin, b_axis, b_side, b_third});
    direction(row, 0, p), direction(row, 1, q);
    row.product = cosine * c_.scale[0] * c_.scale[1];
    row.scale = std::max(c_.scale[0], c_.scale[1]);
    row.reference = std::min(c_.scale[0], c_.scale[1]);
    hold(row, angle);
  }

  /// (|d|^2 - L^2) / 2L: the multiplier is the tension.
  void distance() {
    const auto single = [&](int place) {
      return places_[place].nodes[0].second == 1 && places_[place].constant == Vec3{};
    };
    if (!c_.compliance.is_exact()) return hold(span_row());  // its stretch is not only nearly the distance
    if (c_.kind == ConstraintKind::rod && single(a_origin) && single(b_origin)) {
      hold(solver::DistanceConstraint{
          {places_[a_origin].nodes[0].first, places_[b_origin].nodes[0].first}, c_.length, c_.length});
      return;
    }
    solver::BilinearConstraint row;
    sides(row, {a_origin}, {b_origin});
    for (const int arm : {0, 1}) add(row, arm, a_origin, 1), add(row, arm, b_origin, -1);
    row.product = c_.length * c_.length;
    row.scale = 2 * c_.length;
    row.reference = c_.length;
    hold(row);
  }

  const Constraint& c_;
  const ConstraintGeometry& geometry_;
  const PlaceArms& places_;
  Sink& sink_;
  std::uint8_t next_ = 0;
};

/// Every particle is a node, with the number of its place.
struct JointPlaces {
  PlaceArms arms{};
  std::array<Vec3, place_count> position{}, velocity{};

  /// Their positions at the start of the last step.
  std::array<Vec3, place_count> calc_start(const LastStep& step, const Constraint& c) const {
    std::array<Vec3, place_count> start = position;
    for (int place = 0; place < place_count; ++place) {
      if (!c.has(place) || c.particles[place] == none) continue;
      const model::Body& body = step.model.bodies[step.model.particles[c.particles[place]].body];
      const std::array<double, 4> weights = step.model.weights(c.particles[place]);
      start[place] = {};
      for (int i = 0; i < body.rank; ++i)
        if (weights[i] != 0) start[place] += weights[i] * step.start(body.basis[i]);
    }
    return start;
  }

  JointPlaces(const Model& model, const Constraint& c) {
    for (int place = 0; place < place_count; ++place) {
      if (!c.has(place)) continue;
      position[place] = position_of(model, c, place);
      if (c.particles[place] == none) {
        arms[place].constant = position[place];
      } else {
        arms[place].nodes[0] = {static_cast<std::uint32_t>(place), 1.0};
        // Like the solver's rows: in a conflict a particle may differ from its place in the body.
        std::tie(position[place], velocity[place]) = model.carried(c.particles[place]);
      }
    }
  }
};

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

/// `now` is the last value of the coordinate.
inline void set_target(solver::AngleConstraint& row, double now, double target) {
  row.target_start = row.target = target;
  row.near = now;
}
inline void set_target(solver::BilinearConstraint& row, double, double target) { row.product = target * row.scale; }
template <class Row>
void set_target(Row&, double, double) {}

inline void set_target(solver::StationConstraint& row, double now, double target) {
  row.target_start = row.target = target;
  row.parameter = now;
}
inline void set_target(solver::SpanConstraint& row, double, double target) { row.target = target; }

/// Stores the state of a joint's rows: multipliers, and the place on a curve or between surfaces. For a curve the force
/// is stored, which does not depend on the row's normals.
template <class Row>
void load_held(Row& row, const Constraint& c, RowUse use, double* multipliers) {
  std::copy_n(c.multipliers.begin() + use.first, Row::rows, multipliers);
  if constexpr (std::is_same_v<Row, solver::SurfacePairConstraint>) row.nearest = c.nearest;
  if constexpr (std::is_same_v<Row, solver::CouplingConstraint>)
    if (info(c.kind).screw) std::get<solver::AngleConstraint>(row.terms[0].coordinate).near = c.coordinate[angle];
  if constexpr (std::is_same_v<Row, solver::CurveConstraint>)
    row.start(c.coordinate[slide], {c.multipliers[0], c.multipliers[1], c.multipliers[2]}, multipliers);
}
template <class Row>
void save_held(const Row& row, Constraint& c, RowUse use, const double* multipliers) {
  std::copy_n(multipliers, Row::rows, c.multipliers.begin() + use.first);
  if constexpr (std::is_same_v<Row, solver::SurfacePairConstraint>) c.nearest = row.nearest;
  if constexpr (std::is_same_v<Row, solver::CurveConstraint>) {
    const Vec3 force = row.force(multipliers);
    c.multipliers[0] = force.x, c.multipliers[1] = force.y, c.multipliers[2] = force.z;
  }
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

inline void set_length(solver::DistanceConstraint& row, double length) { row.length = length; }
inline void set_length(solver::BilinearConstraint& row, double length) { row.product = length * length; }
inline void set_length(solver::SpanConstraint& row, double length) { row.target = length; }
inline void set_length(solver::CouplingConstraint& row, double length) { row.target_start = row.target = length; }
template <class Row>
void set_length(Row&, double) {}

}  // namespace joint

}  // namespace iota::ingredient
