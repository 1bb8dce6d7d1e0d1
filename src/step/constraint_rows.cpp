// SPDX-License-Identifier: Apache-2.0
#include "step/constraint_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <type_traits>

namespace iota::step {

using namespace model;
using Role = RowUse::Role;

namespace {

constexpr int angle = static_cast<int>(JointCoordinate::angle), slide = static_cast<int>(JointCoordinate::slide),
              second_angle = static_cast<int>(JointCoordinate::second_angle);

/// Builds the rows of a constraint and hands each to sink(row, use). One function for the problem, where places are
/// combinations of nodes, and for reactions, where each place is a node of its own.
template <class Sink>
class Expansion {
 public:
  Expansion(const Constraint& c, const ConstraintGeometry& geometry, const PlaceArms& places, Sink& sink)
      : c_(c), geometry_(geometry), places_(places), sink_(sink) {}

  void run() {
    using Form = ConstraintKindInfo::Form;
    const ConstraintKindInfo& kind = info(c_.kind);
    switch (kind.form) {
      case Form::joint: return joint(kind);
      case Form::distance: return distance();
      case Form::path: hold(curve_row()); return coordinate(slide, station_row());
      case Form::surface: return hold(surface_row());
      case Form::surface_pair: return hold(contact_row());
    }
  }

