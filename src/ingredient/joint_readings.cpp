// SPDX-License-Identifier: Apache-2.0
#include "ingredient/joint_readings.h"

#include "ingredient/joint_rows.h"
#include "ingredient/model.h"
#include "ingredient/row_loads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

namespace iota::ingredient {

using namespace joint;

void refresh_coordinates(Model& model, std::uint32_t slot) {
  Constraint& c = model.constraints[slot];
  for (const JointCoordinate which : joint_coordinates)
    if (has_coordinate(c.kind, which))
      c.coordinate[static_cast<std::size_t>(which)] = calc_coordinate(model, slot, which).first;
}

namespace {

/// The forces of a constraint on all its places in the last step.
std::array<Vec3, place_count> forces_at(const LastStep& step, std::uint32_t slot, const JointPlaces& places) {
  const Model& model = step.model;
  const Constraint& c = model.constraints[slot];
  std::array<Vec3, place_count> forces{};
  if (!is_in_force(model, c)) return forces;
  const std::array<Vec3, place_count> start = places.calc_start(step, c);
  auto sink = [&]<class Row>(const Row& row, RowUse use) {
    Row loaded = row;
    double multipliers[Row::rows];
    if (use.role == Role::hold)
      load_held(loaded, c, use, multipliers);
    else
      multipliers[0] = c.efforts[use.coordinate][static_cast<std::size_t>(use.role) - 1];
    for_each_row_force(loaded, multipliers, step.stage.midpoint, start.data(), places.position.data(),
                       [&](std::uint32_t place, const Vec3& force) { forces[place] += force; });
  };
  JointRowBuilder<decltype(sink)>(c, model.geometry(slot), places.arms, sink).run();
  return forces;
}

}  // namespace

Vec3 calc_force_at(const LastStep& step, std::uint32_t slot, int place) {
  return forces_at(step, slot, JointPlaces(step.model, step.model.constraints[slot]))[static_cast<std::size_t>(place)];
}

Reaction calc_reaction(const Model& model, std::uint32_t slot) {
  const JointPlaces places(model, model.constraints[slot]);
  const std::array<Vec3, place_count> forces = forces_at(LastStep(model), slot, places);
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
  const JointPlaces places(model, c);
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
  JointRowBuilder<decltype(sink)>(c, model.geometry(slot), places.arms, sink).run();
  return worst;
}

std::pair<double, double> calc_coordinate(const Model& model, std::uint32_t slot, JointCoordinate which) {
  const Constraint& c = model.constraints[slot];
  const JointPlaces places(model, c);
  auto ignore = [](const auto&, RowUse) {};
  const JointRowBuilder<decltype(ignore)> rows(c, model.geometry(slot), places.arms, ignore);
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
    return info(c.kind).form == ConstraintKindInfo::Form::path ? read(rows.station_row()) : read(rows.slide_row());
  const bool second = which == JointCoordinate::second_angle;
  if (second ? !rows.has_second_angle(c) : !rows.has_angle(c)) return {0, 0};
  solver::AngleConstraint row = second ? rows.second_angle_row() : rows.angle_row();
  set_target(row, c.coordinate[static_cast<std::size_t>(which)], 0);
  return read(row);
}

void start_contact(Model& model, std::uint32_t slot) {
  Constraint& c = model.constraints[slot];
  if (info(c.kind).form != ConstraintKindInfo::Form::surface_pair) return;
  const JointPlaces places(model, c);
  auto ignore = [](const auto&, RowUse) {};
  solver::SurfacePairConstraint row =
      JointRowBuilder<decltype(ignore)>(c, model.geometry(slot), places.arms, ignore).contact_row();
  row.start(places.position.data(), 1);
  c.contact = row.contact;
}

}  // namespace iota::ingredient