  void joint(const ConstraintKindInfo& kind) {
    if (kind.meet) meet();
    if (kind.line) line();
    if (kind.align) align();
    if (c_.lock == Constraint::Lock::side_of_a) product(a_side, b_third, 0);
    if (c_.lock == Constraint::Lock::third_of_a) product(a_third, b_side, 0);
    if (kind.cross) product(a_axis, b_axis, 0);
    if (kind.angle && has_angle(c_)) coordinate(angle, angle_row());
    if (kind.slide) coordinate(slide, slide_row());
    if (has_second_angle(c_)) coordinate(second_angle, second_angle_row());
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

  /// Of a's origin against b's, along the axis; product / scale is the target in m.
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

  solver::StationConstraint station_row() const {
    solver::StationConstraint row;
    place_in_frame(row);
    row.curve = geometry_.curve.get();
    row.parameter = c_.coordinate[slide];
    row.reference = 0.1 * c_.length;
    return row;
  }

  solver::SurfacePairConstraint contact_row() const {
    solver::SurfacePairConstraint row;
    sides(row, {a_origin, a_axis, a_side, a_third}, {b_origin, b_axis, b_side, b_third});
    add(row, 0, b_origin, 1), add(row, 0, a_origin, -1);
    frame(row, 1, a_origin), frame(row, 4, b_origin);
    row.surface_a = geometry_.surfaces[0].get(), row.surface_b = geometry_.surfaces[1].get();
    row.reference = std::min(row.surface_a->size(), row.surface_b->size());
    row.contact = c_.contact;
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
  /// a's place against b's frame.
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
  void hold(const Row& row) {
    sink_(row, RowUse{Role::hold, 0, next_});
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
  /// Lists the nodes of a's places first, so that the elimination can keep the two bodies apart.
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
      // Equal directions: three rows, one too many, which the solver minds less than a special case.
      hold(sum_of({{a_axis, 1 / c_.scale[0]},
                   {a_origin, -1 / c_.scale[0]},
                   {b_axis, -1 / c_.scale[1]},
                   {b_origin, 1 / c_.scale[1]}}));
    } else if (c_.alignment != Alignment::none) {
      const bool of_a = c_.alignment == Alignment::axis_of_a;
      const int axis = of_a ? a_axis : b_axis, side = of_a ? b_side : a_side;
      product(axis, side, c_.cosines[0]);
      if (c_.aligned == 2) product(axis, side + 1, c_.cosines[1]);
    }
  }

  /// Two directions, one of each side, keep their angle.
  void product(int p, int q, double cosine) {
    solver::BilinearConstraint row;
    sides(row, {a_origin, a_axis, a_side, a_third}, {b_origin, b_axis, b_side, b_third});
    direction(row, 0, p), direction(row, 1, q);
    row.product = cosine * c_.scale[0] * c_.scale[1];
    row.scale = std::max(c_.scale[0], c_.scale[1]);
    row.reference = std::min(c_.scale[0], c_.scale[1]);
    hold(row);
  }

  /// (|d|^2 - L^2) / 2L: the multiplier is the tension.
  void distance() {
    const auto single = [&](int place) {
      return places_[place].nodes[0].second == 1 && places_[place].constant == Vec3{};
    };
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

/// Every particle a node of its own, numbered as the places are.
struct Places {
  PlaceArms arms{};
  std::array<Vec3, place_count> position{}, velocity{};

  Places(const Model& model, const Constraint& c) {
    for (int place = 0; place < place_count; ++place) {
      if (!c.has(place)) continue;
      position[place] = position_of(model, c, place);
      if (c.particles[place] == none) {
        arms[place].constant = position[place];
      } else {
        arms[place].nodes[0] = {static_cast<std::uint32_t>(place), 1.0};
        // As the solver's rows do: in a conflict a particle may be elsewhere than its body has it.
        std::tie(position[place], velocity[place]) = model.carried(c.particles[place]);
      }
    }
  }
};

/// `now` is the coordinate as it was last seen.
void set_target(solver::AngleConstraint& row, double now, double target) {
  row.target_start = row.target = target;
  row.near = now;
}
void set_target(solver::BilinearConstraint& row, double, double target) { row.product = target * row.scale; }
template <class Row>
void set_target(Row&, double, double) {}

void set_target(solver::StationConstraint& row, double now, double target) {
  row.target_start = row.target = target;
  row.parameter = now;
}

/// What a constraint keeps of the rows that hold it: multipliers, and where it is on a curve or between surfaces. Those on
/// a curve are kept as a force, whatever normals the row has.
template <class Row>
void load_held(Row& row, const Constraint& c, RowUse use, double* multipliers) {
  std::copy_n(c.multipliers.begin() + use.first, Row::rows, multipliers);
  if constexpr (std::is_same_v<Row, solver::SurfacePairConstraint>) row.contact = c.contact;
  if constexpr (std::is_same_v<Row, solver::CurveConstraint>)
    row.start(c.coordinate[slide], {c.multipliers[0], c.multipliers[1], c.multipliers[2]}, multipliers);
}
template <class Row>
void save_held(const Row& row, Constraint& c, RowUse use, const double* multipliers) {
  std::copy_n(multipliers, Row::rows, c.multipliers.begin() + use.first);
  if constexpr (std::is_same_v<Row, solver::SurfacePairConstraint>) c.contact = row.contact;
  if constexpr (std::is_same_v<Row, solver::CurveConstraint>) {
    const Vec3 force = row.force(multipliers);
    c.multipliers[0] = force.x, c.multipliers[1] = force.y, c.multipliers[2] = force.z;
  }
}

void set_length(solver::DistanceConstraint& row, double length) { row.length = length; }
void set_length(solver::BilinearConstraint& row, double length) { row.product = length * length; }
template <class Row>
void set_length(Row&, double) {}

/// The nearer of the two limits, as a one-sided row.
template <class Row>
void load_limit(Row& row, const CoordinateOptions& o, double now, solver::RowLaw& law) {
  if (o.lower == o.upper) return set_target(row, now, o.lower);
  const bool at_lower = now - o.lower < o.upper - now;
  set_target(row, now, at_lower ? o.lower : o.upper);
  (at_lower ? law.upper : law.lower) = 0;
}

}  // namespace

RowsOf rows_of(const CoordinateOptions& o) {
  return {std::isfinite(o.lower) || std::isfinite(o.upper), o.motor_max > 0, o.friction > 0,
          o.stiffness > 0 || o.damping > 0};
}

void ConstraintRows::add(const Model& model, std::uint32_t slot, const PlaceArms& places,
                         const std::vector<std::uint8_t>& pinned, solver::Problem& problem) {
  constraints_.push_back(slot);
  auto sink = [&]<class Row>(const Row& row, RowUse use) {
    const auto end = row.nodes.begin() + row.node_count();
    if (std::all_of(row.nodes.begin(), end, [&](std::uint32_t node) { return pinned[node]; })) {
      if (use.role == Role::hold && (pinned_.empty() || pinned_.back() != slot)) pinned_.push_back(slot);
      return;
    }
    auto& pool = std::get<solver::ConstraintPool<Row>>(problem.constraints);
    const auto item = static_cast<std::uint32_t>(pool.items.size());
    std::get<Uses<Row>>(uses_).list.push_back({slot, item, use});
    pool.items.push_back(row);
    if (use.role != Role::hold || info(model.constraints[slot].kind).sign != 0) (void)pool.law(item);
  };
  Expansion<decltype(sink)>(model.constraints[slot], model.geometry(slot), places, sink).run();
}

void ConstraintRows::load(const Model& model, solver::Problem& problem) const {
  problem.for_each_constraint_pool([&]<class C>(solver::ConstraintPool<C>& pool) {
    for (const auto& [slot, item, use] : std::get<Uses<C>>(uses_).list) {
      const Constraint& c = model.constraints[slot];
      C& row = pool.items[item];
      if (use.role == Role::hold) {
        load_held(row, c, use, pool.multiplier(item));
        const ConstraintKindInfo& kind = info(c.kind);
        if (kind.form == ConstraintKindInfo::Form::distance) set_length(row, c.length);
        if (kind.sign > 0) *pool.law(item) = {.lower = 0};
        if (kind.sign < 0) *pool.law(item) = {.upper = 0};
        continue;
      }
      const CoordinateOptions& o = c.options[use.coordinate];
      *pool.multiplier(item) = c.efforts[use.coordinate][static_cast<std::size_t>(use.role) - 1];
      solver::RowLaw& law = *pool.law(item) = {};
      const double now = c.coordinate[use.coordinate];
      set_target(row, now, 0);
      switch (use.role) {
        case Role::limit: load_limit(row, o, now, law); break;
        case Role::motor:
          law = {.lower = -o.motor_max, .upper = o.motor_max, .rate = o.motor_speed, .hold = true};
          break;
        case Role::friction: law = {.lower = -o.friction, .upper = o.friction, .hold = true}; break;
        default:
          law.compliance = 1 / o.stiffness;  // infinite for a pure dashpot
          law.damping = o.damping;
          set_target(row, now, o.rest);
      }
    }
  });
}

void ConstraintRows::store(Model& model, const solver::Problem& problem) const {
  for (const std::uint32_t slot : constraints_) {
    model.constraints[slot].gap = 0;
    step::refresh_coordinates(model, slot);
  }
  problem.for_each_constraint_pool([&]<class C>(const solver::ConstraintPool<C>& pool) {
    for (const auto& [slot, item, use] : std::get<Uses<C>>(uses_).list) {
      Constraint& c = model.constraints[slot];
      if (use.role != Role::hold) {
        c.efforts[use.coordinate][static_cast<std::size_t>(use.role) - 1] = *pool.multiplier(item);
        continue;
      }
      save_held(pool.items[item], c, use, pool.multiplier(item));
      double g[C::rows];
      pool.items[item].value(problem.position.data(), 1, g);
      for (int r = 0; r < C::rows; ++r) {
        const double off = pool.has_laws() ? pool.law(item)[r].violation(g[r]) : std::abs(g[r]);
        if (!(off <= c.gap)) c.gap = off;
      }
    }
  });
  for (const std::uint32_t slot : pinned_) {
    Constraint& c = model.constraints[slot];
    c.gap = std::max(c.gap, calc_violation(model, slot).absolute);
  }
}

bool ConstraintRows::meets_pinned(const Model& model) const {
  constexpr double met = 1e-6;
  return std::all_of(pinned_.begin(), pinned_.end(), [&](std::uint32_t slot) {
    return !is_in_force(model, model.constraints[slot]) || calc_violation(model, slot).relative <= met;
  });
}

std::uint32_t ConstraintRows::constraint_of(std::size_t pool, std::size_t item) const {
  std::uint32_t found = none;
  std::size_t index = 0;
  std::apply(
      [&](const auto&... uses) {
        const auto look = [&](const auto& list) {
          if (index++ != pool) return;
          for (const auto& row : list)
            if (row.item == item) found = row.constraint;
        };
        (look(uses.list), ...);
      },
      uses_);
  return found;
}

void ConstraintRows::refresh_coordinates(Model& model) const {
  for (const std::uint32_t slot : constraints_) step::refresh_coordinates(model, slot);
}

void refresh_coordinates(Model& model, std::uint32_t slot) {
  Constraint& c = model.constraints[slot];
  for (const JointCoordinate which : joint_coordinates)
    if (has_coordinate(c.kind, which))
      c.coordinate[static_cast<std::size_t>(which)] = calc_coordinate(model, slot, which).first;
}

namespace {

/// The forces of a constraint on all its places.
std::array<Vec3, place_count> forces_at(const Model& model, std::uint32_t slot, const Places& places) {
  const Constraint& c = model.constraints[slot];
  std::array<Vec3, place_count> forces{};
  if (!is_in_force(model, c)) return forces;
  auto sink = [&]<class Row>(const Row& row, RowUse use) {
    Row loaded = row;
    double multipliers[Row::rows];
    if (use.role == Role::hold)
      load_held(loaded, c, use, multipliers);
    else
      multipliers[0] = c.efforts[use.coordinate][static_cast<std::size_t>(use.role) - 1];
    const solver::Gradients<Row> gradients(loaded, places.position.data(), 1);
    for (int i = 0; i < row.node_count(); ++i) {
      Vec3 direction[Row::rows];
      gradients.of_node(i, direction);
      for (int r = 0; r < Row::rows; ++r) forces[row.nodes[i]] -= multipliers[r] * direction[r];
    }
  };
  Expansion<decltype(sink)>(c, model.geometry(slot), places.arms, sink).run();
  return forces;
}

}  // namespace

Vec3 calc_force_at(const Model& model, std::uint32_t slot, int place) {
  return forces_at(model, slot, Places(model, model.constraints[slot]))[static_cast<std::size_t>(place)];
}

Reaction calc_reaction(const Model& model, std::uint32_t slot) {
  const Places places(model, model.constraints[slot]);
  const std::array<Vec3, place_count> forces = forces_at(model, slot, places);
  Reaction reaction;
  reaction.position = places.position[a_origin];
  for (int place = a_origin; place < b_origin; ++place) {
    reaction.force += forces[place];
    reaction.torque += cross(places.position[place] - reaction.position, forces[place]);
  }
  return reaction;
}

Violation calc_violation(const Model& model, std::uint32_t slot) {
  const Constraint& c = model.constraints[slot];
  const ConstraintKindInfo& kind = info(c.kind);
  const Places places(model, c);
  Violation worst;
  auto sink = [&]<class Row>(const Row& row, RowUse use) {
    if (use.role != Role::hold) return;
    Row loaded = row;
    double multipliers[Row::rows], g[Row::rows];
    load_held(loaded, c, use, multipliers);
    if (kind.form == ConstraintKindInfo::Form::distance) set_length(loaded, c.length);
    loaded.value(places.position.data(), 1, g);
    for (const double value : g) {
      const double off = kind.sign == 0 ? std::abs(value) : std::max(0.0, kind.sign * value);
      worst.absolute = std::max(worst.absolute, off);
      worst.relative = std::max(worst.relative, off / loaded.reference_length());
    }
  };
  Expansion<decltype(sink)>(c, model.geometry(slot), places.arms, sink).run();
  return worst;
}

std::pair<double, double> calc_coordinate(const Model& model, std::uint32_t slot, JointCoordinate which) {
  const Constraint& c = model.constraints[slot];
  const Places places(model, c);
  auto ignore = [](const auto&, RowUse) {};
  const Expansion<decltype(ignore)> expansion(c, model.geometry(slot), places.arms, ignore);
  const auto read = [&](const auto& row) {
    using Row = std::remove_cvref_t<decltype(row)>;
    double value = 0, speed = 0;
    row.value(places.position.data(), 1, &value);
    const solver::Gradients<Row> gradients(row, places.position.data(), 1);
    for (int i = 0; i < row.node_count(); ++i) {
      Vec3 direction;
      gradients.of_node(i, &direction);
      speed += dot(direction, places.velocity[row.nodes[i]]);
    }
    return std::pair{value, speed};
  };
  if (which == JointCoordinate::slide)
    return info(c.kind).form == ConstraintKindInfo::Form::path ? read(expansion.station_row())
                                                               : read(expansion.slide_row());
  const bool second = which == JointCoordinate::second_angle;
  if (second ? !expansion.has_second_angle(c) : !expansion.has_angle(c)) return {0, 0};
  solver::AngleConstraint row = second ? expansion.second_angle_row() : expansion.angle_row();
  set_target(row, c.coordinate[static_cast<std::size_t>(which)], 0);
  return read(row);
}

void start_contact(Model& model, std::uint32_t slot) {
  Constraint& c = model.constraints[slot];
  if (info(c.kind).form != ConstraintKindInfo::Form::surface_pair) return;
  const Places places(model, c);
  auto ignore = [](const auto&, RowUse) {};
  solver::SurfacePairConstraint row =
      Expansion<decltype(ignore)>(c, model.geometry(slot), places.arms, ignore).contact_row();
  row.start(places.position.data(), 1);
  c.contact = row.contact;
}

}  // namespace iota::step
